//! The map from a log's signals to the columns of a drive log, as a person writes it (`map.toml`).
//!
//! Read by the binary, used by the resolver. Every key is a column's name; `time_s` is for tables, for other logs have
//! clocks of their own. Checked as far as it can be without the log. Knows nothing of buses and formats.
//!
//! ```toml
//! [signals]
//! speed_m_s = "ESP_02.VehicleSpeed"      # message or channel group, dot, signal; or the signal alone
//! fl_body_accel_m_s2 = { signal = "Chassis_FL.BodyAccZ", unit = "g" }    # where the file is silent or wrong
//! fl_wheel_accel_m_s2 = { signal = "Hub_FL.Z", factor = -1.0, offset = 9.81 }    # instead of a unit
//! fr_pressure_kpa = ""                   # none, even if a name matches
//! ```

use std::path::{Path, PathBuf};

use itpms_files::input;
use toml::de::DeTable;

use super::Conversion;
use super::units::Unit;
use crate::error::{DataError, Problem};
use crate::log::{Quantity, Slot};
use crate::toml_table::{Table, syntax_problem};

/// Which signal goes into which column.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SignalMap {
    pub(super) path: PathBuf,
    pub(super) entries: Vec<Entry>,
    /// Which column of a table is the clock.
    time: Option<Entry>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) slot: Slot,
    pub(super) line: usize,
    /// `None`: this column is to have no signal.
    pub(super) signal: Option<String>,
    pub(super) scale: Scale,
}

/// How to get to the column's unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Scale {
    AsStated,
    Unit(String, Conversion),
    Numbers(Conversion),
}

impl SignalMap {
    /// Reads a map. Errors: the file cannot be read, is not TOML, has an unknown key, or a unit that is not one of the column's quantity.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let read = || parse(&input::read_text(path, "a map of signals (TOML)")?);
        let (entries, time) = read().map_err(|problem| DataError::new(path, problem))?;
        Ok(Self { path: path.to_owned(), entries, time })
    }

    /// The map in this text; `path` is what messages call it.
    pub fn parse(text: &str, path: &Path) -> Result<Self, DataError> {
        let (entries, time) = parse(text).map_err(|problem| DataError::new(path, problem))?;
        Ok(Self { path: path.to_owned(), entries, time })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The column of a table's time, the line that says so, and how it gets seconds where the map says that.
    pub(crate) fn time(&self) -> Option<(&str, usize, Option<Conversion>)> {
        let entry = self.time.as_ref()?;
        let conversion = match &entry.scale {
            Scale::AsStated => None,
            Scale::Unit(_, conversion) | Scale::Numbers(conversion) => Some(*conversion),
        };
        Some((entry.signal.as_deref()?, entry.line, conversion))
    }
}

/// The columns, and the clock.
fn parse(text: &str) -> Result<(Vec<Entry>, Option<Entry>), Problem> {
    let document = DeTable::parse(text).map_err(|error| syntax_problem(text, &error))?;
    let root = Table::root(text, document.get_ref());
    root.check_keys(&["signals"])?;
    let signals = root.table("signals")?.ok_or_else(|| root.lacks("table [signals]"))?;
    let columns: Vec<(Slot, String)> = Slot::all().map(|slot| (slot, slot.name())).collect();
    signals.check_keys(&columns.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>())?;
    let mut entries = Vec::new();
    for (slot, column) in &columns {
        if signals.has(column) {
            entries.push(entry(&signals, *slot, column)?);
        }
    }
    entries.sort_by_key(|entry| entry.line);
    let time = entries.iter().position(|entry| entry.slot == Slot::Time).map(|place| entries.remove(place));
    Ok((entries, time))
}

fn entry(signals: &Table<'_>, slot: Slot, column: &str) -> Result<Entry, Problem> {
    let line = signals.line_of_key(column);
    let named = |signal: String| Some(signal).filter(|signal| !signal.is_empty());
    let Some(table) = signals.table_unless_text(column)? else {
        let signal = signals.text(column)?.unwrap_or_default();
        return Ok(Entry { slot, line, signal: named(signal), scale: Scale::AsStated });
    };
    table.check_keys(&["signal", "unit", "factor", "offset"])?;
    let signal = table.text("signal")?.ok_or_else(|| table.lacks("signal"))?;
    let (unit, factor, offset) = (table.text("unit")?, table.number("factor")?, table.number("offset")?);
    let scale = match (unit, factor, offset) {
        (None, None, None) => Scale::AsStated,
        (Some(unit), None, None) => {
            let conversion = Unit::of(&unit).conversion_to(slot);
            let wrong = || {
                let known = Quantity::of(slot).known_units();
                format!(
                    "line {line}: {column} has unit {unit:?}, expected {known} (or factor and offset instead)"
                )
            };
            Scale::Unit(unit.clone(), conversion.ok_or_else(wrong)?)
        }
        (None, factor, offset) => {
            let conversion = Conversion { factor: factor.unwrap_or(1.0), offset: offset.unwrap_or(0.0) };
            let usable =
                conversion.factor.is_finite() && conversion.factor != 0.0 && conversion.offset.is_finite();
            if !usable {
                let Conversion { factor, offset } = conversion;
                return Err(format!(
                    "line {line}: {column} has factor {factor} and offset {offset}, expected a finite factor that is not 0 and a finite offset"
                )
                .into());
            }
            Scale::Numbers(conversion)
        }
        (Some(_), ..) => {
            let expected = "expected one of the two";
            return Err(format!("line {line}: {column} has a unit and a factor or offset, {expected}").into());
        }
    };
    Ok(Entry { slot, line, signal: named(signal), scale })
}
