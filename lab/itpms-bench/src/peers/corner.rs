//! The paper's corner: its equations, where a filter starts, and a drive. Knows no filter.

use itpms_core::Real;
use itpms_core::model::QuarterCar;
use itpms_paper::FilterConfig;
use nalgebra::{Vector2, Vector5};

/// Seconds from a sample to the next.
pub const STEP_S: f64 = 2e-3;
/// Of the ordinary EKF: what is not known of the road's height at the start, and how far it walks in a step, both as variances in m².
/// 3 cm in a second is a rough road at speed.
pub const ROAD_VARIANCES_M2: [f64; 2] = [1e-4, 9e-4 * STEP_S];

/// The paper's simulation (Sec. 4), surer of the motion and less sure of the stiffness and of the sensors: so the factor acts, and a dense
/// filter lives in `f32`, too.
#[must_use]
pub fn setting<T: Real>() -> FilterConfig<T> {
    FilterConfig {
        initial_variance: Vector5::new(1e-4, 1e-2, 1e-4, 1e-2, 1e7).map(T::lit),
        measurement_variance: Vector2::repeat(T::lit(0.2)),
        ..FilterConfig::paper_simulation()
    }
}

/// Diagonals of `P_0` and `Q`, with the road as a sixth state where there is room for one.
#[must_use]
pub fn variances<T: Real, const N: usize>() -> [[T; N]; 2] {
    let setting = setting::<T>();
    let diagonal =
        |of: &Vector5<T>, road: f64| core::array::from_fn(|i| if i < 5 { of[i] } else { T::lit(road) });
    [
        diagonal(&setting.initial_variance, ROAD_VARIANCES_M2[0]),
        diagonal(&setting.process_variance, ROAD_VARIANCES_M2[1]),
    ]
}

/// `x_0`, the road at zero.
#[must_use]
pub fn start<T: Real, const N: usize>() -> [T; N] {
    let setting = setting::<T>();
    core::array::from_fn(|i| if i < 5 { setting.initial_state[i] } else { T::zero() })
}

/// Diagonal of `R`.
#[must_use]
pub fn noise<T: Real>() -> [T; 2] {
    setting::<T>().measurement_variance.into()
}

/// The quarter car in plain numbers, as every peer is given it.
#[derive(Debug, Clone, Copy)]
pub struct Corner<T> {
    m_b: T,
    m_w: T,
    c_s: T,
    k_s: T,
    step_s: T,
}

impl<T: Real> Corner<T> {
    /// The paper's Table 2.
    #[must_use]
    pub fn paper() -> Self {
        let car = QuarterCar::<T>::paper_table_2();
        Self {
            m_b: car.sprung_mass_kg(),
            m_w: car.unsprung_mass_kg(),
            c_s: car.damping_n_s_per_m(),
            k_s: car.spring_n_per_m(),
            step_s: T::lit(STEP_S),
        }
    }

    /// `h` (eq. 3): accelerations of body and wheel for `x_b, v_b, x_w, v_w, k_t`.
    #[inline]
    pub fn accelerations(&self, x: &[T], road: T) -> [T; 2] {
        let strut = self.k_s * (x[2] - x[0]) + self.c_s * (x[3] - x[1]);
        let tire = x[4] * (road - x[2]);
        [strut / self.m_b, (tire - strut) / self.m_w]
    }

    /// `x + Δt f(x)` (eq. 8).
    #[inline]
    pub fn stepped<const N: usize>(&self, x: &[T; N], road: T) -> [T; N] {
        let [body, wheel] = self.accelerations(x, road);
        let mut next = *x;
        next[0] += self.step_s * x[1];
        next[1] += self.step_s * body;
        next[2] += self.step_s * x[3];
        next[3] += self.step_s * wheel;
        next
    }

    /// `H` (eq. 15), with the derivative to the road where that is a state.
    #[inline]
    pub fn rows<const N: usize>(&self, x: &[T], road: T) -> [[T; N]; 2] {
        let Self { m_b, m_w, c_s, k_s, .. } = *self;
        let mut rows = [[T::zero(); N]; 2];
        rows[0][0] = -k_s / m_b;
        rows[0][1] = -c_s / m_b;
        rows[0][2] = k_s / m_b;
        rows[0][3] = c_s / m_b;
        rows[1][0] = k_s / m_w;
        rows[1][1] = c_s / m_w;
        rows[1][2] = -(k_s + x[4]) / m_w;
        rows[1][3] = -c_s / m_w;
        rows[1][4] = (road - x[2]) / m_w;
        if N == 6 {
            rows[1][5] = self.by_road(x);
        }
        rows
    }

    /// `A` (eq. 13).
    #[inline]
    pub fn transition<const N: usize>(&self, x: &[T], road: T) -> [[T; N]; N] {
        let [body, wheel] = self.rows::<N>(x, road);
        let mut a = [[T::zero(); N]; N];
        a[0][1] = self.step_s;
        a[2][3] = self.step_s;
        a[1] = body.map(|value| value * self.step_s);
        a[3] = wheel.map(|value| value * self.step_s);
        for (i, row) in a.iter_mut().enumerate() {
            row[i] += T::one();
        }
        a
    }

    /// `D` (eq. 15): the wheel's acceleration by the road.
    #[inline]
    pub fn by_road(&self, x: &[T]) -> T {
        x[4] / self.m_w
    }
}

/// Where the road is: the sixth state, or what was found of it.
#[inline]
pub fn road_of<T: Real>(x: &[T], found: T) -> T {
    x.get(5).copied().unwrap_or(found)
}

/// Samples at 500 Hz: the corner driven over a road that walks at random, in four steps a sample, and noise of 0.3 m/s². No library's
/// sine or random numbers, so that a controller makes the same drive.
#[derive(Debug, Clone)]
pub struct Drive {
    corner: Corner<f64>,
    x: [f64; 5],
    road: f64,
    hash: u64,
}

impl Default for Drive {
    fn default() -> Self {
        let corner = Corner { step_s: STEP_S / 4.0, ..Corner::paper() };
        Self { corner, x: [0.0, 0.0, 0.0, 0.0, 200_000.0], road: 0.0, hash: 0 }
    }
}

impl Drive {
    /// The next sample, in m/s².
    pub fn sample<T: Real>(&mut self) -> [T; 2] {
        for _ in 0..4 {
            self.road = 0.9995 * self.road + 1e-3 * self.even();
            self.x = self.corner.stepped(&self.x, self.road);
        }
        let [body, wheel] = self.corner.accelerations(&self.x, self.road);
        [body, wheel].map(|value| T::lit(value + 0.5 * self.even()))
    }

    /// Between -1 and 1: a hash of a counter.
    fn even(&mut self) -> f64 {
        self.hash += 1;
        let mut z = self.hash.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
