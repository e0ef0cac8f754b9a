//! The estimator of a drive's car, and what it says after a row.

use itpms_core::car::CarEstimator;
use itpms_core::conditioning::{SpeedHold, is_a_cars};
use itpms_core::model::{BodyFit, CarEstimate, CarSample, Corner, CornerEstimate, Misfit, QuarterCar};
use itpms_core::monitor::{MonitorConfig, MonitoredWheels};
use itpms_core::torsion::{CarTorsion, TorsionChange};
use itpms_core::warning::MonitorReport;
use itpms_data::out::{RadiusRow, WheelSpeedUse};
use itpms_data::pulses::Pulse;
use itpms_data::reference::StoredReference;
use itpms_data::{LogRow, Vehicle};
use itpms_road::{RepeatedRoads, RoadRepetition, RoadUnderCar};

use crate::car::AnyCar;
use crate::error::DriveError;
use crate::reference::{self, Taught};
use crate::settings::{LOG_END_S, Settings};
use crate::wheel_speeds::{self, WheelSpeeds, YawFault, lacks};

/// The corners' estimates after a row, in the order of [`Corner::ALL`].
pub type Estimates = [Option<CornerEstimate<f64>>; 4];

/// Load and damping as identified, in the order of [`Corner::ALL`].
pub type QuarterCars = [Option<QuarterCar<f64>>; 4];

/// Speed in m/s above which front and rear should be found to meet the same road, and seconds of that after which they
/// should have been: in everyday driving it takes two.
const MEETING_M_S: f64 = 5.0;
const MEETING_S: f64 = 15.0;
/// Share of the time for which a speed may be unknown before that is reported.
const UNKNOWN_SHARE: f64 = 0.1;

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Drive {
    car: AnyCar,
    road: RoadUnderCar<f64>,
    /// Roads that repeat themselves, for the default estimator; on the heap as the car is.
    repeated: Option<Box<RepeatedRoads<f64>>>,
    wheels: Option<WheelSpeeds>,
    /// Time of the first and of the last row, and seconds driven until front and rear of any side were found to meet the same road.
    first_s: f64,
    time_s: f64,
    apart_s: f64,
    met: bool,
    /// Seconds of rows, and of those in which the speed was unknown.
    speed: SpeedHold<f64>,
    passed_s: f64,
    unknown_s: f64,
    /// Rows whose speed no car has, and the first such speed.
    absurd: Option<(u64, f64)>,
    /// Seconds for which the speed was zero while its wheels rolled.
    denied_s: f64,
}

impl Drive {
    /// The estimator of these corners, and of the wheel speeds, at this rate; without corners of the wheel speeds alone.
    /// Errors: a rate or a setting that the estimator refuses, or a stored reference that cannot be used.
    pub fn new(
        settings: &Settings,
        vehicle: &Vehicle,
        corners: &[Corner],
        wheel_speeds: WheelSpeedUse,
        sample_rate_hz: f64,
    ) -> Result<Self, DriveError> {
        let stored = reference::read(settings, vehicle)?;
        let (vehicle, stored) =
            stored.as_ref().map_or((vehicle, None), |(vehicle, stored)| (vehicle, Some(stored)));
        Self::with_reference(settings, stored, vehicle, corners, wheel_speeds, sample_rate_hz)
    }

