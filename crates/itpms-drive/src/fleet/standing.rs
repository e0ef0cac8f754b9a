//! How each car stands after its last drive, the worst first.

use std::collections::BTreeMap;

use super::Failed;
use super::record::{DriveRecord, WheelRecord};

itpms_core::labelled! {
    /// How a wheel or a car fares, in the order of urgency.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum State {
        Low = "low",
        /// A sensor was found not to be trusted.
        Malfunction = "malfunction",
        /// A tire has too much pressure.
        Over = "over",
        /// There is a pressure that could be low as well as not.
        Uncertain = "uncertain",
        /// Not enough is known.
        Unknown = "unknown",
        Fine = "fine",
    }
}

impl State {
    /// That of a wheel in a drive, as the drive's report shows it: what was warned of counts to the end of the drive.
    pub fn of_wheel(wheel: &WheelRecord) -> Self {
        if wheel.first_warning_s.is_some() {
            Self::Low
        } else if wheel.first_malfunction_s.is_some() {
            Self::Malfunction
        } else if wheel.state == "over" {
            Self::Over
        } else if wheel.last.is_some() && wheel.state == "uncertain" {
            Self::Uncertain
        } else if wheel.last.is_none() && wheel.state != "fine"
            || matches!(wheel.state.as_str(), "unknown" | "uncertain")
        {
            Self::Unknown
        } else {
            Self::Fine
        }
    }

    /// That of a drive: its worst wheel's. A wheel that was not estimated may be the one that is low.
    pub fn of_drive(drive: &DriveRecord) -> Self {
        let missing = (!drive.not_estimated.is_empty()).then_some(Self::Unknown);
        drive.wheels.iter().map(Self::of_wheel).chain(missing).min().unwrap_or(Self::Unknown)
    }
}

#[derive(Debug, Clone)]
pub struct CarStanding<'a> {
    pub car: &'a str,
    /// That of its last drive that could be estimated; unknown if none could.
    pub state: State,
    /// Its drives that could be estimated, in their order.
    pub drives: Vec<&'a DriveRecord>,
    /// How many of its drives could not.
    pub failed: usize,
}

impl<'a> CarStanding<'a> {
    /// All cars, the worst first: by state, then by the lowest share of the placard's pressure.
    pub fn of_all(drives: &'a [DriveRecord], failed: &'a [Failed]) -> Vec<Self> {
        let mut cars: BTreeMap<&str, Self> = BTreeMap::new();
        let unseen = |car| Self { car, state: State::Unknown, drives: Vec::new(), failed: 0 };
        for drive in drives {
            let car = cars.entry(&drive.car).or_insert_with_key(|car| unseen(car));
            car.state = State::of_drive(drive);
            car.drives.push(drive);
        }
        for car in failed.iter().filter_map(|failed| failed.car.as_deref()) {
            cars.entry(car).or_insert_with_key(|car| unseen(car)).failed += 1;
        }
        let mut all: Vec<Self> = cars.into_values().collect();
        all.sort_by(|a, b| a.state.cmp(&b.state).then(lowest(a.last()).total_cmp(&lowest(b.last()))));
        all
    }

    pub fn last(&self) -> Option<&'a DriveRecord> {
        self.drives.last().copied()
    }
}

/// The lowest share of the placard's pressure at the end of a drive; infinite where none is known.
pub(super) fn lowest(drive: Option<&DriveRecord>) -> f64 {
    let wheels = drive.into_iter().flat_map(|drive| &drive.wheels);
    wheels.filter_map(share).fold(f64::INFINITY, f64::min)
}

pub(super) fn share(wheel: &WheelRecord) -> Option<f64> {
    wheel.last.map(|last| last.pressure_kpa / wheel.placard_kpa)
}
