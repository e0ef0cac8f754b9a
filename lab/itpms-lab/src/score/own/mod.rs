//! An owner's whole path: a file by `itpms vehicle init`, ten minutes at placard pressures that are learned from and calibrate, and
//! another day with another road, speed and load, on which a tire loses a fifth or nothing happens.
//!
//! Called by the score. The cars are drawn about cars on the road and not about what such a file says of its own uncertainty; on the later
//! day they may also have changed.
//!
//! | module | idea |
//! |---|---|
//! | `car` | a car, and what its owner knows |
//! | `day` | a day's road, speed and load; what changes between two |
//! | `path` | what the first day teaches, the later day with it |
//! | `seen` | what a day showed by one estimator |

mod car;
mod day;
mod path;
mod seen;

use self::day::{CHANGES, Change};
use self::path::{Owned, Way};
use self::seen::{Seen, Wheel};
use super::row::{Cell, Column, Goal, Row};
use super::stats::percentile;
use crate::runner::{Result, Runner, Turn};

/// Share of a true 95 % interval, over a hundred cars.
const HONEST: Goal = Goal::Between(0.92, 0.98);

/// The cars, and which rows are asked for.
#[derive(Default)]
pub(super) struct Plan {
    subjects: Vec<(Subject, usize)>,
}

struct Subject {
    ways: Vec<Way>,
    changes: Vec<&'static Change>,
    wheel_speeds: bool,
}

/// What one car showed: by way, without a loss and with one, and whether it had its reference; by change.
struct Found {
    ways: Vec<([Seen; 2], bool)>,
    changes: Vec<Seen>,
}

impl Plan {
    /// So many cars; of the rows those whose names contain `only`.
    pub(super) fn new(cars: usize, only: Option<&str>, wheel_speeds: bool) -> Self {
        let wanted = |name: &str| only.is_none_or(|only| name.contains(only));
        let ways: Vec<Way> = Way::ALL.into_iter().filter(|way| wanted(way.label())).collect();
        let changes: Vec<_> = CHANGES.iter().filter(|change| wanted(change.name)).collect();
        let empty = ways.is_empty() && changes.is_empty();
        let subject = Subject { ways, changes, wheel_speeds };
        Self { subjects: vec![(subject, if empty { 0 } else { cars })] }
    }

