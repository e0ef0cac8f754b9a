//! A table, and what its rows are: samples of all sensors, messages of a bus, each of which fills its own columns and leaves the others
//! empty, or samples of sensors of several rates, of which the slower ones leave every second or third cell empty.

use std::collections::VecDeque;
use std::path::Path;

use itpms_files::input;

use super::clock::Clock;
use super::csv_source::CsvSource;
use super::feed::Feed;
use super::format::Format;
use super::header::Header;
use super::held::Held;
use super::options::LogOptions;
#[cfg(feature = "parquet")]
use super::parquet_source::ParquetSource;
use super::slot::{RawRow, SLOTS, Slot};
use super::slow_speed::SlowSpeed;
use super::source::Source;
use super::stamps::Fate;
use super::stand_in::StandIns;
use super::survey::{POSSIBLE_RATES_HZ, SURVEY_ROWS};
use super::table_format::TableFormat;
use crate::error::{DataError, Place, Problem};
use crate::signals::Reading;
use crate::signals::align::mean_period;

/// Values that a column has among the first rows before it says what the rows are.
const ENOUGH_VALUES: u32 = 20;
/// Share of the rarer column's rows in which two columns of one message are at least filled together.
const TOGETHER: f64 = 0.05;
/// Share of the rows in which a column of a rate of its own is filled at most.
const FILLED: f64 = 0.6;
/// Share of its steps, in rows, that are then within one row of the mean.
const REGULAR: f64 = 0.95;
/// A longer step, in typical ones, is a gap.
const GAP_STEPS: usize = 3;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rows {
    Samples,
    /// Messages: two of the columns are hardly ever filled in the same row.
    Messages,
    /// Samples of sensors of which some come at a lower rate than the rows.
    Rates,
}

impl Rows {
    /// The remark where samples are made of them by their times.
    fn remark(self) -> Option<&'static str> {
        match self {
            Rows::Samples => None,
            Rows::Messages => Some(
                "each row of the table is a message with some of the signals; samples were made of them by their times",
            ),
            Rows::Rates => Some(
                "some columns of the table have a value in every second row or fewer, at a rate of their own; samples were made of all by \
                 their times",
            ),
        }
    }
}

pub(super) fn open(
    format: Format,
    path: &Path,
    options: &LogOptions,
) -> Result<Box<dyn TableFormat>, DataError> {
    let fail = |problem| DataError::new(path, problem);
    let (map, rows) = (options.any_map()?, &options.rows);
    Ok(match format {
        Format::Csv => {
            let (file, about) = input::open(path).map_err(fail)?;
            Box::new(CsvSource::new(path, file, about.len(), map.as_ref(), rows)?)
        }
        #[cfg(feature = "parquet")]
        Format::Parquet => Box::new(ParquetSource::new(path, map.as_ref(), rows)?),
    })
}

#[derive(Debug)]
pub(super) struct TableSource {
    table: Box<dyn TableFormat>,
    /// The rows that were looked at, and why there are no more.
    ahead: VecDeque<Result<(RawRow, Place), Problem>>,
    without_time: u64,
    pub(super) rows: Rows,
    clock: Clock,
    stand_ins: StandIns,
    held: Held,
}

impl TableSource {
    pub(super) fn new(table: Box<dyn TableFormat>) -> Self {
        let mut source = Self {
            table,
            ahead: VecDeque::new(),
            without_time: 0,
            rows: Rows::Samples,
            clock: Clock::default(),
            stand_ins: StandIns::default(),
            held: Held::default(),
        };
        let mut row = [f64::NAN; SLOTS];
        while source.ahead.len() < SURVEY_ROWS {
            match source.read(&mut row) {
                Ok(Some(place)) => source.ahead.push_back(Ok((row, place))),
                Ok(None) => break,
                Err(problem) => {
                    source.ahead.push_back(Err(problem));
                    break;
                }
            }
        }
        source.stand_ins = StandIns::of(source.ahead.iter().flatten().map(|(row, _)| row));
        for (row, _) in source.ahead.iter_mut().flatten() {
            source.stand_ins.take_out(row);
        }
        source.held = Held::of(source.ahead.iter().flatten().map(|(row, _)| row));
        for (row, _) in source.ahead.iter_mut().flatten() {
            source.held.thin(row);
        }
        if source.is_of_messages() {
            source.rows = Rows::Messages;
        } else if Slot::all().any(|slot| slot.is_acceleration() && source.has_its_own_rate(slot)) {
            source.rows = Rows::Rates;
        }
        source
    }

    fn read(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        let place = self.table.next_row(row)?;
        if place.is_some() {
            let time_s = &mut row[Slot::Time.index()];
            *time_s = self.clock.take(*time_s);
        }
        Ok(place)
    }

