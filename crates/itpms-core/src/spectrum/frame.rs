//! Short spectral frames of several signals under a sine window that overlap by half, accumulated sample by sample so
//! that no signal is ever stored. Steps that do not count leave a hole in a frame; what is left is scaled up.
//!
//! At the true stiffness a reconstructed road velocity is nearly white, so short frames do not smear it.

use nalgebra::{Complex, SMatrix};

use crate::memory::Blank;
use crate::real::Real;

/// New in a frame: frames overlap by half.
pub(crate) const OVERLAP: f64 = 0.5;
/// Independent frames among some that overlap by half under a sine window, which say everything twice: a little less than half lets
/// an interval cover what a model leaves out.
pub(crate) const INDEPENDENT: f64 = 0.45;
/// Share of a frame below which it is not scaled up any further.
const HARDLY_SEEN: f64 = 0.01;

/// The complex spectra of one frame, scaled so that a squared magnitude is a one-sided power density per Hz.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Frame<T: Real, const BINS: usize, const SIGNALS: usize> {
    pub(crate) re: SMatrix<T, BINS, SIGNALS>,
    pub(crate) im: SMatrix<T, BINS, SIGNALS>,
    /// Share of the window's energy that fell on steps that count.
    pub(crate) seen: T,
}

impl<T: Real, const BINS: usize, const SIGNALS: usize> Frame<T, BINS, SIGNALS> {
    pub(crate) fn zero() -> Self {
        Self { re: SMatrix::zeros(), im: SMatrix::zeros(), seen: T::one() }
    }

    pub(crate) fn at(&self, bin: usize, signal: usize) -> Complex<T> {
        let of = |part: &SMatrix<T, BINS, SIGNALS>| part.get((bin, signal)).copied().unwrap_or(T::ZERO);
        Complex::new(of(&self.re), of(&self.im))
    }
}

/// Sums over the steps of one hop: `Σ x_i e^{-jα (2m+1) (i+½)}`, `α = π / (2 hop)`: at `m = 0` and, for `m` from 1 on, half a bin above
/// each bin.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Sums<T: Real, const BINS: usize, const SIGNALS: usize> {
    lowest: SMatrix<T, SIGNALS, 2>,
    re: SMatrix<T, BINS, SIGNALS>,
    im: SMatrix<T, BINS, SIGNALS>,
    /// Energy that the rising and the falling half of the window would have had at steps that do not count, over a whole window's.
    unseen: [T; 2],
}

/// Accumulates frames of two hops each, one every hop.
///
/// A sine is two complex exponentials, so a frame under a sine window is the difference of two spectra without a window, half a bin
/// below and above: `w_i = sin(2α (i+½)/2)` gives `Σ x_i w_i e^{-j2αk(i+½)} = (Q_{k-1} - Q_k) / 2j` with
/// `Q_m = Σ x_i e^{-jα(2m+1)(i+½)}`. Sums over single hops serve both frames that they are part of.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FrameClock<T: Real, const BINS: usize, const SIGNALS: usize> {
    hop: u32,
    grid_period_s: f64,
    step: u32,
    /// Steps that are left out after a restart, and how many of them are to come.
    late: u32,
    waits: u32,
    /// Whether the hop before this one is part of a frame.
    is_under_way: bool,
    /// `e^{-jα (i+½)}`, at the first step, and how far it turns in a step: its parts are the window's halves.
    phase: [T; 2],
    first_phase: [T; 2],
    turn: [T; 2],
    before: Sums<T, BINS, SIGNALS>,
    now: Sums<T, BINS, SIGNALS>,
}

impl<T: Real, const BINS: usize, const SIGNALS: usize> FrameClock<T, BINS, SIGNALS> {
    /// Frames of twice `hop_s`, one every `hop_s`, rounded to whole steps of the grid, at least one.
    pub(crate) fn configure(&mut self, hop_s: f64, grid_period_s: f64) {
        let hop = (hop_s / grid_period_s + 0.5).max(1.0) as u32;
        let angle = T::lit(0.5 * core::f64::consts::PI / f64::from(hop));
        let half = T::lit(0.5) * angle;
        (self.hop, self.grid_period_s, self.late) = (hop, grid_period_s, 0);
        self.turn = [angle.cos(), -angle.sin()];
        self.first_phase = [half.cos(), -half.sin()];
        self.restart();
    }

    /// Its hops begin half a hop later than those of others; before the first step.
    pub(crate) fn delay(&mut self) {
        self.late = self.hop / 2;
        self.waits = self.late;
    }

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

    #[inline(never)]
    pub(crate) fn restart(&mut self) {
        (self.step, self.waits, self.is_under_way) = (0, self.late, false);
        self.phase = self.first_phase;
        (self.before, self.now) = (Sums::BLANK, Sums::BLANK);
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
        if self.waits > 0 {
            self.waits -= 1;
            return None;
        }
        let phase = self.phase;
        if counts {
            self.now.add(phase, signals);
        } else {
            // Σ window² of a whole frame is its hop.
            let hop = T::whole(self.hop);
            let [falling, rising] = phase;
            self.now.unseen[0] += rising * rising / hop;
            self.now.unseen[1] += falling * falling / hop;
        }
        self.phase = times(phase, self.turn);
        self.step += 1;
        if self.step < self.hop {
            return None;
        }
        self.finish_hop()
    }

