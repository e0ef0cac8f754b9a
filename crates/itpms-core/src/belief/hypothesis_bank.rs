//! The belief about the car: a mixture of nine Gaussians, one for every way in which pressures may be changing now
//! (docs/math/shared-road.md, section 6). Moves on with time, is weighed by the constraint and by what others say.

use nalgebra::{SMatrix, SVector};

use crate::belief::gaussian::Hypothesis;
use crate::belief::mixture::Mixture;
use crate::belief::state::{RATE, State, TIRE};
use crate::belief::update::{Likelihood, OwnCovariance, score};
use crate::inter_axle::BINS;
use crate::inter_axle::residual::model::{AxleFrame, AxleResidual, Signals, Slope, Wheel, linearize};
use crate::inter_axle::residual::noise::Expectation;
use crate::model::Learned;
use crate::real::Real;

/// Nothing moves; each wheel loses pressure by itself; both of the left alike, or of the right; all four alike; any wheel wanders
/// either way.
pub(crate) const HYPOTHESES: usize = 9;
const CONSTANT: usize = 0;
const SIDE: usize = 5;
const ALL: usize = 7;
const RANDOM_WALK: usize = 8;
/// Chance per second that each begins.
const BEGIN: [f64; HYPOTHESES] = [0.0, 2e-4, 2e-4, 2e-4, 2e-4, 1e-6, 1e-6, 1e-6, 1e-8];
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
pub(crate) struct HypothesisBank<T: Real> {
    pub(crate) bank: [Hypothesis<T>; HYPOTHESES],
}

/// Whether compliances follow the rate in a mode.
fn has_rate(hypothesis: usize) -> bool {
    hypothesis != CONSTANT && hypothesis != RANDOM_WALK
}

/// How the compliances follow the rate in a mode.
pub(crate) fn changing<T: Real>(hypothesis: usize) -> [T; 4] {
    let changing = |i: usize| hypothesis == i + 1 || hypothesis == SIDE + i % 2 || hypothesis == ALL;
    core::array::from_fn(|i| if changing(i) { T::one() } else { T::zero() })
}

impl<T: Real> HypothesisBank<T> {
    /// What is believed at the start, the tires' compliances around `tires`.
    pub(crate) fn new(tires: &[T; 4]) -> Self {
        let start = Hypothesis::at_start(tires);
        let mut bank =
            Self { bank: core::array::from_fn(|hypothesis| start.with_onset(has_rate(hypothesis))) };
        bank.collapse();
        bank
    }

    /// The same in the place of what was believed.
    pub(crate) fn begin_again(&mut self, tires: &[T; 4]) {
        let start = Hypothesis::at_start(tires);
        for (index, hypothesis) in self.bank.iter_mut().enumerate() {
            *hypothesis = start.with_onset(has_rate(index));
        }
        self.collapse();
    }

    /// Moves on by `seconds`; `liveliness` multiplies the chances that one wheel, and that several, begin to move;
    /// `suspected` are chances per second that each wheel does that somebody else has reason to believe in.
    pub(crate) fn predict(&mut self, seconds: T, onset_scale: [T; 2], onset_rates: &[T; 4]) {
        self.mix(seconds, onset_scale, onset_rates);
        for (index, hypothesis) in self.bank.iter_mut().enumerate() {
            hypothesis.wander(seconds);
            if index == RANDOM_WALK {
                for i in 0..4 {
                    hypothesis.covariance[(TIRE + i, TIRE + i)] += T::lit(LOOSE_SD * LOOSE_SD) * seconds;
                }
            }
            if !has_rate(index) {
                continue;
            }
            hypothesis.covariance[(RATE, RATE)] += T::lit(RATE_WANDER * RATE_WANDER) * seconds;
            let changing = changing::<T>(index);
            for (i, &moved) in changing.iter().enumerate() {
                let by = moved * seconds;
                let change = by * hypothesis.mean[RATE];
                hypothesis.mean[TIRE + i] += change;
                let row = hypothesis.covariance.row(RATE) * by;
                let mut target = hypothesis.covariance.row_mut(TIRE + i);
                target += row;
                let column = hypothesis.covariance.column(RATE) * by;
                let mut target = hypothesis.covariance.column_mut(TIRE + i);
                target += column;
            }
        }
    }

