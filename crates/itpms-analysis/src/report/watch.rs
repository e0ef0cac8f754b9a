//! The monitor's reports of a drive: each wheel's state over time, and every alert with its end. Bounded memory.
//!
//! Called by the report's collector. Knows nothing of how a state came about.

use itpms_core::model::Corner;
use itpms_core::warning::{Alert, Change, Doubt, MonitorReport, WheelState};

use super::track::Track;

/// Buckets of the states over time, and the finest of them in s.
const BUCKETS: usize = 2000;
const FINEST_S: f64 = 0.05;
/// Alerts that are kept with their words; more are counted.
const LISTED: usize = 100;

/// An alert, and when it was taken back, if it was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlertSpan {
    /// The alert with the numbers that decided; its times count like the report's.
    pub alert: Alert<f64>,
    /// When it was taken back, in s; `None`: it stood at the end.
    pub ended_s: Option<f64>,
}

#[derive(Debug, Clone, Default)]
pub struct WatchReport {
    /// Each wheel's stretches `(from s, to s, code)`, in the order of [`Corner::ALL`]: 0 fine, 1 unknown, 2 uncertain,
    /// 3 over, 4 malfunction, 5 low.
    pub states: [Vec<(f64, f64, f64)>; 4],
    pub last: [Option<WheelState>; 4],
    /// The alerts in the order in which they were reported.
    pub alerts: Vec<AlertSpan>,
    /// Alerts that are not among them, for want of room.
    pub unlisted: usize,
}

#[derive(Debug)]
pub(super) struct WatchCollector {
    track: Track,
    before: Option<MonitorReport<f64>>,
    report: WatchReport,
}

impl WatchCollector {
    pub(super) fn new() -> Self {
        let track = Track::new(Corner::ALL.len(), FINEST_S, BUCKETS);
        Self { track, before: None, report: WatchReport::default() }
    }

    /// The monitor's report after a sample; a repeated one adds nothing.
    pub(super) fn push(&mut self, now: &MonitorReport<f64>) {
        if self.before.as_ref().is_some_and(|before| before.time_s == now.time_s) {
            return;
        }
        let states = now.wheels.map(|wheel| wheel.map(|wheel| wheel.state));
        self.track.push(now.time_s, &states.map(|state| state.map_or(f64::NAN, code)));
        for (last, state) in self.report.last.iter_mut().zip(states) {
            *last = state.or(*last);
        }
        match self.before.replace(*now) {
            None => now.alerts().for_each(|alert| self.begin(*alert)),
            Some(before) => now.changes_since(&before).for_each(|change| match change {
                Change::Begun(alert) => self.begin(alert),
                Change::Ended(alert) => self.end(&alert, now.time_s),
            }),
        }
    }

    fn begin(&mut self, alert: Alert<f64>) {
        if self.report.alerts.len() < LISTED {
            self.report.alerts.push(AlertSpan { alert, ended_s: None });
        } else {
            self.report.unlisted += 1;
        }
    }

    fn end(&mut self, ended: &Alert<f64>, time_s: f64) {
        let same = |span: &&mut AlertSpan| {
            let alert = &span.alert;
            let alike = alert.wheels == ended.wheels && alert.cause.label() == ended.cause.label();
            span.ended_s.is_none() && alike && alert.reported_s == ended.reported_s
        };
        if let Some(span) = self.report.alerts.iter_mut().rev().find(same) {
            span.ended_s = Some(time_s);
        }
    }

    /// The record, its times from `origin_s` on; `None` if no monitor spoke.
    pub(super) fn finish(mut self, origin_s: f64) -> Option<WatchReport> {
        self.before?;
        for corner in Corner::ALL {
            let runs = self.track.runs(corner.index());
            let shifted = runs.into_iter().map(|(from, to, code)| (from - origin_s, to - origin_s, code));
            self.report.states[corner.index()] = shifted.collect();
        }
        for span in &mut self.report.alerts {
            span.alert.since_s -= origin_s;
            span.alert.reported_s -= origin_s;
            span.ended_s = span.ended_s.map(|ended_s| ended_s - origin_s);
        }
        Some(self.report)
    }
}

/// The most urgent has the largest code: it stands for its bucket.
fn code(state: WheelState) -> f64 {
    match state {
        WheelState::Fine => 0.0,
        WheelState::Unknown(Doubt::Uncertain) => 2.0,
        WheelState::Unknown(_) => 1.0,
        WheelState::Over => 3.0,
        WheelState::Malfunction => 4.0,
        WheelState::Low => 5.0,
    }
}
