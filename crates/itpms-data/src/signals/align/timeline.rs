//! The rows in the making: every reading finds its row, every row waits for its readings, and then goes.

use std::collections::VecDeque;

use super::kernel::HALF_WIDTH;
use super::report::{AlignmentReport, SlotAlignment, SlotMethod};
use super::series::Series;
use super::survey::{Clock, FEWEST, mean_period};
use crate::log::{SLOTS, Slot};
use crate::signals::Reading;

/// An acceleration this much faster than the rows goes through the low-pass.
const FASTER: f64 = 0.8;
/// Later rows that are begun while a row waits for accelerations of its rate.
const WAIT: f64 = 2.0;
/// The same for faster accelerations.
const WAIT_FAST: f64 = HALF_WIDTH + 3.0;
/// Own periods, and seconds, a row waits for speed and truth. Counted in later rows, too: a single stamp from the future
/// must not end all waiting.
const WAIT_SLOW: f64 = 2.5;
const WAIT_SLOW_S: f64 = 0.5;
/// An offset beyond this share of a period belongs to the neighbouring row.
const WRAP: f64 = 0.75;
/// How fast an offset is followed: weight of a new reading.
const FOLLOW: f64 = 1.0 / 256.0;
/// Readings in a row, all of the past, after which a clock that went back is believed.
const SET_BACK: u32 = 16;
/// Rows in the making at most: half a second at 8 kHz.
const MOST_ROWS: usize = 4096;

/// How a signal comes into the rows.
#[derive(Debug)]
enum Role {
    /// As it is, this far behind the clock, in s.
    Same(f64),
    Faster(Series),
    Slow(Series),
    /// As it came, once, in the next row: times and values that wait. For sensors that send when they like.
    Sent(VecDeque<(f64, f64)>),
    /// Its rate is not known yet: times of its first readings.
    Unknown(Vec<f64>),
}

#[derive(Debug)]
struct Signal {
    slot: Slot,
    role: Role,
    readings: u64,
    left_over: u64,
}

#[derive(Debug)]
struct Row {
    values: [f64; SLOTS],
    /// Time of each reading in it, its offset taken off; NaN where none has come.
    came_s: [f64; SLOTS],
}

impl Row {
    fn empty(time_s: f64) -> Self {
        let mut row = Self { values: [f64::NAN; SLOTS], came_s: [f64::NAN; SLOTS] };
        row.values[Slot::Time.index()] = time_s;
        row
    }

    fn has(&self, slot: Slot) -> bool {
        !self.came_s[slot.index()].is_nan()
    }

    fn put(&mut self, slot: Slot, time_s: f64, value: f64) {
        self.values[slot.index()] = value;
        self.came_s[slot.index()] = time_s;
    }

    fn time_s(&self) -> f64 {
        self.values[Slot::Time.index()]
    }
}

#[derive(Debug)]
pub(super) struct Timeline {
    clock: Slot,
    period_s: f64,
    signals: Vec<Signal>,
    places: [Option<usize>; SLOTS],
    rows: VecDeque<Row>,
    /// Rows before this time cannot be made: a low-pass would reach before the first reading.
    begin_s: f64,
    last_row_s: f64,
    refused: u32,
    late: u64,
    restarts: u64,
    finished: bool,
    /// Rows that do not wait any more.
    released: usize,
}

impl Timeline {
    pub(super) fn new(clock: &Clock, wanted: &[bool; SLOTS]) -> Self {
        let mut signals = Vec::new();
        let mut places = [None; SLOTS];
        let mut begin_s = f64::NEG_INFINITY;
        for slot in Slot::all().filter(|slot| wanted[slot.index()]) {
            let i = slot.index();
            let role = match slot == clock.slot {
                true => Role::Same(0.0),
                false => role(slot, clock.periods_s[i], clock.period_s, clock.offsets_s[i]),
            };
            if matches!(role, Role::Faster(_)) {
                begin_s = begin_s.max(clock.first_s[i] + HALF_WIDTH * clock.period_s);
            }
            places[i] = Some(signals.len());
            signals.push(Signal { slot, role, readings: 0, left_over: 0 });
        }
        Self {
            clock: clock.slot,
            period_s: clock.period_s,
            signals,
            places,
            rows: VecDeque::new(),
            begin_s,
            last_row_s: f64::NEG_INFINITY,
            refused: 0,
            late: 0,
            restarts: 0,
            finished: false,
            released: 0,
        }
    }

