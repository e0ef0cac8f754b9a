//! The unit in which pressures are shown to people. Files, frames and every number inside are in kPa.

use core::fmt;

crate::labelled! {
    /// Unit in which people read pressures; files stay in kPa.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum PressureUnit {
        /// Kilopascal.
        #[default]
        Kpa = "kpa",
        /// Bar: 100 kPa.
        Bar = "bar",
        /// Pound-force per square inch: 6.895 kPa (NIST SP 811, appendix B.8).
        Psi = "psi",
    }
}

impl PressureUnit {
    /// The unit's symbol behind a number.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Kpa => "kPa",
            Self::Bar => "bar",
            Self::Psi => "psi",
        }
    }

    /// One of it, in kPa.
    #[must_use]
    pub const fn kpa(self) -> f64 {
        match self {
            Self::Kpa => 1.0,
            Self::Bar => 100.0,
            Self::Psi => 6.894_757_293_168,
        }
    }

    /// Decimal places that a number needs in it beyond those that it has in kPa.
    #[must_use]
    pub const fn more_places(self) -> usize {
        match self {
            Self::Kpa => 0,
            Self::Bar => 2,
            Self::Psi => 1,
        }
    }

    /// A pressure of so many kPa as a number in this unit, as exact as with `places` decimal places in kPa; `{:+}` writes its sign.
    #[must_use]
    pub fn number(self, kpa: f64, places: usize) -> impl fmt::Display {
        PressureNumber { value: kpa / self.kpa(), places: places + self.more_places() }
    }
}

impl fmt::Display for PressureUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

/// A pressure to be shown, without its unit.
struct PressureNumber {
    value: f64,
    places: usize,
}

impl fmt::Display for PressureNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, places } = *self;
        if f.sign_plus() { write!(f, "{value:+.places$}") } else { write!(f, "{value:.places$}") }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::format;

    use super::*;

    #[test]
    fn a_placard_in_the_units_that_placards_have() {
        // 33 psi are 227.5 kPa and 2.3 bar on placards: 33 * 0.45359237 * 9.80665 / 0.0254^2 Pa = 227.527 kPa.
        let shown = PressureUnit::ALL.map(|unit| format!("{} {unit}", unit.number(227.527, 0)));
        assert_eq!(shown, ["228 kPa", "2.28 bar", "33.0 psi"]);
        assert_eq!(format!("{:+}", PressureUnit::Bar.number(-4.0, 1)), "-0.040");
        assert_eq!(format!("{:+}", PressureUnit::Kpa.number(4.0, 1)), "+4.0");
        for unit in PressureUnit::ALL {
            assert_eq!(PressureUnit::from_label(unit.label()), Some(unit));
        }
    }
}
