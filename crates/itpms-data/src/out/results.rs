//! The results of a drive: `est.csv` (pressures) and `road.csv` (the road under each wheel), or both as Parquet.
//!
//! Called by the estimate command, one call per row; computes nothing.

use std::path::Path;

use itpms_core::model::{Corner, CornerEstimate, Level, Warning};
use itpms_files::AtomicFile;

use super::cell::{Cell, Kind};
use super::state::{States, state_label};
use super::table::Table;
use super::wheel_speeds::{RadiusRow, WheelSpeedUse};
use crate::error::DataError;
use crate::log::AirColumns;

/// Estimates and states after a row of a log.
#[derive(Debug, Clone, Copy)]
pub struct EstimateRow<'a> {
    pub time_s: f64,
    /// In the order of [`Corner::ALL`], as the states that the monitor reports.
    pub estimates: &'a [Option<CornerEstimate<f64>>; 4],
    pub states: &'a States,
    /// By the wheel speeds, where they are used.
    pub radii: Option<&'a RadiusRow>,
}

/// Writes `time_s`, then per corner `{c}_pressure_kpa, {c}_pressure_sd_kpa, {c}_stiffness_n_per_m, {c}_valid,
/// {c}_warning, {c}_change_sd_kpa, {c}_level, {c}_axle_difference_sd_kpa,
/// {c}_lost_kpa, {c}_lost_sd_kpa, {c}_state`, and of a log that knows the temperature of the air `{c}_cold_pressure_kpa,
/// {c}_cold_pressure_sd_kpa`: what the tire would have once it had cooled down to that temperature, empty while it is not known.
///
/// `pressure_sd_kpa` is that of the pressure, the vehicle file's uncertainty included; `change_sd_kpa` that of changes of
/// late; `axle_difference_sd_kpa` that of the difference from the other tire's pressure on its axle. `lost_kpa` is the loss in
/// this drive, with its sd, empty as long as that is not counted and where the tire was low before that. `level` is what the pressure's level rests on: `file`, `calibration` or `reference`. `valid` is `true` or `false`, `warning` one of `none`, `low`, `malfunction`, `state` a word of [`state_label`]. A row says what was known at its
/// time from samples up to it.
#[derive(Debug)]
pub struct EstimateWriter {
    table: Table,
    columns: EstimateColumns,
    cells: Vec<Cell<'static>>,
}

/// Which columns estimates have, whatever file they go to.
#[derive(Debug)]
pub(super) struct EstimateColumns {
    corners: Vec<Corner>,
    wheel_speeds: WheelSpeedUse,
    cold: bool,
}

impl EstimateColumns {
    pub(super) fn new(corners: &[Corner], wheel_speeds: WheelSpeedUse, air: AirColumns) -> Self {
        Self { corners: corners.to_vec(), wheel_speeds, cold: air.temperature }
    }

    pub(super) fn table(&self) -> Vec<(String, Kind)> {
        let mut columns = vec![("time_s".to_owned(), Kind::Number)];
        let nothing =
            EstimateRow { time_s: f64::NAN, estimates: &[None; 4], states: &States::default(), radii: None };
        self.named(&nothing, |corner, suffix, cell| {
            columns.push((format!("{corner}_{suffix}"), cell.kind()))
        });
        columns.extend(self.wheel_speeds.columns());
        columns
    }

    pub(super) fn cells(&self, row: &EstimateRow<'_>, cells: &mut Vec<Cell<'static>>) {
        cells.clear();
        cells.push(Cell::Number(row.time_s));
        self.named(row, |_, _, cell| cells.push(cell));
        self.wheel_speeds.cells(row.radii, cells);
    }

    /// The cells of the corners, each with the names of its corner and of its column.
    fn named(&self, row: &EstimateRow<'_>, mut put: impl FnMut(&str, &str, Cell<'static>)) {
        for corner in &self.corners {
            let estimate = row.estimates[corner.index()].as_ref();
            let number =
                |field: fn(&CornerEstimate<f64>) -> f64| Cell::Number(estimate.map_or(f64::NAN, field));
            let mut put = |column: &str, cell| put(corner.label(), column, cell);
            put("pressure_kpa", number(|e| e.pressure_kpa));
            put("pressure_sd_kpa", number(|e| e.pressure_sd_kpa));
            put("stiffness_n_per_m", number(|e| e.stiffness_n_per_m));
            put("valid", Cell::Flag(estimate.is_some_and(|e| e.validity.is_valid())));
            put("warning", Cell::Label(estimate.map_or(Warning::None, |e| e.warning).label()));
            put("change_sd_kpa", number(|e| e.change_sd_kpa));
            put("level", Cell::Label(estimate.map_or(Level::VehicleFile, |e| e.level).label()));
            put("axle_difference_sd_kpa", number(|e| e.axle_difference_sd_kpa.unwrap_or(f64::NAN)));
            put("lost_kpa", number(|e| e.lost_kpa()[0]));
            put("lost_sd_kpa", number(|e| e.lost_kpa()[1]));
            put("state", Cell::Label(state_label(row.states[corner.index()])));
            if self.cold {
                let cold = estimate.map_or([f64::NAN; 2], cold_values);
                COLD_COLUMNS.into_iter().zip(cold).for_each(|(name, kpa)| put(name, Cell::Number(kpa)));
            }
        }
    }
}

