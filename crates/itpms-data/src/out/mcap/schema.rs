//! The JSON Schema of a topic's messages.

use serde_json::{Map, Value, json};

use crate::out::cell::Kind;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldType {
    Number,
    Flag,
    Label,
    Labels,
}

impl From<Kind> for FieldType {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Number => FieldType::Number,
            Kind::Flag => FieldType::Flag,
            Kind::Label => FieldType::Label,
        }
    }
}

const ABOUT: &str = "A field that a message lacks has no value at its time. Units are in the names of the fields. time_s is the drive's own time; log_time counts it from 1970 where the drive has a date.";

/// `/estimate/fl` as the name of a schema: `itpms.estimate.fl`.
pub(super) fn title(topic: &str) -> String {
    format!("itpms{}", topic.replace('/', "."))
}

/// The schema of messages with these fields and `time_s`, which is in all of them.
pub(super) fn of(title: &str, fields: impl IntoIterator<Item = (String, FieldType)>) -> Value {
    let property = |field| match field {
        FieldType::Number => json!({"type": "number"}),
        FieldType::Flag => json!({"type": "boolean"}),
        FieldType::Label => json!({"type": "string"}),
        FieldType::Labels => json!({"type": "array", "items": {"type": "string"}}),
    };
    let mut properties = Map::from_iter([("time_s".to_owned(), property(FieldType::Number))]);
    properties.extend(fields.into_iter().map(|(name, field)| (name, property(field))));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        "description": ABOUT,
        "type": "object",
        "properties": properties,
        "required": ["time_s"],
    })
}

/// The fields of an alert that began or ended ([`transition_object`](crate::out::transition_object)).
pub fn alert_fields() -> impl Iterator<Item = (String, FieldType)> {
    use FieldType::{Flag, Label, Labels, Number};
    let fields = [
        ("event", Label),
        ("kind", Label),
        ("wheels", Labels),
        ("since_s", Number),
        ("reported_s", Number),
        ("pressure_kpa", Number),
        ("sd_kpa", Number),
        ("limit_kpa", Number),
        ("reference_kpa", Number),
        ("basis", Label),
        ("rate_kpa_per_min", Number),
        ("mean_share", Number),
        ("sd_share", Number),
        ("lost_share", Number),
        ("lost_sd_share", Number),
        ("probability", Number),
        ("lost_share_per_day", Number),
        ("lost_sd_share_per_day", Number),
        ("days", Number),
        ("wheels_are_known", Flag),
        ("malfunction", Label),
        ("sensors", Labels),
        ("gain", Number),
        ("driven_s", Number),
        ("text", Label),
    ];
    fields.into_iter().map(|(name, field)| (name.to_owned(), field))
}
