//! A vehicle file from what an owner knows: the mass on the papers, how it rests on the axles, the tire's size, the kind
//! of car. Every value with its standard deviation and its source (docs/vehicle.md).
//!
//! Called by `itpms vehicle init`. The values are those of other cars: good enough to begin with, to be replaced one by
//! one by what is measured.
//!
//! | module | idea |
//! |---|---|
//! | `class` | what cars of a class have in common |
//! | `front_rear` | one value for both axles, or one for each |
//! | `tire_size` | a tire's size and the stiffness it has by it |
//! | `text` | the file, with comments |
//! | `wheels` | the file for wheel speeds alone |

mod class;
mod entry;
mod front_rear;
mod text;
mod tire_size;
mod wheels;

use super::{Driven, Vehicle};
use crate::error::Problem;
use crate::pressure_unit::pressure_in_other_unit;

pub use class::CarClass;
pub use front_rear::FrontRear;
pub use tire_size::{TireSize, TireSizeError};
pub use wheels::WheelsOfACar;

/// Relative standard deviations of a class's typical values: how much the published cars of docs/vehicle.md scatter about it.
const SPRUNG_MASS_SD: f64 = 0.08;
const UNSPRUNG_MASS_SD: f64 = 0.15;
const SPRING_SD: f64 = 0.25;
const DAMPING_SD: f64 = 0.30;
const STIFFNESS_SD: f64 = 0.08;
/// Of a wheelbase that was not measured, in m: that of cars of a class.
const WHEELBASE_SD_M: f64 = 0.15;
/// Friction and tire damping with their standard deviations, N and N s/m.
const FRICTION_N: [f64; 2] = [40.0, 30.0];
const TIRE_DAMPING_N_S_PER_M: [f64; 2] = [50.0, 30.0];
/// Of an axle's unsprung masses, how much more the front has than the rear: brakes, steering, mostly the drive shafts.
const FRONT_HEAVIER: f64 = 0.04;

#[derive(Debug, Clone, PartialEq)]
pub struct TypicalCar {
    /// Its name; made up of the rest unless given.
    pub name: Option<String>,
    /// Mass ready to drive, in kg.
    pub mass_kg: f64,
    /// Share of the mass that rests on the front axle, 0.3 to 0.75.
    pub front_share: f64,
    pub tire: FrontRear<TireSize>,
    pub class: CarClass,
    /// Pressures on the placard in kPa gauge.
    pub placard_kpa: FrontRear<f64>,
    /// Distance between the axles in m; the class's unless given.
    pub wheelbase_m: Option<f64>,
    /// Further input for wheel speeds; they are not used unless given.
    pub wheels: Option<AxleWheels>,
}

/// Input for wheel speeds about the axles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxleWheels {
    /// Distances in m between the front and between the rear wheels; typical unless given.
    pub track_m: [Option<f64>; 2],
    pub driven: Driven,
    /// Whether a driven axle's wheels are coupled.
    pub limited_slip: bool,
}

/// Masses, spring and damper of both corners of an axle.
#[derive(Debug, Clone, Copy)]
struct Axle {
    sprung_kg: f64,
    unsprung_kg: f64,
    spring_n_per_m: f64,
    damping_n_s_per_m: f64,
}

impl TypicalCar {
    /// The text of its vehicle file, with a comment on every value, and the vehicle it reads as.
    /// Errors: a mass, share or pressure that no car has, in the words of the vehicle file's own check.
    pub fn vehicle_file(&self) -> Result<(String, Vehicle), TypicalCarError> {
        let ranges = [
            ("mass", "kg", self.mass_kg, 300.0, 20_000.0),
            ("front share", "", self.front_share, 0.3, 0.75),
            ("placard pressure", "kPa", self.placard_kpa.front, 100.0, 900.0),
            ("placard pressure", "kPa", self.placard_kpa.rear, 100.0, 900.0),
        ];
        for (what, unit, value, low, high) in ranges {
            if !(low..=high).contains(&value) {
                return Err(TypicalCarError::Range { what, unit, value, low, high });
            }
        }
        let text = text::vehicle_file(self);
        let vehicle =
            Vehicle::parse(&text).map_err(|problem| TypicalCarError::Implausible(Box::new(problem)))?;
        Ok((text, vehicle))
    }

    /// Front and rear axle by the class's figures.
    fn axles(&self) -> [Axle; 2] {
        let figures = self.class.figures();
        let each = 0.25 * figures.unsprung_share * self.mass_kg;
        let axle = |i: usize, share: f64, heavier: f64| {
            let unsprung_kg = each * (1.0 + heavier);
            let sprung_kg = 0.5 * share * self.mass_kg - unsprung_kg;
            let w = std::f64::consts::TAU * figures.body_hz[i];
            Axle {
                sprung_kg,
                unsprung_kg,
                spring_n_per_m: rounded(w * w * sprung_kg, 100.0),
                damping_n_s_per_m: rounded(2.0 * figures.damping_ratio[i] * w * sprung_kg, 10.0),
            }
        };
        [axle(0, self.front_share, FRONT_HEAVIER), axle(1, 1.0 - self.front_share, -FRONT_HEAVIER)]
    }
}

/// To the nearest multiple: more digits would look like a measurement.
fn rounded(value: f64, multiple: f64) -> f64 {
    (value / multiple).round() * multiple
}

/// The pressure in another unit, after the expected range.
fn guess(value: f64) -> String {
    let unit = pressure_in_other_unit(value);
    if unit.is_empty() { unit } else { format!(" (another unit?{unit})") }
}

/// A car that no file can be made of.
#[derive(Debug, thiserror::Error)]
pub enum TypicalCarError {
    #[error(
        "the {what} is {value}{}{unit}, expected {low} to {high}{}{unit}{}",
        blank(.unit), blank(.unit), if *.unit == "kPa" { guess(*.value) } else { String::new() }
    )]
    Range { what: &'static str, unit: &'static str, value: f64, low: f64, high: f64 },
    #[error("these values make no car: {0}")]
    Implausible(Box<Problem>),
}

fn blank(unit: &str) -> &'static str {
    if unit.is_empty() { "" } else { " " }
}
