//! The work of a frame of both axles, in units of which one is due every [`UNIT_S`] seconds, or with every sample where these come fast:
//! no sample costs much more than another.
//! Frames of both sides are done with before the next ones are complete; what they say is published when they are.

use super::Fusion;
use crate::belief::state::State;
use crate::belief::{HYPOTHESES, PREDICTION_PARTS};
use crate::inter_axle::HOP_S;
use crate::inter_axle::alignment::axle_pair::{Measured, PRODUCT_PARTS};
use crate::inter_axle::residual::model::{AxleFrame, Signals, linearize};
use crate::memory::{Blank, Placed};
use crate::model::Side;
use crate::real::Real;

/// Time in s between two units; where samples come at least this fast, in Hz, a little less than one of 500 Hz takes, so that none does
/// two.
const UNIT_S: f64 = 0.001;
const FAST_HZ: f64 = 450.0;
const FAST_UNIT_S: f64 = 0.001_95;
#[derive(Clone, Copy)]
enum Unit {
    /// A part of the belief's prediction to the frame.
    Predict(usize),
    /// A checkpoint of the belief, when one is due.
    Checkpoint,
    /// Some of the products that are expected of a frame, where they are not known yet.
    Prepare(usize),
    /// Measurement by the frame, and its weight.
    Measure,
    /// One hypothesis is compared with it, and what that showed is taught to it.
    Compare(usize),
    Teach(usize),
    /// Hypotheses are weighed, and what is known of the side learns from it.
    Conclude,
}

impl Unit {
    /// The one that is due when so many are done.
    fn after(done: usize) -> Self {
        const PREPARED: usize = PREDICTION_PARTS + 1 + PRODUCT_PARTS;
        match done {
            0..PREDICTION_PARTS => Self::Predict(done),
            PREDICTION_PARTS => Self::Checkpoint,
            _ if done < PREPARED => Self::Prepare(done - PREDICTION_PARTS - 1),
            PREPARED => Self::Measure,
            _ => match (done - PREPARED - 1) / 2 {
                HYPOTHESES.. => Self::Conclude,
                hypothesis if done % 2 != PREPARED % 2 => Self::Compare(hypothesis),
                hypothesis => Self::Teach(hypothesis),
            },
        }
    }
}

/// Units of a frame whose products are known but for one bin's.
const UNITS: usize = PREDICTION_PARTS + 2 * HYPOTHESES + 4;
/// Both sides' units have to fit into a hop, with what falls due between two samples at 20 Hz. Some four hypotheses of eight are followed
/// ([`Belief::compare`](crate::belief::Belief::compare)), so that two fifths of it are left for the work that is done between frames.
const _: () = assert!(2.0 * UNITS as f64 * UNIT_S <= 0.5 * HOP_S && 2.0 * UNITS as f64 * FAST_UNIT_S < HOP_S);

/// Frames that are to be learned from. See the [module](self).
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FrameQueue<T: Real> {
    /// The sides' frames; that of which side is done first.
    frames: [Placed<AxleFrame<T>>; 2],
    first: Side,
    /// Units of the first one that are done.
    done: usize,
    /// When the next one is due, and the time between two, in s.
    due_s: f64,
    unit_s: f64,
    /// Measurement by the first one, once known.
    measured: Placed<Measured<T>>,
}

impl<T: Real> FrameQueue<T> {
    pub(super) fn configure(&mut self, sample_rate_hz: f64) {
        self.clear();
        self.unit_s = if sample_rate_hz > FAST_HZ { FAST_UNIT_S } else { UNIT_S };
    }

    pub(super) fn clear(&mut self) {
        self.frames.iter_mut().for_each(Placed::clear);
        self.measured.clear();
        (self.first, self.done, self.due_s) = (Side::Left, 0, 0.0);
    }

    /// Takes a complete frame of a side, in the place of the one before, if that is still there: more than a hop lies between two
    /// samples then.
    #[inline(never)]
    pub(super) fn enqueue(&mut self, side: Side, frame: AxleFrame<T>, now_s: f64) {
        if self.is_empty() {
            (self.first, self.done, self.due_s) = (side, 0, now_s + self.unit_s);
        }
        if self.first == side {
            self.done = 0;
        }
        self.frames[side].place(|place| *place = frame);
    }

    fn is_empty(&self) -> bool {
        self.frames.iter().all(|frame| frame.as_ref().is_none())
    }

    /// Whether a unit is due; counts it.
    fn is_due(&mut self, time_s: f64) -> bool {
        let due = !self.is_empty() && self.due_s <= time_s;
        if due {
            self.due_s += self.unit_s;
        }
        due
    }
}

impl<T: Real> Fusion<T> {
    /// Does the units that are due; true if that leaves room for other work. Where samples come fast a unit is a sample's work, and waits for
    /// the next one if this one `is_taken`; where they come slowly a sample has the time of several.
    #[inline(never)]
    pub(in crate::car) fn work_on(&mut self, time_s: f64, is_taken: bool) -> bool {
        let is_fast = self.is_fast();
        let mut has_room = !(is_fast && is_taken);
        while self.queue.is_due(time_s) {
            if has_room {
                self.do_unit();
            }
            has_room &= !is_fast;
        }
        has_room && self.is_at_rest()
    }

