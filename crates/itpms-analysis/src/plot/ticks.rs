//! Round numbers along an axis, and how they are written.

/// Places of the marks and their words.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Ticks {
    pub(super) labelled: Vec<(f64, String)>,
    pub(super) minor: Vec<f64>,
}

/// Steps of 1, 2 or 5 times a power of ten, about `count` of them from `low` to `high`.
pub(super) fn linear(low: f64, high: f64, count: usize) -> Ticks {
    let step = round_step((high - low) / count.max(1) as f64);
    if !(step > 0.0 && step.is_finite()) {
        return Ticks::default();
    }
    let write = Writing::of(low.abs().max(high.abs()), step);
    let tolerance = 1e-9 * step;
    let (first, last) =
        (((low - tolerance) / step).ceil() as i64, ((high + tolerance) / step).floor() as i64);
    let labelled = (first..=last).map(|i| {
        let value = i as f64 * step;
        (value, write.number(value))
    });
    Ticks { labelled: labelled.take(MOST_TICKS).collect(), minor: vec![] }
}

/// More than any panel has room for.
const MOST_TICKS: usize = 100;

/// From here on a number is written with a power of ten: a label of hundreds of digits would leave no room for a panel.
const LARGEST_PLAIN: f64 = 1e12;
/// Digits after the point, at most, before it is written so.
const MOST_PLAIN_DECIMALS: f64 = 9.0;
/// Significant digits of a number in 64 bits.
const MOST_DIGITS: f64 = 15.0;

/// How the numbers along one axis are written, all in one way.
struct Writing {
    decimals: usize,
    /// The power of ten that they are written with; 0: none.
    exponent: i32,
}

impl Writing {
    /// For steps between numbers up to `largest`.
    fn of(largest: f64, step: f64) -> Self {
        let finest = step.log10().floor();
        if largest < LARGEST_PLAIN && -finest <= MOST_PLAIN_DECIMALS {
            return Self { decimals: (-finest).max(0.0) as usize, exponent: 0 };
        }
        let exponent = largest.log10().floor();
        let decimals = (exponent - finest).clamp(0.0, MOST_DIGITS) as usize;
        Self { decimals, exponent: exponent as i32 }
    }

    fn number(&self, value: f64) -> String {
        if self.exponent == 0 {
            return number(value, self.decimals);
        }
        // In two steps, because 10^-320 is a number and 10^320 is none.
        let half = self.exponent / 2;
        let mantissa = value / 10f64.powi(half) / 10f64.powi(self.exponent - half);
        if mantissa == 0.0 {
            return "0".to_owned();
        }
        format!("{}·10{}", number(mantissa, self.decimals), raised(self.exponent))
    }
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= rough * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// With more decades than this, 2 and 5 in between find no room.
const ROOM_DECADES: f64 = 2.5;

/// Powers of ten; where there are few of them, 2 and 5 in between are labelled, too.
pub(super) fn logarithmic(low: f64, high: f64) -> Ticks {
    if !(low > 0.0 && high > low && high.is_finite()) {
        return Ticks::default();
    }
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let inside = |value: f64| value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9);
    let decades = (first..=last).filter(|&n| inside(10f64.powi(n))).count();
    // Powers in one way along one axis.
    let plain = (first..=last).filter(|&n| inside(10f64.powi(n))).all(|n| (-3..=4).contains(&n));
    let every = (decades / 7 + 1) as i32;
    let mut ticks = Ticks::default();
    for exponent in first..=last {
        for digit in 1..10 {
            let value = f64::from(digit) * 10f64.powi(exponent);
            if !inside(value) {
                continue;
            }
            let spoken = match digit {
                1 => exponent.rem_euclid(every) == 0,
                2 | 5 => (high / low).log10() < ROOM_DECADES,
                _ => false,
            };
            if spoken {
                ticks.labelled.push((value, power_of_ten(digit, exponent, plain)));
            } else if decades < 9 {
                ticks.minor.push(value);
            }
        }
    }
    ticks
}

/// `0.05`, `20`, `5000`, or `2·10⁶`.
fn power_of_ten(digit: i32, exponent: i32, plain: bool) -> String {
    if plain || (digit == 1 && exponent == 0) {
        return number(f64::from(digit) * 10f64.powi(exponent), (-exponent).max(0) as usize);
    }
    let raised = raised(exponent);
    if digit == 1 { format!("10{raised}") } else { format!("{digit}·10{raised}") }
}

fn raised(exponent: i32) -> String {
    exponent.to_string().chars().map(superscript).collect()
}

fn superscript(character: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    character.to_digit(10).and_then(|digit| DIGITS.get(digit as usize).copied()).unwrap_or('⁻')
}

/// With a real minus sign and, from five digits on, thin spaces between thousands.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let (whole, part) = text.split_once('.').map_or((text.as_str(), ""), |(whole, part)| (whole, part));
    let mut out = String::new();
    // A value that rounds to zero has no sign.
    if value < 0.0 && text.chars().any(|c| c.is_ascii_digit() && c != '0') {
        out.push('\u{2212}');
    }
    for (i, digit) in whole.chars().enumerate() {
        if whole.len() >= 5 && i > 0 && (whole.len() - i).is_multiple_of(3) {
            out.push('\u{2009}');
        }
        out.push(digit);
    }
    if !part.is_empty() {
        out.push('.');
        out.push_str(part);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(ticks: &Ticks) -> Vec<&str> {
        ticks.labelled.iter().map(|(_, word)| word.as_str()).collect()
    }

    #[test]
    fn steps_are_round() {
        assert_eq!(words(&linear(0.0, 40.0, 5)), ["0", "10", "20", "30", "40"]);
        assert_eq!(words(&linear(-0.3, 0.31, 4)), ["\u{2212}0.2", "0.0", "0.2"]);
        assert_eq!(
            words(&linear(190_000.0, 240_000.0, 3)),
            ["200\u{2009}000", "220\u{2009}000", "240\u{2009}000"]
        );
        assert_eq!(words(&linear(0.0, 1e200, 2)), ["0", "0.5·10²⁰⁰", "1.0·10²⁰⁰"]);
        assert_eq!(words(&linear(0.0, 2e-300, 2)), ["0", "1·10⁻³⁰⁰", "2·10⁻³⁰⁰"]);
        // Where numbers have hardly a digit left.
        assert_eq!(linear(0.0, 2e-320, 2).labelled.len(), 3);
        assert_eq!(linear(1.0, 1.0, 5), Ticks::default());
        assert_eq!(linear(0.0, f64::NAN, 5), Ticks::default());
    }

    #[test]
    fn decades_are_named() {
        assert_eq!(words(&logarithmic(1e-7, 1e-3)), ["10⁻⁷", "10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³"]);
        assert_eq!(words(&logarithmic(0.5, 20.0)), ["0.5", "1", "2", "5", "10", "20"]);
        assert!(logarithmic(1.0, 1e40).labelled.len() < 10);
        assert_eq!(logarithmic(0.0, 1.0), Ticks::default());
    }
}
