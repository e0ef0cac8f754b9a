//! A band-pass without phase, to compare heights in the wavelengths that sensors can see.
//!
//! Called by the section on Fig. 8.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Second-order Butterworth section by the bilinear transform.
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl Section {
    /// `sign` is 1 for a low-pass and -1 for a high-pass.
    fn new(corner_hz: f64, rate_hz: f64, sign: f64) -> Self {
        let w = 2.0 * PI * corner_hz / rate_hz;
        let alpha = w.sin() * FRAC_1_SQRT_2;
        let norm = 1.0 + alpha;
        let edge = (1.0 - sign * w.cos()) / norm;
        Self { b: [0.5 * edge, sign * edge, 0.5 * edge], a: [-2.0 * w.cos() / norm, (1.0 - alpha) / norm] }
    }

    fn run(&self, signal: &mut [f64]) {
        // From rest at the first value's level: for the high-pass that is zero, for the low-pass what is left of it.
        let first = signal.first().copied().unwrap_or(0.0);
        let gain = self.b.iter().sum::<f64>() / (1.0 + self.a[0] + self.a[1]);
        let (mut x, mut y) = ([first; 2], [first * gain; 2]);
        for value in signal {
            let out = self.b[0] * *value + self.b[1] * x[0] + self.b[2] * x[1]
                - self.a[0] * y[0]
                - self.a[1] * y[1];
            x = [*value, x[0]];
            y = [out, y[0]];
            *value = out;
        }
    }
}

/// The signal between two frequencies, filtered forwards and backwards: at both corners half the amplitude is left. A
/// signal with a value that is not finite gives NaN throughout from there on.
pub(super) fn band_pass(signal: &[f64], rate_hz: f64, low_hz: f64, high_hz: f64) -> Vec<f64> {
    let end = signal.iter().position(|value| !value.is_finite()).unwrap_or(signal.len());
    let mut out = signal[..end].to_vec();
    for section in [Section::new(low_hz, rate_hz, -1.0), Section::new(high_hz, rate_hz, 1.0)] {
        section.run(&mut out);
        out.reverse();
        section.run(&mut out);
        out.reverse();
    }
    out.resize(signal.len(), f64::NAN);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_band_in_phase_and_drops_the_rest() {
        let wave = |hz: f64, i: i32| (2.0 * PI * hz * f64::from(i) / 1000.0).sin();
        let all: Vec<f64> =
            (0..40_000).map(|i| wave(3.0, i) + 5.0 * wave(0.02, i) + 2.0 + wave(150.0, i)).collect();
        let kept = band_pass(&all, 1000.0, 0.5, 11.0);
        // Twice a second-order Butterworth: at 3 Hz 1 / ((1 + (0.5/3)^4) (1 + (3/11)^4)) = 0.9938; what leaks of the
        // slow wave is 5 (0.02/0.5)^4 = 1.3e-5, of the fast one (11/150)^4 = 3e-5.
        for i in 10_000..30_000 {
            assert!((kept[i as usize] - 0.9938 * wave(3.0, i)).abs() < 1e-3, "{i}");
        }
    }

    #[test]
    fn a_divergence_ends_it() {
        let mut signal = vec![0.0; 100];
        signal[50] = f64::NAN;
        let out = band_pass(&signal, 100.0, 1.0, 10.0);
        assert!(out[49].is_finite() && out[50..].iter().all(|v| v.is_nan()));
    }
}
