//! Histories in time that are straight between given points: the car's speed and a tire's pressure.
//!
//! Called by the scenario (which holds them as written) and the simulation (which asks for values). Before the
//! first point and after the last the value holds.

use std::cell::Cell;

use serde::{Deserialize, Serialize};

use crate::error::{InvalidValue, Result, not_negative, within};

/// A continuous function of time, straight between its points, with its integral.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeProfile {
    times_s: Vec<f64>,
    values: Vec<f64>,
    integrals: Vec<f64>,
    integral_to_zero: f64,
    /// Where the last question was answered.
    found: Found,
}

/// The point found last: a drive asks for one time after the other, and mostly between the same two points. It changes
/// no answer and makes no profile another one.
#[derive(Debug, Clone, Default)]
struct Found(Cell<usize>);

impl PartialEq for Found {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl TimeProfile {
    pub fn constant(value: f64) -> Self {
        let found = Found::default();
        Self { times_s: vec![0.0], values: vec![value], integrals: vec![0.0], integral_to_zero: 0.0, found }
    }

    /// Through `[time_s, value]` points, at least one. Errors: names the point that is not finite or whose time does not increase.
    pub fn new(points: &[[f64; 2]]) -> Result<Self> {
        if points.is_empty() {
            return Err(InvalidValue::new("points", "empty", "at least one [time_s, value] point"));
        }
        let (mut times_s, mut values, mut integrals) = (Vec::new(), Vec::new(), Vec::new());
        for (i, &[time, value]) in points.iter().enumerate() {
            if !(time.is_finite() && value.is_finite()) {
                let found = format!("[{time}, {value}]");
                return Err(InvalidValue::new(format!("point {}", i + 1), found, "two finite numbers"));
            }
            let integral = match (times_s.last(), values.last(), integrals.last()) {
                (Some(&t0), Some(&v0), Some(&i0)) => {
                    if !(time > t0) {
                        let found = format!("{time} after {t0}");
                        let field = format!("the time of point {}", i + 1);
                        return Err(InvalidValue::new(field, found, "times that increase"));
                    }
                    i0 + 0.5 * (time - t0) * (value + v0)
                }
                _ => 0.0,
            };
            times_s.push(time);
            values.push(value);
            integrals.push(integral);
        }
        let mut profile = Self { times_s, values, integrals, integral_to_zero: 0.0, found: Found::default() };
        profile.integral_to_zero = profile.since_first_point(0.0);
        Ok(profile)
    }

    pub fn value(&self, time_s: f64) -> f64 {
        self.value_after(self.last_point(time_s), time_s)
    }

    /// Integral from 0 s to a time in s; negative before 0 s when the value is positive.
    pub fn integral(&self, time_s: f64) -> f64 {
        self.since_first_point(time_s) - self.integral_to_zero
    }

