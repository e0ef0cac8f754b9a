//! `aekf-ui-informed`: the published recursion corrected, and given the stiffness from outside. What was changed and why:
//! `docs/math/ekf-ui.md`, section 5, whose equations (39)-(50) continue the paper's numbering.
//!
//! Called once a sample by an estimator that also brings measurements of the stiffness, from wherever it has them.
//! Knows nothing of pressure, nor of where those measurements come from.

use nalgebra::{
    Matrix2, Matrix4, Matrix4x5, Matrix5, Matrix5x2, Matrix5x4, RowVector2, Vector2, Vector4, Vector5,
};

use crate::informed_config::InformedConfig;
use crate::informed_record::{InformedRecord, InformedStatus, StiffnessUpdate};
use crate::motion::{Motion, MotionStep, TIRE_FORCE};
use crate::parameter::ParameterMemory;
use crate::quarter_car::state;
use itpms_core::Real;
use itpms_core::model::{CornerSample, ParameterError, QuarterCar};

/// Longest interval in s between two samples over which the force may be taken for a straight line: two and a half of the slowest log's.
const LONGEST_STEP_S: f64 = 0.025;
/// A longer interval is walked on a still road in steps of this many s: there the tire's spring is part of the
/// motion, and third order keeps a wheel hop of 15 Hz within 3 %.
const STRIDE_S: f64 = 0.01;
/// Longest interval in s that is bridged; after a longer one the motion starts anew.
const LONGEST_GAP_S: f64 = 0.5;
/// Accelerations beyond this, in m/s², are no measurement.
const LARGEST_M_S2: f64 = 1e4;
/// Displacements (m) and velocities (m/s) beyond this are no motion of a wheel.
const ABSURD_MOTION: f64 = 100.0;
/// A single stiffness measurement is not believed to be better than this part of the largest stiffness.
const BEST_RELATIVE_SD: f64 = 1e-3;
/// A worse one than this, in N/m, says nothing about a tire.
const WORST_SD_N_PER_M: f64 = 1e9;
/// A measurement further out than this many of its own standard deviations is drawn in to there.
const FURTHEST_SD: f64 = 10.0;

/// The corrected filter. A value: clone it, save it (feature `serde`), resume it bit-identically.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AekfUiInformed<T: Real> {
    car: QuarterCar<T>,
    config: InformedConfig<T>,
    /// Motion states, in the order of [`state`].
    x: Vector4<T>,
    /// Tire force in N, the unknown input.
    F: T,
    /// Joint covariance of motion and force.
    Pi: Matrix5<T>,
    k_t: T,
    /// Variance of `k_t`, independent of the motion.
    P_k: T,
    memory: ParameterMemory<T>,
    /// No sample has been seen since the motion started.
    at_start: bool,
    restarts: u32,
}

impl<T: Real> AekfUiInformed<T> {
    /// A filter at rest with the configured stiffness.
    pub fn new(car: QuarterCar<T>, config: InformedConfig<T>) -> Result<Self, ParameterError> {
        let config = config.validated()?;
        let sd = config.initial_stiffness_sd_n_per_m;
        let mut filter = Self {
            car,
            config,
            x: Vector4::zeros(),
            F: T::zero(),
            Pi: Matrix5::zeros(),
            k_t: config.initial_stiffness_n_per_m,
            P_k: sd * sd,
            memory: ParameterMemory::default(),
            at_start: true,
            restarts: 0,
        };
        filter.start_motion();
        Ok(filter)
    }

    /// One sample, `dt_s` seconds after the one before. A missing sample (NaN) is predicted over. Never panics.
    pub fn step(&mut self, dt_s: T, sample: &CornerSample<T>) -> InformedRecord<T> {
        if !(dt_s > T::zero() && dt_s.is_finite()) {
            return self.record(InformedStatus::Ignored);
        }
        self.walk_stiffness(dt_s);
        if dt_s > T::lit(LONGEST_GAP_S) {
            return self.restart();
        }
        let motion = Motion::new(&self.car, self.config.leak_rad_s);
        // The first sample finds the force; before it there is nothing that could have moved.
        let mut rest = if self.at_start { T::zero() } else { dt_s };
        while rest > T::lit(LONGEST_STEP_S) {
            self.predict(&motion, T::lit(STRIDE_S));
            rest -= T::lit(STRIDE_S);
        }
        let y = Vector2::new(sample.body_accel_m_s2, sample.wheel_accel_m_s2);
        // NaN is not within any bound either.
        let record = if y.iter().all(|value| value.abs() <= T::lit(LARGEST_M_S2)) {
            self.at_start = false;
            self.update(&motion, rest, &y)
        } else {
            self.predict(&motion, rest);
            self.record(InformedStatus::PredictedOnly)
        };
        if self.is_sane() { record } else { self.restart() }
    }

