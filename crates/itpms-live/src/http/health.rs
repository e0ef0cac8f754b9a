//! Whether what is shown is now, and if not, why not.
//!
//! Asked by `/healthz`, the metrics and the page. Trusts no one's word alone: a monitor that has stopped saying anything cannot
//! say that it has stopped.

use serde::Serialize;

use super::pump::Frame;
use crate::snapshot::SourceState;

/// Seconds after which a snapshot is old, whatever it says of itself.
const FRESH_S: f64 = 3.0;
/// Where they come more slowly: so many times the time between the last two, and how long that may be.
const OVERDUE: f64 = 2.5;
const SLOWEST_S: f64 = 60.0;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Health {
    /// `fresh`, `waiting` (nothing yet), `stale` or `ended`.
    pub(super) status: &'static str,
    /// For a person; `null` while fresh.
    pub(super) reason: Option<String>,
    /// Seconds since the newest snapshot came; `null` if none has.
    pub(super) snapshot_age_s: Option<f64>,
    /// Name of the source, as far as it is known.
    pub(super) source: Option<String>,
}

impl Health {
    pub(super) fn of(newest: Option<&Frame>) -> Self {
        let Some(frame) = newest else {
            let reason = Some("nothing has come yet".to_owned());
            return Self { status: "waiting", reason, snapshot_age_s: None, source: None };
        };
        let source = &frame.snapshot.source;
        let age_s = frame.came.elapsed().as_secs_f64();
        let patience_s = FRESH_S.max(OVERDUE * frame.pace.as_secs_f64().min(SLOWEST_S));
        let (status, reason) = match source.state {
            SourceState::Ended => ("ended", Some(format!("{} is at its end", source.name))),
            SourceState::Stale if source.rows == 0 => {
                ("waiting", Some(format!("no complete row from {} yet", source.name)))
            }
            SourceState::Stale => {
                ("stale", Some(format!("no row from {} for more than a second", source.name)))
            }
            SourceState::Live if age_s > patience_s => {
                ("stale", Some(format!("the monitor has sent nothing for {age_s:.0} s")))
            }
            SourceState::Live => ("fresh", None),
        };
        Self { status, reason, snapshot_age_s: Some(age_s), source: Some(source.name.clone()) }
    }

    pub(super) fn is_fresh(&self) -> bool {
        self.status == "fresh"
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use tokio::time::Instant;

    use super::*;
    use crate::snapshot::{Snapshot, Source};

    fn status(state: SourceState, age_s: f64, pace_s: f64) -> &'static str {
        let source = Source {
            name: "can0".to_owned(),
            kind: "socketcan",
            state,
            rows: 1,
            frames: 1,
            rate_hz: 200.0,
            ..Source::default()
        };
        let snapshot = Snapshot { source, speed_doubt: Some("missing"), ..Snapshot::default() };
        let [age, pace] = [age_s, pace_s].map(Duration::from_secs_f64);
        Health::of(Some(&Frame::new(Arc::new(snapshot), Instant::now() - age, pace))).status
    }

    #[test]
    fn old_is_what_is_overdue() {
        assert_eq!(status(SourceState::Live, 2.0, 0.1), "fresh");
        assert_eq!(status(SourceState::Live, 4.0, 0.1), "stale");
        // An estimate every ten seconds is asked for: after twelve nothing is wrong yet, after thirty it is.
        assert_eq!(status(SourceState::Live, 12.0, 10.0), "fresh");
        assert_eq!(status(SourceState::Live, 30.0, 10.0), "stale");
        assert_eq!(status(SourceState::Live, 200.0, 4000.0), "stale");
        assert_eq!(status(SourceState::Stale, 0.1, 1.0), "stale");
        assert_eq!(Health::of(None).status, "waiting");
    }
}
