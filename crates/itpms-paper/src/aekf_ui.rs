//! The adaptive extended Kalman filter with unknown input as published: the recursion of [`crate::ekf_ui`] with the
//! factor of [`crate::forgetting`] (Fig. 4). With [`Forgetting::None`] it is the EKF-UI.
//!
//! Called once a sample by whoever reproduces the paper. Knows nothing of pressure. May diverge, as published, and
//! says so instead of panicking or returning nonsense.

use nalgebra::{Matrix2, Matrix5, Vector2, Vector5};

use crate::config::{FactorTiming, FilterConfig, Forgetting};
use crate::ekf_ui::{self, InputEstimate, Outlook, Prediction};
use crate::forgetting::{self, Evidence, ResidualMemory};
use crate::quarter_car::state;
use crate::record::{Divergence, StepRecord, StepStatus};
use itpms_core::Real;
use itpms_core::model::{CornerSample, ParameterError, QuarterCar};

/// Stiffest spring still taken for a tire, in N/m: some thirty times a truck's.
pub(super) const MAX_STIFFNESS_N_PER_M: f64 = 3e7;
/// Largest displacement or road height in m, and velocity in m/s. Drift alone reaches metres within a minute, so
/// this is far out: what is beyond it is no longer drift.
pub(super) const MAX_MOTION: f64 = 1e3;

/// EKF-UI and AEKF-UI as published. A value: clone it, save it (feature `serde`), resume it bit-identically.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AekfUi<T: Real> {
    car: QuarterCar<T>,
    config: FilterConfig<T>,
    x: Vector5<T>,
    P: Matrix5<T>,
    u: T,
    S: T,
    lambda: T,
    memory: ResidualMemory<T>,
    diverged: Option<Divergence>,
    resets: u32,
}

impl<T: Real> AekfUi<T> {
    /// A filter at its initial state (eq. 12).
    pub fn new(car: QuarterCar<T>, config: FilterConfig<T>) -> Result<Self, ParameterError> {
        let config = config.validated()?;
        Ok(Self {
            car,
            config,
            x: config.initial_state,
            P: Matrix5::from_diagonal(&config.initial_variance),
            u: config.initial_road_m,
            S: T::zero(),
            lambda: T::one(),
            memory: ResidualMemory::default(),
            diverged: None,
            resets: 0,
        })
    }

    /// One sample, `dt_s` seconds after the one before. Never panics; see [`StepStatus`] for what can happen.
    pub fn step(&mut self, dt_s: T, sample: &CornerSample<T>) -> StepRecord<T> {
        if let Some(cause) = self.diverged {
            return self.held(StepStatus::Diverged(cause));
        }
        if !(dt_s > T::zero() && dt_s.is_finite()) {
            return self.held(StepStatus::Ignored);
        }
        let prediction = ekf_ui::predict(&self.car, &self.x, self.u, &self.P, dt_s);
        let y = Vector2::new(sample.body_accel_m_s2, sample.wheel_accel_m_s2);
        let record = if y.iter().all(|value| value.is_finite()) {
            self.measured(&prediction, &y)
        } else {
            Ok(self.unmeasured(&prediction))
        };
        match record.and_then(check) {
            Ok(record) => {
                self.x = record.state;
                self.P = record.covariance;
                self.u = record.road_m;
                self.S = record.road_variance_m2;
                self.lambda = record.forgetting;
                record
            }
            Err(cause) => {
                self.diverged = Some(cause);
                self.held(StepStatus::Diverged(cause))
            }
        }
    }

    /// Back to the initial state; counted in [`AekfUi::resets`].
    pub fn reset(&mut self) {
        if let Ok(fresh) = Self::new(self.car, self.config) {
            *self = Self { resets: self.resets.saturating_add(1), ..fresh };
        }
    }

    /// How often [`AekfUi::reset`] was called.
    pub fn resets(&self) -> u32 {
        self.resets
    }

