//! Made-up drives.

use itpms_data::log::{CornerColumns, Slot};
use itpms_drive::{DriveError, simulated};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use pyo3::prelude::*;

use crate::columns::{self, Columns, Packed};
use crate::errors;
use crate::vehicle::Vehicle;
use crate::work::{self, Meanwhile, Progress};

/// A simulated drive with its truth.
#[pyclass(frozen, module = "itpms._itpms")]
pub(crate) struct Simulated {
    name: String,
    columns: Columns,
    vehicle: itpms_data::Vehicle,
}

#[pymethods]
impl Simulated {
    /// The scenario's name.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The log: names and bytes.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Packed<'py>> {
        columns::all(py, &self.columns)
    }

    /// What an estimator is to know of the car.
    #[getter]
    fn vehicle(&self) -> Vehicle {
        Vehicle(self.vehicle.clone())
    }
}

/// The names of the built-in scenarios.
#[pyfunction]
pub(crate) fn scenarios() -> Vec<&'static str> {
    Scenario::builtin_names().collect()
}

/// Drives a scenario: a built-in name or a TOML file.
#[pyfunction]
pub(crate) fn simulate(
    py: Python<'_>,
    scenario: &str,
    seed: u64,
    vehicle: Option<&Vehicle>,
    truth: bool,
    progress: Progress,
) -> PyResult<Simulated> {
    let vehicle = vehicle.map(|vehicle| vehicle.0.clone());
    let result = work::run(py, &progress, |meanwhile: &Meanwhile| -> Result<Simulated, DriveError> {
        let mut scenario = Scenario::load(scenario)?;
        simulated::take_crg(&mut scenario)?;
        if let Some(vehicle) = &vehicle {
            simulated::take_vehicle(&mut scenario, vehicle)?;
        }
        drive(&scenario, seed, truth, meanwhile)
    })?;
    result.map_err(|error| errors::drive(py, &error))
}

fn drive(
    scenario: &Scenario,
    seed: u64,
    truth: bool,
    meanwhile: &Meanwhile,
) -> Result<Simulated, DriveError> {
    let truth = CornerColumns { pressure: truth, road: truth };
    let slots: Vec<Slot> = simulated::columns(scenario, truth).slots().collect();
    let mut columns: Columns = slots.iter().map(|slot| (slot.name(), vec![])).collect();
    let mut simulation = Simulation::new(scenario, seed)?;
    for row in simulation.by_ref() {
        if meanwhile.done(row.time_s / scenario.duration_s).is_break() {
            return Err(DriveError::Stopped);
        }
        let row = simulated::log_row(&row);
        for ((_, column), slot) in columns.iter_mut().zip(&slots) {
            column.push(row.value(*slot));
        }
    }
    simulated::check(scenario, &simulation)?;
    Ok(Simulated { name: scenario.name.clone(), columns, vehicle: simulated::vehicle_of(scenario)? })
}
