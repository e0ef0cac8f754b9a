//! `itpms vehicle check --field`: an owner's log is judged, and packed without what tells whose it is and where it was.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Read as _;

use serde_json::Value;

use crate::common::{Bench, Outcome, table};

const SCENARIO: &str = include_str!("data/field.toml");
const VIN: &str = "1M8GDM9AXKP042788";
const PRESSURES: &str = "--pressure-kpa 241 --pressure-kpa 480:fl=200 --pressure-kpa 900:fl=160";
/// The car's place in the log: no sensor has such values.
const LATITUDE: &str = "-33.8568";

/// The drive with its vehicle file, whose owner has put the identification number wherever it goes; with places, heights and a message
/// that no one knows, and a clock that counts from 1970.
fn drive(scenario: &str) -> Bench {
    let bench = Bench::new();
    bench.write("field.toml", scenario);
    bench.run("lab simulate field.toml --seed 5 -o plain.csv --vehicle-out plain.toml --no-truth").success();
    let mut out = String::new();
    for (i, line) in bench.read("plain.csv").lines().enumerate() {
        let (time, rest) = line.split_once(',').unwrap();
        if i == 0 {
            let _ = writeln!(out, "{line},latitude_deg,longitude_deg,altitude_m,vin");
        } else {
            let time_s: f64 = time.parse().unwrap();
            let _ = writeln!(out, "{:.3},{rest},{LATITUDE}{i},151.2153{i},1834.25,{VIN}", time_s + 1.7e9);
        }
    }
    bench.write("drive.csv", out);
    let vehicle = bench.read("plain.toml");
    let (head, rest) = vehicle.split_once("name = ").unwrap();
    let (_, rest) = rest.split_once('\n').unwrap();
    bench.write(
        "car.toml",
        format!(
            "# the car {VIN}\n{head}name = \"Sedan {VIN}\"\nid = \"{VIN}\"\nhome_altitude_m = 1834.25\n{rest}"
        ),
    );
    bench
}

fn check(bench: &Bench, more: &str) -> Outcome {
    bench.run(&format!("vehicle check drive.csv --vehicle car.toml --field {more}"))
}

fn unpacked(bench: &Bench, name: &str) -> Vec<(String, String)> {
    let mut archive = zip::ZipArchive::new(File::open(bench.path(name)).unwrap()).unwrap();
    (0..archive.len())
        .map(|i| {
            let mut text = String::new();
            let mut file = archive.by_index(i).unwrap();
            let name = file.name().unwrap().into_owned();
            file.read_to_string(&mut text).unwrap();
            (name, text)
        })
        .collect()
}

/// The archive has what was asked for, no person or place is found in any file, and it is estimated like the log.
#[test]
fn a_good_log_is_packed_without_its_owner_and_its_places() {
    let bench = drive(SCENARIO);
    let note = format!("--note 1M8GDM9AXKP042788,dry {PRESSURES} -o car.zip");
    let outcome = check(&bench, &note);
    let reported = outcome.success();
    assert!(reported.contains("known pressures: fl 241, fr 241, rl 241, rr 241 kPa from 0 s"), "{reported}");
    assert!(reported.contains("fl 160 kPa from 900 s") && !reported.contains("to mend"), "{reported}");
    for left_out in
        ["latitude_deg", "longitude_deg", "altitude_m", "the vehicle file's id", "home_altitude_m"]
    {
        assert!(outcome.stderr.contains(left_out), "{outcome:?}");
    }
    let files = unpacked(&bench, "car.zip");
    assert_eq!(
        files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        ["drive.csv", "vehicle.toml", "manifest.json"]
    );
    for (name, text) in &files {
        for secret in [VIN, LATITUDE, "151.2153", "1834.25", "17000000"] {
            assert!(!text.contains(secret), "{name} has {secret}");
        }
    }
    let [log, vehicle, manifest] = [0, 1, 2].map(|i: usize| files[i].1.clone());
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let gauge: Vec<f64> =
        (0..3).map(|i| manifest["pressures"][i]["gauge"]["fl_kpa"].as_f64().unwrap()).collect();
    assert_eq!(gauge, [241.0, 200.0, 160.0]);
    assert_eq!(manifest["note"], "(removed),dry");
    assert_eq!(manifest["sample_rate_hz"], 100.0);
    // Every value that was measured is there, to a millionth.
    let (head, rows) = table(&log);
    let (plain_head, plain_rows) = table(&bench.read("plain.csv"));
    assert_eq!(head, plain_head);
    assert_eq!(rows.len(), plain_rows.len());
    for (row, plain) in rows.iter().zip(&plain_rows).step_by(97) {
        for (cell, plain) in row.iter().zip(plain) {
            let [cell, plain] = [cell, plain].map(|cell| cell.parse::<f64>().unwrap_or(f64::NAN));
            assert!((cell - plain).abs() < 2e-6 || (cell.is_nan() && plain.is_nan()), "{row:?} {plain:?}");
        }
    }
    // What comes out of the archive goes through the program again.
    bench.write("again.csv", log);
    bench.write("again.toml", vehicle);
    let again = bench.run(&format!("vehicle check again.csv --vehicle again.toml --field {PRESSURES}"));
    assert!(again.success().contains("known pressures"), "{again:?}");
    assert!(!again.stderr.contains("left out"), "{again:?}");
}

/// A bus without accelerometers and without a separate speed: its wheels tell when it stands.
#[test]
fn wheel_speeds_alone_are_judged_as_such() {
    let bench = drive(
        &SCENARIO.replace("alone = false", "alone = true").replace("rate_hz = 100.0", "rate_hz = 50.0"),
    );
    let without_speed = |text: String| text.replacen("speed_m_s,", "some_number,", 1);
    let (head, rows) =
        bench.read("drive.csv").split_once('\n').map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    bench.write("drive.csv", format!("{}\n{rows}", without_speed(head)));
    let outcome = check(&bench, &format!("{PRESSURES} -o car.zip"));
    assert!(outcome.success().contains("sensors: four wheel speeds, yaw rate, brake"), "{outcome:?}");
    assert!(!outcome.stdout.contains("accelerations"), "{outcome:?}");
    let files = unpacked(&bench, "car.zip");
    assert!(files.iter().all(|(_, text)| !text.contains(VIN) && !text.contains(LATITUDE)));
    assert!(files[0].1.starts_with("time_s,fl_wheel_speed_m_s"), "{}", &files[0].1[..80]);
    let json = check(&bench, &format!("{PRESSURES} --json"));
    let document: Value = serde_json::from_str(json.success()).unwrap();
    assert_eq!((&document["good"], &document["faults"]), (&Value::Bool(true), &serde_json::json!([])));
}
