#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod atomic;
mod calendar;
mod checksum;
mod error;
pub mod input;
mod leftovers;
mod lock;
mod place;
mod same;
mod text;

pub use atomic::{AtomicFile, NewFolder, abandon_all};
pub use calendar::{Date, weekday};
pub use checksum::{Unsealed, crc64, seal, unsealed};
pub use error::{FileError, FileProblem, sentence};
pub use lock::NameLock;
pub use place::Place;
pub use same::have_same_bytes;
pub use text::{decoded, nearest, shortened};
