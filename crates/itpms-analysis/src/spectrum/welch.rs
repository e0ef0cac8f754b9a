//! Welch's power spectral density: Hann window, 50 % overlap, each segment detrended.
//!
//! Works on a stream: memory is one segment and one sum per frequency, however long the record.

use std::fmt;
use std::sync::Arc;

use itpms_fourier::{Complex, RealToComplex};
use thiserror::Error;

/// Settings no spectrum can be computed with.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum WelchError {
    #[error("segments of {0} samples, expected an even number, 8 or more")]
    Segment(usize),
    #[error("sample spacing {0}, expected a positive, finite number")]
    Spacing(f64),
}

/// A one-sided power spectral density: its integral over frequency is the variance.
#[derive(Debug, Clone, PartialEq)]
pub struct Psd {
    /// Frequencies from one bin's width to half the sampling rate, evenly spaced, in cycles per unit of the
    /// sample spacing (Hz, or cycles per metre). Zero is left out: the trend was removed.
    pub frequencies: Vec<f64>,
    /// Densities in squared units of the signal per unit of frequency.
    pub densities: Vec<f64>,
    pub segments: usize,
}

impl Psd {
    pub fn resolution(&self) -> f64 {
        self.frequencies.first().copied().unwrap_or(f64::NAN)
    }

    /// Variance of the signal in a band of frequencies, both ends included.
    pub fn variance_between(&self, low: f64, high: f64) -> f64 {
        let inside = self.frequencies.iter().zip(&self.densities).filter(|(f, _)| **f >= low && **f <= high);
        inside.map(|(_, density)| density).sum::<f64>() * self.resolution()
    }
}

/// Welch's estimate over a stream of evenly spaced samples.
pub struct Welch {
    fft: Arc<dyn RealToComplex<f64>>,
    window: Vec<f64>,
    spacing: f64,
    pending: Vec<f64>,
    work: Vec<f64>,
    spectrum: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
    sum: Vec<f64>,
    segments: usize,
}

impl fmt::Debug for Welch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Welch")
            .field("segment", &self.window.len())
            .field("spacing", &self.spacing)
            .field("segments", &self.segments)
            .finish_non_exhaustive()
    }
}

impl Welch {
    /// An empty estimate with segments of `segment` samples, `spacing` apart (s, or m).
    pub fn new(segment: usize, spacing: f64) -> Result<Self, WelchError> {
        if segment < 8 || !segment.is_multiple_of(2) {
            return Err(WelchError::Segment(segment));
        }
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(WelchError::Spacing(spacing));
        }
        let fft = itpms_fourier::forward(segment);
        // The periodic Hann window: shifted by half its length it sums to a constant.
        let turn = std::f64::consts::TAU / segment as f64;
        let window = (0..segment).map(|i| 0.5 - 0.5 * (turn * i as f64).cos()).collect();
        Ok(Self {
            window,
            spacing,
            pending: Vec::with_capacity(segment),
            work: fft.make_input_vec(),
            spectrum: fft.make_output_vec(),
            scratch: fft.make_scratch_vec(),
            sum: vec![0.0; segment / 2],
            segments: 0,
            fft,
        })
    }

    /// Takes the next sample. A value that is not finite is a gap: no segment reaches across it.
    pub fn push(&mut self, value: f64) {
        if !value.is_finite() {
            self.pending.clear();
            return;
        }
        self.pending.push(value);
        if self.pending.len() == self.window.len() {
            self.take_segment();
            self.pending.drain(..self.window.len() / 2);
        }
    }

    fn take_segment(&mut self) {
        let n = self.window.len() as f64;
        // Straight line by least squares about the segment's middle.
        let middle = (n - 1.0) / 2.0;
        let mean = self.pending.iter().sum::<f64>() / n;
        let moment: f64 = self.pending.iter().enumerate().map(|(i, v)| (i as f64 - middle) * v).sum();
        let slope = moment * 12.0 / (n * (n * n - 1.0));
        for (i, work) in self.work.iter_mut().enumerate() {
            *work = self.window[i] * (self.pending[i] - mean - slope * (i as f64 - middle));
        }
        // The buffers come from this very plan, so their lengths cannot be refused.
        if self.fft.process_with_scratch(&mut self.work, &mut self.spectrum, &mut self.scratch).is_err() {
            return;
        }
        for (sum, bin) in self.sum.iter_mut().zip(&self.spectrum[1..]) {
            *sum += bin.norm_sqr();
        }
        self.segments += 1;
    }

    pub fn segments(&self) -> usize {
        self.segments
    }

    /// The density so far; `None` before the first whole segment.
    pub fn psd(&self) -> Option<Psd> {
        if self.segments == 0 {
            return None;
        }
        let n = self.window.len();
        let resolution = 1.0 / (n as f64 * self.spacing);
        let power: f64 = self.window.iter().map(|w| w * w).sum();
        // Twice for the negative frequencies, which the one at half the sampling rate does not have.
        let scale = 2.0 * self.spacing / (power * self.segments as f64);
        let mut densities: Vec<f64> = self.sum.iter().map(|s| s * scale).collect();
        if let Some(last) = densities.last_mut() {
            *last *= 0.5;
        }
        let frequencies = (1..=n / 2).map(|i| i as f64 * resolution).collect();
        Some(Psd { frequencies, densities, segments: self.segments })
    }
}

