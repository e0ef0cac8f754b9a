//! Several drives at a time, each on a thread of its own; what is done is kept at once.

use std::any::Any;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

use super::one::{self, Errand};
use super::record::{DriveRecord, Records};
use super::{Failed, Plan, Standing, Watch};
use crate::error::DriveError;

/// Stack of a thread in bytes: the estimator of a whole car is a value of some hundred kilobytes, and is handed about by
/// value while it is set up.
const STACK_BYTES: usize = 32 << 20;

/// How far the run is, counted in bytes of the logs.
pub(super) struct Progress<'a> {
    watch: Watch<'a>,
    bytes: u64,
    drives: usize,
    read: AtomicU64,
    done: AtomicUsize,
    stopped: AtomicBool,
}

impl<'a> Progress<'a> {
    pub(super) fn new(plan: &Plan, watch: Watch<'a>) -> Self {
        let bytes = plan.files.iter().map(|file| file.bytes).sum::<u64>().max(1);
        let (read, done, stopped) = Default::default();
        Self { watch, bytes, drives: plan.files.len(), read, done, stopped }
    }

    /// A drive is done, or was before, and so many more of its bytes count.
    pub(super) fn finished(&self, bytes: u64) {
        self.done.fetch_add(1, Ordering::Relaxed);
        let _ = self.moved(bytes);
    }

    fn moved(&self, bytes: u64) -> ControlFlow<()> {
        let read = self.read.fetch_add(bytes, Ordering::Relaxed) + bytes;
        let share = read as f64 / self.bytes as f64;
        let done = self.done.load(Ordering::Relaxed);
        if (self.watch)(Standing { share, done, drives: self.drives }).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
        if self.stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Does all errands; gives those that failed, with their places among the files.
pub(super) fn run(
    plan: &Plan,
    errands: Vec<Errand<'_>>,
    records: &mut Records,
    progress: &Progress<'_>,
) -> Result<Vec<(usize, Failed)>, DriveError> {
    if errands.is_empty() {
        return Ok(Vec::new());
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(plan.jobs.clamp(1, errands.len()))
        .stack_size(STACK_BYTES)
        .build()
        .map_err(|error| DriveError::Mismatch(format!("no threads to compute with: {error}")))?;
    let (next, kept) = (AtomicUsize::new(0), Mutex::new((records, Vec::new(), None)));
    pool.broadcast(|_| {
        while let Some(errand) = errands.get(next.fetch_add(1, Ordering::Relaxed)) {
            let result = perform(plan, errand, progress);
            // Poisoned only by a panic while a line is written, which ends the program anyway.
            let mut kept = kept.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            let (records, failed, fatal) = &mut *kept;
            match result {
                Ok(record) => {
                    if let Err(error) = records.add(record) {
                        progress.stopped.store(true, Ordering::Relaxed);
                        *fatal = Some(error);
                    }
                }
                Err(DriveError::Stopped) => {}
                // No other drive's files would have room either.
                Err(DriveError::Data(error)) if error.is_of_a_full_disk() => {
                    progress.stopped.store(true, Ordering::Relaxed);
                    *fatal = Some(DriveError::Data(error));
                }
                Err(error) => {
                    let (file, car) = (errand.path.to_owned(), Some(errand.car.id.clone()));
                    failed.push((errand.number, Failed { file, car, why: error.to_string() }));
                }
            }
            if progress.stopped.load(Ordering::Relaxed) {
                break;
            }
        }
    });
    let (_, failed, fatal) = kept.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    match fatal {
        Some(error) => Err(error),
        None if progress.stopped.load(Ordering::Relaxed) => Err(DriveError::Stopped),
        None => Ok(failed),
    }
}

/// One of them. A fault of the program in one drive is that drive's failure and not the fleet's.
fn perform(plan: &Plan, errand: &Errand<'_>, progress: &Progress<'_>) -> Result<DriveRecord, DriveError> {
    let mut counted = 0;
    let mut watch = |share: f64| {
        let read = (share.clamp(0.0, 1.0) * errand.bytes as f64) as u64;
        let more = read.saturating_sub(counted);
        counted += more;
        progress.moved(more)
    };
    let result = catch_unwind(AssertUnwindSafe(|| one::run(plan, errand, &mut watch)));
    progress.finished(errand.bytes.saturating_sub(counted));
    result.unwrap_or_else(|panic| {
        let (path, what) = (errand.path.display(), panic_message(&*panic));
        Err(DriveError::Mismatch(format!("{path}: a fault of this program, worth reporting: {what}")))
    })
}

fn panic_message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message")
}
