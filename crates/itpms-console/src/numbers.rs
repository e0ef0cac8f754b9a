//! Numbers as a person reads them.

/// Six digits, no trailing zeros.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e9).contains(&rounded.abs()) {
        format!("{}", rounded + 0.0)
    } else {
        format!("{rounded:e}")
    }
}

/// `1 234 567`.
pub fn thousands(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_counts_are_grouped() {
        for (value, text) in
            [(0.0, "0"), (-0.0, "0"), (499.999_999_9, "500"), (-12.345_678, "-12.3457"), (1e-7, "1e-7")]
        {
            assert_eq!(number(value), text);
        }
        assert_eq!(number(f64::NAN), "");
        for (count, text) in [(0, "0"), (999, "999"), (1000, "1 000"), (1_234_567, "1 234 567")] {
            assert_eq!(thousands(count), text);
        }
    }
}
