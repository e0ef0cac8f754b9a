//! Lines of `candump` from can-utils, in both forms it has:
//!
//! ```text
//! (1436509052.249713) can0 123#DEADBEEF R          candump -L, -l; the direction only with -x
//!  (1436509052.249713)  can0  RX B -  123  [12]  DE AD ...     on the screen with -ta; columns with -x
//! ```
//!
//! Called by the readers beside it and by whoever reads frames from a pipe; a line knows nothing of the line before.
//!
//! Time stamps of the screen form come in four kinds: `-ta` (since 1970), `-tA` (a date of the logger's local time; taken as UTC), `-tz`
//! (since the first frame) and `-td` (since the frame before). The last two look the same; [`parse_line`] hands out the number that is
//! there, [`FrameReader`](super::FrameReader) finds out which it is and sums differences.

mod format;
mod parse;
mod reader;

pub use format::format_line;
pub(super) use format::push_line;
pub use parse::{Clock, Line, LineProblem, parse_line};
pub(super) use reader::CandumpReader;
