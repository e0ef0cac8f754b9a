//! The method behind an estimator, and its last reading.

use super::EstimatorKind;
use super::fused_stiffness::FusedStiffness;
#[cfg(feature = "paper")]
use super::published_method::PublishedMethod;
use super::reading::{Reading, validity};
use crate::conditioning::GridSample;
use crate::memory::Blank;
use crate::model::{CornerConfig, ParameterError, QuarterCar, Validity};
use crate::real::Real;
use crate::single_wheel::{Informed, RoadRepetition, StiffnessPseudoMeasurement};
use crate::spectrum::transfer::DescribingFunction;

/// Seconds without a frame after which nothing is being learned.
const STALE_S: f64 = 1.0;
/// The default method, or one of the paper's.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// An estimator lives where its owner puts it; there is no heap to box the larger ones in.
#[allow(clippy::large_enum_variant)]
enum Method<T: Real> {
    Informed(Informed<T>),
    #[cfg(feature = "paper")]
    Published(PublishedMethod<T>),
}

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RunningMethod<T: Real> {
    method: Method<T>,
    config: CornerConfig<T>,
    #[cfg(feature = "paper")]
    grid_period_s: T,
    reading: Reading<T>,
    /// Time of the step in which a frame or a repeated road was last learned from.
    read_s: f64,
}

impl<T: Real> Blank for RunningMethod<T> {
    const BLANK: Self = Self {
        method: Blank::BLANK,
        config: Blank::BLANK,
        #[cfg(feature = "paper")]
        grid_period_s: Blank::BLANK,
        reading: Blank::BLANK,
        read_s: Blank::BLANK,
    };
}

impl<T: Real> RunningMethod<T> {
    /// # Errors
    /// Parameters of the corner that a filter refuses are named.
    pub(super) fn configure(
        &mut self,
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
        grid_period_s: f64,
    ) -> Result<(), ParameterError> {
        match kind {
            EstimatorKind::Informed => self.method.inform(config, sample_rate_hz, grid_period_s),
            #[cfg(feature = "paper")]
            _ => self.method.publish(kind, config, sample_rate_hz, grid_period_s)?,
        }
        self.config = *config;
        #[cfg(feature = "paper")]
        {
            self.grid_period_s = T::lit(grid_period_s);
        }
        self.reading = self.method.first_reading(config);
        self.read_s = f64::NEG_INFINITY;
        Ok(())
    }

    /// Starts again, in place: another method beside this one is more than a controller's stack has room for.
    pub(super) fn restart(
        &mut self,
        #[cfg_attr(not(feature = "paper"), expect(unused_variables, reason = "there is one kind"))]
        kind: EstimatorKind,
        repetition: RoadRepetition,
    ) {
        match &mut self.method {
            Method::Informed(informed) => informed.restart(repetition),
            #[cfg(feature = "paper")]
            Method::Published(published) => published.restart(kind, &self.config, repetition),
        }
        self.reading = self.method.first_reading(&self.config);
        self.read_s = f64::NEG_INFINITY;
    }

    /// What is known of the road repeating itself; before the first sample.
    pub(super) fn set_repetition(&mut self, repetition: RoadRepetition) {
        match &mut self.method {
            Method::Informed(informed) => informed.set_repetition(repetition),
            #[cfg(feature = "paper")]
            Method::Published(published) => published.set_repetition(repetition),
        }
    }

    /// Takes one grid sample.
    pub(super) fn step(&mut self, sample: &GridSample<T>) {
        match &mut self.method {
            Method::Informed(informed) => {
                if informed.push(sample) {
                    self.read_s = sample.time_s;
                    self.reading = belief_reading(&self.config, informed);
                }
            }
            #[cfg(feature = "paper")]
            Method::Published(published) => {
                let (reading, learned) = published.step(sample, self.grid_period_s, &self.config);
                self.reading = reading;
                if learned {
                    self.read_s = sample.time_s;
                }
            }
        }
    }

    /// Takes over what the strut's friction makes of its motion.
    pub(super) fn set_friction(&mut self, friction: &DescribingFunction<T>) {
        match &mut self.method {
            Method::Informed(informed) => informed.set_friction(friction),
            #[cfg(feature = "paper")]
            Method::Published(_) => {}
        }
    }

    /// Whether the road is one line, as a washboard's is.
    pub(super) fn is_on_line(&self) -> bool {
        match &self.method {
            Method::Informed(informed) => informed.is_on_line(),
            #[cfg(feature = "paper")]
            Method::Published(_) => false,
        }
    }

    /// The tire has its placard pressure now.
    pub(super) fn set_to_placard(&mut self) {
        match &mut self.method {
            Method::Informed(informed) => {
                informed.set_to_placard();
                self.reading = belief_reading(&self.config, informed);
            }
            #[cfg(feature = "paper")]
            Method::Published(published) => published.set_to_placard(&self.config),
        }
    }

