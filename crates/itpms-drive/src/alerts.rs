//! The monitor's alerts: every transition as it happens, and a list for the summary.

use itpms_core::model::{Corner, PressureUnit};
use itpms_core::warning::{Alert, Cause, Change, MonitorReport};
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

/// Callback for a transition, with its time in s.
pub type Note<'a> = &'a mut dyn FnMut(f64, &Change<f64>) -> Result<(), DriveError>;

/// The transitions of a drive.
#[derive(Debug, Default)]
pub struct Events {
    before: Option<MonitorReport<f64>>,
    listed: Vec<Listed>,
    unlisted: usize,
}

impl Events {
    /// Takes what the monitor says after a row; hands over what changed, with its time in s. Errors: those of `note`.
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

    /// The list. Alerts that still stand have their newest numbers.
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

#[derive(Debug, Clone, Default)]
pub struct Alerts {
    listed: Vec<Listed>,
    unlisted: usize,
}

impl Alerts {
    /// A sentence for every alert, with times from `origin_s` on: where a log counts from an epoch, its own mean nothing to a reader.
    pub fn sentences(&self, origin_s: f64, unit: PressureUnit) -> impl Iterator<Item = String> + '_ {
        let sentences = self.listed.iter().map(move |Listed { alert, ended_s }| {
            let [since_s, reported_s] = [alert.since_s, alert.reported_s].map(|at_s| at_s - origin_s);
            let alert = Alert { since_s, reported_s, ..*alert };
            let sentence = alert.shown_in(unit);
            match ended_s {
                Some(ended_s) => format!("{sentence}; over at {:.1} s", ended_s - origin_s),
                None => sentence.to_string(),
            }
        });
        let rest = (self.unlisted > 0).then(|| format!("and {} more", self.unlisted));
        sentences.chain(rest)
    }

    /// The first one that says that a sensor of this corner is broken and that stood at the end.
    pub(crate) fn broken(&self, corner: Corner) -> Option<&Alert<f64>> {
        let stands = |listed: &&Listed| {
            listed.ended_s.is_none()
                && matches!(listed.alert.cause, Cause::Malfunction(_))
                && listed.alert.wheels.contains(corner)
        };
        self.listed.iter().find(stands).map(|listed| &listed.alert)
    }

    /// Those that are listed, in the order in which they were reported.
    pub fn listed(&self) -> &[Listed] {
        &self.listed
    }

    pub fn json(&self) -> Value {
        let one = |listed: &Listed| {
            let mut object = alert_object(&listed.alert);
            object.insert("ended_s".to_owned(), json!(listed.ended_s));
            Value::Object(object)
        };
        self.listed.iter().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use itpms_core::model::Corner;
    use itpms_core::warning::Cause;

    use super::*;

    #[test]
    fn times_count_from_the_origin() {
        let alert = Alert {
            wheels: Corner::FrontLeft.into(),
            since_s: 1_772_359_221.25,
            reported_s: 1_772_359_222.5,
            cause: Cause::NoInformation { driven_s: 600.0 },
        };
        let listed = vec![Listed { alert, ended_s: Some(1_772_359_230.0) }];
        let alerts = Alerts { listed, unlisted: 2 };
        let sentences: Vec<String> = alerts.sentences(1_772_359_200.0, PressureUnit::Kpa).collect();
        assert!(
            sentences[0].ends_with("since 21.2 s, reported at 22.5 s; over at 30.0 s"),
            "{}",
            sentences[0]
        );
        assert_eq!(sentences[1], "and 2 more");
    }
}
