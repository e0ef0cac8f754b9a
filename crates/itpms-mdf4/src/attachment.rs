//! Files inside a file (AT blocks): a description of the bus beside its frames.
//!
//! Called by whoever has frames without a description; knows no attachment's contents.

use std::collections::HashSet;

use itpms_files::FileProblem;

use super::block::{BlockFile, FRAME, Kind};
use super::error::{Damage, Mdf4Problem};
use super::packed::{End, Method, unpack};
use super::text;

/// Up to the embedded bytes (ASAM MDF 4.1, ATBLOCK).
const ATTACHMENT: Kind = Kind { name: "attachment", id: b"##AT", links: 4, data: 40, most: 40 };

/// `at_flags`.
const EMBEDDED: u16 = 1;
const COMPRESSED: u16 = 1 << 1 | 1 << 3;

/// Attachments of a file that are looked at.
const MOST: usize = 1 << 10;

/// Contents of the first embedded file whose name is `wanted`, of at most `most` bytes, and that name.
pub(super) fn find(
    file: &mut BlockFile,
    first: u64,
    wanted: impl Fn(&str) -> bool,
    most: u64,
) -> Result<Option<(String, Vec<u8>)>, Mdf4Problem> {
    let (mut at, mut visited) = (first, HashSet::new());
    while at != 0 && visited.len() < MOST && visited.insert(at) {
        let block = match file.block(&ATTACHMENT, at) {
            Ok(block) => block,
            // The list ends where it is damaged.
            Err(fault) => return fault.damage().map(|_| None),
        };
        let name = match text::read(file, block.link(1)) {
            Ok(name) => name,
            Err(fault) => fault.damage().map(|_| String::new())?,
        };
        let flags = block.u16(0);
        if flags & EMBEDDED != 0 && wanted(&name) {
            let stored = (at + FRAME + 8 * block.links() as u64 + 40, block.u64(32));
            let method = (flags & COMPRESSED != 0).then(|| block.u8(4));
            let contents = contents(file, stored, method, most)?;
            return match contents {
                Ok(contents) => Ok(Some((name, contents))),
                Err(found) => {
                    let found = format!("{name} {found}");
                    Err(Mdf4Problem::Unreadable(Damage::new("attachment", at, found)))
                }
            };
        }
        at = block.link(0);
    }
    Ok(None)
}

/// The bytes of an embedded file, or what is wrong with them.
fn contents(
    file: &mut BlockFile,
    (from, stored): (u64, u64),
    method: Option<u8>,
    most: u64,
) -> Result<Result<Vec<u8>, String>, Mdf4Problem> {
    let mut bytes = Vec::new();
    let there = file.length().saturating_sub(from);
    let Some(method) = method else {
        if stored > there || stored > most {
            return Ok(Err(format!("has {stored} bytes, expected at most {}", there.min(most))));
        }
        bytes.resize(stored as usize, 0);
        file.read(from, &mut bytes).map_err(FileProblem::Read)?;
        return Ok(Ok(bytes));
    };
    let Some((method, false)) = Method::of(method) else {
        return Ok(Err(format!("has compression {method}, expected 0, 2 or 4 (deflate, zstd, lz4)")));
    };
    Ok(match unpack(file, (from, stored), method, &mut bytes, most).map_err(FileProblem::Read)? {
        End::Complete => Ok(bytes),
        End::Cut => Err("is cut off".to_owned()),
        End::Broken => Err("cannot be unpacked".to_owned()),
        End::TooLong => Err(format!("has more than the {most} bytes expected")),
    })
}
