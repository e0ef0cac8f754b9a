//! All corners as one HTML page: style and pictures inside, nothing loaded. Called by the binary.

use std::fmt::Write as _;

use super::{CornerCheck, INCOHERENT, Verdict};
use crate::plot::{Axis, Figure, Ink, Panel, Stroke, escape};

use crate::page::figures_page;

pub fn page(vehicle: &str, log: &str, corners: &[CornerCheck]) -> String {
    let cards: String = corners.iter().map(card).collect();
    let mut body = format!("<div class=\"corners\">{cards}</div>\n");
    body += "<h2>Body over wheel</h2>\n\
         <p>How the body answers each wheel: acceleration of the body over that of the wheel, as measured and as the vehicle file's mass, \
         spring and damper say. The band holds the file's parameters within a standard deviation. Neither road nor tire nor unsprung mass enter. \
         The four corners share one body, so a corner of a whole car lies within some ten per cent of its own curve. Points that are not known to \
         half of themselves are left out.</p>\n";
    for check in corners {
        let _ = write!(
            body,
            "<h3>{}</h3>\n{}<figure>{}</figure>\n",
            escape(&named(&check.label)),
            fit(check),
            figure(check).html()
        );
    }
    figures_page(&format!("Suspension of “{vehicle}” in {log}"), "", body)
}

/// A corner's verdict: by color, in a word and in a sentence.
fn card(check: &CornerCheck) -> String {
    let (class, word) = match (&check.verdict, check.asks_for_change()) {
        (Verdict::Compared { .. }, false) => ("fine", "agrees"),
        (Verdict::Compared { .. }, true) => ("malfunction", "differs"),
        _ => ("unknown", "not judged"),
    };
    format!(
        "<div class=\"card {class}\"><p class=\"card-name\">{}</p><span class=\"badge {class}\">{word}</span>\
         <p class=\"card-foot\">{}.</p></div>",
        escape(&named(&check.label)),
        escape(&check.sentence())
    )
}

/// How well body and wheel go together, in words; what does not.
fn fit(check: &CornerCheck) -> String {
    let Some((fit, _)) = &check.fit else { return String::new() };
    // Forces that are worse than none leave more than all unexplained.
    let percent = |share: f64| (100.0 * share).min(100.0);
    let parts = [
        fit.incoherence.map(|share| {
            format!(
                "{:.0} % of the body's acceleration does not go with this wheel's (5 to 16 Hz)",
                percent(share)
            )
        }),
        fit.unexplained.map(|share| {
            format!(
                "the forces of all four struts leave {:.0} % of it unexplained (5 to 20 Hz)",
                percent(share)
            )
        }),
        fit.hop_excess.map(|times| {
            format!("front and rear differ {times:.1} times as much near wheel hop as beside it")
        }),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    let figures = (!parts.is_empty())
        .then(|| format!("<p>At the end of the drive {}.</p>\n", escape(&parts.join("; "))));
    let misfit = check.misfit().map(|misfit| format!("<p>What does not fit: {}.</p>\n", escape(&misfit)));
    [figures, misfit].into_iter().flatten().collect()
}

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

/// Points that are known to half of themselves: what the coherence leaves open further would look like a value.
fn known(points: Vec<(f64, f64, f64)>) -> Vec<(f64, f64, f64)> {
    points.into_iter().filter(|(_, gain, error)| *error < 0.5 * gain).collect()
}

fn figure(check: &CornerCheck) -> Figure {
    let frequency = || Axis::logarithmic("Frequency", "Hz");
    let of_file = check.of_file();
    let gain = Panel::new("", "Body over wheel", frequency(), Axis::logarithmic("Gain", ""))
        .band(
            "file, within a standard deviation",
            Ink::Light,
            of_file.iter().map(|(hz, (_, low, high))| (*hz, *low, *high)).collect(),
        )
        .line(
            "file",
            Ink::Truth,
            Stroke::Solid,
            of_file.iter().map(|(hz, (gain, _, _))| (*hz, *gain)).collect(),
        )
        .dots("measured", Ink::Adaptive, known(check.measured()));
    let coherence = Panel::new(
        "",
        format!("Coherence, {INCOHERENT} or more expected"),
        frequency(),
        Axis::linear("Coherence", "").within(0.0, 1.0),
    )
    .level(Ink::Muted, INCOHERENT, "")
    .line("", Ink::Adaptive, Stroke::Solid, check.coherences());
    Figure::new(format!("vehicle-check-{}", check.label), format!("{}: body over wheel", check.label))
        .describe(check.sentence())
        .panel(gain)
        .panel(coherence)
}
