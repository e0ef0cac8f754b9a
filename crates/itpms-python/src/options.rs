//! Options of the Python layer besides a drive and a vehicle, as the program's settings.

use std::path::PathBuf;

use itpms_core::model::PressureUnit;
use itpms_core::warning::Regulation;
use itpms_data::log::LogOptions;
use itpms_drive::{EstimatorKind, Settings};
use itpms_road::{RoadPeriod, RoadRepetition};
use pyo3::prelude::*;

use crate::errors::{Kind, raise};
use crate::pieces;

/// Options of the Python layer besides the log and the vehicle, by the names of the command's options.
#[derive(FromPyObject)]
pub(crate) struct Options {
    #[pyo3(item)]
    estimator: String,
    #[pyo3(item)]
    regulation: String,
    #[pyo3(item)]
    road_repeats: RoadRepeats,
    #[pyo3(item)]
    calibrate_s: Option<f64>,
    #[pyo3(item)]
    reference: Option<PathBuf>,
    #[pyo3(item)]
    pub(crate) save_reference: Option<PathBuf>,
    #[pyo3(item)]
    pub(crate) rate_hz: f64,
    #[pyo3(item)]
    pressure_unit: String,
    #[pyo3(item)]
    pub(crate) road: bool,
    #[pyo3(item)]
    pub(crate) road_map: bool,
    #[pyo3(item)]
    pub(crate) report: bool,
    /// The road's roughness, as the fleet has it.
    #[pyo3(item)]
    pub(crate) roughness: bool,
    #[pyo3(item)]
    trust_units: bool,
    #[pyo3(item)]
    dbc: Option<PathBuf>,
    #[pyo3(item)]
    signals: Option<PathBuf>,
    #[pyo3(item)]
    rows: Vec<String>,
    #[pyo3(item)]
    pulses: Option<PathBuf>,
}

/// Seconds, or a word.
#[derive(FromPyObject)]
enum RoadRepeats {
    Seconds(f64),
    Word(String),
}

impl Options {
    pub(crate) fn settings(&self, py: Python<'_>) -> PyResult<Settings> {
        let refuse = |sentence: String| raise(py, Kind::Setting, sentence);
        let known = |names: Vec<&str>, what: &str, found: &str| {
            refuse(format!("{what} is {found:?}, expected one of: {}", names.join(", ")))
        };
        let positive = |name: &str, value: f64| {
            let usable = value > 0.0 && value.is_finite();
            if usable {
                Ok(value)
            } else {
                Err(refuse(format!("{name} is {value}, expected a positive, finite number")))
            }
        };
        let estimators = || EstimatorKind::ALL.map(EstimatorKind::label).to_vec();
        let units = || PressureUnit::ALL.map(PressureUnit::label).to_vec();
        let regulations = || Regulation::ALL.map(Regulation::label).to_vec();
        if self.calibrate_s.is_some() && self.reference.is_some() {
            return Err(refuse("both calibrate_s and reference are given, expected one of them".to_owned()));
        }
        if self.save_reference.is_some() && self.calibrate_s.is_none() && self.reference.is_none() {
            return Err(refuse(
                "save_reference is given without calibrate_s and reference: nothing would be learned"
                    .to_owned(),
            ));
        }
        Ok(Settings {
            estimator: EstimatorKind::from_label(&self.estimator)
                .ok_or_else(|| known(estimators(), "estimator", &self.estimator))?,
            regulation: Regulation::from_label(&self.regulation)
                .ok_or_else(|| known(regulations(), "regulation", &self.regulation))?,
            road_repeats: self.road_repeats.settled().map_err(refuse)?,
            calibrate_s: self.calibrate_s.map(|seconds| positive("calibrate_s", seconds)).transpose()?,
            reference: self.reference.clone(),
            pulses: self.pulses.clone(),
            rate_hz: positive("rate_hz", self.rate_hz)?,
            pressure_unit: PressureUnit::from_label(&self.pressure_unit)
                .ok_or_else(|| known(units(), "pressure_unit", &self.pressure_unit))?,
            ..Settings::default()
        })
    }

    pub(crate) fn reading(&self, py: Python<'_>) -> PyResult<LogOptions> {
        pieces::reading(py, self.trust_units, self.dbc.clone(), self.signals.clone(), &self.rows)
    }
}

impl RoadRepeats {
    fn settled(&self) -> Result<RoadRepetition, String> {
        match self {
            Self::Seconds(seconds) => {
                RoadPeriod::new(*seconds).map(RoadRepetition::Every).map_err(|error| error.to_string())
            }
            Self::Word(word) if word == "auto" => Ok(RoadRepetition::Detect),
            Self::Word(word) if word == "never" => Ok(RoadRepetition::Never),
            Self::Word(word) => Err(format!("road_repeats is {word:?}, expected seconds, never or auto")),
        }
    }
}
