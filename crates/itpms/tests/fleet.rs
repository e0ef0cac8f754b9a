//! `itpms fleet`: every drive as `itpms estimate` has it, failures listed, a killed run goes on, nothing is done twice.

use std::collections::BTreeMap;
use std::fs;
use std::process::Stdio;
use std::time::Duration;

use serde_json::Value;

use crate::common::{Bench, Outcome, table};

/// Twelve seconds of a whole car; the rear right tire at the pressure that is put in, from 6 s on.
const DRIVE: &str = r#"
name = "short"
duration_s = 12.0
rate_hz = 200.0
settle_s = 5.0
wheelbase_m = 2.7
[speed]
constant_km_h = 70.0
[road.surface.iso8608]
roughness = "B"
slope = 2.0
[sensor]
noise_m_s2 = 0.05
[car]
[corner.fl]
pressure.constant_kpa = 241.3
[corner.fr]
pressure.constant_kpa = 241.3
[corner.rl]
pressure.constant_kpa = 241.3
[corner.rr]
pressure.points_s_kpa = [[5.5, 241.3], [6.0, REAR]]
"#;

/// Nine drives of three cars (in folders, and by their names) and three files that are none.
const DRIVES: [(&str, f64); 9] = [
    ("logs/alpha/drive1.csv", 241.3),
    ("logs/alpha/drive2.parquet", 241.3),
    ("logs/alpha/drive10.csv", 140.0),
    ("logs/bravo/2026/a.csv", 241.3),
    ("logs/bravo/2026/b.csv", 235.0),
    ("logs/bravo/2027/a.csv", 241.3),
    ("logs/charlie_1.csv", 150.0),
    ("logs/charlie_2.csv", 241.3),
    ("logs/charlie-3.csv", 241.3),
];
const BROKEN: [&str; 3] = ["logs/alpha/drive11.parquet", "logs/bravo/2027/b.csv", "logs/stranger.csv"];
const FLEET: &str = "--quiet fleet logs/**/*.csv logs/**/*.parquet --vehicle-dir cars --out out";

fn bench() -> Bench {
    let bench = Bench::new();
    for folder in ["cars", "logs/alpha", "logs/bravo/2026", "logs/bravo/2027"] {
        fs::create_dir_all(bench.path(folder)).unwrap();
    }
    for (seed, (name, rear_kpa)) in DRIVES.iter().enumerate() {
        bench.write("drive.toml", DRIVE.replace("REAR", &rear_kpa.to_string()));
        bench
            .run(&format!(
                "--quiet simulate drive.toml --seed {seed} -o {name} --vehicle-out cars/alpha.toml"
            ))
            .success();
    }
    for car in ["bravo", "charlie"] {
        bench.write(&format!("cars/{car}.toml"), bench.read("cars/alpha.toml"));
    }
    let whole = fs::read(bench.path("logs/alpha/drive2.parquet")).unwrap();
    bench.write(BROKEN[0], &whole[..whole.len() / 2]);
    bench.write(BROKEN[1], "neither,a\ndrive,log\n");
    bench.write(BROKEN[2], bench.read("logs/charlie_1.csv"));
    bench
}

/// Rows of a table by the columns' names; no cell of these tests but the last column's and errors' has a comma in it.
fn rows(bench: &Bench, name: &str) -> Vec<BTreeMap<String, String>> {
    let (names, rows) = table(&bench.read(name));
    rows.into_iter().map(|row| names.iter().cloned().zip(row).collect()).collect()
}

fn number(text: &str) -> Option<f64> {
    (!text.is_empty()).then(|| text.parse().unwrap())
}

/// How often a wheel's warning began, and when first, by the estimates of every sample.
fn warnings(bench: &Bench, estimates: &str, wheel: &str) -> (usize, Option<f64>) {
    let rows = rows(bench, estimates);
    let column = format!("{wheel}_warning");
    let words: Vec<&str> =
        std::iter::once("none").chain(rows.iter().map(|row| row[&column].as_str())).collect();
    let begun: Vec<usize> = (0..rows.len()).filter(|i| words[*i] != "low" && words[i + 1] == "low").collect();
    (begun.len(), begun.first().map(|i| rows[*i]["time_s"].parse().unwrap()))
}

