//! Whether a log is good enough to judge the methods by: each thing that it must have, in a sentence with the way out where it has not.

use itpms_core::conditioning::SAMPLE_RATES_HZ;
use itpms_core::model::Corner;
use itpms_data::log::AirColumns;
use itpms_data::{LogReader, Vehicle};

use super::pressures::KnownStretch;
use super::watch::{LogWatch, Reading, Stop};
use crate::plausibility::Plausibility;

/// Minutes that have to be driven in all: a log of twenty minutes with two stops of two and a half.
const DRIVEN_MIN: f64 = 15.0;
/// And at each of the known pressures: `itpms vehicle learn` asks for five to know what a drive shows, and less is hardly worth a stop.
const STRETCH_MIN: f64 = 4.0;
/// How many different sets of known pressures are wanted: a straight line of stiffness over pressure needs two, and one more to see that it is
/// one.
const SETS: usize = 3;
/// Difference in kPa by which two sets differ in one tire: five times what a gauge for tires is wrong by.
const DIFFERENT_KPA: f64 = 15.0;
/// Seconds by which an owner's clock may be off from the log's where a pressure was changed.
const CLOCK_S: f64 = 30.0;
/// Rate in Hz below which wheel hop is sampled, but not well.
const WELL_SAMPLED_HZ: f64 = 200.0;
/// Mean speed in km/h below which a drive excites little.
const BRISK_KM_H: f64 = 30.0;
/// Share of values that may be missing.
const MISSING: f64 = 0.02;
/// Reading of an accelerometer at rest in m/s²: gravity, or nothing where it is coupled for alternating signals. The bounds are a tilt of 30
/// degrees, and an offset of 0.15 g.
const UPRIGHT_M_S2: std::ops::RangeInclusive<f64> = 8.5..=11.3;
const NO_GRAVITY_M_S2: f64 = 1.5;
/// Times by which a sensor's rms while driving is above its quietest at rest, at least: less, and it shows mostly its own noise.
const ALIVE: f64 = 3.0;
/// Difference in kPa between a gauge and a tire's own sensor that should be looked at: sensors are right to some 10 kPa, and tires warm up.
const SENSOR_KPA: f64 = 35.0;

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Findings {
    pub(super) facts: Vec<String>,
    /// Why it is not good enough.
    pub(super) faults: Vec<String>,
    pub(super) notes: Vec<String>,
}

/// Judges a log that was read to its end; `stretches` are its known pressures, or why there are none.
pub(super) fn judge(
    vehicle: &Vehicle,
    log: &LogReader,
    watch: &LogWatch,
    plausibility: &Plausibility,
    stretches: Result<&[KnownStretch], &String>,
) -> Findings {
    let mut found = Findings::default();
    sensors(vehicle, log, &mut found);
    rate(log, &mut found);
    course(log, watch, &mut found);
    accelerometers(log, watch, &mut found);
    match stretches {
        Ok(stretches) => pressures(watch, stretches, &mut found),
        Err(why) => found.faults.push(why.clone()),
    }
    quality(log, plausibility, &mut found);
    found
}

fn labels(corners: &[Corner]) -> String {
    corners.iter().map(|corner| corner.label()).collect::<Vec<_>>().join(" ")
}

fn sensors(vehicle: &Vehicle, log: &LogReader, found: &mut Findings) {
    let (columns, motion) = (log.columns(), log.columns().motion);
    let present = columns.present();
    let mut has = Vec::new();
    if !present.is_empty() {
        has.push(format!("accelerations of body and wheel at {}", labels(&present)));
    }
    let air = motion.air != AirColumns::default();
    let sent = motion.tire_sensors.contains(&true);
    for (there, name) in [
        (columns.speed, "speed"),
        (motion.wheel_speeds(), "four wheel speeds"),
        (motion.yaw_rate, "yaw rate"),
        (motion.brake, "brake"),
        (sent, "tire sensors"),
        (air, "air"),
    ] {
        if there {
            has.push(name.to_owned());
        }
    }
    found.facts.push(format!("sensors: {}", has.join(", ")));
    if !present.is_empty() {
        let missing: Vec<Corner> = Corner::ALL.into_iter().filter(|c| !present.contains(c)).collect();
        if !missing.is_empty() {
            found.notes.push(format!(
                "no accelerations of {}: with two sensors at each of the four corners a log shows front against rear and left against right",
                labels(&missing)
            ));
        }
        let unknown: Vec<Corner> = present.iter().copied().filter(|c| vehicle.corner(*c).is_none()).collect();
        if !unknown.is_empty() {
            found.faults.push(format!(
                "the vehicle file describes no corner {}: itpms vehicle init --mass --front-share --tire writes one with all four",
                labels(&unknown)
            ));
        }
        if !columns.speed && !motion.wheel_speeds() {
            found.faults.push("no speed_m_s: neither stops nor front over rear show; log the speed of the car's bus, OBD or a GPS receiver as well, and name its column in a map (itpms signals LOG --write-map map.toml)".to_owned());
        }
    }
    if motion.wheel_speeds() {
        if let Err(key) = vehicle.wheel_speed_config() {
            let text = format!(
                "the vehicle file has no {key}, which wheel speeds need: itpms vehicle init --tire --wheelbase-m --driven writes it"
            );
            if present.is_empty() { found.faults.push(text) } else { found.notes.push(text) }
        }
        if !motion.yaw_rate {
            found.notes.push("no yaw_rate_rad_s: bends are harder to distinguish from lost air; it is on most buses beside the wheel speeds".to_owned());
        }
    }
}

