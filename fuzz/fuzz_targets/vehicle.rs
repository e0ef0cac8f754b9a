//! A vehicle file of any text: what is read is written, and read as the same.
#![no_main]

use itpms_data::Vehicle;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| match Vehicle::parse(text) {
    Err(problem) => assert!(!problem.to_string().is_empty()),
    Ok(vehicle) => {
        let written = vehicle.to_toml();
        let again = Vehicle::parse(&written).expect("what is written is read");
        assert_eq!(again.to_toml(), written);
    }
});
