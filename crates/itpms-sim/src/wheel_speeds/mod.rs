//! Wheel speeds on a car's bus, and the car's motion.
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
//! | [`conditions`] | what makes one drive differ from another, as written in a scenario |
//! | [`draw`] | cars and days drawn from seeds |
//! | `surface` | what is under the wheels of each side |
//! | `motion_sensors` | yaw rate and accelerations with their errors and faults |
//! | `drawn` | how one car differs from another |
//! | `disturbance` | what wanders: grade, crown, wind, steering, loads on a rough road |
//! | `run` | all of it in motion, and the messages of the bus |

mod chassis;
pub mod conditions;
mod disturbance;
pub mod draw;
mod drawn;
mod motion_sensors;
mod run;
pub mod spec;
mod surface;
mod tire;

pub use conditions::{ConditionsSpec, YawFault};
pub(crate) use disturbance::{Rough, normal};
pub use draw::{Condition, Day};
pub use run::WheelSpeedRow;
pub(crate) use run::{Rolled, WheelSpeedRun};
pub use spec::{DrivenWheels, WheelSpeedSpec};
