//! OpenCRG files: made here by hand in every format, refused when wrong, and the real ones where they are there.

use std::io::{Write as _, stderr};
use std::path::PathBuf;

use itpms_opencrg::{CrgProblem, CrgRoad};
use proptest::prelude::*;

/// Three long sections at -1, 0 and 2 m, four rows 0.5 m apart; heights count up by a millimetre.
const HEIGHTS: [[f64; 3]; 4] =
    [[0.001, 0.002, 0.003], [0.004, f64::NAN, 0.006], [0.007, 0.008, 0.009], [0.010, 0.011, 0.012]];

const CHANNELS: &str =
    "D:long section at v = -1.0,m\nD:long section at v = 0.0,m ! on the line\nD:Long Section at v = 2.0,m\n";

/// A file of this format code, with more lines in its header.
fn file(code: &str, road: &str, sections: &str, channels: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = format!(
        "$CT ! text\nfree, even $ and = are\n$!***\n$ROAD_CRG\nREFERENCE_LINE_INCREMENT = 0.5 ! m\n{road}$\n\
         {sections}$KD_Definition\n#:{code}\nU:reference line u,m,0,0.5\n{channels}$\n$$$$ ! data\n"
    )
    .into_bytes();
    bytes.extend(data);
    bytes
}

fn text(rows: &[&[f64]], width: usize, per_line: usize) -> Vec<u8> {
    let cell =
        |z: &f64| if z.is_nan() { format!("{:>width$}", "*missing*") } else { format!("{z:>width$.6}") };
    let mut lines = String::new();
    for row in rows {
        for line in row.chunks(per_line) {
            lines += &line.iter().map(cell).collect::<String>();
            lines += "\r\n";
        }
    }
    lines.into_bytes()
}

fn rows() -> Vec<&'static [f64]> {
    HEIGHTS.iter().map(<[f64; 3]>::as_slice).collect()
}

fn binary(code: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    for row in HEIGHTS {
        for z in row {
            if code.as_bytes()[1] == b'R' {
                bytes.extend((z as f32).to_be_bytes());
            } else {
                bytes.extend(z.to_be_bytes());
            }
        }
        if code.starts_with('L') {
            bytes.resize(bytes.len().next_multiple_of(80), 0xff);
        }
    }
    // The last record is filled with NaN.
    bytes.resize(bytes.len().next_multiple_of(80), 0xff);
    bytes
}

fn data(code: &str) -> Vec<u8> {
    match (&code[1..3], &code[..1]) {
        ("RF", "L") => text(&rows(), 10, 8),
        ("DF", "L") => text(&rows(), 20, 4),
        ("RF", _) => text(&[&HEIGHTS.concat()], 10, 8),
        ("DF", _) => text(&[&HEIGHTS.concat()], 20, 4),
        _ => binary(code),
    }
}

fn road(code: &str, road: &str, sections: &str) -> CrgRoad {
    CrgRoad::from_bytes(&file(code, road, sections, CHANNELS, &data(code))).unwrap()
}

fn refusal(bytes: &[u8]) -> String {
    CrgRoad::from_bytes(bytes).unwrap_err().to_string()
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found - expected).abs() < tolerance || (found.is_nan() && expected.is_nan()),
            "{found} {expected}"
        );
    }
}

#[test]
fn every_format_gives_the_same_road() {
    for code in ["LRFI", "LDFI", "KRFI", "KDFI", "LRBI", "LDBI", "KRBI", "KDBI"] {
        for end in ["", "REFERENCE_LINE_END_U = 1.5\n"] {
            let road = road(code, end, "");
            assert_eq!((road.rows(), road.increment_m(), road.start_m()), (4, 0.5, 0.0), "{code}");
            assert_eq!((road.lateral_m(), road.missing_cells()), (&[-1.0, 0.0, 2.0][..], 1));
            // Text has six digits, an f32 of 12 mm an error of 5e-10.
            assert_close(&road.line_m(-1.0).unwrap(), &[0.001, 0.004, 0.007, 0.010], 1e-9);
            assert_close(&road.line_m(0.0).unwrap(), &[0.002, f64::NAN, 0.008, 0.011], 1e-9);
            // Between sections: straight, and missing where one of the two is.
            assert_close(&road.line_m(0.5).unwrap(), &[0.00225, f64::NAN, 0.00825, 0.01125], 1e-9);
            assert_close(&road.line_m(2.0).unwrap(), &[0.003, 0.006, 0.009, 0.012], 1e-9);
        }
    }
}

#[test]
fn a_line_beside_the_road_is_refused() {
    let outside = road("KRBI", "", "").line_m(-1.2).unwrap_err();
    assert_eq!(
        outside.to_string(),
        "-1.2 m beside the reference line is outside of the road, which has heights from -1 to 2 m"
    );
    assert!(road("KRBI", "", "").line_m(f64::NAN).is_err());
}

