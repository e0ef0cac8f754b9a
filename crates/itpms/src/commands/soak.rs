//! `itpms soak`: false warnings over many simulated hours, kept hour by hour, going on where it was stopped.

use std::collections::BTreeMap;
use std::fs;
use std::io::{IsTerminal as _, stderr};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use itpms_data::out::{AtomicFile, Ledger};
use itpms_study::soak::{Hour, Plan, SoakError, Summary, soak};
use serde_json::{Value, json};

use crate::args::SoakArgs;
use crate::exit::Failure;
use crate::interrupt::Interrupt;
use crate::screen::Screen;

/// Seconds between two lines about the progress where there is no terminal for a bar.
const WORD_S: u64 = 60;

pub(crate) fn run(args: &SoakArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let plan = Plan { rate_hz: args.rate, drive_s: args.drive_s, car: args.car };
    fs::create_dir_all(&args.out).map_err(|error| Failure::Directory(args.out.clone(), error))?;
    let path = args.out.join("hours.jsonl");
    let (mut ledger, lines) = Ledger::open(&path)?;
    let mut hours = earlier(&path, &lines, &plan)?;
    if lines.is_empty() {
        ledger.append(&heading(&plan)?.to_string())?;
    }
    let drives = (args.hours * 3600.0 / args.drive_s - 1e-9).ceil().max(1.0) as u64;
    let seeds = (0..drives).map(|i| args.first_seed.wrapping_add(i));
    let todo: Vec<u64> = seeds.clone().filter(|seed| !hours.contains_key(seed)).collect();
    let jobs = args.jobs.map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from);

    let progress = screen.progress("driving");
    let mut word = Word::new(todo.len(), drives as usize);
    let mut failure = None;
    let mut done = |hour: Hour| {
        if let Err(error) = ledger.append(&hour.to_line()) {
            failure = Some(error);
            return ControlFlow::Break(());
        }
        hours.insert(hour.seed, hour);
        progress.set(word.done_share(1));
        if let Some(line) = word.line(&hours).filter(|_| !stderr().is_terminal()) {
            screen.remark(line);
        }
        ControlFlow::Continue(())
    };
    let outcome = soak(&plan, &todo, jobs, &mut done, &|| interrupt.flow());
    drop(progress);
    if let Some(error) = failure {
        return Err(error.into());
    }
    outcome.map_err(|error| match error {
        SoakError::Stopped => Failure::Paused,
        SoakError::Scenario(scenario) => Failure::Scenario(scenario),
        other => Failure::Usage(other.to_string()),
    })?;
    // Hours of other seeds may be there, too; what was asked for is added up.
    let asked: Vec<Hour> = seeds.filter_map(|seed| hours.remove(&seed)).collect();
    finish(args, &Summary::of(&asked), screen)
}

/// The first line of the file: what its hours are hours of. Hours of another program are not added to these.
fn heading(plan: &Plan) -> Result<Value, Failure> {
    Ok(json!({ "itpms_soak": 1, "program": fingerprint()?, "plan": plan }))
}

/// The hours that are there.
fn earlier(path: &Path, lines: &[String], plan: &Plan) -> Result<BTreeMap<u64, Hour>, Failure> {
    let Some((first, rest)) = lines.split_first() else { return Ok(BTreeMap::new()) };
    let found: Value = serde_json::from_str(first).unwrap_or(Value::Null);
    let refuse = |what: &str, found: &Value, expected: &Value| {
        let path = path.display();
        Failure::Usage(format!("{path}: line 1: {what} is {found}, expected {expected}; use another folder"))
    };
    let expected = heading(plan)?;
    for (key, what) in [
        ("itpms_soak", "itpms_soak"),
        ("plan", "the plan of the hours that are there"),
        ("program", "the fingerprint of the program that drove them"),
    ] {
        if found[key] != expected[key] {
            return Err(refuse(what, &found[key], &expected[key]));
        }
    }
    let hour = |(i, line): (usize, &String)| {
        let hour = Hour::from_line(line).map(|hour| (hour.seed, hour));
        hour.ok_or_else(|| Failure::Usage(format!("{}: line {}: not an hour", path.display(), i + 2)))
    };
    rest.iter().enumerate().map(hour).collect()
}

/// FNV-1a (64 bit) of the running program's file: tells builds apart, which a version number does not.
fn fingerprint() -> Result<String, Failure> {
    let unreadable =
        |error: std::io::Error| Failure::Usage(format!("the running program cannot be read: {error}"));
    let path: PathBuf = std::env::current_exe().map_err(unreadable)?;
    let bytes = fs::read(path).map_err(unreadable)?;
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    for byte in bytes {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    Ok(format!("{hash:016x}"))
}

fn finish(args: &SoakArgs, summary: &Summary, screen: &Screen) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(summary);
    let json = json.map_err(|error| Failure::Usage(format!("the sums are no JSON: {error}")))?;
    let mut file = AtomicFile::create(&args.out.join("summary.json"))?;
    file.append(format!("{json}\n").as_bytes())?;
    file.commit()?;
    if args.json {
        screen.print(json);
    } else {
        screen.print(summary.text().trim_end());
        screen.print(format!("See {} for every hour.", args.out.join("hours.jsonl").display()));
    }
    Ok(())
}

/// What is said about the progress.
struct Word {
    begun: Instant,
    said: Instant,
    todo: usize,
    done: usize,
    drives: usize,
}

impl Word {
    fn new(todo: usize, drives: usize) -> Self {
        Self { begun: Instant::now(), said: Instant::now(), todo, done: 0, drives }
    }

    /// The share of this run's drives that is done, after so many more.
    fn done_share(&mut self, more: usize) -> f64 {
        self.done += more;
        self.done as f64 / self.todo.max(1) as f64
    }

    /// Now and then: how far it is, and how long it will take.
    fn line(&mut self, hours: &BTreeMap<u64, Hour>) -> Option<String> {
        if self.said.elapsed() < Duration::from_secs(WORD_S) && self.done < self.todo {
            return None;
        }
        self.said = Instant::now();
        let each_s = self.begun.elapsed().as_secs_f64() / self.done as f64;
        let left_min = each_s * (self.todo - self.done) as f64 / 60.0;
        let km: f64 = hours.values().map(|hour| hour.km).sum();
        let words: usize = hours.values().map(|hour| hour.said.len()).sum();
        Some(format!(
            "{} of {} drives, {km:.0} km, {words} said; {each_s:.1} s a drive, {left_min:.0} min left",
            hours.len(),
            self.drives
        ))
    }
}
