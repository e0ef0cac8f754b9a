//! One file per study: it reads its inputs, writes its outputs and says in a few lines what it found.

use itpms_console::{Failure, Interrupt, Screen};
use itpms_lab::runner::{Progress, StudyError};
use serde::Serialize;

pub(crate) mod certify;
pub(crate) mod faults;
pub(crate) mod malfunctions;
pub(crate) mod observability;
pub(crate) mod reproduce;
pub(crate) mod score;
pub(crate) mod soak;

/// A study's result, with its progress shown.
fn driven<T>(
    screen: &Screen,
    interrupt: &Interrupt,
    study: impl FnOnce(Progress<'_>) -> Result<T, StudyError>,
) -> Result<T, Failure> {
    let progress = screen.progress("driving");
    study(&|done, total| {
        progress.set(done as f64 / total as f64);
        interrupt.flow()
    })
    .map_err(|error| failure(error, Failure::Interrupted))
}

fn failure(error: StudyError, stopped: Failure) -> Failure {
    match error {
        StudyError::Stopped => stopped,
        StudyError::Refused(why) => Failure::Usage(why),
    }
}

fn json(result: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(result)
        .map_err(|error| Failure::Usage(format!("the result is no JSON: {error}")))
}
