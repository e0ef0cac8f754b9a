//! The tables: a row per drive and wheel, and a row per drive that failed.

use std::path::Path;

use itpms_data::out::{Cell, Kind, Table};

use super::Outcome;
use super::record::{DriveRecord, Pressure, WheelRecord};
use crate::error::DriveError;

const COLUMNS: [(&str, Kind); 36] = [
    ("file", Kind::Label),
    ("car", Kind::Label),
    ("vehicle", Kind::Label),
    ("wheel", Kind::Label),
    ("placard_kpa", Kind::Number),
    ("pressure_kpa", Kind::Number),
    ("pressure_sd_kpa", Kind::Number),
    ("pressure_time_s", Kind::Number),
    ("lowest_kpa", Kind::Number),
    ("lowest_sd_kpa", Kind::Number),
    ("lowest_time_s", Kind::Number),
    ("state", Kind::Label),
    ("warning", Kind::Label),
    ("warnings", Kind::Number),
    ("first_warning_s", Kind::Number),
    ("malfunctions", Kind::Number),
    ("first_malfunction_s", Kind::Number),
    ("share_valid", Kind::Number),
    ("iri_m_per_km", Kind::Number),
    ("incoherence", Kind::Number),
    ("unexplained", Kind::Number),
    ("hop_excess", Kind::Number),
    ("friction_n", Kind::Number),
    ("misfit", Kind::Label),
    ("distance_m", Kind::Number),
    ("duration_s", Kind::Number),
    ("rate_hz", Kind::Number),
    ("start_s", Kind::Number),
    ("calibration", Kind::Label),
    ("concerns", Kind::Label),
    ("lost_share", Kind::Number),
    ("lost_share_sd", Kind::Number),
    ("detectable_loss", Kind::Number),
    ("damper", Kind::Label),
    ("damper_over_reference", Kind::Number),
    ("damper_left_right", Kind::Number),
];

pub(super) fn write(out: &Path, outcome: &Outcome) -> Result<(), DriveError> {
    let columns = COLUMNS.map(|(name, kind)| (name.to_owned(), kind));
    for name in [
        "fleet.csv",
        #[cfg(feature = "parquet")]
        "fleet.parquet",
    ] {
        let mut table = Table::create(&out.join(name), &columns)?;
        for drive in &outcome.drives {
            let concerns = drive.concerns.join("; ");
            for wheel in &drive.wheels {
                table.write(&cells(drive, wheel, &concerns))?;
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

fn cells<'a>(drive: &'a DriveRecord, wheel: &'a WheelRecord, concerns: &'a str) -> [Cell<'a>; 36] {
    let number = |value: Option<f64>| Cell::Number(value.unwrap_or(f64::NAN));
    let of = |pressure: Option<Pressure>| match pressure {
        Some(p) => [p.pressure_kpa, p.sd_kpa, p.time_s].map(Cell::Number),
        None => [Cell::Number(f64::NAN); 3],
    };
    let ([last, last_sd, last_s], [lowest, lowest_sd, lowest_s]) = (of(wheel.last), of(wheel.lowest));
    let fit = wheel.fit.as_ref();
    [
        Cell::Label(&drive.file),
        Cell::Label(&drive.car),
        Cell::Label(&drive.vehicle),
        Cell::Label(&wheel.wheel),
        Cell::Number(wheel.placard_kpa),
        last,
        last_sd,
        last_s,
        lowest,
        lowest_sd,
        lowest_s,
        Cell::Label(&wheel.state),
        Cell::Label(&wheel.warning),
        Cell::Number(f64::from(wheel.warnings)),
        number(wheel.first_warning_s),
        Cell::Number(f64::from(wheel.malfunctions)),
        number(wheel.first_malfunction_s),
        Cell::Number(wheel.share_valid),
        number(wheel.iri_m_per_km),
        number(fit.and_then(|fit| fit.incoherence)),
        number(fit.and_then(|fit| fit.unexplained)),
        number(fit.and_then(|fit| fit.hop_excess)),
        number(fit.map(|fit| fit.friction_n)),
        Cell::Label(fit.and_then(|fit| fit.misfit.as_deref()).unwrap_or("")),
        number(drive.distance_m),
        Cell::Number(drive.duration_s),
        Cell::Number(drive.rate_hz),
        Cell::Number(drive.start_s),
        Cell::Label(drive.calibration()),
        Cell::Label(concerns),
        number(wheel.lost.map(|lost| lost.share)),
        number(wheel.lost.map(|lost| lost.sd)),
        number(wheel.lost.map(|lost| lost.detectable)),
        Cell::Label(wheel.damper.as_ref().map_or("", |damper| &damper.state)),
        number(wheel.damper.as_ref().and_then(|damper| damper.over_reference)),
        number(wheel.damper.as_ref().and_then(|damper| damper.left_right)),
    ]
}
