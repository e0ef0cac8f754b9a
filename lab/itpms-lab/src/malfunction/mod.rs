//! Every malfunction put into many everyday drives: is it reported in time, is no wrong pressure shown at any wheel, is no tire
//! warned of, does the monitor come back; and is nothing reported on the same drives without.
//!
//! Called by the binary's `malfunctions`. Deterministic: the same request gives the same figures on any number of processors.
//!
//! | module | idea |
//! |---|---|
//! | `drive` | the drives |
//! | `clean` | what is reported when nothing is wrong |
//! | [`kinds`](kinds()) | the malfunctions and the times within which they are to be reported |
//! | `outcome` | one malfunction in one drive |
//! | `table` | as text |

mod clean;
mod drive;
mod kinds;
mod outcome;
mod table;

use itpms_core::monitor::MonitoredCar;
use rayon::prelude::*;
use serde::Serialize;

use crate::runner::{Odometer, Progress, Result, pool, refused};
use crate::score::stats::percentile;
use crate::tuning::monitor;
pub use clean::Clean;
use clean::{Watch, sum};
use drive::Recorded;
pub use kinds::{Kind, kinds};
use outcome::Outcome;
pub use outcome::TireWarnings;

#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    pub drives: usize,
    /// Seed of the first; the others follow.
    pub first_seed: u64,
    pub only: Option<String>,
}

/// Seconds of driving after the end of a malfunction in which all should be well again.
const AWAITED_S: f64 = 60.0;

/// One kind of malfunction over all drives. Times in s of driving; NaN where there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    pub name: &'static str,
    /// Drives it was put into, for long enough to be reported.
    pub drives: usize,
    /// In how many it was reported; reported within the stated time; and called by its name.
    pub said: usize,
    pub in_time: usize,
    /// Of those in which it was reported, in how many by a word that passes for its name, at any wheel it happens to: its own or
    /// that of a malfunction it looks like.
    pub named: usize,
    /// And in how many by its own name, with the very sensors and nothing beside them.
    pub named_exactly: usize,
    /// Other malfunctions reported while it lasted or in the two minutes after: of another kind, or of another sensor.
    pub others_said: usize,
    pub stated_s: f64,
    /// Time until it was reported, median.
    pub said_median_s: f64,
    /// Time until it was reported, worst.
    pub said_worst_s: f64,
    /// Time per drive with a wrong pressure shown (3 sd and 20 kPa off) before it was reported, at a wheel it happens to.
    pub wrong_before_s: f64,
    /// And in the 20 s after.
    pub wrong_after_s: f64,
    /// And in the two minutes after its end.
    pub wrong_back_s: f64,
    /// The same at the other wheels: before it was reported.
    pub wrong_before_others_s: f64,
    /// And in the 20 s after.
    pub wrong_after_others_s: f64,
    /// And in the two minutes after its end.
    pub wrong_back_others_s: f64,
    /// The same for pressures more than 20 kPa off, whatever their sd, at a wheel it happens to.
    pub far_before_s: f64,
    /// And in the 20 s after.
    pub far_after_s: f64,
    /// At the other wheels, before it was reported.
    pub far_before_others_s: f64,
    /// And in the 20 s after.
    pub far_after_others_s: f64,
    /// Warnings of tires while it lasted. All are false.
    pub tire_warnings_during: TireWarnings,
    pub tire_warnings_after: TireWarnings,
    /// Drives in which all was well again within the time driven after its end: nothing reported, a right pressure shown at its
    /// wheels, no wrong one at any.
    pub recovered: usize,
    /// Drives that went on for long enough after its end.
    pub awaited: usize,
    /// Time until then, median of those that recovered.
    pub recovered_median_s: f64,
    /// Time until then, worst of those that recovered.
    pub recovered_worst_s: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    pub version: u32,
    pub drives: usize,
    pub first_seed: u64,
    pub rows: Vec<Row>,
    pub clean: Clean,
}

struct OneDrive {
    outcomes: Vec<Outcome>,
    clean: Clean,
}

