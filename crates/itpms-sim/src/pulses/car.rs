//! The tooth pulses of a scenario's drive: its speed, pressures and roads, straight on; `docs/math/simulation.md`, "Tooth pulses".
//!
//! Bends, loads and drive torque are not in it. Tires and rims differ from car to car, all that an estimator is told being those of no car
//! in particular.

use super::{PulseSpec, PulseWheel};
use crate::error::{InvalidValue, ScenarioError};
use crate::scenario::Scenario;
use crate::streams::{Purpose, generator};
use crate::time_profile::TimeProfile;
use crate::wheel_speeds::{Rough, normal};

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
    passed: Vec<(f64, usize)>,
}

impl PulseCar {
    /// The drive of a scenario with four corners; `car_seed` makes the car, `seed` its road and its noise.
    ///
    /// # Errors
    /// A scenario without one of the corners, or with a value out of range.
    pub fn new(scenario: &Scenario, car_seed: u64, seed: u64) -> Result<Self, ScenarioError> {
        let scenario = scenario.composed(seed)?;
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
        Ok(Self { wheels, pressures_kpa, speed_m_s, rough: Rough::new(&scenario.road), passed: vec![] })
    }

    /// On to a time in s: `pulse` takes wheel, in the order of `Corner::ALL`, and time of each edge that passes, in the order of time.
    pub fn until(&mut self, time_s: f64, mut pulse: impl FnMut(usize, f64)) {
        while self.wheels[0].time_s() < time_s {
            let now_s = self.wheels[0].time_s();
            let speed_m_s = self.speed_m_s.value(now_s);
            let amplitude = self.rough.amplitude(self.speed_m_s.integral(now_s));
            for (i, (wheel, pressure)) in self.wheels.iter_mut().zip(&self.pressures_kpa).enumerate() {
                let passed = &mut self.passed;
                wheel.step(speed_m_s, pressure.value(now_s), amplitude, &mut |at_s| passed.push((at_s, i)));
            }
            self.passed.sort_by(|a, b| a.0.total_cmp(&b.0));
            self.passed.drain(..).for_each(|(at_s, wheel)| pulse(wheel, at_s));
        }
    }
}
