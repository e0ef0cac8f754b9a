//! Forgetting on one scalar parameter: the factor of eq. (28)-(33) drawn from the parameter's own innovations.
//! Derivation: `docs/math/forgetting.md`, section 4.
//!
//! Called by [`crate::aekf_ui_informed`] for the tire stiffness; knows nothing of cars.

use itpms_core::Real;
use itpms_core::model::ParameterError;

#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ParameterForgetting<T> {
    /// Never: only the parameter's random walk lets it move.
    Off,
    Adaptive {
        /// Number of measurements over which the innovation's variance is averaged while nothing changes; infinite as published.
        memory: T,
        /// Standard errors by which the measured variance must exceed the believed one; 0 as published.
        significance: T,
    },
}

impl<T: Real> ParameterForgetting<T> {
    /// Equations (28)-(33) as they are: memory without end, every excess counts.
    pub fn published() -> Self {
        ParameterForgetting::Adaptive { memory: T::lit(f64::INFINITY), significance: T::zero() }
    }

    /// Itself, if it makes sense. Errors: the memory must be at least 2 measurements, the significance finite and not negative.
    pub fn validated(self) -> Result<Self, ParameterError> {
        if let ParameterForgetting::Adaptive { memory, significance } = self {
            if !(memory >= T::lit(2.0)) {
                return Err(ParameterError {
                    name: "forgetting memory in measurements",
                    value: memory.to_f64(),
                    expected: "2 or more",
                });
            }
            if !(significance >= T::zero() && significance.is_finite()) {
                return Err(ParameterError {
                    name: "forgetting significance",
                    value: significance.to_f64(),
                    expected: "a finite number, zero or more",
                });
            }
        }
        Ok(self)
    }
}

/// Fading sums of squared innovations, each weighted by the information `1/R` of its measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParameterMemory<T> {
    G_1: T,
    G_2: T,
    count: T,
    lambda: T,
}

impl<T: Real> Default for ParameterMemory<T> {
    fn default() -> Self {
        Self { G_1: T::zero(), G_2: T::zero(), count: T::zero(), lambda: T::one() }
    }
}

impl<T: Real> ParameterMemory<T> {
    /// The factor for the parameter's prior variance `P`, after an innovation `nu` against a measurement of
    /// variance `R` (all in the parameter's units, squared where a variance).
    pub fn take_in(&mut self, settings: &ParameterForgetting<T>, nu: T, R: T, P: T) -> T {
        let ParameterForgetting::Adaptive { memory, significance } = *settings else {
            return T::one();
        };
        // What is left of the sums: 1/λ of (51), less what a finite memory loses with each measurement.
        let keep = (T::one() - T::one() / memory) / self.lambda;
        let weight = T::one() / R;
        // (51)  G₁ = G₁/λ + w ν²,  w = 1/R
        self.G_1 = self.G_1 * keep + weight * nu * nu;
        // (51)  G₂ = G₂/λ + w
        self.G_2 = self.G_2 * keep + weight;
        self.count = self.count * keep + T::one();
        // (51)  C₀ = G₁/G₂, and the mean measurement variance weighted alike
        let C_0 = self.G_1 / self.G_2;
        let R_mean = self.count / self.G_2;
        // (52)  standard error of C₀ if the belief P + R were right
        let error = (T::lit(2.0) / self.count).sqrt() * (P + R_mean);
        // (30)  N = C₀ - R
        let N = C_0 - R_mean - significance * error;
        // (28), (29)  λ = max{1, N/M},  M = P
        self.lambda = (N / P).max(T::one());
        self.lambda
    }

    pub fn lambda(&self) -> T {
        self.lambda
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;

    #[test]
    fn with_one_variance_it_is_the_published_factor() {
        // Equations (28)-(33) written out for a scalar with H = 1 and equal R.
        let (r, p) = (4.0f64, 0.5);
        let (mut g1, mut g2, mut lambda) = (0.0, 0.0, 1.0f64);
        let mut memory = ParameterMemory::default();
        let mut largest = 0.0f64;
        for nu in [1.0, -5.0, 0.3, 7.0, 7.5, -0.1] {
            g1 = g1 / lambda + nu * nu;
            g2 = g2 / lambda + 1.0;
            lambda = ((g1 / g2 - r) / p).max(1.0);
            let found = memory.take_in(&ParameterForgetting::published(), nu, r, p);
            assert!((found - lambda).abs() < 1e-12 * lambda);
            largest = largest.max(lambda);
        }
        assert!(largest > 1.0);
    }

    #[test]
    fn innovations_within_belief_cause_no_forgetting() {
        let settings = ParameterForgetting::Adaptive { memory: 20.0, significance: 1.0 };
        let mut memory = ParameterMemory::default();
        for i in 0..100 {
            // Variance of these is exactly the believed P + R = 5, alternating in sign.
            let nu = if i % 2 == 0 { 5.0f64.sqrt() } else { -(5.0f64.sqrt()) };
            assert_eq!(memory.take_in(&settings, nu, 4.0, 1.0), 1.0);
        }
        // A lasting offset of three believed standard deviations is one.
        let factors: Vec<f64> =
            (0..5).map(|_| memory.take_in(&settings, 3.0 * 5.0f64.sqrt(), 4.0, 1.0)).collect();
        assert!(factors.iter().any(|f| *f > 1.0), "{factors:?}");
    }

    #[test]
    fn senseless_settings_are_named() {
        let with = |memory, significance| ParameterForgetting::Adaptive { memory, significance }.validated();
        assert!(ParameterForgetting::<f64>::published().validated().is_ok());
        assert!(with(f64::NAN, 0.0).is_err() && with(1.0, 0.0).is_err());
        assert!(
            with(20.0, f64::NAN).is_err() && with(20.0, -0.1).is_err() && with(20.0, f64::INFINITY).is_err()
        );
    }
}
