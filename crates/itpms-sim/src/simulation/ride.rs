//! The masses of a drive: quarter cars on their own, or a whole car with its load, its turning and its wheels' imbalance.
//!
//! Called by the simulation, which knows roads and sensors; this knows none of them.

use itpms_core::model::QuarterCar;
use rand::RngExt;

use crate::car::motion::Motion;
use crate::car::{CarSpec, Payload};
use crate::error::Result;
use crate::plant::{CarInput, Deviations, FullCar, Plant, StepInput};
use crate::scenario::Scenario;
use crate::streams::{Purpose, generator};
use crate::time_profile::TimeProfile;

/// One step of the fine grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    pub(crate) start_s: f64,
    pub(crate) step_s: f64,
    /// The front axle's distance in m at its start, middle and end.
    pub(crate) front_m: [f64; 3],
    /// By how much each wheel's imbalance turns over what the way and its radius make of it: slip, bends, loads.
    pub(crate) turns: [f64; 4],
}

/// The masses, by `Corner::index`.
#[derive(Debug, Clone)]
pub(crate) enum Ride {
    Quarters { plants: Box<[Option<Plant>; 4]>, rear_offset_m: f64 },
    Car(Box<CarRide>),
}

impl Ride {
    /// At rest on roads of the given heights and tires of the given stiffness, `[m, N/m]`, at a time in s.
    pub(crate) fn new(
        scenario: &Scenario,
        speed_m_s: &TimeProfile,
        seed: u64,
        start_s: f64,
        places: [[f64; 2]; 4],
    ) -> Result<Self> {
        if let Some(car) = &scenario.car {
            return Ok(Ride::Car(Box::new(CarRide::new(scenario, car, speed_m_s, seed, start_s, places)?)));
        }
        let mut plants = Box::new([None, None, None, None]);
        for (corner, spec) in scenario.corner.iter() {
            let [road_m, _] = places[corner.index()];
            plants[corner.index()] = Some(Plant::new(&spec.quarter_car()?, &spec.truth, road_m)?);
        }
        Ok(Ride::Quarters { plants, rear_offset_m: scenario.rear_offset_m })
    }

    /// How far to the left of the front wheels' track the rear ones run now, in m, left and right.
    pub(crate) fn beside_m(&self) -> [f64; 2] {
        match self {
            Ride::Quarters { rear_offset_m, .. } => [*rear_offset_m; 2],
            Ride::Car(ride) => ride.beside_m(),
        }
    }

    /// Turns the car on to the end of a step, which moves its rear wheels sideways.
    pub(crate) fn turn(&mut self, step: &Step) {
        if let Ride::Car(ride) = self {
            ride.motion.advance(step.start_s + step.step_s, step.step_s);
        }
    }

    /// Tire loads in N at the end of a step with these inputs.
    pub(crate) fn tires_n(&self, inputs: &[StepInput; 4]) -> [f64; 4] {
        let road_m = inputs.map(|input| input.road_m[2]);
        let stiffness_n_per_m = inputs.map(|input| input.stiffness_n_per_m[1]);
        match self {
            Ride::Quarters { plants, .. } => [0, 1, 2, 3].map(|i| {
                plants[i].as_ref().map_or(0.0, |plant| plant.tire_n(road_m[i], stiffness_n_per_m[i]))
            }),
            Ride::Car(ride) => ride.car.tires_n(road_m, stiffness_n_per_m),
        }
    }

    /// Acceleration of the car in m/s² forward at the end of the last step; quarter cars have none.
    pub(crate) fn forward_m_s2(&self) -> f64 {
        match self {
            Ride::Quarters { .. } => 0.0,
            Ride::Car(ride) => ride.reached.car_m_s2[0],
        }
    }

    /// Moves the masses by a step; accelerations in m/s² of body and wheel at each corner at its end.
    pub(crate) fn step(&mut self, step: &Step, inputs: &[StepInput; 4]) -> [[f64; 2]; 4] {
        match self {
            Ride::Quarters { plants, .. } => {
                let mut accelerations = [[0.0; 2]; 4];
                for ((plant, input), acceleration) in plants.iter_mut().zip(inputs).zip(&mut accelerations) {
                    if let Some(plant) = plant {
                        plant.step(step.step_s, input);
                        *acceleration = plant.accelerations_m_s2();
                    }
                }
                accelerations
            }
            Ride::Car(ride) => ride.step(step, inputs),
        }
    }
}

#[derive(Debug, Clone)]
pub(crate) struct CarRide {
    car: FullCar,
    motion: Motion,
    payload: Payload,
    speed_m_s: TimeProfile,
    wheels: Imbalance,
    /// Distance of each wheel beyond the front axle's in m.
    beyond_m: [f64; 4],
    wider_m: [f64; 2],
    /// Where the last step ended.
    reached: Reached,
}

/// Inputs of a car beside its roads at one instant.
#[derive(Debug, Clone, Copy)]
struct Reached {
    car_m_s2: [f64; 2],
    wheel_force_n: [f64; 4],
}

/// Imbalance of the wheels.
#[derive(Debug, Clone, Copy)]
struct Imbalance {
    per_radius_m: [f64; 4],
    /// Mass times radius in kg m where the wheel is at distance zero, and a quarter turn later: the cosine and sine of its angle there.
    kg_m: [[f64; 2]; 4],
}

