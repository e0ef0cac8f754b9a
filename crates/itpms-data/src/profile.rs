//! Road profiles from text or Parquet: distance and height, of one track, of two, or of every wheel.
//!
//! Called by the roughness command. Reads surveyed profiles (two or three columns of numbers) and the roads that an
//! estimate leaves (`road.csv`, `road.parquet`). Knows nothing of roughness.

use std::path::Path;

use itpms_files::input;

use crate::error::{DataError, Place, Problem, not_among, twice};
use crate::log::{Lines, number, shortened};
#[cfg(feature = "parquet")]
use crate::parquet_columns::ParquetColumns;

#[derive(Debug, Clone, PartialEq)]
pub struct RoadProfile {
    /// Distance in m, increasing.
    pub distance_m: Vec<f64>,
    pub tracks: Vec<RoadTrack>,
    /// Time in s at those distances, where the file has `time_s`; else empty.
    pub time_s: Vec<f64>,
    /// Rows left out because they were no farther than the row before (a car that stands), or had no distance.
    pub rows_left_out: u64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct RoadTrack {
    /// `left` or `right`, a wheel (`fl`, `fr`, `rl`, `rr`), or `road` where there is one track only.
    pub name: &'static str,
    /// Heights in m, as many as distances; NaN is missing.
    pub height_m: Vec<f64>,
}

/// Names of columns and of the tracks they hold.
const HEIGHTS: [(&str, &str); 7] = [
    ("height_m", "road"),
    ("left_height_m", "left"),
    ("right_height_m", "right"),
    ("fl_road_m", "fl"),
    ("fr_road_m", "fr"),
    ("rl_road_m", "rl"),
    ("rr_road_m", "rr"),
];
const TIME: &str = "time_s";
const DISTANCE: &str = "distance_m";
const EXPECTED: &str = "distance_m and height_m, or left_height_m and right_height_m, or {c}_road_m; or two or three columns of numbers";

/// Meaning of a column of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Slot {
    Distance,
    Time,
    Track(usize),
    Other,
}

impl RoadTrack {
    /// Whether a wheel has felt this road: then a tire has smoothed it already.
    pub fn is_wheel(&self) -> bool {
        !matches!(self.name, "left" | "right" | "road")
    }
}

impl RoadProfile {
    /// Rows per second, from the median step in time; `None` without times.
    pub fn rate_hz(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self.time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).filter(|step| **step > 0.0 && step.is_finite()).map(|step| 1.0 / step)
    }

    /// Reads a file. Cells are parted by commas or semicolons, else by blanks; `#` begins a comment. With a header the columns are
    /// `distance_m` and `height_m`, or `left_height_m` and `right_height_m`, or `{c}_road_m` for the wheels; others are passed over.
    /// Without one, two columns are distance and height, three are distance, left and right. A file that ends in `.parquet` or `.pq` has
    /// the same columns. Errors: the file cannot be read, lacks a column, a cell is no number, a row is longer or shorter than the first,
    /// or the distance goes backwards; this build is without Parquet.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
        let is_parquet = extension.is_some_and(|extension| extension == "parquet" || extension == "pq");
        let profile = if is_parquet { read_parquet(path) } else { read_text(path) };
        profile.and_then(RoadProfile::complete).map_err(|problem| DataError::new(path, problem))
    }

    fn of(names: &[&'static str]) -> Self {
        Self {
            distance_m: Vec::new(),
            time_s: Vec::new(),
            tracks: names.iter().map(|name| RoadTrack { name, height_m: Vec::new() }).collect(),
            rows_left_out: 0,
        }
    }

    fn complete(self) -> Result<Self, Problem> {
        match self.distance_m.len() {
            0 if self.rows_left_out == 0 => Err(Problem::HeaderOnly),
            0 | 1 => Err("found no two rows with different distances, expected a road".into()),
            _ => Ok(self),
        }
    }

    fn add(&mut self, place: Place, row: impl Iterator<Item = (Slot, f64)>) -> Result<(), Problem> {
        let mut heights = vec![f64::NAN; self.tracks.len()];
        let (mut distance_m, mut time_s) = (f64::NAN, None);
        for (slot, value) in row {
            match slot {
                Slot::Track(track) => heights[track] = value,
                Slot::Time => time_s = Some(value),
                Slot::Distance => distance_m = value,
                Slot::Other => {}
            }
        }
        let last_m = self.distance_m.last().copied().unwrap_or(f64::NEG_INFINITY);
        if distance_m < last_m {
            return Err(format!(
                "{place}: the distance goes back from {last_m} to {distance_m} m, expected it to increase"
            )
            .into());
        }
        if !(distance_m > last_m) {
            self.rows_left_out += 1;
            return Ok(());
        }
        self.distance_m.push(distance_m);
        self.time_s.extend(time_s);
        for (track, height) in self.tracks.iter_mut().zip(heights) {
            track.height_m.push(height);
        }
        Ok(())
    }
}

