//! What ten minutes at known pressures teach of a car: parameters, the pressure of a later drive, losses of a fifth in it.
//!
//! Called by the plan of the four-wheel parts.

use itpms_core::model::{CarConfig, CarEstimate, Corner, VehicleCalibration};
use itpms_core::warning::MonitorReport;
use itpms_sim::simulation::{SimRow, Simulation};
use itpms_sim::time_profile::Pressure;

use super::super::row::{Cell, Column, Goal, Row};
use super::super::stats::{ValidErrors, percentile};
use super::learned_car::{DrawnCar, PLACARD_KPA, Subject, estimator};
use crate::runner::{Result, Runner, Turn};
use itpms_analysis::learn::{LearnedCorner, Parameter};

/// Cars per seed asked for: 200 of forty.
const CARS_PER_SEED: f64 = 5.0;
const LEARNING_S: f64 = 600.0;
/// Seconds of a later drive that do not count; when its loss begins, how long it takes, how long a warning is waited for.
const SETTLED_S: f64 = 30.0;
const LOSS_S: [f64; 3] = [90.0, 10.0, 60.0];
const LEFT: f64 = 0.8;
/// Of a share of 0.95 that is right, what is asked for.
const HONEST: Goal = Goal::Between(0.93, 0.97);

type Named = (&'static str, fn(&LearnedCorner) -> Parameter);

const PARAMETERS: [Named; 6] = [
    ("unsprung mass", |corner| corner.unsprung_mass_kg),
    ("tire", |corner| corner.tire_n_per_m),
    ("tire over unsprung mass", |corner| corner.stiffness_over_mass),
    ("damper", |corner| corner.damping_n_s_per_m),
    ("spring", |corner| corner.spring_n_per_m),
    ("friction", |corner| corner.friction_n),
];

/// Who goes along on the later drive: with the file, with what was learned, and with a reference, too.
const SETUPS: [&str; 3] = ["file", "learned", "learned and reference"];

/// The truth of a parameter beside what was learned of it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Learnt {
    truth: f64,
    parameter: Parameter,
}

/// Outcome of a later drive by one estimator.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Later {
    level: ValidErrors,
    after_s: Option<f64>,
    wrong: bool,
}

struct Found {
    parameters: Vec<Vec<Learnt>>,
    slope: Learnt,
    later: Vec<Option<Later>>,
}

#[derive(Default)]
pub(super) struct Plan {
    subjects: Vec<(Subject, usize)>,
}

impl Plan {
    pub(super) fn new(seeds: usize, only: Option<&str>) -> Self {
        let subject =
            |name, by_size, pressures_kpa| Subject { name, by_size, pressures_kpa, learning_s: LEARNING_S };
        let subjects = [
            subject("typical", false, &[PLACARD_KPA]),
            subject("by size", true, &[PLACARD_KPA]),
            subject("by size, two pressures", true, &[180.0, PLACARD_KPA]),
        ];
        let wanted = |subject: &Subject| only.is_none_or(|only| subject.name == only);
        let cars = (CARS_PER_SEED * seeds as f64) as usize;
        Self { subjects: subjects.into_iter().filter(wanted).map(|subject| (subject, cars)).collect() }
    }

