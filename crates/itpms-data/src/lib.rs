//! Measurements in and results out: vehicle files, drive logs, estimates and roads, each read or written as a
//! stream, so that the length of a drive never decides whether it can be processed.
//!
//! | module | idea |
//! |---|---|
//! | [`vehicle`] | the vehicle file (TOML) and the corners it describes |
//! | [`log`] | drive logs in: CSV and Parquet behind one reader that repairs, counts and refuses |
//! | `can` (feature) | frames of CAN logs: candump, ASC and BLF, read and written |
//! | `dbc` (feature `can`) | which frame carries which signals |
//! | [`columns`] | small tables of measurements in: named columns of numbers from CSV |
//! | [`convert`] | a log from one format into another |
//! | [`crg`] | roads from OpenCRG files |
//! | [`profile`] | road profiles from text |
//! | [`pulses`] | when the teeth of wheel speed sensors passed |
//! | [`mdf4`] | measurements in MDF4, in and out |
//! | [`out`] | files out: complete under their name or not there at all |
//! | [`signals`] | what comes signal by signal instead of row by row |
//! | [`reference`](mod@reference) | what a reset taught of a car, stored: its own car's, complete and plausible, or refused |
//! | [`error`] | one message per problem: file, line or column, what was found, what was expected |
//!
//! The binary and the live monitor use this crate; it knows the core's types and nothing of simulation.
#![forbid(unsafe_code)]

#[cfg(any(feature = "can", feature = "mdf4"))]
#[cfg_attr(not(feature = "can"), allow(dead_code))]
mod calendar;
#[cfg(feature = "can")]
pub mod can;
pub mod columns;
pub mod convert;
pub mod crg;
#[cfg(feature = "can")]
pub mod dbc;
pub mod error;
mod input;
pub mod log;
#[cfg(feature = "mdf4")]
pub mod mdf4;
mod nearest;
pub mod out;
#[cfg(feature = "parquet")]
mod parquet_columns;
mod place;
pub mod profile;
pub mod pulses;
pub mod reference;
pub mod signals;
mod text;
mod toml_table;
pub mod vehicle;

pub use error::{DataError, Problem};
pub use log::{LogReader, LogRow};
#[cfg(feature = "can")]
pub use log::{frame_description, holds_frames};
pub use vehicle::Vehicle;
