//! A car that is not its file: how far the estimate is off, whether it says so, and whether it warns in time.
//!
//! Called by the plan of the four-wheel parts. Each deviation alone, then together, on roads of classes A, B and C in turn
//! at one speed. Every drive is estimated twice: as it comes, and after a calibration at its start. In a second drive
//! after a calibration one tire after the other loses a fifth.

use itpms_core::model::{CarEstimate, Confidence, Corner};
use itpms_core::warning::{Alert, Cause, Change, MonitorReport};
use itpms_sim::road::{RoadClass, RoadSpec};
use itpms_sim::simulation::{SimRow, Simulation};
use itpms_sim::time_profile::Pressure;

use super::super::row::{Cell, Column, Row};
use super::super::stats::{ValidErrors, percentile};
use super::real_list::{Deviation, LIST};
use super::{Drive, Plant, Setup};
use crate::runner::{Result, Runner, Turn};

const KM_H: f64 = 80.0;
const RATE_HZ: f64 = 200.0;
const CLASSES: [RoadClass; 3] = [RoadClass::A, RoadClass::B, RoadClass::C];
const CALIBRATION_S: f64 = 40.0;
/// The drives end, in s; errors count from the end of the calibration on.
const END_S: f64 = 160.0;
const PLACARD_KPA: f64 = 241.3;
/// A loss: when it begins, how long it takes, how long a warning is waited for, in s; and what is left.
const LOSS_S: [f64; 3] = [60.0, 10.0, 60.0];
const LEFT: f64 = 0.8;

