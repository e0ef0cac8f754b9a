//! The vehicle file: a name, a wheelbase and up to four corners, each a complete [`CornerConfig`].
//!
//! Read by the binary and by the live monitor; knows TOML and the core's types, nothing of drives. Every value is checked
//! when it is read, so a [`Vehicle`] is usable as it stands.
//!
//! ```toml
//! [vehicle]
//! name = "mid-size sedan"
//! id = "WXY00000000000001"       # optional: tells cars of one model apart, for a learned reference
//! learned = "drive.csv at 240 kPa" # optional: the drives its values come from (itpms vehicle learn)
//! wheelbase_m = 2.7              # optional; needed for the shared road
//! [tire]                         # eq. (5); may be given per corner as [corner.fl.tire]
//! stiffness_per_kpa = 713.91     # N/m per kPa
//! stiffness_at_zero = 60880.0    # N/m
//! stiffness_per_kpa_sd = 7.0     # optional: standard deviations of the two and their correlation
//! stiffness_at_zero_sd = 900.0
//! stiffness_correlation = -0.9
//! [corner.fl]                    # same for fr, rl, rr; a test bed has one
//! sprung_mass_kg = 240.8
//! unsprung_mass_kg = 56.9
//! damping_n_s_per_m = 925.8
//! spring_n_per_m = 29114.0
//! placard_kpa = 241.3
//! accel_noise_m_s2 = 0.05        # optional: rms per sample, both sensors
//! initial_kpa = 241.3            # optional: where the estimate starts; the placard's unless given
//! ```
//!
//! All other keys are optional ([`VehicleDetails`], docs/vehicle.md): how far the values are to be trusted, friction and tire
//! damping, tracks, and what the wheel-speed methods need.
//!
//! Wheel speeds need no masses, springs, dampers and stiffnesses: a file with `wheelbase_m`, `track_front_m`, `track_rear_m` and
//! `driven` is complete without them, and its corners have a `placard_kpa` or are not there.
//!
//! | module | idea |
//! |---|---|
//! | `details`, `read_details` | the optional keys; from their tables, checked |
//! | `uncertainty` | how well parameters are known, by where they come from |
//! | [`typical`] | a whole file from what an owner knows: mass, tire size, class |
//! | `derived` | frequencies and damping ratios of a corner |
//! | `write` | the way back |

mod derived;
mod details;
mod read_details;
pub mod typical;
mod uncertainty;
mod write;

use std::path::Path;

use itpms_core::model::{
    CarConfig, Corner, CornerConfig, ParameterError, PressureMap, QuarterCar, standard_atmosphere_kpa,
};
use itpms_core::torsion::TorsionConfig;
use itpms_core::wheel_speed::WheelSpeedConfig;
use itpms_files::{AtomicFile, input};
use toml::de::DeTable;

use crate::error::{DataError, Problem};
use crate::toml_table::{Table, syntax_problem};

pub use crate::pressure_unit::pressure_in_other_unit;
pub use derived::CornerFigures;
pub use details::{CornerDetails, Driven, TireDetails, VehicleDetails};
pub use itpms_core::model::{Confidence, ParameterUncertainty};

#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    pub name: String,
    /// Which of the cars of that name it is, where that matters: a VIN, a fleet number.
    pub id: Option<String>,
    /// Which drives its values were learned from; `None`: from none.
    pub learned: Option<String>,
    /// Distance between the axles in m.
    pub wheelbase_m: Option<f64>,
    /// The corners, in the order of [`Corner::ALL`].
    pub corners: [Option<CornerConfig<f64>>; 4],
    pub details: VehicleDetails,
}

/// What no car exceeds in the unit of the key. A value outside was most likely given in another unit: tons, N/mm,
/// bar or psi, mm, mm/s². Wide enough for a kart and for a 40-ton truck.
const PLAUSIBLE: [(&str, f64, f64); 14] = [
    ("wheelbase_m", 0.5, 20.0),
    ("track_front_m", 0.3, 4.0),
    ("track_rear_m", 0.3, 4.0),
    ("rolling_radius_m", 0.1, 1.5),
    ("torsion_hz", 10.0, 150.0),
    ("stiffness_per_kpa", 20.0, 20_000.0),
    ("stiffness_at_zero", 1_000.0, 10_000_000.0),
    ("sprung_mass_kg", 10.0, 10_000.0),
    ("unsprung_mass_kg", 1.0, 2_000.0),
    ("damping_n_s_per_m", 10.0, 500_000.0),
    ("spring_n_per_m", 500.0, 10_000_000.0),
    ("placard_kpa", 60.0, 1_500.0),
    ("accel_noise_m_s2", 0.0, 20.0),
    ("initial_kpa", 20.0, 1_500.0),
];

