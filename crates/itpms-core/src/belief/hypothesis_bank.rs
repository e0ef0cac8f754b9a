//! The belief about the car: a mixture of nine Gaussians, one for every way in which pressures may be changing now
//! (docs/math/shared-road.md, section 6). Moves on with time, is weighed by the constraint and by what others say.

use nalgebra::{SMatrix, SVector};

use crate::belief::gaussian::Mode;
use crate::belief::mixture::Mixture;
use crate::belief::state::{RATE, State, TIRE};
use crate::belief::update::{Likelihood, OwnCovariance, score};
use crate::inter_axle::BINS;
use crate::inter_axle::residual::model::{Disagreement, Signals, Slope, TrackFrame, Wheel, compare};
use crate::inter_axle::residual::noise::Expectation;
use crate::model::Learned;
use crate::real::Real;

/// Nothing moves; each wheel loses pressure by itself; both of the left alike, or of the right; all four alike; any wheel wanders
/// either way.
pub(crate) const MODES: usize = 9;
const QUIET: usize = 0;
const SIDE: usize = 5;
const ALL: usize = 7;
const LOOSE: usize = 8;
/// Chance per second that each begins.
const BEGIN: [f64; MODES] = [0.0, 2e-4, 2e-4, 2e-4, 2e-4, 1e-6, 1e-6, 1e-6, 1e-8];
/// Chance per second that a wheel which loses pressure is joined by the other one of its side: a kerb meets both. Share of the
/// side's own weight below which that is not looked at.
const JOIN: f64 = 1e-2;
const NOTICED: f64 = 1e-3;
/// Chance per second that a movement ends.
const END: f64 = 0.5;
/// Growth of the rate's sd per square root of a second.
const RATE_WANDER: f64 = 0.1;
/// Growth per square root of a second of each compliance's sd while wheels wander.
const LOOSE_SD: f64 = 0.06;
/// Chance that a tire was filled or let down during a stop, and the sd of its compliance then.
const FILLED: f64 = 1e-3;
const FILLED_SD: f64 = 0.15;
/// Log-likelihood of a mode that cannot say how likely a frame is.
const IMPOSSIBLE: f64 = -1e6;
/// Growth of a compliance's sd per square root of a second of incoherence, as far as it is believed: as long as the car is known
/// from its file only, and once a reset has taught what it is.
const FADING: f64 = 0.03;
const FADING_TAUGHT: f64 = 0.01;
/// Weight below which a mode begins anew.
const FORGOTTEN: f64 = 1e-20;
/// Degrees of freedom of a word's distribution: how heavy its tails are.
const WORD_TAILS: f64 = 4.0;
/// Largest chance of a step that a suspected wheel begins to move.
const LARGEST_CHANCE: f64 = 0.2;

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(crate) struct Modes<T: Real> {
    pub(crate) modes: [Mode<T>; MODES],
}

/// Whether compliances follow the rate in a mode.
fn has_rate(mode: usize) -> bool {
    mode != QUIET && mode != LOOSE
}

/// How the compliances follow the rate in a mode.
pub(crate) fn moves<T: Real>(mode: usize) -> [T; 4] {
    let moves = |i: usize| mode == i + 1 || mode == SIDE + i % 2 || mode == ALL;
    core::array::from_fn(|i| if moves(i) { T::one() } else { T::zero() })
}

impl<T: Real> Modes<T> {
    /// What is believed at the start, the tires' compliances around `tires`.
    pub(crate) fn new(tires: &[T; 4]) -> Self {
        let start = Mode::at_start(tires);
        let mut modes = Self { modes: core::array::from_fn(|mode| start.begun(has_rate(mode))) };
        modes.calm();
        modes
    }

    /// The same in the place of what was believed.
    pub(crate) fn begin_again(&mut self, tires: &[T; 4]) {
        let start = Mode::at_start(tires);
        for (index, mode) in self.modes.iter_mut().enumerate() {
            *mode = start.begun(has_rate(index));
        }
        self.calm();
    }

