//! The result as HTML: a section for another page, or a page of its own.
//!
//! Called by the binary and by the page about the paper. A section brings its headings, tables and figures; the page
//! around it brings the style (`plot-legend`, `plot-panels`, tables).

use super::summary::{REPORTED_S, reported};
use super::{Car, Observability, Situation, Sources, TOLERANCE};
use itpms_analysis::plot::{Figure, escape};

use itpms_analysis::page::figures_page;

impl Observability {
    pub fn page(&self) -> String {
        figures_page(&format!("What the accelerations can tell: {}", self.vehicle), "", self.section())
    }

    /// The content: paragraphs under `h3`, tables, figures; to be put below an `h1` or `h2`.
    pub fn section(&self) -> String {
        let mut figures = self.figures().into_iter();
        let mut next = || figures.next().map(|figure| framed(&figure)).unwrap_or_default();
        [self.proof(), next(), self.rank(), self.bounds(), next(), self.circumstances(), next()].join("\n")
    }

    fn proof(&self) -> String {
        let rows: String = self
            .twins
            .drives
            .iter()
            .skip(1)
            .map(|twin| {
                format!(
                    "<tr><td>{}</td><td>{:.3}</td><td>{:.0e}</td><td>{:.0e}</td></tr>",
                    escape(&twin.label),
                    1e3 * twin.road_difference_rms_m,
                    twin.relative_difference[0],
                    twin.relative_difference[1]
                )
            })
            .collect();
        format!(
            "<h3>Two accelerations leave the stiffness free</h3>{}\
             <div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th>tire</th><th>its road differs by, mm rms</th><th>body acceleration differs by</th>\
             <th>wheel acceleration differs by</th></tr></thead><tbody>{rows}</tbody></table></div>",
            self.proof_text()
        )
    }

    pub(crate) fn proof_text(&self) -> String {
        format!(
            "<p>Body and wheel feel the road only through the tire's force, <i>F</i> = <i>k</i><sub>t</sub> (<i>x</i><sub>r</sub> − <i>x</i><sub>w</sub>). \
             A tire of another stiffness <i>k</i>′ gives the same force on the road <i>x</i><sub>w</sub> + <i>F</i>/<i>k</i>′, and so the same motion and \
             the same accelerations. Here {} such pairs are driven, each integrated by itself from its own road and its own stiffness; the largest \
             difference of any acceleration is {:.0e} of the largest acceleration, which is rounding.</p>",
            self.twins.drives.len().saturating_sub(1),
            self.twins.worst()
        )
    }

    fn rank(&self) -> String {
        let rows: String = self
            .ranks
            .iter()
            .map(|case| {
                format!(
                    "<tr><td>{}</td><td>{} of {}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                    escape(&case.label),
                    case.rank,
                    case.unknowns,
                    case.missing,
                    case.drifts,
                    case.stiffness.label()
                )
            })
            .collect();
        format!(
            "<h3>Rank with the road as unknown input</h3>{}\
             <div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th>case</th><th>rank</th><th>missing</th><th>of these drift</th><th>stiffness</th></tr></thead>\
             <tbody>{rows}</tbody></table></div>",
            self.rank_text()
        )
    }

    pub(crate) fn rank_text(&self) -> String {
        format!(
            "<p>Unknown are the states, the stiffness and the road with its derivatives; known are both accelerations with theirs. What no singular value \
             above {TOLERANCE:.0e} of the largest belongs to is not observable. Two directions are always missing: body, wheel and road lifted together, and set off \
             together (a double zero at <i>s</i> = 0). For one wheel the third is the exchange of stiffness for road.</p>"
        )
    }

