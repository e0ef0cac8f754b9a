//! How a drive is estimated and published.

use itpms_core::model::VehicleCalibration;
use itpms_core::warning::Regulation;
use itpms_core::wheel_speed::{RadiusCalibration, RadiusDays};
use itpms_data::log::UnitCheck;
use itpms_data::reference::{LearnedTorsion, SuspensionReference};

/// How a drive is estimated and how often it is published.
#[derive(Debug, Clone)]
pub struct DriveOptions {
    pub regulation: Regulation,
    /// Length in s of the calibration that begins with the first row.
    pub calibrate_s: Option<f64>,
    /// The result of an earlier calibration of this car.
    pub reference: Option<VehicleCalibration<f64>>,
    /// The same of struts and body, against which dampers and load are judged.
    pub suspension_reference: Option<SuspensionReference>,
    pub wheel_reference: Option<RadiusCalibration<f64>>,
    /// The days since then.
    pub days_reference: Option<RadiusDays<f64>>,
    pub pulses: bool,
    /// The result of an earlier calibration of the tooth pulses.
    pub torsion_reference: LearnedTorsion,
    pub rate_hz: f64,
    /// Whether numbers that do not look like m/s² and m/s are reported.
    pub units: UnitCheck,
}

impl Default for DriveOptions {
    fn default() -> Self {
        Self {
            regulation: Regulation::default(),
            calibrate_s: None,
            reference: None,
            suspension_reference: None,
            wheel_reference: None,
            days_reference: None,
            pulses: false,
            torsion_reference: [None; 4],
            rate_hz: 10.0,
            units: UnitCheck::default(),
        }
    }
}
