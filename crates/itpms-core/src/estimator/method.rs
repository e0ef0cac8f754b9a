//! The four estimators side by side, each brought to the same reading.

use crate::conditioning::GridSample;
use crate::model::{CornerConfig, CornerSample, ParameterError, QuarterCar, Validity};
use crate::published::{
    AekfUi, AekfUiInformed, FilterConfig, Forgetting, InformedConfig, InformedRecord, InformedStatus,
    ParameterForgetting, StepRecord,
};
use crate::real::Real;
use crate::single_wheel::{CALIBRATION_SD, Informed, RoadRepetition, StiffnessPseudoMeasurement};

use crate::estimator::{EstimatorKind, FusedStiffness};

/// Seconds of full information before an estimate counts.
const STARTING_S: f64 = 2.0;
/// Seconds without a frame after which nothing is being learned.
const STALE_S: f64 = 1.0;
/// Standard deviation, as a share of the placard pressure, beyond which an estimate says nothing.
const WORTHLESS: f64 = 0.25;

/// What every estimator can say after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Reading<T> {
    pub(crate) stiffness_n_per_m: T,
    pub(crate) stiffness_sd_n_per_m: T,
    pub(crate) road_m: T,
    pub(crate) road_sd_m: T,
    pub(crate) validity: Validity,
    pub(crate) forgetting: T,
    pub(crate) nis: T,
    pub(crate) gate: T,
    pub(crate) change_probability: T,
}

/// One of the four, and what it last said.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
// An estimator lives where its owner puts it; there is no heap to box the larger ones in.
#[allow(clippy::large_enum_variant)]
enum Method<T: Real> {
    Informed(Informed<T>),
    AekfUiInformed { likelihood: Informed<T>, filter: AekfUiInformed<T> },
    Published(AekfUi<T>),
}

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(crate) struct RunningMethod<T: Real> {
    method: Method<T>,
    config: CornerConfig<T>,
    grid_period_s: T,
    reading: Reading<T>,
    /// Time of the step in which a frame or a repeated road last said something.
    read_s: f64,
}

impl<T: Real> RunningMethod<T> {
    pub(crate) fn new(
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
        grid_period_s: f64,
    ) -> Result<Self, ParameterError> {
        let informed = || Informed::new(config, sample_rate_hz, grid_period_s);
        let method = match kind {
            EstimatorKind::Informed => Method::Informed(informed()),
            EstimatorKind::AekfUiInformed => {
                Method::AekfUiInformed { likelihood: informed(), filter: mended(config)? }
            }
            EstimatorKind::AekfUi | EstimatorKind::EkfUi => Method::Published(published(kind, config)?),
        };
        let reading = method.first_reading(config);
        let grid_period_s = T::lit(grid_period_s);
        Ok(Self { method, config: *config, grid_period_s, reading, read_s: f64::NEG_INFINITY })
    }

    /// Starts again, in place: another engine beside this one is more than a controller's stack has room for.
    pub(crate) fn restart(&mut self, kind: EstimatorKind, repetition: RoadRepetition) {
        let config = &self.config;
        // The filters have accepted the same before.
        match &mut self.method {
            Method::Informed(informed) => informed.restart(repetition),
            Method::AekfUiInformed { likelihood, filter } => {
                likelihood.restart(repetition);
                *filter = mended(config).unwrap_or(*filter);
            }
            Method::Published(filter) => *filter = published(kind, config).unwrap_or(*filter),
        }
        self.reading = self.method.first_reading(config);
        self.read_s = f64::NEG_INFINITY;
    }

    /// What is known of the road repeating itself; before the first sample. The published filters have no use for it.
    pub(crate) fn set_repetition(&mut self, repetition: RoadRepetition) {
        match &mut self.method {
            Method::Informed(informed) | Method::AekfUiInformed { likelihood: informed, .. } => {
                informed.set_repetition(repetition);
            }
            Method::Published(_) => {}
        }
    }

