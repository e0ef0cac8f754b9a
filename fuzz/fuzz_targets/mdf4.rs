//! An MDF4 file of any bytes: every number of every group is read.
#![no_main]

use itpms_mdf4::{ChannelKind, Mdf4Reader};
use libfuzzer_sys::fuzz_target;

mod scratch;

fuzz_target!(|bytes: &[u8]| {
    let path = scratch::file("log.mf4", bytes);
    let Ok(reader) = Mdf4Reader::open(&path) else { return };
    for (index, group) in reader.groups().iter().enumerate() {
        let numbers: Vec<usize> =
            (0..group.channels.len()).filter(|c| group.channels[*c].kind == ChannelKind::Number).collect();
        let Ok(mut cursor) = reader.cursor(index, &numbers) else { continue };
        let mut values = vec![0.0; numbers.len()];
        while let Ok(Some(_)) = cursor.next(&mut values) {
            assert!((0.0..=1.0).contains(&cursor.progress()));
        }
        assert!(cursor.next(&mut values).is_ok_and(|sample| sample.is_none()), "an end or an error is the end");
        // Bounded however much is wrong.
        assert!(cursor.repairs().len() < 100);
    }
});
