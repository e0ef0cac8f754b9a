//! The drives of the study: the built-in scenarios of the paper's Sections 4 and 5, and what is changed about them.
//!
//! Called by `plan`.

use itpms_sim::road::Surface;
use itpms_sim::scenario::{CornerSpec, Scenario};
use itpms_sim::sensor::SensorSpec;

use super::contestant::{Contestant, Tuning};
use super::{CORNER, Request};
use crate::runner::{Result, refused};

/// Errors count from here on, in s: the standard scenarios' definition of their RMSE.
pub(super) const JUDGED_FROM_S: f64 = 3.0;

/// A drive, who takes part, and how the published filters are tuned.
#[derive(Debug, Clone)]
pub(super) struct Case {
    pub(super) scenario: Scenario,
    pub(super) tuning: Tuning,
    pub(super) contestants: Vec<Contestant>,
}

impl Case {
    /// One of Sec. 4 by its built-in name.
    pub(super) fn simulation(name: &str, request: &Request) -> Result<Self> {
        let mut scenario = Scenario::builtin(name)?;
        scenario.rate_hz = request.rate_hz;
        scenario.sensor = SensorSpec { noise_m_s2: request.noise_m_s2, ..scenario.sensor };
        if let Surface::Iso8608(road) = &mut scenario.road.surface {
            road.roughness = request.road_gd_n0_m3.into();
        }
        Ok(Self { scenario, tuning: Tuning::Simulation, contestants: Contestant::all(0.0) })
    }

    /// One of Sec. 5: the four after a reset of `reset_s`, and the default without.
    pub(super) fn bench(name: &str, reset_s: f64, request: &Request) -> Result<Self> {
        let mut scenario = Scenario::builtin(name)?;
        scenario.rate_hz = request.bench_rate_hz;
        if let Surface::Bench(road) = &mut scenario.road.surface {
            road.roughness = request.road_gd_n0_m3.into();
            road.actuator.natural_frequency_hz = request.bench_actuator_hz;
        }
        let mut contestants = Contestant::all(reset_s);
        contestants.push(Contestant { kind: itpms_paper::EstimatorKind::Informed, reset_s: 0.0 });
        let case = Self { scenario, tuning: Tuning::Bench, contestants };
        case.changed(|corner| corner.unsprung_mass_kg = request.bench_unsprung_mass_kg)
    }

    /// The true sprung mass in kg, while the estimators are given `stated_kg`.
    pub(super) fn with_sprung_mass(self, true_kg: f64, stated_kg: f64) -> Result<Self> {
        self.changed(|corner| {
            corner.sprung_mass_kg = stated_kg;
            corner.truth.sprung_mass_factor = true_kg / stated_kg;
        })
    }

    /// Variance in (m/s²)² of the unsprung accelerometer's noise.
    pub(super) fn with_wheel_noise_variance(self, variance: f64) -> Result<Self> {
        let usual = self.scenario.sensor;
        self.changed(|corner| {
            let sensor = corner.wheel_sensor.unwrap_or(usual);
            corner.wheel_sensor = Some(SensorSpec { noise_m_s2: variance.sqrt(), ..sensor });
        })
    }

    fn changed(mut self, change: impl FnOnce(&mut CornerSpec)) -> Result<Self> {
        match self.scenario.corner.get_mut(CORNER) {
            Some(corner) => change(corner),
            None => {
                let name = self.scenario.name;
                return refused(format!("scenario {name} has no front left corner, expected one"));
            }
        }
        Ok(self)
    }
}
