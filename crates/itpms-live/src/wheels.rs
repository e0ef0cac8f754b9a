//! The wheel speeds of a drive under their monitor: beside that of the accelerations, or alone.

use itpms_core::monitor::MonitoredWheels;
use itpms_core::torsion::CarTorsion;
use itpms_core::warning::MonitorReport;
use itpms_data::pulses::Pulse;
use itpms_data::{LogRow, Vehicle};

use crate::error::LiveError;
use crate::options::DriveOptions;

/// The monitor and what it reported last; a part of the saved state.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct Wheels {
    pub(crate) monitor: Box<MonitoredWheels<f64>>,
    rolling_radius_m: f64,
    alone: bool,
    /// Where tooth pulses are read.
    pub(crate) torsion: Option<Box<CarTorsion<f64>>>,
    pub(crate) report: Box<MonitorReport<f64>>,
}

impl Wheels {
    pub(crate) fn new(vehicle: &Vehicle, alone: bool, options: &DriveOptions) -> Result<Self, LiveError> {
        let refused = |error: &dyn std::fmt::Display| LiveError::Refused(error.to_string());
        let config = vehicle.wheel_speed_config();
        let lacks = |key| refused(&format!("the vehicle file has no {key}"));
        let config = config.map_err(lacks)?;
        let mut monitor = Box::new(MonitoredWheels::unconfigured());
        monitor.configure(&config).map_err(|error| refused(&error))?;
        if let Some(calibration) = &options.wheel_reference
            && !monitor.load_calibration(calibration)
        {
            return Err(refused(&"the learned reference has wheel speeds that no car has"));
        }
        if let Some(days) = &options.days_reference {
            let _ = monitor.load_days(days);
        }
        let mut torsion = None;
        if options.pulses {
            let (of_wheels, placard_kpa) = vehicle.torsion_config().map_err(lacks)?;
            let read = torsion.insert(Box::new(CarTorsion::unconfigured()));
            read.configure(&of_wheels, &placard_kpa).map_err(|error| refused(&error))?;
            let _ = read.load_calibration(&options.torsion_reference);
        }
        if let Some(seconds) = options.calibrate_s {
            monitor.begin_calibration(seconds).map_err(|error| refused(&error))?;
            torsion.iter_mut().for_each(|read| read.begin_calibration());
        }
        let rolling_radius_m = vehicle.rolling_radius_m().unwrap_or(f64::NAN);
        Ok(Self { monitor, rolling_radius_m, alone, torsion, report: Box::new(MonitorReport::empty()) })
    }

    /// Takes a row, and what the car's other monitor reported after it. Gives the speed of the car by its wheels, where nothing else is known.
    pub(crate) fn update(&mut self, row: &LogRow, beside: &MonitorReport<f64>) -> Option<f64> {
        let sample = row.motion.sample(row.time_s, self.rolling_radius_m);
        match &mut self.torsion {
            Some(torsion) => self.monitor.update_with_pulses(&sample, torsion),
            None => self.monitor.update(&sample),
        }
        if !self.alone {
            *self.report = *beside;
            self.monitor.write_alert_into(&mut self.report);
            return None;
        }
        self.monitor.write_report_into(&mut self.report);
        Some(0.25 * sample.wheel_speed_m_s.iter().sum::<f64>())
    }

    /// Takes a tooth pulse, before the first row that is not earlier.
    pub(crate) fn pulse(&mut self, pulse: &Pulse) {
        if let Some(torsion) = &mut self.torsion {
            torsion.push(pulse.wheel, pulse.time_s);
        }
    }
}
