//! Made-up drives.

use itpms_core::model::Corner;
use itpms_drive::{DriveError, simulated};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use pyo3::prelude::*;

use crate::columns::{self, Columns, Packed};
use crate::errors;
use crate::vehicle::Vehicle;
use crate::work::{self, Meanwhile, Told};

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

    /// What an estimator is to be told of the car.
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
    told: Told,
) -> PyResult<Simulated> {
    let vehicle = vehicle.map(|vehicle| vehicle.0.clone());
    let result = work::run(py, &told, |meanwhile: &Meanwhile| -> Result<Simulated, DriveError> {
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
    let corners: Vec<Corner> = scenario.corner.iter().map(|(corner, _)| corner).collect();
    let suffixes: &[&str] = if truth {
        &["body_accel_m_s2", "wheel_accel_m_s2", "pressure_kpa", "road_m"]
    } else {
        &["body_accel_m_s2", "wheel_accel_m_s2"]
    };
    let mut columns: Columns = vec![("time_s".to_owned(), vec![]), ("speed_m_s".to_owned(), vec![])];
    for corner in &corners {
        columns.extend(suffixes.iter().map(|suffix| (format!("{}_{suffix}", corner.label()), vec![])));
    }
    let mut simulation = Simulation::new(scenario, seed)?;
    for row in simulation.by_ref() {
        if meanwhile.done(row.time_s / scenario.duration_s).is_break() {
            return Err(DriveError::Stopped);
        }
        let row = simulated::log_row(&row);
        columns[0].1.push(row.time_s);
        columns[1].1.push(row.speed_m_s);
        for (corner, columns) in corners.iter().zip(columns[2..].chunks_exact_mut(suffixes.len())) {
            let Some(c) = row.corners[corner.index()] else { continue };
            let values = [c.body_accel_m_s2, c.wheel_accel_m_s2, c.pressure_kpa, c.road_m];
            for ((_, column), value) in columns.iter_mut().zip(values) {
                column.push(value);
            }
        }
    }
    simulated::check(scenario, &simulation)?;
    Ok(Simulated { name: scenario.name.clone(), columns, vehicle: simulated::vehicle_of(scenario)? })
}