/// Largest standard deviation in m of a wheelbase that was measured or learned.
const MEASURED_WHEELBASE_SD_M: f64 = 0.05;

const TIRE_KEYS: [&str; 13] = [
    "stiffness_per_kpa",
    "stiffness_at_zero",
    "stiffness_per_kpa_sd",
    "stiffness_at_zero_sd",
    "stiffness_correlation",
    "stiffness_relative_sd",
    "stiffness_over_mass_relative_sd",
    "rolling_radius_m",
    "radius_per_ln_pressure",
    "radius_per_ln_pressure_sd",
    "torsion_hz",
    "torsion_hz_per_kpa",
    "teeth",
];

const CORNER_KEYS: [&str; 16] = [
    "sprung_mass_kg",
    "unsprung_mass_kg",
    "damping_n_s_per_m",
    "spring_n_per_m",
    "placard_kpa",
    "accel_noise_m_s2",
    "initial_kpa",
    "tire",
    "sprung_mass_relative_sd",
    "unsprung_mass_relative_sd",
    "spring_relative_sd",
    "damping_relative_sd",
    "friction_n",
    "friction_sd_n",
    "tire_damping_n_s_per_m",
    "tire_damping_sd_n_s_per_m",
];

/// The `[tire]` table of a vehicle file for this map, with the uncertainty of its coefficients where it has one.
pub fn tire_table(map: &PressureMap<f64>) -> String {
    write::tire_table(map)
}

impl Vehicle {
    /// The paper's simulated vehicle: Table 2 at all four corners, eq. (5), wheelbase 2.7 m.
    pub fn paper() -> Self {
        Self {
            name: "paper, Table 2".to_owned(),
            id: None,
            learned: None,
            wheelbase_m: Some(2.7),
            corners: [Some(CornerConfig::paper()); 4],
            details: VehicleDetails { confidence: Confidence::Measured, ..VehicleDetails::default() },
        }
    }

    /// The corner's parameters, if the vehicle has that corner.
    pub fn corner(&self, corner: Corner) -> Option<&CornerConfig<f64>> {
        self.corners[corner.index()].as_ref()
    }

    /// Pressure of the air in kPa where the tires are filled.
    pub fn home_kpa(&self) -> f64 {
        standard_atmosphere_kpa(self.details.home_altitude_m.unwrap_or(0.0))
    }

    /// Configuration of an estimator of these corners; corners that the vehicle does not have are left out.
    pub fn car_config(&self, corners: &[Corner]) -> CarConfig<f64> {
        let chosen = |corner: Corner| self.corner(corner).copied().filter(|_| corners.contains(&corner));
        CarConfig { corners: Corner::ALL.map(chosen), wheelbase_m: self.wheelbase_m }
    }

    /// The same with other details, and with what they say of how well its parameters are known.
    pub fn with_details(mut self, details: VehicleDetails) -> Self {
        self.details = details;
        for (corner, stated) in self.corners.iter_mut().zip(&details.corners) {
            if let Some(corner) = corner {
                corner.uncertainty = uncertainty::uncertainty(stated, details.confidence);
            }
        }
        self
    }

    /// Pressure on the placard of this corner's tire in kPa, where the file has it.
    pub fn placard_kpa(&self, corner: Corner) -> Option<f64> {
        let alone = self.details.corners[corner.index()].placard_kpa;
        self.corner(corner).map(|config| config.placard_kpa).or(alone)
    }

    /// Rolling radius in m of the tires, where the file has one.
    pub fn rolling_radius_m(&self) -> Option<f64> {
        self.details.corners.iter().find_map(|corner| corner.tire.rolling_radius_m)
    }

