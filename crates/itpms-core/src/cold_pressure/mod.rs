//! How warm the tires are, and the pressures that they would have cold; from a cold pressure back to what a tire should have, as warm as it is.
//!
//! Called by the monitor ten times a second with the speed, and with the air around the car as measured. Knows no estimator; without an air
//! temperature nothing is estimated. Derivation: docs/math/cold-pressure.md.
//!
//! | module | idea |
//! |---|---|
//! | `warm_up` | by how much driving has warmed the tires above the air |

#[cfg(test)]
mod drawn;
mod warm_up;

pub(crate) use self::warm_up::STANDING_S;
use self::warm_up::WarmUp;
use crate::conditioning::pauses::PAUSE_S;
use crate::memory::Blank;
use crate::model::{Air, ColdPressure, standard_atmosphere_kpa};
use crate::real::Real;

/// A temperature in K that is zero degrees Celsius.
const ZERO_C_K: f64 = 273.15;
/// For how long in s the last temperature and the last pressure of the air go on: they are sent seldom and change slowly.
const HELD_S: f64 = 1800.0;
/// Standard deviations in kPa of the air's pressure: by a barometer; by a height, which knows no weather; unknown, as of places up to 300 m and
/// their weather.
const BAROMETER_SD_KPA: f64 = 0.5;
const ALTITUDE_SD_KPA: f64 = 1.2;
const UNKNOWN_SD_KPA: f64 = 3.5;

/// Standard deviations of its warmth by which a tire is expected to be colder than it should be: a reference that is too high warns of air that
/// is there.
const CAUTION_SD: f64 = 0.25;

/// A value that was sent, and how long ago.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Sent<T> {
    /// NaN until one was.
    value: T,
    /// Below zero where it has come since the last step.
    age_s: f64,
}

/// The age in s of a value that has just come.
const NEW_S: f64 = -1.0;

impl<T: Real> Sent<T> {
    fn nothing() -> Self {
        Self { value: T::lit(f64::NAN), age_s: NEW_S }
    }

    fn take(&mut self, value: T) {
        if value.is_finite() {
            *self = Self { value, age_s: NEW_S };
        }
    }

    fn grow_older(&mut self, step_s: f64) {
        self.age_s = if self.age_s < 0.0 { 0.0 } else { self.age_s + step_s };
    }

    fn get(&self) -> Option<T> {
        (self.value.is_finite() && self.age_s <= HELD_S).then_some(self.value)
    }
}

/// The temperature of a car's tires. See the [module](self).
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ColdTires<T> {
    /// Pressure of the air in kPa where the tires are filled.
    home_kpa: T,
    ambient_c: Sent<T>,
    barometric_kpa: Sent<T>,
    altitude_m: Sent<T>,
    warm_up: WarmUp<T>,
}

impl<T: Real> ColdTires<T> {
    /// Tires of which nothing is known, that are filled where the air has this pressure in kPa.
    pub(crate) fn new(home_kpa: T) -> Self {
        let (ambient_c, barometric_kpa, altitude_m) = (Sent::nothing(), Sent::nothing(), Sent::nothing());
        Self { home_kpa, ambient_c, barometric_kpa, altitude_m, warm_up: WarmUp::new() }
    }

    /// Takes air temperature, barometer and height as measured; impossible values count as missing.
    pub(crate) fn take(&mut self, air: &Air<T>) {
        let air = air.plausible();
        self.ambient_c.take(air.ambient_temperature_c);
        self.barometric_kpa.take(air.barometric_kpa);
        self.altitude_m.take(air.altitude_m);
    }

    /// So many seconds have passed at this speed in m/s, NaN where it is not known.
    pub(crate) fn advance(&mut self, step_s: f64, speed_m_s: T) {
        if !(step_s > 0.0 && step_s.is_finite()) {
            return;
        }
        let Self { ambient_c, barometric_kpa, altitude_m, .. } = self;
        [ambient_c, barometric_kpa, altitude_m].into_iter().for_each(|sent| sent.grow_older(step_s));
        let speed_m_s = if step_s > PAUSE_S { T::zero() } else { speed_m_s };
        self.warm_up.advance(step_s, speed_m_s, self.ambient_c.get());
    }

