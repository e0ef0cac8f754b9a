//! A corner in motion: its tire's pressure, its place on the road, its sensors.
//!
//! Called by the simulation, which moves the masses (the corner does not know whether they are its own).

use itpms_core::model::{Corner, PressureMap};

use super::fore_aft::ForeAft;
use super::history::History;
use super::row::CornerRow;
use crate::antialias::LowPass;
use crate::error::Result;
use crate::plant::StepInput;
use crate::pressure_sensor::PressureSensor;
use crate::road::{Lane, Side};
use crate::scenario::{CornerSpec, Scenario};
use crate::sensor::Sensor;
use crate::time_profile::TimeProfile;

/// Way in m within half a step below which a car stands.
const STANDING_M: f64 = 1e-6;

#[derive(Debug, Clone)]
pub(crate) struct CornerRun {
    pub(crate) corner: Corner,
    pub(crate) side: Side,
    /// How far behind the front axle, in m.
    pub(crate) behind_m: f64,
    /// How far to the left of the front wheels' track, in m.
    pub(crate) beside_m: f64,
    pressure_kpa: TimeProfile,
    map: PressureMap<f64>,
    stiffness_factor: f64,
    ground_n_per_m: f64,
    /// Readings of body and wheel sensor for vertical and fore-aft accelerations.
    directions: [[f64; 2]; 2],
    /// The wheel's fore-aft motion, where a sensor reads of it.
    fore_aft: Option<ForeAft>,
    /// Of the road, over the step reached.
    slope: f64,
    filters: [LowPass; 2],
    filtered: [History; 2],
    sensors: [Sensor; 2],
    pressure_sensor: Option<PressureSensor>,
    /// Road and tire at the step reached.
    road_m: f64,
    stiffness_n_per_m: f64,
}

impl CornerRun {
    /// A corner that is placed on the road later; `fine_hz` is the fine grid's rate.
    pub(crate) fn new(
        scenario: &Scenario,
        corner: Corner,
        spec: &CornerSpec,
        seed: u64,
        fine_hz: f64,
    ) -> Result<Self> {
        let filter = LowPass::new(&scenario.antialias, scenario.rate_hz, fine_hz);
        let number = 2 * corner.index() as u64;
        let body = spec.body_sensor.unwrap_or(scenario.sensor);
        let wheel = spec.wheel_sensor.unwrap_or(scenario.sensor);
        Ok(Self {
            corner,
            side: side_of(corner),
            behind_m: if is_rear(corner) { scenario.wheelbase_m } else { 0.0 },
            beside_m: 0.0,
            pressure_kpa: spec.pressure.profile_kpa()?,
            map: spec.tire.map()?,
            stiffness_factor: spec.truth.tire_stiffness_factor,
            ground_n_per_m: scenario.road.ground_n_per_m.unwrap_or(f64::INFINITY),
            directions: [body.directions(), wheel.directions()],
            fore_aft: (wheel.directions()[1] != 0.0)
                .then(|| ForeAft::new(spec.unsprung_mass_kg * spec.truth.unsprung_mass_factor)),
            slope: 0.0,
            filters: [filter.clone(), filter],
            filtered: [body, wheel].map(|sensor| History::new(1e-3 * sensor.delay_ms * fine_hz)),
            sensors: [Sensor::new(&body, seed, number), Sensor::new(&wheel, seed, number + 1)],
            pressure_sensor: spec
                .pressure_sensor
                .map(|sensor| PressureSensor::new(&sensor, seed, corner.index() as u64)),
            road_m: 0.0,
            stiffness_n_per_m: 0.0,
        })
    }

    /// Puts the corner where the drive starts: its road's height in m and its tire's stiffness in N/m there.
    pub(crate) fn place(&mut self, time_s: f64, front_m: f64, lane: Option<&mut Lane>) -> [f64; 2] {
        let distance_m = front_m - self.behind_m;
        self.road_m = lane.map_or(0.0, |lane| lane.contact_height_m(distance_m, self.beside_m));
        self.stiffness_n_per_m = self.contact_stiffness_n_per_m(time_s);
        [self.road_m, self.stiffness_n_per_m]
    }

