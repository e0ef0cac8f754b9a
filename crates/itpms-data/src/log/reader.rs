//! The reader: opens a log, looks ahead, judges it, then hands out row after row.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use itpms_core::model::Corner;

use super::memory_source::{MemorySource, Pieces};
use super::mixed::Mixed;
use super::options::LogOptions;
use super::order::{Stage, TimeOrder};
use super::regular::Regular;
use super::repair::RepairReport;
use super::row::{LogColumns, LogRow};
use super::slot::{Field, SLOTS, Slot};
use super::slow_speed::SlowSpeed;
use super::source::Source;
use super::survey::{GAP_PERIODS, SURVEY_ROWS, Survey};
use super::units::{self, UnitCheck};
use super::{left_out, open, twins};
use crate::error::{DataError, Problem};
use crate::signals::align::AlignmentReport;

/// A drive log, row by row.
///
/// ```no_run
/// # fn main() -> Result<(), itpms_data::DataError> {
/// let mut log = itpms_data::LogReader::open(std::path::Path::new("drive.csv"))?;
/// while let Some(row) = log.next_row()? {
///     println!("{} {}", row.time_s, row.speed_m_s);
/// }
/// for warning in log.repairs().warnings() {
///     eprintln!("{warning}");
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct LogReader {
    path: PathBuf,
    source: Box<dyn Source>,
    order: TimeOrder,
    slow_speed: SlowSpeed,
    /// Rows in order whose speed is not settled.
    ordered: VecDeque<LogRow>,
    ahead: VecDeque<LogRow>,
    accelerations: Vec<Slot>,
    mixed: Mixed,
    /// Rows ahead that were found to be of one recording.
    judged: usize,
    exhausted: bool,
    /// Why the source could not be read on.
    failed: Option<Problem>,
    survey: Survey,
    report: RepairReport,
    regular: Regular,
    last_time_s: Option<f64>,
    seen: [bool; SLOTS],
    /// Times of the first two rows as they are in the file.
    first_times_s: [f64; 2],
}

impl LogReader {
    /// Opens a drive log, CSV or Parquet by extension, and looks at its first [`SURVEY_ROWS`] rows. Errors: the file cannot be read, a
    /// column is missing or twice there, or the first rows show that the log is useless: see [`Problem`].
    pub fn open(path: &Path) -> Result<Self, DataError> {
        Self::open_with(path, &LogOptions::default())
    }

    /// The same with what else there is to know.
    pub fn open_with(path: &Path, options: &LogOptions) -> Result<Self, DataError> {
        let source = open::open(path, options)?;
        Self::of(path, source, options.units)
    }

    /// A drive that another program has read already, in pieces of which one is held at a time: columns of these names, NaN where a
    /// value is missing, `rows` in all where that is known, in messages called `name`. It is judged and repaired as a file is.
    pub fn from_pieces(
        name: &Path,
        names: &[String],
        rows: Option<usize>,
        pieces: Pieces,
        options: &LogOptions,
    ) -> Result<Self, DataError> {
        let source =
            MemorySource::new(name, names, rows, pieces, options.any_map()?.as_ref(), &options.rows)?;
        Self::of(name, open::of_table(Box::new(source)), options.units)
    }

