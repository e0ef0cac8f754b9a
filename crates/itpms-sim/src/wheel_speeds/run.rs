//! The wheels of a drive in motion, and what the bus says of them.
//!
//! Called by the simulation, row by row. Time goes from message to message; a row sees the last one that came.

use itpms_core::model::WheelSpeedSample;
use rand::RngExt;
use rand_pcg::Pcg64;

use super::chassis::{Chassis, GRAVITY_M_S2, Moving};
use super::disturbance::{Rough, Shaken, Wander, normal};
use super::drawn::Drawn;
use super::motion_sensors::{MotionSensors, in_steps};
use super::spec::{DrivenWheels, WheelSpeedSpec};
use super::surface::{Ground, Surfaces};
use super::tire::slip;
use crate::car::motion::Motion;
use crate::error::Result;
use crate::scenario::Scenario;
use crate::streams::{Purpose, generator};
use crate::time_profile::TimeProfile;

/// Lengths over which grade and crown change, in m; times of wind and steering, in s.
const GRADE_M: f64 = 400.0;
const CROSS_SLOPE_M: f64 = 300.0;
const WIND_S: f64 = 20.0;
const STEERING_S: f64 = 2.0;
const SIDE_WIND_S: f64 = 5.0;
const STEEPEST_BANK: f64 = 0.07;
/// Slowest speed in m/s at which a wheel's teeth come often enough, and at which a driver steers.
const SLOWEST_M_S: f64 = 0.5;
const STEERED_M_S: f64 = 3.0;
/// Wheel hop and body in Hz with damping, and their shares of the load's vibration.
const HOP: [f64; 2] = [12.0, 0.2];
const BODY: [f64; 2] = [1.4, 0.3];
const BODY_SHARE: f64 = 0.2;
/// Speed in m/s for which the load's share holds, and the white part of a wheel's speed, as a share.
const SHAKEN_M_S: f64 = 20.0;
const WHITE: f64 = 2e-4;

/// Wheel speeds of a log's row, with the truth. NaN: not sent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelSpeedRow {
    /// Speeds of the wheels in m/s, in the order of `Corner::ALL`, each by the same assumed radius.
    pub wheel_speed_m_s: [f64; 4],
    /// Yaw rate in rad/s, positive to the left.
    pub yaw_rate_rad_s: f64,
    /// Acceleration forward in m/s², gravity along a grade included.
    pub accel_x_m_s2: f64,
    /// Acceleration to the left in m/s², gravity across included.
    pub accel_y_m_s2: f64,
    /// Whether the driver brakes, 0 or 1.
    pub brake: f64,
    pub pressure_kpa: [f64; 4],
    /// `ln` of the true rolling radii over the assumed one.
    pub ln_radius: [f64; 4],
}

impl WheelSpeedRow {
    /// The input of a monitor.
    pub fn sample(&self, time_s: f64) -> WheelSpeedSample<f64> {
        WheelSpeedSample {
            time_s,
            wheel_speed_m_s: self.wheel_speed_m_s,
            yaw_rate_rad_s: self.yaw_rate_rad_s,
            accel_x_m_s2: self.accel_x_m_s2,
            accel_y_m_s2: self.accel_y_m_s2,
            brake: self.brake.is_finite().then_some(self.brake > 0.5),
        }
    }
}

/// How the wheels roll at an instant, each of it over what it is of an unloaded car straight on, at the placard's pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rolled {
    pub(crate) way: [f64; 4],
    /// Rate at which each wheel turns, but for what shakes it.
    pub(crate) turns: [f64; 4],
    pub(crate) load: [f64; 4],
    pub(crate) slip_stiffness: [f64; 4],
}

impl Rolled {
    pub(crate) const FREELY: Self =
        Self { way: [1.0; 4], turns: [1.0; 4], load: [1.0; 4], slip_stiffness: [1.0; 4] };

    /// So far on the way to another one, 0 to 1.
    pub(crate) fn toward(&self, other: &Self, share: f64) -> Self {
        let between =
            |from: &[f64; 4], to: &[f64; 4]| [0, 1, 2, 3].map(|i| from[i] + share * (to[i] - from[i]));
        Self {
            way: between(&self.way, &other.way),
            turns: between(&self.turns, &other.turns),
            load: between(&self.load, &other.load),
            slip_stiffness: between(&self.slip_stiffness, &other.slip_stiffness),
        }
    }
}

