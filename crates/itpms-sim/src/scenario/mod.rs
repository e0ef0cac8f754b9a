//! A drive written down: how long, how fast, over which road, with which pressures, seen through which sensors.
//!
//! Called by the binary and the score; [`Simulation`](crate::simulation::Simulation) drives it. A scenario says both what the estimator is
//! given about a corner and how the true one differs. All fields are public: a study takes a built-in scenario and changes what it studies.
//!
//! The built-in scenarios are the TOML files in `scenarios/`, which also serve as examples.

mod confidence;
mod corner;
mod file;
mod journey;
mod tolerance;
mod warm_up;

use serde::{Deserialize, Serialize};

use itpms_core::model::{CarConfig, Confidence, Corner, CornerConfig};

pub use corner::{CornerSpec, Corners, TireSpec};
pub use journey::JourneySpec;
pub use tolerance::{Draw, ToleranceSpec};

use crate::antialias::AntiAliasSpec;
use crate::car::CarSpec;
use crate::error::{InvalidValue, Result, ScenarioError, within};
use crate::fault::FaultSpec;
use crate::road::{RoadSpec, Surface};
use crate::sensor::SensorSpec;
use crate::time_profile::Speed;
use crate::wheel_speeds::WheelSpeedSpec;

#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ClockSpec {
    /// Each sample is early or late by up to this fraction of the sampling period, evenly spread; `time_s` says when it was really taken.
    pub jitter: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    pub name: String,
    #[serde(default)]
    pub description: String,
    pub duration_s: f64,
    pub rate_hz: f64,
    /// Time in s driven before the log starts, at the speed and pressures of its start, so that it starts in motion.
    #[serde(default = "usual_settling_s")]
    pub settle_s: f64,
    /// Distance in m from front to rear axle: rear wheels meet the road that much later.
    #[serde(default = "usual_wheelbase_m")]
    pub wheelbase_m: f64,
    /// How far beside the front wheels' track the rear ones run in m, without a [`CarSpec`] (which has its own).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rear_offset_m: f64,
    /// How well the vehicle file knows the car: `measured`, `typical` or `rough`.
    #[serde(default = "measured", with = "confidence")]
    pub confidence: Confidence,
    pub speed: Speed,
    pub road: RoadSpec,
    /// The accelerometers, where a corner does not name its own.
    #[serde(default)]
    pub sensor: SensorSpec,
    /// The low-pass before the samplers.
    #[serde(default)]
    pub antialias: AntiAliasSpec,
    #[serde(default)]
    pub clock: ClockSpec,
    /// The body over all four corners; without one, corners are quarter cars on their own, and the tracks of left and
    /// right wheels independent roads.
    pub car: Option<CarSpec>,
    /// What speed, road, turns and loads are composed of, from the seed; `speed` and `road.surface` are `"journey"` then.
    pub journey: Option<JourneySpec>,
    /// The speeds of the four wheels; not in the log, if not given. Needs a [`CarSpec`].
    pub wheel_speeds: Option<WheelSpeedSpec>,
    /// Sensors that go wrong for a while.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fault: Vec<FaultSpec>,
    pub corner: Corners,
}

/// Sprung mass motions of a passenger car decay like exp(-2 t): what is left after this is below the noise.
fn usual_settling_s() -> f64 {
    4.0
}

/// Whoever writes a scenario knows its car.
fn measured() -> Confidence {
    Confidence::Measured
}

