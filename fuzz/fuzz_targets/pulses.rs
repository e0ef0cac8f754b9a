//! A table of tooth pulses of any bytes, as text and as Parquet: in the order of time, or refused in one line.
#![no_main]

use itpms_data::pulses::PulseReader;
use libfuzzer_sys::fuzz_target;

mod scratch;

fuzz_target!(|bytes: &[u8]| {
    for name in ["pulses.csv", "pulses.parquet"] {
        let mut reader = match PulseReader::open(&scratch::file(name, bytes)) {
            Ok(reader) => reader,
            Err(error) => {
                assert!(error.to_string().lines().count() == 1, "{error}");
                continue;
            }
        };
        let mut last_s = f64::NEG_INFINITY;
        while let Ok(Some(pulse)) = reader.next_pulse() {
            assert!(pulse.time_s >= last_s, "pulses are in the order of time");
            last_s = pulse.time_s;
        }
    }
});
