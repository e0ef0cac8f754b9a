//! The published AEKF-UI in closed form: state and covariance are a scalar Kalman update by the body's acceleration, and
//! the wheel's acceleration gives the road and nothing else. The same numbers as [`crate::AekfUi`] in less than a
//! quarter of the instructions, also in `f32`. Derivation: `docs/math/lean-aekf-ui.md`; equations (53)-(67) are its own.
//!
//! Called by whoever runs the published filter on a controller. Knows nothing of pressure. May diverge, as published,
//! and says so instead of panicking or returning nonsense.
//!
//! [`jacobian`]: products with `A` and `H`; [`covariance`]: the packed `P` and its step; [`record`]: what a step says.

pub mod covariance;
pub mod jacobian;
pub mod record;

use nalgebra::{Matrix2, Matrix5, Vector2, Vector5};
use thiserror::Error;

use crate::aekf_ui::{MAX_MOTION, MAX_STIFFNESS_N_PER_M};
use crate::config::{CorrectionInput, FactorTiming, FilterConfig, Forgetting};
use crate::quarter_car::state::TIRE_STIFFNESS;
use crate::record::{Divergence, StepStatus};
use covariance::Covariance;
use itpms_core::Real;
use itpms_core::model::{CornerSample, ParameterError, QuarterCar};
use jacobian::{AccelerationRows, Corner, StateVector};
pub use record::LeanRecord;

/// Why a lean filter cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LeanError {
    /// A value no filter can start from.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error("correction_input is Previous, expected Current: only that has a closed form")]
    PreviousInput,
    #[error("forgetting is Iterative, expected None or OneStep: only those need no more than traces")]
    IterativeForgetting,
}

/// EKF-UI and AEKF-UI as published, in the reading [`CorrectionInput::Current`]. A value: clone it, save it (feature
/// `serde`), resume it bit-identically. To start anew, build another.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AekfUiLean<T> {
    corner: Corner<T>,
    Q: StateVector<T>,
    R: [T; 2],
    adaptive: bool,
    factor_timing: FactorTiming,
    believed: Belief<T>,
    diverged: Option<Divergence>,
}

/// State from one step to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Belief<T> {
    x: StateVector<T>,
    P: Covariance<T>,
    u: T,
    S: T,
    lambda: T,
    /// `tr C_0` and the weight `G_2` it is the mean of.
    trace_C_0: T,
    G_2: T,
}

/// The prediction: `x⁻` and `F = A P⁺ Aᵀ`.
struct Prediction<T> {
    x: StateVector<T>,
    F: Covariance<T>,
}

impl<T: Real> AekfUiLean<T> {
    /// A filter at its initial state (eq. 12).
    pub fn new(car: QuarterCar<T>, config: FilterConfig<T>) -> Result<Self, LeanError> {
        let config = config.validated()?;
        if config.correction_input == CorrectionInput::Previous {
            return Err(LeanError::PreviousInput);
        }
        let adaptive = match config.forgetting {
            Forgetting::None => false,
            Forgetting::OneStep => true,
            Forgetting::Iterative(_) => return Err(LeanError::IterativeForgetting),
        };
        Ok(Self {
            corner: Corner::new(&car),
            Q: config.process_variance.into(),
            R: config.measurement_variance.into(),
            adaptive,
            factor_timing: config.factor_timing,
            believed: Belief {
                x: config.initial_state.into(),
                P: Covariance::from_diagonal(&config.initial_variance.into()),
                u: config.initial_road_m,
                S: T::zero(),
                lambda: T::one(),
                trace_C_0: T::zero(),
                G_2: T::zero(),
            },
            diverged: None,
        })
    }

    /// `x⁺`, in the order and units of [`crate::quarter_car::state`].
    pub fn state(&self) -> Vector5<T> {
        self.believed.x.into()
    }

    /// `P⁺`, in the squared units of the state.
    pub fn covariance(&self) -> Matrix5<T> {
        self.believed.P.to_matrix()
    }

    /// One sample, `dt_s` seconds after the one before. Never panics; see [`StepStatus`] for what can happen: a sample that is not finite
    /// is predicted over, a time step that is not positive and finite is ignored, and a filter that has diverged holds its last good state.
    pub fn step(&mut self, dt_s: T, sample: &CornerSample<T>) -> LeanRecord<T> {
        if let Some(cause) = self.diverged {
            return self.held(StepStatus::Diverged(cause));
        }
        if !(dt_s > T::zero() && dt_s.is_finite()) {
            return self.held(StepStatus::Ignored);
        }
        let prediction = self.predict(dt_s);
        let y = [sample.body_accel_m_s2, sample.wheel_accel_m_s2];
        if !(y[0].is_finite() && y[1].is_finite()) {
            return self.unmeasured(&prediction);
        }
        self.measured(&prediction, y)
    }

