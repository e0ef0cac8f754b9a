//! Which sensors belong together, from their moments: whose body follows which wheel, and whether the bodies move as one
//! plane (docs/math/monitor.md, section 3).

use nalgebra::{SMatrix, SVector};

use crate::diagnosis::signals::width_hz;
use crate::diagnosis::{BLOCK_S, Tuning};
use crate::model::{Corner, HOP_BAND_HZ};
use crate::real::Real;

pub(crate) const PAIRS: [[Corner; 2]; 6] = {
    let [fl, fr, rl, rr] = Corner::ALL;
    [[fl, fr], [fl, rl], [fl, rr], [fr, rl], [fr, rr], [rl, rr]]
};
/// Ridge added to the wheels' moments, as a share of their trace: roads that are alike must not blow up the regression.
const RIDGE: f64 = 1e-3;

/// Who follows whom, from the regression of the bodies on all four wheels in the hop band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Following<T> {
    /// For every pair of corners the logarithm of how much better each body follows its own wheel than the other's.
    /// Negative: two of the sensors are swapped.
    pub(crate) own_over_other: [T; 6],
    /// By how much each body follows its own wheel. Negative: one of the two is upside down.
    pub(crate) own: [T; 4],
    /// Standard deviation of that, from what no wheel explains of the body's motion.
    pub(crate) own_sd: [T; 4],
}

/// `None` for wheels that do not move.
pub(crate) fn following<T: Real>(hop: &SMatrix<T, 8, 8>, tuning: &Tuning) -> Option<Following<T>> {
    let mut wheels = hop.fixed_view::<4, 4>(4, 4).into_owned();
    let ridge = wheels.trace() * T::lit(RIDGE);
    for i in 0..4 {
        wheels[(i, i)] += ridge;
    }
    let wheels_by_bodies = hop.fixed_view::<4, 4>(4, 0).into_owned();
    // Column i: what makes body i move.
    let follows = wheels.cholesky()?.solve(&wheels_by_bodies);
    let of = |wheel: Corner, body: Corner| follows[(wheel.index(), body.index())];
    let square = |wheel, body| of(wheel, body) * of(wheel, body);
    // Where friction holds a strut, or an engine shakes the body, the wheels leave much of its motion unexplained. Two values per Hz and second are independent.
    let independent = T::lit(2.0 * width_hz(HOP_BAND_HZ) * BLOCK_S * tuning.hop_blocks);
    let own_sd = |i: usize| {
        let unexplained = hop[(i, i)] - follows.column(i).dot(&wheels_by_bodies.column(i));
        (unexplained.max(T::zero()) / (wheels[(i, i)] * independent)).sqrt()
    };
    let log = |[i, j]: [Corner; 2]| ((square(i, i) + square(j, j)) / (square(i, j) + square(j, i))).ln();
    Some(Following {
        own_over_other: PAIRS.map(log),
        own: [0, 1, 2, 3].map(|i| follows[(i, i)]),
        own_sd: [0, 1, 2, 3].map(own_sd),
    })
}

/// How the bodies' accelerations lie in one plane: `a_fl - a_fr - a_rl + a_rr` is zero for a rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Plane<T> {
    /// Power outside of the plane over the power of all, noise taken off.
    pub(crate) warp: T,
    /// The same if left and right of one axle were swapped.
    pub(crate) warp_sides: T,
    /// The same if front and rear of one side were swapped.
    pub(crate) warp_axles: T,
    /// The sensor whose gain would explain most of the warp, the share it explains, and the gain.
    pub(crate) culprit: Corner,
    pub(crate) explained: T,
    pub(crate) gain: T,
    /// That gain by the heave, as the sensors of the other diagonal have it: a sensor off its place reads more or less of pitch and roll, but all of the heave.
    pub(crate) heave_gain: T,
}

