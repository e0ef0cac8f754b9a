//! A tire's size as on its sidewall, and the vertical stiffness it has by that size (docs/vehicle.md, section 2).

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// A size such as `205/55R16`: section width in mm, section height in per cent of it, rim diameter in inches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TireSize {
    pub width_mm: f64,
    /// Section height in per cent of the width.
    pub aspect_percent: f64,
    pub rim_inch: f64,
}

/// A text that is no tire size.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "found {0:?}, expected a tire size such as 205/55R16 (width in mm, aspect ratio in per cent, rim in inches)"
)]
pub struct TireSizeError(String);

impl FromStr for TireSize {
    type Err = TireSizeError;

    /// Blanks, `P` or `LT` before it, `ZR`, `C` and load and speed index after it are passed over.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        parse(text).ok_or_else(|| TireSizeError(text.to_owned()))
    }
}

fn parse(text: &str) -> Option<TireSize> {
    let upper = text.to_ascii_uppercase();
    let (width, rest) = upper.split_once('/')?;
    let width = width.trim().trim_start_matches("LT").trim_start_matches('P').trim();
    let (aspect, rim) = rest.split_once('R')?;
    let digits = rim.trim().split(|c: char| !c.is_ascii_digit() && c != '.').next()?;
    let size = TireSize {
        width_mm: width.parse().ok()?,
        aspect_percent: aspect.trim().trim_end_matches('Z').trim().parse().ok()?,
        rim_inch: digits.parse().ok()?,
    };
    let known = (100.0..=455.0).contains(&size.width_mm)
        && (20.0..=95.0).contains(&size.aspect_percent)
        && (10.0..=26.0).contains(&size.rim_inch);
    known.then_some(size)
}

impl fmt::Display for TireSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}R{}", self.width_mm, self.aspect_percent, self.rim_inch)
    }
}

/// Slope of stiffness over pressure per root of contact width times diameter, in N/m per kPa and mm; and the pressure in
/// kPa whose share the tire's structure has. Both from the tires of docs/vehicle.md, table 2, measured over pressure.
const SLOPE_PER_MM: f64 = 2.13;
const STRUCTURE_KPA: f64 = 87.0;
/// Rhyne's effective width: so much of the section width, less so much per point of aspect ratio.
const WIDTH_SHARE: (f64, f64) = (1.03, 0.004);
const MM_PER_INCH: f64 = 25.4;
/// Effective rolling radius over unloaded radius of a radial tire (ETRTO's rolling circumference is 3.05 diameters).
const ROLLING_SHARE: f64 = 3.05 / std::f64::consts::PI;

impl TireSize {
    pub fn outer_diameter_mm(&self) -> f64 {
        MM_PER_INCH * self.rim_inch + 0.02 * self.aspect_percent * self.width_mm
    }

    pub fn rolling_radius_m(&self) -> f64 {
        0.5e-3 * ROLLING_SHARE * self.outer_diameter_mm()
    }

    /// Root in mm of effective width times outer diameter: what stiffness grows with (Rhyne 2005).
    fn scale_mm(&self) -> f64 {
        let width_mm = (WIDTH_SHARE.0 - WIDTH_SHARE.1 * self.aspect_percent) * self.width_mm;
        (width_mm * self.outer_diameter_mm()).sqrt()
    }

    /// Vertical stiffness per pressure in N/m per kPa.
    pub fn stiffness_per_kpa(&self) -> f64 {
        SLOPE_PER_MM * self.scale_mm()
    }

    /// Vertical stiffness in N/m at zero gauge pressure, on the line that holds between 150 and 300 kPa.
    pub fn stiffness_at_zero(&self) -> f64 {
        STRUCTURE_KPA * self.stiffness_per_kpa()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_as_they_stand_on_sidewalls() {
        let size = TireSize { width_mm: 205.0, aspect_percent: 55.0, rim_inch: 16.0 };
        for text in ["205/55R16", "205/55 R16", "P205/55R16 91V", "205/55ZR16", "205/55 zr 16", "205/55R16C"]
        {
            assert_eq!(text.parse(), Ok(size), "{text}");
        }
        assert_eq!("LT245/75R17".parse::<TireSize>().unwrap().width_mm, 245.0);
        // 16 in are 406.4 mm, two side walls of 112.75 mm.
        assert!((size.outer_diameter_mm() - 631.9).abs() < 1e-9);
        for text in
            ["", "205", "205/55", "205-55R16", "20/55R16", "205/5R16", "205/55R160", "a/bRc", "1e9/55R16"]
        {
            let error = text.parse::<TireSize>().unwrap_err().to_string();
            assert!(error.contains("expected a tire size such as 205/55R16"), "{error}");
        }
    }

    #[test]
    fn measured_tires_lie_within_five_per_cent() {
        // The paper's Table 1 (Hankook, test machine): 193.78 and 272.44 kN/m.
        // Pacejka, Tyre and Vehicle Dynamics, 3rd ed., app. 3: MF 6.2 of a 205/60R15 91V at 1.86 and 2.55 bar.
        for (size, measured) in [
            ("225/45R17", [(186.2, 193_780.0), (241.3, 233_350.0), (296.5, 272_440.0)]),
            ("205/60R15", [(186.0, 186_653.0), (220.0, 209_651.0), (255.0, 233_325.0)]),
        ] {
            let size: TireSize = size.parse().unwrap();
            for (kpa, n_per_m) in measured {
                let by_size = size.stiffness_at_zero() + size.stiffness_per_kpa() * kpa;
                assert!((by_size / n_per_m - 1.0).abs() < 0.05, "{size} at {kpa} kPa: {by_size:.0}");
            }
        }
    }
}
