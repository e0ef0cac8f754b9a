//! Snapshots and transitions for tests: front left low, rear right not to be shown.

use std::sync::Arc;

use itpms_live::snapshot::{Latency, Snapshot, Source, SourceState, Transition, Wheel};
use serde_json::{Map, json};

pub(crate) fn snapshot(seq: u64, time_s: f64, state: SourceState) -> Arc<Snapshot> {
    Arc::new(Snapshot {
        seq,
        time_s,
        unix_s: 1.7e9 + time_s,
        source: Source {
            name: "can0".to_owned(),
            kind: "socketcan",
            state,
            rows: (200.0 * time_s) as u64,
            frames: (1000.0 * time_s) as u64,
            dropped: 3,
            unknown_ids: 0,
            malformed: 0,
            reconnects: 0,
            rate_hz: 200.0,
        },
        vehicle: "car".to_owned(),
        speed_m_s: 22.2,
        speed_doubt: None,
        distance_m: 22.2 * time_s,
        latency_ms: Latency { p50: 0.5, p99: 2.0, max: f64::NAN },
        wheels: ["fl", "fr", "rl", "rr"].map(wheel).to_vec(),
        tracks: vec![],
        alerts: vec![],
        sensors: vec![],
        beside: Arc::default(),
        not_estimated: Default::default(),
        all_fine: false,
    })
}

fn wheel(corner: &'static str) -> Wheel {
    let state = match corner {
        "fl" => "low",
        "rr" => "unknown",
        _ => "fine",
    };
    Wheel {
        corner,
        state,
        doubt: (state == "unknown").then_some("starting"),
        pressure_kpa: if corner == "fl" { 138.25 } else { 241.3 },
        pressure_sd_kpa: 2.5,
        change_sd_kpa: 1.5,
        axle_difference_sd_kpa: Some(3.0),
        lost_kpa: Some(1.5),
        lost_sd_kpa: Some(4.0),
        level: "calibration",
        stiffness_n_per_m: 233_000.0,
        reference_kpa: 241.3,
        placard_kpa: 241.3,
        valid: corner != "rr",
        warning: if corner == "fl" { "low" } else { "none" },
        gate: 0.9,
        informed_age_s: 0.1,
        road_m: 0.001,
        iri_m_per_km: f64::NAN,
        ..Wheel::default()
    }
}

pub(crate) fn transition(seq: u64, time_s: f64) -> Arc<Transition> {
    let mut alert = Map::new();
    alert.insert("kind".to_owned(), json!("under-inflated"));
    alert.insert("wheels".to_owned(), json!(["fl"]));
    alert.insert("reported_s".to_owned(), json!(time_s));
    Arc::new(Transition { seq, time_s, unix_s: 1.7e9 + time_s, event: "begun", alert })
}