    /// Whether a column has a value in some of the rows only, at even distances, and often enough for its sensor.
    fn has_its_own_rate(&self, slot: Slot) -> bool {
        let rows = self.ahead.iter().flatten().enumerate();
        let filled: Vec<(usize, f64)> = rows
            .filter(|(_, (row, _))| row[slot.index()].is_finite())
            .map(|(place, (row, _))| (place, row[Slot::Time.index()]))
            .collect();
        if filled.len() < ENOUGH_VALUES as usize {
            return false;
        }
        let mut steps: Vec<usize> = filled.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        steps.sort_unstable();
        let median = steps[steps.len() / 2];
        let usual = &steps[..steps.partition_point(|step| *step <= GAP_STEPS * median)];
        let mean = usual.iter().sum::<usize>() as f64 / usual.len() as f64;
        let even = usual.iter().filter(|step| (**step as f64 - mean).abs() < 1.0).count();
        let times: Vec<f64> = filled.iter().map(|(_, time_s)| *time_s).collect();
        mean * FILLED >= 1.0
            && even as f64 >= REGULAR * steps.len() as f64
            && POSSIBLE_RATES_HZ.contains(&(1.0 / mean_period(&times)))
    }

    /// Whether each row is a message: two of its columns are hardly ever filled in the same row.
    fn is_of_messages(&self) -> bool {
        let slots: Vec<usize> = Slot::all().filter(|slot| is_continuous(*slot)).map(Slot::index).collect();
        let mut together = [[0u32; SLOTS]; SLOTS];
        for (row, _) in self.ahead.iter().flatten() {
            let filled: Vec<usize> = slots.iter().copied().filter(|slot| row[*slot].is_finite()).collect();
            for &one in &filled {
                filled.iter().for_each(|&other| together[one][other] += 1);
            }
        }
        let with_values = || slots.iter().copied().filter(|slot| together[*slot][*slot] >= ENOUGH_VALUES);
        with_values().any(|one| {
            with_values().any(|other| {
                let rarer = together[one][one].min(together[other][other]);
                f64::from(together[one][other]) < TOGETHER * f64::from(rarer)
            })
        })
    }
}

impl Source for TableSource {
    fn header(&self) -> &Header {
        self.table.header()
    }

    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        match self.ahead.pop_front() {
            None => {
                let place = self.read(row)?;
                self.stand_ins.take_out(row);
                self.held.thin(row);
                Ok(place)
            }
            Some(looked_at) => {
                let (values, place) = looked_at?;
                *row = values;
                Ok(Some(place))
            }
        }
    }

    fn progress(&self) -> f64 {
        self.table.progress()
    }

    fn repairs(&self) -> Vec<String> {
        let without_time = match self.without_time {
            0 => None,
            1 => Some("1 row without a time was left out".to_owned()),
            n => Some(format!("{n} rows without a time were left out")),
        };
        self.table.repairs().into_iter().chain(without_time).chain(self.stand_ins.sentences()).collect()
    }

    fn remarks(&self) -> Vec<String> {
        let held = self.held.is_any_acceleration().then(|| {
            "accelerations stand for several rows each, as of a slower signal in a faster raster; each sample was taken once".to_owned()
        });
        self.clock.remarks().into_iter().chain(held).chain(self.rows.remark().map(str::to_owned)).collect()
    }

    fn slow_speed(&self) -> SlowSpeed {
        if !self.header().columns.speed {
            return SlowSpeed::default();
        }
        let of = |(row, _): &(RawRow, Place)| (row[Slot::Time.index()], row[Slot::Speed.index()]);
        SlowSpeed::of(self.ahead.iter().flatten().map(of))
    }

    fn table(&self) -> Option<&dyn TableFormat> {
        Some(&*self.table)
    }
}

impl Feed for TableSource {
    fn step(&mut self, take: &mut dyn FnMut(Fate<Reading>)) -> Result<bool, Problem> {
        let mut row = [f64::NAN; SLOTS];
        if self.next_row(&mut row)?.is_none() {
            return Ok(false);
        }
        let time_s = row[Slot::Time.index()];
        if !time_s.is_finite() {
            self.without_time += 1;
            return Ok(true);
        }
        for slot in Slot::all().filter(|slot| *slot != Slot::Time) {
            let value = row[slot.index()];
            if value.is_finite() {
                take(Fate::Kept(Reading { time_s, slot, value }));
            }
        }
        Ok(true)
    }

    fn progress(&self) -> f64 {
        Source::progress(self)
    }

    fn repairs(&self) -> Vec<String> {
        Source::repairs(self)
    }

    fn remarks(&self) -> Vec<String> {
        Source::remarks(self)
    }

    fn table(&self) -> Option<&dyn TableFormat> {
        Some(&*self.table)
    }
}

/// Whether a column has a value with every sample of its sensor.
fn is_continuous(slot: Slot) -> bool {
    slot.is_acceleration() || slot.is_wheel_speed() || slot == Slot::Speed || matches!(slot, Slot::Motion(_))
}
