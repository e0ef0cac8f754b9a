//! `itpms monitor`: a replay says what `itpms estimate` says, row for row; frames through a pipe the same; a state that is
//! saved goes on; warnings come once.
#![cfg(all(feature = "live", feature = "can"))]

use std::fs::File;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use itpms_data::LogReader;
use itpms_data::can::FrameWriter;
use itpms_data::dbc::{Dbc, Encoder};
use itpms_data::signals::SignalMap;
use serde_json::Value;

use crate::common::{Bench, interrupt, table};

/// The puncture at 200 Hz and its vehicle: `drive.csv` and `car.toml`.
fn puncture() -> Bench {
    let bench = Bench::new();
    let scenario = include_str!("../../itpms-sim/scenarios/drive-puncture.toml");
    bench.write("scenario.toml", scenario.replace("rate_hz = 500.0", "rate_hz = 200.0"));
    bench.run("simulate scenario.toml --seed 1 -o drive.csv --vehicle-out car.toml --no-truth").success();
    bench
}

/// The same as frames of the example car's bus: `drive.log`, `car.dbc` and `map.toml`.
fn with_frames(bench: &Bench) {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/can");
    for name in ["car.dbc", "map.toml"] {
        std::fs::copy(examples.join(name), bench.path(name)).unwrap();
    }
    let (dbc, map) = (bench.path("car.dbc"), SignalMap::read(&bench.path("map.toml")).unwrap());
    let mut log = LogReader::open(&bench.path("drive.csv")).unwrap();
    let mut encoder = Encoder::new(&Dbc::read(&dbc).unwrap(), Some(&map), log.columns()).unwrap();
    let mut writer = FrameWriter::create(&bench.path("drive.log")).unwrap();
    while let Some(row) = log.next_row().unwrap() {
        encoder.encode(&row, |frame| writer.write(&frame).unwrap());
    }
    writer.finish().unwrap().commit().unwrap();
}

fn lines(bench: &Bench, name: &str, kind: &str) -> Vec<Value> {
    let parsed = bench.read(name);
    let parsed = parsed.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    parsed.filter(|line| line["type"] == kind).collect()
}

/// The estimates that a row made, without those that the clock on the wall made.
fn estimates(bench: &Bench, name: &str) -> Vec<Value> {
    let mut found = lines(bench, name, "estimate");
    found.retain(|line| line["source"]["state"] == "live");
    found
}

fn reported(estimate: &Value) -> Value {
    let mut reported = estimate.clone();
    let map = reported.as_object_mut().unwrap();
    ["seq", "unix_s", "source", "latency_ms"].into_iter().for_each(|key| drop(map.remove(key)));
    // A restart cuts a segment of road in two; what is estimated is not touched by it.
    let wheels = map["wheels"].as_array_mut().unwrap();
    wheels.iter_mut().for_each(|wheel| drop(wheel.as_object_mut().unwrap().remove("iri_m_per_km")));
    reported
}

fn all_reported(estimates: &[Value]) -> Vec<Value> {
    estimates.iter().map(reported).collect()
}

/// Holds the estimates of a monitor against `est.csv`.
fn expect_est_csv(bench: &Bench, json: &str) {
    let (header, rows) = table(&bench.read("est.csv"));
    let estimates = estimates(bench, json);
    assert_eq!(estimates.len(), rows.len());
    for (estimate, row) in estimates.iter().zip(&rows) {
        let cell = |name: &str| row[header.iter().position(|column| column == name).unwrap()].as_str();
        let number = |name: &str| cell(name).parse::<f64>().unwrap();
        assert_eq!(estimate["time_s"], number("time_s"));
        for wheel in estimate["wheels"].as_array().unwrap() {
            let corner = wheel["corner"].as_str().unwrap();
            for what in ["pressure_kpa", "pressure_sd_kpa", "stiffness_n_per_m"] {
                // To the last bit: both write the shortest number that reads back as the same.
                assert_eq!(wheel[what], number(&format!("{corner}_{what}")), "{corner} {what} {row:?}");
            }
            assert_eq!(wheel["valid"].to_string(), cell(&format!("{corner}_valid")));
            assert_eq!(wheel["warning"], cell(&format!("{corner}_warning")));
        }
    }
}

