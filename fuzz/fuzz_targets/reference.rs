//! A stored reference of any bytes, and of any body under a checksum that fits: what is read is plausible.
#![no_main]

use itpms_data::reference::{FORMAT, StoredReference};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    assert!(holds(bytes));
    // The checksum that fits stands in the refusal.
    let body = String::from_utf8_lossy(bytes);
    let unsealed = format!("itpms-reference {FORMAT} 0\n{body}");
    let Err(problem) = StoredReference::parse(unsealed.as_bytes()) else { return };
    let words = problem.to_string();
    if let Some((_, sum)) = words.rsplit_once(' ') {
        assert!(holds(format!("itpms-reference {FORMAT} {sum}\n{body}").as_bytes()));
    }
});

/// Whether it is refused, or read as what is plausible and reads back as the same.
fn holds(bytes: &[u8]) -> bool {
    let Ok(stored) = StoredReference::parse(bytes) else { return true };
    let again = StoredReference::parse(stored.to_text().as_bytes());
    stored.reference.check().is_ok() && again.is_ok_and(|again| again == stored)
}