#[test]
fn slope_and_banking_lift_the_grid() {
    let channels = "D:reference line phi,rad\nD:reference line slope,m/m\nD:reference line banking,m/m\n\
                    D:long section 1,m\nD:long section 2,m\n";
    let road_keys = "reference_line_start_z = 100\nlong_section_v_right = -1\nlong_section_v_increment = 2\n";
    let nan = f64::NAN;
    let rows: [&[f64]; 3] =
        [&[nan, nan, 0.1, 0.0, 0.001], &[0.3, 0.02, 0.2, 0.0, 0.001], &[0.3, 0.04, 0.3, 0.0, 0.001]];
    let read = |road: &str, sections: &str| {
        let bytes = file("LRFI", &format!("{road_keys}{road}"), sections, channels, &text(&rows, 10, 8));
        CrgRoad::from_bytes(&bytes).unwrap()
    };
    // z = 100 + sum of slope times 0.5 m + banking v + grid; the first slope is unused.
    assert_close(&read("", "").line_m(1.0).unwrap(), &[100.101, 100.211, 100.331], 1e-9);
    assert_close(&read("", "").line_m(-1.0).unwrap(), &[99.9, 99.81, 99.73], 1e-9);
    // The end lies 0.03 m up by the slopes; given 0.04, half a centimetre more per row.
    assert_close(
        &read("reference_line_end_z = 100.04\n", "").line_m(1.0).unwrap(),
        &[100.101, 100.216, 100.341],
        1e-9,
    );
    // Length times 2 makes the same slopes twice as high and puts the edge at 1.5 m; the stated end no longer holds.
    let scaled = read(
        "reference_line_end_z = 100.04\n",
        "$ROAD_CRG_MODS\nSCALE_LENGTH = 2\nSCALE_WIDTH = 1.5\nSCALE_Z_GRID = 10\nSCALE_SLOPE = 0.5\nSCALE_BANKING = 0\n\
         SCALE_CURVATURE = 3\nREFPOINT_X = 8\nREFLINE_OFFSET_PHI = 1\n$\n",
    );
    assert_eq!((scaled.increment_m(), scaled.lateral_m()), (1.0, &[-1.5, 1.5][..]));
    assert_close(&scaled.line_m(1.5).unwrap(), &[100.01, 100.02, 100.04], 1e-9);
}

#[test]
fn constant_slope_and_banking_of_the_header() {
    let road = road("LRFI", "reference_line_start_s = 0.1\nreference_line_start_b = -0.05\n", "");
    assert_close(&road.line_m(2.0).unwrap(), &[-0.097, -0.044, 0.009, 0.062], 1e-9);
}

#[test]
fn missing_cells_are_filled_only_when_the_file_asks() {
    let mode = |line: &str| road("LRFI", "", &format!("$ROAD_CRG_MODS\n{line}\n$\n")).line_m(0.0).unwrap()[1];
    assert!(mode("").is_nan());
    assert!(mode("grid_nan_mode = 0").is_nan());
    assert_eq!(mode("grid_nan_mode = 1\ngrid_nan_offset = -0.1"), -0.1);
    assert_eq!(mode("grid_nan_mode = 2"), 0.004);
    assert!((mode("grid_nan_mode = 2\ngrid_nan_offset = 0.1") - 0.104).abs() < 1e-12);
    // At the right edge the neighbor is to the left.
    let edge = text(&[&[f64::NAN, f64::NAN, 0.5], &[f64::NAN; 3]], 10, 8);
    let bytes = file("LRFI", "", "$ROAD_CRG_MODS\nGRID_NAN_MODE = 2\n$\n", CHANNELS, &edge);
    assert_close(&CrgRoad::from_bytes(&bytes).unwrap().line_m(-1.0).unwrap(), &[0.5, f64::NAN], 1e-12);
}

#[test]
fn numbered_sections_lie_where_the_header_says() {
    let channels = "D:long section 2,m\nD:long section 1,m\nD:long section 3,m\n";
    let read = |road: &str| CrgRoad::from_bytes(&file("LRFI", road, "", channels, &data("LRFI")));
    for (road, v) in [
        ("long_section_v_increment = 0.5\n", [-0.5, 0.0, 0.5]),
        ("long_section_v_right = -2\nlong_section_v_left = 4\n", [-2.0, 1.0, 4.0]),
        ("long_section_v_left = 2\nlong_section_v_increment = 1\n", [0.0, 1.0, 2.0]),
    ] {
        let road = read(road).unwrap();
        assert_eq!(road.lateral_m(), v);
        // Number 1 is the rightmost, whatever the order of the columns.
        assert_close(&road.line_m(v[0]).unwrap(), &[0.002, f64::NAN, 0.008, 0.011], 1e-9);
    }
    let text = read("").unwrap_err().to_string();
    assert_eq!(text, "3 numbered long sections, expected long_section_v_increment with them");
    let text = read("long_section_v_right = 0\nlong_section_v_left = 3\nlong_section_v_increment = 1\n")
        .unwrap_err();
    assert!(text.to_string().starts_with("3 numbered (from 0 to 3 m by 1 m) long sections"), "{text}");
}

