//! The malfunctions that are put in, and within which time each is to be reported.

use itpms_core::diagnosis::{Malfunction, Place, Sensor};
use itpms_core::model::{Corner, Wheels};
use itpms_core::warning::Cause;
use itpms_sim::fault::{FaultKind, FaultPlace, FaultSpec, SensorName};

use FaultPlace::{Body, Wheel};

#[derive(Debug, Clone, PartialEq)]
pub struct Kind {
    pub name: &'static str,
    /// Seconds of driving within which it is reported.
    pub stated_s: f64,
    /// Fault of the sensors. Times are filled in when it is put in. None: a road that tells nothing, on a drive of its own.
    pub faults: Vec<FaultSpec>,
    /// The labels ([`Malfunction::label`]) that pass for its name: its own, and those of malfunctions it looks like.
    pub labels: &'static [&'static str],
}

impl Kind {
    /// The wheels whose sensors it happens to; without a fault all four.
    pub fn wheels(&self) -> Wheels {
        if self.faults.is_empty() {
            return Corner::ALL.into_iter().collect();
        }
        self.faults.iter().flat_map(sensors).map(|sensor| sensor.corner).collect()
    }

    /// Whether this is a malfunction at a wheel it happens to, under any of the words that pass. Gives the word.
    pub fn label_of(&self, cause: &Cause<f64>, wheels: Wheels) -> Option<&'static str> {
        let label = malfunction_label(cause)?;
        wheels.iter().any(|corner| self.wheels().contains(corner)).then_some(label)
    }

    /// Whether this is what is wrong: the kind of malfunction and the very sensors. Which way a gain is off counts, by how
    /// much does not. Of two swaps at once the monitor can tell no more than whether sides or axles are swapped.
    pub fn is_exactly(&self, cause: &Cause<f64>) -> bool {
        match cause {
            Cause::NoInformation { .. } => self.faults.is_empty(),
            Cause::Malfunction(said) => self.exact().iter().any(|exact| is_same(exact, said)),
            _ => false,
        }
    }

    /// Correct reports: any of these.
    fn exact(&self) -> Vec<Malfunction<f64>> {
        let all: Vec<_> = self.faults.iter().filter_map(exact).collect();
        let [Malfunction::Swapped(a, b), Malfunction::Swapped(..)] = *all else { return all };
        // Front left, front right, rear left, rear right.
        let [a, b] = [a, b].map(|sensor| sensor.corner.index());
        vec![if a / 2 == b / 2 { Malfunction::SwappedSides } else { Malfunction::SwappedAxles }]
    }
}

/// The word for a malfunction, or for nothing learned; `None` for what is reported of a tire.
pub(super) fn malfunction_label(cause: &Cause<f64>) -> Option<&'static str> {
    match cause {
        Cause::Malfunction(malfunction) => Some(malfunction.label()),
        Cause::NoInformation { .. } => Some(cause.label()),
        Cause::UnderInflated(_)
        | Cause::FastLeak { .. }
        | Cause::AllLow { .. }
        | Cause::CommonShift { .. }
        | Cause::OverInflated(_)
        | Cause::Differs { .. }
        | Cause::SlowLeak(_)
        | Cause::Flat(_) => None,
    }
}

fn sensor(name: SensorName) -> Sensor {
    let place = match name.sensor {
        FaultPlace::Body => Place::Body,
        FaultPlace::Wheel => Place::Wheel,
    };
    Sensor { corner: Corner::ALL[name.corner as usize], place }
}

fn sensors(fault: &FaultSpec) -> impl Iterator<Item = Sensor> {
    let other = match fault.kind {
        FaultKind::Swap { with } => Some(sensor(with)),
        _ => None,
    };
    std::iter::once(sensor(fault.at())).chain(other)
}

fn exact(fault: &FaultSpec) -> Option<Malfunction<f64>> {
    let at = sensor(fault.at());
    match fault.kind {
        FaultKind::Stuck => Some(Malfunction::Stuck(at)),
        FaultKind::Dropout { .. } => Some(Malfunction::Dropout(at)),
        FaultKind::Spikes { .. } => Some(Malfunction::Spikes(at)),
        FaultKind::Noise { .. } => Some(Malfunction::Noise(at)),
        FaultKind::Gain { factor } => Some(Malfunction::Gain { sensor: at, gain: factor }),
        FaultKind::Swap { with } => Some(Malfunction::Swapped(at, sensor(with))),
        // Nothing is reported of it.
        FaultKind::Bias { .. } => None,
    }
}

fn is_same(exact: &Malfunction<f64>, said: &Malfunction<f64>) -> bool {
    match (exact, said) {
        (Malfunction::Swapped(a, b), Malfunction::Swapped(c, d)) => (a, b) == (c, d) || (a, b) == (d, c),
        (Malfunction::Gain { sensor: a, gain: is }, Malfunction::Gain { sensor: b, gain: said }) => {
            a == b && (*is > 1.0) == (*said > 1.0) && (*is > 0.0) == (*said > 0.0)
        }
        _ => exact == said,
    }
}

