//! Wheel speeds as written in a scenario.

use serde::{Deserialize, Serialize};

use super::conditions::ConditionsSpec;
use crate::error::{Result, within};

/// Which wheels the engine turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DrivenWheels {
    #[default]
    Front,
    Rear,
    /// All four, each axle by half.
    All,
}

/// The wheels' speeds, what moves them, and the bus that carries them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WheelSpeedSpec {
    /// No accelerations are simulated beside them.
    pub alone: bool,
    /// Seed of the differences from car to car; the drive's, if not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub car_seed: Option<u64>,
    pub driven: DrivenWheels,
    /// Difference in N of the forces of a driven axle's wheels up to which its differential keeps them turning alike; 0: open.
    pub locking_n: f64,
    /// The same as a share of the axle's force, beside.
    pub locking_share: f64,
    /// Time in ms between two messages.
    pub period_ms: f64,
    pub latency_ms: f64,
    /// Step of the speeds in km/h; 0: none.
    pub resolution_km_h: f64,
    /// Share of the messages that is lost: the one before holds.
    pub lost_share: f64,
    /// Imbalances of the wheels turn with these speeds; unless given, with the car's way, which leaves accelerations as they are without wheel speeds.
    pub turns_imbalance: bool,
    pub yaw_rate: bool,
    pub accel_x: bool,
    pub accel_y: bool,
    pub brake: bool,
    /// `d ln R / d ln p` of the rolling radius at the placard's pressure and the unloaded car's load.
    pub radius_per_ln_pressure: f64,
    /// `-d ln R / d ln F` there.
    pub radius_per_ln_load: f64,
    /// Standard deviation of the tires' radii among each other, as a share.
    pub radius_sd: f64,
    /// What each radius differs by beside that, as a share: another tire, a spare wheel.
    pub radius_offsets: [f64; 4],
    /// Share of the radius that the tread loses in a km; driven wheels lose twice as much.
    pub wear_per_km: f64,
    pub slip_stiffness_per_load: f64,
    /// Standard deviation of the brakes' forces among each other, as a share.
    pub brake_imbalance: f64,
    pub grade_sd: f64,
    pub cross_slope_sd: f64,
    pub wind_m_s: f64,
    /// Standard deviation in m/s² of the driver's steering on a straight road.
    pub steering_m_s2: f64,
    /// Standard deviation of a wheel's load on a class B road at 20 m/s, as a share of it.
    pub load_share: f64,
    /// Surfaces, slopes, wind across, trailer, wear, faults; none of it unless given.
    #[serde(skip_serializing_if = "is_off")]
    pub conditions: ConditionsSpec,
}

fn is_off(conditions: &ConditionsSpec) -> bool {
    *conditions == ConditionsSpec::OFF
}

impl Default for WheelSpeedSpec {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl WheelSpeedSpec {
    /// A front-wheel drive whose bus sends everything, with usual errors.
    pub const DEFAULT: Self = Self {
        alone: false,
        car_seed: None,
        driven: DrivenWheels::Front,
        locking_n: 0.0,
        locking_share: 0.0,
        period_ms: 20.0,
        latency_ms: 10.0,
        resolution_km_h: 0.03,
        lost_share: 1e-3,
        turns_imbalance: false,
        yaw_rate: true,
        accel_x: true,
        accel_y: true,
        brake: true,
        radius_per_ln_pressure: 0.007,
        radius_per_ln_load: 0.0064,
        radius_sd: 2e-3,
        radius_offsets: [0.0; 4],
        wear_per_km: 5e-7,
        slip_stiffness_per_load: 50.0,
        brake_imbalance: 0.05,
        grade_sd: 0.02,
        cross_slope_sd: 0.01,
        wind_m_s: 2.0,
        steering_m_s2: 0.15,
        load_share: 0.12,
        conditions: ConditionsSpec::OFF,
    };

    pub(crate) fn validate(&self) -> Result<()> {
        within("locking_n", self.locking_n, 0.0, 1e5, "a force from 0 to 100000 N")?;
        within("locking_share", self.locking_share, 0.0, 10.0, "a share from 0 to 10")?;
        within("period_ms", self.period_ms, 1.0, 100.0, "a time from 1 to 100 ms")?;
        within("latency_ms", self.latency_ms, 0.0, 500.0, "a time from 0 to 500 ms")?;
        within("resolution_km_h", self.resolution_km_h, 0.0, 5.0, "a step from 0 to 5 km/h")?;
        within("lost_share", self.lost_share, 0.0, 0.9, "a share from 0 to 0.9")?;
        within("radius_per_ln_pressure", self.radius_per_ln_pressure, 0.0, 0.1, "a number from 0 to 0.1")?;
        within("radius_per_ln_load", self.radius_per_ln_load, 0.0, 0.1, "a number from 0 to 0.1")?;
        for offset in self.radius_offsets {
            within("radius_offsets", offset, -0.3, 0.3, "shares from -0.3 to 0.3")?;
        }
        within("wear_per_km", self.wear_per_km, 0.0, 1e-3, "a share from 0 to 0.001")?;
        let stiffness = self.slip_stiffness_per_load;
        within("slip_stiffness_per_load", stiffness, 5.0, 500.0, "a number from 5 to 500")?;
        for (name, sd) in [
            ("radius_sd", self.radius_sd),
            ("brake_imbalance", self.brake_imbalance),
            ("grade_sd", self.grade_sd),
            ("cross_slope_sd", self.cross_slope_sd),
            ("load_share", self.load_share),
        ] {
            within(name, sd, 0.0, 0.3, "a share from 0 to 0.3")?;
        }
        self.conditions.validate().map_err(|error| error.within("conditions"))?;
        within("wind_m_s", self.wind_m_s, 0.0, 20.0, "a speed from 0 to 20 m/s")?;
        within("steering_m_s2", self.steering_m_s2, 0.0, 2.0, "an acceleration from 0 to 2 m/s2")
    }
}