impl<T: Real> Plane<T> {
    /// Of the bodies' moments in the bounce band; `noise` is the sum of their noise powers there. `None` if there is too little but noise.
    pub(crate) fn of(bounce: &SMatrix<T, 4, 4>, noise: T) -> Option<Self> {
        let one = T::one();
        let all = bounce.trace();
        if !(all > T::lit(20.0) * noise && all.is_finite()) {
            return None;
        }
        let warp = SVector::<T, 4>::new(one, -one, -one, one);
        let power = |signs: &SVector<T, 4>| (signs.dot(&(bounce * signs)) - noise).max(T::zero()) / all;
        let with_each = bounce * warp;
        let out = warp.dot(&with_each);
        let (mut culprit, mut explained) = (Corner::FrontLeft, T::zero());
        for (i, corner) in Corner::ALL.into_iter().enumerate() {
            let share = with_each[i] * with_each[i] / (out * bounce[(i, i)]).max(T::lit(1e-12));
            if share > explained {
                (culprit, explained) = (corner, share);
            }
        }
        // r = s g a and m = (1 + g) a: r / m = s g / (1 + g).
        let i = culprit.index();
        let gain = |ratio: T| one / (one - warp[i] * ratio);
        let heave = bounce.column(culprit.same_axle().index()) + bounce.column(culprit.same_side().index());
        Some(Self {
            warp: power(&warp),
            warp_sides: power(&SVector::<T, 4>::new(-one, one, -one, one)),
            warp_axles: power(&SVector::<T, 4>::new(-one, -one, one, one)),
            culprit,
            explained,
            gain: gain(with_each[i] / bounce[(i, i)].max(T::lit(1e-12))),
            heave_gain: gain(warp.dot(&heave) / heave[i]),
        })
    }

    /// The sensor whose gain makes bodies warp that otherwise are a plane. Bodies that are none to begin with accuse no sensor.
    pub(crate) fn wrong_gain(&self, tuning: &Tuning) -> Option<Corner> {
        let left = (T::one() - self.explained) * self.warp;
        let explains = self.explained > T::lit(tuning.body_gain_explains);
        (explains && left < T::lit(tuning.left_warp)).then_some(self.culprit)
    }

    /// Whether the bodies would be one plane if those of this pair changed places.
    pub(crate) fn is_put_back_by(&self, [i, j]: [Corner; 2], tuning: &Tuning) -> bool {
        let left = match i {
            _ if i == j.same_axle() => self.warp_sides,
            _ if i == j.same_side() => self.warp_axles,
            // A diagonal that changes places leaves the warp as it is.
            _ => self.warp,
        };
        left < T::lit(tuning.left_warp)
    }

    /// The corners that, back in their places, would make the bodies one plane again, if no others would.
    pub(crate) fn changed_places(&self, tuning: &Tuning) -> Option<Changed> {
        let left = T::lit(tuning.left_warp).min(T::lit(tuning.restored_share) * self.warp);
        match [self.warp_sides < left, self.warp_axles < left] {
            _ if !(self.warp > T::lit(tuning.swapped_warp)) => None,
            [true, false] => Some(Changed::Sides),
            [false, true] => Some(Changed::Axles),
            _ => None,
        }
    }
}

/// Which corners are in each other's place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Changed {
    /// Left and right.
    Sides,
    /// Front and rear.
    Axles,
}

/// A corner's power over the median of the others'.
pub(crate) fn over_others<T: Real>(powers: &[T; 4], corner: Corner) -> T {
    powers[corner] / median(&mut corner.others().map(|other| powers[other]))
}

/// The value in the middle; of an even number the mean of the two there. NaN for nothing.
pub(crate) fn median<T: Real>(values: &mut [T]) -> T {
    values.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(core::cmp::Ordering::Equal));
    let n = values.len();
    match (values.get(n.saturating_sub(1) / 2), values.get(n / 2)) {
        (Some(&below), Some(&above)) => T::lit(0.5) * (below + above),
        _ => T::lit(f64::NAN),
    }
}

