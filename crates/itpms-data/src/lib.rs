//! Measurements in and results out: vehicle files, drive logs, estimates and roads, each read or written as a
//! stream, so that the length of a drive never decides whether it can be processed.
//!
//! | module | idea |
//! |---|---|
//! | [`vehicle`] | the vehicle file (TOML) and the corners it describes |
//! | [`log`] | drive logs in: tables, MDF, CAN logs and MCAP behind one reader that repairs, counts and refuses |
//! | `can` (feature) | the crate `itpms-can-log`: frames of CAN logs, descriptions of a bus |
//! | `dbc` (feature `can`) | frames to columns and back, by a description |
//! | [`columns`] | small tables of measurements in: named columns of numbers from CSV |
//! | [`convert`] | a log from one format into another |
//! | [`crg`] | the crate `itpms-opencrg`: roads from OpenCRG files |
//! | [`profile`] | road profiles from text |
//! | [`pulses`] | when the teeth of wheel speed sensors passed |
//! | `mdf4` (feature) | the crate `itpms-mdf4`: measurements in MDF, in and out |
//! | [`out`] | files out: complete under their name or not there at all |
//! | [`signals`] | what comes signal by signal instead of row by row |
//! | [`reference`](mod@reference) | what a reset taught of a car, stored: its own car's, complete and plausible, or refused |
//! | [`tuning`] | numbers of the monitor that are not their defaults (TOML) |
//! | [`error`] | one message per problem: file, line or column, what was found, what was expected |
//!
//! The binary and the live monitor use this crate; it knows the core's types and nothing of simulation.
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]

pub mod columns;
pub mod convert;
#[cfg(feature = "can")]
pub mod dbc;
pub mod error;
pub mod log;
#[cfg(feature = "mcap")]
mod mcap_in;
#[cfg(feature = "mdf4")]
mod mdf4_contents;
pub mod out;
#[cfg(feature = "parquet")]
mod parquet_columns;
mod pressure_unit;
pub mod profile;
pub mod pulses;
pub mod reference;
pub mod signals;
mod toml_table;
pub mod tuning;
pub mod vehicle;

pub use error::{DataError, Problem};
#[cfg(feature = "can")]
pub use itpms_can_log as can;
#[cfg(feature = "mdf4")]
pub use itpms_mdf4 as mdf4;
pub use itpms_opencrg as crg;
pub use log::{LogReader, LogRow};
#[cfg(feature = "can")]
pub use log::{frame_decoder, frame_description, holds_frames};
pub use vehicle::Vehicle;
