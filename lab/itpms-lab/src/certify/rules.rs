//! Requirements of the two regulations, in numbers. Known to every module here; knows nothing of how it is driven.
//!
//! Sources: UN Regulation No. 141, paragraphs 5.2 to 5.4 and Annex 3; 49 CFR 571.138 (FMVSS 138), S4.2, S4.4, S5.3, S6.

use itpms_core::warning::{Limits, Regulation};
use serde::Serialize;

use super::test_case::Test;

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Rule {
        UnR141 = "UN R141",
        /// FMVSS 138, 49 CFR 571.138.
        Fmvss138 = "FMVSS 138",
    }
}

/// Least warning pressure in kPa: R141 5.2.1, and FMVSS 138 Table 1 for standard-load passenger-car tires.
const R141_LEAST_KPA: f64 = 150.0;
const FMVSS_LEAST_KPA: f64 = 140.0;
/// By how much tires are let down beyond the limit, in kPa: R141 Annex 3 for the diffusion test, FMVSS S6(e).
const R141_FURTHER_KPA: f64 = 7.0;
const FMVSS_FURTHER_KPA: f64 = 14.0;

impl Rule {
    pub fn clause(self, test: Test) -> &'static str {
        match (self, test) {
            (Self::UnR141, Test::Malfunction(_)) => "5.4, Annex 3",
            (Self::UnR141, Test::LowAll) => "5.3, Annex 3",
            (Self::UnR141, Test::Low(_)) => "5.2, Annex 3",
            (Self::Fmvss138, Test::Malfunction(_)) => "S4.4, S6",
            (Self::Fmvss138, _) => "S4.2, S6",
        }
    }

    /// Slowest and fastest speed in km/h at which time counts, all of which is to be driven: R141 Annex 3 1.4.2, FMVSS S5.3.2.
    pub fn band_km_h(self, test: Test) -> [f64; 2] {
        match (self, test) {
            (Self::UnR141, Test::Low(_)) => [40.0, 120.0],
            (Self::UnR141, _) => [40.0, 100.0],
            (Self::Fmvss138, _) => [50.0, 100.0],
        }
    }

    /// Time in s of learning: R141 Annex 3 at least 20 min, FMVSS S6(d) 20 min in all.
    pub fn learning_s(self) -> f64 {
        1200.0
    }

    /// Cumulative driving time in s within which the tell-tale has to come on.
    pub fn limit_s(self, test: Test) -> f64 {
        match (self, test) {
            (Self::UnR141, Test::LowAll) => 3600.0,
            (Self::UnR141, _) => 600.0,
            (Self::Fmvss138, _) => 1200.0,
        }
    }

    /// The pressure in kPa a tire is let down to, from its warm pressure and its placard's.
    pub fn test_pressure_kpa(self, test: Test, warm_kpa: f64, placard_kpa: f64) -> f64 {
        match self {
            Self::UnR141 => {
                let further_kpa = if test == Test::LowAll { R141_FURTHER_KPA } else { 0.0 };
                (0.8 * warm_kpa).max(R141_LEAST_KPA) - further_kpa
            }
            Self::Fmvss138 => (0.75 * placard_kpa).max(FMVSS_LEAST_KPA) - FMVSS_FURTHER_KPA,
        }
    }

    /// When to take the key out for two minutes, in s of cumulative driving time: R141 Annex 3, between 20 and 40
    /// minutes of the diffusion test.
    pub fn key_out_after_s(self, test: Test) -> Option<f64> {
        (self == Self::UnR141 && test == Test::LowAll).then_some(1800.0)
    }

    pub fn limits(self) -> Limits<f64> {
        match self {
            Self::UnR141 => Regulation::UnR141,
            Self::Fmvss138 => Regulation::Fmvss138,
        }
        .into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::{Corner, Wheels};

    #[test]
    fn tires_are_let_down_to_what_the_clauses_say() {
        let one = Test::Low(Wheels::from(Corner::RearLeft));
        // 20 % off 260 kPa warm; 7 kPa further for all four; not below 150 kPa.
        assert!((Rule::UnR141.test_pressure_kpa(one, 260.0, 240.0) - 208.0).abs() < 1e-9);
        assert!((Rule::UnR141.test_pressure_kpa(Test::LowAll, 260.0, 240.0) - 201.0).abs() < 1e-9);
        assert!((Rule::UnR141.test_pressure_kpa(one, 180.0, 170.0) - 150.0).abs() < 1e-9);
        // 25 % off 240 kPa on the placard and 14 kPa further; from 140 kPa where that is more.
        assert!((Rule::Fmvss138.test_pressure_kpa(one, 260.0, 240.0) - 166.0).abs() < 1e-9);
        assert!((Rule::Fmvss138.test_pressure_kpa(one, 190.0, 180.0) - 126.0).abs() < 1e-9);
    }
}
