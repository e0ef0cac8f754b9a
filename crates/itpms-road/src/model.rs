//! The quarter car with the road as a state, in coordinates that suit single precision, and its exact discretisation
//! (docs/math/road.md, eq. 1-8).
//!
//! Called by [`crate::filter`] and [`crate::limits`]. Knows nothing of samples, time stamps or missing values.

use crate::config::RoadConfig;
use itpms_core::Real;
use itpms_core::model::QuarterCar;
use nalgebra::{Matrix2, SMatrix, SVector};

pub(crate) const STATES: usize = 9;
/// The first of them, which the measurements see; the road's height behind them only follows.
pub(crate) const CORE: usize = 7;

pub(crate) type State<T> = SVector<T, STATES>;
pub(crate) type Matrix<T> = SMatrix<T, STATES, STATES>;
pub(crate) type CoreState<T> = SVector<T, CORE>;
pub(crate) type CoreMatrix<T> = SMatrix<T, CORE, CORE>;

/// Names of the state's components. Differences instead of heights: the heights of body, wheel and road are
/// uncertain by millimetres, their differences by micrometres, and `f32` cannot hold both in one covariance.
pub(crate) mod state {
    /// Suspension deflection `x_w - x_b` in m.
    pub(crate) const SUSPENSION: usize = 0;
    pub(crate) const SUSPENSION_RATE: usize = 1;
    /// Tire deflection `x_r - x_w` in m.
    pub(crate) const TIRE: usize = 2;
    pub(crate) const WHEEL_VELOCITY: usize = 3;
    /// Road velocity `v_r` in m/s, noise of limited bandwidth.
    pub(crate) const ROAD_VELOCITY: usize = 4;
    /// Offset of the body accelerometer in m/s².
    pub(crate) const BODY_BIAS: usize = 5;
    /// Offset of the wheel accelerometer in m/s².
    pub(crate) const WHEEL_BIAS: usize = 6;
    /// Road height `z` without its slow part, in m (eq. 4).
    pub(crate) const ROAD: usize = 7;
    /// Integral of `z` in m s.
    pub(crate) const ROAD_INTEGRAL: usize = 8;
}
use state::{
    BODY_BIAS, ROAD, ROAD_INTEGRAL, ROAD_VELOCITY, SUSPENSION, SUSPENSION_RATE, TIRE, WHEEL_BIAS,
    WHEEL_VELOCITY,
};

/// The first states, driven by one another, the road's velocity and the body's offset.
const DYNAMIC: usize = 4;
/// All that drives the dynamic states.
const DRIVING: usize = 6;

/// Everything the continuous model depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Model<T> {
    pub(crate) car: QuarterCar<T>,
    pub(crate) stiffness_n_per_m: T,
    /// Variance of one sample's sensor noise, (m/s²)².
    pub(crate) noise_variance: T,
    /// Two-sided density `q` of the road's vertical velocity, m²/s (eq. 2).
    pub(crate) road_intensity: T,
    pub(crate) road_bandwidth_rad_per_s: T,
    /// Corner below which the height is left out, rad/s.
    pub(crate) low_cut_rad_per_s: T,
    /// Two-sided density of the sensor offsets' walk, (m/s²)²/s.
    pub(crate) bias_intensity: T,
    /// How far the body is from a mass on this spring and damper, relative.
    pub(crate) body_mismatch: T,
}

impl<T: Real> Model<T> {
    pub(crate) fn of(config: &RoadConfig<T>, log_level: T) -> Self {
        Self {
            car: config.quarter_car,
            stiffness_n_per_m: config.stiffness_n_per_m,
            noise_variance: config.accel_noise_m_s2 * config.accel_noise_m_s2,
            road_intensity: T::lit(0.5) * log_level.exp(),
            road_bandwidth_rad_per_s: road_bandwidth(T::lit(FIRST_INTERVAL_S)),
            low_cut_rad_per_s: config.low_cut_rad_per_s,
            bias_intensity: config.bias_walk_m_s2 * config.bias_walk_m_s2,
            body_mismatch: config.body_mismatch,
        }
    }

