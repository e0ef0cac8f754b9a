//! The true car, integrated on a fine grid while its tires lose pressure: a quarter car alone, or all four corners under
//! one body.
//!
//! Called by the simulation. The plants may have what an estimator's model lacks: a damped tire, a damper that is
//! harder one way, dry friction, a body that pitches and rolls. They know nothing of pressure, roads or sensors.

mod deviations;
mod friction;
mod full_car;
mod quarter;
mod suspension;

pub use deviations::Deviations;
pub use full_car::{Body, CarInput, FullCar, Load};
pub use quarter::{Plant, PlantState, StepInput};
pub(crate) use suspension::Strut;
