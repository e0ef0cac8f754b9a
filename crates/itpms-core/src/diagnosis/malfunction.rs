//! Faults of a sensor.

use core::fmt;

use crate::memory::Blank;
use crate::model::{Corner, Wheels};
use crate::real::Real;

/// Quantity and place of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Place {
    /// The acceleration of the sprung mass.
    Body,
    /// The acceleration of the unsprung mass.
    Wheel,
    /// How fast the wheel turns.
    WheelSpeed,
}

/// A sensor of a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sensor {
    /// Its corner.
    pub corner: Corner,
    /// Which of its sensors.
    pub place: Place,
}

/// The known fault of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Malfunction<T> {
    /// It repeats one value.
    Stuck(Sensor),
    /// Too many of its samples are missing.
    Dropout(Sensor),
    /// Single samples far from their neighbors.
    Spikes(Sensor),
    /// Noisier than the same sensors at the other corners.
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
    /// Both sensors of the left and the right corner of one axle carry each other's name; of which is unknown.
    SwappedSides,
    /// Both sensors of the front and the rear corner of one side carry each other's name; of which is unknown.
    SwappedAxles,
    /// The corner's signals do not fit each other or the rest of the car, and which is wrong is unknown.
    Inconsistent(Corner),
}

impl<T: Real> Blank for Malfunction<T> {
    const BLANK: Self = Self::Stuck(Sensor { corner: Corner::FrontLeft, place: Place::Body });
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
    pub(crate) fn is_same_as(&self, other: &Self) -> bool {
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

impl fmt::Display for Sensor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = match self.place {
            Place::Body => "body",
            Place::Wheel => "wheel",
            Place::WheelSpeed => "wheel speed",
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
                write!(f, "{sensor} reads {:.2} times what it should", gain.to_f64())?;
                let other = " (a flat tire, a tire of another size, another signal?)";
                f.write_str(if sensor.place == Place::WheelSpeed { other } else { "" })
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
