//! The causal road estimate of one corner: what comes in is checked, what is set takes effect, what goes out is
//! flagged (docs/math/road.md, section 3).
//!
//! Called with every sample of a corner, by an estimator that knows the tire's stiffness or by
//! [`crate::RoadRecorder`]. Knows nothing of pressure, speed or other corners.
use crate::clock::{Arrival, Clock};
use crate::config::{RoadConfig, RoadLevel};
use crate::level::LevelTracker;
use crate::model::{CoreState, FIRST_INTERVAL_S, Model, Transition, road_bandwidth, state};
use crate::recursion::{Correction, Lean, Recursion};
use itpms_core::Real;
use itpms_core::model::{CornerSample, ParameterError, QuarterCar, Validity, positive};

/// Accelerations beyond this, in m/s², are no road but a broken signal.
const LARGEST_M_S2: f64 = 2_000.0;
/// How often level and rate may change the model, in s.
const FOLLOW_PERIOD_S: f64 = 0.1;
/// Smallest change of a logarithm that is worth a new discretisation.
const WORTH_FOLLOWING: f64 = 0.1;
/// Level assumed until it is learned: class B at 20 km/h.
const FIRST_LOG_LEVEL: f64 = -9.0;
/// Until then the sensors' offsets are not yet distinguished from the road.
const SETTLING_S: f64 = 5.0;
/// Without the wheel's acceleration for so long, the road is a guess.
const BLIND_S: f64 = 0.1;

/// The road under one wheel after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadEstimate<T> {
    /// Time in s the height belongs to: that of the sample less the sensors' delay.
    pub road_time_s: f64,
    /// Road height in m behind the configured high-pass (0.05 Hz, second order), from all samples so far.
    pub road_m: T,
    /// Its standard deviation in m. Most of it is slow drift, which two accelerometers cannot see before it is over;
    /// for a band of wavelengths use [`crate::RoadLimits::band_sd_m`].
    pub road_sd_m: T,
    /// Tire deflection `x_r - x_w` in m, positive when the road pushes.
    pub tire_deflection_m: T,
    /// Mean of the squared normalised innovations of this sample, NaN without a measurement. One to ten on roads: the model's road has a
    /// limited bandwidth (eq. 2), and good sensors see that. A hundred and more is a broken signal or wrong parameters.
    pub nis: T,
    pub validity: Validity,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Advance<T: Real> {
    /// The step taken, `None` for the first sample and after a restart.
    pub(crate) step: Option<Lean>,
    /// The body's and the wheel's correction, `None` where the sample had no value.
    pub(crate) corrections: [Option<Correction<T>>; 2],
    /// False when the sample's time was impossible: nothing happened.
    pub(crate) accepted: bool,
}

impl<T: Real> Advance<T> {
    fn without_data(accepted: bool) -> Self {
        Self { step: None, corrections: [None; 2], accepted }
    }
}

/// Causal road height of one corner.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadFilter<T: Real> {
    config: RoadConfig<T>,
    model: Model<T>,
    /// Relative standard deviation of the tire's stiffness.
    stiffness_sd: T,
    recursion: Recursion<T>,
    clock: Clock<T>,
    level: LevelTracker<T>,
    unfollowed_s: T,
    running_s: T,
    blind_s: T,
    body_accel_m_s2: Option<T>,
    /// Squared normalised innovations of the last sample, `None` without a measurement.
    nis: Option<T>,
    restarts: u32,
}

impl<T: Real> RoadFilter<T> {
    pub fn new(config: &RoadConfig<T>) -> Self {
        let log_level = match config.level {
            RoadLevel::Fixed(log_level) => log_level,
            RoadLevel::Adaptive => T::lit(FIRST_LOG_LEVEL),
        };
        let model = Model::of(config, log_level);
        Self {
            config: *config,
            model,
            stiffness_sd: T::zero(),
            recursion: Recursion::new(&model, config.bias_sd_m_s2),
            clock: Clock::new(),
            level: LevelTracker::new(log_level),
            unfollowed_s: T::zero(),
            running_s: T::zero(),
            blind_s: T::zero(),
            body_accel_m_s2: None,
            nis: None,
            restarts: 0,
        }
    }

