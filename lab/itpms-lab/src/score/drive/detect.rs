//! How soon a loss of a fifth is warned of, and whether the right wheel is named: by the monitor as it is shipped.
//!
//! Called by the plan of the four-wheel parts. Speed, road, wheel, kind of car and how fast the tire goes down change from drive to drive.

use itpms_core::model::Corner;
use itpms_sim::road::{RoadClass, RoadSpec};
use itpms_sim::time_profile::{Pressure, Speed};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::super::row::{Column, Goal, Row};
use super::super::stats::percentile;
use super::{Drive, Plant, Setup};
use crate::runner::{Result, Runner, Turn};
use itpms_sim::simulation::Simulation;

const FROM_KPA: f64 = 241.3;
const TO_KPA: f64 = 0.8 * FROM_KPA;
const CLASSES: [RoadClass; 4] = [RoadClass::A, RoadClass::B, RoadClass::C, RoadClass::D];
const SPEED_KM_H: [f64; 2] = [20.0, 120.0];
/// Seconds driven after a warning, to see whether more is reported.
const AFTER_S: f64 = 20.0;

#[derive(Debug, Clone, Copy, PartialEq)]
struct Loss {
    name: &'static str,
    /// All four or, from drive to drive, the next one.
    all: bool,
    begins_s: f64,
    /// How long it takes, in s: drawn in between.
    takes_s: [f64; 2],
    /// How long a warning is waited for once the loss is complete, in s.
    wait_s: f64,
    rate_hz: f64,
    /// Longest time in s that a warning may take.
    goal_s: f64,
    drives_per_seed: f64,
}

const ONE: Loss = Loss {
    name: "one wheel",
    all: false,
    begins_s: 30.0,
    takes_s: [2.5, 10.0],
    wait_s: 60.0,
    rate_hz: 500.0,
    goal_s: 3.0,
    drives_per_seed: 5.0,
};

const ALL_IN_A_MINUTE: Loss = Loss {
    name: "all four in a minute",
    all: true,
    begins_s: 120.0,
    takes_s: [60.0, 60.0],
    wait_s: 330.0,
    rate_hz: 200.0,
    goal_s: 300.0,
    drives_per_seed: 0.5,
};

const ALL_IN_AN_HOUR: Loss =
    Loss { name: "all four in an hour", takes_s: [3600.0, 3600.0], drives_per_seed: 0.1, ..ALL_IN_A_MINUTE };

#[derive(Debug, Clone, Copy, PartialEq)]
struct Found {
    plant: Plant,
    class: RoadClass,
    km_h: f64,
    /// Seconds from the complete loss to the warning; infinite if it did not come.
    after_s: f64,
    wrong: bool,
    /// Whether something was reported before the loss began.
    early: bool,
}

#[derive(Default)]
pub(super) struct Plan {
    cases: Vec<((Loss, Setup), usize)>,
}

impl Plan {
    pub(super) fn new(seeds: usize, only: Option<&str>) -> Self {
        let mut cases = vec![];
        for (loss, setups) in [
            (ONE, &[Setup::USUAL][..]),
            (ALL_IN_A_MINUTE, &[Setup::USUAL, Setup::RESET]),
            (ALL_IN_AN_HOUR, &[Setup::USUAL, Setup::RESET]),
        ] {
            for &setup in setups {
                if only.is_none_or(|only| name(&loss, &setup).contains(only)) {
                    let drives = (loss.drives_per_seed * seeds as f64).ceil() as usize;
                    cases.push(((loss, setup), drives));
                }
            }
        }
        Self { cases }
    }

