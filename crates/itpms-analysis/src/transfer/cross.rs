//! Auto- and cross-spectra of a wheel's and a body's acceleration (Welch: Hann window, 50 % overlap), from a stream. Called by
//! whoever reads a log, row by row.

use std::fmt;
use std::sync::Arc;

use itpms_fourier::{Complex, RealToComplex};

/// Length in s of a segment: bins of half a Hertz tell a hop from its neighbors, and a minute has a hundred segments.
const SEGMENT_S: f64 = 2.0;
const COHERENCE_HZ: (f64, f64) = (4.0, 16.0);
/// Mean coherence below which the body does not follow this wheel.
pub const INCOHERENT: f64 = 0.5;
/// Segments needed before anything is reported: half a minute.
pub const FEWEST_SEGMENTS: usize = 30;

/// Sums over segments, bin by bin.
pub struct CrossSpectra {
    fft: Arc<dyn RealToComplex<f64>>,
    window: Vec<f64>,
    step_s: f64,
    wheel: Vec<f64>,
    body: Vec<f64>,
    wheel_power: Vec<f64>,
    body_power: Vec<f64>,
    cross: Vec<Complex<f64>>,
    segments: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bin {
    pub(super) hz: f64,
    pub(super) response: Complex<f64>,
    /// Share of the body's power that the wheel explains.
    pub(super) coherence: f64,
    /// Standard error of the response over its size.
    pub(super) relative_error: f64,
}

/// One frequency of the spectra of both signals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Density {
    pub hz: f64,
    /// One-sided power spectral density of the wheel's acceleration in (m/s²)²/Hz.
    pub wheel: f64,
    pub body: f64,
    /// Share of the body's power that the wheel explains, 0 to 1; NaN where one of them has no power.
    pub coherence: f64,
}

impl fmt::Debug for CrossSpectra {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CrossSpectra").field("segments", &self.segments).finish_non_exhaustive()
    }
}

impl CrossSpectra {
    /// Empty, for samples `step_s` apart.
    pub fn new(step_s: f64) -> Self {
        let length = ((SEGMENT_S / step_s).round() as usize).max(8) & !1;
        let turn = std::f64::consts::TAU / length as f64;
        let bins = length / 2 + 1;
        Self {
            fft: itpms_fourier::forward(length),
            window: (0..length).map(|i| 0.5 - 0.5 * (turn * i as f64).cos()).collect(),
            step_s,
            wheel: Vec::with_capacity(length),
            body: Vec::with_capacity(length),
            wheel_power: vec![0.0; bins],
            body_power: vec![0.0; bins],
            cross: vec![Complex::new(0.0, 0.0); bins],
            segments: 0,
        }
    }

    /// Takes the next sample in m/s². A value that is not finite is a gap: no segment reaches across it.
    pub fn push(&mut self, wheel_m_s2: f64, body_m_s2: f64) {
        if !(wheel_m_s2.is_finite() && body_m_s2.is_finite()) {
            self.gap();
            return;
        }
        self.wheel.push(wheel_m_s2);
        self.body.push(body_m_s2);
        if self.wheel.len() == self.window.len() {
            self.take_segment();
            let half = self.window.len() / 2;
            self.wheel.drain(..half);
            self.body.drain(..half);
        }
    }

    /// Time was lost before the next sample.
    pub fn gap(&mut self) {
        self.wheel.clear();
        self.body.clear();
    }

    pub fn segments(&self) -> usize {
        self.segments
    }

    fn take_segment(&mut self) {
        let Some(wheel) = self.transform(&self.wheel) else { return };
        let Some(body) = self.transform(&self.body) else { return };
        for (i, (w, b)) in wheel.iter().zip(&body).enumerate() {
            self.wheel_power[i] += w.norm_sqr();
            self.body_power[i] += b.norm_sqr();
            self.cross[i] += b * w.conj();
        }
        self.segments += 1;
    }

    fn transform(&self, x: &[f64]) -> Option<Vec<Complex<f64>>> {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let mut input: Vec<f64> = x.iter().zip(&self.window).map(|(v, w)| (v - mean) * w).collect();
        let mut spectrum = self.fft.make_output_vec();
        self.fft.process(&mut input, &mut spectrum).ok()?;
        Some(spectrum)
    }

