//! How a text table separates cells and decimals, and how it writes that a value is missing.

/// How a file separates cells and decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dialect {
    separator: u8,
}

impl Dialect {
    /// Cells between blanks, one each.
    pub(super) const BLANKS: Self = Self { separator: b' ' };

    /// That of a file with this header: what separates most names of commas, `;`, tabs and `|`. Where commas separate nothing, they may be
    /// decimal ones.
    pub(crate) fn of(header: &[u8]) -> Self {
        // RaceCapture puts what it says of a column into one cell, between bars.
        let barred = |cell: &[u8]| cell.iter().filter(|byte| **byte == b'|').count() >= 2;
        if header.contains(&b',') && header.starts_with(b"\"") && cells_by(header, b',').all(barred) {
            return Self { separator: b',' };
        }
        let cells = |separator: &u8| cells_by(header, *separator).count();
        // Of equals the first one, the comma.
        let most = b"|\t;,".iter().max_by_key(|separator| cells(separator));
        Self { separator: most.copied().unwrap_or(b',') }
    }

    /// That of a file that begins with a line such as `sep=;`, as spreadsheets want it.
    pub(crate) fn stated(line: &[u8]) -> Option<Self> {
        let separator = line.get(..4).filter(|word| word.eq_ignore_ascii_case(b"sep=")).and(line.get(4..))?;
        match separator {
            [separator] => Some(Self { separator: *separator }),
            // A tab at a line's end is trimmed off.
            [] => Some(Self { separator: b'\t' }),
            _ => None,
        }
    }

    pub(crate) fn names(self, header: &[u8]) -> Vec<String> {
        self.cells(header).map(|name| itpms_files::decoded(name).replace("\"\"", "\"")).collect()
    }

    pub(crate) fn cells(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        cells_by(line, self.separator)
    }

    /// The number in a cell, as [`number`] has it.
    pub(crate) fn number(self, cell: &[u8]) -> Option<f64> {
        let decimal = || {
            let text = std::str::from_utf8(cell).ok()?;
            let parts = text.split_once(',').filter(|_| self.separator != b',' && text != ",");
            let (whole, fraction) = parts?;
            number(format!("{whole}.{fraction}").as_bytes())
        };
        number(cell).or_else(decimal)
    }
}

/// The cells of a line, trimmed and out of their quotes. A comma inside quotes separates nothing.
pub(crate) fn cells(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    cells_by(line, b',')
}

fn cells_by(line: &[u8], separator: u8) -> impl Iterator<Item = &[u8]> {
    let mut quoted = false;
    line.split(move |byte| {
        quoted ^= *byte == b'"';
        *byte == separator && !quoted
    })
    .map(|cell| {
        let cell = cell.trim_ascii();
        cell.strip_prefix(b"\"").and_then(|cell| cell.strip_suffix(b"\"")).unwrap_or(cell).trim_ascii()
    })
}

/// How programs write that there is no value, in any case: R, pandas, spreadsheets and their errors, Python, C libraries of
/// Windows and of others, databases.
const MISSING: [&str; 23] = [
    "na",
    "n/a",
    "n.a.",
    "#n/a",
    "#na",
    "#div/0!",
    "#value!",
    "#num!",
    "#ref!",
    "<na>",
    "none",
    "null",
    "(null)",
    "<null>",
    "\\n",
    "nil",
    "nat",
    "-nan",
    "nan(ind)",
    "-nan(ind)",
    "1.#qnan",
    "-1.#ind",
    "1.#inf",
];

/// The number in a cell: NaN for what is missing or infinite, 1 and 0 for true and false, `None` for what is no number.
pub(crate) fn number(cell: &[u8]) -> Option<f64> {
    if let Some(value) = std::str::from_utf8(cell).ok().and_then(|text| text.parse::<f64>().ok()) {
        return Some(if value.is_finite() { value } else { f64::NAN });
    }
    for (word, value) in [(&b"true"[..], 1.0), (b"false", 0.0)] {
        if cell.eq_ignore_ascii_case(word) {
            return Some(value);
        }
    }
    if let Some(value) = typeset(cell) {
        return Some(value);
    }
    let missing =
        is_placeholder(cell) || MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word.as_bytes()));
    missing.then_some(f64::NAN)
}

/// A cell that is empty or holds marks alone, as displays and programs fill it where a sensor gives no value: `-`, `--`, `--.-`, `?`, `***`.
fn is_placeholder(cell: &[u8]) -> bool {
    let is_mark = |c: char| matches!(c, '-' | '\u{2212}' | '\u{2013}' | '\u{2014}' | '?' | '*' | '.' | '_');
    std::str::from_utf8(cell).is_ok_and(|text| text.chars().all(is_mark))
}

