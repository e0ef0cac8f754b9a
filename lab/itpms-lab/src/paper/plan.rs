//! All drives of the study, on all processors, results in the order of cases and seeds.
//!
//! Called once by [`super::reproduce`].

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use super::case::Case;
use super::drive::{Drive, Keep, drive};
use super::outcome::Outcome;
use super::{PaperError, Progress, Request, published::TABLE_3, published::TABLE_4, published::TABLE_5};

/// Reset drives in s: with `bench-drop` the loss comes at 38 s, with the other two at 5 s.
pub(super) const RESET_LONG_S: f64 = 20.0;
pub(super) const RESET_SHORT_S: f64 = 4.0;
/// The estimators' sprung mass in the mass studies, kg.
pub(super) const TOLD_KG: f64 = 240.0;

#[derive(Debug)]
pub(super) struct Outcomes {
    pub(super) drop: Outcome,
    pub(super) deep: Outcome,
    pub(super) recover: Outcome,
    /// By the rows of Table 3.
    pub(super) mass: [Outcome; 3],
    pub(super) bench_drop: Outcome,
    pub(super) bench_recover: Outcome,
    pub(super) bench_slow: Outcome,
    /// By the rows of Table 4.
    pub(super) bench_mass: [Outcome; 3],
    /// By the rows of Table 5.
    pub(super) bench_noise: [Outcome; 3],
}

pub(super) fn run(request: &Request, progress: Progress<'_>) -> Result<Outcomes, PaperError> {
    let simulated = |name: &str| Case::simulation(name, request);
    let bench = |name: &str, reset_s: f64| Case::bench(name, reset_s, request);
    let mut cases = vec![
        simulated("paper-drop")?,
        simulated("paper-deep-drop")?,
        simulated("paper-drop-recover")?,
        bench("bench-drop", RESET_LONG_S)?,
        bench("bench-drop-recover", RESET_SHORT_S)?,
        bench("bench-slow", RESET_SHORT_S)?,
    ];
    for row in TABLE_3 {
        cases.push(simulated("paper-drop")?.with_sprung_mass(row.setting, TOLD_KG)?);
    }
    for row in TABLE_4.iter().filter(|row| row.setting != TOLD_KG) {
        cases.push(bench("bench-drop", RESET_LONG_S)?.with_sprung_mass(row.setting, TOLD_KG)?);
    }
    for row in &TABLE_5[1..] {
        cases.push(bench("bench-drop", RESET_LONG_S)?.with_wheel_noise_variance(row.setting)?);
    }
    let mut outcomes = drive_all(&cases, request, progress)?.into_iter();
    let mut next = || outcomes.next().ok_or(PaperError::NoSeeds);
    let (drop, deep, recover) = (next()?, next()?, next()?);
    let (bench_drop, bench_recover, bench_slow) = (next()?, next()?, next()?);
    let mass = [next()?, next()?, next()?];
    // The nominal rows of Tables 4 and 5 are the same drives as Fig. 12.
    let bench_mass = [next()?, bench_drop.clone(), next()?];
    let bench_noise = [bench_drop.clone(), next()?, next()?];
    Ok(Outcomes { drop, deep, recover, mass, bench_drop, bench_recover, bench_slow, bench_mass, bench_noise })
}

fn drive_all(cases: &[Case], request: &Request, progress: Progress<'_>) -> Result<Vec<Outcome>, PaperError> {
    let turns: Vec<(&Case, usize)> =
        cases.iter().flat_map(|case| (0..request.seeds).map(move |turn| (case, turn))).collect();
    let (total, done, stopped) = (turns.len() as u64, AtomicU64::new(0), AtomicBool::new(false));
    let once = |(case, turn): (&Case, usize)| {
        if stopped.load(Ordering::Relaxed) {
            return Err(PaperError::Stopped);
        }
        let keep = if turn == 0 { Keep::Histories } else { Keep::Errors };
        let result = drive(case, request.first_seed.wrapping_add(turn as u64), keep)?;
        if progress(done.fetch_add(1, Ordering::Relaxed) + 1, total).is_break() {
            stopped.store(true, Ordering::Relaxed);
            return Err(PaperError::Stopped);
        }
        Ok(result)
    };
    let mut drives = turns.into_par_iter().map(once).collect::<Result<Vec<Drive>, _>>()?.into_iter();
    Ok(cases.iter().map(|case| Outcome::of(case, drives.by_ref().take(request.seeds).collect())).collect())
}

/// Called after every drive with how many of how many are done; [`ControlFlow::Break`] ends the study.
pub(super) type Callback<'a> = &'a (dyn Fn(u64, u64) -> ControlFlow<()> + Sync);
