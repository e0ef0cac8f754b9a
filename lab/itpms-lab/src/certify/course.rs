//! A test as a drive: learning, a standstill in which tires are let down or a plug is pulled, detection. And the drive
//! after it, with everything put right again.
//!
//! Called by `drive`. Knows the regulations' numbers, nothing of estimators.

use itpms_sim::error::ScenarioError;
use itpms_sim::scenario::Scenario;
use itpms_sim::time_profile::{Pressure, Speed};
use itpms_sim::wheel_speeds::WheelSpeedSpec;

use super::procedure::Procedure;
use super::test_case::Test;

const COURSE: &str = include_str!("course.toml");

/// Time in s over which the car stops or sets off.
const STOP_S: f64 = 20.0;
/// Standstill in s, with the key in: warm pressure measured, tires let down, two minutes to settle.
const STAND_S: f64 = 240.0;
/// After how much of it, and within what time in s, the tires are let down.
const DEFLATE_AFTER_S: f64 = 40.0;
const DEFLATE_S: f64 = 60.0;
/// Standstill in s with the key out, in the diffusion test.
const KEY_OUT_S: f64 = 120.0;
/// A tire warms up by so many K with this time constant in s; it starts at 20 °C. Absolute pressure goes with absolute
/// temperature at constant volume (Gay-Lussac).
const WARMS_BY_K: f64 = 20.0;
const WARMS_IN_S: f64 = 480.0;
const COLD_K: f64 = 293.15;
const ATMOSPHERE_KPA: f64 = 101.325;
/// A bend each so many s, this long, to the left and right in turn.
const BEND_EVERY_S: f64 = 60.0;
const BEND_S: f64 = 10.0;
const BEND_M_S2: f64 = 1.5;
/// Length in s of the speed pattern, and of the drive after the test at the most.
const PATTERN_S: f64 = 600.0;
pub(super) const RECOVERY_S: f64 = 600.0;

/// A test's drives and the moments that count.
#[derive(Debug, Clone)]
pub(super) struct Course {
    pub(super) scenario: Scenario,
    /// The same car with right pressures and whole sensors.
    pub(super) recovery: Scenario,
    /// When what is wrong begins and when it is complete, in s.
    pub(super) wrong_from_s: f64,
    pub(super) wrong_at_s: f64,
    pub(super) band_m_s: [f64; 2],
    /// Key out from and to, in s; empty where it stays in.
    pub(super) key_out_s: [f64; 2],
    /// Warm and test pressure in kPa of the tires that are let down.
    pub(super) warm_kpa: f64,
    pub(super) test_kpa: Option<f64>,
    pub(super) limit_s: f64,
    pub(super) learning_s: f64,
}

impl Course {
    pub(super) fn new(procedure: &Procedure) -> Result<Self, ScenarioError> {
        Self::with_times(procedure, procedure.rule.learning_s(), procedure.rule.limit_s(procedure.test))
    }

    /// With other times than the regulation's, for tests of this program.
    pub(super) fn with_times(
        procedure: &Procedure,
        learning_s: f64,
        limit_s: f64,
    ) -> Result<Self, ScenarioError> {
        let (rule, test) = (procedure.rule, procedure.test);
        let mut scenario = Scenario::from_toml(COURSE, "course.toml")?;
        scenario.name = procedure.name();
        let band_km_h = rule.band_km_h(test);
        let mut route = Route::new(band_km_h);
        route.cruise(learning_s);
        let stopped_s = route.stand(STAND_S);
        route.cruise(match rule.key_out_after_s(test) {
            Some(after_s) if after_s < limit_s => after_s,
            _ => limit_s,
        });
        let mut key_out_s = [f64::INFINITY; 2];
        if let Some(after_s) = rule.key_out_after_s(test).filter(|after_s| *after_s < limit_s) {
            let off_s = route.stand(KEY_OUT_S);
            key_out_s = [off_s, off_s + KEY_OUT_S];
            route.cruise(limit_s - after_s);
        }
        scenario.duration_s = route.time_s;
        scenario.speed = Speed::PointsSKmH(route.points);
        if let Some(car) = &mut scenario.car {
            car.lateral_points_s_m_s2 = bends(scenario.duration_s);
        }

        let wrong_from_s = stopped_s + DEFLATE_AFTER_S;
        let placard_kpa = scenario.corner.fl.as_ref().map_or(f64::NAN, |corner| corner.placard_kpa);
        let warm_kpa = warmed_kpa(placard_kpa, learning_s);
        let mut wrong_at_s = wrong_from_s;
        let mut test_kpa = None;
        if let Test::Malfunction(failure) = test {
            scenario.fault = vec![failure.spec(wrong_from_s)];
        } else {
            wrong_at_s += DEFLATE_S;
            test_kpa = Some(rule.test_pressure_kpa(test, warm_kpa, placard_kpa));
        }
        for (corner, spec) in scenario.corner.iter_mut() {
            let mut points = warming(spec.placard_kpa, learning_s);
            if let Some(test_kpa) = test_kpa.filter(|_| procedure.low_wheels().contains(corner)) {
                points.extend([[wrong_from_s, warm_kpa], [wrong_at_s, test_kpa]]);
            }
            spec.pressure = Pressure::PointsSKpa(points);
        }
        let recovery = recovery(&scenario, band_km_h);
        Ok(Self {
            scenario,
            recovery,
            wrong_from_s,
            wrong_at_s,
            band_m_s: band_km_h.map(|v| v / 3.6),
            key_out_s,
            warm_kpa,
            test_kpa,
            limit_s,
            learning_s,
        })
    }