/// A mass on board: over time, m behind the front axle, m to the left.
type Mass = (TimeProfile, [f64; 2]);

#[derive(Debug, Clone)]
pub(crate) struct WheelSpeedRun {
    spec: WheelSpeedSpec,
    chassis: Chassis,
    drawn: Drawn,
    speed_m_s: TimeProfile,
    motion: Motion,
    payload: Vec<Mass>,
    pressures_kpa: [TimeProfile; 4],
    radius_m: [f64; 4],
    rough: Rough,
    random: Pcg64,
    losses: Pcg64,
    across: Pcg64,
    grade: Wander,
    cross_slope: Wander,
    wind: Wander,
    steering: Wander,
    sensors: MotionSensors,
    surfaces: Surfaces,
    side_wind: Wander,
    /// The surface under the wheels of each side, and how far crown and bank fall to the right.
    ground: [Ground; 2],
    fall: f64,
    shaken: [[Shaken; 2]; 4],
    /// Messages so far, way at the last one in m, and what the last one that came held.
    messages: i64,
    distance_m: f64,
    row: Option<WheelSpeedRow>,
    rolled: Rolled,
}

impl WheelSpeedRun {
    /// Of a scenario without a journey; `None` where it has no wheel speeds.
    pub(crate) fn new(scenario: &Scenario, seed: u64) -> Result<Option<Self>> {
        let (Some(spec), Some(car)) = (scenario.wheel_speeds, &scenario.car) else { return Ok(None) };
        let of = &scenario.corner;
        let (Some(fl), Some(fr), Some(rl), Some(rr)) = (&of.fl, &of.fr, &of.rl, &of.rr) else {
            return Ok(None);
        };
        let corners = [fl, fr, rl, rr];
        let static_n = corners.map(|corner| {
            let sprung_kg = corner.sprung_mass_kg * corner.truth.sprung_mass_factor;
            GRAVITY_M_S2 * (sprung_kg + corner.unsprung_mass_kg * corner.truth.unsprung_mass_factor)
        });
        let speed_m_s = scenario.speed.profile_m_s()?;
        let payload = car.payload.iter().map(|p| Ok((p.mass_kg()?, [p.behind_front_m, p.left_m])));
        let mut random = generator(seed, Purpose::WheelSpeeds, [0, 0]);
        let step_s = 1e-3 * spec.period_ms;
        let [p0, p1, p2, p3] = corners.map(|corner| corner.pressure.profile_kpa());
        let drawn = Drawn::new(&spec, corners, static_n, seed);
        let mut across = generator(seed, Purpose::WheelConditions, [1, 0]);
        Ok(Some(Self {
            spec,
            chassis: Chassis::new(&spec, car, scenario.wheelbase_m, static_n),
            drawn,
            motion: Motion::new(car, &speed_m_s, scenario.wheelbase_m)?,
            distance_m: speed_m_s.integral(-1e-3 * spec.latency_ms),
            speed_m_s,
            payload: payload.collect::<Result<_>>()?,
            pressures_kpa: [p0?, p1?, p2?, p3?],
            radius_m: corners.map(|corner| corner.truth.rolling_radius_m),
            rough: Rough::new(&scenario.road),
            grade: Wander::new(spec.grade_sd, GRADE_M, &mut random),
            cross_slope: Wander::new(spec.cross_slope_sd, CROSS_SLOPE_M, &mut random),
            wind: Wander::new(spec.wind_m_s, WIND_S, &mut random),
            steering: Wander::new(spec.steering_m_s2, STEERING_S, &mut random),
            sensors: MotionSensors::new(&spec, &drawn, &mut random),
            surfaces: Surfaces::new(&spec.conditions, seed),
            side_wind: Wander::new(spec.conditions.side_wind_m_s, SIDE_WIND_S, &mut across),
            across,
            ground: [Ground::DRY; 2],
            fall: 0.0,
            random,
            losses: generator(seed, Purpose::WheelSpeeds, [1, 0]),
            shaken: [[HOP, BODY].map(|[hz, damping]| Shaken::new(hz, damping, step_s)); 4],
            messages: 0,
            row: None,
            rolled: Rolled::FREELY,
        }))
    }