    /// The same with the contents of the settings' reference, and the vehicle from which that counts.
    /// Errors: as [`Drive::new`].
    pub fn with_reference(
        settings: &Settings,
        stored: Option<&StoredReference>,
        vehicle: &Vehicle,
        corners: &[Corner],
        wheel_speeds: WheelSpeedUse,
        sample_rate_hz: f64,
    ) -> Result<Self, DriveError> {
        let alone = corners.is_empty();
        let mut wheel_speeds = (wheel_speeds != WheelSpeedUse::None)
            .then(|| vehicle.wheel_speed_config().map_err(|key| lacks(vehicle, key)))
            .transpose()?;
        wheel_speeds.iter_mut().for_each(|config| config.tuning = settings.tuning.wheel_speed);
        if let Some(path) = settings.pulses.as_ref().filter(|_| wheel_speeds.is_none()) {
            return Err(DriveError::Mismatch(format!(
                "{}: tooth pulses count together with wheel speeds, and the log has none that can be used: expected {{c}}_wheel_speed_m_s or {{c}}_wheel_speed_rad_s of all four",
                path.display()
            )));
        }
        let (corners, home_kpa) = (vehicle.car_config(corners), vehicle.home_kpa());
        let limits = settings.regulation.into();
        let tuning = settings.tuning.monitor;
        let config = MonitorConfig { limits, home_kpa, wheel_speeds, tuning, ..MonitorConfig::new(&corners) };
        if !alone && settings.calibration_kpa.iter().any(Option::is_some) {
            let what = "pressures of the calibration other than the placards' (--pressure-kpa) are of use for wheel speeds alone";
            return Err(DriveError::Mismatch(what.to_owned()));
        }
        let mut car = AnyCar::new(settings.estimator, &config, sample_rate_hz)?;
        if let Some(stored) = stored.filter(|stored| !alone && stored.has_corners()) {
            reference::load(settings, &stored.reference, &mut car)?;
        }
        if settings.pulses.is_some() {
            car.read_pulses(wheel_speeds::torsion(vehicle)?);
        }
        if let Some(seconds) = settings.calibrate_s {
            car.begin_calibration(seconds, &settings.pressure_shares(vehicle))?;
        }
        let wheels = wheel_speeds.map(|_| WheelSpeeds::new(settings, vehicle, alone, stored, &mut car));
        let wheels = wheels.transpose()?;
        let repeats = settings.road_repeats != RoadRepetition::Never;
        let repeated = (!alone && repeats && car.estimator().is_some())
            .then(|| RepeatedRoads::new(&corners, sample_rate_hz, settings.road_repeats).map(Box::new))
            .transpose()?;
        Ok(Self {
            car,
            road: RoadUnderCar::unconfigured(),
            repeated,
            wheels,
            first_s: f64::NAN,
            time_s: f64::NAN,
            apart_s: 0.0,
            met: false,
            speed: SpeedHold::new(),
            passed_s: 0.0,
            unknown_s: 0.0,
            absurd: None,
            denied_s: 0.0,
        })
    }

    /// The same with the causal road under each wheel, which costs a quarter of the time.
    /// Errors: parameters of a corner that the road's filter refuses are named.
    pub fn with_road(
        mut self,
        vehicle: &Vehicle,
        corners: &[Corner],
        sample_rate_hz: f64,
    ) -> Result<Self, DriveError> {
        // The paper's filters bring the road with them.
        if self.car.estimator().is_some() {
            self.road.configure(&vehicle.car_config(corners), sample_rate_hz)?;
        }
        Ok(self)
    }

    /// The estimator, but for those of the paper.
    pub fn estimator(&self) -> Option<&CarEstimator<f64>> {
        self.car.estimator()
    }

    /// The cars as they seem to be now, in the order of [`Corner::ALL`].
    pub fn quarter_cars(&self) -> QuarterCars {
        self.car.estimator().map_or([None; 4], CarEstimator::quarter_cars)
    }

    /// The log is over. A calibration as long as the log (within 1 s) ends here, too.
    pub fn finish(&mut self, calibrate_s: Option<f64>) {
        if calibrate_s.is_some_and(|seconds| self.length_s() + LOG_END_S >= seconds) {
            self.car.end_calibration();
        }
    }

    /// The result of the calibration, once it is over.
    pub fn learned(&self) -> Taught {
        let wheel_speeds = self.car.wheels().and_then(MonitoredWheels::calibration).copied();
        let torsion = self.car.torsion().map_or([None; 4], CarTorsion::calibration);
        let corners = self.car.estimator().and_then(CarEstimator::calibration);
        let days =
            self.wheels.as_ref().zip(self.car.wheels()).and_then(|(wheels, monitor)| wheels.days(monitor));
        Taught { corners, wheel_speeds, torsion, suspension: None, days }
    }

    /// The rows' times count from here, in s since 1970; zero: from there, or from no date.
    pub fn clock_began(&mut self, unix_s: f64) {
        if let (Some(wheels), Some(monitor)) = (&mut self.wheels, self.car.wheels_mut()) {
            wheels.clock_began(unix_s);
            monitor.clock_began(unix_s);
        }
    }

    /// Whether the calibration of the wheel speeds was driven on snow, and taught nothing.
    pub(crate) fn calibrated_on_snow(&self) -> bool {
        self.car.wheels().is_some_and(MonitoredWheels::refused_snow)
    }

    /// Whether the yaw rate's sign contradicts the wheels.
    pub(crate) fn yaw_fault(&self) -> Option<YawFault> {
        self.wheels.as_ref().zip(self.car.wheels()).and_then(|(wheels, monitor)| wheels.yaw_fault(monitor))
    }

    /// The radius analysis of the wheel speeds, where they are used.
    pub fn radii(&self) -> Option<RadiusRow> {
        self.car.wheels().map(|wheels| RadiusRow {
            radii: *wheels.radii(),
            states: Corner::ALL.map(|corner| Some(wheels.state_of(corner))),
            slow_leak: *wheels.slow_leak(),
        })
    }

