//! The paper's filters behind the face of [`itpms_core::Estimator`]: samples of one corner in, [`CornerEstimate`]s out.

use itpms_core::Real;
use itpms_core::conditioning::{GridSample, Resampler, SampleClock, SampleCounts};
use itpms_core::estimator::CALIBRATION_SD;
use itpms_core::model::{
    CornerConfig, CornerEstimate, CornerSample, Diagnostics, Level, ParameterError, Validity, Warning,
    positive,
};
use itpms_road::{EstimatorOnRepeatedRoad, RoadRepetition};

use crate::{
    AekfUi, AekfUiInformed, EstimatorKind, FilterConfig, Forgetting, InformedConfig, InformedRecord,
    InformedStatus, ParameterForgetting, StepRecord,
};

/// Least rate in Hz of the corrected filter's steps: that of the frames whose likelihood it is given.
const LEAST_STEP_HZ: f64 = 400.0;
/// Seconds between two measurements of the pressure that a calibration has set.
const SET_S: f64 = 0.1;

#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PaperEstimator<T: Real> {
    config: CornerConfig<T>,
    clock: SampleClock<T>,
    resampler: Resampler<T>,
    filter: Filter<T>,
}

#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// An estimator lives where its owner puts it; there is no heap to box the larger one in.
#[allow(clippy::large_enum_variant)]
enum Filter<T: Real> {
    AsPublished { forgetting: Forgetting<T>, filter: AekfUi<T>, record: Option<StepRecord<T>> },
    Corrected(Corrected<T>),
}

/// The corrected filter, and the estimator whose frames tell it the stiffness.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Corrected<T: Real> {
    frames: EstimatorOnRepeatedRoad<T>,
    filter: AekfUiInformed<T>,
    record: InformedRecord<T>,
    /// Time in s of the last step, before the first minus infinity.
    last_s: f64,
    /// Length in s of the calibration under way, when it ends once that is known, and when the pressure was last set.
    calibration_s: f64,
    calibration_ends_s: Option<f64>,
    set_s: f64,
}

impl<T: Real> PaperEstimator<T> {
    /// A filter for a corner whose samples come at about `sample_rate_hz`; `None` for [`EstimatorKind::Informed`], which is none of
    /// the paper's. Errors: the rate must be positive and finite; parameters of the corner that the filter refuses are named.
    pub fn new(
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<Option<Self>, ParameterError> {
        let filter = match kind {
            EstimatorKind::Informed => return Ok(None),
            EstimatorKind::AekfUiInformed => Filter::Corrected(Corrected::new(config, sample_rate_hz)?),
            EstimatorKind::AekfUi => as_published(config, Forgetting::OneStep)?,
            EstimatorKind::EkfUi => as_published(config, Forgetting::None)?,
        };
        let clock = SampleClock::new(sample_rate_hz)?;
        let least_hz = if kind.is_as_published() { sample_rate_hz } else { LEAST_STEP_HZ };
        let resampler = Resampler::new(sample_rate_hz, least_hz);
        Ok(Some(Self { config: *config, clock, resampler, filter }))
    }

    /// The tire has its placard pressure from the next sample on, for `seconds`: a calibration. The filters as published have no use
    /// for it. Errors: the length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        let seconds = positive("calibrate_s", seconds)?;
        if let Filter::Corrected(corrected) = &mut self.filter {
            corrected.frames.estimator_mut().begin_calibration(seconds)?;
            (corrected.calibration_s, corrected.calibration_ends_s) = (seconds, None);
        }
        Ok(())
    }

    /// Takes one sample: time in s, speed in m/s, body and wheel acceleration in m/s²; NaN is a missing value. Gives the estimate after it.
    pub fn update(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        body_accel_m_s2: T,
        wheel_accel_m_s2: T,
    ) -> CornerEstimate<T> {
        let at = self.clock.take(time_s, speed_m_s);
        // A stamp that is not to be gone by is refused by the resampler, and counted there.
        let steady_s = at.time_s.unwrap_or(f64::NAN);
        let (body, wheel) = (body_accel_m_s2, wheel_accel_m_s2);
        let step_s = T::lit(self.resampler.grid_period_s());
        match &mut self.filter {
            Filter::AsPublished { filter, record, .. } => {
                self.resampler.push(steady_s, at.speed_m_s, body, wheel, |sample| {
                    *record = Some(filter.step(step_s, &accelerations(&sample)));
                });
                let bad = self.resampler.is_bad();
                published_estimate(&self.config, record.as_ref(), time_s, bad)
            }
            Filter::Corrected(corrected) => {
                self.resampler.push(steady_s, at.speed_m_s, body, wheel, |sample| {
                    corrected.step(step_s, &sample);
                });
                let of_frames = corrected.frames.update(time_s, speed_m_s, body, wheel);
                corrected.measure(&self.config, at.now_s);
                corrected_estimate(&self.config, &corrected.record, &of_frames)
            }
        }
    }

