//! How each car stands after its last drive, the worst first.

use std::collections::BTreeMap;

use super::record::{DriveRecord, WheelRecord};

/// How a wheel or a car fares, in the order of urgency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum State {
    /// A tire was warned of as low.
    Low,
    /// A sensor was found not to be trusted.
    Malfunction,
    /// A tire has too much pressure.
    Over,
    /// Not enough is known.
    Unknown,
    /// Nothing is wrong.
    Fine,
}

impl State {
    /// All, the most urgent first.
    pub const ALL: [Self; 5] = [Self::Low, Self::Malfunction, Self::Over, Self::Unknown, Self::Fine];

    /// One word.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Malfunction => "malfunction",
            Self::Over => "over",
            Self::Unknown => "unknown",
            Self::Fine => "fine",
        }
    }

    /// That of a wheel in a drive, as the drive's report shows it: what was warned of counts to the end of the drive.
    #[must_use]
    pub fn of_wheel(wheel: &WheelRecord) -> Self {
        if wheel.first_warning_s.is_some() {
            Self::Low
        } else if wheel.first_malfunction_s.is_some() {
            Self::Malfunction
        } else if wheel.state == "over" {
            Self::Over
        } else if wheel.last.is_none() || wheel.state == "unknown" {
            Self::Unknown
        } else {
            Self::Fine
        }
    }

    /// That of a drive: its worst wheel's.
    #[must_use]
    pub fn of_drive(drive: &DriveRecord) -> Self {
        drive.wheels.iter().map(Self::of_wheel).min().unwrap_or(Self::Unknown)
    }
}

/// A car and its drives.
#[derive(Debug, Clone)]
pub struct CarStanding<'a> {
    /// The car.
    pub car: &'a str,
    /// That of its last drive.
    pub state: State,
    /// Its drives in their order; at least one.
    pub drives: Vec<&'a DriveRecord>,
}

impl<'a> CarStanding<'a> {
    /// All cars, the worst first: by state, then by the lowest share of the placard's pressure.
    #[must_use]
    pub fn of_all(drives: &'a [DriveRecord]) -> Vec<Self> {
        let mut cars: BTreeMap<&str, Vec<&DriveRecord>> = BTreeMap::new();
        for drive in drives {
            cars.entry(&drive.car).or_default().push(drive);
        }
        let mut all: Vec<Self> = cars
            .into_iter()
            .filter_map(|(car, drives)| {
                let state = State::of_drive(drives.last()?);
                Some(Self { car, state, drives })
            })
            .collect();
        all.sort_by(|a, b| a.state.cmp(&b.state).then(lowest(a.last()).total_cmp(&lowest(b.last()))));
        all
    }

    /// Its last drive.
    #[must_use]
    pub fn last(&self) -> Option<&'a DriveRecord> {
        self.drives.last().copied()
    }
}

/// The lowest share of the placard's pressure at the end of a drive; infinite where none is known.
pub(super) fn lowest(drive: Option<&DriveRecord>) -> f64 {
    let wheels = drive.into_iter().flat_map(|drive| &drive.wheels);
    wheels.filter_map(share).fold(f64::INFINITY, f64::min)
}

/// A wheel's last pressure over its placard's.
pub(super) fn share(wheel: &WheelRecord) -> Option<f64> {
    wheel.last.map(|last| last.pressure_kpa / wheel.placard_kpa)
}
