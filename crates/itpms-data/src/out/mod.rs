//! Files out, by extension: estimates and roads as CSV or Parquet, drive logs also as MDF4 and MCAP.
//!
//! Called by the commands of the binary. Rows go out as they come, in bounded memory. A file appears under its name
//! only when it is complete: every writer ends in [`AtomicFile::commit`], and one that is dropped before leaves
//! nothing behind. The exception is a [`Ledger`], which grows line by line.

mod alerts;
mod cell;
mod csv_table;
mod drive_log;
mod ledger;
#[cfg(feature = "can")]
mod log_frames;
#[cfg(feature = "mcap")]
pub mod mcap;
#[cfg(feature = "parquet")]
mod parquet_table;
mod rate;
mod results;
mod state;
mod table;
mod wheel_speeds;

pub use alerts::{alert_object, transition_object};
pub use cell::{Cell, Kind};
pub use drive_log::{LogWriter, Packing};
pub use itpms_files::{AtomicFile, NameLock, NewFolder, abandon_all};
pub use ledger::Ledger;
pub use rate::RateGate;
pub use results::{COLD_COLUMNS, EstimateRow, EstimateWriter, RoadPoint, RoadWriter, cold_values};
pub use state::{States, state_label};
pub use table::Table;
pub use wheel_speeds::{RadiusRow, WheelSpeedUse};
