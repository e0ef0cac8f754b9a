//! A figure of a drop: what was measured, what the model makes of it, and what is left. Called by the binary.

use super::{BumpFit, BumpResult};
use crate::plot::{Axis, Figure, Ink, Panel, Stroke};

const LETTERS: [&str; 8] = ["a", "b", "c", "d", "e", "f", "g", "h"];

impl BumpResult {
    /// Two panels per corner, with the masses four: body and residual, force on the road and residual.
    pub fn figure(&self) -> Figure {
        let mut figure = Figure::new("identify-bump", "Spring, damper, friction and tire from a drop")
            .describe("Measured and fitted motion of each corner below 16 Hz, and what is left.")
            .columns(2);
        let mut letters = LETTERS.iter().cycle();
        let mut letter = || letters.next().copied().unwrap_or_default();
        for fit in &self.corners {
            figure = fit.panels(&mut letter).into_iter().fold(figure, Figure::panel);
        }
        figure
    }
}

impl BumpFit {
    fn panels(&self, letter: &mut impl FnMut() -> &'static str) -> Vec<Panel> {
        let body = format!("{}: acceleration of the body", self.label);
        let mut panels = pair(letter, &body, ("Acceleration", "m/s²"), &self.traces.body);
        if !self.traces.tire.is_empty() {
            let tire = format!("{}: force on the road, about its mean", self.label);
            panels.extend(pair(letter, &tire, ("Force", "N"), &self.traces.tire));
        }
        panels
    }
}

/// The measurement with the fit over it, and the residual on an axis of its own.
fn pair(
    letter: &mut impl FnMut() -> &'static str,
    title: &str,
    (quantity, unit): (&str, &str),
    trace: &[(f64, f64, f64)],
) -> Vec<Panel> {
    let time = || Axis::linear("Time", "s");
    let points =
        |value: fn(&(f64, f64, f64)) -> f64| trace.iter().map(|p| (p.0, value(p))).collect::<Vec<_>>();
    let both = Panel::new(letter(), title, time(), Axis::linear(quantity, unit))
        .line("measured", Ink::Default, Stroke::Solid, points(|p| p.1))
        .line("fitted", Ink::Truth, Stroke::Dashed, points(|p| p.2));
    let left = Panel::new(letter(), "What is left", time(), Axis::linear(quantity, unit))
        .level(Ink::Truth, 0.0, "")
        .line("", Ink::Default, Stroke::Solid, points(|p| p.1 - p.2));
    vec![both, left]
}
