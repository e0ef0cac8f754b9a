//! Readings from an MCAP file: the messages of its topics in the order of the file.
//!
//! The file is read twice: what its topics hold stands in their messages alone.

use std::path::Path;

use super::feed::Feed;
use super::stamps::{Fate, Strays};
use crate::error::{DataError, Problem};
use crate::log::Slot;
use crate::mcap_in::{Messages, Topics};
use crate::signals::listing::{FormatLister as _, McapLister};
use crate::signals::{Conversion, Reading, Resolved, SignalMap, resolve_among};

#[derive(Debug)]
pub(super) struct McapFeed {
    messages: Messages,
    topics: Topics,
    /// Of each topic what is wanted, by the place of its path, and its stamps.
    wanted: Vec<(Vec<Wanted>, Strays<Reading>)>,
    notes: Vec<String>,
}

#[derive(Debug)]
struct Wanted {
    place: usize,
    slot: Slot,
    conversion: Conversion,
}

impl McapFeed {
    pub(super) fn open(path: &Path, map: Option<&SignalMap>) -> Result<(Self, Resolved), DataError> {
        let mut lister = McapLister::open(path)?;
        while lister.step().map_err(|problem| DataError::new(path, problem))? {}
        let (listing, topics, places) = lister.into_parts();
        let resolved = resolve_among(&listing.candidates(), &listing.has_samples(), &listing.unread, map)?;
        let mut wanted: Vec<(Vec<Wanted>, Strays<Reading>)> =
            topics.topics.iter().map(|_| (Vec::new(), Strays::new())).collect();
        for chosen in resolved.iter() {
            let Some((topic, place)) = places.get(chosen.candidate) else { continue };
            let (slot, conversion) = (chosen.slot, chosen.conversion);
            wanted[*topic].0.push(Wanted { place: *place, slot, conversion });
        }
        let messages = Messages::open(path)?;
        Ok((Self { messages, topics, wanted, notes: listing.notes }, resolved))
    }
}

impl Feed for McapFeed {
    fn step(&mut self, mut take: &mut dyn FnMut(Fate<Reading>)) -> Result<bool, Problem> {
        let Self { messages, topics, wanted, .. } = self;
        let mut taken = None;
        if !messages.step(|message| taken = topics.take(message))? {
            wanted.iter_mut().for_each(|(_, strays)| strays.finish(&mut take));
            return Ok(false);
        }
        let Some((topic, time_s)) = taken else { return Ok(true) };
        let Some((wanted, strays)) = wanted.get_mut(topic) else { return Ok(true) };
        for Wanted { place, slot, conversion } in wanted {
            let found = topics.found.iter().find(|(of, _)| of == place).map(|(_, value)| *value);
            // A field missing from a message is a missing sample of a sensor that is always sampled, and nothing of another.
            let value = found.unwrap_or(f64::NAN);
            if value.is_finite() || slot.is_acceleration() || slot.is_wheel_speed() {
                let value = conversion.apply(value);
                strays.take(Reading { time_s, slot: *slot, value }, &mut take);
            }
        }
        Ok(true)
    }

    fn progress(&self) -> f64 {
        self.messages.progress()
    }

    fn repairs(&self) -> Vec<String> {
        self.notes.clone()
    }
}
