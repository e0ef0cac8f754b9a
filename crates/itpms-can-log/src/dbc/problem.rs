//! Problems of a DBC file. Most of them cost one signal or one remark; only a file without any message is refused.
//!
//! Made by the modules beside it; read by people.

use std::fmt;

use thiserror::Error;

/// Why a file is refused as a whole.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum DbcError {
    #[error("the file has {found} bytes, expected a DBC file of at most {most}")]
    TooLarge { found: u64, most: u64 },
    #[error("no message with a usable signal in {lines} lines, expected a DBC file (BO_ and SG_){}", first(.problem))]
    NoMessage { lines: u64, problem: Option<Box<DbcProblem>> },
}

fn first(problem: &Option<Box<DbcProblem>>) -> String {
    problem.as_ref().map(|problem| format!("; {problem}")).unwrap_or_default()
}

/// Something wrong, not fatal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DbcProblem {
    /// Line of the file, from one.
    pub line: u64,
    /// What.
    pub fault: Fault,
}

impl fmt::Display for DbcProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.fault)
    }
}

/// Kinds of problems.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Fault {
    #[error("found {found:?}, expected a statement such as BO_ or SG_; passed over")]
    Stranger { found: String },
    #[error("{statement}: found {found}, expected {expected}; left out")]
    Syntax { statement: &'static str, found: String, expected: &'static str },
    #[error("signal {signal} before any message (BO_); left out")]
    Homeless { signal: String },
    #[error(
        "message {message} has identifier {id}, expected at most 2047, or with bit 31 set at most 29 bits more; \
         left out"
    )]
    Identifier { message: String, id: u64 },
    #[error("message {message} has {bytes} bytes, expected at most 64; left out")]
    TooLong { message: String, bytes: u64 },
    #[error("message {message} has the identifier of {first} (line {first_line}); left out")]
    MessageTwice { message: String, first: String, first_line: u64 },
    #[error("message {message} has a second signal {signal} (first in line {first_line}); left out")]
    SignalTwice { message: String, signal: String, first_line: u64 },
    #[error("message {message} has more than {most} signals; the rest is left out")]
    TooMany { message: String, most: usize },
    #[error("message {message}, signal {signal}: {bits} bits, expected 1 to 64; left out")]
    Length { message: String, signal: String, bits: u64 },
    #[error(
        "message {message}, signal {signal}: {bits} bits from bit {start} on do not lie within the message's {bytes} \
         bytes; left out"
    )]
    Outside { message: String, signal: String, start: u64, bits: u64, bytes: usize },
    #[error("message {message}, signal {signal}: the factor is 0, expected another number; left out")]
    Factor { message: String, signal: String },
    #[error("message {message}, signal {signal}: a float of {bits} bits, expected {expected}; left out")]
    FloatLength { message: String, signal: String, bits: u16, expected: u16 },
    #[error("message {message}, signal {signal}: its multiplexer {} is not there; left out", .switch.as_deref().unwrap_or("(M)"))]
    NoSwitch { message: String, signal: String, switch: Option<String> },
    #[error(
        "message {message}, signal {signal}: {count} multiplexers and no SG_MUL_VAL_ that says which; left out"
    )]
    WhichSwitch { message: String, signal: String, count: usize },
    #[error("message {message}, signal {signal}: its multiplexers select each other; left out")]
    SwitchLoop { message: String, signal: String },
    #[error("message {message}: signal {signal} overlaps {other} (line {other_line}); both are kept")]
    Overlap { message: String, signal: String, other: String, other_line: u64 },
    #[error("message {message}: there are too many signals to look for overlaps; they are kept")]
    NotCompared { message: String },
    #[error("{statement} speaks of signal {signal} of message {id}, which is not there; passed over")]
    NobodyThere { statement: &'static str, signal: String, id: u64 },
    #[error("{0} more like these")]
    More(u64),
}

/// The problems of a file, the first of them in full.
#[derive(Debug, Default)]
pub(super) struct Problems(Vec<DbcProblem>);

const LISTED: usize = 200;

impl Problems {
    pub(super) fn add(&mut self, line: u64, fault: Fault) {
        if self.0.len() < LISTED {
            self.0.push(DbcProblem { line, fault });
        } else if let Some(DbcProblem { fault: Fault::More(count), .. }) = self.0.last_mut() {
            *count += 1;
        } else {
            self.0.push(DbcProblem { line, fault: Fault::More(1) });
        }
    }

    pub(super) fn finish(self) -> Vec<DbcProblem> {
        let mut problems = self.0;
        problems.sort_by_key(|problem| (matches!(problem.fault, Fault::More(_)), problem.line));
        problems
    }
}
