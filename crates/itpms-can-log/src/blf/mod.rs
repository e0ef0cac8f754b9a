//! Vector's BLF: a log as binary objects, most of them inside compressed containers.
//!
//! ```text
//! file      = header (LOGG, 144 bytes) { object }
//! object    = LOBJ, header size u16, header version u16, object size u32, type u32, rest; size modulo 4 bytes follow
//! container = object of type 10: method u16, 6, uncompressed size u32, 4, data (zlib or as they are)
//! ```
//!
//! The contents of the containers, one after the other, are a stream of objects: one may begin in a container and end in
//! the next. All numbers are little-endian. Called by `FrameReader` and `FrameWriter`.
//!
//! **Memory**: one container is held, compressed, uncompressed and once more in front of what follows it. A container of
//! more than 16 MiB, compressed or not, is damaged; so this is at most 48 MiB whatever a file says, and 0.4 MB for the
//! 128 KiB of known programs.
//!
//! **Why no crate.** `ablf` 0.2 knows no CAN FD and, of classic frames, `CAN_MESSAGE2` alone; it panics when a container
//! does not inflate, calls itself once per byte that it passes over, and allocates what a size field says. `blf_asc`
//! 0.2 has one release by one author and holds what it reads. A reader that goes on after damage has to be the owner of
//! the loop; the layouts are public knowledge and small.

mod bytes;
mod container;
mod header;
mod object;
mod reader;
mod writer;

pub(super) use reader::BlfReader;
pub(super) use writer::BlfWriter;

const SIGNATURE: &[u8; 4] = b"LOBJ";

/// Bytes of the part of its header that every object has.
const BASE_HEADER: usize = 16;

/// Object types; `log_container` and the frames of CAN.
mod kind {
    pub(super) const CAN_MESSAGE: u32 = 1;
    pub(super) const CAN_ERROR: u32 = 2;
    pub(super) const LOG_CONTAINER: u32 = 10;
    pub(super) const CAN_ERROR_EXT: u32 = 73;
    pub(super) const CAN_MESSAGE2: u32 = 86;
    pub(super) const CAN_FD_MESSAGE: u32 = 100;
    pub(super) const CAN_FD_MESSAGE_64: u32 = 101;
    pub(super) const CAN_FD_ERROR_64: u32 = 104;
}