    fn mix(&mut self, seconds: T, onset_scale: [T; 2], onset_rates: &[T; 4]) {
        let end = T::one() - (-T::lit(END) * seconds).exp();
        let mut begin = [T::zero(); HYPOTHESES];
        let mut stay = T::one();
        for hypothesis in 1..HYPOTHESES {
            begin[hypothesis] =
                T::lit(BEGIN[hypothesis]) * seconds * onset_scale[usize::from(hypothesis >= SIDE)];
            if hypothesis < SIDE {
                begin[hypothesis] += (onset_rates[hypothesis - 1] * seconds).min(T::lit(LARGEST_CHANCE));
            }
            stay -= begin[hypothesis];
        }
        // In place: a copy of all modes is more than a controller's stack has room for. The quiet mode comes last, as every
        // other begins from it, and single wheels after those that they join.
        let still = self.still(stay, end);
        for (hypothesis, &begin) in begin.iter().enumerate().skip(SIDE) {
            self.go_on(hypothesis, end, begin);
        }
        let [_, several] = onset_scale;
        for wheel in 0..4 {
            self.merge(wheel, T::lit(JOIN) * seconds * several);
        }
        for (hypothesis, &begin) in begin.iter().enumerate().take(SIDE).skip(1) {
            self.go_on(hypothesis, end, begin);
        }
        self.bank[CONSTANT] = still;
    }

    /// What moves no more: what did not and of which this share stays so, and of what did the share that ends.
    fn still(&self, stay: T, end: T) -> Hypothesis<T> {
        let mut still = Mixture::new();
        still.add(self.bank[CONSTANT].weight * stay, &self.bank[CONSTANT]);
        for changing in &self.bank[1..] {
            if changing.weight > T::lit(FORGOTTEN) {
                still.add(changing.weight * end, &changing.without_rate());
            }
        }
        still.into_hypothesis()
    }

    /// A movement goes on but for the share that ends, and by this chance what moved not begins to.
    fn go_on(&mut self, hypothesis: usize, end: T, begin: T) {
        let (constant, changing) = (&self.bank[CONSTANT], &self.bank[hypothesis]);
        let mut with_onset = constant.with_onset(has_rate(hypothesis));
        let stays = changing.weight * (T::one() - end);
        let begins = constant.weight * begin;
        // What nobody believes in is not followed.
        self.bank[hypothesis] = if stays > T::lit(FORGOTTEN) {
            let mut going = Mixture::new();
            going.add(stays, changing);
            going.add(begins, &with_onset);
            going.into_hypothesis()
        } else {
            with_onset.weight = begins;
            with_onset
        };
    }

    /// A wheel that loses pressure by itself is joined, by this chance, by the other one of its side.
    fn merge(&mut self, wheel: usize, chance: T) {
        let hypothesis = SIDE + wheel % 2;
        let (alone, both) = (&self.bank[wheel + 1], &self.bank[hypothesis]);
        let joins = alone.weight * chance;
        if joins > T::lit(NOTICED) * both.weight {
            let mut going = Mixture::new();
            going.add(both.weight, both);
            going.add(joins, &alone.without_rate().with_onset(has_rate(hypothesis)));
            self.bank[hypothesis] = going.into_hypothesis();
        }
    }

    /// Weighs the belief with a frame of one side. Returns what the most likely mode found, and what remained of it over
    /// what was expected, per bin.
    pub(crate) fn update_residual(
        &mut self,
        taken: &AxleFrame<T>,
        wheels: &[Wheel<T>; 2],
        side: usize,
        expected: &Expectation<T>,
        instrument: &Slope<T>,
        weight: T,
    ) -> Option<(AxleResidual<T>, [T; BINS])> {
        let best = self.most_likely();
        let mut kept = None;
        let mut log_weight = [T::zero(); HYPOTHESES];
        for (index, hypothesis) in self.bank.iter_mut().enumerate() {
            let found = linearize(taken, Signals::Measured, wheels, side, &hypothesis.mean);
            let own = OwnCovariance::new(&hypothesis.covariance, side);
            let Some(likelihood) = Likelihood::new(&own, &found, expected) else {
                log_weight[index] = T::lit(IMPOSSIBLE);
                continue;
            };
            log_weight[index] = weight * likelihood.log;
            let score = score(&found, instrument, expected);
            own.learn(hypothesis, &score, &expected.information, &likelihood, weight);
            if index == best {
                kept = Some((found, likelihood.ratio));
            }
        }
        self.reweigh(&log_weight);
        kept
    }

    /// A measured number with its variance: `linearise` gives, for a state, its derivatives and how much more it is than
    /// expected. Says nothing about which mode holds.
    pub(crate) fn update(&mut self, variance: T, linearise: impl Fn(&State<T>) -> (State<T>, T)) {
        for hypothesis in &mut self.bank {
            let (slope, innovation) = linearise(&hypothesis.mean);
            let spread = hypothesis.covariance * slope;
            let total = slope.dot(&spread) + variance;
            if !(total > T::zero()) {
                continue;
            }
            hypothesis.mean += spread * (innovation / total);
            hypothesis.covariance -= spread * spread.transpose() / total;
            hypothesis.symmetrize();
        }
    }

