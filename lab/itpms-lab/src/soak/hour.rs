//! One drive in which nothing is wrong, and what is kept of it: what was reported, and how near it came to saying more.

use std::ops::ControlFlow;
use std::time::Instant;

use itpms_core::model::{CarEstimate, Corner};
use itpms_core::monitor::MonitoredCar;
use itpms_core::warning::{Alert, Change, Limits, MonitorReport};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::{SimRow, Simulation};
use itpms_sim::wheel_speeds::{Condition, YawFault};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use super::{Car, Plan};
use crate::runner::{Result, StudyError};
use crate::score::stats::ErrorSum;
use crate::tuning::monitor;

/// The monitor's report where nothing can be known; no false warning.
pub(super) const NO_INFORMATION: &str = "no-information";

/// Rows between two questions whether to go on.
pub(super) const ASK_ROWS: u64 = 2000;
/// How far the speed that the estimator is given may be off, as a share: tires wear, wheels differ.
const SPEED_SHARE: f64 = 0.01;
/// Standard deviations that a one-sided limit of 95 % lies off.
const ONE_SIDED_95: f64 = 1.645;

/// Record of a drive: a line of a file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Hour {
    pub seed: u64,
    /// Length of the drive in s, stops included.
    pub driven_s: f64,
    pub km: f64,
    /// Everything that was reported, in the order of time: nothing, if all is well.
    pub said: Vec<Said>,
    /// In the order of [`Corner::ALL`].
    pub wheels: [WheelHour; 4],
    /// Of wheel speeds, where these are all the car has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radii: Option<RadiusHour>,
    /// Of the day, where there were a calibration and a later day.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub day: Option<DayHour>,
    pub wall_s: f64,
}

/// Something that was reported though nothing was wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Said {
    /// When, in s from the start of the drive.
    pub time_s: f64,
    /// The wheels it named, such as `fl`.
    pub wheels: Vec<String>,
    /// Why, in one word; see [`itpms_core::warning::Cause::label`].
    pub cause: String,
    pub text: String,
}

/// How near one wheel came to a warning, while its pressure was valid. `None` where it never was.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct WheelHour {
    /// Share of the time in which the pressure was valid.
    pub valid: f64,
    /// Share of that in which the truth was inside the 95 % interval.
    pub covered: Option<f64>,
    /// Root of the mean square error in kPa.
    pub rmse_kpa: Option<f64>,
    /// Largest error over its standard deviation, with its sign.
    pub worst_z: Option<f64>,
    /// Smallest distance in kPa of the 95 % upper limit (p + 1.645 sd) from the limit of a warning; negative where a warning was due.
    pub low_margin_kpa: Option<f64>,
    pub low_margin_s: Option<f64>,
    /// Smallest 95 % lower limit (p - 1.645 sd) in kPa.
    pub lowest_kpa: Option<f64>,
}

