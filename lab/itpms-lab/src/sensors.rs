//! What a car of a study has to find its pressures with.

use itpms_core::model::CarEstimate;
use itpms_core::model::{CarConfig, CarSample, Corner, ParameterError};
use itpms_core::monitor::{MonitorConfig, MonitoredCar, MonitoredWheels};
use itpms_core::torsion::{CarTorsion, TorsionConfig};
use itpms_core::warning::MonitorReport;
use itpms_core::wheel_speed::{DrivenAxle, LoadUncertainty, WheelSpeedConfig, WheelSpeedSample};
use itpms_sim::error::ScenarioError;
use itpms_sim::pulses::PulseCar;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::SimRow;
use itpms_sim::wheel_speeds::{DrivenWheels, WheelSpeedRow, WheelSpeedSpec};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sensors {
    #[default]
    Accelerations,
    /// The four wheel speeds of its bus and nothing else.
    WheelSpeeds,
    /// These and the tooth pulses of the four wheels.
    Pulses,
}

impl Sensors {
    #[must_use]
    pub fn are_of_wheels(self) -> bool {
        self != Self::Accelerations
    }

    /// All, the usual ones first.
    pub const ALL: [Self; 3] = [Self::Accelerations, Self::WheelSpeeds, Self::Pulses];

    /// The name on the command line.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Accelerations => "accelerations",
            Self::WheelSpeeds => "wheel-speeds",
            Self::Pulses => "pulses",
        }
    }

    pub(crate) fn are_usual(&self) -> bool {
        *self == Self::default()
    }
}

/// What a monitor knows of the wheels of a scenario's car: tires nothing is known of. `None`: it has no wheel speeds.
pub(crate) fn wheel_speed_config(
    scenario: &Scenario,
    load: LoadUncertainty<f64>,
) -> Option<WheelSpeedConfig<f64>> {
    let (car, wheels) = (scenario.car.as_ref()?, scenario.wheel_speeds.as_ref()?);
    let driven = match wheels.driven {
        DrivenWheels::Front => DrivenAxle::Front,
        DrivenWheels::Rear => DrivenAxle::Rear,
        DrivenWheels::All => DrivenAxle::Both,
    };
    let limited_slip = wheels.locking_n > 0.0 || wheels.locking_share > 0.0;
    let config = WheelSpeedConfig::new(scenario.wheelbase_m, car.track_front_m, car.track_rear_m, driven);
    Some(WheelSpeedConfig { limited_slip, load, ..config })
}

/// The tooth pulses of a car's drives, one after the other, and what an estimator makes of them: of tires and sensors nothing is known of.
pub(crate) struct Pulses {
    rolling: Option<PulseCar>,
    pub(crate) torsion: Box<CarTorsion<f64>>,
}

impl Pulses {
    pub(crate) fn new(scenario: &Scenario) -> Result<Self, ParameterError> {
        let placard_kpa = Corner::ALL
            .map(|corner| scenario.corner.get(corner).map_or(f64::NAN, |corner| corner.placard_kpa));
        let mut torsion = Box::new(CarTorsion::unconfigured());
        torsion.configure(&[TorsionConfig::new(); 4], &placard_kpa)?;
        Ok(Self { rolling: None, torsion })
    }

    pub(crate) fn roll(
        &mut self,
        scenario: &Scenario,
        car_seed: u64,
        seed: u64,
    ) -> Result<(), ScenarioError> {
        self.rolling = Some(PulseCar::new(scenario, car_seed, seed)?);
        Ok(())
    }

    /// What passes up to a time of the drive, which began `offset_s` after the first one.
    pub(crate) fn until(&mut self, time_s: f64, offset_s: f64) {
        let Self { rolling, torsion } = self;
        let Some(rolling) = rolling else { return };
        rolling.until(time_s, |wheel, at_s| {
            if let Some(corner) = Corner::ALL.get(wheel) {
                torsion.push(*corner, offset_s + at_s);
            }
        });
    }
}

/// What a monitor sees of a row.
pub(crate) fn wheel_speed_sample(row: &SimRow) -> Option<(WheelSpeedSample<f64>, &WheelSpeedRow)> {
    let wheels = row.wheel_speeds.as_ref()?;
    let sample = WheelSpeedSample {
        time_s: row.time_s,
        wheel_speed_m_s: wheels.wheel_speed_m_s,
        yaw_rate_rad_s: wheels.yaw_rate_rad_s,
        accel_x_m_s2: wheels.accel_x_m_s2,
        accel_y_m_s2: wheels.accel_y_m_s2,
        brake: wheels.brake.is_finite().then_some(wheels.brake > 0.5),
    };
    Some((sample, wheels))
}

/// Radius over pressure of the tires of cars on the road: where they have been measured, and where models put them.
const RADIUS_PER_LN_PRESSURE: [f64; 2] = [0.004, 0.016];

/// Wheel speeds beside the accelerations of a drive, of the car of a seed.
pub(crate) fn wheel_speeds_beside(car_seed: u64) -> WheelSpeedSpec {
    let [least, most] = RADIUS_PER_LN_PRESSURE;
    let share: f64 = Pcg64::seed_from_u64(car_seed ^ (1 << 41)).random();
    WheelSpeedSpec {
        car_seed: Some(car_seed),
        radius_per_ln_pressure: least * (most / least).powf(share),
        ..WheelSpeedSpec::default()
    }
}

/// A car's estimator under its monitor, and the monitor of its wheel speeds where it has some.
#[derive(Clone)]
pub(crate) struct Equipped {
    pub(crate) car: Box<MonitoredCar<f64>>,
    pub(crate) wheels: Option<Box<MonitoredWheels<f64>>>,
    report: Box<MonitorReport<f64>>,
}

impl Equipped {
    /// With the wheel speeds of a scenario, if it has some.
    pub(crate) fn new(config: &MonitorConfig<f64>, scenario: &Scenario) -> Result<Self, ParameterError> {
        let mut car = Box::new(MonitoredCar::unconfigured());
        car.configure(config, scenario.rate_hz)?;
        let wheels = match wheel_speed_config(scenario, LoadUncertainty::unknown()) {
            Some(config) => Some(Box::new(MonitoredWheels::new(&config)?)),
            None => None,
        };
        let report = Box::new(*car.report());
        Ok(Self { car, wheels, report })
    }

    pub(crate) fn of(config: &CarConfig<f64>, scenario: &Scenario) -> Result<Self, ParameterError> {
        Self::new(&MonitorConfig::new(config), scenario)
    }

    pub(crate) fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.wheels.as_mut().map_or(Ok(()), |wheels| wheels.begin_calibration(seconds))?;
        self.car.begin_calibration(seconds)
    }

    pub(crate) fn end_calibration(&mut self) {
        if let Some(wheels) = &mut self.wheels {
            wheels.end_calibration();
        }
        self.car.end_calibration();
    }

    /// Takes a row, of which the car's own sensors say `sample`.
    pub(crate) fn update(&mut self, row: &SimRow, sample: &CarSample<f64>) -> CarEstimate<f64> {
        let estimate = self.car.update(sample);
        *self.report = *self.car.report();
        if let (Some(wheels), Some((sample, _))) = (&mut self.wheels, wheel_speed_sample(row)) {
            wheels.update(&sample);
            wheels.write_alert_into(&mut self.report);
            self.car.follow_wheels(wheels);
        }
        estimate
    }

    pub(crate) fn report(&self) -> &MonitorReport<f64> {
        &self.report
    }
}