pub fn study(request: &Request, progress: Progress<'_>) -> Result<Study> {
    if request.drives == 0 {
        return refused("0 drives, expected at least one");
    }
    let mut wanted = kinds();
    let known: Vec<&'static str> = wanted.iter().map(|kind| kind.name).collect();
    if let Some(only) = &request.only {
        wanted.retain(|kind| kind.name.contains(only.as_str()));
        if wanted.is_empty() {
            let known = known.join("; ");
            return refused(format!("no malfunction is called `{only}`, expected a part of one of: {known}"));
        }
    }
    let total = ((wanted.len() + 1) * request.drives) as u64;
    let odometer = Odometer::new(total, progress);
    odometer.advance(0)?;
    let seeds: Vec<u64> = (0..request.drives as u64).map(|i| request.first_seed.wrapping_add(i)).collect();
    let all = || seeds.par_iter().map(|&seed| one(seed, &wanted, &odometer)).collect::<Result<_, _>>();
    let drives: Vec<OneDrive> = pool()?.install(all)?;
    let rows = wanted.iter().enumerate().map(|(i, kind)| {
        let outcomes: Vec<&Outcome> = drives.iter().map(|drive| &drive.outcomes[i]).collect();
        row(kind, &outcomes)
    });
    Ok(Study {
        version: 1,
        drives: request.drives,
        first_seed: request.first_seed,
        rows: rows.collect(),
        clean: sum(drives.iter().map(|drive| &drive.clean)),
    })
}

/// All malfunctions in one drive, and it without.
fn one(seed: u64, kinds: &[Kind], odometer: &Odometer<'_>) -> Result<OneDrive> {
    let drive = Recorded::of(seed)?;
    let mut car = monitored(&drive)?;
    let mut until_then = None;
    let mut clean = Watch::new(&drive);
    for (i, sample) in drive.rows.iter().enumerate() {
        if i == drive.begins {
            until_then = Some(car.clone());
        }
        let estimate = car.update(sample);
        clean.take(sample, &estimate, car.report());
    }
    odometer.advance(1)?;
    let mut outcomes = Vec::with_capacity(kinds.len());
    for kind in kinds {
        outcomes.push(match &until_then {
            _ if kind.faults.is_empty() => over_glass(kind, seed)?,
            Some(car) => outcome::run(kind, &drive, car.clone(), seed),
            None => Outcome::default(),
        });
        odometer.advance(1)?;
    }
    Ok(OneDrive { outcomes, clean: clean.finish() })
}

/// A malfunction that is the road's, on a drive of its own.
fn over_glass(kind: &Kind, seed: u64) -> Result<Outcome> {
    let drive = Recorded::over_glass(seed)?;
    let mut car = monitored(&drive)?;
    for sample in &drive.rows[..drive.begins] {
        car.update(sample);
    }
    Ok(outcome::run(kind, &drive, car, seed))
}

fn monitored(drive: &Recorded) -> Result<Box<MonitoredCar<f64>>> {
    Ok(Box::new(MonitoredCar::new(&monitor(&drive.car), drive.rate_hz)?))
}

/// Where a malfunction was not reported, and could not have been because the car hardly drove, that does not count as a failure; what
/// was shown and warned of counts. The same holds for how a drive went on after its end.
fn row(kind: &Kind, outcomes: &[&Outcome]) -> Row {
    let is_counted = |o: &&&Outcome| o.reported_after_s.is_some() || o.driven_s >= kind.stated_s;
    let said: Vec<f64> = outcomes.iter().filter_map(|o| o.reported_after_s).collect();
    let awaited: Vec<&&Outcome> = outcomes.iter().filter(|o| o.driven_after_s > AWAITED_S).collect();
    let recovered: Vec<f64> = awaited.iter().filter_map(|o| o.recovered_after_s).collect();
    let mean = |figure: fn(&Outcome) -> f64| {
        outcomes.iter().map(|o| figure(o)).sum::<f64>() / outcomes.len().max(1) as f64
    };
    let tires = |warnings: fn(&Outcome) -> TireWarnings| {
        outcomes.iter().fold(TireWarnings::default(), |sum, o| sum.plus(warnings(o)))
    };
    let named = outcomes.iter().filter(|o| o.reported_after_s.is_some() && kind.labels.contains(&o.label));
    let worst = |values: &[f64]| values.iter().copied().fold(f64::NAN, f64::max);
    Row {
        name: kind.name,
        drives: outcomes.iter().filter(is_counted).count(),
        said: said.len(),
        in_time: said.iter().filter(|time_s| **time_s <= kind.stated_s).count(),
        named: named.count(),
        named_exactly: outcomes.iter().filter(|o| o.reported_after_s.is_some() && o.exactly).count(),
        others_said: outcomes.iter().map(|o| o.others_said).sum(),
        stated_s: kind.stated_s,
        said_median_s: percentile(&said, 0.5),
        said_worst_s: worst(&said),
        wrong_before_s: mean(|o| o.before.wrong_s[0]),
        wrong_after_s: mean(|o| o.after.wrong_s[0]),
        wrong_back_s: mean(|o| o.back.wrong_s[0]),
        wrong_before_others_s: mean(|o| o.before.wrong_s[1]),
        wrong_after_others_s: mean(|o| o.after.wrong_s[1]),
        wrong_back_others_s: mean(|o| o.back.wrong_s[1]),
        far_before_s: mean(|o| o.before.far_s[0]),
        far_after_s: mean(|o| o.after.far_s[0]),
        far_before_others_s: mean(|o| o.before.far_s[1]),
        far_after_others_s: mean(|o| o.after.far_s[1]),
        tire_warnings_during: tires(|o| o.tires_during),
        tire_warnings_after: tires(|o| o.tires_after),
        recovered: recovered.len(),
        awaited: awaited.len(),
        recovered_median_s: percentile(&recovered, 0.5),
        recovered_worst_s: worst(&recovered),
    }
}

