//! Sentences as the package's exceptions, which live in `itpms._errors`.

use itpms_data::error::FileProblem;
use itpms_data::{DataError, Problem};
use itpms_drive::DriveError;
use itpms_sim::error::ScenarioError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    /// A drive log that cannot be used.
    Log,
    /// A vehicle file that cannot be used.
    Vehicle,
    /// A scenario that cannot be driven.
    Scenario,
    /// Arguments that are refused, or do not go together.
    Setting,
    /// A file that cannot be written.
    Output,
}

pub(crate) fn raise(py: Python<'_>, kind: Kind, sentence: impl std::fmt::Display) -> PyErr {
    let name = match kind {
        Kind::Log => "LogError",
        Kind::Vehicle => "VehicleError",
        Kind::Scenario => "ScenarioError",
        Kind::Setting => "SettingError",
        Kind::Output => "OutputError",
    };
    let made = py
        .import("itpms._errors")
        .and_then(|module| module.getattr(name))
        .and_then(|class| class.call1((sentence.to_string(),)));
    // Without its own package the extension still says what is wrong.
    made.map_or_else(|_| PyRuntimeError::new_err(sentence.to_string()), PyErr::from_value)
}

/// The exception of a file's error, by the kind of file that was read.
pub(crate) fn data(py: Python<'_>, kind: Kind, error: &DataError) -> PyErr {
    let kind = match *error.problem {
        Problem::File(FileProblem::Write(_) | FileProblem::NoDirectory(_)) => Kind::Output,
        Problem::Reference(_) => Kind::Setting,
        _ => kind,
    };
    raise(py, kind, error)
}

/// Why a drive was not estimated. One that was interrupted raises what the interpreter wants to raise.
pub(crate) fn drive(py: Python<'_>, error: &DriveError) -> PyErr {
    match error {
        DriveError::Data(error) => data(py, Kind::Log, error),
        DriveError::Log(sentence) => raise(py, Kind::Log, sentence),
        DriveError::Scenario(error) => scenario(py, error),
        other => raise(py, Kind::Setting, other),
    }
}

pub(crate) fn scenario(py: Python<'_>, error: &ScenarioError) -> PyErr {
    raise(py, Kind::Scenario, error)
}
