//! What the monitor said and took back: a line of JSON for every transition, and a list for the summary.

use std::path::Path;

use itpms_core::warning::{Alert, Change, MonitorReport};
use itpms_data::out::{AtomicFile, alert_object, transition_object};
use serde_json::{Value, json};

use crate::exit::Failure;

/// Alerts that the summary lists; more are counted.
const LISTED: usize = 50;

/// An alert and when it was taken back, if it was.
#[derive(Debug, Clone, Copy)]
pub(super) struct Listed {
    pub(super) alert: Alert<f64>,
    pub(super) ended_s: Option<f64>,
}

/// The transitions of a drive.
pub(super) struct Events {
    file: Option<AtomicFile>,
    before: Option<MonitorReport<f64>>,
    listed: Vec<Listed>,
    unlisted: usize,
}

impl Events {
    /// Starts the file, if it is wanted.
    pub(super) fn create(path: Option<&Path>) -> Result<Self, Failure> {
        let file = path.map(AtomicFile::create).transpose()?;
        Ok(Self { file, before: None, listed: Vec::new(), unlisted: 0 })
    }

    /// Takes what the monitor says after a row.
    pub(super) fn take(&mut self, report: &MonitorReport<f64>) -> Result<(), Failure> {
        let unchanged = self.before.as_ref().is_some_and(|before| before.time_s == report.time_s);
        if unchanged {
            return Ok(());
        }
        let Some(before) = self.before.replace(*report) else {
            return report.alerts().try_for_each(|alert| self.note(report.time_s, Change::Begun(*alert)));
        };
        report.changes_since(&before).try_for_each(|change| self.note(report.time_s, change))
    }

    fn note(&mut self, time_s: f64, change: Change<f64>) -> Result<(), Failure> {
        if let Some(file) = &mut self.file {
            file.append(format!("{}\n", Value::Object(transition_object(time_s, &change))).as_bytes())?;
        }
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

    /// The complete file, to be given its name together with the others; and what there is to list. Alerts that still
    /// stand have their newest numbers.
    pub(super) fn complete(mut self) -> Result<(Option<AtomicFile>, Alerts), Failure> {
        if let Some(file) = &mut self.file {
            file.settle()?;
        }
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
        Ok((self.file, Alerts { listed: self.listed, unlisted: self.unlisted }))
    }
}

/// What was said during a drive.
#[derive(Debug, Clone, Default)]
pub(crate) struct Alerts {
    listed: Vec<Listed>,
    unlisted: usize,
}

impl Alerts {
    /// A sentence for every alert.
    pub(super) fn sentences(&self) -> impl Iterator<Item = String> + '_ {
        let sentences = self.listed.iter().map(|Listed { alert, ended_s }| match ended_s {
            Some(ended_s) => format!("{alert}; over at {ended_s:.1} s"),
            None => alert.to_string(),
        });
        let rest = (self.unlisted > 0).then(|| format!("and {} more", self.unlisted));
        sentences.chain(rest)
    }

    /// The same as JSON.
    pub(super) fn json(&self) -> Value {
        let one = |listed: &Listed| {
            let mut object = alert_object(&listed.alert);
            object.insert("ended_s".to_owned(), json!(listed.ended_s));
            Value::Object(object)
        };
        self.listed.iter().map(one).collect()
    }
}
