//! A drive log or a CAN log, replayed: its rows or frames come when they were recorded, or N times as fast, or as fast as they are estimated.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use itpms_data::can::FrameReader;
use itpms_data::{DataError, LogReader};

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
        let opened = Input::Opened {
            sample_rate_hz: log.survey().sample_rate_hz,
            corners: log.columns().present(),
            wheel_speeds: log.columns().motion.wheel_speeds(),
        };
        let next = || {
            let row = log.next_row()?;
            Ok(row.map(|row| (row.time_s, Input::Row { row: Box::new(row), arrived: Instant::now() })))
        };
        let result = if inputs.push(opened) { replay(next, speed, &inputs, &stop) } else { Ok(()) };
        end(result, log.path(), &log.repairs().warnings(), &inputs, &say);
    })
}

/// Starts the replay of a CAN log, the same way.
#[must_use]
pub fn start_frames(
    mut log: FrameReader,
    speed: Speed,
    inputs: Arc<Queue<Input>>,
    stop: Arc<AtomicBool>,
    say: Say,
) -> JoinHandle<()> {
    thread::spawn(move || {
        let next = || {
            let frame = log.next_frame()?;
            Ok(frame.map(|frame| (frame.time_s, Input::Frame { frame, arrived: Instant::now() })))
        };
        let result = replay(next, speed, &inputs, &stop);
        end(result, log.path(), &log.repairs().warnings(), &inputs, &say);
    })
}

/// What there is to say of a log that has been replayed, or could not be to its end.
fn end(result: Result<(), DataError>, path: &Path, warnings: &[String], inputs: &Queue<Input>, say: &Say) {
    for warning in warnings {
        say(Note::Warning(format!("{}: {warning}", path.display())));
    }
    inputs.push(result.map_or_else(|error| Input::Failed(error.to_string()), |()| Input::Ended));
    inputs.close();
}

fn replay(
    mut next: impl FnMut() -> Result<Option<(f64, Input)>, DataError>,
    speed: Speed,
    inputs: &Queue<Input>,
    stop: &AtomicBool,
) -> Result<(), DataError> {
    let mut pace = Pace::new(speed);
    let wanted = || !stop.load(Ordering::Relaxed);
    let mut batch = Vec::with_capacity(BATCH);
    while let Some((time_s, mut input)) = next()? {
        if !pace.wait(time_s, wanted) {
            break;
        }
        if let Input::Row { arrived, .. } | Input::Frame { arrived, .. } = &mut input {
            *arrived = Instant::now();
        }
        batch.push(input);
        if (!pace.is_max() || batch.len() == BATCH) && !inputs.push_all(batch.drain(..)) {
            return Ok(());
        }
    }
    inputs.push_all(batch);
    Ok(())
}