    /// Moves on by `seconds`; `liveliness` multiplies the chances that one wheel, and that several, begin to move;
    /// `suspected` are chances per second that each wheel does that somebody else has reason to believe in.
    pub(crate) fn predict(&mut self, seconds: T, liveliness: [T; 2], suspected: &[T; 4]) {
        self.mix(seconds, liveliness, suspected);
        for (index, mode) in self.modes.iter_mut().enumerate() {
            mode.wander(seconds);
            if index == LOOSE {
                for i in 0..4 {
                    mode.covariance[(TIRE + i, TIRE + i)] += T::lit(LOOSE_SD * LOOSE_SD) * seconds;
                }
            }
            if !has_rate(index) {
                continue;
            }
            mode.covariance[(RATE, RATE)] += T::lit(RATE_WANDER * RATE_WANDER) * seconds;
            let moves = moves::<T>(index);
            for (i, &moved) in moves.iter().enumerate() {
                let by = moved * seconds;
                let change = by * mode.mean[RATE];
                mode.mean[TIRE + i] += change;
                let row = mode.covariance.row(RATE) * by;
                let mut target = mode.covariance.row_mut(TIRE + i);
                target += row;
                let column = mode.covariance.column(RATE) * by;
                let mut target = mode.covariance.column_mut(TIRE + i);
                target += column;
            }
        }
    }

    fn mix(&mut self, seconds: T, liveliness: [T; 2], suspected: &[T; 4]) {
        let end = T::one() - (-T::lit(END) * seconds).exp();
        let mut begin = [T::zero(); MODES];
        let mut stay = T::one();
        for mode in 1..MODES {
            begin[mode] = T::lit(BEGIN[mode]) * seconds * liveliness[usize::from(mode >= SIDE)];
            if mode < SIDE {
                begin[mode] += (suspected[mode - 1] * seconds).min(T::lit(LARGEST_CHANCE));
            }
            stay -= begin[mode];
        }
        // In place: a copy of all modes is more than a controller's stack has room for. The quiet mode comes last, as every
        // other begins from it, and single wheels after those that they join.
        let still = self.still(stay, end);
        for (mode, &begin) in begin.iter().enumerate().skip(SIDE) {
            self.go_on(mode, end, begin);
        }
        let [_, several] = liveliness;
        for wheel in 0..4 {
            self.join(wheel, T::lit(JOIN) * seconds * several);
        }
        for (mode, &begin) in begin.iter().enumerate().take(SIDE).skip(1) {
            self.go_on(mode, end, begin);
        }
        self.modes[QUIET] = still;
    }

    /// What moves no more: what did not and of which this share stays so, and of what did the share that ends.
    fn still(&self, stay: T, end: T) -> Mode<T> {
        let mut still = Mixture::new();
        still.add(self.modes[QUIET].weight * stay, &self.modes[QUIET]);
        for moving in &self.modes[1..] {
            if moving.weight > T::lit(FORGOTTEN) {
                still.add(moving.weight * end, &moving.ended());
            }
        }
        still.into_mode()
    }

    /// A movement goes on but for the share that ends, and by this chance what moved not begins to.
    fn go_on(&mut self, mode: usize, end: T, begin: T) {
        let (quiet, moving) = (&self.modes[QUIET], &self.modes[mode]);
        let mut begun = quiet.begun(has_rate(mode));
        let stays = moving.weight * (T::one() - end);
        let begins = quiet.weight * begin;
        // What nobody believes in is not followed.
        self.modes[mode] = if stays > T::lit(FORGOTTEN) {
            let mut going = Mixture::new();
            going.add(stays, moving);
            going.add(begins, &begun);
            going.into_mode()
        } else {
            begun.weight = begins;
            begun
        };
    }

    /// A wheel that loses pressure by itself is joined, by this chance, by the other one of its side.
    fn join(&mut self, wheel: usize, chance: T) {
        let mode = SIDE + wheel % 2;
        let (alone, both) = (&self.modes[wheel + 1], &self.modes[mode]);
        let joins = alone.weight * chance;
        if joins > T::lit(NOTICED) * both.weight {
            let mut going = Mixture::new();
            going.add(both.weight, both);
            going.add(joins, &alone.ended().begun(has_rate(mode)));
            self.modes[mode] = going.into_mode();
        }
    }

    /// Weighs the belief with a frame of one side. Returns what the most likely mode found, and what remained of it over
    /// what was expected, per bin.
    pub(crate) fn weigh(
        &mut self,
        taken: &TrackFrame<T>,
        wheels: &[Wheel<T>; 2],
        side: usize,
        expected: &Expectation<T>,
        instrument: &Slope<T>,
        trust: T,
    ) -> Option<(Disagreement<T>, [T; BINS])> {
        let best = self.most_likely();
        let mut kept = None;
        let mut log_weight = [T::zero(); MODES];
        for (index, mode) in self.modes.iter_mut().enumerate() {
            let found = compare(taken, Signals::Measured, wheels, side, &mode.mean);
            let own = OwnCovariance::new(&mode.covariance, side);
            let Some(likelihood) = Likelihood::new(&own, &found, expected) else {
                log_weight[index] = T::lit(IMPOSSIBLE);
                continue;
            };
            log_weight[index] = trust * likelihood.log;
            let score = score(&found, instrument, expected);
            own.learn(mode, &score, &expected.information, &likelihood, trust);
            if index == best {
                kept = Some((found, likelihood.ratio));
            }
        }
        self.reweigh(&log_weight);
        kept
    }