#[test]
fn a_replay_says_what_estimate_says_row_for_row_and_warns_on_transitions_alone() {
    let bench = puncture();
    bench.run("estimate drive.csv --vehicle car.toml -o est.csv --events events.jsonl").success();
    bench.run("monitor --replay drive.csv --speed max --vehicle car.toml --json live.jsonl").success();
    expect_est_csv(&bench, "live.jsonl");
    let mut warnings = lines(&bench, "live.jsonl", "warning");
    for (i, warning) in warnings.iter_mut().enumerate() {
        let map = warning.as_object_mut().unwrap();
        assert_eq!(map.remove("seq").unwrap(), i);
        ["type", "unix_s"].into_iter().for_each(|key| drop(map.remove(key)));
    }
    let events = bench.read("events.jsonl");
    let events: Vec<Value> = events.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(!events.is_empty());
    assert_eq!(warnings, events);
    let last = lines(&bench, "live.jsonl", "estimate").pop().unwrap();
    assert_eq!(last["source"]["state"], "ended");
    assert_eq!(last["wheels"][0]["state"], "low");
}

/// A speed that is zero while the car drives, and one that stops coming at 20 s.
#[test]
fn an_unknown_speed_is_reported_once() {
    for (from_s, told, reason, text) in [
        (0.0, "0", "contradicted", "speed_m_s says that the car stands while its wheels roll"),
        (20.0, "", "missing", "since 20.5 s there has been no speed_m_s that a car can have"),
    ] {
        let bench = puncture();
        bench.edit_drive(|line, cells| {
            if line > 1 && cells[0].parse::<f64>().unwrap() >= from_s {
                told.clone_into(&mut cells[1]);
            }
        });
        let outcome =
            bench.run("monitor --replay drive.csv --speed max --vehicle car.toml --json live.jsonl");
        outcome.success();
        assert_eq!(outcome.stderr.matches("every wheel is by itself").count(), 1, "{outcome:?}");
        assert!(outcome.stderr.contains(text), "{outcome:?}");
        for estimate in estimates(&bench, "live.jsonl") {
            let known = estimate["speed_m_s"].is_number();
            assert_eq!(known, estimate["speed_doubt"].is_null(), "{estimate}");
            if estimate["time_s"].as_f64().unwrap() > from_s + 3.0 {
                assert_eq!(estimate["speed_doubt"], reason, "{estimate}");
            }
        }
    }
}

#[test]
fn frames_from_a_log_and_through_a_pipe_with_rubbish_in_between() {
    let bench = puncture();
    with_frames(&bench);
    bench.run("estimate drive.log --dbc car.dbc --signals map.toml --vehicle car.toml -o est.csv").success();
    bench
        .run("monitor --replay drive.log --speed max --dbc car.dbc --signals map.toml --vehicle car.toml --json replay.jsonl")
        .success();
    expect_est_csv(&bench, "replay.jsonl");

    // A line that is no frame after every 5000, and one that is not even text.
    let mut piped = Vec::new();
    for (i, line) in bench.read("drive.log").lines().enumerate() {
        piped.extend(line.as_bytes());
        piped.push(b'\n');
        if i % 5000 == 0 {
            piped.extend(b"(1.0) can0 12#3\n");
        }
    }
    let rubbish = bench.read("drive.log").lines().count().div_ceil(5000) + 1;
    piped.extend(b"\xff\xfe\xff\n\n");
    bench.write("piped.log", piped);
    let mut command = bench.command(
        "monitor - --dbc car.dbc --signals map.toml --vehicle car.toml --json pipe.jsonl".split(' '),
    );
    let status = command.stdin(File::open(bench.path("piped.log")).unwrap()).status().unwrap();
    assert!(status.success());
    expect_est_csv(&bench, "pipe.jsonl");
    let last = lines(&bench, "pipe.jsonl", "estimate").pop().unwrap();
    assert_eq!(last["source"]["malformed"], rubbish);
    assert_eq!(last["source"]["unknown_ids"], 0);
}

