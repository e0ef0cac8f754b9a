//! Texts of files: their characters (UTF-8, else Windows code page 1252, in which most others are), what of them goes into a message, and
//! the name nearest to a mistyped one.

/// The text of these bytes. Never fails: the five bytes that code page 1252 does not define become U+FFFD.
#[must_use]
pub fn decoded(bytes: &[u8]) -> String {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| character(*byte)).collect(),
    }
}

fn character(byte: u8) -> char {
    match byte {
        0x80..=0x9f => UPPER[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// 0x80 to 0x9F of code page 1252; all else is as in Latin-1.
const UPPER: [char; 32] = [
    '€', '\u{fffd}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{fffd}', 'Ž', '\u{fffd}',
    '\u{fffd}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{fffd}', 'ž', 'Ÿ',
];

/// The candidate nearest to `name`, if any is near enough to be a slip of the finger: similarity (Jaro-Winkler on
/// lower case) of 0.8 or more. Column names share long endings, so lower values would match nearly everything.
#[must_use]
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(&name, &candidate.to_lowercase()), candidate))
        .filter(|(similarity, _)| *similarity >= 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// Up to 40 characters of a text that a message quotes, without control characters.
#[must_use]
pub fn shortened(text: &str) -> String {
    const LONGEST: usize = 40;
    let clean: String = text.chars().filter(|c| !c.is_control()).take(LONGEST + 1).collect();
    if clean.chars().count() > LONGEST { clean.chars().take(LONGEST).chain(['…']).collect() } else { clean }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_encodings_give_the_same_text() {
        assert_eq!(decoded("m/s² °C €".as_bytes()), "m/s² °C €");
        assert_eq!(decoded(b"m/s\xb2 \xb0C \x80"), "m/s² °C €");
        assert_eq!(decoded(b"\xef\xbb\xbfVERSION"), "VERSION");
    }

    #[test]
    fn slips_are_recognised_and_strangers_are_not() {
        let columns = ["time_s", "speed_m_s", "fl_body_accel_m_s2"];
        assert_eq!(nearest("Time", columns), Some("time_s"));
        assert_eq!(nearest("speed_mps", columns), Some("speed_m_s"));
        assert_eq!(nearest("fl_body_acc_ms2", columns), Some("fl_body_accel_m_s2"));
        assert_eq!(nearest("engine_rpm", columns), None);
    }
}
