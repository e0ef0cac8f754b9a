//! The statements of a DBC file, one after the other. What cannot be read is named and passed over, up to its line's
//! end; nothing that follows is lost.
//!
//! Called by the builder. Knows how statements are written, not whether they make sense together. The format is
//! Vector's *DBC File Format Documentation* 1.0.5; section names below are its.

use super::cursor::{Astray, Cursor};
use super::problem::Fault;

/// The statements of a file that matter here.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Statement {
    /// `BO_`.
    Message { id: u64, name: String, bytes: u64, sender: String },
    /// `SG_`.
    Signal(RawSignal),
    /// `SG_MUL_VAL_` (extended multiplexing).
    Selector { id: u64, signal: String, switch: String, ranges: Vec<(u64, u64)> },
    /// `SIG_VALTYPE_`: 1 and 2 are floats of 32 and 64 bits.
    ValueType { id: u64, signal: String, kind: u64 },
    /// `VAL_`.
    Labels { id: u64, signal: String, labels: Vec<(i64, String)> },
    /// `CM_` of a message or a signal.
    Comment { id: u64, signal: Option<String>, text: String },
    /// `BA_DEF_` of an enumeration.
    Enumeration { name: String, values: Vec<String> },
    /// `BA_DEF_DEF_`.
    Default { name: String, value: String },
    /// `BA_` of a message, or of one of its signals.
    Attribute { name: String, id: u64, signal: Option<String>, value: String },
    /// `BA_` of the whole bus.
    OfTheBus { name: String, value: String },
}

/// `SG_` as it is written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RawSignal {
    pub(super) name: String,
    pub(super) multiplexing: Multiplexing,
    pub(super) start: u64,
    pub(super) bits: u64,
    pub(super) little_endian: bool,
    pub(super) signed: bool,
    pub(super) factor: f64,
    pub(super) offset: f64,
    pub(super) min: f64,
    pub(super) max: f64,
    pub(super) unit: String,
    pub(super) receivers: Vec<String>,
}

/// `M`, `m3`, `m3M` or nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Multiplexing {
    pub(super) switch: bool,
    pub(super) selected_by: Option<u64>,
}

const READ: [&str; 10] =
    ["BO_", "SG_", "SG_MUL_VAL_", "SIG_VALTYPE_", "VAL_", "CM_", "BA_DEF_", "BA_DEF_DEF_", "BA_", "VERSION"];
/// Begins a statement that ends with a semicolon and does not matter here.
const SKIPPED: [&str; 22] = [
    "VAL_TABLE_",
    "BO_TX_BU_",
    "EV_",
    "ENVVAR_DATA_",
    "EV_DATA_",
    "SGTYPE_",
    "SGTYPE_VAL_",
    "BA_DEF_SGTYPE_",
    "BA_SGTYPE_",
    "SIG_TYPE_REF_",
    "SIG_GROUP_",
    "SIGTYPE_VALTYPE_",
    "CAT_DEF_",
    "CAT_",
    "FILTER",
    "BA_DEF_REL_",
    "BA_REL_",
    "BA_DEF_DEF_REL_",
    "BU_SG_REL_",
    "BU_EV_REL_",
    "BU_BO_REL_",
    "NS_DESC_",
];
/// Begins something else.
const OTHERS: [&str; 3] = ["NS_", "BS_", "BU_"];

fn keyword(word: &str) -> Option<&'static str> {
    READ.iter().chain(&SKIPPED).chain(&OTHERS).find(|keyword| **keyword == word).copied()
}

/// So much text is gone back over after statements that went astray; more is no slip of an editor.
const MOST_READ_TWICE: usize = 1 << 22;

/// Hands every statement to `found` and everything unreadable to `fault`, with its line.
pub(super) fn statements(
    text: &str,
    mut found: impl FnMut(u64, Statement),
    mut fault: impl FnMut(u64, Fault),
) -> u64 {
    let mut at = Cursor::new(text);
    let mut read_twice = 0;
    while at.skip_blanks() {
        let start = at;
        match next(&mut at) {
            Ok(Some(statement)) => found(start.line, statement),
            Ok(None) => {}
            Err(problem) => {
                fault(start.line, problem);
                read_twice += at.bytes_since(&start);
                if read_twice <= MOST_READ_TWICE {
                    at = start;
                }
                at.line_rest();
            }
        }
    }
    at.line
}