/// How near radius analysis came to a warning after its calibration.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct RadiusHour {
    /// Time in s in which differences were known, and in which a loss of 30 % of any single tire would have been found.
    pub known_s: f64,
    pub informed_s: f64,
    /// Largest probability of any low tire, and when that was, in s.
    pub most_probable: f64,
    pub most_probable_s: f64,
    /// Shares of the time in which the true change of each ratio of radii was within its 95 % interval: front left over right, rear
    /// left over right, front over rear.
    pub covered: [f64; 3],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DayHour {
    /// What the day was: of a mixed plan one of the others.
    pub condition: Condition,
    /// `d ln R / d ln p` of its tires.
    pub radius_per_ln_pressure: f64,
    pub since_km: f64,
    /// Whether a calibration taught anything.
    pub calibrated: bool,
    /// Of the yaw rate, where the car has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yaw: Option<YawHour>,
    /// Of the tires that lost air, where some did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<LossHour>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct YawHour {
    pub fault: YawFault,
    pub left_out: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LossHour {
    pub kind: String,
    pub wheels: Vec<String>,
    /// Change of `ln` of their radius: `-beta ln p`.
    pub radius_change: f64,
    /// When a warning named one of them, alone or among others, in s after the loss began.
    pub found_s: Option<f64>,
    pub exact: bool,
    /// Whether one named a tire that had not lost air.
    pub wrong: bool,
}

impl Hour {
    pub fn to_line(&self) -> String {
        // Numbers, texts and lists can always be written.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// From such a line; `None` if it is no such thing.
    pub fn from_line(line: &str) -> Option<Self> {
        serde_json::from_str(line).ok()
    }
}

pub(super) fn drive(plan: &Plan, seed: u64, flow: &dyn Fn() -> ControlFlow<()>) -> Result<Hour> {
    let begun = Instant::now();
    let scenario = scenario(plan)?;
    let mut car = monitored(&scenario)?;
    if let Some(seconds) = plan.calibrate_s {
        car.begin_calibration(seconds)?;
    }
    let speed_factor = match plan.car {
        Car::Nominal => 1.0,
        Car::Varied | Car::Quarters => {
            1.0 + SPEED_SHARE * (2.0 * Pcg64::seed_from_u64(seed).random::<f64>() - 1.0)
        }
    };
    let limits = limits(&scenario)?;
    let mut watches = limits.map(Watch::new);
    let mut said = vec![];
    let mut before = *car.report();
    let (mut rows, mut km) = (0, 0.0);
    for row in Simulation::new(&driven(&scenario, plan.car, seed)?, seed)? {
        if rows % ASK_ROWS == 0 && flow().is_break() {
            return Err(StudyError::Stopped);
        }
        rows += 1;
        let mut sample = row.car_sample();
        sample.speed_m_s *= speed_factor;
        let estimate = car.update(&sample);
        for (i, watch) in watches.iter_mut().enumerate() {
            watch.push(&row, &estimate, i);
        }
        km = 1e-3 * row.distance_m;
        note(row.time_s, &before, car.report(), &mut said);
        before = *car.report();
    }
    let driven_s = rows as f64 / plan.rate_hz;
    let wheels = watches.map(|watch| watch.finish(rows));
    Ok(Hour { seed, driven_s, km, said, wheels, wall_s: begun.elapsed().as_secs_f64(), ..Hour::default() })
}

/// The drive, before its seed composes it.
pub(super) fn scenario(plan: &Plan) -> Result<Scenario> {
    let mut scenario = Scenario::builtin("drive-normal")?;
    scenario.rate_hz = plan.rate_hz;
    scenario.duration_s = plan.drive_s;
    if let (Some(journey), Car::Nominal) = (&mut scenario.journey, plan.car) {
        journey.tolerances = None;
    }
    scenario.validate()?;
    Ok(scenario)
}

/// The same as its seed composes it, on the wheels of this car.
fn driven(scenario: &Scenario, car: Car, seed: u64) -> Result<Scenario> {
    let mut driven = scenario.composed(seed)?;
    if car == Car::Quarters {
        driven.car = None;
        // Wheels that turn belong to the whole car.
        driven.corner.iter_mut().for_each(|(_, spec)| spec.truth.imbalance_kg_m = 0.0);
    }
    Ok(driven)
}

/// The estimator and the monitor as they are shipped, given what the vehicle file says; the roads' heights are not read.
fn monitored(scenario: &Scenario) -> Result<Box<MonitoredCar<f64>>> {
    let config = monitor(&scenario.car_config()?);
    Ok(Box::new(MonitoredCar::new(&config, scenario.rate_hz)?))
}

/// Pressures in kPa below which a wheel is warned of.
fn limits(scenario: &Scenario) -> Result<[f64; 4]> {
    let share = Limits::<f64>::from(itpms_core::warning::Regulation::default()).low_share;
    let corners = scenario.car_config()?.corners;
    Ok(corners.map(|corner| corner.map_or(f64::NAN, |corner| share * corner.placard_kpa)))
}

pub(super) fn note(time_s: f64, before: &MonitorReport<f64>, now: &MonitorReport<f64>, said: &mut Vec<Said>) {
    for change in now.changes_since(before) {
        if let Change::Begun(alert) = change {
            said.push(Said::new(time_s, &alert));
        }
    }
}

impl Said {
    pub(super) fn new(time_s: f64, alert: &Alert<f64>) -> Self {
        Self {
            time_s,
            wheels: alert.wheels.iter().map(|corner: Corner| corner.label().to_owned()).collect(),
            cause: alert.cause.label().to_owned(),
            text: alert.to_string(),
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Watch {
    limit_kpa: f64,
    errors: ErrorSum,
    worst_z: f64,
    low_margin: [f64; 2],
    lowest_kpa: f64,
}

impl Watch {
    fn new(limit_kpa: f64) -> Self {
        Self {
            limit_kpa,
            errors: ErrorSum::default(),
            worst_z: 0.0,
            low_margin: [f64::INFINITY, f64::NAN],
            lowest_kpa: f64::INFINITY,
        }
    }

    fn push(&mut self, row: &SimRow, estimate: &CarEstimate<f64>, corner: usize) {
        let (Some(truth), Some(estimate)) = (&row.corners[corner], &estimate.corners[corner]) else { return };
        if !estimate.validity.is_valid() {
            return;
        }
        let (pressure, sd) = (estimate.pressure_kpa, estimate.pressure_sd_kpa);
        let error = pressure - truth.pressure_kpa;
        self.errors.push(error, sd);
        if error.abs() > self.worst_z.abs() * sd {
            self.worst_z = error / sd;
        }
        let margin = pressure + ONE_SIDED_95 * sd - self.limit_kpa;
        if margin < self.low_margin[0] {
            self.low_margin = [margin, row.time_s];
        }
        self.lowest_kpa = self.lowest_kpa.min(pressure - ONE_SIDED_95 * sd);
    }

    fn finish(self, rows: u64) -> WheelHour {
        let valid = self.errors.count();
        let some = |value: f64| (valid > 0).then_some(value);
        WheelHour {
            valid: valid as f64 / rows.max(1) as f64,
            covered: some(self.errors.coverage()),
            rmse_kpa: some(self.errors.rmse()),
            worst_z: some(self.worst_z),
            low_margin_kpa: some(self.low_margin[0]),
            low_margin_s: some(self.low_margin[1]),
            lowest_kpa: some(self.lowest_kpa),
        }
    }
}