fn usual_wheelbase_m() -> f64 {
    2.7
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn is_one(value: &f64) -> bool {
    *value == 1.0
}

impl Scenario {
    /// Checks every number. Errors: [`ScenarioError::Invalid`] names the first value that is out of range.
    pub fn validate(&self) -> Result<(), ScenarioError> {
        self.first_invalid().map_err(|source| ScenarioError::Invalid { scenario: self.name.clone(), source })
    }

    /// The drive of a seed with every point written out; without a [`JourneySpec`] the scenario as it is.
    /// Errors: a value out of range, or a journey in only a part of the scenario.
    pub fn composed(&self, seed: u64) -> Result<Self, ScenarioError> {
        self.validate()?;
        Ok(self.with_journey(seed))
    }

    fn with_journey(&self, seed: u64) -> Self {
        let mut scenario = self.clone();
        if let Some(spec) = scenario.journey.take() {
            let journey = spec.compose(seed, self.duration_s);
            if let Some(tolerances) = &spec.tolerances {
                tolerances.apply(seed, &mut scenario);
            }
            scenario.speed = Speed::PointsSKmH(journey.points_s_km_h);
            scenario.road.surface = Surface::Segments(journey.segments);
            if spec.warms_by_k > 0.0 || spec.air_k != 0.0 {
                warm_up::warm([spec.air_k, spec.warms_by_k], seed, &mut scenario);
            }
            if let Some(car) = &mut scenario.car {
                car.lateral_points_s_m_s2 = journey.lateral_points_s_m_s2;
                car.payload = journey.payload;
            }
        }
        scenario
    }

    /// Of a scenario with a journey: that it is one throughout, and one that can be driven.
    fn first_invalid_of_journey(&self, journey: &JourneySpec) -> Result<()> {
        within("duration_s", self.duration_s, 0.1, 1e6, "a duration from 0.1 to 1000000 s")?;
        journey.validate().map_err(|e| e.within("journey"))?;
        let found = "given beside a [journey]";
        if self.speed != Speed::Journey {
            return Err(InvalidValue::new("speed", found, "\"journey\""));
        }
        if self.road.surface != Surface::Journey {
            return Err(InvalidValue::new("road.surface", found, "\"journey\""));
        }
        match &self.car {
            None => Err(InvalidValue::new("car", "missing", "a [car] to go on the [journey]")),
            Some(car) if !(car.payload.is_empty() && car.lateral_points_s_m_s2.is_empty()) => {
                let expected = "neither payload nor lateral_points_s_m_s2";
                Err(InvalidValue::new("car", "loaded or turned beside a [journey]", expected))
            }
            Some(_) => self.with_journey(0).first_invalid(),
        }
    }

    fn first_invalid(&self) -> Result<()> {
        if let Some(journey) = &self.journey {
            return self.first_invalid_of_journey(journey);
        }
        within("duration_s", self.duration_s, 0.1, 1e6, "a duration from 0.1 to 1000000 s")?;
        within("rate_hz", self.rate_hz, 20.0, 10_000.0, "a rate from 20 to 10000 Hz")?;
        within("settle_s", self.settle_s, 0.0, 60.0, "a time from 0 to 60 s")?;
        within("wheelbase_m", self.wheelbase_m, 0.5, 7.0, "a length from 0.5 to 7 m")?;
        within("rear_offset_m", self.rear_offset_m, -1.0, 1.0, "a distance from -1 to 1 m")?;
        if self.car.is_some() && self.rear_offset_m != 0.0 {
            let found = format!("{} beside a [car]", self.rear_offset_m);
            return Err(InvalidValue::new("rear_offset_m", found, "car.rear_offset_m in its place"));
        }
        self.speed.profile_m_s().map_err(|e| e.within("speed"))?;
        self.road.validate().map_err(|e| e.within("road"))?;
        if matches!(self.road.surface, Surface::Bench(_)) && self.one_speed_m_s().is_none() {
            let found = "given with a speed that changes or is 0";
            return Err(InvalidValue::new("road.surface.bench", found, "constant_km_h above 0"));
        }
        self.sensor.validate().map_err(|e| e.within("sensor"))?;
        self.antialias.validate().map_err(|e| e.within("antialias"))?;
        within("clock.jitter", self.clock.jitter, 0.0, 0.49, "a fraction from 0 to 0.49")?;
        if self.corner.iter().next().is_none() {
            return Err(InvalidValue::new("corner", "empty", "at least one of fl, fr, rl, rr"));
        }
        for (corner, spec) in self.corner.iter() {
            spec.validate().map_err(|e| e.within(corner.label()).within("corner"))?;
            let of_a_car =
                [("imbalance_kg_m", spec.truth.imbalance_kg_m), ("hop_damper_kg", spec.truth.hop_damper_kg)];
            if let Some((name, found)) = of_a_car.into_iter().find(|(_, v)| self.car.is_none() && *v > 0.0) {
                let field = format!("corner.{}.truth.{name}", corner.label());
                return Err(InvalidValue::new(field, found, "a [car], or 0 without one"));
            }
        }
        for fault in &self.fault {
            fault.validate().map_err(|e| e.within("fault"))?;
        }
        if let Some(wheels) = &self.wheel_speeds {
            wheels.validate().map_err(|e| e.within("wheel_speeds"))?;
            if self.car.is_none() {
                return Err(InvalidValue::new("car", "missing", "a [car] for the [wheel_speeds]"));
            }
        }
        if let Some(car) = &self.car {
            car.validate().map_err(|e| e.within("car"))?;
            let corners = self.corner.iter().count();
            if corners != Corner::ALL.len() {
                let found = format!("given with {corners} of the corners");
                return Err(InvalidValue::new("car", found, "all of fl, fr, rl, rr"));
            }
        }
        Ok(())
    }

    pub fn rows(&self) -> u64 {
        // A duration of 40 s at 500 Hz is 20 000 rows, whatever the rounding of the product.
        (self.duration_s * self.rate_hz + 1e-6) as u64
    }

    /// The speed in m/s of a drive that has only one, above 0.
    pub(crate) fn one_speed_m_s(&self) -> Option<f64> {
        match self.speed {
            Speed::ConstantKmH(km_h) if km_h > 0.0 => Some(km_h / 3.6),
            _ => None,
        }
    }

    /// Configuration of a corner's estimator: the vehicle file's values, the sensor noise, where to start.
    /// Errors: the scenario has no such corner, or one of the values is out of range.
    pub fn corner_config(&self, corner: Corner) -> Result<CornerConfig<f64>, ScenarioError> {
        let config = match self.corner.get(corner) {
            Some(spec) => spec
                .config(&self.sensor, self.confidence)
                .map_err(|e| e.within(corner.label()).within("corner")),
            None => Err(InvalidValue::new(format!("corner.{}", corner.label()), "missing", "a corner")),
        };
        config.map_err(|source| ScenarioError::Invalid { scenario: self.name.clone(), source })
    }

    /// The same of all corners there are.
    pub fn car_config(&self) -> Result<CarConfig<f64>, ScenarioError> {
        let mut config = CarConfig { corners: [None; 4], wheelbase_m: Some(self.wheelbase_m) };
        for (corner, _) in self.corner.iter() {
            config.corners[corner.index()] = Some(self.corner_config(corner)?);
        }
        Ok(config)
    }
}
