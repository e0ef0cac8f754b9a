//! Whether the wheel has left the ground: a tire pushes and does not pull, so no force below the one that carries the
//! corner's weight has anything to do with its stiffness (docs/math/informed.md, section 5).

use crate::conditioning::GridSample;
use crate::memory::Blank;
use crate::model::QuarterCar;
use crate::real::Real;

const GRAVITY_M_S2: f64 = 9.81;
/// Share of the corner's weight by which the force of the tire is less than at rest when the wheel has surely lifted, and
/// when it may have: the body's mass, its pitch and roll and the load are not known to the percent.
const LIFTED: f64 = 1.05;
const UNLOADED: f64 = 0.85;
/// A share that no load explains: this tire pulls, as in a simulation that does not let it go, and nothing ever lifts.
const PULLING: f64 = 2.0;
const PULLING_S: f64 = 60.0;
/// Gravity may be in or out. Time constant in s of a sensor's mean, the longest step that counts, the least time it is taken
/// over, and the mean in m/s² from which on it is an offset and nothing that a road does for so long.
const OFFSET_S: f64 = 5.0;
const LONGEST_STEP_S: f64 = 0.1;
const LEAST_S: f64 = 1.0;
const OFFSET_M_S2: f64 = 4.0;
/// Seconds for which a spectrum is invalid: frames between two jumps are those in which the wheel happens to hop little.
const LANDING_S: f64 = 0.5;

/// Contact of the wheel with the road at a grid step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Contact {
    /// It may be in the air: the tire equation does not hold at this step; at its neighbours it may.
    pub(crate) unloaded: bool,
    /// It surely was, now or a moment ago: no spectrum of such steps is that of a tire on its road.
    pub(crate) hopping: bool,
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ContactWatch<T> {
    sprung_mass_kg: T,
    unsprung_mass_kg: T,
    /// Means of body and wheel in m/s², and over how many seconds (up to [`OFFSET_S`]).
    means: [T; 2],
    watched_s: T,
    /// The part of them that is taken for an offset.
    offsets: [T; 2],
    /// Seconds for which the wheel still counts as hopping, and the tire as one that pulls.
    hopping_s: T,
    pulling_s: T,
}

impl<T: Real> ContactWatch<T> {
    pub(crate) fn new(car: &QuarterCar<T>) -> Self {
        Self { sprung_mass_kg: car.sprung_mass_kg(), unsprung_mass_kg: car.unsprung_mass_kg(), ..Self::BLANK }
    }

    /// Looks at a grid step: what accelerates both masses, beyond their weight, is the force of the tire.
    pub(crate) fn look(&mut self, sample: &GridSample<T>) -> Contact {
        let [body, wheel] = self.without_offsets(sample);
        let force_n = self.sprung_mass_kg * body + self.unsprung_mass_kg * wheel;
        let weight_n = (self.sprung_mass_kg + self.unsprung_mass_kg) * T::lit(GRAVITY_M_S2);
        if force_n < -weight_n * T::lit(PULLING) {
            self.pulling_s = T::lit(PULLING_S);
        }
        if self.pulling_s > T::zero() {
            return Contact { unloaded: false, hopping: false };
        }
        if force_n < -weight_n * T::lit(LIFTED) {
            self.hopping_s = T::lit(LANDING_S);
        }
        Contact { unloaded: force_n < -weight_n * T::lit(UNLOADED), hopping: self.hopping_s > T::zero() }
    }