#[cfg(feature = "parquet")]
fn read_parquet(path: &Path) -> Result<RoadProfile, Problem> {
    let mut columns = ParquetColumns::open(input::open_regular(path, "Parquet")?.0)?;
    let (slots, names) = by_name(columns.names())?;
    let mut chosen = Vec::new();
    for (leaf, slot) in slots.into_iter().enumerate() {
        if slot != Slot::Other {
            columns.choose(leaf)?;
            chosen.push(slot);
        }
    }
    let mut profile = RoadProfile::of(&names);
    while let Some(place) = columns.advance()? {
        profile.add(place, chosen.iter().copied().zip(columns.values()))?;
    }
    Ok(profile)
}

#[cfg(not(feature = "parquet"))]
fn read_parquet(_: &Path) -> Result<RoadProfile, Problem> {
    Err("this build is without Parquet, expected a road as text".into())
}

fn read_text(path: &Path) -> Result<RoadProfile, Problem> {
    let mut lines = Lines::new(input::open(path)?.0);
    if !lines.advance()? {
        return Err(format!("the file is empty, expected a header line with {EXPECTED}").into());
    }
    let first: Vec<Vec<u8>> = parts(lines.text()).map(<[u8]>::to_vec).collect();
    let header = first.iter().any(|cell| number(cell).is_none());
    let (slots, names) = if header {
        let names: Vec<_> = first.iter().map(|name| String::from_utf8_lossy(name).into_owned()).collect();
        by_name(&names)?
    } else {
        by_place(&first, lines.number())?
    };
    let mut profile = RoadProfile::of(&names);
    let mut there = !header || lines.advance()?;
    while there {
        take_row(&mut profile, lines.text(), lines.number(), &slots)?;
        there = lines.advance()?;
    }
    Ok(profile)
}

fn parts(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let separated = line.iter().any(|byte| b",;".contains(byte));
    line.split(move |byte| if separated { b",;".contains(byte) } else { byte.is_ascii_whitespace() })
        .map(<[u8]>::trim_ascii)
        .map(|cell| cell.strip_prefix(b"\"").and_then(|cell| cell.strip_suffix(b"\"")).unwrap_or(cell))
        .filter(move |cell| separated || !cell.is_empty())
}

fn by_name(header: &[String]) -> Result<(Vec<Slot>, Vec<&'static str>), Problem> {
    for (second, name) in header.iter().enumerate() {
        let known = name == DISTANCE || name == TIME || HEIGHTS.iter().any(|(column, _)| column == name);
        if let Some(first) = header[..second].iter().position(|other| known && other == name) {
            return Err(twice(name, first, second));
        }
    }
    let mut names = Vec::new();
    let mut slot = |name: &String| match HEIGHTS.iter().find(|(column, _)| column == name) {
        _ if name == DISTANCE => Slot::Distance,
        _ if name == TIME => Slot::Time,
        Some((_, track)) => {
            names.push(*track);
            Slot::Track(names.len() - 1)
        }
        None => Slot::Other,
    };
    let slots: Vec<Slot> = header.iter().map(&mut slot).collect();
    let missing = |column: &str| not_among(column, header, &[], EXPECTED);
    let a_drive = header.iter().any(|name| name.ends_with("_accel_m_s2"));
    match (slots.contains(&Slot::Distance), names.is_empty()) {
        (false, _) | (_, true) if a_drive => Err(Problem::DriveLog),
        (false, _) => Err(missing(DISTANCE)),
        (_, true) => Err(missing(HEIGHTS[0].0)),
        (true, false) => Ok((slots, names)),
    }
}

fn by_place(first: &[Vec<u8>], line: u64) -> Result<(Vec<Slot>, Vec<&'static str>), Problem> {
    match first.len() {
        2 => Ok((vec![Slot::Distance, Slot::Track(0)], vec!["road"])),
        3 => Ok((vec![Slot::Distance, Slot::Track(0), Slot::Track(1)], vec!["left", "right"])),
        found => Err(format!(
            "line {line}: found {found} columns of numbers without a header, expected 2 (distance and height) or 3 (distance, left and right)"
        )
        .into()),
    }
}

fn take_row(profile: &mut RoadProfile, text: &[u8], line: u64, slots: &[Slot]) -> Result<(), Problem> {
    let place = Place::Line(line);
    let mut row = Vec::with_capacity(slots.len());
    let mut found = 0;
    for cell in parts(text) {
        let slot = slots.get(found).copied().unwrap_or(Slot::Other);
        found += 1;
        let value = match slot {
            Slot::Other => continue,
            _ => number(cell).filter(|value| !value.is_infinite()).ok_or_else(|| Problem::NotANumber {
                place,
                column: slot_name(profile, slot),
                found: shortened(&String::from_utf8_lossy(cell)),
                hint: "",
            })?,
        };
        row.push((slot, value));
    }
    if found != slots.len() {
        return Err(Problem::CellCount { place, found, expected: slots.len() });
    }
    profile.add(place, row.into_iter())
}

