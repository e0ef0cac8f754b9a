//! The tooth pulses of a drive, handed to its monitor beside the rows of its log: each before the first row that is not earlier.

use std::path::Path;

use itpms_data::pulses::PulseReader;

use crate::drive::Drive;
use crate::error::DriveError;

/// A table of pulses that is read along with a log; of a drive without one, nothing.
#[derive(Debug, Default)]
pub(crate) struct Pulses {
    reader: Option<PulseReader>,
    /// Time of the first row; pulses since then.
    first_s: Option<f64>,
    within: u64,
}

impl Pulses {
    pub(crate) fn open(path: Option<&Path>) -> Result<Self, DriveError> {
        let reader = path.map(PulseReader::open).transpose()?;
        Ok(Self { reader, ..Self::default() })
    }

    /// Gives the drive what passed up to the time of its next row.
    pub(crate) fn up_to(&mut self, time_s: f64, drive: &mut Drive) -> Result<(), DriveError> {
        let Some(reader) = &mut self.reader else { return Ok(()) };
        let first_s = *self.first_s.get_or_insert(time_s);
        while let Some(pulse) = reader.next_until(time_s)? {
            drive.pulse(&pulse);
            self.within += u64::from(pulse.time_s >= first_s);
        }
        Ok(())
    }

    /// The repairs, once the log is over. Errors: no pulse lay within the log.
    pub(crate) fn finish(&self, log: &Path, end_s: f64) -> Result<Vec<String>, DriveError> {
        let Some(reader) = &self.reader else { return Ok(vec![]) };
        let path = reader.path().display();
        if self.within == 0 {
            return Err(DriveError::Mismatch(format!(
                "{path}: no pulse lies between {} and {end_s} s, the times of {}; expected both by one clock",
                self.first_s.unwrap_or(f64::NAN),
                log.display()
            )));
        }
        Ok(reader.repairs().into_iter().map(|repair| format!("{path}: {repair}")).collect())
    }
}
