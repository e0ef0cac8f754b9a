//! A speed that comes at a rate of its own: every tenth row of a table has one, and the rows between get theirs from the straight line,
//! as the [aligner](crate::signals::align) has it for buses.
//!
//! Called by the reader with the rows of a table in the order of their times. What is further from a reading than the speed's own
//! rate explains stays missing. A speed that comes later than the first rows, as after a receiver's first fix, is looked at when it comes.

use std::collections::VecDeque;

use super::row::LogRow;
use super::survey::SURVEY_ROWS;

/// Readings no further apart than so many of their periods have a line between them.
const PERIODS: f64 = 3.0;
/// A speed in every row, but for one now and then, needs none.
const OWN_RATE: f64 = 1.5;
/// Share of the steps between readings that are near the period, and how near at most, as a share of it.
const REGULAR: f64 = 0.8;
const NEAR: f64 = 0.5;
/// In so many tables whose rows have a speed by chance, their steps are as even.
const MOST_CHANCE: f64 = 0.01;
/// Rows that wait for a reading at most.
const MOST_ROWS: usize = 1 << 15;

#[derive(Debug, Default)]
pub(super) struct SlowSpeed {
    /// Of the speed, where it is longer than that of the rows.
    period_s: Option<f64>,
    /// Rows from the first one with a speed on, where the table began without.
    looking: Option<Vec<LogRow>>,
    last: Option<(f64, f64)>,
    /// Rows since the last reading, or before the first one.
    waiting: VecDeque<LogRow>,
}

impl SlowSpeed {
    /// Of a table whose first rows have these times and speeds.
    pub(super) fn of(rows: impl Iterator<Item = (f64, f64)> + Clone) -> Self {
        let has_speed = rows.clone().any(|(_, speed)| speed.is_finite());
        Self { period_s: own_period(rows), looking: (!has_speed).then(Vec::new), ..Self::default() }
    }

    /// Whether rows are to go through it.
    pub(super) fn is_of_use(&self) -> bool {
        self.period_s.is_some() || self.looking.is_some()
    }

    /// Its readings a second, where it has a rate of its own.
    pub(super) fn rate_hz(&self) -> Option<f64> {
        self.period_s.map(|period_s| 1.0 / period_s)
    }

    /// Takes the next row; hands out those whose speed is settled.
    pub(super) fn push(&mut self, row: LogRow, out: &mut VecDeque<LogRow>) {
        if let Some(looking) = &mut self.looking
            && (!looking.is_empty() || row.speed_m_s.is_finite())
        {
            looking.push(row);
            if looking.len() >= SURVEY_ROWS {
                self.decide(out);
            }
            return;
        }
        let Some(period_s) = self.period_s else { return out.push_back(row) };
        if row.speed_m_s.is_finite() {
            let now = (row.time_s, row.speed_m_s);
            self.settle(Some(now), period_s, out);
            self.last = Some(now);
            return out.push_back(row);
        }
        let since_s = self.last.map(|(time_s, _)| time_s).or(self.waiting.front().map(|row| row.time_s));
        let waits_s = row.time_s - since_s.unwrap_or(row.time_s);
        self.waiting.push_back(row);
        if waits_s > PERIODS * period_s || self.waiting.len() >= MOST_ROWS {
            self.settle(None, period_s, out);
            self.last = None;
        }
    }

    /// There are no more rows.
    pub(super) fn finish(&mut self, out: &mut VecDeque<LogRow>) {
        self.decide(out);
        if let Some(period_s) = self.period_s {
            self.settle(None, period_s, out);
        }
    }

    /// What was looked at says whether the speed has a rate of its own.
    fn decide(&mut self, out: &mut VecDeque<LogRow>) {
        let rows = self.looking.take().unwrap_or_default();
        if !rows.is_empty() {
            self.period_s = own_period(rows.iter().map(|row| (row.time_s, row.speed_m_s)));
        }
        rows.into_iter().for_each(|row| self.push(row, out));
    }

    /// The rows that wait get a speed: on the line to the next reading, or that of one no further than its period.
    fn settle(&mut self, next: Option<(f64, f64)>, period_s: f64, out: &mut VecDeque<LogRow>) {
        let near =
            |time_s: f64, (at_s, speed): (f64, f64)| ((time_s - at_s).abs() <= period_s).then_some(speed);
        for mut row in self.waiting.drain(..) {
            let speed = match (self.last, next) {
                (Some((from_s, from)), Some((to_s, to))) if to_s - from_s <= PERIODS * period_s => {
                    Some(from + (to - from) * (row.time_s - from_s) / (to_s - from_s))
                }
                (last, next) => {
                    [last, next].into_iter().flatten().find_map(|reading| near(row.time_s, reading))
                }
            };
            row.speed_m_s = speed.unwrap_or(f64::NAN);
            out.push_back(row);
        }
    }
}

/// The period of the speed in rows of these times and speeds, where it is longer than theirs.
fn own_period(rows: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let row_s = regular_step(rows.clone().map(|(time_s, _)| time_s), 0.0)?;
    let with_speed = rows.filter(|(_, speed)| speed.is_finite()).map(|(time_s, _)| time_s);
    regular_step(with_speed, row_s).filter(|own_s| *own_s > OWN_RATE * row_s)
}

