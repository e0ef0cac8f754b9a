//! `itpms lab faults`: things go wrong around a monitor and a calibration, on purpose and often, and what is lost is counted.
//!
//! | module | idea |
//! |---|---|
//! | `subject` | the car, its rows and the files of which nothing may be lost |
//! | `saving` | programs killed while they save, full disks, files with a byte changed |
//! | `outage` | brokers that go and return, a bus that falls silent |
//! | `clock` | clocks that jump |
//! | `broker` | a broker that goes when it is asked to |

mod broker;
mod clock;
mod outage;
mod saving;
mod subject;

use itpms_console::{Failure, Interrupt, Screen, threads};
use serde_json::json;

use crate::args::FaultsArgs;
use subject::Subject;

#[derive(Debug)]
struct Outcome {
    tried: u64,
    /// Of those, how many took something that was to stay.
    lost: u64,
    found: String,
}

struct Campaign<'a> {
    subject: &'a Subject,
    effort: f64,
    moments: Moments,
    interrupt: &'a Interrupt,
}

impl Campaign<'_> {
    /// So many of the usual number, at least one.
    fn of(&self, usual: u64) -> u64 {
        ((usual as f64 * self.effort).round() as u64).max(1)
    }
}

/// Knuth's MMIX generator: moments only have to be many and different.
struct Moments(u64);

impl Moments {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % most.max(1)
    }
}

type Fault = fn(&mut Campaign<'_>) -> Result<Outcome, Failure>;

/// Name, what it takes if it takes something, and how.
const FAULTS: [(&str, &str, Fault); 11] = [
    ("state: killed while saving", "a state that is neither the old nor the new one", |c| {
        saving::killed(c, "state")
    }),
    ("calibration: killed while saving", "a file that is neither the old nor the new one", |c| {
        saving::killed(c, "calibration")
    }),
    ("state: disk full while saving", "the old state, or an error that is not reported", |c| {
        saving::full_disk(c, "state")
    }),
    ("calibration: disk full while saving", "the old file, or an error that is not reported", |c| {
        saving::full_disk(c, "calibration")
    }),
    ("state: a byte changed", "a changed state that is believed", saving::changed_state),
    ("calibration: a byte changed", "a changed file that is believed", saving::changed_calibration),
    ("state: cut short", "a part that is believed", saving::cut_state),
    ("broker of warnings goes and returns", "a warning", outage::warnings),
    ("broker of frames goes and returns", "a frame that was sent while it was there", outage::frames),
    ("bus falls silent and returns", "a row, or that silence is reported", outage::silence),
    ("clock jumps", "estimates, or a false warning", clock::jumps),
];

pub(crate) fn run(args: &FaultsArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    if let Some([kind, a, b, target]) = args.victim.as_deref() {
        return saving::save_forever(kind, [a, b], target);
    }
    threads::set(args.jobs)?;
    let wanted = args.only.as_deref().unwrap_or_default();
    let faults: Vec<_> = FAULTS.iter().filter(|(name, ..)| name.contains(wanted)).collect();
    if faults.is_empty() {
        let known: Vec<&str> = FAULTS.iter().map(|(name, ..)| *name).collect();
        return Err(Failure::Usage(format!(
            "--only {wanted}: no such fault, there are: {}",
            known.join("; ")
        )));
    }
    let subject = Subject::new(interrupt)?;
    let progress = screen.progress("breaking");
    let mut outcomes = Vec::new();
    for (done, (name, takes, fault)) in faults.iter().enumerate() {
        progress.set(done as f64 / faults.len() as f64);
        let moments = Moments(args.seed.wrapping_add(done as u64));
        let effort = f64::from(args.effort) / 100.0;
        let mut campaign = Campaign { subject: &subject, effort, moments, interrupt };
        outcomes.push((*name, *takes, fault(&mut campaign)?));
        interrupt.check()?;
    }
    drop(progress);
    print(args, screen, &outcomes);
    let lost: u64 = outcomes.iter().map(|(.., outcome)| outcome.lost).sum();
    if lost > 0 {
        return Err(Failure::Usage(format!("{lost} faults took something that was to stay")));
    }
    Ok(())
}

fn print(args: &FaultsArgs, screen: &Screen, outcomes: &[(&str, &str, Outcome)]) {
    if args.json {
        let faults: Vec<_> = outcomes
            .iter()
            .map(|(name, takes, o)| json!({ "name": name, "tried": o.tried, "lost": o.lost, "would_lose": takes, "found": o.found }))
            .collect();
        let value = json!({ "version": env!("CARGO_PKG_VERSION"), "seed": args.seed, "effort": args.effort, "faults": faults });
        screen.print_lines(format!("{value:#}"));
        return;
    }
    let width = outcomes.iter().map(|(name, ..)| name.len()).max().unwrap_or(0);
    screen.print(format!("{:width$}  {:>7}  {:>4}  found", "fault", "tried", "lost"));
    for (name, _, o) in outcomes {
        screen.print(format!("{name:width$}  {:>7}  {:>4}  {}", o.tried, o.lost, o.found));
    }
}
