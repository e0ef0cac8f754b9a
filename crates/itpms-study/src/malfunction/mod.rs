//! Every malfunction put into many everyday drives: is it said in time, is no wrong pressure shown, does the monitor come
//! back; and is nothing said on the same drives without.
//!
//! Called by the binary's `malfunctions`. Deterministic: the same request gives the same figures on any number of
//! processors.
//!
//! | room | idea |
//! |---|---|
//! | `drive` | the drives |
//! | `clean` | what is said when nothing is wrong |
//! | [`kinds`](kinds()) | the malfunctions and the times within which they are to be said |
//! | `outcome` | one malfunction in one drive |
//! | `table` | as text |

mod clean;
mod drive;
mod kinds;
mod outcome;
mod table;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use itpms_core::car::CarEstimator;
use itpms_core::estimator::EstimatorKind;
use itpms_core::monitor::{Monitor, MonitorConfig, MonitoredCar};
use itpms_core::quarter_car::ParameterError;
use itpms_sim::error::ScenarioError;
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use crate::score::stats::percentile;
pub use clean::Clean;
use clean::{Watch, sum};
use drive::Recorded;
pub use kinds::{Kind, kinds};
use outcome::Outcome;

/// Told at the start and after every malfunction how many of how many are done; [`ControlFlow::Break`] ends the study.
pub type Progress<'a> = &'a (dyn Fn(u64, u64) -> ControlFlow<()> + Sync);

/// Stack of a thread in bytes: an estimator under its monitor is a large value, copied while it is set up.
const STACK_BYTES: usize = 32 << 20;

/// What to compute.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Drives per malfunction.
    pub drives: usize,
    /// Seed of the first; the others follow.
    pub first_seed: u64,
    /// Only malfunctions whose names contain this.
    pub only: Option<String>,
}

/// Why there is no study.
#[derive(Debug, Error)]
pub enum MalfunctionError {
    /// Nothing was asked for.
    #[error("0 drives, expected at least one")]
    Nothing,
    /// No malfunction of that name.
    #[error("no malfunction is called `{found}`, expected a part of one of: {}", known.join("; "))]
    Unknown {
        /// What was asked for.
        found: String,
        /// What there is.
        known: Vec<&'static str>,
    },
    /// The progress callback said so.
    #[error("stopped")]
    Stopped,
    /// A scenario.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A parameter that an estimator refuses.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Threads could not be started.
    #[error("threads cannot be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// One kind of malfunction over all drives. Times in s of driving; NaN where there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The malfunction.
    pub name: &'static str,
    /// Drives it was put into, for long enough to be said.
    pub drives: usize,
    /// In how many it was said; said within the stated time; and called by its name.
    pub said: usize,
    /// Of these, within the stated time.
    pub in_time: usize,
    /// Of these, by its name.
    pub named: usize,
    /// The stated time.
    pub stated_s: f64,
    /// Time until it was said, median.
    pub said_median_s: f64,
    /// Time until it was said, worst.
    pub said_worst_s: f64,
    /// Time per drive with a wrong pressure shown (3 sd and 20 kPa off) before it was said.
    pub wrong_before_s: f64,
    /// And in the 20 s after.
    pub wrong_after_s: f64,
    /// The same for pressures more than 20 kPa off, whatever their sd.
    pub far_before_s: f64,
    /// And in the 20 s after.
    pub far_after_s: f64,
    /// Drives in which all was well again within the time driven after its end.
    pub recovered: usize,
    /// Drives that went on for long enough after its end.
    pub awaited: usize,
    /// Time until then, median.
    pub recovered_median_s: f64,
    /// Time until then, worst.
    pub recovered_worst_s: f64,
}

/// What came out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    /// Of this structure: 1.
    pub version: u32,
    /// Drives per malfunction.
    pub drives: usize,
    /// Seed of the first.
    pub first_seed: u64,
    /// A row per malfunction.
    pub rows: Vec<Row>,
    /// The drives without.
    pub clean: Clean,
}

/// What one drive gave.
struct OneDrive {
    outcomes: Vec<Outcome>,
    clean: Clean,
}

