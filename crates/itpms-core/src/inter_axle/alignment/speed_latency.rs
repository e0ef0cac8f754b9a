//! How late the speed comes: filtered, averaged or sent now and then it lags by some tenths of a second, and while the car brakes the rear
//! meets the front's road at another delay than the distance says (docs/math/shared-road.md, section 2). Found by where both sides find it, at
//! different accelerations. Knows nothing of beliefs.

use nalgebra::{Matrix3, Vector3};

use crate::memory::Blank;
use crate::model::SURELY_SD;
use crate::real::Real;

/// Prior sd: wheelbase over speed, the rear's lateness in s, the speed's in s; and of a find, as a share of the
/// delay.
const PRIOR_SD: [f64; 3] = [0.02, 0.003, 0.3];
const FIND_SD: f64 = 0.004;
/// Finds that count, at least, and after how many half of them is forgotten.
const LEAST: f64 = 4.0;
const MOST: f64 = 24.0;
/// Lags in s that are worth telling, and that are possible.
const SHORTEST_S: f64 = 0.03;
const LONGEST_S: f64 = 1.0;
/// Standard deviations that a lag must be from none; with it finds may be off by [`SURELY_SD`] of theirs on average.
const SURE: f64 = 5.0;

/// The least squares of the finds, in units of [`PRIOR_SD`].
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SpeedLatency<T: Real> {
    count: T,
    information: Matrix3<T>,
    score: Vector3<T>,
    square: T,
}

/// Where both sides found the other axle's road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Find<T> {
    /// How much later than the way says with the file's wheelbase, as a share of the delay; that delay in s; and how fast the speed grew,
    /// in 1/s.
    pub(crate) later: T,
    pub(crate) delay_s: T,
    pub(crate) growth_per_s: T,
}

/// A lag in s, with the wheelbase over speed and the rear's lateness in s that go with it, and their standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Latency<T> {
    pub(crate) seconds: T,
    pub(crate) rho: [T; 2],
    pub(crate) skew_s: [T; 2],
}

impl<T: Real> SpeedLatency<T> {
    /// Takes what both sides found; gives the lag that explains all of it, if there is one.
    pub(crate) fn take(&mut self, find: &Find<T>) -> Option<Latency<T>> {
        // A speed that is late by L while it grows by g per second reads less by g L, and the way comes out as much too short.
        let slope = Vector3::new(T::one(), T::one() / find.delay_s, -find.growth_per_s)
            .component_mul(&Vector3::from(PRIOR_SD.map(T::lit)));
        if !(find.later.is_finite() && slope.iter().all(|x| x.is_finite())) {
            return None;
        }
        if self.count > T::lit(MOST) {
            let half = T::lit(0.5);
            self.count *= half;
            self.information *= half;
            self.score *= half;
            self.square *= half;
        }
        let weight = T::lit(1.0 / (FIND_SD * FIND_SD));
        self.count += T::one();
        self.information += slope * slope.transpose() * weight;
        self.score += slope * (find.later * weight);
        self.square += find.later * find.later * weight;
        self.explained()
    }

    fn explained(&self) -> Option<Latency<T>> {
        let covariance = (self.information + Matrix3::identity()).try_inverse()?;
        let best = covariance * self.score;
        let of = |i: usize| {
            let unit = T::lit(PRIOR_SD[i]);
            [unit * best[i], unit * covariance[(i, i)].max(T::zero()).sqrt()]
        };
        let [seconds, sd] = of(2);
        let left = self.square - self.score.dot(&best);
        let size = seconds.abs();
        let sure = self.count >= T::lit(LEAST) && size > T::lit(SURE) * sd;
        let explained = left < T::lit(SURELY_SD * SURELY_SD) * self.count;
        let worth_it = size > T::lit(SHORTEST_S) && size < T::lit(LONGEST_S);
        (sure && explained && worth_it).then(|| Latency { seconds, rho: of(0), skew_s: of(1) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Speeds up and slows down, in 1/s, at these delays in s.
    const MOMENTS: [[f64; 2]; 6] =
        [[0.2, 0.3], [-0.25, 0.25], [0.05, 0.15], [-0.1, 0.2], [0.3, 0.4], [0.0, 0.1]];

    fn last(later: impl Fn(usize, f64, f64) -> f64) -> Option<Latency<f64>> {
        let mut lag = SpeedLatency::BLANK;
        let mut lag_found = None;
        for (i, [growth_per_s, delay_s]) in MOMENTS.into_iter().cycle().take(60).enumerate() {
            lag_found = lag.take(&Find { later: later(i, growth_per_s, delay_s), delay_s, growth_per_s });
        }
        lag_found
    }

    #[test]
    fn a_late_speed_is_detected_with_scale_and_skew() {
        let noise = |i: usize| 0.002 * ((i * i) as f64).sin();
        let lag = last(|i, growth, delay_s| 0.01 + 0.002 / delay_s - 0.15 * growth + noise(i)).unwrap();
        let near = |[value, sd]: [f64; 2], truth: f64| (value - truth).abs() < 4.0 * sd;
        assert!((lag.seconds - 0.15).abs() < 0.01, "{lag:?}");
        assert!(near(lag.rho, 0.01) && near(lag.skew_s, 0.002) && lag.skew_s[1] < 1e-3, "{lag:?}");
    }

    #[test]
    fn what_a_lag_does_not_explain_is_none() {
        let noise = |i: usize| ((i * i) as f64).sin();
        // Another scale, or a rear that is late, whatever the acceleration; noise; a hundredth of a second; far too much noise; nonsense.
        assert_eq!(last(|_, _, _| 0.05), None);
        assert_eq!(last(|_, _, delay_s| 0.003 / delay_s), None);
        assert_eq!(last(|i, _, _| 0.005 * noise(i)), None);
        assert_eq!(last(|i, growth, _| -0.01 * growth + 0.001 * noise(i)), None);
        assert_eq!(last(|i, growth, _| 0.03 * noise(i) - 0.1 * growth), None);
        assert_eq!(last(|_, _, _| f64::NAN), None);
        // At one acceleration it might be a scale as well.
        let find = |growth_per_s: f64, later: f64| Find { later, delay_s: 0.2, growth_per_s };
        let mut same = SpeedLatency::BLANK;
        assert!((0..20).all(|_| same.take(&find(0.2, -0.03)).is_none()));
        // Two finds are none.
        let mut few = SpeedLatency::BLANK;
        assert!(few.take(&find(0.2, -0.03)).is_none() && few.take(&find(-0.2, 0.03)).is_none());
    }
}
