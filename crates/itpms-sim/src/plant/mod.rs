//! The true car, integrated on a fine grid while its tires lose pressure: a quarter car alone, or all four corners under one body.
//!
//! Called by the simulation. The plants may have what an estimator's model lacks: a damped tire, a damper that is
//! harder one way or mounted in rubber, dry friction, hop dampers, a body that pitches, rolls and bends. They know nothing of pressure, roads or sensors.

mod bending;
mod deviations;
mod friction;
mod full_car;
mod matrix;
mod mount;
mod oscillator;
mod quarter;
mod suspension;
mod tire;

pub use bending::Bending;
pub use deviations::Deviations;
pub use full_car::{Body, CarInput, FullCar, Load};
pub use quarter::{Plant, PlantState, StepInput};
pub(crate) use suspension::Strut;
pub(crate) use tire::Tire;

pub(crate) const GRAVITY_M_S2: f64 = 9.806_65;
