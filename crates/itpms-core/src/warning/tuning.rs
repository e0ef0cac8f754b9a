//! The numbers of the warnings.

use crate::diagnosis::debounce::DebounceTimes;

crate::tuning::tuning! {
    /// Numbers of the warnings beside their [limits](crate::warning::Limits): for how long evidence has to last, and whose counts
    /// (docs/math/monitor.md).
    pub struct Tuning {
        /// Seconds in which something was learned, for a low tire and against it.
        low: DebounceTimes = DebounceTimes { set_s: 2.0, clear_s: 10.0 },
        /// The same of an overfull one.
        over: DebounceTimes = DebounceTimes { set_s: 60.0, clear_s: 10.0 },
        /// The same of all four together.
        all_low: DebounceTimes = DebounceTimes { set_s: 2.0, clear_s: 20.0 },
        /// The same of a car, or an axle, that has changed since its calibration.
        shifted: DebounceTimes = DebounceTimes { set_s: 60.0, clear_s: 20.0 },
        /// The same of a fast leak.
        leak: DebounceTimes = DebounceTimes { set_s: 10.0, clear_s: 60.0 },
        /// By how much less a second counts of a tire that nothing is held against as the other one of its side is silent.
        alone: f64 = 75.0,
        /// Speed in m/s above which a car should learn something: 20 km/h.
        should_learn_m_s: f64 = 5.5,
        /// Seconds of standing after which the pressure at the stop is no longer taken for the present one.
        standing_s: f64 = 30.0,
        /// Seconds by which valid fit has to outlast misfit before a warning stands, the memory of a misfit; twice that is the most that is
        /// remembered.
        fitted_s: f64 = 20.0,
        /// Evidence for a low tire that began so many seconds before that of a sensor's fault on its side, or since, is the fault's.
        beside_a_fault_s: f64 = 30.0,
        /// By how much the mean of all four has to be above its limit to be fine again, as a share of the reference.
        all_fine_above: f64 = 0.03,
        /// Share of the loss that must be warned of which makes a leak if it was fast.
        leak_of_a_loss: f64 = 0.5,
        /// Time constant in s of how fast a loss grows.
        growth_s: f64 = 30.0,
        /// Time constants in s with which a driven tire is taken to warm up and a standing one to cool down where no temperature is known:
        /// tires warm up in some 8 to 10 minutes and cool down in more than half an hour.
        warms_in_s: f64 = 600.0,
        /// See `warms_in_s`.
        cools_in_s: f64 = 900.0,
        /// Speed in m/s from which a tire is taken to become as warm as it can; proportionally less below it.
        warm_m_s: f64 = 20.0,
        /// Share of a calibration at its end from which the warm reference is taken.
        taken_share: f64 = 0.25,
        /// How long that is at the most, in s.
        taken_s: f64 = 300.0,
        /// How many seconds of it must have been learned from.
        taken_least_s: f64 = 30.0,
    }
}
