//! A drive log or a CAN log, replayed: its rows or frames come when they were recorded, or N times as fast, or as fast as they are estimated.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use itpms_data::can::FrameReader;
use itpms_data::pulses::PulseReader;
use itpms_data::{DataError, LogReader};

use super::pace::{Pace, Speed};
use crate::input::{Input, Note, NoteSink, SourceName};
use crate::queue::Queue;

/// Rows that are handed on at once when nothing has to wait.
const BATCH: usize = 256;

pub fn name(path: &Path) -> SourceName {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    SourceName { name, kind: "replay" }
}

/// A table of tooth pulses that is replayed with a log: each before the first row or frame that is not earlier.
#[derive(Debug)]
pub struct Pulses {
    reader: PulseReader,
    /// Times of the first and of the last row or frame; pulses between.
    span_s: Option<[f64; 2]>,
    within: u64,
}

impl Pulses {
    pub fn open(path: &Path) -> Result<Self, DataError> {
        Ok(Self { reader: PulseReader::open(path)?, span_s: None, within: 0 })
    }

    /// The next one that is not later than what the log has next.
    fn until(&mut self, time_s: f64) -> Result<Option<Input>, DataError> {
        let [first_s, last_s] = self.span_s.get_or_insert([time_s; 2]);
        *last_s = time_s;
        let pulse = self.reader.next_until(time_s)?;
        self.within += u64::from(pulse.is_some_and(|pulse| pulse.time_s >= *first_s));
        Ok(pulse.map(Input::Pulse))
    }

    /// Reported at the end.
    fn warnings(&self) -> Vec<String> {
        let none = self.span_s.filter(|_| self.within == 0).map(|[first_s, last_s]| {
            format!("no pulse lies between {first_s} and {last_s} s, the times of the log; expected both by one clock")
        });
        self.reader.repairs().into_iter().chain(none).collect()
    }
}

struct Merged<'a, F> {
    log: F,
    pulses: Option<&'a mut Pulses>,
    next: Option<(f64, Input)>,
}

impl<F: FnMut() -> Result<Option<(f64, Input)>, DataError>> Merged<'_, F> {
    /// The next one, with the time at which it is due.
    fn next(&mut self) -> Result<Option<(f64, Input)>, DataError> {
        if self.next.is_none() {
            self.next = (self.log)()?;
        }
        if let (Some((time_s, _)), Some(pulses)) = (&self.next, &mut self.pulses)
            && let Some(pulse) = pulses.until(*time_s)?
        {
            return Ok(Some((*time_s, pulse)));
        }
        Ok(self.next.take())
    }
}

/// Starts the replay of a log. Waits for room in the queue: nothing is lost. `stop` ends it early.
pub fn start(
    mut log: LogReader,
    mut pulses: Option<Pulses>,
    speed: Speed,
    inputs: Arc<Queue<Input>>,
    stop: Arc<AtomicBool>,
    notes: NoteSink,
) -> JoinHandle<()> {
    thread::spawn(move || {
        let opened = Input::Opened {
            sample_rate_hz: log.survey().estimator_rate_hz(),
            corners: log.columns().present(),
            wheel_speeds: log.columns().motion.wheel_speeds(),
        };
        let next = || {
            let row = log.next_row()?;
            Ok(row.map(|row| (row.time_s, Input::Row { row: Box::new(row), arrived: Instant::now() })))
        };
        let all = Merged { log: next, pulses: pulses.as_mut(), next: None };
        let result = if inputs.push(opened) { replay(all, speed, &inputs, &stop) } else { Ok(()) };
        end(result, (log.path(), &log.repairs().warnings()), pulses.as_ref(), &inputs, &notes);
    })
}

/// Starts the replay of a CAN log, the same way.
pub fn start_frames(
    mut log: FrameReader,
    mut pulses: Option<Pulses>,
    speed: Speed,
    inputs: Arc<Queue<Input>>,
    stop: Arc<AtomicBool>,
    notes: NoteSink,
) -> JoinHandle<()> {
    thread::spawn(move || {
        let next = || {
            let frame = log.next_frame()?;
            Ok(frame.map(|frame| (frame.time_s, Input::Frame { frame, arrived: Instant::now() })))
        };
        let all = Merged { log: next, pulses: pulses.as_mut(), next: None };
        let result = replay(all, speed, &inputs, &stop);
        end(result, (log.path(), &log.repairs().warnings()), pulses.as_ref(), &inputs, &notes);
    })
}

/// The remark on a log that has been replayed, or could not be to its end.
fn end(
    result: Result<(), DataError>,
    (path, warnings): (&Path, &[String]),
    pulses: Option<&Pulses>,
    inputs: &Queue<Input>,
    notes: &NoteSink,
) {
    let warn = |path: &Path, warning: &str| notes(Note::Warning(format!("{}: {warning}", path.display())));
    warnings.iter().for_each(|warning| warn(path, warning));
    if let Some(pulses) = pulses {
        pulses.warnings().iter().for_each(|warning| warn(pulses.reader.path(), warning));
    }
    inputs.push(result.map_or_else(|error| Input::Failed(error.to_string()), |()| Input::Ended));
    inputs.close();
}

fn replay(
    mut all: Merged<'_, impl FnMut() -> Result<Option<(f64, Input)>, DataError>>,
    speed: Speed,
    inputs: &Queue<Input>,
    stop: &AtomicBool,
) -> Result<(), DataError> {
    let mut pace = Pace::new(speed);
    let wanted = || !stop.load(Ordering::Relaxed);
    let mut batch = Vec::with_capacity(BATCH);
    while let Some((time_s, mut input)) = all.next()? {
        if !pace.wait(time_s, wanted) {
            break;
        }
        if let Input::Row { arrived, .. } | Input::Frame { arrived, .. } = &mut input {
            *arrived = Instant::now();
        }
        batch.push(input);
        if (pace.speed != Speed::Max || batch.len() == BATCH) && !inputs.push_all(batch.drain(..)) {
            return Ok(());
        }
    }
    inputs.push_all(batch);
    Ok(())
}
