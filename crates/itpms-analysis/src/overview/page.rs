//! A log as one HTML page: style and pictures inside, nothing loaded. Called by the binary.

use std::fmt::Write as _;

use super::{Found, FoundCorner, FoundWheels, Statistics};
use crate::plot::{Axis, Figure, Ink, Panel, Stroke, escape};
use crate::transfer::{Density, INCOHERENT, named};

use crate::page::figures_page;

/// Where spectra are shown, in Hz: below, drifts of the sensors; above, no suspension.
const SHOWN_HZ: (f64, f64) = (0.5, 100.0);

/// From how many usual steps on a longest one makes the axis of the steps logarithmic.
const FEW_STEPS: f64 = 5.0;

/// How far the axis of the spectra goes beyond the highest of them, as a factor.
const ROOM: f64 = 8.0;

impl Found {
    pub fn page(&self, log: &str) -> String {
        let mut body = format!("<p>{}</p>\n", escape(&self.summary()));
        let doubts = self.doubts();
        let (class, verdict) = if doubts.is_empty() {
            ("fine", "Nothing looks wrong")
        } else {
            ("malfunction", "What looks wrong")
        };
        let items: String = doubts.iter().map(|doubt| format!("<li>{}.</li>", escape(doubt))).collect();
        let list = if doubts.is_empty() { String::new() } else { format!("<ul>{items}</ul>") };
        let _ =
            writeln!(body, "<div class=\"card {class}\"><p class=\"card-name\">{verdict}</p>{list}</div>");
        body += &self.table();
        let _ = write!(body, "<h2>Speed and rows</h2>\n<figure>{}</figure>\n", self.drive().html());
        if let Some(wheels) = &self.wheels {
            let _ = write!(
                body,
                "<h2>Wheel speeds</h2>\n<p>{}</p>\n<figure>{}</figure>\n",
                escape(&wheels.summary()),
                wheels.figure().html()
            );
        }
        for corner in &self.corners {
            let _ = write!(
                body,
                "<h2>{}</h2>\n<p>{}</p>\n<figure>{}</figure>\n",
                escape(&named(corner.label)),
                escape(&corner.summary()),
                corner.figure(self.step_s).html()
            );
        }
        figures_page(&format!("Signals of {log}"), "", body)
    }

    pub fn summary(&self) -> String {
        format!(
            "{} rows in {:.1} s, usually {:.3} ms apart ({:.1} Hz).",
            self.rows,
            self.span_s.1 - self.span_s.0,
            1e3 * self.step_s,
            1.0 / self.step_s
        )
    }

    fn table(&self) -> String {
        let mut rows = String::new();
        let mut row = |name: &str, unit: &str, statistics: &Statistics| {
            let _ = write!(rows, "<tr><td>{}</td>{}</tr>", escape(name), cells(unit, statistics));
        };
        if let Some(speed) = &self.speed {
            row("speed", "m/s", speed);
        }
        for (name, unit, statistics) in self.wheels.iter().flat_map(FoundWheels::signals) {
            row(&name, unit, statistics);
        }
        for corner in &self.corners {
            row(&format!("{}, body acceleration", corner.label), "m/s²", &corner.body);
            row(&format!("{}, wheel acceleration", corner.label), "m/s²", &corner.wheel);
            if let Some(pressure) = &corner.pressure {
                row(&format!("{}, pressure", corner.label), "kPa", pressure);
            }
            if let Some(road) = &corner.road {
                row(&format!("{}, road height", corner.label), "m", road);
            }
        }
        format!(
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Signals\"><table class=\"numbers\"><thead><tr><th class=\"words\">signal</th><th class=\"words\">unit</th><th>values</th><th>missing</th>\
             <th>mean</th><th>standard<br>deviation</th><th>lowest</th><th>highest</th><th>smallest<br>step</th></tr></thead>\
             <tbody>{rows}</tbody></table></div>\n"
        )
    }

    fn drive(&self) -> Figure {
        let time = || Axis::linear("Time", "s");
        let speed = Panel::new("", "Speed", time(), Axis::linear("Speed", "m/s").holding(0.0)).line(
            "",
            Ink::Default,
            Stroke::Solid,
            self.speeds.clone(),
        );
        // Steps of one length are a line at that length; gaps are of any, and take decades.
        let usual_ms = 1e3 * self.step_s;
        let longest_ms = self.steps.iter().map(|step| step.1).fold(usual_ms, f64::max);
        let step = if longest_ms < FEW_STEPS * usual_ms {
            Axis::linear("Time step", "ms").holding(0.0).holding(1.2 * longest_ms)
        } else {
            Axis::logarithmic("Time step, logarithmic", "ms").holding(0.5 * usual_ms)
        };
        let steps = Panel::new("", "Time from row to row, longest of each stretch", time(), step).line(
            "",
            Ink::Default,
            Stroke::Solid,
            self.steps.clone(),
        );
        let figure = Figure::new("log-drive", "Speed and rows").describe(self.summary());
        let figure = if self.speed.is_some() { figure.panel(speed) } else { figure };
        figure.panel(steps)
    }
}

impl FoundCorner {
    /// Coherence and hop in a sentence.
    pub fn summary(&self) -> String {
        let Some(hop_hz) = self.hop_hz else {
            return "No two seconds without a gap: no spectrum.".to_owned();
        };
        format!(
            "Coherence of body and wheel {:.2} on average between 4 and 16 Hz; the wheel's spectrum between 8 and 20 Hz is highest at {hop_hz:.1} Hz; {} segments of 2 s.",
            self.coherence, self.segments
        )
    }

