//! `itpms roughness`: profiles, OpenCRG and drives in, tables and JSON out; unusable inputs refused.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use common::{Bench, table};
use serde_json::Value;

fn ok(bench: &Bench, line: &str) -> String {
    bench.run(line).success().to_owned()
}

/// A sine of 2.4 m and 1 mm on the left, of 5 m on the right, 250 m long at 5 cm.
fn two_sines() -> String {
    let mut text = String::from("distance_m,left_height_m,right_height_m\n");
    for i in 0..=5000 {
        let x = f64::from(i) * 0.05;
        let wave = |length: f64| 0.001 * (TAU * x / length).sin();
        _ = writeln!(text, "{x:.2},{:.9},{:.9}", wave(2.4), wave(5.0));
    }
    text
}

#[test]
fn a_profile_of_two_tracks() {
    let bench = Bench::new();
    bench.write("road.csv", two_sines());
    let json: Value = serde_json::from_str(&ok(&bench, "roughness road.csv -o table.csv --json")).unwrap();
    // From an independent script for 1 mm at these wavelengths, without the 250 mm average, which takes sinc(n 0.25)
    // of a wave; 0.3 % for the start and the grid.
    let sinc = |n: f64| (PI * n * 0.25).sin() / (PI * n * 0.25);
    let (left, right) = (2.7698 * sinc(1.0 / 2.4), 0.9356 * sinc(0.2));
    let segment = &json["segments"][1];
    for (i, expected) in [left, right].into_iter().enumerate() {
        let found = segment["tracks"][i]["iri_m_per_km"].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < 3e-3, "{found} for {expected}");
    }
    let mean = segment["mri_m_per_km"].as_f64().unwrap();
    assert!((mean / (0.5 * (left + right)) - 1.0).abs() < 3e-3);
    assert_eq!(json["segments"][2]["tracks"][0]["note"], "too little road: 50 of 100 m");
    let table = bench.read("table.csv");
    assert_eq!(table.lines().count(), 7, "a header, three segments of two tracks");
    assert!(table.starts_with("start_m,end_m,track,known_m,iri_m_per_km,mri_m_per_km,"));
    let text = ok(&bench, "roughness road.csv --segment-m 50");
    assert!(text.contains("200.0 - 250.0  right") && text.contains("MRI"), "{text}");
}

#[test]
fn a_segment_longer_than_the_road_is_the_road() {
    let bench = Bench::new();
    bench.write("road.csv", two_sines());
    for asked in ["300", "1e9", "1e300"] {
        let line = format!("roughness road.csv --segment-m {asked} -o table.csv --json");
        let json: Value = serde_json::from_str(&ok(&bench, &line)).unwrap();
        let [segment] = &json["segments"].as_array().unwrap()[..] else { panic!("{json}") };
        assert_eq!(segment["end_m"], 250.0);
        for i in 0..2 {
            assert_eq!(segment["tracks"][i]["iri_m_per_km"], json["tracks"][i]["iri_m_per_km"]);
        }
        assert!(bench.read("table.csv").contains("\n0.000000,250.000000,left,250.000000,"));
    }
}

#[test]
fn an_opencrg_road() {
    let bench = Bench::new();
    // A ramp of 1 in 100 to the left: both tracks are smooth. Sections at -1 and 1 m, 0.25 m apart, 60 m.
    let mut text = String::from(
        "$ROAD_CRG\nreference_line_increment = 0.25\nlong_section_v_increment = 2\n$\n\
         $KD_DEFINITION\n#:LRFI\nD:long section 1,m\nD:long section 2,m\n$\n$$$$\n",
    );
    for i in 0..=240 {
        let left = if i == 100 { "*missing*".to_owned() } else { format!("{:.6}", 0.01 * f64::from(i % 2)) };
        _ = writeln!(text, "{:>10.6}{left:>10}", 0.0025 * f64::from(i));
    }
    bench.write("road.crg", text);
    let outcome = bench.run("roughness road.crg --segment-m 30 --lateral-m 1,-1 --json");
    let json: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(json["warnings"][0], "left: 1 missing heights bridged, in holes of 0.25 m or less");
    assert!(json["tracks"][1]["iri_m_per_km"].as_f64().unwrap() < 1e-3, "{json}");
    // One track, named so.
    let text = ok(&bench, "roughness road.crg --segment-m 30 --lateral-m=-0.5");
    assert!(text.starts_with("road.crg: 60.0 m by 0.25 m, road at -0.5 m\n"), "{text}");
    let refusal = bench.run("roughness road.crg --lateral-m 1.5");
    assert!(
        refusal.refusal().contains("1.5 m beside the reference line is outside of the road"),
        "{refusal:?}"
    );
}

