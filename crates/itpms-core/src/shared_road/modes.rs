//! The belief about the car: a mixture of six Gaussians, one for every way in which pressures may be changing now
//! (docs/math/shared-road.md, section 4). Moves on with time, is weighed by the constraint and by what others say.

use nalgebra::{SMatrix, SVector};

use super::coherence::Expectation;
use super::constraint::{
    Disagreement, FRONT_TIRE, Gram, OWN, ROWS, Score, TrackFrame, Wheel, compare, places,
};
use super::parameters::{Covariance, RATE, SIZE, State, TIRE, prior_sd, wander_sd};
use super::{BINS, OVERLAP};
use crate::real::Real;

/// Nothing moves; each wheel by itself; all four alike.
pub(super) const MODES: usize = 6;
const QUIET: usize = 0;
const ALL: usize = 5;
/// Chance per second that a wheel, or all four, begin to move.
const BEGIN: [f64; MODES] = [0.0, 2e-4, 2e-4, 2e-4, 2e-4, 2e-5];
/// Chance per second that a movement ends.
const END: f64 = 0.5;
/// Sd of a new movement's rate in 1/s, and its growth per square root of a second: the compliance of a tire that loses
/// 40 kPa/s changes by 0.15/s.
const RATE_SD: f64 = 0.13;
const RATE_WANDER: f64 = 0.06;
/// Degrees of freedom of the disagreement's distribution: how heavy its tails are.
const TAILS: f64 = 8.0;

/// One of the six.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(super) struct Mode<T: Real> {
    pub(super) mean: State<T>,
    pub(super) covariance: Covariance<T>,
    pub(super) weight: T,
}

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
pub(super) struct Modes<T: Real> {
    pub(super) modes: [Mode<T>; MODES],
}

/// How the compliances follow the rate in a mode.
pub(super) fn moves<T: Real>(mode: usize) -> [T; 4] {
    core::array::from_fn(|i| if mode == ALL || mode == i + 1 { T::one() } else { T::zero() })
}

impl<T: Real> Modes<T> {
    pub(super) fn new() -> Self {
        let sd = prior_sd::<T>();
        let covariance = Covariance::from_diagonal(&sd.component_mul(&sd));
        let modes = core::array::from_fn(|mode| {
            let mut covariance = covariance;
            if mode != QUIET {
                covariance[(RATE, RATE)] = T::lit(RATE_SD * RATE_SD);
            }
            let weight = if mode == QUIET { T::one() } else { T::zero() };
            Mode { mean: State::zeros(), covariance, weight }
        });
        Self { modes }
    }

