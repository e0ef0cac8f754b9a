//! The estimators that every figure shows, each fed with the same samples.
//!
//! Called by `drive`. The published filters are driven directly: the study draws what is inside them, and gives them
//! the tuning of the section of the paper at hand.

use itpms_core::model::{CornerConfig, CornerEstimate, CornerSample};
use itpms_paper::{AekfUi, EstimatorKind, FilterConfig, Forgetting, PaperEstimator};
use itpms_road::{EstimatorOnRepeatedRoad, RoadRepetition, RoadUnderWheel};

use crate::runner::Result;
use itpms_analysis::plot::{Ink, Stroke};

/// Which of the paper's two sets of covariances the published filters get.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tuning {
    /// Sec. 4.
    Simulation,
    /// Sec. 5.1.
    Bench,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contestant {
    pub(super) kind: EstimatorKind,
    /// Length in s of the reset drive at the start; 0 for none.
    pub(super) reset_s: f64,
}

impl Contestant {
    /// All four; `reset_s` is for those that have an ear for it.
    pub(super) fn all(reset_s: f64) -> Vec<Self> {
        let kinds = [
            EstimatorKind::EkfUi,
            EstimatorKind::AekfUi,
            EstimatorKind::AekfUiInformed,
            EstimatorKind::Informed,
        ];
        let is_published = |kind| matches!(kind, EstimatorKind::AekfUi | EstimatorKind::EkfUi);
        let one = |kind| Self { kind, reset_s: if is_published(kind) { 0.0 } else { reset_s } };
        kinds.into_iter().map(one).collect()
    }

    pub(super) fn label(&self) -> &'static str {
        self.kind.label()
    }

    pub(super) fn ink(&self) -> Ink {
        match self.kind {
            EstimatorKind::Informed => Ink::Default,
            EstimatorKind::AekfUiInformed => Ink::Mended,
            EstimatorKind::AekfUi => Ink::Adaptive,
            EstimatorKind::EkfUi => Ink::Plain,
        }
    }

    /// The two published filters often lie on each other; so one of them is dashed.
    pub(super) fn stroke(&self) -> Stroke {
        if self.kind == EstimatorKind::EkfUi { Stroke::Dashed } else { Stroke::Solid }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Word {
    pub(super) pressure_kpa: f64,
    pub(super) pressure_sd_kpa: f64,
    pub(super) stiffness_n_per_m: f64,
    /// In (N/m)².
    pub(super) stiffness_variance: f64,
    pub(super) forgetting: f64,
    pub(super) road_m: f64,
    pub(super) diverged: bool,
}

// There are five at a time, on the heap.
#[allow(clippy::large_enum_variant)]
pub(super) enum Runner {
    Published { filter: AekfUi<f64>, corner: CornerConfig<f64>, step_s: f64 },
    Corrected(PaperEstimator<f64>),
    Informed { estimator: EstimatorOnRepeatedRoad<f64>, road: RoadUnderWheel<f64> },
}

impl Runner {
    pub(super) fn new(
        contestant: &Contestant,
        tuning: Tuning,
        corner: &CornerConfig<f64>,
        rate_hz: f64,
    ) -> Result<Self> {
        let forgetting = match contestant.kind {
            EstimatorKind::AekfUi => Forgetting::OneStep,
            EstimatorKind::EkfUi => Forgetting::None,
            kind => {
                let reset_s = Some(contestant.reset_s).filter(|seconds| *seconds > 0.0);
                if let Some(mut estimator) = PaperEstimator::new(kind, corner, rate_hz)? {
                    reset_s.map(|seconds| estimator.begin_calibration(seconds)).transpose()?;
                    return Ok(Self::Corrected(estimator));
                }
                let mut estimator = EstimatorOnRepeatedRoad::new(corner, rate_hz, RoadRepetition::Detect)?;
                reset_s.map(|seconds| estimator.estimator_mut().begin_calibration(seconds)).transpose()?;
                return Ok(Self::Informed { estimator, road: RoadUnderWheel::new(corner)? });
            }
        };
        let tuned = match tuning {
            Tuning::Simulation => FilterConfig::paper_simulation(),
            Tuning::Bench => FilterConfig::paper_bench(),
        };
        let filter = AekfUi::new(corner.quarter_car, tuned.with_forgetting(forgetting))?;
        Ok(Self::Published { filter, corner: *corner, step_s: 1.0 / rate_hz })
    }

    pub(super) fn update(&mut self, time_s: f64, speed_m_s: f64, sample: &CornerSample<f64>) -> Word {
        match self {
            Self::Published { filter, corner, step_s } => {
                let record = filter.step(*step_s, sample);
                let stiffness = record.stiffness_n_per_m();
                let sd = record.stiffness_sd_n_per_m();
                Word {
                    pressure_kpa: corner.tire.pressure_kpa(stiffness),
                    pressure_sd_kpa: sd / corner.tire.stiffness_per_kpa(),
                    stiffness_n_per_m: stiffness,
                    stiffness_variance: sd * sd,
                    forgetting: record.forgetting,
                    road_m: record.road_m,
                    diverged: record.is_diverged(),
                }
            }
            Self::Corrected(estimator) => {
                let (body, wheel) = (sample.body_accel_m_s2, sample.wheel_accel_m_s2);
                Word::of(&estimator.update(time_s, speed_m_s, body, wheel))
            }
            Self::Informed { estimator, road } => {
                let (body, wheel) = (sample.body_accel_m_s2, sample.wheel_accel_m_s2);
                let mut estimate = estimator.update(time_s, speed_m_s, body, wheel);
                road.update(time_s, sample, estimator.estimator().quarter_car(), &mut estimate);
                Word::of(&estimate)
            }
        }
    }
}

impl Word {
    fn of(estimate: &CornerEstimate<f64>) -> Self {
        Self {
            pressure_kpa: estimate.pressure_kpa,
            pressure_sd_kpa: estimate.pressure_sd_kpa,
            stiffness_n_per_m: estimate.stiffness_n_per_m,
            stiffness_variance: estimate.stiffness_sd_n_per_m * estimate.stiffness_sd_n_per_m,
            forgetting: estimate.diagnostics.forgetting,
            road_m: estimate.road_m,
            diverged: false,
        }
    }
}
