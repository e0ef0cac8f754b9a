//! The meaning of the data's columns: `$KD_DEFINITION`, and the lateral positions of the long sections.
//!
//! Called by the reader between header and data. Knows nothing of heights.

use itpms_files::shortened;

use crate::error::CrgProblem;
use crate::header::{Definition, Header, number};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Notation {
    /// Text, this many characters a number.
    Text(usize),
    /// Big-endian `f32`.
    Single,
    /// Big-endian `f64`.
    Double,
}

/// How rows follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packing {
    /// Each row begins a record of 80 bytes ("long").
    Records,
    /// Rows without a gap ("kernel").
    Dense,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Channel {
    /// Heights; the number counts the long sections from the right.
    LongSection(usize),
    Slope,
    Banking,
    /// Height of the reference line itself.
    Elevation,
    /// Where the line goes in the plane, or something else that does not change a height.
    Ignored,
}

/// The columns of the data.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    pub(crate) notation: Notation,
    pub(crate) packing: Packing,
    pub(crate) channels: Vec<Channel>,
    /// The channels' names as written.
    pub(crate) names: Vec<String>,
    /// Lateral positions of the long sections in m, increasing to the left.
    pub(crate) v_m: Vec<f64>,
}

/// A long section as defined: its column, and where it lies.
#[derive(Debug, Clone, Copy)]
struct LongSection {
    column: usize,
    line: u64,
    at: At,
}

#[derive(Debug, Clone, Copy)]
enum At {
    Position(f64),
    Number(f64),
}

const CHANNELS: &str =
    "long section N,m, or long section at v = V,m, or reference line phi, x, y, z, slope or banking";

impl Layout {
    pub(crate) fn new(header: &Header) -> Result<Self, CrgProblem> {
        let mut format = None;
        let mut channels = Vec::new();
        let mut names = Vec::new();
        let mut sections = Vec::new();
        for definition in &header.definitions {
            let text = definition.text.as_str();
            if let Some(code) = text.strip_prefix("#:") {
                format = Some(parse_format(definition, code)?);
            } else if let Some(name) = text.strip_prefix("D:").or_else(|| text.strip_prefix("d:")) {
                channels.push(parse_channel(definition, name, channels.len(), &mut sections)?);
                names.push(shortened(name.trim()));
            }
        }
        let (notation, packing) = format.ok_or(CrgProblem::NoFormat)?;
        let v_m = lateral_positions(header, &mut sections)?;
        for (i, section) in sections.iter().enumerate() {
            channels[section.column] = Channel::LongSection(i);
        }
        Ok(Self { notation, packing, channels, names, v_m })
    }
}

fn parse_format(definition: &Definition, code: &str) -> Result<(Notation, Packing), CrgProblem> {
    let code = code.trim().to_ascii_uppercase();
    let unknown = || CrgProblem::Format { line: definition.line, found: shortened(&code) };
    let &[packing, precision, notation, b'I'] = code.as_bytes() else { return Err(unknown()) };
    let packing = match packing {
        b'L' => Packing::Records,
        b'K' => Packing::Dense,
        _ => return Err(unknown()),
    };
    let notation = match (precision, notation) {
        (b'R', b'F') => Notation::Text(10),
        (b'D', b'F') => Notation::Text(20),
        (b'R', b'B') => Notation::Single,
        (b'D', b'B') => Notation::Double,
        _ => return Err(unknown()),
    };
    Ok((notation, packing))
}

