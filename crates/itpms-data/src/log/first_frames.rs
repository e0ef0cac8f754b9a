//! The first frames of a CAN log, which are looked at before any is decoded, and what a choice between signals needs to know of the others.

use std::collections::{HashMap, VecDeque};
use std::path::Path;

use crate::can::{CanError, CanFrame, CanId, FrameKind, FrameReader};
use crate::dbc::{Dbc, of_candidate};
use crate::error::DataError;

/// Frames that are looked at: some seconds of a busy bus, a megabyte.
const MOST: usize = 8192;

/// The frames of a log, the first of them held back.
#[derive(Debug)]
pub(super) struct Frames {
    pub(super) first: VecDeque<CanFrame>,
    pub(super) reader: FrameReader,
    /// The log ends with `first`, or cannot be read on for this reason.
    end: Option<Result<(), CanError>>,
}

impl Frames {
    pub(super) fn open(path: &Path) -> Result<Self, DataError> {
        let mut frames =
            Self { first: VecDeque::with_capacity(MOST), reader: FrameReader::open(path)?, end: None };
        while frames.first.len() < MOST && frames.end.is_none() {
            match frames.reader.next_frame() {
                Ok(Some(frame)) => frames.first.push_back(frame),
                Ok(None) => frames.end = Some(Ok(())),
                Err(error) => frames.end = Some(Err(error)),
            }
        }
        Ok(frames)
    }

    pub(super) fn next(&mut self) -> Result<Option<CanFrame>, DataError> {
        if !self.first.is_empty() {
            return Ok(self.first.pop_front());
        }
        match &self.end {
            None => Ok(self.reader.next_frame()?),
            Some(Ok(())) => Ok(None),
            Some(Err(_)) => match self.end.replace(Ok(())) {
                Some(Err(error)) => Err(error.into()),
                _ => Ok(None),
            },
        }
    }

    /// For each candidate of the description whether it has samples in this log; those that are not `asked` for have. A log that is no file is known by
    /// its first frames alone.
    pub(super) fn have_samples(
        &self,
        path: &Path,
        dbc: &Dbc,
        asked: &[usize],
    ) -> Result<Vec<bool>, DataError> {
        let mut waiting: HashMap<CanId, Vec<(usize, usize)>> = HashMap::new();
        for candidate in asked {
            let Some((message, first)) = of_candidate(dbc, *candidate) else { continue };
            let layouts = message.layouts_of(first).map(|place| (*candidate, place));
            waiting.entry(message.id).or_default().extend(layouts);
        }
        let mut has_samples = vec![true; asked.last().map_or(0, |last| last + 1)];
        asked.iter().for_each(|candidate| has_samples[*candidate] = false);
        let mut look = |frame: &CanFrame| {
            if matches!(frame.kind, FrameKind::Remote | FrameKind::Error) {
                return false;
            }
            let Some(message) = dbc.message(frame.id) else { return false };
            let Some(places) = waiting.get_mut(&message.id) else { return false };
            for (candidate, place) in places.iter() {
                let raw = message.raw(*place, frame.data());
                has_samples[*candidate] |=
                    raw.is_some_and(|raw| !message.signals[*place].is_not_available(raw));
            }
            places.retain(|(candidate, _)| !has_samples[*candidate]);
            if places.is_empty() {
                waiting.remove(&message.id);
            }
            waiting.is_empty()
        };
        let mut all_found = asked.is_empty() || self.first.iter().any(&mut look);
        if !all_found && self.end.is_none() && path.is_file() {
            let mut again = FrameReader::open(path)?;
            // Where the log cannot be read on is reported when it is read.
            while !all_found && let Ok(Some(frame)) = again.next_frame() {
                all_found = look(&frame);
            }
        }
        Ok(has_samples)
    }
}
