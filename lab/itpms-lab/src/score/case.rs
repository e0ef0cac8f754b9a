//! The drives of the score: the paper's scenarios, what is changed about them, its test bed, and the sample loop they share.
//!
//! Called by the parts of the score.

use itpms_core::model::{Corner, CornerConfig, CornerEstimate};
use itpms_paper::{AnyEstimator, EstimatorKind};
use itpms_sim::road::{Iso8608, RoadClass, RoadSpec, Surface};
use itpms_sim::scenario::{CornerSpec, Scenario};
use itpms_sim::sensor::SensorSpec;
use itpms_sim::simulation::{CornerRow, SimRow, Simulation};
use itpms_sim::time_profile::Pressure;

use super::stats::Window;
use crate::runner::{Result, StudyError};
use itpms_analysis::bound::{BoundSetting, CornerBound};
use itpms_analysis::spectrum::PowerLaw;

pub(super) const CORNER: Corner = Corner::FrontLeft;
/// Sd in kPa of the estimator's pressure at the start, and so of the bound's.
pub(super) const START_SD_KPA: f64 = 30.0;
/// Steps of the bound along a drive, in s.
const BOUND_STEP_S: f64 = 0.1;

/// A drive to score, and where in it to look.
#[derive(Debug, Clone)]
pub(super) struct Case {
    pub(super) name: String,
    pub(super) kind: EstimatorKind,
    pub(super) scenario: Scenario,
    /// Seconds at the start that the estimator is set to placard pressure.
    reset_s: Option<f64>,
    /// All that counts for RMSE and coverage.
    pub(super) judged: Window,
    /// While the pressure is settled, before and after its change.
    pub(super) before: Window,
    pub(super) after: Window,
    /// The change and the time it takes to notice.
    pub(super) change: Window,
}

impl Case {
    pub(super) fn paper(name: &str, kind: EstimatorKind) -> Result<Self> {
        let scenario = Scenario::builtin(name)?;
        let judged = Window::new(3.0, scenario.duration_s);
        // The recovery of `paper-drop-recover` ends at 27.5 s.
        let (before, change, after) = match name {
            "paper-drop-recover" => ((5.0, 15.0), (15.0, 20.0), (32.0, 40.0)),
            _ => ((5.0, 20.0), (20.0, 25.0), (27.0, 40.0)),
        };
        let window = |(from_s, to_s)| Window::new(from_s, to_s);
        Ok(Self {
            name: name.to_owned(),
            kind,
            scenario,
            reset_s: None,
            judged,
            before: window(before),
            after: window(after),
            change: window(change),
        })
    }

    /// One of the test bed's scenarios by its built-in name, driven at placard pressure until shortly before the change.
    pub(super) fn bench(name: &str, kind: EstimatorKind) -> Result<Self> {
        let scenario = Scenario::builtin(name)?;
        let end_s = scenario.duration_s;
        let (reset_s, before, change, after) = match name {
            "bench-drop" => (20.0, (21.0, 38.0), (38.0, 43.0), (45.0, end_s)),
            "bench-drop-recover" => (4.0, (4.0, 5.0), (5.0, 10.0), (12.0, end_s)),
            _ => (4.0, (4.0, 5.0), (5.0, 35.0), (36.0, end_s)),
        };
        let window = |(from_s, to_s)| Window::new(from_s, to_s);
        Ok(Self {
            name: name.to_owned(),
            kind,
            scenario,
            reset_s: Some(reset_s),
            judged: Window::new(3.0, end_s),
            before: window(before),
            after: window(after),
            change: window(change),
        })
    }

    pub(super) fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// The true sprung mass over the one the estimator is given.
    pub(super) fn with_sprung_mass_factor(mut self, factor: f64) -> Self {
        self.edit_corner(|corner| corner.truth.sprung_mass_factor = factor);
        self
    }

    pub(super) fn with_road(mut self, class: RoadClass, slope: f64) -> Self {
        self.scenario.road = RoadSpec::iso8608(class, slope);
        self
    }

    /// Sensor noise in m/s² rms; the estimator is given it.
    pub(super) fn with_noise(mut self, noise_m_s2: f64) -> Self {
        self.scenario.sensor = SensorSpec::with_noise(noise_m_s2);
        self
    }

