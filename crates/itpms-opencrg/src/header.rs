//! The clear-text header of an OpenCRG file: sections, and names with values in them.
//!
//! Called by the reader first; gives the lines of `$KD_DEFINITION` and the numbers of `$ROAD_CRG` and
//! `$ROAD_CRG_MODS`, each with its line. Sections that do not change the surface (comments, evaluation options, map
//! projection, anything unknown) are passed over. Knows nothing of channels or heights.

use itpms_files::{nearest, shortened};

use crate::error::CrgProblem;

/// Names of `$ROAD_CRG` that mean something here or have a place in the standard.
const ROAD_KEYS: [&str; 30] = [
    "reference_line_start_u",
    "reference_line_start_x",
    "reference_line_start_y",
    "reference_line_start_z",
    "reference_line_start_phi",
    "reference_line_start_s",
    "reference_line_start_b",
    "reference_line_start_lon",
    "reference_line_start_lat",
    "reference_line_start_alt",
    "reference_line_end_u",
    "reference_line_end_x",
    "reference_line_end_y",
    "reference_line_end_z",
    "reference_line_end_phi",
    "reference_line_end_s",
    "reference_line_end_b",
    "reference_line_end_lon",
    "reference_line_end_lat",
    "reference_line_end_alt",
    "reference_line_increment",
    "reference_line_offset_x",
    "reference_line_offset_y",
    "reference_line_offset_z",
    "reference_line_offset_phi",
    "long_section_v_right",
    "long_section_v_left",
    "long_section_v_increment",
    "reference_line_offset_lon",
    "reference_line_offset_lat",
];

/// Names of `$ROAD_CRG_MODS`.
const MODIFIER_KEYS: [&str; 24] = [
    "scale_z_grid",
    "scale_slope",
    "scale_banking",
    "scale_length",
    "scale_width",
    "scale_curvature",
    "grid_nan_mode",
    "grid_nan_offset",
    "refline_rotcenter_x",
    "refline_rotcenter_y",
    "refline_offset_phi",
    "refline_offset_x",
    "refline_offset_y",
    "refline_offset_z",
    "refpoint_u",
    "refpoint_u_fraction",
    "refpoint_u_offset",
    "refpoint_v",
    "refpoint_v_fraction",
    "refpoint_v_offset",
    "refpoint_x",
    "refpoint_y",
    "refpoint_z",
    "refpoint_phi",
];

#[derive(Debug, Clone, PartialEq)]
struct Entry {
    key: String,
    value: f64,
    line: u64,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Numbers {
    entries: Vec<Entry>,
}

impl Numbers {
    pub(crate) fn get(&self, key: &str) -> Option<f64> {
        self.entries.iter().find(|entry| entry.key == key).map(|entry| entry.value)
    }

    /// The number of this name, or `default`.
    pub(crate) fn or(&self, key: &str, default: f64) -> f64 {
        self.get(key).unwrap_or(default)
    }

