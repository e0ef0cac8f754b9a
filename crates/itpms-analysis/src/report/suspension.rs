//! Dampers and load on the page: a card for each damper where it sits, what an axle's two are to each other, and what the axles carry; one
//! quiet line with the reason where nothing is known.
//!
//! Called by the page's writer.

use std::fmt::Write as _;

use itpms_core::model::Corner;

use super::ReportData;
use super::words::corner_name;
use crate::page::whole_percent;
use crate::rotation::OncePerTurn;
use crate::suspension::{
    Because, DamperHealth, DamperState, Load, LoadState, Masses, Measured, SuspensionVerdict,
};

/// The section; empty where a car has fewer than four corners.
pub(super) fn section(data: &ReportData) -> String {
    let Some(verdict) = &data.suspension else {
        // A car with all its wheels shows the reason; a test bed nothing.
        let all = data.corners.len() > 1 && data.corners.len() + data.not_estimated.len() == 4;
        return if all {
            quiet("not looked at: it takes the accelerations of all four corners.")
        } else {
            String::new()
        };
    };
    let judged =
        |damper: &DamperHealth| !matches!(damper.state, DamperState::Unknown | DamperState::Learning);
    if verdict.load.masses.is_none() && !verdict.dampers.iter().any(judged) {
        return quiet(&not_judged(verdict));
    }
    let mut out = format!(
        "<section id=\"suspension\"><h2>Dampers and load</h2><p class=\"verdict\">{}</p><div class=\"struts\">\n",
        summary(verdict)
    );
    for (corner, damper) in Corner::ALL.into_iter().zip(&verdict.dampers) {
        damper_card(&mut out, corner, damper);
    }
    for (at, name) in [(0, "front"), (2, "rear")] {
        let _ = writeln!(out, "<p class=\"axle at-{name}\">{}</p>", axle(name, &verdict.dampers[at]));
    }
    load_card(&mut out, &verdict.load);
    let _ = writeln!(out, "</div>{}</section>", axles_apart(&verdict.dampers));
    out
}

/// Forces once per wheel turn, a row each; empty where none exceeds the road's.
pub(super) fn once_per_turn(data: &ReportData) -> String {
    let measured = |of: Option<Measured>| {
        of.map_or_else(|| "–".to_owned(), |of| format!("{:.0} ± {:.0}", of.value, of.sd))
    };
    let row = |(corner, one): (Corner, &Option<OncePerTurn>)| {
        let one = one.as_ref().filter(|one| one.force_n.is_some())?;
        let turns = one.at_rad_per_s / std::f64::consts::TAU;
        let rise = measured(one.rise.map(|(rise, _)| rise));
        let name = corner_name(corner);
        Some(format!(
            "<tr><th scope=\"row\">{name}</th><td>{}</td><td>{turns:.1}</td><td>{}</td><td>{rise}</td></tr>\n",
            measured(one.force_n),
            measured(one.imbalance_g)
        ))
    };
    let rows: Vec<String> = Corner::ALL.into_iter().zip(&data.once_per_turn).filter_map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    format!(
        "<section id=\"rotation\"><h2>What turns with the wheels</h2><div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Forces once per turn\"><table class=\"numbers\"><thead><tr><th scope=\"col\" class=\"words\">Wheel</th>\
         <th scope=\"col\">Force once per turn, N</th><th scope=\"col\">At turns per s</th><th scope=\"col\">Imbalance, g at 0.2 m</th><th scope=\"col\">Risen in this drive, N</th></tr></thead><tbody>\n{}</tbody></table></div>\
         <p class=\"note\">Amplitude of the force on the wheel, from an imbalance and a tire that is not round together; the imbalance alone is known where the speed was swept.</p></section>\n",
        rows.concat()
    )
}

fn quiet(text: &str) -> String {
    format!("<p class=\"note\" id=\"suspension\">Dampers and load: {text}</p>\n")
}

/// Why nothing is judged, and what left and right are to each other where that is known all the same.
fn not_judged(verdict: &SuspensionVerdict) -> String {
    let why = |because: Option<Because>| because.map_or("nothing was read", Because::text);
    let (dampers, load) = (verdict.dampers[0].because, verdict.load.because);
    let mut out = match dampers == load {
        true => format!("not judged: {}.", why(dampers)),
        false => format!("dampers are not judged: {}; load is not known: {}.", why(dampers), why(load)),
    };
    for (at, name) in [(0, "front"), (2, "rear")] {
        if let Some(left_right) = verdict.dampers[at].left_right {
            let _ = write!(out, " {}.", left_against_right(name, left_right));
        }
    }
    out
}

