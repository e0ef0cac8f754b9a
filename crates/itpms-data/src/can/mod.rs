//! CAN logs: candump's lines, Vector's ASC and BLF, behind one reader and one writer of frames.
//!
//! | module | idea |
//! |---|---|
//! | [`CanFrame`], [`CanId`] | a frame, a value without heap |
//! | [`candump`] | lines of can-utils' candump, also one by one from a pipe |
//! | `asc`, `blf` | files of CANoe, CANalyzer and other tools |
//! | [`FrameReader`], [`FrameWriter`] | any of them, by the file's extension |
//! | [`FrameRepairs`] | what was left out, counted |
//!
//! Frames come in the order of the file, which need not be the order of time, and with the times of the file: since
//! 1970 where it knows the date (taken as UTC), else since its beginning. Nothing here knows what a frame means.
//! Memory is bounded whatever a file says: a line of 4 kB, and of a BLF one container.

mod asc;
mod blf;
mod calendar;
pub mod candump;
mod digits;
mod error;
mod format;
mod frame;
mod interfaces;
mod lines;
mod reader;
mod repairs;
mod writer;

pub use error::CanProblem;
pub use frame::{CanFrame, CanId, Direction, FrameKind, Payload};
pub use reader::FrameReader;
pub use repairs::{FramePlace, FrameRepairs, NotUnderstood};
pub use writer::FrameWriter;
