//! One drive of a car with wheel speeds alone, or with its tooth pulses, in which nothing is wrong: what was reported, how near it came to more, and whether the
//! radii's differences were where their spread says.

use std::ops::ControlFlow;
use std::time::Instant;

use itpms_core::model::CarConfig;
use itpms_core::monitor::MonitorConfig;
use itpms_core::warning::MonitorReport;
use itpms_core::wheel_speed::{LoadUncertainty, RadiusReport, RadiusState, WheelRadius};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use itpms_sim::wheel_speeds::{DrivenWheels, WheelSpeedSpec};

use super::hour::{ASK_ROWS, Hour, RadiusHour, note, scenario};
use super::{Car, Plan};
use crate::runner::{Result, StudyError};
use crate::score::stats::HALF_95;
use crate::sensors::{PulsedCar, Pulses, Sensors, wheel_speed_config};
use crate::tuning::monitor;

/// Length in s of the calibration at the beginning of a drive that does not say otherwise.
const CALIBRATE_S: f64 = 600.0;
/// By how many K its tires warm up at 90 km/h.
const WARMS_BY_K: f64 = 20.0;

pub(super) fn drive(plan: &Plan, seed: u64, flow: &dyn Fn() -> ControlFlow<()>) -> Result<Hour> {
    let begun = Instant::now();
    let scenario = rolling(plan, seed)?;
    let config = CarConfig { corners: [None; 4], wheelbase_m: None };
    let wheel_speeds = wheel_speed_config(&scenario, LoadUncertainty::unknown());
    let mut car = Box::new(PulsedCar::unconfigured_with(None));
    car.configure(&MonitorConfig { wheel_speeds, ..monitor(&config) }, scenario.rate_hz)?;
    let mut pulses = match plan.sensors {
        Sensors::Pulses => Some(Pulses::read_by(&mut car, &scenario)?),
        Sensors::Accelerations | Sensors::WheelSpeeds => None,
    };
    if let Some(pulses) = &mut pulses {
        pulses.roll(&scenario, seed, seed)?;
    }
    let calibrate_s = plan.calibrate_s.unwrap_or(CALIBRATE_S);
    car.begin_calibration(calibrate_s)?;
    let mut watch = Watch::new(calibrate_s);
    let mut said = vec![];
    let mut before = MonitorReport::empty();
    let (mut rows, mut km) = (0, 0.0);
    for row in Simulation::new(&scenario, seed)? {
        if rows % ASK_ROWS == 0 && flow().is_break() {
            return Err(StudyError::Stopped);
        }
        rows += 1;
        km = 1e-3 * row.distance_m;
        if let Some(pulses) = &mut pulses {
            pulses.until(row.time_s, 0.0, &mut car);
        }
        car.update(&row.car_sample());
        note(row.time_s, &before, car.report(), &mut said);
        before = *car.report();
        if let Some((wheels, truth)) = car.wheels().zip(row.wheel_speeds.as_ref()) {
            watch.push(row.time_s, 1.0 / scenario.rate_hz, wheels.radii(), &truth.ln_radius);
        }
    }
    Ok(Hour {
        seed,
        driven_s: rows as f64 / scenario.rate_hz,
        km,
        said,
        radii: Some(watch.finish()),
        wall_s: begun.elapsed().as_secs_f64(),
        ..Hour::default()
    })
}

/// The drive; every seed has another car and bus: driven axle, period, steps, and signals beside the speeds.
fn rolling(plan: &Plan, seed: u64) -> Result<Scenario> {
    let mut scenario = scenario(plan)?;
    if let Some(journey) = &mut scenario.journey {
        journey.warms_by_k = WARMS_BY_K;
    }
    let mut spec = WheelSpeedSpec { alone: true, ..WheelSpeedSpec::default() };
    if plan.car != Car::Nominal {
        let of = |number: u64, after: u64| (seed / after % number) as usize;
        spec.driven = [DrivenWheels::Front, DrivenWheels::Rear, DrivenWheels::All][of(3, 1)];
        spec.resolution_km_h = [0.01, 0.03, 0.06, 0.1][of(4, 1)];
        spec.accel_x = of(2, 1) == 0;
        spec.yaw_rate = of(5, 1) != 0;
        spec.period_ms = [20.0, 10.0][of(2, 7)];
    }
    scenario.rate_hz = 1e3 / spec.period_ms;
    scenario.wheel_speeds = Some(spec);
    Ok(scenario)
}

#[derive(Default)]
pub(super) struct Watch {
    calibrated_s: f64,
    /// Sum of the true `ln` radii over the calibration's driving, and its samples.
    learned: ([f64; 4], f64),
    covered_s: [f64; 3],
    hour: RadiusHour,
}

impl Watch {
    pub(super) fn new(calibrated_s: f64) -> Self {
        Self { calibrated_s, ..Self::default() }
    }

    /// Goes on with a later drive, of which nothing is learned.
    pub(super) fn later(self) -> Self {
        Self { calibrated_s: 0.0, ..self }
    }

    pub(super) fn push(&mut self, time_s: f64, step_s: f64, radii: &RadiusReport<f64>, ln_radius: &[f64; 4]) {
        if time_s < self.calibrated_s {
            self.learned.1 += 1.0;
            for (sum, now) in self.learned.0.iter_mut().zip(ln_radius) {
                *sum += now;
            }
            return;
        }
        if matches!(radii.state, RadiusState::Uncalibrated | RadiusState::Calibrating)
            || radii.difference[0].is_nan()
        {
            return;
        }
        self.hour.known_s += step_s;
        if radii.wheels.iter().all(WheelRadius::informed) {
            self.hour.informed_s += step_s;
        }
        if radii.any_low_probability > self.hour.most_probable {
            (self.hour.most_probable, self.hour.most_probable_s) = (radii.any_low_probability, time_s);
        }
        let change: [f64; 4] = std::array::from_fn(|i| ln_radius[i] - self.learned.0[i] / self.learned.1);
        let [fl, fr, rl, rr] = change;
        let truth = [fl - fr, rl - rr, 0.5 * (fl + fr - rl - rr)];
        for (i, covered_s) in self.covered_s.iter_mut().enumerate() {
            if (radii.difference[i] - truth[i]).abs() <= HALF_95 * radii.difference_sd[i] {
                *covered_s += step_s;
            }
        }
    }

    pub(super) fn finish(self) -> RadiusHour {
        let known_s = self.hour.known_s;
        let covered = self.covered_s.map(|s| if known_s > 0.0 { s / known_s } else { 0.0 });
        RadiusHour { covered, ..self.hour }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_hour_on_wheel_speeds_is_one_of_which_something_is_known() {
        let plan = Plan { drive_s: 1200.0, sensors: Sensors::WheelSpeeds, ..Plan::default() };
        let hour = drive(&plan, 2, &|| ControlFlow::Continue(())).unwrap();
        let radii = hour.radii.unwrap();
        assert!(hour.said.is_empty(), "{:?}", hour.said);
        assert!(radii.known_s > 100.0 && radii.most_probable < 0.99, "{radii:?}");
        let line = hour.to_line();
        assert_eq!(Hour::from_line(&line).unwrap(), hour);
    }
}