    /// Two-sided density `W` of the body's acceleration that the model does not explain (eq. 5): a relative error of
    /// the resonance's peak response to the road, as white noise.
    pub(crate) fn body_intensity(&self) -> T {
        let (m_b, c_s, k_s) =
            (self.car.sprung_mass_kg(), self.car.damping_n_s_per_m(), self.car.spring_n_per_m());
        let peak = k_s / m_b * (T::one() + k_s * m_b / (c_s * c_s));
        self.body_mismatch * self.body_mismatch * peak * self.road_intensity
    }

    /// Share of the measured body acceleration that replaces the modelled one in the prediction (eq. 6).
    pub(crate) fn aid(&self, step_s: T) -> T {
        let unexplained = self.body_intensity();
        unexplained / (unexplained + self.noise_variance * step_s)
    }

    /// Variance of the body's measurement around the modelled acceleration, (m/s²)².
    pub(crate) fn body_variance(&self, step_s: T) -> T {
        self.noise_variance + self.body_intensity() / step_s
    }

    /// Row of the body's measurement: `(k_s d_s + c_s d_s')/m_b + b_b`.
    pub(crate) fn body_row(&self) -> CoreState<T> {
        let m_b = self.car.sprung_mass_kg();
        let mut h = CoreState::zeros();
        h[SUSPENSION] = self.car.spring_n_per_m() / m_b;
        h[SUSPENSION_RATE] = self.car.damping_n_s_per_m() / m_b;
        h[BODY_BIAS] = T::one();
        h
    }

    /// Row of the wheel's measurement: `(k_t d_t - k_s d_s - c_s d_s')/m_w + b_w`.
    pub(crate) fn wheel_row(&self) -> CoreState<T> {
        let m_w = self.car.unsprung_mass_kg();
        let mut h = CoreState::zeros();
        h[SUSPENSION] = -self.car.spring_n_per_m() / m_w;
        h[SUSPENSION_RATE] = -self.car.damping_n_s_per_m() / m_w;
        h[TIRE] = self.stiffness_n_per_m / m_w;
        h[WHEEL_BIAS] = T::one();
        h
    }

    /// Variance of the wheel's acceleration per unit of road intensity, in closed form (eq. 9).
    pub(crate) fn wheel_power_per_intensity(&self) -> T {
        let (m_b, m_w) = (self.car.sprung_mass_kg(), self.car.unsprung_mass_kg());
        let (c_s, k_s, k_t) =
            (self.car.damping_n_s_per_m(), self.car.spring_n_per_m(), self.stiffness_n_per_m);
        let tire = k_t * m_b - k_s * m_w;
        let numerator = tire * tire + c_s * c_s * k_t * m_w + k_s * k_s * m_b * m_w;
        numerator / (T::lit(2.0) * c_s * m_b * m_b * m_w)
    }

    /// `(A, Q_c)` of the continuous model with the share `aid` of the body's acceleration taken from its sensor.
    fn continuous(&self, aid: T) -> (Matrix<T>, Matrix<T>) {
        let (body, wheel) = (self.body_row(), self.wheel_row());
        let mut a = Matrix::zeros();
        a[(SUSPENSION, SUSPENSION_RATE)] = T::one();
        for j in [SUSPENSION, SUSPENSION_RATE, TIRE] {
            a[(WHEEL_VELOCITY, j)] = wheel[j];
            a[(SUSPENSION_RATE, j)] = wheel[j] - (T::one() - aid) * body[j];
        }
        // The sensor reads its offset along, so what is taken from it must lose the offset.
        a[(SUSPENSION_RATE, BODY_BIAS)] = aid;
        a[(TIRE, ROAD_VELOCITY)] = T::one();
        a[(TIRE, WHEEL_VELOCITY)] = -T::one();
        let bandwidth = self.road_bandwidth_rad_per_s;
        a[(ROAD_VELOCITY, ROAD_VELOCITY)] = -bandwidth;
        let cut = self.low_cut_rad_per_s;
        a[(ROAD, ROAD_VELOCITY)] = T::one();
        a[(ROAD, ROAD)] = -T::lit(2.0).sqrt() * cut;
        a[(ROAD, ROAD_INTEGRAL)] = -cut * cut;
        a[(ROAD_INTEGRAL, ROAD)] = T::one();
        let mut q = Matrix::zeros();
        q[(ROAD_VELOCITY, ROAD_VELOCITY)] = bandwidth * bandwidth * self.road_intensity;
        q[(SUSPENSION_RATE, SUSPENSION_RATE)] = (T::one() - aid) * self.body_intensity();
        q[(BODY_BIAS, BODY_BIAS)] = self.bias_intensity;
        q[(WHEEL_BIAS, WHEEL_BIAS)] = self.bias_intensity;
        (a, q)
    }

