//! A drive in a pipeline: its log is read ahead on a thread, what was estimated is recorded and written on another, and the calling one
//! estimates. Numbers, files and errors are those of [`estimate`](crate::estimate()).

use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use itpms_core::warning::MonitorReport;
use itpms_data::out::RadiusRow;
use itpms_data::{LogReader, LogRow};

use crate::drive::{Drive, Estimates, QuarterCars};
use crate::error::DriveError;
use crate::job::{Heights, Job};
use crate::pulses::Pulses;
use crate::run::{Done, ROWS_PER_LOOK, Record, Sink, Watch, begin, conclude};

/// Rows handed on at a time: some 0.1 MB. Looks at whoever may want to stop fall on the first of some of them.
const BATCH: usize = 64;
/// Batches that wait before the one who makes them does.
const WAITING: usize = 4;

const _: () = assert!(ROWS_PER_LOOK.is_multiple_of(BATCH as u64));

/// Rows of the log, and how it went on after them.
struct Read {
    rows: Vec<LogRow>,
    progress: f64,
    /// The log ended, or could not be read on.
    end: Option<Result<(), DriveError>>,
}

struct Step {
    row: LogRow,
    estimates: Estimates,
    /// The monitor's report, where it has changed since the row before.
    report: Option<Box<MonitorReport<f64>>>,
    radii: Option<Box<RadiusRow>>,
    cars: Option<QuarterCars>,
}

/// Estimates a drive on three threads, of which the calling one estimates.
pub fn estimate_in_pipeline(
    log: &mut LogReader,
    job: &Job<'_>,
    sink: &mut (dyn Sink + Send),
    watch: Watch<'_>,
) -> Result<Done, DriveError> {
    let (mut drive, mut record) = begin(log, job)?;
    let mut pulses = Pulses::open(job.settings.pulses.as_deref())?;
    thread::scope(|scope| {
        let (to_estimator, rows) = sync_channel(WAITING);
        let (to_record, steps) = sync_channel(WAITING);
        let (empty, emptied) = sync_channel(WAITING + 2);
        let (log, record, sink) = (&mut *log, &mut record, &mut *sink);
        scope.spawn(move || read(log, &to_estimator));
        let recording = scope.spawn(move || follow(&steps, &empty, record, sink));
        let estimated = work((&mut drive, &mut pulses), job, rows, to_record, &emptied, watch);
        // The error of an earlier row comes first.
        recording.join().unwrap_or_else(|panic| resume_unwind(panic)).and(estimated)
    })?;
    conclude(log, job, (drive, &pulses), record, sink, watch)
}

/// Reads until the log ends or its rows are not wanted.
fn read(log: &mut LogReader, to_estimator: &SyncSender<Read>) {
    loop {
        let mut batch = Read { rows: Vec::with_capacity(BATCH), progress: log.progress(), end: None };
        while batch.rows.len() < BATCH && batch.end.is_none() {
            match log.next_row() {
                Ok(Some(row)) => batch.rows.push(row),
                Ok(None) => batch.end = Some(Ok(())),
                Err(error) => batch.end = Some(Err(error.into())),
            }
        }
        let over = batch.end.is_some();
        if to_estimator.send(batch).is_err() || over {
            return;
        }
    }
}

