//! The newest snapshot for whoever asks, and a bounded history for whoever comes late.
//!
//! Fed by the estimating thread, which never waits for a reader: a slow one misses snapshots, not the other way round. Read
//! by the web server. Knows nothing of how snapshots are made or shown.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::{broadcast, watch};

use crate::snapshot::{Snapshot, Transition};

/// Seconds of the source's clock between two points of the coarse history, and how far it reaches back.
const COARSE: Thinning = Thinning { step_s: 1.0, span_s: 900.0 };
/// The same of the fine history.
const FINE: Thinning = Thinning { step_s: 0.1, span_s: 60.0 };
const TRANSITIONS: usize = 256;

/// Where the newest is to be had.
#[derive(Debug)]
pub struct Hub {
    latest: watch::Sender<Option<Arc<Snapshot>>>,
    transitions: broadcast::Sender<Arc<Transition>>,
    past: Mutex<Past>,
}

/// The history, oldest first.
#[derive(Debug, Clone, Default)]
pub struct History {
    pub coarse: Vec<Arc<Snapshot>>,
    /// The last minute, ten a second.
    pub fine: Vec<Arc<Snapshot>>,
    /// The last transitions, at most 256.
    pub transitions: Vec<Arc<Transition>>,
}

#[derive(Debug, Default)]
struct Past {
    coarse: VecDeque<Arc<Snapshot>>,
    fine: VecDeque<Arc<Snapshot>>,
    transitions: VecDeque<Arc<Transition>>,
}

impl Default for Hub {
    fn default() -> Self {
        Self {
            latest: watch::Sender::new(None),
            transitions: broadcast::Sender::new(TRANSITIONS),
            past: Mutex::default(),
        }
    }
}

impl Hub {
    pub fn new() -> Arc<Self> {
        Arc::default()
    }

    /// Makes this the newest. Waits for no one but a reader that is copying the history's pointers.
    pub fn publish(&self, snapshot: Arc<Snapshot>) {
        self.past().keep(&snapshot);
        self.latest.send_replace(Some(snapshot));
    }

    /// Says that an alert began or ended.
    pub fn announce(&self, transition: Arc<Transition>) {
        let mut past = self.past();
        if past.transitions.len() == TRANSITIONS {
            past.transitions.pop_front();
        }
        past.transitions.push_back(Arc::clone(&transition));
        drop(past);
        // No listener is no error.
        let _ = self.transitions.send(transition);
    }

    pub fn latest(&self) -> Option<Arc<Snapshot>> {
        self.latest.borrow().clone()
    }

    /// A receiver that is woken for every new snapshot and sees only the newest: a slow reader misses some and delays nothing.
    /// Its `changed()` fails once the hub is gone.
    pub fn subscribe(&self) -> watch::Receiver<Option<Arc<Snapshot>>> {
        self.latest.subscribe()
    }

    /// A receiver of every transition from now on. One that lags by more than 256 is notified and finds the last ones in [`Hub::history`].
    pub fn subscribe_transitions(&self) -> broadcast::Receiver<Arc<Transition>> {
        self.transitions.subscribe()
    }

    pub fn is_read(&self) -> bool {
        self.latest.receiver_count() > 0
    }

    pub fn history(&self) -> History {
        let past = self.past();
        History {
            coarse: past.coarse.iter().cloned().collect(),
            fine: past.fine.iter().cloned().collect(),
            transitions: past.transitions.iter().cloned().collect(),
        }
    }

    /// A reader that panicked leaves the history as good as it was.
    fn past(&self) -> MutexGuard<'_, Past> {
        self.past.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Past {
    fn keep(&mut self, snapshot: &Arc<Snapshot>) {
        COARSE.keep(&mut self.coarse, snapshot);
        FINE.keep(&mut self.fine, snapshot);
    }
}

/// How densely and how far back.
#[derive(Debug, Clone, Copy)]
struct Thinning {
    step_s: f64,
    span_s: f64,
}

impl Thinning {
    fn keep(self, kept: &mut VecDeque<Arc<Snapshot>>, snapshot: &Arc<Snapshot>) {
        let time_s = snapshot.time_s;
        let Some(last) = kept.back() else {
            if time_s.is_finite() {
                kept.push_back(Arc::clone(snapshot));
            }
            return;
        };
        let step_s = time_s - last.time_s;
        if step_s < 0.0 {
            // The source began again: what was before has no place on its clock.
            kept.clear();
        } else if !(step_s >= self.step_s * (1.0 - 1e-6)) {
            return;
        }
        kept.push_back(Arc::clone(snapshot));
        while kept.front().is_some_and(|oldest| time_s - oldest.time_s > self.span_s) {
            kept.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::snapshot::{Latency, Source, SourceState};

    fn at(seq: u64, time_s: f64) -> Arc<Snapshot> {
        Arc::new(Snapshot {
            seq,
            time_s,
            source: Source {
                name: "can0".to_owned(),
                kind: "socketcan",
                state: SourceState::Live,
                rate_hz: 500.0,
                ..Source::default()
            },
            vehicle: "car".to_owned(),
            speed_m_s: f64::NAN,
            speed_doubt: Some("missing"),
            latency_ms: Latency { p50: 0.1, p99: 0.2, max: 0.3 },
            ..Snapshot::default()
        })
    }

    #[test]
    fn history_is_thinned_and_bounded_whatever_the_length_and_the_rate() {
        let hub = Hub::new();
        for i in 0..40_000u32 {
            hub.publish(at(u64::from(i), f64::from(i) * 0.05));
        }
        let history = hub.history();
        // Both ends of the span are kept.
        assert_eq!((history.coarse.len(), history.fine.len()), (901, 601));
        assert_eq!(history.coarse.last().unwrap().time_s - history.coarse[0].time_s, 900.0);
        assert_eq!(hub.latest().unwrap().seq, 39_999);
        // A source that begins again has a clock of its own.
        hub.publish(at(40_000, 0.0));
        assert_eq!(hub.history().fine.len(), 1);
    }

    #[test]
    fn a_reader_that_never_reads_delays_nobody_and_then_sees_the_newest() {
        let hub = Hub::new();
        let mut reader = hub.subscribe();
        (0..1000).for_each(|i| hub.publish(at(i, i as f64)));
        assert!(reader.has_changed().unwrap());
        assert_eq!(reader.borrow_and_update().as_ref().unwrap().seq, 999);
        assert!(!reader.has_changed().unwrap());
    }

    #[test]
    fn unknown_numbers_are_null_in_json() {
        let json = serde_json::to_value(&*at(1, f64::NAN)).unwrap();
        assert!(json["time_s"].is_null() && json["speed_m_s"].is_null());
        assert_eq!(json["source"]["state"], "live");
    }
}