    /// Takes over what a step found, if it still describes a car.
    #[inline(always)]
    fn take_over(&mut self, found: Belief<T>, record: LeanRecord<T>) -> LeanRecord<T> {
        if !is_car(&found) {
            return self.diverge(cause(&found));
        }
        self.believed = found;
        record
    }

    #[cold]
    fn diverge(&mut self, cause: Divergence) -> LeanRecord<T> {
        self.diverged = Some(cause);
        self.held(StepStatus::Diverged(cause))
    }

    #[inline(always)]
    fn predict(&self, dt_s: T) -> Prediction<T> {
        let Belief { x, P, u, .. } = &self.believed;
        // (13), (14)
        let rows = self.corner.acceleration_rows(x, *u, dt_s);
        let F = P.propagated(&rows, dt_s);
        // (7), (8)  x̂⁻ = x̂⁺ + Δt f(x̂⁺, u*)
        let [body, wheel] = self.corner.accelerations(x, *u);
        let [x_b, v_b, x_w, v_w, k_t] = *x;
        Prediction { x: [x_b + dt_s * v_b, v_b + dt_s * body, x_w + dt_s * v_w, v_w + dt_s * wheel, k_t], F }
    }

    /// The stages of Fig. 4 after the prediction.
    #[inline(always)]
    fn measured(&mut self, prediction: &Prediction<T>, y: [T; 2]) -> LeanRecord<T> {
        let Prediction { x, F } = prediction;
        let (before, corner) = (&self.believed, &self.corner);
        let rows = corner.acceleration_rows(x, before.u, T::one());
        // (19)  z = y - h(x̂⁻, u*ₖ₋₁)
        let expected = corner.accelerations(x, before.u);
        let z = [y[0] - expected[0], y[1] - expected[1]];

        // (58)  f₀ = F h₀, f₁ = F h₁ and M = H F Hᵀ
        let [f_0, f_1] = F.times_acceleration_rows(&rows);
        let [M_00, M_01] = rows.times(&f_0);
        let [_, M_11] = rows.times(&f_1);
        let (Qh_0, [N_00, N_01, N_11]) = self.process_noise(&rows);

        // (65)  the mean of z zᵀ's trace under the memory that λ leaves it
        let G_2 = before.G_2 / before.lambda + T::one();
        let trace_C_0 = before.trace_C_0 + (z[0] * z[0] + z[1] * z[1] - before.trace_C_0) / G_2;
        let lambda = if self.adaptive {
            // (66)  λ = max{1, (tr C₀ - tr HQHᵀ - tr R)/tr M}
            let wanted = (trace_C_0 - N_00 - N_11 - self.R[0] - self.R[1]) / (M_00 + M_11);
            if wanted > T::one() { wanted } else { T::one() }
        } else {
            T::one()
        };
        let applied = match self.factor_timing {
            FactorTiming::Previous => before.lambda,
            FactorTiming::Same => lambda,
        };

        // (57)  C = λM + HQHᵀ + R
        let c_00 = applied * M_00 + N_00 + self.R[0];
        let c_01 = applied * M_01 + N_01;
        let c_11 = applied * M_11 + N_11 + self.R[1];
        let per_c_00 = c_00.recip();
        // (62)  S = (c₁₁ - c₀₁²/c₀₀)/d²,  (63)  u* = u*ₖ₋₁ + (z₁ - c₀₁/c₀₀ z₀)/d,  d = k_t/m_w
        let along = c_01 * per_c_00;
        let per_d = corner.m_w / x[TIRE_STIFFNESS];
        let S = (c_11 - along * c_01) * per_d * per_d;
        if !(S > T::zero() && S.is_finite()) {
            return self.diverge(Divergence::InputNotDetermined);
        }
        let u = before.u + (z[1] - along * z[0]) * per_d;

        // (60), (61)  v = P⁻h₀,  x̂⁺ = x̂⁻ + v z₀/c₀₀,  P⁺ = P⁻ - v vᵀ/c₀₀
        let v: StateVector<T> = core::array::from_fn(|i| applied * f_0[i] + Qh_0[i]);
        let k = v.map(|value| value * per_c_00);
        let x = core::array::from_fn(|i| x[i] + k[i] * z[0]);
        let P = F.updated(applied, &self.Q, &k, &v);
        let believed = Belief { x, P, u, S, lambda, trace_C_0, G_2 };
        let record = LeanRecord {
            residual_m_s2: z.into(),
            believed_covariance: Matrix2::new(c_00, c_01, c_01, c_11),
            measured_trace: trace_C_0,
            ..believed.record(StepStatus::Updated)
        };
        self.take_over(believed, record)
    }