#[test]
fn wrong_headers_are_refused_by_line() {
    let refuse = |code: &str, road: &str, sections: &str, channels: &str| {
        refusal(&file(code, road, sections, channels, &data("LRFI")))
    };
    assert_eq!(
        refuse("LRFX", "", "", CHANNELS),
        "line 8: data format \"LRFX\", expected #:LRFI, LDFI, KRFI, KDFI, LRBI, LDBI, KRBI or KDBI"
    );
    assert_eq!(
        refuse("LRFI", "reference_line_incremnt = 2\n", "", CHANNELS),
        "line 6: unknown reference_line_incremnt in $ROAD_CRG (did you mean reference_line_increment?)"
    );
    assert_eq!(
        refuse("LRFI", "", "$ROAD_CRG_MODS\nGRID_NAN_MODE = 3\n$\n", CHANNELS),
        "line 8: grid_nan_mode is 3, expected 0, 1 or 2"
    );
    assert_eq!(
        refuse("LRFI", "", "$ROAD_CRG_MODS\nSCALE_LENGTH = 0\n$\n", CHANNELS),
        "line 8: scale_length is 0, expected a positive number"
    );
    assert_eq!(
        refuse("LRFI", "reference_line_end_u = 9.5\n", "", CHANNELS),
        "4 cross sections of data, expected 20 from the header (0 to 9.5 m by 0.5 m)"
    );
    assert_eq!(
        refuse("LRFI", "", "", "D:long section at v = here,m\n"),
        "line 10: data channel \"long section at v = here,m\", expected long section N,m, or long section at v = V,m"
    );
    assert!(refuse("LRFI", "", "", "D:reference line u,m\n").contains("expected rows at even distances"));
    assert_eq!(refuse("LRFI", "", "", "D:long section at v = 1,m\n"), "1 long sections, expected at least 2");
    assert!(
        refuse("LRFI", "", "", &format!("{CHANNELS}D:long section at v = 2,m\n"))
            .starts_with("lines 12 and 13: the same place 2 for two long sections")
    );
    assert!(
        refuse("LRFI", "", "", &format!("{CHANNELS}D:long section 1,m\n"))
            .starts_with("numbered and positioned")
    );
}

#[test]
fn wrong_data_are_refused_by_line_and_column() {
    let with = |data: &str| refusal(&file("LRFI", "", "", CHANNELS, data.as_bytes()));
    let row = " 0.0010000 0.0020000 0.0030000\n";
    assert_eq!(
        with(&format!("{row} 0.0010000 0.00x0000 0.0030000\n")),
        "line 16, columns 11 to 20: found \" 0.00x0000\", expected a number or *missing* in 10 characters"
    );
    assert_eq!(
        with(&format!("{row} 0.0010000 0.002\n")),
        "line 16, columns 11 to 16: found \" 0.002\", expected a number or *missing* in 10 characters"
    );
    assert_eq!(
        with(&format!("{row} 0.0010000 0.0020000\n{row}")),
        "line 16: the data end within a cross section, after 2 of its 3 values"
    );
    assert_eq!(
        with(&format!("{row} 0.0010000 0.0020000 0.0030000 0.0040000\n")),
        "line 16: 40 characters, expected at most 30"
    );
    assert_eq!(with(row), "1 cross sections of data, expected 2 from the header (0 to NaN m by 0.5 m)");
    let end = "reference_line_end_u = 1.5\n";
    let short = &data("KDBI")[..90];
    assert_eq!(
        refusal(&file("KDBI", end, "", CHANNELS, short)),
        "row 4: the data end within a cross section, after 2 of its 3 values"
    );
    let mut infinite = data("KRBI");
    infinite[4..8].copy_from_slice(&f32::INFINITY.to_be_bytes());
    assert_eq!(
        refusal(&file("KRBI", end, "", CHANNELS, &infinite)),
        "row 1, long section at v = 0.0,m: found inf, expected a finite number"
    );
    assert!(matches!(CrgRoad::from_bytes(b"no road"), Err(CrgProblem::NoData)));
}

/// One of the standard's examples. `None` where it is not, which is reported on the stream itself: what the macros print in
/// a test that passes is not shown.
fn example(name: &str) -> Option<CrgRoad> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if !path.exists() {
        stderr().write_all(format!("skipped: no ../shared/data/{name}\n").as_bytes()).unwrap();
        return None;
    }
    Some(CrgRoad::read(&path).unwrap())
}

