//! Drive logs in: one reader for CSV, Parquet, MDF4, MCAP and CAN logs that hands out clean rows, repairs what can be repaired, counts
//! what it did, and refuses the rest in one sentence.
//!
//! | column | meaning |
//! |---|---|
//! | `time_s` | strictly increasing, uniform or jittered |
//! | `speed_m_s` | vehicle speed, optional |
//! | `{c}_body_accel_m_s2`, `{c}_wheel_accel_m_s2` | sprung and unsprung acceleration, up; `c` in `fl fr rl rr` |
//! | `{c}_pressure_kpa`, `{c}_road_m` | truth, optional |
//! | `{c}_wheel_speed_m_s` or `{c}_wheel_speed_rad_s` | speed of each wheel, of all four or none |
//! | `{c}_tpms_kpa`, `{c}_tpms_c` | the car's own tire sensors, sparse, optional |
//! | `ambient_temperature_c`, `barometric_kpa` or `altitude_m` | the air around the car, sparse, optional |
//! | `latitude_deg`, `longitude_deg` | where the car is, sparse, optional; written nowhere unless asked for |
//! | `yaw_rate_rad_s`, `accel_x_m_s2`, `accel_y_m_s2`, `brake` | how the car moves, optional: left and forward positive |
//!
//! Both accelerations of one corner, or the speeds of all four wheels, make a log.
//!
//! In a table the columns have these names, or a map says which is which. The signals of MDF4 and CAN logs are found by their names or by a map, and
//! put into rows by the [aligner](crate::signals::align).
//!
//! An empty cell, `NaN`, `null` or a null is a missing sample, and rows keep their own times: rates, jitter and gaps are the estimator's
//! business. Where some columns are hardly ever filled in the same row, a row is a message; where an acceleration is empty at even
//! distances, it has a rate of its own. Such a table is aligned as a bus is. Memory is bounded: the first [`SURVEY_ROWS`] rows, some ten
//! seconds in which rows are put into the order of their times (`stamps`), and one batch, whatever the length.
//!
//! Called by the commands of the binary and by the live monitor; knows nothing of estimators and of simulation.

mod around;
#[cfg(feature = "can")]
mod bus;
#[cfg(feature = "can")]
mod can_feed;
mod clock;
mod clock_text;
mod csv_source;
mod dialect;
#[cfg(feature = "can")]
mod echoes;
mod elsewhere;
mod feed;
#[cfg(feature = "can")]
mod first_frames;
mod format;
mod header;
mod held;
mod left_out;
mod lines;
mod mapped;
#[cfg(feature = "mcap")]
mod mcap_feed;
#[cfg(feature = "mdf4")]
mod mdf4_feed;
mod memory_source;
mod mixed;
mod open;
mod options;
mod order;
mod packed;
#[cfg(feature = "parquet")]
mod parquet_source;
mod quantity;
mod reader;
mod regular;
mod repair;
mod row;
mod selection;
mod signal_order;
mod signal_source;
mod slot;
mod slow_speed;
mod source;
mod stamps;
mod stand_in;
mod survey;
mod table;
mod table_format;
mod telling;
mod text_head;
mod twins;
mod units;
mod vbox;
mod wide;

pub use around::{AirColumns, AirField, AxleField, PositionColumns, PositionField};
#[cfg(feature = "can")]
pub(crate) use bus::attached;
#[cfg(feature = "can")]
pub use bus::{frame_description, holds_frames};
#[cfg(feature = "can")]
pub use can_feed::frame_decoder;
pub(crate) use clock::Clock;
pub(crate) use clock_text::seconds as clock_seconds;
pub(crate) use dialect::{cells, number};
#[cfg(feature = "can")]
pub(crate) use elsewhere::of_description;
pub(crate) use format::{Format, LogFormat};
pub(crate) use header::separator;
pub(crate) use itpms_files::shortened;
pub(crate) use lines::Lines;
pub use memory_source::{Piece, Pieces};
pub use options::LogOptions;
pub(crate) use quantity::Quantity;
pub use reader::LogReader;
pub use repair::RepairReport;
pub use row::{CornerColumns, LogColumns, LogCorner, LogMotion, LogRow, MotionColumns};
pub use selection::Selection;
pub use slot::{Field, Motion, SLOTS, Slot};
pub use survey::{SURVEY_ROWS, Survey};
pub(crate) use text_head::TextHead;
pub use units::{UnitCheck, check as check_units};
