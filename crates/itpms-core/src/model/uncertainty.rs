//! How well a corner's parameters are known, by where they come from (docs/vehicle.md, section 3). Asked for by whoever weighs
//! them; knows no file.

use crate::memory::Blank;
use crate::real::Real;

/// One-sided 95 % quantile of a normal distribution: a quantity counts as past a limit when this many sds still are.
pub(crate) const ONE_SIDED_95: f64 = 1.64;
/// Sds beyond which a difference is surely none of chance: of a normal distribution one in 370 is. And beyond which even a healthy tire of
/// an unknown car, or the scatter of pieces of driving, does not lie: one in 16 000.
pub(crate) const SURELY_SD: f64 = 3.0;
pub(crate) const OUTLIER_SD: f64 = 4.0;

crate::labelled! {
    /// Where the parameters of a vehicle come from, and so how far to trust them.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub enum Confidence {
        /// Weighed and measured on this car.
        Measured = "measured",
        /// A manufacturer's figures, or a car of the same model that was measured.
        #[default]
        Typical = "typical",
        /// A guess.
        Rough = "rough",
    }
}

/// Of the variance of an unsprung mass, the share that all four wheels of a car have in common and the share in which
/// front and rear differ: what is guessed wrongly of one wheel is guessed wrongly of all (sizes, alloys, brakes of the
/// model), then of an axle (its kind, its drive). 0.8² + 0.6² = 1: left and right are alike.
const COMMON_MASS: f64 = 0.8;
const AXLE_MASS: f64 = 0.6;
/// The share of a tire's standard deviation by which each is wrong for itself (wear, age), and the most that this can be: what is known of
/// the size or the make alone is wrong alike for all four tires of a car.
const OWN_TIRE: f64 = 0.8;
const MOST_OWN_TIRE: f64 = 0.024;

/// Standard deviations of one corner's parameters, relative (0.05 is 5 %) unless the name has a unit, with two
/// parameters that the quarter car does not have.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParameterUncertainty<T> {
    /// Of the sprung mass: which load the value is for. Estimators identify the load on the way.
    pub sprung_mass_relative_sd: T,
    /// Of the unsprung mass.
    pub unsprung_mass_relative_sd: T,
    /// Of the suspension spring.
    pub spring_relative_sd: T,
    /// Of the damping.
    pub damping_relative_sd: T,
    /// Of the tire's line of stiffness over pressure, as one scale.
    pub stiffness_relative_sd: T,
    /// Of the tire's stiffness over the unsprung mass, where that is known better than the two: a drive at known pressures tells it.
    pub stiffness_over_mass_relative_sd: Option<T>,
    /// Coulomb friction of the strut in N.
    pub friction_n: T,
    /// Its standard deviation in N.
    pub friction_sd_n: T,
    /// Vertical damping of the tire in N s/m.
    pub tire_damping_n_s_per_m: T,
    /// Its standard deviation in N s/m.
    pub tire_damping_sd_n_s_per_m: T,
}

impl<T: Real> ParameterUncertainty<T> {
    /// Usual uncertainty of parameters of this origin.
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
                sprung_mass_relative_sd: T::lit(masses[0]),
                unsprung_mass_relative_sd: T::lit(masses[1]),
                spring_relative_sd: T::lit(strut[0]),
                damping_relative_sd: T::lit(strut[1]),
                stiffness_relative_sd: T::lit(tire),
                stiffness_over_mass_relative_sd: None,
                friction_n: T::lit(friction[0]),
                friction_sd_n: T::lit(friction[1]),
                tire_damping_n_s_per_m: T::lit(50.0),
                tire_damping_sd_n_s_per_m: T::lit(tire_damping_sd),
            };
        match confidence {
            Confidence::Measured => table([0.02, 0.015], [0.03, 0.05], 0.01, [20.0, 10.0], 20.0),
            Confidence::Typical => table([0.08, 0.05], [0.15, 0.15], 0.03, [30.0, 20.0], 30.0),
            Confidence::Rough => table([0.15, 0.10], [0.30, 0.30], 0.08, [40.0, 40.0], 50.0),
        }
    }

    /// The part of the unsprung mass's standard deviation that all wheels of the car share.
    #[must_use]
    pub fn common_mass_relative_sd(&self) -> T {
        T::lit(COMMON_MASS) * self.unsprung_mass_relative_sd
    }

    /// The part by which the two axles' unsprung masses are wrong each for itself.
    #[must_use]
    pub fn axle_mass_relative_sd(&self) -> T {
        T::lit(AXLE_MASS) * self.unsprung_mass_relative_sd
    }

    /// The part of the tire stiffness's standard deviation that all tires of the car share.
    #[must_use]
    pub fn common_tire_relative_sd(&self) -> T {
        let (all, own) = (self.stiffness_relative_sd, self.own_tire_relative_sd());
        (all * all - own * own).sqrt()
    }

    /// The part by which each tire's stiffness is wrong for itself: 2.4 % at most.
    #[must_use]
    pub fn own_tire_relative_sd(&self) -> T {
        (T::lit(OWN_TIRE) * self.stiffness_relative_sd).min(T::lit(MOST_OWN_TIRE))
    }

    /// Relative standard deviation of stiffness over unsprung mass, which is what a wheel's hop shows of the tire.
    #[must_use]
    pub fn tire_relative_sd(&self) -> T {
        self.stiffness_over_mass_relative_sd.unwrap_or_else(|| self.independent_tire_relative_sd())
    }

    /// What [`tire_relative_sd`](Self::tire_relative_sd) is over what it would be if mass and tire were known each by itself.
    pub(crate) fn tire_relative_sd_factor(&self) -> T {
        let independent = self.independent_tire_relative_sd();
        match self.stiffness_over_mass_relative_sd {
            Some(known) if independent > T::zero() => known / independent,
            _ => T::one(),
        }
    }

    fn independent_tire_relative_sd(&self) -> T {
        let (mass, tire) = (self.unsprung_mass_relative_sd, self.stiffness_relative_sd);
        (mass * mass + tire * tire).sqrt()
    }
}
