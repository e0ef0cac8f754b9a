//! The tables: a row per drive and wheel, and a row per drive that failed.

use std::path::Path;

use itpms_data::out::{Cell, Kind, Table};

use super::Outcome;
use super::record::{DriveRecord, Pressure, WheelRecord};
use crate::error::DriveError;

pub(super) fn write(out: &Path, outcome: &Outcome) -> Result<(), DriveError> {
    let (drive, wheel) = (DriveRecord::default(), WheelRecord::default());
    let columns = cells(&drive, &wheel, "").map(|(name, cell)| (name.to_owned(), cell.kind()));
    for name in [
        "fleet.csv",
        #[cfg(feature = "parquet")]
        "fleet.parquet",
    ] {
        let mut table = Table::create(&out.join(name), &columns)?;
        for drive in &outcome.drives {
            let concerns = drive.concerns.join("; ");
            for wheel in &drive.wheels {
                table.write(&cells(drive, wheel, &concerns).map(|(_, cell)| cell))?;
            }
        }
        table.finish()?.commit()?;
    }
    let columns = ["file", "car", "error"].map(|name| (name.to_owned(), Kind::Label));
    let mut table = Table::create(&out.join("failed.csv"), &columns)?;
    for failed in &outcome.failed {
        let (file, car) = (failed.file.to_string_lossy(), failed.car.as_deref().unwrap_or(""));
        table.write(&[Cell::Label(&file), Cell::Label(car), Cell::Label(&failed.why)])?;
    }
    Ok(table.finish()?.commit()?)
}

fn cells<'a>(
    drive: &'a DriveRecord,
    wheel: &'a WheelRecord,
    concerns: &'a str,
) -> [(&'static str, Cell<'a>); 36] {
    let number = |value: Option<f64>| Cell::Number(value.unwrap_or(f64::NAN));
    let of = |pressure: Option<Pressure>| match pressure {
        Some(p) => [p.pressure_kpa, p.sd_kpa, p.time_s].map(Cell::Number),
        None => [Cell::Number(f64::NAN); 3],
    };
    let ([last, last_sd, last_s], [lowest, lowest_sd, lowest_s]) = (of(wheel.last), of(wheel.lowest));
    let fit = wheel.fit.as_ref();
    [
        ("file", Cell::Label(&drive.file)),
        ("car", Cell::Label(&drive.car)),
        ("vehicle", Cell::Label(&drive.vehicle)),
        ("wheel", Cell::Label(&wheel.wheel)),
        ("placard_kpa", Cell::Number(wheel.placard_kpa)),
        ("pressure_kpa", last),
        ("pressure_sd_kpa", last_sd),
        ("pressure_time_s", last_s),
        ("lowest_kpa", lowest),
        ("lowest_sd_kpa", lowest_sd),
        ("lowest_time_s", lowest_s),
        ("state", Cell::Label(&wheel.state)),
        ("warning", Cell::Label(&wheel.warning)),
        ("warnings", Cell::Number(f64::from(wheel.warnings))),
        ("first_warning_s", number(wheel.first_warning_s)),
        ("malfunctions", Cell::Number(f64::from(wheel.malfunctions))),
        ("first_malfunction_s", number(wheel.first_malfunction_s)),
        ("share_valid", Cell::Number(wheel.share_valid)),
        ("iri_m_per_km", number(wheel.iri_m_per_km)),
        ("incoherence", number(fit.and_then(|fit| fit.incoherence))),
        ("unexplained", number(fit.and_then(|fit| fit.unexplained))),
        ("hop_excess", number(fit.and_then(|fit| fit.hop_excess))),
        ("friction_n", number(fit.map(|fit| fit.friction_n))),
        ("misfit", Cell::Label(fit.and_then(|fit| fit.misfit.as_deref()).unwrap_or(""))),
        ("distance_m", number(drive.distance_m)),
        ("duration_s", Cell::Number(drive.duration_s)),
        ("rate_hz", Cell::Number(drive.rate_hz)),
        ("start_s", Cell::Number(drive.start_s)),
        ("calibration", Cell::Label(drive.calibration())),
        ("concerns", Cell::Label(concerns)),
        ("lost_share", number(wheel.lost.map(|lost| lost.share))),
        ("lost_share_sd", number(wheel.lost.map(|lost| lost.sd))),
        ("detectable_loss", number(wheel.lost.map(|lost| lost.detectable))),
        ("damper", Cell::Label(wheel.damper.as_ref().map_or("", |damper| &damper.state))),
        ("damper_over_reference", number(wheel.damper.as_ref().and_then(|damper| damper.over_reference))),
        ("damper_left_right", number(wheel.damper.as_ref().and_then(|damper| damper.left_right))),
    ]
}
