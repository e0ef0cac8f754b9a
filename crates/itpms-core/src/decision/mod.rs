//! Which tires have too little air: sixteen sets of low tires, weighed against what is known of all four together
//! (docs/math/decision.md).
//!
//! Called by the monitor with what accelerations tell of levels and losses, and by [`crate::wheel_speed`] for its prior. Knows shares of pressures and their
//! covariance; nothing of where they come from, and of no moment but this one.

mod shares;

pub(crate) use self::shares::{Shares, Since};
use crate::memory::Blank;
use crate::model::{Corner, Wheels};
use crate::real::Real;

/// Sets of tires: bit `i` of a set's number is tire `i`.
pub(crate) const SETS: usize = 16;
/// Share of its pressure that a tire has to be warned of which has lost it, by every regulation.
pub(crate) const LOSS: f64 = 0.2;
/// What a low tire lacks, and its sd, in the losses that have to be warned of; the same of one that is nearly flat, and its prior over that of one that is not.
pub(crate) const LOW: [f64; 2] = [1.25, 0.42];
pub(crate) const FLAT: [f64; 2] = [3.0, 1.5];
pub(crate) const NEARLY_FLAT: f64 = 0.5;
/// No one inflates a tire by so much of its reference more than that, or than the other one of its axle: what reads so is no pressure.
pub(crate) const NOBODY_INFLATES: f64 = 0.5;
/// Prior of one tire that loses its air in a drive, and of one that was low before: of the cars on the road one in ten has one that lacks a quarter.
pub(crate) const ONE_LOSES: f64 = 1e-3;
pub(crate) const ONE_IS_LOW: f64 = 0.025;
/// And of two tires of an axle or a side, of all four, and of any others, over that of one.
const PAIR_LOW: f64 = 0.3;
const ALL_LOW: f64 = 0.5;
const OTHERS_LOW: f64 = 0.05;
const AXLES_AND_SIDES: [usize; 4] = [0b0011, 0b1100, 0b0101, 0b1010];
/// Of a loss that has to be warned of, the share that a low tire lacks at the least.
pub(crate) const DECISIVE: f64 = 0.6;
/// Probability from which a tire is called low, below which it no longer is, and below which it may be called fine.
pub(crate) const SURELY_LOW: f64 = 0.99;
pub(crate) const HARDLY_LOW: f64 = 0.5;
pub(crate) const SURELY_NOT_LOW: f64 = 0.05;
/// Probability of the contrary below which a low tire is reported sooner: a tenth of that of one that is only surely low.
pub(crate) const BEYOND_DOUBT: f64 = 1e-3;

/// Log of how probable it is before anything is seen that these tires are low, against none, if it is `one` of one tire.
pub(crate) fn log_prior<T: Real>(set: usize, one: f64) -> T {
    let is_pair = AXLES_AND_SIDES.contains(&set);
    let share = match set.count_ones() {
        0 => return T::zero(),
        1 => 1.0,
        2 if is_pair => PAIR_LOW,
        4 => ALL_LOW,
        _ => OTHERS_LOW,
    };
    T::lit(share * one).ln_fast()
}

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
    pub(crate) fn of_nothing() -> Self {
        let none = T::lit(f64::NEG_INFINITY);
        Self::of(&core::array::from_fn(|set| log_prior(set, ONE_IS_LOW)), none, &[none; 4]).0
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