    /// The step that leans on a body acceleration measured at both of its ends.
    pub(crate) fn aided(&self, step_s: T) -> Transition<T> {
        Transition::new(self, self.aid(step_s), step_s)
    }

    /// The step without a body acceleration.
    pub(crate) fn free(&self, step_s: T) -> Transition<T> {
        Transition::new(self, T::zero(), step_s)
    }
}

/// One step of the model: `x <- Phi x + Gamma u`, `P <- Phi P Phi^T + Q`, exact for the step's length (eq. 7, 8).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Transition<T: Real> {
    pub(crate) step_s: T,
    phi: Matrix<T>,
    q: Matrix<T>,
}

/// Sampling interval in s assumed before two samples have shown it.
pub(crate) const FIRST_INTERVAL_S: f64 = 0.002;
/// Fastest change of phase in one step of the series; more is reached by doubling.
const SERIES_STEP: f64 = 0.1;
/// Terms of the series: the first one left out is below 1e-13 of the sum.
const SERIES_TERMS: usize = 8;
/// Doublings at most: a step of weeks.
const DOUBLINGS: usize = 30;

impl<T: Real> Transition<T> {
    fn new(model: &Model<T>, aid: T, step_s: T) -> Self {
        let (m_b, m_w) = (model.car.sprung_mass_kg(), model.car.unsprung_mass_kg());
        let stiff = (model.stiffness_n_per_m + model.car.spring_n_per_m()) / m_w;
        let fastest = stiff.sqrt()
            + model.car.damping_n_s_per_m() * (m_b + m_w) / (m_b * m_w)
            + model.road_bandwidth_rad_per_s;
        let mut h = step_s;
        let mut doublings = 0;
        while h * fastest > T::lit(SERIES_STEP) && doublings < DOUBLINGS {
            h *= T::lit(0.5);
            doublings += 1;
        }
        let mut step = Self::by_series(model, aid, h);
        (0..doublings).for_each(|_| step.double());
        step
    }

    /// A step short enough for the series. A function of its own, so that its matrices do not lie under what follows.
    #[inline(never)]
    fn by_series(model: &Model<T>, aid: T, h: T) -> Self {
        let (a, q_c) = model.continuous(aid);
        // Phi = sum (A h)^n / n!,  Q = sum h^(n+1)/(n+1)! L_n  with  L_0 = Q_c, L_(n+1) = A L_n + L_n A^T
        let mut phi = Matrix::identity();
        let mut q = q_c * h;
        let (mut power, mut l) = (phi, q);
        for n in 1..=SERIES_TERMS {
            power = sparse_product(&a, &power) * (h / T::lit(n as f64));
            phi += power;
            let half = sparse_product(&a, &l) * (h / T::lit((n + 1) as f64));
            l = half + half.transpose();
            q += l;
        }
        Self { step_s: h, phi, q }
    }

    /// Twice as long a step.
    #[inline(never)]
    fn double(&mut self) {
        self.q = self.covariance(&self.q);
        self.phi = self.apply(&self.phi);
        self.step_s *= T::lit(2.0);
    }

    /// `Phi m`.
    pub(crate) fn apply(&self, m: &Matrix<T>) -> Matrix<T> {
        self.apply_from_right(&m.transpose()).transpose()
    }

    /// `m Phi^T`; most of `Phi` is zero. Whole columns are added up, which the processor does by several entries at once.
    fn apply_from_right(&self, m: &Matrix<T>) -> Matrix<T> {
        let from = &m.data.0;
        let mut out = *m;
        for i in 0..DYNAMIC {
            out.data.0[i] = self.driven(i, from);
        }
        let kept = self.phi[(ROAD_VELOCITY, ROAD_VELOCITY)];
        out.data.0[ROAD_VELOCITY].iter_mut().for_each(|value| *value *= kept);
        for i in [ROAD, ROAD_INTEGRAL] {
            let mut sum = [T::zero(); STATES];
            for k in [ROAD_VELOCITY, ROAD, ROAD_INTEGRAL] {
                add_multiple(&mut sum, self.phi[(i, k)], &from[k]);
            }
            out.data.0[i] = sum;
        }
        out
    }

