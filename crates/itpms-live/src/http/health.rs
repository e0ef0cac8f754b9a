//! Whether what is shown is now, and if not, why not.
//!
//! Asked by `/healthz`, the metrics and the page. Trusts nobody's word alone: a monitor that has stopped saying anything cannot
//! say that it has stopped.

use serde::Serialize;

use super::pump::Frame;
use crate::snapshot::SourceState;

/// Seconds after which a snapshot is old, whatever it says of itself.
const FRESH_S: f64 = 3.0;

/// Whether what is shown is now.
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
        let (status, reason) = match source.state {
            SourceState::Ended => ("ended", Some(format!("{} is at its end", source.name))),
            SourceState::Stale if source.rows == 0 => {
                ("waiting", Some(format!("no complete row from {} yet", source.name)))
            }
            SourceState::Stale => {
                ("stale", Some(format!("no row from {} for more than a second", source.name)))
            }
            SourceState::Live if age_s > FRESH_S => {
                ("stale", Some(format!("the monitor has said nothing for {age_s:.0} s")))
            }
            SourceState::Live => ("fresh", None),
        };
        Self { status, reason, snapshot_age_s: Some(age_s), source: Some(source.name.clone()) }
    }

    pub(super) fn is_fresh(&self) -> bool {
        self.status == "fresh"
    }
}
