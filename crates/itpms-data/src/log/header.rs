//! The header: from the names in a file to the columns that mean something, or to the one that is missing.
//!
//! Called by both sources with their column names.

use itpms_core::model::Corner;
use itpms_files::{nearest, shortened};

use super::row::LogColumns;
use super::slot::{Field, Slot};
use crate::error::{Problem, separated_by, twice};
use crate::signals::names::meaning;
use crate::signals::{Conversion, column_unit};

#[derive(Debug, Clone)]
pub(super) struct Header {
    pub(super) columns: LogColumns,
    /// For each column of the file, what it is, if it is anything to us.
    pub(super) slots: Vec<Option<Slot>>,
    /// Columns that are nothing to us but look like a misspelling of one that is not there: (found, meant).
    pub(super) suspicious: Vec<(String, String)>,
    /// For each column of the file, how its values get our unit; `None`: they have it.
    pub(super) conversions: Vec<Option<Conversion>>,
    /// Which signal was taken for which column where neither its name nor a map says so, and what was doubtful.
    pub(super) mapping: Vec<String>,
    /// The name of the column of the time.
    pub(super) clock: String,
}

impl Header {
    /// A value of a column of the file in our unit.
    pub(super) fn in_our_unit(&self, column: usize, value: f64) -> f64 {
        let conversion = self.conversions.get(column).copied().flatten();
        conversion.map_or(value, |conversion| conversion.apply(value))
    }

    /// Reads the names of a file's columns.
    pub(super) fn from_names(names: &[String]) -> Result<Self, Problem> {
        let known: Vec<(Slot, String)> = Slot::all().map(|slot| (slot, slot.name())).collect();
        let mut slots: Vec<Option<Slot>> =
            names.iter().map(|name| known.iter().find(|(_, n)| n == name).map(|(slot, _)| *slot)).collect();
        if !slots.contains(&Some(Slot::Time))
            && let Some(place) = column_unit::index(names)
        {
            slots[place] = Some(Slot::Time);
        }
        let place = |slot: Slot| slots.iter().position(|s| *s == Some(slot));
        for (i, slot) in slots.iter().enumerate() {
            if let Some(slot) = slot
                && let Some(first) = place(*slot).filter(|first| *first < i)
            {
                return Err(twice(&slot.name(), first, i));
            }
        }
        let has = |slot| place(slot).is_some();
        let strangers: Vec<&str> =
            names.iter().zip(&slots).filter(|(_, s)| s.is_none()).map(|(n, _)| n.as_str()).collect();
        let missing = |slot: Slot| {
            let column = slot.name();
            let nearest = nearest(&column, strangers.iter().copied()).map(shortened);
            Problem::MissingColumn { column, nearest }
        };
        let half = |slot: Slot, present: Slot| match missing(slot) {
            Problem::MissingColumn { column, nearest: None } => {
                let present = present.name();
                Problem::Refused(format!(
                    "column {column} is missing; a corner has both accelerations: without {present} the log is read without this corner"
                ))
            }
            misspelled => misspelled,
        };
        if !has(Slot::Time) {
            return Err(separator(names).map_or_else(|| missing(Slot::Time), separated_by));
        }
        for corner in Corner::ALL {
            let [body, wheel] =
                [Field::BodyAccel, Field::WheelAccel].map(|field| Slot::Corner(corner, field));
            match (has(body), has(wheel)) {
                (true, false) => return Err(half(wheel, body)),
                (false, true) => return Err(half(body, wheel)),
                _ => {}
            }
        }
        let there: Vec<Slot> = slots.iter().copied().flatten().collect();
        let columns = LogColumns::of(&there);
        if let Some(absent) = wheel_without_speed(&columns, &there) {
            return Err(missing(absent));
        }
        if !columns.are_enough() {
            return Err(no_corner(&strangers));
        }
        let absent: Vec<&str> = known.iter().filter(|(s, _)| !has(*s)).map(|(_, n)| n.as_str()).collect();
        let meant = |name: &str| nearly(name, &absent).or_else(|| speed(name, &absent));
        let suspicious =
            strangers.iter().filter_map(|name| Some((shortened(name), meant(name)?.to_owned()))).collect();
        let conversions = vec![None; slots.len()];
        let clock = place(Slot::Time).map_or_else(String::new, |place| names[place].clone());
        Ok(Self { columns, slots, suspicious, conversions, mapping: Vec::new(), clock })
    }