fn rate(log: &LogReader, found: &mut Findings) {
    let rate_hz = log.survey().sample_rate_hz;
    found.facts.push(format!("rate: {rate_hz:.0} rows a second"));
    if log.columns().present().is_empty() {
        return;
    }
    if rate_hz < *SAMPLE_RATES_HZ.start() {
        found.faults.push(format!(
            "sampled at {rate_hz:.1} Hz, expected {:.0} Hz or more: wheel hop at 10 to 15 Hz and what lies above it do not show; set the logger to 200 Hz or more",
            SAMPLE_RATES_HZ.start()
        ));
    } else if rate_hz < WELL_SAMPLED_HZ {
        found.notes.push(format!("sampled at {rate_hz:.0} Hz: 200 Hz or more is better"));
    }
}

fn minutes(seconds: f64) -> f64 {
    seconds / 60.0
}

fn course(log: &LogReader, watch: &LogWatch, found: &mut Findings) {
    let driven_min = minutes(watch.driven_s.iter().sum());
    let [mean, fastest] = watch.speeds_m_s().map(|speed| 3.6 * speed);
    let stops = &watch.stops;
    let at_speed = if driven_min > 0.0 {
        format!(" at {mean:.0} km/h in the mean and {fastest:.0} at most")
    } else {
        String::new()
    };
    found.facts.push(format!(
        "length: {:.1} min, {driven_min:.1} of them driven{at_speed}; {} stop{} of 10 s or more",
        minutes(watch.length_s()),
        stops.len(),
        if stops.len() == 1 { "" } else { "s" }
    ));
    if !watch.speed_known {
        return;
    }
    if driven_min < DRIVEN_MIN {
        found.faults.push(format!(
            "{driven_min:.1} min are driven above 18 km/h, expected {DRIVEN_MIN:.0} or more: drive for twenty minutes, five and more at each pressure"
        ));
    } else if mean < BRISK_KM_H {
        found.notes.push(format!("driven at {mean:.0} km/h in the mean: 50 to 100 km/h shows more"));
    }
    if stops.is_empty() {
        let what = if log.columns().present().is_empty() {
            "the wheel speeds' zero"
        } else {
            "what the accelerometers read at rest"
        };
        found.faults.push(format!(
            "the car never stands for 10 s, so that {what} is not known: begin with half a minute of standing still, nobody getting in or out"
        ));
    }
}

/// How a sensor is mounted, by its readings.
fn mounting(name: &str, reading: &Reading, found: &mut Findings) {
    let Reading { rest_mean, rest_rms, driving_rms } = *reading;
    if UPRIGHT_M_S2.contains(&-rest_mean) {
        found.faults.push(format!(
            "{name} reads {rest_mean:.1} m/s² at rest: it is upside down; turn it, or give it factor = -1 in a map"
        ));
    } else if !(UPRIGHT_M_S2.contains(&rest_mean) || rest_mean.abs() < NO_GRAVITY_M_S2) {
        found.faults.push(format!(
            "{name} reads {rest_mean:.1} m/s² at rest, expected 9.8 (or 0 where gravity is taken out): its axis is not vertical, or its scale is wrong; mount it upright to some 20 degrees"
        ));
    }
    if !(driving_rms > ALIVE * rest_rms) {
        found.faults.push(format!(
            "{name} has {driving_rms:.2} m/s² rms while driving and {rest_rms:.2} at rest: hardly more than its own noise; is it the right column, and is the sensor fixed to metal?"
        ));
    }
}