/// Estimates row after row. Ends without an error where nothing records any more: that one has it.
fn work(
    (drive, pulses): (&mut Drive, &mut Pulses),
    job: &Job<'_>,
    rows: Receiver<Read>,
    to_record: SyncSender<Vec<Step>>,
    emptied: &Receiver<Vec<Step>>,
    watch: Watch<'_>,
) -> Result<(), DriveError> {
    let (mut count, mut reported_s) = (0u64, f64::NAN);
    for Read { rows, progress, end } in rows {
        if count.is_multiple_of(ROWS_PER_LOOK) && watch(progress).is_break() {
            return Err(DriveError::Stopped);
        }
        count += rows.len() as u64;
        // Used again, as giving back and asking for so much memory would cost more than all else here.
        let mut steps = emptied.try_recv().unwrap_or_else(|_| Vec::with_capacity(BATCH));
        for mut row in rows {
            pulses.up_to(row.time_s, drive)?;
            let estimates = drive.update(&mut row).corners;
            let report = drive.report();
            // A report that says something else has another time; none has been given before the first.
            let report = (report.time_s != reported_s).then(|| Box::new(*report));
            reported_s = report.as_ref().map_or(reported_s, |report| report.time_s);
            let radii = drive.radii().map(Box::new);
            let cars = (job.road == Heights::Smoothed).then(|| drive.quarter_cars());
            steps.push(Step { row, estimates, report, radii, cars });
        }
        if to_record.send(steps).is_err() {
            return Ok(());
        }
        if let Some(end) = end {
            return end;
        }
    }
    Ok(())
}

