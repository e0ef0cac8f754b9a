//! Results of wheel speeds over a drive: relative changes of the radii since the calibration, the losses that follow, and what cannot be
//! seen. Collected in bounded memory, written as a section of the page.

use std::fmt::Write as _;

use itpms_core::model::{Corner, Wheels};
use itpms_core::warning::{Cause, WheelState};
use itpms_core::wheel_speed::{RadiusReport, RadiusState, WheelRadius};
use serde_json::{Value, json};

use super::digits::{axis, values};
use super::track::{Keep, Track};
use super::words::{clock, corner_name};
use super::{AlertSpan, ReportData, Z_95};
use crate::plot::escape;

/// Buckets of every curve, and the finest of them in s: half a second is a block of the analysis.
const BUCKETS: usize = 1000;
const FINEST_S: f64 = 0.5;
/// Curves of a wheel: change, loss, each with the edges of its band.
const PER_WHEEL: usize = 6;
const DIFFERENCES: usize = 4 * PER_WHEEL;
const CHANNELS: usize = DIFFERENCES + 3 * 3;

/// A value over time with its 95 % band.
#[derive(Debug, Clone, Default)]
pub struct BandCurve {
    pub value: Vec<f64>,
    /// Lower and upper edge.
    pub band: [Vec<f64>; 2],
}

#[derive(Debug, Clone)]
pub struct WheelSpeedReport {
    pub time_s: Vec<f64>,
    /// Change of each rolling radius since the calibration in thousandths, in the order of [`Corner::ALL`].
    pub change_1e3: [BandCurve; 4],
    /// Share of its pressure that each tire has lost, in per cent.
    pub lost_percent: [BandCurve; 4],
    /// Change of the ratios of the radii in thousandths: front left over right, rear left over right, front over rear.
    pub difference_1e3: [BandCurve; 3],
    pub last: RadiusReport<f64>,
}

#[derive(Debug)]
pub(super) struct WheelSpeedCollector {
    track: Track,
    last: Option<RadiusReport<f64>>,
}

impl WheelSpeedCollector {
    pub(super) fn new() -> Self {
        Self { track: Track::new(CHANNELS, FINEST_S, BUCKETS), last: None }
    }

    pub(super) fn push(&mut self, time_s: f64, radii: &RadiusReport<f64>) {
        let mut row = [f64::NAN; CHANNELS];
        let band = |cells: &mut [f64], value: f64, sd: f64, lowest: f64| {
            cells.copy_from_slice(&[value, (value - Z_95 * sd).max(lowest), value + Z_95 * sd]);
        };
        for (wheel, cells) in radii.wheels.iter().zip(row.chunks_exact_mut(PER_WHEEL)) {
            if !wheel.change.is_finite() {
                continue;
            }
            band(&mut cells[..3], 1e3 * wheel.change, 1e3 * wheel.change_sd, f64::NEG_INFINITY);
            band(&mut cells[3..], 100.0 * wheel.lost_share, 100.0 * wheel.lost_share_sd, 0.0);
        }
        let pairs = radii.difference.iter().zip(&radii.difference_sd);
        for ((value, sd), cells) in pairs.zip(row[DIFFERENCES..].chunks_exact_mut(3)) {
            band(cells, 1e3 * value, 1e3 * sd, if value.is_nan() { f64::NAN } else { f64::NEG_INFINITY });
        }
        self.track.push(time_s, &row);
        self.last = Some(*radii);
    }

    pub(super) fn finish(self, origin_s: f64) -> Option<WheelSpeedReport> {
        let (track, last) = (self.track, self.last?);
        let curve = |base: usize| BandCurve {
            value: track.curve(base, Keep::Extremes),
            band: [track.curve(base + 1, Keep::Lowest), track.curve(base + 2, Keep::Highest)],
        };
        Some(WheelSpeedReport {
            time_s: track.x().into_iter().map(|time_s| time_s - origin_s).collect(),
            change_1e3: std::array::from_fn(|i| curve(i * PER_WHEEL)),
            lost_percent: std::array::from_fn(|i| curve(i * PER_WHEEL + 3)),
            difference_1e3: std::array::from_fn(|i| curve(DIFFERENCES + 3 * i)),
            last,
        })
    }
}

