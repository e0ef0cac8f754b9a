//! A vehicle file from drives at known pressures: each log twice through `itpms_analysis`'s learner, and what comes out beside what the file
//! states (docs/math/learn.md).

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use itpms_analysis::learn::{
    DriveReading, FoundWheelbase, LearnError, Learned, LearnedCorner, Listener, PASSES, Parameter,
};
use itpms_core::model::Corner;
use itpms_data::log::LogOptions;
use itpms_data::vehicle::{VehicleDetails, pressure_in_other_unit};
use itpms_data::{LogReader, Vehicle};
use serde_json::{Map, Value, json};

use crate::concerns::common_corners;
use crate::error::DriveError;
use crate::run::ROWS_PER_LOOK;
use crate::time_axis::TimeAxis;
use crate::tire_sensors::sent_pressures;
use crate::wheelbase;

/// Significant digits of a learned value: its standard deviation has no more to say.
const DIGITS: usize = 5;
/// Seconds of reading below which a drive teaches little.
const SHORT_S: f64 = 300.0;
/// Share of the time that the best read tire is read for, below which another one is not read at all.
const UNREAD_SHARE: f64 = 0.1;
/// Share of a pass that reading a log takes.
const READING: f64 = 0.1;

/// Pressures in kPa gauge that a car's tire may have; what lies outside was meant in another unit.
pub const KNOWN_KPA: std::ops::RangeInclusive<f64> = 60.0..=1500.0;

/// Why a pressure in kPa is no tire's, in words.
pub fn no_pressure(kpa: f64) -> Option<String> {
    let usable = KNOWN_KPA.contains(&kpa);
    let (from, to) = KNOWN_KPA.into_inner();
    (!usable).then(|| {
        let guess = pressure_in_other_unit(kpa);
        format!("{kpa} kPa is no tire's pressure, expected {from:.0} to {to:.0} (another unit?{guess})")
    })
}

/// A drive, and the pressures in kPa gauge that its tires had on it, in the order of [`Corner::ALL`]; of corners that the log does not have
/// they do not count.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownDrive {
    pub log: PathBuf,
    pub options: LogOptions,
    /// The pressures; for a wheel with NaN the median reading of the tire's own sensor in the log.
    pub pressures_kpa: [f64; 4],
}

impl KnownDrive {
    pub(crate) fn open(&self) -> Result<LogReader, DriveError> {
        Ok(LogReader::open_with(&self.log, &self.options)?)
    }
}

#[derive(Debug, Clone)]
pub struct LearnedVehicle {
    pub vehicle: Vehicle,
    pub learned: Learned,
    /// The wheelbase, if the drives show it; the vehicle's only where the file says that it was assumed.
    pub wheelbase: Option<FoundWheelbase>,
    pub readings: Vec<DriveReading>,
    pub concerns: Vec<String>,
}