    fn figure(&self, step_s: f64) -> Figure {
        let mut figure = Figure::new(format!("log-{}", self.label), named(self.label))
            .describe(self.summary())
            .panel(self.course())
            .panel(self.liveliest())
            .panel(self.densities(step_s))
            .panel(self.coherences(step_s));
        let time = || Axis::linear("Time", "s");
        if self.pressure.is_some() {
            let panel = Panel::new("", "Pressure in the log", time(), Axis::linear("Pressure", "kPa"));
            figure = figure.panel(panel.line("", Ink::Truth, Stroke::Solid, self.tracks.pressure.clone()));
        }
        if self.road.is_some() {
            let panel = Panel::new("", "Road in the log", time(), Axis::linear("Height", "m"));
            figure = figure.panel(panel.line("", Ink::Truth, Stroke::Solid, self.tracks.road.clone()));
        }
        figure
    }

    fn course(&self) -> Panel {
        let axis = Axis::linear("Acceleration", "m/s²");
        let t = &self.tracks;
        Panel::new("", "Whole log", Axis::linear("Time", "s"), axis)
            .band("wheel, lowest to highest", Ink::Light, t.wheel.clone())
            .band("body, lowest to highest", Ink::Adaptive, t.body.clone())
            .line("wheel", Ink::Default, Stroke::Solid, vec![])
            .line("body", Ink::Adaptive, Stroke::Solid, vec![])
            .line("wheel, rms about its mean", Ink::Default, Stroke::Dashed, t.wheel_rms.clone())
            .line("body, rms about its mean", Ink::Adaptive, Stroke::Dashed, t.body_rms.clone())
    }

    fn liveliest(&self) -> Panel {
        let side = |pick: fn(&(f64, f64, f64)) -> f64| {
            self.excerpt.iter().map(|row| (row.0, pick(row))).collect::<Vec<_>>()
        };
        Panel::new(
            "",
            "The two seconds in which the wheel moves most",
            Axis::linear("Time", "s"),
            Axis::linear("Acceleration", "m/s²"),
        )
        .line("", Ink::Default, Stroke::Solid, side(|row| row.2))
        .line("", Ink::Adaptive, Stroke::Solid, side(|row| row.1))
    }

    fn densities(&self, step_s: f64) -> Panel {
        // Room above the highest for the word at the wheel's hop.
        let top = self.lines.iter().map(|line| line.wheel).fold(0.0, f64::max);
        let density = Axis::logarithmic("Power spectral density", "m²/s⁴/Hz").holding(ROOM * top);
        let side = |pick: fn(&Density) -> f64| {
            self.lines.iter().map(|line| (line.hz, pick(line))).collect::<Vec<_>>()
        };
        let panel = Panel::new("", "Spectra", frequency(step_s), density)
            .line("", Ink::Default, Stroke::Solid, side(|line| line.wheel))
            .line("", Ink::Adaptive, Stroke::Solid, side(|line| line.body));
        match self.hop_hz {
            Some(hz) => panel.moment(Ink::Muted, hz, format!("{hz:.1} Hz")),
            None => panel,
        }
    }

    fn coherences(&self, step_s: f64) -> Panel {
        let coherence = self.lines.iter().map(|line| (line.hz, line.coherence)).collect();
        Panel::new(
            "",
            format!("Coherence, {INCOHERENT} or more expected"),
            frequency(step_s),
            Axis::linear("Coherence", "").within(0.0, 1.0),
        )
        .level(Ink::Muted, INCOHERENT, "")
        .line("coherence", Ink::Mended, Stroke::Solid, coherence)
    }
}

fn frequency(step_s: f64) -> Axis {
    Axis::logarithmic("Frequency", "Hz").within(SHOWN_HZ.0, SHOWN_HZ.1.min(0.5 / step_s))
}

fn cells(unit: &str, s: &Statistics) -> String {
    let numbers = [s.mean, s.sd, s.low, s.high, s.smallest_step].map(|value| {
        if value.is_finite() { format!("<td>{}</td>", figures(value)) } else { "<td>–</td>".to_owned() }
    });
    format!("<td class=\"words\">{unit}</td><td>{}</td><td>{}</td>{}", s.samples, s.missing, numbers.concat())
}

fn figures(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-9..1e9).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let decimals = (3 - value.abs().log10().floor() as i32).clamp(0, 9);
    format!("{value:.*}", decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::super::tests::minute;

    #[test]
    fn the_page_is_complete_in_itself_and_takes_no_markup_from_names() {
        let page = minute(0.2, |_, _| {}).page("<script>alert(1)</script>.csv");
        assert!(!page.contains("<script>alert"), "markup from a name");
        assert!(!page.contains("href=") && !page.contains("src="));
        assert_eq!(page.matches("<svg xmlns").count(), 6);
        for word in
            ["12000 rows in 60.0 s", "Power spectral density (m²/s⁴/Hz)", "Nothing looks wrong", "12.0 Hz"]
        {
            assert!(page.contains(word), "{word}");
        }
    }

    #[test]
    fn numbers_have_four_figures() {
        let all = [0.0, 1.0, -0.012345, 12345.6].map(super::figures);
        assert_eq!(all, ["0", "1.000", "-0.01235", "12346"]);
    }
}
