//! A test's intervention: tires that are let down, a sensor that fails. Known to the list and to the rules.

use itpms_core::model::{Corner, Wheels};
use itpms_sim::fault::{FaultKind, FaultPlace, FaultSpec, SensorName};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Test {
    Low(Wheels),
    LowAll,
    Malfunction(Failure),
}

/// A sensor's failure: what a person with pliers can do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Its plug is pulled: no sample any more.
    Unplugged(Corner, FaultPlace),
    /// It repeats its last value.
    Stuck(Corner, FaultPlace),
    /// The plugs of two wheel sensors are exchanged.
    Exchanged(Corner, Corner),
}

impl Failure {
    pub(super) fn name(self) -> String {
        let place = |place| if place == FaultPlace::Wheel { "wheel" } else { "body" };
        match self {
            Self::Unplugged(corner, at) => format!("unplugged-{}-{}", corner.label(), place(at)),
            Self::Stuck(corner, at) => format!("stuck-{}-{}", corner.label(), place(at)),
            Self::Exchanged(a, b) => format!("exchanged-{}-{}", a.label(), b.label()),
        }
    }

    pub(super) fn text(self) -> String {
        let place = |place| if place == FaultPlace::Wheel { "wheel" } else { "body" };
        match self {
            Self::Unplugged(corner, at) => format!("{} {} sensor unplugged", corner.label(), place(at)),
            Self::Stuck(corner, at) => format!("{} {} sensor stuck", corner.label(), place(at)),
            Self::Exchanged(a, b) => format!("wheel sensors of {} and {} exchanged", a.label(), b.label()),
        }
    }

    /// As a scenario has it, for good.
    pub(super) fn spec(self, from_s: f64) -> FaultSpec {
        let fault = |corner, sensor, kind| FaultSpec::lasting(corner, sensor, from_s, kind);
        match self {
            Self::Unplugged(corner, place) => fault(corner, place, FaultKind::Dropout { share: 1.0 }),
            Self::Stuck(corner, place) => fault(corner, place, FaultKind::Stuck),
            Self::Exchanged(a, b) => {
                let with = SensorName::new(b, FaultPlace::Wheel);
                fault(a, FaultPlace::Wheel, FaultKind::Swap { with })
            }
        }
    }
}
