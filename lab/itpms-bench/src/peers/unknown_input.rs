//! What stands between a library's prediction and its correction: the road, found by least squares (eq. 16), and the one-step factor
//! (eq. 28-33). Plain numbers, so that it is the same for every library.

use itpms_core::Real;

use crate::peers::corner;

/// The unknown input of a filter over five states, and the factor.
#[derive(Debug, Clone, Copy)]
pub struct UnknownInput<T> {
    /// `u*`: the road in m.
    pub road: T,
    /// `λ`, by which `P⁺` is multiplied before the next prediction (eq. 18 as printed: `λ_{k-1}`).
    pub lambda: T,
    noise: [T; 2],
    process: [T; 5],
    /// Traces of `G_1`, and `G_2` (eq. 32, 33).
    trace_1: T,
    sum_2: T,
}

/// What the correction needs besides the road.
#[derive(Debug, Clone, Copy)]
pub struct Found<T> {
    /// `S`: the road's variance in m².
    pub variance: T,
    /// `K D`: `S K D Dᵀ Kᵀ` is what a Kalman filter's `P⁺` lacks for an input that had to be found (eq. 17).
    pub gained: [T; 5],
}

impl<T: Real> UnknownInput<T> {
    /// At the start, in the setting of [`corner`].
    #[must_use]
    pub fn fresh() -> Self {
        let [_, process] = corner::variances();
        let (noise, zero) = (corner::noise(), T::zero());
        Self { road: zero, lambda: T::one(), noise, process, trace_1: zero, sum_2: zero }
    }

    /// Finds the road from `H`, `D = (0, by_road)`, the residual `z` with the last road, and the elements of `P⁻`.
    #[inline]
    pub fn find(
        &mut self,
        p: impl Fn(usize, usize) -> T,
        h: &[[T; 5]; 2],
        by_road: T,
        z: [T; 2],
    ) -> Found<T> {
        let dot =
            |a: &[T; 5], b: &[T; 5]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4];
        // P⁻Hᵀ, and (20)  C = HP⁻Hᵀ + R
        let pht = h.map(|row| core::array::from_fn(|i| dot(&core::array::from_fn(|j| p(i, j)), &row)));
        let unforgotten = [dot(&h[0], &pht[0]), dot(&h[1], &pht[1])];
        let (c_00, c_11) = (unforgotten[0] + self.noise[0], unforgotten[1] + self.noise[1]);
        let c_01 = dot(&h[0], &pht[1]);
        let determinant = c_00 * c_11 - c_01 * c_01;
        // (16)  S = (DᵀC⁻¹D)⁻¹,  u* = u*ₖ₋₁ + S DᵀC⁻¹z,  with R⁻¹(I - HK) = C⁻¹;  DᵀC⁻¹ by the second row of C⁻¹
        let weight = [-c_01 * by_road / determinant, c_00 * by_road / determinant];
        let variance = T::one() / (weight[1] * by_road);
        self.road += variance * (weight[0] * z[0] + weight[1] * z[1]);
        let gained = core::array::from_fn(|i| pht[0][i] * weight[0] + pht[1][i] * weight[1]);
        self.lambda = self.factor(h, unforgotten, z);
        Found { variance, gained }
    }

    /// The one-step factor. `HP⁻Hᵀ = λM + HQHᵀ` was made with the last one.
    #[inline]
    fn factor(&mut self, h: &[[T; 5]; 2], [b_00, b_11]: [T; 2], z: [T; 2]) -> T {
        // (32), (33), of (31) the trace
        self.trace_1 = self.trace_1 / self.lambda + z[0] * z[0] + z[1] * z[1];
        self.sum_2 = self.sum_2 / self.lambda + T::one();
        let trace_c_0 = self.trace_1 / self.sum_2;
        let mut by_process = T::zero();
        for row in h {
            for (value, process) in row.iter().zip(&self.process) {
                by_process += *value * *value * *process;
            }
        }
        // (29), (30), (28)
        let trace_m = (b_00 + b_11 - by_process) / self.lambda;
        let wanted = (trace_c_0 - by_process - self.noise[0] - self.noise[1]) / trace_m;
        if wanted > T::one() { wanted } else { T::one() }
    }
}
