//! Short spectral frames of several signals under a sine window that overlap by half, accumulated sample by sample so
//! that no signal is ever stored. Steps that do not count leave a hole in a frame; what is left is scaled up.
//!
//! At the true stiffness a reconstructed road velocity is nearly white, so short frames do not smear it.

use nalgebra::{Complex, SMatrix};

use crate::memory::blank;
use crate::real::Real;

/// Share of a frame below which it is not scaled up any further.
const HARDLY_SEEN: f64 = 0.01;

/// The complex spectra of one frame, scaled so that a squared magnitude is a one-sided power density per Hz.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Frame<T: Real, const BINS: usize, const SIGNALS: usize> {
    pub(crate) re: SMatrix<T, BINS, SIGNALS>,
    pub(crate) im: SMatrix<T, BINS, SIGNALS>,
    /// Share of the window's energy that fell on steps that count.
    pub(crate) seen: T,
}

blank!(Frame<T, BINS, SIGNALS> { re, im, seen });

impl<T: Real, const BINS: usize, const SIGNALS: usize> Frame<T, BINS, SIGNALS> {
    pub(crate) fn zero() -> Self {
        Self { re: SMatrix::zeros(), im: SMatrix::zeros(), seen: T::one() }
    }

    /// A signal in a bin.
    pub(crate) fn at(&self, bin: usize, signal: usize) -> Complex<T> {
        let of = |part: &SMatrix<T, BINS, SIGNALS>| part.get((bin, signal)).copied().unwrap_or(T::ZERO);
        Complex::new(of(&self.re), of(&self.im))
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
    /// The sine window now, of the younger frame and of the older one; at the first step; and how far it turns in a step.
    window: [T; 2],
    first_window: [T; 2],
    window_turn: [T; 2],
    older: Frame<T, BINS, SIGNALS>,
    younger: Frame<T, BINS, SIGNALS>,
}

blank!(FrameClock<T, BINS, SIGNALS> {
    hop, grid_period_s, step, complete_hops, phase, turn, window, first_window, window_turn, older, younger,
});

impl<T: Real, const BINS: usize, const SIGNALS: usize> FrameClock<T, BINS, SIGNALS> {
    /// Frames of twice `hop_s`, one every `hop_s`, rounded to whole steps of the grid, at least one.
    pub(crate) fn configure(&mut self, hop_s: f64, grid_period_s: f64) {
        let hop = (hop_s / grid_period_s + 0.5).max(1.0) as u32;
        let angle = T::lit(core::f64::consts::PI / f64::from(hop));
        (self.hop, self.grid_period_s) = (hop, grid_period_s);
        self.turn = [angle.cos(), -angle.sin()];
        // sin(π (i + ½) / n) over the n steps of two hops, and the same a hop later.
        let (half, quarter) = (T::lit(0.5) * angle, T::lit(0.25) * angle);
        self.first_window = [quarter.sin(), quarter.cos()];
        self.window_turn = [half.sin(), half.cos()];
        self.restart();
    }

    /// Time between frames in s.
    pub(crate) fn hop_s(&self) -> f64 {
        f64::from(self.hop) * self.grid_period_s
    }

    /// Distance between bins in Hz; the first bin lies at one such distance.
    pub(crate) fn bin_spacing_hz(&self) -> f64 {
        1.0 / (2.0 * self.hop_s())
    }

    /// Steps until the next frame is complete, or one so many hops later.
    pub(crate) fn steps_until(&self, hops_later: u32) -> usize {
        (self.hop * (hops_later + 1)).saturating_sub(self.step) as usize
    }

    /// Drops the frames under way.
    #[inline(never)]
    pub(crate) fn restart(&mut self) {
        self.step = 0;
        self.complete_hops = 0;
        self.phase = [T::one(), T::zero()];
        self.window = self.first_window;
        self.older = Frame::zero();
        self.younger = Frame::zero();
    }

    /// Adds one step of all signals; gives a frame when one is complete.
    pub(crate) fn push(&mut self, signals: &[T; SIGNALS]) -> Option<Frame<T, BINS, SIGNALS>> {
        self.push_if(true, signals)
    }

    /// The same of a step that may not count.
    pub(crate) fn push_if(
        &mut self,
        counts: bool,
        signals: &[T; SIGNALS],
    ) -> Option<Frame<T, BINS, SIGNALS>> {
        // Sine window over two hops. The younger frame sees its first half, the older its second.
        let [rising, falling] = self.window;
        let [sine, cosine] = self.window_turn;
        self.window = [rising * cosine + falling * sine, falling * cosine - rising * sine];
        if counts {
            self.add(rising, falling, signals);
        } else {
            // Σ window² of a whole frame is its hop.
            let hop = T::whole(self.hop);
            self.younger.seen -= rising * rising / hop;
            self.older.seen -= falling * falling / hop;
        }
        let ([re, im], [turn_re, turn_im]) = (self.phase, self.turn);
        self.phase = [re * turn_re - im * turn_im, re * turn_im + im * turn_re];
        self.step += 1;
        if self.step < self.hop {
            return None;
        }
        self.finish_hop()
    }

