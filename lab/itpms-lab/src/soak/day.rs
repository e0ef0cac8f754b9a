//! A calibration and a later day of a car with wheel speeds alone, under conditions drawn from its seed: nothing wrong, or tires that lose
//! air, or a yaw rate with a fault.
//!
//! Called by the soak where a plan has conditions. Every seed is another car; the estimator is given its dimensions, its driven axle and
//! whether that is coupled, and the distance since the calibration.

use std::ops::ControlFlow;
use std::time::Instant;

use itpms_core::model::{Corner, Wheels};
use itpms_core::monitor::MonitoredWheels;
use itpms_core::warning::{Alert, Cause};
use itpms_core::wheel_speed::LoadUncertainty;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::Pressure;
use itpms_sim::wheel_speeds::{Condition, Day, YawFault};
use serde::{Deserialize, Serialize};

use super::Plan;
use super::hour::{ASK_ROWS, DayHour, Hour, LossHour, Said, YawHour, scenario};
use super::rolling::Watch;
use crate::runner::{Result, StudyError};
use crate::sensors::wheel_speed_config;

/// Length in s of the calibration's drive, all of which counts unless a plan says otherwise, and how many are driven until one taught something.
const CALIBRATE_S: f64 = 900.0;
const CALIBRATIONS: u64 = 3;
/// When tires lose air, in s, and within which time.
const LOSES_AT_S: f64 = 900.0;
const LOSES_IN_S: f64 = 60.0;
/// Time in s between two points of a pressure.
const STEP_S: f64 = 10.0;

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Days {
    /// Roads, weather, trailer, differential.
    pub condition: Condition,
    /// Share of their pressure that tires of every drive lose; which ones, changes from seed to seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loses: Option<f64>,
    /// Whether the yaw rate has a fault, the next one with every seed.
    #[serde(default)]
    pub bad_yaw: bool,
}

/// Which tires lose air, from seed to seed. Not all four: radii do not show it.
fn losing(seed: u64) -> (&'static str, Wheels, bool) {
    use Corner::{FrontLeft as Fl, FrontRight as Fr, RearLeft as Rl, RearRight as Rr};
    let (kind, wheels, parked): (_, &[Corner], _) = match seed % 10 {
        0 => ("one", &[Fl], false),
        1 => ("one", &[Fr], false),
        2 => ("one", &[Rl], false),
        3 => ("one", &[Rr], false),
        4 => ("side", &[Fl, Rl], false),
        5 => ("side", &[Fr, Rr], false),
        6 => ("diagonal", &[Fl, Rr], false),
        7 => ("axle", &[Fl, Fr], false),
        8 => ("three", &[Fl, Fr, Rr], false),
        _ if seed % 20 < 10 => ("one while parked", &[Fr], true),
        _ => ("one while parked", &[Rl], true),
    };
    (kind, wheels.iter().copied().collect(), parked)
}

pub(super) fn drive(plan: &Plan, days: &Days, seed: u64, flow: &dyn Fn() -> ControlFlow<()>) -> Result<Hour> {
    let begun = Instant::now();
    let mut kept = Kept::default();
    let mut left_out = false;
    let calibrate_s = plan.calibrate_s.unwrap_or(CALIBRATE_S);
    let mut taught = None;
    for attempt in 0..CALIBRATIONS {
        // Seeds of drives that no plan has otherwise.
        let day = Day {
            car_seed: seed,
            seed: seed ^ ((1 + attempt) << 44),
            condition: days.condition,
            calibrates: true,
        };
        let first = composed(&Plan { drive_s: calibrate_s, ..*plan }, days, &day)?;
        let mut wheels = monitor(&first)?;
        // To the drive's last sample but some.
        wheels.begin_calibration(calibrate_s - 1.0)?;
        let mut watch = Watch::new(calibrate_s);
        kept.follow(&first, day.seed, &mut wheels, &mut watch, -calibrate_s, flow)?;
        left_out |= wheels.doubts_yaw_rate();
        taught = wheels.calibration().copied().map(|calibration| (calibration, watch));
        if taught.is_some() {
            break;
        }
    }
    let day = Day { car_seed: seed, seed, condition: days.condition, calibrates: false };
    let mut later = composed(plan, days, &day)?;
    let Some(spec) = later.wheel_speeds else { return Err(StudyError::Stopped) };
    let loss = days.loses.map(|share| (share, losing(seed)));
    if let Some((share, (_, wheels, parked))) = loss {
        kept.from_s = if parked { 0.0 } else { LOSES_AT_S };
        kept.losing = wheels;
        lose(&mut later, wheels, share, kept.from_s, if parked { 0.0 } else { LOSES_IN_S })?;
    }
    let mut wheels = monitor(&later)?;
    let mut calibrated = false;
    let mut watch = Watch::new(0.0);
    if let Some((calibration, learned)) = taught {
        calibrated = wheels.load_calibration(&calibration);
        wheels.age_calibration(spec.conditions.odometer_km);
        watch = learned.later();
    }
    let (rows, km) = kept.follow(&later, seed, &mut wheels, &mut watch, 0.0, flow)?;
    left_out |= wheels.doubts_yaw_rate();
    let loss = loss.map(|(share, (kind, wheels, _))| LossHour {
        kind: kind.to_owned(),
        wheels: wheels.iter().map(|corner| corner.label().to_owned()).collect(),
        radius_change: -spec.radius_per_ln_pressure * (-share).ln_1p(),
        found_s: kept.found_s,
        exact: kept.exact,
        wrong: kept.wrong,
    });
    let of = &spec.conditions;
    let condition = match days.condition {
        Condition::Mixed if spec.locking_n > 0.0 => Condition::LimitedSlip,
        Condition::Mixed if of.snow_share > 0.0 => Condition::Snow,
        Condition::Mixed if of.trailer_kg > 0.0 => Condition::Trailer,
        Condition::Mixed => Condition::Ordinary,
        other => other,
    };
    Ok(Hour {
        seed,
        driven_s: rows as f64 / later.rate_hz,
        km,
        said: kept.said,
        radii: Some(watch.finish()),
        day: Some(DayHour {
            condition,
            radius_per_ln_pressure: spec.radius_per_ln_pressure,
            since_km: of.odometer_km,
            calibrated,
            yaw: spec.yaw_rate.then_some(YawHour { fault: of.yaw_fault, left_out }),
            loss,
        }),
        wall_s: begun.elapsed().as_secs_f64(),
        ..Hour::default()
    })
}