#[test]
fn a_car_drives_over_an_opencrg_road() {
    let bench = Bench::new();
    let mut text = String::from(
        "$ROAD_CRG\nreference_line_increment = 0.1\nlong_section_v_increment = 1\n$\n\
         $KD_DEFINITION\n#:LDFI\nD:long section 1,m\nD:long section 2,m\n$\n$$$$\n",
    );
    // Waves of 5 m: 3 mm on the one side, 1 mm on the other, so 2 mm along the line between them; ten of them.
    let wave = |x: f64| (TAU * x / 5.0).sin();
    for i in 0..=500 {
        let z = wave(0.1 * f64::from(i));
        _ = writeln!(text, "{:>20.12}{:>20.12}", 0.003 * z, 0.001 * z);
    }
    bench.write("road.crg", text);
    bench.write(
        "drive.toml",
        "name = \"block\"\ndescription = \"a measured road\"\nduration_s = 4.0\nrate_hz = 200.0\n\
         [speed]\nconstant_km_h = 36.0\n[road.surface.profile]\nfile = \"road.crg\"\n[corner.fl.pressure]\nconstant_kpa = 241.3\n",
    );
    ok(&bench, "simulate drive.toml -o drive.csv");
    let (header, rows) = table(&bench.read("drive.csv"));
    let road = header.iter().position(|name| name == "fl_road_m").unwrap();
    for row in &rows {
        let (time_s, height_m): (f64, f64) = (row[0].parse().unwrap(), row[road].parse().unwrap());
        // 10 m/s; the spline through points 0.1 m apart is that wave to 1e-6.
        assert!((height_m - 0.002 * wave(10.0 * time_s)).abs() < 1e-5, "{time_s} {height_m}");
    }
    bench.write("drive.toml", bench.read("drive.toml").replace("road.crg", "none.crg"));
    assert_eq!(bench.run("simulate drive.toml -o other.csv").refusal(), "none.crg: no such file");
}

#[test]
fn a_drive_is_estimated_first_and_its_road_file_gives_the_same() {
    let bench = Bench::with_drive();
    ok(&bench, "estimate drive.csv --vehicle car.toml -o est.csv --road-out road.csv");
    let of = |line: &str| -> Value { serde_json::from_str(&ok(&bench, line)).unwrap() };
    let drive = of("roughness drive.csv --vehicle car.toml --segment-m 50 --json");
    let road = of("roughness road.csv --segment-m 50 --json");
    let first = |value: &Value| value["segments"][1]["tracks"][0].clone();
    let (drive, road) = (first(&drive), first(&road));
    assert_eq!(drive["track"], road["track"]);
    // The file rounds heights and distances.
    let iri = |value: &Value| value["iri_m_per_km"].as_f64().unwrap();
    assert!((iri(&drive) / iri(&road) - 1.0).abs() < 1e-3, "{drive} {road}");
    // The same road in Parquet, unrounded; a drive in Parquet is none.
    ok(&bench, "estimate drive.csv --vehicle car.toml -o est.csv --road-out road.parquet");
    let parquet = first(&of("roughness road.parquet --segment-m 50 --json"));
    assert!((iri(&drive) / iri(&parquet) - 1.0).abs() < 1e-6, "{drive} {parquet}");
    ok(&bench, "convert drive.csv drive.parquet");
    assert!(
        bench.run("roughness drive.parquet").refusal().starts_with("drive.parquet: looks like a drive log")
    );
    let (head, rows) =
        bench.read("drive.csv").split_once('\n').map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    let at = head.split(',').position(|name| name == "speed_m_s").unwrap();
    let nobody_knows = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells[at] = "";
        cells.join(",") + "\n"
    };
    bench.write("slow.csv", format!("{head}\n{}", rows.lines().map(nobody_knows).collect::<String>()));
    let refusal = "slow.csv: speed_m_s never says that the car moves, so no distance: expected speeds above zero, or --speed-m-s V";
    assert_eq!(bench.run("roughness slow.csv --vehicle car.toml").refusal(), refusal);
    ok(&bench, "roughness slow.csv --vehicle car.toml --speed-m-s 5.6");
    // A wire that breaks for ten seconds.
    bench.edit_drive(|line, cells| {
        if line > 1 && (20.0..30.0).contains(&cells[0].parse::<f64>().unwrap()) {
            "0".clone_into(&mut cells[at]);
        }
    });
    let broken = bench.run("roughness drive.csv --vehicle car.toml");
    assert!(broken.stderr.contains("for 8.0 s speed_m_s says that the car stands"), "{broken:?}");
    assert!(broken.success().contains("driven"), "{broken:?}");
    // The paper drives at 20 km/h: half a hertz is 11 m.
    assert!(drive["note"].as_str().unwrap().contains("of its waves: reads low"), "{drive}");
}