    pub(super) fn push(&mut self, reading: Reading) {
        let Some(place) = self.places[reading.slot.index()] else { return };
        if self.is_of_the_past(reading.time_s) {
            return;
        }
        let signal = &mut self.signals[place];
        signal.readings += 1;
        match &mut signal.role {
            Role::Same(offset_s) => {
                let time_s = reading.time_s - *offset_s;
                self.set(place, time_s, reading.value);
            }
            Role::Faster(series) | Role::Slow(series) => series.push(reading.time_s, reading.value),
            Role::Sent(waiting) if reading.value.is_finite() && waiting.len() < MOST_ROWS => {
                waiting.push_back((reading.time_s, reading.value));
            }
            Role::Sent(_) => {}
            Role::Unknown(times) => {
                times.push(reading.time_s);
                if times.len() >= 8 * FEWEST {
                    let period_s = mean_period(times);
                    let lag_s = (reading.time_s - self.last_row_s).rem_euclid(self.period_s);
                    let offset_s = if lag_s > 0.5 * self.period_s { lag_s - self.period_s } else { lag_s };
                    signal.role = role(reading.slot, period_s, self.period_s, offset_s);
                }
            }
        }
    }

    /// Whether a reading is older than the rows that have gone. When nothing else comes any more, the clock was set back.
    fn is_of_the_past(&mut self, time_s: f64) -> bool {
        if time_s >= self.last_row_s - self.period_s {
            self.refused = 0;
            return false;
        }
        self.late += 1;
        self.refused += 1;
        if self.refused < SET_BACK {
            return true;
        }
        self.restarts += 1;
        self.refused = 0;
        self.rows.clear();
        (self.last_row_s, self.begin_s) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for signal in &mut self.signals {
            match &mut signal.role {
                Role::Faster(series) | Role::Slow(series) => series.clear(),
                Role::Sent(waiting) => waiting.clear(),
                Role::Same(_) | Role::Unknown(_) => {}
            }
        }
        false
    }

    /// Puts a value into the row nearest to `time_s`, its offset taken off, or begins one there.
    fn set(&mut self, place: usize, time_s: f64, value: f64) {
        let slot = self.signals[place].slot;
        match nearest(&mut self.rows, time_s, 0.5 * self.period_s) {
            // Messages of a bus may come in bunches: every reading of a wheel's clock is a row of its own.
            Some(row) if row.has(slot) && slot == self.clock && slot.is_wheel_speed() => {
                self.open(place, time_s, value);
            }
            Some(row) if row.has(slot) => self.signals[place].left_over += 1,
            Some(row) => {
                row.put(slot, time_s, value);
                if slot == self.clock {
                    row.values[Slot::Time.index()] = time_s;
                    let came_s = row.came_s;
                    self.signals
                        .iter_mut()
                        .for_each(|signal| signal.follow(&came_s, self.clock, self.period_s));
                } else if row.has(self.clock) {
                    let came_s = row.came_s;
                    self.signals[place].follow(&came_s, self.clock, self.period_s);
                }
            }
            None => self.open(place, time_s, value),
        }
    }

    /// A row that is not begun yet, unless its time has passed.
    fn open(&mut self, place: usize, time_s: f64, value: f64) {
        if time_s < self.begin_s {
            return;
        }
        if !(time_s > self.last_row_s) {
            self.signals[place].left_over += 1;
            return;
        }
        let mut row = Row::empty(time_s);
        row.put(self.signals[place].slot, time_s, value);
        let at = self.rows.partition_point(|other| other.time_s() < time_s);
        self.rows.insert(at, row);
    }

    pub(super) fn finish(&mut self) {
        self.finished = true;
        // Rows under whose low-pass the readings end would be half empty: they are not made.
        let end_s = self.signals.iter().fold(f64::INFINITY, |end_s, signal| match &signal.role {
            Role::Faster(series) => end_s.min(series.newest_s() - HALF_WIDTH * self.period_s),
            _ => end_s,
        });
        while self.rows.back().is_some_and(|row| row.time_s() > end_s) {
            self.rows.pop_back();
        }
    }

    pub(super) fn flush(&mut self) {
        self.released = self.rows.len();
    }

