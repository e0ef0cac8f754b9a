//! An alert: which wheels, since when, and why, with the numbers that decided.

use core::fmt;

use super::wheels::Wheels;
use crate::real::Real;
use crate::sample::Corner;

/// Alerts that were said less than so many seconds apart are one: decisions are further apart, and rounding is nearer.
const SAME_S: f64 = 1e-3;

/// Something the driver or the workshop should know.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Alert<T> {
    /// Whom it is about.
    pub wheels: Wheels,
    /// Since when it has been so, in s, as far as can be told.
    pub since_s: f64,
    /// When it was first said, in s.
    pub said_s: f64,
    /// Why.
    pub cause: Cause<T>,
}

/// Why an alert stands.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Cause<T> {
    /// The pressure is certainly below the limit.
    UnderInflated(Reading<T>),
    /// The pressure falls fast against that of the other wheels.
    FastLeak {
        /// The pressure now.
        reading: Reading<T>,
        /// How fast it fell at most since the leak began, over ten seconds or more, in kPa per minute, positive.
        rate_kpa_per_min: T,
    },
    /// All wheels together are low, though none of them needs to be so for certain by itself.
    AllLow {
        /// Mean of pressure over reference.
        mean_share: T,
        /// Its standard deviation.
        sd_share: T,
    },
    /// The pressure is certainly above the limit.
    OverInflated(Reading<T>),
    /// A sensor or its wiring.
    Malfunction(Malfunction<T>),
    /// Nothing could be learned for too long a time of driving.
    NoInformation {
        /// That time in s.
        driven_s: f64,
    },
}

/// The pressure that decided.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading<T> {
    /// Gauge pressure in kPa.
    pub pressure_kpa: T,
    /// Its standard deviation in kPa.
    pub sd_kpa: T,
    /// The limit it has passed, in kPa.
    pub limit_kpa: T,
    /// What the pressure should be, in kPa.
    pub reference_kpa: T,
}

/// Where an accelerometer sits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Place {
    /// On the sprung mass.
    Body,
    /// On the unsprung mass.
    Wheel,
}

/// An accelerometer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sensor {
    /// Its corner.
    pub corner: Corner,
    /// Where there.
    pub place: Place,
}

/// What is wrong with a sensor, as far as can be told.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Malfunction<T> {
    /// It repeats one value.
    Stuck(Sensor),
    /// Too many of its samples are missing.
    Dropout(Sensor),
    /// Single samples far from their neighbors.
    Spikes(Sensor),
    /// Noisier than before, or than its like.
    Noise(Sensor),
    /// It reads too much or too little.
    Gain {
        /// Which.
        sensor: Sensor,
        /// Reading over truth.
        gain: T,
    },
    /// Two sensors carry each other's name.
    Swapped(Sensor, Sensor),
    /// Both sensors of the left and the right corner of one axle carry each other's name; of which, cannot be told.
    SwappedSides,
    /// Both sensors of the front and the rear corner of one side carry each other's name; of which, cannot be told.
    SwappedAxles,
    /// The corner's signals do not fit each other or the rest of the car, and which is wrong cannot be told.
    Inconsistent(Corner),
}

impl<T> Malfunction<T> {
    /// One word: `stuck`, `dropout`, `spikes`, `noise`, `gain`, `swapped` or `inconsistent`.
    #[must_use]
    pub fn label(&self) -> &'static str {
        match self {
            Malfunction::Stuck(_) => "stuck",
            Malfunction::Dropout(_) => "dropout",
            Malfunction::Spikes(_) => "spikes",
            Malfunction::Noise(_) => "noise",
            Malfunction::Gain { .. } => "gain",
            Malfunction::Swapped(..) | Malfunction::SwappedSides | Malfunction::SwappedAxles => "swapped",
            Malfunction::Inconsistent(_) => "inconsistent",
        }
    }

    /// Whether the same is wrong with the same sensors, perhaps by another figure.
    fn is_same_as(&self, other: &Self) -> bool {
        match (self, other) {
            (Malfunction::Stuck(a), Malfunction::Stuck(b))
            | (Malfunction::Dropout(a), Malfunction::Dropout(b))
            | (Malfunction::Spikes(a), Malfunction::Spikes(b))
            | (Malfunction::Noise(a), Malfunction::Noise(b))
            | (Malfunction::Gain { sensor: a, .. }, Malfunction::Gain { sensor: b, .. }) => a == b,
            (Malfunction::Swapped(a, b), Malfunction::Swapped(c, d)) => [a, b] == [c, d] || [b, a] == [c, d],
            (Malfunction::Inconsistent(a), Malfunction::Inconsistent(b)) => a == b,
            (a, b) => core::mem::discriminant(a) == core::mem::discriminant(b),
        }
    }

    /// The corners whose pressures cannot be trusted while it lasts.
    #[must_use]
    pub fn wheels(&self) -> Wheels {
        match self {
            Malfunction::Stuck(sensor)
            | Malfunction::Dropout(sensor)
            | Malfunction::Spikes(sensor)
            | Malfunction::Noise(sensor)
            | Malfunction::Gain { sensor, .. } => sensor.corner.into(),
            Malfunction::Swapped(a, b) => Wheels::from(a.corner) | b.corner.into(),
            Malfunction::SwappedSides | Malfunction::SwappedAxles => Corner::ALL.into_iter().collect(),
            Malfunction::Inconsistent(corner) => (*corner).into(),
        }
    }
}

