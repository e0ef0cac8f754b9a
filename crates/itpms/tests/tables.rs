//! Tables with other names, units and separators: a map makes them the drive that they are.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use common::{Bench, table};

/// Standard gravity in m/s².
const G: f64 = 9.806_65;

/// Writes the drive as another logger might have: `line` makes a row of time, speed and the two accelerations.
fn rewrite(bench: &Bench, header: &str, line: impl Fn([f64; 4]) -> String) {
    let (names, rows) = table(&bench.read("drive.csv"));
    let place = |name: &str| names.iter().position(|other| other == name).unwrap();
    let places = ["time_s", "speed_m_s", "fl_body_accel_m_s2", "fl_wheel_accel_m_s2"].map(place);
    let lines = rows.iter().map(|row| line(places.map(|place| row[place].parse().unwrap())));
    let text: Vec<String> = std::iter::once(header.to_owned()).chain(lines).collect();
    bench.write("other.csv", text.join("\n") + "\n");
}

/// The pressures in kPa are those of the drive itself, but for the digits that units and clocks cost.
fn same_pressures(bench: &Bench, tolerance_kpa: f64) {
    let column = |name: &str| -> Vec<f64> {
        let (names, rows) = table(&bench.read(name));
        let place = names.iter().position(|name| name == "fl_pressure_kpa").unwrap();
        rows.iter().map(|row| row[place].parse().unwrap_or(f64::NAN)).collect()
    };
    let (expected, found) = (column("est.csv"), column("other-est.csv"));
    assert_eq!(expected.len(), found.len());
    for (i, (a, b)) in expected.iter().zip(&found).enumerate() {
        assert!((a - b).abs() < tolerance_kpa || (a.is_nan() && b.is_nan()), "row {i}: {a} {b}");
    }
}

fn bench() -> Bench {
    let bench = Bench::with_drive();
    bench.run("estimate drive.csv --vehicle car.toml -o est.csv").success();
    bench
}

const ESTIMATE: &str = "estimate other.csv --vehicle car.toml -o other-est.csv";

#[test]
fn semicolons_decimal_commas_milliseconds_and_g() {
    let bench = bench();
    let comma = |value: f64| value.to_string().replace('.', ",");
    rewrite(&bench, "Time [ms];v_kmh;AccZ_Body_FL_g;AccZ_Wheel_FL (g);Note", |[t, v, body, wheel]| {
        let values = [1000.0 * t, 3.6 * v, body / G, wheel / G].map(comma);
        format!("{};ok", values.join(";"))
    });
    // What the signals are is known by their names and units, as of a bus; a map says the same.
    bench.run(ESTIMATE).success();
    same_pressures(&bench, 1e-3);
    let listing = bench.run("signals other.csv --write-map map.toml");
    assert!(listing.success().contains("v_kmh"), "{listing:?}");
    let map = bench.read("map.toml");
    assert!(map.contains("fl_body_accel_m_s2 = \"AccZ_Body_FL_g\""), "{map}");
    bench.run(&format!("{ESTIMATE} --signals map.toml")).success();
    same_pressures(&bench, 1e-3);
}

/// As pandas writes a frame with a datetime index: `frame.to_csv(sep=";", decimal=",")`.
#[test]
fn a_german_table_with_dates_comes_out_as_the_plain_one() {
    let bench = bench();
    let comma = |value: f64| value.to_string().replace('.', ",");
    rewrite(&bench, "Zeit;v_Fahrzeug [km/h];Aufbau_az_VL [g];Rad_az_VL [g]", |[t, v, body, wheel]| {
        let (minutes, seconds) = ((t / 60.0).floor(), t % 60.0);
        let values = [3.6 * v, body / G, wheel / G].map(comma);
        format!("2026-03-01 08:{minutes:02.0}:{seconds:06.3};{}", values.join(";"))
    });
    bench.run("signals other.csv --write-map map.toml").success();
    let map = bench.read("map.toml");
    for line in [
        "speed_m_s = \"v_Fahrzeug [km/h]\"",
        "fl_body_accel_m_s2 = \"Aufbau_az_VL [g]\"",
        "fl_wheel_accel_m_s2 = \"Rad_az_VL [g]\"",
    ] {
        assert!(map.contains(line), "{map}");
    }
    bench.run(&format!("{ESTIMATE} --signals map.toml")).success();
    // What the clock's quarters of a microsecond since 1970 cost.
    same_pressures(&bench, 0.05);
}

#[test]
fn dates_for_a_clock_and_a_map_by_hand() {
    let bench = bench();
    rewrite(&bench, "Stamp,Tempo,A,B", |[t, v, body, wheel]| {
        let (minutes, seconds) = ((t / 60.0).floor(), t % 60.0);
        format!("2026-03-01 08:{minutes:02.0}:{seconds:09.6},{},{},{}", v / 0.44704, -body, 1000.0 * wheel)
    });
    let map = "[signals]\ntime_s = \"Stamp\"\nspeed_m_s = { signal = \"Tempo\", unit = \"mph\" }\n\
               fl_body_accel_m_s2 = { signal = \"A\", factor = -1.0 }\nfl_wheel_accel_m_s2 = { signal = \"B\", unit = \"mm/s^2\" }\n";
    bench.write("map.toml", map);
    bench.run(&format!("{ESTIMATE} --signals map.toml")).success();
    // A clock that counts from 1970 has quarters of a microsecond: the same drive with our names has to have it, too.
    bench.edit_drive(|line, cells| {
        if line > 1 {
            cells[0] = (cells[0].parse::<f64>().unwrap() + 1_772_352_000.0).to_string();
        }
    });
    bench.run("estimate drive.csv --vehicle car.toml -o est.csv").success();
    // Two ways to add up a time may end in neighboring numbers.
    same_pressures(&bench, 0.1);
    let (_, rows) = table(&bench.read("other-est.csv"));
    // As `date -u -d '2026-03-01 08:00:00' +%s` has it.
    assert_eq!(rows[0][0].parse::<f64>().unwrap(), 1_772_352_000.0);
    for (change, sentence) in [
        (("\"Stamp\"", "\"Stump\""), "map.toml: line 2: time_s is to be \"Stump\""),
        (("unit = \"mph\"", "unit = \"g\""), "map.toml: line 3: speed_m_s has unit \"g\""),
        (("signal = \"B\"", "signal = \"A\""), "column A is to be both"),
        (("fl_wheel", "fr_wheel"), "no corner has that of its body and of its wheel"),
    ] {
        bench.write("map.toml", map.replace(change.0, change.1));
        let outcome = bench.run(&format!("{ESTIMATE} --signals map.toml"));
        assert!(outcome.refusal().contains(sentence), "{outcome:?}");
    }
    // A log with a clock of its own takes no other.
    bench.write("map.toml", map);
    bench.run("convert drive.csv drive.mf4").success();
    let outcome = bench.run("estimate drive.mf4 --vehicle car.toml -o mf4.csv --signals map.toml");
    assert!(outcome.refusal().contains("time_s is for tables"), "{outcome:?}");
}
