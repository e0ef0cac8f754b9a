//! The numbers of a message in JSON, read without making a tree of it.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::fields::{Fields, MOST_ELEMENTS};

/// Hands out the numbers of a message; false if it is no JSON.
pub(super) fn walk(bytes: &[u8], fields: &mut Fields<'_>) -> bool {
    let mut text = serde_json::Deserializer::from_slice(bytes);
    Walk(fields).deserialize(&mut text).is_ok() && text.end().is_ok()
}

struct Walk<'f, 'a>(&'f mut Fields<'a>);

impl<'de> DeserializeSeed<'de> for Walk<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, value: D) -> Result<(), D::Error> {
        value.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Walk<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a message in JSON")
    }

    fn visit_bool<E>(self, value: bool) -> Result<(), E> {
        self.0.number(f64::from(u8::from(value)));
        Ok(())
    }

    fn visit_i64<E>(self, value: i64) -> Result<(), E> {
        self.0.number(value as f64);
        Ok(())
    }

    fn visit_u64<E>(self, value: u64) -> Result<(), E> {
        self.0.number(value as f64);
        Ok(())
    }

    fn visit_f64<E>(self, value: f64) -> Result<(), E> {
        self.0.number(value);
        Ok(())
    }

    fn visit_str<E>(self, _: &str) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        for number in 0..MOST_ELEMENTS {
            let next = self.0.element(number, |fields| list.next_element_seed(Walk(fields)));
            match next {
                Some(found) => {
                    if found?.is_none() {
                        return Ok(());
                    }
                }
                None => break,
            }
        }
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(name) = map.next_key::<std::borrow::Cow<'de, str>>()? {
            match self.0.field(&name, |fields| map.next_value_seed(Walk(fields))) {
                Some(walked) => walked?,
                None => drop(map.next_value::<IgnoredAny>()?),
            }
        }
        Ok(())
    }
}
