//! A car with all that it has to find its pressures with: an estimator of accelerations under its monitor, which keeps bad sensors from
//! it and judges its estimates, the monitor of wheel speeds, a second witness or the only one, and the tooth pulses, where they are read.

#[cfg(test)]
mod tests;

use crate::car::CarEstimator;
use crate::estimator::OutsideStiffness;
use crate::memory::{Blank, Placed};
use crate::model::{
    Air, CalibrationError, CarEstimate, CarSample, Corner, ParameterError, VehicleCalibration,
};
use crate::monitor::{Monitor, MonitorConfig, MonitoredWheels};
use crate::real::Real;
use crate::torsion::{CarTorsion, WheelSensors};
use crate::warning::MonitorReport;

/// A running estimator and its monitors. A value: clone it, save it, go on. `S` says [which](WheelSensors) of its wheels' sensors
/// it reads.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MonitoredCar<T: Real, S = ()> {
    estimator: CarEstimator<T>,
    monitor: Monitor<T>,
    wheels: Placed<MonitoredWheels<T>>,
    sensors: S,
}

impl<T: Real> MonitoredCar<T> {
    /// A car for samples that come at about `sample_rate_hz`, by value: some 140 KB in `f32`, and on the stack more than once
    /// that until it is where it stays. A controller [configures](Self::configure) it in a `static`.
    ///
    /// # Errors
    /// Of a car with corners the rate must be 100 to 2000 Hz; limits and references must be numbers in order; parameters of a corner or of
    /// wheel speeds that cannot be are named.
    pub fn new(config: &MonitorConfig<T>, sample_rate_hz: f64) -> Result<Self, ParameterError> {
        let mut car = Self::unconfigured();
        car.configure(config, sample_rate_hz)?;
        Ok(car)
    }

    /// Memory for a car, as a constant: for a `static`, to be [configured](Self::configure) where it lies. Until then it is a car
    /// without corners and wheel speeds, of which nothing is estimated.
    #[must_use]
    pub const fn unconfigured() -> Self {
        Self::unconfigured_with(())
    }
}

impl<T: Real, S> MonitoredCar<T, S> {
    /// The same with other sensors: [`NoWheelSpeeds`](crate::torsion::NoWheelSpeeds), or `None`, where tooth pulses [may be
    /// read](Self::read_pulses).
    #[must_use]
    pub const fn unconfigured_with(sensors: S) -> Self {
        Self { estimator: Blank::BLANK, monitor: Blank::BLANK, wheels: Blank::BLANK, sensors }
    }
}

impl<T: Real, P> MonitoredCar<T, Option<P>> {
    /// Reads tooth pulses from here on, analysed in `torsion`: of this car's wheels, [configured](CarTorsion::configure).
    pub fn read_pulses(&mut self, torsion: P) {
        self.sensors = Some(torsion);
    }
}