    /// The same of a number that also says how likely each mode is.
    pub(crate) fn update_reweighted(&mut self, variance: T, linearise: impl Fn(&State<T>) -> (State<T>, T)) {
        let mut log_weight = [T::zero(); HYPOTHESES];
        for (hypothesis, log) in self.bank.iter().zip(&mut log_weight) {
            let (slope, innovation) = linearise(&hypothesis.mean);
            let total = slope.dot(&(hypothesis.covariance * slope)) + variance;
            let tails = T::lit(WORD_TAILS);
            let mahalanobis_sq = innovation * innovation / total;
            *log =
                T::lit(-0.5) * (total.ln() + (tails + T::one()) * (T::one() + mahalanobis_sq / tails).ln());
        }
        self.update(variance, linearise);
        self.reweigh(&log_weight);
    }

    fn reweigh(&mut self, log_weight: &[T; HYPOTHESES]) {
        let mut largest = T::lit(f64::NEG_INFINITY);
        for (hypothesis, &log) in self.bank.iter().zip(log_weight) {
            if hypothesis.weight > T::zero() {
                largest = largest.max(log);
            }
        }
        let mut total = T::zero();
        for (hypothesis, &log) in self.bank.iter_mut().zip(log_weight) {
            hypothesis.weight *= (log - largest).exp();
            total += hypothesis.weight;
        }
        if total > T::zero() && total.is_finite() {
            self.bank.iter_mut().for_each(|hypothesis| hypothesis.weight /= total);
        }
    }

    pub(crate) fn most_likely(&self) -> usize {
        (1..HYPOTHESES)
            .fold(CONSTANT, |best, i| if self.bank[i].weight > self.bank[best].weight { i } else { best })
    }

    /// The belief about a tire fades with seconds of incoherence; less so if a reset has `taught` what the car is.
    pub(crate) fn inflate(&mut self, corner: usize, incoherent_s: T, calibrated: bool) {
        let sd = if calibrated { FADING_TAUGHT } else { FADING };
        for hypothesis in &mut self.bank {
            hypothesis.covariance[(TIRE + corner, TIRE + corner)] += T::lit(sd * sd) * incoherent_s;
        }
    }

    /// Mean and sd of every quantity while nothing moves.
    pub(crate) fn constant(&self) -> (State<T>, State<T>) {
        let hypothesis = &self.bank[CONSTANT];
        (hypothesis.mean, hypothesis.covariance.diagonal().map(|variance| variance.max(T::zero()).sqrt()))
    }

    /// Begins with a quantity as it was learned before, its sd at least `least`; `unit` is the state's in that quantity.
    pub(crate) fn begin_with(&mut self, at: usize, learned: &Learned<T>, least: T, unit: T) {
        let sd = learned.sd.max(least) / unit;
        for hypothesis in &mut self.bank {
            hypothesis.mean[at] = learned.value / unit;
            hypothesis.covariance.row_mut(at).fill(T::zero());
            hypothesis.covariance.column_mut(at).fill(T::zero());
            hypothesis.covariance[(at, at)] = sd * sd;
        }
    }

    /// A tire may have been changed: its compliance has this much more sd.
    pub(crate) fn forget_tire(&mut self, corner: usize, sd: T) {
        for hypothesis in &mut self.bank {
            hypothesis.covariance[(TIRE + corner, TIRE + corner)] += sd * sd;
        }
    }

    /// All tires may have become warmer or colder together: their compliances have so much more sd in common.
    pub(crate) fn change_temperature(&mut self, sd: &[T; 4]) {
        for hypothesis in &mut self.bank {
            for i in 0..4 {
                for j in 0..4 {
                    hypothesis.covariance[(TIRE + i, TIRE + j)] += sd[i] * sd[j];
                }
            }
        }
    }

    /// All modes as one Gaussian, in which nothing moves.
    pub(crate) fn as_one(&self) -> Hypothesis<T> {
        let mut one = Mixture::new();
        for hypothesis in &self.bank {
            one.add(hypothesis.weight, &hypothesis.without_rate());
        }
        one.into_hypothesis()
    }

    /// Believes this and nothing else.
    pub(crate) fn set(&mut self, belief: &Hypothesis<T>) {
        self.bank[CONSTANT] = belief.clone();
        self.collapse();
    }

