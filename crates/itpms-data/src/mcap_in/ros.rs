//! The numbers of a message of ROS, by the definition that the schema is: of ROS 2 in CDR (DDS-XTypes 1.3, section 7.4.1 and 7.4.2), of ROS 1 packed.
//!
//! A definition has the fields of the message, a line each, and behind lines of `=` those of the messages inside it.

use std::collections::HashMap;

use super::fields::{Fields, MOST_ELEMENTS};

const DEEPEST: usize = 16;
/// Messages inside one message, all in all: those without a byte have no other end.
const MOST_INSIDE: usize = 1 << 14;

/// How the bytes of a message lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wire {
    /// Each number at a multiple of its size, behind four bytes that say the order of bytes.
    Cdr,
    /// One behind the other, least byte first.
    Ros1,
}

#[derive(Debug)]
pub(super) struct Definition {
    wire: Wire,
    messages: Vec<Vec<Field>>,
}

#[derive(Debug)]
struct Field {
    name: String,
    kind: Kind,
    list: List,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum List {
    One,
    Fixed(usize),
    Varying,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Unsigned(usize),
    Signed(usize),
    Float(usize),
    Text,
    /// Two numbers of four bytes: seconds and nanoseconds (ROS 1).
    Time {
        signed: bool,
    },
    /// By its place among the messages.
    Message(usize),
}

impl Definition {
    /// Reads a definition, or says why it is of no use.
    pub(super) fn parse(wire: Wire, name: &str, text: &str) -> Result<Self, String> {
        let mut parts: Vec<(String, Vec<&str>)> = vec![(name.replace("/msg/", "/"), Vec::new())];
        for line in text.lines() {
            let line = line.trim();
            if let Some(name) = line.strip_prefix("MSG:") {
                parts.push((name.trim().replace("/msg/", "/"), Vec::new()));
            } else if !line.is_empty()
                && !line.starts_with(['#', '='])
                && let Some((_, lines)) = parts.last_mut()
            {
                lines.push(line);
            }
        }
        let places: HashMap<&str, usize> =
            parts.iter().enumerate().map(|(place, (name, _))| (name.as_str(), place)).collect();
        let mut messages = Vec::new();
        for (name, lines) in &parts {
            let package = name.split_once('/').map_or("", |(package, _)| package);
            let fields = lines.iter().filter_map(|line| field(line, package, &places, wire).transpose());
            messages.push(fields.collect::<Result<Vec<Field>, String>>()?);
        }
        Ok(Self { wire, messages })
    }

    /// Hands out the numbers of a message; false if its bytes are too few.
    pub(super) fn walk(&self, bytes: &[u8], fields: &mut Fields<'_>) -> bool {
        let (bytes, big_endian, align) = match (self.wire, bytes) {
            (Wire::Ros1, bytes) => (bytes, false, 1),
            (Wire::Cdr, [0, kind @ (0 | 1), _, _, bytes @ ..]) => (bytes, *kind == 0, 8),
            // The second version aligns to four bytes at most.
            (Wire::Cdr, [0, kind @ (6 | 7), _, _, bytes @ ..]) => (bytes, *kind == 6, 4),
            _ => return false,
        };
        let mut cursor = Cursor { bytes, at: 0, big_endian, align, inside: MOST_INSIDE };
        self.message(0, 0, &mut cursor, &mut Some(fields)).is_some()
    }

    /// Passes through a message; its numbers are handed out where someone wants them.
    fn message(
        &self,
        place: usize,
        depth: usize,
        cursor: &mut Cursor<'_>,
        fields: &mut Option<&mut Fields<'_>>,
    ) -> Option<()> {
        let message = self.messages.get(place).filter(|_| depth < DEEPEST)?;
        cursor.inside = cursor.inside.checked_sub(1)?;
        if message.is_empty() && self.wire == Wire::Cdr {
            // IDL has no empty structures: one has a byte that says nothing.
            cursor.take(1)?;
        }
        for field in message {
            let mut inside = |fields: &mut Option<&mut Fields<'_>>| self.field(field, depth, cursor, fields);
            match fields {
                Some(some) => some.field(&field.name, |fields| inside(&mut Some(fields)))??,
                None => inside(&mut None)?,
            }
        }
        Some(())
    }

    fn field(
        &self,
        field: &Field,
        depth: usize,
        cursor: &mut Cursor<'_>,
        fields: &mut Option<&mut Fields<'_>>,
    ) -> Option<()> {
        let count = match field.list {
            List::One => return self.value(field.kind, depth, cursor, fields),
            List::Fixed(count) => count,
            List::Varying => cursor.unsigned(4)? as usize,
        };
        if let Kind::Unsigned(size) | Kind::Signed(size) | Kind::Float(size) = field.kind
            && count > MOST_ELEMENTS
        {
            return cursor.take_aligned(size, count.checked_mul(size)?).map(drop);
        }
        for number in 0..count {
            let mut inside = |fields: &mut Option<&mut Fields<'_>>| {
                // Elements without a byte have no end.
                let before = cursor.at;
                self.value(field.kind, depth, cursor, fields)?;
                (cursor.at > before).then_some(())
            };
            match fields.as_mut().filter(|_| count <= MOST_ELEMENTS) {
                Some(some) => some.element(number, |fields| inside(&mut Some(fields)))??,
                None => inside(&mut None)?,
            }
        }
        Some(())
    }