    /// One pressure in kPa throughout, and the pressure that the estimator starts from.
    pub(super) fn with_pressure(mut self, pressure_kpa: f64, start_kpa: f64) -> Result<Self> {
        let stiffness = self.corner()?.tire.stiffness_n_per_m(start_kpa);
        self.edit_corner(|corner| {
            corner.pressure = Pressure::ConstantKpa(pressure_kpa);
            corner.initial_stiffness_n_per_m = Some(stiffness);
        });
        Ok(self)
    }

    fn edit_corner(&mut self, edit: impl FnOnce(&mut CornerSpec)) {
        if let Some(corner) = self.scenario.corner.get_mut(CORNER) {
            edit(corner);
        }
    }

    pub(super) fn corner(&self) -> Result<CornerConfig<f64>> {
        Ok(self.scenario.corner_config(CORNER)?)
    }

    fn road(&self) -> Option<&Iso8608> {
        match &self.scenario.road.surface {
            Surface::Iso8608(iso) => Some(iso),
            _ => None,
        }
    }

    /// Every row of the log with its truth and what was estimated after it.
    pub(super) fn drive(
        &self,
        seed: u64,
        mut look: impl FnMut(&SimRow, &CornerRow, &CornerEstimate<f64>),
    ) -> Result<()> {
        let mut estimator = AnyEstimator::new(self.kind, &self.corner()?, self.scenario.rate_hz)?;
        if let Some(seconds) = self.reset_s {
            estimator.begin_calibration(seconds)?;
        }
        for row in Simulation::new(&self.scenario, seed)? {
            let Some(corner) = row.corners[CORNER.index()] else { continue };
            let (body, wheel) = (corner.body_accel_m_s2, corner.wheel_accel_m_s2);
            look(&row, &corner, &estimator.update(row.time_s, row.speed_m_s, body, wheel));
        }
        Ok(())
    }

    /// The Cramer-Rao bound for this kind of drive; `None` where the road has no one spectrum.
    pub(super) fn bound(&self) -> Result<Option<CornerBound>> {
        let Some(road) = self.road() else { return Ok(None) };
        let setting = bound_setting(&self.scenario, road)?;
        Ok(Some(CornerBound::new(&self.corner()?, &setting)?))
    }

    /// Rms in kPa of the bound's sd over the time that is judged; NaN where there is none.
    pub(super) fn bound_rms_kpa(&self) -> Result<f64> {
        let (Some(bound), Some(corner)) = (self.bound()?, self.scenario.corner.get(CORNER)) else {
            return Ok(f64::NAN);
        };
        let pressure = corner.pressure.profile_kpa().map_err(|e| invalid(&self.scenario, e))?;
        let times = bound_times_s(&self.scenario);
        let pressures: Vec<f64> = times.iter().map(|&t| pressure.value(t)).collect();
        let sds = bound.history(&times, &pressures, START_SD_KPA);
        Ok(self.judged.rms(&times, sds.into_iter()))
    }
}

/// Case of a bound: a drive at one speed on one spectrum.
pub(super) fn bound_setting(scenario: &Scenario, road: &Iso8608) -> Result<BoundSetting> {
    Ok(BoundSetting {
        road: PowerLaw { gd_n0_m3: road.roughness.gd_n0_m3(), waviness: road.slope },
        speed_m_s: scenario.speed.profile_m_s().map_err(|e| invalid(scenario, e))?.value(0.0),
        rate_hz: scenario.rate_hz,
        accel_noise_m_s2: scenario.sensor.noise_m_s2,
        ..BoundSetting::paper()
    })
}

/// Times in s at which a bound is followed along a drive.
pub(super) fn bound_times_s(scenario: &Scenario) -> Vec<f64> {
    let steps = (scenario.duration_s / BOUND_STEP_S).round() as usize;
    (0..=steps).map(|i| i as f64 * BOUND_STEP_S).collect()
}

/// A value that no profile can be made of.
pub(super) fn invalid(scenario: &Scenario, source: itpms_sim::error::InvalidValue) -> StudyError {
    itpms_sim::error::ScenarioError::Invalid { scenario: scenario.name.clone(), source }.into()
}