/// Most important findings, in sentences.
fn summary(verdict: &SuspensionVerdict) -> String {
    let of = |states: &[DamperState]| {
        let corners = Corner::ALL.into_iter().zip(&verdict.dampers);
        let found: Vec<String> = corners
            .filter(|(_, damper)| states.contains(&damper.state))
            .map(|(corner, _)| corner_name(corner).to_lowercase())
            .collect();
        found
    };
    let (less, more) = (of(&[DamperState::Weak, DamperState::Worn]), of(&[DamperState::Stiff]));
    let mut text = Vec::new();
    for (dampers, does) in [(&less, "less"), (&more, "more")] {
        match &dampers[..] {
            [] => {}
            [one] => text.push(format!("The {one} damper damps {does} than it should.")),
            all => text.push(format!("The dampers {} damp {does} than they should.", all.join(", "))),
        }
    }
    match (less.len() + more.len(), of(&[DamperState::Fine]).len()) {
        (0, 4) => text.push("All four dampers do what they did in the calibration drive.".to_owned()),
        (0, _) => {}
        (1, _) => text.push("If further drives say the same, have it looked at.".to_owned()),
        (_, _) => text.push("If further drives say the same, have them looked at.".to_owned()),
    }
    for (over, name) in verdict.load.overloaded_axles().into_iter().zip(["front", "rear"]) {
        if over {
            text.push(format!("<b>The {name} axle carries more than it may.</b>"));
        }
    }
    text.join(" ")
}

/// Name of the style and of the badge's sign.
fn class(state: DamperState) -> &'static str {
    match state {
        DamperState::Learning | DamperState::Unknown => "unknown",
        state => state.label(),
    }
}

fn word(state: DamperState) -> &'static str {
    match state {
        DamperState::Learning => "Learning",
        DamperState::Fine => "Fine",
        DamperState::Weak => "Weak",
        DamperState::Worn => "Worn",
        DamperState::Stiff => "Stiff",
        DamperState::Unknown => "Unknown",
    }
}

/// `49 ± 3`, with no-break spaces.
fn with_sd(measured: Measured, places: usize) -> String {
    format!("{:.places$}\u{a0}±\u{a0}{:.places$}", measured.value, measured.sd)
}

fn percent(share: Measured) -> Measured {
    Measured { value: 100.0 * share.value, sd: 100.0 * share.sd }
}

fn finite(measured: Option<Measured>) -> Option<Measured> {
    measured.filter(|measured| measured.value.is_finite() && measured.sd.is_finite())
}

fn damper_card(out: &mut String, corner: Corner, damper: &DamperHealth) {
    let class = class(damper.state);
    let _ = write!(
        out,
        "<div class=\"card {class} at-{id}\"><p class=\"card-name\">{name}</p><span class=\"badge {class}\">{word}</span>",
        id = corner.label(),
        name = corner_name(corner),
        word = word(damper.state),
    );
    if let Some(over) = finite(damper.over_reference).map(percent) {
        let _ = write!(
            out,
            "<p class=\"card-number\">{:.0}\u{a0}%<small>±\u{a0}{:.0}\u{a0}% of the calibration’s</small></p>\
             <span class=\"gauge\" aria-hidden=\"true\"><i class=\"gauge-fill w{}\"></i><i class=\"gauge-mark\"></i></span>",
            over.value,
            over.sd,
            whole_percent(0.8 * over.value),
        );
    }
    if let Some(because) = damper.because {
        let _ = write!(out, "<p class=\"card-foot\">{}</p>", because.text());
    }
    let damping = finite(damper.damping_n_s_per_m)
        .map_or_else(String::new, |damping| format!("<span>{}\u{a0}N\u{a0}s/m</span>", with_sd(damping, 0)));
    let ratio = finite(damper.wheel_damping_ratio).map_or_else(String::new, |ratio| {
        format!("<span>wheel’s damping ratio {}</span>", with_sd(ratio, 2))
    });
    let _ = writeln!(out, "<p class=\"card-foot\">{damping}{ratio}</p></div>");
}

/// The two dampers of an axle compared; `damper`: its left one.
fn axle(name: &str, damper: &DamperHealth) -> String {
    match finite(damper.left_right) {
        Some(left_right) => format!("{}.", left_against_right(name, left_right)),
        None => format!("{}: left and right were not compared.", capital(name)),
    }
}

