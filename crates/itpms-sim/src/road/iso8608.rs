//! The displacement spectrum of ISO 8608: `Gd(n) = Gd(n0) (n / n0)^-w`, one-sided, `n0` = 0.1 cycle/m.
//!
//! Called by the surfaces that synthesise it; knows nothing of grids or random numbers.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::error::{Result, positive, within};

/// Reference spatial frequency `n0` in cycles/m (ISO 8608:2016, 5.1.2).
pub const REFERENCE_CYCLES_PER_M: f64 = 0.1;

/// A class of ISO 8608, from very good (A) to very poor (H), by its geometric mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the standard's letters have no other name")]
pub enum RoadClass {
    A,
    B,
    C,
    D,
    E,
    F,
    G,
    H,
}

impl RoadClass {
    pub const ALL: [RoadClass; 8] = {
        use RoadClass::*;
        [A, B, C, D, E, F, G, H]
    };

    /// Geometric mean of `Gd(n0)` in m³ (ISO 8608:2016, Table C.1): 16e-6 for A, four times more for each class.
    pub fn gd_n0_m3(self) -> f64 {
        16e-6 * f64::from(1u32 << (2 * self as u32))
    }

    pub fn from_letter(letter: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.to_string() == letter)
    }
}

impl fmt::Display for RoadClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

/// `Gd(n0)` in m³; in a scenario a class letter or the number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness {
    gd_n0_m3: f64,
}

impl Roughness {
    /// `Gd(n0)` in m³.
    pub fn gd_n0_m3(self) -> f64 {
        self.gd_n0_m3
    }
}

impl From<RoadClass> for Roughness {
    fn from(class: RoadClass) -> Self {
        Self { gd_n0_m3: class.gd_n0_m3() }
    }
}

impl From<f64> for Roughness {
    fn from(gd_n0_m3: f64) -> Self {
        Self { gd_n0_m3 }
    }
}

impl Serialize for Roughness {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match RoadClass::ALL.into_iter().find(|c| c.gd_n0_m3() == self.gd_n0_m3) {
            Some(class) => serializer.collect_str(&class),
            None => serializer.serialize_f64(self.gd_n0_m3),
        }
    }
}

impl<'de> Deserialize<'de> for Roughness {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl serde::de::Visitor<'_> for Visitor {
            type Value = Roughness;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a road class from \"A\" to \"H\" or Gd(n0) in m3")
            }
            fn visit_str<E: serde::de::Error>(self, letter: &str) -> Result<Roughness, E> {
                RoadClass::from_letter(letter)
                    .map(Roughness::from)
                    .ok_or_else(|| E::invalid_value(serde::de::Unexpected::Str(letter), &self))
            }
            fn visit_f64<E: serde::de::Error>(self, gd: f64) -> Result<Roughness, E> {
                Ok(Roughness::from(gd))
            }
            fn visit_i64<E: serde::de::Error>(self, gd: i64) -> Result<Roughness, E> {
                Ok(Roughness::from(gd as f64))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

/// How a synthesised road's Fourier coefficients are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Amplitude {
    /// Complex normal: amplitude and phase random, the road a Gaussian process, as real ones nearly are.
    #[default]
    Gaussian,
    /// Amplitude exactly the spectrum's, phase random: every road of a spectrum equally rough. For studies only, it
    /// makes an estimator's life easier than it is.
    Fixed,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Iso8608 {
    /// `Gd(n0)`, or the class it is the mean of.
    pub roughness: Roughness,
    /// Slope `w` of the spectrum, 2 in the standard.
    #[serde(default = "standard_slope")]
    pub slope: f64,
    /// How the Fourier coefficients are drawn.
    #[serde(default)]
    pub amplitude: Amplitude,
    /// The road repeats itself after this many metres (a test bed's segment); never, if not given.
    pub repeat_every_m: Option<f64>,
}

fn standard_slope() -> f64 {
    2.0
}

impl Iso8608 {
    /// A Gaussian road that does not repeat.
    pub fn new(roughness: impl Into<Roughness>, slope: f64) -> Self {
        Self { roughness: roughness.into(), slope, amplitude: Amplitude::Gaussian, repeat_every_m: None }
    }

    /// One-sided displacement spectrum in m³ at a spatial frequency in cycles/m.
    pub fn psd_m3(&self, cycles_per_m: f64) -> f64 {
        self.roughness.gd_n0_m3() * (cycles_per_m / REFERENCE_CYCLES_PER_M).powf(-self.slope)
    }

    pub(crate) fn validate(&self) -> Result<()> {
        positive("roughness", self.roughness.gd_n0_m3())?;
        within("slope", self.slope, 0.5, 4.0, "a number from 0.5 to 4")?;
        match self.repeat_every_m {
            Some(period) => within("repeat_every_m", period, 0.1, 1000.0, "a length from 0.1 to 1000 m"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_the_standards() {
        // ISO 8608:2016, Table C.1, geometric means in 1e-6 m3.
        let table = [16.0, 64.0, 256.0, 1024.0, 4096.0, 16384.0, 65536.0, 262144.0];
        for (class, mean) in RoadClass::ALL.into_iter().zip(table) {
            assert!((class.gd_n0_m3() - mean * 1e-6).abs() < 1e-12);
        }
        assert_eq!(RoadClass::from_letter("C"), Some(RoadClass::C));
        assert_eq!(RoadClass::from_letter("c"), None);
    }

    #[test]
    fn the_spectrum_is_a_power_law_through_its_reference() {
        let iso = Iso8608::new(RoadClass::B, 2.5);
        assert!((iso.psd_m3(0.1) - 64e-6).abs() < 1e-18);
        assert!((iso.psd_m3(10.0) / iso.psd_m3(0.1) - 1e-5).abs() < 1e-17);
    }
}
