//! The second-order high-pass that frees a height of drift, for uneven steps (docs/math/road.md, eq. 4).
//!
//! Called by [`crate::recorder`] backwards in time; the filter has the same high-pass inside its model.

use itpms_core::Real;

/// Steps differing less than this share use the same coefficients.
const STEP_TOLERANCE: f64 = 1e-3;

/// `s² / (s² + sqrt(2) w_c s + w_c²)`, state `(z, integral of z)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HighPass<T> {
    /// `w_c / sqrt(2)`: real and imaginary part of the poles alike.
    pole: T,
    height: T,
    integral: T,
    step_s: T,
    /// `exp(-pole step)` times cosine and sine of `pole step`.
    cosine: T,
    sine: T,
}

impl<T: Real> HighPass<T> {
    pub(crate) fn new(corner_rad_per_s: T) -> Self {
        let zero = T::zero();
        let pole = corner_rad_per_s / T::lit(2.0).sqrt();
        Self { pole, height: zero, integral: zero, step_s: zero, cosine: T::one(), sine: zero }
    }

    /// Free motion over `step_s`, the input's change spread evenly over it. Returns the output.
    pub(crate) fn step(&mut self, step_s: T, change: T) -> T {
        if !((step_s - self.step_s).abs() <= T::lit(STEP_TOLERANCE) * step_s) {
            let angle = self.pole * step_s;
            let decay = (-angle).exp();
            (self.cosine, self.sine) = (decay * angle.cos(), decay * angle.sin());
            self.step_s = step_s;
        }
        // Half of the change before, half after the step: second-order accurate in corner times step.
        let half = T::lit(0.5) * change;
        let (c, s, b) = (self.cosine, self.sine, self.pole);
        let (z, i) = (self.height + half, self.integral);
        self.height = (c - s) * z - T::lit(2.0) * b * s * i + half;
        self.integral = s / b * z + (c + s) * i;
        self.height
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_comes_out_with_the_analogue_filters_gain_and_phase() {
        // At twice the corner: H = -4/(1 - 4 + 2 sqrt(2) j), |H| = 4/sqrt(17), lead = atan2(2 sqrt 2, 3).
        let (corner, w) = (0.5_f64, 1.0_f64);
        let mut filter = HighPass::new(corner);
        let input = |t: f64| (w * t).sin();
        let dt = 0.01;
        for i in 1..20_000 {
            let t = f64::from(i) * dt;
            let out = filter.step(dt, input(t) - input(t - dt));
            if i > 10_000 {
                let expected = 4.0 / 17f64.sqrt() * (w * t + 8f64.sqrt().atan2(3.0)).sin();
                // Second order in corner times step: (0.5 * 0.01)² is far below 1e-4.
                assert!((out - expected).abs() < 1e-4, "{t}: {out} {expected}");
            }
        }
    }
}
