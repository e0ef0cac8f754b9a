//! A road that repeats itself, as on a test bed or a drum: it is shared with the wheel's own past (docs/math/repeated-road.md).
//!
//! A source of evidence beside the estimator. Finds the period by itself, or is given it; confirms it; follows the stiffness while
//! the road goes on repeating; and lets go when it does not. While the same road comes round again and again its spectrum says
//! nothing new, so the estimator's own frames must not be believed meanwhile.
//!
//! | module | idea |
//! |---|---|
//! | `search` | at which period the road repeats itself |
//! | `pass` | the spectrum of one pass |
//! | `given` | the car, and what others believe of the tire |
//! | `lap` | whether it is the same road again |
//! | `follow`, `motion` | the compliance from pass to pass |
//! | `transfer` | what a wheel makes of a road |

mod estimator;
mod follow;
mod given;
mod lap;
mod motion;
mod pass;
mod search;
mod transfer;

use itpms_core::Real;
use itpms_core::conditioning::{LEAST_GRID_HZ, Resampler, SampleClock};
use itpms_core::estimator::{CALIBRATION_SD, OutsideStiffness};
use itpms_core::model::{
    CarConfig, CarEstimate, CarSample, Corner, CornerConfig, CornerEstimate, CornerSample, Level,
    ParameterError, QuarterCar,
};
use itpms_core::spectrum::{
    RELATIVE_ACCELERATION, RELATIVE_VELOCITY, Reconstruction, WHEEL_JERK, WHEEL_VELOCITY,
};

pub use self::estimator::EstimatorOnRepeatedRoad;
use self::given::{Belief, Held};
use self::lap::{Lap, PeriodicEstimate};
use self::search::PeriodSearch;

/// Shortest and longest period in s that may be given for a road.
const SHORTEST_S: f64 = 0.1;
const LONGEST_S: f64 = 5.0;
/// A repeated road is found in its third period or so: until then its spectrum has been counted that often.
const OVERCOUNTED: f64 = 3.0;
/// What a repeated road shows is its belief, and so not independent: how much wider it is given to a filter outside, one per period.
const INDEPENDENT_SD: f64 = 2.0;

/// The time in s after which a road repeats itself.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadPeriod(f64);

impl RoadPeriod {
    /// Errors: the period must be from 0.1 to 5 s: a shorter one has no harmonics near wheel hop, a longer one too many.
    pub fn new(seconds: f64) -> Result<Self, ParameterError> {
        if (SHORTEST_S..=LONGEST_S).contains(&seconds) {
            Ok(Self(seconds))
        } else {
            Err(ParameterError { name: "road_period_s", value: seconds, expected: "0.1 to 5 s" })
        }
    }
}

/// Whether the road repeats itself, as on a test bed or a drum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RoadRepetition {
    /// Looked for in the data: periods from 0.25 to 1.8 s.
    #[default]
    Detect,
    /// Known to repeat so often.
    Every(RoadPeriod),
    Never,
}

/// The road under one wheel, for as long as it repeats itself.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RepeatedRoad<T: Real> {
    config: CornerConfig<T>,
    noise_density: T,
    resampler: Resampler<T>,
    reconstruction: Reconstruction<T>,
    laps: Laps<T>,
    last_s: f64,
}

impl<T: Real> RepeatedRoad<T> {
    /// A road of which only this is known, under a corner whose samples come at about `sample_rate_hz`.
    /// Errors: the rate must be positive and finite.
    pub fn new(
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
        repetition: RoadRepetition,
    ) -> Result<Self, ParameterError> {
        SampleClock::<T>::new(sample_rate_hz)?;
        let noise = config.accel_noise_or_usual_m_s2();
        let resampler = Resampler::new(sample_rate_hz, LEAST_GRID_HZ);
        let grid_period_s = resampler.grid_period_s();
        Ok(Self {
            config: *config,
            noise_density: T::lit(2.0 / sample_rate_hz) * noise * noise,
            resampler,
            reconstruction: Reconstruction::new(grid_period_s),
            laps: Laps::new(repetition, sample_rate_hz, grid_period_s),
            last_s: f64::NAN,
        })
    }

