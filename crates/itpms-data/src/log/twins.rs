//! Columns of accelerations that are one: a table in which a column was copied over another one. Its wheel seems to be what the
//! other one is, and where that differs from its neighbors it seems to be low.
//!
//! Called by the reader with the rows that it looks ahead; two sensors' noise differs in every row.

use std::collections::VecDeque;

use super::row::{LogColumns, LogRow};
use super::slot::Slot;

/// Different values that a column has at least, to be more than a sensor that stands still.
const DIFFERENT: usize = 10;

pub(super) fn of(rows: &VecDeque<LogRow>, columns: &LogColumns) -> Vec<(String, String)> {
    let slots: Vec<Slot> =
        columns.slots().filter(|slot| slot.is_acceleration()).filter(|slot| changes(rows, *slot)).collect();
    let mut twins = Vec::new();
    for (place, one) in slots.iter().enumerate() {
        let same = |row: &LogRow, other: Slot| row.value(*one).to_bits() == row.value(other).to_bits();
        let others = slots[place + 1..].iter().filter(|other| rows.iter().all(|row| same(row, **other)));
        twins.extend(others.map(|other| (one.name(), other.name())));
    }
    twins
}

fn changes(rows: &VecDeque<LogRow>, slot: Slot) -> bool {
    let values = rows.iter().map(|row| row.value(slot)).filter(|value| value.is_finite());
    let pairs = values.clone().zip(values.skip(1));
    pairs.filter(|(before, after)| before != after).take(DIFFERENT).count() == DIFFERENT
}

#[cfg(test)]
mod tests {
    use itpms_core::model::Corner;

    use super::*;
    use crate::log::row::LogCorner;
    use crate::log::slot::SLOTS;

    /// Rows whose wheels move by `wheel`, of the corner and the row.
    fn found(wheel: impl Fn(usize, usize) -> f64) -> Vec<(String, String)> {
        let slots: Vec<Slot> = Slot::all().collect();
        let columns = LogColumns::of(&slots[..SLOTS]);
        let corner =
            |c: usize, i: usize| LogCorner::measured(0.3 * wheel(c, i) + (c * i) as f64, wheel(c, i));
        let row = |i: usize| {
            LogRow::without_motion(i as f64, 20.0, Corner::ALL.map(|c| Some(corner(c.index(), i))))
        };
        of(&(0..50).map(row).collect(), &columns)
    }

    #[test]
    fn a_copied_column_is_named_and_a_sensor_that_stands_still_is_none() {
        let noise = |c: usize, i: usize| ((7 * c + 13 * i * i) % 29) as f64;
        assert_eq!(found(noise), []);
        let copied = found(|c, i| noise(c.min(2), i));
        assert_eq!(copied, [("rl_wheel_accel_m_s2".to_owned(), "rr_wheel_accel_m_s2".to_owned())]);
        assert_eq!(found(|c, i| if c < 2 { 0.0 } else { noise(c, i) }), []);
    }
}