    /// Latest values on the bus at a time in s; times go forward.
    pub(crate) fn read(&mut self, time_s: f64) -> Option<WheelSpeedRow> {
        let step_s = 1e-3 * self.spec.period_ms;
        // Rounding does not make a message late.
        while self.messages as f64 * step_s <= time_s + 1e-9 {
            let message = self.message(self.messages as f64 * step_s - 1e-3 * self.spec.latency_ms, step_s);
            let lost = self.losses.random::<f64>() < self.spec.lost_share;
            if !lost || self.row.is_none() {
                self.row = Some(message);
            }
            self.messages += 1;
        }
        self.row
    }

    /// By how much each wheel's imbalance turned over what the car's way makes of it at the last message.
    pub(crate) fn imbalance_turns(&self) -> [f64; 4] {
        if self.spec.turns_imbalance { self.rolled.turns } else { [1.0; 4] }
    }

    /// How the wheels roll at the next message, and when that is, in s.
    pub(crate) fn roll(&mut self) -> (f64, Rolled) {
        let step_s = 1e-3 * self.spec.period_ms;
        let time_s = self.messages as f64 * step_s;
        self.message(time_s, step_s);
        self.messages += 1;
        (time_s, self.rolled)
    }

    /// How the car moves a message later.
    fn moving(&mut self, time_s: f64, step_s: f64) -> Moving {
        let speed_m_s = self.speed_m_s.value(time_s);
        let distance_m = self.speed_m_s.integral(time_s);
        let way_m = distance_m - self.distance_m;
        self.distance_m = distance_m;
        let random = &mut self.random;
        let steering = self.steering.step(step_s, random);
        let [along, across] = self.motion.car_m_s2(time_s);
        let (ground, crown) = self.surfaces.step(distance_m, step_s, speed_m_s);
        self.ground = ground;
        // A bend's bank falls to its inner side.
        let bank = self.spec.conditions.bank * across / GRAVITY_M_S2;
        self.fall = crown - bank.clamp(-STEEPEST_BANK, STEEPEST_BANK);
        Moving {
            speed_m_s,
            accel_m_s2: [along, if speed_m_s > STEERED_M_S { across + steering } else { across }],
            grade: self.grade.step(way_m, random),
            cross_slope: self.cross_slope.step(way_m, random) + self.fall,
            wind_m_s: self.wind.step(step_s, random),
            side_wind_m_s: self.side_wind.step(step_s, &mut self.across),
            rolling: ground.map(|ground| ground.rolling),
        }
    }

    fn message(&mut self, time_s: f64, step_s: f64) -> WheelSpeedRow {
        let moving = self.moving(time_s, step_s);
        let v = moving.speed_m_s;
        let payload =
            self.payload.iter().map(|(kg, [behind_m, left_m])| [kg.value(time_s), *behind_m, *left_m]);
        let loads_n = self.chassis.loads_n(&moving, payload);
        let pressure_kpa = [0, 1, 2, 3].map(|i| self.pressures_kpa[i].value(time_s));
        let ln_radius = [0, 1, 2, 3].map(|i| {
            let load = loads_n[i] / self.chassis.static_n[i];
            self.drawn.tires[i].ln_radius(load, pressure_kpa[i], v) - self.worn(i)
        });
        let forces = self.chassis.forces_n(&moving, &loads_n, &self.drawn.brakes);
        let braked = forces.brake_n.iter().any(|n| *n < 0.0) || v < SLOWEST_M_S;
        let curvature = if v > SLOWEST_M_S { moving.accel_m_s2[1] / (v * v) } else { 0.0 };
        let mass_kg = loads_n.iter().sum::<f64>() / GRAVITY_M_S2;
        let lateral_m_s2 = moving.accel_m_s2[1] + GRAVITY_M_S2 * self.fall - moving.side_n() / mass_kg;
        let ways = self.chassis.ways(curvature, lateral_m_s2);
        let ways = [0, 1, 2, 3].map(|i| ways[i] * (1.0 + self.ground[i % 2].way));
        let slips = self.slips(&forces.engine_n, &forces.brake_n, &loads_n, &pressure_kpa, &ln_radius, &ways);
        let stiffness = |i: usize, load_n: f64, kpa: f64| self.drawn.tires[i].slip_stiffness_n(load_n, kpa);
        let ground = self.ground;
        let placard_kpa = |i: usize| self.drawn.tires[i].placard_kpa;
        let static_n = self.chassis.static_n;
        self.rolled = Rolled {
            way: ways,
            turns: [0, 1, 2, 3].map(|i| ways[i] * (1.0 + slips[i]) * (-ln_radius[i]).exp()),
            load: [0, 1, 2, 3].map(|i| loads_n[i] / static_n[i]),
            slip_stiffness: [0, 1, 2, 3].map(|i| {
                ground[i % 2].stiffness * stiffness(i, loads_n[i], pressure_kpa[i])
                    / stiffness(i, static_n[i], placard_kpa(i))
            }),
        };
        let shaken = self.shaken(v);
        let speed = |i: usize| {
            let exact = v * ways[i] * (1.0 + slips[i]) * (shaken[i] - ln_radius[i]).exp();
            if v > SLOWEST_M_S { in_steps(exact, self.spec.resolution_km_h / 3.6) } else { 0.0 }
        };
        let wheel_speed_m_s = [0, 1, 2, 3].map(speed);
        let [yaw_rate_rad_s, accel_x_m_s2, accel_y_m_s2] =
            self.sensors.read(&moving, v * curvature, step_s, &mut self.random);
        let brake = if self.spec.brake { f64::from(u8::from(braked)) } else { f64::NAN };
        WheelSpeedRow {
            wheel_speed_m_s,
            yaw_rate_rad_s,
            accel_x_m_s2,
            accel_y_m_s2,
            brake,
            pressure_kpa,
            ln_radius,
        }
    }