    pub(super) fn drives(&self) -> u64 {
        self.cases.iter().map(|(_, drives)| *drives as u64).sum()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>> {
        let found = runner.run(&self.cases, |(loss, setup), turn| drive(loss, setup, turn))?;
        let mut rows = vec![];
        for (((loss, setup), _), found) in self.cases.iter().zip(&found) {
            let all = name(loss, setup);
            rows.push(row(all.clone(), loss, found));
            if !loss.all {
                rows.extend(parts(&all, loss, found));
            }
        }
        Ok(rows)
    }
}

fn name(loss: &Loss, setup: &Setup) -> String {
    if setup.label.is_empty() { loss.name.to_owned() } else { format!("{}, {}", loss.name, setup.label) }
}

/// The same drives by kind of car, class and speed.
fn parts(all: &str, loss: &Loss, found: &[Found]) -> Vec<Row> {
    let mut rows = vec![];
    let mut part = |what: String, belongs: &dyn Fn(&Found) -> bool| {
        let found: Vec<Found> = found.iter().copied().filter(|one| belongs(one)).collect();
        if !found.is_empty() {
            rows.push(row(format!("{all}, {what}"), loss, &found));
        }
    };
    for plant in Plant::ALL {
        part(plant.label().to_owned(), &|found| found.plant == plant);
    }
    for class in CLASSES {
        part(format!("class {class}"), &|found| found.class == class);
    }
    for [from, to] in [[20.0, 50.0], [50.0, 80.0], [80.0, 120.0]] {
        part(format!("{from} to {to} km/h"), &|found| found.km_h >= from && found.km_h < to);
    }
    rows
}

fn row(name: String, loss: &Loss, found: &[Found]) -> Row {
    const MEDIAN: Column = Column::new("after_median_s", "median s", 1);
    const P90: Column = Column::new("after_p90_s", "p90", 1);
    const WORST: Column = Column::new("after_worst_s", "worst", 1);
    const WITHIN: Column = Column::new("share_within_goal", "in time", 3);
    const MISSED: Column = Column::new("missed", "missed", 0);
    const WRONG: Column = Column::new("wrong_wheels", "wrong wheel", 0);
    const EARLY: Column = Column::new("early", "early", 0);
    let after: Vec<f64> = found.iter().map(|one| one.after_s).collect();
    let count = |what: &dyn Fn(&Found) -> bool| found.iter().filter(|one| what(one)).count() as f64;
    let within = count(&|one| one.after_s <= loss.goal_s) / found.len() as f64;
    let cells = vec![
        MEDIAN.plain(percentile(&after, 0.5)),
        P90.plain(percentile(&after, 0.9)),
        WORST.judged(percentile(&after, 1.0), Goal::AtMost(loss.goal_s)),
        WITHIN.plain(within),
        MISSED.judged(count(&|one| one.after_s.is_infinite()), Goal::AtMost(0.0)),
        WRONG.judged(count(&|one| one.wrong), Goal::AtMost(0.0)),
        EARLY.judged(count(&|one| one.early), Goal::AtMost(0.0)),
    ];
    Row::of_default("detection", name, found.len(), cells)
}

/// The drive of a turn: wheels, classes and cars in turn, speeds and times at random.
fn composed(loss: &Loss, turn: Turn) -> Result<(Drive, Found, f64)> {
    let mut random = Pcg64::seed_from_u64(turn.seed);
    let mut between = |[low, high]: [f64; 2]| low + (high - low) * random.random::<f64>();
    let (km_h, takes_s) = (between(SPEED_KM_H), between(loss.takes_s));
    let (struck, class) = (Corner::ALL[turn.index % 4], CLASSES[turn.index / 4 % 4]);
    // All four are few: cars take turns, classes with them.
    let (class, plant) = match loss.all {
        false => (class, Plant::ALL[turn.index / 16 % 2]),
        true => (CLASSES[turn.index % 4], Plant::ALL[turn.index % 2]),
    };
    let mut drive = Drive::puncture(plant, km_h)?.each_corner(|corner, spec| {
        spec.pressure = if loss.all || corner == struck {
            Pressure::ramp(FROM_KPA, TO_KPA, loss.begins_s, takes_s)
        } else {
            Pressure::ConstantKpa(FROM_KPA)
        };
    });
    drive.struck = struck;
    let scenario = &mut drive.scenario;
    scenario.rate_hz = loss.rate_hz;
    scenario.duration_s = loss.begins_s + takes_s + loss.wait_s;
    scenario.speed = Speed::ConstantKmH(km_h);
    let contact_length_m = 0.1;
    scenario.road = RoadSpec { contact_length_m, ..RoadSpec::iso8608(class, 2.0) };
    let found = Found { plant, class, km_h, after_s: f64::INFINITY, wrong: false, early: false };
    Ok((drive, found, loss.begins_s + takes_s))
}

fn drive(loss: &Loss, setup: &Setup, turn: Turn) -> Result<Found> {
    let (drive, mut found, complete_s) = composed(loss, turn)?;
    let drive = drive.with_setups(&[*setup]);
    let Some(mut car) = drive.cars(&drive.scenario)?.pop() else { return Ok(found) };
    for row in Simulation::new(&drive.scenario, turn.seed)? {
        car.update(&row.car_sample());
        for alert in car.report().alerts() {
            found.early |= row.time_s < loss.begins_s;
            if alert.cause.is_low() {
                let right = loss.all || alert.wheels.contains(drive.struck);
                // "All four" names the right one among others.
                found.wrong |= !loss.all && alert.wheels != drive.struck.into();
                if right && found.after_s.is_infinite() {
                    found.after_s = row.time_s - complete_s;
                }
            }
        }
        if row.time_s > complete_s.max(complete_s + found.after_s) + AFTER_S {
            break;
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runner::UNWATCHED;

    #[test]
    fn drives_differ_in_all_they_should() {
        let drives: Vec<(Drive, Found, f64)> =
            (0..200).map(|index| composed(&ONE, Turn { index, seed: 1 + index as u64 }).unwrap()).collect();
        for plant in Plant::ALL {
            for class in CLASSES {
                for corner in Corner::ALL {
                    let is_one = |(drive, found, _): &&(Drive, Found, f64)| {
                        drive.struck == corner && found.class == class && found.plant == plant
                    };
                    assert!(drives.iter().filter(is_one).count() >= 6);
                }
            }
        }
        for (drive, found, complete_s) in &drives {
            drive.scenario.validate().unwrap();
            assert!((20.0..120.0).contains(&found.km_h) && (32.5..=40.0).contains(complete_s));
            assert_eq!(drive.scenario.car.is_some(), found.plant == Plant::Car);
            let down = |corner| {
                matches!(drive.scenario.corner.get(corner).unwrap().pressure, Pressure::PointsSKpa(_))
            };
            assert!(Corner::ALL.into_iter().all(|corner| down(corner) == (corner == drive.struck)));
        }
        let mean = drives.iter().map(|(_, found, _)| found.km_h).sum::<f64>() / 200.0;
        // 100/sqrt(12) km/h over 200 drives: sd 2.
        assert!((mean - 70.0).abs() < 7.0, "{mean}");
    }

    #[test]
    fn misses_wrong_wheels_and_late_warnings_are_counted() {
        let one = Found {
            plant: Plant::Car,
            class: RoadClass::A,
            km_h: 30.0,
            after_s: 1.0,
            wrong: false,
            early: false,
        };
        let found = [
            one,
            Found { after_s: f64::INFINITY, km_h: 90.0, ..one },
            Found { after_s: 7.0, wrong: true, class: RoadClass::C, ..one },
            Found { after_s: -0.5, early: true, ..one },
        ];
        let row = row("all".to_owned(), &ONE, &found);
        let value = |name: &str| row.cell(name).unwrap().value;
        assert_eq!((value("missed"), value("wrong_wheels"), value("early")), (1.0, 1.0, 1.0));
        assert_eq!((value("after_median_s"), value("share_within_goal")), (4.0, 0.5));
        assert!(value("after_worst_s").is_infinite());
        let names: Vec<String> = parts("all", &ONE, &found).into_iter().map(|row| row.name).collect();
        assert_eq!(
            names,
            ["all, car", "all, class A", "all, class C", "all, 20 to 50 km/h", "all, 80 to 120 km/h"]
        );
    }

    /// A tire that is a fifth low is warned of, and not before it is.
    #[test]
    fn a_drive_is_judged() {
        let plan = Plan::new(1, Some("minute, reset"));
        assert_eq!((plan.cases.len(), plan.drives()), (1, 1));
        let short = Loss { begins_s: 20.0, takes_s: [5.0, 5.0], wait_s: 5.0, rate_hz: 200.0, ..ONE };
        let runner = Runner::new(1, 1, UNWATCHED);
        let cases = [((), 1)];
        let found = runner.run(&cases, |(), turn| drive(&short, &Setup::USUAL, turn)).unwrap();
        let one = &found[0][0];
        assert!(one.class == RoadClass::A && !one.early && !one.wrong && one.after_s < 3.0, "{one:?}");
    }

    /// Class D at 80 km/h and more: each wheel is in the air for a tenth of the time and longer.
    #[test]
    fn wheels_in_the_air_hide_no_loss() {
        let short = Loss { begins_s: 20.0, takes_s: [5.0, 5.0], wait_s: 20.0, ..ONE };
        let fast = |turn: &Turn| {
            let (_, found, _) = composed(&short, *turn).unwrap();
            found.class == RoadClass::D && found.plant == Plant::Car && found.km_h > 80.0
        };
        let turns = (0..400).map(|i| Turn { index: i % 32, seed: 1000 + i as u64 }).filter(fast);
        let cases: Vec<(Turn, usize)> = turns.take(3).map(|turn| (turn, 1)).collect();
        let found = Runner::new(1, 2, UNWATCHED)
            .run(&cases, |turn, _| drive(&short, &Setup::USUAL, *turn))
            .unwrap()
            .concat();
        assert_eq!(found.len(), 3);
        // The goal is 3 s; one drive in twenty takes longer.
        assert!(found.iter().all(|one| one.after_s < 15.0 && !one.wrong && !one.early), "{found:?}");
    }
}
