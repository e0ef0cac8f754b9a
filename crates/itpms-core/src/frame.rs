//! Short spectral frames of several signals under a sine window that overlap by half, accumulated sample by sample so
//! that no signal is ever stored.
//!
//! At the true stiffness a reconstructed road velocity is nearly white, so short frames do not smear it.

use nalgebra::{Complex, SMatrix};

use crate::real::Real;

/// The complex spectra of one frame, scaled so that a squared magnitude is a one-sided power density per Hz.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Frame<T: Real, const BINS: usize, const SIGNALS: usize> {
    pub(crate) re: SMatrix<T, BINS, SIGNALS>,
    pub(crate) im: SMatrix<T, BINS, SIGNALS>,
}

impl<T: Real, const BINS: usize, const SIGNALS: usize> Frame<T, BINS, SIGNALS> {
    pub(crate) fn zero() -> Self {
        Self { re: SMatrix::zeros(), im: SMatrix::zeros() }
    }

    /// A signal in a bin.
    pub(crate) fn at(&self, bin: usize, signal: usize) -> Complex<T> {
        Complex::new(self.re[(bin, signal)], self.im[(bin, signal)])
    }

    /// `Re(X_i X_j*)` of two signals in a bin.
    pub(crate) fn cross(&self, bin: usize, i: usize, j: usize) -> T {
        self.re[(bin, i)] * self.re[(bin, j)] + self.im[(bin, i)] * self.im[(bin, j)]
    }
}

/// Accumulates two frames that overlap by half.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FrameClock<T: Real, const BINS: usize, const SIGNALS: usize> {
    /// Steps per hop.
    hop: u32,
    grid_period_s: f64,
    step: u32,
    /// Hops since the last restart, up to two.
    complete_hops: u32,
    /// `e^{-jφ}`, `φ = 2π step / (2 hop)`, and its increment.
    phase: [T; 2],
    turn: [T; 2],
    older: Frame<T, BINS, SIGNALS>,
    younger: Frame<T, BINS, SIGNALS>,
}

impl<T: Real, const BINS: usize, const SIGNALS: usize> FrameClock<T, BINS, SIGNALS> {
    /// Frames of twice `hop_s`, one every `hop_s`, rounded to whole steps of the grid, at least one.
    pub(crate) fn new(hop_s: f64, grid_period_s: f64) -> Self {
        let hop = (hop_s / grid_period_s + 0.5).max(1.0) as u32;
        let angle = T::lit(core::f64::consts::PI / f64::from(hop));
        Self {
            hop,
            grid_period_s,
            step: 0,
            complete_hops: 0,
            phase: [T::one(), T::zero()],
            turn: [angle.cos(), -angle.sin()],
            older: Frame::zero(),
            younger: Frame::zero(),
        }
    }

    /// Time between frames in s.
    pub(crate) fn hop_s(&self) -> f64 {
        f64::from(self.hop) * self.grid_period_s
    }

    /// Distance between bins in Hz; the first bin lies at one such distance.
    pub(crate) fn bin_spacing_hz(&self) -> f64 {
        1.0 / (2.0 * self.hop_s())
    }

    /// Drops the frames under way.
    pub(crate) fn restart(&mut self) {
        self.step = 0;
        self.complete_hops = 0;
        self.phase = [T::one(), T::zero()];
        self.older = Frame::zero();
        self.younger = Frame::zero();
    }

    /// Adds one step of all signals; gives a frame when one is complete.
    pub(crate) fn push(&mut self, signals: &[T; SIGNALS]) -> Option<Frame<T, BINS, SIGNALS>> {
        // Sine window over two hops: sin(π (i + ½) / n). The younger frame sees its first half, the older its second.
        let angle = T::lit(core::f64::consts::FRAC_PI_2 * (f64::from(self.step) + 0.5) / f64::from(self.hop));
        let (rising, falling) = (angle.sin(), angle.cos());
        let [re_1, im_1] = self.phase;
        let (mut re, mut im) = (re_1, im_1);
        for bin in 0..BINS {
            for (signal, &x) in signals.iter().enumerate() {
                let (x_re, x_im) = (x * re, x * im);
                self.younger.re[(bin, signal)] += rising * x_re;
                self.younger.im[(bin, signal)] += rising * x_im;
                self.older.re[(bin, signal)] += falling * x_re;
                self.older.im[(bin, signal)] += falling * x_im;
            }
            (re, im) = (re * re_1 - im * im_1, re * im_1 + im * re_1);
        }
        let [turn_re, turn_im] = self.turn;
        self.phase = [re_1 * turn_re - im_1 * turn_im, re_1 * turn_im + im_1 * turn_re];
        self.step += 1;
        if self.step < self.hop {
            return None;
        }
        self.finish_hop()
    }

    fn finish_hop(&mut self) -> Option<Frame<T, BINS, SIGNALS>> {
        self.step = 0;
        self.complete_hops = (self.complete_hops + 1).min(2);
        // Bin k turns by kπ in a hop; the sign is the same for all signals of a bin and drops out of every product, so
        // the phase may start again at zero if the odd bins of the frame under way change sign.
        self.phase = [T::one(), T::zero()];
        let mut done = core::mem::replace(&mut self.younger, Frame::zero());
        for bin in (0..BINS).step_by(2) {
            for signal in 0..SIGNALS {
                done.re[(bin, signal)] = -done.re[(bin, signal)];
                done.im[(bin, signal)] = -done.im[(bin, signal)];
            }
        }
        core::mem::swap(&mut done, &mut self.older);
        if self.complete_hops < 2 {
            return None;
        }
        // 2 dt / Σ window² with Σ window² = hop
        let scale = T::lit(2.0 * self.grid_period_s / f64::from(self.hop)).sqrt();
        done.re *= scale;
        done.im *= scale;
        Some(done)
    }
}