    pub(crate) fn is_known(&self) -> bool {
        self.ambient_c.get().is_some()
    }

    /// Cold pressure of a tire of this pressure with its sd, in kPa.
    pub(crate) fn cold(&self, pressure_kpa: T, sd_kpa: T) -> Option<ColdPressure<T>> {
        let ambient_temperature_c = self.ambient_c.get()?;
        let ambient_k = ambient_temperature_c + T::lit(ZERO_C_K);
        let [excess_k, excess_sd_k] = self.warm_up.excess_k(ambient_temperature_c);
        let [barometric_kpa, barometric_sd_kpa] = self.barometric();
        let tire_k = ambient_k + excess_k;
        let ratio = ambient_k / tire_k;
        let absolute_kpa = ratio * (pressure_kpa + barometric_kpa);
        let of_warmth = absolute_kpa / tire_k * excess_sd_k;
        let variance =
            ratio * ratio * (sd_kpa * sd_kpa + barometric_sd_kpa * barometric_sd_kpa) + of_warmth * of_warmth;
        Some(ColdPressure {
            pressure_kpa: absolute_kpa - self.home_kpa,
            sd_kpa: variance.sqrt(),
            ambient_temperature_c,
        })
    }

    /// Expected warm pressure in kPa of a tire with this cold pressure, less [`CAUTION_SD`] sds of the warming.
    pub(crate) fn expected_kpa(&self, cold_kpa: T) -> Option<T> {
        let ambient_c = self.ambient_c.get()?;
        let ambient_k = ambient_c + T::lit(ZERO_C_K);
        let [excess_k, excess_sd_k] = self.warm_up.excess_k(ambient_c);
        // A tire that may be colder than the air is taken to be as cold as that.
        let excess_k = (excess_k - T::lit(CAUTION_SD) * excess_sd_k).max(excess_k.min(T::zero()));
        let [barometric_kpa, _] = self.barometric();
        Some((cold_kpa + self.home_kpa) * (ambient_k + excess_k) / ambient_k - barometric_kpa)
    }

