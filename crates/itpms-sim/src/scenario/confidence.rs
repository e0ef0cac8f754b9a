//! How well a vehicle file knows its car, as a word in a scenario.

use itpms_core::model::Confidence;
use serde::de::{Error, Unexpected};
use serde::{Deserialize, Deserializer, Serializer};

pub(super) fn serialize<S: Serializer>(confidence: &Confidence, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(confidence.label())
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Confidence, D::Error> {
    let word = String::deserialize(from)?;
    let known = Confidence::ALL.into_iter().find(|confidence| confidence.label() == word);
    let expected = &"\"measured\", \"typical\" or \"rough\"";
    known.ok_or_else(|| D::Error::invalid_value(Unexpected::Str(&word), expected))
}
