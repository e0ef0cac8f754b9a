//! False warnings over many hours: everyday drives in which nothing is wrong, one after the other, until one is warned of.
//!
//! Called by the binary's `soak`. A drive is an hour of `drive-normal`, composed from its seed; every seed is also
//! another car, within tolerances of bodies, tires and sensors that the estimator does not know of. Nothing here knows of
//! files: what is done is handed over drive by drive, and what was done before is given.
//!
//! | module | idea |
//! |---|---|
//! | [`hour`] | one drive, and what is kept of it |
//! | [`day`] | a calibration and a later day on wheel speeds, under drawn conditions |
//! | [`day_summary`] | many days added up |
//! | `rolling` | the same on wheel speeds alone |
//! | [`summary`] | many drives added up |

pub mod day;
pub mod day_summary;
pub mod hour;
mod rolling;
pub mod summary;

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use serde::{Deserialize, Serialize};

use crate::runner::{Result, STACK_BYTES, StudyError, refused};
use crate::sensors::Sensors;
pub use day::Days;
pub use hour::{Hour, RadiusHour, Said, WheelHour};
pub use summary::Summary;

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Car {
        /// Another one with every seed.
        Varied = "varied",
        /// That of `drive-normal`, which is nearly the one the estimator is given.
        Nominal = "nominal",
        /// Another one with every seed, and its wheels not joined by a body: four quarter cars, whose rear wheels meet the
        /// front wheels' road. No bends and no loads, but nothing that rests on a rigid body may be taken for granted.
        Quarters = "quarters",
    }
}

/// Plan of the drives: those of one plan can be added up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    pub rate_hz: f64,
    pub drive_s: f64,
    pub car: Car,
    /// Length in s of a calibration at the beginning of every drive, `None`: never calibrated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibrate_s: Option<f64>,
    /// What the car has; with wheel speeds alone each seed has a bus of its own, and is calibrated for ten minutes unless given.
    #[serde(default, skip_serializing_if = "Sensors::are_usual")]
    pub sensors: Sensors,
    /// On wheel speeds alone: a calibration and a later day in place of one drive, under these conditions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub days: Option<Days>,
}

impl Default for Plan {
    /// Hours at 200 Hz, each seed another car.
    fn default() -> Self {
        Self {
            rate_hz: 200.0,
            drive_s: 3600.0,
            car: Car::Varied,
            calibrate_s: None,
            sensors: Sensors::default(),
            days: None,
        }
    }
}