/// The file and heights in m that the C library of the standard gives for it at (u, v), less its height at u0, v = 0
/// (it lifts the road so that this is zero).
fn held_against_the_library(name: &str, start_m: f64, points: &[(f64, f64, f64)]) {
    let Some(road) = example(name) else { return };
    assert_eq!(road.start_m(), start_m);
    let height = |u: f64, v: f64| {
        let line = road.line_m(v).unwrap();
        let at = (u - start_m) / road.increment_m();
        let row = (at.round() as usize).min(line.len() - 1);
        if (at - row as f64).abs() < 1e-6 {
            return line[row];
        }
        let share = at - at.floor();
        line[at as usize] * (1.0 - share) + line[at as usize + 1] * share
    };
    for &(u, v, z) in points {
        let found = height(u, v) - height(start_m, 0.0);
        // The library keeps heights as f32.
        assert!((found - z).abs() < 1e-7, "{name} {u} {v}: {found} for {z}");
    }
}

#[test]
fn the_standards_examples_agree_with_its_library() {
    held_against_the_library(
        "handmade_curved_banked_sloped.crg",
        0.0,
        &[
            (2.0, -1.5, -0.005_5),
            (2.0, -0.5, 0.016_611_100_2),
            (4.0, 0.0, 0.077_111_100_2),
            (10.0, 1.5, 0.643_5),
            (12.0, -1.0, 0.616_111_100_2),
            (20.0, 1.0, 1.232_111_100_2),
            (22.0, -1.5, 1.21),
        ],
    );
    held_against_the_library(
        "belgian_block.crg",
        730.0,
        &[
            (730.0, -3.4 / 3.0, -0.002_132_813_1),
            (730.0 + 10.0 / 11.0, 0.0, -0.057_487_206),
            (730.0 + 40.0 / 11.0, 0.0, -0.022_226_853_8),
            (730.0 + 60.0 / 11.0, 1.7 / 3.0, -0.008_926_507_2),
            (730.0 + 70.0 / 11.0, -3.4 / 3.0, 0.008_174_614_5),
            (730.0 + 100.0 / 11.0, -1.7 / 3.0, -0.037_904_869_4),
        ],
    );
}

#[test]
fn the_examples_holes_stay_holes() {
    let Some(road) = example("handmade_straight.crg") else { return };
    assert_eq!((road.rows(), road.lateral_m().len(), road.missing_cells()), (23, 7, 3));
    // Written as *missing* in the rows at 7 and 8 m of the rightmost section.
    let holes: Vec<usize> =
        road.line_m(-1.5).unwrap().iter().enumerate().filter(|(_, z)| z.is_nan()).map(|(i, _)| i).collect();
    assert_eq!(holes, [7, 8]);
    let Some(belgian) = example("belgian_block.crg") else { return };
    assert_eq!((belgian.rows(), belgian.lateral_m().len(), belgian.increment_m()), (1001, 341, 0.01));
    // Its right edge was not measured; counted in the file's bytes with another program.
    assert!(belgian.line_m(-1.7).unwrap().iter().all(|z| z.is_nan()));
    assert_eq!(belgian.line_m(-1.5).unwrap().iter().filter(|z| z.is_nan()).count(), 598);
    for v in [-0.75, 0.75] {
        assert!(belgian.line_m(v).unwrap().iter().all(|z| z.is_finite()));
    }
}

proptest! {
    /// A file with bytes changed, cut or put in between: a road with numbers in it or one sentence, never a panic.
    #[test]
    fn no_change_brings_the_reader_down(
        code in proptest::sample::select(vec!["LRFI", "KDFI", "LDBI", "KRBI"]),
        edits in proptest::collection::vec((any::<prop::sample::Index>(), 0u8..3, any::<u8>()), 0..12),
        end in any::<bool>(),
    ) {
        let road = if end { "reference_line_end_u = 1.5\n" } else { "" };
        let mods = "$ROAD_CRG_MODS\nSCALE_LENGTH = 2\nGRID_NAN_MODE = 2\n$\n";
        let channels = format!("D:reference line slope,m/m\n{CHANNELS}");
        let mut bytes = file(code, road, mods, &channels, &data(code));
        for (place, kind, byte) in edits {
            let at = place.index(bytes.len().max(1));
            match kind {
                0 if at < bytes.len() => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ if at % 7 == 0 => bytes.truncate(at),
                _ => {}
            }
            if bytes.is_empty() {
                break;
            }
        }
        match CrgRoad::from_bytes(&bytes) {
            Ok(road) => {
                let v = road.lateral_m()[0];
                let line = road.line_m(v).unwrap();
                prop_assert_eq!(line.len(), road.rows());
                prop_assert!(line.iter().all(|z| !z.is_infinite()));
            }
            Err(problem) => prop_assert!(problem.to_string().len() < 400),
        }
    }
}