fn parse_channel(
    definition: &Definition,
    name: &str,
    column: usize,
    sections: &mut Vec<LongSection>,
) -> Result<Channel, CrgProblem> {
    let refuse =
        |expected| CrgProblem::Channel { line: definition.line, found: shortened(name.trim()), expected };
    let lower = name.to_ascii_lowercase();
    let words = lower.split(',').next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ");
    if let Some(which) = words.strip_prefix("long section") {
        let at = match which.trim().strip_prefix("at v") {
            Some(v) => v.trim().strip_prefix('=').and_then(|v| number(v.trim())).map(At::Position),
            None => number(which.trim()).map(At::Number),
        };
        let at = at.ok_or_else(|| refuse("long section N,m, or long section at v = V,m"))?;
        sections.push(LongSection { column, line: definition.line, at });
        return Ok(Channel::Ignored);
    }
    match words.strip_prefix("reference line") {
        None => Ok(Channel::Ignored),
        Some(what) => match what.trim() {
            "phi" | "x" | "y" => Ok(Channel::Ignored),
            "z" => Ok(Channel::Elevation),
            "slope" => Ok(Channel::Slope),
            "banking" => Ok(Channel::Banking),
            "u" => Err(refuse("rows at even distances, given by reference_line_increment")),
            _ => Err(refuse(CHANNELS)),
        },
    }
}

/// The long sections ordered from right to left, and where they lie in m.
fn lateral_positions(header: &Header, sections: &mut [LongSection]) -> Result<Vec<f64>, CrgProblem> {
    let wrong = |found: String, expected| CrgProblem::LongSections { found, expected };
    if sections.len() < 2 {
        return Err(wrong(sections.len().to_string(), "at least 2"));
    }
    let place = |section: &LongSection| match section.at {
        At::Position(v) | At::Number(v) => v,
    };
    let numbered = |section: &LongSection| matches!(section.at, At::Number(_));
    if sections.iter().any(|section| numbered(section) != numbered(&sections[0])) {
        return Err(wrong("numbered and positioned".to_owned(), "all numbered or all at v = V"));
    }
    sections.sort_by(|a, b| place(a).total_cmp(&place(b)));
    if let Some(pair) = sections.windows(2).find(|pair| !(place(&pair[1]) - place(&pair[0]) > 1e-6)) {
        let found = format!(
            "lines {} and {}: the same place {} for two",
            pair[0].line,
            pair[1].line,
            place(&pair[0])
        );
        return Err(wrong(found, "places that differ"));
    }
    if !numbered(&sections[0]) {
        return Ok(sections.iter().map(place).collect());
    }
    let n = sections.len();
    if let Some((i, section)) = sections.iter().enumerate().find(|(i, s)| place(s) != (i + 1) as f64) {
        let found = format!("line {}: number {} at place {} of", section.line, place(section), i + 1);
        return Err(wrong(found, "numbers 1, 2, 3 and so on"));
    }
    even_positions(header, n)
}

/// Positions of `n` numbered sections. Two of right edge, left edge and increment tell the third; with the increment
/// alone the sections lie evenly about the reference line.
fn even_positions(header: &Header, n: usize) -> Result<Vec<f64>, CrgProblem> {
    let road = &header.road;
    let steps = (n - 1) as f64;
    let increment = road.within("long_section_v_increment", "a positive number", |v| v > 0.0)?;
    let (right, left) = (road.get("long_section_v_right"), road.get("long_section_v_left"));
    let (right, increment) = match (right, left, increment) {
        (Some(right), Some(left), None) => (right, (left - right) / steps),
        (Some(right), _, Some(increment)) => (right, increment),
        (None, Some(left), Some(increment)) => (left - steps * increment, increment),
        (None, None, Some(increment)) => (-0.5 * steps * increment, increment),
        _ => {
            let found = format!("{n} numbered");
            return Err(CrgProblem::LongSections { found, expected: "long_section_v_increment with them" });
        }
    };
    let end = right + steps * increment;
    if !(increment > 0.0) || left.is_some_and(|left| !((left - end).abs() < 0.1 * increment)) {
        let found = format!("{n} numbered (from {right} to {} m by {increment} m)", left.unwrap_or(end));
        return Err(CrgProblem::LongSections {
            found,
            expected: "as many as the header's edges and increment ask for",
        });
    }
    Ok((0..n).map(|i| right + i as f64 * increment).collect())
}
