//! A CAN log of any bytes read by a DBC file of any bytes, which stands before the first zero byte.
#![no_main]

use itpms_data::LogReader;
use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::signals::Lister;
use libfuzzer_sys::fuzz_target;

mod scratch;

fuzz_target!(|bytes: &[u8]| {
    let Some(zero) = bytes.iter().position(|byte| *byte == 0) else { return };
    let dbc = scratch::file("bus.dbc", &bytes[..zero]);
    let log = scratch::file("bus.log", &bytes[zero + 1..]);
    let options =
        LogOptions { units: UnitCheck::Trusting, dbc: Some(dbc.clone()), ..LogOptions::default() };
    if let Ok(mut log) = LogReader::open_with(&log, &options) {
        let mut last_s = f64::NEG_INFINITY;
        while let Ok(Some(row)) = log.next_row() {
            assert!(row.time_s > last_s, "rows are in the order of time");
            last_s = row.time_s;
        }
        log.repairs().warnings().iter().for_each(|warning| assert!(!warning.is_empty()));
    }
    let Ok(mut lister) = Lister::open(&log, Some(&dbc), &[]) else { return };
    while let Ok(true) = lister.step() {}
    let listing = lister.finish();
    assert_eq!(listing.candidates().len(), listing.has_samples().len());
});
