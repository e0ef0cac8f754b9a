//! A learned reference and the vehicle file that it is to belong to.

use std::path::Path;

use itpms_console::Failure;
use itpms_data::Vehicle;
use itpms_data::reference::StoredReference;

/// The reference, and the vehicle from which it counts; the refusal of another car's names both files.
pub(crate) fn of(
    reference: &Path,
    vehicle: &Vehicle,
    file: &Path,
) -> Result<(Vehicle, StoredReference), Failure> {
    let stored = StoredReference::read(reference)?;
    let refused =
        |problem| Failure::Usage(format!("{}: {problem} as in {}", reference.display(), file.display()));
    let (vehicle, _) = stored.for_vehicle(vehicle).map_err(refused)?;
    Ok((vehicle, stored))
}
