//! Drives a scenario: a stream of log rows with the truth beside them, the same for the same scenario and seed.
//!
//! Called by the binary, the score and tests. Memory does not grow with the drive's length.
//!
//! The plant runs on a fine grid of eight times the log's rate and at least 4 kHz (1.6 kHz where the tires average the
//! road over a contact length); its accelerations pass the anti-alias filter there. A log's sample is read off the filtered signal at its (possibly jittered) time by a
//! cubic through the four fine-grid values around it.

mod corner;
mod fore_aft;
mod history;
mod ride;
mod row;

use rand::RngExt;
use rand_pcg::Pcg64;

pub use row::{CornerRow, SimRow};

use crate::error::ScenarioError;
use crate::fault::Faults;
use crate::plant::StepInput;
use crate::road::{Following, GRID_SPACING_M, Lane, Line, RoadError, Side};
use crate::scenario::Scenario;
use crate::streams::{Purpose, generator};
use crate::time_profile::TimeProfile;
use crate::wheel_speeds::WheelSpeedRun;
use corner::{CornerRun, is_rear, side_of};
use ride::{Ride, Step};

/// Lowest rate of the fine grid in Hz, for a tire that follows every point of the road: waves of 1 cm at 130 km/h.
const POINT_RATE_HZ: f64 = 4000.0;

/// The same for a tire that averages the road over a contact length, which leaves nothing to see of such waves: an hour's log at 200 Hz
/// differs from one simulated at 16 kHz by 0.25 % of its rms, most of it the shape of the anti-alias filter near its corner.
const CONTACT_RATE_HZ: f64 = 1600.0;

/// Contact length in m from which on it counts as one.
const CONTACT_M: f64 = 0.05;

/// An acceleration in m/s² that nothing on a road has.
const ABSURD_M_S2: f64 = 1e6;

/// Steps of the fine grid per sample of the log, at least.
const STEPS_PER_SAMPLE: f64 = 8.0;

/// A running drive: an iterator over its rows.
#[derive(Debug, Clone)]
pub struct Simulation {
    rate_hz: f64,
    steps_per_sample: i64,
    jitter: f64,
    clock: Pcg64,
    speed_m_s: TimeProfile,
    lanes: Lanes,
    corners: Vec<CornerRun>,
    /// Whether a sensor reads of fore-aft accelerations.
    leans: bool,
    ride: Ride,
    wheel_speeds: Option<WheelSpeedRun>,
    faults: Faults,
    step: i64,
    row: u64,
    rows: u64,
    /// When the car's motion stopped being one.
    diverged_s: Option<f64>,
}

/// The roads under the left and the right wheels, where there are any.
#[derive(Debug, Clone)]
struct Lanes {
    left: Option<Lane>,
    right: Option<Lane>,
}

impl Lanes {
    fn side(&mut self, side: Side) -> Option<&mut Lane> {
        match side {
            Side::Left => self.left.as_mut(),
            Side::Right => self.right.as_mut(),
        }
    }
}

