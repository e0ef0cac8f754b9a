//! The car in the caller's memory: accelerations and wheel speeds under their monitors, the roads, and what was reported last.

use itpms_core::model::{CalibrationError, CarEstimate, CarSample, VehicleCalibration};
use itpms_core::monitor::{MonitoredCar, MonitoredWheels};
use itpms_core::warning::{Alert, Change, MonitorReport};
use itpms_core::wheel_speed::RadiusCalibration;
use itpms_road::RoadUnderCar;
use serde::{Deserialize, Serialize};

use crate::cold::{self, itpms_air, itpms_cold_report};
use crate::config::itpms_config;
use crate::estimate::{self, itpms_estimate};
use crate::image::{self, Kind};
use crate::itpms_real;
use crate::kept::Kept;
use crate::read_config::{Config, Refusal};
use crate::sample::{itpms_sample, itpms_wheel_speed_sample};
use crate::status::itpms_status;

const CALIBRATION: Kind = Kind::new(b'C', 2);
/// A program with another layout of the estimator has another format.
const STATE: Kind = Kind::new(b'S', 8);

/// See the [module](self).
#[derive(Serialize, Deserialize)]
pub(crate) struct Car {
    config: Option<Config>,
    car: MonitoredCar<itpms_real>,
    road: RoadUnderCar<itpms_real>,
    estimate: Option<CarEstimate<itpms_real>>,
    /// As the events were last asked for.
    reported: Option<MonitorReport<itpms_real>>,
}

/// What was learned.
type Taught = (Option<VehicleCalibration<itpms_real>>, Option<RadiusCalibration<itpms_real>>);

impl Car {
    /// Begins anew with this configuration.
    fn begin(&mut self, config: &Config) -> Result<(), itpms_core::ParameterError> {
        self.car.configure(&config.monitor, config.sample_rate_hz)?;
        self.road.clear();
        if config.wants_road {
            self.road.configure(&config.monitor.car, config.sample_rate_hz)?;
        }
        self.config = Some(*config);
        (self.estimate, self.reported) = (None, None);
        Ok(())
    }

    fn has_corners(&self) -> bool {
        self.config.as_ref().is_some_and(|config| config.monitor.car.has_corners())
    }

    pub(crate) fn update(&mut self, sample: &itpms_sample) -> Result<(), itpms_status> {
        let mut sample = sample.read()?;
        let config = self.config.as_ref().filter(|config| config.monitor.car.has_corners());
        let config = config.ok_or(itpms_status::NoCorners)?;
        for (corner, configured) in sample.corners.iter_mut().zip(&config.monitor.car.corners) {
            *corner = corner.filter(|_| configured.is_some());
        }
        let mut estimate = self.car.update(&sample);
        if config.wants_road {
            self.road.update(&sample, &self.car.estimator().quarter_cars(), &mut estimate);
        }
        self.estimate = Some(estimate);
        Ok(())
    }

    pub(crate) fn update_wheel_speeds(
        &mut self,
        sample: &itpms_wheel_speed_sample,
    ) -> Result<(), itpms_status> {
        let sample = sample.read()?;
        self.car.wheels().ok_or(itpms_status::NoWheelSpeeds)?;
        self.car.update(&CarSample::of_wheel_speeds(sample));
        Ok(())
    }

    pub(crate) fn update_air(&mut self, air: &itpms_air) -> Result<(), itpms_status> {
        if !self.has_corners() {
            return Err(itpms_status::NoCorners);
        }
        self.car.follow_air(&air.read());
        Ok(())
    }

    pub(crate) fn cold(&self) -> itpms_cold_report {
        cold::report(self.config.as_ref().map(|config| &config.monitor.car), self.estimate.as_ref())
    }

    pub(crate) fn estimate(&self) -> itpms_estimate {
        let radii = self.car.wheels().map(MonitoredWheels::radii);
        estimate::estimate(self.estimate.as_ref(), self.car.report(), radii)
    }

    fn taught(&self) -> Taught {
        let wheels = self.car.wheels().and_then(MonitoredWheels::calibration);
        (self.car.estimator().calibration(), wheels.copied())
    }

