//! The data of an OpenCRG file: rows of numbers, as text or as big-endian floats.
//!
//! Called by the reader with the bytes behind the header. A missing value is NaN. Does not know a column's meaning
//! beyond its name in a message.

use itpms_files::{Place, shortened};

use crate::channels::{Layout, Notation, Packing};
use crate::error::CrgProblem;
use crate::header::{Header, number};

/// Length of a record in bytes, or of a line in characters.
const RECORD: usize = 80;

/// All values, row after row; as many rows as `expected` if that is known.
pub(crate) fn read(
    bytes: &[u8],
    header: &Header,
    layout: &Layout,
    expected: Option<usize>,
) -> Result<Vec<f64>, CrgProblem> {
    let data = bytes.get(header.data_from..).unwrap_or_default();
    match layout.notation {
        Notation::Text(width) => read_text(data, header.data_line, layout, width),
        Notation::Single => read_binary(data, layout, 4, expected, |b| match b {
            &[a, b, c, d] => f64::from(f32::from_be_bytes([a, b, c, d])),
            _ => f64::NAN,
        }),
        Notation::Double => read_binary(data, layout, 8, expected, |b| match b {
            &[a, b, c, d, e, f, g, h] => f64::from_be_bytes([a, b, c, d, e, f, g, h]),
            _ => f64::NAN,
        }),
    }
}

fn read_binary(
    data: &[u8],
    layout: &Layout,
    width: usize,
    expected: Option<usize>,
    value: impl Fn(&[u8]) -> f64,
) -> Result<Vec<f64>, CrgProblem> {
    let channels = layout.channels.len();
    let filled = channels * width;
    let row_bytes = match layout.packing {
        Packing::Dense => filled,
        Packing::Records => filled.div_ceil(RECORD) * RECORD,
    };
    // What does not fill a record is padding; a last row may lack its own.
    let whole = data.len() / row_bytes;
    let rest = data.len() % row_bytes;
    let there = if layout.packing == Packing::Records && rest >= filled { whole + 1 } else { whole };
    let mut rows = there;
    if let Some(expected) = expected {
        if there < expected {
            let place = Place::Row(there as u64 + 1);
            let found = (rest / width).min(channels);
            return Err(if there + 1 == expected && found > 0 {
                CrgProblem::CutOff { place, found, expected: channels }
            } else {
                header_has(there, expected)
            });
        }
        if there > expected && data.len() - expected * row_bytes >= RECORD {
            return Err(header_has(there, expected));
        }
        rows = expected;
    }
    let mut values = Vec::with_capacity(rows * channels);
    for row in data.chunks(row_bytes).take(rows) {
        values.extend(row.chunks_exact(width).take(channels).map(&value));
    }
    if expected.is_none() {
        drop_padding(&mut values, channels, RECORD / width);
    }
    Ok(values)
}

/// Placeholder of an error that the reader completes: only it knows the header's lengths.
fn header_has(found: usize, expected: usize) -> CrgProblem {
    CrgProblem::Length { found, expected, start_m: f64::NAN, end_m: f64::NAN, increment_m: f64::NAN }
}

/// The NaNs that fill the last record are no rows.
fn drop_padding(values: &mut Vec<f64>, channels: usize, per_record: usize) {
    let least = values.len().saturating_sub(per_record - 1);
    while values.len() >= least + channels && values[values.len() - channels..].iter().all(|v| v.is_nan()) {
        values.truncate(values.len() - channels);
    }
}

/// A long row begins a line and fills as many as it needs; dense rows run on from line to line.
fn read_text(data: &[u8], first_line: u64, layout: &Layout, width: usize) -> Result<Vec<f64>, CrgProblem> {
    let channels = layout.channels.len();
    let per_line = RECORD / width;
    let mut values = Vec::new();
    let mut last = first_line;
    for (bytes, line) in data.split(|byte| *byte == b'\n').zip(first_line..) {
        let text = String::from_utf8_lossy(bytes);
        if text.trim().is_empty() {
            continue;
        }
        last = line;
        let begun = values.len() % channels;
        let most = match layout.packing {
            Packing::Dense => per_line,
            Packing::Records => per_line.min(channels - begun),
        };
        let cells = text_values(text.trim_end_matches('\r'), line, width, most, &mut values)?;
        if layout.packing == Packing::Records && cells < most {
            let place = Place::Line(line);
            return Err(CrgProblem::CutOff { place, found: begun + cells, expected: channels });
        }
    }
    if layout.packing == Packing::Dense {
        drop_incomplete_padding(&mut values, channels);
    }
    match values.len() % channels {
        0 => Ok(values),
        found => Err(CrgProblem::CutOff { place: Place::Line(last), found, expected: channels }),
    }
}

/// The values of a line of at most `most` cells; how many there were.
fn text_values(
    text: &str,
    line: u64,
    width: usize,
    most: usize,
    values: &mut Vec<f64>,
) -> Result<usize, CrgProblem> {
    let mut characters: Vec<char> = text.chars().collect();
    if characters.iter().skip(most * width).any(|c| !c.is_whitespace()) {
        return Err(CrgProblem::LongLine { line, found: characters.len(), expected: most * width });
    }
    characters.truncate(most * width);
    let before = values.len();
    for (i, cell) in characters.chunks(width).enumerate() {
        // Blanks behind a last cell say nothing.
        if cell.len() < width && cell.iter().all(|c| c.is_whitespace()) {
            break;
        }
        values.push(text_value(cell, line, i * width + 1, width)?);
    }
    Ok(values.len() - before)
}

/// Missing values behind the last whole row fill the last record.
fn drop_incomplete_padding(values: &mut Vec<f64>, channels: usize) {
    let whole = values.len() / channels * channels;
    if values[whole..].iter().all(|v| v.is_nan()) {
        values.truncate(whole);
    }
}

fn text_value(cell: &[char], line: u64, first: usize, width: usize) -> Result<f64, CrgProblem> {
    let text: String = cell.iter().collect();
    let trimmed = text.trim();
    let value = match trimmed {
        _ if cell.len() < width => None,
        _ if trimmed.starts_with('*') || trimmed.eq_ignore_ascii_case("nan") => Some(f64::NAN),
        _ => number(trimmed),
    };
    let last = first + cell.len() - 1;
    value.ok_or_else(|| CrgProblem::Cell { line, first, last, found: shortened(&text), width })
}