    /// Seconds of full information that it has had; no number where it does not count them.
    pub(super) fn learned_s(&self) -> T {
        match &self.method {
            Method::Informed(informed) => informed.learned_s(),
            #[cfg(feature = "paper")]
            Method::Published(_) => T::lit(f64::NAN),
        }
    }

    /// The car as it seems to be now, where the method looks at it.
    pub(super) fn quarter_car(&self) -> QuarterCar<T> {
        match &self.method {
            Method::Informed(informed) => informed.quarter_car(),
            #[cfg(feature = "paper")]
            Method::Published(_) => self.config.quarter_car,
        }
    }

    /// What the last frames tell of the stiffness to a belief outside.
    pub(super) fn pseudo_measurement(
        &mut self,
        believed: impl FnOnce() -> (T, T),
    ) -> Option<StiffnessPseudoMeasurement<T>> {
        match &mut self.method {
            Method::Informed(informed) => informed.pseudo_measurement(believed),
            #[cfg(feature = "paper")]
            Method::Published(_) => None,
        }
    }

    /// Puts what the whole car says in the place of what the corner says.
    pub(super) fn apply_fused(&self, reading: &mut Reading<T>, fused: &FusedStiffness<T>) {
        reading.stiffness_n_per_m = fused.stiffness_n_per_m;
        reading.stiffness_sd_n_per_m = fused.stiffness_sd_n_per_m;
        reading.change_probability = fused.changing;
        if !fused.has_signal {
            reading.gate = T::zero();
        } else if fused.learning {
            reading.gate = T::one();
        }
        let sd_kpa = fused.stiffness_sd_n_per_m / self.config.tire.stiffness_per_kpa();
        reading.validity = validity(&self.config, fused.learned_s, sd_kpa);
    }

    pub(super) fn reading(&self) -> Reading<T> {
        self.reading
    }

    /// The same at a time: nothing is being learned where no frame comes, as in a hole of the record.
    pub(super) fn reading_at(&self, time_s: f64) -> Reading<T> {
        let fresh = (0.0..STALE_S).contains(&(time_s - self.read_s));
        if fresh || self.method.is_as_published() {
            return self.reading;
        }
        Reading { gate: T::zero(), ..self.reading }
    }
}

impl<T: Real> Blank for Method<T> {
    const BLANK: Self = Self::Informed(Informed::BLANK);
}

impl<T: Real> Method<T> {
    /// Becomes the default method.
    fn inform(&mut self, config: &CornerConfig<T>, sample_rate_hz: f64, grid_period_s: f64) {
        #[cfg(feature = "paper")]
        if matches!(self, Self::Published(_)) {
            *self = Self::BLANK;
        }
        match self {
            Self::Informed(informed) => {
                informed.configure(config, sample_rate_hz, grid_period_s, RoadRepetition::default());
            }
            #[cfg(feature = "paper")]
            Self::Published(_) => {}
        }
    }

    /// Becomes one of the paper's; by way of the stack, which controllers have no use for.
    #[cfg(feature = "paper")]
    #[inline(never)]
    fn publish(
        &mut self,
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
        grid_period_s: f64,
    ) -> Result<(), ParameterError> {
        *self = Self::Published(PublishedMethod::new(kind, config, sample_rate_hz, grid_period_s)?);
        Ok(())
    }

    /// What is known before the first sample.
    fn first_reading(&self, config: &CornerConfig<T>) -> Reading<T> {
        match self {
            Self::Informed(informed) => belief_reading(config, informed),
            #[cfg(feature = "paper")]
            Self::Published(published) => published.first_reading(config),
        }
    }

    /// Whether its readings say nothing of how long ago something was learned.
    fn is_as_published(&self) -> bool {
        match self {
            Self::Informed(_) => false,
            #[cfg(feature = "paper")]
            Self::Published(published) => published.is_as_published(),
        }
    }
}

fn belief_reading<T: Real>(config: &CornerConfig<T>, informed: &Informed<T>) -> Reading<T> {
    let belief = informed.belief();
    Reading {
        stiffness_n_per_m: config.tire.stiffness_n_per_m(belief.pressure_kpa),
        stiffness_sd_n_per_m: belief.pressure_sd_kpa * config.tire.stiffness_per_kpa(),
        road_m: T::lit(f64::NAN),
        road_sd_m: T::lit(f64::NAN),
        validity: match validity(config, belief.learned_s, belief.pressure_sd_kpa) {
            Validity::Valid if !belief.is_in_range => Validity::NoInformation,
            validity => validity,
        },
        forgetting: belief.variance_growth,
        nis: belief.nis,
        gate: belief.gate,
        change_probability: belief.moving,
    }
}