    /// `Q h_0` and the upper triangle of `H Q Hᵀ`.
    #[inline(always)]
    fn process_noise(&self, rows: &AccelerationRows<T>) -> (StateVector<T>, [T; 3]) {
        let (Corner { k_s, c_s, .. }, Q) = (&self.corner, &self.Q);
        // (59)  Qh₀ = Qs/m_b
        let (k, c) = (*k_s * rows.per_m_b, *c_s * rows.per_m_b);
        let Qh_0 = [-k * Q[0], -c * Q[1], k * Q[2], c * Q[3], T::zero()];
        // (59)  h₁ᵀQh₁ by the elements of h₁
        let (k, c) = (*k_s * rows.per_m_w, *c_s * rows.per_m_w);
        let wheel = k + rows.tire;
        let N_11 = k * k * Q[0]
            + c * c * (Q[1] + Q[3])
            + wheel * wheel * Q[2]
            + rows.deflection * rows.deflection * Q[4];
        let [N_00, N_01] = rows.times(&Qh_0);
        (Qh_0, [N_00, N_01, N_11])
    }

    /// A step without measurement: prediction (eq. 14) with the input held. The paper does not treat this case.
    #[cold]
    fn unmeasured(&mut self, prediction: &Prediction<T>) -> LeanRecord<T> {
        let P = prediction.F.plus_diagonal(&self.Q);
        let believed = Belief { x: prediction.x, P, ..self.believed };
        self.take_over(believed, believed.record(StepStatus::PredictedOnly))
    }

    #[cold]
    fn held(&self, status: StepStatus) -> LeanRecord<T> {
        self.believed.record(status)
    }
}

impl<T: Real> Belief<T> {
    /// The state, seen from outside; the measurement's fields are NaN.
    #[inline(always)]
    fn record(&self, status: StepStatus) -> LeanRecord<T> {
        let nan = T::lit(f64::NAN);
        LeanRecord {
            status,
            road_m: self.u,
            road_variance_m2: self.S,
            stiffness_n_per_m: self.x[TIRE_STIFFNESS],
            stiffness_variance_n2_per_m2: self.P.diagonal()[TIRE_STIFFNESS],
            residual_m_s2: Vector2::repeat(nan),
            believed_covariance: Matrix2::repeat(nan),
            measured_trace: nan,
            forgetting: self.lambda,
        }
    }
}

/// Whether it still describes a car; the limits are the dense filter's. NaN fails every comparison.
#[inline(always)]
fn is_car<T: Real>(believed: &Belief<T>) -> bool {
    let Belief { x, P, u, lambda, .. } = believed;
    let limit = T::lit(MAX_MOTION);
    x[TIRE_STIFFNESS] > T::zero()
        && x[TIRE_STIFFNESS] < T::lit(MAX_STIFFNESS_N_PER_M)
        && x[..TIRE_STIFFNESS].iter().all(|value| value.abs() < limit)
        && u.abs() < limit
        && P.diagonal().iter().all(|variance| *variance >= T::zero())
        && P.is_finite()
        && lambda.is_finite()
}

/// What keeps it from describing a car. Inlined, or else every belief would have to be put into memory for it.
#[inline(always)]
fn cause<T: Real>(believed: &Belief<T>) -> Divergence {
    let Belief { x, P, u, lambda, .. } = believed;
    let limit = T::lit(MAX_MOTION);
    if !(x.iter().all(|value| value.is_finite()) && P.is_finite() && u.is_finite() && lambda.is_finite()) {
        Divergence::NotFinite
    } else if !(x[TIRE_STIFFNESS] > T::zero() && x[TIRE_STIFFNESS] < T::lit(MAX_STIFFNESS_N_PER_M)) {
        Divergence::StiffnessOutOfRange
    } else if !(x[..TIRE_STIFFNESS].iter().all(|value| value.abs() < limit) && u.abs() < limit) {
        Divergence::MotionOutOfRange
    } else {
        Divergence::NegativeVariance
    }
}