    /// Takes a sample's time in s and accelerations, the corner as it seems to be and its estimate after the sample; calls `follow` with
    /// each new stiffness that the estimator is to [follow](itpms_core::Estimator::follow), and with `None` when the road repeats no more.
    pub fn update(
        &mut self,
        time_s: f64,
        values: &CornerSample<T>,
        quarter_car: &QuarterCar<T>,
        estimate: &CornerEstimate<T>,
        mut follow: impl FnMut(Option<OutsideStiffness<T>>),
    ) {
        if self.laps.repetition == RoadRepetition::Never {
            return;
        }
        let no_speed = T::lit(f64::NAN);
        let belief = self.belief(estimate);
        let corner = given::Corner { quarter_car: *quarter_car, noise_density: self.noise_density };
        let Self { resampler, reconstruction, laps, last_s, .. } = self;
        resampler.push(time_s, no_speed, values.body_accel_m_s2, values.wheel_accel_m_s2, |step| {
            if step.after_gap {
                reconstruction.restart();
                laps.interrupted(T::lit(step.time_s - *last_s));
            }
            *last_s = step.time_s;
            let signals = reconstruction.push(&step);
            let force = quarter_car.unsprung_mass_kg() * signals[WHEEL_JERK]
                + quarter_car.damping_n_s_per_m() * signals[RELATIVE_ACCELERATION]
                + quarter_car.spring_n_per_m() * signals[RELATIVE_VELOCITY];
            let step = Step { wheel: signals[WHEEL_VELOCITY], force, is_invalid: step.invalid };
            let followed = laps.are_followed;
            if let Some(periodic) = laps.push(&step, &corner, &belief) {
                follow(Some(outside(&periodic)));
            }
            if followed && !laps.are_followed {
                follow(None);
            }
        });
    }

    /// Prior of the compliance.
    fn belief(&self, estimate: &CornerEstimate<T>) -> Belief<T> {
        let tire = &self.config.tire;
        let placard_kpa = self.config.placard_kpa;
        let (stiffness, sd_kpa, held) = if estimate.level == Level::Calibration {
            (tire.stiffness_n_per_m(placard_kpa), T::lit(CALIBRATION_SD) * placard_kpa, Held::Yes)
        } else {
            (estimate.stiffness_n_per_m, estimate.change_sd_kpa * T::lit(OVERCOUNTED).sqrt(), Held::No)
        };
        let relative_sd = sd_kpa * tire.stiffness_per_kpa() / stiffness;
        Belief { theta: T::one() / stiffness, relative_sd, held }
    }
}

/// One grid step of the parts of the road's velocity: `wheel + θ force`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step<T> {
    wheel: T,
    force: T,
    is_invalid: bool,
}

/// Periods that are looked for, or the road that is met again and again.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Laps<T: Real> {
    repetition: RoadRepetition,
    sample_rate_hz: f64,
    grid_period_s: f64,
    search: PeriodSearch<T>,
    lap: Option<Lap<T>>,
    /// Whether the road is confirmed, and the estimator follows what its passes show.
    are_followed: bool,
}

impl<T: Real> Laps<T> {
    fn new(repetition: RoadRepetition, sample_rate_hz: f64, grid_period_s: f64) -> Self {
        let search = PeriodSearch::new(grid_period_s);
        let mut laps =
            Self { repetition, sample_rate_hz, grid_period_s, search, lap: None, are_followed: false };
        laps.start_if_known();
        laps
    }

    fn start(&mut self, period_s: T) {
        self.lap = Some(Lap::new(self.sample_rate_hz, T::lit(self.grid_period_s), period_s));
    }

    fn start_if_known(&mut self) {
        if let (None, RoadRepetition::Every(RoadPeriod(period_s))) = (&self.lap, self.repetition) {
            self.start(T::lit(period_s));
        }
    }

