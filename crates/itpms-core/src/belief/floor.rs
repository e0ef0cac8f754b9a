//! Tires only lose air while they roll: once losses are counted nothing but warming up makes one negative (docs/math/level-and-loss.md,
//! section 2).

use crate::model::Corner;
use crate::real::Real;

/// How far below its level a tire's compliance may be read, over that at placard pressure.
const MARGIN: f64 = 0.02;
/// The share by which pressures may rise as the tires warm up, with its time constant in s: 9 % are 25 K, and tires warm up
/// in some ten minutes.
const WARMING: f64 = 0.09;
const WARMING_S: f64 = 300.0;
/// How many times as much as most of the others a tire may warm up.
const WARMER_THAN_OTHERS: f64 = 2.0;

/// The least that each tire's compliance can be, over that at placard pressure, less one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Floor<T> {
    /// For all that it may warm up.
    each: [T; 4],
    /// Whether all tires have corners, which show how warm they are.
    of_four: bool,
}

impl<T: Real> Floor<T> {
    /// Seconds after a calibration; `shares` of the air in each tire's stiffness.
    pub(super) fn after(since_s: T, shares: [T; 4], of_four: bool) -> Self {
        let warmer = T::lit(WARMING) * (T::one() - (-since_s / T::lit(WARMING_S)).exp());
        Self { each: shares.map(|share| -T::lit(MARGIN) - warmer * share), of_four }
    }

    /// Each tire by itself, some without a bound.
    #[cfg(test)]
    pub(super) fn alone(each: [Option<T>; 4]) -> Self {
        Self { each: each.map(|least| least.unwrap_or(T::lit(f64::NEG_INFINITY))), of_four: false }
    }

    /// That of one tire where all have these compliances: tires warm up together.
    pub(super) fn of(&self, tire: Corner, compliances: [T; 4]) -> T {
        let least = self.each[tire];
        if !self.of_four {
            return least;
        }
        let [a, b, c] = tire.others().map(|other| compliances[other]);
        let median = a.max(b).min(a.min(b).max(c));
        least.max(T::lit(WARMER_THAN_OTHERS) * median.min(T::zero()) - T::lit(MARGIN))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: Floor<f64> = Floor { each: [-0.08; 4], of_four: true };

    /// A tire of a car none of whose others is warm has no more than the margin; where most are, it may be twice as warm, but
    /// not warmer than any can be. One that has lost air, or is misread, speaks for none of the others.
    #[test]
    fn tires_warm_up_together() {
        for (others, least) in [
            ([0.0, 0.0, 0.0], -0.02),
            ([0.1, 0.2, 0.3], -0.02),
            ([-0.02, -0.02, -0.02], -0.06),
            ([-0.02, 0.3, -0.02], -0.06),
            ([-0.02, 0.0, 0.0], -0.02),
            ([-0.05, -0.07, -0.06], -0.08),
        ] {
            for tire in Corner::ALL {
                let mut compliances = [f64::NAN; 4];
                tire.others().into_iter().zip(others).for_each(|(other, of)| compliances[other] = of);
                let found = FLOOR.of(tire, compliances);
                assert!((found - least).abs() < 1e-15, "{others:?}: {found}");
            }
        }
    }

    /// An axle alone does not show how warm most are.
    #[test]
    fn without_four_corners_each_is_by_itself() {
        let axle = Floor { of_four: false, ..FLOOR };
        assert_eq!(axle.of(Corner::FrontLeft, [0.0; 4]), -0.08);
    }

    /// 9 % of the air's part and the margin, in the end.
    #[test]
    fn warming_up_takes_minutes() {
        let floor = |since_s| Floor::<f64>::after(since_s, [0.0, 0.8, 0.9, 1.0], true).each;
        assert_eq!(floor(0.0), [-0.02; 4]);
        for (found, expected) in floor(1e6).iter().zip([-0.02, -0.092, -0.101, -0.11]) {
            assert!((found - expected).abs() < 1e-12);
        }
        assert!((floor(300.0)[3] + 0.02 + 0.09 * (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
    }
}
