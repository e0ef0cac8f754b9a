//! Descriptions of a bus (DBC files): which frame carries which signals.
//!
//! Files come from many programs and are seldom flawless: what cannot be used is named with its line ([`Dbc::problems`]) and left out, the
//! rest is read. The public crates for the format read a file as a whole or not at all.
//!
//! | module | idea |
//! |---|---|
//! | `cursor` | words |
//! | `statement` | how statements are written |
//! | `build`, `draft` | statements to messages |
//! | `bits` | where a signal's bits are |
//! | `message` | bytes to physical values and back |
//! | `missing` | which raw values are none |
//! | `problem` | what can be wrong |

mod bits;
mod build;
mod cursor;
mod draft;
mod find_missing;
mod message;
mod missing;
pub(crate) mod problem;
mod statement;

use std::collections::HashMap;
use std::path::Path;

pub use bits::{ByteOrder, Layout};
pub use message::{EncodeError, Kind, Message, Selector, Signal};
pub use missing::NoValue;
pub use problem::{DbcError, DbcProblem, Fault};

use itpms_files::input;

use crate::CanId;
use crate::error::{CanError, CanProblem};
use build::Builder;

/// Files are read into memory; the largest in use have some 10 MB.
pub const LARGEST: u64 = 1 << 26;

/// A description of a bus.
#[derive(Debug, Clone, PartialEq)]
pub struct Dbc {
    messages: Vec<Message>,
    places: HashMap<CanId, usize>,
    /// Messages of SAE J1939 by their parameter group; `None` where two have the same.
    groups: HashMap<u32, Option<usize>>,
    problems: Vec<DbcProblem>,
}

impl Dbc {
    /// Reads a file in UTF-8 or code page 1252.
    ///
    /// # Errors
    /// The file cannot be read, is larger than 64 MiB, or has no message with a usable signal.
    pub fn read(path: &Path) -> Result<Self, CanError> {
        let bytes =
            input::read(path, LARGEST, "a DBC file").map_err(|problem| CanError::new(path, problem))?;
        Self::from_bytes(&bytes).map_err(|error| CanError::new(path, CanProblem::Dbc(error)))
    }

    /// The same for a file's contents.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DbcError> {
        Self::parse(&itpms_files::decoded(bytes))
    }

    /// The same for a file's text.
    pub fn parse(text: &str) -> Result<Self, DbcError> {
        if text.len() as u64 > 2 * LARGEST {
            return Err(DbcError::TooLarge { found: text.len() as u64, most: LARGEST });
        }
        let mut builder = Builder::default();
        let (mut statements, mut faults) = (Vec::new(), Vec::new());
        let lines = statement::statements(
            text,
            |line, statement| statements.push((line, statement)),
            |line, fault| faults.push((line, fault)),
        );
        faults.into_iter().for_each(|(line, fault)| builder.problems.add(line, fault));
        statements.into_iter().for_each(|(line, statement)| builder.add(line, statement));
        let (messages, problems) = builder.finish();
        let problems = problems.finish();
        if messages.iter().all(|message| message.signals.is_empty()) {
            let problem = problems.first().cloned().map(Box::new);
            return Err(DbcError::NoMessage { lines, problem });
        }
        let places = messages.iter().enumerate().map(|(place, message)| (message.id, place)).collect();
        let mut groups = HashMap::new();
        for (place, message) in messages.iter().enumerate().filter(|(_, message)| message.j1939) {
            groups.entry(message.id.parameter_group()).and_modify(|only| *only = None).or_insert(Some(place));
        }
        Ok(Self { messages, places, groups, problems })
    }

    /// The problems of the file, by line; what they concern was left out unless they say otherwise.
    #[must_use]
    pub fn problems(&self) -> &[DbcProblem] {
        &self.problems
    }

    /// The messages, in the file's order.
    #[must_use]
    pub fn messages(&self) -> &[Message] {
        &self.messages
    }

    /// The message with this identifier; on SAE J1939 that of its parameter group, whoever sends it.
    #[must_use]
    pub fn message(&self, id: CanId) -> Option<&Message> {
        let of_group = || {
            let extended = Some(id).filter(|id| id.is_extended() && !self.groups.is_empty())?;
            *self.groups.get(&extended.parameter_group())?
        };
        self.messages.get(self.places.get(&id).copied().or_else(of_group)?)
    }
}
