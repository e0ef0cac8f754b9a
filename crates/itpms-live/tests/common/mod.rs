//! Rows, snapshots and warnings for tests.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests may fail as tests do"
)]
#![allow(dead_code, reason = "every test file uses its own part")]

use std::sync::Arc;

use itpms_core::model::Corner;
use itpms_data::LogRow;
use itpms_data::log::LogCorner;
use itpms_live::input::{Note, NoteSink};
use itpms_live::snapshot::{Latency, Snapshot, Source, SourceState, Transition};

/// Rows of four corners that shake at random, at 200 Hz: enough for whatever does not ask what the pressures are.
pub(crate) fn rows(count: u32) -> impl Iterator<Item = LogRow> {
    let mut state = 1u64;
    let mut noise = move || {
        // Knuth's MMIX generator; the sum of four uniform numbers is bell-shaped enough.
        (0..4).fold(-2.0, |sum, _| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum + (state >> 11) as f64 / (1u64 << 53) as f64
        })
    };
    (0..count).map(move |i| {
        let mut corner = |_| {
            let (body_accel_m_s2, wheel_accel_m_s2) = (noise(), 10.0 * noise());
            Some(LogCorner::measured(body_accel_m_s2, wheel_accel_m_s2))
        };
        LogRow::without_motion(f64::from(i) / 200.0, 20.0, Corner::ALL.map(&mut corner))
    })
}

pub(crate) fn snapshot(seq: u64) -> Arc<Snapshot> {
    Arc::new(Snapshot {
        seq,
        time_s: seq as f64 / 10.0,
        source: Source {
            name: "can0".to_owned(),
            kind: "socketcan",
            state: SourceState::Live,
            rate_hz: 500.0,
            ..Source::default()
        },
        vehicle: "car".to_owned(),
        speed_m_s: 20.0,
        latency_ms: Latency { p50: 0.1, p99: 0.2, max: 0.3 },
        ..Snapshot::default()
    })
}

pub(crate) fn transition(seq: u64) -> Arc<Transition> {
    let alert = serde_json::json!({"kind": "under-inflated", "wheels": ["fl"], "text": "fl under-inflated"});
    let alert = alert.as_object().unwrap().clone();
    Arc::new(Transition { seq, time_s: seq as f64, unix_s: 0.0, event: "begun", alert })
}

/// Notes into the test's own output.
pub(crate) fn notes() -> NoteSink {
    Arc::new(|note| match note {
        Note::Remark(text) => println!("{text}"),
        Note::Warning(text) => println!("warning: {text}"),
    })
}

/// Runs a test with the stack of a program's first thread: an estimator is made on it.
pub(crate) fn with_large_stack(test: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(8 << 20).spawn(test).unwrap();
    if let Err(panic) = thread.join() {
        std::panic::resume_unwind(panic);
    }
}
