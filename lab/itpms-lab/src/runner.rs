//! Many drives on all processors, in an order that does not depend on how many there are, and why a study ends before its time.
//!
//! Called by the studies. Knows nothing of drives.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

/// Stack of a thread in bytes: an estimator of a whole car is a value of some hundred kilobytes, and is handed about by
/// value while it is set up.
pub(crate) const STACK_BYTES: usize = 32 << 20;

/// Called now and then with how many drives, or simulated seconds, of how many are done; [`ControlFlow::Break`] ends the study.
pub type Progress<'a> = &'a (dyn Fn(u64, u64) -> ControlFlow<()> + Sync);

pub type Result<T, E = StudyError> = std::result::Result<T, E>;

#[derive(Debug)]
pub enum StudyError {
    /// The caller wanted no more.
    Stopped,
    /// The request, or something in a scenario, cannot be used: a sentence.
    Refused(String),
}

impl<E: std::error::Error> From<E> for StudyError {
    fn from(error: E) -> Self {
        Self::Refused(error.to_string())
    }
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stopped => "stopped",
            Self::Refused(why) => why,
        })
    }
}

pub(crate) fn refused<T>(why: impl Into<String>) -> Result<T> {
    Err(StudyError::Refused(why.into()))
}

/// Runs a test where there is as much stack as the studies have.
#[cfg(test)]
pub(crate) fn on_study_stack<T: Send + 'static>(test: impl FnOnce() -> T + Send + 'static) -> T {
    std::thread::Builder::new().stack_size(STACK_BYTES).spawn(test).unwrap().join().unwrap()
}

/// As many threads as the caller's pool has, which has smaller stacks.
pub(crate) fn pool() -> Result<rayon::ThreadPool> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(rayon::current_num_threads());
    let pool = threads.stack_size(STACK_BYTES).build();
    pool.or_else(|error| refused(format!("threads cannot be started: {error}")))
}

/// Neither shows progress nor stops.
pub const UNWATCHED: Progress<'static> = &|_, _| ControlFlow::Continue(());

/// Counts what is done over all threads, in the unit of [`Progress`], and asks whether to go on.
pub(crate) struct Odometer<'a> {
    pub(crate) done: AtomicU64,
    total: u64,
    stopped: AtomicBool,
    progress: Progress<'a>,
}

impl<'a> Odometer<'a> {
    pub(crate) fn new(total: u64, progress: Progress<'a>) -> Self {
        Self { done: AtomicU64::new(0), total, stopped: AtomicBool::new(false), progress }
    }

    fn check(&self) -> Result<()> {
        if self.stopped.load(Ordering::Relaxed) { Err(StudyError::Stopped) } else { Ok(()) }
    }

    pub(crate) fn advance(&self, more: u64) -> Result<()> {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        if (self.progress)(done.min(self.total), self.total).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
        self.check()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Turn {
    /// From 0.
    pub(crate) index: usize,
    pub(crate) seed: u64,
}

pub(crate) struct Runner<'a> {
    first_seed: u64,
    odometer: Odometer<'a>,
}

impl<'a> Runner<'a> {
    /// For `total` drives in all.
    pub(crate) fn new(first_seed: u64, total: u64, progress: Progress<'a>) -> Self {
        Self { first_seed, odometer: Odometer::new(total, progress) }
    }

    /// `drive` for so many turns of every case; results by case, then by turn.
    pub(crate) fn run<C: Sync, T: Send>(
        &self,
        cases: &[(C, usize)],
        drive: impl Fn(&C, Turn) -> Result<T> + Sync,
    ) -> Result<Vec<Vec<T>>> {
        let turns: Vec<(&C, usize)> =
            cases.iter().flat_map(|(case, drives)| (0..*drives).map(move |index| (case, index))).collect();
        let flat = || turns.into_par_iter().map(|(case, index)| self.once(case, index, &drive)).collect();
        let results: Result<Vec<T>> = pool()?.install(flat);
        let mut results = results?.into_iter();
        Ok(cases.iter().map(|(_, drives)| results.by_ref().take(*drives).collect()).collect())
    }

    fn once<C, T>(&self, case: &C, index: usize, drive: impl Fn(&C, Turn) -> Result<T>) -> Result<T> {
        self.odometer.check()?;
        let result = drive(case, Turn { index, seed: self.first_seed.wrapping_add(index as u64) })?;
        self.odometer.advance(1).map(|()| result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_by_case_and_turn() {
        let runner = Runner::new(100, 5, UNWATCHED);
        let results =
            runner.run(&[("a", 2), ("b", 3)], |case, turn| Ok(format!("{case}{}", turn.seed))).unwrap();
        assert_eq!(results, [vec!["a100", "a101"], vec!["b100", "b101", "b102"]]);
    }

    #[test]
    fn a_break_stops_the_rest() {
        let runner = Runner::new(0, 1000, &|_, _| ControlFlow::Break(()));
        let driven = AtomicU64::new(0);
        let result = runner.run(&[((), 1000)], |(), _| Ok(driven.fetch_add(1, Ordering::Relaxed)));
        assert!(matches!(result, Err(StudyError::Stopped)));
        assert!(driven.load(Ordering::Relaxed) < 1000);
    }
}
