//! Text of a DBC file of any bytes, and what can be done with it: frames decoded and encoded, columns found.
#![no_main]

use itpms_data::dbc::{Dbc, Decoder};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(dbc) = Dbc::from_bytes(bytes) else { return };
    // The file's own beginning serves as data, so that both change together.
    let data = &bytes[..bytes.len().min(64)];
    for message in dbc.messages() {
        message.decode(data, |place, _| assert!(place < message.signals.len()));
        if let Ok(payload) = message.encode(|place| place as f64 - 2.0) {
            assert_eq!(payload.len(), message.frame_length());
        }
    }
    for problem in dbc.problems() {
        assert!(problem.line > 0 && !problem.to_string().is_empty());
    }
    Decoder::new(dbc, None).expect("without a map there is nothing to refuse");
});
