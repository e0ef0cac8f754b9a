//! The stream of server-sent events behind the page.
//!
//! First `hello` and `history`, then `snapshot` and `transition` as they come and a `beat` every second, so that silence means
//! trouble. A client that was cut off says what it saw last and gets what it missed; one that is slow gets the newest and
//! misses the rest: nothing is queued but transitions, of which the hub keeps a bounded number.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::http::StatusCode;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, RETRY_AFTER};
use axum::response::{IntoResponse, Response};
use futures_util::stream::unfold;
use serde_json::{Value, json};
use tokio::sync::broadcast;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{Interval, MissedTickBehavior, interval_at};

use super::history::columns;
use super::pump::{Newest, json};
use super::shared::{Shared, unix_s};
use crate::snapshot::{Snapshot, Transition};

/// Streams at once. Fewer than connections, so that there is always room for who asks for health.
const STREAMS: usize = 32;
/// Between two signs of life.
const BEAT: Duration = Duration::from_secs(1);

/// An open stream; dropped with its connection.
struct Client {
    shared: Arc<Shared>,
    newest: Newest,
    transitions: broadcast::Receiver<Arc<Transition>>,
    beat: Interval,
    opening: Option<Bytes>,
}

impl Drop for Client {
    fn drop(&mut self) {
        self.shared.streams.fetch_sub(1, Relaxed);
    }
}

/// Answers a request for the stream; `last` is the id of the last event that this client has seen.
pub(super) fn stream(shared: Arc<Shared>, last: Option<&str>) -> Response {
    if shared.streams.fetch_add(1, Relaxed) >= STREAMS {
        shared.streams.fetch_sub(1, Relaxed);
        return (StatusCode::SERVICE_UNAVAILABLE, [(RETRY_AFTER, "5")], "Too many streams are open.\n")
            .into_response();
    }
    let client = Client::new(shared, last);
    let events =
        unfold(client, async |mut client| Some((Ok::<_, std::io::Error>(client.next().await?), client)));
    let kind = [(CONTENT_TYPE, "text/event-stream"), (CACHE_CONTROL, "no-store")];
    // Proxies that collect answers before they pass them on are asked not to.
    (kind, [("x-accel-buffering", "no")], Body::from_stream(events)).into_response()
}

impl Client {
    fn new(shared: Arc<Shared>, last: Option<&str>) -> Self {
        let mut newest = shared.newest.clone();
        newest.mark_changed();
        // Subscribed before the history is copied: rather twice than never; transitions have numbers.
        let transitions = shared.hub.subscribe_transitions();
        let mut beat = interval_at(tokio::time::Instant::now() + BEAT, BEAT);
        beat.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let opening = Some(opening(&shared, last));
        Self { shared, newest, transitions, beat, opening }
    }

    /// The next event; `None` once the monitor is gone.
    async fn next(&mut self) -> Option<Bytes> {
        if let Some(opening) = self.opening.take() {
            return Some(opening);
        }
        tokio::select! {
            // Warnings before numbers.
            biased;
            transition = self.transitions.recv() => match transition {
                Ok(transition) => Some(event("transition", "", &json(&*transition))),
                // Too slow for the warnings themselves: all that are remembered, again.
                Err(RecvError::Lagged(_)) => Some(event("transitions", "", &json(&self.shared.hub.history().transitions))),
                Err(RecvError::Closed) => None,
            },
            changed = self.newest.changed() => {
                changed.ok()?;
                let frame = self.newest.borrow_and_update().clone();
                Some(match frame {
                    Some(frame) => event("snapshot", &id(&self.shared, &frame.snapshot), &frame.json()),
                    None => self.sign_of_life(),
                })
            }
            _ = self.beat.tick() => Some(self.sign_of_life()),
        }
    }

    fn sign_of_life(&self) -> Bytes {
        event("beat", "", &json(&json!({ "unix_s": unix_s(), "health": self.shared.health() })))
    }
}

fn id(shared: &Shared, snapshot: &Snapshot) -> String {
    format!("{}.{}", shared.run, snapshot.seq)
}

/// Who speaks, and what was before: all of it, or what came after `last` if that is of this run.
fn opening(shared: &Shared, last: Option<&str>) -> Bytes {
    let seen = last.and_then(|id| id.strip_prefix(&*shared.run)?.strip_prefix('.')?.parse::<u64>().ok());
    let mut history = shared.hub.history();
    if let Some(seen) = seen {
        history.coarse.retain(|snapshot| snapshot.seq > seen);
        history.fine.retain(|snapshot| snapshot.seq > seen);
    }
    let hello: Value = json!({
        "program": concat!("itpms ", env!("CARGO_PKG_VERSION")),
        "run": shared.run,
        "unix_s": unix_s(),
        "health": shared.health(),
    });
    let past = json!({
        "resumed": seen.is_some(),
        "coarse": columns(&history.coarse),
        "fine": columns(&history.fine),
        "transitions": history.transitions,
    });
    let mut both = b"retry: 1000\n".to_vec();
    both.extend_from_slice(&event("hello", "", &json(&hello)));
    both.extend_from_slice(&event("history", "", &json(&past)));
    both.into()
}

/// An event as it goes over the wire; JSON has no line breaks of its own.
fn event(name: &str, id: &str, data: &Bytes) -> Bytes {
    let mut text = Vec::with_capacity(data.len() + 64);
    if !id.is_empty() {
        text.extend_from_slice(format!("id: {id}\n").as_bytes());
    }
    text.extend_from_slice(format!("event: {name}\ndata: ").as_bytes());
    text.extend_from_slice(data);
    text.extend_from_slice(b"\n\n");
    text.into()
}
