//! Drives a scenario: a stream of log rows with the truth beside them, the same for the same scenario and seed.
//!
//! Called by the binary, the score and tests. Memory does not grow with the drive's length.
//!
//! The plant runs on a fine grid, at 4 kHz or eight times the log's rate, whichever is more; its accelerations pass
//! the anti-alias filter there. A log's sample is read off the filtered signal at its (possibly jittered) time by a
//! cubic through the four fine-grid values around it.

use itpms_core::pressure::PressureMap;
use itpms_core::sample::{Corner, CornerSample, Sample};
use rand::RngExt;
use rand_pcg::Pcg64;

use crate::antialias::LowPass;
use crate::error::ScenarioError;
use crate::plant::{Plant, StepInput};
use crate::pressure_sensor::PressureSensor;
use crate::road::{GRID_SPACING_M, Road, RoadError, Side};
use crate::scenario::{CornerSpec, Scenario};
use crate::sensor::Sensor;
use crate::streams::{Purpose, generator};
use crate::time_profile::TimeProfile;

/// Lowest rate of the fine grid in Hz.
const PLANT_RATE_HZ: f64 = 4000.0;

/// Steps of the fine grid per sample of the log, at least.
const STEPS_PER_SAMPLE: f64 = 8.0;

/// One row of a log with its truth. Signals are late by the anti-alias filter's group delay, the truth is not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimRow {
    /// Time of the sample in s; the first one is at 0 or, with a jittered clock, a little later.
    pub time_s: f64,
    /// Speed in m/s.
    pub speed_m_s: f64,
    /// Distance in m since 0 s, of the front axle.
    pub distance_m: f64,
    /// By [`Corner::index`]; `None` where the scenario has no such corner.
    pub corners: [Option<CornerRow>; 4],
}

/// One corner of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerRow {
    /// Logged sprung mass acceleration in m/s²; NaN when lost.
    pub body_accel_m_s2: f64,
    /// Logged unsprung mass acceleration in m/s²; NaN when lost.
    pub wheel_accel_m_s2: f64,
    /// True gauge pressure in kPa.
    pub pressure_kpa: f64,
    /// What a log holds as the pressure in kPa: the reading of the scenario's pressure sensor, or the true pressure
    /// where it has none.
    pub pressure_reading_kpa: f64,
    /// True tire stiffness in N/m.
    pub stiffness_n_per_m: f64,
    /// True road height in m under this wheel's axle: a point of the profile.
    pub road_m: f64,
    /// The same as the tire feels it, averaged over its contact length; equal to `road_m` for a point follower.
    pub contact_road_m: f64,
}

impl SimRow {
    /// What the estimator of one corner sees; `None` where the scenario has no such corner.
    #[must_use]
    pub fn sample(&self, corner: Corner) -> Option<Sample<f64, CornerSample<f64>>> {
        let row = self.corners[corner.index()].as_ref()?;
        Some(Sample { time_s: self.time_s, speed_m_s: self.speed_m_s, corners: row.sample() })
    }

    /// What the estimator of the whole car sees.
    #[must_use]
    pub fn car_sample(&self) -> Sample<f64, [Option<CornerSample<f64>>; 4]> {
        let corners = self.corners.map(|row| row.map(|r| r.sample()));
        Sample { time_s: self.time_s, speed_m_s: self.speed_m_s, corners }
    }
}

impl CornerRow {
    fn sample(&self) -> CornerSample<f64> {
        CornerSample { body_accel_m_s2: self.body_accel_m_s2, wheel_accel_m_s2: self.wheel_accel_m_s2 }
    }
}

/// A running drive: an iterator over its rows.
#[derive(Debug, Clone)]
pub struct Simulation {
    rate_hz: f64,
    steps_per_sample: i64,
    jitter: f64,
    clock: Pcg64,
    speed_m_s: TimeProfile,
    roads: Tracks,
    corners: Vec<CornerRun>,
    /// Fine-grid step reached.
    step: i64,
    row: u64,
    rows: u64,
}

/// The roads under the left and the right wheels, where there are any.
#[derive(Debug, Clone)]
struct Tracks {
    left: Option<Road>,
    right: Option<Road>,
}

impl Tracks {
    fn side(&mut self, side: Side) -> Option<&mut Road> {
        match side {
            Side::Left => self.left.as_mut(),
            Side::Right => self.right.as_mut(),
        }
    }
}

