//! How soon tires are named that lose air together, or were low from the start, by a car that is not its file.
//!
//! Called by the plan of the four-wheel parts. Every seed is another car, as a vehicle file of confidence `typical` may be about, on a journey
//! of its own; what is known of it is the file, a calibration at the start of the drive, or one of another day with another journey and load.

use itpms_core::model::{CarConfig, CarEstimate, Corner, VehicleCalibration, Wheels};
use itpms_sim::road::RoadSpec;
use itpms_sim::scenario::{Scenario, ToleranceSpec};
use itpms_sim::simulation::{SimRow, Simulation};
use itpms_sim::time_profile::{Pressure, Speed};

use super::super::row::{Column, Goal, Row};
use super::super::stats::{ValidErrors, percentile};
use super::learned_car::estimator;
use crate::runner::{Result, Runner, Turn};

/// A fifth is lost from here on, in so many s; a quarter is missing from the start.
const BEGINS_S: f64 = 300.0;
const TAKES_S: f64 = 10.0;
const LEFT: f64 = 0.8;
const LEFT_BEFORE: f64 = 0.75;
const WAIT_S: f64 = 110.0;
/// Calibrations in s: in the drive, and on another day, whose seeds are so far away.
const CALIBRATION_S: f64 = 120.0;
const OTHER_DAY_S: f64 = 600.0;
const OTHER_DAY: u64 = 1 << 20;
/// Sprung masses on that other day over those before, of every other car: two passengers.
const LATER_LOAD: f64 = 1.1;
/// Seconds of a drive whose errors do not count.
const SETTLED_S: f64 = 30.0;
/// The motorway that shows least: speed, roughness (an eighth of class A's), friction and imbalance of every wheel.
const MOTORWAY_KM_H: f64 = 130.0;
const MOTORWAY_GD_N0_M3: f64 = 2e-6;
const MOTORWAY_FRICTION_N: f64 = 50.0;
const MOTORWAY_IMBALANCE_KG_M: f64 = 0.004;

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum Loss {
        None = "nothing lost",
        One = "one tire",
        Side = "a side",
        Axle = "an axle",
        All = "all four",
        OneBefore = "a quarter of one before the drive",
        OneOnMotorway = "one on a very smooth motorway",
    }
}

