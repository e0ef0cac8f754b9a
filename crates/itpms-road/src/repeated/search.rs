//! Looks for a road that repeats itself: the autocorrelation of the reconstructed road velocity at every lag from a
//! quarter of a second to 1.8 s, forgotten over some periods (docs/math/repeated-road.md, eq. 1-2).
//!
//! Fed with every grid step; gives a period when the signal has repeated itself for a whole one. Knows nothing of
//! stiffness. A road that does not repeat correlates by chance alone, a wheel out of balance with one frequency only:
//! what is found here is a candidate, to be confirmed by harmonics.

use itpms_core::Real;

/// Rate in Hz at which the signal is compared with its past.
const RATE_HZ: f64 = 100.0;
/// Shortest and longest period looked for, in steps of that rate: 0.25 to 1.8 s.
const SHORTEST: usize = 25;
const LONGEST: usize = 180;
const LAGS: usize = LONGEST - SHORTEST + 1;
/// Band-pass before the comparison, 3 to 17 Hz at -6 dB: the road is loudest against the sensors' noise around wheel hop, and
/// far below it wander offsets that have not settled yet.
const BAND_PASS: [f64; 9] = [1.0, 2.0, 3.0, 2.0, 0.0, -2.0, -3.0, -2.0, -1.0];
const MEMORY_S: f64 = 3.0;
/// Least correlation of a road that repeats: what is missing is noise.
const REPEATS: f64 = 0.8;
/// A multiple of the period correlates as well; the shortest lag that comes this close to the best is the period.
const AS_GOOD: f64 = 0.93;
/// Seconds of comparison before a lag counts, at least; and a whole period.
const LEAST_S: f64 = 0.6;

#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PeriodSearch<T: Real> {
    /// Grid steps per step here, and how many of them are summed up.
    block: u32,
    in_block: u32,
    wheel: T,
    force: T,
    /// The last means, newest first.
    means: [T; BAND_PASS.len()],
    step_s: f64,
    keep: T,
    /// The past, newest first from `newest` on: twice, one after the other, so that it lies in a row from any place on.
    past: Ring<T>,
    newest: usize,
    filled: usize,
    /// Steps since the last restart.
    seen: u32,
    /// `Σ x(t) x(t-L)`, `Σ x(t-L)²` and `Σ x(t)²` per lag, since that lag can be looked back.
    cross: Lags<T>,
    then: Lags<T>,
    now: Lags<T>,
}

const KEPT: usize = LONGEST + 1;

type Ring<T> = nalgebra::SVector<T, { 2 * KEPT }>;
type Lags<T> = nalgebra::SVector<T, LAGS>;

impl<T: Real> PeriodSearch<T> {
    pub(crate) fn new(grid_period_s: f64) -> Self {
        // Rounded to whole steps, at least one.
        let block = (1.0 / (RATE_HZ * grid_period_s) + 0.5).max(1.0) as u32;
        let step_s = f64::from(block) * grid_period_s;
        Self {
            block,
            in_block: 0,
            wheel: T::zero(),
            force: T::zero(),
            means: [T::zero(); BAND_PASS.len()],
            step_s,
            keep: T::lit(-step_s / MEMORY_S).exp(),
            past: Ring::zeros(),
            newest: 0,
            filled: 0,
            seen: 0,
            cross: Lags::zeros(),
            then: Lags::zeros(),
            now: Lags::zeros(),
        }
    }

    /// The signal was interrupted, or what was found has been taken: start again.
    pub(crate) fn restart(&mut self) {
        (self.in_block, self.filled, self.seen) = (0, 0, 0);
        (self.wheel, self.force) = (T::zero(), T::zero());
        self.means = [T::zero(); BAND_PASS.len()];
        self.cross.fill(T::zero());
        self.then.fill(T::zero());
        self.now.fill(T::zero());
    }

    /// Takes one grid step of `wheel + θ force`, and asks for `θ` now and then; gives the period in s once the signal repeats itself.
    pub(crate) fn push(&mut self, wheel: T, force: T, theta: impl FnOnce() -> T) -> Option<T> {
        self.wheel += wheel;
        self.force += force;
        self.in_block += 1;
        if self.in_block < self.block {
            return None;
        }
        self.means.rotate_right(1);
        self.means[0] = (self.wheel + theta() * self.force) / T::lit(f64::from(self.block));
        (self.wheel, self.force, self.in_block) = (T::zero(), T::zero(), 0);
        let passed = self
            .means
            .iter()
            .zip(BAND_PASS)
            .fold(T::zero(), |sum, (&mean, weight)| sum + mean * T::lit(weight));
        self.compare(passed);
        self.newest = (self.newest + KEPT - 1) % KEPT;
        (self.past[self.newest], self.past[self.newest + KEPT]) = (passed, passed);
        self.filled = (self.filled + 1).min(KEPT);
        self.seen = self.seen.saturating_add(1);
        // A tenth of a second between two looks is soon enough.
        if ((KEPT - self.newest) % KEPT).is_multiple_of(10) { self.find() } else { None }
    }