    /// Starts again from the corner's initial pressure, as after a tire change.
    pub fn restart(&mut self) {
        // The same parameters were accepted before.
        match &mut self.filter {
            Filter::AsPublished { forgetting, filter, record } => {
                *record = None;
                *filter = published_filter(&self.config, *forgetting).unwrap_or(*filter);
            }
            Filter::Corrected(corrected) => {
                corrected.frames.estimator_mut().restart();
                corrected.filter = corrected_filter(&self.config).unwrap_or(corrected.filter);
                corrected.record = corrected.filter.record(InformedStatus::PredictedOnly);
            }
        }
    }

    pub fn counts(&self) -> SampleCounts {
        self.resampler.counts()
    }
}

impl<T: Real> Corrected<T> {
    fn new(config: &CornerConfig<T>, sample_rate_hz: f64) -> Result<Self, ParameterError> {
        let filter = corrected_filter(config)?;
        Ok(Self {
            frames: EstimatorOnRepeatedRoad::new(config, sample_rate_hz, RoadRepetition::Detect)?,
            filter,
            record: filter.record(InformedStatus::PredictedOnly),
            last_s: f64::NEG_INFINITY,
            calibration_s: 0.0,
            calibration_ends_s: None,
            set_s: f64::NEG_INFINITY,
        })
    }

    fn step(&mut self, step_s: T, sample: &GridSample<T>) {
        // The motion and the stiffness know nothing of a hole but how long it was.
        let hole_s = sample.time_s - core::mem::replace(&mut self.last_s, sample.time_s);
        let dt_s = if sample.after_gap && hole_s.is_finite() { T::lit(hole_s) } else { step_s };
        self.record = self.filter.step(dt_s, &accelerations(sample));
    }

    /// Gives the filter what the frames tell of the stiffness, and what a calibration has set.
    fn measure(&mut self, config: &CornerConfig<T>, now_s: f64) {
        if let Some(measured) = self.frames.estimator_mut().take_pseudo_measurement() {
            self.filter.measure_stiffness(measured.stiffness_n_per_m, measured.sd_n_per_m);
            self.record = self.filter.record(self.record.status);
        }
        if !(self.calibration_s > 0.0 && now_s.is_finite()) {
            return;
        }
        let ends_s = *self.calibration_ends_s.get_or_insert(now_s + self.calibration_s);
        if now_s < ends_s && !(now_s - self.set_s < SET_S) {
            self.set_s = now_s;
            let sd_kpa = T::lit(CALIBRATION_SD) * config.placard_kpa;
            let stiffness_n_per_m = config.tire.stiffness_n_per_m(config.placard_kpa);
            self.filter.measure_stiffness(stiffness_n_per_m, sd_kpa * config.tire.stiffness_per_kpa());
        }
    }
}

fn as_published<T: Real>(
    config: &CornerConfig<T>,
    forgetting: Forgetting<T>,
) -> Result<Filter<T>, ParameterError> {
    let filter = published_filter(config, forgetting)?;
    Ok(Filter::AsPublished { forgetting, filter, record: None })
}

fn published_filter<T: Real>(
    config: &CornerConfig<T>,
    forgetting: Forgetting<T>,
) -> Result<AekfUi<T>, ParameterError> {
    let start = FilterConfig::paper_simulation().with_forgetting(forgetting);
    AekfUi::new(config.quarter_car, start.with_initial_stiffness(config.initial_stiffness_n_per_m()))
}

/// The corrected filter, set for measurements that come every 0.7 s: a short memory of few, weighty innovations.
fn corrected_filter<T: Real>(config: &CornerConfig<T>) -> Result<AekfUiInformed<T>, ParameterError> {
    let forgetting = ParameterForgetting::Adaptive { memory: T::lit(5.0), significance: T::lit(0.2) };
    let settings = InformedConfig { forgetting, ..InformedConfig::for_corner(config) };
    AekfUiInformed::new(config.quarter_car, settings)
}

fn accelerations<T: Real>(sample: &GridSample<T>) -> CornerSample<T> {
    CornerSample { body_accel_m_s2: sample.body_accel_m_s2, wheel_accel_m_s2: sample.wheel_accel_m_s2 }
}

