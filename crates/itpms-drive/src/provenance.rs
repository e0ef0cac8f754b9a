//! Where a drive's numbers come from, for the end of its report: the log, the options that were given, the sources of the vehicle's
//! parameters. Called at the end of a drive.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use itpms_analysis::report::{Parameter, Provenance};
use itpms_core::model::Corner;
use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::reference::day;
use itpms_data::tuning::Tuning;
use itpms_data::{LogReader, Vehicle};
use itpms_road::RoadRepetition;

use crate::job::Job;
use crate::settings::Settings;

pub(crate) fn provenance(job: &Job<'_>, log: &LogReader, sensors_kpa: &[f64; 4]) -> Provenance {
    Provenance {
        program: job.settings.program.clone(),
        made: today(),
        source: log.path().file_name().unwrap_or_default().to_string_lossy().into_owned(),
        vehicle: job.vehicle.name.clone(),
        estimator: estimator_label(job).to_owned(),
        sources: sources(job.vehicle, job.corners),
        command: job.settings.command.clone(),
        options: options(job.settings, job.reading)
            .into_iter()
            .chain(tire_sensors(job, sensors_kpa))
            .collect(),
        repairs: log.repairs().counts().into_iter().map(|(what, count)| (what.to_owned(), count)).collect(),
    }
}

/// The day, or that of `SOURCE_DATE_EPOCH`: with it the same command gives the same page, byte by byte, on any day.
pub(crate) fn today() -> String {
    let stated = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|text| text.parse().ok());
    let now = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    day(stated.unwrap_or_else(now))
}

/// The tires' own sensors, where there is no estimated pressure to show them beside.
fn tire_sensors(job: &Job<'_>, sensors_kpa: &[f64; 4]) -> Option<(String, String)> {
    let sent =
        Corner::ALL.iter().zip(sensors_kpa).filter(|(_, kpa)| job.corners.is_empty() && kpa.is_finite());
    let unit = job.settings.pressure_unit;
    let sent: Vec<String> =
        sent.map(|(corner, kpa)| format!("{} {} {unit}", corner.label(), unit.number(*kpa, 0))).collect();
    (!sent.is_empty()).then(|| ("Tire sensors of the car, last sent".to_owned(), sent.join(", ")))
}

/// The estimator: of the accelerations, or where there are none the analysis of wheel speeds.
pub(crate) fn estimator_label(job: &Job<'_>) -> &'static str {
    if job.corners.is_empty() { "wheel-speeds" } else { job.settings.estimator.label() }
}

/// The options by name: the rule and the rows always, everything else where it was given.
fn options(settings: &Settings, reading: &LogOptions) -> Vec<(String, String)> {
    let file = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let calibration = match (settings.calibrate_s, settings.reference.as_deref()) {
        (Some(seconds), _) => format!("the first {seconds} s of this drive (--calibrate-s)"),
        (None, Some(path)) => format!("of an earlier drive: {} (--reference)", file(path)),
        (None, None) => "none".to_owned(),
    };
    let repeats = match settings.road_repeats {
        RoadRepetition::Detect => None,
        RoadRepetition::Every(_) => Some("after the time that was given (--road-repeats)".to_owned()),
        RoadRepetition::Never => Some("never (--road-repeats)".to_owned()),
    };
    let units = match reading.units {
        UnitCheck::Suspicious => None,
        UnitCheck::Trusting => Some("taken as they are (--trust-units)".to_owned()),
    };
    let rows = reading.rows.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let rows = (!rows.is_empty()).then(|| format!("those with {rows} (--where)"));
    let given =
        |path: &Option<_>, option: &str| path.as_deref().map(|path| format!("{} ({option})", file(path)));
    [
        ("Calibration", Some(calibration)),
        ("Warning limits", Some(settings.regulation.name().to_owned())),
        (
            "Numbers of the monitor",
            (settings.tuning != Tuning::default()).then(|| "not their defaults (--tuning)".to_owned()),
        ),
        ("Signals named by", given(&reading.signals, "--signals")),
        ("Frames explained by", given(&reading.dbc, "--dbc")),
        ("Rows", rows),
        ("Units", units),
        ("Road repeats", repeats),
        ("Rows of the result per second", Some(settings.rate_hz.to_string())),
    ]
    .into_iter()
    .filter_map(|(name, value)| Some((name.to_owned(), value?)))
    .collect()
}

/// Where the vehicle's parameters come from: drives, the file, or what is usual for its confidence.
fn sources(vehicle: &Vehicle, corners: &[Corner]) -> Vec<(Parameter, String)> {
    let Some(first) = corners.first() else { return vec![] };
    let (stated, tire) =
        (&vehicle.details.corners[first.index()], &vehicle.details.corners[first.index()].tire);
    let source = |parameter: Parameter| {
        let (learned, sd_stated) = match parameter {
            Parameter::SprungMass => (false, stated.sprung_mass_relative_sd.is_some()),
            Parameter::UnsprungMass => (true, stated.unsprung_mass_relative_sd.is_some()),
            Parameter::Tire => (true, tire.stiffness_relative_sd.is_some()),
            Parameter::TireOverMass => (
                true,
                tire.stiffness_over_mass_relative_sd.is_some()
                    || stated.unsprung_mass_relative_sd.is_some() && tire.stiffness_relative_sd.is_some(),
            ),
            // A line without a standard deviation is taken as exact, whatever the confidence.
            Parameter::Slope => (true, true),
            Parameter::Damping => (true, stated.damping_relative_sd.is_some()),
            Parameter::Spring => (true, stated.spring_relative_sd.is_some()),
            Parameter::Friction => (true, stated.friction_sd_n.is_some()),
            Parameter::TireDamping => (false, stated.tire_damping_sd_n_s_per_m.is_some()),
        };
        match &vehicle.learned {
            Some(drives) if learned => format!("learned: {drives}"),
            _ if sd_stated => "vehicle file".to_owned(),
            _ => format!("vehicle file; ± as usual for {}", vehicle.details.confidence.label()),
        }
    };
    Parameter::ALL.into_iter().map(|parameter| (parameter, source(parameter))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_asked_for_is_listed_and_what_was_not_is_not() {
        let listed = |settings: &Settings, reading: &LogOptions| {
            let all = options(settings, reading).into_iter().map(|(name, value)| format!("{name}: {value}"));
            all.collect::<Vec<_>>().join("; ")
        };
        assert_eq!(
            listed(&Settings::default(), &LogOptions::default()),
            "Calibration: none; Warning limits: UN R141; Rows of the result per second: 10"
        );
        let settings = Settings {
            reference: Some("cars/a.reference".into()),
            road_repeats: RoadRepetition::Never,
            rate_hz: 2.5,
            ..Settings::default()
        };
        let reading = LogOptions {
            units: UnitCheck::Trusting,
            dbc: None,
            signals: Some("maps/a.toml".into()),
            rows: vec![],
        };
        assert_eq!(
            listed(&settings, &reading),
            "Calibration: of an earlier drive: a.reference (--reference); Warning limits: UN R141; \
             Signals named by: a.toml (--signals); Units: taken as they are (--trust-units); \
             Road repeats: never (--road-repeats); Rows of the result per second: 2.5"
        );
        let settings = Settings { calibrate_s: Some(60.0), ..Settings::default() };
        assert!(
            listed(&settings, &LogOptions::default())
                .starts_with("Calibration: the first 60 s of this drive")
        );
    }
}
