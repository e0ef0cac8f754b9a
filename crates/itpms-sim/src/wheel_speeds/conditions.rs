//! What makes one drive differ from another, as written in a scenario: surfaces, slopes, wind, trailer, wear, faults of the yaw rate.
//!
//! `[wheel_speeds.conditions]`. Each effect is off where its number is 0; what is drawn of it comes from a generator of its own, so
//! that a drive without conditions is the one it was. `docs/math/simulation.md`, eq. 16a-16i.

use serde::{Deserialize, Serialize};

use crate::error::{Result, within};

/// Fault of the yaw rate on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum YawFault {
    #[default]
    None,
    /// It stays at its offset.
    Dead,
    /// Positive to the right.
    Reversed,
    HalfGain,
    /// Degrees per second taken for radians.
    Degrees,
    /// Noise of 0.2 rad/s beside it.
    Noisy,
}

impl YawFault {
    pub const ALL: [Self; 5] = [Self::Dead, Self::Reversed, Self::HalfGain, Self::Degrees, Self::Noisy];

    pub fn label(self) -> &'static str {
        match self {
            Self::None => "good",
            Self::Dead => "dead",
            Self::Reversed => "reversed",
            Self::HalfGain => "half-gain",
            Self::Degrees => "degrees",
            Self::Noisy => "noisy",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ConditionsSpec {
    /// Share of the stretches of road that are wet.
    pub wet_share: f64,
    pub snow_share: f64,
    pub gravel_share: f64,
    /// Share of the stretches that are another surface on the right than on the left.
    pub split_share: f64,
    pub surface_m: f64,
    /// Standard deviation of `ln` of the slip stiffness among stretches of one surface.
    pub surface_spread: f64,
    /// The same of all tires from drive to drive.
    pub slip_day_sd: f64,
    /// How much of its proportionality to the load the slip stiffness lacks: it goes with the load to the power of 1 less this.
    pub slip_load_loss: f64,
    /// How far the front wheels are steered each about the turn's center: 0 both alike, 1 fully.
    pub ackermann: f64,
    /// Mean fall of the road to the right.
    pub crown: f64,
    /// Standard deviation of the fall among stretches.
    pub crown_spread: f64,
    /// Share of a bend's lateral acceleration that its bank carries, up to a slope of 7 %.
    pub bank: f64,
    /// Standard deviation of the wind across in m/s.
    pub side_wind_m_s: f64,
    pub trailer_kg: f64,
    /// Share of it that the hitch carries.
    pub tongue_share: f64,
    /// Drag of the trailer per squared air speed in N s²/m².
    pub trailer_drag_n_s2_per_m2: f64,
    /// Distance in km that the tires have rolled before the drive.
    pub odometer_km: f64,
    /// Standard deviation among the tires of the tread's loss, as a share.
    pub wear_spread: f64,
    /// How often in an hour a side of the car runs for 5 to 30 s on a softer and rougher strip.
    pub passing_per_h: f64,
    /// Mean of such a strip's addition to a wheel's way, as a share.
    pub passing_way: f64,
    /// Error of the yaw rate's scale, as a share.
    pub yaw_scale: f64,
    /// Standard deviation in rad/s of its offset's wander in ten minutes, beside the usual one.
    pub yaw_drift_rad_s: f64,
    pub yaw_fault: YawFault,
}

impl ConditionsSpec {
    /// A dry and even road, no trailer, no wear, a yaw rate as it is otherwise.
    pub const OFF: Self = Self {
        wet_share: 0.0,
        snow_share: 0.0,
        gravel_share: 0.0,
        split_share: 0.0,
        surface_m: 800.0,
        surface_spread: 0.0,
        slip_day_sd: 0.0,
        slip_load_loss: 0.0,
        ackermann: 0.0,
        crown: 0.0,
        crown_spread: 0.0,
        bank: 0.0,
        side_wind_m_s: 0.0,
        trailer_kg: 0.0,
        tongue_share: 0.06,
        trailer_drag_n_s2_per_m2: 0.0,
        odometer_km: 0.0,
        wear_spread: 0.0,
        passing_per_h: 0.0,
        passing_way: 0.0,
        yaw_scale: 0.0,
        yaw_drift_rad_s: 0.0,
        yaw_fault: YawFault::None,
    };

    pub(crate) fn validate(&self) -> Result<()> {
        let shares = [
            ("wet_share", self.wet_share),
            ("snow_share", self.snow_share),
            ("gravel_share", self.gravel_share),
            ("split_share", self.split_share),
            ("slip_load_loss", self.slip_load_loss),
            ("ackermann", self.ackermann),
            ("bank", self.bank),
        ];
        for (name, share) in shares {
            within(name, share, 0.0, 1.0, "a share from 0 to 1")?;
        }
        let not_dry = self.wet_share + self.snow_share + self.gravel_share;
        within(
            "wet_share",
            not_dry,
            0.0,
            1.0 + 1e-9,
            "shares of wet, snow and gravel of 1 together at most",
        )?;
        within("surface_m", self.surface_m, 5.0, 1e6, "a length from 5 to 1000000 m")?;
        for (name, sd) in [
            ("surface_spread", self.surface_spread),
            ("slip_day_sd", self.slip_day_sd),
            ("wear_spread", self.wear_spread),
        ] {
            within(name, sd, 0.0, 1.0, "a number from 0 to 1")?;
        }
        within("crown", self.crown, -0.1, 0.1, "a slope from -0.1 to 0.1")?;
        within("crown_spread", self.crown_spread, 0.0, 0.1, "a slope from 0 to 0.1")?;
        within("side_wind_m_s", self.side_wind_m_s, 0.0, 20.0, "a speed from 0 to 20 m/s")?;
        within("trailer_kg", self.trailer_kg, 0.0, 3500.0, "a mass from 0 to 3500 kg")?;
        within("tongue_share", self.tongue_share, 0.0, 0.2, "a share from 0 to 0.2")?;
        let drag = self.trailer_drag_n_s2_per_m2;
        within("trailer_drag_n_s2_per_m2", drag, 0.0, 5.0, "a drag from 0 to 5 N s2/m2")?;
        within("odometer_km", self.odometer_km, 0.0, 1e5, "a distance from 0 to 100000 km")?;
        within("passing_per_h", self.passing_per_h, 0.0, 100.0, "a number from 0 to 100")?;
        within("passing_way", self.passing_way, 0.0, 0.05, "a share from 0 to 0.05")?;
        within("yaw_scale", self.yaw_scale, -0.5, 0.5, "a share from -0.5 to 0.5")?;
        within("yaw_drift_rad_s", self.yaw_drift_rad_s, 0.0, 0.1, "a yaw rate from 0 to 0.1 rad/s")
    }
}

impl Default for ConditionsSpec {
    fn default() -> Self {
        Self::OFF
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_that_no_road_has_are_refused() {
        let refused = |spec: ConditionsSpec| spec.validate().is_err();
        assert!(!refused(ConditionsSpec::OFF));
        assert!(refused(ConditionsSpec { wet_share: 0.6, snow_share: 0.6, ..ConditionsSpec::OFF }));
        assert!(refused(ConditionsSpec { trailer_kg: f64::NAN, ..ConditionsSpec::OFF }));
        assert!(refused(ConditionsSpec { surface_m: 0.0, ..ConditionsSpec::OFF }));
    }
}
