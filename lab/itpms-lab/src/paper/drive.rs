//! One drive with all contestants on board: their errors, and for the drive that is drawn their histories.
//!
//! Called by `plan`, on all processors.

use itpms_sim::simulation::Simulation;

use super::CORNER;
use super::case::{Case, JUDGED_FROM_S};
use super::contestant::{Runner, Word};
use crate::runner::Result;
use crate::score::stats::ErrorSum;

const TRACE_HZ: f64 = 20.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keep {
    Errors,
    Histories,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Achieved {
    /// Over t > 3 s, kPa; infinite once diverged.
    pub(super) rmse_kpa: f64,
    /// The same over the time after the reset drive.
    pub(super) rmse_after_kpa: f64,
    /// Share of that time with the truth inside the 95 % interval.
    pub(super) coverage: f64,
    pub(super) diverged_s: Option<f64>,
    /// Empty unless histories are kept.
    pub(super) trace: Trace,
}

/// A contestant's histories at [`TRACE_HZ`]; the road at the log's rate.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Trace {
    pub(super) pressure_kpa: Vec<f64>,
    pub(super) pressure_sd_kpa: Vec<f64>,
    pub(super) stiffness_n_per_m: Vec<f64>,
    pub(super) stiffness_variance: Vec<f64>,
    /// The largest since the last point.
    pub(super) forgetting: Vec<f64>,
    pub(super) road_m: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Truth {
    pub(super) time_s: Vec<f64>,
    pub(super) pressure_kpa: Vec<f64>,
    pub(super) stiffness_n_per_m: Vec<f64>,
    pub(super) road_time_s: Vec<f64>,
    pub(super) road_m: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drive {
    /// In the order of the case's contestants.
    pub(super) results: Vec<Achieved>,
    /// Empty unless histories are kept.
    pub(super) truth: Truth,
}

struct Seat {
    runner: Runner,
    reset_s: f64,
    all: ErrorSum,
    after: ErrorSum,
    diverged_s: Option<f64>,
    largest_forgetting: f64,
    trace: Trace,
}

impl Seat {
    fn take(&mut self, time_s: f64, word: &Word, truth_kpa: f64) {
        if word.diverged && self.diverged_s.is_none() {
            self.diverged_s = Some(time_s);
        }
        let error = word.pressure_kpa - truth_kpa;
        if time_s > JUDGED_FROM_S {
            self.all.push(error, word.pressure_sd_kpa);
        }
        if time_s > self.reset_s.max(JUDGED_FROM_S) {
            self.after.push(error, word.pressure_sd_kpa);
        }
        self.largest_forgetting = self.largest_forgetting.max(word.forgetting);
    }

    /// After a divergence there is nothing to draw.
    fn draw(&mut self, word: &Word) {
        let shown = |value: f64| if word.diverged { f64::NAN } else { value };
        self.trace.pressure_kpa.push(shown(word.pressure_kpa));
        self.trace.pressure_sd_kpa.push(shown(word.pressure_sd_kpa));
        self.trace.stiffness_n_per_m.push(shown(word.stiffness_n_per_m));
        self.trace.stiffness_variance.push(shown(word.stiffness_variance));
        self.trace.forgetting.push(shown(self.largest_forgetting));
        self.largest_forgetting = f64::NEG_INFINITY;
    }

    fn finish(self) -> Achieved {
        let or_diverged = |rmse: f64| if self.diverged_s.is_some() { f64::INFINITY } else { rmse };
        Achieved {
            rmse_kpa: or_diverged(self.all.rmse()),
            rmse_after_kpa: or_diverged(self.after.rmse()),
            coverage: self.after.coverage(),
            diverged_s: self.diverged_s,
            trace: self.trace,
        }
    }
}

pub(super) fn drive(case: &Case, seed: u64, keep: Keep) -> Result<Drive> {
    let corner = case.scenario.corner_config(CORNER)?;
    let rate_hz = case.scenario.rate_hz;
    let mut seats = Vec::with_capacity(case.contestants.len());
    for contestant in &case.contestants {
        seats.push(Seat {
            runner: Runner::new(contestant, case.tuning, &corner, rate_hz)?,
            reset_s: contestant.reset_s,
            all: ErrorSum::default(),
            after: ErrorSum::default(),
            diverged_s: None,
            largest_forgetting: f64::NEG_INFINITY,
            trace: Trace::default(),
        });
    }
    let mut truth = Truth::default();
    let mut due_s = 0.0;
    for row in Simulation::new(&case.scenario, seed)? {
        let Some(true_corner) = row.corners[CORNER.index()] else { continue };
        let sample = true_corner.sample();
        let drawn = keep == Keep::Histories && row.time_s >= due_s - 1e-9;
        for seat in &mut seats {
            let word = seat.runner.update(row.time_s, row.speed_m_s, &sample);
            seat.take(row.time_s, &word, true_corner.pressure_kpa);
            if drawn {
                seat.draw(&word);
            }
            if keep == Keep::Histories {
                seat.trace.road_m.push(if word.diverged { f64::NAN } else { word.road_m });
            }
        }
        if drawn {
            due_s += 1.0 / TRACE_HZ;
            truth.time_s.push(row.time_s);
            truth.pressure_kpa.push(true_corner.pressure_kpa);
            truth.stiffness_n_per_m.push(true_corner.stiffness_n_per_m);
        }
        if keep == Keep::Histories {
            truth.road_time_s.push(row.time_s);
            truth.road_m.push(true_corner.road_m);
        }
    }
    Ok(Drive { results: seats.into_iter().map(Seat::finish).collect(), truth })
}