/// Values in their places, as many as there are or have room.
pub(crate) fn gathered<T: Real>(values: impl Iterator<Item = T>, places: &mut [T]) -> &mut [T] {
    let mut count = 0;
    for (place, value) in places.iter_mut().zip(values) {
        *place = value;
        count += 1;
    }
    places.get_mut(..count).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use nalgebra::Vector4;

    use super::*;
    use crate::random::Random;

    /// Moments of bodies that are moved so, as many independent times as two seconds of bounce have.
    fn plane(random: &mut Random, bodies: impl Fn(&mut Random) -> Vector4<f64>) -> Plane<f64> {
        let mut moments = SMatrix::<f64, 4, 4>::zeros();
        for _ in 0..12 {
            let moved = bodies(random);
            moments += moved * moved.transpose();
        }
        Plane::of(&moments, 0.0).unwrap()
    }

    /// A rigid body that heaves, pitches and rolls, and warps by a fiftieth of that; one sensor with a gain.
    fn rigid(random: &mut Random, at: usize, gain: f64) -> Vector4<f64> {
        let [heave, pitch, roll, warp] = core::array::from_fn(|_| random.normal());
        let warp = 0.02 * warp;
        let mut bodies = Vector4::new(
            heave + pitch + roll + warp,
            heave + pitch - roll - warp,
            heave - pitch + roll - warp,
            heave - pitch - roll + warp,
        );
        bodies[at] *= gain;
        bodies
    }

    /// Bodies that follow their own wheels by 0.8 and are shaken besides, as loudly as that: of many regressions over as many times as the moments hold, each
    /// coefficient has the spread that is stated.
    #[test]
    fn a_body_that_is_shaken_follows_its_wheel_as_well_as_is_stated() {
        let mut random = Random(11);
        let (mut sum, mut squares, mut stated) = (0.0, 0.0, 0.0);
        let runs = 400.0;
        for _ in 0..runs as u32 {
            let mut moments = SMatrix::<f64, 8, 8>::zeros();
            for _ in 0..144 {
                let wheels = Vector4::from_fn(|_, _| random.normal());
                let bodies = wheels * 0.8 + Vector4::from_fn(|_, _| 0.8 * random.normal());
                let mut all = SVector::<f64, 8>::zeros();
                all.fixed_rows_mut::<4>(0).copy_from(&bodies);
                all.fixed_rows_mut::<4>(4).copy_from(&wheels);
                moments += all * all.transpose();
            }
            let Following { own, own_sd, .. } = following(&moments, &Tuning::DEFAULT).unwrap();
            (sum, squares) = (sum + own[2], squares + own[2] * own[2]);
            stated += own_sd[2] / runs;
        }
        let mean = sum / runs;
        let spread = (squares / runs - mean * mean).sqrt();
        assert!(
            (mean - 0.8).abs() < 0.02 && (spread / stated - 1.0).abs() < 0.15,
            "{mean} {spread} {stated}"
        );
    }

    #[test]
    fn a_wrong_gain_of_a_rigid_body_is_blamed_on_its_sensor() {
        let mut random = Random(5);
        for gain in [0.5, 0.7, 1.5, 2.0] {
            for i in 0..200 {
                let plane = plane(&mut random, |random| rigid(random, i % 4, gain));
                assert_eq!(plane.wrong_gain(&Tuning::DEFAULT), Some(Corner::ALL[i % 4]), "{gain}: {plane:?}");
                // The warp takes part: a fiftieth of the motion.
                assert!((plane.gain / gain).ln().abs() < 0.15, "{gain}: {plane:?}");
            }
        }
    }

    /// Front left two fifths of the way off to the center of gravity reads 0.6 of pitch and roll, so `g = -0.4 (p + r)`. With a heave of 0.3 the readings of the
    /// other end of its diagonal, `h - p - r`, explain most of that: by them it has a gain of 1/(1 - 0.4 * 2/(0.3² + 2)), by the heave none.
    #[test]
    fn a_sensor_off_its_place_has_no_gain_by_the_heave() {
        let mut random = Random(9);
        let mut moments = SMatrix::<f64, 4, 4>::zeros();
        for _ in 0..40_000 {
            let [heave, pitch, roll] = [0.3, 1.0, 1.0].map(|sd| sd * random.normal());
            let moved = Vector4::new(
                heave + 0.6 * (pitch + roll),
                heave + pitch - roll,
                heave - pitch + roll,
                heave - pitch - roll,
            );
            moments += moved * moved.transpose();
        }
        let plane = Plane::of(&moments, 0.0).unwrap();
        assert_eq!(plane.wrong_gain(&Tuning::DEFAULT), Some(Corner::RearRight), "{plane:?}");
        assert!((plane.gain - 2.09 / 1.29).abs() < 0.02, "{plane:?}");
        assert!((plane.heave_gain - 1.0).abs() < 0.04, "{plane:?}");
    }

    #[test]
    fn corners_in_each_other_s_place_are_reported() {
        let mut random = Random(7);
        for _ in 0..200 {
            let sides = plane(&mut random, |random| {
                let bodies = rigid(random, 0, 1.0);
                Vector4::new(bodies[1], bodies[0], bodies[2], bodies[3])
            });
            assert_eq!(sides.changed_places(&Tuning::DEFAULT), Some(Changed::Sides), "{sides:?}");
            let axles = plane(&mut random, |random| {
                let bodies = rigid(random, 0, 1.0);
                Vector4::new(bodies[2], bodies[1], bodies[0], bodies[3])
            });
            assert_eq!(axles.changed_places(&Tuning::DEFAULT), Some(Changed::Axles), "{axles:?}");
            assert_eq!(
                plane(&mut random, |random| rigid(random, 0, 1.0)).changed_places(&Tuning::DEFAULT),
                None
            );
        }
    }

    #[test]
    fn only_bodies_that_are_swapped_are_put_back() {
        let mut random = Random(8);
        for _ in 0..200 {
            for (pair, [i, j]) in
                PAIRS.into_iter().enumerate().filter(|(_, [i, j])| i.index() + j.index() != 3)
            {
                let swapped = plane(&mut random, |random| {
                    let mut bodies = rigid(random, 0, 1.0);
                    bodies.swap_rows(i.index(), j.index());
                    bodies
                });
                let back: Vec<bool> =
                    PAIRS.into_iter().map(|pair| swapped.is_put_back_by(pair, &Tuning::DEFAULT)).collect();
                // Which of an axle's or a side's two pairs it is the plane cannot tell.
                assert!(back[pair] && back[5 - pair], "{back:?}");
                assert_eq!(back.iter().filter(|back| **back).count(), 2, "{back:?}");
            }
            // Half of the power is the body's own twist.
            let twisting = plane(&mut random, |random| {
                let twist = 2.0 * random.normal();
                rigid(random, 0, 1.0) + Vector4::new(twist, -twist, -twist, twist)
            });
            assert!(
                PAIRS.into_iter().all(|pair| !twisting.is_put_back_by(pair, &Tuning::DEFAULT)),
                "{twisting:?}"
            );
        }
    }

    #[test]
    fn four_bodies_that_are_not_one_have_nobody_to_blame() {
        let mut random = Random(6);
        let mut tempting = 0;
        for _ in 0..20_000 {
            let plane = plane(&mut random, |random| Vector4::from_fn(|_, _| random.normal()));
            tempting += u32::from(plane.explained > Tuning::DEFAULT.body_gain_explains);
            assert_eq!(
                (plane.wrong_gain(&Tuning::DEFAULT), plane.changed_places(&Tuning::DEFAULT)),
                (None, None),
                "{plane:?}"
            );
        }
        // What one of four signals explains of their sum by chance.
        assert!(tempting > 100, "{tempting}");
    }
}
