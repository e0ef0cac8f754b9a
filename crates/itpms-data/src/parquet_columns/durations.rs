//! Which integers are durations: Parquet has no such type, so Arrow's writers (pyarrow, pandas, polars) lay them down as plain
//! integers and say the unit in the file's metadata, under `ARROW:schema`.
//!
//! That is a message of Arrow's IPC format, a FlatBuffer, of which a few fields matter here. Reading them takes less than a
//! dependency on Arrow would; whatever contradicts itself counts as not given. Called once a file by the columns.

use std::collections::HashMap;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

pub(super) const KEY: &str = "ARROW:schema";

/// Places of fields in their tables, and tags, from Arrow's `Message.fbs` and `Schema.fbs`.
const MESSAGE_HEADER: usize = 2;
const SCHEMA_FIELDS: usize = 1;
const FIELD_NAME: usize = 0;
const FIELD_TYPE_TAG: usize = 2;
const FIELD_TYPE: usize = 3;
const TAG_DURATION: u8 = 18;
const DURATION_UNIT: usize = 0;

/// Units that a second has, by the names of the columns that hold durations.
pub(super) fn units_per_s(schema: &str) -> HashMap<String, f64> {
    read(schema).unwrap_or_default()
}

fn read(schema: &str) -> Option<HashMap<String, f64>> {
    let bytes = STANDARD.decode(schema.trim()).ok()?;
    // A marker that newer writers put first, then the length.
    let buffer = Buffer(bytes.strip_prefix(&[0xff; 4]).unwrap_or(&bytes).get(4..)?);
    let schema = buffer.table(buffer.root()?, MESSAGE_HEADER)?;
    let mut found = HashMap::new();
    for field in buffer.tables(schema, SCHEMA_FIELDS)? {
        if buffer.byte(field, FIELD_TYPE_TAG) != Some(TAG_DURATION) {
            continue;
        }
        let unit = buffer.short(buffer.table(field, FIELD_TYPE)?, DURATION_UNIT);
        // Left out, it is the schema's default: milliseconds.
        let per_s = [1.0, 1e3, 1e6, 1e9].get(usize::from(unit.unwrap_or(1)))?;
        found.insert(buffer.text(field, FIELD_NAME)?, *per_s);
    }
    Some(found)
}

/// A FlatBuffer. A table is the place where it begins; every offset counts from where it stands.
struct Buffer<'a>(&'a [u8]);

impl Buffer<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> Option<[u8; N]> {
        self.0.get(at..at.checked_add(N)?)?.try_into().ok()
    }

    fn u32_at(&self, at: usize) -> Option<usize> {
        usize::try_from(u32::from_le_bytes(self.bytes(at)?)).ok()
    }

    fn follow(&self, at: usize) -> Option<usize> {
        at.checked_add(self.u32_at(at)?)
    }

    fn root(&self) -> Option<usize> {
        self.follow(0)
    }

    /// Where a table's field stands; `None`: it is left out.
    fn field(&self, table: usize, number: usize) -> Option<usize> {
        let back = i64::from(i32::from_le_bytes(self.bytes(table)?));
        let directory = usize::try_from(i64::try_from(table).ok()?.checked_sub(back)?).ok()?;
        let entry = 4 + 2 * number;
        if entry + 2 > usize::from(u16::from_le_bytes(self.bytes(directory)?)) {
            return None;
        }
        let offset = usize::from(u16::from_le_bytes(self.bytes(directory.checked_add(entry)?)?));
        if offset == 0 { None } else { table.checked_add(offset) }
    }

    fn byte(&self, table: usize, number: usize) -> Option<u8> {
        self.bytes(self.field(table, number)?).map(|[byte]| byte)
    }

    fn short(&self, table: usize, number: usize) -> Option<u16> {
        self.bytes(self.field(table, number)?).map(u16::from_le_bytes)
    }

    fn table(&self, table: usize, number: usize) -> Option<usize> {
        self.follow(self.field(table, number)?)
    }

    fn text(&self, table: usize, number: usize) -> Option<String> {
        let at = self.table(table, number)?;
        let begin = at.checked_add(4)?;
        let bytes = self.0.get(begin..begin.checked_add(self.u32_at(at)?)?)?;
        String::from_utf8(bytes.to_vec()).ok()
    }

    fn tables(&self, table: usize, number: usize) -> Option<impl Iterator<Item = usize>> {
        let at = self.table(table, number)?;
        // No more than the bytes have room for.
        let count = self.u32_at(at)?.min(self.0.len() / 4);
        Some((0..count).map_while(move |i| self.follow(at + 4 + 4 * i)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What pyarrow 26 writes of a table with `a: duration[us]`, `b: double`, `c: duration[s]`.
    const PYARROW: &str = "/////8gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAABsAAAAMAAAAAQAAACw////AAABEhAAAAAUAAAABAAAAAAAAAABAAAAYwAAAKL///8AAAAA2P///wAAAQMQAAAAFAAAAAQAAAAAAAAAAQAAAGIAAADK////AAACABAAFAAIAAYABwAMAAAAEAAQAAAAAAABEhAAAAAYAAAABAAAAAAAAAABAAAAYQAGAAgABgAGAAAAAAACAA==";

    #[test]
    fn arrows_own_words() {
        assert_eq!(units_per_s(PYARROW), HashMap::from([("a".to_owned(), 1e6), ("c".to_owned(), 1.0)]));
    }

    #[test]
    fn damage_is_silence() {
        let bytes = STANDARD.decode(PYARROW).unwrap();
        for place in 0..bytes.len() {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[place] ^= 1 << bit;
                units_per_s(&STANDARD.encode(&damaged));
            }
            units_per_s(&STANDARD.encode(&bytes[..place]));
        }
        assert!(units_per_s("no base64!").is_empty());
    }
}
