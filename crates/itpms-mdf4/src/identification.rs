//! The first 64 bytes: whether this is MDF4, and whether its writer came to an end.
//!
//! Called by the reader first of all.

use itpms_files::FileProblem;

use super::block::{BlockFile, IDENTIFICATION, shown};
use super::error::Mdf4Problem;

/// How the blocks of a file are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Generation {
    /// MDF 2 and 3.
    Three,
    Four,
}

/// Parts that the writer had not written yet (`id_unfin_flags`, ASAM MDF 4.1).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Unfinished {
    /// Whether the file says that it is not complete.
    pub(super) anything: bool,
    pub(super) counts: bool,
    pub(super) last_length: bool,
    pub(super) last_list: bool,
}

impl Unfinished {
    pub(super) fn describe(self) -> String {
        let missing = [
            (self.counts, "numbers of samples"),
            (self.last_length, "length of the last data block"),
            (self.last_list, "list of the last data blocks"),
        ];
        let missing: Vec<&str> = missing.iter().filter(|(is, _)| *is).map(|(_, what)| *what).collect();
        if missing.is_empty() {
            "nothing named".to_owned()
        } else {
            format!("missing: {}", missing.join(", "))
        }
    }
}

pub(super) fn read(file: &mut BlockFile) -> Result<(Generation, Unfinished), Mdf4Problem> {
    let mut bytes = [0; IDENTIFICATION as usize];
    let there = file.length().min(IDENTIFICATION) as usize;
    file.read(0, &mut bytes[..there]).map_err(FileProblem::Read)?;
    let unfinished = match &bytes[..8] {
        b"MDF     " => false,
        b"UnFinMF " => true,
        other => {
            return Err(Mdf4Problem::NotMdf(shown(&other[..there.min(8)]).trim_matches('"').to_owned()));
        }
    };
    if file.length() < IDENTIFICATION + 104 {
        return Err(Mdf4Problem::TooShort(file.length()));
    }
    let version = u16::from_le_bytes([bytes[28], bytes[29]]);
    // Up to version 3 the numbers may have the other order of bytes.
    let version = if (200..440).contains(&version.swap_bytes()) { version.swap_bytes() } else { version };
    if !(200..440).contains(&version) {
        return Err(Mdf4Problem::Version(format!("{}.{:02}", version / 100, version % 100)));
    }
    let flags = if unfinished { u16::from_le_bytes([bytes[60], bytes[61]]) } else { 0 };
    let unfinished = Unfinished {
        anything: unfinished,
        counts: flags & 1 != 0,
        last_length: flags & 1 << 2 != 0,
        last_list: flags & 1 << 4 != 0,
    };
    Ok((if version < 400 { Generation::Three } else { Generation::Four }, unfinished))
}