    /// The same on wheel speeds alone, by the car of a seed.
    pub(super) fn on_wheel_speeds(mut self, car_seed: u64) -> Self {
        for scenario in [&mut self.scenario, &mut self.recovery] {
            let wheels =
                WheelSpeedSpec { alone: true, car_seed: Some(car_seed), ..WheelSpeedSpec::default() };
            scenario.rate_hz = 1e3 / wheels.period_ms;
            scenario.wheel_speeds = Some(wheels);
        }
        self
    }

    /// What can be driven at the most, in s.
    pub(super) fn longest_s(&self) -> f64 {
        self.scenario.duration_s + self.recovery.duration_s
    }

    /// Whether driving time counts at a speed in m/s. Rounding at the band's ends does not stop the clock.
    pub(super) fn counts(&self, speed_m_s: f64) -> bool {
        let [slowest, fastest] = self.band_m_s;
        (slowest - 1e-6..=fastest + 1e-6).contains(&speed_m_s)
    }
}

/// The car driven on after the test: tires at their placard pressures, plugs in their places.
fn recovery(scenario: &Scenario, band_km_h: [f64; 2]) -> Scenario {
    let mut recovery = scenario.clone();
    let mut route = Route::new(band_km_h);
    route.cruise(RECOVERY_S);
    recovery.duration_s = route.time_s;
    recovery.speed = Speed::PointsSKmH(route.points);
    recovery.fault.clear();
    if let Some(car) = &mut recovery.car {
        car.lateral_points_s_m_s2 = bends(recovery.duration_s);
    }
    for (_, spec) in recovery.corner.iter_mut() {
        spec.pressure = Pressure::ConstantKpa(spec.placard_kpa);
    }
    recovery
}

/// Pressure in kPa of a tire that was filled cold and has been driven for so long.
fn warmed_kpa(cold_kpa: f64, driven_s: f64) -> f64 {
    let warmer_k = WARMS_BY_K * (1.0 - (-driven_s / WARMS_IN_S).exp());
    (cold_kpa + ATMOSPHERE_KPA) * (1.0 + warmer_k / COLD_K) - ATMOSPHERE_KPA
}

/// Pressure over time while learning, in points a minute apart; held afterwards, cooling in the standstill being a kPa or two.
fn warming(cold_kpa: f64, learning_s: f64) -> Vec<[f64; 2]> {
    let minutes = (learning_s / 60.0).ceil().max(1.0);
    (0..=minutes as u32)
        .map(|i| f64::from(i) / minutes * learning_s)
        .map(|t| [t, warmed_kpa(cold_kpa, t)])
        .collect()
}

fn bends(duration_s: f64) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    let (mut start_s, mut side) = (30.0, 1.0);
    while start_s + BEND_S < duration_s {
        let bend = [[0.0, 0.0], [2.0, side * BEND_M_S2], [BEND_S - 2.0, side * BEND_M_S2], [BEND_S, 0.0]];
        points.extend(bend.map(|[t, a]| [start_s + t, a]));
        start_s += BEND_EVERY_S;
        side = -side;
    }
    points
}

struct Route {
    band_km_h: [f64; 2],
    time_s: f64,
    points: Vec<[f64; 2]>,
}

