//! Formulas in words: `(X1 - 32768) * 0.01`, as algebraic conversions have them (ASAM MDF 4.1, CCBLOCK, `cc_type` 3).
//!
//! Called by the conversions, which read the text once; evaluated for every value. The syntax is that of the ASAM General Expression
//! Syntax as far as it makes a number of one number: `+ - * / %`, `**` and `pow` for powers, brackets, and the functions below. The raw
//! value is `X` or `X1`. What else may be in it (comparisons, bits, other channels) is not computed, nor is `^`: some tools mean a power
//! by it, others (asammdf among them) the exclusive or of bits.

/// Values that wait at most while a formula is evaluated, and brackets inside brackets.
const DEEPEST: usize = 24;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Formula {
    steps: Vec<Step>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Number(f64),
    Raw,
    Negate,
    Operator(u8),
    /// Place among the functions.
    Function(usize),
}

#[derive(Clone, Copy)]
enum Function {
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
}

use Function::{One, Two};

#[rustfmt::skip]
const FUNCTIONS: [(&str, Function); 28] = [
    ("abs", One(f64::abs)), ("sqrt", One(f64::sqrt)), ("exp", One(f64::exp)), ("log", One(f64::ln)), ("ln", One(f64::ln)),
    ("log10", One(f64::log10)), ("log2", One(f64::log2)), ("sin", One(f64::sin)), ("cos", One(f64::cos)), ("tan", One(f64::tan)),
    ("asin", One(f64::asin)), ("acos", One(f64::acos)), ("atan", One(f64::atan)), ("arcsin", One(f64::asin)),
    ("arccos", One(f64::acos)), ("arctan", One(f64::atan)), ("sinh", One(f64::sinh)), ("cosh", One(f64::cosh)),
    ("tanh", One(f64::tanh)), ("floor", One(f64::floor)), ("ceil", One(f64::ceil)), ("round", One(f64::round)),
    ("trunc", One(f64::trunc)), ("int", One(f64::trunc)), ("pow", Two(f64::powf)), ("min", Two(f64::min)),
    ("max", Two(f64::max)), ("atan2", Two(f64::atan2)),
];

impl Formula {
    /// Reads a formula.
    ///
    /// # Errors
    /// Where it goes on with something else than was expected: the rest of the text.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut parser = Parser { rest: text.trim(), steps: Vec::new(), depth: 0 };
        let complete = parser.sum().is_some() && parser.rest.is_empty();
        let formula = Self { steps: parser.steps };
        if complete && formula.deepest() <= DEEPEST { Ok(formula) } else { Err(parser.rest.to_owned()) }
    }

    /// Values that wait at most.
    fn deepest(&self) -> usize {
        let (mut now, mut most) = (0usize, 0);
        for step in &self.steps {
            match step {
                Step::Number(_) | Step::Raw => now += 1,
                Step::Negate => {}
                Step::Operator(_) => now = now.saturating_sub(1),
                Step::Function(place) => {
                    now = now.saturating_sub(usize::from(matches!(FUNCTIONS[*place].1, Two(_))))
                }
            }
            most = most.max(now);
        }
        most
    }

    /// The value of the formula for the raw value `x`.
    pub(super) fn apply(&self, x: f64) -> f64 {
        let mut values = [f64::NAN; DEEPEST + 1];
        // The number of values that wait; the formula was held against it when it was read.
        let mut top = 0;
        for step in &self.steps {
            let two =
                |values: &[f64], top: usize| (values[top.saturating_sub(2)], values[top.saturating_sub(1)]);
            match step {
                Step::Number(number) => (values[top], top) = (*number, top + 1),
                Step::Raw => (values[top], top) = (x, top + 1),
                Step::Negate => values[top.saturating_sub(1)] = -values[top.saturating_sub(1)],
                Step::Operator(sign) => {
                    let (a, b) = two(&values, top);
                    top = top.saturating_sub(1);
                    values[top.saturating_sub(1)] = match sign {
                        b'+' => a + b,
                        b'-' => a - b,
                        b'*' => a * b,
                        b'/' => a / b,
                        b'%' => a % b,
                        _ => a.powf(b),
                    };
                }
                Step::Function(place) => match FUNCTIONS[*place].1 {
                    One(function) => values[top.saturating_sub(1)] = function(values[top.saturating_sub(1)]),
                    Two(function) => {
                        let (a, b) = two(&values, top);
                        top = top.saturating_sub(1);
                        values[top.saturating_sub(1)] = function(a, b);
                    }
                },
            }
        }
        values[0]
    }
}

/// The rest of the text, and the steps read so far.
struct Parser<'a> {
    rest: &'a str,
    steps: Vec<Step>,
    depth: usize,
}

impl<'a> Parser<'a> {
    /// Passes this sign, if it is next.
    fn passes(&mut self, sign: &str) -> bool {
        let Some(rest) = self.rest.strip_prefix(sign) else { return false };
        self.rest = rest.trim_start();
        true
    }