    /// Largest value, reached at one of the points.
    pub fn maximum(&self) -> f64 {
        self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Smallest value, reached at one of the points.
    pub fn minimum(&self) -> f64 {
        self.values.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The last point not later than a time, or the first point.
    fn last_point(&self, time_s: f64) -> usize {
        let last = self.found.0.get();
        let is_next = |point: usize| self.times_s.get(point + 1).is_none_or(|&t| t > time_s);
        if (last == 0 || self.times_s[last] <= time_s) && is_next(last) {
            return last;
        }
        let point = self.times_s.partition_point(|&t| t <= time_s).saturating_sub(1);
        self.found.0.set(point);
        point
    }

    fn value_after(&self, point: usize, time_s: f64) -> f64 {
        let (t0, v0) = (self.times_s[point], self.values[point]);
        match (self.times_s.get(point + 1), self.values.get(point + 1)) {
            (Some(t1), Some(v1)) if time_s > t0 => v0 + (v1 - v0) * (time_s - t0) / (t1 - t0),
            _ => v0,
        }
    }

    fn since_first_point(&self, time_s: f64) -> f64 {
        let point = self.last_point(time_s);
        let mean = 0.5 * (self.values[point] + self.value_after(point, time_s));
        self.integrals[point] + (time_s - self.times_s[point]) * mean
    }
}

/// The car's speed over time, as written in a scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Speed {
    #[serde(rename = "constant_km_h")]
    ConstantKmH(f64),
    /// Points `[time in s, speed in km/h]`, straight between them; zero is a stop.
    #[serde(rename = "points_s_km_h")]
    PointsSKmH(Vec<[f64; 2]>),
    /// Composed from the seed, as the scenario's `[journey]` says.
    #[serde(rename = "journey")]
    Journey,
}

impl Speed {
    /// Speed in m/s over time; its integral is the distance in m. Errors: speeds are finite and from 0 to 500 km/h, times increase.
    pub fn profile_m_s(&self) -> Result<TimeProfile> {
        let points = match self {
            Speed::ConstantKmH(v) => vec![[0.0, *v]],
            Speed::PointsSKmH(points) => points.clone(),
            Speed::Journey => {
                return Err(InvalidValue::new("journey", "without one", "a scenario with a [journey]"));
            }
        };
        for [_, v] in &points {
            within("km/h", *v, 0.0, 500.0, "a speed from 0 to 500")?;
        }
        TimeProfile::new(&points.iter().map(|&[t, v]| [t, v / 3.6]).collect::<Vec<_>>())
    }
}

/// A tire's gauge pressure over time, as written in a scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Pressure {
    #[serde(rename = "constant_kpa")]
    ConstantKpa(f64),
    /// Points `[time in s, pressure in kPa]`, straight between them.
    #[serde(rename = "points_s_kpa")]
    PointsSKpa(Vec<[f64; 2]>),
}

impl Pressure {
    /// Holds `from_kpa` until `start_s`, then goes straight to `to_kpa` within `duration_s`.
    pub fn ramp(from_kpa: f64, to_kpa: f64, start_s: f64, duration_s: f64) -> Self {
        Pressure::PointsSKpa(vec![[start_s, from_kpa], [start_s + duration_s, to_kpa]])
    }

    /// Pressure in kPa over time. Errors: pressures are finite and not negative, times increase.
    pub fn profile_kpa(&self) -> Result<TimeProfile> {
        let points = match self {
            Pressure::ConstantKpa(p) => vec![[0.0, *p]],
            Pressure::PointsSKpa(points) => points.clone(),
        };
        for [_, p] in &points {
            not_negative("kPa", *p)?;
        }
        TimeProfile::new(&points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_integrals_are_those_of_the_polygon() {
        let p = TimeProfile::new(&[[10.0, 2.0], [20.0, 6.0], [30.0, 0.0]]).unwrap();
        for (t, v) in
            [(-5.0, 2.0), (10.0, 2.0), (15.0, 4.0), (20.0, 6.0), (25.0, 3.0), (30.0, 0.0), (99.0, 0.0)]
        {
            assert!((p.value(t) - v).abs() < 1e-12, "{t}");
        }
        // By hand: 20 m until 10 s, 40 m more until 20 s, 30 m more until 30 s, then standing.
        for (t, d) in
            [(-1.0, -2.0), (0.0, 0.0), (10.0, 20.0), (15.0, 35.0), (20.0, 60.0), (30.0, 90.0), (50.0, 90.0)]
        {
            assert!((p.integral(t) - d).abs() < 1e-12, "{t}");
        }
        assert_eq!((p.minimum(), p.maximum()), (0.0, 6.0));
    }

    #[test]
    fn bad_points_are_named() {
        let e = TimeProfile::new(&[[0.0, 1.0], [0.0, 2.0]]).unwrap_err().to_string();
        assert_eq!(e, "the time of point 2 is 0 after 0, expected times that increase");
        assert!(TimeProfile::new(&[]).is_err());
        assert!(TimeProfile::new(&[[0.0, f64::NAN]]).is_err());
        assert!(Speed::ConstantKmH(-1.0).profile_m_s().is_err());
        assert!(Pressure::ConstantKpa(f64::NAN).profile_kpa().is_err());
    }
}