    /// The signal was interrupted for this long.
    fn interrupted(&mut self, seconds: T) {
        self.search.restart();
        match &mut self.lap {
            Some(lap) if lap.confirmed && seconds >= T::zero() => lap.interrupted(seconds),
            lap => *lap = None,
        }
        self.start_if_known();
    }

    /// Takes one grid step; gives an estimate when a part of a period on a confirmed road is complete.
    fn push(
        &mut self,
        step: &Step<T>,
        corner: &given::Corner<T>,
        belief: &Belief<T>,
    ) -> Option<PeriodicEstimate<T>> {
        let estimate = self.pass(step, corner, belief);
        self.are_followed = self.lap.as_ref().is_some_and(|lap| lap.confirmed);
        estimate
    }

    fn pass(
        &mut self,
        step: &Step<T>,
        corner: &given::Corner<T>,
        belief: &Belief<T>,
    ) -> Option<PeriodicEstimate<T>> {
        let Some(lap) = &mut self.lap else {
            if let Some(period_s) = self.search.push(step.wheel, step.force, || belief.theta) {
                self.search.restart();
                self.start(period_s);
            }
            return None;
        };
        let estimate = lap.push(step.wheel, step.force, step.is_invalid, corner, belief);
        if lap.is_over() {
            self.lap = None;
            self.start_if_known();
        }
        estimate
    }
}

/// Measurement by the passes, for the estimator.
fn outside<T: Real>(periodic: &PeriodicEstimate<T>) -> OutsideStiffness<T> {
    let stiffness_n_per_m = T::one() / periodic.theta;
    let stiffness_sd_n_per_m = periodic.relative_sd * stiffness_n_per_m;
    OutsideStiffness {
        stiffness_n_per_m,
        stiffness_sd_n_per_m,
        rate_per_s: -periodic.rate_per_s,
        independent_sd_n_per_m: periodic
            .whole_period
            .then_some(stiffness_sd_n_per_m * T::lit(INDEPENDENT_SD)),
        change_probability: periodic.moving,
        nis: periodic.nis,
        learned_s: periodic.seconds,
    }
}

/// The roads under all wheels of a car, for as long as they repeat themselves.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RepeatedRoads<T: Real> {
    clock: SampleClock<T>,
    wheels: [Option<RepeatedRoad<T>>; 4],
}

impl<T: Real> RepeatedRoads<T> {
    /// Roads of which only this is known, under the corners of a car whose samples come at about `sample_rate_hz`.
    /// Errors: the rate must be positive and finite.
    pub fn new(
        config: &CarConfig<T>,
        sample_rate_hz: f64,
        repetition: RoadRepetition,
    ) -> Result<Self, ParameterError> {
        let clock = SampleClock::new(sample_rate_hz)?;
        let mut wheels = [const { None }; 4];
        for (wheel, corner) in wheels.iter_mut().zip(&config.corners) {
            *wheel = corner
                .as_ref()
                .map(|corner| RepeatedRoad::new(corner, sample_rate_hz, repetition))
                .transpose()?;
        }
        Ok(Self { clock, wheels })
    }

    /// Takes a sample, the corners as they seem to be and the estimate after the sample; calls `follow` as
    /// [`RepeatedRoad::update`] does, with the corner.
    pub fn update(
        &mut self,
        sample: &CarSample<T>,
        quarter_cars: &[Option<QuarterCar<T>>; 4],
        estimate: &CarEstimate<T>,
        mut follow: impl FnMut(Corner, Option<OutsideStiffness<T>>),
    ) {
        let Some(time_s) = self.clock.take(sample.time_s, sample.speed_m_s).time_s else { return };
        let corners = sample.corners.iter().zip(quarter_cars).zip(&estimate.corners);
        for ((wheel, corner), ((values, quarter_car), estimate)) in
            self.wheels.iter_mut().zip(Corner::ALL).zip(corners)
        {
            if let (Some(wheel), Some(values), Some(quarter_car), Some(estimate)) =
                (wheel, values, quarter_car, estimate)
            {
                wheel.update(time_s, values, quarter_car, estimate, |stiffness| follow(corner, stiffness));
            }
        }
    }
}