fn accelerometers(log: &LogReader, watch: &LogWatch, found: &mut Findings) {
    let (mut with_gravity, mut without) = (0, 0);
    for corner in log.columns().present() {
        for (part, reading) in ["body", "wheel"].into_iter().zip(watch.reading(corner)) {
            let Some(reading) = reading else { continue };
            mounting(&format!("{}_{part}_accel_m_s2", corner.label()), &reading, found);
            let gravity = reading.rest_mean.abs() >= NO_GRAVITY_M_S2;
            with_gravity += usize::from(gravity);
            without += usize::from(!gravity);
        }
    }
    if with_gravity > 0 && without > 0 {
        found.notes.push(format!(
            "{with_gravity} accelerometers read gravity at rest and {without} do not: two kinds of sensors?"
        ));
    }
}

/// When the car stood, in words.
fn when(stops: &[Stop]) -> String {
    if stops.is_empty() {
        return "it never stands".to_owned();
    }
    let words: Vec<String> =
        stops.iter().map(|stop| format!("{:.0} to {:.0} s", stop.from_s, stop.to_s)).collect();
    format!("it stands at {}", words.join(", "))
}

fn pressures(watch: &LogWatch, stretches: &[KnownStretch], found: &mut Findings) {
    let mut words = Vec::new();
    let mut different: Vec<&KnownStretch> = Vec::new();
    for (i, (stretch, driven_s)) in stretches.iter().zip(&watch.driven_s).enumerate() {
        let before = i.checked_sub(1).map(|before| &stretches[before]);
        words.push(format!(
            "{} kPa from {:.0} s, {:.1} min driven",
            stretch.changes(before),
            stretch.from_s,
            minutes(*driven_s)
        ));
        let from_s = stretch.from_s;
        if from_s > watch.length_s() {
            found.faults.push(format!("pressures from {from_s:.0} s on are given, and the log ends at {:.0} s: times are seconds since its first row", watch.length_s()));
            continue;
        }
        let stands = |stop: &Stop| stop.from_s - CLOCK_S <= from_s && from_s <= stop.to_s + CLOCK_S;
        if before.is_some() && watch.speed_known && !watch.stops.iter().any(stands) {
            found.faults.push(format!(
                "at {from_s:.0} s, from when on {} kPa {} given, the car drives at {:.0} km/h: tires are let down while it stands ({})",
                stretch.changes(before),
                if stretch.changes(before).contains(',') { "are" } else { "is" },
                3.6 * watch.speed_at(i),
                when(&watch.stops)
            ));
        }
        if watch.speed_known && minutes(*driven_s) < STRETCH_MIN {
            found.faults.push(format!(
                "{:.1} min are driven at the pressures from {from_s:.0} s on, expected {STRETCH_MIN:.0} or more",
                minutes(*driven_s)
            ));
        }
        if different.iter().all(|other| stretch.difference_kpa(other) >= DIFFERENT_KPA) {
            different.push(stretch);
        }
        for corner in Corner::ALL {
            let gauge = stretch.kpa[corner.index()];
            if let Some(sent) = watch.sent_kpa(i, corner).filter(|sent| (sent - gauge).abs() > SENSOR_KPA) {
                found.notes.push(format!(
                    "{}: the gauge read {gauge:.0} kPa from {from_s:.0} s on, and the tire's own sensor sends {sent:.0}: another tire, or absolute pressure?",
                    corner.label()
                ));
            }
        }
    }
    found.facts.push(format!("known pressures: {}", words.join("; ")));
    if different.len() < SETS {
        found.faults.push(format!(
            "{} known set{} of pressures that differ by {DIFFERENT_KPA:.0} kPa in a tire, expected {SETS}: at two stops let one tire down, by a sixth each time, and read it again",
            different.len(),
            if different.len() == 1 { "" } else { "s" }
        ));
    }
}

fn quality(log: &LogReader, plausibility: &Plausibility, found: &mut Findings) {
    let report = log.repairs();
    let cells = report.rows_kept as f64 * 2.0 * log.columns().present().len() as f64;
    let missing = report.missing_accelerations as f64 / cells;
    if missing > MISSING {
        found.faults.push(format!(
            "{:.1} % of the accelerations are missing, expected {:.0} % at most: cables, or a logger that is too slow",
            100.0 * missing,
            100.0 * MISSING
        ));
    }
    for column in &report.dead_columns {
        found.faults.push(format!("{column} has no value at all: is its sensor connected?"));
    }
    for (one, other) in &report.same_columns {
        found.faults.push(format!(
            "{one} and {other} have the same values: one sensor's, there twice; give each its own in the map"
        ));
    }
    found.faults.extend(plausibility.contradiction());
    found.faults.extend(plausibility.concerns());
    let is_reported = |text: &String| {
        report.dead_columns.iter().any(|name| text.contains(name)) || text.contains("have the same values")
    };
    found.notes.extend(report.warnings().into_iter().filter(|text| !is_reported(text)));
}
