//! A drive log, replayed: its rows come when they were recorded, or N times as fast, or as fast as they are estimated.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use itpms_data::LogReader;

use super::pace::{Pace, Speed};
use crate::input::{Input, Note, Say, SourceName};
use crate::queue::Queue;

/// Rows that are handed on at once when nothing has to wait.
const BATCH: usize = 256;

/// How a replay is called.
#[must_use]
pub fn name(path: &Path) -> SourceName {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    SourceName { name, kind: "replay" }
}

/// Starts the replay of a log. Waits for room in the queue: nothing is lost. `stop` ends it early.
#[must_use]
pub fn start(
    mut log: LogReader,
    speed: Speed,
    inputs: Arc<Queue<Input>>,
    stop: Arc<AtomicBool>,
    say: Say,
) -> JoinHandle<()> {
    thread::spawn(move || {
        let opened =
            Input::Opened { sample_rate_hz: log.survey().sample_rate_hz, corners: log.columns().present() };
        let last = match inputs.push(opened).then(|| rows(&mut log, speed, &inputs, &stop)) {
            Some(Err(error)) => Input::Failed(error.to_string()),
            _ => Input::Ended,
        };
        for warning in log.repairs().warnings() {
            say(Note::Warning(format!("{}: {warning}", log.path().display())));
        }
        inputs.push(last);
        inputs.close();
    })
}

fn rows(
    log: &mut LogReader,
    speed: Speed,
    inputs: &Queue<Input>,
    stop: &AtomicBool,
) -> Result<(), itpms_data::DataError> {
    let mut pace = Pace::new(speed);
    let wanted = || !stop.load(Ordering::Relaxed);
    let mut batch = Vec::with_capacity(BATCH);
    while let Some(row) = log.next_row()? {
        if !pace.wait(row.time_s, wanted) {
            break;
        }
        batch.push(Input::Row { row, arrived: Instant::now() });
        if (!pace.is_max() || batch.len() == BATCH) && !inputs.push_all(batch.drain(..)) {
            return Ok(());
        }
    }
    inputs.push_all(batch);
    Ok(())
}
