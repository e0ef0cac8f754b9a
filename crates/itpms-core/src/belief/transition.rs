//! How one hypothesis becomes another as time goes by: changes of pressure begin, go on, are joined and end
//! (docs/math/shared-road.md, section 6).

use nalgebra::RowSVector;

use super::gaussian::{Hypothesis, Wandering};
use super::hypothesis_bank::{CONSTANT, HYPOTHESES, HypothesisBank, RANDOM_WALK, SIDE, changing, has_rate};
use super::mixture::Mixture;
use super::state::{RATE, State, TIRE};
use crate::memory::blank;
use crate::real::Real;

/// Chance per second that each begins.
const BEGIN: [f64; HYPOTHESES] = [0.0, 2e-4, 2e-4, 2e-4, 2e-4, 1e-6, 1e-6, 1e-6, 1e-8];
/// Chance per second that a wheel which loses pressure is joined by the other one of its side: a kerb meets both. Share of the
/// side's own weight below which that is not looked at.
const JOIN: f64 = 1e-2;
const NOTICED: f64 = 1e-3;
/// Chance per second that a change ends.
const END: f64 = 0.5;
/// Growth of the rate's sd per square root of a second.
const RATE_WANDER: f64 = 0.1;
/// Growth per square root of a second of each compliance's sd while wheels wander.
const LOOSE_SD: f64 = 0.06;
/// Chance that a tire was filled or let down during a stop, and the sd of its compliance then.
const FILLED: f64 = 1e-3;
const FILLED_SD: f64 = 0.15;
/// Weight below which a hypothesis begins anew.
const FORGOTTEN: f64 = 1e-20;
/// Largest chance of a step that a suspected wheel begins to move.
const LARGEST_CHANCE: f64 = 0.2;

/// Parts of a prediction: changes begin, go on and end; then time passes.
pub(crate) const PARTS: usize = 2;

/// A prediction that is under way, as a whole of [`PARTS`].
#[derive(Debug, Clone, PartialEq)]
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
}

blank!(Transition<T> { seconds, end, stay, begin, join, still });

impl<T: Real> Transition<T> {
    /// None is under way.
    pub(super) fn clear(&mut self) {
        (self.seconds, self.end, self.stay, self.join) = (T::zero(), T::zero(), T::zero(), T::zero());
        self.begin.fill(T::zero());
        self.still.mean.fill(T::zero());
        self.still.covariance.fill(T::zero());
        self.still.weight = T::zero();
    }
}

impl<T: Real> HypothesisBank<T> {
    /// Begins to move on by `seconds`; `onset_scale` multiplies the chances that one wheel, and that several, begin to move;
    /// `onset_rates` are chances per second that each wheel does that somebody else has reason to believe in.
    pub(super) fn begin_prediction(&mut self, seconds: T, onset_scale: [T; 2], onset_rates: &[T; 4]) {
        let [_, several] = onset_scale;
        let transition = &mut self.transition;
        transition.seconds = seconds;
        transition.end = T::one() - (-T::lit(END) * seconds).exp();
        transition.join = T::lit(JOIN) * seconds * several;
        transition.stay = T::one();
        for (hypothesis, begin) in transition.begin.iter_mut().enumerate().skip(1) {
            *begin = T::lit(BEGIN[hypothesis]) * seconds * onset_scale[usize::from(hypothesis >= SIDE)];
            if let Some(&rate) = onset_rates.get(hypothesis - 1) {
                *begin += (rate * seconds).min(T::lit(LARGEST_CHANCE));
            }
            transition.stay -= *begin;
        }
    }

    /// Nothing is left to be done of a prediction.
    pub(super) fn end_prediction(&mut self) {
        self.transition.seconds = T::zero();
    }

    /// Does one of its parts.
    pub(super) fn predict_part(&mut self, part: usize) {
        if !(self.transition.seconds > T::zero()) {
            return;
        }
        match part {
            0 => self.mix(),
            _ => self.pass(),
        }
    }

