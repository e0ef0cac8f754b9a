//! The air around the car: its temperature and its pressure, as a car measures them and as a height stands for it.

use core::ops::RangeInclusive;

use crate::memory::Blank;
use crate::real::Real;

/// The air around the car, as measured. NaN is a value that is not sent.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Air<T> {
    /// Temperature in degrees Celsius.
    pub ambient_temperature_c: T,
    /// Absolute pressure in kPa.
    pub barometric_kpa: T,
    /// Height above the sea in m, used where there is no barometer.
    pub altitude_m: T,
}

/// Plausible ranges on roads in degrees Celsius, kPa and m.
const TEMPERATURES_C: RangeInclusive<f64> = -60.0..=65.0;
const PRESSURES_KPA: RangeInclusive<f64> = 45.0..=110.0;
const ALTITUDES_M: RangeInclusive<f64> = -500.0..=6000.0;

impl<T: Real> Air<T> {
    /// Nothing is known of it.
    #[must_use]
    pub fn unknown() -> Self {
        let nothing = T::lit(f64::NAN);
        Self { ambient_temperature_c: nothing, barometric_kpa: nothing, altitude_m: nothing }
    }

    /// The same without what cannot be: a sensor that is not there or counts in another unit.
    #[must_use]
    pub fn plausible(&self) -> Self {
        let within = |value: T, range: RangeInclusive<f64>| {
            if range.contains(&value.to_f64()) { value } else { T::lit(f64::NAN) }
        };
        Self {
            ambient_temperature_c: within(self.ambient_temperature_c, TEMPERATURES_C),
            barometric_kpa: within(self.barometric_kpa, PRESSURES_KPA),
            altitude_m: within(self.altitude_m, ALTITUDES_M),
        }
    }
}

/// The standard atmosphere (ISO 2533) at sea level: pressure in kPa, temperature in K, its fall in K/m, and the exponent `g M / (R L)`.
pub(crate) const SEA_LEVEL_KPA: f64 = 101.325;
const SEA_LEVEL_K: f64 = 288.15;
const LAPSE_K_M: f64 = 0.0065;
const EXPONENT: f64 = 5.255_88;

/// Pressure in kPa of the standard atmosphere at a height in m above the sea, below 11 km (docs/math/cold-pressure.md, eq. 2).
#[must_use]
pub fn standard_atmosphere_kpa<T: Real>(altitude_m: T) -> T {
    let ratio = T::one() - T::lit(LAPSE_K_M / SEA_LEVEL_K) * altitude_m;
    T::lit(SEA_LEVEL_KPA) * (T::lit(EXPONENT) * ratio.ln_fast()).exp_fast()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_atmosphere_is_the_standards() {
        // ISO 2533, by geopotential heights.
        for (altitude_m, kpa) in
            [(0.0, 101.325), (500.0, 95.461), (1000.0, 89.876), (1500.0, 84.556), (3000.0, 70.109)]
        {
            let found: f64 = standard_atmosphere_kpa(altitude_m);
            assert!((found - kpa).abs() < 2e-3, "{altitude_m}: {found}");
            let single = standard_atmosphere_kpa(altitude_m as f32);
            assert!((f64::from(single) - kpa).abs() < 3e-3, "{altitude_m}: {single}");
        }
    }

    #[test]
    fn what_cannot_be_counts_as_missing() {
        // The 85 of a sensor that is missing, hPa and K for kPa and C.
        let odd: Air<f64> =
            Air { ambient_temperature_c: 263.15, barometric_kpa: 1013.0, altitude_m: 9000.0 }.plausible();
        assert!(
            [odd.ambient_temperature_c, odd.barometric_kpa, odd.altitude_m]
                .iter()
                .all(|value| value.is_nan())
        );
        let winter = Air { ambient_temperature_c: -10.0, barometric_kpa: 98.0, altitude_m: 300.0 };
        assert_eq!(winter.plausible(), winter);
    }
}