#[test]
fn frames_that_are_of_no_use_and_a_state_without_a_place_are_reported() {
    let bench = puncture();
    with_frames(&bench);
    let log = bench.read("drive.log").replace(" can0 ", " can0 00000");
    bench.write("other.log", log);
    let outcome = bench
        .run("monitor --replay other.log --dbc car.dbc --signals map.toml --vehicle car.toml --speed max");
    assert!(outcome.stderr.contains("none with a signal that is wanted"), "{}", outcome.stderr);
    let refused = bench.run("monitor --replay drive.csv --vehicle car.toml --state nowhere/car.state");
    assert!(refused.refusal().contains("nowhere"), "{refused:?}");
}

/// Waits until the monitor has published something.
fn wait_for_estimate(bench: &Bench, name: &str, child: &mut Child) {
    let start = Instant::now();
    while !std::fs::read_to_string(bench.path(name)).is_ok_and(|text| text.matches("\"live\"").count() > 20) {
        assert!(start.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_polite_kill_saves_the_state_and_the_next_start_goes_on_to_the_same_bits() {
    let bench = puncture();
    bench.run("monitor --replay drive.csv --speed max --vehicle car.toml --json whole.jsonl").success();
    let whole = estimates(&bench, "whole.jsonl");
    assert_eq!(whole.len(), 400);

    let line =
        "monitor --replay drive.csv --speed 10 --vehicle car.toml --json first.jsonl --state car.state";
    let mut command = bench.command(line.split(' '));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for_estimate(&bench, "first.jsonl", &mut child);
    let stopped = interrupt(child, "TERM");
    assert_eq!(stopped.code, Some(0), "{stopped:?}");
    assert!(stopped.stderr.contains("begins afresh"), "{stopped:?}");
    let first = estimates(&bench, "first.jsonl");
    let done = lines(&bench, "first.jsonl", "estimate").pop().unwrap();
    assert_eq!(done["source"]["state"], "ended");
    let rows = done["source"]["rows"].as_u64().unwrap() as usize;
    assert!((200..7800).contains(&rows), "{rows}");

    // The rest of the drive, as if no time had passed.
    let drive = bench.read("drive.csv");
    let (header, data) = drive.split_once('\n').unwrap();
    let rest: Vec<&str> = data.lines().skip(rows).collect();
    bench.write("rest.csv", format!("{header}\n{}\n", rest.join("\n")));
    let line =
        "monitor --replay rest.csv --speed max --vehicle car.toml --json second.jsonl --state car.state";
    let resumed = bench.run(line);
    assert!(resumed.stderr.contains("goes on from the saved state"), "{resumed:?}");
    resumed.success();
    let both = [first, estimates(&bench, "second.jsonl")].concat();
    assert_eq!(all_reported(&both), all_reported(&whole));
    // Alerts reported before the restart are not reported again.
    let texts = |name: &str| -> Vec<Value> {
        lines(&bench, name, "warning").iter().map(|warning| warning["text"].clone()).collect()
    };
    assert_eq!([texts("first.jsonl"), texts("second.jsonl")].concat(), texts("whole.jsonl"));
    assert!(!bench.names().iter().any(|name| name.ends_with(".tmp")));
}

#[cfg(unix)]
#[test]
fn a_reader_that_reads_nothing_does_not_keep_it_from_ending() {
    let bench = puncture();
    let mut command = bench.command("monitor --replay drive.csv --speed max --vehicle car.toml".split(' '));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let unread = child.stdout.take();
    // The pipe is full by then, or the log is at its end.
    std::thread::sleep(Duration::from_secs(4));
    assert!(child.try_wait().unwrap().is_none(), "it waits for its reader");
    let asked = Instant::now();
    interrupt(child, "TERM");
    assert!(asked.elapsed() < Duration::from_secs(6), "{:?}", asked.elapsed());
    drop(unread);
}

#[cfg(unix)]
#[test]
fn one_monitor_per_state_and_a_killed_one_leaves_the_next_nothing_to_complain_of() {
    let bench = puncture();
    let line = "monitor --replay drive.csv --speed 1 --vehicle car.toml --state car.state --json";
    let begin = |json: &str| {
        let mut command = bench.command(line.split(' ').chain([json]));
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        wait_for_estimate(&bench, json, &mut child);
        child
    };
    let mut first = begin("first.jsonl");
    let second = bench.run(&format!("{line} second.jsonl"));
    let by = format!("is used by another program (process {}), expected one at a time", first.id());
    assert_eq!(second.refusal(), format!("car.state: {by}"));
    first.kill().unwrap();
    first.wait().unwrap();
    // Its temporary file beside the state, and another program's of nearly the same name.
    bench.write(&format!(".car.state.{}-3.tmp", first.id()), "half a state");
    bench.write(".car.state.mine.tmp", "mine");
    let third = begin("third.jsonl");
    assert_eq!(interrupt(third, "TERM").code, Some(0));
    let hidden: Vec<String> = bench.names().into_iter().filter(|name| name.starts_with('.')).collect();
    assert_eq!(hidden, [".car.state.mine.tmp"]);
    assert!(bench.names().contains(&"car.state".to_owned()));
}

#[test]
fn a_damaged_state_is_refused_loudly_and_the_monitor_begins_afresh() {
    let bench = puncture();
    let line = "monitor --replay drive.csv --speed max --vehicle car.toml --state car.state --json";
    bench.run(&format!("{line} fresh.jsonl")).success();
    let mut state = std::fs::read(bench.path("car.state")).unwrap();
    let middle = state.len() / 2;
    state[middle] ^= 1;
    bench.write("car.state", &state);
    let outcome = bench.run(&format!("{line} again.jsonl"));
    assert!(outcome.stderr.contains("car.state: is damaged") && outcome.stderr.contains("BEGINS AFRESH"));
    outcome.success();
    // A refused state is knowledge of a car, and kept.
    assert_eq!(std::fs::read(bench.path("car.state.refused")).unwrap(), state);
    bench.write("car.state", &state);
    bench.run(&format!("{line} third.jsonl")).success();
    assert_eq!(std::fs::read(bench.path("car.state.refused-2")).unwrap(), state);
    assert_eq!(
        all_reported(&estimates(&bench, "again.jsonl")),
        all_reported(&estimates(&bench, "fresh.jsonl"))
    );
}

#[test]
fn frames_of_our_own_dbc_say_what_the_lines_say() {
    let bench = puncture();
    bench
        .run("monitor --replay drive.csv --speed max --vehicle car.toml --json live.jsonl --can-out out.log")
        .success();
    let printed = bench.run("monitor --print-dbc").success().to_owned();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/can/itpms.dbc");
    assert_eq!(printed, std::fs::read_to_string(example).unwrap());
    let dbc = Dbc::parse(&printed).unwrap();
    assert_eq!(dbc.problems(), []);
    let mut frames = itpms_data::can::FrameReader::open(&bench.path("out.log")).unwrap();
    let told = lines(&bench, "live.jsonl", "estimate");
    let mut sets = 0;
    let mut last = (f64::NAN, f64::NAN, f64::NAN);
    while let Some(frame) = frames.next_frame().unwrap() {
        let message = dbc.message(frame.id).unwrap();
        message.decode(frame.data(), |place, value| match message.signals[place].name.as_str() {
            "ITPMS_Counter" => {
                assert_eq!(value, f64::from(sets as u8));
                sets += 1;
            }
            "ITPMS_Pressure_FL" => last.0 = value,
            "ITPMS_State_FL" => last.1 = value,
            "ITPMS_Warning_FL" => last.2 = value,
            _ => {}
        });
    }
    assert_eq!(sets, told.len());
    let wheel = &told.last().unwrap()["wheels"][0];
    assert!(
        (last.0 - wheel["pressure_kpa"].as_f64().unwrap()).abs() <= 0.005 + 1e-9,
        "half a step of 0.01 kPa"
    );
    assert_eq!((last.1, last.2), (2.0, 1.0), "low, and a warning of it");
}

#[test]
fn a_pipe_that_nobody_reads_ends_with_its_reader() {
    let bench = puncture();
    let mut command = bench.command("monitor --replay drive.csv --speed 1 --vehicle car.toml".split(' '));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(30));
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_corner_that_is_not_estimated_has_its_reason_as_estimate_has_it() {
    let bench = puncture();
    with_frames(&bench);
    let drop = |columns: &[&str]| {
        let (header, rows) = table(&bench.read("drive.csv"));
        let kept: Vec<usize> =
            (0..header.len()).filter(|place| !columns.contains(&header[*place].as_str())).collect();
        let line = |cells: &Vec<String>| {
            kept.iter().map(|place| cells[*place].as_str()).collect::<Vec<_>>().join(",")
        };
        let lines: Vec<String> = std::iter::once(&header).chain(&rows).map(line).collect();
        lines.join("\n") + "\n"
    };
    bench.write("three.csv", drop(&["rr_body_accel_m_s2", "rr_wheel_accel_m_s2"]));
    // Another message has the names of the front left corner.
    let dbc = bench.read("car.dbc").replace("AxleAcc", "WheelAcc");
    let front_left = dbc.split("BO_ ").find(|message| message.contains("BodyAccZ_FL")).unwrap();
    let (_, signals) = front_left.split_once('\n').unwrap();
    let never = format!("BO_ 1999 Never: 6 ESP\n{}\n\nBO_ ", signals.trim_end());
    bench.write("never.dbc", dbc.replacen("BO_ ", &never, 1));
    let frames = bench.read("drive.log");
    let without: Vec<&str> = frames.lines().filter(|line| !line.contains(" 210#")).collect();
    bench.write("without.log", without.join("\n") + "\n");
    for (log, more, corner, why) in [
        ("three.csv", "", "rr", "not in the log"),
        ("without.log", "--dbc never.dbc", "fl", "which has no samples in this log"),
    ] {
        let estimated = bench.run(&format!("estimate {log} {more} --vehicle car.toml -o e.csv --json"));
        let estimated: Value = serde_json::from_str(estimated.success()).unwrap();
        let reason = estimated["not_estimated"][corner].as_str().unwrap().to_owned();
        assert!(reason.starts_with("not in the log") && reason.ends_with(why), "{reason}");
        let live =
            format!("monitor -q --replay {log} {more} --speed max --vehicle car.toml --json {log}.jsonl");
        let outcome = bench.run(&live);
        outcome.success();
        let line = format!("warning: {log}: corner {corner} of the vehicle file is {reason}");
        assert!(outcome.stderr.lines().any(|found| found == line), "{}", outcome.stderr);
        for estimate in estimates(&bench, &format!("{log}.jsonl")) {
            assert_eq!(estimate["not_estimated"], serde_json::json!({ corner: reason }));
            assert_eq!(estimate["all_fine"], false, "the wheel that is not estimated may be low");
        }
    }
    // Where one of the two comes it is that one, live as in a file.
    let live = "monitor --replay drive.log --dbc never.dbc --speed max --vehicle car.toml --json all.jsonl";
    bench.run(live).success();
    let all = lines(&bench, "all.jsonl", "estimate");
    assert!(all.iter().any(|estimate| estimate["all_fine"] == true));
    let last = all.last().unwrap();
    assert_eq!(last["wheels"].as_array().unwrap().len(), 4);
    assert_eq!(last["not_estimated"], serde_json::json!({}));
}
