//! Files that never end, that never begin, or whose names are not for a terminal.
#![cfg(unix)]

use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::{Bench, Outcome, interrupt};

const AT_ONCE: Duration = Duration::from_secs(1);

fn pipe(bench: &Bench, name: &str) {
    assert!(Command::new("mkfifo").arg(bench.path(name)).status().unwrap().success());
}

fn started(bench: &Bench, line: &str) -> Child {
    let mut command = bench.command(line.split_whitespace());
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_millis(500));
    child
}

/// Asks once for the end and expects it within a second.
fn ended(child: Child, signal: &str) -> Outcome {
    let asked = Instant::now();
    let outcome = interrupt(child, signal);
    assert!(asked.elapsed() < AT_ONCE + Duration::from_millis(200), "{:?}: {outcome:?}", asked.elapsed());
    assert_eq!(outcome.code, Some(130), "{outcome:?}");
    outcome
}

fn with_dbc(bench: &Bench) {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/can");
    for name in ["car.dbc", "map.toml"] {
        fs::copy(examples.join(name), bench.path(name)).unwrap();
    }
}

#[test]
fn a_pipe_without_a_writer_ends_at_the_first_signal() {
    let bench = Bench::with_drive();
    with_dbc(&bench);
    for (name, more, signal) in [
        ("wait.csv", "", "TERM"),
        ("wait.log", "--dbc car.dbc --signals map.toml", "INT"),
        ("wait.asc", "--dbc car.dbc --signals map.toml", "HUP"),
    ] {
        pipe(&bench, name);
        let before = bench.names();
        let child = started(&bench, &format!("estimate {name} --vehicle car.toml -o est.csv {more}"));
        assert_eq!(ended(child, signal).stderr, "error: interrupted\n");
        assert_eq!(bench.names(), before);
    }
    pipe(&bench, "wait.toml");
    let child = started(&bench, "estimate drive.csv --vehicle wait.toml -o est.csv");
    ended(child, "TERM");
}

#[test]
fn a_pipe_whose_writer_stops_in_the_middle_ends_at_the_first_signal_and_leaves_nothing() {
    let bench = Bench::with_drive();
    pipe(&bench, "wait.csv");
    let before = bench.names();
    let line = "estimate wait.csv --vehicle car.toml -o est.csv --road-out road.csv";
    let mut command = bench.command(line.split_whitespace());
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut writer = File::options().write(true).open(bench.path("wait.csv")).unwrap();
    let drive = fs::read(bench.path("drive.csv")).unwrap();
    writer.write_all(&drive[..drive.len() / 2]).unwrap();
    let begun = |name: &String| name.starts_with(".est.csv.");
    let asked = Instant::now();
    while !bench.names().iter().any(begun) {
        assert!(asked.elapsed() < Duration::from_secs(30));
        sleep(Duration::from_millis(10));
    }
    sleep(Duration::from_millis(300));
    ended(child, "TERM");
    assert_eq!(bench.names(), before);
    drop(writer);
}

/// Whether a terminal would obey something of this.
fn is_plain(text: &str) -> bool {
    text.chars().all(|c| c == '\n' || !(c.is_control() || c == '\u{202e}'))
}

#[test]
fn names_are_cleaned_before_they_reach_the_terminal() {
    let bench = Bench::with_drive();
    let name = "a\u{1b}[2J\nb\u{9b}31m\u{202e}.csv";
    let shown = "a\\u001b[2J\\u000ab\\u009b31m\\u202e.csv";
    fs::rename(bench.path("drive.csv"), bench.path(name)).unwrap();
    let run = |arguments: &[&str]| {
        let output = bench.command(arguments).output().unwrap();
        let [stdout, stderr] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert!(is_plain(&stdout) && is_plain(&stderr), "{arguments:?}: {stdout:?} {stderr:?}");
        (output.status.code(), stdout, stderr)
    };
    // A result, a remark, a warning and an error.
    let (code, stdout, _) = run(&["estimate", name, "--vehicle", "car.toml", "-o", "est.csv"]);
    assert_eq!(code, Some(0));
    assert!(stdout.starts_with(shown), "{stdout}");
    assert_eq!(stdout.lines().count(), 3, "{stdout}");
    let (code, _, stderr) =
        run(&["estimate", &format!("no{name}"), "--vehicle", "car.toml", "-o", "est.csv"]);
    assert_eq!(code, Some(2));
    assert_eq!(stderr, format!("error: no{shown}: no such file\n"));
    // JSON stays JSON and keeps the name.
    let (_, stdout, _) = run(&["signals", name, "--json"]);
    let value: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert!(value.to_string().contains("\\u001b[2J"), "{value}");
    // A column's name and a vehicle's.
    let hostile = bench.read(name).replacen("speed_m_s", "spe\u{1b}]0;x\u{7}ed", 1);
    bench.write("hostile.csv", hostile);
    let (_, stdout, _) = run(&["signals", "hostile.csv"]);
    assert!(stdout.contains("spe\\u001b]0;x\\u0007ed"), "{stdout}");
    let other = bench.read("car.toml").replace("[corner.fl]", "[corner.rr]");
    bench.write("other.toml", format!("{other}\n").replacen("name = \"", "name = \"\\u001b[1m", 1));
    let (code, _, stderr) = run(&["estimate", "hostile.csv", "--vehicle", "other.toml", "-o", "est.csv"]);
    assert_eq!(code, Some(2), "{stderr}");
}

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
        let outcome = interrupt(
            bench.start(
                "estimate drive.csv --vehicle car.toml -o est.csv --road-out road.csv --report report.html",
                "est.csv",
            ),
            signal,
        );
        assert_eq!(outcome.code, Some(130), "{outcome:?}");
        assert_eq!(outcome.stderr, "error: interrupted, nothing was written\n");
        assert_eq!(bench.names(), before);
    }
}

#[test]
fn an_interrupted_demo_leaves_nothing() {
    let bench = Bench::new();
    let mut command = bench.command(["demo"]);
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    while bench.names().is_empty() {
        assert!(child.try_wait().unwrap().is_none());
    }
    let outcome = interrupt(child, "INT");
    assert_eq!(outcome.code, Some(130), "{outcome:?}");
    assert_eq!(bench.names(), Vec::<String>::new());
}