/// A number with a minus as typesetters have it, or an exponent as Fortran has it: `2.5D+01`.
fn typeset(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    let plain: String = text
        .chars()
        .map(|c| match c {
            '\u{2212}' | '\u{2013}' | '\u{fe63}' | '\u{ff0d}' => '-',
            'D' | 'd' | 'Q' | 'q' => 'e',
            c => c,
        })
        .collect();
    plain.parse().ok().filter(|value: &f64| value.is_finite() && plain != text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_has_many_spellings_and_text_is_not_one_of_them() {
        for missing in [
            "",
            "NaN",
            "nan",
            "null",
            "NULL",
            "inf",
            "-inf",
            "NA",
            "n/a",
            "#N/A",
            "None",
            "<NA>",
            "NaT",
            "-",
            "--",
            "--.-",
            "?",
            "***",
            ".",
            "\u{2212}",
            "\u{2014}",
            "\\N",
            "#DIV/0!",
            "-nan(ind)",
            "-1.#IND",
        ] {
            assert!(number(missing.as_bytes()).unwrap().is_nan(), "{missing}");
        }
        assert_eq!(number(b"-1.5e-3"), Some(-1.5e-3));
        for (text, value) in
            [("\u{2212}0.06", -0.06), ("2.2220D+01", 22.22), ("\u{2212}3d\u{2212}2", -0.03), ("1Q2", 100.0)]
        {
            assert_eq!(number(text.as_bytes()), Some(value), "{text}");
        }
        assert_eq!((number(b"True"), number(b"FALSE")), (Some(1.0), Some(0.0)));
        for text in ["fast", "1,5", "0x10", "12 m", "--5", "1?", "d", "3 d", "\u{2212}d"] {
            assert!(number(text.as_bytes()).is_none(), "{text}");
        }
    }

    #[test]
    fn where_commas_separate_nothing_they_are_decimal() {
        let semicolons = Dialect::of(b"time_s;fl_body_accel_m_s2;v");
        assert_eq!(semicolons.names(b"time_s; \"a;b\" ;v"), ["time_s", "a;b", "v"]);
        assert_eq!(semicolons.cells(b"0,5;-1,25e1;").count(), 3);
        for (text, value) in [("0,5", 0.5), ("-1,25e1", -12.5), ("1.5", 1.5), ("7", 7.0)] {
            assert_eq!(semicolons.number(text.as_bytes()), Some(value), "{text}");
        }
        assert!(semicolons.number(b"").unwrap().is_nan());
        for text in ["1.000,5", "1,000,5", ",", "a,b"] {
            assert_eq!(semicolons.number(text.as_bytes()), None, "{text}");
        }
        // A comma in a name is no separator where another one separates more.
        let tabs = Dialect::of(b"time_s\tbody, left\tv");
        assert_eq!(tabs.names(b"time_s\tbody, left\tv"), ["time_s", "body, left", "v"]);
        let commas = Dialect::of(b"time_s,a;b");
        assert_eq!((commas.cells(b"1,2;3").count(), commas.number(b"1,5")), (2, None));
        assert_eq!(Dialect::of(b"time_s\tv").names(b"time_s\tv"), ["time_s", "v"]);
        assert_eq!(Dialect::of(b"time_s").names(b"time_s"), ["time_s"]);
    }

    #[test]
    fn a_file_may_say_its_separator_and_names_their_quotes() {
        for (line, separated) in [
            (&b"sep=;"[..], Some("a;b")),
            (b"SEP=|", Some("a|b")),
            (b"sep=", Some("a\tb")),
            (b"separate", None),
        ] {
            let found =
                Dialect::stated(line).map(|dialect| dialect.cells(separated.unwrap().as_bytes()).count());
            assert_eq!(found, separated.map(|_| 2), "{line:?}");
        }
        let commas = Dialect::of(b"a,b");
        assert_eq!(commas.names(b"\"a \"\"b\"\" body\",\"c\""), ["a \"b\" body", "c"]);
        assert_eq!(commas.names(b"Beschl. [m/s\xb2],v"), ["Beschl. [m/s\u{b2}]", "v"]);
    }

    #[test]
    fn cells_come_out_of_blanks_and_quotes() {
        let split = |line: &'static str| {
            cells(line.as_bytes()).map(|cell| std::str::from_utf8(cell).unwrap()).collect::<Vec<_>>()
        };
        assert_eq!(split("1, 2 ,3"), ["1", "2", "3"]);
        assert_eq!(split("\"time_s\",\"a, b\",,"), ["time_s", "a, b", "", ""]);
    }
}
