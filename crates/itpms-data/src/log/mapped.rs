//! Tables with foreign names: a map, and where it is silent the names, say which column is what.
//!
//! Called by the sources of tables with their column names. Without a map a table's columns have our names, or say by their words and units
//! what they are.

use std::path::Path;

use itpms_files::shortened;

use super::header::Header;
use super::quantity::Quantity;
use super::row::LogColumns;
use super::slot::Slot;
use crate::error::{DataError, Problem};
use crate::signals::names::meaning;
use crate::signals::{Conversion, SignalMap, column_unit, not_there, resolve};

/// How a table's header is read.
pub(super) fn header(
    path: &Path,
    names: &[String],
    units: &[String],
    map: Option<&SignalMap>,
) -> Result<Header, DataError> {
    match map {
        None => match named(names).and_then(|header| in_units(header, names, units)) {
            Ok(header) => Ok(with_speed(header, names, units)),
            Err(problem) => recognized(path, names, units, problem),
        },
        Some(map) => mapped(path, names, units, map),
    }
}

/// The header of a table with our names; the time may have another one.
fn named(names: &[String]) -> Result<Header, Problem> {
    Header::from_names(names).or_else(|problem| Header::with_clock(names).ok_or(problem))
}

/// The header of a table of other names, whose words and units say what it is, as those of a bus do. One with some of our names lacks one of
/// them, and that is `problem`.
fn recognized(
    path: &Path,
    names: &[String],
    units: &[String],
    problem: Problem,
) -> Result<Header, DataError> {
    let is_ours = |name: &String| Slot::all().any(|slot| slot.is_acceleration() && slot.name() == *name);
    let speaks = |name: &String| meaning("", name).is_some_and(|(slot, _)| slot.is_acceleration());
    let all_others = !names.iter().any(is_ours);
    match mapped(path, names, units, &SignalMap::default()) {
        Ok(header) if all_others || header.columns.motion.wheel_speeds() => Ok(header),
        // Missing columns are reported by the table's own names.
        Err(error) if all_others && names.iter().any(speaks) => Err(error),
        _ => Err(DataError::new(path, problem)),
    }
}

/// The speed by its words and unit, where the column of our name is not there. Of several that are called the same the first.
fn with_speed(mut header: Header, names: &[String], units: &[String]) -> Header {
    let is_speed = |place: &usize| meaning("", &names[*place]).is_some_and(|(slot, _)| slot == Slot::Speed);
    let mut places: Vec<usize> = (0..names.len()).filter(is_speed).collect();
    places.retain(|place| header.slots[*place].is_none());
    if header.columns.speed || places.is_empty() {
        return header;
    }
    let first = places[0];
    let times = places.len();
    if places.iter().all(|place| names[*place] == names[first]) {
        places.truncate(1);
    }
    let stated = |place: usize| units.get(place).map_or("", String::as_str);
    let candidates: Vec<_> =
        places.iter().map(|place| column_unit::candidate_in(&names[*place], stated(*place))).collect();
    let Ok(resolved) = resolve(&candidates, None) else { return header };
    let Some(chosen) = resolved.get(Slot::Speed) else { return header };
    let place = places[chosen.candidate];
    (header.slots[place], header.conversions[place]) = (Some(Slot::Speed), Some(chosen.conversion));
    header.columns.speed = true;
    header.suspicious.retain(|(found, _)| *found != shortened(&names[place]));
    header.mapping.extend(resolved.lines());
    if times > places.len() {
        header.mapping.push(format!("{} is there {times} times: the first is taken", names[place]));
    }
    header
}

/// The header of a table with our names and a row of units under them: the values come in those units.
fn in_units(mut header: Header, names: &[String], units: &[String]) -> Result<Header, Problem> {
    for (place, unit) in units.iter().enumerate() {
        let Some(slot) = header.slots[place].filter(|_| column_unit::is_unit(unit)) else { continue };
        let conversion = conversion(unit, slot).ok_or_else(|| {
            let (column, expected) = (&names[place], Quantity::of(slot).unit());
            Problem::Refused(format!("column {column} has the unit {unit}, expected {expected}"))
        })?;
        header.conversions[place] = Some(conversion).filter(|conversion| *conversion != Conversion::IDENTITY);
    }
    Ok(header)
}

