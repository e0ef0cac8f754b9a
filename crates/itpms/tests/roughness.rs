//! `itpms roughness`: profiles, OpenCRG and drives in, tables and JSON out; unusable inputs refused.

use serde_json::Value;

use crate::common::Bench;

fn ok(bench: &Bench, line: &str) -> String {
    bench.run(line).success().to_owned()
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
    let (reported, remarks) = columns("convert drive.csv plain.csv", "plain.csv");
    assert!(!reported && remarks.contains("expected --positions"), "{remarks}");
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