impl Simulation {
    /// Starts a drive. The same scenario and seed give the same rows; road, sensors, losses and clock draw from generators of their own, so
    /// that a change to one leaves the others as they were. Errors: a value out of range, or a road profile that cannot be read.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Self, ScenarioError> {
        let composed = scenario.composed(seed)?;
        let scenario = &composed;
        let invalid = |source| ScenarioError::Invalid { scenario: scenario.name.clone(), source };
        let rate_hz = scenario.rate_hz;
        let lowest_hz =
            if scenario.road.contact_length_m < CONTACT_M { POINT_RATE_HZ } else { CONTACT_RATE_HZ };
        let steps_per_sample = (lowest_hz / rate_hz - 1e-9).ceil().max(STEPS_PER_SAMPLE);
        let fine_hz = rate_hz * steps_per_sample;
        let speed_m_s = scenario.speed.profile_m_s().map_err(invalid)?;
        // Wheel speeds alone need neither masses nor roads.
        let rides = !scenario.wheel_speeds.is_some_and(|wheels| wheels.alone);
        let mut lanes = if rides {
            lanes(scenario, seed, speed_m_s.maximum())?
        } else {
            Lanes { left: None, right: None }
        };
        let step = -((scenario.settle_s * rate_hz * steps_per_sample).ceil() as i64);
        let start_s = step as f64 / fine_hz;
        let mut corners = Vec::new();
        let mut places = [[0.0; 2]; 4];
        for (corner, spec) in scenario.corner.iter().filter(|_| rides) {
            let mut run = CornerRun::new(scenario, corner, spec, seed, fine_hz).map_err(invalid)?;
            run.beside_m = first_beside_m(scenario, &run);
            places[corner.index()] =
                run.place(start_s, speed_m_s.integral(start_s), lanes.side(side_of(corner)));
            corners.push(run);
        }
        let ride = Ride::new(scenario, &speed_m_s, seed, start_s, places).map_err(invalid)?;
        Ok(Self {
            rate_hz,
            steps_per_sample: steps_per_sample as i64,
            jitter: scenario.clock.jitter,
            clock: generator(seed, Purpose::Clock, [0, 0]),
            speed_m_s,
            lanes,
            leans: corners.iter().any(CornerRun::leans),
            corners,
            ride,
            wheel_speeds: WheelSpeedRun::new(scenario, seed).map_err(invalid)?,
            faults: Faults::new(&scenario.fault, seed),
            step,
            row: 0,
            rows: scenario.rows(),
            diverged_s: None,
        })
    }

    /// Since when, in s, the car's accelerations are no numbers or absurd, if they are: its masses, springs, dampers or tires are
    /// none that can be simulated. What came since is worth nothing.
    pub fn diverged_s(&self) -> Option<f64> {
        self.diverged_s
    }

    /// Time in s of a (fractional) fine-grid step.
    fn time_s(&self, step: f64) -> f64 {
        step / (self.rate_hz * self.steps_per_sample as f64)
    }

    /// A row after the sensors' faults.
    fn spoil(&mut self, row: &mut SimRow) {
        let nothing = [f64::NAN; 2];
        let mut readings =
            row.corners.map(|c| c.map_or(nothing, |c| [c.body_accel_m_s2, c.wheel_accel_m_s2]));
        self.faults.spoil(row.time_s, &mut readings);
        for (corner, [body, wheel]) in row.corners.iter_mut().zip(readings) {
            if let Some(corner) = corner {
                (corner.body_accel_m_s2, corner.wheel_accel_m_s2) = (body, wheel);
            }
        }
    }

    /// One step of the fine grid for all corners.
    fn advance(&mut self) {
        let start = self.step as f64;
        let times = [start, start + 0.5, start + 1.0].map(|step| self.time_s(step));
        let front_m = times.map(|time_s| self.speed_m_s.integral(time_s));
        let turns = self.wheel_speeds.as_ref().map_or([1.0; 4], WheelSpeedRun::imbalance_turns);
        let step = Step { start_s: times[0], step_s: self.time_s(1.0), front_m, turns };
        self.step += 1;
        self.ride.turn(&step);
        let [left_m, right_m] = self.ride.beside_m();
        let mut inputs = [StepInput { road_m: [0.0; 3], stiffness_n_per_m: [0.0; 2] }; 4];
        for run in &mut self.corners {
            let beside_m = match (is_rear(run.corner), run.side) {
                (false, _) => 0.0,
                (true, Side::Left) => left_m,
                (true, Side::Right) => right_m,
            };
            if let Some(lane) = self.lanes.side(run.side) {
                inputs[run.corner.index()] = run.roll([front_m[1], front_m[2]], beside_m, times[2], lane);
            }
        }
        let accelerations = self.ride.step(&step, &inputs);
        if !accelerations.iter().flatten().all(|acceleration| acceleration.abs() < ABSURD_M_S2) {
            self.diverged_s.get_or_insert(times[2]);
        }
        let tires_n = self.leans.then(|| self.ride.tires_n(&inputs));
        for run in &mut self.corners {
            let i = run.corner.index();
            match tires_n {
                None => run.sense(accelerations[i]),
                Some(tires_n) => {
                    let car_m_s2 = self.ride.forward_m_s2();
                    run.sense_leaning(accelerations[i], step.step_s, car_m_s2, tires_n[i]);
                }
            }
        }
    }
}

