//! The head of the page where wheel speeds are all there is: the car, and what is known of each wheel at the end of the drive.
//!
//! Called by the page's writer.

use std::fmt::Write as _;

use itpms_core::model::Corner;
use itpms_core::warning::{Doubt, WheelState};

use super::car::{self, Tire};
use super::wheels::{found, would_show};
use super::words::{Status, corner_name};
use super::{ReportData, WheelSpeedReport};

/// The car and its wheels; `None` where there are accelerations.
pub(super) fn cards(data: &ReportData) -> Option<String> {
    let wheels = data.wheel_speeds.as_ref().filter(|_| data.corners.is_empty())?;
    let states = data.watch.as_ref().map_or([None; 4], |watch| watch.last);
    let of = |corner: Corner| states.get(corner.index()).copied().flatten();
    let tires = Corner::ALL.map(|corner| {
        let status = status(of(corner));
        Some(Tire { status, word: status.word() })
    });
    let mut out = car::drawing(&format!("By the wheel speeds {}", found(&wheels.last)), &tires);
    for corner in Corner::ALL {
        card(&mut out, wheels, corner, of(corner));
    }
    Some(out)
}

fn status(state: Option<WheelState>) -> Status {
    match state {
        Some(WheelState::Low) => Status::Low,
        Some(WheelState::Malfunction) => Status::Malfunction,
        Some(WheelState::Over) => Status::Over,
        Some(WheelState::Fine) => Status::Fine,
        Some(WheelState::Unknown(Doubt::Uncertain)) => Status::Uncertain,
        Some(WheelState::Unknown(_)) | None => Status::Unknown,
    }
}

/// A wheel's loss, and its detectable loss.
fn card(out: &mut String, wheels: &WheelSpeedReport, corner: Corner, state: Option<WheelState>) {
    let status = status(state);
    let wheel = &wheels.last.wheels[corner.index()];
    let known = wheel.lost_share.is_finite();
    let (number, spread) = match known {
        true => (
            format!("{:.0}\u{a0}%", 100.0 * wheel.lost_share),
            format!("±\u{a0}{:.0}\u{a0}% lost", 100.0 * wheel.lost_share_sd),
        ),
        false => ("–".to_owned(), "not compared".to_owned()),
    };
    let why = match state {
        Some(WheelState::Unknown(Doubt::Uncertain)) => "too uncertain to rule out a loss",
        Some(WheelState::Unknown(Doubt::Starting)) => "not calibrated",
        Some(WheelState::Unknown(_)) | None => "fine takes that 30 % would show: drive on",
        Some(WheelState::Fine) => "no different from the others",
        Some(_) => "",
    };
    let _ = writeln!(
        out,
        "<a class=\"card {class} at-{id}\" href=\"#wheel-speeds\"><span class=\"card-name\">{name}</span>\
         <span class=\"badge {class}\">{label}</span><span class=\"card-number\">{number}<small>{spread}</small></span>\
         <span class=\"card-foot\"><span>{shows}</span><span>{why}</span></span></a>",
        class = status.class(),
        id = corner.label(),
        name = corner_name(corner),
        label = status.label(),
        shows = if known { would_show(wheel) } else { String::new() },
    );
}
