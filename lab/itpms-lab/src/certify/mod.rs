//! The test procedures of UN R141 Annex 3 and FMVSS 138 S6, driven in simulation and held against their limits.
//!
//! Called by the binary (`itpms lab certify`). What the estimator and its monitor see is what a car would give them; pressures and
//! faults are set here and compared with what the tell-tale did, and with what was reported beside it. A simulation is no type
//! approval; docs/certify.md says which clauses are driven and which are not.
//!
//! | module | idea |
//! |---|---|
//! | `rules` | what the two regulations ask for: speeds, pressures, times |
//! | `procedure` | the list of tests |
//! | `test_case` | what a test does to the car |
//! | `course` | a test as a scenario: learning, standstill, detection |
//! | `telltale` | what the driver would see |
//! | `watched` | the monitor, on accelerations or on wheel speeds |
//! | `drive` | one test from the reset to the tell-tale's end |
//! | `outcome` | what came of it, and whether that passes |
//! | `patterns` | tests of one kind together |
//! | `table`, `page`, `figures` | for people |

mod course;
mod drive;
mod figures;
mod outcome;
mod page;
mod patterns;
mod procedure;
mod rules;
mod table;
mod telltale;
mod test_case;
#[cfg(test)]
mod tests;
mod watched;

use rayon::prelude::*;
use serde::Serialize;

use crate::runner::{Odometer, Progress, Result, pool, refused};
use crate::sensors::Sensors;

pub use outcome::{FalseAlert, Outcome, Phase, TracePoint, Verdict};
pub use patterns::PatternTests;
pub use procedure::{Extent, Procedure};
pub use rules::Rule;
pub use table::list;
pub use test_case::{Failure, Test};

#[derive(Debug, Clone)]
pub struct Request {
    pub extent: Extent,
    pub only: Option<String>,
    /// Seed of the first test's course; the others follow.
    pub seed: u64,
    /// What the car has; with wheel speeds it has no sensor to unplug, and every combination of tires is let down for both.
    pub sensors: Sensors,
    /// What it knows of its loads, which do not change in a test; of no meaning with accelerations.
    pub loads: StatedLoads,
    /// How often each test is driven, with another car, road and noise.
    pub repeats: u32,
}

itpms_core::labelled! {
    /// How well a car with wheel speeds alone knows its load. More load is a smaller radius, as less pressure is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum StatedLoads {
        /// Nothing, as in everyday life: passengers may have got in while it stood.
        #[default]
        Unknown = "unknown",
        /// That they stay as they are, as the regulations have it.
        Constant = "constant",
    }
}

#[derive(Debug, Clone, Serialize)]
pub struct Certificate {
    pub version: &'static str,
    pub seed: u64,
    pub passed: bool,
    pub driven_s: f64,
    /// Tests of one kind together, where they were driven on wheel speeds.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub patterns: Vec<PatternTests>,
    pub outcomes: Vec<Outcome>,
}

/// The tests of a request, in order. Errors: none has such a name.
pub fn procedures(request: &Request) -> Result<Vec<Procedure>> {
    let all = Procedure::all(request.extent, request.sensors);
    let Some(part) = &request.only else { return Ok(all) };
    let chosen: Vec<Procedure> = all.iter().filter(|p| p.name().contains(part.as_str())).copied().collect();
    if chosen.is_empty() {
        let known = all.iter().map(Procedure::name).collect::<Vec<_>>().join(", ");
        return refused(format!("no test's name contains {part:?}, expected a part of one of: {known}"));
    }
    Ok(chosen)
}

/// Drives the tests on all processors. The same request gives the same result, however many there are.
/// Errors: no such test, a stop, or a scenario that cannot be driven.
pub fn certify(request: &Request, progress: Progress<'_>) -> Result<Certificate> {
    let mut runs = vec![];
    for procedure in procedures(request)? {
        for again in 0..u64::from(request.repeats.max(1)) {
            // A test keeps its course whichever other tests are driven.
            let seed = request.seed.wrapping_mul(1000).wrapping_add(procedure.number(request.sensors));
            let seed = seed.wrapping_add(again.wrapping_mul(1_000_000));
            let course = course::Course::new(&procedure)?;
            let course = match request.sensors {
                Sensors::Accelerations => course,
                Sensors::WheelSpeeds | Sensors::Pulses => course.on_wheel_speeds(seed),
            };
            runs.push((procedure, course, seed));
        }
    }
    let total_s = runs.iter().map(|(_, course, _)| course.longest_s() as u64).sum();
    let odometer = Odometer::new(total_s, progress);
    let outcomes: Result<Vec<Outcome>> = pool()?.install(|| {
        let one = |(procedure, course, seed): &(Procedure, course::Course, u64)| {
            drive::drive(procedure, course, *seed, (request.sensors, request.loads), &odometer)
        };
        runs.par_iter().map(one).collect()
    });
    let outcomes = outcomes?;
    let patterns = match request.sensors {
        Sensors::Accelerations => vec![],
        Sensors::WheelSpeeds | Sensors::Pulses => {
            let of: Vec<_> = runs.iter().map(|(procedure, ..)| *procedure).zip(&outcomes).collect();
            patterns::by_pattern(&of)
        }
    };
    Ok(Certificate {
        version: env!("CARGO_PKG_VERSION"),
        seed: request.seed,
        passed: outcomes.iter().all(|outcome| outcome.verdict == Verdict::Pass),
        driven_s: outcomes.iter().map(|outcome| outcome.driven_s).sum(),
        patterns,
        outcomes,
    })
}
