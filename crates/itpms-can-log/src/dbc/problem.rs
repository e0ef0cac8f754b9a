//! What is wrong in a DBC file. Most of it costs one signal or one remark; only a file without any message is refused.
//!
//! Made by the modules beside it; read by people.

use std::fmt;

use thiserror::Error;

/// Why a file is refused as a whole.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DbcError {
    /// Larger than any description of a bus.
    #[error("the file has {found} bytes, expected a DBC file of at most {most}")]
    TooLarge {
        /// Its size.
        found: u64,
        /// The limit.
        most: u64,
    },
    /// Nothing that could be decoded.
    #[error("no message with a usable signal in {lines} lines, expected a DBC file (BO_ and SG_){}", first(.problem))]
    NoMessage {
        /// Lines of the file.
        lines: u64,
        /// The first thing that is wrong with it.
        problem: Option<Box<DbcProblem>>,
    },
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

/// What can be wrong.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Fault {
    /// A line that begins with nothing known.
    #[error("found {found:?}, expected a statement such as BO_ or SG_; passed over")]
    Stranger {
        /// The line's beginning.
        found: String,
    },
    /// A statement that breaks off or goes astray.
    #[error("{statement}: found {found}, expected {expected}; left out")]
    Syntax {
        /// Its keyword.
        statement: &'static str,
        /// What is there instead.
        found: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// A signal without a message.
    #[error("signal {signal} before any message (BO_); left out")]
    Homeless {
        /// The signal.
        signal: String,
    },
    /// An identifier that is neither of 11 nor, with bit 31, of 29 bits.
    #[error(
        "message {message} has identifier {id}, expected at most 2047, or with bit 31 set at most 29 bits more; \
         left out"
    )]
    Identifier {
        /// The message.
        message: String,
        /// As written.
        id: u64,
    },
    /// Longer than a frame.
    #[error("message {message} has {bytes} bytes, expected at most 64; left out")]
    TooLong {
        /// The message.
        message: String,
        /// As written.
        bytes: u64,
    },
    /// An identifier that is there twice.
    #[error("message {message} has the identifier of {first} (line {first_line}); left out")]
    MessageTwice {
        /// The message.
        message: String,
        /// The one before.
        first: String,
        /// Where that is.
        first_line: u64,
    },
    /// A name that is there twice in a message.
    #[error("message {message} has a second signal {signal} (first in line {first_line}); left out")]
    SignalTwice {
        /// The message.
        message: String,
        /// The signal.
        signal: String,
        /// Where the first is.
        first_line: u64,
    },
    /// More signals than are looked at.
    #[error("message {message} has more than {most} signals; the rest is left out")]
    TooMany {
        /// The message.
        message: String,
        /// The limit.
        most: usize,
    },
    /// A signal of no bits or of more than a number holds.
    #[error("message {message}, signal {signal}: {bits} bits, expected 1 to 64; left out")]
    Length {
        /// The message.
        message: String,
        /// The signal.
        signal: String,
        /// As written.
        bits: u64,
    },
    /// A signal that its message has no room for.
    #[error(
        "message {message}, signal {signal}: {bits} bits from bit {start} on do not lie within the message's {bytes} \
         bytes; left out"
    )]
    Outside {
        /// The message.
        message: String,
        /// The signal.
        signal: String,
        /// Its first bit as written.
        start: u64,
        /// Its length.
        bits: u64,
        /// Bytes of the message.
        bytes: usize,
    },
    /// A factor of zero.
    #[error("message {message}, signal {signal}: the factor is 0, expected another number; left out")]
    Factor {
        /// The message.
        message: String,
        /// The signal.
        signal: String,
    },
    /// A float that has not the length of one.
    #[error("message {message}, signal {signal}: a float of {bits} bits, expected {expected}; left out")]
    FloatLength {
        /// The message.
        message: String,
        /// The signal.
        signal: String,
        /// Its length.
        bits: u16,
        /// 32 or 64.
        expected: u16,
    },
    /// A multiplexed signal whose multiplexer is not there.
    #[error("message {message}, signal {signal}: its multiplexer {} is not there; left out", or_unnamed(.switch))]
    NoSwitch {
        /// The message.
        message: String,
        /// The signal.
        signal: String,
        /// The multiplexer's name, where one is given.
        switch: Option<String>,
    },
    /// A multiplexed signal that could have several multiplexers.
    #[error(
        "message {message}, signal {signal}: {count} multiplexers and no SG_MUL_VAL_ that says which; left out"
    )]
    WhichSwitch {
        /// The message.
        message: String,
        /// The signal.
        signal: String,
        /// How many there are.
        count: usize,
    },
    /// Multiplexers that select each other.
    #[error("message {message}, signal {signal}: its multiplexers select each other; left out")]
    SwitchLoop {
        /// The message.
        message: String,
        /// The signal.
        signal: String,
    },
    /// Two signals in the same bits at the same time.
    #[error("message {message}: signal {signal} overlaps {other} (line {other_line}); both are kept")]
    Overlap {
        /// The message.
        message: String,
        /// The later one.
        signal: String,
        /// The earlier one.
        other: String,
        /// Where that is.
        other_line: u64,
    },
    /// So many signals in the file that not all are held against each other.
    #[error("message {message}: there are too many signals to look for overlaps; they are kept")]
    NotCompared {
        /// The message.
        message: String,
    },
    /// A statement about a signal that is not there.
    #[error("{statement} speaks of signal {signal} of message {id}, which is not there; passed over")]
    NobodyThere {
        /// Its keyword.
        statement: &'static str,
        /// The signal.
        signal: String,
        /// The message's identifier as written.
        id: u64,
    },
    /// Too many more to be read.
    #[error("{0} more like these")]
    More(u64),
}

fn or_unnamed(name: &Option<String>) -> &str {
    name.as_deref().unwrap_or("(M)")
}

/// The problems of a file, the first of them in full.
#[derive(Debug, Default)]
pub(super) struct Problems(Vec<DbcProblem>);

/// Listed one by one.
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

    /// By their lines.
    pub(super) fn finish(self) -> Vec<DbcProblem> {
        let mut problems = self.0;
        problems.sort_by_key(|problem| (matches!(problem.fault, Fault::More(_)), problem.line));
        problems
    }
}
