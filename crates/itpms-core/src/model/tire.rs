//! Tire stiffness and inflation pressure: the straight line of eq. (5), its regression from a table of tire
//! tests (Table 1, Fig. 3), its inverse, and what its own uncertainty adds to a pressure's.
//!
//! `k_t = slope * p + intercept`. The paper's tire: 713.91 N/m per kPa and 60 880 N/m at zero gauge pressure.

use thiserror::Error;

use crate::memory::Blank;
use crate::model::{ParameterError, positive};
use crate::real::Real;

/// A table of tire tests that no pressure map can be drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum RegressionError {
    /// A line with a standard error needs three points.
    #[error("{0} points, expected at least 3")]
    TooFewPoints(usize),
    /// Pressures and stiffnesses come in pairs.
    #[error("{pressures} pressures but {stiffnesses} stiffnesses")]
    LengthMismatch { pressures: usize, stiffnesses: usize },
    /// NaN or infinite.
    #[error("row {0} is not finite")]
    NotFinite(usize),
    /// All rows have the same pressure.
    #[error("all rows have the same pressure")]
    OnePressure,
    /// A tire gets stiffer with pressure.
    #[error("stiffness does not increase with pressure (slope {0} N/m per kPa)")]
    NotIncreasing(f64),
}

/// Stiffness as a straight line over pressure, with the covariance of its two coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PressureMap<T> {
    stiffness_per_kpa: T,
    stiffness_at_zero: T,
    variance_slope: T,
    variance_intercept: T,
    covariance: T,
}

impl<T: Real> PressureMap<T> {
    /// An exactly known line: `stiffness_per_kpa` in N/m per kPa, `stiffness_at_zero` in N/m.
    ///
    /// # Errors
    /// The slope must be positive and finite, the intercept finite and not negative.
    pub fn new(stiffness_per_kpa: T, stiffness_at_zero: T) -> Result<Self, ParameterError> {
        let stiffness_per_kpa = positive("stiffness_per_kpa", stiffness_per_kpa)?;
        if !(stiffness_at_zero >= T::zero() && stiffness_at_zero.is_finite()) {
            return Err(ParameterError {
                name: "stiffness_at_zero",
                value: stiffness_at_zero.to_f64(),
                expected: "a finite number, zero or more",
            });
        }
        Ok(Self { stiffness_per_kpa, stiffness_at_zero, ..Self::BLANK })
    }

    /// The same line with the standard deviations of its coefficients (N/m per kPa, N/m) and their correlation, from -1 to 1.
    ///
    /// # Errors
    /// Names the value that is negative, not finite or outside its range.
    pub fn with_uncertainty(
        self,
        stiffness_per_kpa_sd: T,
        stiffness_at_zero_sd: T,
        correlation: T,
    ) -> Result<Self, ParameterError> {
        for (name, sd) in
            [("stiffness_per_kpa_sd", stiffness_per_kpa_sd), ("stiffness_at_zero_sd", stiffness_at_zero_sd)]
        {
            if !(sd >= T::zero() && sd.is_finite()) {
                return Err(ParameterError {
                    name,
                    value: sd.to_f64(),
                    expected: "a finite number, zero or more",
                });
            }
        }
        if !(correlation.abs() <= T::one()) {
            return Err(ParameterError {
                name: "stiffness_correlation",
                value: correlation.to_f64(),
                expected: "a number between -1 and 1",
            });
        }
        Ok(Self {
            variance_slope: stiffness_per_kpa_sd * stiffness_per_kpa_sd,
            variance_intercept: stiffness_at_zero_sd * stiffness_at_zero_sd,
            covariance: correlation * stiffness_per_kpa_sd * stiffness_at_zero_sd,
            ..self
        })
    }

    /// The paper's tire as printed in eq. (5).
    #[must_use]
    pub fn paper_eq_5() -> Self {
        Self { stiffness_per_kpa: T::lit(713.91), stiffness_at_zero: T::lit(60_880.0), ..Self::BLANK }
    }

