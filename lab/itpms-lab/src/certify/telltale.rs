//! The driver's display: one lamp for low pressure, one for a malfunction, and the wheels that are named.

use itpms_core::model::{CarEstimate, Corner, Warning, Wheels};
use itpms_core::warning::{Alert, Cause, MonitorReport};

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
    of_wheels | lit_by_alerts(lamp, report)
}

/// The same where nothing but alerts is known.
pub(super) fn lit_by_alerts(lamp: Lamp, report: &MonitorReport<f64>) -> Wheels {
    let lights = |alert: &&Alert<f64>| lights(lamp, &alert.cause);
    report.alerts().filter(lights).fold(Wheels::NONE, |wheels, alert| wheels | alert.wheels)
}

fn lights(lamp: Lamp, cause: &Cause<f64>) -> bool {
    lamp_of(cause) == Some(lamp)
}

/// The lamp of a cause; a tire that is overfull has none.
fn lamp_of(cause: &Cause<f64>) -> Option<Lamp> {
    match cause {
        Cause::UnderInflated(_)
        | Cause::FastLeak { .. }
        | Cause::AllLow { .. }
        | Cause::Flat(_)
        | Cause::Differs { .. }
        | Cause::SlowLeak(_) => Some(Lamp::Low),
        Cause::Malfunction(_) | Cause::NoInformation { .. } => Some(Lamp::Malfunction),
        Cause::OverInflated(_) | Cause::CommonShift { .. } => None,
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wrong {
    /// Nothing of the kind is the matter with the car.
    Lamp,
    /// It is, but not with all the wheels that are named.
    Wheel,
}

/// Whether what is done to the car explains an alert, from when it is done until it is put right. A test does one thing:
/// - tires are let down: these are low, and lose pressure fast while they are. Nothing is wrong with a sensor, no tire is
///   overfull (the others are warm, not more), and those that are not let down hold. That all four are low is reported of all
///   four, so only where all were let down: a diffusion has no neighbors;
/// - a sensor fails, or two are exchanged: their corners have a malfunction, and if it lasts, nothing is learned there.
///   The car keeps its tires: none is low, whatever a dead sensor or its partner seems to say. A corner that shares road and
///   body with them has sensors of its own and can do without.
///
/// After everything is put right the same may still be reported until it is taken back; that it is, is another question. That
/// tires were filled, or have cooled down to the placard's pressure, is no leak: a reset has set them right.
pub(super) fn wrong(lamp: Lamp, concerned: Wheels, alert: &Alert<f64>) -> Option<Wrong> {
    if lamp_of(&alert.cause) != Some(lamp) {
        Some(Wrong::Lamp)
    } else if matches!(alert.cause, Cause::Differs { is_known: false, .. }) {
        // Of these some are low; which, is left open.
        (!alert.wheels.iter().any(|corner| concerned.contains(corner))).then_some(Wrong::Wheel)
    } else if alert.wheels.iter().any(|corner| !concerned.contains(corner)) {
        Some(Wrong::Wheel)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::diagnosis::{Malfunction, Place, Sensor};

    #[test]
    fn only_what_was_done_to_the_car_explains_a_lamp() {
        let [fl, fr, ..] = Corner::ALL;
        let all: Wheels = Corner::ALL.into_iter().collect();
        let one = Wheels::from(fl);
        let reading = crate::LOW;
        let stuck = Malfunction::Stuck(Sensor { corner: fl, place: Place::Wheel });
        let reports = |lamp, concerned, cause, wheels: Wheels| {
            wrong(lamp, concerned, &Alert { wheels, since_s: 0.0, reported_s: 0.0, cause })
        };
        // Front left is let down.
        let low = |cause, wheels| reports(Lamp::Low, one, cause, wheels);
        assert_eq!(low(Cause::UnderInflated(reading), one), None);
        assert_eq!(low(Cause::FastLeak { reading, rate_kpa_per_min: 50.0 }, one), None);
        assert_eq!(low(Cause::UnderInflated(reading), fr.into()), Some(Wrong::Wheel));
        assert_eq!(
            low(Cause::AllLow { mean_share: 0.8, sd_share: 0.01, probability: 0.998 }, all),
            Some(Wrong::Wheel)
        );
        assert_eq!(low(Cause::OverInflated(reading), fr.into()), Some(Wrong::Lamp));
        assert_eq!(low(Cause::Malfunction(stuck), one), Some(Wrong::Lamp));
        assert_eq!(low(Cause::NoInformation { driven_s: 600.0 }, one), Some(Wrong::Lamp));
        // All four are.
        let mean = Cause::AllLow { mean_share: 0.8, sd_share: 0.01, probability: 0.998 };
        assert_eq!(reports(Lamp::Low, all, mean, all), None);
        assert_eq!(reports(Lamp::Low, all, Cause::UnderInflated(reading), fr.into()), None);
        // Its wheel sensor is stuck.
        let broken = |cause, wheels| reports(Lamp::Malfunction, one, cause, wheels);
        assert_eq!(broken(Cause::Malfunction(stuck), one), None);
        assert_eq!(broken(Cause::NoInformation { driven_s: 600.0 }, one), None);
        assert_eq!(broken(Cause::Malfunction(Malfunction::SwappedSides), all), Some(Wrong::Wheel));
        assert_eq!(broken(Cause::UnderInflated(reading), one), Some(Wrong::Lamp));
    }
}
