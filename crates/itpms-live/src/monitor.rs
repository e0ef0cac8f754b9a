//! The estimating thread: takes what sources tell, keeps the clock of staleness, hands out what there is to tell.
//!
//! Called by `itpms monitor`. Waits for its source alone: every output has a queue of its own, and the state is written by another thread.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use itpms_data::LogRow;

use crate::engine::{Engine, Published};
use crate::error::LiveError;
use crate::feed::Feed;
use crate::hub::Hub;
use crate::input::{Input, Note, NoteSink};
use crate::output::Output;
use crate::queue::{Queue, Taken};
use crate::snapshot::SourceState;
use crate::state;

/// Without a row for so long what is known is old.
pub const STALE_AFTER: Duration = Duration::from_secs(1);
/// How often an old state is published again.
const STALE_EVERY: Duration = Duration::from_secs(1);
const SAVE_EVERY: Duration = Duration::from_secs(60);
/// How long the thread sleeps at most without looking at the clock.
const LOOK_EVERY: Duration = Duration::from_millis(50);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    SourceEnded,
    Stopped,
}

/// The estimating thread and everything it hands to.
pub struct Monitor {
    engine: Engine,
    /// The decoder from frames to rows, where frames come.
    feed: Option<Feed>,
    hub: Arc<Hub>,
    outputs: Vec<Output>,
    state: Option<StateFile>,
    notes: NoteSink,
    last_row: Instant,
    /// When a frame with a signal that is wanted came last.
    last_frame: Instant,
    last_published: Instant,
    /// Losses that the queue between source and estimate has had.
    queue_dropped: u64,
    lost: u64,
    failures_reported: usize,
    /// Whether it was reported that no frame is of use.
    useless_reported: bool,
}

impl Monitor {
    pub fn new(
        engine: Engine,
        hub: Arc<Hub>,
        outputs: Vec<Output>,
        state: Option<PathBuf>,
        notes: NoteSink,
    ) -> Self {
        let state = state.map(|path| StateFile::new(path, Arc::clone(&notes)));
        let now = Instant::now();
        Self {
            engine,
            feed: None,
            hub,
            outputs,
            state,
            notes,
            last_row: now,
            last_frame: now,
            last_published: now,
            queue_dropped: 0,
            lost: 0,
            failures_reported: 0,
            useless_reported: false,
        }
    }

    /// The same for a source of frames.
    pub fn with_feed(self, feed: Feed) -> Self {
        Self { feed: Some(feed), ..self }
    }

    /// Estimates until the source ends or `stop` says so. Outputs get everything that was published before this returns, and the state is
    /// saved. Errors: the vehicle does not fit the source, the source broke in the middle, or an output or the state cannot be written.
    pub fn run(mut self, inputs: &Queue<Input>, stop: impl Fn() -> bool) -> Result<End, LiveError> {
        let end = self.estimate(inputs, stop);
        inputs.close();
        let last = self.last_message(&end);
        let saved = self.save_last();
        let outputs: Vec<Result<(), LiveError>> = self.outputs.into_iter().map(Output::finish).collect();
        let end = end?;
        last?;
        saved?;
        outputs
            .into_iter()
            .filter(|ended| !matches!(ended, Err(LiveError::ReaderGone)))
            .collect::<Result<(), _>>()?;
        Ok(end)
    }

    fn estimate(&mut self, inputs: &Queue<Input>, stop: impl Fn() -> bool) -> Result<End, LiveError> {
        // Time spent on loading and starting before this is no silence of the source.
        self.last_row = Instant::now();
        let mut taken = VecDeque::new();
        loop {
            if stop() {
                return Ok(End::Stopped);
            }
            let closed = inputs.take(&mut taken, LOOK_EVERY) == Taken::Closed;
            self.queue_dropped = inputs.dropped();
            self.engine.source_mut().dropped = self.queue_dropped + self.lost;
            while let Some(input) = taken.pop_front() {
                if let Some(end) = self.take(input)? {
                    return Ok(end);
                }
            }
            if closed {
                return Ok(End::SourceEnded);
            }
            self.look_at_the_clock();
            self.release_what_waits()?;
            if self.nobody_listens() {
                return Ok(End::Stopped);
            }
        }
    }