    /// Bytes of its saved state now.
    pub(crate) fn state_size(&self) -> usize {
        image::HEADER + postcard::experimental::serialized_size(self).unwrap_or(0)
    }

    pub(crate) fn save_state(&self, bytes: &mut [u8]) -> Result<usize, itpms_status> {
        image::save(STATE, self, bytes)
    }

    /// Goes on from a saved state.
    pub(crate) fn restore_state(&mut self, bytes: &[u8]) -> Result<(), itpms_status> {
        *self = image::load(STATE, bytes)?;
        Ok(())
    }
}

impl Kept for Car {
    const MARK: u32 = u32::from_le_bytes(*b"IPTM");

    // Part by part: as a whole it would cross the stack.
    #[allow(unsafe_code)]
    #[inline(never)] // Its blank copies leave the stack before the car is configured.
    unsafe fn blank(place: *mut Self) {
        // SAFETY: the caller's promise; every field is written, and none is read before.
        unsafe {
            (&raw mut (*place).config).write(None);
            (&raw mut (*place).car).write(MonitoredCar::unconfigured());
            (&raw mut (*place).road).write(RoadUnderCar::unconfigured());
            (&raw mut (*place).estimate).write(None);
            (&raw mut (*place).reported).write(None);
        }
    }

    fn configure(&mut self, config: &itpms_config) -> Result<(), Refusal> {
        Ok(self.begin(&Config::read(config)?)?)
    }

    fn reset(&mut self) -> Result<(), itpms_status> {
        let config = self.config.ok_or(itpms_status::NotACar)?;
        self.begin(&config).map_err(|_| itpms_status::BadParameter)
    }

    fn alerts(&self, mut take: impl FnMut(usize, &Alert<itpms_real>)) {
        self.car.report().alerts().enumerate().for_each(|(i, alert)| take(i, alert));
    }

    fn events(
        &mut self,
        room: usize,
        mut take: impl FnMut(usize, &Change<itpms_real>),
    ) -> (usize, Result<(), itpms_status>) {
        let (now, before) = (*self.car.report(), self.reported.unwrap_or_else(MonitorReport::empty));
        let count = now.changes_since(&before).count();
        if count > room {
            return (count, Err(itpms_status::TooSmall));
        }
        now.changes_since(&before).enumerate().for_each(|(i, change)| take(i, &change));
        self.reported = Some(now);
        (count, Ok(()))
    }

    fn begin_calibration(&mut self, seconds: f64) -> Result<(), itpms_status> {
        self.car.begin_calibration(seconds).map_err(|_| itpms_status::BadDuration)
    }

    fn end_calibration(&mut self) -> Result<(), itpms_status> {
        self.car.end_calibration();
        match self.taught() {
            (None, None) => Err(itpms_status::NotCalibrated),
            _ => Ok(()),
        }
    }

    fn save_calibration(&self, bytes: &mut [u8]) -> Result<usize, itpms_status> {
        match self.taught() {
            (None, None) => Err(itpms_status::NotCalibrated),
            taught => image::save(CALIBRATION, &taught, bytes),
        }
    }

    fn load_calibration(&mut self, bytes: &[u8]) -> Result<(), itpms_status> {
        let (corners, wheels): Taught = image::load(CALIBRATION, bytes)?;
        if self.estimate.is_some()
            || self.car.wheels().is_some_and(|wheels| wheels.radii().time_s.is_finite())
        {
            return Err(itpms_status::TooLate);
        }
        if let Some(corners) = corners.filter(|_| self.has_corners()) {
            self.car.load_calibration(&corners).map_err(|error| match error {
                CalibrationError::OtherCar => itpms_status::OtherCar,
                CalibrationError::NotANumber(_) | CalibrationError::Implausible(_) => {
                    itpms_status::Implausible
                }
            })?;
        }
        let loaded =
            self.car.wheels_mut().zip(wheels).map(|(wheels, learned)| wheels.load_calibration(&learned));
        if loaded == Some(false) { Err(itpms_status::Implausible) } else { Ok(()) }
    }
}