    /// Take the tire's stiffness and its standard deviation, both in N/m. The deviation goes into the road's; another
    /// stiffness costs a discretisation at the next sample (about 5 000 multiplications).
    /// Errors: the stiffness must be positive and finite, its deviation finite and not negative; the old values stay.
    pub fn set_stiffness(&mut self, n_per_m: T, sd_n_per_m: T) -> Result<(), ParameterError> {
        let n_per_m = positive("stiffness_n_per_m", n_per_m)?;
        if !(sd_n_per_m >= T::zero() && sd_n_per_m.is_finite()) {
            return Err(ParameterError {
                name: "stiffness_sd_n_per_m",
                value: sd_n_per_m.to_f64(),
                expected: "a finite number, zero or more",
            });
        }
        self.stiffness_sd = sd_n_per_m / n_per_m;
        if n_per_m != self.model.stiffness_n_per_m {
            self.model.stiffness_n_per_m = n_per_m;
            self.recursion.forget_transitions();
        }
        Ok(())
    }

    /// Take other masses, spring and damper, as identified on the way. Costs like [`RoadFilter::set_stiffness`].
    pub fn set_quarter_car(&mut self, quarter_car: QuarterCar<T>) {
        if quarter_car != self.model.car {
            self.model.car = quarter_car;
            self.recursion.forget_transitions();
        }
    }

    /// The road level in use, learned or given: see [`RoadLevel`].
    pub fn log_level(&self) -> T {
        self.level.log_level()
    }

    /// Usual sampling interval in s as it was seen, 0 before the second sample.
    pub fn interval_s(&self) -> T {
        self.clock.interval_s()
    }

    pub fn sensor_delay_s(&self) -> T {
        self.config.sensor_delay.delay_s(self.clock.interval_s())
    }

    /// Estimated offsets of the body's and the wheel's accelerometer in m/s².
    pub fn sensor_offsets_m_s2(&self) -> [T; 2] {
        let x = self.recursion.mean();
        [x[state::BODY_BIAS], x[state::WHEEL_BIAS]]
    }

    /// How often the computation left its range or the clock was set, and the filter began anew.
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// One more sample. A missing or absurd value is left out, a sample at an impossible time is ignored; both are flagged.
    pub fn update(&mut self, time_s: f64, sample: &CornerSample<T>) -> RoadEstimate<T> {
        let advance = self.advance(time_s, sample);
        let estimate = self.estimate();
        if advance.accepted { estimate } else { RoadEstimate { validity: Validity::BadSignal, ..estimate } }
    }

    /// The estimate after the last sample.
    pub fn estimate(&self) -> RoadEstimate<T> {
        let x = self.recursion.mean();
        let variance = self.recursion.road_variance_m2() + self.stiffness_variance_m2();
        RoadEstimate {
            road_time_s: self.clock.time_s() - self.sensor_delay_s().to_f64(),
            road_m: x[state::ROAD],
            road_sd_m: variance.max(T::zero()).sqrt(),
            tire_deflection_m: x[state::TIRE],
            nis: self.nis.unwrap_or_else(|| T::lit(f64::NAN)),
            validity: self.validity(),
        }
    }

    fn validity(&self) -> Validity {
        if self.blind_s > T::lit(BLIND_S) {
            Validity::BadSignal
        } else if self.running_s < T::lit(SETTLING_S) {
            Validity::Starting
        } else {
            Validity::Valid
        }
    }

    /// One more sample, with the account the backward pass needs.
    pub(crate) fn advance(&mut self, time_s: f64, sample: &CornerSample<T>) -> Advance<T> {
        let step_s = match self.clock.take(time_s) {
            Arrival::Next(step_s) => Some(step_s),
            Arrival::First => None,
            Arrival::Anew => {
                self.restart();
                None
            }
            Arrival::Ignored => return Advance::without_data(false),
        };
        let body = believable(sample.body_accel_m_s2);
        let wheel = believable(sample.wheel_accel_m_s2);
        let step = step_s.map(|step_s| self.predict(step_s, body));
        let corrections = self.correct(body, wheel);
        self.nis = mean_nis(&corrections);
        self.keep_accounts(step_s.unwrap_or_else(T::zero), body, wheel);
        if self.recursion.is_sound() {
            Advance { step, corrections, accepted: true }
        } else {
            self.restart();
            Advance::without_data(true)
        }
    }

    /// Leans on the body's acceleration where it was measured at both ends of the step.
    fn predict(&mut self, step_s: T, body: Option<T>) -> Lean {
        if self.unfollowed_s > T::lit(FOLLOW_PERIOD_S) {
            self.unfollowed_s = T::zero();
            self.follow();
        }
        let mean = self.body_accel_m_s2.zip(body).map(|(before, now)| T::lit(0.5) * (before + now));
        self.recursion.predict(&self.model, step_s, mean)
    }