/// A corner in motion.
#[derive(Debug, Clone)]
struct CornerRun {
    corner: Corner,
    side: Side,
    /// How far behind the front axle, in m.
    behind_m: f64,
    pressure_kpa: TimeProfile,
    map: PressureMap<f64>,
    stiffness_factor: f64,
    plant: Plant,
    filters: [LowPass; 2],
    /// Filtered body and wheel acceleration at the last four fine-grid steps, oldest first.
    filtered: [[f64; 2]; 4],
    sensors: [Sensor; 2],
    pressure_sensor: Option<PressureSensor>,
    road_m: f64,
    stiffness_n_per_m: f64,
}

impl Simulation {
    /// Starts a drive. The same scenario and seed give the same rows; road, sensors, losses and clock draw from
    /// generators of their own, so that a change to one leaves the others as they were.
    ///
    /// # Errors
    /// A value out of range, or a road profile that cannot be read.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Self, ScenarioError> {
        scenario.validate()?;
        let invalid = |source| ScenarioError::Invalid { scenario: scenario.name.clone(), source };
        let rate_hz = scenario.rate_hz;
        let steps_per_sample = (PLANT_RATE_HZ / rate_hz - 1e-9).ceil().max(STEPS_PER_SAMPLE);
        let mut simulation = Self {
            rate_hz,
            steps_per_sample: steps_per_sample as i64,
            jitter: scenario.clock.jitter,
            clock: generator(seed, Purpose::Clock, [0, 0]),
            speed_m_s: scenario.speed.profile_m_s().map_err(invalid)?,
            roads: Tracks { left: None, right: None },
            corners: Vec::new(),
            step: -((scenario.settle_s * rate_hz * steps_per_sample).ceil() as i64),
            row: 0,
            rows: scenario.rows(),
        };
        simulation.lay_roads(scenario, seed)?;
        for (corner, spec) in scenario.corner.iter() {
            simulation.place_corner(scenario, corner, spec, seed).map_err(invalid)?;
        }
        Ok(simulation)
    }

    fn lay_roads(&mut self, scenario: &Scenario, seed: u64) -> Result<(), ScenarioError> {
        // Waves up to the log's rate at the drive's top speed: twice what a sample can tell from shorter ones.
        let spacing_m =
            (0.5 * self.speed_m_s.maximum() / self.rate_hz).clamp(GRID_SPACING_M / 8.0, GRID_SPACING_M);
        let lay = |side: Side| {
            if scenario.corner.iter().all(|(corner, _)| side_of(corner) != side) {
                return Ok(None);
            }
            let road = match scenario.one_speed_m_s() {
                Some(speed) => Road::at_speed(&scenario.road, side, seed, spacing_m, speed),
                None => Road::new(&scenario.road, side, seed, spacing_m),
            };
            road.map(Some).map_err(|e| match e {
                RoadError::Value(source) => {
                    ScenarioError::Invalid { scenario: scenario.name.clone(), source }
                }
                RoadError::Profile(source) => {
                    ScenarioError::Profile { scenario: scenario.name.clone(), source }
                }
            })
        };
        self.roads = Tracks { left: lay(Side::Left)?, right: lay(Side::Right)? };
        Ok(())
    }

    fn place_corner(
        &mut self,
        scenario: &Scenario,
        corner: Corner,
        spec: &CornerSpec,
        seed: u64,
    ) -> Result<(), crate::error::InvalidValue> {
        let side = side_of(corner);
        let behind_m = match corner {
            Corner::FrontLeft | Corner::FrontRight => 0.0,
            Corner::RearLeft | Corner::RearRight => scenario.wheelbase_m,
        };
        let time_s = self.time_s(self.step as f64);
        let distance_m = self.speed_m_s.integral(time_s) - behind_m;
        let road_m = self.roads.side(side).map_or(0.0, |road| road.contact_height_m(distance_m));
        let filter =
            LowPass::new(&scenario.antialias, self.rate_hz, self.rate_hz * self.steps_per_sample as f64);
        let number = 2 * corner.index() as u64;
        let body = spec.body_sensor.unwrap_or(scenario.sensor);
        let wheel = spec.wheel_sensor.unwrap_or(scenario.sensor);
        let mut run = CornerRun {
            corner,
            side,
            behind_m,
            pressure_kpa: spec.pressure.profile_kpa()?,
            map: spec.tire.map()?,
            stiffness_factor: spec.truth.tire_stiffness_factor,
            plant: Plant::new(&spec.quarter_car()?, &spec.truth, road_m)?,
            filters: [filter.clone(), filter],
            filtered: [[0.0; 2]; 4],
            sensors: [Sensor::new(&body, seed, number), Sensor::new(&wheel, seed, number + 1)],
            pressure_sensor: spec
                .pressure_sensor
                .map(|sensor| PressureSensor::new(&sensor, seed, corner.index() as u64)),
            road_m,
            stiffness_n_per_m: 0.0,
        };
        run.stiffness_n_per_m = run.true_stiffness_n_per_m(run.pressure_kpa.value(time_s));
        self.corners.push(run);
        Ok(())
    }

    /// Time in s of a (fractional) fine-grid step.
    fn time_s(&self, step: f64) -> f64 {
        step / (self.rate_hz * self.steps_per_sample as f64)
    }

    /// One step of the fine grid for all corners.
    fn advance(&mut self) {
        let step_s = self.time_s(1.0);
        let middle_m = self.speed_m_s.integral(self.time_s(self.step as f64 + 0.5));
        self.step += 1;
        let end_s = self.time_s(self.step as f64);
        let end_m = self.speed_m_s.integral(end_s);
        for run in &mut self.corners {
            if let Some(road) = self.roads.side(run.side) {
                let middle = road.contact_height_m(middle_m - run.behind_m);
                let end = road.contact_height_m(end_m - run.behind_m);
                run.step(step_s, [middle, end], end_s);
            }
        }
    }
}

