//! What can be wrong with a table of pulses; read by people as part of a [`Problem`](crate::error::Problem).

use itpms_files::Place;
use thiserror::Error;

/// Why a table of pulses is not used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PulseProblem {
    /// A column that has to be there.
    #[error(
        "found the columns {found}, expected time_s and wheel: {column} is missing{}",
        .nearest.as_ref().map(|name| format!("; the nearest name there is {name}")).unwrap_or_default()
    )]
    NoColumn { column: &'static str, found: String, nearest: Option<String> },
    /// A name that two columns have.
    #[error("two columns are called {0}, expected one")]
    TwoColumns(&'static str),
    /// A row of units that says something else.
    #[error("the unit of time_s is {0:?}, expected s")]
    Unit(String),
    /// Text or nothing where a wheel belongs.
    #[error("{place}, column wheel: found {found}, expected fl, fr, rl or rr")]
    Wheel {
        place: Place,
        /// The cell, quoted, or what it is.
        found: String,
    },
    /// A row that lies further back than rows may.
    #[error(
        "{place}, column time_s: found {time_s} s after the {newest_s} s of {after}, expected the pulses of all wheels in the order of time (sort the table by time_s, or cut it where the clock was set)"
    )]
    Backwards {
        place: Place,
        time_s: f64,
        /// The row with the latest time so far.
        after: Place,
        newest_s: f64,
    },
}