    /// Apart, or every step would move a frame's place about, whether there is one or not.
    #[inline(never)]
    fn finish_hop(&mut self) -> Option<Frame<T, BINS, SIGNALS>> {
        self.step = 0;
        self.phase = self.first_phase;
        let done = self.is_under_way.then(|| self.frame());
        self.before = core::mem::replace(&mut self.now, Sums::BLANK);
        self.is_under_way = true;
        done
    }

    fn frame(&self) -> Frame<T, BINS, SIGNALS> {
        let (before, now) = (&self.before, &self.now);
        let seen = T::one() - before.unseen[0] - now.unseen[1];
        // 2 dt / Σ window², with Σ window² = hop if every step counts; half of it for the sine's two exponentials.
        let density = T::lit(2.0 * self.grid_period_s / f64::from(self.hop)) / seen.max(T::lit(HARDLY_SEEN));
        let scale = T::lit(0.5) * density.sqrt();
        let mut frame = Frame { seen, ..Frame::zero() };
        for signal in 0..SIGNALS {
            // A hop later the exponentials have turned by -j (-1)^m.
            let [re, im] = [before, now].map(|sums| [sums.lowest[(signal, 0)], sums.lowest[(signal, 1)]]);
            let (mut below, mut sign) = ([re[0] + im[1], re[1] - im[0]], T::one());
            for bin in 0..BINS {
                sign = -sign;
                let above = [
                    before.re[(bin, signal)] + sign * now.im[(bin, signal)],
                    before.im[(bin, signal)] - sign * now.re[(bin, signal)],
                ];
                // Over j: the real part is the imaginary one, the imaginary part less the real one.
                frame.re[(bin, signal)] = (below[1] - above[1]) * scale;
                frame.im[(bin, signal)] = (above[0] - below[0]) * scale;
                below = above;
            }
        }
        frame
    }
}

impl<T: Real, const BINS: usize, const SIGNALS: usize> Sums<T, BINS, SIGNALS> {
    fn add(&mut self, phase: [T; 2], signals: &[T; SIGNALS]) {
        let twice = times(phase, phase);
        let mut turns = [[T::zero(); 2]; BINS];
        let mut turn = phase;
        for place in &mut turns {
            turn = times(turn, twice);
            *place = turn;
        }
        let [lowest_re, lowest_im] = &mut self.lowest.data.0;
        for ((re, im), &x) in lowest_re.iter_mut().zip(lowest_im).zip(signals) {
            *re += x * phase[0];
            *im += x * phase[1];
        }
        // Bins innermost: they lie side by side in memory.
        for ((re, im), &x) in self.re.data.0.iter_mut().zip(&mut self.im.data.0).zip(signals) {
            for ((re, im), &[turn_re, turn_im]) in re.iter_mut().zip(im).zip(&turns) {
                *re += x * turn_re;
                *im += x * turn_im;
            }
        }
    }
}

fn times<T: Real>([a_re, a_im]: [T; 2], [b_re, b_im]: [T; 2]) -> [T; 2] {
    [a_re * b_re - a_im * b_im, a_re * b_im + a_im * b_re]
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

    /// Every frame is what its definition says, of steps that count and of those that do not.
    #[test]
    fn a_frame_is_the_spectrum_under_a_sine_window() {
        let (hop, counts) = (25, |step: usize| !(40..47).contains(&step));
        let mut draw = noise();
        let x: Vec<f64> = (0..200).map(|_| 3.0 + draw()).collect();
        let mut next = x.iter();
        let found = frames(x.len(), || *next.next().unwrap(), counts);
        assert_eq!(found.len(), x.len() / hop - 1);
        for (n, frame) in found.iter().enumerate() {
            let window = |i: usize| (core::f64::consts::PI * (i as f64 + 0.5) / (2 * hop) as f64).sin();
            let counting = || (0..2 * hop).filter(|i| counts(n * hop + i));
            let energy: f64 = counting().map(|i| window(i).powi(2)).sum();
            assert!((frame.seen - energy / hop as f64).abs() < 1e-12);
            for bin in 0..BINS {
                let omega = core::f64::consts::PI * (bin + 1) as f64 / hop as f64;
                let sum = |of: fn(f64) -> f64| -> f64 {
                    counting().map(|i| x[n * hop + i] * window(i) * of(omega * (i as f64 + 0.5))).sum()
                };
                let scale = (2.0 * PERIOD_S / energy).sqrt();
                let expected = Complex::new(scale * sum(f64::cos), -scale * sum(f64::sin));
                assert!((frame.at(bin, 0) - expected).norm_sqr() < 1e-24, "frame {n}, bin {bin}");
            }
        }
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
            let power = found.iter().map(|frame| frame.at(bin, 0).norm_sqr()).sum::<f64>() / count;
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
