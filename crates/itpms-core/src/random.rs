//! Random numbers for tests, the same every time.

/// SplitMix64 and Box-Muller.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Evenly drawn between zero and one, never either of them.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + 0.5 / (1u64 << 53) as f64
    }

    /// Of a Gaussian with mean zero and variance one.
    pub(crate) fn normal(&mut self) -> f64 {
        // Where another crate of the build brings `std`, numbers have these functions by themselves.
        #[allow(unused_imports)]
        use nalgebra::ComplexField;

        (-2.0 * self.uniform().ln()).sqrt() * (core::f64::consts::TAU * self.uniform()).cos()
    }
}