fn kind(name: &'static str, stated_s: f64, labels: &'static [&'static str], faults: Vec<FaultSpec>) -> Kind {
    Kind { name, stated_s, faults, labels }
}

fn fault(corner: Corner, sensor: FaultPlace, kind: FaultKind) -> FaultSpec {
    FaultSpec::lasting(corner, sensor, 0.0, kind)
}

fn swap(a: Corner, place_a: FaultPlace, b: Corner, place_b: FaultPlace) -> FaultSpec {
    fault(a, place_a, FaultKind::Swap { with: SensorName::new(b, place_b) })
}

/// All kinds, in the order of the table.
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
    let silent = |name, a, b| {
        let at = |corner, place| fault(corner, place, FaultKind::Dropout { share: 1.0 });
        kind(name, 2.5, &["dropout"], [a, b].into_iter().flat_map(|i| [at(i, Body), at(i, Wheel)]).collect())
    };
    let spikes = |size_m_s2| FaultKind::Spikes { per_s: 1.0, size_m_s2 };
    let noise = |rms_m_s2| FaultKind::Noise { rms_m_s2 };
    vec![
        alone("stuck, wheel", 1.5, &["stuck"], fl, Wheel, FaultKind::Stuck),
        alone("stuck, body", 1.5, &["stuck"], rr, Body, FaultKind::Stuck),
        alone("dropped out, wheel", 2.5, &["dropout"], fr, Wheel, FaultKind::Dropout { share: 1.0 }),
        silent("dropped out, a side", fl, rl),
        silent("dropped out, an axle", rl, rr),
        alone("6 of 10 samples lost, body", 3.5, &["dropout"], rl, Body, FaultKind::Dropout { share: 0.6 }),
        alone("spikes of 50 m/s2, 1/s, wheel", 15.0, &["spikes"], fr, Wheel, spikes(50.0)),
        alone("spikes of 20 m/s2, 1/s, body", 15.0, &["spikes"], rl, Body, spikes(20.0)),
        alone("noise of 2 m/s2, wheel", 15.0, &["noise", "spikes"], fl, Wheel, noise(2.0)),
        alone("noise of 1 m/s2, body", 15.0, &["noise", "spikes"], rl, Body, noise(1.0)),
        alone("gain 0.5, wheel", 120.0, &["gain"], fr, Wheel, FaultKind::Gain { factor: 0.5 }),
        alone("gain 2, wheel", 120.0, &["gain", "noise"], rr, Wheel, FaultKind::Gain { factor: 2.0 }),
        alone("gain 0.75, wheel", 120.0, &["gain"], fl, Wheel, FaultKind::Gain { factor: 0.75 }),
        alone("gain 1.35, wheel", 120.0, &["gain"], rl, Wheel, FaultKind::Gain { factor: 1.35 }),
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
        // The monitor says it after ten minutes of driving; ten seconds more until the car is on that road and nothing is learned any more.
        kind("road smooth as glass", 610.0, &["no-information"], vec![]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str) -> Kind {
        kinds().into_iter().find(|kind| kind.name == name).unwrap()
    }

    fn at(corner: Corner, place: Place) -> Sensor {
        Sensor { corner, place }
    }

    #[test]
    fn exactly_is_the_kind_and_the_very_sensor_and_which_way() {
        let [fl, fr, rl, _] = Corner::ALL;
        let reports = |kind: &str, said| of(kind).is_exactly(&Cause::Malfunction(said));
        assert!(reports("stuck, wheel", Malfunction::Stuck(at(fl, Place::Wheel))));
        assert!(!reports("stuck, wheel", Malfunction::Stuck(at(fl, Place::Body))));
        assert!(!reports("stuck, wheel", Malfunction::Stuck(at(fr, Place::Wheel))));
        assert!(!reports("noise of 2 m/s2, wheel", Malfunction::Spikes(at(fl, Place::Wheel))));
        let gain = |gain| Malfunction::Gain { sensor: at(fl, Place::Body), gain };
        assert!(reports("upside down, body", gain(-0.8)) && !reports("upside down, body", gain(0.5)));
        assert!(reports("dropped out, a side", Malfunction::Dropout(at(rl, Place::Body))));
        assert!(!reports("dropped out, a side", Malfunction::Dropout(at(fr, Place::Body))));
        let halved = |gain| Malfunction::Gain { sensor: at(fr, Place::Wheel), gain };
        assert!(reports("gain 0.5, wheel", halved(0.6)) && !reports("gain 0.5, wheel", halved(1.6)));
        let (wheel, body) = (at(fl, Place::Wheel), at(rl, Place::Body));
        assert!(reports("body and another's wheel swapped", Malfunction::Swapped(body, wheel)));
        assert!(reports("body and another's wheel swapped", Malfunction::Swapped(wheel, body)));
        assert!(!reports("body and another's wheel swapped", Malfunction::Inconsistent(fl)));
        assert!(reports("corners swapped, left and right", Malfunction::SwappedSides));
        assert!(!reports("corners swapped, left and right", Malfunction::SwappedAxles));
        assert!(reports("corners swapped, front and rear", Malfunction::SwappedAxles));
        let nothing = Cause::NoInformation { driven_s: 600.0 };
        assert!(of("road smooth as glass").is_exactly(&nothing) && !of("stuck, wheel").is_exactly(&nothing));
    }

    #[test]
    fn every_kind_can_be_said_exactly_and_passes_by_its_own_name() {
        for kind in kinds() {
            let mut exact: Vec<_> = kind.exact().into_iter().map(Cause::Malfunction).collect();
            if kind.faults.is_empty() {
                exact.push(Cause::NoInformation { driven_s: 600.0 });
            }
            assert!(!exact.is_empty(), "{}", kind.name);
            for exact in exact {
                assert!(kind.is_exactly(&exact), "{}", kind.name);
                let label = kind.label_of(&exact, kind.wheels()).unwrap();
                assert_eq!(kind.labels[0], label, "{}", kind.name);
                assert_eq!(kind.label_of(&exact, Wheels::NONE), None, "{}", kind.name);
            }
        }
    }
}