impl<T> Cause<T> {
    /// One word: `under-inflated`, `fast-leak`, `all-low`, `over-inflated`, `malfunction` or `no-information`.
    #[must_use]
    pub fn label(&self) -> &'static str {
        match self {
            Cause::UnderInflated(_) => "under-inflated",
            Cause::FastLeak { .. } => "fast-leak",
            Cause::AllLow { .. } => "all-low",
            Cause::OverInflated(_) => "over-inflated",
            Cause::Malfunction(_) => "malfunction",
            Cause::NoInformation { .. } => "no-information",
        }
    }
}

impl<T> Alert<T> {
    /// Whether this is what became of it, perhaps with newer numbers, after the clock was set back by so much in between.
    pub(super) fn is_same_as(&self, other: &Self, set_back_s: f64) -> bool {
        let same_fault = match (&self.cause, &other.cause) {
            (Cause::Malfunction(a), Cause::Malfunction(b)) => a.is_same_as(b),
            (a, b) => a.label() == b.label(),
        };
        same_fault && self.wheels == other.wheels && (self.said_s - set_back_s - other.said_s).abs() < SAME_S
    }
}

impl fmt::Display for Sensor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = match self.place {
            Place::Body => "body",
            Place::Wheel => "wheel",
        };
        write!(f, "{} {place} sensor", self.corner.label())
    }
}

impl<T: Real> fmt::Display for Malfunction<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Malfunction::Stuck(sensor) => write!(f, "{sensor} is stuck"),
            Malfunction::Dropout(sensor) => write!(f, "{sensor} loses samples"),
            Malfunction::Spikes(sensor) => write!(f, "{sensor} has spikes"),
            Malfunction::Noise(sensor) => write!(f, "{sensor} is too noisy"),
            Malfunction::Gain { sensor, gain } => {
                write!(f, "{sensor} reads {:.2} times what it should", gain.to_f64())
            }
            Malfunction::Swapped(a, b) => write!(f, "{a} and {b} are swapped"),
            Malfunction::SwappedSides => f.write_str("left and right of one axle are swapped"),
            Malfunction::SwappedAxles => f.write_str("front and rear of one side are swapped"),
            Malfunction::Inconsistent(corner) => {
                write!(f, "the sensors of {} do not fit the others", corner.label())
            }
        }
    }
}

impl<T: Real> fmt::Display for Reading<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [pressure, sd, limit, reference] =
            [self.pressure_kpa, self.sd_kpa, self.limit_kpa, self.reference_kpa].map(Real::to_f64);
        write!(f, "{pressure:.0} kPa (sd {sd:.0}), limit {limit:.0} of {reference:.0}")
    }
}

/// A sentence for a person: wheels, why, the numbers, since when.
impl<T: Real> fmt::Display for Alert<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.cause {
            Cause::UnderInflated(reading) => write!(f, "{} under-inflated: {reading}", self.wheels)?,
            Cause::FastLeak { reading, rate_kpa_per_min } => {
                let rate = rate_kpa_per_min.to_f64();
                write!(f, "{} lost up to {rate:.0} kPa per minute: {reading}", self.wheels)?;
            }
            Cause::AllLow { mean_share, sd_share } => {
                let [mean, sd] = [mean_share, sd_share].map(|share| 100.0 * share.to_f64());
                write!(f, "all wheels low: at {mean:.0} % (sd {sd:.0}) of their reference")?;
            }
            Cause::OverInflated(reading) => write!(f, "{} over-inflated: {reading}", self.wheels)?,
            Cause::Malfunction(malfunction) => write!(f, "malfunction: {malfunction}")?,
            Cause::NoInformation { driven_s } => {
                write!(f, "{}: nothing learned in {:.0} min of driving", self.wheels, driven_s / 60.0)?;
            }
        }
        write!(f, "; since {:.1} s, said at {:.1} s", self.since_s, self.said_s)
    }
}
