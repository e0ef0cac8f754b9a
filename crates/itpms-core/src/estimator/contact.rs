//! Whether the wheel has left the ground: a tire pushes and does not pull, so no force below the one that carries the
//! corner's weight has anything to do with its stiffness (docs/math/informed.md, section 5).

use crate::intake::GridSample;
use crate::quarter_car::QuarterCar;
use crate::real::Real;

/// Gravity in m/s².
const GRAVITY_M_S2: f64 = 9.81;
/// Share of the corner's weight by which the force of the tire is less than at rest when the wheel has surely lifted, and
/// when it may have: the body's mass, its pitch and roll and the load are not known to the percent.
const LIFTED: f64 = 1.05;
const UNLOADED: f64 = 0.85;
/// A share that no load explains: this tire pulls, as in a simulation that does not let it go, and nothing ever lifts.
const PULLING: f64 = 2.0;
/// Seconds after which that is forgotten.
const PULLING_S: f64 = 60.0;
/// Seconds for which a spectrum is spoiled: frames between two jumps are those in which the wheel happens to hop little.
const LANDING_S: f64 = 0.5;

/// What a grid step shows of the wheel's hold on the road.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Contact {
    /// It may be in the air: this step is no word about the tire, its neighbours may be.
    pub(super) unloaded: bool,
    /// It surely was, now or a moment ago: no spectrum of such steps is that of a tire on its road.
    pub(super) hopping: bool,
}

/// The watch on one wheel.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ContactWatch<T> {
    sprung_mass_kg: T,
    unsprung_mass_kg: T,
    airborne_s: f64,
    pulling_s: f64,
}

impl<T: Real> ContactWatch<T> {
    pub(super) fn new(car: &QuarterCar<T>) -> Self {
        Self {
            sprung_mass_kg: car.sprung_mass_kg(),
            unsprung_mass_kg: car.unsprung_mass_kg(),
            airborne_s: f64::NEG_INFINITY,
            pulling_s: f64::NEG_INFINITY,
        }
    }

    /// Looks at a grid step: what accelerates both masses, beyond their weight, is the force of the tire.
    pub(super) fn look(&mut self, sample: &GridSample<T>) -> Contact {
        let force_n =
            self.sprung_mass_kg * sample.body_accel_m_s2 + self.unsprung_mass_kg * sample.wheel_accel_m_s2;
        let weight_n = (self.sprung_mass_kg + self.unsprung_mass_kg) * T::lit(GRAVITY_M_S2);
        if force_n < -weight_n * T::lit(PULLING) {
            self.pulling_s = sample.time_s;
        }
        if sample.time_s - self.pulling_s < PULLING_S {
            return Contact { unloaded: false, hopping: false };
        }
        if force_n < -weight_n * T::lit(LIFTED) {
            self.airborne_s = sample.time_s;
        }
        Contact {
            unloaded: force_n < -weight_n * T::lit(UNLOADED),
            hopping: sample.time_s - self.airborne_s < LANDING_S,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// What a watch says of tire forces, as shares of the weight, a tenth of a second apart.
    fn watched(forces: &[f64]) -> std::vec::Vec<Contact> {
        let car = QuarterCar::<f64>::paper_table_2();
        let mut watch = ContactWatch::new(&car);
        let weight_n = (car.sprung_mass_kg() + car.unsprung_mass_kg()) * GRAVITY_M_S2;
        let look = |(i, share): (usize, &f64)| {
            // The body takes a third of it.
            let force_n = share * weight_n;
            watch.look(&GridSample {
                time_s: 0.1 * i as f64,
                speed_m_s: 20.0,
                body_accel_m_s2: force_n / 3.0 / car.sprung_mass_kg(),
                wheel_accel_m_s2: force_n / 1.5 / car.unsprung_mass_kg(),
                spoiled: false,
                unloaded: false,
                after_gap: false,
            })
        };
        forces.iter().enumerate().map(look).collect()
    }

    /// Whether it may be in the air, and whether it surely was of late, step by step.
    fn seen(forces: &[f64]) -> (std::vec::Vec<bool>, std::vec::Vec<bool>) {
        watched(forces).iter().map(|contact| (contact.unloaded, contact.hopping)).unzip()
    }

    #[test]
    fn a_wheel_without_force_is_in_the_air_and_lands() {
        let forces = [0.0, 2.0, -0.8, -0.9, -1.0, -1.1, -1.06, -0.5, 1.5, 0.0, -0.86, 0.0, 0.0];
        let (unloaded, hopping) = seen(&forces);
        assert_eq!(unloaded, core::array::from_fn::<_, 13, _>(|i| [3, 4, 5, 6, 10].contains(&i)));
        // Surely lifted at 0.5 and 0.6 s, and half a second more.
        assert_eq!(hopping, core::array::from_fn::<_, 13, _>(|i| (5..11).contains(&i)));
    }

    #[test]
    fn a_tire_that_pulls_never_lifts_and_nothing_unknown_does() {
        assert_eq!(seen(&[-1.1, -2.1, -1.1, -1.2]).0, [true, false, false, false]);
        assert_eq!(seen(&[-1.1, -2.1, -1.1, -1.2]).1, [true, false, false, false]);
        assert_eq!(seen(&[f64::NAN, f64::NAN]), (std::vec![false; 2], std::vec![false; 2]));
    }
}