#[test]
fn a_dozen_drives_are_what_estimate_makes_of_each_and_three_fail() {
    let bench = bench();
    let outcome = bench.run(&format!("{FLEET} --calibrate-s 5 --reports --estimates --jobs 2"));
    let reported = outcome.success().trim_end().lines().last().unwrap().to_owned();
    assert_eq!(reported, "9 of 12 drives of 3 cars estimated; 3 failed: out/failed.csv");
    let failed: Vec<String> = rows(&bench, "out/failed.csv").iter().map(|row| row["file"].clone()).collect();
    assert_eq!(failed, BROKEN);
    assert!(bench.read("out/failed.csv").contains("stranger.csv: no car's"));

    let fleet = rows(&bench, "out/fleet.csv");
    assert_eq!(fleet.len(), 9 * 4);
    let first = ["logs/alpha/drive1.csv", "logs/bravo/2026/a.csv", "logs/charlie-3.csv"];
    for (name, rear_kpa) in DRIVES {
        let car = ["alpha", "bravo", "charlie"].into_iter().find(|car| name.contains(car)).unwrap();
        let calibrated = first.into_iter().find(|drive| drive.contains(car)).unwrap();
        let how = if name == calibrated {
            "--calibrate-s 5".to_owned()
        } else {
            format!("--reference out/references/{calibrated}.reference")
        };
        let line = format!(
            "estimate {name} --vehicle cars/{car}.toml {how} -o all.csv --rate 200 --report r.html --json"
        );
        let json: Value = bench.json(&line);
        bench.run(&format!("estimate {name} --vehicle cars/{car}.toml {how} -o est.csv")).success();
        assert_eq!(bench.read(&format!("out/estimates/{name}.csv")), bench.read("est.csv"), "{name}");
        for row in fleet.iter().filter(|row| row["file"] == name) {
            let corner = &json["corners"][&row["wheel"]];
            for (column, value) in [
                ("pressure_kpa", &corner["last"]["pressure_kpa"]),
                ("pressure_sd_kpa", &corner["last"]["sd_kpa"]),
                ("lowest_kpa", &corner["lowest"]["pressure_kpa"]),
                ("share_valid", &corner["share_valid"]),
                ("iri_m_per_km", &corner["road"]["iri_m_per_km"]),
                ("incoherence", &corner["fit"]["incoherence"]),
                ("unexplained", &corner["fit"]["unexplained"]),
                ("hop_excess", &corner["fit"]["hop_excess"]),
                ("friction_n", &corner["fit"]["friction_n"]),
                ("distance_m", &json["distance_m"]),
                ("duration_s", &json["duration_s"]),
            ] {
                assert_eq!(number(&row[column]), value.as_f64(), "{name} {column} {row:?}");
            }
            assert_eq!(row["warning"], corner["warning"].as_str().unwrap());
            assert_eq!(row["misfit"].is_empty(), corner["fit"]["misfit"].is_null(), "{name} {row:?}");
            assert_eq!(row["car"], car);
            let (count, first_s) = warnings(&bench, "all.csv", &row["wheel"]);
            assert_eq!(
                (row["warnings"].parse::<usize>().unwrap(), number(&row["first_warning_s"])),
                (count, first_s)
            );
            let low = rear_kpa < 160.0 && row["wheel"] == "rr";
            assert_eq!(count > 0, low, "{name} {row:?}");
            assert_eq!(row["calibration"], if name == calibrated { "drive" } else { "carried" });
        }
        assert!(bench.read(&format!("out/reports/{name}.html")).contains("</html>"));
    }
    let page = bench.read("out/index.html");
    // The worst first; each with its report. charlie's low drive is not its last one.
    assert!(page.contains("1 of 3 cars has a low tire"), "{}", &page[..600]);
    assert!(page.contains("href=\"reports/logs/alpha/drive10.csv.html\""));
    // Of alpha and of bravo a drive after the last good one is broken; the car of the third is unknown.
    assert_eq!(page.matches("1\u{a0}later drive failed</a>").count(), 2);
    // Nothing is loaded from anywhere.
    assert!(["src=", "href=\"http", "url(", "@import", "<link"].iter().all(|load| !page.contains(load)));
}