impl<T: Real, S: WheelSensors<T>> MonitoredCar<T, S> {
    /// Configures the car as [`new`](Self::new) does, in place: it takes little stack. Whatever was there is forgotten, but for the tooth
    /// pulses: their analysis is configured by itself.
    ///
    /// # Errors
    /// As for [`new`](Self::new); the car is unconfigured then.
    pub fn configure(
        &mut self,
        config: &MonitorConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<(), ParameterError> {
        self.clear();
        if let Some(wheel_speeds) = &config.wheel_speeds {
            self.wheels.try_place(|wheels| wheels.configure(wheel_speeds))?;
        }
        let configured = match config.car.has_corners() {
            true => self.configure_corners(config, sample_rate_hz),
            false => Ok(()),
        };
        configured.inspect_err(|_| self.clear())
    }

    fn configure_corners(
        &mut self,
        config: &MonitorConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<(), ParameterError> {
        self.estimator.configure(&config.car, sample_rate_hz)?;
        self.estimator.set_options(&config.options);
        self.monitor.configure(config, sample_rate_hz)
    }

    fn clear(&mut self) {
        self.estimator.clear();
        self.monitor.clear();
        self.wheels.clear();
    }

    /// Loads the calibration of an earlier drive, before the first sample; one of wheel speeds goes to [`wheels_mut`](Self::wheels_mut).
    ///
    /// # Errors
    /// An implausible calibration, or one of other corners or other placard pressures.
    pub fn load_calibration(&mut self, calibration: &VehicleCalibration<T>) -> Result<(), CalibrationError> {
        self.estimator.load_calibration(calibration)
    }

    /// Takes one sample; gives the estimate after its accelerations, whose validity and warnings are the monitor's. Wheel speeds count if the
    /// car was [configured](MonitorConfig::wheel_speeds) with them, tooth pulses with the next of these. A sample that has wheel speeds and
    /// no corner leaves the accelerations as they are.
    pub fn update(&mut self, sample: &CarSample<T>) -> CarEstimate<T> {
        match S::SPEEDS && sample.is_of_wheel_speeds() {
            true => {
                self.take_wheel_speeds(sample);
                self.estimator.without_corners(sample.time_s)
            }
            false => self.take(sample),
        }
    }

    fn take(&mut self, sample: &CarSample<T>) -> CarEstimate<T> {
        let at = self.estimator.clock().take(sample.time_s, sample.speed_m_s);
        let watched = self.estimator.has_corners();
        let (at, screened) = if watched { self.monitor.screen(&at, sample) } else { (at, *sample) };
        let suspected = self.monitor.take_rollback_request();
        if !suspected.is_empty() {
            self.estimator.rollback(Corner::ALL.map(|corner| suspected.contains(corner)));
        }
        let mut estimate = self.estimator.update_at(&at, &screened, watched && self.monitor.is_busy_at(&at));
        // Without corners the report is the wheel speeds'.
        if watched {
            for corner in self.monitor.judge(&at, &mut estimate).iter() {
                self.estimator.restart_corner(corner);
            }
        }
        self.take_wheel_speeds(sample);
        estimate
    }

    /// The pressures learn from these if four corners are there and their axles share the road.
    fn take_wheel_speeds(&mut self, sample: &CarSample<T>) {
        let Some(message) = sample.wheel_speeds.as_ref().filter(|_| S::SPEEDS) else { return };
        if let Some(wheels) = self.wheels.as_mut() {
            wheels.update_with_pulses(message, self.sensors.torsion_mut());
        }
        self.follow_wheels();
    }

    fn follow_wheels(&mut self) {
        let Some(wheels) = self.wheels.as_ref() else { return };
        if wheels.has_news() {
            self.estimator.follow_radii(wheels.differences());
        }
        match self.estimator.has_corners() {
            true => self.monitor.follow_wheels(wheels),
            false => wheels.write_report_into(self.monitor.report_mut()),
        }
    }

    /// The report after the last sample.
    pub fn report(&self) -> &MonitorReport<T> {
        self.monitor.report()
    }

    /// The monitor of the wheel speeds, of a car that was [configured](MonitorConfig::wheel_speeds) with them.
    pub fn wheels(&self) -> Option<&MonitoredWheels<T>> {
        self.wheels.as_ref()
    }

    /// The same, to load calibrations and days.
    pub fn wheels_mut(&mut self) -> Option<&mut MonitoredWheels<T>> {
        self.wheels.as_mut()
    }

    /// Whether the speed says that the car stands while its wheels roll ([`Monitor::denies_standstill`]).
    pub fn denies_standstill(&self) -> bool {
        self.monitor.denies_standstill()
    }

    /// The analysis of the tooth pulses, where they are read.
    pub fn torsion(&self) -> Option<&CarTorsion<T>> {
        self.sensors.torsion()
    }

    /// The same, to take in the [edges](CarTorsion::push) up to the next sample, and to begin with what an earlier drive taught.
    pub fn torsion_mut(&mut self) -> Option<&mut CarTorsion<T>> {
        self.sensors.torsion_mut()
    }

    /// The driver's calibration: all tires have their placard pressures from the next sample on. The estimator learns the car for
    /// `seconds`, and how its wheels' radii differ; the monitor then takes what the warm tires are read to have for what they should have.
    /// Before the first sample, too.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.begin_calibration_at(seconds, &[T::one(); 4])
    }

    /// The same where each tire has this share of its placard pressure, which only wheel speeds and pulses are calibrated at.
    ///
    /// # Errors
    /// As for [`begin_calibration`](Self::begin_calibration).
    pub fn begin_calibration_at(
        &mut self,
        seconds: f64,
        pressure_share: &[T; 4],
    ) -> Result<(), ParameterError> {
        if self.estimator.has_corners() {
            self.estimator.begin_calibration(seconds)?;
            self.monitor.begin_calibration(seconds)?;
        }
        if let Some(wheels) = self.wheels.as_mut() {
            wheels.begin_calibration_at(seconds, pressure_share)?;
        }
        if let Some(torsion) = self.sensors.torsion_mut() {
            torsion.begin_calibration_at(pressure_share);
        }
        self.follow_wheels();
        Ok(())
    }

    /// Ends the calibration that is to begin or under way, as where a log ends with it; its result is there then.
    pub fn end_calibration(&mut self) {
        self.estimator.end_calibration();
        self.monitor.end_calibration();
        if let Some(wheels) = self.wheels.as_mut().filter(|wheels| wheels.is_calibrating()) {
            wheels.end_calibration();
            if let Some(torsion) = self.sensors.torsion_mut() {
                torsion.end_calibration();
            }
        }
    }

    /// Takes the stiffness of a corner's tire that another source follows from the next sample on, in place of what the corner's
    /// own frames show, until `None` is given.
    pub fn follow(&mut self, corner: Corner, stiffness: Option<OutsideStiffness<T>>) {
        self.estimator.follow(corner, stiffness);
    }

    /// Takes the air around the car as measured ([`Monitor::follow_air`]), before the sample of the same time.
    pub fn follow_air(&mut self, air: &Air<T>) {
        self.monitor.follow_air(air);
    }

    /// The estimator.
    pub fn estimator(&self) -> &CarEstimator<T> {
        &self.estimator
    }
}