itpms_core::labelled! {
    /// Knowledge of the car besides its file.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum Known {
        File = "file",
        Calibrated = "calibrated",
        OtherDay = "reference of another day",
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Case {
    loss: Loss,
    known: Known,
}

impl Case {
    const ALL: [(Loss, &'static [Known]); 7] = {
        const EVERY: &[Known] = &[Known::File, Known::Calibrated, Known::OtherDay];
        [
            (Loss::None, EVERY),
            (Loss::One, EVERY),
            (Loss::Side, EVERY),
            (Loss::Axle, EVERY),
            (Loss::All, EVERY),
            (Loss::OneBefore, &[Known::File, Known::OtherDay]),
            (Loss::OneOnMotorway, &[Known::Calibrated]),
        ]
    };

    fn name(self) -> String {
        format!("{}, {}", self.loss.label(), self.known.label())
    }

    fn goal_s(self) -> f64 {
        match (self.loss, self.known) {
            (Loss::None, _) => f64::INFINITY,
            (Loss::OneBefore, _) => 25.0,
            (Loss::Side | Loss::Axle, Known::Calibrated) => 30.0,
            _ => 60.0,
        }
    }

    /// Which tires of the drive of a turn.
    fn lost(self, index: usize) -> Wheels {
        let one = Corner::ALL[index % 4];
        match self.loss {
            Loss::None => Wheels::NONE,
            Loss::One | Loss::OneBefore | Loss::OneOnMotorway => one.into(),
            Loss::Side => Corner::ALL.into_iter().filter(|&corner| side(corner) == side(one)).collect(),
            Loss::Axle => {
                Corner::ALL.into_iter().filter(|corner| corner.index() / 2 == one.index() / 2).collect()
            }
            Loss::All => Corner::ALL.into_iter().collect(),
        }
    }

    fn complete_s(self) -> f64 {
        if self.loss == Loss::OneBefore { 0.0 } else { BEGINS_S + TAKES_S }
    }
}

/// 0 on the left, 1 on the right.
fn side(corner: Corner) -> usize {
    corner.index() % 2
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Found {
    /// Seconds from the complete loss until all its tires have been named; infinite if they never were.
    after_s: f64,
    /// Whether another tire was named, and whether one was before it lost anything.
    wrong: bool,
    early: bool,
    level: ValidErrors,
    shapes: [Shape; 4],
}

/// In which shapes errors come: of the mean, of left less right, front less rear, and of the diagonals.
const SHAPES: [[f64; 4]; 4] =
    [[1.0, 1.0, 1.0, 1.0], [1.0, -1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0]];

/// Squares of the errors of one shape, and of them over the variance that is stated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Shape {
    count: f64,
    squares: f64,
    over_stated: f64,
}

#[derive(Default)]
pub(super) struct Plan {
    cases: Vec<(Case, usize)>,
}

impl Plan {
    pub(super) fn new(seeds: usize, only: Option<&str>) -> Self {
        let cases = Case::ALL.into_iter();
        let cases = cases.flat_map(|(loss, known)| known.iter().map(move |&known| Case { loss, known }));
        let wanted = |case: &Case| only.is_none_or(|only| case.name().contains(only));
        Self { cases: cases.filter(wanted).map(|case| (case, seeds)).collect() }
    }

    pub(super) fn drives(&self) -> u64 {
        self.cases.iter().map(|(_, drives)| *drives as u64).sum()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>> {
        let found = runner.run(&self.cases, drive)?;
        Ok(self.cases.iter().zip(&found).map(|((case, _), found)| row(*case, found)).collect())
    }
}

/// The car of a seed on the journey of another; the car of its file.
fn car(turn: Turn) -> Result<(Scenario, CarConfig<f64>)> {
    let mut scenario = Scenario::builtin("drive-normal")?;
    let file = scenario.car_config()?;
    if let Some(journey) = &mut scenario.journey {
        journey.tolerances = None;
    }
    ToleranceSpec::typical().apply(turn.seed, &mut scenario);
    Ok((scenario, file))
}

/// The car's reference, learned at its placard's pressures on a day before.
fn calibrated_before(
    scenario: &Scenario,
    file: &CarConfig<f64>,
    seed: u64,
) -> Result<Option<VehicleCalibration<f64>>> {
    let scenario = Scenario { duration_s: OTHER_DAY_S, ..scenario.clone() };
    let mut car = estimator(file)?;
    car.begin_calibration(OTHER_DAY_S)?;
    for row in Simulation::new(&scenario, seed.wrapping_add(OTHER_DAY))? {
        car.update(&row.car_sample());
    }
    car.end_calibration();
    Ok(car.estimator().calibration().filter(|learned| learned.check().is_ok()))
}

fn drive(case: &Case, turn: Turn) -> Result<Found> {
    let (mut scenario, file) = car(turn)?;
    let mut car = estimator(&file)?;
    match case.known {
        Known::File => {}
        Known::Calibrated => car.begin_calibration(CALIBRATION_S)?,
        Known::OtherDay => {
            if let Some(calibration) = calibrated_before(&scenario, &file, turn.seed)? {
                car.load_calibration(&calibration)?;
            }
            // Every other car has two passengers who were not there before.
            let load = if turn.index % 2 == 1 { LATER_LOAD } else { 1.0 };
            scenario.corner.iter_mut().for_each(|(_, spec)| spec.truth.sprung_mass_factor *= load);
        }
    }
    let lost = case.lost(turn.index);
    let complete_s = case.complete_s();
    scenario.duration_s = complete_s + WAIT_S;
    for (_, spec) in scenario.corner.iter_mut().filter(|(corner, _)| lost.contains(*corner)) {
        let kpa = spec.pressure.profile_kpa().map_or(f64::NAN, |profile| profile.value(0.0));
        spec.pressure = match case.loss {
            Loss::OneBefore => Pressure::ConstantKpa(LEFT_BEFORE * kpa),
            _ => Pressure::ramp(kpa, LEFT * kpa, BEGINS_S, TAKES_S),
        };
    }
    if case.loss == Loss::OneOnMotorway {
        onto_motorway(&mut scenario);
    }
    let mut found = Found { after_s: f64::INFINITY, ..Found::default() };
    let (mut named, mut rolls_s) = (Wheels::NONE, None);
    for row in Simulation::new(&scenario, turn.seed)? {
        let sample = row.car_sample();
        let estimate = car.update(&sample);
        if sample.speed_m_s > 0.0 {
            rolls_s.get_or_insert(row.time_s);
        }
        found.see(&row, &estimate);
        for alert in car.report().alerts().filter(|alert| alert.cause.is_low()) {
            found.early |= case.loss != Loss::OneBefore && row.time_s < BEGINS_S;
            found.wrong |= alert.wheels.iter().any(|corner| !lost.contains(corner));
            named = named.iter().chain(alert.wheels.iter()).collect();
        }
        if found.after_s.is_infinite()
            && lost != Wheels::NONE
            && lost.iter().all(|corner| named.contains(corner))
        {
            let since_s = if case.loss == Loss::OneBefore { rolls_s.unwrap_or(0.0) } else { complete_s };
            found.after_s = row.time_s - since_s;
        }
    }
    Ok(found)
}

/// A constant speed on a road that is so smooth that imbalance and friction say more than it does.
fn onto_motorway(scenario: &mut Scenario) {
    scenario.speed = Speed::ConstantKmH(MOTORWAY_KM_H);
    scenario.journey = None;
    scenario.road = RoadSpec { contact_length_m: 0.1, ..RoadSpec::iso8608(MOTORWAY_GD_N0_M3, 2.0) };
    for (_, spec) in scenario.corner.iter_mut() {
        spec.truth.friction_n = MOTORWAY_FRICTION_N;
        spec.truth.imbalance_kg_m = MOTORWAY_IMBALANCE_KG_M;
    }
}

impl Found {
    fn see(&mut self, row: &SimRow, estimate: &CarEstimate<f64>) {
        if !(row.time_s > SETTLED_S.max(CALIBRATION_S)) {
            return;
        }
        let mut of_all = [None; 4];
        for (of_one, (truth, estimate)) in of_all.iter_mut().zip(row.corners.iter().zip(&estimate.corners)) {
            let (Some(truth), Some(estimate)) = (truth, estimate) else { continue };
            self.level.push(truth.pressure_kpa, estimate);
            let error_kpa = estimate.pressure_kpa - truth.pressure_kpa;
            *of_one = estimate.validity.is_valid().then_some([error_kpa, estimate.pressure_sd_kpa]);
        }
        let [Some(fl), Some(fr), Some(rl), Some(rr)] = of_all else { return };
        let of_all = [fl, fr, rl, rr];
        for (shape, signs) in self.shapes.iter_mut().zip(SHAPES) {
            let (mut error, mut variance) = (0.0, 0.0);
            for i in 0..4 {
                error += 0.25 * signs[i] * of_all[i][0];
                for j in 0..4 {
                    let covariance = estimate.correlation[i][j] * of_all[i][1] * of_all[j][1];
                    variance += signs[i] * signs[j] * covariance / 16.0;
                }
            }
            shape.count += 1.0;
            shape.squares += error * error;
            shape.over_stated += error * error / variance;
        }
    }
}

fn row(case: Case, found: &[Found]) -> Row {
    const MEDIAN: Column = Column::new("after_median_s", "median s", 1);
    const WORST: Column = Column::new("after_worst_s", "worst", 1);
    const MISSED: Column = Column::new("missed", "missed", 0);
    const WRONG: Column = Column::new("wrong_wheels", "wrong tire", 0);
    const EARLY: Column = Column::new("early", "early", 0);
    const RMS: Column = Column::new("rms_kpa", "rms", 1);
    const RMS_OF: [Column; 4] = [
        Column::new("mean_rms_kpa", "mean", 1),
        Column::new("side_rms_kpa", "side", 1),
        Column::new("axle_rms_kpa", "axle", 1),
        Column::new("warp_rms_kpa", "warp", 1),
    ];
    const CHI_OF: [Column; 4] = [
        Column::new("mean_chi_square", "chi2", 2),
        Column::new("side_chi_square", "side", 2),
        Column::new("axle_chi_square", "axle", 2),
        Column::new("warp_chi_square", "warp", 2),
    ];
    const COVERED: Column = Column::new("coverage", "cover", 3);
    const VALID: Column = Column::new("valid", "valid", 3);
    let count = |what: &dyn Fn(&Found) -> bool| found.iter().filter(|one| what(one)).count() as f64;
    let levels: Vec<&ValidErrors> = found.iter().map(|one| &one.level).collect();
    let of_shape = |shape: usize, of: &dyn Fn(&Shape) -> f64| {
        let all = || found.iter().map(|one| one.shapes[shape]);
        all().map(|shape| of(&shape)).sum::<f64>() / all().map(|shape| shape.count).sum::<f64>()
    };
    let mut cells = vec![];
    if case.loss != Loss::None {
        let after: Vec<f64> = found.iter().map(|one| one.after_s).collect();
        let warned = after.iter().copied().filter(|after_s| after_s.is_finite());
        cells.extend([
            MEDIAN.plain(percentile(&after, 0.5)),
            WORST.judged(warned.fold(f64::NAN, f64::max), Goal::AtMost(case.goal_s())),
            MISSED.judged(count(&|one| one.after_s.is_infinite()), Goal::AtMost(0.0)),
        ]);
    }
    cells.extend([
        WRONG.judged(count(&|one| one.wrong), Goal::AtMost(0.0)),
        EARLY.judged(count(&|one| one.early), Goal::AtMost(0.0)),
        RMS.plain(ValidErrors::rms(&levels)),
        COVERED.plain(ValidErrors::mean(&levels, |one| one.errors.coverage())),
        VALID.plain(ValidErrors::share_valid(&levels)),
    ]);
    if case.loss == Loss::None {
        cells.extend((0..4).map(|i| RMS_OF[i].plain(of_shape(i, &|shape| shape.squares).sqrt())));
        cells.extend((0..4).map(|i| CHI_OF[i].plain(of_shape(i, &|shape| shape.over_stated))));
    }
    Row::of_default("several", case.name(), found.len(), cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_name_the_tires_that_lose() {
        let lost = |loss, index| Case { loss, known: Known::File }.lost(index);
        assert_eq!(lost(Loss::None, 1), Wheels::NONE);
        for index in 0..4 {
            let corner = Corner::ALL[index];
            for loss in [Loss::One, Loss::Side, Loss::Axle, Loss::All, Loss::OneBefore] {
                assert!(lost(loss, index).contains(corner));
            }
            assert_eq!(lost(Loss::Side, index).iter().count(), 2);
            assert!(lost(Loss::Side, index).iter().all(|other| side(other) == side(corner)));
            assert!(lost(Loss::Axle, index).iter().all(|other| other.index() / 2 == corner.index() / 2));
            assert_eq!(lost(Loss::All, index).iter().count(), 4);
        }
    }

    /// The car differs from its file, and on another day it is the same car on another journey.
    #[test]
    fn the_car_is_not_its_file_and_stays_the_same() {
        let (scenario, file) = car(Turn { index: 0, seed: 3 }).unwrap();
        scenario.validate().unwrap();
        let (other, same) = car(Turn { index: 0, seed: 4 }).unwrap();
        assert!(file == same && scenario.corner != other.corner && scenario.journey == other.journey);
        assert!(scenario.corner.iter().all(|(_, spec)| spec.truth.unsprung_mass_factor != 1.0));
    }
}
