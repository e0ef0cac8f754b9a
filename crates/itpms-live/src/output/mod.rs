//! Where estimates and warnings go, each output behind a queue and a thread of its own, so that none can stall the estimate.
//!
//! | module | idea |
//! |---|---|
//! | `json` | a line of JSON per estimate and per warning |
//! | [`can`] | frames of our own DBC |
//! | `mcap` (feature) | a recording for Foxglove and PlotJuggler |
//! | `mqtt` | messages of a broker |
//!
//! Fed by the estimating thread; knows nothing of where the estimates come from.

pub mod can;
mod json;
#[cfg(feature = "mcap")]
mod mcap;
mod mqtt;

use std::collections::VecDeque;
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::Duration;

pub use json::JsonLines;
#[cfg(feature = "mcap")]
pub use mcap::McapOut;
pub use mqtt::Mqtt;

use crate::engine::Published;
use crate::error::LiveError;
use crate::queue::{Queue, Taken};

/// Items that wait for an output at most: seven minutes at ten a second, some 10 MB.
const WAITING: usize = 4096;
/// How long an output's thread sleeps at most.
const PATIENCE: Duration = Duration::from_millis(200);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhenSlow {
    /// The estimate waits: for files, and for sources that can wait, too. Nothing is lost.
    Wait,
    /// The oldest waiting estimates are lost and counted; warnings only if nothing but warnings waits.
    LoseEstimates,
}

#[derive(Debug)]
pub struct Output {
    queue: Arc<Queue<Published>>,
    when_slow: WhenSlow,
    failed: Arc<OnceLock<String>>,
    thread: Option<JoinHandle<Result<(), LiveError>>>,
}

impl Output {
    /// Starts an output that hands everything to `write`, and at the end to `end`.
    pub(crate) fn start<W: Send + 'static>(
        when_slow: WhenSlow,
        mut writer: W,
        write: impl Fn(&mut W, &mut VecDeque<Published>) -> Result<(), LiveError> + Send + 'static,
        end: impl FnOnce(W) -> Result<(), LiveError> + Send + 'static,
    ) -> Self {
        let queue = Arc::new(Queue::new(WAITING));
        let failed = Arc::new(OnceLock::new());
        let thread = thread::spawn({
            let (queue, failed) = (Arc::clone(&queue), Arc::clone(&failed));
            move || {
                let mut taken = VecDeque::new();
                loop {
                    match queue.take(&mut taken, PATIENCE) {
                        Taken::Closed => return end(writer),
                        Taken::Some | Taken::Nothing => {}
                    }
                    if let Err(error) = write(&mut writer, &mut taken) {
                        let _ = failed.set(error.to_string());
                        // No one shall wait for room here.
                        queue.close();
                        return Err(error);
                    }
                }
            }
        });
        Self { queue, when_slow, failed, thread: Some(thread) }
    }

    /// Hands it to the output's thread.
    pub fn publish(&self, published: &Published) {
        match self.when_slow {
            WhenSlow::Wait => {
                self.queue.push(published.clone());
            }
            WhenSlow::LoseEstimates => {
                self.queue.push_now(published.clone(), |old| matches!(old, Published::Estimate(_)));
            }
        }
    }

    /// Why it has given up, if it has.
    pub fn failure(&self) -> Option<&str> {
        self.failed.get().map(String::as_str)
    }

    /// Losses because the output was slow.
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }

    /// Waits until everything is out.
    pub fn finish(mut self) -> Result<(), LiveError> {
        self.queue.close();
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(LiveError::Refused("an output broke off".to_owned())),
            None => Ok(()),
        }
    }
}
