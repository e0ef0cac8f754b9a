//! `itpms lab soak`: false warnings over many simulated hours, kept hour by hour, going on where it was stopped.

mod record;

use std::collections::BTreeMap;
use std::fs;
use std::io::{IsTerminal as _, stderr};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use itpms_console::{Failure, Interrupt, Screen, threads};
use itpms_data::out::AtomicFile;
use itpms_lab::sensors::Sensors;
use itpms_lab::soak::{Days, Hour, Plan, Summary, soak};

use self::record::Record;
use super::{failure, json};
use crate::args::SoakArgs;

/// Seconds between two lines about the progress where there is no terminal for a bar.
const PROGRESS_S: u64 = 60;
/// A hundred years of hours, which no one waits for; the seeds of a run are kept in memory.
const MOST_DRIVES: f64 = 1e6;

pub(crate) fn run(args: &SoakArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let plan = Plan {
        rate_hz: args.rate,
        drive_s: args.drive_s,
        car: args.car,
        calibrate_s: args.calibrate_s,
        sensors: args.sensors,
        days: days(args)?,
    };
    let drives = drives(args)?;
    fs::create_dir_all(&args.out).map_err(|error| Failure::Directory(args.out.clone(), error))?;
    interrupt.resumes();
    let mut record = Record::open(args.out.join("hours.jsonl"), &plan)?;
    let seeds = (0..drives).map(|i| args.first_seed.wrapping_add(i));
    let todo: Vec<u64> = seeds.clone().filter(|seed| !record.hours().contains_key(seed)).collect();
    let jobs = threads::at_a_time(args.jobs);
    let drive = |seeds: &[u64], done: &mut (dyn FnMut(Hour) -> ControlFlow<()> + Send)| {
        soak(&plan, seeds, jobs, done, &|| interrupt.flow()).map_err(|error| failure(error, Failure::Paused))
    };

    if !todo.is_empty() {
        let doubtful = record.doubtful();
        if !doubtful.is_empty() {
            screen.remark("another build drove the hours that are there: the first and the last are driven again, to compare");
        }
        let mut again = vec![];
        drive(&doubtful, &mut |hour| {
            again.push(hour);
            ControlFlow::Continue(())
        })?;
        record.adopt(&again)?;
    }

    let progress = screen.progress("driving");
    let mut word = Word::new(todo.len(), drives as usize);
    let mut failure = None;
    let outcome = drive(&todo, &mut |hour| {
        if let Err(error) = record.add(hour) {
            failure = Some(error);
            return ControlFlow::Break(());
        }
        progress.set(word.done_share(1));
        if let Some(line) = word.line(record.hours()).filter(|_| !stderr().is_terminal()) {
            screen.remark(line);
        }
        ControlFlow::Continue(())
    });
    drop(progress);
    if let Some(error) = failure {
        return Err(error);
    }
    outcome?;
    // Hours of other seeds may be there, too; what was asked for is added up.
    let asked: Vec<Hour> = seeds.filter_map(|seed| record.hours().get(&seed).cloned()).collect();
    finish(args, &Summary::of(&asked), record.path(), screen)
}

/// Conditions of the later days, if there are some.
fn days(args: &SoakArgs) -> Result<Option<Days>, Failure> {
    let Some(condition) = args.condition else { return Ok(None) };
    if args.sensors != Sensors::WheelSpeeds {
        return Err(Failure::Usage("--condition is for --sensors wheel-speeds".to_owned()));
    }
    if let Some(share) = args.lose.filter(|share| !(*share < 0.9)) {
        return Err(Failure::Usage(format!("--lose {share} is no share, expected less than 0.9")));
    }
    Ok(Some(Days { condition, loses: args.lose, bad_yaw: args.bad_yaw }))
}

fn drives(args: &SoakArgs) -> Result<u64, Failure> {
    let drives = (args.hours * 3600.0 / args.drive_s - 1e-9).ceil().max(1.0);
    if !(drives <= MOST_DRIVES) {
        let (hours, drive_s) = (args.hours, args.drive_s);
        return Err(Failure::Usage(format!(
            "--hours {hours:e} is {drives:e} drives of {drive_s} s, expected {MOST_DRIVES:e} or fewer"
        )));
    }
    Ok(drives as u64)
}

fn finish(args: &SoakArgs, summary: &Summary, hours: &Path, screen: &Screen) -> Result<(), Failure> {
    let json = json(summary)?;
    AtomicFile::save(&args.out.join("summary.json"), format!("{json}\n").as_bytes())?;
    if args.json {
        screen.print_lines(json);
    } else {
        screen.print_lines(summary.text().trim_end());
        screen.print(format!("See {} for every hour.", hours.display()));
    }
    Ok(())
}

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
        if self.said.elapsed() < Duration::from_secs(PROGRESS_S) && self.done < self.todo {
            return None;
        }
        self.said = Instant::now();
        let each_s = self.begun.elapsed().as_secs_f64() / self.done as f64;
        let left_min = each_s * (self.todo - self.done) as f64 / 60.0;
        let km: f64 = hours.values().map(|hour| hour.km).sum();
        let words: usize = hours.values().map(|hour| hour.said.len()).sum();
        Some(format!(
            "{} of {} drives, {km:.0} km, {words} reported; {each_s:.1} s a drive, {left_min:.0} min left",
            hours.len(),
            self.drives
        ))
    }
}