    fn take(&mut self, input: Input) -> Result<Option<End>, LiveError> {
        match input {
            Input::Opened { sample_rate_hz, corners, wheel_speeds } => {
                self.engine.open(sample_rate_hz, &corners, wheel_speeds)?;
            }
            Input::Row { row, arrived } => {
                self.engine.source_mut().frames += 1;
                self.row(&row, Some(arrived))?;
            }
            Input::Frame { frame, arrived } => {
                self.engine.source_mut().frames += 1;
                if let Some(feed) = &mut self.feed {
                    let used = feed.used();
                    feed.push(&frame, arrived);
                    if feed.used() > used {
                        self.last_frame = Instant::now();
                    }
                    self.engine.source_mut().unknown_ids = feed.unknown_ids();
                }
                self.fed_rows()?;
            }
            Input::Pulse(pulse) => self.engine.pulse(pulse),
            Input::Malformed(count) => self.engine.source_mut().malformed += count,
            Input::Lost(count) => self.lost += count,
            Input::Disconnected(why) => {
                let name = &self.engine.source_mut().name;
                let text = format!("{name}: {why}; trying again");
                (self.notes)(Note::Warning(text));
            }
            Input::Reconnected => {
                self.engine.source_mut().reconnects += 1;
                let name = &self.engine.source_mut().name;
                let text = format!("{name}: is there again");
                (self.notes)(Note::Remark(text));
            }
            Input::Ended => return Ok(Some(End::SourceEnded)),
            Input::Failed(why) => return Err(LiveError::Refused(why)),
        }
        Ok(None)
    }

    fn fed_rows(&mut self) -> Result<(), LiveError> {
        while let Some((row, arrived)) = self.feed.as_mut().and_then(Feed::pop) {
            self.row(&row, arrived)?;
        }
        Ok(())
    }

    fn row(&mut self, row: &LogRow, arrived: Option<Instant>) -> Result<(), LiveError> {
        self.last_row = Instant::now();
        let Self { engine, hub, outputs, last_published, .. } = self;
        engine.take(row, arrived, &mut |published| {
            *last_published = Instant::now();
            publish(hub, outputs, published);
        })
    }

    /// In a silence rows do not wait for more of their frames. How long they waited is no latency.
    fn release_what_waits(&mut self) -> Result<(), LiveError> {
        let Some(feed) = self.feed.as_mut().filter(|_| self.last_frame.elapsed() > STALE_AFTER) else {
            return Ok(());
        };
        feed.flush();
        let last_row = self.last_row;
        while let Some((row, _)) = self.feed.as_mut().and_then(Feed::pop) {
            self.row(&row, None)?;
        }
        // Nothing new has come.
        self.last_row = last_row;
        Ok(())
    }

    /// Says once that frames come and none is of use: another bus, or another bus's description.
    fn report_useless_frames(&mut self) {
        let Some(feed) = self.feed.as_ref().filter(|feed| feed.used() == 0 && !self.useless_reported) else {
            return;
        };
        let unknown = feed.unknown_ids();
        let source = self.engine.source_mut();
        if source.frames > 0 {
            self.useless_reported = true;
            let (name, frames) = (&source.name, source.frames);
            (self.notes)(Note::Warning(format!(
                "{name}: {frames} frames have come and none with a signal that is wanted; {unknown} have identifiers that the DBC file does not have"
            )));
        }
    }