    /// Takes one grid sample.
    pub(crate) fn step(&mut self, sample: &GridSample<T>) {
        let corner = CornerSample {
            body_accel_m_s2: sample.body_accel_m_s2,
            wheel_accel_m_s2: sample.wheel_accel_m_s2,
        };
        match &mut self.method {
            Method::Informed(informed) => {
                if informed.push(sample) {
                    self.read_s = sample.time_s;
                    self.reading = belief_reading(&self.config, informed);
                }
            }
            Method::AekfUiInformed { likelihood, filter } => {
                let mut record = filter.step(self.grid_period_s, &corner);
                if likelihood.push(sample) {
                    self.read_s = sample.time_s;
                    if let Some(word) = likelihood.take_pseudo_measurement() {
                        filter.measure_stiffness(word.stiffness_n_per_m, word.sd_n_per_m);
                        record = filter.record(record.status);
                    }
                }
                self.reading = record_reading(&self.config, likelihood, &record);
            }
            Method::Published(filter) => {
                self.reading = published_reading(&filter.step(self.grid_period_s, &corner));
            }
        }
    }

    /// Tells that the tire has its placard pressure now. The published filters have no ear for it.
    pub(crate) fn set_to_placard(&mut self) {
        match &mut self.method {
            Method::Informed(informed) => {
                informed.set_to_placard();
                self.reading = belief_reading(&self.config, informed);
            }
            Method::AekfUiInformed { likelihood, filter } => {
                likelihood.set_to_placard();
                let tire = &self.config.tire;
                let placard = self.config.placard_kpa;
                let sd = T::lit(CALIBRATION_SD) * placard * tire.stiffness_per_kpa();
                filter.measure_stiffness(tire.stiffness_n_per_m(placard), sd);
            }
            Method::Published(_) => {}
        }
    }

    /// The car as it seems to be now, where the method looks at it.
    pub(crate) fn quarter_car(&self) -> QuarterCar<T> {
        match &self.method {
            Method::Informed(informed) => informed.quarter_car(),
            _ => self.config.quarter_car,
        }
    }

    /// What the last frames said to a belief outside.
    pub(crate) fn pseudo_measurement(
        &mut self,
        believed: impl FnOnce() -> (T, T),
    ) -> Option<StiffnessPseudoMeasurement<T>> {
        match &mut self.method {
            Method::Informed(informed) => informed.pseudo_measurement(believed),
            _ => None,
        }
    }

    /// Puts what the whole car says in the place of what the corner says.
    pub(crate) fn apply_fused(&self, reading: &mut Reading<T>, word: &FusedStiffness<T>) {
        reading.stiffness_n_per_m = word.stiffness_n_per_m;
        reading.stiffness_sd_n_per_m = word.stiffness_sd_n_per_m;
        reading.change_probability = word.changing;
        if !word.has_signal {
            reading.gate = T::zero();
        } else if word.learning {
            reading.gate = T::one();
        }
        let sd_kpa = word.stiffness_sd_n_per_m / self.config.tire.stiffness_per_kpa();
        reading.validity = validity(&self.config, word.learned_s, sd_kpa);
    }

    pub(crate) fn reading(&self) -> Reading<T> {
        self.reading
    }

    /// The same at a time: nothing is being learned where no frame comes, as in a hole of the record.
    pub(crate) fn reading_at(&self, time_s: f64) -> Reading<T> {
        let fresh = (0.0..STALE_S).contains(&(time_s - self.read_s));
        match &self.method {
            Method::Published(_) => self.reading,
            _ if fresh => self.reading,
            _ => Reading { gate: T::zero(), ..self.reading },
        }
    }
}

impl<T: Real> Method<T> {
    /// What is known before the first sample.
    fn first_reading(&self, config: &CornerConfig<T>) -> Reading<T> {
        match self {
            Self::Informed(informed) => belief_reading(config, informed),
            Self::AekfUiInformed { likelihood, filter } => {
                record_reading(config, likelihood, &filter.record(InformedStatus::PredictedOnly))
            }
            Self::Published(_) => start_reading(config.initial_stiffness_n_per_m()),
        }
    }
}

