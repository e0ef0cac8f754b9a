//! Samples that were written several times: a slow signal in the raster of a faster one, where each value stands until the next one comes.
//!
//! Called with the first rows of a table, and then with every row. A value that only stands there is taken out, so that the column has
//! its sensor's rate, as one with empty cells between its samples has. So it is with a speed, which then lies on the line between its
//! readings ([`slow_speed`](super::slow_speed)).

use super::slot::{RawRow, Slot};

/// Samples that a column has before it is judged; a speed's are further apart, so that fewer are no chance.
const ENOUGH: usize = 64;
const ENOUGH_OF_SPEED: usize = 8;
/// Share of the rows in which a column changes at most.
const CHANGES: f64 = 0.6;
/// A run longer than this many usual ones holds two samples that are the same by chance.
const LONG: f64 = 1.5;
/// Share of the runs that are as long as the others, within one row or this share of them.
const REGULAR: f64 = 0.85;
const NEAR: f64 = 0.1;

#[derive(Debug, Clone, Copy)]
struct Column {
    slot: Slot,
    /// Rows for which a value stands at most.
    most: usize,
    last: f64,
    since: usize,
}

/// The accelerations and the speed of a table that are held. See the [module](self).
#[derive(Debug, Default)]
pub(super) struct Held(Vec<Column>);

impl Held {
    /// Of a table that begins with these rows.
    pub(super) fn of<'a>(rows: impl Iterator<Item = &'a RawRow> + Clone) -> Self {
        let column = |slot: Slot| {
            let enough = if slot == Slot::Speed { ENOUGH_OF_SPEED } else { ENOUGH };
            let most = longest_run(rows.clone().map(|row| row[slot.index()]), enough)?;
            Some(Column { slot, most, last: f64::NAN, since: 0 })
        };
        let may_be = |slot: &Slot| slot.is_acceleration() || *slot == Slot::Speed;
        Self(Slot::all().filter(may_be).filter_map(column).collect())
    }

    pub(super) fn is_any_acceleration(&self) -> bool {
        self.0.iter().any(|column| column.slot.is_acceleration())
    }

    /// Takes out what only stands there.
    pub(super) fn thin(&mut self, row: &mut RawRow) {
        for Column { slot, most, last, since } in &mut self.0 {
            let value = &mut row[slot.index()];
            *since += 1;
            if *value == *last && *since < *most {
                *value = f64::NAN;
            } else if value.is_finite() {
                (*last, *since) = (*value, 0);
            }
        }
    }
}

/// For how many rows a sample stands, if all do for as long.
fn longest_run(values: impl Iterator<Item = f64>, enough: usize) -> Option<usize> {
    let (mut runs, mut last, mut length) = (Vec::new(), f64::NAN, 0usize);
    for value in values {
        if value.is_nan() {
            return None;
        }
        length += 1;
        if value != last {
            runs.push(length);
            (last, length) = (value, 0);
        }
    }
    // The first one began with the file.
    let runs = runs.get(1..).filter(|runs| runs.len() >= enough)?;
    let mut sorted = runs.to_vec();
    sorted.sort_unstable();
    let median = sorted[sorted.len() / 2] as f64;
    let usual = &sorted[..sorted.partition_point(|run| *run as f64 <= LONG * median)];
    let mean = usual.iter().sum::<usize>() as f64 / usual.len() as f64;
    let even = usual.iter().filter(|run| (**run as f64 - mean).abs() < (NEAR * mean).max(1.0)).count();
    let is_held = mean * CHANGES >= 1.0 && even as f64 >= REGULAR * runs.len() as f64;
    usual.last().copied().filter(|_| is_held)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a sensor whose steps are a hundredth of its reading.
    fn sample(k: usize) -> f64 {
        ((k as f64 * 0.37).sin() * 40.0 + (k as f64 * 1.9).cos() * 20.0).round() / 10.0
    }

    #[test]
    fn values_that_stand_have_one_length() {
        assert_eq!(longest_run((0..4096).map(|k| sample(k / 4)), ENOUGH), Some(4));
        // 200 Hz in 500.
        assert_eq!(longest_run((0..4096).map(|k| sample(2 * k / 5)), ENOUGH), Some(3));
        assert_eq!(longest_run((0..4096).map(sample), ENOUGH), None);
        // A sensor so coarse that it shows the same for a while.
        assert_eq!(longest_run((0..4096).map(|k| (f64::from(k) * 0.01).sin().round()), ENOUGH), None);
        assert_eq!(longest_run((0..4096).map(|k| ((k as f64 * 0.013).sin() * 5.0).round()), ENOUGH), None);
    }

    #[test]
    fn each_sample_stays_once_even_where_two_are_the_same() {
        let slot = Slot::all().find(|slot| slot.is_acceleration()).unwrap();
        let rows: Vec<RawRow> = (0..4096)
            .map(|k| {
                let mut row = [f64::NAN; super::super::slot::SLOTS];
                row[slot.index()] = sample(if k / 4 == 100 { 99 } else { k / 4 });
                row
            })
            .collect();
        let mut held = Held::of(rows.iter());
        assert!(held.is_any_acceleration());
        let left = rows.into_iter().enumerate().filter_map(|(k, mut row)| {
            held.thin(&mut row);
            row[slot.index()].is_finite().then_some(k)
        });
        assert!(left.eq((0..4096).step_by(4)));
    }
}