/// Records and writes until nothing more comes.
fn follow(
    steps: &Receiver<Vec<Step>>,
    empty: &SyncSender<Vec<Step>>,
    record: &mut Record,
    sink: &mut (dyn Sink + Send),
) -> Result<(), DriveError> {
    let mut newest = None;
    for mut batch in steps {
        for Step { row, estimates, report, radii, cars } in batch.drain(..) {
            newest = report.or(newest);
            let Some(report) = &newest else { continue };
            record.take(&row, &estimates, report, radii.as_deref(), cars.as_ref(), sink)?;
        }
        // It is not wanted where the drive is over.
        let _ = empty.try_send(batch);
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]
mod tests {
    use std::fmt::Write as _;
    use std::ops::ControlFlow;

    use itpms_core::warning::Change;
    use itpms_sim::scenario::Scenario;
    use itpms_sim::simulation::Simulation;

    use super::*;
    use itpms_data::Vehicle;
    use itpms_data::log::LogOptions;
    use itpms_data::out::EstimateRow;

    use crate::simulated::{log_row, vehicle_of};
    use crate::{LateRow, Settings, common_corners, estimate};

    /// The nail is there after 20 s, a road's height 30 s late.
    const SECONDS: f64 = 32.0;
    const RATE_HZ: f64 = 200.0;

    /// Keeps all that it is given, until a row that it refuses.
    #[derive(Default)]
    struct Kept {
        text: String,
        rows: usize,
        refuses: Option<usize>,
    }

    impl Sink for Kept {
        fn row(&mut self, row: &LogRow, known: &EstimateRow<'_>) -> Result<(), DriveError> {
            if self.refuses == Some(self.rows) {
                return Err(DriveError::Mismatch(format!("row {}", self.rows)));
            }
            self.rows += 1;
            writeln!(self.text, "{row:?} {:?} {:?}", known.estimates, known.states)
                .map_err(|_| DriveError::Stopped)
        }

        fn road(&mut self, late: &LateRow) -> Result<(), DriveError> {
            writeln!(self.text, "{late:?}").map_err(|_| DriveError::Stopped)
        }

        fn transition(&mut self, time_s: f64, change: &Change<f64>) -> Result<(), DriveError> {
            writeln!(self.text, "{time_s} {change:?}").map_err(|_| DriveError::Stopped)
        }
    }

    /// A drive with a puncture as a log; from row `broken` on its time is no number.
    fn drive(folder: &std::path::Path, broken: Option<usize>) -> (LogReader, Vehicle) {
        let scenario = Scenario {
            duration_s: SECONDS,
            rate_hz: RATE_HZ,
            ..Scenario::builtin("drive-puncture").unwrap()
        };
        let path = folder.join("drive.csv");
        let mut text = "time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2,rl_body_accel_m_s2,rl_wheel_accel_m_s2\n".to_owned();
        for (index, row) in Simulation::new(&scenario, 1).unwrap().enumerate() {
            let row = log_row(&row);
            let time = if broken.is_some_and(|broken| index >= broken) {
                "x".to_owned()
            } else {
                row.time_s.to_string()
            };
            let [fl, _, rl, _] = row.corners.map(|corner| corner.unwrap());
            writeln!(
                text,
                "{time},{},{},{},{},{}",
                row.speed_m_s,
                fl.body_accel_m_s2,
                fl.wheel_accel_m_s2,
                rl.body_accel_m_s2,
                rl.wheel_accel_m_s2
            )
            .unwrap();
        }
        std::fs::write(&path, text).unwrap();
        (LogReader::open(&path).unwrap(), vehicle_of(&scenario).unwrap())
    }

    /// The outcome of a drive: the sink's record, the figures at the end or the error.
    fn outcome(
        broken: Option<usize>,
        refuses: Option<usize>,
        stop: Option<u32>,
        pipeline: bool,
    ) -> (String, String) {
        let folder = tempfile::tempdir().unwrap();
        let (mut log, vehicle) = drive(folder.path(), broken);
        let (corners, settings) = (common_corners(&log, &vehicle).unwrap(), Settings::default());
        let reading = LogOptions::default();
        let job = Job {
            vehicle: &vehicle,
            corners: &corners,
            settings: &settings,
            reading: &reading,
            road: Heights::Smoothed,
            report: true,
        };
        let mut sink = Kept { refuses, ..Kept::default() };
        let mut looks = 0;
        let mut watch = |_share: f64| {
            looks += 1;
            if stop == Some(looks) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let done = match pipeline {
            false => estimate(&mut log, &job, &mut sink, &mut watch),
            true => estimate_in_pipeline(&mut log, &job, &mut sink, &mut watch),
        };
        let end = match done {
            Ok(Done { data, alerts, concerns, fits, learned, .. }) => {
                format!("{data:?} {alerts:?} {concerns:?} {fits:?} {learned:?} {:?}", log.repairs())
            }
            Err(error) => error.to_string().replace(&folder.path().display().to_string(), ""),
        };
        (sink.text, end)
    }

    fn the_same(broken: Option<usize>, refuses: Option<usize>, stop: Option<u32>) -> (String, String) {
        let one = outcome(broken, refuses, stop, false);
        let three = outcome(broken, refuses, stop, true);
        assert_eq!(one.1, three.1);
        // Not with the two texts in the message, which are megabytes.
        assert!(one.0 == three.0, "the sink was not given the same");
        one
    }

    #[test]
    fn a_pipeline_tells_the_same_to_the_last_bit() {
        let (received, _) = the_same(None, None, None);
        assert_eq!(received.lines().filter(|line| line.starts_with("LogRow")).count(), 6400);
        assert_eq!(received.lines().filter(|line| line.starts_with("LateRow")).count(), 6400);
        assert!(received.contains("Begun"), "the nail was not reported");
    }

    #[test]
    fn what_was_read_before_an_error_is_detected_before_it() {
        let (received, error) = the_same(Some(5003), None, None);
        // Rows that wait for earlier ones come out, too.
        assert_eq!(received.lines().filter(|line| line.starts_with("LogRow")).count(), 5003);
        assert!(error.contains("5005"), "{error}");
    }

    #[test]
    fn a_sink_that_refuses_a_row_ends_the_drive_with_its_words() {
        let (received, error) = the_same(None, Some(1000), None);
        assert_eq!(received.lines().filter(|line| line.starts_with("LogRow")).count(), 1000);
        assert_eq!(error, "row 1000");
        // That row comes before the one that cannot be read, though that one is read by then.
        let (_, error) = the_same(Some(5003), Some(5000), None);
        assert_eq!(error, "row 5000");
    }

    #[test]
    fn a_stop_ends_it_where_it_is_asked_for() {
        let (received, error) = the_same(None, None, Some(3));
        assert_eq!(received.lines().filter(|line| line.starts_with("LogRow")).count(), 2048);
        assert_eq!(error, "interrupted");
    }
}
