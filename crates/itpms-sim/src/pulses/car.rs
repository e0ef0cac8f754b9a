//! The tooth pulses of a scenario's drive; `docs/math/simulation.md`, "Tooth pulses".
//!
//! Speed, pressures and roads are the scenario's; bends, loads, slip and radii those of its wheel speeds, where it has them: without, it goes
//! straight on. Tires and rims differ from car to car, all that an estimator is given being those of no car in particular.

use super::{PulseSpec, PulseWheel, Rolling};
use crate::error::{InvalidValue, ScenarioError};
use crate::scenario::Scenario;
use crate::streams::{Purpose, generator};
use crate::time_profile::TimeProfile;
use crate::wheel_speeds::{Rolled, Rough, WheelSpeedRun, normal};

/// By how much cars differ: sidewall, rim, slip stiffness as shares, the air's share; and sidewalls of one car.
const SIDEWALL_SD: f64 = 0.08;
const RIM_SD: f64 = 0.05;
const SLIP_SD: f64 = 0.1;
const AIR_SHARE_SD: f64 = 0.03;
const SAME_CAR_SD: f64 = 0.02;

/// Four wheels on their way.
#[derive(Debug, Clone)]
pub struct PulseCar {
    wheels: [PulseWheel; 4],
    pressures_kpa: [TimeProfile; 4],
    speed_m_s: TimeProfile,
    rough: Rough,
    wheel_speeds: Option<WheelSpeedRun>,
    /// How the wheels rolled and will roll, each with its time in s: between two messages of the wheel speeds.
    rolled: [(f64, Rolled); 2],
    passed: Vec<(f64, usize)>,
}

impl PulseCar {
    /// The drive of a scenario with four corners; `car_seed` makes the car, `seed` its road and its noise.
    /// Errors: a scenario without one of the corners, or with a value out of range.
    pub fn new(scenario: &Scenario, car_seed: u64, seed: u64) -> Result<Self, ScenarioError> {
        let mut scenario = scenario.composed(seed)?;
        // The wheels' present motion, whenever the bus sends it.
        if let Some(bus) = &mut scenario.wheel_speeds {
            bus.latency_ms = 0.0;
        }
        let invalid = |source| ScenarioError::Invalid { scenario: scenario.name.clone(), source };
        let of = &scenario.corner;
        let (Some(fl), Some(fr), Some(rl), Some(rr)) = (&of.fl, &of.fr, &of.rl, &of.rr) else {
            let found = format!("of {} corners", scenario.corner.iter().count());
            return Err(invalid(InvalidValue::new("corner", found, "all four, for tooth pulses")));
        };
        let corners = [fl, fr, rl, rr];
        let mut random = generator(car_seed, Purpose::WheelCar, [2, 0]);
        let mut times = |value: f64, sd: f64| value * (1.0 + sd * normal(&mut random)).max(0.5);
        let usual = PulseSpec::default();
        let sidewall_n_m = times(usual.sidewall_n_m, SIDEWALL_SD);
        let car = PulseSpec {
            rim_kg_m2: times(usual.rim_kg_m2, RIM_SD),
            slip_stiffness_n: times(usual.slip_stiffness_n, SLIP_SD),
            air_share: times(usual.air_share, AIR_SHARE_SD / usual.air_share),
            ..usual
        };
        let wheels = [0, 1, 2, 3].map(|wheel: usize| {
            let spec = PulseSpec {
                radius_m: corners[wheel].truth.rolling_radius_m,
                sidewall_n_m: times(sidewall_n_m, SAME_CAR_SD),
                ..car
            };
            PulseWheel::of_car(&spec, car_seed, seed, wheel as u64)
        });
        let [a, b, c, d] = corners.map(|corner| corner.pressure.profile_kpa());
        let pressures_kpa =
            [a.map_err(invalid)?, b.map_err(invalid)?, c.map_err(invalid)?, d.map_err(invalid)?];
        let speed_m_s = scenario.speed.profile_m_s().map_err(invalid)?;
        Ok(Self {
            wheels,
            pressures_kpa,
            speed_m_s,
            rough: Rough::new(&scenario.road),
            wheel_speeds: WheelSpeedRun::new(&scenario, seed).map_err(invalid)?,
            rolled: [(f64::NEG_INFINITY, Rolled::FREELY); 2],
            passed: vec![],
        })
    }

