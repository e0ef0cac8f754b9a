//! What the driver would see: one lamp for low pressure, one for a malfunction, and the wheels that are named.

use itpms_core::car::CarEstimate;
use itpms_core::estimate::Warning;
use itpms_core::monitor::{Cause, MonitorReport, Wheels};
use itpms_core::sample::Corner;

/// A lamp.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lamp {
    Low,
    Malfunction,
}

/// The wheels a lamp is lit for; none where it is out.
pub(super) fn lit(lamp: Lamp, report: &MonitorReport<f64>, estimate: &CarEstimate<f64>) -> Wheels {
    let wanted = match lamp {
        Lamp::Low => Warning::Low,
        Lamp::Malfunction => Warning::Malfunction,
    };
    let warned =
        |corner: &Corner| estimate.corners[corner.index()].is_some_and(|estimate| estimate.warning == wanted);
    let of_wheels: Wheels = Corner::ALL.into_iter().filter(warned).collect();
    report
        .alerts()
        .filter(|alert| lights(lamp, &alert.cause))
        .fold(of_wheels, |wheels, alert| wheels | alert.wheels)
}

fn lights(lamp: Lamp, cause: &Cause<f64>) -> bool {
    match cause {
        Cause::UnderInflated(_) | Cause::FastLeak { .. } | Cause::AllLow { .. } => lamp == Lamp::Low,
        Cause::Malfunction(_) | Cause::NoInformation { .. } => lamp == Lamp::Malfunction,
        Cause::OverInflated(_) => false,
    }
}
