//! The vehicle file for wheel speeds alone: what an owner measures or reads off the car, no masses. Called by `itpms vehicle init`.

use std::fmt::Write as _;

use itpms_core::model::Corner;

use super::entry::line;
use super::{AxleWheels, FrontRear, TireSize, TypicalCarError};
use crate::toml_table::escaped;
use crate::vehicle::Vehicle;

/// Distance in m between the wheels of an axle, where it is not given: cars have 1.45 to 1.65 m.
const TRACK_M: f64 = 1.55;

/// Input for a car with wheel speeds.
#[derive(Debug, Clone, PartialEq)]
pub struct WheelsOfACar {
    /// Its name; made up of the rest unless given.
    pub name: Option<String>,
    pub tire: FrontRear<TireSize>,
    pub wheelbase_m: f64,
    pub axles: AxleWheels,
    /// Pressures on the placard in kPa gauge, by axle.
    pub placard_kpa: FrontRear<f64>,
}

impl WheelsOfACar {
    /// The text of its vehicle file, with a comment on every value, and the vehicle it reads as.
    /// Errors: a length or a pressure that no car has, in the words of the vehicle file's own check.
    pub fn vehicle_file(&self) -> Result<(String, Vehicle), TypicalCarError> {
        let text = self.text();
        let vehicle =
            Vehicle::parse(&text).map_err(|problem| TypicalCarError::Implausible(Box::new(problem)))?;
        Ok((text, vehicle))
    }

    fn text(&self) -> String {
        let mut out = String::from(
            "# For wheel speeds alone, by itpms vehicle init (docs/vehicle.md). Masses, springs and dampers are for accelerations.\n\n[vehicle]\n",
        );
        let made_up = format!("{} with {}", self.axles.driven.label(), self.tire);
        let name = escaped(self.name.as_deref().unwrap_or(&made_up));
        let _ = writeln!(out, "name = \"{name}\"");
        line(&mut out, "wheelbase_m", self.wheelbase_m, 3, "as given");
        axle_keys(&mut out, &self.axles);
        let sizes = self.tire.axles();
        tire(&mut out, "tire", &sizes[0]);
        for (corner, axle) in Corner::ALL.into_iter().zip([0, 0, 1, 1]) {
            let _ = writeln!(out, "\n[corner.{}]", corner.label());
            line(
                &mut out,
                "placard_kpa",
                self.placard_kpa.axles()[axle],
                1,
                "from the placard in the door frame: cold, gauge",
            );
            if sizes[axle] != sizes[0] {
                tire(&mut out, &format!("corner.{}.tire", corner.label()), &sizes[axle]);
            }
        }
        out
    }
}

fn tire(out: &mut String, table: &str, size: &TireSize) {
    let _ = writeln!(out, "\n[{table}]");
    line(out, "rolling_radius_m", size.rolling_radius_m(), 3, "3.05 diameters to a turn (ETRTO)");
    radius_keys(out);
}

pub(super) fn axle_keys(out: &mut String, axles: &AxleWheels) {
    for (key, track_m) in ["track_front_m", "track_rear_m"].into_iter().zip(axles.track_m) {
        let from = if track_m.is_some() { "as given" } else { "typical of cars; measure it to 1 cm" };
        line(out, key, track_m.unwrap_or(TRACK_M), 3, from);
    }
    let _ = writeln!(out, "driven = \"{}\"\nlimited_slip = {}", axles.driven.label(), axles.limited_slip);
}

/// How a radius and a torsional resonance follow the pressure.
pub(super) fn radius_keys(out: &mut String) {
    line(out, "radius_per_ln_pressure", 0.007, 4, "of no tire in particular (docs/math/wheel-speed.md)");
    line(out, "radius_per_ln_pressure_sd", 0.0042, 4, "");
    line(out, "torsion_hz", 49.5, 1, "for tooth pulses: of no tire in particular, a calibration finds it");
    line(out, "torsion_hz_per_kpa", 0.052, 3, "the same; no calibration finds it");
    let _ = writeln!(out, "{:<40} # of the wheel speed sensor's ring; count them", "teeth = 48");
}