fn next(at: &mut Cursor<'_>) -> Result<Option<Statement>, Fault> {
    let beginning = at.beginning();
    let Some(keyword) = keyword(at.peek()) else { return Err(Fault::Stranger { found: beginning }) };
    // Alone in its line it is one of those that NS_ lists.
    let mut line = *at;
    if line.line_rest().trim() == keyword {
        at.line_rest();
        return Ok(None);
    }
    let statement = at.word("a keyword").and_then(|_| match keyword {
        "BO_" => message(at).map(Some),
        "SG_" => signal(at).map(|signal| Some(Statement::Signal(signal))),
        "SG_MUL_VAL_" => selector(at).map(Some),
        "SIG_VALTYPE_" => value_type(at).map(Some),
        "VAL_" => labels(at),
        "CM_" => comment(at),
        "BA_DEF_" => enumeration(at),
        "BA_DEF_DEF_" => default(at).map(Some),
        "BA_" => attribute(at),
        "VERSION" => at.string("the version in quotes").map(|_| None),
        "NS_" | "BS_" => {
            at.line_rest();
            Ok(None)
        }
        "BU_" => {
            skip_nodes(at);
            Ok(None)
        }
        _ => skip(at).map(|()| None),
    });
    statement.map_err(|Astray { found, expected }| Fault::Syntax { statement: keyword, found, expected })
}

/// `BO_ 291 Name: 8 Sender`.
fn message(at: &mut Cursor<'_>) -> Result<Statement, Astray> {
    let id = at.integer("an identifier")?;
    let name = at.word("the message's name")?.to_owned();
    at.sign(':', "a colon after the message's name")?;
    let bytes = at.integer("the number of bytes")?;
    let sender = at.line_rest().trim().to_owned();
    Ok(Statement::Message { id, name, bytes, sender })
}

/// `SG_ Name m0M : 7|16@0+ (0.01,0) [0|655.35] "km/h" A,B`.
fn signal(at: &mut Cursor<'_>) -> Result<RawSignal, Astray> {
    let name = at.word("the signal's name")?.to_owned();
    let multiplexing = if at.takes(':') { Multiplexing::default() } else { multiplexing(at)? };
    let start = at.integer("the first bit")?;
    at.sign('|', "a bar after the first bit")?;
    let bits = at.integer("the number of bits")?;
    at.sign('@', "an @ after the number of bits")?;
    let format = match at.peek() {
        "1+" => (true, false),
        "1-" => (true, true),
        "0+" => (false, false),
        "0-" => (false, true),
        _ => return Err(at.astray("1+, 1-, 0+ or 0- (byte order and sign)")),
    };
    at.word("byte order and sign")?;
    at.sign('(', "factor and offset in parentheses")?;
    let factor = at.number("a finite factor")?;
    at.sign(',', "a comma between factor and offset")?;
    let offset = at.number("a finite offset")?;
    at.sign(')', "a parenthesis after the offset")?;
    at.sign('[', "the range in brackets")?;
    let min = at.number("a finite minimum")?;
    at.sign('|', "a bar between minimum and maximum")?;
    let max = at.number("a finite maximum")?;
    at.sign(']', "a bracket after the maximum")?;
    let unit = unit(at)?;
    let listed = at.line_rest();
    let receivers = listed.split(|c: char| c == ',' || c.is_whitespace()).filter(|name| !name.is_empty());
    Ok(RawSignal {
        name,
        multiplexing,
        start,
        bits,
        little_endian: format.0,
        signed: format.1,
        factor,
        offset,
        min,
        max,
        unit,
        receivers: receivers.map(str::to_owned).collect(),
    })
}

/// A unit ends in its line: a quote that is missing must not swallow the signals that follow.
fn unit(at: &mut Cursor<'_>) -> Result<String, Astray> {
    let before = at.line;
    let unit = at.string("the unit in quotes")?;
    if at.line == before {
        Ok(unit)
    } else {
        Err(Astray { found: "no end of the unit".to_owned(), expected: "a quote" })
    }
}

fn multiplexing(at: &mut Cursor<'_>) -> Result<Multiplexing, Astray> {
    const EXPECTED: &str = "a colon, or M, m0 or m0M and a colon";
    let word = at.peek();
    let multiplexing = match (word, word.strip_prefix('m')) {
        ("M", _) => Multiplexing { switch: true, selected_by: None },
        (_, Some(rest)) => {
            let (number, switch) = rest.strip_suffix('M').map_or((rest, false), |number| (number, true));
            let value = number.parse().map_err(|_| at.astray(EXPECTED))?;
            Multiplexing { switch, selected_by: Some(value) }
        }
        _ => return Err(at.astray(EXPECTED)),
    };
    at.word(EXPECTED)?;
    at.sign(':', EXPECTED)?;
    Ok(multiplexing)
}

/// `SG_MUL_VAL_ 291 Signal Switch 0-3, 7-7;`
fn selector(at: &mut Cursor<'_>) -> Result<Statement, Astray> {
    const RANGE: &str = "a range such as 0-3";
    let id = at.integer("an identifier")?;
    let signal = at.word("a signal's name")?.to_owned();
    let switch = at.word("the multiplexer's name")?.to_owned();
    let mut ranges = Vec::new();
    loop {
        let word = at.peek();
        let ends = word.split_once('-').and_then(|(low, high)| Some((low.parse().ok()?, high.parse().ok()?)));
        ranges.push(ends.filter(|(low, high): &(u64, u64)| low <= high).ok_or_else(|| at.astray(RANGE))?);
        at.word(RANGE)?;
        if at.takes(';') {
            return Ok(Statement::Selector { id, signal, switch, ranges });
        }
        // The comma is there in Vector's files and missing in some others'.
        at.takes(',');
    }
}

