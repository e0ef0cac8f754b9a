//! A body that bends or twists: one mode beside heave, pitch and roll.
//!
//! Part of a car in a scenario and of the whole car that moves.

use serde::{Deserialize, Serialize};

use crate::error::{Result, positive, within};

/// A mode of the body, free in the air.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bending {
    pub frequency_hz: f64,
    #[serde(default = "usual_ratio")]
    pub damping_ratio: f64,
    /// Its modal mass in kg, for the participations given.
    pub modal_mass_kg: f64,
    /// Its participation at the struts' tops, in the order of `Corner::ALL`.
    pub participation: [f64; 4],
}

fn usual_ratio() -> f64 {
    0.03
}

impl Bending {
    pub(crate) fn validate(&self) -> Result<()> {
        within("frequency_hz", self.frequency_hz, 5.0, 100.0, "a frequency from 5 to 100 Hz")?;
        within("damping_ratio", self.damping_ratio, 0.0, 0.5, "a ratio from 0 to 0.5")?;
        positive("modal_mass_kg", self.modal_mass_kg)?;
        for share in self.participation {
            within("participation", share, -10.0, 10.0, "shares from -10 to 10")?;
        }
        Ok(())
    }
}
