//! Evidence over days: a leak too slow for any one of them. Loads are drawn anew each day, a leak goes on in one direction
//! (`docs/math/wheel-speed.md`, eq. 11b-11e). Kept are sums over days, not the days.

#[cfg(test)]
mod tests;

use super::filter::normal_distribution;
use super::hypotheses::{DECISION, Triangle, add_radii, add_square, dot, inverse, times};
use crate::memory::Blank;
use crate::model::{Corner, SEEN};
use crate::real::Real;
use crate::wheel_speed::Tuning;

/// Stamps from here on are dates, in s since 1970.
const DATES_S: f64 = 1e8;
pub(super) const DAY_S: f64 = 86_400.0;
/// Drives less than so many days apart are of one day, with one load: the best known counts.
const SAME_DAY: f64 = 0.6;
/// Result of one day.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RadiusDay<T> {
    /// Days since the calibration.
    pub day: T,
    /// Changes of the three ratios since the calibration, in thousandths.
    pub change_1e3: [T; 3],
    /// Their covariance without the calibration's, in the order 00, 10, 11, 20, 21, 22, with half of the loads' effect; all zeros: there is none.
    pub covariance_1e6: [T; 6],
}

/// Results of the days since a calibration: to be stored beside it, and loaded with it.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RadiusDays<T> {
    /// When the calibration was over, in s since 1970; zero: not known.
    pub calibrated_unix_s: f64,
    /// The newest day, which is in no sum yet.
    pub newest: RadiusDay<T>,
    /// Days in the sums.
    pub count: u32,
    /// Sums of a day's information `W`, of `k W` and `k² W` with its number `k`, in the order of a covariance.
    pub information: [[T; 6]; 3],
    /// Sums of `W` and `k W` times its changes.
    pub vector: [[T; 3]; 2],
}

/// Evidence of a slow leak over the days since the calibration.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SlowLeak<T> {
    /// Probability that this tire alone leaks slowly, in the order of [`Corner::ALL`].
    pub probability: [T; 4],
    /// What the likeliest one's radius changes by in a day, as a share of it, and its sd.
    pub rate_per_day: T,
    /// Its standard deviation.
    pub rate_sd_per_day: T,
    /// The last day's number.
    pub day: T,
    /// Days that count.
    pub days: u32,
}

impl<T: Real> SlowLeak<T> {
    pub(crate) fn likeliest(&self) -> (Corner, T) {
        let wheels = Corner::ALL.into_iter().zip(self.probability);
        wheels.reduce(|a, b| if b.1 > a.1 { b } else { a }).unwrap_or((Corner::FrontLeft, T::zero()))
    }
}

impl<T: Real> RadiusDays<T> {
    /// No day yet since a calibration that was over at this time, in s since 1970.
    #[must_use]
    pub fn since(calibrated_unix_s: f64) -> Self {
        let calibrated_unix_s = if calibrated_unix_s > DATES_S { calibrated_unix_s } else { 0.0 };
        Self { calibrated_unix_s, ..Self::BLANK }
    }

