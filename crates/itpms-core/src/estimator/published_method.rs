//! The paper's filters, and the paper's filter corrected, brought to the same reading. Compiled with feature `paper` only.

use super::EstimatorKind;
use super::reading::{Reading, validity};
use crate::conditioning::GridSample;
use crate::model::{CornerConfig, CornerSample, ParameterError, Validity};
use crate::published::{
    AekfUi, AekfUiInformed, FilterConfig, Forgetting, InformedConfig, InformedRecord, InformedStatus,
    ParameterForgetting, StepRecord,
};
use crate::real::Real;
use crate::single_wheel::{CALIBRATION_SD, Informed, RoadRepetition};

/// One of the paper's filters.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// An estimator lives where its owner puts it; there is no heap to box the larger ones in.
#[allow(clippy::large_enum_variant)]
pub(super) enum PublishedMethod<T: Real> {
    /// Told the stiffness likelihood of the default estimator's frames.
    Corrected {
        likelihood: Informed<T>,
        filter: AekfUiInformed<T>,
        /// Time in s of the last step, before the first minus infinity.
        last_s: f64,
    },
    AsPublished(AekfUi<T>),
}

impl<T: Real> PublishedMethod<T> {
    pub(super) fn new(
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
        grid_period_s: f64,
    ) -> Result<Self, ParameterError> {
        Ok(if kind == EstimatorKind::AekfUiInformed {
            let likelihood = Informed::new(config, sample_rate_hz, grid_period_s);
            Self::Corrected { likelihood, filter: corrected(config)?, last_s: f64::NEG_INFINITY }
        } else {
            Self::AsPublished(published(kind, config)?)
        })
    }

    /// Starts again, in place. The filters have accepted the same before.
    pub(super) fn restart(
        &mut self,
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        repetition: RoadRepetition,
    ) {
        match self {
            Self::Corrected { likelihood, filter, .. } => {
                likelihood.restart(repetition);
                *filter = corrected(config).unwrap_or(*filter);
            }
            Self::AsPublished(filter) => *filter = published(kind, config).unwrap_or(*filter),
        }
    }

    /// The filters as published have no use for it.
    pub(super) fn set_repetition(&mut self, repetition: RoadRepetition) {
        if let Self::Corrected { likelihood, .. } = self {
            likelihood.set_repetition(repetition);
        }
    }

    /// Takes one grid sample; gives the reading after it, and whether a frame was learned from.
    pub(super) fn step(
        &mut self,
        sample: &GridSample<T>,
        grid_period_s: T,
        config: &CornerConfig<T>,
    ) -> (Reading<T>, bool) {
        let corner = CornerSample {
            body_accel_m_s2: sample.body_accel_m_s2,
            wheel_accel_m_s2: sample.wheel_accel_m_s2,
        };
        match self {
            Self::Corrected { likelihood, filter, last_s } => {
                // The motion and the stiffness know nothing of a hole but how long it was.
                let hole_s = sample.time_s - core::mem::replace(last_s, sample.time_s);
                let is_hole = sample.after_gap && hole_s.is_finite();
                let dt_s = if is_hole { T::lit(hole_s) } else { grid_period_s };
                let mut record = filter.step(dt_s, &corner);
                let learned = likelihood.push(sample);
                if learned && let Some(spectral) = likelihood.take_pseudo_measurement() {
                    filter.measure_stiffness(spectral.stiffness_n_per_m, spectral.sd_n_per_m);
                    record = filter.record(record.status);
                }
                (record_reading(config, likelihood, &record), learned)
            }
            Self::AsPublished(filter) => (published_reading(&filter.step(grid_period_s, &corner)), false),
        }
    }

    /// The tire has its placard pressure now. The filters as published cannot be told.
    pub(super) fn set_to_placard(&mut self, config: &CornerConfig<T>) {
        if let Self::Corrected { likelihood, filter, .. } = self {
            likelihood.set_to_placard();
            let tire = &config.tire;
            let sd = T::lit(CALIBRATION_SD) * config.placard_kpa * tire.stiffness_per_kpa();
            filter.measure_stiffness(tire.stiffness_n_per_m(config.placard_kpa), sd);
        }
    }

    /// What is known before the first sample.
    pub(super) fn first_reading(&self, config: &CornerConfig<T>) -> Reading<T> {
        match self {
            Self::Corrected { likelihood, filter, .. } => {
                record_reading(config, likelihood, &filter.record(InformedStatus::PredictedOnly))
            }
            Self::AsPublished(_) => start_reading(config.initial_stiffness_n_per_m()),
        }
    }

    /// Whether its readings say nothing of how long ago something was learned.
    pub(super) fn is_as_published(&self) -> bool {
        matches!(self, Self::AsPublished(_))
    }
}

/// The filter as published, with the forgetting of its kind.
fn published<T: Real>(kind: EstimatorKind, config: &CornerConfig<T>) -> Result<AekfUi<T>, ParameterError> {
    let forgetting = if kind == EstimatorKind::AekfUi { Forgetting::OneStep } else { Forgetting::None };
    let start = FilterConfig::paper_simulation().with_forgetting(forgetting);
    AekfUi::new(config.quarter_car, start.with_initial_stiffness(config.initial_stiffness_n_per_m()))
}

/// The filter that is told the stiffness.
fn corrected<T: Real>(config: &CornerConfig<T>) -> Result<AekfUiInformed<T>, ParameterError> {
    AekfUiInformed::new(config.quarter_car, filter_config(config))
}

/// Settings of the corrected filter for pseudo-measurements that come every 0.7 s: a short memory of few, weighty innovations.
fn filter_config<T: Real>(config: &CornerConfig<T>) -> InformedConfig<T> {
    let forgetting = ParameterForgetting::Adaptive { memory: T::lit(5.0), significance: T::lit(0.2) };
    InformedConfig { forgetting, ..InformedConfig::for_corner(config) }
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
