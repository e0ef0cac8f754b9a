//! One corner of a scenario: what its estimator is given, how the true one differs, and its pressure.

use itpms_core::model::{Confidence, Corner, CornerConfig, ParameterUncertainty, PressureMap, QuarterCar};
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::plant::Deviations;
use crate::pressure_sensor::PressureSensorSpec;
use crate::sensor::SensorSpec;
use crate::time_profile::Pressure;

/// Stiffness over pressure, as in a vehicle file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TireSpec {
    pub stiffness_per_kpa: f64,
    /// N/m at zero gauge pressure.
    pub stiffness_at_zero: f64,
}

impl Default for TireSpec {
    fn default() -> Self {
        let map = PressureMap::<f64>::paper_eq_5();
        Self { stiffness_per_kpa: map.stiffness_per_kpa(), stiffness_at_zero: map.stiffness_at_zero() }
    }
}

impl TireSpec {
    /// The map from pressure to stiffness. Errors: a slope that is not positive or an intercept that is negative.
    pub fn map(&self) -> Result<PressureMap<f64>> {
        Ok(PressureMap::new(self.stiffness_per_kpa, self.stiffness_at_zero)?)
    }
}

/// A corner as written in a scenario. What a vehicle file also says has the same name here, and the paper's Table 2 and eq. (5) as default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CornerSpec {
    #[serde(default = "sprung_mass_kg")]
    pub sprung_mass_kg: f64,
    #[serde(default = "unsprung_mass_kg")]
    pub unsprung_mass_kg: f64,
    #[serde(default = "damping_n_s_per_m")]
    pub damping_n_s_per_m: f64,
    /// Suspension spring the estimator is given, in N/m.
    #[serde(default = "spring_n_per_m")]
    pub spring_n_per_m: f64,
    #[serde(default = "placard_kpa")]
    pub placard_kpa: f64,
    /// Sensor noise the estimator is given, in m/s² rms per sample; the wheel sensor's true one, if not given.
    pub accel_noise_m_s2: Option<f64>,
    /// Stiffness the estimator starts from, in N/m; the placard's, if not given.
    pub initial_stiffness_n_per_m: Option<f64>,
    pub pressure: Pressure,
    #[serde(default)]
    pub tire: TireSpec,
    /// How the true corner differs from what the estimator is given.
    #[serde(default)]
    pub truth: Deviations,
    /// The body's accelerometer, if not the scenario's usual one.
    pub body_sensor: Option<SensorSpec>,
    /// The wheel's accelerometer, if not the scenario's usual one.
    pub wheel_sensor: Option<SensorSpec>,
    /// The sensor whose reading a log holds as the pressure; without one it holds the true pressure.
    pub pressure_sensor: Option<PressureSensorSpec>,
}

fn sprung_mass_kg() -> f64 {
    QuarterCar::<f64>::paper_table_2().sprung_mass_kg()
}

fn unsprung_mass_kg() -> f64 {
    QuarterCar::<f64>::paper_table_2().unsprung_mass_kg()
}

fn damping_n_s_per_m() -> f64 {
    QuarterCar::<f64>::paper_table_2().damping_n_s_per_m()
}

fn spring_n_per_m() -> f64 {
    QuarterCar::<f64>::paper_table_2().spring_n_per_m()
}

fn placard_kpa() -> f64 {
    CornerConfig::<f64>::paper().placard_kpa
}

impl CornerSpec {
    pub fn paper(pressure: Pressure) -> Self {
        Self {
            sprung_mass_kg: sprung_mass_kg(),
            unsprung_mass_kg: unsprung_mass_kg(),
            damping_n_s_per_m: damping_n_s_per_m(),
            spring_n_per_m: spring_n_per_m(),
            placard_kpa: placard_kpa(),
            accel_noise_m_s2: None,
            initial_stiffness_n_per_m: None,
            pressure,
            tire: TireSpec::default(),
            truth: Deviations::default(),
            body_sensor: None,
            wheel_sensor: None,
            pressure_sensor: None,
        }
    }

