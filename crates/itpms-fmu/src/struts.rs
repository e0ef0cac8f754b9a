//! Dampers and load of a simulated drive, as `itpms estimate` finds them, worked out every twenty seconds. Called by the model with every row.

use itpms_analysis::beside::SuspensionWatch;
use itpms_analysis::suspension::{DamperHealth, DamperState, LoadState, Masses, Measured, SuspensionVerdict};
use itpms_core::model::Corner;
use itpms_data::{LogRow, Vehicle};
use serde::{Deserialize, Serialize};

use crate::variables::{OfCar, OfCorner};

const LOOK_S: f64 = 20.0;

/// Listens to all four corners, if they are measured.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Struts {
    watch: Option<SuspensionWatch>,
    /// When the calibration ends, and when it is looked next.
    calibrated_s: f64,
    look_s: f64,
}

impl Struts {
    pub(crate) fn new(
        vehicle: &Vehicle,
        corners: &[Corner],
        time_s: f64,
        step_s: f64,
        calibrate_s: Option<f64>,
    ) -> Self {
        let watch = SuspensionWatch::new(vehicle, corners, step_s, None);
        Self {
            watch,
            calibrated_s: calibrate_s.map_or(f64::INFINITY, |s| time_s + s),
            look_s: time_s + LOOK_S,
        }
    }

    /// Takes a row; what is known, where it was worked out after it.
    pub(crate) fn take(&mut self, row: &LogRow) -> Option<SuspensionVerdict> {
        let watch = self.watch.as_mut()?;
        watch.take(row);
        if row.time_s >= self.calibrated_s {
            self.calibrated_s = f64::INFINITY;
            watch.calibrate();
        } else if row.time_s < self.look_s {
            return None;
        }
        self.look_s = row.time_s + LOOK_S;
        Some(watch.conclude())
    }
}

/// An output of the car; `None`: it is none of these.
pub(crate) fn load(verdict: &SuspensionVerdict, of: OfCar) -> Option<f64> {
    let number = |number: fn(&Masses) -> f64| Some(verdict.load.masses.as_ref().map_or(f64::NAN, number));
    match of {
        OfCar::FrontAxle => number(|masses| masses.axles_kg[0].value),
        OfCar::FrontAxleSd => number(|masses| masses.axles_kg[0].sd),
        OfCar::RearAxle => number(|masses| masses.axles_kg[1].value),
        OfCar::RearAxleSd => number(|masses| masses.axles_kg[1].sd),
        OfCar::Total => number(|masses| masses.total_kg.value),
        OfCar::TotalSd => number(|masses| masses.total_kg.sd),
        OfCar::Added => number(|masses| masses.added_kg.value),
        OfCar::AddedSd => number(|masses| masses.added_kg.sd),
        OfCar::LoadState => Some(match verdict.load.state {
            LoadState::Unknown => 0.0,
            LoadState::Known => 1.0,
            LoadState::Overload => 2.0,
            LoadState::Learning => 3.0,
        }),
        _ => None,
    }
}

/// An output of a corner; `None`: it is none of these.
pub(crate) fn damper(damper: &DamperHealth, of: OfCorner) -> Option<f64> {
    let value = |of: Option<Measured>| Some(of.map_or(f64::NAN, |of| of.value));
    let sd = |of: Option<Measured>| Some(of.map_or(f64::NAN, |of| of.sd));
    match of {
        OfCorner::Damper => value(damper.damping_n_s_per_m),
        OfCorner::DamperSd => sd(damper.damping_n_s_per_m),
        OfCorner::OverReference => value(damper.over_reference),
        OfCorner::OverReferenceSd => sd(damper.over_reference),
        OfCorner::LeftRight => value(damper.left_right),
        OfCorner::LeftRightSd => sd(damper.left_right),
        OfCorner::FrontRear => value(damper.front_rear),
        OfCorner::FrontRearSd => sd(damper.front_rear),
        OfCorner::DampingRatio => value(damper.wheel_damping_ratio),
        OfCorner::DampingRatioSd => sd(damper.wheel_damping_ratio),
        OfCorner::DamperState => Some(match damper.state {
            DamperState::Unknown => 0.0,
            DamperState::Fine => 1.0,
            DamperState::Weak => 2.0,
            DamperState::Worn => 3.0,
            DamperState::Stiff => 4.0,
            DamperState::Learning => 5.0,
        }),
        _ => None,
    }
}