#[test]
fn a_killed_run_goes_on_where_it_was_and_a_third_does_nothing() {
    let bench = bench();
    bench.run(&FLEET.replace("--out out", "--out whole")).success();
    let mut command = bench.command(format!("{FLEET} --jobs 1").split_whitespace());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let kept =
        || fs::read_to_string(bench.path("out/drives.jsonl")).unwrap_or_default().matches("\"file\"").count();
    for _ in 0..6000 {
        if kept() >= 3 {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    // SIGKILL: nothing can be tidied up.
    child.kill().unwrap();
    child.wait().unwrap();
    let before = kept();
    assert!((3..9).contains(&before), "{before} drives were done when it was killed");
    assert!(!bench.path("out/fleet.csv").exists());
    // As if the power had failed in the middle of a line.
    let torn = bench.read("out/drives.jsonl") + "{\"file\":\"logs/al";
    bench.write("out/drives.jsonl", torn);
    let last = |outcome: &Outcome| outcome.success().trim_end().lines().last().unwrap().to_owned();
    let again = bench.run(FLEET);
    assert!(last(&again).contains(&format!("({before} of them before)")), "{again:?}");
    assert_eq!(bench.read("out/fleet.csv"), bench.read("whole/fleet.csv"));
    let third = bench.run(FLEET);
    assert!(last(&third).contains("(9 of them before)"), "{third:?}");
    // A changed log, another setting, another vehicle file: only what they concern is done again.
    bench.write("logs/charlie_2.csv", bench.read("logs/charlie_1.csv") + "# again\n");
    assert!(last(&bench.run(FLEET)).contains("(8 of them before)"));
    bench.write("cars/bravo.toml", bench.read("cars/bravo.toml") + "\n# checked\n");
    assert!(last(&bench.run(FLEET)).contains("(6 of them before)"));
    assert!(!last(&bench.run(&format!("{FLEET} --regulation fmvss-138"))).contains("before"));
}

/// A car of which no drive could be estimated is not left out of the cars, let alone fine.
#[test]
fn a_car_none_of_whose_drives_could_be_estimated_is_unknown() {
    let bench = bench();
    bench.write("logs/charlie-3.csv", "time_s\n");
    let reported =
        bench.run("--quiet fleet logs/alpha/drive1.csv logs/charlie-3.csv --vehicle-dir cars --out out");
    let line = "charlie: unknown, its only drive could not be estimated";
    assert!(reported.success().lines().any(|reported| reported == line), "{reported:?}");
    let page = bench.read("out/index.html");
    assert!(page.contains("<tr><th scope=\"row\">charlie</th>"));
    assert!(page.contains("no drive could be estimated</td>"));
}

/// A digit that was changed on the disk is not believed, and what is no drive is a row in failed.csv.
#[cfg(unix)]
#[test]
fn what_is_not_as_it_was_written_is_estimated_again_and_odd_names_are_harmless() {
    use std::os::unix::fs::symlink;
    let bench = Bench::with_drive();
    fs::create_dir_all(bench.path("logs")).unwrap();
    let long = format!("logs/{}.csv", "n".repeat(251));
    for name in ["logs/a.csv", "logs/=cmd|x.csv", &long] {
        // A copy would be left out.
        bench.write(name, format!("# {name}\n{}", bench.read("drive.csv")));
    }
    symlink("/nowhere.csv", bench.path("logs/dangling.csv")).unwrap();
    symlink("..", bench.path("logs/up")).unwrap();
    let line = "--quiet fleet logs/*.csv logs/up/*/*.csv --vehicle car.toml --out out --estimates --reports";
    let last = |outcome: &Outcome| outcome.success().trim_end().lines().last().unwrap().to_owned();
    let first = bench.run(line);
    assert_eq!(last(&first), "3 of 4 drives of 1 car estimated; 1 failed: out/failed.csv", "{first:?}");
    assert!(bench.read("out/failed.csv").contains("logs/dangling.csv: leads to no file"));
    let fleet = bench.read("out/fleet.csv");
    let kept = bench.read("out/drives.jsonl");
    let at = kept.find("\"pressure_kpa\":").unwrap() + "\"pressure_kpa\":".len();
    let mut forged = kept.clone().into_bytes();
    forged[at] = if forged[at] == b'9' { b'1' } else { forged[at] + 1 };
    bench.write("out/drives.jsonl", forged);
    let again = bench.run(line);
    assert!(last(&again).contains("3 of 4 drives of 1 car estimated (2 of them before)"), "{again:?}");
    assert!(again.stderr.contains("drives.jsonl: 1 line damaged"), "{again:?}");
    assert_eq!(bench.read("out/fleet.csv"), fleet);
}

/// Cars that are not quite as their file says, on one road. Their positions are off so many meters along it.
const ROAD_CARS: [(&str, f64, f64, &str); 3] = [
    ("ada", 64.0, 5.0, "tire_stiffness_factor = 1.08\nunsprung_mass_factor = 0.95\nspring_factor = 1.1\n"),
    ("bob", 72.0, 0.0, "tire_stiffness_factor = 0.93\nsprung_mass_factor = 1.1\n"),
    ("cyd", 83.0, -3.0, "unsprung_mass_factor = 1.07\ndamping_factor = 1.15\nspring_factor = 0.9\n"),
];

/// Their drives, a folder a car; 1100 m due north-east, a position a second.
fn cars_on_one_road() -> Bench {
    let bench = Bench::new();
    for (car, km_h, off_m, truth) in ROAD_CARS {
        fs::create_dir_all(bench.path(&format!("logs/{car}"))).unwrap();
        let corners: String = ["fl", "fr", "rl", "rr"]
            .map(|corner| {
                format!("[corner.{corner}]\npressure.constant_kpa = 241.3\n[corner.{corner}.truth]\n{truth}")
            })
            .concat();
        bench.write(
            "road.toml",
            format!(
                "name = \"road\"\nduration_s = {}\nrate_hz = 200.0\nsettle_s = 5.0\nwheelbase_m = 2.7\n[speed]\nconstant_km_h = {km_h}\n\
                 [road.surface.segments]\nafter_last = \"repeat\"\nlist = [{{ length_m = 150.0, roughness = \"A\", slope = 2.0 }}, {{ length_m = 120.0, roughness = \"B\", slope = 2.0 }}, \
                 {{ length_m = 100.0, roughness = 30e-6, slope = 2.0 }}]\n[sensor]\nnoise_m_s2 = 0.05\n[car]\n{corners}",
                3960.0 / km_h
            ),
        );
        bench.run("--quiet simulate road.toml --seed 9 -o drive.csv --vehicle-out car.toml").success();
        let m_s = km_h / 3.6;
        bench.edit_drive(|line, cells| {
            let way_m = off_m + m_s * cells[0].parse::<f64>().unwrap_or(0.0);
            let degrees = |share: f64| format!("{:.8}", share + 0.707 * way_m / 111_195.0);
            cells.extend(match (line, line % 200) {
                (1, _) => ["latitude_deg".to_owned(), "longitude_deg".to_owned()],
                (_, 2) => [degrees(0.01), degrees(0.01)],
                _ => [String::new(), String::new()],
            });
        });
        bench.write(&format!("logs/{car}/drive.csv"), bench.read("drive.csv"));
    }
    bench
}

#[test]
fn the_roads_of_a_fleet_are_one_map_with_a_factor_for_each_car() {
    let bench = cars_on_one_road();
    let line = "--quiet fleet logs/**/*.csv --vehicle car.toml --vehicle-dir cars --out out";
    fs::create_dir_all(bench.path("cars")).unwrap();
    for (car, ..) in ROAD_CARS {
        bench.write(&format!("cars/{car}.toml"), bench.read("car.toml"));
    }
    let line = line.replace("--vehicle car.toml ", "");
    // It was not asked for.
    bench.run(&line).success();
    assert!(!bench.path("out/road.geojson").exists());
    assert!(
        !bench.read("out/index.html").contains("id=\"roads\"")
            && !bench.read("out/drives.jsonl").contains("\"road\"")
    );
    bench.run(&format!("{line} --map")).success();
    let page = bench.read("out/index.html");
    // Nothing is asked of a network.
    let page = page.replace("http://www.w3.org/2000/svg", "");
    assert!(page.contains("id=\"roads\"") && !page.contains("http:") && !page.contains("https:"));
    let road: Value = serde_json::from_str(&bench.read("out/road.geojson")).unwrap();
    let factors: Vec<f64> =
        road["cars"].as_array().unwrap().iter().map(|car| car["factor"].as_f64().unwrap()).collect();
    let between = road["between_cars"].as_f64().unwrap();
    assert_eq!(factors.len(), 3);
    assert!(between < 0.03, "{between} {factors:?}");
    let mean = factors.iter().map(|factor| factor.ln()).sum::<f64>() / 3.0;
    assert!(mean.abs() < 1e-6, "{factors:?}");
    let cells = road["features"].as_array().unwrap();
    let shared = cells.iter().filter(|cell| cell["properties"]["cars"] == 3).count();
    assert!(shared > 30, "{shared} of {}", cells.len());
    // Without it again the page has none.
    bench.run(&line).success();
    assert!(!bench.read("out/index.html").contains("id=\"roads\""));
}
