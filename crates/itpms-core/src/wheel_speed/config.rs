//! Configuration of radius analysis: the car's dimensions, its driven axle, how a radius follows the pressure, what loads may do.

use super::state::SCALE;
use crate::memory::Blank;
use crate::model::{ParameterError, positive};
use crate::real::Real;
use crate::wheel_speed::Tuning;

/// Which wheels the engine turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DrivenAxle {
    /// The front wheels.
    #[blank]
    Front,
    /// The rear wheels.
    Rear,
    /// All four.
    Both,
}

impl DrivenAxle {
    /// Whether it turns the front wheels, and the rear ones.
    pub(super) fn axles(self) -> [bool; 2] {
        [self != DrivenAxle::Rear, self != DrivenAxle::Front]
    }
}

/// By how much the loads of the tires may change while the car stands, as standard deviations; zero where loads are known not to change.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LoadUncertainty<T> {
    /// Of the load of both rear tires, as a share of it.
    pub rear_axle: T,
    /// Of the load of one rear tire against the other, as a share of it.
    pub rear_left_right: T,
    /// Front passengers who get in or out.
    pub front_passengers: T,
}

impl<T: Real> LoadUncertainty<T> {
    /// A passenger car nothing is known of: a fifth of the rear axle's load, 3 % between its wheels, one front passenger.
    #[must_use]
    pub fn unknown() -> Self {
        Self { rear_axle: T::lit(0.2), rear_left_right: T::lit(0.03), front_passengers: T::one() }
    }

    /// The load stays as it was at the calibration.
    #[must_use]
    pub fn constant() -> Self {
        Self { rear_axle: T::zero(), rear_left_right: T::zero(), front_passengers: T::zero() }
    }

    fn check(&self) -> Result<(), ParameterError> {
        let shares = [
            ("load_rear_axle_sd", self.rear_axle),
            ("load_rear_left_right_sd", self.rear_left_right),
            ("load_front_passengers_sd", self.front_passengers),
        ];
        for (name, value) in shares {
            if !(value >= T::zero() && value <= T::lit(10.0)) {
                let (value, expected) = (value.to_f64(), "a number from 0 to 10");
                return Err(ParameterError { name, value, expected });
            }
        }
        Ok(())
    }
}

/// Configuration of [`MonitoredWheels`](crate::monitor::MonitoredWheels).
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelSpeedConfig<T> {
    /// Distance between the axles in m.
    pub wheelbase_m: T,
    /// Distance between the front wheels in m.
    pub track_front_m: T,
    /// Distance between the rear wheels in m.
    pub track_rear_m: T,
    /// Which wheels the engine turns.
    pub driven: DrivenAxle,
    /// Whether a driven axle's wheels are coupled, so that they turn alike under torque and hide a low tire.
    pub limited_slip: bool,
    /// `d ln R / d ln p` of the rolling radius.
    pub radius_per_ln_pressure: T,
    /// Standard deviation of the former, as a share of it.
    pub radius_per_ln_pressure_sd: T,
    /// Changes of the load while the car stands.
    pub load: LoadUncertainty<T>,
    /// Numbers that are usually left as they are; `None`: [`Tuning::DEFAULT`]. It is in no saved state: a monitor that is read from one has
    /// the default.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub tuning: Option<&'static Tuning>,
}

impl<T: Real> WheelSpeedConfig<T> {
    /// A car of these dimensions in m with an open differential, on unknown tires: 0.007 ± 60 % of its radius per ln p
    /// (`docs/math/wheel-speed.md`, eq. 2).
    #[must_use]
    pub fn new(wheelbase_m: T, track_front_m: T, track_rear_m: T, driven: DrivenAxle) -> Self {
        Self {
            wheelbase_m,
            track_front_m,
            track_rear_m,
            driven,
            limited_slip: false,
            radius_per_ln_pressure: T::lit(0.007),
            radius_per_ln_pressure_sd: T::lit(0.6),
            load: LoadUncertainty::unknown(),
            tuning: None,
        }
    }

    /// Thousandths of a radius per `ln` of its pressure.
    pub(super) fn per_ln_1e3(&self) -> T {
        T::lit(SCALE) * self.radius_per_ln_pressure
    }

    pub(super) fn tuning(&self) -> &'static Tuning {
        self.tuning.unwrap_or(&Tuning::DEFAULT)
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let lengths = [
            ("wheelbase_m", self.wheelbase_m),
            ("track_front_m", self.track_front_m),
            ("track_rear_m", self.track_rear_m),
        ];
        for (name, value) in lengths {
            if !(value >= T::lit(0.5) && value <= T::lit(20.0)) {
                let (value, expected) = (value.to_f64(), "a length from 0.5 to 20 m");
                return Err(ParameterError { name, value, expected });
            }
        }
        let beta = self.radius_per_ln_pressure;
        if !(beta >= T::lit(5e-4) && beta <= T::lit(0.1)) {
            let expected = "a number from 0.0005 to 0.1";
            return Err(ParameterError { name: "radius_per_ln_pressure", value: beta.to_f64(), expected });
        }
        positive("radius_per_ln_pressure_sd", self.radius_per_ln_pressure_sd)?;
        self.tuning().check()?;
        self.load.check()
    }
}
