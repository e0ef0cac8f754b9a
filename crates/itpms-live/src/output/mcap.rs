//! Estimates and warnings as an MCAP recording: `/estimate` of the car, `/estimate/fl` and so on of its wheels, `/alerts`, with the names of
//! the lines of JSON.

use std::collections::VecDeque;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use itpms_core::model::Corner;
use itpms_data::out::mcap::{FieldType, McapWriter, Topic, alert_fields};
use serde_json::{Map, Value, json};

use super::{Output, WhenSlow};
use crate::engine::Published;
use crate::error::LiveError;
use crate::snapshot::{Snapshot, Transition, Wheel};

/// The most that a power cut loses.
const FLUSH_EVERY: Duration = Duration::from_secs(10);
const MOST: u32 = 100_000;

const CAR: [(&str, FieldType); 6] = [
    ("unix_s", FieldType::Number),
    ("speed_m_s", FieldType::Number),
    ("distance_m", FieldType::Number),
    ("latency_p99_ms", FieldType::Number),
    ("source_state", FieldType::Label),
    ("all_fine", FieldType::Flag),
];

const WHEEL: [(&str, FieldType); 26] = [
    ("state", FieldType::Label),
    ("doubt", FieldType::Label),
    ("pressure_kpa", FieldType::Number),
    ("pressure_sd_kpa", FieldType::Number),
    ("change_sd_kpa", FieldType::Number),
    ("axle_difference_sd_kpa", FieldType::Number),
    ("lost_kpa", FieldType::Number),
    ("lost_sd_kpa", FieldType::Number),
    ("cold_pressure_kpa", FieldType::Number),
    ("cold_pressure_sd_kpa", FieldType::Number),
    ("ambient_temperature_c", FieldType::Number),
    ("cold_add_kpa", FieldType::Number),
    ("lost_share", FieldType::Number),
    ("lost_share_sd", FieldType::Number),
    ("detectable_loss", FieldType::Number),
    ("level", FieldType::Label),
    ("stiffness_n_per_m", FieldType::Number),
    ("reference_kpa", FieldType::Number),
    ("placard_kpa", FieldType::Number),
    ("valid", FieldType::Flag),
    ("warning", FieldType::Label),
    ("gate", FieldType::Number),
    ("informed_age_s", FieldType::Number),
    ("road_m", FieldType::Number),
    ("iri_m_per_km", FieldType::Number),
    ("tire_sensor_kpa", FieldType::Number),
];

pub struct McapOut {
    path: PathBuf,
    writer: McapWriter<File>,
    car: Topic,
    wheels: [Topic; 4],
    alerts: Topic,
    flushed: Instant,
}

impl McapOut {
    /// Begins a recording. One that is there is left alone, as the format cannot be added to: the new one is then `drive-2.mcap` and so on.
    pub fn open(path: &Path) -> Result<Self, LiveError> {
        let failed = |error| LiveError::Output { target: path.display().to_string(), error };
        let (path, file) = create(path).map_err(failed)?;
        let topics = || {
            let named = |fields: &[(&str, FieldType)]| {
                fields.iter().map(|(name, field)| ((*name).to_owned(), *field)).collect::<Vec<_>>()
            };
            let mut writer = McapWriter::new(file)?;
            let car = writer.add_topic("/estimate", named(&CAR))?;
            let [fl, fr, rl, rr] = Corner::ALL
                .map(|corner| writer.add_topic(&format!("/estimate/{}", corner.label()), named(&WHEEL)));
            let alerts = writer.add_topic("/alerts", alert_fields())?;
            let wheels = [fl?, fr?, rl?, rr?];
            Ok(Self { path: path.clone(), writer, car, wheels, alerts, flushed: Instant::now() })
        };
        topics().map_err(|error| LiveError::Output { target: path.display().to_string(), error })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn start(self) -> Output {
        Output::start(WhenSlow::Wait, self, Self::take, Self::finish)
    }

    fn take(&mut self, waiting: &mut VecDeque<Published>) -> Result<(), LiveError> {
        let written = waiting.drain(..).try_for_each(|published| match published {
            Published::Estimate(snapshot) => self.write_estimate(&snapshot),
            Published::Warning(transition) => self.write_alert(&transition),
        });
        let flushed = written.and_then(|()| {
            if self.flushed.elapsed() < FLUSH_EVERY {
                return Ok(());
            }
            self.flushed = Instant::now();
            self.writer.flush()
        });
        flushed.map_err(|error| self.failed(error))
    }

    fn write_estimate(&mut self, snapshot: &Snapshot) -> io::Result<()> {
        let time_s = snapshot.time_s;
        // Nothing has come yet.
        if !time_s.is_finite() {
            return Ok(());
        }
        self.writer.write(&mut self.car, time_s, car(snapshot))?;
        for wheel in &snapshot.wheels {
            let place = Corner::ALL.iter().position(|corner| corner.label() == wheel.corner);
            let Some(topic) = place.and_then(|place| self.wheels.get_mut(place)) else { continue };
            self.writer.write(topic, time_s, wheel_object(wheel)?)?;
        }
        Ok(())
    }

    fn write_alert(&mut self, transition: &Transition) -> io::Result<()> {
        let mut object = transition.alert.clone();
        object.insert("event".to_owned(), json!(transition.event));
        self.writer.write(&mut self.alerts, transition.time_s, object)
    }

    fn finish(self) -> Result<(), LiveError> {
        let target = self.path.display().to_string();
        let finished = self.writer.finish().and_then(|file| file.sync_all());
        finished.map_err(|error| LiveError::Output { target, error })
    }

    fn failed(&self, error: io::Error) -> LiveError {
        LiveError::Output { target: self.path.display().to_string(), error }
    }
}

/// A file that was not there, of this name or the first free one after it.
fn create(path: &Path) -> io::Result<(PathBuf, File)> {
    let numbered = |k: u32| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let extension = path.extension().map(|extension| format!(".{}", extension.to_string_lossy()));
        path.with_file_name(format!("{stem}-{k}{}", extension.unwrap_or_default()))
    };
    let mut name = path.to_owned();
    for k in 2..MOST {
        match File::create_new(&name) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => name = numbered(k),
            created => return Ok((name, created?)),
        }
    }
    File::create_new(&name).map(|file| (name, file))
}

fn car(snapshot: &Snapshot) -> Map<String, Value> {
    let values = [
        json!(snapshot.unix_s),
        json!(snapshot.speed_m_s),
        json!(snapshot.distance_m),
        json!(snapshot.latency_ms.p99),
        json!(snapshot.source.state),
        json!(snapshot.all_fine),
    ];
    CAR.iter().map(|(name, _)| (*name).to_owned()).zip(values).collect()
}

/// The wheel as in the lines of JSON; its corner is in the topic.
fn wheel_object(wheel: &Wheel) -> io::Result<Map<String, Value>> {
    let Value::Object(mut object) = serde_json::to_value(wheel)? else { return Ok(Map::new()) };
    object.remove("corner");
    Ok(object)
}