    /// Configuration of the wheel-speed analysis. Errors: the key that the file lacks for that.
    pub fn wheel_speed_config(&self) -> Result<WheelSpeedConfig<f64>, &'static str> {
        let VehicleDetails { track_front_m, track_rear_m, driven, limited_slip, .. } = self.details;
        let mut config = WheelSpeedConfig::new(
            self.wheelbase_m.ok_or("wheelbase_m")?,
            track_front_m.ok_or("track_front_m")?,
            track_rear_m.ok_or("track_rear_m")?,
            driven.ok_or("driven")?.into(),
        );
        config.limited_slip = limited_slip;
        let tire = |of: fn(&TireDetails) -> Option<f64>| {
            let stated: Vec<f64> =
                self.details.corners.iter().filter_map(|corner| of(&corner.tire)).collect();
            (!stated.is_empty()).then(|| stated.iter().sum::<f64>() / stated.len() as f64)
        };
        if let Some(stated) = tire(|tire| tire.radius_per_ln_pressure) {
            config.radius_per_ln_pressure = stated;
        }
        if let Some(sd) = tire(|tire| tire.radius_per_ln_pressure_sd) {
            config.radius_per_ln_pressure_sd = sd / config.radius_per_ln_pressure.abs();
        }
        Ok(config)
    }

    /// What torsional analysis is given of each wheel, and the pressures that they should have in kPa: of a sensor and a tire nothing is known
    /// of, where the file has nothing. Teeth and resonance are checked by the analysis. Errors: the key that the file lacks for that.
    pub fn torsion_config(&self) -> Result<([TorsionConfig<f64>; 4], [f64; 4]), &'static str> {
        let (mut wheels, mut placard_kpa) = ([TorsionConfig::new(); 4], [0.0; 4]);
        for (corner, (wheel, kpa)) in Corner::ALL.into_iter().zip(wheels.iter_mut().zip(&mut placard_kpa)) {
            *kpa = self.placard_kpa(corner).ok_or("placard_kpa of all four corners")?;
            let tire = &self.details.corners[corner.index()].tire;
            let radius_m = tire.rolling_radius_m.or(self.rolling_radius_m());
            wheel.rolling_radius_m = radius_m.ok_or("[tire] rolling_radius_m")?;
            wheel.teeth = tire.teeth.unwrap_or(wheel.teeth);
            wheel.resonance_hz = tire.torsion_hz.unwrap_or(wheel.resonance_hz);
            wheel.resonance_per_kpa = tire.torsion_hz_per_kpa.unwrap_or(wheel.resonance_per_kpa);
        }
        Ok((wheels, placard_kpa))
    }

    /// Whether the wheelbase is that of other cars: its standard deviation says that it was not measured. `itpms vehicle learn` and a
    /// calibration find it then.
    pub fn assumes_wheelbase(&self) -> bool {
        self.wheelbase_m.is_some()
            && self.details.wheelbase_sd_m.is_some_and(|sd_m| sd_m > MEASURED_WHEELBASE_SD_M)
    }

    /// How well the parameters of this corner are known; those of the file's confidence for a corner that it does not have.
    pub fn uncertainty(&self, corner: Corner) -> ParameterUncertainty<f64> {
        let usual = || ParameterUncertainty::of(self.details.confidence);
        self.corner(corner).map_or_else(usual, |corner| corner.uncertainty)
    }

    /// Standard deviation in kPa that the file leaves in the level of a pressure before a calibration, the largest of these corners.
    pub fn level_sd_kpa(&self, corners: &[Corner]) -> f64 {
        let of = |config: &CornerConfig<f64>| {
            let stiffness = config.tire.stiffness_n_per_m(config.placard_kpa);
            config.uncertainty.tire_relative_sd() * stiffness / config.tire.stiffness_per_kpa()
        };
        corners.iter().filter_map(|corner| self.corner(*corner)).map(of).fold(0.0, f64::max)
    }

    /// Reads a vehicle file.
    /// Errors: the file cannot be read, is not TOML, has an unknown or lacks a needed key, or a value is out of its range.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let read = || Self::parse(&input::read_text(path, "a vehicle file (TOML)")?);
        read().map_err(|problem| DataError::new(path, problem))
    }

    /// The vehicle described by the text of a vehicle file.
    pub fn parse(text: &str) -> Result<Self, Problem> {
        let document = DeTable::parse(text).map_err(|error| syntax_problem(text, &error))?;
        let root = Table::root(text, document.get_ref());
        root.check_keys(&["vehicle", "tire", "corner"])?;

        let (mut name, mut id, mut learned, mut wheelbase_m) =
            ("unnamed vehicle".to_owned(), None, None, None);
        let mut details = VehicleDetails::default();
        if let Some(vehicle) = root.table("vehicle")? {
            vehicle.check_keys(&read_details::VEHICLE_KEYS)?;
            name = vehicle.text("name")?.unwrap_or(name);
            id = vehicle.text("id")?;
            learned = vehicle.text("learned")?;
            wheelbase_m = checked(&vehicle, "wheelbase_m")?;
            details = read_details::vehicle(&vehicle)?;
        }
        let rolls = wheelbase_m.is_some() && details.has_wheels();
        let tire = root.table("tire")?.map(|table| read_tire(&table, rolls)).transpose()?;

        // Wheels are there whether or not a table speaks of them.
        if let Some((_, tire)) = tire.filter(|_| rolls) {
            details.corners = [CornerDetails { tire, ..CornerDetails::default() }; 4];
        }
        let corner_tables = root.table("corner")?;
        let mut corners = [None; 4];
        for corner in Corner::ALL {
            let tables = corner_tables.as_ref();
            tables.map_or(Ok(()), |tables| tables.check_keys(&Corner::ALL.map(Corner::label)))?;
            let Some(table) = tables.map_or(Ok(None), |tables| tables.table(corner.label()))? else {
                continue;
            };
            let wheel = rolls.then(|| read_wheel(&table, tire)).transpose()?.flatten();
            let (config, beyond) = match wheel {
                Some(wheel) => (None, wheel),
                None => read_corner(&table, tire).map(|(config, beyond)| (Some(config), beyond))?,
            };
            corners[corner.index()] = config;
            details.corners[corner.index()] = beyond;
        }
        if corners.iter().all(Option::is_none) && !rolls {
            return Err("no corner is described, expected at least one table [corner.fl] (or fr, rl, rr); for wheel speeds alone wheelbase_m, \
                 track_front_m, track_rear_m and driven in [vehicle]"
                .into());
        }
        Ok(Self { name, id, learned, wheelbase_m, corners, details }.with_details(details))
    }

    /// The text of a vehicle file that reads back as this vehicle.
    pub fn to_toml(&self) -> String {
        write::vehicle(self)
    }

    /// The same with these lines of comment at its head, and beside each value what `comment` says of it by its table and key.
    pub fn to_commented_toml(
        &self,
        head: &[String],
        comment: &dyn Fn(&str, &str) -> Option<String>,
    ) -> String {
        write::commented(&write::vehicle(self), head, comment)
    }

    /// Writes a vehicle file, completely or not at all.
    pub fn write(&self, path: &Path) -> Result<(), DataError> {
        Ok(AtomicFile::save(path, self.to_toml().as_bytes())?)
    }
}

