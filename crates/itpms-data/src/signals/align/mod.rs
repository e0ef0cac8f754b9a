//! From readings with clocks of their own to rows: what a bus or a measurement file tells signal by signal becomes what an estimator takes.
//!
//! Called by the log reader and by whoever listens to a bus. Nothing is invented on the way:
//!
//! | signal | how it comes into a row |
//! |---|---|
//! | accelerations of about the slowest one's rate | as they are, each once. Messages of one cycle that come one after the other are one row; its time is the clock's, the first such acceleration's |
//! | faster accelerations | through a low-pass of linear phase, flat to a quarter of the rows' rate (`kernel`) |
//! | sensors in tires, and of the air | each reading once, in the row after it |
//! | speed, true pressure and road | as they are where the times agree, else on the straight line between two readings no further apart than three of their periods |
//!
//! Rates and offsets are measured in the first two seconds, in which no row comes out. Later a row waits for its last
//! reading: until two later rows have begun for accelerations of its rate, 8 for faster ones, at most 2.5 periods of its
//! own (and half a second) for the speed. What is still not there then is missing. An offset is followed slowly, so clocks may drift; when one
//! has drifted past three quarters of a period, one of its readings is missing or left over.

mod ahead;
mod kernel;
mod report;
mod series;
mod survey;
#[cfg(test)]
mod tests;
mod timeline;

use crate::log::{LogColumns, LogRow, SLOTS, Slot};
use crate::signals::Reading;
use ahead::Ahead;
pub use report::{AlignmentReport, SlotAlignment, SlotMethod};
pub(crate) use survey::mean_period;
use survey::{Clock, Survey};
use timeline::Timeline;

/// Makes rows of readings. See the [module](self).
#[derive(Debug)]
pub struct Aligner {
    columns: LogColumns,
    wanted: [bool; SLOTS],
    ahead: Ahead,
    stage: Stage,
    without_time: u64,
}

#[derive(Debug)]
enum Stage {
    /// The first readings wait until rates and offsets are known.
    Surveying(Survey),
    Running(Box<Timeline>),
}

impl Aligner {
    /// Rows of these columns; readings of others are passed over.
    pub fn new(slots: &[Slot]) -> Self {
        let mut wanted = [false; SLOTS];
        for slot in slots {
            wanted[slot.index()] = *slot != Slot::Time;
        }
        Self {
            columns: LogColumns::of(slots),
            wanted,
            ahead: Ahead::new(),
            stage: Stage::Surveying(Survey::default()),
            without_time: 0,
        }
    }

    /// The columns of the rows: corners without one of their accelerations are left out.
    pub fn columns(&self) -> &LogColumns {
        &self.columns
    }

    /// Takes a reading. Those of one signal come in the order of their times; signals may lag each other by some periods.
    pub fn push(&mut self, reading: Reading) {
        if !self.wanted[reading.slot.index()] {
            return;
        }
        if !reading.time_s.is_finite() {
            self.without_time += 1;
            return;
        }
        let Self { ahead, stage, columns, wanted, .. } = self;
        ahead.take(reading, |reading| stage.push(reading, columns, wanted));
    }

    /// There is nothing more: what waits comes out.
    pub fn finish(&mut self) {
        self.ahead.drop_waiting();
        self.stage.begin(&self.columns, &self.wanted);
        if let Stage::Running(timeline) = &mut self.stage {
            timeline.finish();
        }
    }

    /// Nothing comes for now: what waits comes out, and what comes later begins new rows. Not before the rates are known.
    pub fn flush(&mut self) {
        if let Stage::Running(timeline) = &mut self.stage {
            timeline.flush();
        }
    }

    /// The next row that waits for nothing.
    pub fn pop(&mut self) -> Option<LogRow> {
        self.pop_values().map(|values| LogRow::from_values(&values, &self.columns))
    }

    /// The same as bare values by [`Slot::index`], NaN where missing.
    pub(crate) fn pop_values(&mut self) -> Option<[f64; SLOTS]> {
        match &mut self.stage {
            Stage::Surveying(_) => None,
            Stage::Running(timeline) => timeline.pop(),
        }
    }

    /// Report of the alignment so far; `None` until the rates are known.
    pub fn report(&self) -> Option<AlignmentReport> {
        match &self.stage {
            Stage::Surveying(_) => None,
            Stage::Running(timeline) => {
                let (without_time, strays) = (self.without_time, self.ahead.strays);
                Some(AlignmentReport { without_time, strays, ..timeline.report() })
            }
        }
    }
}

impl Stage {
    fn push(&mut self, reading: Reading, columns: &LogColumns, wanted: &[bool; SLOTS]) {
        match self {
            Stage::Surveying(survey) => {
                survey.push(reading);
                if survey.is_over() {
                    self.begin(columns, wanted);
                }
            }
            Stage::Running(timeline) => timeline.push(reading),
        }
    }

    /// The survey is over: with a clock the rows begin; without one, as long as no acceleration comes, it goes on.
    fn begin(&mut self, columns: &LogColumns, wanted: &[bool; SLOTS]) {
        let Stage::Surveying(survey) = self else { return };
        let Some(clock) = Clock::of(survey, columns) else {
            survey.forget_older_half();
            return;
        };
        let mut timeline = Timeline::new(&clock, wanted);
        for reading in survey.take() {
            timeline.push(reading);
        }
        *self = Stage::Running(Box::new(timeline));
    }
}
