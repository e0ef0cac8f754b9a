//! A car's parameters: read, made from text, written.

use std::path::PathBuf;

use itpms_core::model::Corner;
use itpms_data::vehicle::typical::{CarClass, FrontRear, TireSize, TypicalCar};
use pyo3::prelude::*;
use serde_json::json;

use crate::errors::{self, Kind, raise};

/// One value for both axles, or a pair: front, rear.
#[derive(FromPyObject)]
pub(crate) enum OfAxle<T> {
    Both(T),
    Each(T, T),
}

impl<T: Clone> OfAxle<T> {
    fn axles(self) -> [T; 2] {
        match self {
            Self::Both(value) => [value.clone(), value],
            Self::Each(front, rear) => [front, rear],
        }
    }
}

/// A car as its vehicle file describes it.
#[pyclass(frozen, module = "itpms._itpms")]
#[derive(Debug)]
pub(crate) struct Vehicle(pub(crate) itpms_data::Vehicle);

#[pymethods]
impl Vehicle {
    /// The car of a vehicle file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let vehicle = itpms_data::Vehicle::read(&path);
        vehicle.map(Self).map_err(|error| errors::data(py, Kind::Vehicle, &error))
    }

    /// The car that the text of a vehicle file describes.
    #[staticmethod]
    fn parse(py: Python<'_>, text: &str) -> PyResult<Self> {
        itpms_data::Vehicle::parse(text).map(Self).map_err(|problem| raise(py, Kind::Vehicle, problem))
    }

    /// The paper's simulated car.
    #[staticmethod]
    fn paper() -> Self {
        Self(itpms_data::Vehicle::paper())
    }

    /// A car of typical values.
    #[staticmethod]
    fn typical(
        py: Python<'_>,
        mass_kg: f64,
        front_share: f64,
        tire: OfAxle<String>,
        car_class: Option<&str>,
        placard_kpa: OfAxle<f64>,
        wheelbase_m: Option<f64>,
        name: Option<String>,
    ) -> PyResult<Self> {
        let refuse = |sentence: String| raise(py, Kind::Setting, sentence);
        let class = car_class.map_or(Ok(CarClass::default()), |label| {
            CarClass::from_label(label).ok_or_else(|| {
                let known = CarClass::ALL.map(CarClass::label).join(", ");
                refuse(format!("car_class is {label:?}, expected one of: {known}"))
            })
        })?;
        let size = |text: String| text.parse::<TireSize>().map_err(|error| refuse(format!("tire: {error}")));
        let [front, rear] = tire.axles().map(size);
        let tire = FrontRear { front: front?, rear: rear? };
        let [front, rear] = placard_kpa.axles();
        let placard_kpa = FrontRear { front, rear };
        let car =
            TypicalCar { name, mass_kg, front_share, tire, class, placard_kpa, wheelbase_m, wheels: None };
        car.vehicle_file().map(|(_, vehicle)| Self(vehicle)).map_err(|error| refuse(error.to_string()))
    }

    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.0.write(&path).map_err(|error| errors::data(py, Kind::Output, &error))
    }

    fn to_toml(&self) -> String {
        self.0.to_toml()
    }

    /// Name, id, wheelbase and corners as JSON.
    fn json(&self) -> String {
        let corners: serde_json::Map<String, serde_json::Value> = Corner::ALL
            .into_iter()
            .filter_map(|corner| {
                let config = self.0.corner(corner)?;
                let car = &config.quarter_car;
                let described = json!({
                    "sprung_mass_kg": car.sprung_mass_kg(),
                    "unsprung_mass_kg": car.unsprung_mass_kg(),
                    "damping_n_s_per_m": car.damping_n_s_per_m(),
                    "spring_n_per_m": car.spring_n_per_m(),
                    "placard_kpa": config.placard_kpa,
                    "stiffness_per_kpa": config.tire.stiffness_per_kpa(),
                    "stiffness_at_zero": config.tire.stiffness_at_zero(),
                });
                Some((corner.label().to_owned(), described))
            })
            .collect();
        let itpms_data::Vehicle { name, id, wheelbase_m, .. } = &self.0;
        json!({ "name": name, "id": id, "wheelbase_m": wheelbase_m, "corners": corners }).to_string()
    }
}
