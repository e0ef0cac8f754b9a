//! From inputs to estimates: surveys the first rows, estimates each, and makes snapshots and transitions of it.
//!
//! Owned by the estimating thread. Reads no clock but the wall's, for stamps and latency: what is estimated depends on the
//! rows alone. Knows nothing of threads; where snapshots go is its caller's business.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use itpms_core::model::Corner;
use itpms_core::warning::Change;
use itpms_data::log::{SURVEY_ROWS, Survey};
use itpms_data::out::{RateGate, alert_object};
use itpms_data::pulses::Pulse;
use itpms_data::signals::doubt_of;
use itpms_data::{LogRow, Vehicle};

use crate::describe;
use crate::drive::{Clock, DriveOptions, LiveDrive, Reported};
use crate::error::LiveError;
use crate::input::{Note, NoteSink, SourceName};
use crate::latency::LatencyWindow;
use crate::past::{Past, Place};
use crate::snapshot::{Snapshot, Source, SourceState, Transition};
use crate::speed::{SpeedDoubt, SpeedDoubts};
use crate::state::SavedDrive;
use crate::units::UnitWatch;

/// Seconds of rows from which the rate is measured where the source does not know it.
const SURVEY_S: f64 = 1.5;
/// Share of that time that has to hold rows at the rate measured: a bus that wakes up may tell a few and pause.
const FULL_SHARE: f64 = 0.5;
/// Share by which the rate of a saved drive may differ from that of the rows.
const SAME_RATE: f64 = 0.01;
/// Tooth pulses that wait for their row, at most: a minute of four wheels on a motorway. Of more the oldest are lost.
const MOST_PULSES: usize = 1 << 18;

/// Outputs of the estimating thread.
#[derive(Debug, Clone)]
pub enum Published {
    Estimate(Arc<Snapshot>),
    /// An alert began or ended.
    Warning(Arc<Transition>),
}

pub struct Engine {
    vehicle: Vehicle,
    options: DriveOptions,
    notes: NoteSink,
    stage: Stage,
    saved: Option<SavedDrive>,
    source: Source,
    /// Tooth pulses until the first row that is not earlier.
    pulses: VecDeque<Pulse>,
    latency: LatencyWindow,
    speed: SpeedDoubts,
    snapshots: u64,
    transitions: u64,
    past: Past,
    /// Wall clock when the newest row came; NaN before the first one.
    newest_unix_s: f64,
    units: UnitWatch,
    bursts_reported: bool,
    /// Doubts about the source's signals.
    doubts: Vec<String>,
    /// Corners of the vehicle that do not come, and why.
    not_estimated: BTreeMap<&'static str, String>,
}

enum Stage {
    /// The first rows wait until their rate is known.
    Surveying(Vec<LogRow>),
    Running(Box<LiveDrive>),
}

impl Engine {
    /// An engine that has seen nothing yet; with a drive that was saved, it goes on where that stopped, if the rows fit it.
    pub fn new(
        vehicle: Vehicle,
        options: DriveOptions,
        source: SourceName,
        saved: Option<SavedDrive>,
        notes: NoteSink,
    ) -> Self {
        let source = Source { name: source.name, kind: source.kind, rate_hz: f64::NAN, ..Source::default() };
        let stage = Stage::Surveying(Vec::new());
        let latency = LatencyWindow::default();
        let units = UnitWatch::new(options.units);
        Self {
            vehicle,
            options,
            notes,
            stage,
            saved,
            source,
            pulses: VecDeque::new(),
            latency,
            speed: SpeedDoubts::default(),
            snapshots: 0,
            transitions: 0,
            past: Past::new(),
            newest_unix_s: unix_s(),
            units,
            bursts_reported: false,
            doubts: Vec::new(),
            not_estimated: BTreeMap::new(),
        }
    }

    /// The same, knowing what was doubtful about the source's signals.
    pub fn knowing(self, doubts: Vec<String>) -> Self {
        Self { doubts, ..self }
    }

    /// The counters that are shown with every snapshot; the source's part of the work keeps them up to date.
    pub fn source_mut(&mut self) -> &mut Source {
        &mut self.source
    }