    /// Whether any day counts.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.newest.covariance_1e6[0] == T::zero()
    }

    /// Whether they can be of a car: finite, with variances that are some.
    #[must_use]
    pub fn is_sane(&self) -> bool {
        let RadiusDay { day, change_1e3, covariance_1e6: newest } = &self.newest;
        let numbers = self.information.as_flattened().iter().chain(self.vector.as_flattened());
        let finite = numbers.chain(change_1e3).chain(newest).chain([day]).all(|x| x.is_finite());
        let positive = |[a, _, c, _, _, f]: &Triangle<T>| [a, c, f].into_iter().all(|x| *x > T::zero());
        let some = |is: bool, sums: &Triangle<T>| if is { positive(sums) } else { *sums == [T::zero(); 6] };
        finite
            && *day >= T::zero()
            && some(!self.is_empty(), newest)
            && self.information.iter().all(|sums| some(self.count > 0, sums))
    }

    /// Takes in what is known of the changes at this time; whether it counts: it has a date, of the last day or later, and is known better than
    /// what was known of that day.
    pub(super) fn see(&mut self, unix_s: f64, change: &[T; 3], covariance: &Triangle<T>) -> bool {
        let day = T::lit((unix_s - self.calibrated_unix_s) / DAY_S);
        if !(self.calibrated_unix_s > DATES_S && unix_s > DATES_S && day > T::zero()) {
            return false;
        }
        if !self.is_empty() {
            let later = day - self.newest.day;
            let known_to = |[front, _, rear, ..]: &Triangle<T>| *front + *rear;
            let is_better = known_to(covariance) < known_to(&self.newest.covariance_1e6);
            if !(later > T::lit(-SAME_DAY)) || later < T::lit(SAME_DAY) && !is_better {
                return false;
            }
            if !(later < T::lit(SAME_DAY)) {
                self.add_newest();
            }
        }
        self.newest = RadiusDay { day, change_1e3: *change, covariance_1e6: *covariance };
        true
    }

    fn add_newest(&mut self) {
        let RadiusDay { day, change_1e3, covariance_1e6 } = self.newest;
        let Some((weight, _)) = inverse(&covariance_1e6) else { return };
        let change = times(&weight, &change_1e3);
        self.count = self.count.saturating_add(1);
        let mut by = T::one();
        for (power, sums) in self.information.iter_mut().enumerate() {
            sums.iter_mut().zip(weight).for_each(|(sum, w)| *sum += by * w);
            if let Some(vector) = self.vector.get_mut(power) {
                vector.iter_mut().zip(change).for_each(|(sum, x)| *sum += by * x);
            }
            by *= day;
        }
    }

    /// The rates of the three ratios a day with their covariance, the usual load being known beforehand to `usual`.
    fn rates(&self, usual: &Triangle<T>) -> Option<([T; 3], Triangle<T>)> {
        let [w, kw, mut kkw] = self.information;
        let [wd, kwd] = self.vector;
        let mut sum = inverse(usual)?.0;
        sum.iter_mut().zip(w).for_each(|(sum, w)| *sum += w);
        let load = inverse(&sum)?.0;
        let [a, b, c, d, e, f] = kw;
        for row in [[a, b, d], [b, c, e], [d, e, f]].into_iter().enumerate() {
            let taken = times(&kw, &times(&load, &row.1));
            let places = [[0, 1, 3], [1, 2, 4], [3, 4, 5]];
            for (place, taken) in places[row.0].into_iter().zip(taken).take(row.0 + 1) {
                kkw[place] -= taken;
            }
        }
        let taken = times(&kw, &times(&load, &wd));
        let covariance = inverse(&kkw)?.0;
        let rates = times(&covariance, &core::array::from_fn(|i| kwd[i] - taken[i]));
        Some((rates, covariance))
    }

    /// What all days say, of a car whose usual load is known beforehand to `usual`, the calibration's covariance included.
    pub(super) fn verdict(&self, usual: &Triangle<T>, tuning: &Tuning) -> SlowLeak<T> {
        let mut all = *self;
        if !self.is_empty() {
            all.add_newest();
        }
        let nothing = SlowLeak { day: self.newest.day, days: all.count, ..SlowLeak::BLANK };
        let Some((rates, mut covariance)) = all.rates(usual).filter(|_| all.count >= tuning.least_days)
        else {
            return nothing;
        };
        let [_, wear_sd] = tuning.wear;
        add_radii(&mut covariance, wear_sd);
        let (mut wide, unexplained_sd) = (covariance, 2.0 * tuning.leak_per_day);
        for i in 0..3 {
            let along = core::array::from_fn(|j| if i == j { T::one() } else { T::zero() });
            add_square(&mut wide, &along, T::lit(unexplained_sd * unexplained_sd));
        }
        let (Some((inner, inner_size)), Some((outer, outer_size))) = (inverse(&covariance), inverse(&wide))
        else {
            return nothing;
        };
        let half = T::lit(0.5);
        let square = dot(&rates, &times(&inner, &rates)) - dot(&rates, &times(&outer, &rates));
        let unexplained = half * (square + (inner_size / outer_size).ln_fast())
            + T::lit(DECISION.unexplained * DECISION.one_loses).ln_fast();
        let leaks = SEEN.map(|seen| Leak::of(&inner, &rates, &seen.map(T::lit), tuning.leak_per_day));
        let best = leaks.iter().map(|leak| leak.log).fold(unexplained.at_least(T::zero()), T::at_least);
        let total = leaks
            .iter()
            .map(|leak| leak.log)
            .chain([unexplained, T::zero()])
            .fold(T::zero(), |sum, log| sum + (log - best).exp_fast());
        let probability = leaks.each_ref().map(|leak| (leak.log - best).exp_fast() / total);
        let verdict = SlowLeak { probability, ..nothing };
        let rate = leaks.get(verdict.likeliest().0.index()).map_or((T::zero(), T::zero()), |leak| leak.rate);
        let thousandth = T::lit(1e-3);
        SlowLeak { rate_per_day: thousandth * rate.0, rate_sd_per_day: thousandth * rate.1, ..verdict }
    }
}

struct Leak<T> {
    /// Log of its probability over that of no leak.
    log: T,
    /// Rate and its sd, in thousandths a day.
    rate: (T, T),
}

impl<T: Real> Leak<T> {
    /// `inner`: information of the rates `found`, wear included.
    fn of(inner: &Triangle<T>, found: &[T; 3], seen: &[T; 3], rate: f64) -> Self {
        let weighted = times(inner, seen);
        let before = T::lit(1.0 / (rate * rate));
        let variance = T::one() / (before + dot(seen, &weighted));
        let mean = variance * (before * T::lit(-rate) + dot(found, &weighted));
        let sd = variance.sqrt();
        // A leak takes air away: only the part of prior and posterior below zero counts.
        let loses = normal_distribution(-mean / sd).at_least(T::lit(1e-30)) / normal_distribution(T::one());
        let square = mean * mean / variance - T::lit(rate * rate) * before;
        let log = T::lit(0.5) * (square + (variance * before).ln_fast())
            + (loses * T::lit(DECISION.one_loses)).ln_fast();
        Self { log, rate: (mean, sd) }
    }
}
