//! Every unusable input of `itpms estimate`: exit code 2, one message, and not a file more than before.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use std::fs;

use common::{Bench, interrupt};

const ESTIMATE: &str =
    "estimate drive.csv --vehicle car.toml -o est.csv --road-out road.csv --report report.html";

/// Runs the estimate and checks that it left nothing; gives the message.
fn refusal(bench: &Bench) -> String {
    refusal_of(bench, ESTIMATE)
}

fn refusal_of(bench: &Bench, line: &str) -> String {
    let before = bench.names();
    let outcome = bench.run(line);
    assert_eq!(bench.names(), before, "{outcome:?}");
    outcome.refusal().to_owned()
}

/// The message for the paper's drive after an edit, line by line and cell by cell.
fn edited(edit: impl Fn(usize, &mut Vec<String>)) -> String {
    let bench = Bench::with_drive();
    bench.edit_drive(edit);
    refusal(&bench)
}

const BODY: usize = 2;
const WHEEL: usize = 3;

#[test]
fn a_missing_file_or_a_directory() {
    let bench = Bench::with_drive();
    let text = refusal_of(&bench, "estimate nowhere.csv --vehicle car.toml -o est.csv");
    assert_eq!(text, "nowhere.csv: no such file");
    let text = refusal_of(&bench, "estimate drive.csv --vehicle nowhere.toml -o est.csv");
    assert_eq!(text, "nowhere.toml: no such file");
    fs::create_dir(bench.path("logs.csv")).unwrap();
    let text = refusal_of(&bench, "estimate logs.csv --vehicle car.toml -o est.csv");
    assert_eq!(text, "logs.csv: is a directory, expected a file");
    let text = refusal_of(&bench, "estimate car.toml --vehicle car.toml -o est.csv");
    assert!(text.starts_with("car.toml: unknown file extension .toml, expected .csv"), "{text}");
}

#[test]
fn an_empty_file_a_header_alone_and_a_single_sample() {
    let bench = Bench::with_drive();
    let lines: Vec<String> = bench.read("drive.csv").lines().map(str::to_owned).collect();
    bench.write("drive.csv", "");
    assert!(refusal(&bench).starts_with("drive.csv: the file is empty, expected a header line with time_s"));
    bench.write("drive.csv", format!("{}\n", lines[0]));
    assert_eq!(refusal(&bench), "drive.csv: there is a header but no row under it");
    bench.write("drive.csv", format!("{}\n{}\n", lines[0], lines[1]));
    assert_eq!(refusal(&bench), "drive.csv: found 1 sample with a time, expected at least 2");
}

#[cfg(feature = "parquet")]
#[test]
fn a_parquet_file_that_is_none() {
    let bench = Bench::with_drive();
    bench.write("drive.parquet", "PAR1 this is none PAR1");
    let text = refusal_of(&bench, "estimate drive.parquet --vehicle car.toml -o est.csv");
    assert!(text.starts_with("drive.parquet: not a readable Parquet file: "), "{text}");
}

/// Puts this into a column of the lines of which it is wanted.
fn with(column: usize, lines: impl Fn(usize) -> bool, cell: impl Fn(usize) -> String) -> String {
    edited(|line, cells| {
        if lines(line) {
            cells[column] = cell(line);
        }
    })
}

/// Sentences that the log's reader has tests of: here, that the program says them and leaves nothing, also when much has been written already.
#[test]
fn a_log_that_is_damaged() {
    let other = "other names or units: itpms signals LOG --write-map map.toml, then --signals map.toml";
    let no_number = "found \"broken\", expected a number, or NaN or nothing where it is missing";
    for (column, lines, cell, message) in [
        (
            WHEEL,
            1..2,
            "gear",
            "column fl_wheel_accel_m_s2 is missing; a corner has both accelerations: without fl_body_accel_m_s2 the log is read without this corner",
        ),
        (0, 1..2, "Time_x", &format!("column time_s is missing; the nearest name there is Time_x; {other}")),
        (BODY, 17..18, "broken", &format!("line 17, column fl_body_accel_m_s2: {no_number}")),
        (BODY, 19_000..19_001, "broken", &format!("line 19000, column fl_body_accel_m_s2: {no_number}")),
        (0, 2..usize::MAX, "12.5", "time is constant: time_s is 12.5 in all of the 20000 rows read"),
    ] {
        let text = with(column, |line| lines.contains(&line), |_| cell.to_owned());
        assert!(text.starts_with(&format!("drive.csv: {message}")), "{text}");
    }
    // A clock that begins again is another recording: cut there, never sorted.
    let text = with(0, |line| line > 15_000, |line| format!("{}", (line - 15_000) as f64 / 500.0));
    assert!(text.contains("begins again at line 15001, from 29.996 to 0.002 s"), "{text}");
    assert!(text.contains("cut the file before line 15001"), "{text}");
}