    /// Moves on by `seconds`; `liveliness` multiplies the chance that a movement begins.
    pub(super) fn predict(&mut self, seconds: T, liveliness: T) {
        self.mix(seconds, liveliness);
        let wander = wander_sd::<T>();
        for (index, mode) in self.modes.iter_mut().enumerate() {
            for i in 0..SIZE {
                mode.covariance[(i, i)] += wander[i] * wander[i] * seconds;
            }
            if index == QUIET {
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

    fn mix(&mut self, seconds: T, liveliness: T) {
        let end = T::one() - (-T::lit(END) * seconds).exp();
        let mut begin = [T::zero(); MODES];
        let mut stay = T::one();
        for mode in 1..MODES {
            begin[mode] = T::lit(BEGIN[mode]) * seconds * liveliness;
            stay -= begin[mode];
        }
        let old = self.modes.clone();
        let quiet = &old[QUIET];
        let mut still = Mixture::new();
        still.add(quiet.weight * stay, &quiet.mean, &quiet.covariance);
        for (mode, moving) in old.iter().enumerate().skip(1) {
            let mut ended = moving.clone();
            ended.mean[RATE] = T::zero();
            ended.covariance.row_mut(RATE).fill(T::zero());
            ended.covariance.column_mut(RATE).fill(T::zero());
            still.add(moving.weight * end, &ended.mean, &ended.covariance);

            let mut begun = quiet.covariance;
            begun[(RATE, RATE)] = T::lit(RATE_SD * RATE_SD);
            let mut going = Mixture::new();
            going.add(moving.weight * (T::one() - end), &moving.mean, &moving.covariance);
            going.add(quiet.weight * begin[mode], &quiet.mean, &begun);
            self.modes[mode] = going.into_mode();
        }
        self.modes[QUIET] = still.into_mode();
    }

    /// Weighs the belief with a frame of one side. Returns what the most likely mode found, and what remained of it over
    /// what was expected, per bin.
    pub(super) fn weigh(
        &mut self,
        taken: &TrackFrame<T>,
        wheels: &[Wheel<T>; 2],
        side: usize,
        expected: &Expectation<T>,
    ) -> Option<(Disagreement<T>, [T; BINS])> {
        let best = self.most_likely();
        let mut kept = None;
        let mut log_weight = [T::zero(); MODES];
        for (index, mode) in self.modes.iter_mut().enumerate() {
            let moves = moves(index);
            let found = compare(taken, wheels, side, &mode.mean, &moves);
            let by_rate = -moves[wheels[0].corner] * taken.delay_s;
            let own = OwnCovariance::new(&mode.covariance, side, by_rate);
            let likelihood = Likelihood::new(&own, &found, expected)?;
            log_weight[index] = likelihood.log;
            if let Some(worth) = &expected.worth {
                own.learn(mode, &likelihood.score(&found, expected), worth, likelihood.scale);
            }
            if index == best {
                kept = Some((found, likelihood.ratio));
            }
        }
        if expected.worth.is_some() {
            self.reweigh(&log_weight);
        }
        kept
    }

    /// A measured number: `slope . state + offset`, that is `value`, with its variance; linearised for every mode.
    pub(super) fn measure(&mut self, variance: T, linearise: impl Fn(&State<T>) -> (State<T>, T)) {
        let mut log_weight = [T::zero(); MODES];
        for (mode, log_weight) in self.modes.iter_mut().zip(&mut log_weight) {
            let (slope, innovation) = linearise(&mode.mean);
            let spread = mode.covariance * slope;
            let total = slope.dot(&spread) + variance;
            if !(total > T::zero()) {
                continue;
            }
            mode.mean += spread * (innovation / total);
            mode.covariance -= spread * spread.transpose() / total;
            mode.tidy();
            *log_weight = T::lit(-0.5) * (innovation * innovation / total + total.ln());
        }
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

    pub(super) fn most_likely(&self) -> usize {
        (1..MODES)
            .fold(QUIET, |best, i| if self.modes[i].weight > self.modes[best].weight { i } else { best })
    }

    /// Only the quiet mode is left: somebody knows that nothing moves.
    pub(super) fn calm(&mut self) {
        for mode in &mut self.modes[1..] {
            mode.weight = T::zero();
        }
        self.modes[QUIET].weight = T::one();
    }

    /// Mean and covariance of the tires' compliances `age_s` after the last frame's middle, all modes together.
    pub(super) fn tires(&self, age_s: T) -> (SVector<T, 4>, SMatrix<T, 4, 4>) {
        let mut mean = SVector::<T, 4>::zeros();
        let mut square = SMatrix::<T, 4, 4>::zeros();
        for (index, mode) in self.modes.iter().enumerate() {
            let by = moves::<T>(index).map(|m| m * age_s);
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
    pub(super) fn quantity(&self, at: usize) -> (T, T) {
        let (mut mean, mut square) = (T::zero(), T::zero());
        for mode in &self.modes {
            mean += mode.weight * mode.mean[at];
            square += mode.weight * (mode.covariance[(at, at)] + mode.mean[at] * mode.mean[at]);
        }
        (mean, square - mean * mean)
    }

    /// Probability that anything moves.
    pub(super) fn moving(&self) -> T {
        self.modes[1..].iter().fold(T::zero(), |sum, mode| sum + mode.weight)
    }

    pub(super) fn is_sound(&self) -> bool {
        self.modes.iter().all(|mode| {
            mode.weight >= T::zero()
                && mode.mean.iter().all(|x| x.is_finite())
                && mode.covariance.iter().all(|x| x.is_finite())
        })
    }
}

impl<T: Real> Mode<T> {
    /// Rounding leaves a covariance neither symmetric nor quite positive.
    fn tidy(&mut self) {
        for i in 0..SIZE {
            for j in 0..i {
                let mean = T::lit(0.5) * (self.covariance[(i, j)] + self.covariance[(j, i)]);
                self.covariance[(i, j)] = mean;
                self.covariance[(j, i)] = mean;
            }
            self.covariance[(i, i)] = self.covariance[(i, i)].max(T::zero());
        }
    }
}

/// Gaussians added up to one.
struct Mixture<T: Real> {
    weight: T,
    sum: State<T>,
    square: Covariance<T>,
    /// The first one's mean, around which squares are taken.
    around: Option<State<T>>,
}

impl<T: Real> Mixture<T> {
    fn new() -> Self {
        Self { weight: T::zero(), sum: State::zeros(), square: Covariance::zeros(), around: None }
    }

    fn add(&mut self, weight: T, mean: &State<T>, covariance: &Covariance<T>) {
        let around = *self.around.get_or_insert(*mean);
        let off = mean - around;
        // A weight of nothing still has to leave a usable Gaussian.
        let weight = weight.max(T::lit(1e-30));
        self.weight += weight;
        self.sum += off * weight;
        self.square += (covariance + off * off.transpose()) * weight;
    }

    fn into_mode(self) -> Mode<T> {
        let off = self.sum / self.weight;
        let around = self.around.unwrap_or_else(State::zeros);
        let covariance = self.square / self.weight - off * off.transpose();
        Mode { mean: around + off, covariance, weight: self.weight }
    }
}

/// The part of a belief that a side's disagreement depends on. The rate enters through the front tire, which was met a
/// moment ago: a disagreement knows `tire + by_rate rate`.
struct OwnCovariance<T: Real> {
    /// Covariance of everything with the side's quantities, and of these among themselves.
    all: SMatrix<T, SIZE, OWN>,
    own: Gram<T>,
}

impl<T: Real> OwnCovariance<T> {
    fn new(covariance: &Covariance<T>, side: usize, by_rate: T) -> Self {
        let places = places(side);
        let mut all = SMatrix::<T, SIZE, OWN>::zeros();
        for (column, &place) in places.iter().enumerate() {
            all.set_column(column, &covariance.column(place));
        }
        let rate = covariance.column(RATE) * by_rate;
        let mut front = all.column_mut(FRONT_TIRE);
        front += rate;
        let mut own = Gram::zeros();
        for (row, &place) in places.iter().enumerate() {
            own.set_row(row, &all.row(place));
        }
        let rate = all.row(RATE) * by_rate;
        let mut front = own.row_mut(FRONT_TIRE);
        front += rate;
        Self { all, own }
    }

    /// Adds information `W A` with the score `W score`, both divided by `scale`.
    fn learn(&self, mode: &mut Mode<T>, score: &Score<T>, worth: &(Gram<T>, Gram<T>), scale: T) {
        let (weight, information) = worth;
        let information = information / scale;
        // P' = P - P_o (I + Ω P_oo)^-1 Ω P_o^T, and with it the mean: m' = m + P'_o W score.
        let Some(inverse) = (Gram::identity() + information * self.own).try_inverse() else { return };
        let gain = self.all * inverse;
        mode.covariance -= gain * information * self.all.transpose();
        mode.tidy();
        mode.mean += gain * (weight * score / scale);
    }
}

/// How well a mode foretold a frame.
struct Likelihood<T: Real> {
    log: T,
    /// Factor by which the disagreement's variance is larger than expected, at least one.
    scale: T,
    /// Power of what remains over what was expected, per bin.
    ratio: [T; BINS],
}

impl<T: Real> Likelihood<T> {
    fn new(own: &OwnCovariance<T>, found: &Disagreement<T>, expected: &Expectation<T>) -> Option<Self> {
        let known = found.slope * own.own * found.slope.transpose();
        // Half of a bin's power in each of its two numbers; frames that overlap say half of everything twice.
        let share = T::lit(0.5 / OVERLAP);
        let total = |scale: T| {
            let mut total = known;
            (0..ROWS).for_each(|row| total[(row, row)] += expected.power[row % BINS] * share * scale);
            total
        };
        let plain = total(T::one()).cholesky()?;
        let surprise = found.rows.dot(&plain.solve(&found.rows));
        // A disagreement far larger than expected says little: Student's t with few degrees of freedom.
        let (tails, rows) = (T::lit(TAILS), T::lit(ROWS as f64));
        let scale = ((tails + surprise) / (tails + rows)).max(T::one());
        let inverse = total(scale).cholesky()?.inverse();
        let weighted = inverse * found.rows;
        let mut ratio = [T::zero(); BINS];
        for (bin, ratio) in ratio.iter_mut().enumerate() {
            for row in [bin, BINS + bin] {
                *ratio += share * scale * weighted[row] * weighted[row] / inverse[(row, row)];
            }
        }
        let diagonal = plain.l_dirty().diagonal();
        let log_determinant = diagonal.iter().fold(T::zero(), |sum, x| sum + T::lit(2.0) * x.ln());
        let log = T::lit(-0.5) * (log_determinant + (tails + rows) * (T::one() + surprise / tails).ln());
        Some(Self { log, scale, ratio })
    }

    /// Derivative of the log-likelihood by the side's quantities, free of what noise does to it.
    fn score(&self, found: &Disagreement<T>, expected: &Expectation<T>) -> Score<T> {
        let mut score = expected.score;
        for row in 0..ROWS {
            let weight = T::lit(2.0 * OVERLAP) / expected.power[row % BINS];
            score -= found.slope.row(row).transpose() * (found.rows[row] * weight);
        }
        score
    }
}