/// The result of the wheel speeds, in one sentence without a full stop.
pub fn found(radii: &RadiusReport<f64>) -> String {
    let names = |wheels: itpms_core::model::Wheels| {
        let names: Vec<String> = wheels.iter().map(|corner| corner_name(corner).to_lowercase()).collect();
        names.join(" and ")
    };
    match radii.state {
        RadiusState::Uncalibrated => {
            "nothing was calibrated, so no wheel's speed is compared with anything".to_owned()
        }
        RadiusState::Calibrating => "the calibration is not over".to_owned(),
        RadiusState::Uninformed => {
            "a tire that has lost 30 % would not show: too little was driven since the calibration with all four speeds in order, or loads may have changed".to_owned()
        }
        RadiusState::NoneDiffers => "no tire differs from the others since the calibration".to_owned(),
        RadiusState::Low(wheels) if wheels.iter().count() == 4 => {
            "all four tires have lost air since the calibration".to_owned()
        }
        RadiusState::Low(wheels) => {
            let one = wheels.iter().count() == 1;
            let verb = if one { "tire differs from the others" } else { "tires differ from the others" };
            format!("the {} {verb} since the calibration", names(wheels))
        }
        RadiusState::OneOf(wheels) if wheels.iter().count() == 4 => {
            "one of the tires differs from the others since the calibration; which one, is unknown".to_owned()
        }
        RadiusState::OneOf(wheels) => {
            let either: Vec<String> = wheels.iter().map(|c| corner_name(c).to_lowercase()).collect();
            format!("one of the tires differs from the others since the calibration: {}", either.join(" or "))
        }
    }
}

/// Limits of the wheel speeds, a sentence each.
pub fn unseen(radii: &RadiusReport<f64>) -> Vec<String> {
    let known = !matches!(radii.state, RadiusState::Uncalibrated | RadiusState::Calibrating);
    let mut out = Vec::new();
    if !known || radii.unseen.all_alike {
        out.push(
            "What all four tires lose alike is not seen, nor the level of any pressure: wheel speeds show differences since the calibration."
                .to_owned(),
        );
    }
    let named = match radii.state {
        RadiusState::Low(wheels) | RadiusState::OneOf(wheels) => wheels,
        _ => Wheels::NONE,
    };
    let uninformed: Vec<&str> = Corner::ALL
        .into_iter()
        .zip(&radii.wheels)
        .filter(|(corner, wheel)| known && !wheel.informed() && !named.contains(*corner))
        .map(|(corner, _)| corner.label())
        .collect();
    if !uninformed.is_empty() && radii.state != RadiusState::Uninformed {
        out.push(format!("A loss of 30 % of {} alone would not show.", uninformed.join(", ")));
    }
    if known && radii.unseen.which_of_a_diagonal {
        out.push(
            "Without a yaw rate a front tire and the rear one across are hardly distinguishable, and losses below .3 % of the radius are not found."
                .to_owned(),
        );
    }
    if known && radii.unseen.loads {
        out.push(
            "The car has stood since the calibration, so loads may have changed: rear tires, and both of an axle, need a larger loss."
                .to_owned(),
        );
    }
    if known && !radii.unseen.hidden_by_torque.is_empty() {
        out.push(format!(
            "The wheels {} are coupled, by a limited slip or as under torque: which of the two lost air is not seen.",
            radii.unseen.hidden_by_torque
        ));
    }
    if known && radii.unseen.slippery {
        out.push(
            "The driven wheels slip more than at the calibration, as on snow: a loss is reported after five minutes of usable driving."
                .to_owned(),
        );
    }
    out
}

pub fn wheel_line(wheel: &WheelRadius<f64>) -> String {
    if !wheel.change.is_finite() {
        return "not compared with anything".to_owned();
    }
    format!(
        "radius {:+.2} ± {:.2} ‰, lost {:.0} ± {:.0} %; {}",
        1e3 * wheel.change,
        1e3 * wheel.change_sd,
        100.0 * wheel.lost_share,
        100.0 * wheel.lost_share_sd,
        would_show(wheel)
    )
}

/// What would have been found of a wheel that is compared with the others.
pub(super) fn would_show(wheel: &WheelRadius<f64>) -> String {
    match (100.0 * wheel.detectable_loss_share).ceil() {
        percent if percent <= 90.0 => format!("a loss of {percent:.0} % would show"),
        _ => "no loss would show yet".to_owned(),
    }
}

