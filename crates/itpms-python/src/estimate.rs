//! A whole drive: a log or columns in, what was found out.

use std::path::{Path, PathBuf};

use itpms_analysis::report::render_report;
use itpms_core::model::Corner;
use itpms_core::warning::Change;
use itpms_data::log::PositionColumns;
use itpms_data::out::{EstimateRow, RateGate, transition_object};
use itpms_data::{LogReader, LogRow};
use itpms_drive::fleet::wheels::{Begun, wheels};
use itpms_drive::reference::Saving;
use itpms_drive::{
    Done, DriveError, Heights, Job, LateRow, RoadSurvey, Settings, Sink, common_corners, corner_lines,
    summary_json, torsion_line, wheel_speed_lines, wheel_speed_use,
};
use pyo3::prelude::*;
use pyo3::types::PyIterator;
use serde_json::{Value, json};

use crate::columns::{self, Columns, Packed, Words};
use crate::errors::{self, Kind, raise};
use crate::found::Found;
use crate::options::Options;
use crate::pieces::Pieces;
use crate::vehicle::Vehicle;
use crate::work::{self, Meanwhile, Progress};

/// Estimates the drive in a file.
#[pyfunction]
pub(crate) fn estimate_log(
    py: Python<'_>,
    path: PathBuf,
    vehicle: &Vehicle,
    options: Options,
    progress: Progress,
) -> PyResult<Estimated> {
    let reading = options.reading(py)?;
    run(py, vehicle, &options, &progress, || LogReader::open_with(&path, &reading))
}

/// Estimates a drive given piece by piece, as [`Pieces`] takes them. `name` is what messages call the drive.
#[pyfunction]
pub(crate) fn estimate_pieces(
    py: Python<'_>,
    name: &str,
    names: Vec<String>,
    rows: Option<usize>,
    pieces: Bound<'_, PyIterator>,
    vehicle: &Vehicle,
    options: Options,
    progress: Progress,
) -> PyResult<Estimated> {
    let reading = options.reading(py)?;
    let pieces = Pieces::new(names, rows, pieces.unbind());
    let raised = pieces.raised();
    let result = run(py, vehicle, &options, &progress, move || pieces.open(Path::new(name), &reading));
    raised.or(result)
}

fn run(
    py: Python<'_>,
    vehicle: &Vehicle,
    options: &Options,
    progress: &Progress,
    open: impl FnOnce() -> Result<LogReader, itpms_data::DataError> + Send,
) -> PyResult<Estimated> {
    let (settings, reading) = (options.settings(py)?, options.reading(py)?);
    let (vehicle, keep_road, save) = (&vehicle.0, options.road, options.save_reference.as_deref());
    // For a report the road is smoothed; the same report, whatever else was kept.
    let report = options.report;
    let road = match options.roughness {
        _ if report || keep_road || options.road_map => Heights::Smoothed,
        true => Heights::Causal,
        false => Heights::None,
    };
    let result = work::run(py, progress, |meanwhile: &Meanwhile| -> Result<Estimated, DriveError> {
        let mut log = open()?;
        let corners = common_corners(&log, vehicle)?;
        let saving = save.map(|path| Saving::create(path, &settings, vehicle)).transpose()?;
        let wheel_speeds = wheel_speed_use(log.columns(), vehicle, &corners).unwrap_or_default();
        let has_temperature = log.columns().motion.air.temperature;
        let found = Found::new(&corners, wheel_speeds, has_temperature, 0);
        let mut kept = Kept::new(&corners, found, settings.rate_hz, keep_road);
        if options.road_map {
            if log.columns().motion.position == PositionColumns::Absent {
                let why = "no latitude_deg and longitude_deg, so no map: expected both columns, or a map that names them";
                return Err(DriveError::Mismatch(format!("{}: {why}", log.path().display())));
            }
            let survey = RoadSurvey::new(SEGMENT_M, &corners, log.survey().estimator_rate_hz());
            kept.survey = Some(survey.map_err(|error| DriveError::Mismatch(error.to_string()))?);
        }
        let job = Job { vehicle, corners: &corners, settings: &settings, reading: &reading, road, report };
        let done = itpms_drive::estimate(&mut log, &job, &mut kept, &mut |share| meanwhile.done(share))?;
        if let Some(saving) = saving {
            saving.complete(settings.calibrate_s, done.data.drive.duration_s, done.learned)?.commit()?;
        }
        let map = kept.survey.take().map(|survey| survey.finish(vehicle.wheelbase_m).geojson().0.to_string());
        let rows = log.repairs().rows_kept;
        let figures = Value::Object(summary_json(&done, rows));
        let end_s = log.last_time_s().map_or(f64::NAN, |end_s| end_s - done.data.drive.origin_s);
        let unit = done.data.pressure_unit;
        let lines = corner_lines(&done, end_s).into_iter();
        let lines = lines.chain(done.radii.iter().flat_map(wheel_speed_lines));
        let lines = lines.chain(torsion_line(&done, unit)).chain(done.beside.lines()).collect();
        Ok(Estimated {
            done,
            kept,
            map,
            figures,
            lines,
            report,
            settings: settings.clone(),
            vehicle: vehicle.clone(),
        })
    })?;
    result.map_err(|error| errors::drive(py, &error))
}