    /// What becomes of the `i`-th dynamic state, in `N` rows at once.
    #[inline(always)]
    fn driven<const N: usize, const FROM: usize>(&self, i: usize, columns: &[[T; N]; FROM]) -> [T; N] {
        let mut sum = [T::zero(); N];
        for (k, column) in columns.iter().enumerate().take(DRIVING) {
            add_multiple(&mut sum, self.phi[(i, k)], column);
        }
        sum
    }

    /// `m Phi^T` for the core states.
    pub(crate) fn apply_to_core_from_right(&self, m: &CoreMatrix<T>) -> CoreMatrix<T> {
        let mut out = *m;
        for i in 0..DYNAMIC {
            out.data.0[i] = self.driven(i, &m.data.0);
        }
        let kept = self.phi[(ROAD_VELOCITY, ROAD_VELOCITY)];
        out.data.0[ROAD_VELOCITY].iter_mut().for_each(|value| *value *= kept);
        out
    }

    /// `Phi x + Gamma u`, `u` the measured body acceleration (0 for a step without).
    pub(crate) fn state(&self, x: &State<T>, body_accel_m_s2: T) -> State<T> {
        let mut driving = *x;
        // The measurement takes the offset away again: Gamma = -Phi e_(b_b).
        driving[BODY_BIAS] -= body_accel_m_s2;
        let mut out = *x;
        for i in 0..DYNAMIC {
            let mut sum = T::zero();
            for k in 0..DRIVING {
                sum += self.phi[(i, k)] * driving[k];
            }
            out[i] = sum;
        }
        let phi = |i, j| self.phi[(i, j)];
        out[ROAD_VELOCITY] = phi(ROAD_VELOCITY, ROAD_VELOCITY) * x[ROAD_VELOCITY];
        for i in [ROAD, ROAD_INTEGRAL] {
            out[i] = phi(i, ROAD_VELOCITY) * x[ROAD_VELOCITY]
                + phi(i, ROAD) * x[ROAD]
                + phi(i, ROAD_INTEGRAL) * x[ROAD_INTEGRAL];
        }
        out
    }

    /// `Phi` between the height and its integral.
    pub(crate) fn height_block(&self) -> Matrix2<T> {
        self.phi.fixed_view::<2, 2>(ROAD, ROAD).into_owned()
    }

    /// `Phi P Phi^T + Q` of a symmetric `P`.
    pub(crate) fn covariance(&self, p: &Matrix<T>) -> Matrix<T> {
        let left = self.apply_from_right(p).transpose();
        let mut out = self.apply_from_right(&left) + self.q;
        symmetrise(&mut out);
        out
    }

    /// `Q` alone: for a step long enough, the covariance the model has when nothing was measured.
    pub(crate) fn noise(&self) -> &Matrix<T> {
        &self.q
    }
}

/// Bandwidth in rad/s given to the road's velocity at a sampling interval in s (eq. 2). White to infinity, it would
/// move the wheel between two samples in ways that an anti-aliased sensor proves were not there.
pub(crate) fn road_bandwidth<T: Real>(interval_s: T) -> T {
    T::two_pi() * T::lit(0.1) / interval_s
}

/// `sum + factor * column`, of a length that the compiler knows.
#[inline(always)]
pub(crate) fn add_multiple<T: Real, const N: usize>(sum: &mut [T; N], factor: T, column: &[T; N]) {
    for (sum, &value) in sum.iter_mut().zip(column) {
        *sum += factor * value;
    }
}

/// `m row`, the columns of `m` added up; those with a factor of zero are left out.
#[inline(always)]
pub(crate) fn combine<T: Real, const N: usize>(columns: &[[T; N]], row: &CoreState<T>) -> [T; N] {
    let mut sum = [T::zero(); N];
    for (column, &factor) in columns.iter().zip(row.iter()) {
        if factor != T::zero() {
            add_multiple(&mut sum, factor, column);
        }
    }
    sum
}

