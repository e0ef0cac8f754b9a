//! Vector's ASC: a log as text, written by CANoe, CANalyzer and python-can.
//!
//! ```text
//! date Fri Nov 20 05:17:33.000 pm 2026
//! base hex  timestamps absolute
//! internal events logged
//! Begin TriggerBlock Fri Nov 20 05:17:33.000 pm 2026
//!    0.250000 1  123             Rx   d 4 DE AD BE EF
//!    0.250100 CANFD   1 Rx        123                                   1 0 9 12 DE AD ...
//! End TriggerBlock
//! ```
//!
//! Called by `FrameReader` and `FrameWriter`. After Vector's description of the format (CAN, log & trigger events,
//! version 1.4) and what the programs write.
//!
//! Times: the date of the header, or of a trigger block before the first frame, plus the stamp. The format does not
//! name a time zone; the date is taken as UTC. A later block's date counts only where the stamps begin again.

mod date;
mod parse;
mod reader;
mod writer;

pub(super) use reader::AscReader;
pub(super) use writer::AscWriter;
