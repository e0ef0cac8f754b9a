//! Estimates and warnings as messages of an MQTT broker (3.1.1).
//!
//! | topic | message | kept by the broker | delivery |
//! |---|---|---|---|
//! | PREFIX/estimate | a snapshot | no | at most once: only the newest waits |
//! | PREFIX/warning | a transition | yes | at least once |
//! | PREFIX/status | `{"state":"online"}`, and `offline` as last will | yes | at least once |
//!
//! A warning waits here until the broker has acknowledged it, whatever becomes of the connection; up to a bound, beyond
//! which the oldest are lost and that is reported.

mod link;
mod outbox;

use std::collections::VecDeque;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use self::outbox::{Outbox, Shared};
use super::{Output, WhenSlow};
use crate::broker::BrokerAddress;
use crate::engine::Published;
use crate::error::LiveError;
use crate::input::{Note, NoteSink};

/// How long the end of the monitor waits for the broker to take what is left.
const LAST_PATIENCE: Duration = Duration::from_secs(3);

pub struct Mqtt {
    shared: Arc<Shared>,
    prefix: String,
    notes: NoteSink,
    link: JoinHandle<()>,
}

impl Mqtt {
    /// Starts to connect; a broker that is not there yet is waited for.
    /// Errors: the prefix has a wildcard, which a broker answers by hanging up; or the system gives no thread.
    pub fn open(address: BrokerAddress, notes: &NoteSink) -> Result<Self, LiveError> {
        if address.topic.contains(['#', '+']) {
            return Err(LiveError::BrokerAddress { found: address.topic });
        }
        let prefix = address.topic.clone();
        let shared = Arc::new(Shared::new(Outbox::new(&prefix)));
        let failed = |error| LiveError::Output { target: "MQTT".to_owned(), error };
        let link = thread::Builder::new().name("mqtt-out".to_owned()).spawn({
            let (shared, notes) = (Arc::clone(&shared), Arc::clone(notes));
            move || link::run(&address, &shared, &notes)
        });
        Ok(Self { shared, prefix, notes: Arc::clone(notes), link: link.map_err(failed)? })
    }

    pub fn start(self) -> Output {
        Output::start(WhenSlow::LoseEstimates, self, Self::write, Self::end)
    }

    fn write(&mut self, waiting: &mut VecDeque<Published>) -> Result<(), LiveError> {
        if waiting.is_empty() {
            return Ok(());
        }
        let mut estimate = None;
        let mut warnings = Vec::new();
        for published in waiting.drain(..) {
            match published {
                Published::Estimate(snapshot) => estimate = Some(snapshot),
                Published::Warning(transition) => warnings.push(transition),
            }
        }
        let mut outbox = self.shared.lock();
        for warning in warnings {
            if let Ok(payload) = serde_json::to_vec(&*warning) {
                outbox.post(format!("{}/warning", self.prefix), payload);
            }
        }
        if let Some(Ok(payload)) = estimate.map(|snapshot| serde_json::to_vec(&*snapshot)) {
            outbox.newest = Some(payload);
        }
        drop(outbox);
        self.shared.changed.notify_one();
        Ok(())
    }

    fn end(self) -> Result<(), LiveError> {
        self.shared.lock().close(&self.prefix, LAST_PATIENCE);
        self.shared.changed.notify_one();
        let _ = self.link.join();
        let outbox = self.shared.lock();
        let left = outbox.left();
        if left > 0 || outbox.lost > 0 {
            let text = format!("MQTT: {left} messages were never acknowledged, {} had no room", outbox.lost);
            (self.notes)(Note::Warning(text));
        }
        Ok(())
    }
}