fn conversion(unit: &str, slot: Slot) -> Option<Conversion> {
    match slot {
        Slot::Time => column_unit::seconds(unit).map(|factor| Conversion { factor, offset: 0.0 }),
        _ => column_unit::conversion_to(unit, slot),
    }
}

fn mapped(path: &Path, names: &[String], units: &[String], map: &SignalMap) -> Result<Header, DataError> {
    let fail = |problem| DataError::new(path, problem);
    let (time, conversion) = clock(path, names, units, map)?;
    let others: Vec<usize> = (0..names.len()).filter(|place| *place != time).collect();
    let stated = |place: usize| units.get(place).map_or("", String::as_str);
    let candidates: Vec<_> =
        others.iter().map(|place| column_unit::candidate_in(&names[*place], stated(*place))).collect();
    let resolved = resolve(&candidates, Some(map))?;
    if let Some(why) = resolved.unusable() {
        return Err(fail(Problem::Refused(why)));
    }
    let mut slots = vec![None; names.len()];
    let mut conversions = vec![None; names.len()];
    (slots[time], conversions[time]) = (Some(Slot::Time), Some(conversion));
    let columns = LogColumns::of(&resolved.slots());
    for chosen in resolved.iter().filter(|chosen| columns.has(chosen.slot)) {
        let place = others[chosen.candidate];
        if let Some(other) = slots[place].replace(chosen.slot) {
            let (signal, slot) = (&chosen.signal, chosen.slot.name());
            let why =
                format!("column {signal} is to be both {} and {slot}, expected one of them", other.name());
            return Err(fail(Problem::Refused(why)));
        }
        conversions[place] = Some(chosen.conversion);
    }
    let (mapping, clock) = (resolved.assumptions(), names[time].clone());
    Ok(Header { columns, slots, suspicious: Vec::new(), conversions, mapping, clock })
}

/// The column of the time: what the map says, else `time_s`, else the only one that is called like a clock.
fn clock(
    path: &Path,
    names: &[String],
    units: &[String],
    map: &SignalMap,
) -> Result<(usize, Conversion), DataError> {
    let seconds = |factor| Conversion { factor, offset: 0.0 };
    let under = |place: usize| units.get(place).and_then(|unit| column_unit::seconds(unit));
    if let Some((signal, line, conversion)) = map.time() {
        let column = Slot::Time.name();
        // In memory a frame's index has no name of its own and comes as `time_s`.
        let called = |wanted: &str| names.iter().position(|name| name == wanted);
        let Some(place) = called(signal).or_else(|| called(&Slot::Time.name())) else {
            let known = names.iter().map(String::as_str);
            return Err(DataError::new(map.path(), not_there(line, &column, signal, names.len(), known)));
        };
        let stated = || under(place).or_else(|| column_unit::seconds_in(signal)).map(seconds);
        return Ok((place, conversion.or_else(stated).unwrap_or(Conversion::IDENTITY)));
    }
    if let Some(place) = names.iter().position(|name| *name == Slot::Time.name()) {
        return Ok((place, under(place).map_or(Conversion::IDENTITY, seconds)));
    }
    match column_unit::clocks(names)[..] {
        [(place, factor)] => Ok((place, seconds(under(place).unwrap_or(factor)))),
        [] => {
            let missing = || Problem::MissingColumn { column: Slot::Time.name(), nearest: None };
            let place = column_unit::index(names).ok_or_else(|| DataError::new(path, missing()))?;
            Ok((place, Conversion::IDENTITY))
        }
        [(one, _), (other, _), ..] => {
            let why = format!(
                "time_s could be {} or {}: say which in the map, time_s = {:?}",
                names[one], names[other], names[one]
            );
            Err(DataError::new(path, Problem::Refused(why)))
        }
    }
}