/// The estimate of a published filter: its stiffness is where it started, whatever its covariance says, so it is never valid. Its
/// parameters are taken for exact.
fn published_estimate<T: Real>(
    config: &CornerConfig<T>,
    record: Option<&StepRecord<T>>,
    time_s: f64,
    bad: bool,
) -> CornerEstimate<T> {
    let nan = T::lit(f64::NAN);
    let start = (config.initial_stiffness_n_per_m(), T::lit(f64::INFINITY));
    let (stiffness_n_per_m, sd_n_per_m) =
        record.map_or(start, |record| (record.stiffness_n_per_m(), record.stiffness_sd_n_per_m()));
    let pressure_kpa = config.tire.pressure_kpa(stiffness_n_per_m);
    let change_sd_kpa = sd_n_per_m / config.tire.stiffness_per_kpa();
    CornerEstimate {
        time_s,
        stiffness_n_per_m,
        stiffness_sd_n_per_m: sd_n_per_m,
        pressure_kpa,
        pressure_sd_kpa: config.tire.pressure_sd_kpa(pressure_kpa, sd_n_per_m),
        change_sd_kpa,
        level: Level::VehicleFile,
        axle_difference_sd_kpa: None,
        loss: None,
        cold: None,
        road_m: record.map_or(nan, |record| record.road_m),
        road_sd_m: record.map_or(nan, |record| record.road_variance_m2.sqrt()),
        validity: match record {
            _ if bad => Validity::BadSignal,
            None => Validity::Starting,
            Some(record) if record.is_diverged() => Validity::Diverged,
            Some(_) => Validity::NoInformation,
        },
        warning: Warning::None,
        diagnostics: Diagnostics {
            forgetting: record.map_or(T::one(), |record| record.forgetting),
            nis: record.map_or(nan, |record| record.nis * T::lit(0.5)),
            gate: record.map_or(T::zero(), |_| T::one()),
            change_probability: nan,
            pressure_variance_kpa2: change_sd_kpa * change_sd_kpa,
        },
    }
}

/// The estimate of the corrected filter, as valid as the frames that tell it the stiffness and with the same doubt of the vehicle file.
fn corrected_estimate<T: Real>(
    config: &CornerConfig<T>,
    record: &InformedRecord<T>,
    of_frames: &CornerEstimate<T>,
) -> CornerEstimate<T> {
    let per_kpa = config.tire.stiffness_per_kpa();
    let (stiffness_n_per_m, sd_n_per_m) = (record.stiffness_n_per_m(), record.stiffness_sd_n_per_m());
    let of_signals = of_frames.change_sd_kpa * per_kpa;
    let of_file = of_frames.stiffness_sd_n_per_m * of_frames.stiffness_sd_n_per_m - of_signals * of_signals;
    let stiffness_sd_n_per_m = (sd_n_per_m * sd_n_per_m + of_file.max(T::zero())).sqrt();
    let pressure_kpa = config.tire.pressure_kpa(stiffness_n_per_m);
    let pressure_sd_kpa = config.tire.pressure_sd_kpa(pressure_kpa, stiffness_sd_n_per_m);
    let change_sd_kpa = sd_n_per_m / per_kpa;
    let sound = pressure_kpa.is_finite() && pressure_sd_kpa.is_finite();
    CornerEstimate {
        stiffness_n_per_m,
        stiffness_sd_n_per_m,
        pressure_kpa,
        pressure_sd_kpa,
        change_sd_kpa,
        road_m: record.road_m,
        road_sd_m: record.road_sd_m(),
        validity: if sound { of_frames.validity } else { Validity::Diverged },
        diagnostics: Diagnostics {
            forgetting: record.forgetting,
            nis: record.nis,
            gate: of_frames.diagnostics.gate,
            change_probability: T::lit(f64::NAN),
            pressure_variance_kpa2: change_sd_kpa * change_sd_kpa,
        },
        ..*of_frames
    }
}

/// The estimator of a corner that was chosen by its name.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// An estimator lives where its owner puts it; there is no heap to box the larger one in.
#[allow(clippy::large_enum_variant)]
pub enum AnyEstimator<T: Real> {
    Informed(EstimatorOnRepeatedRoad<T>),
    Paper(PaperEstimator<T>),
}

impl<T: Real> AnyEstimator<T> {
    /// An estimator of `kind` for a corner whose samples come at about `sample_rate_hz`.
    /// Errors: the rate must be positive and finite; parameters of the corner that it refuses are named.
    pub fn new(
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<Self, ParameterError> {
        Ok(match PaperEstimator::new(kind, config, sample_rate_hz)? {
            Some(paper) => Self::Paper(paper),
            None => {
                Self::Informed(EstimatorOnRepeatedRoad::new(config, sample_rate_hz, RoadRepetition::Detect)?)
            }
        })
    }

    /// The tire has its placard pressure from the next sample on, for `seconds`: a calibration.
    /// Errors: the length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        match self {
            Self::Informed(estimator) => estimator.estimator_mut().begin_calibration(seconds),
            Self::Paper(estimator) => estimator.begin_calibration(seconds),
        }
    }

    /// Takes one sample: time in s, speed in m/s, body and wheel acceleration in m/s²; NaN is a missing value. Gives the estimate after it.
    pub fn update(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        body_accel_m_s2: T,
        wheel_accel_m_s2: T,
    ) -> CornerEstimate<T> {
        match self {
            Self::Informed(estimator) => {
                estimator.update(time_s, speed_m_s, body_accel_m_s2, wheel_accel_m_s2)
            }
            Self::Paper(estimator) => estimator.update(time_s, speed_m_s, body_accel_m_s2, wheel_accel_m_s2),
        }
    }
}