/// Drives these seeds, `jobs` at a time. Each drive is handed to `done` when it is complete, in whatever order;
/// `flow` is asked every few seconds of driving, and by both [`ControlFlow::Break`] ends the whole.
pub fn soak(
    plan: &Plan,
    seeds: &[u64],
    jobs: usize,
    done: &mut (dyn FnMut(Hour) -> ControlFlow<()> + Send),
    flow: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Result<()> {
    let (next, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let done = Mutex::new(done);
    let stop = || {
        if stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { flow() }
    };
    let work = || -> Result<()> {
        while let Some(&seed) = seeds.get(next.fetch_add(1, Ordering::Relaxed)) {
            let hour = match &plan.days {
                Some(days) => day::drive(plan, days, seed, &stop),
                None if plan.sensors.are_of_wheels() => rolling::drive(plan, seed, &stop),
                None => hour::drive(plan, seed, &stop),
            };
            if hour.is_err() {
                stopped.store(true, Ordering::Relaxed);
            }
            let hour = hour?;
            // Poisoned only by a panic in another thread, which ends the program anyway.
            let mut done = done.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            if done(hour).is_break() {
                stopped.store(true, Ordering::Relaxed);
                return Err(StudyError::Stopped);
            }
        }
        Ok(())
    };
    let results: Vec<Result<()>> = thread::scope(|scope| {
        let spawn = || thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, work);
        let handles: Vec<_> = (0..jobs.clamp(1, seeds.len().max(1))).map(|_| spawn()).collect();
        let join = |handle: std::io::Result<thread::ScopedJoinHandle<'_, Result<()>>>| {
            let handle = handle.or_else(|error| refused(format!("threads cannot be started: {error}")))?;
            handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        handles.into_iter().map(join).collect()
    });
    // A reason comes before the stops that follow from it.
    let mut outcome = Ok(());
    for result in results {
        match (&outcome, &result) {
            (Ok(()), Err(_)) => outcome = result,
            (Err(StudyError::Stopped), Err(error)) if !matches!(error, StudyError::Stopped) => {
                outcome = result
            }
            _ => {}
        }
    }
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;

    fn short() -> Plan {
        Plan { drive_s: 30.0, ..Plan::default() }
    }

    fn go() -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn hours(seeds: &[u64], jobs: usize) -> Vec<Hour> {
        let mut hours = vec![];
        let mut done = |hour: Hour| {
            hours.push(Hour { wall_s: 0.0, ..hour });
            go()
        };
        soak(&short(), seeds, jobs, &mut done, &go).unwrap();
        hours.sort_by_key(|hour| hour.seed);
        hours
    }

    #[test]
    fn hours_do_not_depend_on_the_number_of_threads() {
        let (one, three) = (hours(&[1, 2, 3, 4], 1), hours(&[4, 3, 2, 1], 3));
        assert_eq!(one, three);
        assert_eq!(one.iter().map(|hour| hour.seed).collect::<Vec<_>>(), [1, 2, 3, 4]);
        assert!(one.iter().all(|hour| (hour.driven_s - 30.0).abs() < 1e-9 && hour.km > 0.0));
        // Lines of a file carry all of it.
        let line = one[0].to_line();
        assert_eq!(Hour::from_line(&line).unwrap(), one[0]);
        assert!(Hour::from_line("{}").is_none() && Hour::from_line(&line[1..]).is_none());
    }

    #[test]
    fn quarter_cars_go_on_the_same_journey() {
        let drive = |car| {
            let mut driven = None;
            let plan = Plan { car, drive_s: 120.0, ..Plan::default() };
            let mut done = |hour: Hour| {
                driven = Some(hour);
                go()
            };
            soak(&plan, &[3], 1, &mut done, &go).unwrap();
            driven.unwrap()
        };
        let [joined, quarters] = [Car::Varied, Car::Quarters].map(drive);
        assert!(joined.km > 0.5 && (joined.km - quarters.km).abs() < 1e-9);
        // Another car, so other errors; but nothing is wrong with either.
        assert_ne!(joined.wheels, quarters.wheels);
        assert!(quarters.wheels.iter().all(|wheel| wheel.valid > 0.5), "{:?}", quarters.wheels);
        assert_eq!(quarters.said, []);
    }

    #[test]
    fn a_calibration_at_the_beginning_makes_drawn_cars_more_accurate() {
        let rmse_kpa = |calibrate_s| {
            let plan = Plan { drive_s: 150.0, calibrate_s, ..Plan::default() };
            let mut squares = vec![];
            let mut done = |hour: Hour| {
                squares.extend(hour.wheels.iter().map(|wheel| wheel.rmse_kpa.unwrap().powi(2)));
                go()
            };
            soak(&plan, &[1, 2, 3], 2, &mut done, &go).unwrap();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        let (without, with) = (rmse_kpa(None), rmse_kpa(Some(60.0)));
        assert!(with < 0.7 * without, "{without} {with}");
        let nothing = Plan { calibrate_s: Some(0.0), ..short() };
        let refused = soak(&nothing, &[1], 1, &mut |_| go(), &go);
        assert!(matches!(refused, Err(StudyError::Refused(why)) if why.contains("calibrate_s")));
    }

    #[test]
    fn it_stops_when_told_and_says_why_it_cannot_go_on() {
        let mut count = 0;
        let mut done = |_: Hour| {
            count += 1;
            ControlFlow::Break(())
        };
        let stopped = soak(&short(), &[1, 2, 3, 4, 5, 6], 2, &mut done, &go);
        assert!(matches!(stopped, Err(StudyError::Stopped)));
        assert!(count <= 2);
        let never = soak(&short(), &[1], 1, &mut |_| go(), &|| ControlFlow::Break(()));
        assert!(matches!(never, Err(StudyError::Stopped)));
        let slow = Plan { rate_hz: 1.0, ..short() };
        let refused = soak(&slow, &[1, 2], 2, &mut |_| go(), &go).unwrap_err().to_string();
        assert!(refused.contains("rate_hz"), "{refused}");
    }
}