    /// Moves on by `seconds` in which nobody watched: nothing moves any more. `filled`: somebody may have changed a
    /// pressure.
    pub(crate) fn predict_gap(&mut self, seconds: T, filled: bool) {
        self.collapse();
        let constant = &mut self.bank[CONSTANT];
        constant.wander(seconds);
        if filled {
            let chance = T::lit(FILLED);
            let mut loose = constant.clone();
            for i in TIRE..TIRE + 4 {
                loose.covariance[(i, i)] += T::lit(FILLED_SD * FILLED_SD);
            }
            loose.weight = chance;
            constant.weight = T::one() - chance;
            self.bank[RANDOM_WALK] = loose;
        }
    }

    /// HypothesisBank in which a tire is what no tire can be are not followed. A tire of the quiet one is never softer than flat; what
    /// else is wrong with that one is left for [`HypothesisBank::is_sound`]. `softest`: each tire's compliance when flat.
    pub(crate) fn drop_impossible(&mut self, softest: &[T; 4]) {
        self.bank[CONSTANT].stop_at(softest);
        let mut total = T::zero();
        for (index, hypothesis) in self.bank.iter_mut().enumerate() {
            // Tires do not fill themselves, and nobody else fills several at once while they roll.
            let filling = (SIDE..=ALL).contains(&index) && !(hypothesis.mean[RATE] >= T::zero());
            if filling || !hypothesis.is_possible(softest) {
                hypothesis.weight = T::zero();
            }
            total += hypothesis.weight;
        }
        if total > T::zero() {
            self.bank.iter_mut().for_each(|hypothesis| hypothesis.weight /= total);
        }
    }

    /// Only the quiet mode is left: somebody knows that nothing moves.
    pub(crate) fn collapse(&mut self) {
        for hypothesis in &mut self.bank[1..] {
            hypothesis.weight = T::zero();
        }
        self.bank[CONSTANT].weight = T::one();
    }

    /// Mean and covariance of the tires' compliances, each so many seconds after what is believed of it, all modes together.
    pub(crate) fn tires(&self, age_s: &[T; 4]) -> (SVector<T, 4>, SMatrix<T, 4, 4>) {
        let mut mean = SVector::<T, 4>::zeros();
        let mut square = SMatrix::<T, 4, 4>::zeros();
        for (index, hypothesis) in self.bank.iter().enumerate() {
            let changing = changing::<T>(index);
            let by: [T; 4] = core::array::from_fn(|i| changing[i] * age_s[i]);
            let z =
                SVector::<T, 4>::from_fn(|i, _| hypothesis.mean[TIRE + i] + by[i] * hypothesis.mean[RATE]);
            let p = SMatrix::<T, 4, 4>::from_fn(|i, j| {
                let c = |a: usize, b: usize| hypothesis.covariance[(a, b)];
                c(TIRE + i, TIRE + j)
                    + by[i] * c(RATE, TIRE + j)
                    + by[j] * c(RATE, TIRE + i)
                    + by[i] * by[j] * c(RATE, RATE)
            });
            mean += z * hypothesis.weight;
            square += (p + z * z.transpose()) * hypothesis.weight;
        }
        (mean, square - mean * mean.transpose())
    }

    /// Mean and variance of one quantity, all modes together.
    pub(crate) fn quantity(&self, at: usize) -> (T, T) {
        let (mut mean, mut square) = (T::zero(), T::zero());
        for hypothesis in &self.bank {
            mean += hypothesis.weight * hypothesis.mean[at];
            square += hypothesis.weight
                * (hypothesis.covariance[(at, at)] + hypothesis.mean[at] * hypothesis.mean[at]);
        }
        (mean, square - mean * mean)
    }

    /// Probability that each tire moves.
    pub(crate) fn changing_tires(&self) -> [T; 4] {
        let several = self.bank[ALL].weight + self.bank[RANDOM_WALK].weight;
        core::array::from_fn(|i| self.bank[i + 1].weight + self.bank[SIDE + i % 2].weight + several)
    }

    /// Probability that anything moves.
    pub(crate) fn changing(&self) -> T {
        self.bank[1..].iter().fold(T::zero(), |sum, hypothesis| sum + hypothesis.weight)
    }

    pub(crate) fn is_sound(&self, softest: &[T; 4]) -> bool {
        let finite = |hypothesis: &Hypothesis<T>| {
            hypothesis.weight >= T::zero()
                && hypothesis.mean.iter().all(|x| x.is_finite())
                && hypothesis.covariance.iter().all(|x| x.is_finite())
        };
        self.bank.iter().all(finite) && self.bank[CONSTANT].is_possible(softest)
    }
}