/// Length in m of a segment of a road's map, the command's default.
const SEGMENT_M: f64 = 100.0;

/// The record of a drive under way: rows at the wanted rate, the road at the log's, transitions.
struct Kept {
    corners: Vec<Corner>,
    gate: RateGate,
    found: Found,
    road: Option<Columns>,
    survey: Option<RoadSurvey>,
    transitions: Vec<Value>,
    begun: Begun,
    first_s: Option<f64>,
}

impl Kept {
    fn new(corners: &[Corner], found: Found, rate_hz: f64, road: bool) -> Self {
        let named =
            |names: Vec<String>| names.into_iter().map(|name| (name, Vec::new())).collect::<Columns>();
        let of = |suffix: &str| {
            corners.iter().map(|corner| format!("{}_{suffix}", corner.label())).collect::<Vec<_>>()
        };
        let first = vec!["time_s".to_owned(), "distance_m".to_owned()];
        Self {
            corners: corners.to_vec(),
            gate: RateGate::new(rate_hz),
            found,
            road: road.then(|| named([first, of("road_m"), of("road_sd_m")].concat())),
            survey: None,
            transitions: Vec::new(),
            begun: Begun::default(),
            first_s: None,
        }
    }
}

impl Sink for Kept {
    fn row(&mut self, row: &LogRow, known: &EstimateRow<'_>) -> Result<(), DriveError> {
        self.first_s.get_or_insert(row.time_s);
        self.begun.take(known.estimates);
        if self.gate.lets_through(row.time_s) {
            self.found.push(known);
        }
        Ok(())
    }

    fn road(&mut self, late: &LateRow) -> Result<(), DriveError> {
        if let Some(survey) = &mut self.survey {
            survey.take(late);
        }
        let Some(road) = &mut self.road else { return Ok(()) };
        let of = |field: fn(&itpms_core::model::CornerEstimate<f64>) -> f64| {
            self.corners
                .iter()
                .map(move |corner| late.estimates[corner.index()].as_ref().map_or(f64::NAN, field))
        };
        let heights = of(|e| e.road_m).chain(of(|e| e.road_sd_m));
        let values = [late.row.time_s, late.distance_m].into_iter().chain(heights);
        for ((_, column), value) in road.iter_mut().zip(values) {
            column.push(value);
        }
        Ok(())
    }

    fn transition(&mut self, time_s: f64, change: &Change<f64>) -> Result<(), DriveError> {
        self.transitions.push(Value::Object(transition_object(time_s, change)));
        Ok(())
    }

    fn notice(&mut self, event: &serde_json::Map<String, Value>) -> Result<(), DriveError> {
        self.transitions.push(Value::Object(event.clone()));
        Ok(())
    }
}

/// A drive's results.
#[pyclass(frozen, module = "itpms._itpms")]
pub(crate) struct Estimated {
    done: Done,
    kept: Kept,
    map: Option<String>,
    figures: Value,
    lines: Vec<String>,
    report: bool,
    settings: Settings,
    vehicle: itpms_data::Vehicle,
}

#[pymethods]
impl Estimated {
    /// The numbers over time: names and bytes.
    fn estimates<'py>(&self, py: Python<'py>) -> PyResult<Packed<'py>> {
        columns::all(py, &self.kept.found.numbers)
    }

    /// The warnings over time: names and words.
    fn warnings(&self) -> Words {
        self.kept.found.words.clone()
    }

    /// The road: names and bytes, or `None` where it was not kept.
    fn road<'py>(&self, py: Python<'py>) -> PyResult<Option<Packed<'py>>> {
        self.kept.road.as_ref().map(|road| columns::all(py, road)).transpose()
    }

    /// The road's map as GeoJSON, or `None` where it was not asked for.
    fn road_map(&self) -> Option<String> {
        self.map.clone()
    }

    /// The monitor's alerts, begun and ended: a JSON list of the events that `itpms estimate --events` writes.
    fn transitions(&self) -> String {
        Value::Array(self.kept.transitions.clone()).to_string()
    }

    /// The state at the end, as JSON.
    fn figures(&self) -> String {
        self.figures.to_string()
    }

    /// A JSON list with a fleet table's columns of each wheel.
    fn wheels(&self) -> String {
        json!(wheels(&self.done, &self.kept.begun)).to_string()
    }

    /// The log's time of its first row, in s.
    fn start_s(&self) -> f64 {
        self.kept.first_s.unwrap_or(0.0)
    }

    /// Stores what a calibration drive taught, or says why it taught nothing.
    fn teach(&self, py: Python<'_>, path: PathBuf) -> PyResult<Option<String>> {
        let Self { done, settings, vehicle, .. } = self;
        itpms_drive::reference::teach(&path, settings, vehicle, done.learned)
            .map_err(|error| errors::drive(py, &error))
    }

    /// The labels of the corners.
    fn corners(&self) -> Vec<&'static str> {
        self.kept.corners.iter().map(|corner| corner.label()).collect()
    }

    /// A line for each corner, as the command shows it.
    fn lines(&self) -> Vec<String> {
        self.lines.clone()
    }

    /// The page about the drive, or `None` where it was not kept.
    fn page(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let page = self.report.then(|| render_report(&self.done.data)).transpose();
        page.map_err(|error| raise(py, Kind::Output, format!("the report cannot be made: {error}")))
    }
}
