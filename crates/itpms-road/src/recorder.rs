//! The road record of a streamed log: forward filter, backward pass over a window of bounded memory, and the
//! sensors' delay taken out (docs/math/road.md, sections 4 and 6).
//!
//! Called row by row by whoever writes a road record. Memory is the caller's and does not grow with the log.

use core::marker::PhantomData;

use crate::clock::Arrival;
use crate::config::RoadConfig;
use crate::filter::{RoadFilter, believable};
use crate::high_pass::HighPass;
use crate::interpolate::{HALF, WIDTH, height_at};
use crate::row::{RoadPoint, RoadRow};
use crate::segment::{Later, Segment};
use itpms_core::Real;
use itpms_core::model::CornerSample;
use thiserror::Error;

/// Length of a segment in s: the backward pass corrects slow drift only, and is linear over so short a time to a few micrometres.
const SEGMENT_S: f64 = 0.02;
/// Rows kept behind the block for interpolation.
const HISTORY: usize = WIDTH;
const FEWEST_ROWS: usize = 64;
const FEWEST_SEGMENTS: usize = 16;
/// Segments kept free of the extra cuts at gaps.
const SPARE_SEGMENTS: u64 = 4;
/// Share of a smoothed height's variance that a second pass of the high-pass leaves, at most: 3/4 where the road's slow
/// part is lost in noise above the corner (eq. 18), down to 1/4 where it is not.
const TWICE_CUT: f64 = 0.75;
/// A step of so many sampling intervals is a silence.
const SILENT_INTERVALS: f64 = 3.5;

/// A window too small to work in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error(
    "memory for {rows} rows and {segments} segments, expected at least {FEWEST_ROWS} and {FEWEST_SEGMENTS}"
)]
pub struct RecorderMemoryError {
    pub rows: usize,
    pub segments: usize,
}

/// Writes the road record of one corner. `R` and `S` own the window: vectors, arrays or mutable slices of [`RoadRow`] and [`Segment`].
///
/// Rows come out late by up to the window's length, in blocks of a quarter of it; every height has at least three
/// quarters of the window as look-ahead. Two recorders with windows of equally many rows give their points at
/// the same calls. [`RoadFilter`] settings may change between rows through [`RoadRecorder::filter_mut`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadRecorder<T: Real, R, S> {
    filter: RoadFilter<T>,
    rows: R,
    segments: S,
    scalar: PhantomData<T>,
    /// Rows written since the start, rows given out, segments begun, segments let go.
    written: u64,
    given: u64,
    begun: u64,
    let_go: u64,
    last_observed: Option<u64>,
}

/// Window for a look-ahead of `lookahead_s` ([`RoadConfig::lookahead_s`]) at `rate_hz`: numbers of rows and segments to
/// provide. In `f64`, at 500 Hz and with the default of 27 s, they take 0.9 and 1.8 MB.
pub fn window_for(rate_hz: f64, lookahead_s: f64) -> (usize, usize) {
    let rows = (rate_hz * lookahead_s / 0.75) as usize + FEWEST_ROWS;
    let per_segment = (rate_hz * SEGMENT_S) as usize;
    (rows, rows / per_segment.max(1) + 4 * FEWEST_SEGMENTS)
}

