//! An axis: its words, its range, and the way from a value to a place.

use super::ticks::{Ticks, linear, logarithmic};

/// No axis goes further: a range has to be a number itself, with its margin. What lies beyond is cut off.
const FARTHEST: f64 = 1e300;

/// Share of its values that an axis covers at least.
const LEAST_SHARE: f64 = 1e-9;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Linear,
    Logarithmic,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    label: String,
    unit: String,
    scale: Scale,
    range: Option<(f64, f64)>,
    hold: Vec<f64>,
}

impl Axis {
    /// Evenly spaced. `unit` may be empty.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), scale: Scale::Linear, range: None, hold: vec![] }
    }

    /// Every factor of ten as long as the next. Values that are not positive are not drawn.
    pub fn logarithmic(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(label, unit) }
    }

    /// From `low` to `high`, whatever the data: what lies beyond is cut off and marked. Without this the range is that of the data.
    pub fn within(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// A value that must be on the axis where its range is that of the data.
    pub fn holding(mut self, value: f64) -> Self {
        self.hold.push(value);
        self
    }

    pub(super) fn caption(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} ({})", self.label, self.unit) }
    }

    /// With a range: its own, else a little more than the data's.
    pub(super) fn settled(&self, data: impl Iterator<Item = f64>, margin: f64) -> Settled {
        let logarithmic = self.scale == Scale::Logarithmic;
        let (low, high) = self.range.unwrap_or_else(|| {
            let usable = |value: &f64| value.is_finite() && (!logarithmic || *value > 0.0);
            let drawn = if logarithmic { 1.0 / FARTHEST..=FARTHEST } else { -FARTHEST..=FARTHEST };
            let within = |value: f64| value.clamp(*drawn.start(), *drawn.end());
            let all = data.chain(self.hold.iter().copied()).filter(usable).map(within);
            let (low, high) =
                all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
            // What differs by its last digits alone is one value: its ticks would need more digits than a number has.
            let apart = high - low > LEAST_SHARE * low.abs().max(high.abs());
            match (apart, low.is_finite()) {
                (true, _) if logarithmic => (low / 1.3, high * 1.3),
                (true, _) => (low - margin * (high - low), high + margin * (high - low)),
                (false, true) if logarithmic => (low / 2.0, low * 2.0),
                (false, true) => {
                    let half = (1e-6 * low.abs()).max(0.5);
                    (low - half, low + half)
                }
                (false, false) => (1.0, 2.0),
            }
        });
        Settled { logarithmic, low, high }
    }
}

/// An axis that knows its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settled {
    logarithmic: bool,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Settled {
    /// 0 at the low end, 1 at the high end; NaN where the value has no place.
    pub(super) fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value.ln() - self.low.ln()) / (self.high.ln() - self.low.ln())
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    pub(super) fn ticks(&self, count: usize) -> Ticks {
        if self.logarithmic { logarithmic(self.low, self.high) } else { linear(self.low, self.high, count) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_shares_of_the_range() {
        let axis = Axis::linear("Time", "s").within(10.0, 20.0).settled(std::iter::empty(), 0.0);
        assert_eq!([axis.place(10.0), axis.place(15.0), axis.place(20.0)], [0.0, 0.5, 1.0]);
        let axis = Axis::logarithmic("Frequency", "Hz").within(1.0, 100.0).settled(std::iter::empty(), 0.0);
        assert!((axis.place(10.0) - 0.5).abs() < 1e-12);
        assert!(axis.place(-1.0).is_nan());
    }

    #[test]
    fn the_range_is_that_of_usable_data() {
        let axis = Axis::linear("x", "").holding(-1.0).settled([f64::NAN, 0.0, 1.0].into_iter(), 0.0);
        assert_eq!((axis.low, axis.high), (-1.0, 1.0));
        let nothing = Axis::linear("x", "").settled(std::iter::empty(), 0.0);
        // A constant that was computed twice.
        let constant = Axis::linear("x", "").settled([241.3, 241.3 + 3e-13].into_iter(), 0.0);
        assert!(constant.high - constant.low > 0.5, "{constant:?}");
        assert!(nothing.low < nothing.high);
        let log = Axis::logarithmic("x", "").settled([0.0, 1.0, 10.0].into_iter(), 0.0);
        assert!(log.low > 0.0 && log.low < 1.0 && log.high > 10.0);
    }
}