    /// Ordinary least squares through measured pairs, with the coefficients' covariance and R².
    pub fn regression(pressures_kpa: &[T], stiffnesses_n_per_m: &[T]) -> Result<(Self, T), RegressionError> {
        let n = pressures_kpa.len();
        if n != stiffnesses_n_per_m.len() {
            return Err(RegressionError::LengthMismatch {
                pressures: n,
                stiffnesses: stiffnesses_n_per_m.len(),
            });
        }
        if n < 3 {
            return Err(RegressionError::TooFewPoints(n));
        }
        let pairs = || pressures_kpa.iter().copied().zip(stiffnesses_n_per_m.iter().copied());
        if let Some(row) = pairs().position(|(p, k)| !(p.is_finite() && k.is_finite())) {
            return Err(RegressionError::NotFinite(row));
        }
        let count = T::lit(n as f64);
        let sum = pairs().fold((T::zero(), T::zero()), |(a, b), (p, k)| (a + p, b + k));
        let (p_mean, k_mean) = (sum.0 / count, sum.1 / count);
        // Centred sums: S_pp, S_pk, S_kk
        let (mut s_pp, mut s_pk, mut s_kk) = (T::zero(), T::zero(), T::zero());
        for (p, k) in pairs() {
            let (dp, dk) = (p - p_mean, k - k_mean);
            s_pp += dp * dp;
            s_pk += dp * dk;
            s_kk += dk * dk;
        }
        if !(s_pp > T::epsilon() * (T::one() + p_mean * p_mean)) {
            return Err(RegressionError::OnePressure);
        }
        let slope = s_pk / s_pp;
        if !(slope > T::zero()) {
            return Err(RegressionError::NotIncreasing(slope.to_f64()));
        }
        let intercept = k_mean - slope * p_mean;
        let residual = (s_kk - slope * s_pk).max(T::zero());
        let variance = residual / (count - T::lit(2.0));
        let map = Self {
            stiffness_per_kpa: slope,
            stiffness_at_zero: intercept,
            variance_slope: variance / s_pp,
            variance_intercept: variance * (T::one() / count + p_mean * p_mean / s_pp),
            covariance: -p_mean * variance / s_pp,
        };
        Ok((map, T::one() - residual / s_kk))
    }

    /// Slope in N/m per kPa.
    pub fn stiffness_per_kpa(&self) -> T {
        self.stiffness_per_kpa
    }

    /// Intercept in N/m.
    pub fn stiffness_at_zero(&self) -> T {
        self.stiffness_at_zero
    }

    /// Standard deviation of the slope in N/m per kPa; zero for a line taken as exact.
    pub fn stiffness_per_kpa_sd(&self) -> T {
        self.variance_slope.sqrt()
    }

    /// Standard deviation of the intercept in N/m; zero for a line taken as exact.
    pub fn stiffness_at_zero_sd(&self) -> T {
        self.variance_intercept.sqrt()
    }

    /// Correlation of slope and intercept; zero for a line taken as exact.
    pub fn stiffness_correlation(&self) -> T {
        let scale = (self.variance_slope * self.variance_intercept).sqrt();
        if scale > T::zero() { self.covariance / scale } else { T::zero() }
    }

    /// Tire stiffness in N/m at a gauge pressure in kPa (eq. 5).
    pub fn stiffness_n_per_m(&self, pressure_kpa: T) -> T {
        self.stiffness_per_kpa * pressure_kpa + self.stiffness_at_zero
    }

    /// Gauge pressure in kPa at a tire stiffness in N/m (inverse of eq. 5).
    pub fn pressure_kpa(&self, stiffness_n_per_m: T) -> T {
        (stiffness_n_per_m - self.stiffness_at_zero) / self.stiffness_per_kpa
    }

    /// Standard deviation in kPa that the line's own uncertainty adds to a pressure read from a known stiffness:
    /// `var p = (p² var(slope) + var(intercept) + 2 p cov) / slope²`, to first order.
    pub fn map_sd_kpa(&self, pressure_kpa: T) -> T {
        let p = pressure_kpa;
        let variance =
            p * p * self.variance_slope + self.variance_intercept + T::lit(2.0) * p * self.covariance;
        variance.max(T::zero()).sqrt() / self.stiffness_per_kpa
    }

