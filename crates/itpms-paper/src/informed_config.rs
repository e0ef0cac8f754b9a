//! Configuration of the corrected filter.
//!
//! Used by [`crate::aekf_ui_informed`]; knows nothing of the recursion.

use crate::parameter::ParameterForgetting;
use itpms_core::Real;
use itpms_core::model::{CornerConfig, ParameterError, positive};

/// Settings of the corrected filter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InformedConfig<T> {
    /// Accelerometer noise in m/s², rms per sample, both sensors.
    pub accel_noise_m_s2: T,
    /// Rate in rad/s at which displacement and velocity shared by body and wheel are forgotten. The road's phase
    /// leads by `2 leak / (2 pi f)` at a frequency `f`; drift grows as `leak^(-3/2)`.
    pub leak_rad_s: T,
    /// Disturbance of the velocities in m/s per sqrt(s): what the model and the sampling leave out. It sets how fast
    /// the road's claimed sd drifts, hardly the road itself.
    pub velocity_walk_m_s_sqrt_s: T,
    /// How far the road may have moved unseen, in m per sqrt(s); used while samples are missing.
    pub road_walk_m_sqrt_s: T,
    pub initial_stiffness_n_per_m: T,
    pub initial_stiffness_sd_n_per_m: T,
    /// Random walk of the stiffness in N/m per sqrt(s).
    pub stiffness_walk_n_per_m_sqrt_s: T,
    /// Standard deviation in N/m beyond which walk and forgetting stop: nothing is known there but that there is a tire.
    pub stiffness_sd_limit_n_per_m: T,
    pub lowest_stiffness_n_per_m: T,
    pub highest_stiffness_n_per_m: T,
    pub forgetting: ParameterForgetting<T>,
}

impl<T: Real> InformedConfig<T> {
    /// Defaults for a corner, scaled by its tire: initial sd 30 kPa, walk 10 kPa per sqrt(s), sd limit 40 kPa,
    /// range from 0.9 of the stiffness at 0 kPa (0.09 of the placard's at least) to twice the placard's, leak
    /// 2 pi 0.05 rad/s, sensor noise 0.05 m/s² where the corner does not say. Walk, memory and significance were
    /// chosen so that the 95 % interval holds in the scenarios of `docs/math/forgetting.md`, section 4.
    pub fn for_corner(corner: &CornerConfig<T>) -> Self {
        let per_kpa = corner.tire.stiffness_per_kpa();
        let placard = corner.tire.stiffness_n_per_m(corner.placard_kpa);
        Self {
            accel_noise_m_s2: corner.accel_noise_or_usual_m_s2(),
            leak_rad_s: T::lit(core::f64::consts::TAU * 0.05),
            velocity_walk_m_s_sqrt_s: T::lit(2e-3),
            road_walk_m_sqrt_s: T::lit(0.03),
            initial_stiffness_n_per_m: corner.initial_stiffness_n_per_m(),
            initial_stiffness_sd_n_per_m: per_kpa * T::lit(30.0),
            stiffness_walk_n_per_m_sqrt_s: per_kpa * T::lit(10.0),
            stiffness_sd_limit_n_per_m: per_kpa * T::lit(40.0),
            lowest_stiffness_n_per_m: corner.tire.stiffness_n_per_m(T::zero()).max(placard * T::lit(0.1))
                * T::lit(0.9),
            highest_stiffness_n_per_m: placard * T::lit(2.0),
            forgetting: ParameterForgetting::Adaptive { memory: T::lit(20.0), significance: T::lit(0.5) },
        }
    }

    /// Itself, if a filter can start from it.
    /// Errors: names the first value that is not positive and finite, or outside the stiffness range.
    pub fn validated(self) -> Result<Self, ParameterError> {
        positive("accel_noise_m_s2", self.accel_noise_m_s2)?;
        positive("leak_rad_s", self.leak_rad_s)?;
        positive("velocity_walk_m_s_sqrt_s", self.velocity_walk_m_s_sqrt_s)?;
        positive("road_walk_m_sqrt_s", self.road_walk_m_sqrt_s)?;
        positive("initial_stiffness_sd_n_per_m", self.initial_stiffness_sd_n_per_m)?;
        positive("stiffness_sd_limit_n_per_m", self.stiffness_sd_limit_n_per_m)?;
        positive("lowest_stiffness_n_per_m", self.lowest_stiffness_n_per_m)?;
        positive("highest_stiffness_n_per_m", self.highest_stiffness_n_per_m)?;
        if !(self.stiffness_walk_n_per_m_sqrt_s >= T::zero()
            && self.stiffness_walk_n_per_m_sqrt_s.is_finite())
        {
            return Err(ParameterError {
                name: "stiffness_walk_n_per_m_sqrt_s",
                value: self.stiffness_walk_n_per_m_sqrt_s.to_f64(),
                expected: "a finite number, zero or more",
            });
        }
        let initial = self.initial_stiffness_n_per_m;
        if !(initial >= self.lowest_stiffness_n_per_m && initial <= self.highest_stiffness_n_per_m) {
            return Err(ParameterError {
                name: "initial_stiffness_n_per_m",
                value: initial.to_f64(),
                expected: "a number within the range of possible stiffnesses",
            });
        }
        self.forgetting.validated()?;
        Ok(self)
    }

    /// `stiffness_n_per_m`, moved to the nearest possible one.
    pub(crate) fn within_range(&self, stiffness_n_per_m: T) -> T {
        stiffness_n_per_m.max(self.lowest_stiffness_n_per_m).min(self.highest_stiffness_n_per_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_filter_can_start_from_is_named() {
        let good = InformedConfig::for_corner(&CornerConfig::<f64>::paper());
        assert!(good.validated().is_ok());
        let name = |config: InformedConfig<f64>| config.validated().unwrap_err().name;
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(name(InformedConfig { accel_noise_m_s2: bad, ..good }), "accel_noise_m_s2");
            assert_eq!(name(InformedConfig { leak_rad_s: bad, ..good }), "leak_rad_s");
            let config = InformedConfig { stiffness_sd_limit_n_per_m: bad, ..good };
            assert_eq!(name(config), "stiffness_sd_limit_n_per_m");
        }
        let config = InformedConfig { stiffness_walk_n_per_m_sqrt_s: -1.0, ..good };
        assert_eq!(name(config), "stiffness_walk_n_per_m_sqrt_s");
        for bad in [1.0, 1e9, f64::NAN] {
            let config = InformedConfig { initial_stiffness_n_per_m: bad, ..good };
            assert_eq!(name(config), "initial_stiffness_n_per_m");
        }
    }
}
