//! The unit in the name of a table's column: `Speed [km/h]`, `AccZ_FL (g)`, `v_kmh`, `body_acc_fl_m_s2`; and whether a column is the clock.
//!
//! Called where a table's columns are taken for signals.

use super::names::meaning;
use super::units::Unit;
use super::{Candidate, Conversion};
use crate::log::{Quantity, Slot};

/// The column as a candidate: a signal of its own name and, if the name ends with one, of that unit.
pub(crate) fn candidate(name: &str) -> Candidate {
    let (bare, unit) = split(name);
    // `carState.wheelSpeeds.fl`: paths of a message's fields. What stands before the last point is a group's name.
    let says = |group, name| meaning(group, name).is_some();
    let point = bare.rfind('.').filter(|point| !says("", bare) && says(&bare[..*point], &bare[*point + 1..]));
    match point {
        Some(point) => {
            Candidate { group: name[..point].to_owned(), name: name[point + 1..].to_owned(), unit }
        }
        None => Candidate { group: String::new(), name: name.to_owned(), unit },
    }
}

/// The same of a column with a unit stated beside its name, which counts: with such a row, names are only names.
pub(crate) fn candidate_in(name: &str, stated: &str) -> Candidate {
    let candidate = candidate(name);
    if is_unit(stated) { Candidate { unit: stated.to_owned(), ..candidate } } else { candidate }
}

/// From a unit to a column's own, if it is a unit of the column's quantity.
pub(crate) fn conversion_to(unit: &str, slot: Slot) -> Option<Conversion> {
    Unit::of(unit).conversion_to(slot)
}

pub(crate) fn seconds(unit: &str) -> Option<f64> {
    match Unit::of(unit) {
        Unit::Known(Quantity::Time, conversion) => Some(conversion.factor),
        _ => None,
    }
}

/// Seconds per unit of the column, if it is a clock: `time_s`, `Time`, `t [ms]`, `timestamps`. One that does not say its unit has seconds.
pub(crate) fn clock(name: &str) -> Option<f64> {
    let (bare, unit) = split(name);
    let letters: String = bare.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    let is_clock = matches!(
        letters.as_str(),
        "time" | "times" | "t" | "ts" | "timestamp" | "timestamps" | "zeit" | "zeitstempel"
    );
    match Unit::of(&unit) {
        // What comma's logs call their clock, in ns.
        Unit::Silent if letters == "logmonotime" => Some(1e-9),
        Unit::Known(Quantity::Time, conversion) if is_clock => Some(conversion.factor),
        Unit::Silent if is_clock => Some(1.0),
        _ => None,
    }
}

/// The columns that are clocks, each with its seconds per unit; where there is none, those that are called after the date and the time.
pub(crate) fn clocks(names: &[String]) -> Vec<(usize, f64)> {
    let places = || names.iter().enumerate();
    let clocks: Vec<_> = places().filter_map(|(place, name)| Some((place, clock(name)?))).collect();
    if !clocks.is_empty() {
        return clocks;
    }
    // What loggers on telephones and race cars call their clock beside others, the finest first.
    let letters = |name: &str| name.to_lowercase().replace([' ', '_'], "");
    let own = ["interval", "devicetime", "elapsedtime"]
        .into_iter()
        .find_map(|clock| places().find(|(_, name)| letters(name) == clock));
    if let Some((place, _)) = own {
        return vec![(place, 1.0)];
    }
    places().filter(|(_, name)| is_date(name)).map(|(place, _)| (place, 1.0)).collect()
}

/// Whether a column is called like dates and times: `DateTime`, `Datum`, `Datum/Uhrzeit`.
fn is_date(name: &str) -> bool {
    let letters: String = name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    matches!(
        letters.as_str(),
        "date" | "datetime" | "dateandtime" | "datum" | "datumzeit" | "datumuhrzeit" | "uhrzeit"
    )
}

/// Name that pandas gives an unnamed index in a file.
pub(crate) const INDEX: &str = "__index_level_0__";