/// The columns of a cold pressure, without their corner.
pub const COLD_COLUMNS: [&str; 2] = ["cold_pressure_kpa", "cold_pressure_sd_kpa"];

/// Their values in kPa; NaN where unknown.
pub fn cold_values(estimate: &CornerEstimate<f64>) -> [f64; 2] {
    estimate.cold.map_or([f64::NAN; 2], |cold| [cold.pressure_kpa, cold.sd_kpa])
}

impl EstimateWriter {
    /// Starts the file with the columns of these corners, of wheel speeds ([`WheelSpeedUse::columns`]), and of the air's columns in the log.
    /// Errors: the file cannot be created, or its extension is not known.
    pub fn create(
        path: &Path,
        corners: &[Corner],
        wheel_speeds: WheelSpeedUse,
        air: AirColumns,
    ) -> Result<Self, DataError> {
        let columns = EstimateColumns::new(corners, wheel_speeds, air);
        Ok(Self { table: Table::create(path, &columns.table())?, columns, cells: Vec::new() })
    }

    /// Adds a row. A corner without an estimate has empty cells, is not valid and warns of nothing.
    pub fn write(&mut self, row: &EstimateRow<'_>) -> Result<(), DataError> {
        self.columns.cells(row, &mut self.cells);
        self.table.write(&self.cells)
    }

    /// Everything onto the disk; [`AtomicFile::commit`] then gives the file its name.
    pub fn finish(self) -> Result<AtomicFile, DataError> {
        self.table.finish()
    }
}

/// The road under one wheel at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadPoint {
    /// Height in m, within the wavelengths the sensors can see: no hill, no drift, no pebble.
    pub road_m: f64,
    pub road_sd_m: f64,
}

/// Writes `time_s, distance_m`, then `{c}_road_m` for every corner, then `{c}_road_sd_m` for every corner, at the log's rate.
///
/// The height is band-limited: what is slower than about 0.5 Hz in time is drift of the accelerometers and taken out, what is shorter than
/// the tire's contact patch was never felt. At 20 km/h that leaves wavelengths of about 0.5 to 10 m.
#[derive(Debug)]
pub struct RoadWriter {
    table: Table,
    columns: RoadColumns,
    cells: Vec<Cell<'static>>,
}

/// Which columns a road has, whatever file it goes to.
#[derive(Debug)]
pub(super) struct RoadColumns(Vec<Corner>);

impl RoadColumns {
    pub(super) fn new(corners: &[Corner]) -> Self {
        Self(corners.to_vec())
    }

    pub(super) fn table(&self) -> Vec<(String, Kind)> {
        let mut columns = vec![("time_s".to_owned(), Kind::Number), ("distance_m".to_owned(), Kind::Number)];
        for suffix in ["road_m", "road_sd_m"] {
            for corner in &self.0 {
                columns.push((format!("{}_{suffix}", corner.label()), Kind::Number));
            }
        }
        columns
    }

    pub(super) fn cells(
        &self,
        time_s: f64,
        distance_m: f64,
        points: &[Option<RoadPoint>; 4],
        cells: &mut Vec<Cell<'static>>,
    ) {
        cells.clear();
        cells.extend([Cell::Number(time_s), Cell::Number(distance_m)]);
        for field in [|p: RoadPoint| p.road_m, |p: RoadPoint| p.road_sd_m] {
            let numbers = self.0.iter().map(|corner| points[corner.index()].map_or(f64::NAN, field));
            cells.extend(numbers.map(Cell::Number));
        }
    }
}

impl RoadWriter {
    /// Starts the file with the columns of these corners. Errors: the file cannot be created, or its extension is not known.
    pub fn create(path: &Path, corners: &[Corner]) -> Result<Self, DataError> {
        let columns = RoadColumns::new(corners);
        Ok(Self { table: Table::create(path, &columns.table())?, columns, cells: Vec::new() })
    }

    /// Adds a row; `points` in the order of [`Corner::ALL`], an absent one leaves its cells empty. The distance is
    /// NaN where the speed is unknown.
    pub fn write(
        &mut self,
        time_s: f64,
        distance_m: f64,
        points: &[Option<RoadPoint>; 4],
    ) -> Result<(), DataError> {
        self.columns.cells(time_s, distance_m, points, &mut self.cells);
        self.table.write(&self.cells)
    }

    /// Everything onto the disk; [`AtomicFile::commit`] then gives the file its name.
    pub fn finish(self) -> Result<AtomicFile, DataError> {
        self.table.finish()
    }
}