/// `Rear axle: left damps 49 ± 2 % less than right`, without its full stop.
fn left_against_right(name: &str, left_right: Measured) -> String {
    let share = percent(left_right);
    let size = with_sd(Measured { value: share.value.abs(), sd: share.sd }, 0);
    let axle = capital(name);
    match share.value.abs() < 2.0 * share.sd {
        true => format!("{axle}: left and right are alike, {size}\u{a0}% apart"),
        false => {
            let does = if share.value < 0.0 { "less" } else { "more" };
            format!("{axle}: left damps {size}\u{a0}% {does} than right")
        }
    }
}

fn capital(name: &str) -> &'static str {
    if name == "front" { "Front axle" } else { "Rear axle" }
}

/// What front and rear are to each other, where the dampers of each axle are in one state: of an axle with one that is worn it says nothing new.
fn axles_apart(dampers: &[DamperHealth; 4]) -> String {
    let is_alike = dampers[0].state == dampers[1].state && dampers[2].state == dampers[3].state;
    let Some(front_rear) = finite(dampers[0].front_rear).filter(|_| is_alike) else { return String::new() };
    let share = percent(front_rear);
    let size = with_sd(Measured { value: share.value.abs(), sd: share.sd }, 0);
    let text = match share.value.abs() < 2.0 * share.sd {
        true => format!("Front and rear have changed alike since the calibration, {size}\u{a0}% apart."),
        false => {
            let does = if share.value < 0.0 { "less" } else { "more" };
            format!("The front axle damps {size}\u{a0}% {does} than the rear one, against the calibration.")
        }
    };
    format!("<p class=\"note\">{text}</p>")
}

fn load_card(out: &mut String, load: &Load) {
    let (class, word) = match load.state {
        LoadState::Known => ("fine", "Known"),
        LoadState::Overload => ("overload", "Overload"),
        LoadState::Learning => ("unknown", "Learning"),
        LoadState::Unknown => ("unknown", "Unknown"),
    };
    let _ = write!(
        out,
        "<div class=\"card {class} at-load\"><p class=\"card-name\">Load</p><span class=\"badge {class}\">{word}</span>"
    );
    match &load.masses {
        Some(masses) => carried(out, load, masses),
        None => {
            let why = load.because.map_or("nothing was read", Because::text);
            let _ = write!(out, "<p class=\"card-foot\">{why}</p>");
        }
    }
    out.push_str("</div>\n");
}

fn carried(out: &mut String, load: &Load, masses: &Masses) {
    let Masses { axles_kg, total_kg, added_kg } = masses;
    let _ = write!(
        out,
        "<p class=\"card-number\">{:.0}\u{a0}kg<small>±\u{a0}{:.0} in all</small></p>\
         <p class=\"card-foot\">{}</p>",
        total_kg.value,
        total_kg.sd,
        match added_kg.value < 0.0 {
            true => format!(
                "{:.0}\u{a0}±\u{a0}{:.0}\u{a0}kg less than in the calibration drive",
                -added_kg.value, added_kg.sd
            ),
            false => format!("{}\u{a0}kg more than in the calibration drive", with_sd(*added_kg, 0)),
        },
    );
    let most = axles_kg[0].value.max(axles_kg[1].value);
    for (i, name) in ["Front axle", "Rear axle"].into_iter().enumerate() {
        let limit = load.gross_axle_kg.map(|limits| limits[i]);
        let over = load.overloaded_axles()[i];
        // The bar's full length is the permitted load, or else the heavier axle's load; the mark is the permitted load.
        let share = axles_kg[i].value / limit.unwrap_or(most);
        let mark = if limit.is_some() { "<i class=\"gauge-mark\"></i>" } else { "" };
        let may = limit.map_or_else(String::new, |limit| format!("<span>of {limit:.0}\u{a0}kg</span>"));
        let _ = write!(
            out,
            "<p class=\"card-foot axle-load{}\"><span>{name} <b>{}\u{a0}kg</b></span>{may}</p>\
             <span class=\"gauge{}\" aria-hidden=\"true\"><i class=\"gauge-fill w{}\"></i>{mark}</span>",
            if over { " overload" } else { "" },
            with_sd(axles_kg[i], 0),
            if over { " low" } else { "" },
            whole_percent(80.0 * share),
        );
    }
}