fn monitor(scenario: &Scenario) -> Result<Box<MonitoredWheels<f64>>> {
    let mut wheels = Box::new(MonitoredWheels::unconfigured());
    if let Some(config) = wheel_speed_config(scenario, LoadUncertainty::unknown()) {
        wheels.configure(&config)?;
    }
    Ok(wheels)
}

/// The drive of a day, with every point written out.
fn composed(plan: &Plan, days: &Days, day: &Day) -> Result<Scenario> {
    let mut scenario = scenario(plan)?;
    let Some(mut journey) = scenario.journey.take() else { return Ok(scenario) };
    // Bodies and tires are the car's, not the day's.
    if let Some(tolerances) = journey.tolerances.take() {
        tolerances.apply(day.car_seed, &mut scenario);
    }
    let mut spec = day.draw(&mut journey);
    if days.bad_yaw {
        let [first, ..] = YawFault::ALL;
        let fault = YawFault::ALL.get((day.car_seed % 5) as usize).copied().unwrap_or(first);
        // A sensor breaks; a wrong unit, sign or gain has been there from the first day on.
        let breaks = matches!(fault, YawFault::Dead | YawFault::Noisy);
        spec.yaw_rate = true;
        spec.conditions.yaw_fault = if breaks && day.calibrates { YawFault::None } else { fault };
    }
    scenario.rate_hz = 1e3 / spec.period_ms;
    scenario.wheel_speeds = Some(spec);
    scenario.journey = Some(journey);
    Ok(scenario.composed(day.seed)?)
}

/// Lets tires lose a share of their pressure.
fn lose(scenario: &mut Scenario, wheels: Wheels, share: f64, from_s: f64, takes_s: f64) -> Result<()> {
    let steps = (scenario.duration_s / STEP_S).ceil() as u32;
    for corner in wheels.iter() {
        let Some(spec) = scenario.corner.get_mut(corner) else { continue };
        let Ok(sound) = spec.pressure.profile_kpa() else { continue };
        let points = (0..=steps).map(|i| {
            let time_s = STEP_S * f64::from(i);
            let after_s = time_s - from_s;
            let done = if after_s >= takes_s { 1.0 } else { (after_s / takes_s).clamp(0.0, 1.0) };
            [time_s, sound.value(time_s) * (1.0 - share * done)]
        });
        spec.pressure = Pressure::PointsSKpa(points.collect());
    }
    scenario.validate()?;
    Ok(())
}

#[derive(Default)]
struct Kept {
    losing: Wheels,
    from_s: f64,
    said: Vec<Said>,
    found_s: Option<f64>,
    exact: bool,
    wrong: bool,
}

