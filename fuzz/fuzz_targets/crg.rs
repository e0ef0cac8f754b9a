//! An OpenCRG file of any bytes: its surface, along lines within and beside it.
#![no_main]

use itpms_opencrg::CrgRoad;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(road) = CrgRoad::from_bytes(bytes) else { return };
    assert!(road.increment_m() > 0.0 && road.start_m().is_finite());
    let ends = [road.lateral_m().first(), road.lateral_m().last()];
    for v_m in ends.into_iter().flatten().copied().chain([0.0, 1e300, f64::NAN]) {
        if let Ok(line) = road.line_m(v_m) {
            assert_eq!(line.len(), road.rows());
        }
    }
});