    /// Spectra of both signals, from the first bin to half the sampling rate; empty before the first segment.
    pub fn densities(&self) -> Vec<Density> {
        if self.segments == 0 {
            return Vec::new();
        }
        let window: f64 = self.window.iter().map(|w| w * w).sum();
        // Twice for the negative frequencies; the last bin, half the sampling rate, has none and is left out.
        let scale = 2.0 * self.step_s / (window * self.segments as f64);
        let resolution = 1.0 / (self.window.len() as f64 * self.step_s);
        (1..self.cross.len() - 1)
            .map(|i| {
                let (wheel, body) = (self.wheel_power[i], self.body_power[i]);
                let coherence = self.cross[i].norm_sqr() / (wheel * body);
                Density {
                    hz: i as f64 * resolution,
                    wheel: scale * wheel,
                    body: scale * body,
                    coherence: if wheel > 0.0 && body > 0.0 { coherence } else { f64::NAN },
                }
            })
            .collect()
    }

    /// Mean coherence where the body answers the wheel, 4 to 16 Hz; 0 before the first segment.
    pub fn coherence(&self) -> f64 {
        let bins = self.response(COHERENCE_HZ.0, COHERENCE_HZ.1);
        bins.iter().map(|bin| bin.coherence).sum::<f64>() / bins.len().max(1) as f64
    }

    /// The response of the body to the wheel between two frequencies.
    pub(super) fn response(&self, low_hz: f64, high_hz: f64) -> Vec<Bin> {
        let resolution = 1.0 / (self.window.len() as f64 * self.step_s);
        // Half-overlapping Hann segments are worth some 11/18 of as many independent ones (Welch 1967), at least one.
        let independent = (self.segments as f64 * 11.0 / 18.0).max(1.0);
        (1..self.cross.len())
            .map(|i| (i, i as f64 * resolution))
            .filter(|(_, hz)| (low_hz..=high_hz).contains(hz))
            .filter(|(i, _)| self.wheel_power[*i] > 0.0 && self.body_power[*i] > 0.0)
            .map(|(i, hz)| {
                let coherence = self.cross[i].norm_sqr() / (self.wheel_power[i] * self.body_power[i]);
                let relative_error = ((1.0 - coherence).max(0.0) / (2.0 * independent * coherence)).sqrt();
                Bin { hz, response: self.cross[i] / self.wheel_power[i], coherence, relative_error }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn densities_are_those_of_the_signals() {
        // A wheel of amplitude 2 at 12 Hz, its body a quarter of it.
        let mut spectra = CrossSpectra::new(0.005);
        for i in 0..8_000 {
            let wheel = 2.0 * (TAU * 12.0 * f64::from(i) * 0.005).sin();
            spectra.push(wheel, 0.25 * wheel);
        }
        let lines = spectra.densities();
        let peak = lines.iter().max_by(|a, b| a.wheel.total_cmp(&b.wheel)).unwrap();
        assert_eq!(peak.hz, 12.0);
        assert!((peak.coherence - 1.0).abs() < 1e-9);
        // The density's integral is the variance: 2²/2 and a sixteenth of it.
        let variance = |of: fn(&Density) -> f64| lines.iter().map(of).sum::<f64>() * 0.5;
        assert!((variance(|line| line.wheel) - 2.0).abs() < 1e-3, "{}", variance(|line| line.wheel));
        assert!((variance(|line| line.body) - 0.125).abs() < 1e-4);
    }

    #[test]
    fn signals_that_have_nothing_to_do_with_each_other_are_incoherent() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
        };
        let mut spectra = CrossSpectra::new(0.005);
        assert_eq!(spectra.coherence(), 0.0);
        assert!(spectra.densities().is_empty());
        for _ in 0..24_000 {
            spectra.push(random(), random());
        }
        // Of n independent segments 1/n is left; some 73 are in 119 halves.
        assert!(spectra.coherence() < 0.03, "{}", spectra.coherence());
    }
}
