//! Panels side by side under one legend: one SVG for a file, or HTML whose panels stack where there is little room.

use super::mark::Sample;
use super::panel::{Panel, SIZE, WIDTH, opening};
use super::svg::{Anchor, Svg, coordinate, escape};
use super::text::width;

/// Space around and between panels.
const GAP: f64 = 26.0;
const MARGIN: f64 = 12.0;
/// Of the legend: height of a row, length of a sample, space between sample and name, between entries.
const ROW: f64 = 21.0;
const SAMPLE: f64 = 26.0;
const AFTER_SAMPLE: f64 = 7.0;
const AFTER_NAME: f64 = 20.0;

/// A figure: a name for its files, a title, what it shows in a sentence, its panels.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    name: String,
    title: String,
    description: String,
    columns: usize,
    panels: Vec<Panel>,
}

impl Figure {
    /// An empty figure. `name` is that of its files, without ending: `figure-07`.
    pub fn new(name: impl Into<String>, title: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            description: String::new(),
            columns: 2,
            panels: vec![],
        }
    }

    /// Description for screen readers.
    pub fn describe(self, description: impl Into<String>) -> Self {
        Self { description: description.into(), ..self }
    }

    /// How many panels stand side by side at most; two unless given.
    pub fn columns(self, columns: usize) -> Self {
        Self { columns: columns.max(1), ..self }
    }

    /// One more panel, after the others: along rows, from the top.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn title(&self) -> &str {
        &self.title
    }

    fn legend(&self) -> Vec<(&str, Sample)> {
        let mut entries: Vec<(&str, Sample)> = vec![];
        for entry in self.panels.iter().flat_map(|panel| panel.marks.iter()).filter_map(|mark| mark.entry()) {
            if !entries.iter().any(|(name, _)| *name == entry.0) {
                entries.push(entry);
            }
        }
        entries
    }

    pub fn svg(&self) -> String {
        let columns = self.columns.min(self.panels.len()).max(1);
        let total_width = 2.0 * MARGIN + columns as f64 * WIDTH + (columns - 1) as f64 * GAP;
        let (legend, legend_height) = self.legend_rows(total_width - 2.0 * MARGIN);
        let mut top = MARGIN + legend_height;
        let mut body = Svg::default();
        for row in self.panels.chunks(columns) {
            for (column, panel) in row.iter().enumerate() {
                let (x, y) = (coordinate(MARGIN + column as f64 * (WIDTH + GAP)), coordinate(top));
                body.raw(format_args!("<g transform=\"translate({x} {y})\">{}</g>", panel.content()));
            }
            top += row.iter().map(|panel| panel.size().1).fold(0.0, f64::max) + GAP;
        }
        let height = top - GAP + MARGIN;
        let mut svg = Svg::default();
        svg.raw(opening(total_width, height, &self.title, &self.description));
        svg.raw("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>");
        svg.raw(legend);
        svg.raw(body.finish());
        svg.raw("</svg>\n");
        svg.finish()
    }

    /// The legend in rows of `room`, and the height it takes.
    fn legend_rows(&self, room: f64) -> (String, f64) {
        let entries = self.legend();
        let mut svg = Svg::default();
        let (mut x, mut y) = (0.0, 0.0);
        for (name, sample) in &entries {
            let needed = SAMPLE + AFTER_SAMPLE + width(name, SIZE);
            if x > 0.0 && x + needed > room {
                (x, y) = (0.0, y + ROW);
            }
            let (at_x, at_y) = (MARGIN + x, MARGIN + y + 10.0);
            svg.raw(format_args!("<g transform=\"translate({} {})\">", coordinate(at_x), coordinate(at_y)));
            draw(&mut svg, *sample);
            svg.text((SAMPLE + AFTER_SAMPLE, 4.7), Anchor::Start, "", name);
            svg.raw("</g>");
            x += needed + AFTER_NAME;
        }
        (svg.finish(), if entries.is_empty() { 0.0 } else { y + ROW + 10.0 })
    }

    /// The figure for a page: a legend and the panels, which stack where there is little room. Goes into an element of
    /// the page's own; the page's style says how `plot-legend` and `plot-panels` lie.
    pub fn html(&self) -> String {
        let mut svg = Svg::default();
        svg.raw("<ul class=\"plot-legend\">");
        for (name, sample) in self.legend() {
            svg.raw(format_args!(
                "<li><svg viewBox=\"0 -8 {SAMPLE} 16\" width=\"{SAMPLE}\" height=\"16\" aria-hidden=\"true\">"
            ));
            draw(&mut svg, sample);
            svg.raw(format_args!("</svg>{}</li>", escape(name)));
        }
        let columns = self.columns.min(self.panels.len()).max(1);
        svg.raw(format_args!("</ul><div class=\"plot-panels plot-columns-{columns}\">"));
        for panel in &self.panels {
            svg.raw(panel.svg());
        }
        svg.raw("</div>");
        svg.finish()
    }
}

/// A sample of a legend, from 0 to its length, about height 0.
fn draw(svg: &mut Svg, sample: Sample) {
    match sample {
        Sample::Line(ink, stroke) => {
            let (color, width, dashes) = (ink.color(), stroke.width().max(1.4), stroke.dashes());
            svg.segment(
                (1.0, 0.0),
                (SAMPLE - 1.0, 0.0),
                format_args!(" stroke=\"{color}\" stroke-width=\"{width}\"{dashes}"),
            );
        }
        Sample::Area(ink) => svg.raw(format_args!(
            "<rect x=\"1\" y=\"-6\" width=\"24\" height=\"12\" fill=\"{}\" fill-opacity=\"0.25\"/>",
            ink.color()
        )),
        Sample::Dot(ink) => {
            svg.raw(format_args!("<circle cx=\"13\" cy=\"0\" r=\"3.6\" fill=\"{}\"/>", ink.color()));
        }
    }
}