impl Route {
    /// The car comes rolling, at the middle of its first pattern.
    fn new(band_km_h: [f64; 2]) -> Self {
        Self { band_km_h, time_s: 0.0, points: vec![] }
    }

    /// Drives through the whole band for so long: 80 km/h, slow, fast, and a middling speed, ten minutes a round.
    fn cruise(&mut self, seconds: f64) {
        let [slowest, fastest] = self.band_km_h;
        let middling = 0.5 * (80.0 + slowest);
        let pattern = [
            (0.0, 80.0),
            (0.12, 80.0),
            (0.16, slowest),
            (0.27, slowest),
            (0.33, fastest),
            (0.55, fastest),
            (0.6, middling),
            (0.72, middling),
            (0.77, fastest - 10.0),
            (0.96, fastest - 10.0),
        ];
        let start_s = self.time_s;
        let rounds = (seconds / PATTERN_S).ceil().max(1.0);
        let round_s = seconds / rounds;
        for round in 0..rounds as u32 {
            for (share, km_h) in pattern {
                self.points.push([start_s + (f64::from(round) + share) * round_s, km_h]);
            }
        }
        self.time_s = start_s + seconds;
        self.points.push([self.time_s, 80.0]);
    }

    /// Stops, stands, sets off; gives the time at which the car stands.
    fn stand(&mut self, seconds: f64) -> f64 {
        let stopped_s = self.time_s + STOP_S;
        self.time_s = stopped_s + seconds + STOP_S;
        self.points.extend([[stopped_s, 0.0], [stopped_s + seconds, 0.0]]);
        // Where the next cruise begins, at 80 km/h.
        stopped_s
    }
}

#[cfg(test)]
mod tests {
    use super::super::procedure::Extent;
    use super::*;
    use crate::sensors::Sensors;

    #[test]
    fn every_course_can_be_driven_as_its_regulation_says() {
        for procedure in Procedure::all(Extent::Full, Sensors::Accelerations) {
            let course = Course::new(&procedure).unwrap();
            course.scenario.validate().unwrap();
            course.recovery.validate().unwrap();
            let profile = course.scenario.speed.profile_m_s().unwrap();
            let band = procedure.rule.band_km_h(procedure.test);
            let at = |t: f64| 3.6 * profile.value(t);
            // R141 Annex 3: average of 80 +- 10 km/h while learning, within the band but for two minutes.
            let learning_s = course.learning_s;
            let mean = 3.6 * profile.integral(learning_s) / learning_s;
            assert!((70.0..=90.0).contains(&mean), "{} {mean}", procedure.name());
            let seconds = |from: f64, to: f64| (0..(to - from) as u32).map(move |i| from + f64::from(i));
            assert!(seconds(0.0, learning_s).all(|t| course.counts(at(t) / 3.6)));
            // The whole band is driven in learning and in detection, and detection is as long as the limit.
            for (from, to) in [(0.0, learning_s), (course.wrong_at_s, course.scenario.duration_s)] {
                let slowest = seconds(from, to).map(at).filter(|v| *v > 30.0).fold(f64::MAX, f64::min);
                let fastest = seconds(from, to).map(at).fold(0.0, f64::max);
                assert!((fastest - band[1]).abs() < 0.5, "{fastest}");
                assert!(slowest < band[0] + 5.0, "{slowest}");
            }
            let detecting = seconds(course.wrong_at_s, course.scenario.duration_s + 1.0)
                .filter(|t| course.counts(at(*t) / 3.6))
                .count() as f64;
            assert!(detecting >= course.limit_s, "{detecting}");
            // The car stands while something is done to it.
            assert!(at(course.wrong_from_s) == 0.0 && at(course.wrong_at_s) == 0.0);
            assert!(!(course.key_out_s[0] < f64::INFINITY) || at(course.key_out_s[0] + 60.0) == 0.0);
        }
    }

    #[test]
    fn a_warm_tire_has_the_pressure_of_its_temperature() {
        // 20 K of 293.15 K on 342.6 kPa absolute: 23.4 kPa; nearly all of it after an hour.
        assert!((warmed_kpa(241.3, 1e6) - 241.3 - 23.376).abs() < 0.01);
        assert!((warmed_kpa(241.3, 3600.0) - 264.6).abs() < 0.1);
        assert_eq!(warmed_kpa(241.3, 0.0), 241.3);
    }
}
