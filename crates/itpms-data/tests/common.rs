//! A folder of one test, and logs read to their end.
#![allow(dead_code, reason = "features decide which tests there are")]

use std::fs;
use std::path::{Path, PathBuf};

use itpms_data::log::{LogColumns, LogOptions, UnitCheck};
use itpms_data::out::LogWriter;
use itpms_data::signals::{Lister, Listing};
use itpms_data::{LogReader, LogRow};

/// A folder that goes away with its test.
pub(crate) struct Bench(tempfile::TempDir);

impl Bench {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, content).unwrap();
        path
    }
}

/// The rows of a log, and the remarks on it.
pub(crate) struct Found {
    pub(crate) rows: Vec<LogRow>,
    pub(crate) warnings: Vec<String>,
    pub(crate) remarks: Vec<String>,
    pub(crate) mapping: Vec<String>,
}

pub(crate) fn found(path: &Path, options: &LogOptions) -> Result<Found, String> {
    let mut log = LogReader::open_with(path, options).map_err(|error| error.to_string())?;
    let rows = log.by_ref().collect::<Result<_, _>>().map_err(|error| error.to_string())?;
    let (warnings, remarks) = (log.repairs().warnings(), log.remarks());
    Ok(Found { rows, warnings, remarks, mapping: log.mapping().to_vec() })
}

/// Rows and warnings of a log whose units are what they are taken for.
pub(crate) fn read(path: &Path) -> Result<(Vec<LogRow>, Vec<String>), String> {
    found(path, &UnitCheck::Trusting.into()).map(|found| (found.rows, found.warnings))
}

pub(crate) fn listed(path: &Path) -> Listing {
    let mut lister = Lister::open(path, None, &[]).unwrap();
    while lister.step().unwrap() {}
    lister.finish()
}

pub(crate) fn write_log(path: &Path, columns: LogColumns, rows: &[LogRow]) {
    let mut writer = LogWriter::create(path, columns).unwrap();
    rows.iter().for_each(|row| writer.write(row).unwrap());
    writer.finish().unwrap().commit().unwrap();
}
