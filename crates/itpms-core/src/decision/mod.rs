//! Which tires have too little air: sixteen sets of low tires, weighed against what is known of all four together
//! (docs/math/decision.md).
//!
//! Called by the monitor with what accelerations tell of levels and losses, and by [`crate::wheel_speed`] for its prior. Knows shares of pressures and their
//! covariance; nothing of where they come from, and of no moment but this one.

mod shares;
mod tuning;

pub(crate) use self::shares::{Shares, Since};
pub use self::tuning::Tuning;
use crate::memory::Blank;
use crate::model::{Corner, Wheels};
use crate::real::Real;

/// Sets of tires: bit `i` of a set's number is tire `i`.
pub(crate) const SETS: usize = 16;
/// Share of its pressure that a tire has to be warned of which has lost it, by every regulation.
pub(crate) const LOSS: f64 = 0.2;
/// Of a loss that has to be warned of, the share that a low tire lacks at the least.
pub(crate) const DECISIVE: f64 = 0.6;
/// How probable each set is, and what its tires lack.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Probabilities<T> {
    /// Of the sets; the rest is what none of them explains.
    of_set: [T; SETS],
    /// Whether each tire lacks enough to be low, as far as is known: what lacks a little less is neither low nor as it should be.
    lacks: [bool; 4],
    /// That each tire is on its rim, which reads hard.
    on_rim: [T; 4],
    /// By how much each tire's share may be off because another car, or nothing known, explains the levels: an sd, with the error's sign (eq. 5).
    doubt: [T; 4],
}

impl<T: Real> Probabilities<T> {
    /// Before anything is seen.
    pub(crate) fn of_nothing(tuning: &Tuning) -> Self {
        let none = T::lit(f64::NEG_INFINITY);
        Self::of(&tuning.log_priors(tuning.one_is_low), none, &[none; 4]).0
    }

    /// Of sets of these probabilities, whatever their tires lack.
    pub(crate) fn known(of_set: [T; SETS]) -> Self {
        Self { of_set, lacks: [true; 4], on_rim: [T::zero(); 4], doubt: [T::zero(); 4] }
    }

    /// Normalizes these log-likelihoods, priors included, of the sets, of the unexplained and of each tire on its rim; gives the log of their
    /// sum, too.
    fn of(sets: &[T; SETS], unexplained: T, rims: &[T; 4]) -> (Self, T) {
        let best = sets.iter().chain(rims).copied().fold(unexplained, T::at_least);
        let weight = |log: T| (log - best).exp_fast();
        let (of_set, on_rim) = (sets.map(weight), rims.map(weight));
        let total = of_set.iter().chain(&on_rim).fold(weight(unexplained), |sum, &weight| sum + weight);
        let of_set = of_set.map(|weight| weight / total);
        let on_rim = on_rim.map(|weight| weight / total);
        (Self { of_set, lacks: [true; 4], on_rim, doubt: [T::zero(); 4] }, best + total.ln_fast())
    }

    pub(crate) fn on_rim(&self, tire: Corner) -> T {
        self.on_rim[tire.index()]
    }

    /// By how much a tire's share may be off for another reason than its air: an sd that adds to its level's, with the sign of the error.
    pub(crate) fn doubt(&self, tire: Corner) -> T {
        self.doubt[tire.index()]
    }

    /// The same with the doubt of others.
    pub(crate) fn with_doubt_of(self, others: &Self) -> Self {
        Self { doubt: others.doubt, ..self }
    }

    /// Of each set.
    #[cfg(test)]
    pub(crate) fn of_set(&self) -> &[T; SETS] {
        &self.of_set
    }

    pub(crate) fn low(&self, tire: Corner) -> T {
        if self.lacks[tire.index()] { self.sum(|set| set & (1 << tire.index()) != 0) } else { T::zero() }
    }

    pub(crate) fn none_low(&self) -> T {
        self.sum(|set| set == 0)
    }

    pub(crate) fn any_low(&self) -> T {
        self.sum(|set| set != 0)
    }

    /// That some are, and all of them among these.
    pub(crate) fn among(&self, tires: Wheels) -> T {
        let bits = tires.iter().fold(0, |bits, tire| bits | 1 << tire.index());
        self.sum(|set| set != 0 && set & !bits == 0)
    }

    /// That all four are.
    pub(crate) fn all_low(&self) -> T {
        if self.lacks == [true; 4] { self.sum(|set| set + 1 == SETS) } else { T::zero() }
    }

    fn sum(&self, is: impl Fn(usize) -> bool) -> T {
        let counted = self.of_set.iter().enumerate().filter(|(set, _)| is(*set));
        counted.fold(T::zero(), |sum, (_, p)| sum + *p)
    }
}
