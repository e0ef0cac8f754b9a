//! Rows of a table into the order of time; the few that cannot be are left out.
//!
//! Called by the reader with every row of a table. Rows of signals come in order from the aligner and do not come here.

use std::collections::VecDeque;

use super::row::LogRow;
use super::stamps::{Coarse, Fate, Series, Sorted, Stamped, Strays, TOLERATED_SHARE};
use crate::error::{Place, Problem, coarse_clock};

/// Up to this many rows out of order are repaired in any log; beyond, [`TOLERATED_SHARE`] decides.
const TOLERATED_ROWS: u64 = 1;
/// While the log is still being read: rows out of order that decide nothing yet.
const PATIENCE_ROWS: u64 = 20;
/// Share of rows that may repeat the time of the row before. A logger that writes a row twice stays below.
const TOLERATED_REPEATS: f64 = 0.1;
/// So near the first stamp a clock that went back has begun again, in s.
const BEGINS_AGAIN_S: f64 = 1.0;
/// Rows that wait at most for earlier ones: some 12 MB.
const MOST_ROWS: usize = 1 << 16;

#[derive(Debug, Clone, Copy)]
struct Line {
    row: LogRow,
    place: Place,
    /// Time of the row before it in the file; NaN for the first.
    before_s: f64,
}

impl Line {
    fn step_back(&self) -> Option<Step> {
        let Self { row, place, before_s } = *self;
        (row.time_s < before_s).then_some(Step { place, from_s: before_s, to_s: row.time_s })
    }
}

impl Stamped for Line {
    fn time_s(&self) -> f64 {
        self.row.time_s
    }

    fn at(mut self, time_s: f64) -> Self {
        self.row.time_s = time_s;
        self
    }

    fn has_values_of(&self, other: &Self) -> bool {
        self.row.has_values_of(&other.row)
    }
}

/// Where time went back, from one row of the file to the next.
#[derive(Debug, Clone, Copy)]
struct Step {
    place: Place,
    from_s: f64,
    to_s: f64,
}

/// Puts rows in order and counts those it moves or leaves out.
#[derive(Debug)]
pub(super) struct TimeOrder {
    strays: Strays<Line>,
    series: Series<Line>,
    sorted: Sorted<Line>,
    given_s: f64,
    /// Time of the first row in the file, and of the last one; NaN before the first.
    first_s: f64,
    last_s: f64,
    pub(super) rows: u64,
    pub(super) without_time: u64,
    pub(super) backwards: u64,
    /// Rows left out because another one has their time.
    pub(super) repeated: u64,
    first_repeat: Option<Place>,
    step_back: Option<Step>,
}

impl TimeOrder {
    pub(super) fn new() -> Self {
        Self {
            strays: Strays::new(),
            series: Series::new(),
            sorted: Sorted::new(MOST_ROWS),
            given_s: f64::NEG_INFINITY,
            first_s: f64::NAN,
            last_s: f64::NAN,
            rows: 0,
            without_time: 0,
            backwards: 0,
            repeated: 0,
            first_repeat: None,
            step_back: None,
        }
    }

    /// Takes a row; hands out those that no earlier one can precede.
    pub(super) fn push(&mut self, row: LogRow, place: Place, out: &mut VecDeque<LogRow>) {
        self.rows += 1;
        if !row.time_s.is_finite() {
            self.without_time += 1;
            return;
        }
        if self.last_s.is_nan() {
            self.first_s = row.time_s;
        }
        let Self { strays, series, sorted, .. } = self;
        let line = Line { row, place, before_s: std::mem::replace(&mut self.last_s, row.time_s) };
        let mut left_out = LeftOut::default();
        strays.take(line, |fate| left_out.pass(fate, series, sorted));
        self.count(&left_out, line.step_back());
        self.hand_out(out);
    }

    /// The last rows, once there are no more.
    pub(super) fn finish(&mut self, out: &mut VecDeque<LogRow>) {
        let Self { strays, series, sorted, .. } = self;
        let mut left_out = LeftOut::default();
        strays.finish(|fate| left_out.pass(fate, series, sorted));
        series.settle(&mut |fate| left_out.sort(fate, sorted));
        sorted.finish();
        self.count(&left_out, None);
        self.hand_out(out);
    }

