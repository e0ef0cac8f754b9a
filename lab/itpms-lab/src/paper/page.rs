//! The study as one HTML page: style inside, nothing loaded, a list of contents.
//!
//! Called by [`super::Study`].

use std::fmt::Write as _;

use super::Request;
use super::section::{Part, Section};
use itpms_analysis::page::figures_page;
use itpms_analysis::plot::escape;

const STYLE: &str = include_str!("../../assets/paper/page.css");

pub(super) fn page(sections: &[Section], request: &Request) -> String {
    let contents: String = sections
        .iter()
        .map(|section| format!("<li><a href=\"#{}\">{}</a></li>", section.id, escape(&section.title)))
        .collect();
    let body: String = sections.iter().map(html).collect();
    let content = format!(
        "<p>Every figure and table with numbers of <cite>New Indirect Tire Pressure Monitoring System Enabled by Adaptive Extended Kalman \
         Filtering of Vehicle Suspension Systems</cite> (Electronics 2021, 10(11), 1359), made again from simulated drives by <code>itpms lab \
         reproduce</code> {version}. Numbers of figures, tables and equations are the paper's; captions are ours. Figures 1, 2 and 4 \
         are diagrams and stand in <code>docs/math</code>.</p>\n\
         <p class=\"made\">{seeds} drives per case, seeds from {first}; simulation at {rate} Hz with {noise} m/s² of sensor noise, test bed at {bench_rate} \
         Hz with {mass} kg unsprung; what else was chosen is listed under <a href=\"#assumed\">Assumed</a>. The same options give the same page, byte for byte.</p>\n\
         <nav aria-label=\"Contents\"><h2>Contents</h2><ol>{contents}</ol></nav>\n\
         <section id=\"who\"><h2>Who is who</h2><dl>\
         <dt>ekf-ui</dt><dd>The extended Kalman filter with unknown input, eq. (6) to (17), as published.</dd>\
         <dt>aekf-ui</dt><dd>The same with the one-step forgetting factor, eq. (28) to (33), as published: the paper's proposal.</dd>\
         <dt>aekf-ui-informed</dt><dd>That recursion corrected (docs/math/ekf-ui.md, section 5), and the stiffness that the road's spectrum suggests.</dd>\
         <dt>informed</dt><dd>The default: a Bayes filter over the pressure that knows that a road looks like a road, and notices when one repeats.</dd></dl></section>\n\
         {body}",
        version = env!("CARGO_PKG_VERSION"),
        seeds = request.seeds,
        first = request.first_seed,
        rate = request.rate_hz,
        noise = request.noise_m_s2,
        bench_rate = request.bench_rate_hz,
        mass = request.bench_unsprung_mass_kg,
    );
    figures_page("The paper's study, reproduced", STYLE, content)
}

fn html(section: &Section) -> String {
    let mut text = format!("<section id=\"{}\">\n<h2>{}</h2>\n", section.id, escape(&section.title));
    for part in &section.parts {
        // Writing to a string cannot fail.
        let _ = match part {
            Part::Text(html) => writeln!(text, "{html}"),
            Part::Figure { figure, caption, data } => writeln!(
                text,
                "<figure id=\"{name}\">\n<h3>{title}</h3>\n{plot}\n<figcaption>{caption} {files}</figcaption>\n</figure>",
                name = figure.name(),
                title = escape(figure.title()),
                plot = figure.html(),
                files = files(figure.name(), data.iter().map(|data| data.name.as_str())),
            ),
            Part::Table { table, caption } => writeln!(
                text,
                "<figure class=\"table\" id=\"{name}\">\n<h3>{title}</h3>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" \
                 aria-label=\"{title}\">{cells}</div>\n<figcaption>{caption} {files}</figcaption>\n</figure>",
                name = table.data.name,
                title = escape(&table.title),
                cells = table.html(),
                files = files("", [table.data.name.as_str()]),
            ),
        };
    }
    text + "</section>\n"
}

fn files<'a>(svg: &str, data: impl IntoIterator<Item = &'a str>) -> String {
    let mut links = vec![];
    if !svg.is_empty() {
        links.push(format!("<a href=\"{svg}.svg\">{svg}.svg</a>"));
    }
    for name in data {
        links.push(format!("<a href=\"{name}.csv\">{name}.csv</a>, <a href=\"{name}.json\">json</a>"));
    }
    format!("<span class=\"files\">{}</span>", links.join(" · "))
}