/// `SIG_VALTYPE_ 291 Signal : 1;`
fn value_type(at: &mut Cursor<'_>) -> Result<Statement, Astray> {
    let id = at.integer("an identifier")?;
    let signal = at.word("a signal's name")?.to_owned();
    at.takes(':');
    let kind = at.integer("0, 1, 2 or 3")?;
    at.sign(';', "a semicolon")?;
    Ok(Statement::ValueType { id, signal, kind })
}

/// `VAL_ 291 Signal 0 "off" 1 "on" ;`, or of an environment variable, which has no identifier.
fn labels(at: &mut Cursor<'_>) -> Result<Option<Statement>, Astray> {
    let Ok(id) = at.integer("an identifier") else { return skip(at).map(|()| None) };
    let signal = at.word("a signal's name")?.to_owned();
    let mut labels = Vec::new();
    while !at.takes(';') {
        // Some programs write whole numbers as floats; a table's name stands here in others' files.
        let Ok(value) = at.number("a value or a semicolon") else { return skip(at).map(|()| None) };
        labels.push((value as i64, at.string("a description in quotes")?));
    }
    Ok(Some(Statement::Labels { id, signal, labels }))
}

/// `CM_ SG_ 291 Signal "text";`, `CM_ BO_ 291 "text";`; others are passed over.
fn comment(at: &mut Cursor<'_>) -> Result<Option<Statement>, Astray> {
    let of = at.peek();
    if !matches!(of, "SG_" | "BO_") {
        return skip(at).map(|()| None);
    }
    at.word("SG_ or BO_")?;
    let id = at.integer("an identifier")?;
    let signal = if of == "SG_" { Some(at.word("a signal's name")?.to_owned()) } else { None };
    let text = at.string("the comment in quotes")?;
    at.sign(';', "a semicolon after the comment")?;
    Ok(Some(Statement::Comment { id, signal, text }))
}

/// `BA_DEF_ BO_ "Name" ENUM "a","b";`; other types are passed over.
fn enumeration(at: &mut Cursor<'_>) -> Result<Option<Statement>, Astray> {
    if !at.peek().is_empty() {
        at.word("what it is an attribute of")?;
    }
    let name = at.string("the attribute's name in quotes")?;
    if at.peek() != "ENUM" {
        return skip(at).map(|()| None);
    }
    at.word("ENUM")?;
    let mut values = Vec::new();
    loop {
        values.push(at.string("a value in quotes")?);
        if at.takes(';') {
            return Ok(Some(Statement::Enumeration { name, values }));
        }
        at.takes(',');
    }
}

/// `BA_DEF_DEF_ "Name" 10;`
fn default(at: &mut Cursor<'_>) -> Result<Statement, Astray> {
    let name = at.string("the attribute's name in quotes")?;
    let value = value(at)?;
    Ok(Statement::Default { name, value })
}

/// `BA_ "Name" BO_ 291 10;`, `BA_ "Name" SG_ 291 Signal "text";`, `BA_ "Name" "text";`; attributes of nodes and of environment
/// variables are passed over.
fn attribute(at: &mut Cursor<'_>) -> Result<Option<Statement>, Astray> {
    let name = at.string("the attribute's name in quotes")?;
    let of = at.peek();
    match of {
        "BO_" | "SG_" => {
            at.word("BO_ or SG_")?;
            let id = at.integer("an identifier")?;
            let signal = if of == "SG_" { Some(at.word("a signal's name")?.to_owned()) } else { None };
            let value = value(at)?;
            Ok(Some(Statement::Attribute { name, id, signal, value }))
        }
        "BU_" | "EV_" => skip(at).map(|()| None),
        _ => Ok(Some(Statement::OfTheBus { name, value: value(at)? })),
    }
}

/// A number or a string, and the semicolon after it.
fn value(at: &mut Cursor<'_>) -> Result<String, Astray> {
    let value = match at.peek() {
        "" => at.string("a value")?,
        word => {
            at.word("a value")?;
            word.to_owned()
        }
    };
    at.sign(';', "a semicolon")?;
    Ok(value)
}

/// `BU_: A B C`, over several lines if need be.
fn skip_nodes(at: &mut Cursor<'_>) {
    at.takes(':');
    while !at.peek().is_empty() && keyword(at.peek()).is_none() {
        at.skip_word();
    }
}

/// Goes past the semicolon that ends this statement, or up to the next one where it has none.
fn skip(at: &mut Cursor<'_>) -> Result<(), Astray> {
    let mut line = at.line;
    while at.skip_blanks() {
        let word = at.peek();
        if at.line > line && keyword(word).is_some() {
            return Ok(());
        }
        line = at.line;
        if at.takes(';') {
            return Ok(());
        } else if !word.is_empty() {
            at.skip_word();
        } else if at.is_at('"') {
            at.string("a string")?;
        } else {
            at.skip_character();
        }
    }
    Ok(())
}