    /// Of rows that were left out, time went back with one of them, or, where they lie ahead of the others, with the row `after` them.
    fn count(&mut self, left_out: &LeftOut, after: Option<Step>) {
        self.backwards += left_out.strays;
        self.repeated += left_out.repeated;
        self.first_repeat = self.first_repeat.or(left_out.first_repeat);
        if left_out.strays > 0 {
            self.step_back = self.step_back.or(left_out.step_back).or(after);
        }
    }

    fn hand_out(&mut self, out: &mut VecDeque<LogRow>) {
        while let Some(Line { row, place, .. }) = self.sorted.pop() {
            if row.time_s > self.given_s {
                self.given_s = row.time_s;
                out.push_back(row);
            } else {
                self.repeated += 1;
                self.first_repeat.get_or_insert(place);
            }
        }
    }

    /// Rows that came after a later one and were put in their place.
    pub(super) fn moved(&self) -> u64 {
        self.sorted.moved
    }

    /// Finding on a clock coarser than the rows.
    pub(super) fn coarse(&self) -> Coarse {
        self.series.coarse()
    }

    /// Whether what was left out so far is still a repair and not most of the log.
    pub(super) fn check(&self, stage: Stage) -> Result<(), Problem> {
        let tolerated = match stage {
            Stage::Reading => PATIENCE_ROWS,
            Stage::Complete => TOLERATED_ROWS,
        };
        let with_time = self.rows - self.without_time;
        if let Stage::Complete = stage {
            if self.rows > 0 && with_time == 0 {
                return Err(format!("column time_s has no value in any of {} rows", self.rows).into());
            }
            if with_time > 1 && self.repeated + 1 == with_time {
                return Err(format!(
                    "time is constant: time_s is {} in all of the {with_time} rows read, expected it to increase",
                    self.given_s
                )
                .into());
            }
        }
        if self.backwards > tolerated
            && self.backwards as f64 > TOLERATED_SHARE * with_time as f64
            && let Some(Step { place, from_s, to_s }) = self.step_back
        {
            // Sorted, two recordings would be one of twice the rate.
            if (to_s - self.first_s).abs() < BEGINS_AGAIN_S && from_s - self.first_s > BEGINS_AGAIN_S {
                return Err(format!(
                    "the clock begins again at {place}, from {from_s} to {to_s} s: another recording, expected one: cut the file before \
                     {place}, and give each part the header"
                )
                .into());
            }
            return Err(format!(
                "time goes backwards in {} of the {with_time} rows read, at {place} from {from_s} to {to_s} s, expected it to increase \
                 (rows are put in order over ten seconds; sort the file by its time, or cut it where the clock was set)",
                self.backwards
            )
            .into());
        }
        let coarse = self.coarse();
        if coarse.is_unsure() {
            let Coarse { step_s, rate_hz, .. } = coarse;
            return Err(coarse_clock("rows", step_s, rate_hz));
        }
        if self.repeated > tolerated
            && self.repeated as f64 > TOLERATED_REPEATS * with_time as f64
            && let Some(place) = self.first_repeat
        {
            return Err(Problem::TimeRepeats { repeated: self.repeated, rows: with_time, place });
        }
        Ok(())
    }
}

/// Rows displaced by one row.
#[derive(Default)]
struct LeftOut {
    strays: u64,
    repeated: u64,
    step_back: Option<Step>,
    first_repeat: Option<Place>,
}

impl LeftOut {
    fn pass(&mut self, fate: Fate<Line>, series: &mut Series<Line>, sorted: &mut Sorted<Line>) {
        match fate {
            Fate::Kept(line) => series.take(line, &mut |fate| self.sort(fate, sorted)),
            other => self.sort(other, sorted),
        }
    }

    fn sort(&mut self, fate: Fate<Line>, sorted: &mut Sorted<Line>) {
        match fate {
            Fate::Kept(line) if sorted.push(line) => {}
            Fate::Kept(line) | Fate::Stray(line) => {
                self.strays += 1;
                self.step_back = self.step_back.or_else(|| line.step_back());
            }
            Fate::Repeated(line) => {
                self.repeated += 1;
                self.first_repeat.get_or_insert(line.place);
            }
        }
    }
}

