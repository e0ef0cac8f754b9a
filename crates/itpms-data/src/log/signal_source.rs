//! Rows from logs that hold signal after signal, each on its own clock: MDF4 and CAN logs, tables with a message in each row or with sensors of several rates.
//!
//! Between the reader of drive logs, which wants rows, and a feed, which has readings; the aligner makes the ones of the others.

#[cfg(any(feature = "can", feature = "mcap", feature = "mdf4"))]
use std::path::Path;

#[cfg(feature = "can")]
use super::can_feed::CanFeed;
use super::feed::Feed;
use super::header::Header;
#[cfg(feature = "mcap")]
use super::mcap_feed::McapFeed;
#[cfg(feature = "mdf4")]
use super::mdf4_feed::Mdf4Feed;
#[cfg(any(feature = "can", feature = "mcap", feature = "mdf4"))]
use super::options::LogOptions;
use super::signal_order::SignalOrder;
use super::slot::{RawRow, Slot};
use super::source::Source;
use super::table::TableSource;
use super::table_format::TableFormat;
#[cfg(any(feature = "can", feature = "mcap", feature = "mdf4"))]
use crate::error::DataError;
use crate::error::{Place, Problem};
use crate::signals::Aligner;
#[cfg(any(feature = "can", feature = "mcap", feature = "mdf4"))]
use crate::signals::Resolved;
use crate::signals::align::AlignmentReport;

#[derive(Debug)]
pub(super) struct SignalSource {
    feed: Box<dyn Feed>,
    order: SignalOrder,
    aligner: Aligner,
    header: Header,
    rows: u64,
    last_s: f64,
    is_over: bool,
}

impl SignalSource {
    #[cfg(feature = "mdf4")]
    pub(super) fn mdf4(path: &Path, options: &LogOptions) -> Result<Self, DataError> {
        without_frames(path, options)?;
        options.refuse_for_signals().map_err(|problem| DataError::new(path, problem))?;
        let (feed, resolved) = Mdf4Feed::open(path, options.map()?.as_ref())?;
        Self::resolved(path, Box::new(feed), &resolved)
    }

    #[cfg(feature = "mcap")]
    pub(super) fn mcap(path: &Path, options: &LogOptions) -> Result<Self, DataError> {
        without_frames(path, options)?;
        let (feed, resolved) = McapFeed::open(path, options.map()?.as_ref())?;
        Self::resolved(path, Box::new(feed), &resolved)
    }

    #[cfg(feature = "can")]
    pub(super) fn can(path: &Path, options: &LogOptions) -> Result<Self, DataError> {
        options.refuse_for_signals().map_err(|problem| DataError::new(path, problem))?;
        let (feed, resolved) = CanFeed::open(path, options.dbc.as_deref(), options.map()?.as_ref())?;
        Self::resolved(path, Box::new(feed), &resolved)
    }

    pub(super) fn table(feed: Box<TableSource>) -> Self {
        let Header { slots, suspicious, mapping, clock, .. } = feed.header().clone();
        let slots: Vec<Slot> = slots.into_iter().flatten().collect();
        Self::new(feed, &slots, suspicious, mapping, clock)
    }

    #[cfg(any(feature = "can", feature = "mcap", feature = "mdf4"))]
    fn resolved(path: &Path, feed: Box<dyn Feed>, resolved: &Resolved) -> Result<Self, DataError> {
        if let Some(why) = resolved.unusable() {
            return Err(DataError::new(path, Problem::Refused(why)));
        }
        Ok(Self::new(feed, &resolved.slots(), Vec::new(), resolved.assumptions(), Slot::Time.name()))
    }

    fn new(
        feed: Box<dyn Feed>,
        slots: &[Slot],
        suspicious: Vec<(String, String)>,
        mapping: Vec<String>,
        clock: String,
    ) -> Self {
        let aligner = Aligner::new(slots);
        let columns = *aligner.columns();
        Self {
            feed,
            order: SignalOrder::new(),
            aligner,
            header: Header {
                columns,
                slots: Vec::new(),
                suspicious,
                conversions: Vec::new(),
                mapping,
                clock,
            },
            rows: 0,
            last_s: f64::NEG_INFINITY,
            is_over: false,
        }
    }

    /// The repairs may say why.
    fn no_rows(&self) -> Problem {
        let repairs = self.repairs();
        let why = if repairs.is_empty() { String::new() } else { format!(" ({})", repairs.join("; ")) };
        Problem::Refused(format!("no row can be made: too few values of the mapped accelerations{why}"))
    }
}

impl Source for SignalSource {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        loop {
            while let Some(values) = self.aligner.pop_values() {
                let time_s = values[Slot::Time.index()];
                if !(time_s > self.last_s) || self.order.is_hole(&values) {
                    continue;
                }
                self.last_s = time_s;
                *row = values;
                self.rows += 1;
                return Ok(Some(Place::Row(self.rows)));
            }
            if self.is_over {
                return if self.rows == 0 { Err(self.no_rows()) } else { Ok(None) };
            }
            let order = &mut self.order;
            if !self.feed.step(&mut |fate| order.take(fate))? {
                self.is_over = true;
                self.order.finish();
            }
            while let Some(reading) = self.order.pop() {
                self.aligner.push(reading);
            }
            if self.is_over {
                self.aligner.finish();
                self.order.check()?;
            }
        }
    }

    fn progress(&self) -> f64 {
        self.feed.progress()
    }

    fn repairs(&self) -> Vec<String> {
        let aligned = self.aligner.report().map(|report| report.warnings()).unwrap_or_default();
        self.feed.repairs().into_iter().chain(self.order.warnings()).chain(aligned).collect()
    }

    fn remarks(&self) -> Vec<String> {
        let aligned = self.aligner.report().map(|report| report.remarks()).unwrap_or_default();
        self.feed.remarks().into_iter().chain(self.order.remarks()).chain(aligned).collect()
    }

    fn start_ns(&self) -> u64 {
        self.feed.start_ns()
    }

    fn alignment(&self) -> Option<AlignmentReport> {
        self.aligner.report()
    }

    fn table(&self) -> Option<&dyn TableFormat> {
        self.feed.table()
    }

    fn is_in_order(&self) -> bool {
        true
    }
}

/// A log that names its signals itself has no use for a description of frames.
#[cfg(any(feature = "mcap", feature = "mdf4"))]
fn without_frames(path: &Path, options: &LogOptions) -> Result<(), DataError> {
    if options.dbc.is_none() {
        return Ok(());
    }
    let what =
        "a DBC file says what frames of a CAN bus mean; this file has none, it names its signals itself";
    Err(DataError::new(path, what))
}
