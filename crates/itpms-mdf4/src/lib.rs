#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | idea |
//! |---|---|
//! | `identification`, `block`, `text` | the frame of a file and of its blocks, held against the file's length |
//! | `structure`, `channel_list`, `conversion`, `formula`, `field` | the tree of groups and channels, compiled to what reads a number |
//! | `mdf3` | the same tree from the blocks of versions 2 and 3 |
//! | `data`, `inflate`, `packed`, `records` | a group's bytes however they are cut and compressed, and its records among others' |
//! | `bytes`, `bus`, `attachment` | frames of a bus: their data, which channel is what, and a description inside the file |
//! | [`Mdf4Reader`], [`GroupCursor`] | what a reader sees |
//! | [`Mdf4Writer`] | groups at native rates, compressed or not, written as a stream |
//!
//! The readable part of a file that is damaged, cut off or was never finished is read; each repair or omission
//! is an [`Mdf4Repair`]. Memory is bounded whatever a file says: texts 64 MB, tables of conversions 100 MB, 131 072
//! channels, and per cursor one data block (see [`Mdf4Reader::cursor`]).
//!
//! # Other crates
//!
//! Looked at in November 2026. `mf4-rs` 3.8.0 maps files into memory and refuses DZ blocks. `mdf4-rs` 0.6.0 inflates DZ but loads the whole
//! file, turns back transposed blocks wrongly where the last row is incomplete, and needs a newer compiler than this workspace. `mdflib`
//! 0.2.1 wraps a C++ library. `asammdf` 0.1.0 calls itself not ready for use. None bounds its memory.
#![forbid(unsafe_code)]

mod attachment;
mod block;
pub mod bus;
mod bytes;
mod channel;
mod channel_list;
mod clock_unit;
mod conversion;
mod cursor;
mod data;
mod error;
mod field;
mod formula;
mod identification;
mod inflate;
mod mdf3;
mod packed;
mod reader;
mod records;
mod structure;
mod text;
mod writer;

pub use channel::{Channel, ChannelGroup, ChannelKind};
pub use cursor::GroupCursor;
pub use error::{Damage, Mdf4Error, Mdf4Problem, Mdf4Repair};
pub use reader::Mdf4Reader;
pub use writer::{ChannelSpec, Compression, GroupSpec, Mdf4Writer, SampleFormat};