/// How much of the log a verdict is based on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// More rows will come.
    Reading,
    /// All rows, or enough of them, have been seen.
    Complete,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(times: impl IntoIterator<Item = f64>) -> (Vec<f64>, TimeOrder) {
        let mut order = TimeOrder::new();
        let mut out = VecDeque::new();
        for (i, time_s) in (2..).zip(times) {
            let row = LogRow::without_motion(time_s, i as f64, [None; 4]);
            order.push(row, Place::Line(i), &mut out);
        }
        order.finish(&mut out);
        (out.iter().map(|row| row.time_s).collect(), order)
    }

    #[test]
    fn what_is_late_by_seconds_is_put_in_its_place_and_what_is_far_off_goes() {
        for (times, kept, counts) in [
            (&[1.0, 2.0, 900.0, 3.0, 4.0][..], &[1.0, 2.0, 3.0, 4.0][..], (1, 0)),
            (&[20.0, 21.0, -7.0, 22.0], &[20.0, 21.0, 22.0], (1, 0)),
            (&[900.0, 1.0, 2.0, 3.0], &[1.0, 2.0, 3.0], (1, 0)),
            (&[1.0, 2.0, 3.0, 0.5], &[0.5, 1.0, 2.0, 3.0], (0, 1)),
            (&[1.0, 3.0, 2.0, 4.0], &[1.0, 2.0, 3.0, 4.0], (0, 1)),
        ] {
            let (out, order) = sorted(times.iter().copied());
            assert_eq!(out, kept, "{times:?}");
            assert_eq!(
                (order.backwards, order.moved(), order.repeated),
                (counts.0, counts.1, 0),
                "{times:?}"
            );
            assert!(order.check(Stage::Complete).is_ok());
        }
    }

    #[test]
    fn repeated_and_missing_times_are_left_out_and_counted() {
        let (out, order) = sorted([1.0, 1.0, f64::NAN, 2.0, 3.0]);
        assert_eq!(out, [1.0, 2.0, 3.0]);
        assert_eq!((order.rows, order.repeated, order.without_time), (5, 1, 1));
    }

    fn verdict(times: impl IntoIterator<Item = f64>) -> String {
        sorted(times)
            .1
            .check(Stage::Complete)
            .map_or_else(|problem| problem.to_string(), |()| "fine".to_owned())
    }

    #[test]
    fn a_log_that_is_mostly_out_of_order_is_refused() {
        let back = verdict((0..500).map(|i| 500.0 - f64::from(i)));
        assert!(
            back.starts_with("time goes backwards in 49") && back.contains("at line 3 from 500 to 499 s"),
            "{back}"
        );
        // Rows at a clock far ahead: time goes back with the row after them.
        let ahead = (0..40).map(|i| if (20..22).contains(&i) { 9000.0 } else { f64::from(i) });
        assert!(verdict(ahead).contains("at line 24 from 9000 to 22 s"));
        assert!(verdict([7.0; 40]).starts_with("time is constant: time_s is 7 in all of the 40 rows read"));
        assert!(verdict([f64::NAN; 3]).starts_with("column time_s has no value in any of 3 rows"));
        // A clock that was set back in the middle.
        let reset = (0..500).map(f64::from).chain((0..100).map(f64::from));
        assert!(verdict(reset).starts_with("the clock begins again at line 502, from 499 to 0 s"));
        let set = (0..500).map(f64::from).chain((200..300).map(f64::from));
        assert!(verdict(set).contains("at line 502 from 499 to 200 s"));
        // One in a thousand is a repair.
        assert_eq!(verdict((0..3000).map(|i| if i % 1000 == 500 { 0.0 } else { f64::from(i) })), "fine");
    }

    #[test]
    fn rows_under_a_coarse_clock_are_spread_or_refused() {
        let even =
            |step_s: f64| (0..5000).map(move |i| ((f64::from(i) * 0.002 + 1e-9) / step_s).floor() * step_s);
        let (out, order) = sorted(even(0.01));
        assert_eq!((out.len(), order.repeated, verdict(even(0.01))), (5000, 0, "fine".to_owned()));
        assert!(out.windows(2).all(|pair| (pair[1] - pair[0] - 0.002).abs() < 5e-4));
        assert!(
            verdict(even(1.0)).contains("1 s") && verdict(even(1.0)).contains("500"),
            "{}",
            verdict(even(1.0))
        );
    }

    #[test]
    fn while_reading_a_burst_is_waited_out() {
        let (_, order) = sorted([50.0, 51.0, 52.0, 4.0, 3.0]);
        assert!(order.check(Stage::Reading).is_ok() && order.check(Stage::Complete).is_err());
    }
}
