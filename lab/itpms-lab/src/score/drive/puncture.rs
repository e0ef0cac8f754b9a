//! A puncture at two speeds, on the front wheels' track and beside it; and what each source of information is worth.
//!
//! Called by the plan of the four-wheel parts.

use itpms_core::car::Sources;

use super::{Drive, Plant, Setup};
use crate::runner::Result;

/// Speeds in km/h with the goals for the struck wheel's median RMSE in kPa: on the track, and beside it.
const SPEEDS: [(f64, f64, f64); 2] = [(80.0, 4.2, 4.5), (20.0, 6.5, 8.0)];
/// How far the rear wheels run beside the front ones' track, in m.
const OFFSET_M: f64 = 0.02;
/// A noisy sensor, in m/s² rms per sample.
const NOISY_M_S2: f64 = 0.3;

const SOURCES: [Setup; 4] = [
    Setup { label: "spectrum", sources: Sources::Spectrum, reset_s: None },
    Setup { label: "shared road", sources: Sources::SharedRoad, reset_s: None },
    Setup { label: "both", ..Setup::USUAL },
    Setup { label: "both, reset", ..Setup::RESET },
];

/// The punctures, each with the goal for its struck wheel.
pub(super) fn drives() -> Result<Vec<(Drive, Option<f64>)>> {
    let mut drives = vec![];
    for plant in Plant::ALL {
        for (km_h, on_track_kpa, beside_kpa) in SPEEDS {
            let drive = Drive::puncture(plant, km_h)?;
            let beside = drive.clone().with_rear_offset_m(OFFSET_M).named("2 cm off");
            drives.extend([(drive, Some(on_track_kpa)), (beside, Some(beside_kpa))]);
        }
    }
    Ok(drives)
}

/// The same on the track, seen through noisy sensors; without goals.
pub(super) fn noisy() -> Result<Vec<(Drive, Option<f64>)>> {
    let mut drives = vec![];
    for plant in Plant::ALL {
        for (km_h, _, _) in SPEEDS {
            drives.push((Drive::puncture(plant, km_h)?.with_noise(NOISY_M_S2), None));
        }
    }
    Ok(drives)
}

/// The same punctures, on the track, with one source of information at a time.
pub(super) fn ablation() -> Result<Vec<(Drive, Option<f64>)>> {
    let mut drives = vec![];
    for plant in Plant::ALL {
        for (km_h, _, _) in SPEEDS {
            drives.push((Drive::puncture(plant, km_h)?.with_setups(&SOURCES), None));
        }
    }
    Ok(drives)
}