impl CarRide {
    fn new(
        scenario: &Scenario,
        spec: &CarSpec,
        speed_m_s: &TimeProfile,
        seed: u64,
        start_s: f64,
        places: [[f64; 2]; 4],
    ) -> Result<Self> {
        let mut corners = [(QuarterCar::paper_table_2(), Deviations::default()); 4];
        for (corner, of) in scenario.corner.iter() {
            corners[corner.index()] = (of.quarter_car()?, of.truth);
        }
        let body = spec.body(
            scenario.wheelbase_m,
            corners.map(|(nominal, truth)| nominal.sprung_mass_kg() * truth.sprung_mass_factor),
        );
        let roads_m = places.map(|[road_m, _]| road_m);
        let mut car = FullCar::new(&body, &corners, roads_m)?;
        let mut payload = Payload::new(spec, &body)?;
        if let Some(loads) = payload.changed(start_s) {
            car.load(&loads);
        }
        car.settle(roads_m, places.map(|[_, stiffness]| stiffness));
        let motion = Motion::new(spec, speed_m_s, scenario.wheelbase_m)?;
        let wheels = Imbalance::new(&corners, seed);
        let (speed, front_m) = (speed_m_s.value(start_s), speed_m_s.integral(start_s));
        Ok(Self {
            car,
            reached: Reached {
                car_m_s2: motion.car_m_s2(start_s),
                wheel_force_n: wheels.forces_n([speed; 4], [front_m; 4]),
            },
            motion,
            payload,
            speed_m_s: speed_m_s.clone(),
            wheels,
            beyond_m: [0.0; 4],
            wider_m: spec.wider_m(),
        })
    }

    fn beside_m(&self) -> [f64; 2] {
        self.wider_m.map(|wider_m| self.motion.beside_m() + wider_m)
    }

    fn step(&mut self, step: &Step, inputs: &[StepInput; 4]) -> [[f64; 2]; 4] {
        let end_s = step.start_s + step.step_s;
        if let Some(loads) = self.payload.changed(end_s) {
            self.car.load(&loads);
        }
        let [middle_m_s, end_m_s] =
            [step.start_s + 0.5 * step.step_s, end_s].map(|time_s| self.speed_m_s.value(time_s));
        let [start_m, middle_m, end_m] = step.front_m;
        let start = self.reached;
        let beyond_m = self.beyond_m;
        let at = |front_m: f64| {
            [0, 1, 2, 3].map(|i| front_m + beyond_m[i] + (step.turns[i] - 1.0) * (front_m - start_m))
        };
        let rolling = |speed_m_s: f64| step.turns.map(|turns| turns * speed_m_s);
        let middle_n = self.wheels.forces_n(rolling(middle_m_s), at(middle_m));
        let end_n = self.wheels.forces_n(rolling(end_m_s), at(end_m));
        self.beyond_m = [0, 1, 2, 3].map(|i| beyond_m[i] + (step.turns[i] - 1.0) * (end_m - start_m));
        self.reached = Reached { car_m_s2: self.motion.car_m_s2(end_s), wheel_force_n: end_n };
        let end = self.reached;
        // Accelerations are straight within a step but for the points of their profiles.
        let halfway = [0, 1].map(|i| 0.5 * (start.car_m_s2[i] + end.car_m_s2[i]));
        let force = |i: usize| [start.wheel_force_n[i], middle_n[i], end.wheel_force_n[i]];
        self.car.step(
            step.step_s,
            &CarInput {
                road_m: inputs.map(|input| input.road_m),
                stiffness_n_per_m: inputs.map(|input| input.stiffness_n_per_m),
                wheel_force_n: [0, 1, 2, 3].map(force),
                car_m_s2: [start.car_m_s2, halfway, end.car_m_s2],
            },
        );
        self.car.accelerations_m_s2()
    }
}

impl Imbalance {
    /// Of wheels that stand anyhow at distance zero.
    fn new(corners: &[(QuarterCar<f64>, Deviations); 4], seed: u64) -> Self {
        let kg_m = |i: usize| {
            let turn = generator(seed, Purpose::Imbalance, [i as u64, 0]).random::<f64>();
            let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
            [cos, sin].map(|part| corners[i].1.imbalance_kg_m * part)
        };
        Self {
            per_radius_m: corners.map(|(_, truth)| truth.rolling_radius_m.recip()),
            kg_m: [0, 1, 2, 3].map(kg_m),
        }
    }

    /// Vertical forces in N at the wheels' speeds in m/s and ways in m: `U ω² cos(angle)`.
    fn forces_n(&self, speed_m_s: [f64; 4], way_m: [f64; 4]) -> [f64; 4] {
        // Wheels that have turned alike are at one angle.
        let mut turned = (f64::NAN, (0.0, 0.0));
        let mut forces = [0.0; 4];
        for (i, force) in forces.iter_mut().enumerate() {
            let (per_radius_m, [cos_kg_m, sin_kg_m]) = (self.per_radius_m[i], self.kg_m[i]);
            if cos_kg_m == 0.0 && sin_kg_m == 0.0 {
                continue;
            }
            let angle = way_m[i] * per_radius_m;
            if turned.0 != angle {
                turned = (angle, angle.sin_cos());
            }
            let (sin, cos) = turned.1;
            let rad_per_s = speed_m_s[i] * per_radius_m;
            *force = rad_per_s * rad_per_s * (cos_kg_m * cos - sin_kg_m * sin);
        }
        forces
    }
}
