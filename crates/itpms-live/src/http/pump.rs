//! From the hub's snapshots, however many, to at most ten a second, written as JSON once for all clients.
//!
//! Runs as one task of the server. The newest wins: what came in between is skipped.

use std::sync::{Arc, OnceLock};
use std::time::Duration;

use axum::body::Bytes;
use tokio::sync::watch;
use tokio::time::{Instant, sleep};

use crate::hub::Hub;
use crate::snapshot::Snapshot;

/// Time between two snapshots for clients.
const PACE: Duration = Duration::from_millis(100);

#[derive(Debug)]
pub(super) struct Frame {
    pub(super) snapshot: Arc<Snapshot>,
    /// When it came, on our own clock.
    pub(super) came: Instant,
    /// Time since the one before, as an idea of when the next one is due.
    pub(super) pace: Duration,
    json: OnceLock<Bytes>,
}

impl Frame {
    pub(super) fn new(snapshot: Arc<Snapshot>, came: Instant, pace: Duration) -> Self {
        Self { snapshot, came, pace, json: OnceLock::new() }
    }

    pub(super) fn json(&self) -> Bytes {
        self.json.get_or_init(|| json(&*self.snapshot)).clone()
    }
}

/// Anything of ours as JSON; its types cannot fail to be written.
pub(super) fn json(value: &impl serde::Serialize) -> Bytes {
    serde_json::to_vec(value).unwrap_or_else(|_| b"null".to_vec()).into()
}

/// The newest frame, for everybody.
pub(super) type Newest = watch::Receiver<Option<Arc<Frame>>>;

/// Starts the task; it ends when nothing listens any more.
pub(super) fn start(hub: &Hub) -> Newest {
    let mut snapshots = hub.subscribe();
    let (frames, newest) = watch::channel(None);
    snapshots.mark_changed();
    tokio::spawn(async move {
        let mut before = None;
        while snapshots.changed().await.is_ok() {
            let Some(snapshot) = snapshots.borrow_and_update().clone() else { continue };
            let came = Instant::now();
            let pace = before.replace(came).map_or(Duration::ZERO, |before| came - before);
            if frames.send(Some(Arc::new(Frame::new(snapshot, came, pace)))).is_err() {
                return;
            }
            sleep(PACE).await;
        }
    });
    newest
}
