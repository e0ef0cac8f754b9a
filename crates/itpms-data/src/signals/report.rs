//! The mapping of signals to columns, ambiguous and missing ones, as text and as a map to start from.
//!
//! Called by the commands, which print it as it is. Knows the resolver's result and nothing of logs.

use std::fmt::Write as _;

use itpms_core::model::Corner;

use super::remark::{Remark, Source};
use super::{Conversion, Resolved};
use crate::log::{Field, LogColumns, Quantity, Slot};
use crate::toml_table::escaped;

impl Resolved {
    /// Doubts, in the order of the columns.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// A line per column that has a signal: which, how converted, and by what.
    pub fn lines(&self) -> Vec<String> {
        let line = |chosen: &super::Chosen| {
            let conversion = words(chosen.conversion, &chosen.unit);
            format!("{} is {}{conversion}, {}", chosen.slot.name(), chosen.signal, chosen.source)
        };
        self.iter().map(line).collect()
    }

    /// What someone should know who wrote no map of it: which signal was taken for which column where neither its name nor a
    /// map says so, what was doubtful, and which corner is left out.
    pub fn assumptions(&self) -> Vec<String> {
        let lines = self.iter().zip(self.lines());
        let guessed = lines
            .filter(|(chosen, _)| !matches!(chosen.source, Source::Name | Source::Map))
            .map(|(_, line)| line);
        let doubts = self.remarks().iter().map(ToString::to_string);
        let lone = self
            .lone()
            .into_iter()
            .map(|slot| format!("there is no signal for {}, so that corner is left out", slot.name()));
        guessed.chain(doubts).chain(lone).chain(self.lacking_wheels()).collect()
    }

    pub fn has_wheel_speeds(&self) -> bool {
        LogColumns::of(&self.slots()).motion.wheel_speeds()
    }

    /// The wheels without a speed where others have one, as a sentence.
    fn lacking_wheels(&self) -> Option<String> {
        let has = |corner: &Corner| {
            let of = |field| self.get(Slot::Corner(*corner, field)).is_some();
            of(Field::WheelSpeed) || of(Field::WheelRotation)
        };
        let lacking: Vec<&str> = Corner::ALL.into_iter().filter(|c| !has(c)).map(Corner::label).collect();
        let some = !self.has_wheel_speeds() && lacking.len() < Corner::ALL.len();
        let wheels = if lacking.is_empty() { "one unit for all".to_owned() } else { lacking.join(" ") };
        some.then(|| {
            format!("wheel speeds are of use for all four wheels alone and are left out; missing: {wheels}")
        })
    }

    /// The corners that have both accelerations, in the order of [`Corner::ALL`].
    pub fn corners(&self) -> Vec<Corner> {
        let has = |corner, field| self.get(Slot::Corner(corner, field)).is_some();
        let complete = |corner: &Corner| has(*corner, Field::BodyAccel) && has(*corner, Field::WheelAccel);
        Corner::ALL.into_iter().filter(complete).collect()
    }

    /// Why nothing can be estimated from these signals, if no corner has both accelerations and not all four wheels have a speed; else `None`.
    pub fn unusable(&self) -> Option<String> {
        if !self.corners().is_empty() || self.has_wheel_speeds() {
            return None;
        }
        let accelerations = self.iter().filter(|c| c.slot.is_acceleration()).count();
        let mut text = match (self.candidates, accelerations) {
            (0, _) => "there are no signals".to_owned(),
            (of, 0) => format!("none of {of} signals is known to be an acceleration of a body or wheel"),
            (of, some) => {
                format!(
                    "{some} of {of} signals are known to be accelerations, but no corner has that of its body and of its wheel"
                )
            }
        };
        if self.remarks.is_empty()
            && let Some(unread) = self.unread.first()
        {
            let _ = write!(text, "; {} is {}", unread.candidate.full_name(), unread.why);
        }
        // Accelerations decide; of many doubts one is enough to see what is missing.
        let first = self.remarks.iter().find(|remark| remark.is_of_acceleration()).or(self.remarks.first());
        if let Some(remark) = first {
            let _ = write!(text, "; {remark}");
        }
        if self.remarks.len() > 1 {
            let _ = write!(text, "; {} more (itpms signals)", self.remarks.len() - 1);
        }
        if self.candidates > 0 {
            text.push_str(
                "; expected body and wheel of one corner or more, or the speeds of four wheels: name them in a map (--signals map.toml)",
            );
        }
        Some(text)
    }

