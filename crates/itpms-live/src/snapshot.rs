//! The published state of the car at one moment, as plain numbers and words.
//!
//! Made by the estimating thread; read by JSON lines, MQTT, the page and the tests. As JSON the names of the fields are
//! part of the contract with scripts. A number that is not known is NaN here and `null` in JSON. Holds no logic.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;
use serde_json::{Map, Value};

/// The car at one moment.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Snapshot {
    /// Counts the snapshots of this process from 0; one that is missing was not seen.
    pub seq: u64,
    /// Time of the newest row in s, on the source's clock; NaN before the first row.
    pub time_s: f64,
    /// Wall clock when that row came, in s since 1970-01-01 UTC: an old snapshot is as old as its data. Before the first row,
    /// when the monitor began.
    pub unix_s: f64,
    /// Where the rows come from, and whether they come.
    pub source: Source,
    pub vehicle: String,
    pub speed_m_s: f64,
    /// Why the speed is not known: `missing` or `contradicted` by wheels that roll while it is zero; else `null`.
    pub speed_doubt: Option<&'static str>,
    /// Distance driven since the start, in m.
    pub distance_m: f64,
    pub latency_ms: Latency,
    /// The wheels that are monitored, in the order fl fr rl rr.
    pub wheels: Vec<Wheel>,
    /// Left and right track, where front and rear are measured.
    pub tracks: Vec<Track>,
    /// The alerts that stand: the objects of `events.jsonl` (`kind`, `wheels`, `since_s`, `reported_s`, `text`, and numbers that
    /// depend on the kind).
    pub alerts: Vec<Map<String, Value>>,
    pub sensors: Vec<SensorHealth>,
    /// `dampers`, `load`, `once_per_turn` and `tire_sensors` as in `itpms estimate --json`, of the drive so far and at most a minute old.
    #[serde(flatten)]
    pub beside: Arc<Map<String, Value>>,
    /// Corners of the vehicle file that do not come, and why.
    pub not_estimated: BTreeMap<&'static str, String>,
    /// Whether every wheel of the vehicle file comes and is known to be fine, and the source is live: the only time to say "all good".
    pub all_fine: bool,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Source {
    /// Interface, file or topic, such as `can0`.
    pub name: String,
    /// `socketcan`, `stdin`, `replay` or `mqtt`.
    pub kind: &'static str,
    pub state: SourceState,
    pub rows: u64,
    /// Frames received; rows, where the source has no frames.
    pub frames: u64,
    /// Frames lost because we were too slow, or that the bus interface reported as lost.
    pub dropped: u64,
    /// Frames whose id is not in the DBC.
    pub unknown_ids: u64,
    /// Lines and frames that could not be read.
    pub malformed: u64,
    /// Times the connection was lost and made again.
    pub reconnects: u64,
    /// Rows per second for which the estimator was made; NaN before that is known.
    pub rate_hz: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SourceState {
    /// A row came within the last second.
    Live,
    /// Nothing has come for more than a second, or nothing yet: what is reported is old.
    #[default]
    Stale,
    /// The log or the input is at its end.
    Ended,
}

/// From the arrival of the frame that completed a row to the estimate, in ms, over the last ten seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Latency {
    pub p50: f64,
    /// 99 of 100 are below.
    pub p99: f64,
    pub max: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Wheel {
    /// `fl`, `fr`, `rl` or `rr`.
    pub corner: &'static str,
    /// `unknown`, `fine`, `low`, `over` or `malfunction`.
    pub state: &'static str,
    /// While unknown, why: `starting`, `no-information`, `uncertain`, `suspicion`, `misfit` or `standing`; else `null`.
    pub doubt: Option<&'static str>,
    /// Gauge pressure in kPa; means something only while valid.
    pub pressure_kpa: f64,
    pub pressure_sd_kpa: f64,
    /// Standard deviation in kPa of its change within minutes: without what the vehicle file leaves open.
    pub change_sd_kpa: f64,
    /// Standard deviation in kPa of its difference from the axle's other tire; `null` without one.
    pub axle_difference_sd_kpa: Option<f64>,
    /// Pressure lost in this drive in kPa, and its standard deviation; `null` while that is not counted, and where the tire was low
    /// before that. By wheel speeds alone: against the other tires since the calibration.
    pub lost_kpa: Option<f64>,
    pub lost_sd_kpa: Option<f64>,
    /// The tire's pressure once it has cooled down to the air around the car, in kPa, and its standard deviation; absent while the
    /// temperature of the air is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cold_pressure_kpa: Option<f64>,
    /// See [`cold_pressure_kpa`](Self::cold_pressure_kpa).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cold_pressure_sd_kpa: Option<f64>,
    /// Temperature in degrees Celsius of the air that it was computed with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambient_temperature_c: Option<f64>,
    /// Air to add in kPa, cold, up to the placard's pressure; absent where that is less than its standard deviation or hardly
    /// any, and while the pressure is not valid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cold_add_kpa: Option<f64>,
    /// By wheel speeds alone: share of its pressure that was lost since the calibration, its standard deviation, and the smallest loss that
    /// would have shown; `null` while not known.
    pub lost_share: Option<f64>,
    pub lost_share_sd: Option<f64>,
    pub detectable_loss: Option<f64>,
    /// Basis of its level: `file`, `calibration`, `reference` or, by wheel speeds alone, `other-tires`: then there is no pressure.
    pub level: &'static str,
    pub stiffness_n_per_m: f64,
    pub reference_kpa: f64,
    pub placard_kpa: f64,
    /// Whether the pressure may be shown.
    pub valid: bool,
    /// `none`, `low` or `malfunction`.
    pub warning: &'static str,
    /// Share of the last frame that was learned from, 0 to 1.
    pub gate: f64,
    /// Seconds since something was learned of this wheel.
    pub informed_age_s: f64,
    /// Height of the road under the wheel in m, causal and without drift.
    pub road_m: f64,
    /// International Roughness Index of the last full 100 m under this wheel.
    pub iri_m_per_km: f64,
    /// The last reading of the tire's own sensor in kPa; absent where it sends nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tire_sensor_kpa: Option<f64>,
}

/// How front and rear of one side meet the same road.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Track {
    /// `left` or `right`.
    pub side: &'static str,
    pub shared: bool,
    /// Share of the road's power near wheel hop that front and rear do not have in common, 0.001 to 2.
    pub incoherence: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorHealth {
    /// Its column in a drive log, such as `fl_body_accel_m_s2`.
    pub column: String,
    /// `fine`, `suspect` (not learned from, not yet reported) or `malfunction`.
    pub state: &'static str,
    /// The fault as a sentence; `null` while there is none.
    pub reason: Option<String>,
}

/// An alert that began or ended.
#[derive(Debug, Clone, Serialize)]
pub struct Transition {
    /// Counts the transitions of this process from 0.
    pub seq: u64,
    /// When, in s on the source's clock.
    pub time_s: f64,
    /// When, in s since 1970-01-01 UTC.
    pub unix_s: f64,
    /// `begun` or `ended`.
    pub event: &'static str,
    /// The alert, as in [`Snapshot::alerts`].
    #[serde(flatten)]
    pub alert: Map<String, Value>,
}