    /// Says that nothing comes, and saves the state, when it is time.
    fn look_at_the_clock(&mut self) {
        if self.last_row.elapsed() > STALE_AFTER {
            let source = self.engine.source_mut();
            let news = source.state == SourceState::Live;
            source.state = SourceState::Stale;
            if news || self.last_published.elapsed() > STALE_EVERY {
                self.publish_now();
                self.report_useless_frames();
            }
        }
        if let Some(state) = &mut self.state
            && state.is_due()
            && let Some(bytes) = self.engine.saved()
        {
            state.write_later(bytes);
        }
    }

    /// Whether all outputs have given up, and no page is served. One that has, while others go on, is reported.
    fn nobody_listens(&mut self) -> bool {
        let failures: Vec<&str> = self.outputs.iter().filter_map(Output::failure).collect();
        let over = !failures.is_empty() && failures.len() == self.outputs.len() && !self.hub.is_read();
        if failures.len() > self.failures_reported && !over {
            self.failures_reported = failures.len();
            (self.notes)(Note::Warning(format!("an output has ended: {}", failures.join("; "))));
        }
        over
    }

    fn publish_now(&mut self) {
        self.last_published = Instant::now();
        let snapshot = self.engine.snapshot();
        publish(&self.hub, &self.outputs, Published::Estimate(snapshot));
    }

    /// At the end of the source what waits is estimated; that there will be nothing more is published in any case.
    fn last_message(&mut self, end: &Result<End, LiveError>) -> Result<(), LiveError> {
        let waiting = match end {
            Ok(End::SourceEnded) => self.estimate_waiting(),
            _ => Ok(()),
        };
        self.engine.source_mut().state = SourceState::Ended;
        self.publish_now();
        self.report_useless_frames();
        let backwards = self.engine.out_of_order();
        if backwards > 0 {
            let text = format!("{backwards} rows were not later than the ones before them and were left out");
            (self.notes)(Note::Warning(text));
        }
        waiting
    }

    fn estimate_waiting(&mut self) -> Result<(), LiveError> {
        if let Some(feed) = &mut self.feed {
            feed.finish();
            self.fed_rows()?;
        }
        let Self { engine, hub, outputs, .. } = self;
        engine.finish(&mut |published| publish(hub, outputs, published))
    }

    fn save_last(&mut self) -> Result<(), LiveError> {
        let Some(state) = self.state.take() else { return Ok(()) };
        let path = state.path.clone();
        state.finish();
        self.engine.saved().map_or(Ok(()), |bytes| state::write(&path, &bytes))
    }
}

fn publish(hub: &Hub, outputs: &[Output], published: Published) {
    outputs.iter().for_each(|output| output.publish(&published));
    match published {
        Published::Estimate(snapshot) => hub.publish(snapshot),
        Published::Warning(transition) => hub.announce(transition),
    }
}

/// A thread that writes the newest state.
struct StateFile {
    path: PathBuf,
    queue: Arc<Queue<Vec<u8>>>,
    writer: JoinHandle<()>,
    saved: Instant,
}

impl StateFile {
    fn new(path: PathBuf, notes: NoteSink) -> Self {
        let queue = Arc::new(Queue::<Vec<u8>>::new(1));
        let writer = thread::spawn({
            let (queue, path) = (Arc::clone(&queue), path.clone());
            move || {
                let mut taken = VecDeque::new();
                while queue.take(&mut taken, SAVE_EVERY) != Taken::Closed {
                    if let Some(bytes) = taken.pop_back()
                        && let Err(error) = state::write(&path, &bytes)
                    {
                        notes(Note::Warning(format!("the state was not saved: {error}")));
                    }
                    taken.clear();
                }
            }
        });
        Self { path, queue, writer, saved: Instant::now() }
    }

    fn is_due(&self) -> bool {
        self.saved.elapsed() > SAVE_EVERY
    }

    fn write_later(&mut self, bytes: Vec<u8>) {
        self.saved = Instant::now();
        self.queue.push_now(bytes, |_| true);
    }

    /// Waits until what is being written is written.
    fn finish(self) {
        self.queue.close();
        let _ = self.writer.join();
    }
}