    /// Both accelerations without what the sensors always show. Small means are left alone: they are the road's.
    fn without_offsets(&mut self, sample: &GridSample<T>) -> [T; 2] {
        let readings = [sample.body_accel_m_s2, sample.wheel_accel_m_s2];
        let seconds = sample.step_s;
        if seconds > T::zero() {
            self.pulling_s -= seconds;
            self.hopping_s -= seconds;
            let seconds = seconds.at_most(T::lit(LONGEST_STEP_S));
            self.watched_s = (self.watched_s + seconds).at_most(T::lit(OFFSET_S));
            let share = seconds / self.watched_s;
            for (mean, reading) in self.means.iter_mut().zip(readings) {
                if reading.is_finite() {
                    *mean += (reading - *mean) * share;
                }
            }
        }
        if self.watched_s >= T::lit(LEAST_S) {
            let offset = |mean: T| if mean.abs() > T::lit(OFFSET_M_S2) { mean } else { T::zero() };
            let before = core::mem::replace(&mut self.offsets, self.means.map(offset));
            let is_new = |(before, now): (&T, &T)| (*before == T::zero()) != (*now == T::zero());
            if before.iter().zip(&self.offsets).any(is_new) {
                // The statistics so far were made of wrong forces.
                (self.pulling_s, self.hopping_s) = (T::zero(), T::zero());
            }
        }
        core::array::from_fn(|i| readings[i] - self.offsets[i])
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// A grid step of these accelerations, so many s after the one before.
    fn step(step_s: f64, [body_accel_m_s2, wheel_accel_m_s2]: [f64; 2]) -> GridSample<f64> {
        let (invalid, unloaded, after_gap) = (false, false, false);
        GridSample {
            time_s: 0.0,
            step_s,
            speed_m_s: 20.0,
            body_accel_m_s2,
            wheel_accel_m_s2,
            invalid,
            unloaded,
            after_gap,
        }
    }

    /// What accelerates body and wheel so that the tire has this force; the body takes a third of it.
    fn accelerations(car: &QuarterCar<f64>, force_n: f64) -> [f64; 2] {
        [force_n / 3.0 / car.sprung_mass_kg(), force_n / 1.5 / car.unsprung_mass_kg()]
    }

    /// What a watch says of tire forces, as shares of the weight, an eighth of a second apart.
    fn watched(forces: &[f64]) -> std::vec::Vec<Contact> {
        let car = QuarterCar::<f64>::paper_table_2();
        let mut watch = ContactWatch::new(&car);
        let weight_n = (car.sprung_mass_kg() + car.unsprung_mass_kg()) * GRAVITY_M_S2;
        let look = |(i, share): (usize, &f64)| {
            watch.look(&step(if i == 0 { 0.0 } else { 0.125 }, accelerations(&car, share * weight_n)))
        };
        forces.iter().enumerate().map(look).collect()
    }

    #[test]
    fn gravity_may_be_in_or_out_of_either_sensor() {
        let car = QuarterCar::<f64>::paper_table_2();
        let weight_n = (car.sprung_mass_kg() + car.unsprung_mass_kg()) * GRAVITY_M_S2;
        let lifts = |offsets: [f64; 2]| -> std::vec::Vec<Contact> {
            let mut watch = ContactWatch::new(&car);
            // Hops of 1.2 weights, 11 a second, at 200 Hz: airborne at the top of each.
            let hop = |i: u32| {
                let time_s = 0.005 * f64::from(i);
                let force_n = 1.2 * weight_n * (core::f64::consts::TAU * 11.0 * time_s).sin();
                let [body, wheel] = accelerations(&car, force_n);
                watch.look(&step(0.005, [body + offsets[0], wheel + offsets[1]]))
            };
            (0..20_000).map(hop).collect()
        };
        let plain = lifts([0.0; 2]);
        let share = plain.iter().filter(|contact| contact.unloaded).count() as f64 / plain.len() as f64;
        // A sine is below -0.85/1.2 of its amplitude for a quarter of the time.
        assert!((share - 0.25).abs() < 0.01, "{share}");
        // Found after a second, to the digit after some more.
        for offsets in [[9.81, 9.81], [-9.81, -9.81], [9.81, 0.0], [0.0, -9.81], [-40.0, 40.0]] {
            let with = lifts(offsets);
            let settled = 2_000;
            let unlike = plain.iter().zip(&with).skip(settled).filter(|(a, b)| a != b).count();
            assert!(unlike <= (plain.len() - settled) / 50, "{offsets:?}: {unlike}");
        }
        // A mean that a road may have is left alone, to the last bit.
        let mut watch = ContactWatch::new(&car);
        for _ in 0..10_000 {
            let sample = step(0.005, [3.9, -3.9]);
            assert_eq!(watch.without_offsets(&sample), [3.9, -3.9]);
        }
    }

    /// Whether it may be in the air, and whether it surely was of late, step by step.
    fn seen(forces: &[f64]) -> (std::vec::Vec<bool>, std::vec::Vec<bool>) {
        watched(forces).iter().map(|contact| (contact.unloaded, contact.hopping)).unzip()
    }

    #[test]
    fn a_wheel_without_force_is_in_the_air_and_lands() {
        let mut forces = [0.0; 63];
        // Six seconds of an even road first.
        forces[50..62]
            .copy_from_slice(&[0.0, 2.0, -0.8, -0.9, -1.0, -1.1, -1.06, -0.5, 1.5, 0.0, -0.86, 0.0]);
        let (unloaded, hopping) = seen(&forces);
        assert_eq!(unloaded, core::array::from_fn::<_, 63, _>(|i| [53, 54, 55, 56, 60].contains(&i)));
        // Surely lifted in two steps, and for half a second, four steps, from the second one on.
        assert_eq!(hopping, core::array::from_fn::<_, 63, _>(|i| (55..60).contains(&i)));
    }

    #[test]
    fn a_tire_that_pulls_never_lifts_and_nothing_unknown_does() {
        assert_eq!(seen(&[-1.1, -2.1, -1.1, -1.2]).0, [true, false, false, false]);
        assert_eq!(seen(&[-1.1, -2.1, -1.1, -1.2]).1, [true, false, false, false]);
        assert_eq!(seen(&[f64::NAN, f64::NAN]), (std::vec![false; 2], std::vec![false; 2]));
    }
}
