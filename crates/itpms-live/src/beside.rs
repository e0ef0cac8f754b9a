//! Findings beside the pressures while a drive goes on: dampers and load, the tires' own sensors, what turns with the wheels.
//!
//! Owned by the drive. Rows are listened to as they come; what they show is worked out once a minute, on a thread of its own: it takes some
//! tenths of a second, and the estimate waits for none. A drive ends with a long stop, after which the car may carry something else.

use std::sync::Arc;
use std::thread::{self, JoinHandle};

use itpms_analysis::beside::{Beside, Findings, Identified};
use itpms_data::{LogRow, Vehicle};
use itpms_drive::Drive;
use serde_json::{Map, Value, json};

use crate::clock::Clock;
use crate::options::DriveOptions;
use crate::reported::Reported;

/// Seconds between two looks at what the rows have shown.
const LOOK_S: f64 = 60.0;
/// Seconds of standing, or of silence, that end a drive, and the speed in m/s below which a car stands.
const PARKED_S: f64 = 600.0;
const STANDING_M_S: f64 = 1.0;

#[derive(Debug)]
pub(crate) struct BesideWatch {
    /// One that has seen nothing, for the next drive.
    blank: Beside,
    watch: Beside,
    working: Option<JoinHandle<Findings>>,
    looked_s: f64,
    moved_s: f64,
    pub(crate) shown: Arc<Map<String, Value>>,
    /// The findings that stand, as alerts.
    pub(crate) standing: Vec<Map<String, Value>>,
}

impl BesideWatch {
    pub(crate) fn new(vehicle: &Vehicle, clock: &Clock, options: &DriveOptions) -> Self {
        let step_s = clock.sample_rate_hz.recip();
        let healthy = options.reference.as_ref().and_then(|stored| stored.suspension);
        let blank = Beside::new(vehicle, &clock.corners, step_s, healthy);
        let shown = shown(&blank.conclude(&Identified::default()));
        let (watch, looked_s, moved_s) = (blank.clone(), f64::NAN, f64::NAN);
        Self { blank, watch, working: None, looked_s, moved_s, shown, standing: Vec::new() }
    }

    /// Takes a row after which the car was estimated; hands on what is newly found, and what is over.
    pub(crate) fn take(
        &mut self,
        row: &LogRow,
        speed_m_s: f64,
        estimates: &[Option<itpms_core::CornerEstimate<f64>>; 4],
        drive: &Drive,
        reported: &mut impl FnMut(f64, Reported),
    ) {
        // A speed that is not known is none of a car that stands.
        if !(speed_m_s < STANDING_M_S) {
            if row.time_s - self.moved_s > PARKED_S {
                self.begin_again(row.time_s, reported);
            }
            self.moved_s = row.time_s;
        }
        let standing = &mut self.standing;
        self.watch.take(row, estimates, drive.radii().as_ref(), |event| {
            let alert = alert(event, row.time_s);
            // A wheel's sensor has one verdict: the newest.
            if let Some(place) = standing.iter().position(|before| is_of_the_same(before, &alert)) {
                reported(row.time_s, Reported::BesideEnded(standing.remove(place)));
            }
            standing.push(alert.clone());
            reported(row.time_s, Reported::BesideBegun(alert));
        });
        if self.working.as_ref().is_some_and(JoinHandle::is_finished) {
            self.take_over();
        }
        if self.looked_s.is_nan() {
            self.looked_s = row.time_s;
        }
        if row.time_s - self.looked_s >= LOOK_S && self.working.is_none() {
            self.looked_s = row.time_s;
            let (watch, car) = (self.watch.clone(), Identified::by(drive.estimator()));
            self.working = thread::Builder::new().spawn(move || watch.conclude(&car)).ok();
        }
    }

    /// There is nothing more: what all rows have shown.
    pub(crate) fn finish(&mut self, drive: &Drive) {
        self.working = None;
        self.shown = shown(&self.watch.conclude(&Identified::by(drive.estimator())));
    }

