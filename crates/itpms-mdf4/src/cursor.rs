//! The samples of one channel group, one by one.
//!
//! Made by the reader; owns its file, so that several groups can be read side by side.

use std::path::{Path, PathBuf};

use super::bytes::ByteColumn;
use super::channel::Layout;
use super::error::{Mdf4Error, Mdf4Problem, Mdf4Repair, Repairs};
use super::records::{Records, Stop};

/// A way through the samples of one group.
#[derive(Debug)]
pub struct GroupCursor {
    path: PathBuf,
    group: String,
    parts: Parts,
    /// Samples the group claims.
    claimed: Option<u64>,
    given: u64,
    repairs: Repairs,
    finished: bool,
}

#[derive(Debug)]
pub(super) struct Parts {
    pub(super) values: Records,
    /// Invalidation bytes that lie apart from the values.
    pub(super) invalid: Option<Records>,
    /// Records of another group that has the time.
    pub(super) master: Option<Records>,
    pub(super) time: Layout,
    pub(super) seconds_per_unit: f64,
    /// Bytes of values in a record of the group that has the time.
    pub(super) time_value_bytes: usize,
    pub(super) columns: Vec<Layout>,
    pub(super) bytes: Option<ByteColumn>,
    /// Bytes of values in a record; invalidation bytes follow.
    pub(super) value_bytes: usize,
}

impl GroupCursor {
    pub(super) fn new(path: &Path, group: &str, parts: Parts, claimed: Option<u64>) -> Self {
        Self {
            path: path.to_owned(),
            group: group.to_owned(),
            parts,
            claimed,
            given: 0,
            repairs: Repairs::default(),
            finished: false,
        }
    }

    /// The next sample: its time in s, and in `values` the physical values of the channels asked for, NaN where a value is invalid; the
    /// time may be NaN for the same reason. `None` at the end. An end that came too early is among the [`repairs`](GroupCursor::repairs).
    ///
    /// # Errors
    /// The system refuses to read, a compressed block is beyond the bounds or of an unknown method, or data blocks form a ring.
    pub fn next(&mut self, values: &mut [f64]) -> Result<Option<f64>, Mdf4Error> {
        if self.finished {
            return Ok(None);
        }
        match self.parts.next(values) {
            Ok(Some(time_s)) => {
                self.given += 1;
                Ok(Some(time_s))
            }
            Ok(None) => {
                self.finish();
                Ok(None)
            }
            Err(problem) => {
                self.finished = true;
                Err(Mdf4Error::new(&self.path, problem))
            }
        }
    }

    /// Bytes, of the channel whose bytes were asked for, of the sample that [`GroupCursor::next`] went to; `None` where there are none.
    ///
    /// # Errors
    /// The system refuses to read.
    pub fn bytes(&mut self) -> Result<Option<&[u8]>, Mdf4Problem> {
        let Parts { values, bytes, value_bytes, .. } = &mut self.parts;
        let record = values.current();
        let record = record.get(..*value_bytes).unwrap_or(record);
        bytes.as_mut().map_or(Ok(None), |column| column.of(record))
    }

    /// Share of the samples that was read, 0 to 1; where the file does not know how many there are, the share of the file.
    #[must_use]
    pub fn progress(&self) -> f64 {
        match self.claimed {
            _ if self.finished => 1.0,
            Some(claimed) => (self.parts.values.passed() as f64 / claimed.max(1) as f64).min(1.0),
            None => self.parts.values.depth(),
        }
    }

    /// Repairs and omissions in the data; complete once [`GroupCursor::next`] has returned `None`.
    #[must_use]
    pub fn repairs(&self) -> &[Mdf4Repair] {
        self.repairs.list()
    }

    fn finish(&mut self) {
        self.finished = true;
        let group = || self.group.clone();
        let parts = &mut self.parts;
        let apart = parts.bytes.as_mut().and_then(ByteColumn::records);
        let readers = [Some(&mut parts.values), parts.invalid.as_mut(), parts.master.as_mut(), apart];
        for damage in readers.into_iter().flatten().flat_map(Records::take_damages) {
            self.repairs.push(Mdf4Repair::Data { group: group(), damage });
        }
        let values = &parts.values;
        match values.stop {
            Some(Stop::DataEnd { partial }) if partial > 0 => {
                self.repairs.push(Mdf4Repair::PartialRecord { group: group(), bytes: partial });
            }
            Some(Stop::UnknownRecord(id)) => {
                self.repairs.push(Mdf4Repair::UnknownRecord { group: group(), id, read: self.given });
            }
            Some(Stop::Enough { more: true }) => {
                let claimed = self.claimed.unwrap_or(0);
                self.repairs.push(Mdf4Repair::MoreSamples { group: group(), claimed });
            }
            _ => {}
        }
        if values.lost > 0 {
            self.repairs.push(Mdf4Repair::SamplesLost { group: group(), lost: values.lost });
        }
        if let Some(claimed) = self.claimed.filter(|claimed| self.given < *claimed) {
            self.repairs.push(Mdf4Repair::FewerSamples { group: group(), read: self.given, claimed });
        }
    }
}

impl Parts {
    fn next(&mut self, values: &mut [f64]) -> Result<Option<f64>, Mdf4Problem> {
        loop {
            let Some(number) = self.values.advance()? else { return Ok(None) };
            // A sample without its time or its invalidation bytes is passed over, as one in a gap is.
            if let Some(invalid) = &mut self.invalid
                && !invalid.advance_to(number)?
            {
                continue;
            }
            if let Some(master) = &mut self.master
                && !master.advance_to(number)?
            {
                continue;
            }
            let record = self.values.current();
            let (record, behind) = record.split_at(self.value_bytes.min(record.len()));
            let invalid = self.invalid.as_ref().map_or(behind, Records::current);
            for (value, column) in values.iter_mut().zip(&self.columns) {
                *value = column.value(record, invalid, number);
            }
            let stamp = match &self.master {
                None => self.time.value(record, invalid, number),
                Some(master) => {
                    let record = master.current();
                    let (record, invalid) = record.split_at(self.time_value_bytes.min(record.len()));
                    self.time.value(record, invalid, number)
                }
            };
            return Ok(Some(stamp * self.seconds_per_unit));
        }
    }
}
