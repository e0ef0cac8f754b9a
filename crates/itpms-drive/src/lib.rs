//! Whole drives: a log and a vehicle in; pressures, road, alerts and a report's data out. One at a time or a fleet's.
//!
//! | module | idea |
//! |---|---|
//! | [`settings`] | what an estimate can be given besides its log and its vehicle |
//! | [`drive`] | the estimator of a drive's car under its monitor |
//! | [`alerts`] | what the monitor reported and took back |
//! | [`road`] | the road record, late but smooth |
//! | `road_survey` | its roughness, holes and bumps, and where they are |
//! | [`run`] | a log, row by row, through all of these into a [`Sink`] |
//! | [`pipeline`] | the same with reading and recording on threads of their own |
//! | [`concerns`] | what should be known before believing the result |
//! | [`reference`](mod@reference) | what a calibration drive taught, from and for other drives |
//! | [`learn`](mod@learn) | a vehicle file from drives at known pressures |
//! | [`check`](mod@check) | a vehicle file held against a drive |
//! | [`field`] | the field kit: an owner's log with known pressures, judged and packed |
//! | [`summary`] | what is known at the end, as JSON |
//! | [`files`] | the sink of the command line: files, complete or not there |
//! | [`fleet`] | many drives of many cars |
//! | [`simulated`] | simulated drives as logs hold them |
//! | [`wheel_speeds`](wheel_speed_use) | wheel speeds under their monitor, alone or beside accelerations |
//! | `air` | what a log says of the air that cannot be |
//! | `pulses` | tooth pulses read along with a log |
//! | [`error`] | why there is no result |
//!
//! Called by the binary and by the Python package. Knows no terminal, no exit codes and no mathematics.
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]

mod air;
pub mod alerts;
mod car;
pub mod check;
pub mod concerns;
pub mod drive;
pub mod error;
pub mod field;
pub mod files;
pub mod fleet;
mod job;
pub mod learn;
pub mod learn_radius;
pub mod pipeline;
mod plausibility;
mod provenance;
mod pulses;
pub mod reference;
pub mod road;
mod road_survey;
pub mod run;
pub mod settings;
pub mod simulated;
pub mod summary;
mod time_axis;
pub mod tire_sensors;
mod wheel_speeds;
mod wheelbase;

pub use alerts::Alerts;
pub use car::AnyCar;
pub use check::{CheckedVehicle, check};
pub use concerns::common_corners;
pub use drive::{Drive, Estimates, QuarterCars};
pub use error::DriveError;
pub use field::{FieldCheck, FieldNotes, check_field};
pub use files::{FilePaths, Files};
pub use itpms_paper::EstimatorKind;
pub use learn::{KnownDrive, LearnedVehicle, learn, learn_with};
pub use learn_radius::{LearnedRadius, learn_radius};
pub use pipeline::estimate_in_pipeline;
pub use reference::Taught;
pub use road::{LateRow, RoadTrack};
pub use road_survey::{RoadSurvey, SurveyedRoad};
pub use run::{Done, Heights, Job, Sink, Watch, estimate};
pub use settings::Settings;
pub use summary::{corner_lines, summary_json, torsion_line, wheel_speed_lines};
pub use wheel_speeds::wheel_speed_use;
