//! Alerts as JSON, the same in `events.jsonl` and wherever else they go.
//!
//! Called by the commands that write what the monitor says. Knows the monitor's words, no file.

use itpms_core::diagnosis::{Malfunction, Place, Sensor};
use itpms_core::model::Wheels;
use itpms_core::warning::{Alert, Cause, Change, Reading};
use serde_json::{Map, Value, json};

use crate::log::{Field, Slot};

/// An alert that began or ended, as a line of `events.jsonl`: `time_s`, `event` (`begun` or `ended`) and the alert.
pub fn transition_object(time_s: f64, change: &Change<f64>) -> Map<String, Value> {
    let (event, alert) = match change {
        Change::Begun(alert) => ("begun", alert),
        Change::Ended(alert) => ("ended", alert),
    };
    let mut line = Map::new();
    line.insert("time_s".to_owned(), json!(time_s));
    line.insert("event".to_owned(), json!(event));
    line.extend(alert_object(alert));
    line
}

/// An alert: `kind`, `wheels`, `since_s`, `reported_s`, numbers that depend on the kind, and `text` for a person.
pub fn alert_object(alert: &Alert<f64>) -> Map<String, Value> {
    let mut object = Map::new();
    let mut put = |key: &str, value: Value| {
        object.insert(key.to_owned(), value);
    };
    put("kind", json!(alert.cause.label()));
    put("wheels", wheels(alert.wheels));
    put("since_s", json!(alert.since_s));
    put("reported_s", json!(alert.reported_s));
    match &alert.cause {
        Cause::UnderInflated(reading) | Cause::OverInflated(reading) | Cause::Flat(reading) => {
            put_reading(&mut put, reading)
        }
        Cause::FastLeak { reading, rate_kpa_per_min } => {
            put_reading(&mut put, reading);
            put("rate_kpa_per_min", json!(rate_kpa_per_min));
        }
        Cause::AllLow { mean_share, sd_share, probability } => {
            put("mean_share", json!(mean_share));
            put("sd_share", json!(sd_share));
            put("probability", json!(probability));
        }
        Cause::CommonShift { mean_share, sd_share } => {
            put("mean_share", json!(mean_share));
            put("sd_share", json!(sd_share));
        }
        Cause::Differs { lost_share, lost_sd_share, is_known, probability } => {
            put("lost_share", json!(lost_share));
            put("lost_sd_share", json!(lost_sd_share));
            put("wheels_are_known", json!(is_known));
            put("probability", json!(probability));
        }
        Cause::SlowLeak(leak) => {
            put("probability", json!(leak.probability));
            put("lost_share_per_day", json!(leak.lost_share_per_day));
            put("lost_sd_share_per_day", json!(leak.lost_sd_share_per_day));
            put("lost_share", json!(leak.lost_share));
            put("lost_sd_share", json!(leak.lost_sd_share));
            put("days", json!(leak.days));
        }
        Cause::Malfunction(malfunction) => put_malfunction(&mut put, malfunction),
        Cause::NoInformation { driven_s } => put("driven_s", json!(driven_s)),
    }
    put("text", json!(alert.to_string()));
    object
}

fn put_reading(put: &mut impl FnMut(&str, Value), reading: &Reading<f64>) {
    put("pressure_kpa", json!(reading.pressure_kpa));
    put("sd_kpa", json!(reading.sd_kpa));
    put("limit_kpa", json!(reading.limit_kpa));
    put("reference_kpa", json!(reading.reference_kpa));
    put("basis", json!(reading.basis.label()));
    if let Some(probability) = reading.probability {
        put("probability", json!(probability));
    }
}

fn put_malfunction(put: &mut impl FnMut(&str, Value), malfunction: &Malfunction<f64>) {
    put("malfunction", json!(malfunction.label()));
    let sensors: Vec<String> = match malfunction {
        Malfunction::Stuck(sensor)
        | Malfunction::Dropout(sensor)
        | Malfunction::Spikes(sensor)
        | Malfunction::Noise(sensor)
        | Malfunction::Gain { sensor, .. } => vec![column(sensor)],
        Malfunction::Swapped(a, b) => vec![column(a), column(b)],
        Malfunction::SwappedSides | Malfunction::SwappedAxles | Malfunction::Inconsistent(_) => vec![],
    };
    put("sensors", json!(sensors));
    if let Malfunction::Gain { gain, .. } = malfunction {
        put("gain", json!(gain));
    }
}

fn column(sensor: &Sensor) -> String {
    let field = match sensor.place {
        Place::Body => Field::BodyAccel,
        Place::Wheel => Field::WheelAccel,
        Place::WheelSpeed => Field::WheelSpeed,
    };
    Slot::Corner(sensor.corner, field).name()
}

fn wheels(wheels: Wheels) -> Value {
    wheels.iter().map(|corner| json!(corner.label())).collect()
}