/// The median step between these times, where chance does not make steps so even.
///
/// Where each row has a value with the same small probability, steps are exponentially distributed. Of such a step the probability to
/// be within a share d of the median is 2^-(1-d) - 2^-(1+d) = sinh(d ln 2); k of n steps are so, beside the median itself, with at most
/// (n over k) times its (k-1)th power. A step of a whole number of rows is known to half of one.
fn regular_step(times: impl Iterator<Item = f64>, row_s: f64) -> Option<f64> {
    let times: Vec<f64> = times.collect();
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.retain(|step| *step > 0.0);
    steps.sort_by(f64::total_cmp);
    let median_s = *steps.get(steps.len() / 2)?;
    let mut off: Vec<f64> = steps.iter().map(|step| (step / median_s - 1.0).abs()).collect();
    off.sort_by(f64::total_cmp);
    let near = (REGULAR * steps.len() as f64).ceil() as usize;
    let share = off.get(near.checked_sub(1)?)?.max(0.5 * row_s / median_s);
    let probability = (share * std::f64::consts::LN_2).sinh();
    let choices: f64 = (1..=steps.len() - near).map(|i| (1.0 + near as f64 / i as f64).ln()).sum();
    let chance = (choices + (near as f64 - 1.0) * probability.ln()).exp();
    (share <= NEAR && chance < MOST_CHANCE).then_some(median_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 30 s at this rate with a speed of 20 + t where `has` says so, through.
    fn through(rate_hz: f64, has: impl Fn(usize) -> bool) -> (Option<f64>, Vec<LogRow>) {
        let row = |k: usize| {
            let time_s = k as f64 / rate_hz;
            let speed_m_s = if has(k) { 20.0 + time_s } else { f64::NAN };
            LogRow::without_motion(time_s, speed_m_s, [None; 4])
        };
        let rows: Vec<LogRow> = (0..(30.0 * rate_hz) as usize).map(row).collect();
        let first = &rows[..SURVEY_ROWS.min(rows.len())];
        let mut slow = SlowSpeed::of(first.iter().map(|row| (row.time_s, row.speed_m_s)));
        let mut out = VecDeque::new();
        rows.iter().for_each(|row| slow.push(*row, &mut out));
        slow.finish(&mut out);
        assert!(out.iter().map(|row| row.time_s).eq(rows.iter().map(|row| row.time_s)));
        (slow.rate_hz(), out.into())
    }

    /// Rows `from` to `to` are on the line, the others no further off than a second's change.
    fn are_on_the_line(rows: &[LogRow], between: std::ops::Range<usize>) {
        for (k, row) in rows.iter().enumerate() {
            let off = (row.speed_m_s - 20.0 - row.time_s).abs();
            let most = if between.contains(&k) { 1e-9 } else { 1.1 };
            assert!(off < most || (row.speed_m_s.is_nan() && k < between.start), "{k}: {off}");
        }
    }

    #[test]
    fn between_readings_it_is_on_the_line_and_far_from_them_it_is_missing() {
        for (rate_hz, every) in
            [(200.0, 10), (100.0, 25), (200.0, 100), (200.0, 200), (500.0, 500), (1000.0, 1000)]
        {
            let (own_hz, rows) = through(rate_hz, |k| k % every == 3);
            let expected_hz = rate_hz / every as f64;
            assert!((own_hz.unwrap() - expected_hz).abs() < 1e-6, "{rate_hz} {every}");
            are_on_the_line(&rows, 3..rows.len() - every);
            // A receiver's own clock, some rows off, and one of its readings lost.
            let (own_hz, rows) = through(rate_hz, |k| {
                let reading = k / every;
                k % every == (reading * reading) % 3 && reading != 1
            });
            if every < 1000 {
                assert!((own_hz.unwrap() / expected_hz - 1.0).abs() < 0.3, "{rate_hz} {every}");
                are_on_the_line(&rows, 0..rows.len() - every);
            }
        }
        let (_, rows) = through(200.0, |k| k % 10 == 3 && !(2000..2100).contains(&k));
        let missing = rows.iter().filter(|row| row.speed_m_s.is_nan()).count();
        assert!((80..100).contains(&missing), "{missing}");
    }

    #[test]
    fn a_speed_that_comes_late_is_as_good() {
        for every in [1, 10, 200] {
            let (own_hz, rows) = through(200.0, |k| k >= 4500 && k % every == 0);
            let (first, between) = (4500_usize.next_multiple_of(every), every - 1);
            assert_eq!(own_hz.is_some(), every > 1);
            are_on_the_line(&rows, first..rows.len() - between);
            assert!(rows[..first - between.min(first)].iter().all(|row| row.speed_m_s.is_nan()));
        }
    }

    #[test]
    fn a_speed_in_every_row_is_left_as_it_is_and_one_by_chance_has_no_rate() {
        let (rate_hz, rows) = through(200.0, |k| k % 7 != 0);
        assert_eq!(rate_hz, None);
        assert!(rows.iter().enumerate().all(|(k, row)| row.speed_m_s.is_nan() == (k % 7 == 0)));
        let mut even = 0;
        for seed in 0..200_u64 {
            let chance = |k: usize| {
                let mixed = (seed * 100_003 + k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                (mixed ^ (mixed >> 32)).is_multiple_of([20, 100, 500][(seed % 3) as usize])
            };
            even += usize::from(through(200.0, chance).0.is_some());
        }
        // One in a hundred, and three times its square root.
        assert!(even <= 6, "{even} of 200");
    }
}