/// Makes the study on all processors.
///
/// # Errors
/// See [`MalfunctionError`].
pub fn study(request: &Request, progress: Progress<'_>) -> Result<Study, MalfunctionError> {
    if request.drives == 0 {
        return Err(MalfunctionError::Nothing);
    }
    let mut wanted = kinds();
    let known: Vec<&'static str> = wanted.iter().map(|kind| kind.name).collect();
    if let Some(only) = &request.only {
        wanted.retain(|kind| kind.name.contains(only.as_str()));
        if wanted.is_empty() {
            return Err(MalfunctionError::Unknown { found: only.clone(), known });
        }
    }
    let total = ((wanted.len() + 1) * request.drives) as u64;
    let (done, stopped) = (AtomicU64::new(0), AtomicBool::new(false));
    let count = || {
        let now = done.fetch_add(1, Ordering::Relaxed) + 1;
        if stopped.load(Ordering::Relaxed) || progress(now, total).is_break() {
            stopped.store(true, Ordering::Relaxed);
            return Err(MalfunctionError::Stopped);
        }
        Ok(())
    };
    if progress(0, total).is_break() {
        return Err(MalfunctionError::Stopped);
    }
    let pool = rayon::ThreadPoolBuilder::new().stack_size(STACK_BYTES).build()?;
    let seeds: Vec<u64> = (0..request.drives as u64).map(|i| request.first_seed.wrapping_add(i)).collect();
    let drives: Vec<OneDrive> =
        pool.install(|| seeds.par_iter().map(|&seed| one(seed, &wanted, &count)).collect::<Result<_, _>>())?;
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
fn one(
    seed: u64,
    kinds: &[Kind],
    count: &(dyn Fn() -> Result<(), MalfunctionError> + Sync),
) -> Result<OneDrive, MalfunctionError> {
    let drive = Recorded::of(seed)?;
    let estimator = CarEstimator::new(EstimatorKind::Informed, &drive.car, drive.rate_hz)?;
    let monitor = Monitor::new(&MonitorConfig::new(&drive.car), drive.rate_hz)?;
    let mut car = Box::new(MonitoredCar::new(estimator, monitor));
    let mut until_then = None;
    let mut clean = Watch::new(&drive);
    for (i, sample) in drive.rows.iter().enumerate() {
        if i == drive.begins {
            until_then = Some(car.clone());
        }
        let estimate = car.update(sample);
        clean.take(sample, &estimate, car.report());
    }
    count()?;
    let mut outcomes = Vec::with_capacity(kinds.len());
    for kind in kinds {
        outcomes.push(match &until_then {
            Some(car) => outcome::run(kind, &drive, (**car).clone(), seed),
            None => Outcome::default(),
        });
        count()?;
    }
    Ok(OneDrive { outcomes, clean: clean.finish() })
}

/// A malfunction that was not said, and could not have been because the car hardly drove, does not count.
fn row(kind: &Kind, outcomes: &[&Outcome]) -> Row {
    let counts = |o: &&&Outcome| o.said_after_s.is_some() || o.driven_s >= kind.stated_s;
    let outcomes: Vec<&&Outcome> = outcomes.iter().filter(counts).collect();
    let said: Vec<f64> = outcomes.iter().filter_map(|o| o.said_after_s).collect();
    let recovered: Vec<f64> = outcomes.iter().filter_map(|o| o.recovered_after_s).collect();
    let mean = |figure: fn(&Outcome) -> f64| {
        outcomes.iter().map(|o| figure(o)).sum::<f64>() / outcomes.len().max(1) as f64
    };
    let named = outcomes.iter().filter(|o| o.said_after_s.is_some() && kind.labels.contains(&o.label));
    let worst = |values: &[f64]| values.iter().copied().fold(f64::NAN, f64::max);
    Row {
        name: kind.name,
        drives: outcomes.len(),
        said: said.len(),
        in_time: said.iter().filter(|time_s| **time_s <= kind.stated_s).count(),
        named: named.count(),
        stated_s: kind.stated_s,
        said_median_s: percentile(&said, 0.5),
        said_worst_s: worst(&said),
        wrong_before_s: mean(|o| o.wrong_before_s),
        wrong_after_s: mean(|o| o.wrong_after_s),
        far_before_s: mean(|o| o.far_before_s),
        far_after_s: mean(|o| o.far_after_s),
        recovered: recovered.len(),
        awaited: outcomes.iter().filter(|o| o.recovered_after_s.is_some() || o.driven_after_s > 60.0).count(),
        recovered_median_s: percentile(&recovered, 0.5),
        recovered_worst_s: worst(&recovered),
    }
}