    fn barometric(&self) -> [T; 2] {
        if let Some(kpa) = self.barometric_kpa.get() {
            return [kpa, T::lit(BAROMETER_SD_KPA)];
        }
        match self.altitude_m.get() {
            Some(altitude_m) => [standard_atmosphere_kpa(altitude_m), T::lit(ALTITUDE_SD_KPA)],
            None => [self.home_kpa, T::lit(UNKNOWN_SD_KPA)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::SEA_LEVEL_KPA;

    fn air(ambient_temperature_c: f64, barometric_kpa: f64) -> Air<f64> {
        Air { ambient_temperature_c, barometric_kpa, ..Air::unknown() }
    }

    fn driven(air: &Air<f64>, seconds: u32, speed_m_s: f64) -> ColdTires<f64> {
        let mut tires = ColdTires::new(SEA_LEVEL_KPA);
        for _ in 0..10 * seconds {
            tires.take(air);
            tires.advance(0.1, speed_m_s);
        }
        tires
    }

    #[test]
    fn tires_that_stood_for_long_are_as_cold_as_the_air() {
        // Filled to 240 kPa at 20 C at sea level: by the gas law 341.325 kPa * T / 293.15 K - 101.325 kPa.
        let tires = driven(&air(-10.0, SEA_LEVEL_KPA), 7200, 0.0);
        let gauge_kpa = 341.325 * 263.15 / 293.15 - 101.325;
        let cold = tires.cold(gauge_kpa, 3.0).unwrap();
        assert!(
            (cold.pressure_kpa - 205.07).abs() < 0.01 && (cold.pressure_kpa - gauge_kpa).abs() < 1e-9,
            "{cold:?}"
        );
        // The sensor of the air, and of its pressure, beside the pressure's own.
        let of_air = 306.395 / 263.15 * 1.5;
        assert!((cold.sd_kpa - (9.0f64 + 0.25 + of_air * of_air).sqrt()).abs() < 0.05, "{cold:?}");
    }

    #[test]
    fn a_warm_tire_has_less_when_cold() {
        // 100 km/h for two hours: 22 K above the air, known to 30 %.
        let tires = driven(&air(0.0, SEA_LEVEL_KPA), 7200, 100.0 / 3.6);
        let warm_kpa = 341.325 * 295.15 / 273.15 - 101.325;
        let cold = tires.cold(warm_kpa, 0.0).unwrap();
        assert!((cold.pressure_kpa - 240.0).abs() < 0.01, "{cold:?}");
        let sd_kpa = 341.325 / 295.15 * (6.6f64 * 6.6 + 1.5 * 1.5).sqrt();
        assert!((cold.sd_kpa - (sd_kpa * sd_kpa + 0.25).sqrt()).abs() < 0.05, "{cold:?} {sd_kpa}");
        // And back, a little less warm.
        let expected_kpa = tires.expected_kpa(240.0).unwrap();
        let less_kpa = CAUTION_SD * sd_kpa * 295.15 / 273.15;
        assert!((expected_kpa - (warm_kpa - less_kpa)).abs() < 0.05, "{expected_kpa}");
    }

    #[test]
    fn on_a_pass_a_gauge_shows_more() {
        let barometer_kpa = standard_atmosphere_kpa(1400.0);
        let by_barometer = driven(&air(20.0, barometer_kpa), 7200, 0.0);
        let altitude = Air { ambient_temperature_c: 20.0, altitude_m: 1400.0, ..Air::unknown() };
        let by_altitude = driven(&altitude, 7200, 0.0);
        let gauge_kpa = 240.0 + SEA_LEVEL_KPA - barometer_kpa;
        assert!((gauge_kpa - 255.7).abs() < 0.1);
        for tires in [by_barometer, by_altitude] {
            assert!((tires.cold(gauge_kpa, 1.0).unwrap().pressure_kpa - 240.0).abs() < 1e-9);
            assert!((tires.expected_kpa(240.0).unwrap() - gauge_kpa).abs() < 1e-9);
        }
        // Of a car at home up there the same tire is as it should be at 240 kPa.
        let mut home = ColdTires::new(barometer_kpa);
        home.take(&altitude);
        assert!((home.cold(240.0, 1.0).unwrap().pressure_kpa - 240.0).abs() < 1e-9);
        // Without either the place is unknown.
        let nowhere = driven(&air(20.0, f64::NAN), 7200, 0.0);
        let cold = nowhere.cold(240.0, 0.0).unwrap();
        assert!((cold.pressure_kpa - 240.0).abs() < 1e-9 && cold.sd_kpa > UNKNOWN_SD_KPA);
    }

    #[test]
    fn without_a_temperature_nothing_is_reported_and_the_last_one_goes_on_for_a_while() {
        let mut tires = driven(&air(f64::NAN, 100.0), 60, 20.0);
        assert!(!tires.is_known() && tires.cold(240.0, 3.0).is_none() && tires.expected_kpa(240.0).is_none());
        tires.take(&air(95.0, 100.0));
        assert!(!tires.is_known());
        tires.take(&air(5.0, 100.0));
        // However long ago the sample before it was.
        tires.advance(10_000.0, 20.0);
        tires.advance(HELD_S, 20.0);
        assert!(tires.is_known());
        tires.advance(1.0, 20.0);
        assert!(!tires.is_known());
    }

    #[test]
    fn single_precision_says_the_same() {
        let mut tires = ColdTires::<f32>::new(101.325);
        for _ in 0..36_000 {
            tires.take(&Air { ambient_temperature_c: -5.0, barometric_kpa: 95.0, altitude_m: f32::NAN });
            tires.advance(0.1, 30.0);
        }
        let double = driven(&air(-5.0, 95.0), 3600, 30.0).cold(230.0, 4.0).unwrap();
        let single = tires.cold(230.0, 4.0).unwrap();
        assert!((f64::from(single.pressure_kpa) - double.pressure_kpa).abs() < 0.1, "{single:?} {double:?}");
        assert!((f64::from(single.sd_kpa) - double.sd_kpa).abs() < 0.05, "{single:?} {double:?}");
    }
}