    fn of(path: &Path, source: Box<dyn Source>, units: UnitCheck) -> Result<Self, DataError> {
        let report = RepairReport {
            misspelled_columns: source.header().suspicious.clone(),
            ..RepairReport::default()
        };
        let mut reader = Self {
            path: path.to_owned(),
            slow_speed: source.slow_speed(),
            accelerations: source.header().columns.slots().filter(|slot| slot.is_acceleration()).collect(),
            mixed: Mixed::new(&source.header().columns),
            judged: 0,
            source,
            order: TimeOrder::new(),
            ordered: VecDeque::new(),
            ahead: VecDeque::with_capacity(SURVEY_ROWS),
            exhausted: false,
            failed: None,
            survey: Survey { rows: 0, sample_period_s: 0.0, jitter_s: 0.0, sample_rate_hz: 0.0 },
            report,
            regular: Regular::new(f64::NAN),
            last_time_s: None,
            seen: [false; SLOTS],
            first_times_s: [f64::NAN; 2],
        };
        reader.look_ahead(units).map_err(|problem| DataError::new(path, problem))?;
        Ok(reader)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// When time 0 was, in ns since 1970, where the file says so beside its times; else 0: then they may count from 1970 themselves.
    pub fn start_ns(&self) -> u64 {
        self.source.start_ns()
    }

    pub fn columns(&self) -> &LogColumns {
        &self.source.header().columns
    }

    /// Evidence of the first rows about the clock.
    pub fn survey(&self) -> &Survey {
        &self.survey
    }

    /// Time in s of the last row that was given; `None` before the first.
    pub fn last_time_s(&self) -> Option<f64> {
        self.last_time_s
    }

    pub fn repairs(&self) -> &RepairReport {
        &self.report
    }

    /// Which signal was taken for which column where neither its name nor a map says so, and what was doubtful about it; empty
    /// for tables without a map.
    pub fn mapping(&self) -> &[String] {
        &self.source.header().mapping
    }

    /// How the signals of an MDF4 or CAN log were put into rows; `None` for tables.
    pub fn alignment(&self) -> Option<AlignmentReport> {
        self.source.alignment()
    }

    /// How the signals of an MDF4 or CAN log came into order and into rows, a sentence each; nothing for tables.
    pub fn remarks(&self) -> Vec<String> {
        let speed = self.slow_speed.rate_hz().map(|rate_hz| {
            format!(
                "speed_m_s comes {} times a second beside {:.0} rows; between, it is on the straight line",
                (rate_hz * 1e3).round() / 1e3,
                self.survey.sample_rate_hz
            )
        });
        self.source.remarks().into_iter().chain(speed).collect()
    }

    /// Share of the log that has been read, 0 to 1; of pieces of unknown number of rows, 0.
    pub fn progress(&self) -> f64 {
        self.source.progress()
    }

    /// The next row, `None` after the last.
    /// Errors: the file cannot be read on, a cell is no number, or so many rows are out of order that what is left would not be this drive.
    pub fn next_row(&mut self) -> Result<Option<LogRow>, DataError> {
        while self.ahead.is_empty() && !self.exhausted {
            self.pull()
                .and_then(|()| self.order.check(Stage::Reading))
                .map_err(|problem| DataError::new(&self.path, self.with_way_out(problem)))?;
        }
        let Some(row) = self.ahead.pop_front() else {
            let failed = self.failed.take().map(|problem| DataError::new(&self.path, problem));
            return failed.map_or(Ok(None), Err);
        };
        if self.judged > 0 {
            self.judged -= 1;
        } else {
            self.mixed
                .take(&row)
                .map_err(|problem| DataError::new(&self.path, self.with_way_out(problem)))?;
        }
        self.report.missing_speeds += u64::from(self.source.header().columns.speed && row.speed_m_s.is_nan());
        if let Some(last_s) = self.last_time_s {
            let step_s = row.time_s - last_s;
            self.regular.take(last_s, step_s).map_err(|problem| DataError::new(&self.path, problem))?;
            if step_s > GAP_PERIODS * self.survey.sample_period_s {
                self.report.gaps += 1;
                if self.report.longest_gap.is_none_or(|(longest_s, _)| step_s > longest_s) {
                    self.report.longest_gap = Some((step_s, last_s));
                }
            }
        }
        self.last_time_s = Some(row.time_s);
        self.report.rows_kept += 1;
        Ok(Some(row))
    }

    fn look_ahead(&mut self, units: UnitCheck) -> Result<(), Problem> {
        let mut read = Ok(());
        while read.is_ok() && self.ahead.len() < SURVEY_ROWS && !self.exhausted {
            read = self.pull();
        }
        if read.is_ok() && self.report.rows_read == 0 {
            return Err(Problem::HeaderOnly);
        }
        if read.is_ok() && !self.exhausted {
            read = self.order.check(Stage::Complete);
        }
        // Two recordings make a clock look as odd as it does.
        self.are_of_one_recording().map_err(|problem| self.with_way_out(problem))?;
        read.map_err(|problem| self.with_way_out(problem))?;
        self.survey = Survey::of(&self.ahead).map_err(|problem| self.of_the_clock(problem))?;
        self.regular = Regular::new(1.0 / self.survey.sample_rate_hz);
        self.report.same_columns = twins::of(&self.ahead, &self.source.header().columns);
        match units {
            UnitCheck::Suspicious => units::check(self.ahead.iter()),
            UnitCheck::Trusting => Ok(()),
        }
    }

    fn are_of_one_recording(&mut self) -> Result<(), Problem> {
        self.judged = self.ahead.len();
        let mut end_s = f64::NAN;
        for row in &self.ahead {
            self.mixed.take(row)?;
            end_s = row.time_s;
        }
        self.mixed.judge(end_s)
    }

    /// Of two recordings, with what tells them apart; of rows that come twice, with the parts that have them.
    fn with_way_out(&self, mut problem: Problem) -> Problem {
        if let Problem::TimeRepeats { repeated, rows, .. } = problem
            && let Some((one, other)) = self.source.table().and_then(|table| table.overlap())
        {
            return Problem::Refused(format!(
                "{repeated} of the {rows} rows read have the time of another one, and the parts {one} and {other} have rows of the same time, \
                 expected each row once: move one of the two elsewhere"
            ));
        }
        if let Problem::TwoRecordings { way_out, .. } = &mut problem
            && let Some(found) = self.source.one_of_two(&self.path)
        {
            *way_out = found;
        }
        problem
    }

    /// A problem of the period, by the name of the file's clock. Where steps are so long that no row but the first one was kept, the
    /// period is the problem.
    fn of_the_clock(&self, problem: Problem) -> Problem {
        let clock = self.source.header().clock.clone();
        let [first_s, second_s] = self.first_times_s;
        match problem {
            Problem::SamplePeriod { period_s, rate_hz, .. } => {
                Problem::SamplePeriod { clock, period_s, rate_hz }
            }
            Problem::TooFewSamples(_) if second_s > first_s => {
                let period_s = second_s - first_s;
                Problem::SamplePeriod { clock, period_s, rate_hz: 1.0 / period_s }
            }
            other => other,
        }
    }

    /// Reads one row of the file; none, one or (at the end) one more row comes out of it.
    fn pull(&mut self) -> Result<(), Problem> {
        let mut raw = [f64::NAN; SLOTS];
        let place = match self.source.next_row(&mut raw) {
            Ok(Some(place)) => place,
            Ok(None) => return self.close(),
            // Rows read earlier are returned earlier.
            Err(problem) if self.report.rows_read >= SURVEY_ROWS as u64 => {
                (self.exhausted, self.failed) = (true, Some(problem));
                self.finish_order();
                return Ok(());
            }
            Err(problem) => return Err(problem),
        };
        for (seen, value) in self.seen.iter_mut().zip(&raw) {
            *seen |= value.is_finite();
        }
        let time_s = raw[Slot::Time.index()];
        if let Some(first) = self.first_times_s.iter_mut().find(|first| first.is_nan()) {
            *first = time_s;
        }
        let columns = self.source.header().columns;
        let missing = |slot: &&Slot| raw[slot.index()].is_nan();
        self.report.missing_accelerations += self.accelerations.iter().filter(missing).count() as u64;
        let row = LogRow::from_values(&raw, &columns);
        if self.source.is_in_order() {
            self.order.rows += 1;
            self.ahead.push_back(row);
        } else if self.slow_speed.is_of_use() {
            self.order.push(row, place, &mut self.ordered);
            self.settle_speeds();
        } else {
            self.order.push(row, place, &mut self.ahead);
        }
        self.copy_counts();
        Ok(())
    }

    fn settle_speeds(&mut self) {
        let Self { ordered, slow_speed, ahead, .. } = self;
        ordered.drain(..).for_each(|row| slow_speed.push(row, ahead));
    }

    /// There are no more rows.
    fn finish_order(&mut self) {
        self.order.finish(&mut self.ordered);
        self.settle_speeds();
        self.slow_speed.finish(&mut self.ahead);
    }

    /// The end of the file: the last row, the last checks.
    fn close(&mut self) -> Result<(), Problem> {
        self.exhausted = true;
        self.finish_order();
        self.order.check(Stage::Complete)?;
        self.report.cut_off_lines = u64::from(self.source.table().is_some_and(|table| table.cut_off()));
        self.report.format = self.source.repairs();
        self.report.format.extend(left_out::of_folder(&self.path));
        self.copy_counts();
        let columns = self.source.header().columns;
        let dead = |slot: &Slot| !self.seen[slot.index()];
        let alive = |corner: &Corner| {
            !dead(&Slot::Corner(*corner, Field::BodyAccel))
                && !dead(&Slot::Corner(*corner, Field::WheelAccel))
        };
        self.report.dead_columns = needed(&columns).filter(dead).map(Slot::name).collect();
        let roll = |field| Corner::ALL.iter().all(|corner| !dead(&Slot::Corner(*corner, field)));
        let useful =
            columns.present().iter().any(alive) || roll(Field::WheelSpeed) || roll(Field::WheelRotation);
        match self.report.dead_columns.first() {
            Some(column) if self.report.rows_read > 0 && !useful => {
                let rows = self.report.rows_read;
                Err(format!(
                    "column {column} has no value in any of {rows} rows, and no other corner is complete"
                )
                .into())
            }
            _ => Ok(()),
        }
    }

    fn copy_counts(&mut self) {
        self.report.rows_read = self.order.rows;
        self.report.without_time = self.order.without_time;
        self.report.out_of_order = self.order.backwards;
        self.report.put_in_order = self.order.moved();
        self.report.duplicate_times = self.order.repeated;
        self.report.spread = self.order.coarse().spread;
    }
}

/// The columns without a value in which there is nothing to estimate.
fn needed(columns: &LogColumns) -> impl Iterator<Item = Slot> {
    columns.slots().filter(|slot| slot.is_acceleration() || slot.is_wheel_speed())
}

/// The rows, for loops and adapters.
impl Iterator for LogReader {
    type Item = Result<LogRow, DataError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_row().transpose()
    }
}