    /// Share of a wheel's radius that its tread has lost.
    fn worn(&self, wheel: usize) -> f64 {
        let driven = match self.spec.driven {
            DrivenWheels::Front => wheel < 2,
            DrivenWheels::Rear => wheel >= 2,
            DrivenWheels::All => true,
        };
        let factor = if driven { 2.0 } else { 1.0 };
        factor
            * self.drawn.wear[wheel]
            * self.spec.wear_per_km
            * (self.spec.conditions.odometer_km + 1e-3 * self.distance_m)
    }

    fn slips(
        &self,
        engine_n: &[f64; 2],
        brake_n: &[f64; 4],
        loads_n: &[f64; 4],
        pressure_kpa: &[f64; 4],
        ln_radius: &[f64; 4],
        ways: &[f64; 4],
    ) -> [f64; 4] {
        let stiffness_n = [0, 1, 2, 3].map(|i| {
            let tire = &self.drawn.tires[i];
            self.ground[i % 2].stiffness * tire.slip_stiffness_n(loads_n[i], pressure_kpa[i])
        });
        let mut slips = [0.0; 4];
        for axle in 0..2 {
            let (left, right) = (2 * axle, 2 * axle + 1);
            let free = (ways[left] / ways[right]).ln() - (ln_radius[left] - ln_radius[right]);
            let slips_of = |forces_n: [f64; 2]| {
                [(left, forces_n[0]), (right, forces_n[1])].map(|(i, engine_n)| {
                    let ground = &self.ground[i % 2];
                    // What nothing turns is held back by what it rolls on.
                    let held_n = if engine_n == 0.0 { ground.rolling * loads_n[i] } else { 0.0 };
                    let force_n = engine_n + brake_n[i] - held_n;
                    slip(force_n, loads_n[i], stiffness_n[i], ground.friction)
                })
            };
            // An axle that is not driven has no differential.
            let engine = if engine_n[axle] == 0.0 {
                [0.0; 2]
            } else {
                let stiffness_n = [stiffness_n[left], stiffness_n[right]];
                self.chassis.shared_n(engine_n[axle], free, stiffness_n, slips_of)
            };
            [slips[left], slips[right]] = slips_of(engine);
        }
        slips
    }

    /// By what share each wheel turns faster than its radius and slip say: loads that swing, wheels that are not round, noise.
    fn shaken(&mut self, speed_m_s: f64) -> [f64; 4] {
        let amplitude = self.spec.load_share
            * self.rough.amplitude(self.distance_m)
            * (speed_m_s / SHAKEN_M_S).max(0.0).sqrt();
        let mut shaken = [0.0; 4];
        for (i, (shaken, [hop, body])) in shaken.iter_mut().zip(&mut self.shaken).enumerate() {
            let load = hop.step(&mut self.random) + BODY_SHARE * body.step(&mut self.random);
            let [round, phase] = self.drawn.out_of_round[i];
            *shaken = self.drawn.tires[i].per_ln_load * amplitude * load
                + round * (self.distance_m / self.radius_m[i] + phase).cos()
                + WHITE * normal(&mut self.random);
        }
        shaken
    }
}