    fn bounds(&self) -> String {
        let head: String =
            (0..4).map(|_| REPORTED_S.map(|t| format!("<th>{t:.0} s</th>")).concat()).collect();
        let rows: String = Sources::ALL
            .into_iter()
            .map(|sources| {
                let label = sources.to_string();
                let cells: String = Car::ALL
                    .into_iter()
                    .flat_map(|car| Situation::ALL.map(|situation| (car, situation)))
                    .flat_map(|(car, situation)| {
                        let curve = self.curve(&label, situation, car);
                        REPORTED_S.map(|t| reported(curve.map_or(f64::NAN, |curve| curve.at(t))))
                    })
                    .map(|sd| format!("<td>{}</td>", if sd == "-" { "–".to_owned() } else { escape(&sd) }))
                    .collect();
                format!("<tr><td><b>{}</b> {}</td>{cells}</tr>", escape(&label), escape(sources.text()))
            })
            .collect();
        format!(
            "<h3>What each source of information allows to know</h3>{}\
             <div class=\"scroll\" tabindex=\"0\"><table class=\"numbers\"><thead><tr><th rowspan=\"3\">sources</th><th colspan=\"6\">car known</th><th colspan=\"6\">car uncertain</th></tr>\
             <tr><th colspan=\"3\">constant</th><th colspan=\"3\">after a loss</th><th colspan=\"3\">constant</th><th colspan=\"3\">after a loss</th></tr>\
             <tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>{}",
            self.conditions_text(),
            self.lesson_text()
        )
    }

    pub(crate) fn conditions_text(&self) -> String {
        let c = &self.conditions;
        format!(
            "<p>Least standard deviation of the pressure in kPa for any unbiased estimator (Cramer-Rao), for each source alone and together; a dash is \
             nothing at all. <i>Constant</i>: {:.1} kPa since the start. <i>After a loss</i>: {:.0} s at that pressure, then {:.1} kPa. \
             Road Gd(n0) {:.1e} m³, slope {:.2}, {:.0} km/h, noise {} m/s² at {:.0} Hz, {:.0} to {:.0} Hz. \
             (b′) has an unsprung mass of {:.1} instead of {:.1} kg{}; (c) repeats every {} s; (d) is right to {:.1} kPa. \
             <i>Car uncertain</i>: unsprung mass known to 1 %, sprung mass 15 %, damping 20 %, spring 5 %.</p>",
            c.placard_kpa,
            c.before_s,
            c.pressure_after_kpa,
            c.road_level_m3,
            c.road_slope,
            c.speed_km_h,
            c.noise_m_s2,
            c.rate_hz,
            c.band_hz.0,
            c.band_hz.1,
            c.unsprung_masses_kg.1,
            c.unsprung_masses_kg.0,
            if c.unlike_is_made_up { " (made up: the vehicle's corners are alike)" } else { "" },
            c.period_s,
            c.reset_sd_kpa
        )
    }

    /// What follows from the bounds, as a paragraph of HTML.
    pub(crate) fn lesson_text(&self) -> String {
        "<p>The road's spectrum (a) gives the absolute pressure, slowly: the limit is the randomness of the road. Wheels that share a road (b), and a \
             wheel with its own past (c), compare; they are as sharp as the sensors, but corners alike with the same pressure compare to nothing. A reset (d) does not see a \
             loss; it tells what the car's file does not know. With a car known as well as its file is, one per cent of unsprung mass is one per cent of \
             stiffness, and that is the floor of everything but a reset.</p>"
            .to_owned()
    }

    fn circumstances(&self) -> String {
        format!("<h3>Over speed, damping, noise and tracks</h3>{}", self.circumstances_text())
    }

    pub(crate) fn circumstances_text(&self) -> String {
        "<p>Speed and noise hardly matter to the road's spectrum (a), which is far louder than the sensors; the damper does, through the width of the \
         wheel-hop resonance. For wheels that compare (b, c) it is the other way round: more speed is more road and less noise is a better comparison. \
         All that holds for a road that is quite common. A rear wheel beside the front's track meets a road of which a share is its own, and that share is noise \
         far above the sensors': at one per cent it is what limits (b).</p>"
            .to_owned()
    }
}

fn framed(figure: &Figure) -> String {
    format!("<figure>{}<figcaption>{}</figcaption></figure>", figure.html(), escape(figure.title()))
}
