//! The estimator of a drive's car, and what it says after a row.

use itpms_core::car::{CarEstimate, CarEstimator, LearnedReference};
use itpms_core::estimate::CornerEstimate;
use itpms_core::monitor::{Monitor, MonitorConfig, MonitorReport, MonitoredCar};
use itpms_core::quarter_car::QuarterCar;
use itpms_core::sample::Corner;
use itpms_core::speed::SpeedHold;
use itpms_data::{LogRow, Vehicle};

use super::reference;
use crate::args::EstimateArgs;
use crate::exit::Failure;

/// What is known of the corners after a row, in the order of [`Corner::ALL`].
pub(super) type Estimates = [Option<CornerEstimate<f64>>; 4];

/// Load and damping as identified, in the order of [`Corner::ALL`].
pub(super) type QuarterCars = [Option<QuarterCar<f64>>; 4];

/// Speed in m/s above which front and rear should be found to meet the same road, and seconds of that after which they
/// should have been: in everyday driving it takes two.
const MEETING_M_S: f64 = 5.0;
const MEETING_S: f64 = 60.0;
/// Share of the time for which a speed may be unknown before that is said.
const UNKNOWN_SHARE: f64 = 0.1;

/// Speed in m/s that a car which stands does not reach, and rms of a wheel's acceleration that it does not either: engines
/// and doors make a tenth.
pub(super) const STANDING_M_S: f64 = 0.5;
const MOVING_WHEEL_M_S2: f64 = 1.0;

/// The running estimator under its monitor.
pub(super) struct Drive {
    car: Box<MonitoredCar<f64>>,
    /// Time of the first and of the last row, and seconds driven until front and rear of any side were found to meet the same road.
    first_s: f64,
    time_s: f64,
    apart_s: f64,
    met: bool,
    /// Seconds of rows, and of those in which nobody knew the speed.
    speed: SpeedHold<f64>,
    passed_s: f64,
    unknown_s: f64,
    /// The highest speed, and how every wheel moves.
    fastest_m_s: f64,
    wheels: [Motion; 4],
}

/// Mean and mean square of the accelerations so far.
#[derive(Debug, Clone, Copy, Default)]
struct Motion {
    count: f64,
    mean: f64,
    square: f64,
}

impl Motion {
    fn take(&mut self, value: f64) {
        if value.is_finite() {
            self.count += 1.0;
            self.mean += (value - self.mean) / self.count;
            self.square += (value * value - self.square) / self.count;
        }
    }

    fn rms(&self) -> f64 {
        (self.square - self.mean * self.mean).max(0.0).sqrt()
    }
}

impl Drive {
    pub(super) fn new(
        args: &EstimateArgs,
        vehicle: &Vehicle,
        corners: &[Corner],
        sample_rate_hz: f64,
    ) -> Result<Self, Failure> {
        let config = vehicle.car_config(corners);
        let fail = |error| Failure::Usage(format!("{error}"));
        let car = CarEstimator::new(args.estimator, &config, sample_rate_hz).map_err(fail)?;
        let car = car.with_road_repetition(args.road_repeats);
        let car = reference::told(args, vehicle, car)?;
        let told = MonitorConfig::new(&config).with_limits(args.regulation.into());
        let monitor = Monitor::new(&told, sample_rate_hz).map_err(fail)?;
        let mut car = Box::new(MonitoredCar::new(car, monitor));
        if let Some(seconds) = args.calibrate_s {
            car.begin_reset(seconds).map_err(fail)?;
        }
        Ok(Self {
            car,
            first_s: f64::NAN,
            time_s: f64::NAN,
            apart_s: 0.0,
            met: false,
            speed: SpeedHold::new(),
            passed_s: 0.0,
            unknown_s: 0.0,
            fastest_m_s: f64::NEG_INFINITY,
            wheels: [Motion::default(); 4],
        })
    }

    /// The cars as they seem to be now, in the order of [`Corner::ALL`].
    pub(super) fn quarter_cars(&self) -> QuarterCars {
        self.car.estimator().quarter_cars()
    }

    /// What the reset taught, once it is over.
    pub(super) fn learned(&self) -> Option<LearnedReference<f64>> {
        self.car.estimator().learned()
    }

    /// What the monitor says after the last row.
    pub(super) fn report(&self) -> &MonitorReport<f64> {
        self.car.report()
    }

    /// Seconds from the first row to the last.
    pub(super) fn length_s(&self) -> f64 {
        self.time_s - self.first_s
    }

    /// Whether the car has been driven for long, and front and rear never met the same road.
    pub(super) fn never_met(&self) -> bool {
        !self.met && self.apart_s > MEETING_S
    }

    /// The share of the time in which nobody knew the speed, if it is more than should be.
    pub(super) fn speed_unknown(&self) -> Option<f64> {
        Some(self.unknown_s / self.passed_s).filter(|share| *share > UNKNOWN_SHARE)
    }

    /// How much the wheels move, in m/s² rms, of a car that is said to stand for all of its drive and does not look like it.
    pub(super) fn moves_at_no_speed(&self) -> Option<f64> {
        let most = self.wheels.iter().map(Motion::rms).fold(0.0, f64::max);
        let stands = self.fastest_m_s.is_finite() && self.fastest_m_s <= STANDING_M_S;
        (stands && most > MOVING_WHEEL_M_S2).then_some(most)
    }

    pub(super) fn update(&mut self, row: &LogRow) -> CarEstimate<f64> {
        self.fastest_m_s = self.fastest_m_s.max(row.speed_m_s);
        for (wheel, corner) in self.wheels.iter_mut().zip(&row.corners) {
            wheel.take(corner.as_ref().map_or(f64::NAN, |corner| corner.wheel_accel_m_s2));
        }
        let estimate = self.car.update(&row.sample());
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
            self.apart_s += if speed_m_s > MEETING_M_S { step_s } else { 0.0 };
        }
        estimate
    }
}
