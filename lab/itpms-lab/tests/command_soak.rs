//! `itpms lab soak`: hours are kept one by one, and a run goes on where it was stopped, however it was stopped.

use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::common::{Bench, interrupt};

/// Six drives of a minute: each takes some tenths of a second.
const LINE: &str = "soak --hours 0.1 --drive-s 60 --out soak";

/// The hours that are kept, by seed, without the time they took.
fn hours(bench: &Bench) -> Vec<Value> {
    let text = bench.read("soak/hours.jsonl");
    let mut hours: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    // The others say whose hours follow.
    hours.retain(|line| line.get("seed").is_some());
    hours.iter_mut().for_each(|hour| hour["wall_s"] = 0.into());
    hours.sort_by_key(|hour| hour["seed"].as_u64());
    hours
}

#[test]
fn six_minutes_are_driven_and_added_up() {
    let bench = Bench::new();
    let sums: Value = bench.json(&format!("{LINE} --json"));
    assert_eq!(sums["drives"], 6);
    assert!((sums["hours"].as_f64().unwrap() - 0.1).abs() < 1e-9);
    let seeds: Vec<u64> = hours(&bench).iter().map(|hour| hour["seed"].as_u64().unwrap()).collect();
    assert_eq!(seeds, [1, 2, 3, 4, 5, 6]);
    let file: Value = serde_json::from_str(&bench.read("soak/summary.json")).unwrap();
    assert_eq!(file, sums);
    // Again: nothing is left to drive; more hours go on from there.
    let before = bench.read("soak/hours.jsonl");
    assert!(bench.run(LINE).success().contains("6 drives"));
    assert_eq!(bench.read("soak/hours.jsonl"), before);
    assert!(bench.run(&LINE.replace("0.1", "0.11")).success().contains("7 drives"));
    assert!(bench.read("soak/hours.jsonl").starts_with(&before));
}

#[test]
fn a_killed_run_loses_no_finished_hour_and_repeats_none() {
    let whole = Bench::new();
    whole.run(LINE).success();
    let bench = Bench::new();
    let path = bench.path("soak/hours.jsonl");
    let complete = || std::fs::read(&path).map_or(0, |bytes| bytes.iter().filter(|b| **b == b'\n').count());
    // Killed outright as soon as another hour is there, three times.
    for _ in 0..3 {
        let before = complete().max(1);
        let line = format!("{LINE} --jobs 2");
        let mut command = bench.command(line.split_whitespace());
        let mut run = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while complete() <= before && run.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(2));
        }
        run.kill().unwrap();
        run.wait().unwrap();
        // And as if the disk had got half of the next one.
        let torn = [std::fs::read(&path).unwrap().as_slice(), br#"{"seed":99,"dri"#].concat();
        std::fs::write(&path, torn).unwrap();
    }
    bench.run(LINE).success();
    assert_eq!(hours(&bench), hours(&whole));
}

#[test]
fn an_interrupted_run_says_that_it_can_go_on() {
    let bench = Bench::new();
    let line = "soak --hours 50 --drive-s 60 --out soak";
    let mut command = bench.command(line.split_whitespace());
    let run = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !bench.path("soak/hours.jsonl").exists() {
        sleep(Duration::from_millis(2));
    }
    let outcome = interrupt(run, "INT");
    assert_eq!(outcome.code, Some(130));
    assert!(outcome.stderr.contains("what is finished is kept"), "{outcome:?}");
    // The lock went with the program.
    bench.run("soak --hours 0.01 --drive-s 60 --out soak").success();
}

#[test]
fn another_program_adds_its_hours_if_it_drives_the_same() {
    let (whole, bench) = (Bench::new(), Bench::new());
    whole.run(LINE).success();
    bench.run(&LINE.replace("0.1", "0.05")).success();
    // As if it had been another build.
    let theirs = bench.read("soak/hours.jsonl").replacen("\"program\":\"", "\"program\":\"0", 1);
    bench.write("soak/hours.jsonl", &theirs);
    let outcome = bench.run(LINE);
    assert!(
        outcome.success().contains("6 drives") && outcome.stderr.contains("another build"),
        "{outcome:?}"
    );
    assert_eq!(hours(&bench), hours(&whole));
    let both = bench.read("soak/hours.jsonl");
    assert!(both.starts_with(&theirs));
    assert_eq!(both.lines().filter(|line| line.contains("program")).count(), 2);
    // The hours after the second line are its own: nothing is driven again.
    let more = bench.run(&LINE.replace("0.1", "0.11"));
    assert!(more.success().contains("7 drives") && !more.stderr.contains("another build"), "{more:?}");
    // One that drove otherwise, be it by a millimeter.
    let mut line: Value = serde_json::from_str(theirs.lines().nth(1).unwrap()).unwrap();
    line["km"] = (line["km"].as_f64().unwrap() + 1e-6).into();
    bench.write("soak/hours.jsonl", format!("{}\n{line}\n", theirs.lines().next().unwrap()));
    let refused = bench.run(&format!("--quiet {LINE}"));
    assert!(refused.refusal().contains("drives that of seed"), "{refused:?}");
    assert_eq!(bench.read("soak/hours.jsonl").lines().count(), 2);
}
