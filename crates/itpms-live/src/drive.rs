//! The running estimate: the car under its monitor, and what is counted along the way.
//!
//! Owned by the engine, which hands it row after row. Knows nothing of sources, threads and outputs: the same rows give the
//! same estimates, here and in `itpms estimate`.

use itpms_analysis::odometer::Odometer;
use itpms_core::model::{CarEstimate, CarSample};
use itpms_core::monitor::MonitorConfig;
use itpms_core::warning::{Change, MonitorReport};
use itpms_data::out::RateGate;
use itpms_data::pulses::Pulse;
use itpms_data::{LogRow, Vehicle};
use itpms_road::RoadUnderCar;

use crate::beside::BesideWatch;
pub use crate::clock::Clock;
use crate::error::LiveError;
pub use crate::options::DriveOptions;
pub use crate::reported::Reported;
use crate::roughness::Roughness;
use crate::speed::SpeedDoubt;
use crate::wheels::{self, Car, lacks};

/// A drive being estimated. Made and restored in parts that are moved about: whoever does so needs a stack as a program's first
/// thread has it (8 MB), not a test's.
#[derive(Debug)]
pub struct Drive {
    pub(crate) clock: Clock,
    pub(crate) car: Box<Car>,
    pub(crate) road: RoadUnderCar<f64>,
    /// Of speeds of rotation; NaN where the vehicle file has none.
    pub(crate) rolling_radius_m: f64,
    pub(crate) gate: RateGate,
    pub(crate) progress: Progress,
    pub(crate) roughness: Roughness,
    pub(crate) beside: BesideWatch,
    pub(crate) latest: Option<CarEstimate<f64>>,
}

/// Counters that are saved with the estimate.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Progress {
    pub(crate) rows: u64,
    pub(crate) time_s: f64,
    pub(crate) odometer: Odometer,
    /// The last report: transitions are found against it.
    pub(crate) before: Option<MonitorReport<f64>>,
}

impl Drive {
    /// A drive about to begin. Errors: parameters or a reference that the estimator refuses.
    pub fn new(vehicle: &Vehicle, clock: Clock, options: &DriveOptions) -> Result<Self, LiveError> {
        let config = vehicle.car_config(&clock.corners);
        let refused = |error: &dyn std::fmt::Display| LiveError::Refused(error.to_string());
        let (limits, home_kpa) = (options.regulation.into(), vehicle.home_kpa());
        let wheel_speeds =
            clock.wheel_speeds.then(|| vehicle.wheel_speed_config()).transpose().map_err(lacks)?;
        let config = MonitorConfig { limits, home_kpa, wheel_speeds, ..MonitorConfig::new(&config) };
        let mut car = Box::new(Car::unconfigured_with(None));
        car.configure(&config, clock.sample_rate_hz).map_err(|error| refused(&error))?;
        let mut road = RoadUnderCar::unconfigured();
        if config.car.has_corners() {
            road.configure(&config.car, clock.sample_rate_hz).map_err(|error| refused(&error))?;
            if let Some(calibration) = &options.reference {
                car.load_calibration(calibration).map_err(|error| refused(&error))?;
            }
        }
        if options.pulses && !clock.wheel_speeds {
            return Err(refused(
                &"tooth pulses count together with wheel speeds, and the source has none that can be used: expected the speeds of all four wheels",
            ));
        }
        wheels::begin(&mut car, vehicle, options)?;
        if let Some(seconds) = options.calibrate_s {
            car.begin_calibration(seconds).map_err(|error| refused(&error))?;
        }
        let roughness = Roughness::new(&clock)?;
        let beside = BesideWatch::new(vehicle, &clock, options);
        let progress = Progress { rows: 0, time_s: f64::NAN, odometer: Odometer::new(), before: None };
        Ok(Self {
            clock,
            car,
            road,
            rolling_radius_m: vehicle.rolling_radius_m().unwrap_or(f64::NAN),
            gate: RateGate::new(options.rate_hz),
            progress,
            roughness,
            beside,
            latest: None,
        })
    }

    /// Takes a tooth pulse, before the first row that is not earlier. One of before the last row was taken then, or is lost.
    pub(crate) fn pulse(&mut self, pulse: &Pulse) {
        let is_new = !(pulse.time_s <= self.progress.time_s);
        if let Some(torsion) = self.car.torsion_mut().filter(|_| is_new) {
            torsion.push(pulse.wheel, pulse.time_s);
        }
    }

    /// Takes a row; gives what began and ended to `reported`. `true` if an estimate is due to be published.
    pub fn update(&mut self, row: &LogRow, mut reported: impl FnMut(f64, Reported)) -> bool {
        self.car.follow_air(&row.motion.air);
        let rolls = self.car.wheels().is_some();
        let message = rolls.then(|| row.motion.sample(row.time_s, self.rolling_radius_m));
        let sample = CarSample { wheel_speeds: message, ..row.sample() };
        let mut estimate = self.car.update(&sample);
        self.road.update(&sample, &self.car.estimator().quarter_cars(), &mut estimate);
        let progress = &mut self.progress;
        (progress.rows, progress.time_s) = (progress.rows + 1, row.time_s);
        // Nothing else is known of a car without corners.
        let alone = message.filter(|_| self.clock.corners.is_empty());
        let rolls_m_s = alone.map(|message| 0.25 * message.wheel_speed_m_s.iter().sum::<f64>());
        let measured_m_s = match rolls_m_s {
            Some(rolls_m_s) if row.speed_m_s.is_nan() => rolls_m_s,
            _ if self.car.denies_standstill() => f64::NAN,
            _ => row.speed_m_s,
        };
        let speed_m_s = progress.odometer.push(row.time_s, measured_m_s);
        self.roughness.push(&estimate, speed_m_s, progress.odometer.distance_m());
        self.beside.take(row, speed_m_s, &estimate.corners, &self.car, &mut reported);
        self.latest = Some(estimate);
        let report = self.car.report();
        if self.progress.before.as_ref().is_none_or(|before| before.time_s != report.time_s) {
            let time_s = report.time_s;
            match self.progress.before.replace(*report) {
                None => {
                    report
                        .alerts()
                        .for_each(|alert| reported(time_s, Reported::Change(Change::Begun(*alert))));
                }
                Some(before) => report
                    .changes_since(&before)
                    .for_each(|change| reported(time_s, Reported::Change(change))),
            }
        }
        self.gate.lets_through(row.time_s)
    }

    /// There are no more rows: what takes a while is worked out of all of them.
    pub(crate) fn finish(&mut self) {
        self.beside.finish(&self.car);
    }

    /// The monitor's report after the last row.
    pub fn report(&self) -> &MonitorReport<f64> {
        self.car.report()
    }

    /// The estimate after the last row.
    pub fn latest(&self) -> Option<&CarEstimate<f64>> {
        self.latest.as_ref()
    }

    /// Why the speed of the car is unknown; `None` where it is known.
    pub fn speed_doubt(&self) -> Option<SpeedDoubt> {
        match self.progress.odometer.speed_m_s().is_nan() {
            true if self.car.denies_standstill() => Some(SpeedDoubt::Contradicted),
            true => Some(SpeedDoubt::Missing),
            false => None,
        }
    }

    /// Time of the last row in s; NaN before the first.
    pub fn time_s(&self) -> f64 {
        self.progress.time_s
    }
}
