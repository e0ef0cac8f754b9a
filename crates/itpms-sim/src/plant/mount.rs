//! A damper on a bushing: the top mount that stands between it and the body.
//!
//! Part of a strut. The bushing's force is the damper's, so its rate is `k (ẋ - v)` with `v` the speed at which the damper
//! gives that force; for a linear damper it follows `c ẋ` with the time `c/k`.

/// A bushing in series with a damper, and how far it is stretched.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mount {
    stiffness_n_per_m: f64,
    force_n: f64,
    damper_m_s: f64,
    extension_m: f64,
}

impl Mount {
    /// Without force; `None` where the damper is bolted to the body.
    pub(crate) fn new(stiffness_n_per_m: f64) -> Option<Self> {
        let at_rest = Self { stiffness_n_per_m, force_n: 0.0, damper_m_s: 0.0, extension_m: 0.0 };
        (stiffness_n_per_m > 0.0).then_some(at_rest)
    }

    /// Force in N against the extension, `since_s` after the last step's end at an extension in m that is reached at one
    /// speed. `damper` gives the damper's force over speed at a speed: that of the last step stands for it, which a linear
    /// damper's is exactly. Stable for any step.
    #[inline]
    pub(crate) fn force_n(&self, extension_m: f64, since_s: f64, damper: impl Fn(f64) -> f64) -> f64 {
        if !(since_s > 0.0) {
            return self.force_n;
        }
        let n_s_per_m = damper(self.damper_m_s);
        let left = (-since_s * self.stiffness_n_per_m / n_s_per_m).exp();
        let extension_m_s = (extension_m - self.extension_m) / since_s;
        n_s_per_m * extension_m_s * (1.0 - left) + self.force_n * left
    }

    /// Goes on to the extension in m at the end of a step.
    pub(crate) fn advance(&mut self, extension_m: f64, since_s: f64, damper: impl Fn(f64) -> f64) {
        let force_n = self.force_n(extension_m, since_s, damper);
        let stretched_m = (force_n - self.force_n) / self.stiffness_n_per_m;
        self.damper_m_s = (extension_m - self.extension_m - stretched_m) / since_s;
        self.force_n = force_n;
        self.extension_m = extension_m;
    }

    /// Takes an extension in m for the one reached, without having moved.
    pub(crate) fn place(&mut self, extension_m: f64) {
        self.extension_m = extension_m;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A damper on a spring is a complex stiffness `i ω c k / (k + i ω c)`.
    #[test]
    fn a_mounted_damper_has_the_impedance_of_both_in_series() {
        let (k, c, h) = (200_000.0, 1500.0, 1.0 / 4000.0);
        for hz in [1.0, 12.0, 40.0] {
            let (w, mut mount) = (TAU * hz, Mount::new(k).unwrap());
            let steps = (1.0 / h) as usize;
            let (mut sine, mut cosine) = (0.0, 0.0);
            for i in 0..2 * steps {
                let t = (i + 1) as f64 * h;
                mount.advance(1e-3 * (w * t).sin(), h, |_| c);
                if i >= steps {
                    sine += 2.0 * mount.force_n * (w * t).sin() / steps as f64;
                    cosine += 2.0 * mount.force_n * (w * t).cos() / steps as f64;
                }
            }
            // In phase and a quarter ahead: k (ωc)² and k² ωc over k² + (ωc)².
            let of = 1e-3 * k * w * c / (k * k + (w * c).powi(2));
            let error = (sine - of * w * c).hypot(cosine - of * k);
            // The speed is taken for even within a step: half a step late, made up by its end; (ωh)²/12 is left.
            assert!(error < 1.5e-3 * of * (w * c).hypot(k), "{hz} Hz: {sine} {cosine}");
        }
        assert!(Mount::new(0.0).is_none());
    }

    /// At one speed it ends with the damper's whole force, whatever the damper's law, and without a mount's length to give.
    #[test]
    fn it_settles_at_the_dampers_own_force() {
        let law = |m_s: f64| if m_s > 0.0 { 1300.0 } else { 700.0 } / (1.0 + 2.0 * m_s.abs());
        for m_s in [0.4, -0.4] {
            let mut mount = Mount::new(300_000.0).unwrap();
            for i in 0..400 {
                mount.advance(m_s * f64::from(i + 1) * 2.5e-4, 2.5e-4, law);
            }
            assert!((mount.force_n / (law(m_s) * m_s) - 1.0).abs() < 1e-6, "{m_s}: {mount:?}");
        }
    }
}