    /// Reads names that are ours but for that of the time, where one column is called like a clock.
    pub(super) fn with_clock(names: &[String]) -> Option<Self> {
        let [(place, factor)] = column_unit::clocks(names)[..] else { return None };
        let mut ours = names.to_vec();
        let name = std::mem::replace(&mut ours[place], Slot::Time.name());
        let mut header = Self::from_names(&ours).ok()?;
        header.conversions[place] = Some(Conversion { factor, offset: 0.0 });
        header.mapping.push(format!("time_s is the column {name}"));
        header.clock = name;
        Some(header)
    }
}

/// The first wheel that lacks a speed in a log of nothing but other wheels' speeds.
fn wheel_without_speed(columns: &LogColumns, there: &[Slot]) -> Option<Slot> {
    let field = there.iter().find_map(|slot| match slot {
        Slot::Corner(_, field @ (Field::WheelSpeed | Field::WheelRotation)) => Some(*field),
        _ => None,
    })?;
    let absent = Corner::ALL.into_iter().map(|corner| Slot::Corner(corner, field));
    absent.filter(|slot| !there.contains(slot)).find(|_| !columns.are_enough())
}

/// No corner at all: name the wheel speed or else the acceleration that comes nearest to a column that is there, else the front left's.
fn no_corner(strangers: &[&str]) -> Problem {
    let speeds = strangers.iter().filter_map(|name| Some((meaning("", name)?.0, *name)));
    if let Some((slot, name)) = speeds.clone().find(|(slot, _)| slot.is_wheel_speed()) {
        return Problem::MissingColumn { column: slot.name(), nearest: Some(shortened(name)) };
    }
    let accelerations = Corner::ALL.into_iter().flat_map(|corner| {
        [Field::BodyAccel, Field::WheelAccel].map(|field| Slot::Corner(corner, field).name())
    });
    for column in accelerations {
        if let Some(nearest) = nearly(&column, strangers) {
            return Problem::MissingColumn { column, nearest: Some(shortened(nearest)) };
        }
    }
    let column = Slot::Corner(Corner::FrontLeft, Field::BodyAccel).name();
    Problem::MissingColumn { column, nearest: nearest("accel", strangers.iter().copied()).map(shortened) }
}

/// The candidate that differs from `name` by no more than a third of its letters and belongs to the same corner.
/// Stricter than [`nearest`], because nothing is known to be wrong yet.
fn nearly<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    let corner = |text: &str| Corner::ALL.into_iter().find(|c| text.starts_with(c.label()));
    candidates
        .iter()
        .map(|candidate| (strsim::damerau_levenshtein(&name, &candidate.to_lowercase()), *candidate))
        .filter(|(distance, candidate)| 3 * distance <= name.len() && corner(candidate) == corner(&name))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The speed, if it is absent and the name says that it is one: what a log without it misses is not seen later.
fn speed<'a>(name: &str, absent: &[&'a str]) -> Option<&'a str> {
    let (slot, _) = meaning("", name)?;
    absent.iter().copied().find(|column| slot == Slot::Speed && *column == slot.name())
}

