//! A learned reference and the vehicle file that it is to belong to.

use std::path::Path;

use itpms_core::model::VehicleCalibration;
use itpms_data::Vehicle;
use itpms_data::reference::StoredReference;

use crate::exit::Failure;

/// What was learned, and the vehicle from which it counts; the refusal of another car's names both files.
pub(crate) fn of(
    reference: &Path,
    vehicle: &Vehicle,
    file: &Path,
) -> Result<(Vehicle, VehicleCalibration<f64>), Failure> {
    let stored = StoredReference::read(reference)?;
    let refused =
        |problem| Failure::Usage(format!("{}: {problem} as in {}", reference.display(), file.display()));
    let (vehicle, reference) = stored.for_vehicle(vehicle).map_err(refused)?;
    Ok((vehicle, *reference))
}