    /// Says what the rows will be, where the source knows it.
    /// Errors: the vehicle has none of the corners, or the estimator refuses its parameters.
    pub fn open(
        &mut self,
        sample_rate_hz: f64,
        corners: &[Corner],
        wheel_speeds: bool,
    ) -> Result<(), LiveError> {
        if let Stage::Surveying(rows) = &self.stage
            && rows.is_empty()
        {
            let clock = self.clock(sample_rate_hz, corners, wheel_speeds)?;
            self.stage = Stage::Running(Box::new(self.begin(clock)?));
        }
        Ok(())
    }

    /// Takes a tooth pulse, in the order of time.
    pub fn pulse(&mut self, pulse: Pulse) {
        if self.pulses.len() == MOST_PULSES {
            self.pulses.pop_front();
        }
        self.pulses.push_back(pulse);
    }

    /// Takes a row and when it came, where that counts for the latency; what there is to tell goes to `publish`.
    pub fn take(
        &mut self,
        row: &LogRow,
        arrived: Option<Instant>,
        publish: &mut impl FnMut(Published),
    ) -> Result<(), LiveError> {
        self.source.state = SourceState::Live;
        match &mut self.stage {
            Stage::Surveying(rows) => {
                rows.push(*row);
                let span_s = rows.first().map_or(0.0, |first| row.time_s - first.time_s);
                if !(span_s >= SURVEY_S) && rows.len() < SURVEY_ROWS {
                    return Ok(());
                }
                self.end_survey(false, publish)
            }
            Stage::Running(_) => self.estimate(row, arrived, publish),
        }
    }

    /// There is nothing more: rows that wait for the end of the survey are estimated with what there is.
    pub fn finish(&mut self, publish: &mut impl FnMut(Published)) -> Result<(), LiveError> {
        if let Stage::Surveying(rows) = &self.stage
            && rows.len() > 1
        {
            self.end_survey(true, publish)?;
        }
        if let Stage::Running(drive) = &mut self.stage {
            drive.finish();
        }
        if let Some(word) = self.units.finish() {
            self.warn(&word);
        }
        Ok(())
    }

    fn warn(&self, text: &str) {
        (self.notes)(Note::Warning(format!("{}: {text}", self.source.name)));
    }

    /// `ended`: no more rows will come.
    fn end_survey(&mut self, ended: bool, publish: &mut impl FnMut(Published)) -> Result<(), LiveError> {
        let Stage::Surveying(rows) = &mut self.stage else { return Ok(()) };
        let mut rows = std::mem::take(rows);
        let corners = rows.last().map_or([None; 4], |row| row.corners);
        let corners: Vec<Corner> =
            Corner::ALL.into_iter().filter(|corner| corners[corner.index()].is_some()).collect();
        let roll = |row: &LogRow| {
            let all = |speeds: &[f64; 4]| speeds.iter().all(|speed| speed.is_finite());
            all(&row.motion.wheel_speed_m_s) || all(&row.motion.wheel_speed_rad_s)
        };
        let wheel_speeds = rows.iter().any(roll);
        let rate_hz = match Survey::of(&rows) {
            Ok(survey) => survey.estimator_rate_hz(),
            Err(problem) => {
                // Perhaps the bus was just waking up: the newer half may be better.
                self.warn(&format!("{problem}; looking on"));
                self.stage = Stage::Surveying(rows.split_off(rows.len().div_ceil(2)));
                return Ok(());
            }
        };
        let span_s = rows.first().zip(rows.last()).map_or(0.0, |(first, last)| last.time_s - first.time_s);
        if !ended && (rows.len() as f64) < FULL_SHARE * span_s * rate_hz {
            if !std::mem::replace(&mut self.bursts_reported, true) {
                let count = rows.len();
                self.warn(&format!(
                    "{count} rows in {span_s:.1} s, though {:.1} ms apart: bursts; looking on",
                    1e3 / rate_hz
                ));
            }
            self.stage = Stage::Surveying(rows.split_off(rows.len().div_ceil(2)));
            return Ok(());
        }
        let clock = self.clock(rate_hz, &corners, wheel_speeds)?;
        self.stage = Stage::Running(Box::new(self.begin(clock)?));
        // How long they waited says nothing of later rows.
        rows.iter().try_for_each(|row| self.estimate(row, None, publish))
    }

