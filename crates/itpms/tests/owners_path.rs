//! README's own path: a file by `vehicle init` without a wheelbase, a first drive that teaches and calibrates, a later one on which a tire
//! loses a third. The tables are as most exports are: 200 rows a second, of which every tenth has a speed.

use serde_json::Value;

use crate::common::{Bench, table};

struct Car {
    init: &'static str,
    placard_kpa: f64,
    wheelbase_m: f64,
}

const FIRST_S: f64 = 260.0;
const PUNCTURE_S: f64 = 70.0;
const LEFT: f64 = 0.68;

fn number(file: &str, section: &str, key: &str) -> f64 {
    let (_, rest) = file.split_once(&format!("[{section}]")).unwrap();
    let section = rest.split("\n[").next().unwrap();
    let line = section.lines().find(|line| line.starts_with(&format!("{key} = "))).unwrap();
    line[key.len() + 3..].split_whitespace().next().unwrap().parse().unwrap()
}

/// The car as it is: its file is some percent off.
fn scenario(car: &Car, file: &str, seconds: f64, speed: &str, road: char, punctured: bool) -> String {
    let mut text = format!(
        "name = \"own\"\ndescription = \"README's path\"\nduration_s = {seconds}\nrate_hz = 200.0\nsettle_s = 4.0\nwheelbase_m = {}\n\
         [speed]\npoints_s_km_h = {speed}\n[road.surface.iso8608]\nroughness = \"{road}\"\nslope = 2.0\n[sensor]\nnoise_m_s2 = 0.05\n[car]\n",
        car.wheelbase_m
    );
    for corner in ["fl", "fr", "rl", "rr"] {
        text += &format!("[corner.{corner}]\nplacard_kpa = {}\n", car.placard_kpa);
        for (key, share) in [
            ("sprung_mass_kg", 0.97),
            ("unsprung_mass_kg", 1.05),
            ("damping_n_s_per_m", 0.9),
            ("spring_n_per_m", 1.06),
        ] {
            text += &format!("{key} = {:.3}\n", share * number(file, &format!("corner.{corner}"), key));
        }
        for (key, share) in [("stiffness_per_kpa", 1.04), ("stiffness_at_zero", 1.0)] {
            text += &format!("tire.{key} = {:.3}\n", share * number(file, "tire", key));
        }
        let (before, after) = (car.placard_kpa, LEFT * car.placard_kpa);
        text += &match (corner, punctured) {
            ("fl", true) => format!(
                "pressure.points_s_kpa = [[{PUNCTURE_S}, {before}], [{}, {after}]]\n",
                PUNCTURE_S + 15.0
            ),
            _ => format!("pressure.constant_kpa = {before}\n"),
        };
    }
    text
}

fn thin_out_speed(bench: &Bench, name: &str) {
    let (header, rows) = table(&bench.read(name));
    let speed = header.iter().position(|name| name == "speed_m_s").unwrap();
    let line = |(k, row): (usize, Vec<String>)| {
        let keep = |at: usize| at != speed || k.is_multiple_of(10);
        let cells: Vec<&str> =
            row.iter().enumerate().map(|(at, cell)| if keep(at) { cell.as_str() } else { "" }).collect();
        cells.join(",") + "\n"
    };
    let lines: String = rows.into_iter().enumerate().map(line).collect();
    bench.write(name, header.join(",") + "\n" + &lines);
}

fn follow(car: &Car) {
    let bench = Bench::new();
    let placard_kpa = car.placard_kpa;
    bench.run(&format!("vehicle init {} --placard-kpa {placard_kpa} -o typical.toml", car.init)).success();
    let file = bench.read("typical.toml");
    let speed = "[[0.0, 50.0], [80.0, 95.0], [160.0, 60.0], [260.0, 100.0]]";
    bench.write("first.toml", scenario(car, &file, FIRST_S, speed, 'B', false));
    bench.write(
        "later.toml",
        scenario(car, &file, 120.0, "[[0.0, 90.0], [50.0, 70.0], [120.0, 85.0]]", 'C', true),
    );
    for (drive, seed) in [("first", 7), ("later", 8)] {
        bench.run(&format!("simulate {drive}.toml --seed {seed} -o {drive}.csv --no-truth")).success();
        thin_out_speed(&bench, &format!("{drive}.csv"));
    }

    let learn =
        format!("vehicle learn first.csv --pressure-kpa {placard_kpa} --from typical.toml -o car.toml");
    let learned = bench.run(&learn);
    assert!(!learned.success().contains("do not show"), "{learned:?}");
    let wheelbase_m = number(&bench.read("car.toml"), "vehicle", "wheelbase_m");
    assert!((wheelbase_m - car.wheelbase_m).abs() < 0.08, "{wheelbase_m} for {}", car.wheelbase_m);
    let calibrate = format!("--calibrate-s {} --save-reference car.reference -q", FIRST_S - 20.0);
    bench.run(&format!("estimate first.csv --vehicle car.toml -o est.csv {calibrate}")).success();

    let later = "estimate later.csv --vehicle car.toml -o est.csv --reference car.reference --json -q";
    let later: Value = bench.json(later);
    let corner = |corner: &str| &later["corners"][corner];
    let fl = corner("fl");
    assert_eq!(fl["state"], "low", "{later}");
    let warned_s = fl["low_since_s"].as_f64().unwrap();
    assert!((PUNCTURE_S..PUNCTURE_S + 20.0).contains(&warned_s), "{warned_s}");
    let last = &fl["last"];
    let [found, sd] = ["pressure_kpa", "sd_kpa"].map(|key| last[key].as_f64().unwrap());
    assert!((found - LEFT * placard_kpa).abs() < 2.5 * sd && sd < 15.0, "{found} (sd {sd})");
    let stands = |alert: &Value| alert["ended_s"].is_null() && alert["wheels"] == serde_json::json!(["fl"]);
    assert!(later["alerts"].as_array().unwrap().iter().any(stands), "{later}");
    for other in ["fr", "rl", "rr"] {
        assert!(
            corner(other)["low_since_s"].is_null() && corner(other)["state"] != "low",
            "{other}: {later}"
        );
    }
}

#[test]
fn a_small_car_at_200_kpa() {
    follow(&Car {
        init: "--mass 1050 --front-share 0.62 --tire 185/60R15 --class compact",
        placard_kpa: 200.0,
        wheelbase_m: 2.55,
    });
}

#[test]
fn a_sedan_at_230_kpa() {
    follow(&Car {
        init: "--mass 1390 --front-share 0.58 --tire 205/55R16 --class sedan",
        placard_kpa: 230.0,
        wheelbase_m: 2.64,
    });
}

#[test]
fn a_van_at_260_kpa() {
    follow(&Car {
        init: "--mass 2150 --front-share 0.53 --tire 215/65R16C --class van",
        placard_kpa: 260.0,
        wheelbase_m: 2.95,
    });
}