    /// Whether a sample has the time of one unit only.
    pub(in crate::car) fn is_fast(&self) -> bool {
        self.queue.unit_s >= FAST_UNIT_S
    }

    pub(in crate::car) fn is_large_next(&self) -> bool {
        !self.queue.is_empty()
            && matches!(Unit::after(self.queue.done), Unit::Predict(_) | Unit::Prepare(_) | Unit::Teach(_))
    }

    /// Whether the belief is at rest, and not in the middle of a frame.
    pub(in crate::car) fn is_at_rest(&self) -> bool {
        self.queue.is_empty()
    }

    /// Does the next unit in which there is something to do.
    #[inline(never)]
    fn do_unit(&mut self) {
        let side = self.queue.first;
        loop {
            let unit = Unit::after(self.queue.done);
            self.queue.done += 1;
            let done = match unit {
                Unit::Predict(part) => {
                    self.predict_to_frame(side, part);
                    true
                }
                Unit::Checkpoint => self.checkpoint(),
                Unit::Prepare(part) => self.prepare(side, part),
                Unit::Measure => self.measure(side),
                Unit::Compare(hypothesis) => self.compare(side, hypothesis),
                Unit::Teach(hypothesis) => self.teach(hypothesis),
                Unit::Conclude => {
                    self.conclude(side);
                    true
                }
            };
            if done {
                return;
            }
        }
    }

    #[inline(never)]
    fn checkpoint(&mut self) -> bool {
        let saved = self.belief.checkpoint();
        if let Some(time_s) = saved {
            self.inter_axle.pairs.iter_mut().for_each(|pair| pair.checkpoint(time_s));
        }
        saved.is_some()
    }

    #[inline(never)]
    fn predict_to_frame(&mut self, side: Side, part: usize) {
        if part == 0
            && let Some(frame) = self.queue.frames[side].as_ref()
        {
            let (time_s, delay_s) = (frame.middle_s, frame.delay_s);
            let onset = self.onset();
            self.belief.begin_prediction(time_s, &onset);
            self.inter_axle.set_delay(side, delay_s);
        }
        self.belief.predict_part(part);
    }

    #[inline(never)]
    fn prepare(&mut self, side: Side, part: usize) -> bool {
        let frame = self.queue.frames[side].as_ref();
        let (Some(frame), Some(wheels)) = (frame, self.inter_axle.wheels(side)) else { return false };
        let state = &self.belief.most_likely().mean;
        self.inter_axle.pairs[side].prepare(frame, &wheels, state, part)
    }

    #[inline(never)]
    fn measure(&mut self, side: Side) -> bool {
        let frame = self.queue.frames[side].as_ref();
        let (Some(frame), Some(wheels)) = (frame, self.inter_axle.wheels(side)) else { return false };
        for corner in [side.front(), side.rear()] {
            self.belief.drop_settled(corner, frame.middle_s);
        }
        let opposite = &self.inter_axle.pairs[side.other()];
        let meanwhile = self.inter_axle.pairs[side].found_meanwhile(opposite, frame.middle_s);
        let state = &self.belief.most_likely().mean;
        let pair = &mut self.inter_axle.pairs[side];
        let measure = |out: &mut Measured<T>| pair.measure(frame, &wheels, state, meanwhile, out).ok_or(());
        if self.queue.measured.try_place(measure).is_ok() {
            self.belief.begin_update(&self.queue.measured.value().measurement);
        }
        true
    }

    #[inline(never)]
    fn compare(&mut self, side: Side, hypothesis: usize) -> bool {
        let frame = self.queue.frames[side].as_ref().zip(self.queue.measured.as_ref());
        let (Some((frame, measured)), Some(wheels)) = (frame, self.inter_axle.wheels(side)) else {
            return false;
        };
        let at = |state: &State<T>| linearize(frame, Signals::Measured, &wheels, side, state);
        self.belief.compare(hypothesis, &measured.measurement, at)
    }

    #[inline(never)]
    fn teach(&mut self, hypothesis: usize) -> bool {
        let reading = self.queue.measured.as_ref().map(|measured| &measured.measurement.reading);
        reading.is_some_and(|reading| self.belief.teach(hypothesis, reading))
    }

    #[inline(never)]
    fn conclude(&mut self, side: Side) {
        let opposite_parts = self.inter_axle.pairs[side.other()].is_parting();
        let mut learned_s = 0.0;
        if let Some((frame, measured)) = self.queue.frames[side].as_ref().zip(self.queue.measured.as_ref())
            && let Some(record) = self.belief.finish_update()
            && self.inter_axle.pairs[side].learn(frame, measured, record, opposite_parts)
        {
            learned_s = 0.5 * HOP_S;
            self.inter_axle.learned();
        }
        self.belief.settle(learned_s);
        self.queue.measured.clear();
        self.queue.frames[side].clear();
        (self.queue.first, self.queue.done) = (side.other(), 0);
        self.belief.refresh(&mut self.tires);
    }
}
