//! The analogue low-pass between an accelerometer and its sampler: a Butterworth filter at the plant's rate.
//!
//! Called by the simulation. Without it the broadband acceleration of a wheel folds down into the waves of a metre
//! that a road estimate is about.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::error::{InvalidValue, Result, within};

/// The filter as written in a scenario.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AntiAliasSpec {
    /// Order: 2, 4, 6 or 8; 0 for no filter.
    pub order: u32,
    /// Frequency where the filter has fallen by 3 dB, as a fraction of the log's rate.
    pub corner: f64,
}

impl Default for AntiAliasSpec {
    fn default() -> Self {
        Self { order: 4, corner: 0.3 }
    }
}

impl AntiAliasSpec {
    pub(crate) fn validate(&self) -> Result<()> {
        if !matches!(self.order, 0 | 2 | 4 | 6 | 8) {
            return Err(InvalidValue::new("order", self.order, "0, 2, 4, 6 or 8"));
        }
        within("corner", self.corner, 0.01, 2.0, "a fraction of the rate from 0.01 to 2")
    }

    /// Quality of each pair of poles: `Q = 1 / (2 sin((2i + 1) π / 2n))`.
    fn pole_pairs(&self) -> impl Iterator<Item = f64> {
        let n = f64::from(self.order);
        (0..self.order / 2).map(move |i| 0.5 / (f64::from(2 * i + 1) * PI / (2.0 * n)).sin())
    }
}

/// One second-order section, transposed direct form II.
#[derive(Debug, Clone, Copy)]
struct Section {
    b: f64,
    a1: f64,
    a2: f64,
    z1: f64,
    z2: f64,
}

#[derive(Debug, Clone)]
pub struct LowPass {
    sections: Vec<Section>,
}

impl LowPass {
    /// The filter of a log with `rate_hz`, run `sampling_hz` times a second. Bilinear transform, its frequency scale fitted at the corner.
    pub fn new(spec: &AntiAliasSpec, rate_hz: f64, sampling_hz: f64) -> Self {
        let k = (PI * spec.corner * rate_hz / sampling_hz).tan();
        let sections = spec
            .pole_pairs()
            .map(|q| {
                let norm = 1.0 / (1.0 + k / q + k * k);
                Section {
                    b: k * k * norm,
                    a1: 2.0 * (k * k - 1.0) * norm,
                    a2: (1.0 - k / q + k * k) * norm,
                    z1: 0.0,
                    z2: 0.0,
                }
            })
            .collect();
        Self { sections }
    }

    /// The filtered value of the next input.
    #[inline]
    pub fn process(&mut self, input: f64) -> f64 {
        let mut x = input;
        for s in &mut self.sections {
            let y = s.b * x + s.z1;
            s.z1 = 2.0 * s.b * x - s.a1 * y + s.z2;
            s.z2 = s.b * x - s.a2 * y;
            x = y;
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gain and phase at `f` Hz, from a sine that has settled.
    fn response(spec: &AntiAliasSpec, f: f64) -> (f64, f64) {
        let (rate, fs) = (500.0, 4000.0);
        let mut filter = LowPass::new(spec, rate, fs);
        let (mut s, mut c) = (0.0, 0.0);
        for i in 0..8000 {
            let phase = 2.0 * PI * f * f64::from(i) / fs;
            let y = filter.process(phase.sin());
            if i >= 4000 {
                s += y * phase.sin() / 2000.0;
                c += y * phase.cos() / 2000.0;
            }
        }
        (s.hypot(c), c.atan2(s))
    }

    #[test]
    fn the_corner_is_three_decibels_down_and_the_slope_butterworths() {
        for order in [2, 4, 6, 8] {
            let spec = AntiAliasSpec { order, corner: 0.3 };
            let db = |f| 20.0 * response(&spec, f).0.log10();
            assert!((db(150.0) + 3.0103).abs() < 1e-3, "order {order}");
            for f in [20.0, 100.0, 250.0, 400.0] {
                // |H|² = 1 / (1 + (f/fc)^2n) on the bilinear transform's frequency scale.
                let ratio = (PI * f / 4000.0).tan() / (PI * 150.0 / 4000.0).tan();
                let expected = -10.0 * (1.0 + ratio.powi(2 * order as i32)).log10();
                assert!((db(f) - expected).abs() < 0.01, "order {order}, {f} Hz: {}", db(f));
            }
        }
    }

    #[test]
    fn low_frequencies_are_late_by_the_group_delay() {
        let spec = AntiAliasSpec::default();
        let (_, phase) = response(&spec, 5.0);
        let delay = -phase / (2.0 * PI * 5.0);
        // 2.6131 is the first coefficient of the fourth-order Butterworth polynomial (published tables): the sum of 1/Q.
        assert!((spec.pole_pairs().map(|q| 1.0 / q).sum::<f64>() - 2.6131).abs() < 1e-4);
        assert!((delay - 2.6131 / (2.0 * PI * 150.0)).abs() < 0.01 * delay);
    }

    #[test]
    fn order_zero_is_a_wire() {
        let mut wire = LowPass::new(&AntiAliasSpec { order: 0, corner: 0.3 }, 500.0, 4000.0);
        assert_eq!(wire.process(1.25), 1.25);
        assert!(AntiAliasSpec { order: 3, corner: 0.3 }.validate().is_err());
        assert!(AntiAliasSpec { order: 4, corner: f64::NAN }.validate().is_err());
    }
}