/// A header that is one cell because its separator is not the comma.
pub(crate) fn separator(names: &[String]) -> Option<char> {
    match names {
        [only] => [';', '\t', '|'].into_iter().find(|separator| only.contains(*separator)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::row::CornerColumns;

    fn header(line: &str) -> Result<Header, String> {
        let names: Vec<String> = line.split(',').map(str::to_owned).collect();
        Header::from_names(&names).map_err(|problem| problem.to_string())
    }

    #[test]
    fn columns_may_come_in_any_order_with_others_between() {
        let h = header("rr_wheel_accel_m_s2,gear,time_s,rr_body_accel_m_s2,rr_road_m").unwrap();
        assert!(!h.columns.speed);
        assert_eq!(h.columns.present(), [Corner::RearRight]);
        assert_eq!(h.columns.corners[3], Some(CornerColumns { pressure: false, road: true }));
        assert_eq!(h.slots[2], Some(Slot::Time));
        assert!(h.slots[1].is_none() && h.suspicious.is_empty());
    }

    #[test]
    fn a_missing_column_is_named_with_the_nearest_that_is_there() {
        let text = header("Time,fl_body_accel_m_s2,fl_wheel_accel_m_s2").unwrap_err();
        assert_eq!(text, "column time_s is missing; the nearest name there is Time");
        let text = header("time_s,fl_body_accel_m_s2,fl_wheel_acc_m_s2").unwrap_err();
        assert_eq!(
            text,
            "column fl_wheel_accel_m_s2 is missing; the nearest name there is fl_wheel_acc_m_s2"
        );
        let text = header("time_s,speed_m_s").unwrap_err();
        assert_eq!(text, "column fl_body_accel_m_s2 is missing");
        let text = header("time_s,rl_body_acc,rl_wheel_acc_m_s2").unwrap_err();
        assert_eq!(
            text,
            "column rl_wheel_accel_m_s2 is missing; the nearest name there is rl_wheel_acc_m_s2"
        );
    }

    #[test]
    fn wheel_speeds_alone_are_a_log() {
        let four = |suffix: &str| ["fl", "fr", "rl", "rr"].map(|c| format!("{c}_{suffix}")).join(",");
        let h = header(&format!("time_s,yaw_rate_rad_s,{}", four("wheel_speed_m_s"))).unwrap();
        assert!(h.columns.motion.wheel_speed && h.columns.motion.yaw_rate && !h.columns.motion.brake);
        assert!(h.columns.present().is_empty());
        let h = header(&format!("time_s,{}", four("wheel_speed_rad_s"))).unwrap();
        assert!(h.columns.motion.wheel_rotation && !h.columns.motion.wheel_speed);
        let text = header("time_s,fl_wheel_speed_m_s,fr_wheel_speed_m_s,rl_wheel_speed_m_s").unwrap_err();
        assert_eq!(text, "column rr_wheel_speed_m_s is missing");
        // Of a name that says what it is, never an acceleration is the nearest.
        let text = header("time_s,fl_wheel_speed,fr_wheel_speed").unwrap_err();
        assert_eq!(text, "column fl_wheel_speed_m_s is missing; the nearest name there is fl_wheel_speed");
    }

    #[test]
    fn a_duplicate_is_an_error_only_where_it_matters() {
        let text = header("time_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2,time_s").unwrap_err();
        assert_eq!(text, "column time_s appears twice (columns 1 and 4), expected once: rename one");
        assert!(header("time_s,note,note,fl_body_accel_m_s2,fl_wheel_accel_m_s2").is_ok());
    }

    #[test]
    fn another_separator_is_recognised() {
        let text = header("time_s;fl_body_accel_m_s2;fl_wheel_accel_m_s2").unwrap_err();
        assert_eq!(text, "the header is separated by ';', expected commas");
    }

    #[test]
    fn a_likely_misspelling_is_mentioned_but_no_error() {
        let h = header("time_s,speed_mps,fl_body_accel_m_s2,fl_wheel_accel_m_s2,fr_pressure").unwrap();
        // fr_pressure is nearer to nothing of its own corner than a third of its letters allow, and no harm either way.
        assert!(h.suspicious.contains(&("speed_mps".to_owned(), "speed_m_s".to_owned())));
        // By what it says, too, but not where there is one already.
        let named = |speed: &str| {
            let h = header(&format!("time_s,{speed},fl_body_accel_m_s2,fl_wheel_accel_m_s2")).unwrap();
            h.suspicious.iter().any(|(found, meant)| found.contains("Vehicle") && meant == "speed_m_s")
        };
        assert!(named("VehicleSpeed") && !named("VehicleSpeed,speed_m_s") && !named("VehicleSpeedLimit"));
    }
}
