#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | idea |
//! |---|---|
//! | [`CanFrame`], [`CanId`] | a frame, a value without heap |
//! | [`candump`] | lines of can-utils' candump, also one by one from a pipe |
//! | `asc`, `blf` | files of CANoe, CANalyzer and other tools |
//! | `trc`, `busmaster`, `frame_table` | files of PEAK's programs, BUSMASTER, SavvyCAN and python-can, read line by line |
//! | `mf4` | frames in MDF4 files |
//! | [`FrameReader`], [`FrameWriter`] | any of them, by the file's extension |
//! | [`FrameRepairs`] | what was left out, counted |
//! | [`dbc`] | which frame carries which signals |
//!
//! Frames come in the order of the file, which need not be the order of time, and with the times of the file: since
//! 1970 where it knows the date (taken as UTC), else since its beginning. Nothing here knows what a frame means.
//! Memory is bounded whatever a file says: a line of 4 kB, and of a BLF one container.
#![forbid(unsafe_code)]

mod asc;
mod blf;
mod busmaster;
pub mod candump;
pub mod dbc;
mod digits;
mod error;
mod format;
mod frame;
mod frame_source;
mod frame_table;
mod interfaces;
mod line_format;
mod line_reader;
mod lines;
#[cfg(feature = "mdf4")]
mod mf4;
mod reader;
mod repairs;
mod strange;
mod trc;
mod writer;

pub use error::{CanError, CanProblem};
pub use frame::{CanFrame, CanId, Direction, FrameKind, Payload};
pub use reader::{FrameReader, is_frame_table};
pub use repairs::{FramePlace, FrameRepairs, NotUnderstood};
pub use writer::FrameWriter;
