//! The quarter car: one sprung and one unsprung mass, a linear spring and damper between them, a tire as a
//! spring to the road (paper eq. 1-4, Fig. 2).
//!
//! Asked for by every filter and estimator; knows nothing of pressure, time or sensors.

use thiserror::Error;

use crate::memory::Blank;
use crate::real::Real;

/// A parameter outside its physical range.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{name} is {value}, expected {expected}")]
pub struct ParameterError {
    /// The parameter's name with its unit, as in the vehicle file.
    pub name: &'static str,
    /// The given value.
    pub value: f64,
    /// Accepted values.
    pub expected: &'static str,
}

/// A value from here on, in any of our units, is none of a car: what is made of it would be infinite.
const LARGEST: f64 = 1e9;

/// `value` if it is positive and below 1e9 (NaN is neither).
///
/// # Errors
/// It is not; the error calls it `name`.
pub fn positive<T: Real>(name: &'static str, value: T) -> Result<T, ParameterError> {
    if value > T::zero() && value < T::lit(LARGEST) {
        Ok(value)
    } else {
        Err(ParameterError { name, value: value.to_f64(), expected: "a positive number below 1e9" })
    }
}

/// Parameters of one corner of the car, valid by construction.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct QuarterCar<T> {
    sprung_mass_kg: T,
    unsprung_mass_kg: T,
    damping_n_s_per_m: T,
    spring_n_per_m: T,
}

impl<T: Real> QuarterCar<T> {
    /// A quarter car of sprung mass `m_b`, unsprung mass `m_w` (kg), damping `c_s` (N s/m) and suspension spring `k_s` (N/m).
    ///
    /// # Errors
    /// Names the first parameter that is not a positive number below 1e9.
    pub fn new(
        sprung_mass_kg: T,
        unsprung_mass_kg: T,
        damping_n_s_per_m: T,
        spring_n_per_m: T,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            sprung_mass_kg: positive("sprung_mass_kg", sprung_mass_kg)?,
            unsprung_mass_kg: positive("unsprung_mass_kg", unsprung_mass_kg)?,
            damping_n_s_per_m: positive("damping_n_s_per_m", damping_n_s_per_m)?,
            spring_n_per_m: positive("spring_n_per_m", spring_n_per_m)?,
        })
    }

    /// The paper's simulated corner (Table 2).
    #[must_use]
    pub fn paper_table_2() -> Self {
        Self {
            sprung_mass_kg: T::lit(240.8),
            unsprung_mass_kg: T::lit(56.9),
            damping_n_s_per_m: T::lit(925.8),
            spring_n_per_m: T::lit(29_114.0),
        }
    }

    /// Sprung mass `m_b` in kg.
    pub fn sprung_mass_kg(&self) -> T {
        self.sprung_mass_kg
    }

    /// Unsprung mass `m_w` in kg.
    pub fn unsprung_mass_kg(&self) -> T {
        self.unsprung_mass_kg
    }

    /// Damping `c_s` in N s/m.
    pub fn damping_n_s_per_m(&self) -> T {
        self.damping_n_s_per_m
    }

    /// Suspension spring `k_s` in N/m.
    pub fn spring_n_per_m(&self) -> T {
        self.spring_n_per_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_outside_its_range_is_named() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(QuarterCar::new(bad, 50.0, 900.0, 3e4).unwrap_err().name, "sprung_mass_kg");
            assert_eq!(QuarterCar::new(240.0, bad, 900.0, 3e4).unwrap_err().name, "unsprung_mass_kg");
            assert_eq!(QuarterCar::new(240.0, 50.0, bad, 3e4).unwrap_err().name, "damping_n_s_per_m");
            assert_eq!(QuarterCar::new(240.0, 50.0, 900.0, bad).unwrap_err().name, "spring_n_per_m");
        }
    }
}
