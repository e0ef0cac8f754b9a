//! Rows into the order of time, by leaving out the few that are not.
//!
//! Called by the reader with every row. One row is held back, so that of two neighbours that disagree the right one
//! can go: after 1, 2, 900, 3, 4 the 900 is the odd one, after 1, 2, -7, 3 the -7.

use super::row::LogRow;
use crate::error::{Place, Problem};

/// Up to this many rows out of order are repaired in any log; beyond, [`TOLERATED_SHARE`] decides.
const TOLERATED_ROWS: u64 = 1;
/// Share of rows that may be out of order.
const TOLERATED_SHARE: f64 = 0.01;
/// While the log is still being read: rows out of order that decide nothing yet.
const PATIENCE_ROWS: u64 = 20;
/// Share of rows that may repeat the time of the row before. A logger that writes a row twice stays below; a clock
/// coarser than the sample period does not.
const TOLERATED_REPEATS: f64 = 0.1;

/// Where time last went back.
#[derive(Debug, Clone, Copy)]
struct Step {
    place: Place,
    from_s: f64,
    to_s: f64,
}

/// Keeps rows whose time increases and counts the others.
#[derive(Debug, Default)]
pub(super) struct TimeOrder {
    held: Option<LogRow>,
    emitted_s: Option<f64>,
    pub(super) rows: u64,
    pub(super) without_time: u64,
    pub(super) backwards: u64,
    pub(super) repeated: u64,
    first_repeat: Option<Place>,
    backwards_run: Option<Step>,
    in_run: bool,
}

impl TimeOrder {
    /// Takes a row, and hands out the one before it if that one is good.
    pub(super) fn push(&mut self, row: LogRow, place: Place) -> Option<LogRow> {
        self.rows += 1;
        if !row.time_s.is_finite() {
            self.without_time += 1;
            return None;
        }
        let Some(held) = self.held else {
            self.held = Some(row);
            return None;
        };
        if row.time_s > held.time_s {
            self.in_run = false;
            self.held = Some(row);
            return self.emit(held);
        }
        if row.time_s == held.time_s {
            self.repeated += 1;
            self.first_repeat.get_or_insert(place);
            return None;
        }
        self.backwards += 1;
        if !self.in_run {
            self.backwards_run = Some(Step { place, from_s: held.time_s, to_s: row.time_s });
            self.in_run = true;
        }
        if self.emitted_s.is_none_or(|emitted_s| row.time_s > emitted_s) {
            // The row fits behind what went out, the held one does not fit before it.
            self.held = Some(row);
        }
        None
    }

    /// The last row, once there are no more.
    pub(super) fn finish(&mut self) -> Option<LogRow> {
        self.held.take().and_then(|row| self.emit(row))
    }

    fn emit(&mut self, row: LogRow) -> Option<LogRow> {
        self.emitted_s = Some(row.time_s);
        Some(row)
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
                return Err(Problem::NoTime { rows: self.rows });
            }
            if let Some(held) = self.held.filter(|_| with_time > 1 && self.repeated + 1 == with_time) {
                return Err(Problem::TimeConstant { time_s: held.time_s, rows: with_time });
            }
        }
        if self.backwards > tolerated
            && self.backwards as f64 > TOLERATED_SHARE * with_time as f64
            && let Some(Step { place, from_s, to_s }) = self.backwards_run
        {
            let (backwards, rows) = (self.backwards, with_time);
            return Err(Problem::TimeBackwards { backwards, rows, place, from_s, to_s });
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

    fn sorted(times: &[f64]) -> (Vec<f64>, TimeOrder) {
        let mut order = TimeOrder::default();
        let row = |time_s| LogRow { time_s, speed_m_s: f64::NAN, corners: [None; 4] };
        let mut out: Vec<f64> = (1..)
            .zip(times)
            .filter_map(|(i, t)| order.push(row(*t), Place::Row(i)))
            .map(|row| row.time_s)
            .collect();
        out.extend(order.finish().map(|row| row.time_s));
        (out, order)
    }

    #[test]
    fn the_odd_row_goes_whichever_way_it_is_odd() {
        for (times, kept) in [
            (&[1.0, 2.0, 900.0, 3.0, 4.0][..], &[1.0, 2.0, 3.0, 4.0][..]),
            (&[1.0, 2.0, -7.0, 3.0, 4.0], &[1.0, 2.0, 3.0, 4.0]),
            (&[900.0, 1.0, 2.0, 3.0], &[1.0, 2.0, 3.0]),
            (&[1.0, 2.0, 3.0, 0.5], &[1.0, 2.0, 3.0]),
            (&[1.0, 3.0, 2.0, 4.0], &[1.0, 2.0, 4.0]),
        ] {
            let (out, order) = sorted(times);
            assert_eq!(out, kept, "{times:?}");
            assert_eq!((order.backwards, order.repeated), (1, 0), "{times:?}");
            assert!(order.check(Stage::Complete).is_ok());
        }
    }

    #[test]
    fn repeated_and_missing_times_are_left_out_and_counted() {
        let (out, order) = sorted(&[1.0, 1.0, f64::NAN, 2.0, 3.0]);
        assert_eq!(out, [1.0, 2.0, 3.0]);
        assert_eq!((order.rows, order.repeated, order.without_time), (5, 1, 1));
    }

    /// `check` before `finish`, as the reader does at the end of a log.
    fn verdict(times: impl IntoIterator<Item = f64>) -> String {
        let mut order = TimeOrder::default();
        for (i, time_s) in (2..).zip(times) {
            order.push(LogRow { time_s, speed_m_s: f64::NAN, corners: [None; 4] }, Place::Line(i));
        }
        order.check(Stage::Complete).map_or_else(|problem| problem.to_string(), |()| "fine".to_owned())
    }

    #[test]
    fn a_log_that_is_mostly_out_of_order_is_refused() {
        assert_eq!(
            verdict((0..5).map(|i| 5.0 - f64::from(i))),
            "time goes backwards in 4 of the 5 rows read, at line 3 from 5 to 4 s, expected it to increase"
        );
        assert!(verdict([7.0; 40]).starts_with("time is constant: time_s is 7 in all of the 40 rows read"));
        assert!(verdict([f64::NAN; 3]).starts_with("column time_s has no value in any of 3 rows"));
        // A clock that was set back in the middle.
        let reset = (0..500).map(f64::from).chain((0..100).map(f64::from));
        assert!(verdict(reset).contains("at line 502 from 499 to 0 s"));
        // Every stamp twice.
        let twice = (0..50).flat_map(|i| [f64::from(i); 2]);
        assert!(verdict(twice).starts_with("time stands still in 50 of the 100 rows read (first at line 3)"));
        // One in a thousand is a repair.
        assert_eq!(verdict((0..3000).map(|i| if i % 1000 == 500 { 0.0 } else { f64::from(i) })), "fine");
    }

    #[test]
    fn while_reading_a_burst_is_waited_out() {
        let mut order = TimeOrder::default();
        for (i, t) in [5.0, 4.0, 3.0].into_iter().enumerate() {
            order.push(LogRow { time_s: t, speed_m_s: 0.0, corners: [None; 4] }, Place::Row(i as u64 + 1));
        }
        assert!(order.check(Stage::Reading).is_ok() && order.check(Stage::Complete).is_err());
    }
}