    /// How often the motion was started anew.
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// The filter's state now, without a step: after a stiffness measurement, for one.
    pub fn record(&self, status: InformedStatus) -> InformedRecord<T> {
        let nan = T::lit(f64::NAN);
        // (47)  x_r = x_w + F/k_t
        let road_m = self.x[state::WHEEL_POSITION] + self.F / self.k_t;
        // (47)  c = ∂x_r/∂(x, F),  var x_r = cᵀΠc + (F/k_t²)² P_k
        let mut c = Vector5::zeros();
        c[state::WHEEL_POSITION] = T::one();
        c[TIRE_FORCE] = T::one() / self.k_t;
        let by_stiffness = self.F / (self.k_t * self.k_t);
        let road_variance_m2 = c.dot(&(self.Pi * c)).max(T::zero()) + by_stiffness * by_stiffness * self.P_k;
        InformedRecord {
            status,
            state: Vector5::new(self.x[0], self.x[1], self.x[2], self.x[3], self.k_t),
            tire_force_n: self.F,
            road_m,
            road_variance_m2,
            motion_covariance: self.Pi,
            stiffness_variance: self.P_k,
            residual_m_s2: Vector2::repeat(nan),
            nis: nan,
            forgetting: self.memory.lambda(),
        }
    }

    fn update(&mut self, motion: &Motion<T>, dt_s: T, y: &Vector2<T>) -> InformedRecord<T> {
        let MotionStep { Phi, G_0, G_1 } = motion.step(dt_s);
        let H = &motion.H;
        // (14)  x̂⁻ with the force held, to third order instead of first
        let x_prior = Phi * self.x + (G_0 + G_1) * self.F;
        // (43)  P⁻ = [Φ G₀] Π [Φ G₀]ᵀ + Q
        let from = beside(&Phi, &G_0);
        let P = from * self.Pi * from.transpose() + self.process_noise(dt_s);
        // (44)  D = ∂y/∂F, its effect within the step included
        let D = motion.D + H * G_1;
        // (19)  z = y - h(x̂⁻, F̂ₖ₋₁)
        let z = y - H * x_prior - motion.D * self.F;
        let noise = self.config.accel_noise_m_s2;
        let R = Matrix2::identity() * (noise * noise);
        // (20)  C = HP⁻Hᵀ + R, positive definite because R is
        let Some(C_inverse) = (H * P * H.transpose() + R).try_inverse() else {
            return self.record(InformedStatus::PredictedOnly);
        };
        // (16)  S = (DᵀC⁻¹D)⁻¹,  M = S DᵀC⁻¹: the input by weighted least squares
        let S = T::one() / (D.transpose() * C_inverse * D).x;
        let M: RowVector2<T> = D.transpose() * C_inverse * S;
        // (16)  K = P⁻HᵀC⁻¹
        let K = P * H.transpose() * C_inverse;
        // (45)  gain of motion and force in one: [K(I - DM) + G₁M; M]
        let mut gain = Matrix5x2::zeros();
        gain.fixed_view_mut::<TIRE_FORCE, 2>(0, 0).copy_from(&(K * (Matrix2::identity() - D * M) + G_1 * M));
        gain.set_row(TIRE_FORCE, &M);
        // (17), reading `Current`
        let step = gain * z;
        self.x = x_prior + step.fixed_rows::<TIRE_FORCE>(0);
        self.F += step[TIRE_FORCE];
        // (46)  Π = (E - 𝒦H) P⁻ (E - 𝒦H)ᵀ + 𝒦 R 𝒦ᵀ
        let left = Matrix5x4::identity() - gain * H;
        self.Pi = symmetric(&(left * P * left.transpose() + gain * R * gain.transpose()));
        let unexplained = z - D * (M * z).x;
        InformedRecord {
            residual_m_s2: z,
            nis: unexplained.dot(&(C_inverse * unexplained)),
            ..self.record(InformedStatus::Updated)
        }
    }

    /// A step without measurement: the road keeps its height, ever less surely, and the tire pushes accordingly.
    fn predict(&mut self, motion: &Motion<T>, dt_s: T) {
        // (48)  the road walks, and the force by k_t times that
        let walk = self.k_t * self.config.road_walk_m_sqrt_s;
        let Phi = motion.step_on_still_road(self.k_t, dt_s);
        let whole = Phi * Vector5::new(self.x[0], self.x[1], self.x[2], self.x[3], self.F);
        self.x = whole.fixed_rows::<TIRE_FORCE>(0).into_owned();
        self.F = whole[TIRE_FORCE];
        let mut Pi = Phi * self.Pi * Phi.transpose();
        let mut block = Pi.fixed_view_mut::<TIRE_FORCE, TIRE_FORCE>(0, 0);
        block += self.process_noise(dt_s);
        Pi[(TIRE_FORCE, TIRE_FORCE)] += walk * walk * dt_s;
        self.Pi = symmetric(&Pi);
    }

