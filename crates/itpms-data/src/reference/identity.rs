//! Which car a reference belongs to: the vehicle's name, its id where there is one, and a fingerprint of the parameters
//! from which the learned deviations count.

use std::fmt::Write as _;

use itpms_core::model::Corner;
use itpms_files::crc64;

use super::problem::ReferenceProblem;
use crate::vehicle::{Vehicle, VehicleDetails};

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VehicleIdentity {
    pub name: String,
    pub id: Option<String>,
    /// Fingerprint of masses, dampers, springs, tires, placard pressures and wheelbase, as 16 hexadecimal digits. Sensor
    /// noise and the pressure an estimate starts from may change without a new calibration.
    pub parameters: String,
}

impl VehicleIdentity {
    pub fn of(vehicle: &Vehicle) -> Self {
        let parameters = fingerprint(vehicle);
        Self { name: vehicle.name.clone(), id: vehicle.id.clone(), parameters }
    }

    /// Refuses the first thing that tells this car from `wanted`. Errors: [`ReferenceProblem::OtherVehicle`].
    pub fn expect(&self, wanted: &Self) -> Result<(), ReferenceProblem> {
        let quoted =
            |text: &Option<String>| text.as_ref().map_or("not given".to_owned(), |id| format!("{id:?}"));
        let parameters = |car: &Self| format!("those of fingerprint {}", car.parameters);
        let (what, found, expected) = if self.name != wanted.name {
            ("name", format!("{:?}", self.name), format!("{:?}", wanted.name))
        } else if self.id != wanted.id {
            ("id", quoted(&self.id), quoted(&wanted.id))
        } else if self.parameters != wanted.parameters {
            ("set of parameters", parameters(self), parameters(wanted))
        } else {
            return Ok(());
        };
        Err(ReferenceProblem::OtherVehicle { what, found, expected })
    }
}

fn fingerprint(vehicle: &Vehicle) -> String {
    let mut text = format!("wheelbase {:?}", vehicle.wheelbase_m);
    for corner in Corner::ALL {
        let Some(config) = vehicle.corner(corner) else { continue };
        let (car, tire) = (&config.quarter_car, &config.tire);
        let values = [
            car.sprung_mass_kg(),
            car.unsprung_mass_kg(),
            car.damping_n_s_per_m(),
            car.spring_n_per_m(),
            tire.stiffness_per_kpa(),
            tire.stiffness_at_zero(),
            config.placard_kpa,
        ];
        // The shortest decimals that read back as the same numbers: what a person would have typed.
        let _ = write!(text, " {} {values:?}", corner.label());
    }
    if vehicle.corners.iter().all(Option::is_none) {
        // What wheel speeds are compared by, where they are all there is.
        let VehicleDetails { track_front_m, track_rear_m, driven, .. } = &vehicle.details;
        let _ = write!(text, " wheels {track_front_m:?} {track_rear_m:?} {driven:?}");
    }
    format!("{:016x}", crc64(&[text.as_bytes()]))
}
