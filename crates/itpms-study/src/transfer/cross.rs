//! Auto- and cross-spectra of a wheel's and a body's acceleration (Welch: Hann window, 50 % overlap), from a stream. Called by
//! whoever reads a log, row by row.

use std::fmt;
use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};

/// Length in s of a segment: bins of half a Hertz tell a hop from its neighbors, and a minute has a hundred segments.
const SEGMENT_S: f64 = 2.0;

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

/// One frequency of the measured response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bin {
    pub(super) hz: f64,
    /// Body over wheel.
    pub(super) response: Complex<f64>,
    /// Share of the body's power that the wheel explains.
    pub(super) coherence: f64,
    /// Standard error of the response over its size.
    pub(super) relative_error: f64,
}

impl fmt::Debug for CrossSpectra {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CrossSpectra").field("segments", &self.segments).finish_non_exhaustive()
    }
}

impl CrossSpectra {
    /// Empty, for samples `step_s` apart.
    #[must_use]
    pub fn new(step_s: f64) -> Self {
        let length = ((SEGMENT_S / step_s).round() as usize).max(8) & !1;
        let turn = std::f64::consts::TAU / length as f64;
        let bins = length / 2 + 1;
        Self {
            fft: RealFftPlanner::<f64>::new().plan_fft_forward(length),
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

    /// Segments taken.
    #[must_use]
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