    /// The columns of corners that have one acceleration and lack the other.
    pub fn lone(&self) -> Vec<Slot> {
        let pair = |corner| [Field::BodyAccel, Field::WheelAccel].map(|field| Slot::Corner(corner, field));
        let lacking = |[body, wheel]: [Slot; 2]| match (self.get(body), self.get(wheel)) {
            (Some(_), None) => Some(wheel),
            (None, Some(_)) => Some(body),
            _ => None,
        };
        Corner::ALL.into_iter().map(pair).filter_map(lacking).collect()
    }

    /// The text of a map that says all this, with what is doubtful or missing as comments. `clock`: the column of a table that is
    /// its clock.
    pub fn to_toml(&self, clock: Option<&str>) -> String {
        self.to_toml_in(clock, None)
    }

    /// The same with the clock's unit, where it does not say it itself.
    pub fn to_toml_in(&self, clock: Option<&str>, unit: Option<&str>) -> String {
        let mut out = String::from("[signals]\n");
        if let Some(name) = clock.map(escaped) {
            let value = match unit {
                Some(unit) => format!("{{ signal = \"{name}\", unit = \"{unit}\" }}"),
                None => format!("\"{name}\""),
            };
            let _ = writeln!(out, "{} = {value}", Slot::Time.name());
        }
        for slot in Slot::all().filter(|slot| *slot != Slot::Time) {
            let column = slot.name();
            match self.get(slot) {
                Some(chosen) => {
                    let value = map_value(chosen);
                    let _ = writeln!(out, "{column} = {value}");
                }
                None => {
                    let doubt = |remark: &&Remark| matches!(remark, Remark::Ambiguous { slot: s, .. } | Remark::Unit { slot: s, .. } | Remark::Unread { slot: s, .. } | Remark::NoSamples { slot: s, .. } if *s == slot);
                    if let Some(remark) = self.remarks.iter().find(doubt) {
                        let text: String = remark.to_string().chars().map(one_line).collect();
                        let _ = writeln!(out, "# {text}");
                    }
                    let optional = match slot {
                        Slot::Corner(_, Field::Pressure | Field::Road) => " (the truth, where it is known)",
                        _ if slot.is_tire_sensor() => " (the car's own tire sensor, where it has one)",
                        Slot::Air(_) => " (the air around the car, for cold pressures)",
                        Slot::Axle(_) => " (the car's own axle load sensor, where it has one)",
                        Slot::Position(_) => " (where the car is, for the road's place)",
                        _ => "",
                    };
                    let _ = writeln!(out, "# {column} = \"\"{optional}");
                }
            }
        }
        out
    }
}

/// Doubts about a corner's accelerations among the remarks on a log's signals.
pub fn doubt_of(corner: Corner, reported: &[String]) -> Option<&str> {
    let columns = [Field::BodyAccel, Field::WheelAccel].map(|field| Slot::Corner(corner, field).name());
    let is_of_it = |text: &&String| columns.iter().any(|column| text.contains(column.as_str()));
    reported.iter().find(is_of_it).map(String::as_str)
}

fn one_line(c: char) -> char {
    if c.is_control() { ' ' } else { c }
}

/// This signal's entry of a map, which reads back as the same.
fn map_value(chosen: &super::Chosen) -> String {
    let signal = escaped(&chosen.signal);
    let stated = super::units::Unit::of(&chosen.unit).conversion_to(chosen.slot);
    if stated == Some(chosen.conversion) {
        return format!("\"{signal}\"");
    }
    if chosen.conversion == Conversion::IDENTITY {
        return format!("{{ signal = \"{signal}\", unit = \"{}\" }}", Quantity::of(chosen.slot).unit());
    }
    let Conversion { factor, offset } = chosen.conversion;
    format!("{{ signal = \"{signal}\", factor = {factor:?}, offset = {offset:?} }}")
}

fn words(conversion: Conversion, unit: &str) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(" in {unit}") };
    match conversion {
        Conversion::IDENTITY => unit,
        Conversion { factor, offset: 0.0 } => format!("{unit} times {}", short(factor)),
        Conversion { factor, offset } => format!("{unit} times {} plus {}", short(factor), short(offset)),
    }
}

/// Six digits are enough for a reader.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