impl<T, R, S> RoadRecorder<T, R, S>
where
    T: Real,
    R: AsRef<[RoadRow<T>]> + AsMut<[RoadRow<T>]>,
    S: AsRef<[Segment<T>]> + AsMut<[Segment<T>]>,
{
    /// A recorder at the start of a log, working in the memory given ([`window_for`]). Too few segments for the rows
    /// make longer segments. Errors: fewer than 64 rows or 16 segments.
    pub fn new(config: &RoadConfig<T>, rows: R, segments: S) -> Result<Self, RecorderMemoryError> {
        let (row_count, segment_count) = (rows.as_ref().len(), segments.as_ref().len());
        if row_count < FEWEST_ROWS || segment_count < FEWEST_SEGMENTS {
            return Err(RecorderMemoryError { rows: row_count, segments: segment_count });
        }
        Ok(Self {
            filter: RoadFilter::new(config),
            rows,
            segments,
            scalar: PhantomData,
            written: 0,
            given: 0,
            begun: 0,
            let_go: 0,
            last_observed: None,
        })
    }

    /// The forward filter, to read its estimate.
    pub fn filter(&self) -> &RoadFilter<T> {
        &self.filter
    }

    /// The forward filter, to set stiffness, level, noise or the corner's parameters from the next row on.
    pub fn filter_mut(&mut self) -> &mut RoadFilter<T> {
        &mut self.filter
    }

    /// One more row of the log; gives the points that are ready, oldest first. A row whose time does not advance is
    /// dropped: no point will come for it.
    pub fn push(&mut self, time_s: f64, sample: &CornerSample<T>, mut give: impl FnMut(RoadPoint<T>)) {
        if self.filter.arrival(time_s) == Arrival::Anew {
            // The clock was set: what was before is a log of its own.
            self.finish(&mut give);
            self.let_go = self.begun;
            self.last_observed = None;
        }
        let behind_gap = self.cut_before_gap(time_s, sample);
        let advance = self.filter.advance(time_s, sample);
        if !advance.accepted {
            return;
        }
        if self.begun > self.let_go {
            let last = ((self.begun - 1) % self.segments.as_ref().len() as u64) as usize;
            let transition = advance.step.and_then(|step| self.filter.transition(step));
            self.segments.as_mut()[last].extend(transition, &advance.corrections);
        }
        let observed = advance.corrections[1].is_some();
        let row = self.written;
        *self.row_mut(row) = RoadRow {
            time_s,
            forward_m: self.filter.road_m(),
            extra_m2: self.filter.stiffness_variance_m2(),
            observed,
            ..RoadRow::default()
        };
        self.written += 1;
        if observed {
            self.bridge_to(row);
            self.last_observed = Some(row);
        }
        self.cut(if observed && behind_gap { Cut::Gap } else { Cut::Regular });
        let capacity = self.rows.as_ref().len() as u64;
        if self.written - self.given.saturating_sub(HISTORY as u64) == capacity {
            let block = (capacity - HISTORY as u64) / 4;
            self.smooth();
            self.give_until(self.given + block, &mut give);
        }
    }

    /// The log's end: gives all points that are left. Rows pushed afterwards continue the log with the
    /// knowledge of earlier samples, but heights already given do not change any more.
    pub fn finish(&mut self, mut give: impl FnMut(RoadPoint<T>)) {
        self.smooth();
        self.give_until(self.written, &mut give);
    }

    fn row(&self, row: u64) -> &RoadRow<T> {
        let rows = self.rows.as_ref();
        &rows[(row % rows.len() as u64) as usize]
    }

    fn row_mut(&mut self, row: u64) -> &mut RoadRow<T> {
        let rows = self.rows.as_mut();
        let at = (row % rows.len() as u64) as usize;
        &mut rows[at]
    }

    fn segment_mut(&mut self, segment: u64) -> &mut Segment<T> {
        let segments = self.segments.as_mut();
        let at = (segment % segments.len() as u64) as usize;
        &mut segments[at]
    }

    fn open_segment(&mut self) -> Option<&mut Segment<T>> {
        (self.begun > self.let_go).then(|| self.segment_mut(self.begun - 1))
    }

    /// Whether the coming row lies behind a gap: rows without a wheel acceleration, or a silence. Where the gap
    /// begins, a segment ends at the last row seen, since the drift must not be drawn as a line across the gap.
    fn cut_before_gap(&mut self, time_s: f64, sample: &CornerSample<T>) -> bool {
        let Some(last) = self.written.checked_sub(1) else { return false };
        let before = *self.row(last);
        let silence = time_s - before.time_s > SILENT_INTERVALS * self.filter.interval_s().to_f64();
        let begins = before.observed && (silence || believable(sample.wheel_accel_m_s2).is_none());
        if begins {
            self.cut(Cut::Gap);
        }
        silence || !before.observed
    }

    /// Between the last seen row and this one, rows without a wheel acceleration: the forward filter holds the road there and jumps at the
    /// end, the expectation given both ends is a straight line (and a Brownian bridge around it).
    fn bridge_to(&mut self, row: u64) {
        let Some(from) = self.last_observed else { return };
        let first_kept = self.given;
        if from + 1 >= row || from < first_kept {
            return;
        }
        let (a, b) = (*self.row(from), *self.row(row));
        let intensity = self.filter.road_intensity();
        let span = b.time_s - a.time_s;
        for blind in from + 1..row {
            let between = self.row_mut(blind);
            let share = T::lit((between.time_s - a.time_s) / span);
            between.forward_m = a.forward_m + share * (b.forward_m - a.forward_m);
            between.extra_m2 += intensity * T::lit(span) * share * (T::one() - share);
        }
    }

    /// Ends the open segment at the last row and begins the next, if it is long enough or borders a gap.
    fn cut(&mut self, why: Cut) {
        let Some(row) = self.written.checked_sub(1) else { return };
        let capacity = self.segments.as_ref().len() as u64;
        let rows = self.rows.as_ref().len() as u64;
        let affordable = rows / (capacity - SPARE_SEGMENTS) + 1;
        let full = ((SEGMENT_S / self.filter.interval_s().to_f64()) as u64).max(affordable);
        let held = self.begun - self.let_go;
        // Extra cuts must leave room for the regular ones up to the next block.
        let to_come = rows.saturating_sub(self.written - self.given) / full + SPARE_SEGMENTS;
        let wanted = match (self.open_segment(), why) {
            (None, _) => true,
            (Some(open), _) if open.first_row == row => false,
            (Some(open), Cut::Regular) => row - open.first_row >= full && held < capacity,
            (Some(_), Cut::Gap) => held + to_come < capacity,
        };
        if wanted {
            let segment = Segment::begin(row, self.row(row).time_s, &self.filter);
            *self.segment_mut(self.begun) = segment;
            self.begun += 1;
        }
    }

    /// The backward pass over the window, and from it every row's height.
    fn smooth(&mut self) {
        let mut later = Later::nothing();
        for segment in (self.let_go..self.begun).rev() {
            later = self.segment_mut(segment).conclude(&later);
        }
        for segment in self.let_go..self.begun {
            let from = Node::of(self.segment_mut(segment));
            let to = if segment + 1 < self.begun {
                Node::of(self.segment_mut(segment + 1))
            } else {
                self.end_node()
            };
            for row in from.row.max(self.given)..to.row {
                self.smooth_row(row, &from, &to);
            }
        }
        if let Some(last) = self.written.checked_sub(1).filter(|&last| last >= self.given) {
            let end = self.end_node();
            self.smooth_row(last, &end, &end);
        }
        self.cut_slow_part();
    }

    /// The high-pass of the model's height once more, backwards in time: takes its phase away. What lies behind the
    /// window's end counts as level ground.
    fn cut_slow_part(&mut self) {
        let mut high_pass = HighPass::new(self.filter.low_cut_rad_per_s());
        let mut later: Option<RoadRow<T>> = None;
        for row in (self.given..self.written).rev() {
            let r = *self.row(row);
            let out = match later {
                Some(l) => high_pass.step(T::lit(l.time_s - r.time_s), r.smooth_m - l.smooth_m),
                None => high_pass.step(T::zero(), r.smooth_m),
            };
            later = Some(r);
            self.row_mut(row).smooth_m = out;
        }
    }

    /// The forward filter's end: nothing later corrects it.
    fn end_node(&self) -> Node<T> {
        let row = self.written.saturating_sub(1);
        Node {
            row,
            time_s: self.row(row).time_s,
            correction_m: self.filter.expected_offset_m(),
            variance_m2: self.filter.expected_variance_m2(),
        }
    }

    /// A row's smoothed height: the forward one with the drift between two snapshots taken as a line.
    fn smooth_row(&mut self, row: u64, from: &Node<T>, to: &Node<T>) {
        let r = self.row_mut(row);
        let span = to.time_s - from.time_s;
        let share = if span > 0.0 { T::lit((r.time_s - from.time_s) / span) } else { T::zero() };
        r.smooth_m = r.forward_m + from.correction_m + share * (to.correction_m - from.correction_m);
        let variance_m2 = from.variance_m2 + share * (to.variance_m2 - from.variance_m2);
        r.variance_m2 = r.extra_m2 + T::lit(TWICE_CUT) * variance_m2;
    }

    /// Gives the rows before `end` and frees the memory that only they needed.
    fn give_until(&mut self, end: u64, give: &mut impl FnMut(RoadPoint<T>)) {
        let delay_s = self.filter.sensor_delay_s().to_f64();
        let mut left = self.given;
        for row in self.given..end {
            let time_s = self.row(row).time_s;
            while left + 1 < self.written && self.row(left + 1).time_s <= time_s + delay_s {
                left += 1;
            }
            give(self.point(time_s, delay_s, left));
        }
        self.given = end;
        while self.let_go + 1 < self.begun && self.segment_mut(self.let_go + 1).first_row <= end {
            self.let_go += 1;
        }
    }

    /// The point for `time_s`, whose height the sensors show `delay_s` later, just after row `left`.
    fn point(&self, time_s: f64, delay_s: f64, left: u64) -> RoadPoint<T> {
        let right = (left + 1).min(self.written - 1);
        let oldest = self.written.saturating_sub(self.rows.as_ref().len() as u64);
        let first = (left + 1).saturating_sub(HALF as u64).max(oldest);
        let last = (left + HALF as u64).min(self.written - 1);
        let (mut times, mut heights) = ([T::zero(); WIDTH], [T::zero(); WIDTH]);
        let count = (last + 1 - first) as usize;
        for (i, row) in (first..=last).enumerate() {
            let r = self.row(row);
            times[i] = T::lit(r.time_s - time_s - delay_s);
            heights[i] = r.smooth_m;
        }
        let (before, after) = (self.row(left), self.row(right));
        // The log's last rows are shown by sensors after its end: hold the last height.
        let road_m = if right == left {
            before.smooth_m
        } else {
            height_at(&times[..count], &heights[..count], (left - first) as usize, T::zero())
        };
        RoadPoint {
            time_s,
            road_m,
            road_sd_m: before.variance_m2.max(after.variance_m2).sqrt(),
            observed: before.observed && after.observed,
        }
    }
}

/// Why a segment may end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cut {
    /// It may have become long enough.
    Regular,
    /// A gap begins or has just ended.
    Gap,
}

/// A snapshot's place and the backward pass's conclusion there.
struct Node<T> {
    row: u64,
    time_s: f64,
    correction_m: T,
    variance_m2: T,
}

impl<T: Real> Node<T> {
    fn of(segment: &Segment<T>) -> Self {
        Self {
            row: segment.first_row,
            time_s: segment.time_s,
            correction_m: segment.correction_m,
            variance_m2: segment.variance_m2,
        }
    }
}