#[test]
fn accelerations_in_g_with_and_without_gravity() {
    for gravity in [0.0, -1.0] {
        let bench = Bench::with_drive();
        bench.edit_drive(|line, cells| {
            if line > 1 {
                for column in [BODY, WHEEL] {
                    cells[column] = format!("{}", gravity + cells[column].parse::<f64>().unwrap() / 9.80665);
                }
            }
        });
        let text = refusal(&bench);
        assert!(
            text.starts_with("drive.csv: wrong units suspected (accelerations in g): fl body and wheel"),
            "{text}"
        );
        assert!(
            text.ends_with(
                ", expected m/s^2; if they are right: --trust-units, else state the units in a map: --signals"
            ),
            "{text}"
        );
        bench.run("estimate drive.csv --vehicle car.toml -o est.csv --trust-units").success();
    }
}

#[test]
fn a_vehicle_file_with_an_unknown_key_a_negative_mass_or_the_wrong_corner() {
    let bench = Bench::with_drive();
    let car = bench.read("car.toml");
    // Each where the other one should be.
    let exchanged = car.replace("damping_n_s_per_m", "x").replace("spring_n_per_m", "damping_n_s_per_m");
    bench.write("car.toml", exchanged.replace("\nx =", "\nspring_n_per_m ="));
    let text = refusal(&bench);
    assert!(text.contains("spring_n_per_m is 925.8, expected 2377 to 237660 (another unit?)"), "{text}");
    bench.write("car.toml", car.replace("unsprung_mass_kg", "unsprung_mas_kg"));
    let text = refusal(&bench);
    assert!(
        text.starts_with(
            "car.toml: line 12: unknown key unsprung_mas_kg in [corner.fl] (did you mean unsprung_mass_kg?)"
        ),
        "{text}"
    );
    bench.write("car.toml", car.replace("240.8", "-240"));
    assert_eq!(
        refusal(&bench),
        "car.toml: line 11: [corner.fl] sprung_mass_kg is -240, expected a positive, finite number"
    );
    bench.write("car.toml", car.replace("corner.fl", "corner.rr"));
    assert_eq!(
        refusal(&bench),
        "drive.csv has the corners fl, but the vehicle \"vehicle of paper-drop\" describes rr"
    );
}

#[test]
fn an_output_that_cannot_be_written() {
    let bench = Bench::with_drive();
    for (output, message) in [
        ("missing/est.csv", "missing/est.csv: cannot be written: the directory missing does not exist"),
        (".", ".: is a directory, expected a file"),
        ("car.toml/est.csv", "car.toml/est.csv: cannot be written: "),
        ("est.txt", "est.txt: unknown file extension .txt, expected .csv"),
        ("drive.csv", "drive.csv: is the drive log itself, expected another name to write to"),
        ("./car.toml", "./car.toml: is the vehicle file itself"),
    ] {
        let text = refusal_of(&bench, &format!("estimate drive.csv --vehicle car.toml -o {output}"));
        assert!(text.starts_with(message), "{text}");
        let line = format!("estimate drive.csv --vehicle car.toml -o est.csv --road-out {output}");
        let text = refusal_of(&bench, &line);
        assert!(text.starts_with(message), "{text}");
    }
    let line = "estimate drive.csv --vehicle car.toml -o est.csv --road-out est.csv";
    assert_eq!(refusal_of(&bench, line), "est.csv: is given for two outputs, expected a name for each");
}