    fn correct(&mut self, body: Option<T>, wheel: Option<T>) -> [Option<Correction<T>>; 2] {
        let (model, interval_s) = (&self.model, self.usual_interval_s());
        let recursion = &mut self.recursion;
        [
            body.map(|y| recursion.correct(model.body_row(), y, model.body_variance(interval_s))),
            wheel.map(|y| recursion.correct(model.wheel_row(), y, model.noise_variance)),
        ]
    }

    fn keep_accounts(&mut self, step_s: T, body: Option<T>, wheel: Option<T>) {
        self.body_accel_m_s2 = body;
        self.running_s += step_s.min(T::lit(BLIND_S));
        self.unfollowed_s += step_s;
        self.blind_s = if wheel.is_some() { T::zero() } else { self.blind_s + step_s };
        if let (Some(y), RoadLevel::Adaptive) = (wheel, self.config.level) {
            let power = self.model.wheel_power_per_intensity();
            self.level.update(y, step_s, self.model.noise_variance, power);
            if self.running_s > T::lit(SETTLING_S) {
                self.level.update_slow(self.recursion.mean()[state::ROAD], step_s);
            }
        }
    }

    /// Lets the model follow the level and the sampling rate where they moved.
    fn follow(&mut self) {
        let intensity = T::lit(0.5) * self.level.log_level().exp();
        let bandwidth = road_bandwidth(self.usual_interval_s());
        let moved = |to: T, from: T| (to / from).ln().abs() > T::lit(WORTH_FOLLOWING);
        if moved(intensity, self.model.road_intensity)
            || moved(bandwidth, self.model.road_bandwidth_rad_per_s)
        {
            self.model.road_intensity = intensity;
            self.model.road_bandwidth_rad_per_s = bandwidth;
            self.recursion.forget_transitions();
        }
    }

    fn usual_interval_s(&self) -> T {
        let seen = self.clock.interval_s();
        if seen > T::zero() { seen } else { T::lit(FIRST_INTERVAL_S) }
    }

    /// Begin anew, keeping time, level and parameters.
    fn restart(&mut self) {
        self.recursion = Recursion::new(&self.model, self.config.bias_sd_m_s2);
        self.level.forget_slow();
        self.running_s = T::zero();
        self.body_accel_m_s2 = None;
        self.nis = None;
        self.restarts = self.restarts.saturating_add(1);
    }
}

/// What [`crate::RoadRecorder`] reads after a sample.
impl<T: Real> RoadFilter<T> {
    /// What [`Self::advance`] would make of a time.
    pub(crate) fn arrival(&self, time_s: f64) -> Arrival<T> {
        self.clock.arrival(time_s)
    }

    /// The transition of an advance just made.
    pub(crate) fn transition(&self, step: Lean) -> Option<&Transition<T>> {
        self.recursion.transition(step)
    }

    /// Variance in m² that the stiffness's uncertainty adds: `x_r = x_w + F / k_t`, so `d x_r = -d_t d k_t / k_t`.
    pub(crate) fn stiffness_variance_m2(&self) -> T {
        let error = self.recursion.mean()[state::TIRE] * self.stiffness_sd;
        error * error
    }

    pub(crate) fn road_m(&self) -> T {
        self.recursion.mean()[state::ROAD]
    }

    /// Height of the expectation above [`Self::road_m`], m.
    pub(crate) fn expected_offset_m(&self) -> T {
        self.recursion.expected_offset_m()
    }

    /// Variance of the height's expectation, m².
    pub(crate) fn expected_variance_m2(&self) -> T {
        self.recursion.expected_variance_m2()
    }

    pub(crate) fn road_covariance(&self) -> CoreState<T> {
        self.recursion.road_covariance()
    }

    /// Variance a height gains in one second without a measurement, m²/s.
    pub(crate) fn road_intensity(&self) -> T {
        self.model.road_intensity
    }

    pub(crate) fn low_cut_rad_per_s(&self) -> T {
        self.model.low_cut_rad_per_s
    }
}

/// A value that may be believed: finite and not absurd.
pub(crate) fn believable<T: Real>(accel_m_s2: T) -> Option<T> {
    (accel_m_s2.abs() < T::lit(LARGEST_M_S2)).then_some(accel_m_s2)
}

fn mean_nis<T: Real>(corrections: &[Option<Correction<T>>; 2]) -> Option<T> {
    let (mut sum, mut count) = (T::zero(), T::zero());
    for c in corrections.iter().flatten() {
        sum += c.innovation * c.innovation / c.variance;
        count += T::one();
    }
    (count > T::zero()).then(|| sum / count)
}
