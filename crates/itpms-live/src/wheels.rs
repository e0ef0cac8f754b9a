//! What turns a row's wheel speeds and the tooth pulses up to it into what a car's monitor takes.

use itpms_core::monitor::{MonitoredCar, MonitoredWheels};
use itpms_core::torsion::CarTorsion;
use itpms_data::pulses::Pulse;
use itpms_data::{LogRow, Vehicle};

use crate::error::LiveError;
use crate::options::DriveOptions;

#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct Wheels {
    rolling_radius_m: f64,
    /// Where tooth pulses are read.
    pub(crate) torsion: Option<Box<CarTorsion<f64>>>,
}

impl Wheels {
    /// Of a car about to begin, whose monitor takes over what was learned.
    pub(crate) fn new(
        vehicle: &Vehicle,
        options: &DriveOptions,
        monitor: &mut MonitoredWheels<f64>,
    ) -> Result<Self, LiveError> {
        let refused = |error: &dyn std::fmt::Display| LiveError::Refused(error.to_string());
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
            if options.calibrate_s.is_some() {
                read.begin_calibration();
            }
        }
        Ok(Self { rolling_radius_m: vehicle.rolling_radius_m().unwrap_or(f64::NAN), torsion })
    }

    /// Hands the car a row's wheel speeds. Gives the speed of the car by them, in m/s.
    pub(crate) fn update(&mut self, row: &LogRow, car: &mut MonitoredCar<f64>) -> f64 {
        let sample = row.motion.sample(row.time_s, self.rolling_radius_m);
        car.update_wheel_speeds(&sample, self.torsion.as_deref_mut());
        0.25 * sample.wheel_speed_m_s.iter().sum::<f64>()
    }

    /// Takes a tooth pulse, before the first row that is not earlier.
    pub(crate) fn pulse(&mut self, pulse: &Pulse) {
        if let Some(torsion) = &mut self.torsion {
            torsion.push(pulse.wheel, pulse.time_s);
        }
    }
}

/// A key that the vehicle file lacks for what the source sends.
pub(crate) fn lacks(key: &str) -> LiveError {
    LiveError::Refused(format!("the vehicle file has no {key}"))
}
