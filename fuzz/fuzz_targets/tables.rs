//! What holds for a drive log as a table of any format, whatever is in it.

use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::signals::Lister;
use itpms_data::LogReader;

#[path = "scratch.rs"]
mod scratch;

/// Reads a log to its end or its error, and lists it.
pub fn read(name: &str, bytes: &[u8]) {
    let path = scratch::file(name, bytes);
    for units in [UnitCheck::Suspicious, UnitCheck::Trusting] {
        match LogReader::open_with(&path, &LogOptions::from(units)) {
            Err(error) => assert!(error.to_string().lines().count() == 1, "{error}"),
            Ok(mut log) => {
                let mut last_s = f64::NEG_INFINITY;
                while let Ok(Some(row)) = log.next_row() {
                    assert!(row.time_s > last_s, "rows are in the order of time");
                    assert!((0.0..=1.0).contains(&log.progress()));
                    last_s = row.time_s;
                }
                log.repairs().warnings().iter().for_each(|warning| assert!(!warning.is_empty()));
            }
        }
    }
    let Ok(mut lister) = Lister::open(&path, None, &[]) else { return };
    while let Ok(true) = lister.step() {}
    let _ = lister.finish();
}