    /// A measured number with its variance: `linearise` gives, for a state, its derivatives and how much more it is than
    /// expected. Says nothing about which mode holds.
    pub(crate) fn measure(&mut self, variance: T, linearise: impl Fn(&State<T>) -> (State<T>, T)) {
        for mode in &mut self.modes {
            let (slope, innovation) = linearise(&mode.mean);
            let spread = mode.covariance * slope;
            let total = slope.dot(&spread) + variance;
            if !(total > T::zero()) {
                continue;
            }
            mode.mean += spread * (innovation / total);
            mode.covariance -= spread * spread.transpose() / total;
            mode.tidy();
        }
    }

    /// The same of a number that also says how likely each mode is.
    pub(crate) fn hear(&mut self, variance: T, linearise: impl Fn(&State<T>) -> (State<T>, T)) {
        let mut log_weight = [T::zero(); MODES];
        for (mode, log) in self.modes.iter().zip(&mut log_weight) {
            let (slope, innovation) = linearise(&mode.mean);
            let total = slope.dot(&(mode.covariance * slope)) + variance;
            let tails = T::lit(WORD_TAILS);
            let surprise = innovation * innovation / total;
            *log = T::lit(-0.5) * (total.ln() + (tails + T::one()) * (T::one() + surprise / tails).ln());
        }
        self.measure(variance, linearise);
        self.reweigh(&log_weight);
    }

    fn reweigh(&mut self, log_weight: &[T; MODES]) {
        let mut largest = T::lit(f64::NEG_INFINITY);
        for (mode, &log) in self.modes.iter().zip(log_weight) {
            if mode.weight > T::zero() {
                largest = largest.max(log);
            }
        }
        let mut total = T::zero();
        for (mode, &log) in self.modes.iter_mut().zip(log_weight) {
            mode.weight *= (log - largest).exp();
            total += mode.weight;
        }
        if total > T::zero() && total.is_finite() {
            self.modes.iter_mut().for_each(|mode| mode.weight /= total);
        }
    }

    pub(crate) fn most_likely(&self) -> usize {
        (1..MODES)
            .fold(QUIET, |best, i| if self.modes[i].weight > self.modes[best].weight { i } else { best })
    }

    /// The belief about a tire fades with seconds of incoherence; less so if a reset has `taught` what the car is.
    pub(crate) fn doubt(&mut self, corner: usize, incoherent_s: T, taught: bool) {
        let sd = if taught { FADING_TAUGHT } else { FADING };
        for mode in &mut self.modes {
            mode.covariance[(TIRE + corner, TIRE + corner)] += T::lit(sd * sd) * incoherent_s;
        }
    }

    /// Mean and sd of every quantity while nothing moves.
    pub(crate) fn quiet(&self) -> (State<T>, State<T>) {
        let mode = &self.modes[QUIET];
        (mode.mean, mode.covariance.diagonal().map(|variance| variance.max(T::zero()).sqrt()))
    }

    /// Begins with a quantity as it was learned before, its sd at least `least`; `unit` is the state's in that quantity.
    pub(crate) fn begin_with(&mut self, at: usize, learned: &Learned<T>, least: T, unit: T) {
        let sd = learned.sd.max(least) / unit;
        for mode in &mut self.modes {
            mode.mean[at] = learned.value / unit;
            mode.covariance.row_mut(at).fill(T::zero());
            mode.covariance.column_mut(at).fill(T::zero());
            mode.covariance[(at, at)] = sd * sd;
        }
    }

    /// A tire may have been changed: its compliance has this much more sd.
    pub(crate) fn forget_tire(&mut self, corner: usize, sd: T) {
        for mode in &mut self.modes {
            mode.covariance[(TIRE + corner, TIRE + corner)] += sd * sd;
        }
    }

    /// All tires may have become warmer or colder together: their compliances have so much more sd in common.
    pub(crate) fn change_temperature(&mut self, sd: &[T; 4]) {
        for mode in &mut self.modes {
            for i in 0..4 {
                for j in 0..4 {
                    mode.covariance[(TIRE + i, TIRE + j)] += sd[i] * sd[j];
                }
            }
        }
    }

    /// All modes as one Gaussian, in which nothing moves.
    pub(crate) fn as_one(&self) -> Mode<T> {
        let mut one = Mixture::new();
        for mode in &self.modes {
            one.add(mode.weight, &mode.ended());
        }
        one.into_mode()
    }

