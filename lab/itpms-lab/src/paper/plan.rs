//! All drives of the study, on all processors, results in the order of cases and seeds.
//!
//! Called once by [`super::reproduce`].

use super::case::Case;
use super::drive::{Keep, drive};
use super::outcome::Outcome;
use super::{Progress, Request, published::TABLE_3, published::TABLE_4, published::TABLE_5};
use crate::runner::{Result, Runner, StudyError};

/// Reset drives in s: with `bench-drop` the loss comes at 38 s, with the other two at 5 s.
pub(super) const RESET_LONG_S: f64 = 20.0;
pub(super) const RESET_SHORT_S: f64 = 4.0;
/// The estimators' sprung mass in the mass studies, kg.
pub(super) const CONFIGURED_KG: f64 = 240.0;

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

pub(super) fn run(request: &Request, progress: Progress<'_>) -> Result<Outcomes> {
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
        cases.push(simulated("paper-drop")?.with_sprung_mass(row.setting, CONFIGURED_KG)?);
    }
    for row in TABLE_4.iter().filter(|row| row.setting != CONFIGURED_KG) {
        cases.push(bench("bench-drop", RESET_LONG_S)?.with_sprung_mass(row.setting, CONFIGURED_KG)?);
    }
    for row in &TABLE_5[1..] {
        cases.push(bench("bench-drop", RESET_LONG_S)?.with_wheel_noise_variance(row.setting)?);
    }
    let mut outcomes = drive_all(&cases, request, progress)?.into_iter();
    let mut next = || outcomes.next().ok_or_else(|| StudyError::Refused("0 seeds".to_owned()));
    let (drop, deep, recover) = (next()?, next()?, next()?);
    let (bench_drop, bench_recover, bench_slow) = (next()?, next()?, next()?);
    let mass = [next()?, next()?, next()?];
    // The nominal rows of Tables 4 and 5 are the same drives as Fig. 12.
    let bench_mass = [next()?, bench_drop.clone(), next()?];
    let bench_noise = [bench_drop.clone(), next()?, next()?];
    Ok(Outcomes { drop, deep, recover, mass, bench_drop, bench_recover, bench_slow, bench_mass, bench_noise })
}

fn drive_all(cases: &[Case], request: &Request, progress: Progress<'_>) -> Result<Vec<Outcome>> {
    let cases: Vec<(&Case, usize)> = cases.iter().map(|case| (case, request.seeds)).collect();
    let runner = Runner::new(request.first_seed, (cases.len() * request.seeds) as u64, progress);
    let drives = runner.run(&cases, |case, turn| {
        drive(case, turn.seed, if turn.index == 0 { Keep::Histories } else { Keep::Errors })
    })?;
    Ok(cases.iter().zip(drives).map(|((case, _), drives)| Outcome::of(case, drives)).collect())
}
