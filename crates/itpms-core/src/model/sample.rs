//! Input: one time, one speed, up to four corners. A missing value is NaN, as in the drive log.

use core::ops::{Index, IndexMut};

use crate::memory::Blank;
use crate::real::Real;

/// An acceleration in m/s² that is none: a wheel on a kerb reaches some 500 m/s²; twice that is no car any more.
pub(crate) const ABSURD_M_S2: f64 = 1000.0;

crate::labelled! {
    /// A corner of the car, in the order of every four-element array here.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Blank)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub enum Corner {
        /// Front left.
        #[blank]
        FrontLeft = "fl",
        /// Front right.
        FrontRight = "fr",
        /// Rear left.
        RearLeft = "rl",
        /// Rear right.
        RearRight = "rr",
    }
}

impl Corner {
    /// This corner's place in [`Corner::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    pub(crate) fn side(self) -> Side {
        [Side::Left, Side::Right, Side::Left, Side::Right][self]
    }

    pub(crate) fn same_side(self) -> Self {
        [Corner::RearLeft, Corner::RearRight, Corner::FrontLeft, Corner::FrontRight][self]
    }

    pub(crate) fn same_axle(self) -> Self {
        [Corner::FrontRight, Corner::FrontLeft, Corner::RearRight, Corner::RearLeft][self]
    }

    pub(crate) fn others(self) -> [Self; 3] {
        [1, 2, 3].map(|step| Self::ALL[(self as usize + step) % 4])
    }

    /// Zero in front, one at the rear.
    pub(crate) fn axle(self) -> usize {
        usize::from(self >= Corner::RearLeft)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Side {
    #[blank]
    Left,
    Right,
}

impl Side {
    /// Both, in the order of every two-element array of them.
    pub(crate) const ALL: [Side; 2] = [Side::Left, Side::Right];

    pub(crate) fn other(self) -> Self {
        [Side::Right, Side::Left][self]
    }

    pub(crate) fn front(self) -> Corner {
        [Corner::FrontLeft, Corner::FrontRight][self]
    }

    pub(crate) fn rear(self) -> Corner {
        [Corner::RearLeft, Corner::RearRight][self]
    }

    /// Its place in [`Side::ALL`].
    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

/// Something of each `$of`: no place is outside of it. The remainder changes none, and where a compiler has lost sight of that it is cheaper
/// than a bound to check, or a table of jumps.
macro_rules! one_each {
    ($of:ident, $count:literal) => {
        impl<X> Index<$of> for [X; $count] {
            type Output = X;

            #[inline]
            fn index(&self, of: $of) -> &X {
                &self[of as usize % $count]
            }
        }

        impl<X> IndexMut<$of> for [X; $count] {
            #[inline]
            fn index_mut(&mut self, of: $of) -> &mut X {
                &mut self[of as usize % $count]
            }
        }
    };
}

one_each!(Corner, 4);
one_each!(Side, 2);

/// The two accelerations of one corner, positive upwards. NaN is a missing value.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CornerSample<T> {
    /// Sprung mass acceleration in m/s².
    pub body_accel_m_s2: T,
    /// Unsprung mass acceleration in m/s².
    pub wheel_accel_m_s2: T,
}

/// Four wheel speeds and what the car says of its motion besides. NaN: not known.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelSpeedSample<T> {
    /// Time of the message in s, strictly increasing.
    pub time_s: f64,
    /// Speeds of the wheels as the car has them, each by the same assumed radius, in the order of [`Corner::ALL`].
    pub wheel_speed_m_s: [T; 4],
    /// Yaw rate, positive to the left.
    pub yaw_rate_rad_s: T,
    /// Acceleration forward, gravity along a grade included.
    pub accel_x_m_s2: T,
    /// Acceleration to the left.
    pub accel_y_m_s2: T,
    /// Whether the driver brakes.
    pub brake: Option<bool>,
}

/// One row of a car's drive: what came with it of accelerations and wheel speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CarSample<T> {
    /// Time in s, strictly increasing.
    pub time_s: f64,
    /// Vehicle speed in m/s; NaN when unknown.
    pub speed_m_s: T,
    /// The accelerations; a corner that is not measured is `None`.
    pub corners: [Option<CornerSample<T>>; 4],
    /// The wheel speeds, where a message of them has come since the last sample.
    pub wheel_speeds: Option<WheelSpeedSample<T>>,
}

impl<T: Real> CarSample<T> {
    /// A message of the wheel speeds between two samples of the accelerations, or of a car that has none.
    #[must_use]
    pub fn of_wheel_speeds(message: WheelSpeedSample<T>) -> Self {
        let (time_s, speed_m_s) = (message.time_s, T::lit(f64::NAN));
        Self { time_s, speed_m_s, corners: [None; 4], wheel_speeds: Some(message) }
    }

    /// Whether it is one: the accelerations are neither measured nor missing.
    pub(crate) fn is_of_wheel_speeds(&self) -> bool {
        self.wheel_speeds.is_some() && self.corners.iter().all(Option::is_none)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_know_their_sides_and_axles() {
        use Corner::{FrontLeft, FrontRight, RearLeft, RearRight};
        assert_eq!(Corner::ALL.map(Corner::same_side), [RearLeft, RearRight, FrontLeft, FrontRight]);
        assert_eq!(Corner::ALL.map(Corner::same_axle), [FrontRight, FrontLeft, RearRight, RearLeft]);
        assert_eq!(Corner::ALL.map(Corner::axle), [0, 0, 1, 1]);
        for (i, corner) in Corner::ALL.into_iter().enumerate() {
            assert_eq!(
                ([0, 1, 2, 3][corner], ["left", "right"][corner.side()]),
                (i, ["left", "right"][i % 2])
            );
        }
    }
}
