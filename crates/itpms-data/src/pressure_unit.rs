//! A pressure in a unit that was not asked for.

/// The likely unit of a number that is no tire's pressure in kPa, in words: ` 2.4 bar is 240 kPa`; empty where no unit makes it one.
pub fn pressure_in_other_unit(value: f64) -> String {
    let of = |unit: &str, kpa: f64| format!(" {value} {unit} is {kpa:.0} kPa");
    match value {
        0.8..=15.0 => of("bar", 100.0 * value),
        15.0..=100.0 => of("psi", 6.894_757 * value),
        100_000.0..=1_500_000.0 => of("Pa", 1e-3 * value),
        _ => String::new(),
    }
}
