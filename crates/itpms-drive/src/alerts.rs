//! What the monitor said and took back: every transition as it happens, and a list for the summary.

use itpms_core::warning::{Alert, Change, MonitorReport};
use itpms_data::out::alert_object;
use serde_json::{Value, json};

use crate::error::DriveError;

/// Alerts that the summary lists; more are counted.
const LISTED: usize = 50;

/// An alert and when it was taken back, if it was.
#[derive(Debug, Clone, Copy)]
pub struct Listed {
    /// The alert with its newest numbers.
    pub alert: Alert<f64>,
    /// When it was taken back, in s; `None`: it stood at the end.
    pub ended_s: Option<f64>,
}

/// Who is told of a transition, with its time in s.
pub type Note<'a> = &'a mut dyn FnMut(f64, &Change<f64>) -> Result<(), DriveError>;

/// The transitions of a drive.
#[derive(Debug, Default)]
pub struct Events {
    before: Option<MonitorReport<f64>>,
    listed: Vec<Listed>,
    unlisted: usize,
}

impl Events {
    /// Takes what the monitor says after a row; hands over what changed, with its time in s.
    ///
    /// # Errors
    /// Those of `note`.
    pub fn take(&mut self, report: &MonitorReport<f64>, note: Note<'_>) -> Result<(), DriveError> {
        let unchanged = self.before.as_ref().is_some_and(|before| before.time_s == report.time_s);
        if unchanged {
            return Ok(());
        }
        let Some(before) = self.before.replace(*report) else {
            return report
                .alerts()
                .try_for_each(|alert| self.note(report.time_s, Change::Begun(*alert), note));
        };
        report.changes_since(&before).try_for_each(|change| self.note(report.time_s, change, note))
    }

    fn note(&mut self, time_s: f64, change: Change<f64>, note: Note<'_>) -> Result<(), DriveError> {
        note(time_s, &change)?;
        match change {
            Change::Begun(_) if self.listed.len() >= LISTED => self.unlisted += 1,
            Change::Begun(alert) => self.listed.push(Listed { alert, ended_s: None }),
            Change::Ended(alert) => {
                let same = |listed: &&mut Listed| {
                    listed.ended_s.is_none()
                        && listed.alert.wheels == alert.wheels
                        && listed.alert.reported_s == alert.reported_s
                        && listed.alert.cause.label() == alert.cause.label()
                };
                if let Some(listed) = self.listed.iter_mut().rev().find(same) {
                    *listed = Listed { alert, ended_s: Some(time_s) };
                }
            }
        }
        Ok(())
    }

    /// What there is to list. Alerts that still stand have their newest numbers.
    #[must_use]
    pub fn complete(mut self) -> Alerts {
        for now in self.before.iter().flat_map(MonitorReport::alerts) {
            let standing = self.listed.iter_mut().rev().find(|listed| {
                listed.ended_s.is_none()
                    && listed.alert.reported_s == now.reported_s
                    && listed.alert.wheels == now.wheels
            });
            if let Some(listed) = standing.filter(|listed| listed.alert.cause.label() == now.cause.label()) {
                listed.alert = *now;
            }
        }
        Alerts { listed: self.listed, unlisted: self.unlisted }
    }
}

/// What was said during a drive.
#[derive(Debug, Clone, Default)]
pub struct Alerts {
    listed: Vec<Listed>,
    unlisted: usize,
}

impl Alerts {
    /// A sentence for every alert.
    pub fn sentences(&self) -> impl Iterator<Item = String> + '_ {
        let sentences = self.listed.iter().map(|Listed { alert, ended_s }| match ended_s {
            Some(ended_s) => format!("{alert}; over at {ended_s:.1} s"),
            None => alert.to_string(),
        });
        let rest = (self.unlisted > 0).then(|| format!("and {} more", self.unlisted));
        sentences.chain(rest)
    }

    /// Those that are listed, in the order in which they were said.
    #[must_use]
    pub fn listed(&self) -> &[Listed] {
        &self.listed
    }

    /// The same as JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        let one = |listed: &Listed| {
            let mut object = alert_object(&listed.alert);
            object.insert("ended_s".to_owned(), json!(listed.ended_s));
            Value::Object(object)
        };
        self.listed.iter().map(one).collect()
    }
}