/// Natural frequencies in Hz that a body on its springs may have: twice and half of those of cars and trucks.
const BODY_HZ: [f64; 2] = [0.5, 5.0];

/// A positive number inside its plausible range, if the key is there.
fn checked(table: &Table<'_>, key: &'static str) -> Result<Option<f64>, Problem> {
    let Some(value) = table.number(key)? else { return Ok(None) };
    if !(value > 0.0 && value.is_finite()) {
        let error = ParameterError { name: key, value, expected: "a positive, finite number" };
        return Err(table.refuse(error));
    }
    plausible(table, key, value).map(Some)
}

/// The value, if it is in the plausible range of its key.
fn plausible(table: &Table<'_>, key: &'static str, value: f64) -> Result<f64, Problem> {
    for (name, low, high) in PLAUSIBLE {
        if name == key && !(low..=high).contains(&value) {
            return Err(implausible(table, key, value, low, high));
        }
    }
    Ok(value)
}

fn implausible(table: &Table<'_>, key: &'static str, value: f64, low: f64, high: f64) -> Problem {
    let (line, table) = (table.line_of_key(key), table.path());
    let unit = if key.ends_with("_kpa") { pressure_in_other_unit(value) } else { String::new() };
    Problem::Refused(format!(
        "line {line}: {table} {key} is {value}, expected {low} to {high} (another unit?{unit})"
    ))
}

fn required(table: &Table<'_>, key: &'static str) -> Result<f64, Problem> {
    checked(table, key)?.ok_or_else(|| table.lacks(key))
}

/// A tire, and its stiffness where the table speaks of one.
type Tire = (Option<PressureMap<f64>>, TireDetails);