/// The roads, waves up to the log's rate at the drive's top speed: twice what a sample can tell from shorter ones.
fn lanes(scenario: &Scenario, seed: u64, top_m_s: f64) -> Result<Lanes, ScenarioError> {
    let spacing_m = (0.5 * top_m_s / scenario.rate_hz).clamp(GRID_SPACING_M / 8.0, GRID_SPACING_M);
    let lay = |side: Side| {
        if scenario.corner.iter().all(|(corner, _)| side_of(corner) != side) {
            return Ok(None);
        }
        let (line, following) = match &scenario.car {
            Some(car) => {
                let wider_m = car.wider_m()[usize::from(side == Side::Right)];
                let following = if car.wanders() {
                    Following::Wandering
                } else {
                    Following::Beside(car.rear_offset_m + wider_m)
                };
                (Line::of_track(side, car.track_front_m), following)
            }
            None => (Line::alone(side), Following::Beside(scenario.rear_offset_m)),
        };
        Lane::new(&scenario.road, line, seed, spacing_m, scenario.one_speed_m_s(), following)
            .map(Some)
            .map_err(|e| match e {
                RoadError::Value(source) => {
                    ScenarioError::Invalid { scenario: scenario.name.clone(), source }
                }
                RoadError::Profile(source) => {
                    ScenarioError::Profile { scenario: scenario.name.clone(), source }
                }
            })
    };
    Ok(Lanes { left: lay(Side::Left)?, right: lay(Side::Right)? })
}

/// How far beside the front wheels' track a corner starts, in m.
fn first_beside_m(scenario: &Scenario, run: &CornerRun) -> f64 {
    match &scenario.car {
        Some(car) if is_rear(run.corner) => {
            car.rear_offset_m + car.wider_m()[usize::from(run.side == Side::Right)]
        }
        None if is_rear(run.corner) => scenario.rear_offset_m,
        _ => 0.0,
    }
}

impl Iterator for Simulation {
    type Item = SimRow;

    fn next(&mut self) -> Option<SimRow> {
        if self.row >= self.rows {
            return None;
        }
        let mut late = self.jitter * self.clock.random_range(-1.0..=1.0);
        if self.row == 0 {
            // A log does not start before its drive.
            late = late.abs();
        }
        // The sample's place on the fine grid: `whole` steps and a fraction.
        let late_steps = late * self.steps_per_sample as f64;
        let whole = self.row as i64 * self.steps_per_sample + late_steps.floor() as i64;
        let fraction = late_steps - late_steps.floor();
        while self.step < whole + 2 && !self.corners.is_empty() {
            self.advance();
        }
        let time_s = (self.row as f64 + late) / self.rate_hz;
        let distance_m = self.speed_m_s.integral(time_s);
        let mut row = SimRow {
            time_s,
            speed_m_s: self.speed_m_s.value(time_s),
            distance_m,
            corners: [None; 4],
            wheel_speeds: self.wheel_speeds.as_mut().and_then(|wheels| wheels.read(time_s)),
        };
        for run in &mut self.corners {
            if let Some(lane) = self.lanes.side(run.side) {
                row.corners[run.corner.index()] = Some(run.read(time_s, distance_m, fraction, lane));
            }
        }
        self.spoil(&mut row);
        self.row += 1;
        Some(row)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = (self.rows - self.row) as usize;
        (left, Some(left))
    }
}

impl ExactSizeIterator for Simulation {}
