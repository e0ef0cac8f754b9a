//! MCAP of `estimate --mcap` and `monitor --mcap`: what is in it is what the other files of the same drive say.
#![cfg(all(feature = "mcap", feature = "live"))]

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use crate::common::{Bench, table};

type Topics = BTreeMap<String, Vec<Map<String, Value>>>;

fn read(bench: &Bench, name: &str) -> Topics {
    let bytes = std::fs::read(bench.path(name)).unwrap();
    let mut topics = Topics::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let object: Map<String, Value> = serde_json::from_slice(&message.data).unwrap();
        let time_ns = (object["time_s"].as_f64().unwrap() * 1e9).round() as u64;
        assert_eq!(message.log_time, time_ns);
        topics.entry(message.channel.topic.clone()).or_default().push(object);
    }
    topics
}

/// Every cell of a table is in the topics under `root`, and nothing else is.
fn assert_same(csv: &str, topics: &Topics, root: &str) {
    let (header, rows) = table(csv);
    let mut compared = 0;
    for (k, row) in rows.iter().enumerate() {
        for (name, cell) in header.iter().zip(row) {
            let wheel = name.split_once('_').filter(|(wheel, _)| ["fl", "fr", "rl", "rr"].contains(wheel));
            let (topic, field) = match wheel {
                Some((wheel, field)) => (format!("{root}/{wheel}"), field),
                // In every topic, and so also where no topic but the wheels' has values.
                None if name == "time_s" => (format!("{root}/fl"), name.as_str()),
                None => (root.to_owned(), name.as_str()),
            };
            let found = topics[&topic][k].get(field);
            let same = match found {
                None => cell.is_empty(),
                Some(Value::Number(number)) => cell.parse() == Ok(number.as_f64().unwrap()),
                Some(Value::Bool(flag)) => cell == &flag.to_string(),
                Some(other) => other == cell.as_str(),
            };
            assert!(same, "{topic}.{field}, row {k}: {found:?} instead of {cell:?}");
            compared += usize::from(found.is_some());
        }
    }
    let under = topics.iter().filter(|(topic, _)| topic.starts_with(root));
    let fields: usize = under.flat_map(|(_, messages)| messages).map(|message| message.len() - 1).sum();
    assert_eq!(compared, fields + rows.len());
}

/// Four wheels at 200 Hz of which one loses air after 20 s: `drive.csv` and `car.toml`.
fn puncture() -> Bench {
    let bench = Bench::new();
    let scenario = include_str!("../../itpms-sim/scenarios/drive-puncture.toml");
    let scenario = scenario.replace("rate_hz = 500.0", "rate_hz = 200.0");
    bench.write("scenario.toml", scenario.replace("duration_s = 40.0", "duration_s = 25.0"));
    bench.run("simulate scenario.toml --seed 1 -o drive.csv --vehicle-out car.toml").success();
    bench
}

#[test]
fn a_drive_and_what_was_found_in_it() {
    let bench = puncture();
    let outputs = "-o est.csv --road-out road.csv --events events.jsonl";
    bench.run(&format!("estimate drive.csv --vehicle car.toml {outputs} --mcap all.mcap")).success();
    let topics = read(&bench, "all.mcap");
    let names: Vec<&str> = topics.keys().map(String::as_str).collect();
    let of = |root: &str| ["fl", "fr", "rl", "rr"].map(|wheel| format!("{root}/{wheel}"));
    let expected = [
        vec!["/alerts".to_owned()],
        of("/estimate").to_vec(),
        vec!["/road".to_owned()],
        of("/road").to_vec(),
        vec!["/signals".to_owned()],
        of("/signals").to_vec(),
    ];
    assert_eq!(names, expected.concat());
    assert_same(&bench.read("drive.csv"), &topics, "/signals");
    assert_same(&bench.read("est.csv"), &topics, "/estimate");
    assert_same(&bench.read("road.csv"), &topics, "/road");
    let events = bench.read("events.jsonl");
    let mut events: Vec<Map<String, Value>> =
        events.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    events.iter_mut().for_each(|event| event.retain(|_, value| !value.is_null()));
    assert!(!events.is_empty());
    assert_eq!(topics["/alerts"], events);
    // Alone, and with the summary as JSON, the same file.
    let outcome = bench.run("estimate drive.csv --vehicle car.toml --mcap alone.mcap --json");
    assert!(outcome.success().contains("\"mcap\":\"alone.mcap\""), "{outcome:?}");
    assert_eq!(read(&bench, "alone.mcap"), topics);
    let refused = bench.run("estimate drive.csv --vehicle car.toml -o x.mcap --mcap x.mcap");
    assert!(refused.refusal().contains("given for two outputs"), "{refused:?}");
}

#[test]
fn a_recording_says_what_the_lines_of_json_say_and_none_is_written_over() {
    let bench = puncture();
    let replay = "monitor --replay drive.csv --speed max --vehicle car.toml --mcap live.mcap";
    bench.run(&format!("{replay} --json live.jsonl")).success();
    let topics = read(&bench, "live.mcap");
    let lines: Vec<Map<String, Value>> =
        bench.read("live.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let mut estimates = lines.iter().filter(|line| line["type"] == "estimate" && !line["time_s"].is_null());
    let known = |wheel: &Value| {
        let mut wheel = wheel.as_object().unwrap().clone();
        wheel.retain(|name, value| !value.is_null() && name != "corner");
        wheel
    };
    let mut count = 0;
    for (k, car) in topics["/estimate"].iter().enumerate() {
        let line = estimates.next().unwrap();
        assert_eq!((&car["time_s"], &car["unix_s"]), (&line["time_s"], &line["unix_s"]));
        assert_eq!(car["source_state"], line["source"]["state"]);
        for wheel in line["wheels"].as_array().unwrap() {
            let mut expected = known(wheel);
            expected.insert("time_s".to_owned(), line["time_s"].clone());
            let topic = format!("/estimate/{}", wheel["corner"].as_str().unwrap());
            assert_eq!(topics[&topic][k], expected);
            count += 1;
        }
    }
    assert!(estimates.next().is_none() && count >= 4 * 240, "{count}");
    let warnings = lines.iter().filter(|line| line["type"] == "warning");
    let mut warnings: Vec<_> = warnings.map(|line| known(&Value::Object(line.clone()))).collect();
    for warning in &mut warnings {
        for name in ["type", "seq", "unix_s"] {
            warning.remove(name);
        }
    }
    assert!(!warnings.is_empty());
    assert_eq!(topics["/alerts"], warnings);

    let before = std::fs::read(bench.path("live.mcap")).unwrap();
    let outcome = bench.run(replay);
    outcome.success();
    assert!(outcome.stderr.contains("the recording goes to live-2.mcap"), "{outcome:?}");
    assert_eq!(std::fs::read(bench.path("live.mcap")).unwrap(), before);
    assert_eq!(read(&bench, "live-2.mcap")["/estimate/fl"], topics["/estimate/fl"]);
}
