//! A tire's cold pressure, and the air to add.
//!
//! Called by the page's writer and by whoever prints a drive's summary.

use itpms_core::model::{ColdPressure, PressureUnit};

/// As people read it: `218 cold at -10 C`, and `add 22` where that is so.
pub fn cold_text(cold: &ColdPressure<f64>, placard_kpa: f64, unit: PressureUnit) -> (String, Option<String>) {
    let at = format!("{} cold at {:.0} C", unit.number(cold.pressure_kpa, 0), cold.ambient_temperature_c);
    (at, cold.air_to_add_kpa(placard_kpa).map(|kpa| format!("add {}", unit.number(kpa, 0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_surely_short_is_to_be_added() {
        let cold = |pressure_kpa, sd_kpa| ColdPressure { pressure_kpa, sd_kpa, ambient_temperature_c: -10.2 };
        let words = |cold: &ColdPressure<f64>, unit| cold_text(cold, 240.0, unit);
        let short = cold(218.2, 6.0);
        assert_eq!(
            words(&short, PressureUnit::Kpa),
            ("218 cold at -10 C".to_owned(), Some("add 22".to_owned()))
        );
        assert_eq!(
            words(&short, PressureUnit::Bar),
            ("2.18 cold at -10 C".to_owned(), Some("add 0.22".to_owned()))
        );
        assert_eq!(words(&cold(218.2, 25.0), PressureUnit::Kpa).1, None);
        assert_eq!(words(&cold(236.0, 2.0), PressureUnit::Kpa).1, None);
        assert_eq!(words(&cold(260.0, 2.0), PressureUnit::Kpa).1, None);
    }
}