    fn value(
        &self,
        kind: Kind,
        depth: usize,
        cursor: &mut Cursor<'_>,
        fields: &mut Option<&mut Fields<'_>>,
    ) -> Option<()> {
        let value = match kind {
            Kind::Message(place) => return self.message(place, depth + 1, cursor, fields),
            Kind::Text => {
                let length = cursor.unsigned(4)? as usize;
                return cursor.take(length).map(drop);
            }
            Kind::Time { signed } => {
                for name in ["sec", "nanosec"] {
                    let value = if signed { cursor.signed(4)? as f64 } else { cursor.unsigned(4)? as f64 };
                    if let Some(fields) = fields {
                        fields.field(name, |fields| fields.number(value));
                    }
                }
                return Some(());
            }
            Kind::Unsigned(size) => cursor.unsigned(size)? as f64,
            Kind::Signed(size) => cursor.signed(size)? as f64,
            Kind::Float(4) => f64::from(f32::from_bits(cursor.unsigned(4)? as u32)),
            Kind::Float(_) => f64::from_bits(cursor.unsigned(8)?),
        };
        if let Some(fields) = fields {
            fields.number(value);
        }
        Some(())
    }
}

/// The field on a line; `None` for a constant.
fn field(
    line: &str,
    package: &str,
    places: &HashMap<&str, usize>,
    wire: Wire,
) -> Result<Option<Field>, String> {
    let unknown = || format!("a definition with the line {line:?}");
    let (kind, rest) = line.split_once(char::is_whitespace).ok_or_else(unknown)?;
    let rest = rest.split('#').next().unwrap_or_default().trim();
    let name = rest.split(|c: char| c.is_whitespace() || c == '=').next().unwrap_or_default();
    let after = rest.get(name.len()..).unwrap_or_default().trim_start();
    if after.starts_with('=') {
        return Ok(None);
    }
    let (kind, list) = match kind.split_once('[') {
        None => (kind, List::One),
        Some((kind, count)) => {
            let count = count.strip_suffix(']').ok_or_else(unknown)?;
            let list = if count.is_empty() || count.starts_with("<=") {
                List::Varying
            } else {
                List::Fixed(count.parse().map_err(|_| unknown())?)
            };
            (kind, list)
        }
    };
    // `string<=16` has a bound.
    let plain = kind.split("<=").next().unwrap_or(kind);
    let ros1 = wire == Wire::Ros1;
    let kind = match plain {
        "bool" | "uint8" => Kind::Unsigned(1),
        "byte" if ros1 => Kind::Signed(1),
        "char" | "byte" => Kind::Unsigned(1),
        "int8" => Kind::Signed(1),
        "uint16" => Kind::Unsigned(2),
        "int16" => Kind::Signed(2),
        "uint32" => Kind::Unsigned(4),
        "int32" => Kind::Signed(4),
        "uint64" => Kind::Unsigned(8),
        "int64" => Kind::Signed(8),
        "float32" => Kind::Float(4),
        "float64" => Kind::Float(8),
        "string" => Kind::Text,
        "time" if ros1 => Kind::Time { signed: false },
        "duration" if ros1 => Kind::Time { signed: true },
        other => {
            let other = other.replace("/msg/", "/");
            let own = format!("{package}/{other}");
            let header = (other == "Header").then_some("std_msgs/Header");
            let place = [Some(other.as_str()), Some(own.as_str()), header].into_iter().flatten();
            let place = place.filter_map(|name| places.get(name)).copied().next();
            Kind::Message(place.ok_or_else(|| format!("a definition that lacks {other}"))?)
        }
    };
    Ok(Some(Field { name: name.to_owned(), kind, list }))
}

/// Where in a message reading is.
#[derive(Debug)]
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
    /// The largest multiple at which a number lies.
    align: usize,
    /// Messages that may still come.
    inside: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let bytes = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(bytes)
    }

    fn take_aligned(&mut self, size: usize, count: usize) -> Option<&'a [u8]> {
        let align = size.min(self.align).max(1);
        self.at = self.at.checked_next_multiple_of(align)?;
        self.take(count)
    }

    fn unsigned(&mut self, size: usize) -> Option<u64> {
        let bytes = self.take_aligned(size, size)?;
        let together = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        Some(if self.big_endian {
            bytes.iter().fold(0, together)
        } else {
            bytes.iter().rev().fold(0, together)
        })
    }

    fn signed(&mut self, size: usize) -> Option<i64> {
        let unused = 64 - 8 * size as u32;
        Some((self.unsigned(size)? << unused) as i64 >> unused)
    }
}
