//! The four estimators side by side, each brought to the same reading.

use crate::estimate::{CornerConfig, Validity};
use crate::filter::{
    AekfUi, AekfUiInformed, FilterConfig, Forgetting, InformedConfig, InformedRecord, InformedStatus, StepRecord,
};
use crate::informed::Informed;
use crate::intake::GridSample;
use crate::quarter_car::ParameterError;
use crate::real::Real;
use crate::sample::CornerSample;

use super::EstimatorKind;

/// Seconds of full information before an estimate counts.
const STARTING_S: f64 = 2.0;
/// Standard deviation, as a share of the placard pressure, beyond which an estimate says nothing.
const WORTHLESS: f64 = 0.25;

/// What every estimator can say after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Reading<T> {
    pub(super) stiffness_n_per_m: T,
    pub(super) stiffness_sd_n_per_m: T,
    pub(super) road_m: T,
    pub(super) road_sd_m: T,
    pub(super) validity: Validity,
    pub(super) forgetting: T,
    pub(super) nis: T,
    pub(super) gate: T,
    pub(super) change_probability: T,
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
pub(super) struct Engine<T: Real> {
    method: Method<T>,
    config: CornerConfig<T>,
    grid_period_s: T,
    reading: Reading<T>,
}

impl<T: Real> Engine<T> {
    pub(super) fn new(
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
        grid_period_s: f64,
    ) -> Result<Self, ParameterError> {
        let initial = config.initial_stiffness_n_per_m();
        let published = |forgetting| {
            let start = FilterConfig::paper_simulation().with_forgetting(forgetting);
            AekfUi::new(config.quarter_car, start.with_initial_stiffness(initial)).map(Method::Published)
        };
        let informed = || Informed::new(config, sample_rate_hz, grid_period_s);
        let method = match kind {
            EstimatorKind::Informed => Method::Informed(informed()),
            EstimatorKind::AekfUiInformed => Method::AekfUiInformed {
                likelihood: informed(),
                filter: AekfUiInformed::new(config.quarter_car, InformedConfig::for_corner(config))?,
            },
            EstimatorKind::AekfUi => published(Forgetting::OneStep)?,
            EstimatorKind::EkfUi => published(Forgetting::None)?,
        };
        let nan = T::lit(f64::NAN);
        let mut engine = Self {
            method,
            config: *config,
            grid_period_s: T::lit(grid_period_s),
            reading: Reading {
                stiffness_n_per_m: initial,
                stiffness_sd_n_per_m: nan,
                road_m: nan,
                road_sd_m: nan,
                validity: Validity::Starting,
                forgetting: T::one(),
                nis: nan,
                gate: T::zero(),
                change_probability: nan,
            },
        };
        engine.start();
        Ok(engine)
    }

    /// What is known before the first sample.
    fn start(&mut self) {
        match &self.method {
            Method::Informed(informed) => self.reading = self.of_belief(informed),
            Method::AekfUiInformed { likelihood, filter } => {
                self.reading = self.of_informed_record(likelihood, &filter.record(InformedStatus::PredictedOnly));
            }
            Method::Published(_) => {
                self.reading.stiffness_sd_n_per_m = T::lit(PAPER_INITIAL_VARIANCE).sqrt();
            }
        }
    }

    pub(super) fn step(&mut self, sample: &GridSample<T>) {
        let corner = CornerSample {
            body_accel_m_s2: sample.body_accel_m_s2,
            wheel_accel_m_s2: sample.wheel_accel_m_s2,
        };
        match &mut self.method {
            Method::Informed(informed) => {
                if informed.push(sample) {
                    let informed = &*informed;
                    self.reading = Self::belief_reading(&self.config, informed);
                }
            }
            Method::AekfUiInformed { likelihood, filter } => {
                let mut record = filter.step(self.grid_period_s, &corner);
                if likelihood.push(sample)
                    && let Some(measured) = likelihood.score_at(record.stiffness_n_per_m())
                {
                    filter.measure_stiffness_information(
                        measured.at_n_per_m,
                        measured.score,
                        measured.information,
                    );
                    record = filter.record(record.status);
                }
                self.reading = Self::informed_record_reading(&self.config, likelihood, &record);
            }
            Method::Published(filter) => {
                let record = filter.step(self.grid_period_s, &corner);
                self.reading = published_reading(&record);
            }
        }
    }

    pub(super) fn reading(&self) -> Reading<T> {
        self.reading
    }
}