/// A car at 72 km/h on a road of class A with holes and bumps, the positions of a receiver at 1 Hz along a meridian beside it.
fn drive_over_holes(bench: &Bench) {
    let hole = |at_m: f64, depth_m: f64, tracks: &str| {
        format!(
            "[[road.pothole]]\nat_m = {at_m:?}\nlength_m = 0.6\ndepth_m = {depth_m:?}\nedge_m = 0.15\ntracks = \"{tracks}\"\n"
        )
    };
    let holes: String = HOLES.iter().map(|(at_m, height_m, tracks)| hole(*at_m, -height_m, tracks)).collect();
    let corners: String = ["fl", "fr", "rl", "rr"]
        .map(|corner| format!("[corner.{corner}.pressure]\nconstant_kpa = 241.3\n"))
        .concat();
    bench.write(
        "holes.toml",
        format!(
            "name = \"holes\"\ndescription = \"holes and bumps\"\nduration_s = 30.0\nrate_hz = 400.0\n\
             [speed]\nconstant_km_h = 72.0\n[road]\ncontact_length_m = 0.1\n\
             surface.iso8608 = {{ roughness = \"A\", slope = 2.0 }}\n{holes}[car]\n{corners}"
        ),
    );
    ok(bench, "simulate holes.toml -o drive.csv --vehicle-out car.toml");
    bench.edit_drive(|line, cells| {
        let time_s = cells[0].parse().unwrap_or(f64::NAN);
        cells.extend(match (line, line.saturating_sub(2) % 400) {
            (1, _) => ["latitude_deg".to_owned(), "longitude_deg".to_owned()],
            (_, 0) => [format!("{:.9}", latitude_deg(20.0 * time_s)), "11.5".to_owned()],
            _ => [String::new(), String::new()],
        });
    });
}

/// Where they begin on the front wheels' way, in m, how high they are, and their tracks.
const HOLES: [(f64, f64, &str); 4] =
    [(150.0, -0.03, "left"), (260.0, 0.025, "right"), (380.0, -0.02, "both"), (470.0, 0.03, "left")];

/// A meridian over the distance, on a sphere of 6371 km.
fn latitude_deg(distance_m: f64) -> f64 {
    48.0 + (distance_m / 6.371e6).to_degrees()
}