    /// The number of this name if it lies in the range; an error that names its line otherwise.
    pub(crate) fn within(
        &self,
        key: &str,
        expected: &'static str,
        inside: impl Fn(f64) -> bool,
    ) -> Result<Option<f64>, CrgProblem> {
        match self.entries.iter().find(|entry| entry.key == key) {
            Some(entry) if !inside(entry.value) => Err(CrgProblem::Range {
                line: entry.line,
                key: entry.key.clone(),
                value: entry.value,
                expected,
            }),
            other => Ok(other.map(|entry| entry.value)),
        }
    }
}

/// A line of `$KD_DEFINITION`, without its remark.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Definition {
    pub(crate) line: u64,
    pub(crate) text: String,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Header {
    pub(crate) road: Numbers,
    /// `None`: the file has no such section.
    pub(crate) modifiers: Option<Numbers>,
    pub(crate) definitions: Vec<Definition>,
    /// Where the data begin, in bytes.
    pub(crate) data_from: usize,
    pub(crate) data_line: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Section {
    /// Between sections, or in one that says nothing about the surface.
    Other,
    Road,
    Modifiers,
    Definition,
    File,
}

impl Section {
    const NAMED: [(Section, &'static str); 4] = [
        (Section::Road, "ROAD_CRG"),
        (Section::Modifiers, "ROAD_CRG_MODS"),
        (Section::Definition, "KD_DEFINITION"),
        (Section::File, "ROAD_CRG_FILE"),
    ];

    fn name(self) -> &'static str {
        Self::NAMED.iter().find(|(section, _)| *section == self).map_or("", |(_, name)| name)
    }

    /// The section that a line such as `$ROAD_CRG ! remark` begins.
    fn beginning(line: &str) -> Self {
        let word = line[1..].split(|c: char| c.is_whitespace() || c == '!').next().unwrap_or_default();
        let known = Self::NAMED.iter().find(|(_, name)| name.eq_ignore_ascii_case(word));
        known.map_or(Section::Other, |(section, _)| *section)
    }
}

impl Header {
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, CrgProblem> {
        let mut header = Header::default();
        let mut section = Section::Other;
        let mut seen: Vec<(Section, u64)> = Vec::new();
        let (mut from, mut number) = (0, 0);
        while from < bytes.len() {
            let rest = &bytes[from..];
            let length = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |end| end + 1);
            let text = String::from_utf8_lossy(&rest[..length]);
            let line = text.trim_end();
            from += length;
            number += 1;
            if line.starts_with("$$") {
                header.data_from = from;
                header.data_line = number + 1;
                return header.complete(&seen);
            }
            if line.starts_with('$') {
                section = Section::beginning(line);
                header.enter(section, number, &mut seen)?;
            } else if !(line.trim_start().is_empty() || line.trim_start().starts_with('*')) {
                header.take(section, line, number)?;
            }
        }
        Err(CrgProblem::NoData)
    }

    /// Whether the line that ends a header is among these bytes, which may begin a file.
    pub(crate) fn ends_in(beginning: &[u8]) -> bool {
        beginning.starts_with(b"$$") || beginning.windows(3).any(|three| three == b"\n$$")
    }

    fn complete(self, seen: &[(Section, u64)]) -> Result<Self, CrgProblem> {
        for section in [Section::Road, Section::Definition] {
            if !seen.iter().any(|(other, _)| *other == section) {
                return Err(CrgProblem::MissingSection(section.name()));
            }
        }
        Ok(self)
    }

    fn enter(
        &mut self,
        section: Section,
        line: u64,
        seen: &mut Vec<(Section, u64)>,
    ) -> Result<(), CrgProblem> {
        if section == Section::Other {
            return Ok(());
        }
        if let Some((_, first)) = seen.iter().find(|(other, _)| *other == section) {
            return Err(CrgProblem::SecondSection { line, section: section.name(), first: *first });
        }
        seen.push((section, line));
        if section == Section::Modifiers {
            self.modifiers = Some(Numbers::default());
        }
        Ok(())
    }

    fn take(&mut self, section: Section, line: &str, number: u64) -> Result<(), CrgProblem> {
        let statement = line.split('!').next().unwrap_or_default().trim_end();
        if statement.trim().is_empty() {
            return Ok(());
        }
        match section {
            Section::Other => Ok(()),
            Section::Road => assign(&mut self.road, section, &ROAD_KEYS, statement, number),
            Section::Modifiers => {
                let numbers = self.modifiers.get_or_insert_default();
                assign(numbers, section, &MODIFIER_KEYS, statement, number)
            }
            Section::Definition => {
                self.definitions.push(Definition { line: number, text: statement.trim_start().to_owned() });
                Ok(())
            }
            Section::File => Err(CrgProblem::OtherFile { line: number, file: shortened(statement.trim()) }),
        }
    }
}

/// `name = value` into the numbers of a section. Names count without regard to upper and lower case.
fn assign(
    numbers: &mut Numbers,
    section: Section,
    known: &[&str],
    statement: &str,
    line: u64,
) -> Result<(), CrgProblem> {
    let Some((key, value)) = statement.split_once('=') else {
        return Err(CrgProblem::Assignment {
            line,
            section: section.name(),
            found: shortened(statement.trim()),
        });
    };
    let column = statement[..key.len() + 1].chars().count() + 1 + value.chars().count()
        - value.trim_start().chars().count();
    let (key, value) = (key.trim().to_ascii_lowercase(), value.trim());
    if !known.contains(&key.as_str()) {
        let nearest = nearest(&key, known.iter().copied()).map(str::to_owned);
        return Err(CrgProblem::UnknownKey { line, section: section.name(), key: shortened(&key), nearest });
    }
    if let Some(first) = numbers.entries.iter().find(|entry| entry.key == key) {
        return Err(CrgProblem::SecondKey { line, key, first: first.line });
    }
    match number(value) {
        Some(value) => {
            numbers.entries.push(Entry { key, value, line });
            Ok(())
        }
        None => Err(CrgProblem::Value { line, column, key, found: shortened(value) }),
    }
}

/// A finite number as C or Fortran writes it.
pub(crate) fn number(text: &str) -> Option<f64> {
    let plain = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eEdD".contains(&byte));
    let value = text.replace(['d', 'D'], "e").parse::<f64>().ok()?;
    (plain && value.is_finite()).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(middle: &str) -> Result<Header, String> {
        let text =
            format!("$ROAD_CRG\nreference_line_increment=1\n$\n$KD_DEFINITION\n#:LRFI\n${middle}\n$$$$\n");
        Header::read(text.as_bytes()).map_err(|problem| problem.to_string())
    }

    #[test]
    fn names_values_remarks_and_comments() {
        let header = read(
            "\n* scale_z_grid = 9\n$Road_Crg_Mods ! remark\n\n  Scale_Z_Grid = 2.5D-1 ! a quarter\n$\n$CT\nfree = text\n$",
        )
        .unwrap();
        let modifiers = header.modifiers.unwrap();
        assert_eq!(modifiers.get("scale_z_grid"), Some(0.25));
        assert_eq!(header.road.get("reference_line_increment"), Some(1.0));
        assert_eq!(header.definitions, [Definition { line: 5, text: "#:LRFI".to_owned() }]);
        assert_eq!(header.data_line, 16);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (middle, message) in [
            (
                "\n$ROAD_CRG_MODS\nscale_z_grid = two",
                "line 8, column 16: scale_z_grid is \"two\", expected a finite number",
            ),
            (
                "\n$ROAD_CRG_MODS\nscale_z_grid = inf",
                "line 8, column 16: scale_z_grid is \"inf\", expected a finite number",
            ),
            (
                "\n$ROAD_CRG_MODS\nscale_z_gird = 2",
                "line 8: unknown scale_z_gird in $ROAD_CRG_MODS (did you mean scale_z_grid?)",
            ),
            (
                "\n$ROAD_CRG_MODS\nscale_slope 2",
                "line 8: found \"scale_slope 2\" in $ROAD_CRG_MODS, expected name = value",
            ),
            (
                "\n$ROAD_CRG_MODS\nscale_slope=2\nSCALE_SLOPE=3",
                "line 9: scale_slope a second time (first in line 8)",
            ),
            ("\n$road_crg", "line 7: section $ROAD_CRG a second time (first in line 1)"),
            (
                "\n$ROAD_CRG_FILE\n../other.crg ! here",
                "line 8: the road is in another file (../other.crg), expected the road itself: give that file",
            ),
        ] {
            assert_eq!(read(middle).unwrap_err(), message);
        }
        assert!(matches!(Header::read(b"$ROAD_CRG\n"), Err(CrgProblem::NoData)));
        assert!(matches!(Header::read(b"$$$$\n"), Err(CrgProblem::MissingSection("ROAD_CRG"))));
    }
}