/// Learns what `file` says from these drives. `watch` receives the share that is done. Errors: a log that cannot be read, has none of the
/// vehicle's corners or teaches nothing; a pressure that no tire has; [`DriveError::Stopped`].
pub fn learn(
    file: &Vehicle,
    drives: &[KnownDrive],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<LearnedVehicle, DriveError> {
    learn_with(file, drives, &mut |number| drives[number].open(), watch)
}

/// The same where `open` gives the log of a drive by its number among the `drives`, anew for every pass over it.
pub fn learn_with(
    file: &Vehicle,
    drives: &[KnownDrive],
    open: &mut dyn FnMut(usize) -> Result<LogReader, DriveError>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<LearnedVehicle, DriveError> {
    let (drives, mut concerns) = by_sensors(file, drives, open, watch)?;
    let drives = &drives[..];
    // Reading costs less than estimating: it counts as a tenth of a pass.
    let total = (PASSES * drives.len().max(1)) as f64 + READING * drives.len() as f64;
    let mut done = READING * drives.len() as f64;
    let found = wheelbase::find(&file.car_config(&Corner::ALL), drives.len(), open, &mut |share| {
        watch(share * done / total)
    })?;
    concerns.extend(wheelbase::doubt(file, found));
    let written = file;
    let file = &wheelbase::with_found(file, found);
    let nominal = file.car_config(&Corner::ALL);
    let mut now = file.clone();
    let mut result = None;
    for pass in 0..PASSES {
        let mut readings = vec![];
        for (number, drive) in drives.iter().enumerate() {
            let mut share = |share: f64| watch((done + share) / total);
            let mut log = open(number)?;
            // A wheelbase that the drives contradict is among the concerns.
            let wheelbase_m = found.map(|found| found.wheelbase_m).or(now.wheelbase_m);
            readings.push(listen(&now, wheelbase_m, &mut log, drive, &mut share)?);
            if pass == 0 {
                let path = drive.log.display();
                concerns.extend(log.repairs().warnings().into_iter().map(|text| format!("{path}: {text}")));
            }
            done += 1.0;
        }
        let learned =
            itpms_analysis::learn::learn(&nominal, &readings).map_err(|error| named(error, drives))?;
        now = vehicle(file, drives, &learned);
        result = Some((learned, readings));
    }
    let (learned, readings) = result.ok_or(LearnError::NoDrive)?;
    concerns.extend(doubts(written, drives, &readings));
    Ok(LearnedVehicle { vehicle: now, learned, wheelbase: found, readings, concerns })
}

/// A drive that teaches nothing is called by its log.
fn named(error: LearnError, drives: &[KnownDrive]) -> DriveError {
    let drive = match error {
        LearnError::TooLittle(number) => number.checked_sub(1).and_then(|number| drives.get(number)),
        _ => None,
    };
    match drive {
        Some(drive) => DriveError::Log(format!(
            "{}: no tire was read for a minute after the first 30 s, expected some minutes of driving at more than walking pace with body and wheels that go together (itpms vehicle check shows whether they do)",
            drive.log.display()
        )),
        None => error.into(),
    }
}

/// The drives with the pressures that the tires' own sensors have where none are given, and remarks on them.
pub(crate) fn by_sensors(
    file: &Vehicle,
    drives: &[KnownDrive],
    open: &mut dyn FnMut(usize) -> Result<LogReader, DriveError>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(Vec<KnownDrive>, Vec<String>), DriveError> {
    let (mut known, mut remarks) = (drives.to_vec(), vec![]);
    for (number, drive) in known.iter_mut().enumerate() {
        let mut log = open(number)?;
        if !log.columns().motion.tire_sensors.contains(&true) {
            continue;
        }
        let given_kpa = drive.pressures_kpa;
        let sent = sent_pressures(&mut log, file, given_kpa, f64::INFINITY, &mut |_| watch(0.0))?;
        for (kpa, sent) in drive.pressures_kpa.iter_mut().zip(sent.kpa) {
            *kpa = if kpa.is_nan() { sent.unwrap_or(f64::NAN) } else { *kpa };
        }
        remarks.extend(sent.remarks);
    }
    Ok((known, remarks))
}

fn listen(
    vehicle: &Vehicle,
    wheelbase_m: Option<f64>,
    log: &mut LogReader,
    drive: &KnownDrive,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<DriveReading, DriveError> {
    let corners = common_corners(log, vehicle)?;
    if corners.is_empty() {
        let path = drive.log.display();
        return Err(DriveError::Log(format!(
            "{path}: has wheel speeds alone, expected accelerations to learn from"
        )));
    }
    for corner in &corners {
        let (path, label, kpa) = (drive.log.display(), corner.label(), drive.pressures_kpa[corner.index()]);
        if kpa.is_nan() {
            let why = format!(
                "{path}: no pressure is given of {label}, and no tire sensor in the log sends a plausible one ({label}_tpms_kpa); expected --pressure-kpa for every wheel"
            );
            return Err(DriveError::Mismatch(why));
        }
        if let Some(why) = no_pressure(kpa) {
            return Err(DriveError::Mismatch(format!("{path}: {label}: {why}")));
        }
    }
    let config = vehicle.car_config(&corners);
    let mut listener = Listener::new(&config, drive.pressures_kpa, log.survey().estimator_rate_hz())?;
    let mut axis = TimeAxis::new(wheelbase_m);
    let mut count = 0u64;
    while let Some(row) = log.next_row()? {
        if count.is_multiple_of(ROWS_PER_LOOK) && watch(log.progress()).is_break() {
            return Err(DriveError::Stopped);
        }
        count += 1;
        axis.take(&row);
        listener.take(&row.sample());
    }
    let path = drive.log.display();
    if let Some(why) = axis.contradiction() {
        return Err(DriveError::Log(format!("{path}: {why}")));
    }
    let malfunction = corners.iter().map(|corner| listener.malfunction(*corner)).collect::<Vec<_>>();
    let reading = listener.finish();
    let seconds = |corner: &&Corner| reading.wheels[corner.index()].map_or(0.0, |wheel| wheel.seconds);
    let most_s = corners.iter().map(|corner| seconds(&corner)).fold(0.0, f64::max);
    if let Some((corner, malfunction)) =
        corners.iter().zip(&malfunction).find(|(corner, _)| seconds(corner) < UNREAD_SHARE * most_s)
    {
        let why = match malfunction {
            Some(malfunction) => format!("{malfunction}: look at this sensor's scale and mount"),
            None => "its sensors do not fit together".to_owned(),
        };
        return Err(DriveError::Log(format!(
            "{path}: the tire {} was read for {:.0} s and others for {most_s:.0}: {why} (itpms vehicle check shows them); nothing is learned of the car",
            corner.label(),
            seconds(&corner)
        )));
    }
    Ok(reading)
}

fn doubts(file: &Vehicle, drives: &[KnownDrive], readings: &[DriveReading]) -> Vec<String> {
    let mut doubts = vec![];
    for (drive, reading) in drives.iter().zip(readings) {
        let path = drive.log.display();
        let name = name(&drive.log);
        if file.learned.as_ref().is_some_and(|learned| learned.contains(&name)) {
            doubts.push(format!(
                "{path}: the file was learned from {name} already; a drive that counts twice makes it look better known than it is. Start from the file it began with, and give all drives at once"
            ));
        }
        for corner in Corner::ALL.into_iter().filter(|corner| file.corner(*corner).is_some()) {
            let seconds = reading.wheels[corner.index()].map_or(0.0, |wheel| wheel.seconds);
            if seconds < SHORT_S {
                doubts.push(format!(
                    "{path}: the tire {} was read for {seconds:.0} s, expected {SHORT_S:.0} s or more: ten minutes at an even pace teach most",
                    corner.label()
                ));
            }
        }
    }
    doubts
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn described(drives: &[KnownDrive]) -> String {
    let each = drives.iter().map(|drive| {
        let [first, rest @ ..] = drive.pressures_kpa;
        let kpa = match rest.iter().all(|kpa| *kpa == first) {
            true => format!("{first}"),
            false => drive.pressures_kpa.map(|kpa| kpa.to_string()).join(", "),
        };
        format!("{} at {kpa} kPa", name(&drive.log))
    });
    each.collect::<Vec<_>>().join("; ")
}

/// The vehicle with the learned values in place of the file's, to a few digits.
fn vehicle(file: &Vehicle, drives: &[KnownDrive], learned: &Learned) -> Vehicle {
    let mut details: VehicleDetails = file.details;
    let mut corners = file.corners;
    for (i, corner) in learned.car.corners.iter().enumerate() {
        let Some(corner) = corner else { continue };
        let mut corner = *corner;
        let car = &corner.quarter_car;
        let digits = [car.unsprung_mass_kg(), car.damping_n_s_per_m(), car.spring_n_per_m()].map(rounded);
        let tire = &corner.tire;
        let line = [tire.stiffness_per_kpa(), tire.stiffness_at_zero(), tire.stiffness_per_kpa_sd()];
        let [per_kpa, at_zero, per_kpa_sd] = line.map(rounded);
        // Five digits of a positive number are positive: neither is refused.
        if let Ok(car) =
            itpms_core::model::QuarterCar::new(car.sprung_mass_kg(), digits[0], digits[1], digits[2])
        {
            corner.quarter_car = car;
        }
        if let Ok(tire) = itpms_core::model::PressureMap::new(per_kpa, at_zero)
            .and_then(|map| map.with_uncertainty(per_kpa_sd, per_kpa_sd * corner.placard_kpa, -1.0))
        {
            corner.tire = tire;
        }
        let (known, stated) = (&corner.uncertainty, &mut details.corners[i]);
        let sd = |value: f64| Some((value * 1e4).round() / 1e4);
        stated.sprung_mass_relative_sd = sd(known.sprung_mass_relative_sd);
        stated.unsprung_mass_relative_sd = sd(known.unsprung_mass_relative_sd);
        stated.spring_relative_sd = sd(known.spring_relative_sd);
        stated.damping_relative_sd = sd(known.damping_relative_sd);
        stated.friction_n = Some((known.friction_n * 10.0).round() / 10.0);
        stated.friction_sd_n = Some((known.friction_sd_n * 10.0).round() / 10.0);
        stated.tire.stiffness_relative_sd = sd(known.stiffness_relative_sd);
        stated.tire.stiffness_over_mass_relative_sd = known.stiffness_over_mass_relative_sd.and_then(sd);
        corners[i] = Some(corner);
    }
    let learned = Some(described(drives));
    Vehicle { learned, corners, ..file.clone() }.with_details(details)
}

fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// Parameters of a corner by the key of their value and of their standard deviation.
fn parameters(corner: &LearnedCorner) -> [(&'static str, &'static str, Parameter); 4] {
    [
        ("unsprung_mass_kg", "unsprung_mass_relative_sd", corner.unsprung_mass_kg),
        ("damping_n_s_per_m", "damping_relative_sd", corner.damping_n_s_per_m),
        ("spring_n_per_m", "spring_relative_sd", corner.spring_n_per_m),
        ("friction_n", "friction_sd_n", corner.friction_n),
    ]
}

impl LearnedVehicle {
    /// Parameters that no drive has identified, and that none can, a sentence each.
    pub fn unknown(&self) -> Vec<String> {
        let mut unknown = vec![
            "all unsprung masses, tires, springs, dampers and friction times one factor move alike: that factor rests on the file's sprung masses, unsprung masses and tires".to_owned(),
            "sprung masses are the file's; an estimate finds the load anew on every drive".to_owned(),
        ];
        let slope = &self.learned.slope;
        if !slope.is_learned() {
            unknown.push(format!(
                "how much stiffer the tires are per kPa is known to {:.0} %: a drive at a pressure a quarter lower, with the same tires, tells it better",
                100.0 * slope.after_sd / slope.after
            ));
        }
        for corner in Corner::ALL {
            let Some(learned) = &self.learned.corners[corner.index()] else { continue };
            let tire = ("the tire's stiffness by itself", learned.tire_n_per_m);
            let all =
                parameters(learned).map(|(key, _, parameter)| (key, parameter)).into_iter().chain([tire]);
            let left: Vec<&str> =
                all.filter(|(_, parameter)| !parameter.is_learned()).map(|(key, _)| key).collect();
            if !left.is_empty() {
                unknown.push(format!(
                    "{}: hardly better known than before: {}",
                    corner.label(),
                    left.join(", ")
                ));
            }
        }
        unknown
    }

    /// Whether the vehicle's wheelbase is the one that the drives show.
    pub fn wheelbase_is_learned(&self) -> bool {
        self.wheelbase.is_some_and(|found| {
            self.vehicle.wheelbase_m.is_some_and(|m| (m - found.wheelbase_m).abs() < 1e-3)
                && self.vehicle.details.wheelbase_sd_m.is_some()
        })
    }

    /// Parameters before and after by corner, what stays unknown and what should be known: what `itpms vehicle learn --json` prints.
    pub fn document(&self) -> Value {
        let parameter = |p: Parameter| {
            json!({
                "before": p.before, "before_sd": p.before_sd,
                "after": p.after, "after_sd": p.after_sd,
                "learned": p.is_learned(),
            })
        };
        let corners: Map<String, Value> = Corner::ALL
            .into_iter()
            .filter_map(|corner| {
                let of = self.learned.corners[corner.index()].as_ref()?;
                let value = json!({
                    "unsprung_mass_kg": parameter(of.unsprung_mass_kg),
                    "tire_n_per_m": parameter(of.tire_n_per_m),
                    "stiffness_over_mass_per_s2": parameter(of.stiffness_over_mass),
                    "damping_n_s_per_m": parameter(of.damping_n_s_per_m),
                    "spring_n_per_m": parameter(of.spring_n_per_m),
                    "friction_n": parameter(of.friction_n),
                    "uncalibrated_pressure_sd_kpa": self.vehicle.level_sd_kpa(&[corner]),
                });
                Some((corner.label().to_owned(), value))
            })
            .collect();
        json!({
            "corners": corners,
            "slope_over_file": parameter(self.learned.slope),
            "wheelbase_m": self.wheelbase.map(|found| found.wheelbase_m),
            "wheelbase_sd_m": self.wheelbase.map(|found| found.sd_m),
            "unknown": self.unknown(),
            "concerns": self.concerns,
        })
    }

    /// The vehicle file, with a comment on where each value comes from.
    pub fn to_toml(&self, from: &str) -> String {
        let mut head = vec![
            format!(
                "Learned by itpms vehicle learn, beginning with {from}: values without a comment are as there; standard deviations of learned values are new."
            ),
            "Unknown as before:".to_owned(),
        ];
        head.extend(self.unknown().into_iter().map(|text| format!("- {text}")));
        self.vehicle.to_commented_toml(&head, &|table, key| self.comment(table, key))
    }

    fn comment(&self, table: &str, key: &str) -> Option<String> {
        let of = |label: &str| {
            let corner = Corner::ALL.into_iter().find(|corner| corner.label() == label)?;
            self.learned.corners[corner.index()].as_ref()
        };
        if table == "vehicle" && key == "learned" {
            return Some("which drives".to_owned());
        }
        if table == "vehicle" && key == "wheelbase_m" && self.wheelbase_is_learned() {
            return Some("learned: front and rear meet the same road so much later".to_owned());
        }
        if table == "tire" || table.ends_with(".tire") {
            let label =
                table.strip_prefix("corner.").and_then(|rest| rest.strip_suffix(".tire")).unwrap_or("fl");
            let (tire, slope) = (&of(label)?.tire_n_per_m, &self.learned.slope);
            return Some(match key {
                "stiffness_per_kpa" => format!(
                    "N/m per kPa: {}, slope {:.3} of the file's",
                    changed(tire, "N/m at placard pressure"),
                    slope.after
                ),
                "stiffness_at_zero" => {
                    "N/m: the line goes through the stiffness at placard pressure".to_owned()
                }
                "stiffness_per_kpa_sd" => {
                    "of the slope; with the next two the line is exact at placard pressure".to_owned()
                }
                "stiffness_relative_sd" => "of the tire by itself".to_owned(),
                "stiffness_over_mass_relative_sd" => {
                    "of stiffness over unsprung mass: the level of a pressure rests on it".to_owned()
                }
                _ => return None,
            });
        }
        let corner = of(table.strip_prefix("corner.")?)?;

        parameters(corner).into_iter().find_map(|(name, sd_name, parameter)| {
            if key == name {
                Some(changed(&parameter, ""))
            } else {
                (key == sd_name && !parameter.is_learned())
                    .then(|| "hardly better than the file's".to_owned())
            }
        })
    }
}

/// A parameter in the file, and as learned.
fn changed(parameter: &Parameter, unit: &str) -> String {
    let digits = |value: f64| if value < 1_000.0 { format!("{value:.1}") } else { format!("{value:.0}") };
    let word = if parameter.is_learned() { "learned" } else { "file and drives" };
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    format!("{word}: {} ± {}{unit} before", digits(parameter.before), digits(parameter.before_sd))
}