impl CornerRun {
    fn true_stiffness_n_per_m(&self, pressure_kpa: f64) -> f64 {
        self.stiffness_factor * self.map.stiffness_n_per_m(pressure_kpa)
    }

    /// One step, to a time `end_s` with the road's heights in the middle and at the end.
    fn step(&mut self, step_s: f64, [middle, end]: [f64; 2], end_s: f64) {
        let stiffness = self.true_stiffness_n_per_m(self.pressure_kpa.value(end_s));
        let input = StepInput {
            road_m: [self.road_m, middle, end],
            stiffness_n_per_m: [self.stiffness_n_per_m, stiffness],
        };
        self.plant.step(step_s, &input);
        self.road_m = end;
        self.stiffness_n_per_m = stiffness;
        let [body, wheel] = self.plant.accelerations_m_s2();
        let [_, b, c, d] = self.filtered;
        self.filtered = [b, c, d, [self.filters[0].process(body), self.filters[1].process(wheel)]];
    }

    /// The log's row at a time, `fraction` of a fine-grid step after the second of the last four.
    fn read(&mut self, time_s: f64, distance_m: f64, fraction: f64, road: &mut Road) -> CornerRow {
        let [body, wheel] = [0, 1].map(|i| crate::road::cubic(self.filtered.map(|f| f[i]), fraction));
        let pressure_kpa = self.pressure_kpa.value(time_s);
        CornerRow {
            body_accel_m_s2: self.sensors[0].read(body),
            wheel_accel_m_s2: self.sensors[1].read(wheel),
            pressure_kpa,
            pressure_reading_kpa: self
                .pressure_sensor
                .as_mut()
                .map_or(pressure_kpa, |sensor| sensor.read(time_s, pressure_kpa)),
            stiffness_n_per_m: self.true_stiffness_n_per_m(pressure_kpa),
            road_m: road.height_m(distance_m - self.behind_m),
            contact_road_m: road.contact_height_m(distance_m - self.behind_m),
        }
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
        while self.step < whole + 2 {
            self.advance();
        }
        let time_s = (self.row as f64 + late) / self.rate_hz;
        let distance_m = self.speed_m_s.integral(time_s);
        let mut row =
            SimRow { time_s, speed_m_s: self.speed_m_s.value(time_s), distance_m, corners: [None; 4] };
        for run in &mut self.corners {
            if let Some(road) = self.roads.side(run.side) {
                row.corners[run.corner.index()] = Some(run.read(time_s, distance_m, fraction, road));
            }
        }
        self.row += 1;
        Some(row)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = (self.rows - self.row) as usize;
        (left, Some(left))
    }
}

impl ExactSizeIterator for Simulation {}

fn side_of(corner: Corner) -> Side {
    match corner {
        Corner::FrontLeft | Corner::RearLeft => Side::Left,
        Corner::FrontRight | Corner::RearRight => Side::Right,
    }
}