    /// `Q` of one step: disturbances of both velocities.
    fn process_noise(&self, dt_s: T) -> Matrix4<T> {
        let walk = self.config.velocity_walk_m_s_sqrt_s;
        let mut q = Matrix4::zeros();
        q[(state::BODY_VELOCITY, state::BODY_VELOCITY)] = walk * walk * dt_s;
        q[(state::WHEEL_VELOCITY, state::WHEEL_VELOCITY)] = walk * walk * dt_s;
        q
    }

    /// Starts from rest. What body and wheel share begins at zero by definition, since the leak forgets its level anyway (a micrometre
    /// keeps the covariance regular); only the body's place and velocity relative to the wheel are unknown, and the force.
    fn start_motion(&mut self) {
        let (place, velocity, shared) = (T::lit(0.03), T::lit(0.3), T::lit(1e-6));
        let force = self.k_t * place;
        let sd = Vector5::new(place, velocity, shared, shared, force);
        self.x = Vector4::zeros();
        self.F = T::zero();
        self.Pi = Matrix5::from_diagonal(&sd.component_mul(&sd));
        self.at_start = true;
    }

    fn is_sane(&self) -> bool {
        let road = self.F / self.config.lowest_stiffness_n_per_m;
        self.x.iter().all(|value| value.abs() <= T::lit(ABSURD_MOTION))
            && road.abs() <= T::lit(ABSURD_MOTION)
            && self.Pi.iter().all(|value| value.is_finite())
    }

    fn restart(&mut self) -> InformedRecord<T> {
        self.start_motion();
        self.restarts = self.restarts.saturating_add(1);
        self.record(InformedStatus::Restarted)
    }
}

/// The stiffness: a scalar filter of its own, since the accelerations say nothing about it.
impl<T: Real> AekfUiInformed<T> {
    /// A measurement of the tire stiffness and its standard deviation, both in N/m, from any source whose errors
    /// are independent from one measurement to the next. A noisy one may lie outside what is possible, even below
    /// zero: cutting it off there would bias the estimate. Only the estimate is kept within the configured range.
    pub fn measure_stiffness(&mut self, value_n_per_m: T, sd_n_per_m: T) -> StiffnessUpdate<T> {
        if !(value_n_per_m.is_finite() && sd_n_per_m > T::zero() && sd_n_per_m < T::lit(WORST_SD_N_PER_M)) {
            return StiffnessUpdate::Ignored;
        }
        let largest = self.config.highest_stiffness_n_per_m;
        let sd = sd_n_per_m.max(largest * T::lit(BEST_RELATIVE_SD));
        // Nothing sane is further out, and its square must not overflow.
        let far = T::lit(FURTHEST_SD) * sd + largest;
        self.absorb(value_n_per_m.max(-far).min(far), sd * sd)
    }

    /// Forgets as the innovation asks, then corrects by it.
    fn absorb(&mut self, value: T, R: T) -> StiffnessUpdate<T> {
        let nu = value - self.k_t;
        let believed = self.P_k + R;
        let lambda = self.memory.take_in(&self.config.forgetting, nu, R, self.P_k);
        // (18)  P = λP, up to the limit
        let limit = self.config.stiffness_sd_limit_n_per_m;
        let P = (self.P_k * lambda).min(limit * limit).max(self.P_k);
        // (50)  K = P/(P + R),  k_t += K ν,  P = R K
        let K = P / (P + R);
        self.k_t = self.config.within_range(self.k_t + K * nu);
        self.P_k = R * K;
        StiffnessUpdate::Used { innovation_n_per_m: nu, nis: nu * nu / believed, forgetting: lambda }
    }

    /// Random walk of the stiffness, up to the sd beyond which nothing is known anyway.
    fn walk_stiffness(&mut self, dt_s: T) {
        let (walk, limit) =
            (self.config.stiffness_walk_n_per_m_sqrt_s, self.config.stiffness_sd_limit_n_per_m);
        self.P_k = (self.P_k + walk * walk * dt_s).min(limit * limit).max(self.P_k);
    }
}

/// `[a b]`, 4x5.
fn beside<T: Real>(a: &Matrix4<T>, b: &Vector4<T>) -> Matrix4x5<T> {
    let mut whole = Matrix4x5::zeros();
    whole.fixed_view_mut::<TIRE_FORCE, TIRE_FORCE>(0, 0).copy_from(a);
    whole.set_column(TIRE_FORCE, b);
    whole
}

/// The symmetric part: products of rounded matrices are symmetric only to rounding.
fn symmetric<T: Real>(a: &Matrix5<T>) -> Matrix5<T> {
    (a + a.transpose()) * T::lit(0.5)
}