#[cfg(test)]
mod tests {
    use super::outcome::Shown;
    use super::*;

    fn stuck() -> Kind {
        kinds().into_iter().find(|kind| kind.name == "stuck, wheel").unwrap()
    }

    /// Reported by its name after a second, and well again after two.
    fn good() -> Outcome {
        Outcome {
            reported_after_s: Some(1.0),
            label: "stuck",
            exactly: true,
            driven_s: 21.0,
            recovered_after_s: Some(2.0),
            driven_after_s: 120.0,
            ..Outcome::default()
        }
    }

    #[test]
    fn a_row_keeps_apart_what_happens_at_other_wheels_and_after_the_end() {
        let shown = |wrong_s| Shown { wrong_s, far_s: [4.0, 8.0] };
        let bad = Outcome {
            label: "inconsistent",
            exactly: false,
            before: shown([1.0, 2.0]),
            after: shown([3.0, 5.0]),
            back: shown([6.0, 7.0]),
            others_said: 2,
            tires_during: TireWarnings { low: 1, ..TireWarnings::default() },
            tires_after: TireWarnings { over: 1, fast_leak: 1, ..TireWarnings::default() },
            recovered_after_s: None,
            ..good()
        };
        let row = row(&stuck(), &[&good(), &bad]);
        assert_eq!((row.drives, row.said, row.named, row.named_exactly, row.others_said), (2, 2, 1, 1, 2));
        assert_eq!([row.wrong_before_s, row.wrong_after_s, row.wrong_back_s], [0.5, 1.5, 3.0]);
        let others = [row.wrong_before_others_s, row.wrong_after_others_s, row.wrong_back_others_s];
        assert_eq!(others, [1.0, 2.5, 3.5]);
        assert_eq!([row.far_before_s, row.far_before_others_s, row.far_after_others_s], [2.0, 4.0, 4.0]);
        assert_eq!((row.tire_warnings_during.total(), row.tire_warnings_after.total()), (1, 2));
        // It drove on for two minutes and did not recover: awaited, and not in the median of those that did.
        assert_eq!((row.recovered, row.awaited, row.recovered_worst_s), (1, 2, 2.0));
    }

    #[test]
    fn what_a_short_drive_showed_counts_though_nobody_could_have_said_it() {
        let tires_during = TireWarnings { low: 1, ..TireWarnings::default() };
        let short =
            Outcome { reported_after_s: None, driven_s: 0.5, tires_during, driven_after_s: 10.0, ..good() };
        let row = row(&stuck(), &[&good(), &short]);
        assert_eq!((row.drives, row.said, row.tire_warnings_during.total()), (1, 1, 1));
        assert_eq!((row.recovered, row.awaited), (1, 1));
    }

    #[test]
    fn the_table_marks_what_is_not_as_it_should_be() {
        let table = |outcomes: &[&Outcome]| {
            let rows = vec![row(&stuck(), outcomes)];
            Study { version: 1, drives: outcomes.len(), first_seed: 1, rows, clean: Clean::default() }.table()
        };
        let line =
            |text: &str| text.lines().find(|line| line.starts_with("stuck, wheel")).unwrap().to_owned();
        let fine = line(&table(&[&good(), &good()]));
        assert!(fine.contains("2/2") && fine.ends_with("2.0"), "{fine}");
        let lost = Outcome { recovered_after_s: None, ..good() };
        let text = line(&table(&[&good(), &lost]));
        assert!(text.contains("1/2") && text.ends_with("not all back"), "{text}");
        // The car stood or the drive ended before that could be seen.
        let ended = Outcome { driven_after_s: 10.0, ..lost };
        assert!(line(&table(&[&good(), &ended])).ends_with("2.0"));
        let late = Outcome { reported_after_s: Some(9.0), ..good() };
        assert!(line(&table(&[&late])).ends_with("late"));
        let warned = TireWarnings { low: 1, all_low: 2, ..TireWarnings::default() };
        let text = line(&table(&[&Outcome { tires_after: warned, ..good() }]));
        assert!(text.ends_with("false warnings: low 1, all low 2"), "{text}");
    }
}
