//! The rows of a table as messages: a topic per wheel, and one for the rest of the car.

use std::io::{self, Write};

use itpms_core::model::Corner;
use serde_json::Value;

use super::{McapWriter, Topic};
use crate::out::cell::{Cell, Kind};

/// The topics of a table's columns.
#[derive(Debug)]
pub struct RowTopics(Vec<RowTopic>);

#[derive(Debug)]
struct RowTopic {
    topic: Topic,
    /// Where its columns are in a row, each with its name as it stands in a message: `,"pressure_kpa":`.
    columns: Vec<(usize, String)>,
}

impl RowTopics {
    /// Adds the topics of these columns: `{c}_x` is field `x` of topic `root/{c}`, every other one is a field of `root`. `time_s` is in
    /// all of them; a topic without anything else is none.
    pub fn create<W: Write>(
        writer: &mut McapWriter<W>,
        root: &str,
        columns: &[(String, Kind)],
    ) -> io::Result<Self> {
        let mut topics = Vec::new();
        for corner in [None].into_iter().chain(Corner::ALL.map(Some)) {
            let own = columns.iter().enumerate().filter(|(_, (name, _))| name != "time_s");
            let own = own.filter_map(|(place, (name, kind))| {
                let (whose, field) = split(name);
                (whose == corner).then_some((place, field, *kind))
            });
            let own: Vec<(usize, &str, Kind)> = own.collect();
            if own.is_empty() {
                continue;
            }
            let name = corner.map_or_else(|| root.to_owned(), |corner| format!("{root}/{}", corner.label()));
            let fields = own.iter().map(|(_, field, kind)| ((*field).to_owned(), (*kind).into()));
            let topic = writer.add_topic(&name, fields)?;
            let columns = own.iter().map(|(place, field, _)| (*place, format!(",\"{field}\":"))).collect();
            topics.push(RowTopic { topic, columns });
        }
        Ok(Self(topics))
    }

    /// Adds a row, a message in each topic, its cells in the order of the columns.
    pub fn write<W: Write>(
        &mut self,
        writer: &mut McapWriter<W>,
        time_s: f64,
        cells: &[Cell<'_>],
    ) -> io::Result<()> {
        for RowTopic { topic, columns } in &mut self.0 {
            writer.write_message(topic, time_s, |message| {
                message.extend_from_slice(b"{\"time_s\":");
                serde_json::to_writer(&mut *message, &time_s)?;
                for (place, name) in columns.iter() {
                    let value = match cells.get(*place) {
                        // JSON has neither NaN nor infinity.
                        Some(Cell::Number(value)) if value.is_finite() => Value::from(*value),
                        Some(Cell::Flag(flag)) => Value::from(*flag),
                        Some(Cell::Label(text)) => Value::from(*text),
                        Some(Cell::Number(_)) | None => continue,
                    };
                    message.extend_from_slice(name.as_bytes());
                    serde_json::to_writer(&mut *message, &value)?;
                }
                message.push(b'}');
                Ok(())
            })?;
        }
        Ok(())
    }
}

/// Whose column it is, and what it is called there.
fn split(name: &str) -> (Option<Corner>, &str) {
    let of = |corner: Corner| name.strip_prefix(corner.label())?.strip_prefix('_');
    let found = Corner::ALL.into_iter().find_map(|corner| Some((Some(corner), of(corner)?)));
    found.unwrap_or((None, name))
}