/// The density of a whole record; `None` when it is shorter than a segment.
pub fn welch(signal: &[f64], segment: usize, spacing: f64) -> Result<Option<Psd>, WelchError> {
    let mut estimate = Welch::new(segment, spacing)?;
    signal.iter().for_each(|&value| estimate.push(value));
    Ok(estimate.psd())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    #[test]
    fn white_noise_of_known_variance_is_flat() {
        let mut rng = Pcg64::seed_from_u64(1);
        let signal: Vec<f64> = (0..256 * 400)
            .map(|_| 0.3 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng))
            .collect();
        let psd = welch(&signal, 256, 0.01).unwrap().unwrap();
        assert_eq!(psd.segments, 799);
        // variance / (half the rate) = 0.09 / 50; about 750 independent averages: 3.6 % per bin, so 5 sd = 18 %.
        for (f, d) in psd.frequencies.iter().zip(&psd.densities).take(126).skip(1) {
            assert!((d / 0.0018 - 1.0).abs() < 0.18, "{f} Hz: {d}");
        }
        // Over all bins the variance comes back; 102 400 samples: 0.44 %, so 5 sd = 2.2 %, and the trend takes 2/256.
        assert!((psd.variance_between(0.0, 50.0) / 0.09 - 1.0).abs() < 0.03);
    }

    #[test]
    fn a_sine_carries_half_its_squared_amplitude() {
        let signal: Vec<f64> =
            (0..4096).map(|i| 2.0 * (std::f64::consts::TAU * 10.3 * f64::from(i) * 0.01).sin()).collect();
        let psd = welch(&signal, 512, 0.01).unwrap().unwrap();
        // The Hann window's sidelobes beyond +-1 Hz (5 bins) hold less than a part in a thousand.
        assert!((psd.variance_between(9.3, 11.3) - 2.0).abs() < 0.01);
    }

    #[test]
    fn a_straight_line_has_no_spectrum() {
        let signal: Vec<f64> = (0..1024).map(|i| 3.0 - 0.7 * f64::from(i)).collect();
        let psd = welch(&signal, 128, 1.0).unwrap().unwrap();
        assert!(psd.densities.iter().all(|d| *d < 1e-18));
    }

    #[test]
    fn a_gap_ends_a_segment() {
        let mut estimate = Welch::new(64, 1.0).unwrap();
        for i in 0..63 {
            estimate.push(f64::from(i % 7));
        }
        estimate.push(f64::NAN);
        for i in 0..63 {
            estimate.push(f64::from(i % 7));
        }
        assert_eq!(estimate.segments(), 0);
        assert!(estimate.psd().is_none());
        estimate.push(1.0);
        assert_eq!(estimate.segments(), 1);
    }

    #[test]
    fn settings_are_checked() {
        assert_eq!(Welch::new(7, 1.0).unwrap_err(), WelchError::Segment(7));
        assert_eq!(Welch::new(9, 1.0).unwrap_err(), WelchError::Segment(9));
        assert_eq!(Welch::new(64, 0.0).unwrap_err(), WelchError::Spacing(0.0));
        assert!(Welch::new(64, f64::NAN).is_err());
    }
}
