//! Numbers of the page's curves as JSON: rounded to significant digits, `null` where there is none.

use serde::Serialize;
use serde::ser::{SerializeSeq, Serializer};

/// Significant digits of values; positions along an axis have more.
const VALUE_DIGITS: i32 = 5;
const AXIS_DIGITS: i32 = 8;

/// Numbers with so many significant digits; what is not finite becomes `null`.
pub(super) struct Digits<'a>(&'a [f64], i32);

impl Serialize for Digits<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.0.len()))?;
        for &value in self.0 {
            list.serialize_element(&Number(value, self.1))?;
        }
        list.end()
    }
}

pub(super) struct Number(f64, i32);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let value = round(self.0, self.1);
        if !value.is_finite() {
            serializer.serialize_none()
        } else if value.fract() == 0.0 && value.abs() < 1e9 {
            serializer.serialize_i64(value as i64)
        } else {
            serializer.serialize_f64(value)
        }
    }
}

/// To so many significant digits, such that the shortest decimal is short.
fn round(value: f64, digits: i32) -> f64 {
    if !value.is_finite() || value.abs() < 1e-30 {
        return if value.is_finite() { 0.0 } else { f64::NAN };
    }
    let place = digits - 1 - value.abs().log10().floor() as i32;
    let power = 10f64.powi(place.abs());
    if place >= 0 { (value * power).round() / power } else { (value / power).round() * power }
}

pub(super) fn value(v: f64) -> Number {
    Number(v, VALUE_DIGITS)
}

pub(super) fn position(v: f64) -> Number {
    Number(v, AXIS_DIGITS)
}

pub(super) fn values(v: &[f64]) -> Digits<'_> {
    Digits(v, VALUE_DIGITS)
}

pub(super) fn axis(v: &[f64]) -> Digits<'_> {
    Digits(v, AXIS_DIGITS)
}