    /// Believes this and nothing else.
    pub(crate) fn set(&mut self, belief: &Mode<T>) {
        self.modes[QUIET] = belief.clone();
        self.calm();
    }

    /// Moves on by `seconds` in which nobody watched: nothing moves any more. `filled`: somebody may have changed a
    /// pressure.
    pub(crate) fn wake(&mut self, seconds: T, filled: bool) {
        self.calm();
        let quiet = &mut self.modes[QUIET];
        quiet.wander(seconds);
        if filled {
            let chance = T::lit(FILLED);
            let mut loose = quiet.clone();
            for i in TIRE..TIRE + 4 {
                loose.covariance[(i, i)] += T::lit(FILLED_SD * FILLED_SD);
            }
            loose.weight = chance;
            quiet.weight = T::one() - chance;
            self.modes[LOOSE] = loose;
        }
    }

    /// Modes in which a tire is what no tire can be are not followed. A tire of the quiet one is never softer than flat; what
    /// else is wrong with that one is left for [`Modes::is_sound`]. `softest`: each tire's compliance when flat.
    pub(crate) fn drop_impossible(&mut self, softest: &[T; 4]) {
        self.modes[QUIET].stop_at(softest);
        let mut total = T::zero();
        for (index, mode) in self.modes.iter_mut().enumerate() {
            // Tires do not fill themselves, and nobody else fills several at once while they roll.
            let filling = (SIDE..=ALL).contains(&index) && !(mode.mean[RATE] >= T::zero());
            if filling || !mode.is_possible(softest) {
                mode.weight = T::zero();
            }
            total += mode.weight;
        }
        if total > T::zero() {
            self.modes.iter_mut().for_each(|mode| mode.weight /= total);
        }
    }

    /// Only the quiet mode is left: somebody knows that nothing moves.
    pub(crate) fn calm(&mut self) {
        for mode in &mut self.modes[1..] {
            mode.weight = T::zero();
        }
        self.modes[QUIET].weight = T::one();
    }

    /// Mean and covariance of the tires' compliances, each so many seconds after what is believed of it, all modes together.
    pub(crate) fn tires(&self, age_s: &[T; 4]) -> (SVector<T, 4>, SMatrix<T, 4, 4>) {
        let mut mean = SVector::<T, 4>::zeros();
        let mut square = SMatrix::<T, 4, 4>::zeros();
        for (index, mode) in self.modes.iter().enumerate() {
            let moves = moves::<T>(index);
            let by: [T; 4] = core::array::from_fn(|i| moves[i] * age_s[i]);
            let z = SVector::<T, 4>::from_fn(|i, _| mode.mean[TIRE + i] + by[i] * mode.mean[RATE]);
            let p = SMatrix::<T, 4, 4>::from_fn(|i, j| {
                let c = |a: usize, b: usize| mode.covariance[(a, b)];
                c(TIRE + i, TIRE + j)
                    + by[i] * c(RATE, TIRE + j)
                    + by[j] * c(RATE, TIRE + i)
                    + by[i] * by[j] * c(RATE, RATE)
            });
            mean += z * mode.weight;
            square += (p + z * z.transpose()) * mode.weight;
        }
        (mean, square - mean * mean.transpose())
    }

    /// Mean and variance of one quantity, all modes together.
    pub(crate) fn quantity(&self, at: usize) -> (T, T) {
        let (mut mean, mut square) = (T::zero(), T::zero());
        for mode in &self.modes {
            mean += mode.weight * mode.mean[at];
            square += mode.weight * (mode.covariance[(at, at)] + mode.mean[at] * mode.mean[at]);
        }
        (mean, square - mean * mean)
    }

    /// Probability that each tire moves.
    pub(crate) fn moving_tires(&self) -> [T; 4] {
        let several = self.modes[ALL].weight + self.modes[LOOSE].weight;
        core::array::from_fn(|i| self.modes[i + 1].weight + self.modes[SIDE + i % 2].weight + several)
    }

    /// Probability that anything moves.
    pub(crate) fn moving(&self) -> T {
        self.modes[1..].iter().fold(T::zero(), |sum, mode| sum + mode.weight)
    }

    pub(crate) fn is_sound(&self, softest: &[T; 4]) -> bool {
        let finite = |mode: &Mode<T>| {
            mode.weight >= T::zero()
                && mode.mean.iter().all(|x| x.is_finite())
                && mode.covariance.iter().all(|x| x.is_finite())
        };
        self.modes.iter().all(finite) && self.modes[QUIET].is_possible(softest)
    }
}