    fn add(&mut self, rising: T, falling: T, signals: &[T; SIGNALS]) {
        let [re_1, im_1] = self.phase;
        let mut turns = [[T::zero(); 2]; BINS];
        let (mut re, mut im) = (re_1, im_1);
        for turn in &mut turns {
            *turn = [re, im];
            (re, im) = (re * re_1 - im * im_1, re * im_1 + im * re_1);
        }
        // Bins innermost: they lie side by side in memory.
        let younger = self.younger.re.data.0.iter_mut().zip(&mut self.younger.im.data.0);
        let older = self.older.re.data.0.iter_mut().zip(&mut self.older.im.data.0);
        for (((young_re, young_im), (old_re, old_im)), &x) in younger.zip(older).zip(signals) {
            let young = young_re.iter_mut().zip(young_im);
            let old = old_re.iter_mut().zip(old_im);
            for (((young_re, young_im), (old_re, old_im)), &[re, im]) in young.zip(old).zip(&turns) {
                let (x_re, x_im) = (x * re, x * im);
                *young_re += rising * x_re;
                *young_im += rising * x_im;
                *old_re += falling * x_re;
                *old_im += falling * x_im;
            }
        }
    }

    /// Apart, or every step would move a frame's place about, whether there is one or not.
    #[inline(never)]
    fn finish_hop(&mut self) -> Option<Frame<T, BINS, SIGNALS>> {
        self.step = 0;
        self.window = self.first_window;
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
        // 2 dt / Σ window², with Σ window² = hop if every step counts.
        let seen = done.seen.max(T::lit(HARDLY_SEEN));
        let scale = (T::lit(2.0 * self.grid_period_s / f64::from(self.hop)) / seen).sqrt();
        done.re *= scale;
        done.im *= scale;
        Some(done)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::memory::configured;
    use crate::random::Random;

    const PERIOD_S: f64 = 0.004;
    const BINS: usize = 5;

    /// Frames of a signal, of which those steps count that `counts` says.
    fn frames(
        steps: usize,
        mut signal: impl FnMut() -> f64,
        counts: impl Fn(usize) -> bool,
    ) -> Vec<Frame<f64, BINS, 1>> {
        let mut clock: FrameClock<f64, BINS, 1> =
            configured(|clock: &mut FrameClock<f64, BINS, 1>| clock.configure(0.1, PERIOD_S));
        (0..steps).filter_map(|step| clock.push_if(counts(step), &[signal()])).collect()
    }

    /// White noise of variance one, the same each time.
    fn noise() -> impl FnMut() -> f64 {
        let mut random = Random(3);
        move || random.normal()
    }

    #[test]
    fn holes_leave_the_power_of_a_random_signal_as_it_is() {
        // Eleven steps of every thirty: holes of 44 ms, some twice a frame of 200 ms.
        let found = frames(200_000, noise(), |step| step % 30 >= 11);
        let count = found.len() as f64;
        let seen = found.iter().map(|frame| frame.seen).sum::<f64>() / count;
        assert!((seen - 19.0 / 30.0).abs() < 1e-3, "{seen}");
        for bin in 0..BINS {
            // White noise has a one-sided density of twice the period. A frame's power scatters as much as it is large, and
            // frames that overlap by half are worth two thirds of their number at least.
            let power = found.iter().map(|frame| frame.cross(bin, 0, 0)).sum::<f64>() / count;
            let off = power / (2.0 * PERIOD_S) - 1.0;
            assert!(off.abs() < 4.0 / (0.66 * count).sqrt(), "bin {bin}: {off}");
        }
    }

    #[test]
    fn a_frame_is_seen_whole_or_not_at_all() {
        assert!(frames(200, noise(), |_| true).iter().all(|frame| frame.seen == 1.0));
        let unseen = frames(200, noise(), |_| false);
        assert!(!unseen.is_empty());
        for frame in unseen {
            assert!(frame.seen.abs() < 1e-12 && frame.re.iter().chain(frame.im.iter()).all(|&x| x == 0.0));
        }
    }

    #[test]
    fn what_does_not_count_leaves_no_trace() {
        let counts = |step: usize| step % 30 >= 11;
        let (mut clean, mut step) = (noise(), 0);
        let invalid = move || {
            step += 1;
            let x = clean();
            if counts(step - 1) { x } else { f64::NAN }
        };
        assert_eq!(frames(500, noise(), counts), frames(500, invalid, counts));
    }
}