    /// The stages of Fig. 4 after the prediction.
    fn measured(&mut self, prediction: &Prediction<T>, y: &Vector2<T>) -> Result<StepRecord<T>, Divergence> {
        let FilterConfig { process_variance: Q, measurement_variance: R, .. } = &self.config;
        let outlook = ekf_ui::look_out(&self.car, &prediction.state, self.u, y);
        let C_0 = self.memory.take_in(&outlook.z, self.lambda);
        let evidence = Evidence { H: &outlook.H, propagated: &prediction.propagated, Q, R, C_0: &C_0 };
        let lambda = match &self.config.forgetting {
            Forgetting::None => T::one(),
            Forgetting::OneStep => forgetting::one_step_factor(&evidence),
            Forgetting::Iterative(descent) => forgetting::iterative_factor(descent, &evidence, self.lambda),
        };
        let applied = match self.config.factor_timing {
            FactorTiming::Previous => self.lambda,
            FactorTiming::Same => lambda,
        };
        let optimality = forgetting::optimality(&evidence, applied);
        let P_prior = ekf_ui::prior_covariance(&prediction.propagated, applied, Q);
        let input =
            ekf_ui::estimate_input(&outlook, &P_prior, R, self.u).ok_or(Divergence::InputNotDetermined)?;
        let (x, P) = ekf_ui::correct(
            &self.car,
            &prediction.state,
            &P_prior,
            R,
            &outlook,
            &input,
            y,
            self.config.correction_input,
        );
        let (Outlook { z, .. }, InputEstimate { C, S, u, .. }) = (outlook, input);
        Ok(StepRecord {
            status: StepStatus::Updated,
            prior_state: prediction.state,
            prior_covariance: P_prior,
            state: x,
            covariance: P,
            road_m: u,
            road_variance_m2: S,
            residual_m_s2: z,
            believed_covariance: C,
            measured_covariance: C_0,
            nis: C.lu().solve(&z).map_or(T::lit(f64::NAN), |weighted| z.dot(&weighted)),
            forgetting: lambda,
            optimality,
        })
    }

    /// A step without measurement: prediction (eq. 14) with the input held. The paper does not treat this case.
    fn unmeasured(&self, prediction: &Prediction<T>) -> StepRecord<T> {
        let prior = ekf_ui::prior_covariance(&prediction.propagated, T::one(), &self.config.process_variance);
        StepRecord {
            status: StepStatus::PredictedOnly,
            prior_state: prediction.state,
            prior_covariance: prior,
            state: prediction.state,
            covariance: prior,
            ..self.held(StepStatus::PredictedOnly)
        }
    }

    fn held(&self, status: StepStatus) -> StepRecord<T> {
        let nan = T::lit(f64::NAN);
        StepRecord {
            status,
            prior_state: self.x,
            prior_covariance: self.P,
            state: self.x,
            covariance: self.P,
            road_m: self.u,
            road_variance_m2: self.S,
            residual_m_s2: Vector2::repeat(nan),
            believed_covariance: Matrix2::repeat(nan),
            measured_covariance: Matrix2::repeat(nan),
            nis: nan,
            forgetting: self.lambda,
            optimality: nan,
        }
    }
}

/// The record, if it still describes a car.
fn check<T: Real>(record: StepRecord<T>) -> Result<StepRecord<T>, Divergence> {
    let finite = record.state.iter().chain(record.covariance.iter()).all(|value| value.is_finite())
        && record.road_m.is_finite()
        && record.forgetting.is_finite();
    if !finite {
        return Err(Divergence::NotFinite);
    }
    let stiffness = record.stiffness_n_per_m();
    if !(stiffness > T::zero() && stiffness < T::lit(MAX_STIFFNESS_N_PER_M)) {
        return Err(Divergence::StiffnessOutOfRange);
    }
    let motion = record.state.fixed_rows::<{ state::TIRE_STIFFNESS }>(0).amax().max(record.road_m.abs());
    if !(motion < T::lit(MAX_MOTION)) {
        return Err(Divergence::MotionOutOfRange);
    }
    if record.covariance.diagonal().iter().any(|variance| *variance < T::zero()) {
        return Err(Divergence::NegativeVariance);
    }
    Ok(record)
}
