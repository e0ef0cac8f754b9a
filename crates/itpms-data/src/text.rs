//! The characters of a text: UTF-8 where it is that, else Windows code page 1252, in which most others are.
//! Called by the readers of DBC files and of tables' headers.

/// The text of these bytes. Never fails: the five bytes that code page 1252 does not define become U+FFFD.
pub(crate) fn decoded(bytes: &[u8]) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_encodings_give_the_same_text() {
        assert_eq!(decoded("m/s² °C €".as_bytes()), "m/s² °C €");
        assert_eq!(decoded(b"m/s\xb2 \xb0C \x80"), "m/s² °C €");
        assert_eq!(decoded(b"\xef\xbb\xbfVERSION"), "VERSION");
    }
}