    fn compare(&mut self, value: T) {
        let (keep, square) = (self.keep, value * value);
        let looked_back = (self.filled.min(LONGEST) + 1).saturating_sub(SHORTEST);
        // The newest stored value is one step old. A sum at a time over slices, which the processor does by several lags at once.
        let from = self.newest + SHORTEST - 1;
        let past = self.past.as_slice().get(from..from + looked_back).unwrap_or(&[]);
        for (cross, &old) in self.cross.as_mut_slice().iter_mut().zip(past) {
            *cross = keep * *cross + value * old;
        }
        for (then, &old) in self.then.as_mut_slice().iter_mut().zip(past) {
            *then = keep * *then + old * old;
        }
        for (now, _) in self.now.as_mut_slice().iter_mut().zip(past) {
            *now = keep * *now + square;
        }
    }

    fn correlation(&self, i: usize) -> T {
        let energy = self.then[i] * self.now[i];
        if energy > T::lit(1e-24) { self.cross[i] / energy.sqrt() } else { T::zero() }
    }

    fn find(&self) -> Option<T> {
        // A lag counts once it was looked at for a period of its own, and for LEAST_S at least.
        let usable = |lag: usize| {
            let looked_s = (f64::from(self.seen) - lag as f64) * self.step_s;
            looked_s >= LEAST_S && looked_s >= lag as f64 * self.step_s
        };
        let correlations: [T; LAGS] = core::array::from_fn(|i| self.correlation(i));
        let mut best = T::lit(REPEATS);
        for (i, &correlation) in correlations.iter().enumerate().take(LAGS - 1).skip(1) {
            if usable(i + SHORTEST) {
                best = best.max(correlation);
            }
        }
        (1..LAGS - 1).find_map(|i| {
            let (before, here, after) = (correlations[i - 1], correlations[i], correlations[i + 1]);
            let peak = here >= before && here > after;
            let good = here > T::lit(REPEATS) && here >= T::lit(AS_GOOD) * best;
            (usable(i + SHORTEST) && peak && good).then(|| {
                let bend = before - T::lit(2.0) * here + after;
                let offset = T::lit(0.5) * (before - after) / bend;
                (T::lit((i + SHORTEST) as f64) + offset) * T::lit(self.step_s)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.002;

    /// Harmonics 2 to 40 of a period, with the phases of a quadratic chirp.
    fn periodic(time_s: f64, period_s: f64) -> f64 {
        (2..40)
            .map(|k| (core::f64::consts::TAU * f64::from(k) * time_s / period_s + f64::from(k * k)).sin())
            .sum()
    }

    /// Uniform, from a linear congruential generator.
    fn noise(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }

    #[test]
    fn a_period_is_found_to_a_fraction_of_a_step() {
        for period_s in [0.31, 0.66, 0.6631, 1.5] {
            let mut search = PeriodSearch::<f64>::new(DT);
            let mut state = 7;
            let found = (0..5000).find_map(|i| {
                search.push(periodic(f64::from(i) * DT, period_s), noise(&mut state), || 2.0).map(|p| (p, i))
            });
            let (found_s, at) = found.unwrap();
            // The parabola through three lags of 10 ms; what is left the clock follows by itself.
            assert!((found_s - period_s).abs() < 1e-3, "{found_s} for {period_s}");
            // Two periods, or one and 0.6 s, and a look every tenth of a second.
            assert!(f64::from(at) * DT < 2.0 * period_s.max(1.0) + 0.3, "{at} for {period_s}");
        }
    }

    #[test]
    fn what_does_not_repeat_has_no_period() {
        let mut search = PeriodSearch::<f64>::new(DT);
        let mut state = 11;
        // Ten minutes, white over the whole band.
        assert!((0..300_000).all(|_| search.push(noise(&mut state), 0.0, || 0.0).is_none()));
    }
}