    /// In place: a copy of all hypotheses is more than a controller has room for. Single wheels come after those that they join.
    fn mix(&mut self) {
        let Transition { end, begin, join, .. } = self.transition;
        self.stay_or_end();
        for (hypothesis, &begin) in begin.iter().enumerate().skip(SIDE) {
            self.go_on(hypothesis, end, begin);
        }
        (0..4).for_each(|wheel| self.merge(wheel, join));
        for (hypothesis, &begin) in begin.iter().enumerate().take(SIDE).skip(1) {
            self.go_on(hypothesis, end, begin);
        }
        self.hypotheses[CONSTANT].take_over(&self.transition.still);
    }

    /// Time passes.
    fn pass(&mut self) {
        let seconds = self.transition.seconds;
        let wandering = Wandering::over(seconds, &self.strut_variance);
        for (index, hypothesis) in self.hypotheses.iter_mut().enumerate() {
            hypothesis.wander(&wandering);
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
                let row = RowSVector::from_fn(|_, j| hypothesis.covariance[(RATE, j)] * by);
                let mut target = hypothesis.covariance.row_mut(TIRE + i);
                target += row;
                let column = State::from_fn(|i, _| hypothesis.covariance[(i, RATE)] * by);
                let mut target = hypothesis.covariance.column_mut(TIRE + i);
                target += column;
            }
        }
    }

    /// What moves no more: what did not and of which this share stays so, and of what did the share that ends.
    fn stay_or_end(&mut self) {
        let Self { hypotheses: [constant, others @ ..], transition, .. } = self;
        let (stay, end) = (transition.stay, transition.end);
        let mut still = Mixture::new(&mut transition.still);
        still.add(constant.weight * stay, &constant.part());
        for changing in others {
            if changing.weight > T::lit(FORGOTTEN) {
                still.add(changing.weight * end, &changing.part().without_rate());
            }
        }
        still.finish();
    }

    /// A change goes on but for the share that ends, and by this chance what did not change begins to.
    fn go_on(&mut self, hypothesis: usize, end: T, begin: T) {
        let [constant, others @ ..] = &mut self.hypotheses;
        let Some(changing) = others.get_mut(hypothesis - 1) else { return };
        let with_onset = constant.part().with_onset(has_rate(hypothesis));
        let stays = changing.weight * (T::one() - end);
        let begins = constant.weight * begin;
        // What nobody believes in is not followed.
        if stays > T::lit(FORGOTTEN) {
            let mut going = Mixture::around(changing, stays);
            going.add(begins, &with_onset);
            going.finish();
        } else {
            with_onset.write(begins, changing);
        }
    }

    /// A wheel that loses pressure by itself is joined, by this chance, by the other one of its side.
    fn merge(&mut self, wheel: usize, chance: T) {
        let hypothesis = SIDE + wheel % 2;
        let (single, several) = self.hypotheses.split_at_mut(SIDE);
        let (alone, both) = (&single[wheel + 1], &mut several[hypothesis - SIDE]);
        let joins = alone.weight * chance;
        if joins > T::lit(NOTICED) * both.weight {
            let weight = both.weight;
            let mut going = Mixture::around(both, weight);
            going.add(joins, &alone.part().without_rate().with_onset(has_rate(hypothesis)));
            going.finish();
        }
    }

    /// All tires may have become warmer or colder together: their compliances have so much more sd in common.
    pub(super) fn change_temperature(&mut self, sd: &[T; 4]) {
        for hypothesis in &mut self.hypotheses {
            for i in 0..4 {
                for j in 0..4 {
                    hypothesis.covariance[(TIRE + i, TIRE + j)] += sd[i] * sd[j];
                }
            }
        }
    }

    /// Moves on by `seconds` in which nobody watched: nothing moves any more. `filled`: somebody may have changed a
    /// pressure.
    pub(super) fn predict_gap(&mut self, seconds: T, filled: bool) {
        self.collapse();
        let [constant, .., loose] = &mut self.hypotheses;
        constant.wander(&Wandering::over(seconds, &self.strut_variance));
        if filled {
            let chance = T::lit(FILLED);
            loose.take_over(constant);
            for i in TIRE..TIRE + 4 {
                loose.covariance[(i, i)] += T::lit(FILLED_SD * FILLED_SD);
            }
            loose.weight = chance;
            constant.weight = T::one() - chance;
        }
    }
}
