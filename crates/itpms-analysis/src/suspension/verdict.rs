//! A drive's verdict on dampers and load.

use itpms_data::reference::SuspensionReference;

use super::because::Because;
use super::car_body::CarBody;
use super::health::DamperHealth;
use super::load::Load;
use super::reading::SuspensionReading;
use super::spectra::SuspensionSpectra;

/// What may be judged, by the vehicle file.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Terms {
    /// The dampers do what a controller tells them.
    pub adaptive_dampers: bool,
    /// The springs follow the load.
    pub level_control: bool,
    /// Permitted axle loads in kg.
    pub gross_axle_kg: Option<[f64; 2]>,
}

/// The states of dampers and load after a drive, and what it would teach.
#[derive(Debug, Clone, PartialEq)]
pub struct SuspensionVerdict {
    /// The dampers, in the order of [`Corner::ALL`](itpms_core::model::Corner::ALL).
    pub dampers: [DamperHealth; 4],
    pub load: Load,
    /// The reference it would store for a healthy car; none where there is one already, or where the drive does not suffice.
    pub learned: Option<SuspensionReference>,
    /// Seconds of driving that were of use.
    pub usable_s: f64,
}

impl SuspensionVerdict {
    /// Of a car, with or without what it was when it was healthy.
    pub fn of(
        car: &CarBody,
        spectra: &SuspensionSpectra,
        reference: Option<&SuspensionReference>,
        terms: &Terms,
    ) -> Self {
        let adaptive = terms.adaptive_dampers.then_some(Because::Adaptive);
        let leveled = terms.level_control.then_some(Because::LevelControl);
        let doubt = adaptive.or(leveled.filter(|_| reference.is_some()));
        let read = match reference {
            Some(reference) => SuspensionReading::against(car, spectra, reference),
            None => SuspensionReading::alone(car, spectra),
        };
        let learned = match (&read, reference) {
            (Ok(reading), None) => reading.as_reference().ok(),
            _ => None,
        };
        let (dampers, load) = match (&read, reference) {
            (Err(because), _) => ([DamperHealth::unknown(*because); 4], Load::unknown(*because)),
            (Ok(reading), reference) => {
                let load = match (leveled, reference) {
                    (Some(because), _) => Load::unknown(because),
                    (None, None) => Load::unknown(Because::NoReference),
                    (None, Some(reference)) => Load::of(car, reading, reference, terms.gross_axle_kg),
                };
                (DamperHealth::of(car, reading, reference, doubt), load)
            }
        };
        Self { dampers, load, learned, usable_s: spectra.usable_s() }
    }
}