#[test]
fn no_command_writes_over_what_it_reads() {
    let bench = Bench::with_drive();
    for (line, message) in [
        ("estimate drive.csv --vehicle car.toml -o x.csv --road-out ./x.csv", "./x.csv: is given for two"),
        (
            "estimate drive.csv --vehicle car.toml --signals m.toml -o x.csv --events m.toml",
            "m.toml: is the signal map",
        ),
        ("simulate car.toml -o x.csv --vehicle-out car.toml", "car.toml: is the scenario itself"),
        ("simulate paper-drop -o x.csv --vehicle-out ./x.csv", "./x.csv: is given for two outputs"),
        ("monitor --replay drive.csv --vehicle car.toml --json drive.csv", "drive.csv: is the log itself"),
        (
            "monitor --replay drive.csv --vehicle car.toml --state ./car.toml",
            "./car.toml: is the vehicle file",
        ),
        ("monitor --replay drive.csv --vehicle car.toml --state other.csv", "other.csv: is no saved state"),
    ] {
        if line.starts_with("monitor") && !cfg!(feature = "live") {
            continue;
        }
        bench.write("other.csv", "somebody's");
        bench.write("m.toml", "");
        let text = refusal_of(&bench, line);
        assert!(text.starts_with(message), "{line}: {text}");
        assert_eq!(bench.read("other.csv"), "somebody's");
    }
}

/// A result that goes nowhere is no result.
#[test]
#[cfg(target_os = "linux")]
fn a_standard_output_that_is_full_is_said() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let done = Bench::new().command(["completions", "bash"]).stdout(full).output().unwrap();
    let text = String::from_utf8(done.stderr).unwrap();
    assert_eq!(text, "error: standard output: the result cannot be written to it\n");
    assert_eq!(done.status.code(), Some(2));
}

#[test]
fn an_older_result_survives_a_failed_run() {
    let bench = Bench::with_drive();
    bench.run(ESTIMATE).success();
    let before = bench.read("est.csv");
    bench.edit_drive(|line, cells| {
        if line == 19_000 {
            cells[BODY] = "0.1.2".to_owned();
        }
    });
    refusal(&bench);
    assert_eq!(bench.read("est.csv"), before);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let bench = Bench::with_drive();
    for line in [
        "estimate drive.csv --vehicle car.toml -o /dev/full",
        "estimate drive.csv --vehicle car.toml -o est.csv --road-out /dev/full",
        "estimate drive.csv --vehicle car.toml -o est.csv --report /dev/full",
    ] {
        let text = refusal_of(&bench, line);
        assert!(text.starts_with("/dev/full: cannot be written: No space left on device"), "{text}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing() {
    let bench = Bench::new();
    bench.write(
        "long.toml",
        "name = \"long\"\nduration_s = 1500.0\nrate_hz = 500.0\nspeed.constant_km_h = 50.0\n\
         road.surface.iso8608 = { roughness = \"B\", slope = 2.0 }\n\
         corner.fl.pressure.points_s_kpa = [[0.0, 240.0]]\ncorner.rr.pressure.points_s_kpa = [[0.0, 240.0]]\n",
    );
    bench.run("simulate long.toml -o drive.csv --vehicle-out car.toml").success();
    let before = bench.names();
    for signal in ["INT", "TERM"] {
        let outcome = interrupt(bench.start(ESTIMATE, "est.csv"), signal);
        assert_eq!(outcome.code, Some(130), "{outcome:?}");
        assert_eq!(outcome.stderr, "error: interrupted, nothing was written\n");
        assert_eq!(bench.names(), before);
    }
}

#[test]
fn options_that_make_no_sense_are_refused_by_the_parser() {
    let bench = Bench::with_drive();
    for option in ["--rate 0", "--rate -5", "--rate NaN", "--estimator kalman", "--what"] {
        let outcome = bench.run(&format!("estimate drive.csv --vehicle car.toml -o est.csv {option}"));
        assert_eq!(outcome.code, Some(2), "{option}: {outcome:?}");
        assert!(outcome.stderr.starts_with("error: "), "{option}: {outcome:?}");
        assert_eq!(bench.names(), ["car.toml", "drive.csv"]);
    }
    // A number below zero is a value and not an unknown option.
    let outcome = bench.run("estimate drive.csv --vehicle car.toml -o est.csv --rate -5");
    assert!(outcome.stderr.contains("invalid value '-5' for '--rate"), "{outcome:?}");
}

/// Another table's message states how it is read.
#[test]
fn a_table_with_other_names_is_told_the_way() {
    let bench = Bench::with_drive();
    bench.write("own.csv", "Zeit [s];v [km/h];AccZ_FL [g]\n0,0;50;0,1\n");
    let text = refusal_of(&bench, "estimate own.csv --vehicle car.toml -o est.csv");
    assert_eq!(
        text,
        "own.csv: column time_s is missing; other names or units: itpms signals LOG --write-map map.toml, then --signals map.toml (there, the unit of a name that states none: fl_wheel_speed_m_s = { signal = \"...\", unit = \"km/h\" })"
    );
}