/// The page's title where wheel speeds are all there is: what was warned of, or what is known in the end.
pub(super) fn title(data: &ReportData, wheels: &WheelSpeedReport) -> String {
    let alert = data
        .watch
        .iter()
        .flat_map(|watch| &watch.alerts)
        .find(|span| matches!(span.alert.cause, Cause::Differs { .. } | Cause::SlowLeak(_)));
    let leaks = |span: &&&AlertSpan| matches!(span.alert.cause, Cause::SlowLeak(_));
    let mut text = match alert.as_ref().filter(leaks).and_then(|span| span.alert.wheels.iter().next()) {
        Some(corner) => format!("the {} tire loses air slowly", corner_name(corner).to_lowercase()),
        None => found(&wheels.last),
    };
    if let Some(span) = alert {
        text += &format!("; warned of at {}", clock(span.alert.reported_s));
    }
    text[..1].to_uppercase() + &text[1..]
}

pub(super) fn section(data: &ReportData) -> String {
    let Some(wheels) = &data.wheel_speeds else { return String::new() };
    let mut out = format!(
        "<section id=\"wheel-speeds\"><h2>Wheel speeds</h2><p class=\"verdict\">By the wheel speeds {}.</p>\
         <div class=\"panels\" data-wheels=\"lost\"></div><div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Wheel speeds\"><table class=\"figures\"><thead><tr><td></td>\
         <th scope=\"col\">Radius since the calibration</th><th scope=\"col\">Lost of its pressure</th>\
         <th scope=\"col\">Would have shown</th><th scope=\"col\">State</th></tr></thead><tbody>\n",
        escape(&found(&wheels.last))
    );
    let last = data.watch.as_ref().filter(|_| data.corners.is_empty()).map(|watch| watch.last);
    for (corner, wheel) in Corner::ALL.into_iter().zip(&wheels.last.wheels) {
        let known = wheel.change.is_finite();
        let cell = |text: String| if known { text } else { "–".to_owned() };
        let state = match last.and_then(|last| last[corner.index()]) {
            Some(WheelState::Low) => "low",
            Some(WheelState::Fine) => "as the others",
            _ if !known || !wheel.informed() => "unknown",
            _ if wheel.low_probability > 0.5 => "uncertain",
            _ => "as the others",
        };
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{state}</td></tr>",
            corner_name(corner),
            cell(format!("{:+.2} ± {:.2} ‰", 1e3 * wheel.change, 1e3 * wheel.change_sd)),
            cell(format!("{:.0} ± {:.0} %", 100.0 * wheel.lost_share, 100.0 * wheel.lost_share_sd)),
            cell(would_show(wheel)),
        );
    }
    out.push_str("</tbody></table></div>");
    for sentence in unseen(&wheels.last) {
        let _ = write!(out, "<p class=\"note\">{}</p>", escape(&sentence));
    }
    out.push_str(
        "<details class=\"inner\"><summary>Radii and their ratios</summary><div class=\"panels\" data-wheels=\"radii\"></div></details></section>\n",
    );
    out
}

pub(super) fn json(data: &ReportData) -> Option<Value> {
    let wheels = data.wheel_speeds.as_ref()?;
    fn bands(curves: &[BandCurve], names: &[&'static str]) -> Vec<Value> {
        let band = |(curve, name): (&BandCurve, &&str)| {
            let [lo, hi] = curve.band.each_ref().map(|edge| values(edge));
            json!({ "name": name, "y": values(&curve.value), "lo": lo, "hi": hi })
        };
        curves.iter().zip(names).map(band).collect()
    }
    let names = Corner::ALL.map(corner_name);
    let pairs = ["Front left over right", "Rear left over right", "Front over rear"];
    let states = data.watch.iter().filter(|_| data.corners.is_empty()).flat_map(|watch| &watch.states);
    let states: Vec<Vec<_>> =
        states.map(|runs| runs.iter().map(|run| [run.0, run.1, run.2]).collect()).collect();
    Some(json!({
        "t": axis(&wheels.time_s),
        "change": bands(&wheels.change_1e3, &names),
        "lost": bands(&wheels.lost_percent, &names),
        "difference": bands(&wheels.difference_1e3, &pairs),
        "states": states,
    }))
}
