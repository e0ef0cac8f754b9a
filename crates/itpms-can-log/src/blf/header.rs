//! The header of a BLF file. Called by the reader and the writer beside it.
//!
//! Bytes: 0 `LOGG`, 4 header size u32, 8 program and version, 16 file size u64, 24 uncompressed size u64, 32 objects u32,
//! 36 objects read u32, 40 beginning, 56 end (eight u16 each: year, month, weekday, day, hour, minute, second, ms).

use itpms_files::{Date, weekday};

use super::bytes::{u16_at, u32_at};

/// Bytes of the header that are read; programs write [`SIZE`].
pub(super) const LEAST: usize = 72;

/// Bytes of the header that is written.
pub(super) const SIZE: usize = 144;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Header {
    pub(super) size: u32,
    /// Beginning of the measurement in s since 1970; 0 where the header does not say.
    pub(super) start_s: f64,
}

impl Header {
    /// The header at the beginning of a file; `None` if there is none.
    pub(super) fn read(data: &[u8]) -> Option<Self> {
        if data.get(..4)? != b"LOGG" {
            return None;
        }
        Some(Self { size: u32_at(data, 4)?, start_s: system_time(data.get(40..56)?).unwrap_or(0.0) })
    }
}

/// Seconds since 1970 of a `SYSTEMTIME`, taken as UTC as python-can does; the format does not name a time zone.
fn system_time(data: &[u8]) -> Option<f64> {
    let field = |index: usize| u16_at(data, 2 * index).map(u32::from);
    let date = Date {
        year: field(0)?.into(),
        month: field(1)?,
        day: field(3)?,
        hour: field(4)?,
        minute: field(5)?,
        second: field(6)?,
    };
    let milliseconds = i64::from(field(7)?.min(999));
    // Rounded once.
    Some((date.seconds()? * 1000 + milliseconds) as f64 / 1000.0)
}

/// The statistics in the header of a finished file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Summary {
    pub(super) file_bytes: u64,
    pub(super) uncompressed_bytes: u64,
    pub(super) objects: u32,
    /// Whole seconds since 1970.
    pub(super) start_s: i64,
    /// Milliseconds since 1970.
    pub(super) stop_ms: i64,
}

impl Summary {
    pub(super) fn to_bytes(self) -> [u8; SIZE] {
        let mut out = Vec::with_capacity(SIZE);
        out.extend_from_slice(b"LOGG");
        out.extend_from_slice(&(SIZE as u32).to_le_bytes());
        // No program's number; the version of the binary format that these objects belong to (2.6.8.1).
        out.extend_from_slice(&[0, 0, 0, 0, 2, 6, 8, 1]);
        out.extend_from_slice(&self.file_bytes.to_le_bytes());
        out.extend_from_slice(&self.uncompressed_bytes.to_le_bytes());
        out.extend_from_slice(&self.objects.to_le_bytes());
        out.extend_from_slice(&0_u32.to_le_bytes());
        push_system_time(&mut out, self.start_s * 1000);
        push_system_time(&mut out, self.stop_ms);
        let mut bytes = [0; SIZE];
        bytes[..out.len()].copy_from_slice(&out);
        bytes
    }
}

fn push_system_time(out: &mut Vec<u8>, milliseconds: i64) {
    let seconds = milliseconds.div_euclid(1000);
    let date = Date::of_seconds(seconds);
    let fields = [
        date.year as u16,
        date.month as u16,
        weekday(seconds) as u16,
        date.day as u16,
        date.hour as u16,
        date.minute as u16,
        date.second as u16,
        milliseconds.rem_euclid(1000) as u16,
    ];
    fields.iter().for_each(|field| out.extend_from_slice(&field.to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_beginning_is_read_as_it_was_written() {
        let summary =
            Summary { file_bytes: 1, uncompressed_bytes: 2, objects: 3, start_s: 1_795_195_053, stop_ms: 0 };
        let bytes = summary.to_bytes();
        assert_eq!(Header::read(&bytes), Some(Header { size: 144, start_s: 1_795_195_053.0 }));
        // Friday, 20 November 2026, 17:17:33.000.
        let fields: Vec<u16> = (0..8).map(|index| u16_at(&bytes, 40 + 2 * index).unwrap()).collect();
        assert_eq!(fields, [2026, 11, 5, 20, 17, 17, 33, 0]);
        assert_eq!(Header::read(b"LOGG"), None);
        assert_eq!(Header::read(&[0; 144]), None);
    }
}
