//! Sensors of a study's car.

use itpms_core::model::{Corner, ParameterError};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_core::torsion::{CarTorsion, TorsionConfig};
use itpms_core::wheel_speed::{DrivenAxle, LoadUncertainty, WheelSpeedConfig};
use itpms_sim::error::ScenarioError;
use itpms_sim::pulses::PulseCar;
use itpms_sim::scenario::Scenario;
use itpms_sim::wheel_speeds::{DrivenWheels, WheelSpeedSpec};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Sensors {
        #[default]
        Accelerations = "accelerations",
        /// The four wheel speeds of its bus and nothing else.
        WheelSpeeds = "wheel-speeds",
        /// These and the tooth pulses of the four wheels.
        Pulses = "pulses",
    }
}

impl Sensors {
    pub fn are_of_wheels(self) -> bool {
        self != Self::Accelerations
    }

    pub(crate) fn are_usual(&self) -> bool {
        *self == Self::default()
    }
}

/// A monitor's configuration for the wheels of a scenario's car, of unknown tires. `None`: it has no wheel speeds.
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
    Some(WheelSpeedConfig { limited_slip, load, tuning: crate::tuning::numbers().wheel_speed, ..config })
}

/// A car whose tooth pulses may be read.
pub(crate) type PulsedCar = MonitoredCar<f64, Option<Box<CarTorsion<f64>>>>;

/// The tooth pulses of a car's drives, one after the other.
pub(crate) struct Pulses(Option<PulseCar>);

impl Pulses {
    /// Lets a car read them, with tires and sensors nothing is known of.
    pub(crate) fn read_by(car: &mut PulsedCar, scenario: &Scenario) -> Result<Self, ParameterError> {
        let placard_kpa = Corner::ALL
            .map(|corner| scenario.corner.get(corner).map_or(f64::NAN, |corner| corner.placard_kpa));
        let mut torsion = Box::new(CarTorsion::unconfigured());
        torsion.configure(&[TorsionConfig::new(); 4], &placard_kpa)?;
        car.read_pulses(torsion);
        Ok(Self(None))
    }

    pub(crate) fn roll(
        &mut self,
        scenario: &Scenario,
        car_seed: u64,
        seed: u64,
    ) -> Result<(), ScenarioError> {
        self.0 = Some(PulseCar::new(scenario, car_seed, seed)?);
        Ok(())
    }

    /// Hands the car those that pass up to a time of the drive, which began `offset_s` after the first one.
    pub(crate) fn until(&mut self, time_s: f64, offset_s: f64, car: &mut PulsedCar) {
        if let Some((rolling, torsion)) = self.0.as_mut().zip(car.torsion_mut()) {
            rolling.until(time_s, |wheel, at_s| {
                if let Some(corner) = Corner::ALL.get(wheel) {
                    torsion.push(*corner, offset_s + at_s);
                }
            });
        }
    }
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

/// A car's estimator under its monitors, with the wheel speeds of a scenario that has some.
pub(crate) fn equipped(
    config: &MonitorConfig<f64>,
    scenario: &Scenario,
) -> Result<Box<MonitoredCar<f64>>, ParameterError> {
    let wheel_speeds = wheel_speed_config(scenario, LoadUncertainty::unknown());
    let mut car = Box::new(MonitoredCar::unconfigured());
    car.configure(&MonitorConfig { wheel_speeds, ..*config }, scenario.rate_hz)?;
    Ok(car)
}
