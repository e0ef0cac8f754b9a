//! The numbers of the decision.

use crate::decision::SETS;
use crate::real::Real;

crate::tuning::tuning! {
    /// Numbers of the decision: priors, what low tires lack, and the probabilities from which reports are made (docs/math/decision.md). Shares
    /// are of a tire's reference pressure.
    pub struct Tuning {
        /// Prior that one tire loses its air in a drive.
        one_loses: f64 = 1e-3,
        /// Prior that one tire was low before the drive: of the cars on the road one in ten has one that lacks a quarter.
        one_is_low: f64 = 0.025,
        /// Prior of two tires of an axle or a side over that of one.
        pair_low: f64 = 0.3,
        /// Prior of all four over that of one.
        all_low: f64 = 0.5,
        /// Prior of any other set over that of one.
        others_low: f64 = 0.05,
        /// Lack of a low tire, and its sd, in units of the losses that have to be warned of.
        low: [f64; 2] = [1.25, 0.42],
        /// The same of one that is nearly flat.
        flat: [f64; 2] = [3.0, 1.5],
        /// Prior of a tire that is nearly flat over that of one that is not.
        nearly_flat: f64 = 0.5,
        /// What a tire on its rim lacks by its stiffness, and the sd of that: it reads 1.6 to 2.3 times its pressure; and the sd of what others
        /// lack beside it.
        rim: [f64; 3] = [-0.95, 0.35, 0.1],
        /// By how much more than its reference, or than the other one of its axle, no one inflates a tire: what reads so is no pressure.
        nobody_inflates: f64 = 0.5,
        /// Sd of the share that a tire lacks which is not low: gauges, and a little warmth of its own.
        fine_sd: f64 = 0.013,
        /// Sd of the common lack of tires colder than their references: 5 K are 1.8 %.
        warmth_sd: f64 = 0.018,
        /// Sd of the apparent common lack on a car that has changed since a calibration of another day.
        changed_sd: f64 = 0.2,
        /// And of the difference between the axles' lacks.
        changed_axle_sd: f64 = 0.1,
        /// Prior of such a car.
        changed: f64 = 0.1,
        /// Sd of each tire's share where no set explains them.
        unexplained_sd: f64 = 0.3,
        /// Prior of that over that of one low tire.
        unexplained: f64 = 0.01,
        /// Probability from which a tire is called low.
        surely_low: f64 = 0.99,
        /// Probability below which it no longer is.
        hardly_low: f64 = 0.5,
        /// Probability below which it may be called fine.
        surely_not_low: f64 = 0.05,
        /// Probability of the contrary below which a low tire is reported in half the time: a tenth of `1 - surely_low`.
        beyond_doubt: f64 = 1e-3,
    }
}

/// Sets of tires that are an axle or a side.
const AXLES_AND_SIDES: [usize; 4] = [0b0011, 0b1100, 0b0101, 0b1010];

impl Tuning {
    /// Log of how probable it is before anything is seen that the tires of each set are low, against none, if it is `one` of one tire.
    pub(crate) fn log_priors<T: Real>(&self, one: f64) -> [T; SETS] {
        let log = |share: f64| T::lit(share * one).ln_fast();
        let [single, pair, all, others] = [1.0, self.pair_low, self.all_low, self.others_low].map(log);
        core::array::from_fn(|set| match set.count_ones() {
            0 => T::zero(),
            1 => single,
            2 if AXLES_AND_SIDES.contains(&set) => pair,
            4 => all,
            _ => others,
        })
    }
}
