//! The wheel speeds of a drive under their monitor: beside that of the accelerations, or alone.

use itpms_core::monitor::MonitoredWheels;
use itpms_core::warning::MonitorReport;
use itpms_data::{LogRow, Vehicle};

use crate::error::LiveError;
use crate::options::DriveOptions;

/// The monitor and what it reported last; a part of the saved state.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct Wheels {
    pub(crate) monitor: Box<MonitoredWheels<f64>>,
    rolling_radius_m: f64,
    alone: bool,
    pub(crate) report: Box<MonitorReport<f64>>,
}

impl Wheels {
    pub(crate) fn new(vehicle: &Vehicle, alone: bool, options: &DriveOptions) -> Result<Self, LiveError> {
        let refused = |error: &dyn std::fmt::Display| LiveError::Refused(error.to_string());
        let config = vehicle.wheel_speed_config();
        let config = config.map_err(|key| refused(&format!("the vehicle file has no {key}")))?;
        let mut monitor = Box::new(MonitoredWheels::unconfigured());
        monitor.configure(&config).map_err(|error| refused(&error))?;
        if let Some(calibration) = &options.wheel_reference
            && !monitor.load_calibration(calibration)
        {
            return Err(refused(&"the learned reference has wheel speeds that no car has"));
        }
        if let Some(seconds) = options.calibrate_s {
            monitor.begin_calibration(seconds).map_err(|error| refused(&error))?;
        }
        let rolling_radius_m = vehicle.rolling_radius_m().unwrap_or(f64::NAN);
        Ok(Self { monitor, rolling_radius_m, alone, report: Box::new(MonitorReport::empty()) })
    }

    /// Takes a row, and what the car's other monitor reported after it. Gives the speed of the car by its wheels, where nothing else is known.
    pub(crate) fn update(&mut self, row: &LogRow, beside: &MonitorReport<f64>) -> Option<f64> {
        let sample = row.motion.sample(row.time_s, self.rolling_radius_m);
        self.monitor.update(&sample);
        if !self.alone {
            *self.report = *beside;
            self.monitor.tell(&mut self.report);
            return None;
        }
        self.monitor.tell_alone(&mut self.report);
        Some(0.25 * sample.wheel_speed_m_s.iter().sum::<f64>())
    }
}
