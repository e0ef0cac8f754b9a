//! How a drive log is to be read: arguments that every command with a log has.

use std::path::{Path, PathBuf};

use itpms_data::log::{LogOptions, Selection, UnitCheck};

#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct LogArgs {
    /// CAN logs (.log, .candump, .asc, .blf, .trc, .mf4 or .csv with frames): what the frames mean.
    #[arg(long, value_name = "CAR.dbc")]
    pub(crate) dbc: Option<PathBuf>,
    /// Which signal, or column of a table with other names or units, is which of our columns. `itpms signals` writes such a map.
    #[arg(long, value_name = "MAP.toml")]
    pub(crate) signals: Option<PathBuf>,
    /// Tables: only rows that have this value in a column, or in a key of a folder's parts (car=A/part-0.parquet).
    #[arg(id = "where", long = "where", value_name = "COLUMN=VALUE")]
    pub(crate) rows: Vec<Selection>,
    /// Take accelerations as m/s^2 and the speed as m/s even if they do not look like it.
    #[arg(long)]
    pub(crate) trust_units: bool,
}

impl LogArgs {
    /// The files it reads, each with what it is.
    pub(crate) fn inputs(&self) -> [(Option<&Path>, &'static str); 2] {
        [(self.dbc.as_deref(), "the DBC file"), (self.signals.as_deref(), "the signal map")]
    }

    /// The same for the reader.
    pub(crate) fn options(&self) -> LogOptions {
        LogOptions {
            units: if self.trust_units { UnitCheck::Trusting } else { UnitCheck::Suspicious },
            dbc: self.dbc.clone(),
            signals: self.signals.clone(),
            rows: self.rows.clone(),
        }
    }
}
