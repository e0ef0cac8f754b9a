//! All corners as one HTML page: style and pictures inside, nothing loaded. Called by the binary.

use std::fmt::Write as _;

use super::CornerCheck;
use crate::plot::{Axis, Figure, Ink, Panel, Stroke, escape};

const STYLE: &str = include_str!("../observability/page.css");

/// The page about one drive of one vehicle.
#[must_use]
pub fn page(vehicle: &str, log: &str, corners: &[CornerCheck]) -> String {
    let title = format!("Suspension of “{}” in {}", escape(vehicle), escape(log));
    let mut body = String::from(
        "<p>How the body answers each wheel: acceleration of the body over that of the wheel, as measured and as the vehicle file's mass, \
         spring and damper say. The band holds the file's parameters within a standard deviation. Neither road nor tire nor unsprung mass enter. \
         The four corners share one body, so a corner of a whole car lies within some ten per cent of its own curve.</p>\n",
    );
    for check in corners {
        let _ = write!(
            body,
            "<h3>{}</h3>\n<p>{}.</p>\n{}<figure>{}</figure>\n",
            escape(&named(&check.label)),
            escape(&check.sentence()),
            fit(check),
            figure(check).html()
        );
    }
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <title>{title}</title><style>{STYLE}</style></head>\n<body><main><h1>{title}</h1>\n{body}</main></body></html>\n"
    )
}

/// How well body and wheel go together, in words; what does not.
fn fit(check: &CornerCheck) -> String {
    let Some((fit, _)) = &check.fit else { return String::new() };
    let share = |value: Option<f64>, of: &str| value.map(|value| format!("{:.0} % {of}", 100.0 * value));
    let parts = [
        share(fit.incoherence, "of the body's acceleration do not go with this wheel's (5 to 16 Hz)"),
        share(fit.unexplained, "are left unexplained by the forces of all four struts (5 to 20 Hz)"),
        fit.hop_excess.map(|times| {
            format!("front and rear differ {times:.1} times as much near wheel hop as beside it")
        }),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    let figures = (!parts.is_empty()).then(|| format!("<p>At the end {}.</p>\n", escape(&parts.join("; "))));
    let misfit = check.misfit().map(|misfit| format!("<p>What does not fit: {}.</p>\n", escape(&misfit)));
    [figures, misfit].into_iter().flatten().collect()
}

/// A corner in words.
pub(crate) fn named(label: &str) -> String {
    let words = match label {
        "fl" => "Front left",
        "fr" => "Front right",
        "rl" => "Rear left",
        "rr" => "Rear right",
        other => return other.to_owned(),
    };
    format!("{words} ({label})")
}

/// Gain and coherence of a corner.
fn figure(check: &CornerCheck) -> Figure {
    let frequency = || Axis::logarithmic("Frequency", "Hz");
    let told = check.told();
    let gain = Panel::new("", "Body over wheel", frequency(), Axis::logarithmic("Gain", ""))
        .band(
            "file, within a standard deviation",
            Ink::Light,
            told.iter().map(|(hz, (_, low, high))| (*hz, *low, *high)).collect(),
        )
        .line("file", Ink::Truth, Stroke::Solid, told.iter().map(|(hz, (gain, _, _))| (*hz, *gain)).collect())
        .dots("measured", Ink::Adaptive, check.measured());
    let coherence = Panel::new("", "Coherence", frequency(), Axis::linear("Coherence", "").within(0.0, 1.0))
        .level(Ink::Muted, 0.5, "the body follows this wheel")
        .line("", Ink::Adaptive, Stroke::Solid, check.coherences());
    Figure::new(format!("vehicle-check-{}", check.label), format!("{}: body over wheel", check.label))
        .describe(check.sentence())
        .panel(gain)
        .panel(coherence)
}
