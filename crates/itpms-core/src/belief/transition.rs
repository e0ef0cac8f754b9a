//! How one hypothesis becomes another as time goes by: changes of pressure begin, go on, are joined and end
//! (docs/math/shared-road.md, section 6).

use super::gaussian::{Circumstances, Hypothesis, Wandering};
use super::hypotheses::{CONSTANT, HYPOTHESES, Hypotheses, RANDOM_WALK, SIDE, both, changing, has_rate};
use super::state::{RATE, TIRE};
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

/// Chance per second that each begins: that nothing moves, each of the four wheels (the prior of a leak), each of the two sides, and that
/// all wander.
const BEGIN: [f64; HYPOTHESES] = [0.0, 2e-4, 2e-4, 2e-4, 2e-4, 1e-6, 1e-6, 1e-8];
/// Chance per second that a wheel which loses pressure is joined by the other one of its side: a kerb meets both.
const JOIN: f64 = 1e-2;
/// Weight, over that of the side's own hypothesis or of all, below which a hypothesis is not followed, or only in some frames.
pub(super) const NOTICED: f64 = 1e-3;
/// Chance per second that a change ends.
const END: f64 = 0.5;
/// Growth of the rate's sd per square root of a second.
const RATE_WANDER: f64 = 0.1;
/// Growth per square root of a second of each compliance's sd while wheels wander.
const LOOSE_SD: f64 = 0.06;
/// Weight below which a hypothesis begins anew.
const FORGOTTEN: f64 = 1e-20;
/// Largest chance of a step that a suspected wheel begins to move.
const LARGEST_CHANCE: f64 = 0.2;

/// Parts of a prediction: changes of single tires end, and of several; those of several go on or begin, then those of one; then time passes.
pub(crate) const PARTS: usize = 5;

/// A prediction that is under way, as a whole of [`PARTS`].
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Transition<T: Real> {
    seconds: T,
    /// Chances of this step: that a change ends, that none begins, that each does, that a wheel is joined.
    end: T,
    stay: T,
    begin: [T; HYPOTHESES],
    join: T,
    /// What nothing moves any more in; takes the constant one's place once everything else has begun from that.
    still: Hypothesis<T>,
    wandering: Wandering<T>,
}

impl<T: Real> Transition<T> {
    /// None is under way.
    pub(super) fn clear(&mut self) {
        (self.seconds, self.end, self.stay, self.join) = (T::zero(), T::zero(), T::zero(), T::zero());
        self.begin.fill(T::zero());
        self.still.mean.fill(T::zero());
        self.still.covariance.clear();
        self.still.weight = T::zero();
    }

    /// Begins to move on by `seconds`; wheels may begin to move, several together, and all to wander; `onset_rates` are chances per second that each wheel does that somebody else has reason to believe in.
    pub(super) fn begin(&mut self, seconds: T, [moves, together, wanders]: [bool; 3], onset_rates: &[T; 4]) {
        let factor = |may: bool| if may { seconds } else { T::zero() };
        self.seconds = seconds;
        self.end = T::one() - (-T::lit(END) * seconds).exp();
        self.join = T::lit(JOIN) * factor(together);
        self.stay = T::one();
        for (hypothesis, begin) in self.begin.iter_mut().enumerate().skip(1) {
            let may = match hypothesis {
                RANDOM_WALK => wanders,
                SIDE.. => together,
                _ => moves,
            };
            *begin = T::lit(BEGIN[hypothesis]) * factor(may);
            if let Some(&rate) = onset_rates.get(hypothesis - 1) {
                *begin += (rate * seconds).min(T::lit(LARGEST_CHANCE));
            }
            self.stay -= *begin;
        }
    }

    /// Nothing is left to be done of a prediction.
    pub(super) fn end(&mut self) {
        self.seconds = T::zero();
    }

