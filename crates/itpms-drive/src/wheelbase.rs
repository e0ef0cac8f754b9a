//! The wheelbase as drives show it, for a vehicle file that says it was assumed.
//!
//! Called by `learn` before it listens to the tires: front and rear are compared at the right place from the first pass on.

use std::ops::ControlFlow;

use itpms_analysis::learn::{FoundWheelbase, WheelbaseListener};
use itpms_core::model::{CarConfig, Corner};
use itpms_data::{LogReader, Vehicle};

use crate::error::DriveError;
use crate::run::ROWS_PER_LOOK;

/// Standard deviations by which a wheelbase that was given may differ from what the drives show.
const FAR: f64 = 3.0;

/// The wheelbase by `drives` logs of a car, weighted by their standard deviations; `open` opens one by its number.
pub(crate) fn find(
    car: &CarConfig<f64>,
    drives: usize,
    open: &mut dyn FnMut(usize) -> Result<LogReader, DriveError>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Option<FoundWheelbase>, DriveError> {
    let mut found = vec![];
    for number in 0..drives {
        let mut log = open(number)?;
        let mut listener = WheelbaseListener::new(car, log.survey().estimator_rate_hz());
        let mut count = 0u64;
        while let Some(row) = log.next_row()? {
            let share = (number as f64 + log.progress()) / drives as f64;
            if count.is_multiple_of(ROWS_PER_LOOK) && watch(share).is_break() {
                return Err(DriveError::Stopped);
            }
            count += 1;
            listener.take(&row.sample());
        }
        found.extend(listener.finish());
    }
    let weight = |one: &FoundWheelbase| one.sd_m.powi(-2);
    let weights: f64 = found.iter().map(weight).sum();
    let mean = found.iter().map(|one| weight(one) * one.wheelbase_m).sum::<f64>() / weights;
    // Their systematic error is common to them.
    let least = found.iter().map(|one| one.sd_m).fold(f64::INFINITY, f64::min);
    Ok((!found.is_empty()).then_some(FoundWheelbase { wheelbase_m: mean, sd_m: least }))
}

/// The file with the wheelbase that was found in the place of one that was assumed.
pub(crate) fn with_found(file: &Vehicle, found: Option<FoundWheelbase>) -> Vehicle {
    let mut vehicle = file.clone();
    if let Some(found) = found.filter(|_| file.assumes_wheelbase()) {
        let to_mm = |m: f64| (1e3 * m).round() / 1e3;
        vehicle.wheelbase_m = Some(to_mm(found.wheelbase_m));
        vehicle.details.wheelbase_sd_m = Some(to_mm(found.sd_m));
    }
    vehicle
}

/// A caveat of it, if there is one.
pub(crate) fn doubt(file: &Vehicle, found: Option<FoundWheelbase>) -> Option<String> {
    let side = |front, rear| file.corner(front).is_some() && file.corner(rear).is_some();
    let has_side = side(Corner::FrontLeft, Corner::RearLeft) || side(Corner::FrontRight, Corner::RearRight);
    let stated_m = file.wheelbase_m.filter(|_| has_side)?;
    match found {
        None if file.assumes_wheelbase() => Some(format!(
            "the wheelbase of {stated_m} m was assumed and the drives do not show it (front and rear were not found to follow each other): measure it and set wheelbase_m"
        )),
        // What was learned in the place of an assumption, and could be a wrong clock or speed as well.
        Some(found) if file.assumes_wheelbase() => {
            let sd_m = found.sd_m.hypot(file.details.wheelbase_sd_m.unwrap_or(0.0));
            let factor = found.wheelbase_m / stated_m;
            ((found.wheelbase_m - stated_m).abs() > FAR * sd_m).then(|| {
                format!(
                    "the drives show a wheelbase of {:.2} ± {:.2} m, which takes the place of the {stated_m} m that were assumed: measure it; if it is not so, the time or the speed is wrong by a factor of {factor:.2}, and so is what was learned",
                    found.wheelbase_m, found.sd_m
                )
            })
        }
        Some(found) if (found.wheelbase_m - stated_m).abs() > FAR * found.sd_m => Some(format!(
            "the drives show a wheelbase of {:.2} ± {:.2} m, the file has {stated_m} m: measure it, or write wheelbase_sd_m = 0.15 beside wheelbase_m to have it learned",
            found.wheelbase_m, found.sd_m
        )),
        _ => None,
    }
}
