//! The numbers of a message in protobuf, by the description of its file that the schema is.

use prost_reflect::{DescriptorPool, DynamicMessage, MessageDescriptor, ReflectMessage, Value};

use super::fields::{Fields, MOST_ELEMENTS};

/// The message that the schema of this name describes, or why it cannot be read.
pub(super) fn compile(name: &str, schema: &[u8]) -> Result<MessageDescriptor, String> {
    let pool =
        DescriptorPool::decode(schema).map_err(|error| format!("no description of protobuf ({error})"))?;
    pool.get_message_by_name(name).ok_or_else(|| format!("a description of protobuf without {name}"))
}

/// Hands out the numbers of a message; false if it is none of this kind.
pub(super) fn walk(kind: &MessageDescriptor, bytes: &[u8], fields: &mut Fields<'_>) -> bool {
    match DynamicMessage::decode(kind.clone(), bytes) {
        Ok(message) => {
            walk_message(&message, fields);
            true
        }
        Err(_) => false,
    }
}

fn walk_message(message: &DynamicMessage, fields: &mut Fields<'_>) {
    for field in message.descriptor().fields() {
        // A number that is not sent is zero, unless the description has presence for it.
        if field.supports_presence() && !message.has_field(&field) {
            continue;
        }
        let value = message.get_field(&field);
        fields.field(field.name(), |fields| walk_value(&value, fields));
    }
}

fn walk_value(value: &Value, fields: &mut Fields<'_>) {
    match value {
        Value::Bool(value) => fields.number(f64::from(u8::from(*value))),
        Value::I32(value) => fields.number(f64::from(*value)),
        Value::I64(value) => fields.number(*value as f64),
        Value::U32(value) => fields.number(f64::from(*value)),
        Value::U64(value) => fields.number(*value as f64),
        Value::F32(value) => fields.number(f64::from(*value)),
        Value::F64(value) => fields.number(*value),
        Value::EnumNumber(value) => fields.number(f64::from(*value)),
        Value::Message(message) => walk_message(message, fields),
        Value::List(list) => {
            for (number, value) in list.iter().enumerate().take(MOST_ELEMENTS) {
                fields.element(number, |fields| walk_value(value, fields));
            }
        }
        Value::String(_) | Value::Bytes(_) | Value::Map(_) => {}
    }
}