const UNKNOWN: Setup = Setup { label: "", ..Setup::USUAL };
const CALIBRATED: Setup = Setup { label: "calibrated", reset_s: Some(CALIBRATION_S), ..Setup::USUAL };

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Level {
    wheels: [ValidErrors; 4],
    /// Warnings of tires that are as they should be, and of sensors.
    false_low: u32,
    sensors: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Found {
    struck: Corner,
    /// Seconds from the complete loss to the warning of that tire; infinite if none came.
    after_s: f64,
    wrong: bool,
    early: bool,
}

#[derive(Default)]
pub(super) struct Plan {
    levels: Vec<(Subject, usize)>,
    losses: Vec<(Subject, usize)>,
}

#[derive(Debug, Clone, Copy)]
struct Subject {
    deviation: &'static Deviation,
    wheel_speeds: bool,
}

impl Plan {
    pub(super) fn new(seeds: usize, only: Option<&str>, wheel_speeds: bool) -> Self {
        let wanted = |deviation: &&Deviation| only.is_none_or(|only| deviation.name.contains(only));
        let subjects = || LIST.iter().filter(wanted).map(|deviation| Subject { deviation, wheel_speeds });
        Self {
            levels: subjects().map(|subject| (subject, seeds)).collect(),
            losses: subjects().map(|subject| (subject, seeds.max(Corner::ALL.len()))).collect(),
        }
    }

    pub(super) fn drives(&self) -> u64 {
        self.levels.iter().chain(&self.losses).map(|(_, drives)| *drives as u64).sum()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>> {
        let levels = runner.run(&self.levels, levels)?;
        let losses = runner.run(&self.losses, loss)?;
        let mut rows = vec![];
        for (number, setup) in [UNKNOWN, CALIBRATED].into_iter().enumerate() {
            for ((subject, _), levels) in self.levels.iter().zip(&levels) {
                let of_setup: Vec<Level> =
                    levels.iter().filter_map(|found| found.get(number).copied()).collect();
                if of_setup.is_empty() {
                    continue;
                }
                let part = if setup.label.is_empty() { "car" } else { "car-calibrated" };
                let cells = level_cells(subject.deviation, &of_setup);
                rows.push(Row::of_default(part, subject.deviation.name, of_setup.len(), cells));
            }
        }
        for ((subject, _), found) in self.losses.iter().zip(&losses) {
            rows.push(Row::of_default("car-loss", subject.deviation.name, found.len(), loss_cells(found)));
        }
        Ok(rows)
    }
}

/// The deviating car on the road of a turn, its pressures as the placard says but for a tire that is flat from the start.
fn composed(subject: &Subject, turn: Turn, setups: &[Setup]) -> Result<Drive> {
    let mut drive = Drive::puncture(Plant::Car, KM_H)?.with_setups(setups);
    let class = CLASSES[turn.index % CLASSES.len()];
    // Deviations are those of a car that is known as most are.
    drive.scenario.confidence = Confidence::Typical;
    drive.scenario.rate_hz = RATE_HZ;
    drive.scenario.duration_s = END_S;
    drive.scenario.road = RoadSpec { contact_length_m: 0.1, ..RoadSpec::iso8608(class, 2.0) };
    drive.wheel_speeds = subject.wheel_speeds;
    let drive = drive.each_corner(|_, spec| spec.pressure = Pressure::ConstantKpa(PLACARD_KPA));
    Ok((subject.deviation.change)(drive, turn.seed))
}

fn levels(subject: &Subject, turn: Turn) -> Result<Vec<Level>> {
    // No one calibrates on a flat tire.
    let setups: &[Setup] = if subject.deviation.flat.is_some() { &[UNKNOWN] } else { &[UNKNOWN, CALIBRATED] };
    let drive = composed(subject, turn, setups)?;
    let scenario = drive.simulated(turn.seed);
    let mut cars = drive.cars(&scenario)?;
    let mut found = vec![Level::default(); cars.len()];
    let mut before: Vec<MonitorReport<f64>> = cars.iter().map(|car| *car.report()).collect();
    for row in Simulation::new(&scenario, turn.seed)? {
        let sample = row.car_sample();
        for ((car, level), before) in cars.iter_mut().zip(&mut found).zip(&mut before) {
            level.push(&row, &car.update(&sample));
            for change in car.report().changes_since(before) {
                if let Change::Begun(alert) = change {
                    level.hear(&alert, subject.deviation.flat);
                }
            }
            *before = *car.report();
        }
    }
    Ok(found)
}

impl Level {
    fn push(&mut self, row: &SimRow, estimate: &CarEstimate<f64>) {
        if row.time_s <= CALIBRATION_S {
            return;
        }
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            let (Some(truth), Some(estimate)) = (&row.corners[i], &estimate.corners[i]) else { continue };
            wheel.push(truth.pressure_kpa, estimate);
        }
    }

    fn hear(&mut self, alert: &Alert<f64>, flat: Option<Corner>) {
        if alert.cause.is_low() {
            self.false_low += u32::from(flat.is_none_or(|flat| alert.wheels != flat.into()));
        } else {
            self.sensors += u32::from(matches!(alert.cause, Cause::Malfunction(_)));
        }
    }
}

/// A drive of its own for every tire that loses air, after a calibration; where one is flat from the start, that drive
/// without a calibration.
fn loss(subject: &Subject, turn: Turn) -> Result<Found> {
    let flat = subject.deviation.flat;
    let struck = flat.unwrap_or(Corner::ALL[turn.index % 4]);
    // Tires and classes in turn: twelve drives have them all.
    let turn = Turn { index: turn.index / 4 + turn.index, ..turn };
    let mut drive = composed(subject, turn, &[if flat.is_some() { UNKNOWN } else { CALIBRATED }])?;
    let [begins_s, takes_s, wait_s] = LOSS_S;
    let complete_s = if flat.is_some() { 0.0 } else { begins_s + takes_s };
    drive.scenario.duration_s = complete_s + wait_s;
    if let (None, Some(spec)) = (flat, drive.scenario.corner.get_mut(struck)) {
        let kpa = spec.pressure.profile_kpa().map_or(PLACARD_KPA, |profile| profile.value(0.0));
        spec.pressure = Pressure::ramp(kpa, LEFT * kpa, begins_s, takes_s);
    }
    let mut found = Found { struck, after_s: f64::INFINITY, wrong: false, early: false };
    let scenario = drive.simulated(turn.seed);
    let Some(mut car) = drive.cars(&scenario)?.pop() else { return Ok(found) };
    for row in Simulation::new(&scenario, turn.seed)? {
        car.update(&row.car_sample());
        for alert in car.report().alerts().filter(|alert| alert.cause.is_low()) {
            found.early |= flat.is_none() && row.time_s < begins_s;
            if alert.wheels.contains(struck) && row.time_s >= begins_s.min(complete_s) {
                found.after_s = found.after_s.min(row.time_s - complete_s);
            }
            found.wrong |= alert.wheels != struck.into();
        }
    }
    Ok(found)
}

fn level_cells(deviation: &Deviation, levels: &[Level]) -> Vec<Cell> {
    const BIAS: Column = Column::new("bias_kpa", "bias", 1);
    const WORST: Column = Column::new("worst_bias_kpa", "worst", 1);
    const SD: Column = Column::new("sd_kpa", "sd stated", 1);
    const RMS: Column = Column::new("rms_kpa", "rms", 1);
    const COVERED: Column = Column::new("coverage", "cover", 3);
    const VALID: Column = Column::new("valid", "valid", 3);
    const FALSE: Column = Column::new("false_warnings", "false", 0);
    const SENSORS: Column = Column::new("sensor_warnings", "sensor", 0);
    // A wheel on its rim has no pressure: it is judged by whether it is warned of.
    let judged = |i: usize| deviation.flat.is_none_or(|flat| flat.index() != i);
    let wheels = levels.iter().flat_map(|level| level.wheels.iter().enumerate());
    let wheels: Vec<&ValidErrors> = wheels.filter(|(i, _)| judged(*i)).map(|(_, wheel)| wheel).collect();
    let mean = |of: &dyn Fn(&ValidErrors) -> f64| ValidErrors::mean(&wheels, of);
    let biases = wheels.iter().filter(|wheel| wheel.errors.count() > 0).map(|wheel| wheel.errors.bias());
    let worst = biases.max_by(|a, b| a.abs().total_cmp(&b.abs()));
    vec![
        BIAS.plain(mean(&|wheel| wheel.errors.bias())),
        WORST.plain(worst.unwrap_or(f64::NAN)),
        SD.plain(mean(&|wheel| wheel.sds_kpa / wheel.errors.count() as f64)),
        RMS.plain(ValidErrors::rms(&wheels)),
        COVERED.plain(mean(&|wheel| wheel.errors.coverage())),
        VALID.plain(ValidErrors::share_valid(&wheels)),
        FALSE.plain(levels.iter().map(|level| f64::from(level.false_low)).sum()),
        SENSORS.plain(levels.iter().map(|level| f64::from(level.sensors)).sum()),
    ]
}

fn loss_cells(found: &[Found]) -> Vec<Cell> {
    const TIRES: [Column; 4] = [
        Column::new("fl_after_median_s", "fl", 1),
        Column::new("fr_after_median_s", "fr", 1),
        Column::new("rl_after_median_s", "rl", 1),
        Column::new("rr_after_median_s", "rr", 1),
    ];
    const WORST: Column = Column::new("after_worst_s", "worst", 1);
    const MISSED: Column = Column::new("missed", "missed", 0);
    const WRONG: Column = Column::new("wrong_wheels", "wrong wheel", 0);
    const EARLY: Column = Column::new("early", "early", 0);
    let of = |corner: Corner| -> Vec<f64> {
        found.iter().filter(|one| one.struck == corner).map(|one| one.after_s).collect()
    };
    let count = |what: &dyn Fn(&Found) -> bool| found.iter().filter(|one| what(one)).count() as f64;
    let mut cells: Vec<Cell> = TIRES
        .into_iter()
        .zip(Corner::ALL)
        .map(|(column, corner)| column.plain(percentile(&of(corner), 0.5)))
        .collect();
    let warned = found.iter().map(|one| one.after_s).filter(|after_s| after_s.is_finite());
    cells.extend([
        WORST.plain(warned.fold(f64::NAN, f64::max)),
        MISSED.plain(count(&|one| one.after_s.is_infinite())),
        WRONG.plain(count(&|one| one.wrong)),
        EARLY.plain(count(&|one| one.early)),
    ]);
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runner::on_study_stack;
    use crate::score::stats::ErrorSum;

    fn subject(name: &str) -> Subject {
        let deviation = LIST.iter().find(|deviation| deviation.name == name).unwrap();
        Subject { deviation, wheel_speeds: false }
    }

    #[test]
    fn cars_can_be_driven_differ_and_are_configured_by_their_file() {
        let turn = Turn { index: 0, seed: 2 };
        let file = composed(&subject("as its file"), turn, &[UNKNOWN]).unwrap();
        for deviation in LIST {
            let of = Subject { deviation, wheel_speeds: false };
            let drive = composed(&of, turn, &[UNKNOWN]).unwrap();
            drive.scenario.validate().unwrap();
            assert_eq!(drive.file_config().unwrap(), file.file_config().unwrap(), "{}", deviation.name);
            let same = deviation.name == "as its file";
            assert_eq!(drive.scenario == file.scenario, same, "{}", deviation.name);
            // And what is simulated differs, too.
            let row = |drive: &Drive| Simulation::new(&drive.scenario, 2).unwrap().nth(100).unwrap().corners;
            assert_eq!(row(&drive) == row(&file), same, "{}", deviation.name);
        }
        let drawn =
            |seed| composed(&subject("drawn as typical"), Turn { index: 0, seed }, &[UNKNOWN]).unwrap();
        assert_ne!(drawn(1).scenario.corner, drawn(2).scenario.corner);
    }

    /// On a washboard accelerations say little after the calibration: radii make the differences of tires surer, and stay honest.
    #[test]
    fn wheel_speeds_beside_make_a_level_surer() {
        let driven = |wheel_speeds| {
            let of = Subject { wheel_speeds, ..subject("washboard 1 m, 2 mm") };
            levels(&of, Turn { index: 0, seed: 5 }).unwrap()
        };
        let [alone, beside] = on_study_stack(move || [false, true].map(driven));
        // Uncalibrated the radii mean nothing.
        assert_eq!(alone[0], beside[0]);
        let of = |ValidErrors { errors, sds_kpa, .. }: ValidErrors| {
            (sds_kpa / errors.count() as f64, errors.rmse(), errors.coverage())
        };
        let mean = |level: &Level| level.wheels.map(of);
        for (alone, beside) in mean(&alone[1]).into_iter().zip(mean(&beside[1])) {
            assert!(
                beside.0 < 0.95 * alone.0 && beside.1 < beside.0 && beside.2 > 0.93,
                "{alone:?} {beside:?}"
            );
        }
    }

    #[test]
    fn tires_and_classes_take_turns() {
        // Losses: each of four tires on each of three classes within twelve drives.
        let mut pairs: Vec<(usize, usize)> = (0..12).map(|i| (i % 4, (i / 4 + i) % CLASSES.len())).collect();
        pairs.sort_unstable();
        pairs.dedup();
        assert_eq!(pairs.len(), 12);
    }

    #[test]
    fn figures_are_means_over_valid_time() {
        let wheel = |error: f64, sd: f64, valid: u64| {
            let mut errors = ErrorSum::default();
            (0..valid).for_each(|_| errors.push(error, sd));
            ValidErrors { errors, sds_kpa: sd * valid as f64, rows: 40 }
        };
        let wheels = [wheel(10.0, 4.0, 30), wheel(-2.0, 4.0, 10), wheel(0.0, 4.0, 0), wheel(6.0, 8.0, 20)];
        let level = Level { wheels, false_low: 2, sensors: 1 };
        let cells = level_cells(subject("as its file").deviation, &[level]);
        let value = |name: &str| cells.iter().find(|cell| cell.column.name == name).unwrap().value;
        // 60 valid rows of 160: (300 - 20 + 120)/60, (40 4 + 20 8)/60, (3000 + 40 + 720)/60; 10 kPa is beyond 1.96 4.
        assert!(
            (value("bias_kpa") - 400.0 / 60.0).abs() < 1e-12
                && (value("sd_kpa") - 320.0 / 60.0).abs() < 1e-12
        );
        assert!((value("rms_kpa") - (3760.0f64 / 60.0).sqrt()).abs() < 1e-12);
        assert!((value("coverage") - 0.5).abs() < 1e-12 && (value("valid") - 0.375).abs() < 1e-12);
        assert_eq!(
            (value("worst_bias_kpa"), value("false_warnings"), value("sensor_warnings")),
            (10.0, 2.0, 1.0)
        );
        // What lies on its rim has no pressure to be right about.
        let flat = level_cells(subject("fl flat on its rim").deviation, &[level]);
        assert_eq!(flat.iter().find(|cell| cell.column.name == "worst_bias_kpa").unwrap().value, 6.0);
    }

    #[test]
    fn losses_are_counted_by_tire() {
        let one = Found { struck: Corner::FrontLeft, after_s: 2.0, wrong: false, early: false };
        let found = [
            one,
            Found { after_s: 4.0, wrong: true, ..one },
            Found { struck: Corner::RearRight, after_s: f64::INFINITY, early: true, ..one },
        ];
        let cells = loss_cells(&found);
        let value = |name: &str| cells.iter().find(|cell| cell.column.name == name).unwrap().value;
        assert_eq!((value("fl_after_median_s"), value("after_worst_s")), (3.0, 4.0));
        assert!(value("rr_after_median_s").is_infinite() && value("fr_after_median_s").is_nan());
        assert_eq!((value("missed"), value("wrong_wheels"), value("early")), (1.0, 1.0, 1.0));
    }

    /// On a smooth road struts of 96 N hardly slip: what too much friction taken out leaves to a damper is less than none.
    #[test]
    fn struts_that_stick_are_read_all_the_while() {
        on_study_stack(|| {
            let levels = levels(&subject("drawn as typical"), Turn { index: 45, seed: 46 }).unwrap();
            for (level, most_kpa) in levels.iter().zip([45.0, 12.0]) {
                assert!(level.wheels.iter().all(|wheel| wheel.errors.count() == wheel.rows));
                assert!(level.wheels.iter().all(|wheel| wheel.errors.bias().abs() < most_kpa), "{level:?}");
                assert_eq!((level.false_low, level.sensors), (0, 0));
            }
        });
    }

    /// A car as its file is read right after a calibration, and its loss is warned of.
    #[test]
    fn a_car_as_its_file_is_read_and_warned_of() {
        on_study_stack(|| {
            let turn = Turn { index: 0, seed: 5 };
            let levels = levels(&subject("as its file"), turn).unwrap();
            for level in &levels {
                assert!(
                    level.wheels.iter().all(|wheel| wheel.errors.bias().abs() < 20.0 && wheel.rows == 23_999)
                );
                assert_eq!((level.false_low, level.sensors), (0, 0));
            }
            let loss = loss(&subject("as its file"), turn).unwrap();
            assert!(loss.after_s < 10.0 && !loss.wrong && !loss.early, "{loss:?}");
        });
    }
}