    /// The source's corners that the vehicle has.
    fn clock(
        &mut self,
        sample_rate_hz: f64,
        corners: &[Corner],
        wheel_speeds: bool,
    ) -> Result<Clock, LiveError> {
        let described = |corner: &Corner| self.vehicle.corner(*corner).is_some();
        let common: Vec<Corner> = corners.iter().copied().filter(described).collect();
        let usable = self.vehicle.wheel_speed_config();
        if let Some(key) = usable.err().filter(|_| wheel_speeds) {
            self.warn(&format!(
                "the wheel speeds are not used: the vehicle {:?} has no {key}",
                self.vehicle.name
            ));
        }
        let wheel_speeds = wheel_speeds && usable.is_ok();
        if common.is_empty() && !wheel_speeds {
            let all: Vec<Corner> = Corner::ALL.into_iter().filter(described).collect();
            return Err(LiveError::NoCorner {
                source_name: self.source.name.clone(),
                found: labels(corners),
                vehicle: self.vehicle.name.clone(),
                described: match all[..] {
                    [] => "none: it is for wheel speeds alone".to_owned(),
                    _ => labels(&all),
                },
            });
        }
        for corner in corners.iter().filter(|corner| !described(corner)) {
            let label = corner.label();
            let name = &self.source.name;
            (self.notes)(Note::Warning(format!(
                "{name}: corner {label} is not in the vehicle file and is not estimated"
            )));
        }
        for corner in Corner::ALL.iter().filter(|corner| described(corner) && !corners.contains(corner)) {
            let log = if self.source.kind == "replay" { "in the log" } else { "among the signals" };
            let doubt =
                doubt_of(*corner, &self.doubts).map_or_else(String::new, |doubt| format!(": {doubt}"));
            let why = format!("not {log}{doubt}");
            self.warn(&format!("corner {} of the vehicle file is {why}", corner.label()));
            self.not_estimated.insert(corner.label(), why);
        }
        Ok(Clock { sample_rate_hz, corners: common, wheel_speeds })
    }

    /// The saved drive if the rows fit it, else a new one, and that is reported.
    fn begin(&mut self, clock: Clock) -> Result<LiveDrive, LiveError> {
        self.source.rate_hz = clock.sample_rate_hz;
        let Some(saved) = self.saved.take() else {
            return LiveDrive::new(&self.vehicle, clock, &self.options);
        };
        let rate_hz = saved.sample_rate_hz;
        let same_rate = (clock.sample_rate_hz / rate_hz - 1.0).abs() <= SAME_RATE;
        if saved.corners == clock.corners && saved.has_wheel_speeds() == clock.wheel_speeds && same_rate {
            let drive = saved.resume(&self.vehicle, &self.options)?;
            let time_s = drive.time_s();
            if self.options.settings.pulses.is_some() && !saved.has_pulses() {
                self.warn("the saved state has nothing of tooth pulses, and goes on without them");
            }
            (self.notes)(Note::Remark(format!("goes on from the saved state, at {time_s:.1} s")));
            self.source.rate_hz = rate_hz;
            return Ok(drive);
        }
        (self.notes)(Note::Warning(format!(
            "the saved state is of {} at {rate_hz} Hz, found {} at {} Hz: begins afresh",
            labels(&saved.corners),
            labels(&clock.corners),
            clock.sample_rate_hz
        )));
        LiveDrive::new(&self.vehicle, clock, &self.options)
    }

