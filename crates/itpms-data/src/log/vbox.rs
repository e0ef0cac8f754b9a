//! The beginning of a VBOX file (`.vbo`): sections of lines, the names of the columns in one of them, rows of numbers between blanks in the
//! last.
//!
//! Called by the reader of text tables' heads with the first line of a file.

use super::dialect::Dialect;
use super::lines::Lines;
use crate::error::Problem;

/// Lines before the data at most.
const MOST_LINES: usize = 4096;

/// The sections before the data: names and units of the columns, and the line of the names.
pub(super) struct VboxHead {
    pub(super) names: Vec<String>,
    pub(super) units: Vec<String>,
    pub(super) line: Vec<u8>,
}

/// The head, if this is such a file; else nothing has been read on.
pub(super) fn read(lines: &mut Lines) -> Result<Option<VboxHead>, Problem> {
    let is_vbox = |line: &[u8]| {
        let line = line.to_ascii_lowercase();
        line.starts_with(b"file created on") || line == b"[header]"
    };
    if !is_vbox(lines.text()) {
        return Ok(None);
    }
    let mut first = vec![lines.present()];
    let (mut section, mut channels, mut units, mut names) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    loop {
        let text = String::from_utf8_lossy(lines.text()).into_owned();
        match (&section[..], text.strip_prefix('[')) {
            (_, Some(_)) => section = text.to_ascii_lowercase().into_bytes(),
            (b"[header]", _) => channels.push(text),
            (b"[channel units]", _) => units.push(text),
            (b"[column names]", _) => names.push(text),
            _ => {}
        }
        if section == b"[data]" {
            break;
        }
        if first.len() >= MOST_LINES || !lines.advance()? {
            // No such file after all.
            lines.put_back(first.drain(1..));
            return Ok(None);
        }
        first.push(lines.present());
    }
    let line = names.concat().into_bytes();
    let short = Dialect::BLANKS.names(&line);
    // The channels' long names say the unit of the speed.
    let names: Vec<String> = if channels.len() == short.len() {
        channels
    } else {
        let long = |name: String| if name == "velocity" { "velocity kmh".to_owned() } else { name };
        short.into_iter().map(long).collect()
    };
    // Units are stated of the last channels alone, those that came from elsewhere.
    let silent = names.len().saturating_sub(units.len());
    let units = std::iter::repeat_n(String::new(), silent).chain(units).take(names.len()).collect();
    Ok(Some(VboxHead { names, units, line }))
}