    /// Standard deviation of the pressure in kPa, the stiffness's (N/m) and the line's own combined.
    pub fn pressure_sd_kpa(&self, pressure_kpa: T, stiffness_sd_n_per_m: T) -> T {
        let reading = stiffness_sd_n_per_m / self.stiffness_per_kpa;
        let map = self.map_sd_kpa(pressure_kpa);
        (reading * reading + map * map).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Paper, Table 1.
    const P: [f64; 5] = [186.2, 213.7, 241.3, 268.9, 296.5];
    const K: [f64; 5] = [193_780.0, 213_450.0, 233_350.0, 252_960.0, 272_440.0];

    #[test]
    fn regression_of_table_1_gives_the_papers_line() {
        let (map, r2) = PressureMap::regression(&P, &K).unwrap();
        // An independent script's least squares: 713.668 and 60 973.57. The paper prints 713.91 and 60 880, 0.03 % and 0.15 % away.
        assert!((map.stiffness_per_kpa() - 713.668_293).abs() < 1e-5, "{}", map.stiffness_per_kpa());
        assert!((map.stiffness_at_zero() - 60_973.567_5).abs() < 1e-3, "{}", map.stiffness_at_zero());
        assert!(r2 > 0.998);
    }

    #[test]
    fn the_maps_own_uncertainty_grows_away_from_its_data() {
        let (map, _) = PressureMap::regression(&P, &K).unwrap();
        let middle = map.map_sd_kpa(241.3);
        assert!(middle > 0.0 && map.map_sd_kpa(100.0) > 3.0 * middle);
        // With a stiffness sd the two add in quadrature.
        let sd = map.pressure_sd_kpa(241.3, 713.7 * 5.0);
        assert!((sd * sd - middle * middle - 25.0).abs() < 0.1);
    }

    #[test]
    fn the_coefficients_own_uncertainty_gives_that_of_the_line() {
        let (map, _) = PressureMap::regression(&P, &K).unwrap();
        let (slope, zero, r) =
            (map.stiffness_per_kpa_sd(), map.stiffness_at_zero_sd(), map.stiffness_correlation());
        let p = 200.0;
        let variance = p * p * slope * slope + zero * zero + 2.0 * p * r * slope * zero;
        assert!((variance.sqrt() / map.stiffness_per_kpa() - map.map_sd_kpa(p)).abs() < 1e-9);
        let exact = PressureMap::<f64>::paper_eq_5();
        assert_eq!((exact.stiffness_per_kpa_sd(), exact.stiffness_correlation()), (0.0, 0.0));
    }

    #[test]
    fn bad_tables_are_refused_with_their_reason() {
        use RegressionError as E;
        assert_eq!(PressureMap::regression(&P[..2], &K[..2]).unwrap_err(), E::TooFewPoints(2));
        assert_eq!(
            PressureMap::regression(&P, &K[..4]).unwrap_err(),
            E::LengthMismatch { pressures: 5, stiffnesses: 4 }
        );
        assert_eq!(PressureMap::regression(&[200.0; 3], &K[..3]).unwrap_err(), E::OnePressure);
        assert_eq!(PressureMap::regression(&[1.0, f64::NAN, 3.0], &K[..3]).unwrap_err(), E::NotFinite(1));
        let mut falling = K;
        falling.reverse();
        assert!(matches!(PressureMap::regression(&P, &falling), Err(E::NotIncreasing(_))));
    }

    #[test]
    fn parameters_are_checked() {
        assert_eq!(PressureMap::new(f64::NAN, 0.0).unwrap_err().name, "stiffness_per_kpa");
        assert_eq!(PressureMap::new(700.0, f64::NAN).unwrap_err().name, "stiffness_at_zero");
        let map = PressureMap::<f64>::paper_eq_5();
        assert_eq!(map.with_uncertainty(-1.0, 0.0, 0.0).unwrap_err().name, "stiffness_per_kpa_sd");
        assert_eq!(map.with_uncertainty(1.0, f64::NAN, 0.0).unwrap_err().name, "stiffness_at_zero_sd");
        assert_eq!(map.with_uncertainty(1.0, 1.0, 2.0).unwrap_err().name, "stiffness_correlation");
    }

    #[test]
    fn pressure_and_stiffness_invert_each_other() {
        let map = PressureMap::<f32>::paper_eq_5();
        for p in [0.0f32, 41.4, 137.9, 241.3, 310.0] {
            assert!((map.pressure_kpa(map.stiffness_n_per_m(p)) - p).abs() < 1e-3);
        }
    }
}
