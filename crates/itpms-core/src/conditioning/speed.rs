//! How fast the car is, and how far it has gone, where not every sample says so.
//!
//! Called by the estimators, the monitor and everybody who counts the way.

use crate::memory::blank;
use crate::real::Real;

/// Speed in m/s below which no frame of a wheel or a strut is learned from.
pub(crate) const STANDING_M_S: f64 = 2.5;
/// Longest time in s for which a speed is taken to go on: a car that brakes hard is 4 m/s slower by then.
const HOLD_S: f64 = 0.5;

/// Speeds in m/s that cars have: backwards, forwards. Anything else is a bus that tells nonsense, or a sign that is wrong: a car
/// that stood or reversed for good would never be read again.
const CARS_M_S: core::ops::RangeInclusive<f64> = -5.0..=100.0;

/// Whether this is a speed in m/s that a car can have, -5 to 100.
#[must_use]
pub fn is_a_cars<T: Real>(speed_m_s: T) -> bool {
    CARS_M_S.contains(&speed_m_s.to_f64())
}

/// Bridges the samples that come without a speed, as where a bus tells it less often than the accelerations: the last one
/// goes on for half a second. What no car drives ([`is_a_cars`]) is no speed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpeedHold<T> {
    known_s: f64,
    speed_m_s: T,
}

blank!(SpeedHold<T> { known_s, speed_m_s });

impl<T: Real> SpeedHold<T> {
    /// Nothing is known yet.
    #[must_use]
    pub fn new() -> Self {
        Self { known_s: f64::NEG_INFINITY, speed_m_s: T::lit(f64::NAN) }
    }

    /// Takes a sample's time in s and speed in m/s, NaN when it has none; gives the speed to go by, NaN when that is unknown.
    pub fn take(&mut self, time_s: f64, speed_m_s: T) -> T {
        if is_a_cars(speed_m_s) {
            (self.known_s, self.speed_m_s) = (time_s, speed_m_s);
            return speed_m_s;
        }
        let age_s = time_s - self.known_s;
        if (0.0..=HOLD_S).contains(&age_s) { self.speed_m_s } else { T::lit(f64::NAN) }
    }
}

impl<T: Real> Default for SpeedHold<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// Longest step in s over which a way is counted: longer, and how far the car went is unknown.
const LONGEST_STEP_S: f64 = 10.0;

/// Counts the way by the trapezoidal rule, from the speeds that [`SpeedHold`] gives.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Odometer {
    speed: SpeedHold<f64>,
    time_s: f64,
    speed_m_s: f64,
    distance_m: f64,
}

impl Odometer {
    /// Nothing is known yet.
    #[must_use]
    pub fn new() -> Self {
        Self { speed: SpeedHold::new(), time_s: f64::NAN, speed_m_s: f64::NAN, distance_m: f64::NAN }
    }

    /// Takes a sample's time in s and speed in m/s, NaN when it has none; gives the speed to go by, NaN when that is unknown.
    pub fn push(&mut self, time_s: f64, speed_m_s: f64) -> f64 {
        let speed_m_s = self.speed.take(time_s, speed_m_s);
        if speed_m_s.is_finite() && self.distance_m.is_nan() {
            self.distance_m = 0.0;
        }
        let (step_s, mean_m_s) = (time_s - self.time_s, 0.5 * (speed_m_s + self.speed_m_s));
        if step_s > 0.0 && step_s <= LONGEST_STEP_S && mean_m_s > 0.0 && mean_m_s.is_finite() {
            self.distance_m += mean_m_s * step_s;
        }
        (self.time_s, self.speed_m_s) = (time_s, speed_m_s);
        speed_m_s
    }

    /// The speed in m/s to go by, NaN when that is unknown.
    #[must_use]
    pub fn speed_m_s(&self) -> f64 {
        self.speed_m_s
    }

    /// The way in m so far, NaN while no speed was ever known.
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        self.distance_m
    }
}

impl Default for Odometer {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_goes_on_for_half_a_second() {
        let mut speed = SpeedHold::new();
        assert!(speed.take(0.0, f64::NAN).is_nan());
        assert_eq!(speed.take(1.0, 20.0), 20.0);
        assert_eq!(speed.take(1.5, f64::NAN), 20.0);
        // It is as old as when it was sent, not as when it was last asked for.
        assert!(speed.take(1.6, f64::INFINITY).is_nan());
        // A clock that was set back, or is broken, says nothing of its age.
        assert!(speed.take(0.9, f64::NAN).is_nan());
        assert!(speed.take(f64::NAN, f64::NAN).is_nan());
        assert_eq!(speed.take(f64::NAN, 19.0), 19.0);
        assert!(speed.take(2.0, f64::NAN).is_nan());
    }

    #[test]
    fn what_no_car_drives_is_no_speed() {
        let mut speed = SpeedHold::new();
        assert_eq!(speed.take(0.0, 22.0f32), 22.0);
        for nonsense in [655.35f32, f32::MAX, -6.0, f32::MIN, f32::INFINITY] {
            assert_eq!(speed.take(0.1, nonsense), 22.0);
        }
        assert!(speed.take(0.6, 655.35).is_nan());
        assert_eq!([speed.take(0.7, -3.0), speed.take(0.8, 99.0)], [-3.0, 99.0]);
    }

    #[test]
    fn a_way_is_counted_where_the_speed_is_known() {
        let mut way = Odometer::new();
        assert!(way.push(0.0, f64::NAN).is_nan() && way.distance_m().is_nan());
        // 10 to 20 m/s within ten seconds are 150 m, however seldom the speed is sent.
        for tenths in 10..=110u32 {
            let time_s = 0.1 * f64::from(tenths);
            let is_sent = tenths.is_multiple_of(5);
            way.push(time_s, if is_sent { 9.0 + time_s } else { f64::NAN });
        }
        // A held speed is up to 0.4 s old, 0.2 s on average: 2 m short.
        assert!((way.distance_m() - 148.0).abs() < 0.1, "{}", way.distance_m());
        let before_m = way.distance_m();
        // Unknown for longer than it is held: 0.5 s count, at 20 m/s.
        for tenths in 111..=200u32 {
            way.push(0.1 * f64::from(tenths), f64::NAN);
        }
        assert!((way.distance_m() - before_m - 10.0).abs() < 0.1 && way.speed_m_s().is_nan());
        // Nor does a hole in the record, or a clock that goes back.
        let before_m = way.distance_m();
        for time_s in [20.0, 31.0, 5.0] {
            way.push(time_s, 20.0);
        }
        assert_eq!(way.distance_m(), before_m);
    }
}