impl Kept {
    fn follow(
        &mut self,
        scenario: &Scenario,
        seed: u64,
        wheels: &mut MonitoredWheels<f64>,
        watch: &mut Watch,
        begins_s: f64,
        flow: &dyn Fn() -> ControlFlow<()>,
    ) -> Result<(u64, f64)> {
        let (mut rows, mut km) = (0, 0.0);
        let mut before: Option<Alert<f64>> = None;
        for row in Simulation::new(scenario, seed)? {
            if rows % ASK_ROWS == 0 && flow().is_break() {
                return Err(StudyError::Stopped);
            }
            rows += 1;
            km = 1e-3 * row.distance_m;
            let Some(truth) = &row.wheel_speeds else { continue };
            wheels.update(&truth.sample(row.time_s));
            let now = wheels.alert();
            if let Some(alert) = now.filter(|alert| !before.is_some_and(|before| is_same(&before, alert))) {
                self.judge(begins_s + row.time_s, &alert);
            }
            before = now;
            watch.push(row.time_s, 1.0 / scenario.rate_hz, wheels.radii(), &truth.ln_radius);
        }
        Ok((rows, km))
    }

    /// Whether a warning that has begun is right.
    fn judge(&mut self, time_s: f64, alert: &Alert<f64>) {
        let hits = alert.wheels.iter().any(|corner| self.losing.contains(corner));
        let known = !matches!(alert.cause, Cause::Differs { is_known: false, .. });
        let strays = alert.wheels.iter().any(|corner| !self.losing.contains(corner));
        let of_tires = !matches!(alert.cause, Cause::Malfunction(_));
        let right = of_tires && time_s >= self.from_s && hits && !(known && strays);
        if right || of_tires && time_s >= self.from_s && hits {
            self.found_s = self.found_s.or(Some(time_s - self.from_s));
        }
        self.exact |= right && known && alert.wheels == self.losing;
        if !right {
            self.wrong |= of_tires && time_s >= self.from_s && !self.losing.is_empty();
            self.said.push(Said::new(time_s, alert));
        }
    }
}

fn is_same(a: &Alert<f64>, b: &Alert<f64>) -> bool {
    let known = |alert: &Alert<f64>| !matches!(alert.cause, Cause::Differs { is_known: false, .. });
    a.wheels == b.wheels && a.cause.label() == b.cause.label() && known(a) == known(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::Sensors;

    fn hour(days: Days, seed: u64, drive_s: f64) -> Hour {
        let plan = Plan { drive_s, sensors: Sensors::WheelSpeeds, days: Some(days), ..Plan::default() };
        drive(&plan, &days, seed, &|| ControlFlow::Continue(())).unwrap()
    }

    #[test]
    fn a_day_keeps_what_was_said_and_is_read_back() {
        let days = Days { condition: Condition::Ordinary, loses: Some(0.5), bad_yaw: false };
        let hour = hour(days, 30, 1500.0);
        let day = hour.day.as_ref().unwrap();
        let loss = day.loss.as_ref().unwrap();
        assert_eq!((loss.kind.as_str(), loss.wheels.as_slice()), ("one", &["fl".to_owned()][..]));
        // ln 2 of a beta.
        assert!((loss.radius_change - day.radius_per_ln_pressure * 2f64.ln()).abs() < 1e-12);
        assert_eq!(Hour::from_line(&hour.to_line()).unwrap(), hour);
    }

    #[test]
    fn every_kind_of_loss_has_its_turn() {
        let kinds: std::collections::BTreeSet<_> = (0..20).map(|seed| losing(seed).0).collect();
        assert_eq!(kinds.len(), 6);
        assert!((0..20).all(|seed| (1..=3).contains(&losing(seed).1.iter().count())));
    }

    #[test]
    fn a_loss_is_one_from_its_time_on() {
        let days = Days { condition: Condition::Snow, loses: None, bad_yaw: false };
        let plan = Plan { drive_s: 1200.0, sensors: Sensors::WheelSpeeds, ..Plan::default() };
        let day = Day { car_seed: 4, seed: 4, condition: Condition::Snow, calibrates: false };
        let sound = composed(&plan, &days, &day).unwrap();
        let mut leaking = sound.clone();
        lose(&mut leaking, Corner::RearLeft.into(), 0.25, 900.0, 60.0).unwrap();
        let at = |scenario: &Scenario, corner: Corner, time_s| {
            scenario.corner.get(corner).unwrap().pressure.profile_kpa().unwrap().value(time_s)
        };
        for (time_s, left) in [(300.0, 1.0), (900.0, 1.0), (930.0, 0.875), (960.0, 0.75), (1200.0, 0.75)] {
            let share = at(&leaking, Corner::RearLeft, time_s) / at(&sound, Corner::RearLeft, time_s);
            assert!((share - left).abs() < 1e-9, "{time_s} {share}");
        }
        assert_eq!(at(&leaking, Corner::RearRight, 1200.0), at(&sound, Corner::RearRight, 1200.0));
    }
}
