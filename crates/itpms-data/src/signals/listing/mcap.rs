//! The list of an MCAP file: its topics.

use std::path::Path;

use super::statistics::{Clock, Range};
use super::{FormatLister, ListedGroup, ListedSignal, Listing};
use crate::error::{DataError, Problem};
use crate::mcap_in::{Messages, Topics};
use crate::signals::{Candidate, Unread};

/// Messages between two looks around.
const MESSAGES_PER_STEP: usize = 4096;

#[derive(Debug)]
pub(crate) struct McapLister {
    messages: Messages,
    topics: Topics,
    /// Of each topic, and of each of its paths.
    clocks: Vec<(Clock, Vec<Range>)>,
    whole: Clock,
    span_s: Option<(f64, f64)>,
}

impl McapLister {
    pub(crate) fn open(path: &Path) -> Result<Self, DataError> {
        let messages = Messages::open(path)?;
        let (topics, whole) = (Topics::default(), Clock::default());
        Ok(Self { messages, topics, clocks: Vec::new(), whole, span_s: None })
    }

    pub(crate) fn into_parts(self) -> (Listing, Topics, Vec<(usize, usize)>) {
        let Self { messages, topics, mut clocks, whole, span_s } = self;
        clocks.resize_with(topics.topics.len(), Default::default);
        let (mut groups, mut places, mut unread) = (Vec::new(), Vec::new(), Vec::new());
        let mut notes = messages.repairs();
        for (number, (topic, (clock, ranges))) in topics.topics.iter().zip(&clocks).enumerate() {
            if let Some(why) = topics.unread(topic) {
                let candidate =
                    Candidate { group: String::new(), name: topic.name.clone(), unit: String::new() };
                unread.push(Unread { candidate, why });
                continue;
            }
            if topic.not_understood > 0 {
                let count = topic.not_understood;
                notes.push(format!(
                    "{count} messages of {} are not as its schema says and were left out",
                    topic.name
                ));
            }
            let signals = (0..topic.paths.len()).map(|place| {
                places.push((number, place));
                let Candidate { name, unit, .. } = topic.signal(place);
                ListedSignal::new(name, unit, &ranges.get(place).copied().unwrap_or_default())
            });
            let signals = signals.collect();
            groups.push(ListedGroup { signals, ..ListedGroup::new(topic.name.clone(), clock) });
        }
        let listing = Listing {
            groups,
            kind: "topic",
            span_s,
            samples: whole.samples(),
            clock: None,
            notes,
            absent: Vec::new(),
            unread,
        };
        (listing, topics, places)
    }
}

impl FormatLister for McapLister {
    fn step(&mut self) -> Result<bool, Problem> {
        let Self { messages, topics, clocks, whole, span_s } = self;
        for _ in 0..MESSAGES_PER_STEP {
            let mut taken = None;
            if !messages.step(|message| taken = topics.take(message))? {
                return Ok(false);
            }
            let Some((topic, time_s)) = taken else { continue };
            clocks.resize_with(topics.topics.len().max(clocks.len()), Default::default);
            let Some((clock, ranges)) = clocks.get_mut(topic) else { continue };
            clock.tick(time_s);
            whole.tick(time_s);
            let (first_s, last_s) = span_s.unwrap_or((time_s, time_s));
            *span_s = Some((first_s.min(time_s), last_s.max(time_s)));
            for (place, value) in &topics.found {
                ranges.resize(ranges.len().max(place + 1), Range::default());
                ranges[*place].add(*value);
            }
        }
        Ok(true)
    }

    fn progress(&self) -> f64 {
        self.messages.progress()
    }

    fn finish(self: Box<Self>) -> Listing {
        self.into_parts().0
    }
}
