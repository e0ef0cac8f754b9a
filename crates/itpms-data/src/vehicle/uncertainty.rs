//! How well a corner's parameters are known (docs/vehicle.md, section 3). Asked for by whoever weighs them; knows no file.

use itpms_core::model::Corner;

use super::Vehicle;
use super::details::Confidence;

/// Of the variance of an unsprung mass, the share that all four wheels of a car have in common and the share in which
/// front and rear differ: what is guessed wrongly of one wheel is guessed wrongly of all (sizes, alloys, brakes of the
/// model), then of an axle (its kind, its drive). 0.8² + 0.6² = 1: left and right are alike.
const COMMON_SHARE: f64 = 0.8;
const AXLE_SHARE: f64 = 0.6;

/// Standard deviations of one corner's parameters, relative (0.05 is 5 %) unless the name has a unit, with the two
/// parameters that an estimator is not told of today.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterUncertainty {
    /// Of the sprung mass: which load the value is for. Estimators identify the load on the way.
    pub sprung_mass_relative_sd: f64,
    /// Of the unsprung mass.
    pub unsprung_mass_relative_sd: f64,
    /// Of the suspension spring.
    pub spring_relative_sd: f64,
    /// Of the damping.
    pub damping_relative_sd: f64,
    /// Of the tire's line of stiffness over pressure, as one scale.
    pub stiffness_relative_sd: f64,
    /// Coulomb friction of the strut in N.
    pub friction_n: f64,
    /// Its standard deviation in N.
    pub friction_sd_n: f64,
    /// Vertical damping of the tire in N s/m.
    pub tire_damping_n_s_per_m: f64,
    /// Its standard deviation in N s/m.
    pub tire_damping_sd_n_s_per_m: f64,
}

impl ParameterUncertainty {
    /// What is usual for parameters of this origin.
    ///
    /// | | measured | typical | rough |
    /// |---|---|---|---|
    /// | sprung mass | 2 %: a scale, and the fuel since | 8 %: driver, passengers, luggage | 15 % |
    /// | unsprung mass | 1.5 %: parts on a scale; how much of a link moves with the wheel is a convention | 5 %: 4 % in common, 3 % by axle | 10 % |
    /// | spring | 3 %: a slow load and unload, bushings included | 15 %: rate at the wheel, not at the coil | 30 % |
    /// | damping | 5 %: linear part of a curved, warm damper | 15 % | 30 % |
    /// | tire stiffness | 1 %: a test bench on the tire fitted | 3 %: same size and maker; wear, temperature, speed | 8 %: from the size alone |
    /// | friction | 20 ± 10 N | 30 ± 20 N | 40 ± 40 N |
    /// | tire damping | 50 ± 20 N s/m | 50 ± 30 N s/m | 50 ± 50 N s/m |
    #[must_use]
    pub fn of(confidence: Confidence) -> Self {
        let table =
            |masses: [f64; 2], strut: [f64; 2], tire: f64, friction: [f64; 2], tire_damping_sd: f64| Self {
                sprung_mass_relative_sd: masses[0],
                unsprung_mass_relative_sd: masses[1],
                spring_relative_sd: strut[0],
                damping_relative_sd: strut[1],
                stiffness_relative_sd: tire,
                friction_n: friction[0],
                friction_sd_n: friction[1],
                tire_damping_n_s_per_m: 50.0,
                tire_damping_sd_n_s_per_m: tire_damping_sd,
            };
        match confidence {
            Confidence::Measured => table([0.02, 0.015], [0.03, 0.05], 0.01, [20.0, 10.0], 20.0),
            Confidence::Typical => table([0.08, 0.05], [0.15, 0.15], 0.03, [30.0, 20.0], 30.0),
            Confidence::Rough => table([0.15, 0.10], [0.30, 0.30], 0.08, [40.0, 40.0], 50.0),
        }
    }

    /// The part of the unsprung mass's standard deviation that all wheels of the car share.
    #[must_use]
    pub fn common_mass_relative_sd(&self) -> f64 {
        COMMON_SHARE * self.unsprung_mass_relative_sd
    }

    /// The part by which the two axles' unsprung masses are wrong each for itself.
    #[must_use]
    pub fn axle_mass_relative_sd(&self) -> f64 {
        AXLE_SHARE * self.unsprung_mass_relative_sd
    }

    /// Relative standard deviation of stiffness over unsprung mass, which is what a wheel's hop shows of the tire.
    #[must_use]
    pub fn tire_relative_sd(&self) -> f64 {
        self.unsprung_mass_relative_sd.hypot(self.stiffness_relative_sd)
    }
}

impl Vehicle {
    /// How well the parameters of this corner are known: the file's own figures, for what it leaves out those of its
    /// [`Confidence`].
    #[must_use]
    pub fn uncertainty(&self, corner: Corner) -> ParameterUncertainty {
        let told = &self.details.corners[corner.index()];
        let usual = ParameterUncertainty::of(self.details.confidence);
        ParameterUncertainty {
            sprung_mass_relative_sd: told.sprung_mass_relative_sd.unwrap_or(usual.sprung_mass_relative_sd),
            unsprung_mass_relative_sd: told
                .unsprung_mass_relative_sd
                .unwrap_or(usual.unsprung_mass_relative_sd),
            spring_relative_sd: told.spring_relative_sd.unwrap_or(usual.spring_relative_sd),
            damping_relative_sd: told.damping_relative_sd.unwrap_or(usual.damping_relative_sd),
            stiffness_relative_sd: told.tire.stiffness_relative_sd.unwrap_or(usual.stiffness_relative_sd),
            friction_n: told.friction_n.unwrap_or(usual.friction_n),
            friction_sd_n: told.friction_sd_n.unwrap_or(usual.friction_sd_n),
            tire_damping_n_s_per_m: told.tire_damping_n_s_per_m.unwrap_or(usual.tire_damping_n_s_per_m),
            tire_damping_sd_n_s_per_m: told
                .tire_damping_sd_n_s_per_m
                .unwrap_or(usual.tire_damping_sd_n_s_per_m),
        }
    }
}