fn slot_name(profile: &RoadProfile, slot: Slot) -> String {
    match slot {
        Slot::Track(i) => {
            let track = profile.tracks[i].name;
            HEIGHTS.iter().find(|(_, name)| *name == track).map_or(track, |(column, _)| column).to_owned()
        }
        Slot::Time => TIME.to_owned(),
        Slot::Distance | Slot::Other => DISTANCE.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use proptest::prelude::*;

    fn read_bytes(bytes: &[u8]) -> Result<RoadProfile, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("road.csv");
        fs::write(&path, bytes).unwrap();
        let fail = |error: DataError| error.to_string().replace(&format!("{}/", folder.path().display()), "");
        RoadProfile::read(&path).map_err(fail)
    }

    fn heights(profile: &RoadProfile) -> Vec<(&str, Vec<f64>)> {
        profile.tracks.iter().map(|track| (track.name, track.height_m.clone())).collect()
    }

    #[test]
    fn with_a_header_and_without() {
        let profile = read_bytes(b"478.0 583.1\n478.25\t583.2\n").unwrap();
        assert_eq!(profile.distance_m, [478.0, 478.25]);
        assert_eq!(heights(&profile), [("road", vec![583.1, 583.2])]);
        let profile = read_bytes(b"# a survey\n0;1;2\n\n0.5;1.5;2.5\n").unwrap();
        assert_eq!(heights(&profile), [("left", vec![1.0, 1.5]), ("right", vec![2.0, 2.5])]);
        let profile =
            read_bytes(b"right_height_m,who,distance_m,left_height_m\n2,me,0,1\n2.5,you,1,1.5\n").unwrap();
        assert_eq!(heights(&profile), [("right", vec![2.0, 2.5]), ("left", vec![1.0, 1.5])]);
    }

    #[test]
    fn the_road_that_an_estimate_leaves() {
        // Before the speed is known there is no distance, while the car stands it does not grow.
        let text = b"time_s,distance_m,fl_road_m,rr_road_m,fl_road_sd_m\n0,,0.1,,1\n1,0,0.1,,1\n2,0,0.2,,1\n3,2,,0.3,1\n";
        let profile = read_bytes(text).unwrap();
        assert_eq!((profile.distance_m.as_slice(), profile.rows_left_out), (&[0.0, 2.0][..], 2));
        assert_eq!((profile.time_s.as_slice(), profile.rate_hz()), (&[1.0, 3.0][..], Some(0.5)));
        assert!(profile.tracks[0].is_wheel());
        let tracks = heights(&profile);
        assert_eq!((tracks[0].0, tracks[0].1[0], tracks[1].0, tracks[1].1[1]), ("fl", 0.1, "rr", 0.3));
        assert!(tracks[0].1[1].is_nan());
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, message) in [
            ("", "road.csv: the file is empty, expected a header line with distance_m and height_m"),
            ("distance_m,height_m\n", "road.csv: there is a header but no row under it"),
            (
                "0 1 2 3\n",
                "road.csv: line 1: found 4 columns of numbers without a header, expected 2 (distance and height",
            ),
            ("0,1\n1,x\n", "road.csv: line 2, column height_m: found \"x\", expected a number"),
            ("0,1\n1\n", "road.csv: line 2: found 1 cells, expected 2"),
            (
                "0,1\n2,1\n1,1\n",
                "road.csv: line 3: the distance goes back from 2 to 1 m, expected it to increase",
            ),
            ("0,1\n0,1\n", "road.csv: found no two rows with different distances"),
            (
                "distanc_m,height_m\n0,1\n",
                "road.csv: column distance_m is missing; the nearest name there is distanc_m",
            ),
            ("distance_m,z\n0,1\n", "road.csv: column height_m is missing; found distance_m,z, expected"),
            ("distance_m,height_m,height_m\n0,1,1\n", "road.csv: column height_m appears twice"),
            ("time_s,fl_body_accel_m_s2\n0,1\n", "road.csv: looks like a drive log"),
        ] {
            let found = read_bytes(text.as_bytes()).unwrap_err();
            assert!(found.starts_with(message), "{found}");
        }
    }

    proptest! {
        /// Whatever is in a file: increasing distances or one sentence, never a panic.
        #[test]
        fn no_content_brings_the_reader_down(
            head in prop_oneof![Just("distance_m,height_m,left_height_m\n"), Just("")],
            body in proptest::collection::vec(prop_oneof![4 => "[0-9., ;e-]{0,12}\n", 1 => "\\PC{0,20}"], 0..30),
        ) {
            if let Ok(profile) = read_bytes(format!("{head}{}", body.concat()).as_bytes()) {
                prop_assert!(profile.distance_m.windows(2).all(|pair| pair[1] > pair[0]));
                prop_assert!(profile.tracks.iter().all(|t| t.height_m.len() == profile.distance_m.len()));
            }
        }
    }
}
