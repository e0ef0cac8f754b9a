//! Long computations on a thread of their own, while the interpreter is free and looks for Ctrl-C.
//!
//! Python tells signals to its main thread only, so that one must not compute; and an estimator of a whole car needs more
//! stack than a Python thread may have.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

const STACK_BYTES: usize = 32 << 20;
/// How soon Ctrl-C is seen.
const LOOK: Duration = Duration::from_millis(50);

/// Whether somebody wants a computation to end.
#[derive(Debug, Default)]
pub(crate) struct Stop(AtomicBool);

impl Stop {
    pub(crate) fn wanted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Runs `work` without the interpreter's lock; on Ctrl-C it is told to stop, and the interpreter's exception is raised.
pub(crate) fn run<T: Send>(py: Python<'_>, work: impl FnOnce(&Stop) -> T + Send) -> PyResult<T> {
    let stop = Stop::default();
    py.detach(|| {
        thread::scope(|scope| {
            let (done, wait) = channel();
            let stop = &stop;
            let spawned = thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, move || {
                let result = work(stop);
                // Nobody waits any more only where the interpreter has raised something.
                let _ = done.send(());
                result
            });
            let worker = spawned
                .map_err(|error| PyRuntimeError::new_err(format!("no thread to compute with: {error}")))?;
            let mut raised = Ok(());
            while let Err(RecvTimeoutError::Timeout) = wait.recv_timeout(LOOK) {
                raised = Python::attach(|py| py.check_signals());
                if raised.is_err() {
                    stop.0.store(true, Ordering::Relaxed);
                    break;
                }
            }
            let result = worker.join();
            raised?;
            result.map_err(|_| PyRuntimeError::new_err("a fault of this program, worth reporting"))
        })
    })
}
