//! What a car's bus says of its four wheels: their speeds, and how the car moves.
//!
//! Part of a scenario (`[wheel_speeds]`); the simulation drives it beside its masses, or alone, which takes no step of a plant.
//! It shares speed, turns, loads and pressures with them and draws from generators of its own, so that no other number of a
//! drive changes. Nothing here knows of an estimator. `docs/math/simulation.md`, "Wheel speeds".
//!
//! | module | idea |
//! |---|---|
//! | [`spec`] | as written in a scenario |
//! | `tire` | rolling radius and slip of a tire |
//! | `chassis` | loads, forces, differentials and ways round a bend |
//! | `drawn` | how one car differs from another |
//! | `disturbance` | what wanders: grade, crown, wind, steering, loads on a rough road |
//! | `run` | all of it in motion, and the messages of the bus |

mod chassis;
mod disturbance;
mod drawn;
mod run;
pub mod spec;
mod tire;

pub(crate) use disturbance::{Rough, normal};
pub use run::WheelSpeedRow;
pub(crate) use run::{Rolled, WheelSpeedRun};
pub use spec::{DrivenWheels, WheelSpeedSpec};