    /// Takes a vehicle's values for what the estimator is given (and the truth deviates from).
    pub fn set_vehicle(&mut self, vehicle: &CornerConfig<f64>) {
        self.sprung_mass_kg = vehicle.quarter_car.sprung_mass_kg();
        self.unsprung_mass_kg = vehicle.quarter_car.unsprung_mass_kg();
        self.damping_n_s_per_m = vehicle.quarter_car.damping_n_s_per_m();
        self.spring_n_per_m = vehicle.quarter_car.spring_n_per_m();
        self.placard_kpa = vehicle.placard_kpa;
        self.accel_noise_m_s2 = vehicle.accel_noise_m_s2;
        self.tire = TireSpec {
            stiffness_per_kpa: vehicle.tire.stiffness_per_kpa(),
            stiffness_at_zero: vehicle.tire.stiffness_at_zero(),
        };
    }

    /// The quarter car the estimator is given. Errors: names the parameter that is not positive.
    pub fn quarter_car(&self) -> Result<QuarterCar<f64>> {
        Ok(QuarterCar::new(
            self.sprung_mass_kg,
            self.unsprung_mass_kg,
            self.damping_n_s_per_m,
            self.spring_n_per_m,
        )?)
    }

    pub(crate) fn config(&self, usual: &SensorSpec, confidence: Confidence) -> Result<CornerConfig<f64>> {
        let map = self.tire.map()?;
        let mut config = CornerConfig::new(self.quarter_car()?, map, self.placard_kpa)?;
        config.uncertainty = ParameterUncertainty::of(confidence);
        if confidence == Confidence::Measured {
            // Friction was measured as well: the modelled strut has none unless the truth deviates.
            config.uncertainty.friction_n = 0.0;
        }
        let noise = self.accel_noise_m_s2.unwrap_or(self.wheel_sensor.unwrap_or(*usual).noise_m_s2);
        if noise > 0.0 {
            config = config.with_accel_noise(noise)?;
        }
        match self.initial_stiffness_n_per_m {
            Some(stiffness) => Ok(config.with_initial_pressure(map.pressure_kpa(stiffness))?),
            None => Ok(config),
        }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        self.config(&SensorSpec::default(), Confidence::default())?;
        self.pressure.profile_kpa().map_err(|e| e.within("pressure"))?;
        self.truth.validate().map_err(|e| e.within("truth"))?;
        for (name, sensor) in [("body_sensor", &self.body_sensor), ("wheel_sensor", &self.wheel_sensor)] {
            if let Some(sensor) = sensor {
                sensor.validate().map_err(|e| e.within(name))?;
            }
        }
        if let Some(sensor) = &self.pressure_sensor {
            sensor.validate().map_err(|e| e.within("pressure_sensor"))?;
        }
        Ok(())
    }
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Corners {
    pub fl: Option<CornerSpec>,
    pub fr: Option<CornerSpec>,
    pub rl: Option<CornerSpec>,
    pub rr: Option<CornerSpec>,
}

impl Corners {
    /// A corner, if the scenario has it.
    pub fn get(&self, corner: Corner) -> Option<&CornerSpec> {
        [&self.fl, &self.fr, &self.rl, &self.rr][corner.index()].as_ref()
    }

    /// A corner to change, if the scenario has it.
    pub fn get_mut(&mut self, corner: Corner) -> Option<&mut CornerSpec> {
        self.iter_mut().find_map(|(other, spec)| (other == corner).then_some(spec))
    }

    /// The corners there are, in the order of [`Corner::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Corner, &CornerSpec)> {
        Corner::ALL.into_iter().filter_map(|corner| self.get(corner).map(|spec| (corner, spec)))
    }

    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Corner, &mut CornerSpec)> {
        let all = [&mut self.fl, &mut self.fr, &mut self.rl, &mut self.rr];
        Corner::ALL.into_iter().zip(all).filter_map(|(corner, spec)| Some((corner, spec.as_mut()?)))
    }
}
