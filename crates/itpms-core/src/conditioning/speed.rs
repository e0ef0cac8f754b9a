//! How fast the car is, where not every sample says so.
//!
//! Called by the estimators, the monitor and everybody who counts the way.

use crate::conditioning::pauses::MISSING_S;
use crate::memory::Blank;
use crate::real::Real;

/// Speed in m/s below which no frame of a wheel or a strut is learned from.
pub(crate) const STANDING_M_S: f64 = 2.5;

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
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpeedHold<T> {
    known_s: f64,
    speed_m_s: T,
}

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
        if (0.0..=MISSING_S).contains(&age_s) { self.speed_m_s } else { T::lit(f64::NAN) }
    }
}

impl<T: Real> Default for SpeedHold<T> {
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
}
