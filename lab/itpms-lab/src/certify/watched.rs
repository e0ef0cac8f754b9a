//! The monitor of a test's car: on accelerations, or on wheel speeds alone, or with their tooth pulses.
//!
//! Called by `drive`, which holds what it says against what was done to the car.

use itpms_core::model::{CarConfig, CarEstimate, CarSample, Corner, CornerSample, ParameterError, Wheels};
use itpms_core::monitor::MonitorConfig;
use itpms_core::warning::MonitorReport;
use itpms_core::wheel_speed::{LoadUncertainty, WheelSpeedSample};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::SimRow;

use super::StatedLoads;
use super::course::Course;
use super::outcome::TracePoint;
use super::procedure::Procedure;
use super::telltale::{Lamp, lit, lit_by_alerts};
use crate::runner::Result;
use crate::sensors::{PulsedCar, Pulses, Sensors, wheel_speed_config};
use crate::tuning::monitor;

/// A car and what was estimated last, where it has accelerometers.
pub(super) struct Watched {
    car: Box<PulsedCar>,
    pulses: Option<Pulses>,
    estimate: Option<CarEstimate<f64>>,
}

impl Watched {
    pub(super) fn new(
        procedure: &Procedure,
        course: &Course,
        loads: StatedLoads,
        sensors: Sensors,
    ) -> Result<Self> {
        let scenario = &course.scenario;
        let load = match loads {
            StatedLoads::Constant => LoadUncertainty::constant(),
            StatedLoads::Unknown => LoadUncertainty::unknown(),
        };
        let wheel_speeds = wheel_speed_config(scenario, load);
        let mut config = CarConfig { corners: [None; 4], wheelbase_m: Some(scenario.wheelbase_m) };
        for corner in Corner::ALL.into_iter().filter(|_| wheel_speeds.is_none()) {
            config.corners[corner.index()] = Some(scenario.corner_config(corner)?);
        }
        let limits = procedure.rule.limits();
        let config = MonitorConfig { limits, wheel_speeds, ..monitor(&config) };
        let mut car = Box::new(PulsedCar::unconfigured_with(None));
        car.configure(&config, scenario.rate_hz)?;
        let reads_pulses = sensors == Sensors::Pulses && wheel_speeds.is_some();
        let pulses = reads_pulses.then(|| Pulses::read_by(&mut car, scenario)).transpose()?;
        Ok(Self { car, pulses, estimate: None })
    }

    pub(super) fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.car.begin_calibration(seconds)
    }

    pub(super) fn roll(&mut self, scenario: &Scenario, seed: u64) -> Result<()> {
        if let Some(pulses) = &mut self.pulses {
            let car_seed = scenario.wheel_speeds.and_then(|wheels| wheels.car_seed).unwrap_or(seed);
            pulses.roll(scenario, car_seed, seed)?;
        }
        Ok(())
    }

    /// A row of a drive that began `offset_s` after the first one.
    pub(super) fn take(&mut self, row: &SimRow, offset_s: f64) {
        if let Some(pulses) = &mut self.pulses {
            pulses.until(row.time_s, offset_s, &mut self.car);
        }
        let mut sample = row.car_sample();
        sample.time_s += offset_s;
        if let Some(message) = &mut sample.wheel_speeds {
            message.time_s += offset_s;
        }
        self.update(&sample);
    }

    /// A sample of a parked car: what its accelerometers read, where it has some, and wheels that stand.
    pub(super) fn stand(&mut self, time_s: f64, readings: [[f64; 2]; 4]) {
        let reading =
            |[body, wheel]: [f64; 2]| CornerSample { body_accel_m_s2: body, wheel_accel_m_s2: wheel };
        let measures = self.car.wheels().is_none();
        let wheels = WheelSpeedSample {
            time_s,
            wheel_speed_m_s: [0.0; 4],
            yaw_rate_rad_s: 0.0,
            accel_x_m_s2: 0.0,
            accel_y_m_s2: 0.0,
            brake: Some(true),
        };
        self.update(&CarSample {
            time_s,
            speed_m_s: 0.0,
            corners: readings.map(|of| measures.then(|| reading(of))),
            wheel_speeds: Some(wheels),
        });
    }

    fn update(&mut self, sample: &CarSample<f64>) {
        let estimate = self.car.update(sample);
        self.estimate = self.car.wheels().is_none().then_some(estimate);
    }

    pub(super) fn report(&self) -> &MonitorReport<f64> {
        self.car.report()
    }

    pub(super) fn lit(&self, lamp: Lamp) -> Wheels {
        match &self.estimate {
            Some(estimate) => lit(lamp, self.car.report(), estimate),
            None if self.car.wheels().is_some() => lit_by_alerts(lamp, self.car.report()),
            None => Wheels::NONE,
        }
    }

    pub(super) fn trace(&self, time_s: f64, row: &SimRow) -> Option<TracePoint> {
        if self.car.wheels().is_none() {
            return self.estimate.as_ref().map(|estimate| TracePoint::new(time_s, row, estimate));
        }
        row.wheel_speeds.as_ref().map(|wheels| TracePoint {
            speed_km_h: 3.6 * row.speed_m_s,
            truth_kpa: wheels.pressure_kpa,
            ..TracePoint::nothing(time_s)
        })
    }
}