    /// Of the tire on the ground at a time: where that is soft, both give way.
    fn contact_stiffness_n_per_m(&self, time_s: f64) -> f64 {
        let tire = self.true_stiffness_n_per_m(self.pressure_kpa.value(time_s));
        if self.ground_n_per_m.is_finite() { 1.0 / (1.0 / tire + 1.0 / self.ground_n_per_m) } else { tire }
    }

    fn true_stiffness_n_per_m(&self, pressure_kpa: f64) -> f64 {
        self.stiffness_factor * self.map.stiffness_n_per_m(pressure_kpa)
    }

    /// Rolls on to a time `end_s`: the front axle's distances in the middle and at the end of the step, and how far
    /// beside the front wheels' track this one is at its end.
    pub(crate) fn roll(
        &mut self,
        [middle_m, end_m]: [f64; 2],
        beside_m: f64,
        end_s: f64,
        lane: &mut Lane,
    ) -> StepInput {
        let halftraveled_m = 0.5 * (self.beside_m + beside_m);
        let middle = lane.contact_height_m(middle_m - self.behind_m, halftraveled_m);
        let end = lane.contact_height_m(end_m - self.behind_m, beside_m);
        let stiffness = self.contact_stiffness_n_per_m(end_s);
        if self.fore_aft.is_some() {
            let traveled_m = end_m - middle_m;
            self.slope = if traveled_m > STANDING_M { (end - middle) / traveled_m } else { 0.0 };
        }
        let input = StepInput {
            road_m: [self.road_m, middle, end],
            stiffness_n_per_m: [self.stiffness_n_per_m, stiffness],
        };
        self.beside_m = beside_m;
        self.road_m = end;
        self.stiffness_n_per_m = stiffness;
        input
    }

    /// Whether a sensor reads of fore-aft accelerations.
    pub(crate) fn leans(&self) -> bool {
        self.directions.iter().any(|[_, fore_aft]| *fore_aft != 0.0)
    }

    /// Takes in the true accelerations of body and wheel at the step's end.
    pub(crate) fn sense(&mut self, accelerations_m_s2: [f64; 2]) {
        let filters = self.filters.iter_mut().zip(&mut self.filtered);
        for ((filter, filtered), acceleration) in filters.zip(accelerations_m_s2) {
            filtered.push(filter.process(acceleration));
        }
    }

    /// The same where a sensor leans: the car's acceleration forward and what the tire carries in N go in.
    pub(crate) fn sense_leaning(&mut self, vertical_m_s2: [f64; 2], step_s: f64, car_m_s2: f64, tire_n: f64) {
        let slope = self.slope;
        let wheel_m_s2 = self.fore_aft.as_mut().map_or(0.0, |wheel| wheel.step(step_s, slope, tire_n));
        let forward_m_s2 = [car_m_s2, car_m_s2 + wheel_m_s2];
        let read = |i: usize| {
            let [vertical, fore_aft] = self.directions[i];
            vertical * vertical_m_s2[i] + fore_aft * forward_m_s2[i]
        };
        self.sense([read(0), read(1)]);
    }

    /// The log's row at a time, `fraction` of a fine-grid step after the second of the last four.
    pub(crate) fn read(&mut self, time_s: f64, front_m: f64, fraction: f64, lane: &mut Lane) -> CornerRow {
        let [body, wheel] = [0, 1].map(|i| self.filtered[i].read(fraction));
        let pressure_kpa = self.pressure_kpa.value(time_s);
        let distance_m = front_m - self.behind_m;
        CornerRow {
            body_accel_m_s2: self.sensors[0].read(body),
            wheel_accel_m_s2: self.sensors[1].read(wheel),
            pressure_kpa,
            pressure_reading_kpa: self
                .pressure_sensor
                .as_mut()
                .map_or(pressure_kpa, |sensor| sensor.read(time_s, pressure_kpa)),
            stiffness_n_per_m: self.true_stiffness_n_per_m(pressure_kpa),
            road_m: lane.height_m(distance_m, self.beside_m),
            contact_road_m: lane.contact_height_m(distance_m, self.beside_m),
        }
    }
}

pub(crate) fn side_of(corner: Corner) -> Side {
    match corner {
        Corner::FrontLeft | Corner::RearLeft => Side::Left,
        Corner::FrontRight | Corner::RearRight => Side::Right,
    }
}

pub(crate) fn is_rear(corner: Corner) -> bool {
    matches!(corner, Corner::RearLeft | Corner::RearRight)
}
