//! A sensor's fault as written in a scenario.

use itpms_core::model::Corner;
use serde::{Deserialize, Serialize};

use crate::error::{InvalidValue, Result, not_negative, positive, within};

/// Which of a corner's sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultPlace {
    Body,
    Wheel,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CornerName {
    Fl,
    Fr,
    Rl,
    Rr,
}

impl From<Corner> for CornerName {
    fn from(corner: Corner) -> Self {
        match corner {
            Corner::FrontLeft => Self::Fl,
            Corner::FrontRight => Self::Fr,
            Corner::RearLeft => Self::Rl,
            Corner::RearRight => Self::Rr,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorName {
    pub corner: CornerName,
    pub sensor: FaultPlace,
}

impl SensorName {
    pub fn new(corner: Corner, sensor: FaultPlace) -> Self {
        Self { corner: corner.into(), sensor }
    }

    /// Its place in [`Readings`](super::Readings).
    pub(super) fn index(self) -> [usize; 2] {
        [self.corner as usize, self.sensor as usize]
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum FaultKind {
    /// Repeats the value it had when the fault began.
    Stuck,
    /// Loses samples, each by itself.
    Dropout {
        share: f64,
    },
    /// Adds single values far off, up or down, at random times.
    Spikes {
        per_s: f64,
        size_m_s2: f64,
    },
    /// Reads so many times what it should.
    Gain {
        factor: f64,
    },
    Noise {
        rms_m_s2: f64,
    },
    Bias {
        offset_m_s2: f64,
    },
    /// Carries another sensor's values, and that one its own.
    Swap {
        with: SensorName,
    },
}

/// A fault: a `[[fault]]` table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaultSpec {
    pub corner: CornerName,
    pub sensor: FaultPlace,
    pub from_s: f64,
    /// When it ends, in s; never, if not given.
    pub to_s: Option<f64>,
    pub kind: FaultKind,
}

impl FaultSpec {
    /// From a time on, for good.
    pub fn lasting(corner: Corner, sensor: FaultPlace, from_s: f64, kind: FaultKind) -> Self {
        Self { corner: corner.into(), sensor, from_s, to_s: None, kind }
    }

    pub fn at(&self) -> SensorName {
        SensorName { corner: self.corner, sensor: self.sensor }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        within("from_s", self.from_s, -1e6, 1e6, "a time in s")?;
        if let Some(to_s) = self.to_s {
            within("to_s", to_s, self.from_s, 1e6, "a time in s after from_s")?;
        }
        match self.kind {
            FaultKind::Stuck => Ok(()),
            FaultKind::Dropout { share } => {
                within("kind.dropout.share", share, 0.0, 1.0, "a share from 0 to 1")
            }
            FaultKind::Spikes { per_s, size_m_s2 } => {
                positive("kind.spikes.per_s", per_s)?;
                positive("kind.spikes.size_m_s2", size_m_s2)
            }
            FaultKind::Gain { factor } => {
                within("kind.gain.factor", factor, -100.0, 100.0, "a factor from -100 to 100")
            }
            FaultKind::Noise { rms_m_s2 } => not_negative("kind.noise.rms_m_s2", rms_m_s2),
            FaultKind::Bias { offset_m_s2 } => {
                within("kind.bias.offset_m_s2", offset_m_s2, -1e3, 1e3, "an offset within 1000 m/s2")
            }
            FaultKind::Swap { with } if with == self.at() => {
                Err(InvalidValue::new("kind.swap.with", "the same sensor", "another one"))
            }
            FaultKind::Swap { .. } => Ok(()),
        }
    }
}