    /// Whether a tire's own sensor says that its tire leaks.
    pub(crate) fn sees_a_leak(&self) -> bool {
        self.standing.iter().any(|alert| alert.get("kind").is_some_and(|kind| kind == "tire-sensor-leak"))
    }

    /// The tires' own sensors' last readings in kPa; NaN: none.
    pub(crate) fn sent_kpa(&self) -> [f64; 4] {
        self.watch.sent_kpa()
    }

    fn take_over(&mut self) {
        if let Some(Ok(findings)) = self.working.take().map(JoinHandle::join) {
            self.shown = shown(&findings);
        }
    }

    fn begin_again(&mut self, time_s: f64, reported: &mut impl FnMut(f64, Reported)) {
        self.working = None;
        self.watch = self.blank.clone();
        self.shown = shown(&self.watch.conclude(&Identified::default()));
        self.looked_s = time_s;
        self.standing.drain(..).for_each(|alert| reported(time_s, Reported::BesideEnded(alert)));
    }
}

fn shown(findings: &Findings) -> Arc<Map<String, Value>> {
    let all = findings.json().into_iter().filter(|(name, _)| *name != "tire_sensors_kpa");
    Arc::new(all.map(|(name, value)| (name.to_owned(), value)).collect())
}

/// A line of `events.jsonl` as an alert of the monitor.
fn alert(mut event: Map<String, Value>, time_s: f64) -> Map<String, Value> {
    event.remove("event");
    let since_s = event.remove("time_s");
    event.entry("since_s").or_insert(json!(since_s));
    event.insert("reported_s".to_owned(), json!(time_s));
    event
}

fn is_of_the_same(a: &Map<String, Value>, b: &Map<String, Value>) -> bool {
    let is_sensor =
        |alert: &Map<String, Value>| alert.get("kind")?.as_str().map(|kind| kind.starts_with("tire-sensor"));
    a.get("wheels") == b.get("wheels") && is_sensor(a) == is_sensor(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::Corner;

    use crate::drive::LiveDrive;

    fn row(time_s: f64, speed_m_s: f64) -> LogRow {
        let still = itpms_data::log::LogCorner::measured(0.0, 0.0);
        LogRow::without_motion(time_s, speed_m_s, [Some(still); 4])
    }

    /// A drive of a minute, a stop of so many seconds and two seconds more: its report of the findings before the stop.
    fn stopped_for(seconds: u32) -> Vec<String> {
        let clock = Clock { sample_rate_hz: 100.0, corners: Corner::ALL.to_vec(), wheel_speeds: false };
        let mut drive = LiveDrive::new(&Vehicle::paper(), clock, &DriveOptions::default()).unwrap();
        let found = json!({ "kind": "unbalance-rising", "wheels": ["fl"], "text": "" });
        drive.beside.standing.extend(found.as_object().cloned());
        let mut over = Vec::new();
        let stop = 60 + seconds;
        for k in 0..(stop + 2) * 100 {
            let time_s = f64::from(k) / 100.0;
            let speed_m_s = if (60.0..f64::from(stop)).contains(&time_s) { 0.0 } else { 20.0 };
            drive.update(&row(time_s, speed_m_s), |time_s, reported| {
                if let Reported::BesideEnded(alert) = reported {
                    over.push(format!("{} {}", time_s.round(), alert["kind"]));
                }
            });
        }
        over
    }

    #[test]
    fn a_long_stop_ends_a_drive_and_a_short_one_does_not() {
        let stops = std::thread::Builder::new().stack_size(8 << 20).spawn(|| [590, 610].map(stopped_for));
        let [short, long] = stops.unwrap().join().unwrap();
        assert!(short.is_empty(), "{short:?}");
        assert_eq!(long, ["670 \"unbalance-rising\""]);
    }
}
