//! What comes in: one time, one speed, up to four corners. A missing value is NaN, as in the drive log.

/// An acceleration in m/s² that is none: a wheel on a kerb reaches some 500 m/s²; twice that is no car any more.
pub(crate) const ABSURD_M_S2: f64 = 1000.0;

/// A corner of the car.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Corner {
    /// Front left.
    FrontLeft,
    /// Front right.
    FrontRight,
    /// Rear left.
    RearLeft,
    /// Rear right.
    RearRight,
}

impl Corner {
    /// All corners, in the order of every four-element array here.
    pub const ALL: [Corner; 4] = [Corner::FrontLeft, Corner::FrontRight, Corner::RearLeft, Corner::RearRight];

    /// The prefix of this corner's columns: `fl`, `fr`, `rl` or `rr`.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Corner::FrontLeft => "fl",
            Corner::FrontRight => "fr",
            Corner::RearLeft => "rl",
            Corner::RearRight => "rr",
        }
    }

    /// This corner's place in [`Corner::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }
}

/// The two accelerations of one corner, positive upwards. NaN is a missing value.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CornerSample<T> {
    /// Sprung mass acceleration in m/s².
    pub body_accel_m_s2: T,
    /// Unsprung mass acceleration in m/s².
    pub wheel_accel_m_s2: T,
}

/// One row of a drive: what one corner's estimator sees of it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample<T, C> {
    /// Time in s, strictly increasing.
    pub time_s: f64,
    /// Vehicle speed in m/s; NaN when unknown.
    pub speed_m_s: T,
    /// The accelerations: a [`CornerSample`], or an array of optional ones for the whole car.
    pub corners: C,
}

/// One row of a whole car's drive; a corner that is not measured is `None`.
pub type CarSample<T> = Sample<T, [Option<CornerSample<T>>; 4]>;
