//! The unit of a clock, however it is spelled. Called by the reader, for masters that are not in s as the standard has them.

/// Seconds per unit; `None` if this is no unit of time.
pub(super) fn seconds(unit: &str) -> Option<f64> {
    let is_plain = |c: &char| {
        // `Â` is left over where UTF-8 was read as cp1252: `Âµs`.
        !(c.is_whitespace() || c.is_control() || matches!(c, 'Â' | '[' | ']' | '(' | ')' | '.' | '_'))
    };
    let plain: String =
        unit.chars().filter(is_plain).map(|c| if matches!(c, 'µ' | 'μ') { 'u' } else { c }).collect();
    match plain.to_lowercase().as_str() {
        "s" | "sec" => Some(1.0),
        "ms" => Some(1e-3),
        "us" => Some(1e-6),
        "ns" => Some(1e-9),
        "min" => Some(60.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::seconds;

    #[test]
    fn a_unit_of_time_has_many_spellings() {
        for (unit, expected) in [
            ("s", 1.0),
            ("[s]", 1.0),
            ("Sec.", 1.0),
            (" ms ", 1e-3),
            ("µs", 1e-6),
            ("Âµs", 1e-6),
            ("min", 60.0),
        ] {
            assert_eq!(seconds(unit), Some(expected), "{unit}");
        }
        assert_eq!((seconds(""), seconds("m"), seconds("1/s")), (None, None, None));
    }
}
