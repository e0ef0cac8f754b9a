//! A test as a figure: true and estimated pressures, when something went wrong, and when the tell-tale came on.

use itpms_core::model::Corner;

use super::{Certificate, Outcome};
use itpms_analysis::plot::{Axis, Figure, Ink, Panel, Stroke};

/// One color per wheel, in the order of `Corner::ALL`.
const INKS: [Ink; 4] = [Ink::Default, Ink::Adaptive, Ink::Mended, Ink::Plain];

/// Half the width of a 95 % interval in standard deviations.
const Z_95: f64 = itpms_analysis::report::Z_95;

/// So many s are drawn around what counts.
const BESIDE_S: f64 = 60.0;

impl Certificate {
    pub fn figures(&self) -> Vec<Figure> {
        self.outcomes.iter().map(Outcome::figure).collect()
    }
}

impl Outcome {
    /// Pressures of all wheels over time.
    pub fn figure(&self) -> Figure {
        let minutes = |s: f64| s / 60.0;
        let (from_s, to_s) = self.drawn_s();
        let time = Axis::linear("Time since the reset", "min").within(minutes(from_s), minutes(to_s));
        let mut panel =
            Panel::new("", self.what.clone(), time, Axis::linear("Pressure", "kPa")).height(300.0);
        let shown = self.shown();
        for (i, (corner, ink)) in Corner::ALL.into_iter().zip(INKS).enumerate() {
            if shown == Some(i) {
                let band = self.trace.iter().filter(|p| p.estimate_kpa[i].is_finite()).map(|p| {
                    let half = Z_95 * p.sd_kpa[i];
                    (minutes(p.time_s), p.estimate_kpa[i] - half, p.estimate_kpa[i] + half)
                });
                panel = panel.band(format!("{}: 95 % interval", corner.label()), ink, band.collect());
            }
        }
        for (i, (corner, ink)) in Corner::ALL.into_iter().zip(INKS).enumerate() {
            let line = self.trace.iter().map(|p| (minutes(p.time_s), p.estimate_kpa[i])).collect();
            panel = panel.line(format!("{} estimated", corner.label()), ink, Stroke::Solid, line);
        }
        if let Some(i) = shown {
            let line = self.trace.iter().map(|p| (minutes(p.time_s), p.truth_kpa[i])).collect();
            panel = panel.line(format!("{} true", Corner::ALL[i].label()), Ink::Truth, Stroke::Dashed, line);
        }
        let word = if self.test_kpa.is_some() { "let down" } else { "fault" };
        panel = panel.moment(Ink::Muted, minutes(self.wrong_at_s), word);
        if let Some(warned_at_s) = self.warned_at_s {
            panel = panel.moment(Ink::Adaptive, minutes(warned_at_s), "warned");
        }
        Figure::new(self.name.clone(), format!("{}, {}", self.rule.label(), self.what))
            .columns(1)
            .describe(
                "Pressures over time: true, estimated with its 95 % interval, and the moment of the warning.",
            )
            .panel(panel)
    }

    /// From the end of the learning phase until a little after the tell-tale, or to the end; in s.
    fn drawn_s(&self) -> (f64, f64) {
        let end_s = self.trace.iter().map(|point| point.time_s).fold(self.wrong_at_s, f64::max);
        let to_s = self.warned_at_s.map_or(end_s, |at_s| (at_s + BESIDE_S).min(end_s));
        ((self.wrong_at_s - 3.0 * BESIDE_S).max(0.0), to_s)
    }

    /// The wheel whose truth and interval are drawn: the first of those that were let down.
    fn shown(&self) -> Option<usize> {
        let first = self.low_wheels.split(' ').next()?;
        Corner::ALL.into_iter().position(|corner| corner.label() == first)
    }
}
