//! Numbers that stand for no value, as -9999 or 655.35 do: one that comes again and again, far from all else that a column has.
//!
//! Called with the first rows of a table, and then with every row: such a value is taken out, counted and named. The check of units asks, too.

use super::slot::{RawRow, Slot};

/// How often it comes at least.
const FEWEST: u64 = 3;
/// How far from the median it lies, in what the farthest of the others does, and in m/s² or m/s.
const FAR: f64 = 10.0;
const FAR_SI: f64 = 50.0;
/// Share of an acceleration's values that it is at most.
const RARE: f64 = 0.01;
const MOST: usize = 3;

/// The numbers of a table that are no values, and how often they came. See the [module](self).
#[derive(Debug, Default)]
pub(super) struct StandIns(Vec<(Slot, f64, u64)>);

impl StandIns {
    pub(super) fn of<'a>(rows: impl Iterator<Item = &'a RawRow> + Clone) -> Self {
        let mut found = Vec::new();
        for slot in Slot::all().filter(|slot| slot.is_acceleration() || *slot == Slot::Speed) {
            let mut values: Vec<f64> =
                rows.clone().map(|row| row[slot.index()]).filter(|value| value.is_finite()).collect();
            values.sort_unstable_by(f64::total_cmp);
            for _ in 0..MOST {
                let Some(value) = stand_in(&values) else { break };
                let before = values.len();
                values.retain(|other| *other != value);
                // More is the units' to refuse: someone should look at such a sensor.
                let is_rare = (before - values.len()) as f64 <= RARE * before as f64;
                if is_rare || slot == Slot::Speed {
                    found.push((slot, value, 0));
                }
            }
        }
        Self(found)
    }

    pub(super) fn take_out(&mut self, row: &mut RawRow) {
        for (slot, value, count) in &mut self.0 {
            if row[slot.index()] == *value {
                row[slot.index()] = f64::NAN;
                *count += 1;
            }
        }
    }

    pub(super) fn sentences(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|(slot, value, count)| {
            format!(
                "column {} is {value} in {count} rows, far from all else it has, as where a number stands for no value: taken as missing",
                slot.name()
            )
        })
    }
}

/// The least or the largest of sorted values, if it is none.
pub(super) fn stand_in(sorted: &[f64]) -> Option<f64> {
    let (low, high) = (*sorted.first()?, *sorted.last()?);
    let median = sorted[sorted.len() / 2];
    let off = |value: f64| (value - median).abs();
    let others = sorted.iter().filter(|other| ![low, high].contains(other));
    let farthest = others.map(|other| off(*other)).fold(0.0, f64::max);
    let comes = |value: f64| sorted.iter().filter(|other| **other == value).count() as u64;
    [low, high]
        .into_iter()
        .find(|&value| comes(value) >= FEWEST && off(value) > FAR_SI && off(value) >= FAR * farthest)
}

#[cfg(test)]
mod tests {
    use super::super::slot::SLOTS;
    use super::*;

    fn found(value: impl Fn(usize) -> f64) -> Vec<f64> {
        let slot = Slot::all().find(|slot| slot.is_acceleration()).unwrap();
        let rows: Vec<RawRow> = (0..4000)
            .map(|k| {
                let mut row = [f64::NAN; SLOTS];
                row[slot.index()] = value(k);
                row
            })
            .collect();
        StandIns::of(rows.iter()).0.iter().map(|(_, value, _)| *value).collect()
    }

    #[test]
    fn what_comes_again_far_from_all_else_is_no_value() {
        let wheel = |k: usize| 20.0 * (k as f64 * 0.377).sin();
        assert_eq!(found(wheel), [0.0; 0]);
        for stand_in in [-9999.0, 655.35, -999.25, 1e30, f64::MAX] {
            assert_eq!(found(|k| if k % 200 == 7 { stand_in } else { wheel(k) }), [stand_in]);
            assert_eq!(found(|k| if k == 7 { stand_in } else { wheel(k) }), [0.0; 0]);
        }
        let two = |k: usize| if k.is_multiple_of(300) { -9999.0 } else { 9999.0 };
        let mut both = found(|k| if k % 100 == 0 { two(k) } else { wheel(k) });
        both.sort_by(f64::total_cmp);
        assert_eq!(both, [-9999.0, 9999.0]);
        // A sensor at the end of its range, and a bump in a car that stands.
        assert_eq!(found(|k| (4.0 * wheel(k)).clamp(-60.0, 60.0)), [0.0; 0]);
        assert_eq!(found(|k| if k % 500 < 3 { 5.0 } else { 0.01 * wheel(k) }), [0.0; 0]);
    }
}