    fn estimate(
        &mut self,
        row: &LogRow,
        arrived: Option<Instant>,
        publish: &mut impl FnMut(Published),
    ) -> Result<(), LiveError> {
        let Stage::Running(drive) = &mut self.stage else { return Ok(()) };
        match self.past.place(drive.time_s(), row.time_s) {
            Place::Next => {}
            Place::Late => return Ok(()),
            Place::SetBack(back_s) => {
                drive.gate = RateGate::new(self.options.settings.rate_hz);
                (self.notes)(Note::Warning(format!(
                    "{}: time went back by {back_s:.1} s to {:.1} s: the clock was set, what is known of the car stays",
                    self.source.name, row.time_s
                )));
            }
        }
        if let Some(word) = self.units.take(row) {
            (self.notes)(Note::Warning(format!("{}: {word}", self.source.name)));
        }
        while let Some(pulse) = self.pulses.front().filter(|pulse| pulse.time_s <= row.time_s) {
            drive.pulse(pulse);
            self.pulses.pop_front();
        }
        let transitions = &mut self.transitions;
        let due = drive.update(row, |time_s, reported| {
            publish(Published::Warning(Arc::new(transition(*transitions, time_s, reported))));
            *transitions += 1;
        });
        if drive.clock.has_side()
            && let Some(word) = self.speed.take(row.time_s, drive.speed_doubt())
        {
            (self.notes)(Note::Warning(format!("{}: {word}", self.source.name)));
        }
        self.source.rows += 1;
        self.newest_unix_s = unix_s();
        if let Some(arrived) = arrived {
            let now = Instant::now();
            self.latency.add(now.saturating_duration_since(arrived), now);
        }
        if due {
            publish(Published::Estimate(self.snapshot()));
        }
        Ok(())
    }

    pub fn snapshot(&mut self) -> Arc<Snapshot> {
        let latency_ms = self.latency.summary(Instant::now());
        let seq = self.snapshots;
        self.snapshots += 1;
        let mut snapshot = Snapshot {
            seq,
            time_s: f64::NAN,
            unix_s: self.newest_unix_s,
            source: self.source.clone(),
            vehicle: self.vehicle.name.clone(),
            speed_m_s: f64::NAN,
            distance_m: f64::NAN,
            latency_ms,
            not_estimated: self.not_estimated.clone(),
            ..Snapshot::default()
        };
        if let Stage::Running(drive) = &self.stage {
            snapshot.time_s = drive.time_s();
            snapshot.speed_m_s = drive.progress.odometer.speed_m_s();
            snapshot.speed_doubt = drive.speed_doubt().map(SpeedDoubt::label);
            snapshot.distance_m = drive.progress.odometer.distance_m();
            snapshot.wheels = describe::wheels(drive, &self.vehicle);
            snapshot.tracks = describe::tracks(drive);
            snapshot.alerts = describe::alerts(drive);
            snapshot.beside = Arc::clone(&drive.beside.shown);
            snapshot.sensors = describe::sensors(drive);
            // A wheel of which nothing is known may be the one that is low.
            snapshot.all_fine = self.source.state == SourceState::Live
                && drive.report().is_all_fine()
                && !drive.beside.sees_a_leak()
                && !drive.clock.corners.is_empty()
                && self.not_estimated.is_empty();
        }
        Arc::new(snapshot)
    }

    pub fn drive(&self) -> Option<&LiveDrive> {
        match &self.stage {
            Stage::Surveying(_) => None,
            Stage::Running(drive) => Some(drive),
        }
    }

    /// The bytes of the state file, once there is something to save.
    pub fn saved(&self) -> Option<Vec<u8>> {
        let drive = self.drive().filter(|drive| drive.latest.is_some())?;
        SavedDrive::of(drive, &self.options).to_bytes(&self.vehicle)
    }

    /// Rows left out because their time was not after the last one's.
    pub fn out_of_order(&self) -> u64 {
        self.past.left_out
    }
}

fn transition(seq: u64, time_s: f64, reported: Reported) -> Transition {
    let (event, alert) = match reported {
        Reported::Change(Change::Begun(alert)) => ("begun", alert_object(&alert)),
        Reported::Change(Change::Ended(alert)) => ("ended", alert_object(&alert)),
        Reported::BesideBegun(alert) => ("begun", alert),
        Reported::BesideEnded(alert) => ("ended", alert),
    };
    Transition { seq, time_s, unix_s: unix_s(), event, alert }
}

/// A wall clock before 1970 gives a wrong stamp, not a wrong estimate.
pub(crate) fn unix_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
}

fn labels(corners: &[Corner]) -> String {
    match corners {
        [] => "none".to_owned(),
        corners => corners.iter().map(|corner| corner.label()).collect::<Vec<_>>().join(" "),
    }
}
