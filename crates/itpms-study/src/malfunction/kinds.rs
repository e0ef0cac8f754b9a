//! The malfunctions that are put in, and within which time each is to be said.

use itpms_core::sample::Corner;
use itpms_sim::fault::{FaultKind, FaultPlace, FaultSpec, SensorName};

use FaultPlace::{Body, Wheel};

/// A kind of malfunction.
#[derive(Debug, Clone, PartialEq)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// Seconds of driving within which it is said.
    pub stated_s: f64,
    /// What happens to the sensors. Times are filled in when it is put in.
    pub faults: Vec<FaultSpec>,
    /// The words of [`Malfunction::label`](itpms_core::monitor::Malfunction::label) that say what it is.
    pub labels: &'static [&'static str],
}

fn kind(name: &'static str, stated_s: f64, labels: &'static [&'static str], faults: Vec<FaultSpec>) -> Kind {
    Kind { name, stated_s, faults, labels }
}

fn fault(corner: Corner, sensor: FaultPlace, kind: FaultKind) -> FaultSpec {
    FaultSpec { corner: corner.into(), sensor, from_s: 0.0, to_s: None, kind }
}

fn swap(a: Corner, place_a: FaultPlace, b: Corner, place_b: FaultPlace) -> FaultSpec {
    fault(a, place_a, FaultKind::Swap { with: SensorName::new(b, place_b) })
}

/// All kinds, in the order of the table.
#[must_use]
pub fn kinds() -> Vec<Kind> {
    let [fl, fr, rl, rr] = Corner::ALL;
    let alone = |name, stated_s, label, corner, place, what| {
        kind(name, stated_s, label, vec![fault(corner, place, what)])
    };
    let swapped = |name, stated_s, a, place_a, b, place_b| {
        kind(name, stated_s, &["swapped", "inconsistent"], vec![swap(a, place_a, b, place_b)])
    };
    let corners =
        |name, a, b| kind(name, 25.0, &["swapped"], vec![swap(a, Body, b, Body), swap(a, Wheel, b, Wheel)]);
    vec![
        alone("stuck, wheel", 1.5, &["stuck"], fl, Wheel, FaultKind::Stuck),
        alone("stuck, body", 1.5, &["stuck"], rr, Body, FaultKind::Stuck),
        alone("dropped out, wheel", 2.5, &["dropout"], fr, Wheel, FaultKind::Dropout { share: 1.0 }),
        alone("6 of 10 samples lost, body", 3.5, &["dropout"], rl, Body, FaultKind::Dropout { share: 0.6 }),
        alone(
            "spikes of 50 m/s2, 1/s, wheel",
            15.0,
            &["spikes"],
            fr,
            Wheel,
            FaultKind::Spikes { per_s: 1.0, size_m_s2: 50.0 },
        ),
        alone(
            "spikes of 20 m/s2, 1/s, body",
            15.0,
            &["spikes"],
            rl,
            Body,
            FaultKind::Spikes { per_s: 1.0, size_m_s2: 20.0 },
        ),
        alone(
            "noise of 2 m/s2, wheel",
            15.0,
            &["noise", "spikes"],
            fl,
            Wheel,
            FaultKind::Noise { rms_m_s2: 2.0 },
        ),
        alone(
            "noise of 1 m/s2, body",
            15.0,
            &["noise", "spikes"],
            rl,
            Body,
            FaultKind::Noise { rms_m_s2: 1.0 },
        ),
        alone("gain 0.5, wheel", 120.0, &["gain"], fr, Wheel, FaultKind::Gain { factor: 0.5 }),
        alone("gain 2, wheel", 120.0, &["gain", "noise"], rr, Wheel, FaultKind::Gain { factor: 2.0 }),
        alone("gain 0.7, body", 35.0, &["gain"], fr, Body, FaultKind::Gain { factor: 0.7 }),
        alone("gain 1.5, body", 25.0, &["gain"], rr, Body, FaultKind::Gain { factor: 1.5 }),
        alone("upside down, wheel", 25.0, &["gain"], rr, Wheel, FaultKind::Gain { factor: -1.0 }),
        alone("upside down, body", 25.0, &["gain"], fl, Body, FaultKind::Gain { factor: -1.0 }),
        swapped("body and wheel swapped", 10.0, fl, Wheel, fl, Body),
        swapped("body and another's wheel swapped", 15.0, fl, Wheel, rl, Body),
        swapped("wheels swapped, left and right", 25.0, fl, Wheel, fr, Wheel),
        swapped("wheels swapped, front and rear", 25.0, fl, Wheel, rl, Wheel),
        swapped("bodies swapped, left and right", 25.0, rl, Body, rr, Body),
        swapped("bodies swapped, front and rear", 25.0, fr, Body, rr, Body),
        corners("corners swapped, left and right", rl, rr),
        corners("corners swapped, front and rear", fr, rr),
    ]
}