    /// On to a time in s: `pulse` takes wheel, in the order of `Corner::ALL`, and time of each edge that passes, in the order of time.
    pub fn until(&mut self, time_s: f64, mut pulse: impl FnMut(usize, f64)) {
        while self.wheels[0].time_s() < time_s {
            let now_s = self.wheels[0].time_s();
            let speed_m_s = self.speed_m_s.value(now_s);
            let amplitude = self.rough.amplitude(self.speed_m_s.integral(now_s));
            let Rolled { way, turns, load, slip_stiffness } = self.rolled_at(now_s);
            for (i, (wheel, pressure)) in self.wheels.iter_mut().zip(&self.pressures_kpa).enumerate() {
                let rolling = Rolling {
                    speed_m_s: speed_m_s * way[i],
                    pressure_kpa: pressure.value(now_s),
                    turns: turns[i] / way[i],
                    load: load[i],
                    slip_stiffness: slip_stiffness[i],
                    amplitude,
                };
                let passed = &mut self.passed;
                wheel.step(&rolling, &mut |at_s| passed.push((at_s, i)));
            }
            self.passed.sort_by(|a, b| a.0.total_cmp(&b.0));
            self.passed.drain(..).for_each(|(at_s, wheel)| pulse(wheel, at_s));
        }
    }

    fn rolled_at(&mut self, time_s: f64) -> Rolled {
        let Some(wheel_speeds) = &mut self.wheel_speeds else { return Rolled::FREELY };
        while self.rolled[1].0 <= time_s {
            self.rolled = [self.rolled[1], wheel_speeds.roll()];
        }
        let [(from_s, from), (to_s, to)] = &self.rolled;
        let share = (time_s - from_s) / (to_s - from_s);
        if share.is_finite() { from.toward(to, share) } else { *to }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::Simulation;

    /// Over a bend the edges of each wheel come as often as its speed on the bus, which is that of a wheel of its radius, says.
    #[test]
    fn pulses_and_the_bus_are_of_the_same_wheels() {
        const FROM_S: f64 = 12.0;
        const TO_S: f64 = 28.0;
        let text = format!(
            "{}\n[wheel_speeds]\nalone = true\nresolution_km_h = 0.0\nradius_sd = 0.0\nlost_share = 0.0\nlatency_ms = 0.0\n",
            "name = \"bend\"\nduration_s = 30.0\nrate_hz = 50.0\nspeed.constant_km_h = 60.0\nroad.surface.iso8608.roughness = \"A\"\n\
             [car]\nlateral_points_s_m_s2 = [[10.0, 0.0], [20.0, 1.0], [30.0, 0.0]]\n\
             [corner.fl.pressure]\npoints_s_kpa = [[5.0, 241.3], [10.0, 180.0]]\n[corner.fr.pressure]\nconstant_kpa = 241.3\n\
             [corner.rl.pressure]\nconstant_kpa = 241.3\n[corner.rr.pressure]\nconstant_kpa = 241.3\n"
        );
        let scenario = Scenario::from_toml(&text, "test").unwrap();
        let mut edges = [0.0; 4];
        PulseCar::new(&scenario, 3, 3).unwrap().until(TO_S, |wheel, at_s| {
            if at_s > FROM_S {
                edges[wheel] += 1.0;
            }
        });
        let mut way_m = [0.0; 4];
        for row in Simulation::new(&scenario, 3).unwrap() {
            let speeds = row.wheel_speeds.unwrap().wheel_speed_m_s;
            if row.time_s > FROM_S && row.time_s <= TO_S {
                way_m.iter_mut().zip(speeds).for_each(|(way, speed)| *way += speed / 50.0);
            }
        }
        let turns = |i: usize| edges[i] / 48.0;
        for (i, way_m) in way_m.into_iter().enumerate() {
            let by_bus = way_m / (0.31 * std::f64::consts::TAU);
            // An edge at either end, and what a hopping wheel leaves.
            assert!((turns(i) - by_bus).abs() < 0.1 + 3e-4 * by_bus, "{i}: {} {by_bus}", turns(i));
        }
        // By more than the tolerance the outer wheel goes further, and the tire that lost a quarter turns faster than in the rear.
        let (front, rear) = (turns(1) - turns(0), turns(3) - turns(2));
        assert!(rear > 0.3 && front < rear - 0.15, "{edges:?}");
    }
}