fn read_tire(table: &Table<'_>, rolls: bool) -> Result<Tire, Problem> {
    table.check_keys(&TIRE_KEYS)?;
    let has_stiffness = TIRE_KEYS[..5].iter().any(|key| table.has(key));
    let map = (has_stiffness || !rolls).then(|| read_stiffness(table)).transpose()?;
    Ok((map, read_details::tire(table)?))
}

fn read_stiffness(table: &Table<'_>) -> Result<PressureMap<f64>, Problem> {
    let per_kpa = required(table, "stiffness_per_kpa")?;
    let at_zero = table.number("stiffness_at_zero")?.ok_or_else(|| table.lacks("stiffness_at_zero"))?;
    if at_zero > 0.0 {
        plausible(table, "stiffness_at_zero", at_zero)?;
    }
    let or_zero = |key| Ok::<f64, Problem>(table.number(key)?.unwrap_or(0.0));
    let per_kpa_sd = or_zero("stiffness_per_kpa_sd")?;
    let at_zero_sd = or_zero("stiffness_at_zero_sd")?;
    let correlation = or_zero("stiffness_correlation")?;
    PressureMap::new(per_kpa, at_zero)
        .and_then(|map| map.with_uncertainty(per_kpa_sd, at_zero_sd, correlation))
        .map_err(|error| table.refuse(error))
}

/// A corner of which no more is given than its tire and its placard; `None` for a corner with masses, or half of them.
fn read_wheel(table: &Table<'_>, common_tire: Option<Tire>) -> Result<Option<CornerDetails>, Problem> {
    table.check_keys(&CORNER_KEYS)?;
    if CORNER_KEYS.iter().any(|key| table.has(key) && !["placard_kpa", "tire"].contains(key)) {
        return Ok(None);
    }
    let own = table.table("tire")?.map(|own| read_tire(&own, true)).transpose()?;
    let tire = own.or(common_tire).map_or_else(TireDetails::default, |(_, tire)| tire);
    let placard_kpa = checked(table, "placard_kpa")?;
    Ok(Some(CornerDetails { placard_kpa, tire, ..CornerDetails::default() }))
}

fn read_corner(
    table: &Table<'_>,
    common_tire: Option<Tire>,
) -> Result<(CornerConfig<f64>, CornerDetails), Problem> {
    table.check_keys(&CORNER_KEYS)?;
    let own = table.table("tire")?.map(|own| read_tire(&own, false)).transpose()?;
    let lacks = || table.lacks("tire; expected a table [tire] for all corners or one under this corner");
    let (tire, tire_details) = own.or(common_tire).ok_or_else(lacks)?;
    let tire = tire.ok_or_else(|| table.lacks("tire.stiffness_per_kpa"))?;
    let (sprung_kg, unsprung_kg) = (required(table, "sprung_mass_kg")?, required(table, "unsprung_mass_kg")?);
    // A wheel is not heavier than what it carries: most likely the two are exchanged.
    if unsprung_kg > sprung_kg {
        return Err(implausible(table, "unsprung_mass_kg", unsprung_kg, 1.0, sprung_kg));
    }
    let (damping, spring) = (required(table, "damping_n_s_per_m")?, required(table, "spring_n_per_m")?);
    // A body rests on its springs at 1 to 2 Hz; far from that, damper and spring are most likely exchanged.
    let [softest, stiffest] = BODY_HZ.map(|hz| (std::f64::consts::TAU * hz).powi(2) * sprung_kg);
    if !(softest..=stiffest).contains(&spring) {
        return Err(implausible(table, "spring_n_per_m", spring, softest.round(), stiffest.round()));
    }
    let quarter_car = QuarterCar::new(sprung_kg, unsprung_kg, damping, spring);
    let placard_kpa = required(table, "placard_kpa")?;
    let (noise, initial) = (checked(table, "accel_noise_m_s2")?, checked(table, "initial_kpa")?);
    let config = quarter_car
        .and_then(|quarter_car| CornerConfig::new(quarter_car, tire, placard_kpa))
        .and_then(|config| noise.map_or(Ok(config), |noise| config.with_accel_noise(noise)))
        .and_then(|config| initial.map_or(Ok(config), |initial| config.with_initial_pressure(initial)))
        .map_err(|error| table.refuse(error))?;
    Ok((config, read_details::corner(table, tire_details)?))
}