    pub(super) fn drives(&self) -> u64 {
        self.subjects.iter().map(|(_, cars)| *cars as u64).sum()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>> {
        let found = runner.run(&self.subjects, car)?;
        let mut rows = vec![];
        for ((subject, _), found) in self.subjects.iter().zip(&found) {
            for (i, (name, _)) in PARAMETERS.iter().enumerate() {
                let all: Vec<Learnt> = found.iter().flat_map(|one| one.parameters[i].clone()).collect();
                rows.push(parameter_row(subject, name, &all, found.len()));
            }
            let slopes: Vec<Learnt> = found.iter().map(|one| one.slope).collect();
            rows.push(parameter_row(subject, "slope over pressure", &slopes, found.len()));
        }
        for ((subject, _), found) in self.subjects.iter().zip(&found) {
            for (i, setup) in SETUPS.iter().enumerate() {
                let later: Vec<Later> = found.iter().filter_map(|one| one.later[i]).collect();
                let name = format!("{}, {setup}", subject.name);
                rows.push(Row::of_default("learn-later", name, later.len(), later_cells(&later)));
            }
        }
        Ok(rows)
    }
}

fn car(subject: &Subject, turn: Turn) -> Result<Found> {
    let car = DrawnCar::draw(subject, turn.index, turn.seed)?;
    let (learned, calibration) = car.learn(subject)?;
    let corners = || {
        Corner::ALL.into_iter().filter_map(|c| Some((car.truth(c)?, learned.corners[c.index()].as_ref()?)))
    };
    let parameters = PARAMETERS
        .iter()
        .enumerate()
        .map(|(i, (_, of))| {
            corners()
                .map(|(truth, corner)| {
                    let truth = [
                        truth.unsprung_mass_kg,
                        truth.tire_n_per_m,
                        truth.tire_n_per_m / truth.unsprung_mass_kg,
                        truth.damping_n_s_per_m,
                        truth.spring_n_per_m,
                        truth.friction_n,
                    ][i];
                    Learnt { truth, parameter: of(corner) }
                })
                .collect()
        })
        .collect();
    let slope = corners().next().map_or(f64::NAN, |(truth, _)| truth.slope);
    let given = [
        Some((&car.file, None)),
        Some((&learned.car, None)),
        calibration.as_ref().map(|calibration| (&learned.car, Some(calibration))),
    ];
    let later = later(&car, turn, &given)?;
    Ok(Found { parameters, slope: Learnt { truth: slope, parameter: learned.slope }, later })
}

/// What an estimator of the later drive is given: a car, and what an earlier calibration of exactly that car taught.
type Given<'a> = (&'a CarConfig<f64>, Option<&'a VehicleCalibration<f64>>);

/// A later drive on which one tire after the other, from car to car, loses a fifth; estimated by all at once.
fn later(car: &DrawnCar, turn: Turn, given: &[Option<Given<'_>>]) -> Result<Vec<Option<Later>>> {
    let [begins_s, takes_s, wait_s] = LOSS_S;
    let struck = Corner::ALL[turn.index % 4];
    let (mut scenario, seed) = car.later(turn.index + turn.index / 4, begins_s + takes_s + wait_s);
    if let Some(spec) = scenario.corner.get_mut(struck) {
        spec.pressure = Pressure::ramp(PLACARD_KPA, LEFT * PLACARD_KPA, begins_s, takes_s);
    }
    let mut estimators = vec![];
    for given in given {
        estimators.push(match given {
            Some((config, calibration)) => {
                let mut estimator = estimator(config)?;
                calibration.map_or(Ok(()), |calibration| estimator.load_calibration(calibration))?;
                Some((estimator, Later::default()))
            }
            None => None,
        });
    }
    for row in Simulation::new(&scenario, seed)? {
        for (estimator, found) in estimators.iter_mut().flatten() {
            let estimate = estimator.update(&row.car_sample());
            found.hear(row.time_s, struck, estimator.report());
            found.see(&row, &estimate);
        }
    }
    Ok(estimators.into_iter().map(|one| one.map(|(_, found)| found)).collect())
}

impl Later {
    fn hear(&mut self, time_s: f64, struck: Corner, report: &MonitorReport<f64>) {
        let [begins_s, takes_s, _] = LOSS_S;
        for alert in report.alerts().filter(|alert| alert.cause.is_low()) {
            if time_s < begins_s || alert.wheels != struck.into() {
                self.wrong = true;
            } else if self.after_s.is_none() {
                self.after_s = Some(time_s - begins_s - takes_s);
            }
        }
    }

    fn see(&mut self, row: &SimRow, estimate: &CarEstimate<f64>) {
        if !(row.time_s > SETTLED_S && row.time_s < LOSS_S[0]) {
            return;
        }
        for (truth, estimate) in row.corners.iter().zip(&estimate.corners) {
            let (Some(truth), Some(estimate)) = (truth, estimate) else { continue };
            self.level.push(truth.pressure_kpa, estimate);
        }
    }
}

/// Percents of the value that is believed, but friction in N.
fn parameter_row(subject: &Subject, name: &str, all: &[Learnt], cars: usize) -> Row {
    const WITHIN: Column = Column::new("within", "within", 3);
    const BEFORE: Column = Column::new("file_rms", "file rms", 1);
    const AFTER: Column = Column::new("learned_rms", "rms", 1);
    const STATED: Column = Column::new("learned_sd", "sd stated", 1);
    let unit = |value: f64| if name == "friction" { 1.0 } else { 0.01 * value };
    let count = all.len() as f64;
    let rms =
        |of: &dyn Fn(&Learnt) -> f64| (all.iter().map(|one| of(one).powi(2)).sum::<f64>() / count).sqrt();
    let within = |one: &&Learnt| (one.parameter.after - one.truth).abs() <= 1.96 * one.parameter.after_sd;
    let cells = vec![
        WITHIN.judged(all.iter().filter(within).count() as f64 / count, HONEST),
        BEFORE.plain(rms(&|one| (one.parameter.before - one.truth) / unit(one.truth))),
        AFTER.plain(rms(&|one| (one.parameter.after - one.truth) / unit(one.truth))),
        STATED.plain(rms(&|one| one.parameter.after_sd / unit(one.parameter.after))),
    ];
    Row::of_default("learn", format!("{}, {name}", subject.name), cars, cells)
}

fn later_cells(all: &[Later]) -> Vec<Cell> {
    const RMS: Column = Column::new("rms_kpa", "rms", 1);
    const SD: Column = Column::new("sd_kpa", "sd stated", 1);
    const COVERED: Column = Column::new("coverage", "cover", 3);
    const VALID: Column = Column::new("valid", "valid", 3);
    const FOUND: Column = Column::new("found", "found", 0);
    const MISSED: Column = Column::new("missed", "missed", 0);
    const AFTER: Column = Column::new("after_median_s", "after s", 1);
    const FALSE: Column = Column::new("false", "false", 0);
    let levels: Vec<&ValidErrors> = all.iter().map(|one| &one.level).collect();
    let after: Vec<f64> = all.iter().filter_map(|one| one.after_s).collect();
    vec![
        RMS.plain(ValidErrors::rms(&levels)),
        SD.plain(levels.iter().map(|one| one.sds_kpa).sum::<f64>() / ValidErrors::valid(&levels)),
        COVERED.plain(ValidErrors::mean(&levels, |one| one.errors.coverage())),
        VALID.plain(ValidErrors::share_valid(&levels)),
        FOUND.plain(after.len() as f64),
        MISSED.plain((all.len() - after.len()) as f64),
        AFTER.plain(percentile(&after, 0.5)),
        FALSE.plain(all.iter().filter(|one| one.wrong).count() as f64),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_deviations_are_of_the_truth() {
        let subject = Plan::new(1, Some("typical")).subjects[0].0;
        let learnt = |truth: f64| Learnt {
            truth,
            parameter: Parameter { before: 110.0, before_sd: 10.0, after: 104.0, after_sd: 2.0 },
        };
        let row = parameter_row(&subject, "damper", &[learnt(100.0), learnt(102.0)], 2);
        let value = |name: &str| row.cell(name).unwrap().value;
        // 4 of 2 sd are outside, 2 are within.
        assert_eq!(value("within"), 0.5);
        assert!((value("file_rms") - ((100.0 + (8.0f64 / 1.02).powi(2)) / 2.0).sqrt()).abs() < 1e-9);
        assert!((value("learned_sd") - 200.0 / 104.0).abs() < 1e-9);
    }

    #[test]
    fn drawn_cars_scatter_as_their_files_say() {
        let subject = Plan::new(1, Some("by size")).subjects[0].0;
        let mut sums = [0.0f64; 3];
        for seed in 0..400 {
            let car = DrawnCar::draw(&subject, 0, seed).unwrap();
            let (truth, nominal) =
                (car.truth(Corner::RearLeft).unwrap(), car.file.corners[2].unwrap().quarter_car);
            let deviations = [
                truth.unsprung_mass_kg / nominal.unsprung_mass_kg(),
                truth.damping_n_s_per_m / nominal.damping_n_s_per_m(),
                truth.spring_n_per_m / nominal.spring_n_per_m(),
            ];
            sums.iter_mut().zip(deviations).for_each(|(sum, value)| *sum += value.ln().powi(2));
        }
        // Cut at 2.5 sd a normal variance is 0.911 of itself; of 400 its relative sd is 7 %, its root's 3.5.
        for (sum, sd) in sums.into_iter().zip([0.15, 0.30, 0.25]) {
            assert!(((sum / 400.0).sqrt() / (sd * 0.911f64.sqrt()) - 1.0).abs() < 0.1, "{sum} {sd}");
        }
    }
}
