//! A test bed's road: one random segment, played again and again by a hydraulic actuator of finite bandwidth.
//!
//! Called by the surfaces, which turn it into a road over distance with the speed that the test bed stands for. The actuator's answer to a
//! repeated segment is computed harmonic by harmonic, in its steady state: it is periodic exactly, and there is no start to wait out.

use itpms_fourier::Complex;
use serde::{Deserialize, Serialize};

use super::iso8608::{Amplitude, Iso8608, Roughness};
use crate::error::{Result, within};

/// A hydraulic actuator that follows a demanded height as a mass on a damped spring follows its foot:
/// `H(f) = 1 / (1 - (f/f0)² + 2 i ζ f/f0)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Actuator {
    /// Natural frequency `f0` in Hz: with a damping of 0.7 also where the answer has fallen by 3 dB.
    pub natural_frequency_hz: f64,
    /// Damping ratio `ζ`.
    pub damping_ratio: f64,
}

impl Default for Actuator {
    fn default() -> Self {
        Self { natural_frequency_hz: 30.0, damping_ratio: 0.7 }
    }
}

impl Actuator {
    /// Height over demanded height at a frequency in Hz.
    pub(crate) fn response(&self, frequency_hz: f64) -> Complex<f64> {
        let ratio = frequency_hz / self.natural_frequency_hz;
        Complex::new(1.0 - ratio * ratio, 2.0 * self.damping_ratio * ratio).inv()
    }

    fn validate(&self) -> Result<()> {
        let natural_hz = self.natural_frequency_hz;
        within("natural_frequency_hz", natural_hz, 1.0, 1e4, "a frequency from 1 to 10000 Hz")?;
        within("damping_ratio", self.damping_ratio, 0.05, 5.0, "a ratio from 0.05 to 5")
    }
}

/// A test bed's road as written in a scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchRoad {
    /// Time in s after which the segment starts again.
    pub repeat_every_s: f64,
    /// `Gd(n0)` of the demanded segment at the scenario's speed, or the class it is the mean of.
    pub roughness: Roughness,
    /// Slope `w` of the demanded segment's spectrum.
    pub slope: f64,
    /// How the segment's Fourier coefficients are drawn.
    #[serde(default)]
    pub amplitude: Amplitude,
    #[serde(default)]
    pub actuator: Actuator,
}

impl BenchRoad {
    pub(crate) fn validate(&self) -> Result<()> {
        within("repeat_every_s", self.repeat_every_s, 0.05, 60.0, "a time from 0.05 to 60 s")?;
        self.demand().validate()?;
        self.actuator.validate().map_err(|e| e.within("actuator"))
    }

    /// Spectrum of the demanded segment.
    pub(crate) fn demand(&self) -> Iso8608 {
        Iso8608 { amplitude: self.amplitude, ..Iso8608::new(self.roughness, self.slope) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_actuator_follows_slow_demands_lags_and_falls_off() {
        let a = Actuator::default();
        // Series for small f/f0: 1 - 2 i ζ f/f0, so late by 2 ζ / (2π f0) = 7.4 ms.
        let slow = a.response(0.03);
        assert!((slow.re - 1.0).abs() < 1e-5 && (slow.im + 1.4e-3).abs() < 1e-6, "{slow}");
        // At the natural frequency 1/(2 i ζ).
        let at = a.response(30.0);
        assert!(at.re.abs() < 1e-15 && (at.im + 1.0 / 1.4).abs() < 1e-12, "{at}");
        // Far above it -(f0/f)².
        let fast = a.response(3000.0);
        assert!((fast.re * 1e4 + 1.0).abs() < 1e-3 && fast.im.abs() < 2e-6, "{fast}");
    }

    #[test]
    fn nonsense_is_refused() {
        let bench = BenchRoad {
            repeat_every_s: 0.66,
            roughness: 16e-6.into(),
            slope: 2.0,
            amplitude: Amplitude::Gaussian,
            actuator: Actuator::default(),
        };
        assert!(bench.validate().is_ok());
        let refused = |edit: &dyn Fn(&mut BenchRoad)| {
            let mut bad = bench.clone();
            edit(&mut bad);
            bad.validate().unwrap_err().field
        };
        assert_eq!(refused(&|b| b.repeat_every_s = f64::NAN), "repeat_every_s");
        assert_eq!(refused(&|b| b.slope = 9.0), "slope");
        assert_eq!(refused(&|b| b.actuator.damping_ratio = 0.0), "actuator.damping_ratio");
        assert_eq!(refused(&|b| b.actuator.natural_frequency_hz = 0.0), "actuator.natural_frequency_hz");
    }
}