/// The filter as published, with the forgetting of its kind.
fn published<T: Real>(kind: EstimatorKind, config: &CornerConfig<T>) -> Result<AekfUi<T>, ParameterError> {
    let forgetting = if kind == EstimatorKind::AekfUi { Forgetting::OneStep } else { Forgetting::None };
    let start = FilterConfig::paper_simulation().with_forgetting(forgetting);
    AekfUi::new(config.quarter_car, start.with_initial_stiffness(config.initial_stiffness_n_per_m()))
}

/// The filter that is told the stiffness.
fn mended<T: Real>(config: &CornerConfig<T>) -> Result<AekfUiInformed<T>, ParameterError> {
    AekfUiInformed::new(config.quarter_car, filter_config(config))
}

/// Settings of the mended filter for words that come every 0.7 s: a short memory of few, weighty innovations.
fn filter_config<T: Real>(config: &CornerConfig<T>) -> InformedConfig<T> {
    let forgetting = ParameterForgetting::Adaptive { memory: T::lit(5.0), significance: T::lit(0.2) };
    InformedConfig { forgetting, ..InformedConfig::for_corner(config) }
}

/// Whether a stiffness of this sd may be believed, given how much was learned.
fn validity<T: Real>(config: &CornerConfig<T>, learned_s: T, pressure_sd_kpa: T) -> Validity {
    if !(learned_s >= T::lit(STARTING_S)) {
        Validity::Starting
    } else if !(pressure_sd_kpa <= T::lit(WORTHLESS) * config.placard_kpa) {
        Validity::NoInformation
    } else {
        Validity::Valid
    }
}

fn belief_reading<T: Real>(config: &CornerConfig<T>, informed: &Informed<T>) -> Reading<T> {
    let belief = informed.belief();
    Reading {
        stiffness_n_per_m: config.tire.stiffness_n_per_m(belief.pressure_kpa),
        stiffness_sd_n_per_m: belief.pressure_sd_kpa * config.tire.stiffness_per_kpa(),
        road_m: T::lit(f64::NAN),
        road_sd_m: T::lit(f64::NAN),
        validity: validity(config, belief.learned_s, belief.pressure_sd_kpa),
        forgetting: belief.variance_growth,
        nis: belief.surprise,
        gate: belief.gate,
        change_probability: belief.moving,
    }
}

fn record_reading<T: Real>(
    config: &CornerConfig<T>,
    likelihood: &Informed<T>,
    record: &InformedRecord<T>,
) -> Reading<T> {
    let belief = likelihood.belief();
    let sd = record.stiffness_sd_n_per_m();
    Reading {
        stiffness_n_per_m: record.stiffness_n_per_m(),
        stiffness_sd_n_per_m: sd,
        road_m: record.road_m,
        road_sd_m: record.road_sd_m(),
        validity: validity(config, belief.learned_s, sd / config.tire.stiffness_per_kpa()),
        forgetting: record.forgetting,
        nis: record.nis,
        gate: belief.gate,
        change_probability: T::lit(f64::NAN),
    }
}

/// A published filter: its stiffness is where it started, whatever its covariance says, so it is never valid.
fn published_reading<T: Real>(record: &StepRecord<T>) -> Reading<T> {
    Reading {
        stiffness_n_per_m: record.stiffness_n_per_m(),
        stiffness_sd_n_per_m: record.stiffness_sd_n_per_m(),
        road_m: record.road_m,
        road_sd_m: record.road_variance_m2.sqrt(),
        validity: if record.is_diverged() { Validity::Diverged } else { Validity::NoInformation },
        forgetting: record.forgetting,
        nis: record.nis * T::lit(0.5),
        gate: T::one(),
        change_probability: T::lit(f64::NAN),
    }
}

/// Before the first sample of a published filter.
fn start_reading<T: Real>(stiffness_n_per_m: T) -> Reading<T> {
    let nan = T::lit(f64::NAN);
    Reading {
        stiffness_n_per_m,
        stiffness_sd_n_per_m: T::lit(f64::INFINITY),
        road_m: nan,
        road_sd_m: nan,
        validity: Validity::Starting,
        forgetting: T::one(),
        nis: nan,
        gate: T::zero(),
        change_probability: nan,
    }
}