#[test]
fn holes_and_bumps_are_on_the_map_where_they_are() {
    let bench = Bench::new();
    drive_over_holes(&bench);
    let text = ok(&bench, "roughness drive.csv --vehicle car.toml --geojson road.geojson --map road.html");
    let page = bench.read("road.html");
    assert!(page.contains("The road of drive.csv") && !page.contains("http:") && !page.contains("https:"));
    assert_eq!(
        page.matches("<path class=\"spot\" transform").count(),
        page.matches("</td><td>2</td></tr>").count()
    );
    assert!(text.contains("left   hole of ") && text.contains("right  bump of "), "{text}");
    let road: Value = serde_json::from_str(&bench.read("road.geojson")).unwrap();
    assert_eq!(road["type"], "FeatureCollection");
    let features = road["features"].as_array().unwrap();
    let of = |kind: &str| {
        features.iter().filter(|feature| feature["geometry"]["type"] == kind).collect::<Vec<_>>()
    };
    let lines = of("LineString");
    // 600 m, of which the first and the last meters are not seen.
    assert!((5..=6).contains(&lines.len()), "{}", lines.len());
    for line in lines {
        assert!(line["properties"]["iri_m_per_km"].as_f64().unwrap() > 0.5);
        let first = &line["geometry"]["coordinates"][0];
        let start_m = line["properties"]["start_m"].as_f64().unwrap();
        assert!((first[0].as_f64().unwrap() - 11.5).abs() < 1e-9);
        assert!((first[1].as_f64().unwrap() - latitude_deg(start_m)).abs() < 2e-6);
    }
    let points = of("Point");
    let sides = |tracks: &'static str| if tracks == "both" { vec!["left", "right"] } else { vec![tracks] };
    let expected: Vec<_> = HOLES
        .iter()
        .flat_map(|(at_m, height_m, tracks)| {
            sides(tracks).into_iter().map(|side| (*at_m, *height_m, side.to_owned()))
        })
        .collect();
    assert_eq!(points.len(), expected.len(), "{points:?}");
    for (at_m, height_m, side) in expected {
        let near = |point: &&&Value| {
            let distance_m = point["properties"]["distance_m"].as_f64().unwrap();
            (distance_m - at_m - 0.3).abs() < 0.6 && point["properties"]["track"] == *side
        };
        let point = points.iter().find(near).unwrap_or_else(|| panic!("{at_m} {side}: {points:?}"));
        let about = &point["properties"];
        assert_eq!(about["kind"], if height_m < 0.0 { "hole" } else { "bump" });
        assert_eq!(about["passes"], 2, "{point}");
        let error_mm = about["height_mm"].as_f64().unwrap() - 1e3 * height_m;
        assert!(error_mm.abs() < 2.0 * about["height_sd_mm"].as_f64().unwrap(), "{point}");
        let latitude = point["geometry"]["coordinates"][1].as_f64().unwrap();
        assert!((latitude - latitude_deg(at_m + 0.3)).abs() < 1e-5, "{point}");
        assert!((about["time_s"].as_f64().unwrap() - at_m / 20.0).abs() < 0.1);
    }
}

#[test]
fn where_the_car_was_is_written_where_it_is_asked_for_only() {
    let bench = Bench::new();
    drive_over_holes(&bench);
    let columns = |line: &str, name: &str| {
        let outcome = bench.run(line);
        outcome.success();
        (bench.read(name).lines().next().unwrap().contains("latitude_deg"), outcome.stderr)
    };
    let (told, remarks) = columns("convert drive.csv plain.csv", "plain.csv");
    assert!(!told && remarks.contains("expected --positions"), "{remarks}");
    assert!(columns("convert drive.csv full.csv --positions", "full.csv").0);
    let all =
        "estimate drive.csv --vehicle car.toml -o est.csv --events events.jsonl --report report.html --json";
    let summary = ok(&bench, all);
    for text in [summary, bench.read("est.csv"), bench.read("events.jsonl"), bench.read("report.html")] {
        assert!(!text.contains("latitude") && !text.contains("48.000"), "a position is in an output");
    }
    let refusal = bench.run("roughness plain.csv --vehicle car.toml --geojson road.geojson");
    assert!(refusal.refusal().starts_with("plain.csv: no latitude_deg and longitude_deg"), "{refusal:?}");
    assert!(!bench.names().contains(&"road.geojson".to_owned()));
}