    pub(super) fn pop(&mut self) -> Option<[f64; SLOTS]> {
        let row = self.rows.front()?;
        let goes = self.finished || self.released > 0 || self.rows.len() >= MOST_ROWS || self.is_ready(row);
        if !goes {
            return None;
        }
        self.released = self.released.saturating_sub(1);
        let mut values = self.rows.pop_front()?.values;
        let time_s = values[Slot::Time.index()];
        for signal in &mut self.signals {
            let value = &mut values[signal.slot.index()];
            match &mut signal.role {
                Role::Faster(series) => {
                    *value = series.filtered(time_s, self.period_s);
                    series.forget_before(time_s - HALF_WIDTH * self.period_s);
                }
                Role::Slow(series) => {
                    *value = series.at(time_s);
                    series.forget_before(time_s);
                }
                Role::Sent(waiting) => {
                    while waiting.front().is_some_and(|(sent_s, _)| *sent_s <= time_s) {
                        *value = waiting.pop_front().map_or(f64::NAN, |(_, sent)| sent);
                    }
                }
                Role::Same(_) | Role::Unknown(_) => {}
            }
        }
        self.last_row_s = time_s;
        Some(values)
    }

    fn is_ready(&self, row: &Row) -> bool {
        let time_s = row.time_s();
        let later = self.rows.len().saturating_sub(1) as f64;
        self.signals.iter().all(|signal| match &signal.role {
            Role::Same(_) => row.has(signal.slot) || later >= WAIT,
            Role::Faster(series) => {
                series.newest_s() >= time_s + HALF_WIDTH * self.period_s || later >= WAIT_FAST
            }
            Role::Slow(series) => {
                let patience_s = (WAIT_SLOW * series.period_s()).min(WAIT_SLOW_S);
                series.newest_s() >= time_s || later * self.period_s >= patience_s.max(self.period_s)
            }
            Role::Sent(_) | Role::Unknown(_) => true,
        })
    }

    pub(super) fn report(&self) -> AlignmentReport {
        let signals = self.signals.iter().map(|signal| {
            let (method, rate_hz) = match &signal.role {
                Role::Same(_) if signal.slot == self.clock => (SlotMethod::Clock, 1.0 / self.period_s),
                Role::Same(offset_s) => (SlotMethod::AsItIs { offset_s: *offset_s }, 1.0 / self.period_s),
                Role::Faster(series) => (SlotMethod::LowPass, 1.0 / series.period_s()),
                Role::Slow(series) => (SlotMethod::Interpolated, 1.0 / series.period_s()),
                Role::Sent(_) => (SlotMethod::Sent, f64::NAN),
                Role::Unknown(_) => (SlotMethod::Waiting, f64::NAN),
            };
            let Signal { slot, readings, left_over, .. } = *signal;
            SlotAlignment { slot, rate_hz, method, readings, left_over }
        });
        AlignmentReport {
            rate_hz: 1.0 / self.period_s,
            signals: signals.collect(),
            without_time: 0,
            strays: 0,
            late: self.late,
            restarts: self.restarts,
        }
    }
}

impl Signal {
    /// Its offset after a row that holds both it and the clock.
    fn follow(&mut self, came_s: &[f64; SLOTS], clock: Slot, period_s: f64) {
        let behind_s = came_s[self.slot.index()] - came_s[clock.index()];
        let Role::Same(offset_s) = &mut self.role else { return };
        if self.slot == clock || behind_s.is_nan() {
            return;
        }
        *offset_s += FOLLOW * behind_s;
        if offset_s.abs() > WRAP * period_s {
            *offset_s -= period_s.copysign(*offset_s);
        }
    }
}

/// The row nearest to a time, if it is near enough. Rows are in order: one that moves to a reading's time stays the nearest to it.
fn nearest(rows: &mut VecDeque<Row>, time_s: f64, within_s: f64) -> Option<&mut Row> {
    let apart_s = |row: &Row| (row.time_s() - time_s).abs();
    let later = rows.partition_point(|row| row.time_s() < time_s);
    let around = later.saturating_sub(1)..(later + 1).min(rows.len());
    let nearest = rows.range_mut(around).min_by(|a, b| apart_s(a).total_cmp(&apart_s(b)))?;
    (apart_s(nearest) <= within_s).then_some(nearest)
}

/// How a signal of this period comes into rows of that one.
fn role(slot: Slot, period_s: f64, row_period_s: f64, offset_s: f64) -> Role {
    match slot.is_acceleration() {
        _ if slot.is_sparse() => Role::Sent(VecDeque::new()),
        _ if period_s.is_nan() => Role::Unknown(Vec::new()),
        true if period_s < FASTER * row_period_s => Role::Faster(Series::new(period_s)),
        true => Role::Same(offset_s),
        false => Role::Slow(Series::new(period_s)),
    }
}