/// `a m` for an `a` that is mostly zero.
fn sparse_product<T: Real>(a: &Matrix<T>, m: &Matrix<T>) -> Matrix<T> {
    let mut out = Matrix::zeros();
    for i in 0..STATES {
        for k in 0..STATES {
            let factor = a[(i, k)];
            if factor != T::zero() {
                for j in 0..STATES {
                    out[(i, j)] += factor * m[(k, j)];
                }
            }
        }
    }
    out
}

/// `(m + m^T)/2`.
pub(crate) fn symmetrise<T: Real>(m: &mut Matrix<T>) {
    for i in 0..STATES {
        for j in 0..i {
            let mean = T::lit(0.5) * (m[(i, j)] + m[(j, i)]);
            m[(i, j)] = mean;
            m[(j, i)] = mean;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> Model<f64> {
        let config = RoadConfig::new(QuarterCar::paper_table_2(), 233_000.0, 0.05).unwrap();
        Model::of(&config, -8.9)
    }

    #[test]
    fn the_discretisation_solves_the_differential_equations() {
        let model = model();
        for (aid, step) in [(0.0, 0.002), (0.9, 0.01), (0.3, 0.1)] {
            let (a, q_c) = model.continuous(aid);
            // dPhi/dt = A Phi, dQ/dt = A Q + Q A^T + Q_c by the midpoint rule; its error is (A h)² / 24.
            let n = 200_000;
            let h = step / f64::from(n);
            let (mut phi, mut q) = (Matrix::<f64>::identity(), Matrix::<f64>::zeros());
            let half = Matrix::identity() + a * (0.5 * h);
            for _ in 0..n {
                let middle = half * q * half.transpose() + q_c * (0.5 * h);
                q += (a * middle + (a * middle).transpose() + q_c) * h;
                phi += a * (half * phi) * h;
            }
            let made = Transition::new(&model, aid, step);
            assert!((made.phi - phi).amax() < 1e-7 * phi.amax(), "{step}");
            for i in 0..STATES {
                for j in 0..STATES {
                    let scale = (q[(i, i)] * q[(j, j)]).sqrt();
                    assert!((made.q[(i, j)] - q[(i, j)]).abs() <= 1e-6 * scale, "{step} ({i}, {j})");
                }
            }
        }
    }

    #[test]
    fn the_sparse_products_are_the_dense_ones() {
        let model = model();
        let made = Transition::new(&model, 0.7, 0.004);
        let m = Matrix::from_fn(|i, j| ((3 * i + 5 * j) as f64).sin());
        assert!((made.apply(&m) - made.phi * m).amax() < 1e-12);
        let core = m.fixed_view::<CORE, CORE>(0, 0).into_owned();
        let dense = made.phi.fixed_view::<CORE, CORE>(0, 0) * core;
        let from_right = made.apply_to_core_from_right(&core.transpose());
        assert!((from_right.transpose() - dense).amax() < 1e-12);
        let p = m * m.transpose();
        assert!((made.covariance(&p) - (made.phi * p * made.phi.transpose() + made.q)).amax() < 1e-12);
        // A measured body acceleration acts like the opposite offset.
        let x = State::from_fn(|i, _| (i as f64).cos());
        let mut shifted = x;
        shifted[BODY_BIAS] -= 2.5;
        let mut expected = made.phi * shifted;
        expected[BODY_BIAS] = x[BODY_BIAS];
        assert!((made.state(&x, 2.5) - expected).amax() < 1e-12);
    }

    #[test]
    fn the_wheels_power_in_closed_form_is_the_stationary_covariances() {
        // With the road's velocity white up to 8 kHz; what lies above is 0.2 % of the wheel's power.
        let model = Model { road_bandwidth_rad_per_s: 5e4, ..model() };
        let p = *model.free(60.0).noise();
        let h = model.wheel_row();
        let mut row = State::zeros();
        row.fixed_rows_mut::<CORE>(0).copy_from(&h);
        row[WHEEL_BIAS] = 0.0;
        let power = row.dot(&(p * row)) / model.road_intensity;
        assert!((power / model.wheel_power_per_intensity() - 1.0).abs() < 0.01, "{power}");
        // And the height's: a random walk of intensity q behind the high-pass, q / (2 sqrt(2) w_c).
        let height = p[(ROAD, ROAD)] * 8f64.sqrt() * model.low_cut_rad_per_s / model.road_intensity;
        assert!((height - 1.0).abs() < 1e-3, "{height}");
    }
}
