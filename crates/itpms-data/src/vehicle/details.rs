//! Further parameters of a vehicle file, beyond those of the estimators: how far its values are to be trusted, friction,
//! tracks, and what the wheel-speed methods need. Read by `read_details`, written by `write`; knows no TOML.

use itpms_core::model::Confidence;
use itpms_core::wheel_speed::DrivenAxle;

impl From<Driven> for DrivenAxle {
    fn from(driven: Driven) -> Self {
        match driven {
            Driven::Front => Self::Front,
            Driven::Rear => Self::Rear,
            Driven::All => Self::Both,
        }
    }
}

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Driven {
        Front = "front",
        Rear = "rear",
        All = "all",
    }
}

/// The optional keys of a vehicle file, as far as they are there.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VehicleDetails {
    /// How far to trust what has no standard deviation of its own.
    pub confidence: Confidence,
    /// Standard deviation of the wheelbase in m; see [`Vehicle::assumes_wheelbase`](super::Vehicle::assumes_wheelbase).
    pub wheelbase_sd_m: Option<f64>,
    pub track_front_m: Option<f64>,
    /// Distance between the rear wheels' contact centers in m.
    pub track_rear_m: Option<f64>,
    pub driven: Option<Driven>,
    /// Whether a driven axle's wheels are coupled: a limited-slip or locked differential.
    pub limited_slip: bool,
    /// Height in m above the sea at which the tires are filled; `None`: at sea level.
    pub home_altitude_m: Option<f64>,
    /// By how much springs stiffen as they are compressed, in 1/m: their slope goes as `exp(p x)`; `None`: not at all.
    pub spring_stiffening_per_m: Option<f64>,
    /// Permitted axle loads in kg, front and rear, wheels included.
    pub gross_axle_kg: Option<[f64; 2]>,
    /// Whether springs follow the load.
    pub level_control: bool,
    /// Whether a controller tells the dampers what to do.
    pub adaptive_dampers: bool,
    /// By corner, in the order of [`Corner::ALL`](itpms_core::model::Corner::ALL); empty for a corner that the vehicle does not have.
    pub corners: [CornerDetails; 4],
}

impl VehicleDetails {
    /// Whether tracks and driven axle are there: with a wheelbase all that wheel speeds need.
    pub(super) fn has_wheels(&self) -> bool {
        self.track_front_m.is_some() && self.track_rear_m.is_some() && self.driven.is_some()
    }
}

/// The optional keys of a corner and of its tire. All standard deviations are relative ones (0.05 is 5 %) unless their name has a unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CornerDetails {
    pub sprung_mass_relative_sd: Option<f64>,
    pub unsprung_mass_relative_sd: Option<f64>,
    pub spring_relative_sd: Option<f64>,
    pub damping_relative_sd: Option<f64>,
    pub friction_n: Option<f64>,
    pub friction_sd_n: Option<f64>,
    pub tire_damping_n_s_per_m: Option<f64>,
    pub tire_damping_sd_n_s_per_m: Option<f64>,
    /// Placard pressure in kPa of a corner of which nothing else is known: wheel speeds need no more.
    pub placard_kpa: Option<f64>,
    pub tire: TireDetails,
}

/// The optional keys of a tire: the scale of its stiffness, and what the wheel-speed methods need.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TireDetails {
    /// Relative standard deviation of the whole line of stiffness over pressure, up or down as one.
    pub stiffness_relative_sd: Option<f64>,
    /// Relative standard deviation of the tire's stiffness over the unsprung mass, where that is known better than the two.
    pub stiffness_over_mass_relative_sd: Option<f64>,
    pub rolling_radius_m: Option<f64>,
    /// Relative change of the rolling radius per unit of ln(pressure): `d ln R / d ln p`.
    pub radius_per_ln_pressure: Option<f64>,
    pub radius_per_ln_pressure_sd: Option<f64>,
    /// Torsional resonance of belt against rim in Hz at placard pressure.
    pub torsion_hz: Option<f64>,
    pub torsion_hz_per_kpa: Option<f64>,
    /// Teeth of the wheel-speed sensor's ring.
    pub teeth: Option<u32>,
}
