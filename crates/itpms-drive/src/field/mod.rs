//! The field kit: whether an owner's log with known pressures is good enough to judge the methods by, and the archive to hand on.
//!
//! | module | idea |
//! |---|---|
//! | `pressures` | what the gauge read, and from when on |
//! | `watch` | what the log shows of itself, row by row |
//! | `judge` | what is good enough, and the way out where it is not |
//! | `pack` | log, vehicle and manifest in one archive, without identification number and places |
//!
//! Called by `itpms vehicle check --field`. Estimates nothing: a car that the estimator does not understand is the most welcome one.

mod judge;
mod pack;
mod pressures;
mod watch;

use itpms_core::model::Corner;
use itpms_data::{LogReader, Vehicle};
use serde_json::{Map, Value, json};

use crate::error::DriveError;
use crate::plausibility::Plausibility;
use crate::run::{ROWS_PER_LOOK, Watch};
use judge::{Findings, judge};
use pack::Pack;
pub use pressures::{KnownFrom, KnownStretch};
use watch::LogWatch;

const FORMAT: u32 = 1;

/// The owner's notes beside log and vehicle file.
#[derive(Debug, Clone, Default)]
pub struct FieldNotes {
    /// The gauge's readings, in the order of time.
    pub pressures: Vec<KnownFrom>,
    /// Sensors, road, weather, in the owner's words.
    pub note: Option<String>,
    /// The program's name and version, for the manifest.
    pub program: String,
}

#[derive(Debug, Clone)]
pub struct FieldCheck {
    findings: Findings,
    left_out: Vec<String>,
    /// The archive's bytes, where it was asked for and the log is good enough.
    pub archive: Option<Vec<u8>>,
}

/// Reads a log to its end, judges it, and packs it if `packs` and it is good enough. `watch` receives the share that is done.
/// Errors: the log cannot be read on; [`DriveError::Stopped`].
pub fn check_field(
    vehicle: &Vehicle,
    log: &mut LogReader,
    notes: &FieldNotes,
    packs: bool,
    watch: Watch<'_>,
) -> Result<FieldCheck, DriveError> {
    let stretches = pressures::stretches(&notes.pressures);
    let known = stretches.as_deref().unwrap_or_default();
    let radius_m = vehicle.rolling_radius_m().unwrap_or(f64::NAN);
    let (mut seen, mut plausibility) = (LogWatch::new(known), Plausibility::default());
    let mut pack = packs.then(|| Pack::begin(log.columns())).transpose()?;
    let mut rows = 0u64;
    while let Some(row) = log.next_row()? {
        if rows.is_multiple_of(ROWS_PER_LOOK) && watch(log.progress()).is_break() {
            return Err(DriveError::Stopped);
        }
        rows += 1;
        seen.take(&row, radius_m);
        plausibility.take(&row, radius_m);
        if let Some(pack) = &mut pack {
            let time_s = seen.since_start_s(&row);
            pack.row(&row, time_s)?;
        }
    }
    seen.finish();
    let findings = judge(vehicle, log, &seen, &plausibility, stretches.as_deref());
    let left_out = pack::left_out(log.columns(), vehicle);
    let mut check = FieldCheck { findings, left_out, archive: None };
    if let Some(pack) = pack.filter(|_| check.is_good()) {
        let manifest = manifest(notes, log, &seen, known, &check, &pack.columns());
        check.archive = Some(pack.finish(vehicle, &manifest)?);
    }
    Ok(check)
}

fn manifest(
    notes: &FieldNotes,
    log: &LogReader,
    seen: &LogWatch,
    known: &[KnownStretch],
    check: &FieldCheck,
    columns: &[String],
) -> Value {
    let stretch = |(stretch, driven_s): (&KnownStretch, &f64)| {
        let kpa: Map<String, Value> = Corner::ALL
            .into_iter()
            .map(|corner| (format!("{}_kpa", corner.label()), json!(stretch.kpa[corner.index()])))
            .collect();
        json!({ "from_s": stretch.from_s, "driven_s": driven_s.round(), "gauge": kpa })
    };
    json!({
        "format": FORMAT,
        "program": notes.program,
        "files": [pack::LOG, pack::VEHICLE],
        "sample_rate_hz": log.survey().sample_rate_hz,
        "rows": log.repairs().rows_kept,
        "length_s": seen.length_s(),
        "columns": columns,
        "pressures": known.iter().zip(&seen.driven_s).map(stretch).collect::<Vec<_>>(),
        "note": notes.note.as_deref().map(pack::without_vin),
        "facts": check.findings.facts,
        "notes": check.findings.notes,
        "left_out": check.left_out,
    })
}

impl FieldCheck {
    /// Whether the log is good enough.
    pub fn is_good(&self) -> bool {
        self.findings.faults.is_empty()
    }

    /// The log's content, a sentence each.
    pub fn facts(&self) -> &[String] {
        &self.findings.facts
    }

    /// Why the log is not good enough, each with the way out; empty: it is.
    pub fn faults(&self) -> &[String] {
        &self.findings.faults
    }

    pub fn notes(&self) -> &[String] {
        &self.findings.notes
    }

    /// Parts of log and vehicle file that are not in the archive.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// The output of `itpms vehicle check --field --json`.
    pub fn document(&self) -> Value {
        json!({
            "good": self.is_good(),
            "facts": self.facts(),
            "faults": self.faults(),
            "notes": self.notes(),
            "left_out": self.left_out,
        })
    }
}