    /// Does one of its parts; see [`Wandering::over`] for the circumstances.
    pub(super) fn apply(
        &mut self,
        part: usize,
        hypotheses: &mut Hypotheses<T>,
        circumstances: &Circumstances<T>,
    ) {
        if !(self.seconds > T::zero()) {
            return;
        }
        match part {
            0 => {
                hypotheses[CONSTANT].part().write(hypotheses[CONSTANT].weight * self.stay, &mut self.still);
                self.end_some(&hypotheses[CONSTANT + 1..SIDE]);
            }
            1 => self.end_some(&hypotheses[SIDE..]),
            2 => self.mix_several(hypotheses),
            3 => {
                self.mix_single(hypotheses);
                hypotheses[CONSTANT].take_over(&self.still);
                self.wandering = Wandering::over(self.seconds, circumstances);
            }
            _ => self.pass(hypotheses),
        }
    }

    /// In place: a copy of all hypotheses is more than a controller has room for.
    fn mix_several(&mut self, hypotheses: &mut Hypotheses<T>) {
        let Self { end, begin, join, .. } = *self;
        for (hypothesis, &begin) in begin.iter().enumerate().skip(SIDE) {
            go_on(hypotheses, hypothesis, end, begin);
        }
        Corner::ALL.into_iter().for_each(|wheel| merge(hypotheses, wheel, join));
    }

    /// Single wheels come after those that they join, and what does not move after all that begins from it.
    fn mix_single(&mut self, hypotheses: &mut Hypotheses<T>) {
        let Self { end, begin, .. } = *self;
        for (hypothesis, &begin) in begin.iter().enumerate().take(SIDE).skip(CONSTANT + 1) {
            go_on(hypotheses, hypothesis, end, begin);
        }
    }

    fn pass(&self, hypotheses: &mut Hypotheses<T>) {
        let seconds = self.seconds;
        for (index, hypothesis) in hypotheses.iter_mut().enumerate() {
            hypothesis.wander(&self.wandering);
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
            for (i, &moved) in changing.iter().enumerate().filter(|(_, moved)| **moved > T::zero()) {
                let by = moved * seconds;
                let change = by * hypothesis.mean[RATE];
                hypothesis.mean[TIRE + i] += change;
                let rate = hypothesis.covariance.column(RATE) * by;
                for (j, &with_rate) in rate.iter().enumerate() {
                    // The tire's own variance changes with both of its factors.
                    let times = if j == TIRE + i { T::lit(2.0) } else { T::one() };
                    hypothesis.covariance[(TIRE + i, j)] += times * with_rate;
                }
                hypothesis.covariance[(TIRE + i, TIRE + i)] += by * rate[RATE];
            }
        }
    }

    /// Of some that move the share that ends moves no more.
    fn end_some(&mut self, some: &[Hypothesis<T>]) {
        for changing in some.iter().filter(|changing| changing.weight > T::lit(FORGOTTEN)) {
            self.still.join(changing.weight * self.end, &changing.part().without_rate());
        }
    }
}

/// A change goes on but for the share that ends, and by this chance what did not change begins to.
fn go_on<T: Real>(hypotheses: &mut Hypotheses<T>, hypothesis: usize, end: T, begin: T) {
    let [constant, others @ ..] = hypotheses;
    let Some(changing) = others.get_mut(hypothesis - 1) else { return };
    let with_onset = constant.part().with_onset(has_rate(hypothesis));
    let stays = changing.weight * (T::one() - end);
    let begins = constant.weight * begin;
    // Below this weight a hypothesis is not followed.
    if stays > T::lit(FORGOTTEN) {
        changing.weight = stays;
        changing.join(begins, &with_onset);
    } else {
        with_onset.write(begins, changing);
    }
}

/// A wheel that loses pressure by itself is joined, by this chance, by the other one of its side.
fn merge<T: Real>(hypotheses: &mut Hypotheses<T>, wheel: Corner, chance: T) {
    let hypothesis = both(wheel);
    let (single, several) = hypotheses.split_at_mut(SIDE);
    let (alone, both) = (&single[wheel.index() + 1], &mut several[hypothesis - SIDE]);
    let joins = alone.weight * chance;
    if joins > T::lit(NOTICED) * both.weight {
        both.join(joins, &alone.part().without_rate().with_onset(has_rate(hypothesis)));
    }
}
