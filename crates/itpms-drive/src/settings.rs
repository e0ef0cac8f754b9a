//! Settings of an estimate besides its log and its vehicle.

use std::path::PathBuf;

use itpms_core::model::{Corner, PressureUnit};
use itpms_core::warning::Regulation;
use itpms_data::Vehicle;
use itpms_data::tuning::Tuning;
use itpms_paper::EstimatorKind;
use itpms_road::RoadRepetition;

use crate::error::DriveError;

/// Seconds that a log may be shorter than the calibration that it is.
pub(crate) const LOG_END_S: f64 = 1.0;

/// How a drive is to be estimated.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    pub estimator: EstimatorKind,
    pub regulation: Regulation,
    /// Numbers of the monitors that are usually left as they are.
    pub tuning: Tuning,
    pub road_repeats: RoadRepetition,
    /// So many seconds at the start are driven at placard pressure: a calibration drive.
    pub calibrate_s: Option<f64>,
    /// A stored reference from an earlier calibration drive of this car; not together with `calibrate_s`.
    pub reference: Option<PathBuf>,
    /// Pressures in kPa that the tires were known to have in the calibration where they are not their placards', in the order of
    /// [`Corner::ALL`]; for wheel speeds.
    pub calibration_kpa: [Option<f64>; 4],
    /// The table of tooth pulses that belongs to the log, by the same clock: they count together with its wheel speeds.
    pub pulses: Option<PathBuf>,
    /// Rows per second of the estimates.
    pub rate_hz: f64,
    /// Unit of the pressures that people read: lines, sentences and pages. Files are in kPa.
    pub pressure_unit: PressureUnit,
    /// Program and version that made all this, for the end of a report.
    pub program: String,
    /// The command that all this came from, for the end of a report; empty: not shown.
    pub command: String,
}

impl Default for Settings {
    /// Those of `itpms estimate`: the default estimator and regulation, 10 rows per second, no calibration, kPa.
    fn default() -> Self {
        Self {
            estimator: EstimatorKind::default(),
            regulation: Regulation::default(),
            tuning: Tuning::default(),
            road_repeats: RoadRepetition::default(),
            calibrate_s: None,
            reference: None,
            calibration_kpa: [None; 4],
            pulses: None,
            rate_hz: 10.0,
            pressure_unit: PressureUnit::Kpa,
            program: concat!("itpms ", env!("CARGO_PKG_VERSION")).to_owned(),
            command: String::new(),
        }
    }
}

impl Settings {
    /// Each tire's pressure in the calibration over the one that it should have had.
    pub(crate) fn pressure_shares(&self, vehicle: &Vehicle) -> [f64; 4] {
        Corner::ALL.map(|corner| {
            let known = self.calibration_kpa[corner.index()].zip(vehicle.placard_kpa(corner));
            known.map_or(1.0, |(kpa, placard_kpa)| kpa / placard_kpa)
        })
    }

    /// Refuses what `option`, a calibration or its result, cannot do with this estimator.
    /// Errors: only the default estimator learns from a calibration drive.
    pub(crate) fn expect_learning(&self, option: &str) -> Result<(), DriveError> {
        let learns = EstimatorKind::default();
        if self.estimator == learns {
            return Ok(());
        }
        let (used, learns) = (self.estimator.label(), learns.label());
        Err(DriveError::Mismatch(format!(
            "{option} with --estimator {used}: only {learns} learns from a calibration"
        )))
    }
}
