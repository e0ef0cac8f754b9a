//! The monitor of a test's car: on accelerations, or on wheel speeds alone, or with their tooth pulses.
//!
//! Called by `drive`, which holds what it says against what was done to the car.

use itpms_core::model::CarEstimate;
use itpms_core::model::{CarConfig, CarSample, Corner, CornerSample, ParameterError, Wheels};
use itpms_core::monitor::{MonitorConfig, MonitoredCar, MonitoredWheels};
use itpms_core::warning::MonitorReport;
use itpms_core::wheel_speed::{LoadUncertainty, WheelSpeedSample};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::SimRow;

use super::course::Course;
use super::outcome::TracePoint;
use super::procedure::Procedure;
use super::telltale::{Lamp, lit, lit_by_alerts};
use super::{CertifyError, LoadsTold};
use crate::sensors::{Pulses, Sensors, wheel_speed_config, wheel_speed_sample};

/// A monitor and what it reported last.
// There is one at a time.
#[allow(clippy::large_enum_variant)]
pub(super) enum Watched {
    Car { car: Box<MonitoredCar<f64>>, estimate: Option<CarEstimate<f64>> },
    Wheels { wheels: Box<MonitoredWheels<f64>>, pulses: Option<Pulses>, report: Box<MonitorReport<f64>> },
}

impl Watched {
    pub(super) fn new(
        procedure: &Procedure,
        course: &Course,
        loads: LoadsTold,
        sensors: Sensors,
    ) -> Result<Self, CertifyError> {
        let scenario = &course.scenario;
        let load = match loads {
            LoadsTold::Constant => LoadUncertainty::constant(),
            LoadsTold::Unknown => LoadUncertainty::unknown(),
        };
        if let Some(config) = wheel_speed_config(scenario, load) {
            let wheels = Box::new(MonitoredWheels::new(&config)?);
            let pulses = match sensors {
                Sensors::Pulses => Some(Pulses::new(scenario)?),
                Sensors::Accelerations | Sensors::WheelSpeeds => None,
            };
            return Ok(Self::Wheels { wheels, pulses, report: Box::new(MonitorReport::empty()) });
        }
        let mut config = CarConfig { corners: [None; 4], wheelbase_m: Some(scenario.wheelbase_m) };
        for corner in Corner::ALL {
            config.corners[corner.index()] = Some(scenario.corner_config(corner)?);
        }
        let config = MonitorConfig { limits: procedure.rule.limits(), ..MonitorConfig::new(&config) };
        Ok(Self::Car { car: Box::new(MonitoredCar::new(&config, scenario.rate_hz)?), estimate: None })
    }

    pub(super) fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        match self {
            Self::Car { car, .. } => car.begin_calibration(seconds),
            Self::Wheels { wheels, pulses, .. } => {
                if let Some(pulses) = pulses {
                    pulses.torsion.begin_calibration();
                }
                wheels.begin_calibration(seconds)
            }
        }
    }

    /// A drive of the same car begins.
    pub(super) fn roll(&mut self, scenario: &Scenario, seed: u64) -> Result<(), CertifyError> {
        match self {
            Self::Wheels { pulses: Some(pulses), .. } => {
                let car_seed = scenario.wheel_speeds.and_then(|wheels| wheels.car_seed).unwrap_or(seed);
                Ok(pulses.roll(scenario, car_seed, seed)?)
            }
            Self::Wheels { .. } | Self::Car { .. } => Ok(()),
        }
    }

    /// A row of a drive that began `offset_s` after the first one.
    pub(super) fn take(&mut self, row: &SimRow, offset_s: f64) {
        match self {
            Self::Car { car, estimate } => {
                let sample = row.car_sample();
                *estimate = Some(car.update(&CarSample { time_s: offset_s + sample.time_s, ..sample }));
            }
            Self::Wheels { wheels, pulses, report } => {
                let Some((sample, _)) = wheel_speed_sample(row) else { return };
                let sample = WheelSpeedSample { time_s: offset_s + sample.time_s, ..sample };
                match pulses {
                    Some(pulses) => {
                        pulses.until(row.time_s, offset_s);
                        wheels.update_with_pulses(&sample, &mut pulses.torsion);
                    }
                    None => wheels.update(&sample),
                }
                wheels.write_report_into(report);
            }
        }
    }

    /// A sample of a parked car: what its accelerometers read, and wheels that stand.
    pub(super) fn stand(&mut self, time_s: f64, readings: [[f64; 2]; 4]) {
        match self {
            Self::Car { car, estimate } => {
                let corners = readings.map(|[body, wheel]| {
                    Some(CornerSample { body_accel_m_s2: body, wheel_accel_m_s2: wheel })
                });
                *estimate = Some(car.update(&CarSample { time_s, speed_m_s: 0.0, corners }));
            }
            Self::Wheels { wheels, report, .. } => {
                wheels.update(&WheelSpeedSample {
                    time_s,
                    wheel_speed_m_s: [0.0; 4],
                    yaw_rate_rad_s: 0.0,
                    accel_x_m_s2: 0.0,
                    accel_y_m_s2: 0.0,
                    brake: Some(true),
                });
                wheels.write_report_into(report);
            }
        }
    }

    pub(super) fn report(&self) -> &MonitorReport<f64> {
        match self {
            Self::Car { car, .. } => car.report(),
            Self::Wheels { report, .. } => report,
        }
    }

    pub(super) fn lit(&self, lamp: Lamp) -> Wheels {
        match self {
            Self::Car { car, estimate } => {
                estimate.as_ref().map_or(Wheels::NONE, |estimate| lit(lamp, car.report(), estimate))
            }
            Self::Wheels { report, .. } => lit_by_alerts(lamp, report),
        }
    }

    pub(super) fn trace(&self, time_s: f64, row: &SimRow) -> Option<TracePoint> {
        match self {
            Self::Car { estimate, .. } => {
                estimate.as_ref().map(|estimate| TracePoint::new(time_s, row, estimate))
            }
            Self::Wheels { .. } => row.wheel_speeds.as_ref().map(|wheels| TracePoint {
                speed_km_h: 3.6 * row.speed_m_s,
                truth_kpa: wheels.pressure_kpa,
                ..TracePoint::nothing(time_s)
            }),
        }
    }
}