/// The column that is such an index: with times in it, it is the clock of a table that has no other.
pub(crate) fn index(names: &[String]) -> Option<usize> {
    names.iter().position(|name| name == INDEX)
}

/// Seconds per unit of a column that is given as the clock, if its name ends with a unit of time.
pub(crate) fn seconds_in(name: &str) -> Option<f64> {
    seconds(&split(name).1)
}

/// The text before the unit, and the unit; empty where there is none.
fn split(name: &str) -> (&str, String) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        let inside = name.strip_suffix(close).and_then(|rest| rest.rsplit_once(open));
        // Round brackets may hold anything; square brackets almost always hold a unit.
        if let Some((bare, unit)) = inside.filter(|(_, unit)| open == '[' || is_unit(unit)) {
            return (bare.trim_end(), unit.to_owned());
        }
    }
    let ends = |c: char| c == '_' || c == '.' || c.is_whitespace();
    let seams: Vec<usize> = name.char_indices().filter(|(_, c)| ends(*c)).map(|(place, _)| place).collect();
    // `m_s2` and `km_h` are quotients of two words (`m_s` is no millisecond); a unit that is the whole name is none.
    for seam in seams.iter().rev().take(2).rev().filter(|seam| **seam > 0) {
        let unit = name[*seam..].trim_start_matches(ends);
        if let Some(unit) =
            [unit.replacen(ends, "/", 1), unit.to_owned()].into_iter().find(|unit| is_unit(unit))
        {
            return (&name[..*seam], unit);
        }
    }
    (name, String::new())
}

pub(crate) fn is_unit(text: &str) -> bool {
    matches!(Unit::of(text), Unit::Known(..))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Field;
    use itpms_core::model::Corner;

    #[test]
    fn units_end_names() {
        for (name, bare, unit) in [
            ("Speed [km/h]", "Speed", "km/h"),
            ("AccZ_FL (g)", "AccZ_FL", "g"),
            ("AccZ (front left)", "AccZ (front left)", ""),
            ("v_kmh", "v", "kmh"),
            ("fl_body_acc_m_s2", "fl_body_acc", "m/s2"),
            ("speed_m_s", "speed", "m/s"),
            ("veh.speed.km.h", "veh.speed", "km/h"),
            ("Raw [LSB]", "Raw", "LSB"),
            ("VehicleSpeed", "VehicleSpeed", ""),
            ("g", "g", ""),
            ("fl_road_m", "fl_road", "m"),
        ] {
            assert_eq!(split(name), (bare, unit.to_owned()), "{name}");
        }
    }

    #[test]
    fn the_unit_counts_in_the_columns_own() {
        let factor = |name: &str, slot| {
            Unit::of(&candidate(name).unit).conversion_to(slot).map(|conversion| conversion.factor)
        };
        let body = Slot::Corner(Corner::FrontLeft, Field::BodyAccel);
        assert_eq!(factor("acc_m_s2", body), Some(1.0));
        assert_eq!(factor("acc_g", body), Some(9.806_65));
        assert_eq!(factor("v_km_h", Slot::Speed), Some(1.0 / 3.6));
        assert_eq!(factor("v [Unit_KiloMeterPerHour]", Slot::Speed), Some(1.0 / 3.6));
        assert_eq!(factor("acc_g", Slot::Speed), None);
    }

    #[test]
    fn clocks() {
        for (name, seconds) in [
            ("time_s", Some(1.0)),
            ("Time", Some(1.0)),
            ("t [ms]", Some(1e-3)),
            ("timestamp_ns", Some(1e-9)),
            ("Timestamps", Some(1.0)),
            ("Zeit [ms]", Some(1e-3)),
            ("time of day", None),
            ("lap_time_s", None),
            ("time [LSB]", None),
            ("logMonoTime", Some(1e-9)),
        ] {
            assert_eq!(clock(name), seconds, "{name}");
        }
    }
}