    fn sum(&mut self) -> Option<()> {
        self.product()?;
        while let Some(sign) = self.rest.bytes().next().filter(|sign| b"+-".contains(sign)) {
            self.rest = self.rest[1..].trim_start();
            self.product()?;
            self.steps.push(Step::Operator(sign));
        }
        Some(())
    }

    fn product(&mut self) -> Option<()> {
        self.signed()?;
        while let Some(sign) = self.rest.bytes().next().filter(|sign| b"*/%".contains(sign)) {
            self.rest = self.rest[1..].trim_start();
            self.signed()?;
            self.steps.push(Step::Operator(sign));
        }
        Some(())
    }

    fn signed(&mut self) -> Option<()> {
        if self.passes("-") {
            self.deeper(Self::signed)?;
            self.steps.push(Step::Negate);
            return Some(());
        }
        self.passes("+");
        self.power()
    }

    fn power(&mut self) -> Option<()> {
        self.operand()?;
        if self.passes("**") {
            // To the right first: 2**3**2 is 2**9.
            self.deeper(Self::signed)?;
            self.steps.push(Step::Operator(b'^'));
        }
        Some(())
    }

    fn deeper(&mut self, read: fn(&mut Self) -> Option<()>) -> Option<()> {
        self.depth += 1;
        let read = if self.depth <= DEEPEST { read(self) } else { None };
        self.depth -= 1;
        read
    }

    fn operand(&mut self) -> Option<()> {
        if self.passes("(") {
            self.deeper(Self::sum)?;
            return self.passes(")").then_some(());
        }
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if self.rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            return self.number();
        }
        let word = &self.rest[..self.rest.find(|c| !is_word(c)).unwrap_or(self.rest.len())];
        let lower = word.to_ascii_lowercase();
        let step = match lower.as_str() {
            "x" | "x1" => Step::Raw,
            "pi" => Step::Number(std::f64::consts::PI),
            name => {
                let place = FUNCTIONS.iter().position(|(known, _)| *known == name)?;
                self.passes(word);
                if !self.passes("(") {
                    return None;
                }
                self.deeper(Self::sum)?;
                if matches!(FUNCTIONS[place].1, Two(_)) {
                    if !self.passes(",") {
                        return None;
                    }
                    self.deeper(Self::sum)?;
                }
                self.steps.push(Step::Function(place));
                return self.passes(")").then_some(());
            }
        };
        self.passes(word);
        self.steps.push(step);
        Some(())
    }

    fn number(&mut self) -> Option<()> {
        let bytes = self.rest.as_bytes();
        let digits =
            |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
        let mut end = digits(0);
        if bytes.get(end).is_some_and(|b| b.eq_ignore_ascii_case(&b'e')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = bytes
                .get(end + 1 + sign..)
                .map_or(0, |rest| rest.iter().take_while(|b| b.is_ascii_digit()).count());
            end += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        let (number, rest) = self.rest.split_at(end);
        self.steps.push(Step::Number(number.parse().ok()?));
        self.rest = rest.trim_start();
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn formulas_are_what_they_are_on_paper() {
        let x = 2.5f64;
        for (text, expected) in [
            ("X1/100", x / 100.0),
            ("x", x),
            ("(X1 - 32768) * 0.01", (x - 32768.0) * 0.01),
            ("-X**2", -x * x),
            ("2**3**2", 512.0),
            ("2**-1", 0.5),
            ("8/4/2", 1.0),
            ("1-2-3", -4.0),
            ("7 % 4", 3.0),
            ("1.5e-3*X + .5", 0.0015 * x + 0.5),
            ("pow(X1, 2) + sqrt(abs(-9))", x * x + 3.0),
            ("2*sin(PI/6)", 1.0),
            ("exp(ln(X)) - log10(100)", x - 2.0),
            ("max(X, 3) - min(X, 3)", 0.5),
            ("- - + X", x),
            ("((((X))))", x),
        ] {
            let value = Formula::parse(text).unwrap().apply(x);
            assert!((value - expected).abs() < 1e-12, "{text}: {value}, not {expected}");
        }
    }

    #[test]
    fn what_is_no_formula_of_one_number_is_named() {
        for text in [
            "", "X1 +", "X2", "X & 3", "sin X", "pow(X)", "X > 3", "(X", "X)", "1.2.3", "foo(X)", "é",
            "X1/100;", "X^2", "2^3^2",
        ] {
            assert!(Formula::parse(text).is_err(), "{text}");
        }
        let nested = format!("{}X{}", "(".repeat(100), ")".repeat(100));
        assert!(Formula::parse(&nested).is_err());
        assert!(Formula::parse(&format!("{}X{}", "X+(".repeat(20), ")".repeat(20))).is_ok());
        assert_eq!(Formula::parse("X1 * 2 @ 3"), Err("@ 3".to_owned()));
    }

    proptest! {
        /// Whatever is written: a formula that can be evaluated, or none.
        #[test]
        fn anything_may_be_written(text in "[X0-9+*/^%(). ,a-z-]{0,60}", x in proptest::num::f64::ANY) {
            if let Ok(formula) = Formula::parse(&text) {
                formula.apply(x);
            }
        }
    }
}
