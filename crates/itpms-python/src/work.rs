//! Long computations on a thread of their own, while the interpreter is free, looks for Ctrl-C and receives how far they are.
//!
//! Python tells signals to its main thread only, so that one must not compute; and an estimator of a whole car needs more
//! stack than a Python thread may have.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

const STACK_BYTES: usize = 32 << 20;
/// How soon Ctrl-C is seen.
const LOOK: Duration = Duration::from_millis(50);

/// Who receives the share that is done, 0 to 1, some twenty times a second, on the thread that called.
pub(crate) type Progress = Option<Py<PyAny>>;

/// State shared by a computation and the thread that waits for it.
#[derive(Debug, Default)]
pub(crate) struct Meanwhile {
    stop: AtomicBool,
    /// The share that is done, as the bits of an `f64`.
    done: AtomicU64,
}

impl Meanwhile {
    /// Says how far the computation is; a break where an end is wanted.
    pub(crate) fn done(&self, share: f64) -> ControlFlow<()> {
        self.done.store(share.to_bits(), Ordering::Relaxed);
        if self.stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Looks for a signal and tells how far it is.
    fn look(&self, progress: &Progress) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            let Some(progress) = progress else { return Ok(()) };
            progress.call1(py, (f64::from_bits(self.done.load(Ordering::Relaxed)),)).map(drop)
        })
    }
}

/// Runs `work` without the interpreter's lock; on Ctrl-C, or what `progress` raises, it is asked to stop, and that exception is raised.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    progress: &Progress,
    work: impl FnOnce(&Meanwhile) -> T + Send,
) -> PyResult<T> {
    let meanwhile = Meanwhile::default();
    py.detach(|| {
        thread::scope(|scope| {
            let (done, wait) = channel();
            let meanwhile = &meanwhile;
            let spawned = thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, move || {
                let result = work(meanwhile);
                // No one waits any more only where the interpreter has raised something.
                let _ = done.send(());
                result
            });
            let worker = spawned
                .map_err(|error| PyRuntimeError::new_err(format!("no thread to compute with: {error}")))?;
            let mut raised = Ok(());
            while let Err(RecvTimeoutError::Timeout) = wait.recv_timeout(LOOK) {
                raised = meanwhile.look(progress);
                if raised.is_err() {
                    meanwhile.stop.store(true, Ordering::Relaxed);
                    break;
                }
            }
            let result = worker.join();
            raised?;
            result.map_err(|_| PyRuntimeError::new_err("a fault of this program, worth reporting"))
        })
    })
}