    /// Each tire's change since the calibration by its tooth pulses, where they are read.
    pub fn torsion(&self) -> Option<[Option<TorsionChange<f64>>; 4]> {
        self.car.torsion().map(CarTorsion::changes)
    }

    /// Takes a tooth pulse, before the first row that is not earlier.
    pub fn pulse(&mut self, pulse: &Pulse) {
        if let Some(torsion) = self.car.torsion_mut() {
            torsion.push(pulse.wheel, pulse.time_s);
        }
    }

    /// The monitor's report after the last row.
    pub fn report(&self) -> &MonitorReport<f64> {
        self.car.report()
    }

    pub fn length_s(&self) -> f64 {
        self.time_s - self.first_s
    }

    /// Whether the car has been driven for long, and front and rear never met the same road.
    pub fn never_met(&self) -> bool {
        !self.met && self.apart_s > MEETING_S
    }

    /// The share of the time in which the speed was unknown, if it is more than should be.
    pub fn speed_unknown(&self) -> Option<f64> {
        Some(self.unknown_s / self.passed_s).filter(|share| *share > UNKNOWN_SHARE)
    }

    /// How many rows have a speed in m/s that no car has, and the first such speed, if there are any.
    pub fn absurd_speeds(&self) -> Option<(u64, f64)> {
        self.absurd
    }

    /// Whether the speed says that the car stands while its wheels roll.
    pub fn denies_standstill(&self) -> bool {
        self.car.denies_standstill()
    }

    /// Seconds for which the speed was zero while its wheels rolled, if there were any.
    pub fn denied_s(&self) -> Option<f64> {
        Some(self.denied_s).filter(|seconds| *seconds > 0.0)
    }

    /// Corners whose body and wheel do not move as the vehicle file says, and what does not fit.
    pub fn misfits(&self) -> impl Iterator<Item = (Corner, Misfit)> + '_ {
        Corner::ALL.into_iter().filter_map(|corner| Some((corner, self.fit(corner)?.1?)))
    }

    /// How well body and wheel of a corner go together, and what does not, if the car has that corner.
    pub fn fit(&self, corner: Corner) -> Option<(BodyFit<f64>, Option<Misfit>)> {
        self.car.estimator()?.fit(corner)
    }

    /// By how much the spectra read more than the placard's pressures in the calibration, with its sd, in kPa.
    pub fn calibration_excess_kpa(&self) -> Option<[f64; 2]> {
        self.car.estimator()?.calibration_excess_kpa()
    }

    /// Seconds by which the speed was found to come late, if it was.
    pub fn speed_latency_s(&self) -> Option<f64> {
        Some(self.car.estimator()?.speed_latency_s()).filter(|seconds| *seconds != 0.0)
    }

    /// Takes a row; a speed that its wheels deny is taken out of it.
    pub fn update(&mut self, row: &mut LogRow) -> CarEstimate<f64> {
        if row.speed_m_s.is_finite() && !is_a_cars(row.speed_m_s) {
            self.absurd.get_or_insert((0, row.speed_m_s)).0 += 1;
        }
        self.car.follow_air(&row.motion.air);
        let message = self.wheels.as_mut().map(|wheels| wheels.sample(row, &mut self.car));
        let sample = CarSample { wheel_speeds: message, ..row.sample() };
        let mut estimate = self.car.update(&sample);
        if let Some(estimator) = self.car.estimator() {
            let quarter_cars = estimator.quarter_cars();
            if let Some(repeated) = &mut self.repeated {
                let car = &mut self.car;
                repeated.update(&sample, &quarter_cars, &estimate, |corner, stiffness| {
                    car.follow(corner, stiffness)
                });
            }
            self.road.update(&sample, &quarter_cars, &mut estimate);
        }
        let step_s = row.time_s - self.time_s;
        self.time_s = row.time_s;
        if self.first_s.is_nan() {
            self.first_s = row.time_s;
        }
        self.met |= estimate.tracks.iter().any(|track| track.shared);
        let speed_m_s = self.speed.take(row.time_s, row.speed_m_s);
        if step_s < 1.0 {
            self.passed_s += step_s;
            self.unknown_s += if speed_m_s.is_nan() { step_s } else { 0.0 };
            self.denied_s += if self.car.denies_standstill() { step_s } else { 0.0 };
            self.apart_s += if speed_m_s > MEETING_M_S { step_s } else { 0.0 };
        }
        if self.car.denies_standstill() {
            row.speed_m_s = f64::NAN;
        }
        if let Some((wheels, message)) = self.wheels.as_mut().zip(message) {
            wheels.look(row, &message);
        }
        estimate
    }
}