    pub(super) fn drives(&self) -> u64 {
        self.subjects.iter().map(|(_, cars)| *cars as u64).sum()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>> {
        let found = runner.run(&self.subjects, car)?;
        let mut rows = vec![];
        for ((subject, _), found) in self.subjects.iter().zip(&found) {
            for (i, way) in subject.ways.iter().enumerate() {
                let of_way: Vec<_> = found.iter().map(|one| &one.ways[i]).collect();
                rows.push(Row::of_default("own", way.label(), found.len(), way_cells(&of_way)));
            }
            for (i, change) in subject.changes.iter().enumerate() {
                let seen: Vec<&Seen> = found.iter().map(|one| &one.changes[i]).collect();
                rows.push(Row::of_default("own-changed", change.name, seen.len(), change_cells(&seen)));
            }
        }
        Ok(rows)
    }
}

fn car(subject: &Subject, turn: Turn) -> Result<Found> {
    let mut taught = subject.ways.clone();
    if !subject.changes.is_empty() {
        taught.push(Way::LearnedAndReference);
    }
    let car = Owned::teach(turn.index, turn.seed, &taught, subject.wheel_speeds)?;
    let later = if subject.ways.is_empty() { vec![] } else { car.later(&subject.ways)? };
    let ways = later.into_iter().zip(&subject.ways).map(|(seen, way)| (seen, car.has_reference(*way)));
    let changes = subject.changes.iter().map(|change| car.changed(change));
    Ok(Found { ways: ways.collect(), changes: changes.collect::<Result<_, _>>()? })
}

const RMS: Column = Column::new("rms_kpa", "rms", 1);
const SD: Column = Column::new("sd_kpa", "sd", 1);
const INSIDE: Column = Column::new("inside", "inside", 3);
const VALID: Column = Column::new("valid", "valid", 3);

fn way_cells(found: &[&([Seen; 2], bool)]) -> Vec<Cell> {
    const WORST_RMS: Column = Column::new("worst_rms_kpa", "worst rms", 1);
    const INSIDE_WORST: Column = Column::new("inside_worst", "worst", 3);
    const INSIDE_LOSS: Column = Column::new("inside_in_loss", "in loss", 3);
    const AFTER: Column = Column::new("after_median_s", "after s", 1);
    const AFTER_WORST: Column = Column::new("after_worst_s", "worst", 1);
    const MISSED: Column = Column::new("missed", "missed", 0);
    const FALSE: Column = Column::new("false", "false", 0);
    const RISE: Column = Column::new("rise_kpa", "rise", 1);
    const NO_REFERENCE: Column = Column::new("without_reference", "no ref", 0);
    let sound: Vec<&Seen> = found.iter().map(|(seen, _)| &seen[0]).collect();
    let losing: Vec<&Seen> = found.iter().map(|(seen, _)| &seen[1]).collect();
    let level = Level::of(&sound);
    let after: Vec<f64> = losing.iter().filter_map(|seen| seen.after_s).collect();
    let is_false = |(seen, _): &&&([Seen; 2], bool)| seen.iter().any(Seen::is_false_low);
    vec![
        RMS.plain(level.rms_kpa),
        WORST_RMS.plain(level.worst_rms_kpa),
        SD.plain(level.sd_kpa),
        INSIDE.judged(level.inside, HONEST),
        INSIDE_WORST.plain(level.inside_worst),
        INSIDE_LOSS.judged(Level::of(&losing).inside, HONEST),
        VALID.plain(level.valid),
        // A loss that is not warned of is the latest of all.
        AFTER.judged(
            percentile(&losing.iter().map(|seen| seen.after_s.unwrap_or(f64::NAN)).collect::<Vec<_>>(), 0.5),
            Goal::AtMost(4.0),
        ),
        AFTER_WORST.judged(percentile(&after, 1.0), Goal::AtMost(15.0)),
        MISSED.judged((losing.len() - after.len()) as f64, Goal::AtMost(0.0)),
        FALSE.judged(found.iter().filter(is_false).count() as f64, Goal::AtMost(0.0)),
        RISE.judged(losing.iter().map(|seen| seen.rise_kpa).fold(0.0, f64::max), Goal::AtMost(8.0)),
        NO_REFERENCE.plain(found.iter().filter(|(_, reference)| !reference).count() as f64),
    ]
}

fn change_cells(found: &[&Seen]) -> Vec<Cell> {
    const FINE: Column = Column::new("fine", "fine", 3);
    const LOW: [Column; 4] = [
        Column::new("false_low_fl", "low fl", 0),
        Column::new("false_low_fr", "fr", 0),
        Column::new("false_low_rl", "rl", 0),
        Column::new("false_low_rr", "rr", 0),
    ];
    const ALL_LOW: Column = Column::new("false_all_low", "all low", 0);
    const OVER: Column = Column::new("said_over", "over", 0);
    const SENSOR: Column = Column::new("said_sensor", "sensor", 0);
    let level = Level::of(found);
    let count = |is: &dyn Fn(&Seen) -> bool| found.iter().filter(|seen| is(seen)).count() as f64;
    let mut cells = vec![
        RMS.plain(level.rms_kpa),
        SD.plain(level.sd_kpa),
        INSIDE.plain(level.inside),
        VALID.plain(level.valid),
        FINE.plain(level.fine),
    ];
    cells.extend(
        LOW.iter()
            .enumerate()
            .map(|(i, low)| low.judged(count(&|seen| seen.wheels[i].false_low), Goal::AtMost(0.0))),
    );
    cells.extend([
        ALL_LOW.plain(count(&|seen| seen.all_low)),
        OVER.plain(count(&|seen| seen.over)),
        SENSOR.plain(count(&|seen| seen.sensor)),
    ]);
    cells
}

/// Levels of many drives together, every valid row of a wheel counting alike.
struct Level {
    rms_kpa: f64,
    worst_rms_kpa: f64,
    sd_kpa: f64,
    inside: f64,
    inside_worst: f64,
    valid: f64,
    fine: f64,
}

impl Level {
    fn of(drives: &[&Seen]) -> Self {
        let wheels: Vec<&Wheel> = drives.iter().flat_map(|seen| &seen.wheels).collect();
        let counted = |wheel: &&&Wheel| wheel.errors.count() > 0;
        let known: Vec<&Wheel> = wheels.iter().filter(counted).copied().collect();
        let count: f64 = known.iter().map(|wheel| wheel.errors.count() as f64).sum();
        let mean = |of: &dyn Fn(&Wheel) -> f64| {
            known.iter().map(|wheel| wheel.errors.count() as f64 * of(wheel)).sum::<f64>() / count
        };
        let sum = |of: &dyn Fn(&Wheel) -> u64| wheels.iter().map(|wheel| of(wheel)).sum::<u64>() as f64;
        let rows = sum(&|wheel| wheel.rows);
        Self {
            rms_kpa: mean(&|wheel| wheel.errors.rmse().powi(2)).sqrt(),
            worst_rms_kpa: known.iter().map(|wheel| wheel.errors.rmse()).fold(0.0, f64::max),
            sd_kpa: known.iter().map(|wheel| wheel.sds).sum::<f64>() / count,
            inside: mean(&|wheel| wheel.errors.coverage()),
            inside_worst: known.iter().map(|wheel| wheel.errors.coverage()).fold(1.0, f64::min),
            valid: sum(&|wheel| wheel.valid) / rows,
            fine: sum(&|wheel| wheel.fine) / rows,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::Corner;

    /// Two drives whose wheels are off by 3 and 4 kPa with an sd of 1.8: the first inside, the second not.
    #[test]
    fn levels_count_every_row_alike_and_a_loss_that_is_not_warned_of_is_the_latest() {
        let drive = |error_kpa: f64, rows: u64| {
            let mut seen = Seen::sound();
            for wheel in &mut seen.wheels {
                (0..rows).for_each(|_| wheel.errors.push(error_kpa, 1.8));
                (wheel.rows, wheel.valid, wheel.sds) = (2 * rows, rows, 1.8 * rows as f64);
            }
            seen
        };
        let losing = |after_s| Seen { after_s, rise_kpa: 3.0, ..Seen::losing(Corner::RearLeft) };
        let mut wrong = losing(None);
        wrong.wheels[1].false_low = true;
        let found = [([drive(3.0, 30), losing(Some(2.0))], true), ([drive(4.0, 10), wrong], false)];
        let cells = way_cells(&found.iter().collect::<Vec<_>>());
        let value = |name: &str| cells.iter().find(|cell| cell.column.name == name).unwrap().value;
        assert!((value("rms_kpa") - ((3.0 * 9.0 + 16.0) / 4.0f64).sqrt()).abs() < 1e-12);
        assert!((value("sd_kpa") - 1.8).abs() < 1e-12);
        assert_eq!([value("inside"), value("inside_worst"), value("valid")], [0.75, 0.0, 0.5]);
        assert_eq!([value("missed"), value("false"), value("without_reference")], [1.0; 3]);
        assert_eq!([value("after_worst_s"), value("rise_kpa")], [2.0, 3.0]);
        assert!(value("after_median_s").is_infinite());
        let changed = change_cells(&found.iter().map(|(seen, _)| &seen[1]).collect::<Vec<_>>());
        let low: Vec<f64> = changed
            .iter()
            .filter(|cell| cell.column.name.starts_with("false_low"))
            .map(|cell| cell.value)
            .collect();
        assert_eq!(low, [0.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn rows_are_chosen_by_their_names() {
        let plan = |only| Plan::new(3, only, false);
        assert_eq!(plan(Some("reference")).subjects[0].0.ways.len(), 2);
        assert_eq!(plan(Some("dampers")).subjects[0].0.changes.len(), 2);
        assert_eq!(plan(None).drives(), 3);
        assert_eq!(plan(Some("zzz")).drives(), 0);
    }
}
