//! The newest snapshot in Prometheus' text format.
//!
//! Asked by `/metrics`. A pressure that may not be shown is NaN here, and what has not come at all is missing.

use std::fmt::{Display, Write as _};
use std::sync::atomic::Ordering::Relaxed;

use super::shared::Shared;
use crate::snapshot::{Snapshot, Wheel};

/// The words of [`Wheel::state`].
const STATES: [&str; 6] = ["unknown", "uncertain", "fine", "low", "over", "malfunction"];

pub(super) fn text(shared: &Shared) -> String {
    let mut out = Page(String::with_capacity(8192));
    let health = shared.health();
    out.family("itpms_fresh", "gauge", "1 while rows come and are estimated.");
    out.line("itpms_fresh", "", u8::from(health.is_fresh()));
    out.family("itpms_snapshot_age_seconds", "gauge", "Seconds since the newest snapshot.");
    out.line("itpms_snapshot_age_seconds", "", health.snapshot_age_s.unwrap_or(f64::INFINITY));
    out.family("itpms_http_streams", "gauge", "Clients that watch the stream.");
    out.line("itpms_http_streams", "", shared.streams.load(Relaxed));
    let newest = shared.newest.borrow().clone();
    if let Some(frame) = newest {
        source(&mut out, &frame.snapshot);
        wheels(&mut out, &frame.snapshot);
        car(&mut out, &frame.snapshot);
    }
    out.0
}

fn source(out: &mut Page, snapshot: &Snapshot) {
    let source = &snapshot.source;
    for (name, help, value) in [
        ("itpms_rows_total", "Rows estimated.", source.rows),
        ("itpms_frames_total", "Frames received.", source.frames),
        ("itpms_frames_dropped_total", "Frames lost.", source.dropped),
        ("itpms_frames_unknown_id_total", "Frames whose id the DBC file does not have.", source.unknown_ids),
        ("itpms_frames_malformed_total", "Frames or lines that could not be read.", source.malformed),
        ("itpms_reconnects_total", "Times the source was lost and found again.", source.reconnects),
    ] {
        out.family(name, "counter", help);
        out.line(name, "", value);
    }
    out.family(
        "itpms_latency_seconds",
        "gauge",
        "From the frame to the estimate, over the last ten seconds.",
    );
    let latency = snapshot.latency_ms;
    for (quantile, value) in [("0.5", latency.p50), ("0.99", latency.p99), ("1", latency.max)] {
        out.line("itpms_latency_seconds", &format!("quantile=\"{quantile}\""), value / 1e3);
    }
    out.family("itpms_source_time_seconds", "gauge", "Time of the newest row on the source's clock.");
    out.line("itpms_source_time_seconds", "", snapshot.time_s);
}

fn wheels(out: &mut Page, snapshot: &Snapshot) {
    type Number = fn(&Wheel) -> f64;
    let families: [(&str, &str, Number); 10] = [
        ("itpms_tire_pressure_kpa", "Gauge pressure; NaN while it may not be shown.", |w| {
            shown(w, w.pressure_kpa)
        }),
        ("itpms_tire_pressure_sd_kpa", "Its standard deviation.", |w| shown(w, w.pressure_sd_kpa)),
        ("itpms_tire_change_sd_kpa", "The same of what has changed within minutes.", |w| {
            shown(w, w.change_sd_kpa)
        }),
        (
            "itpms_tire_axle_difference_sd_kpa",
            "The same of the difference from the axle's other tire.",
            |w| shown(w, w.axle_difference_sd_kpa.unwrap_or(f64::NAN)),
        ),
        ("itpms_tire_reference_kpa", "What the pressure is held against.", |w| w.reference_kpa),
        ("itpms_tire_stiffness_newtons_per_meter", "Tire stiffness.", |w| w.stiffness_n_per_m),
        ("itpms_tire_valid", "1 while the pressure may be shown.", |w| f64::from(u8::from(w.valid))),
        ("itpms_tire_information_gate", "Share of the last frame that was learned from.", |w| w.gate),
        ("itpms_tire_informed_age_seconds", "Seconds since something was learned.", |w| w.informed_age_s),
        ("itpms_road_iri_meters_per_kilometer", "Roughness of the last 100 m.", |w| w.iri_m_per_km),
    ];
    for (name, help, number) in families {
        out.family(name, "gauge", help);
        for wheel in &snapshot.wheels {
            out.line(name, &format!("wheel=\"{}\"", wheel.corner), number(wheel));
        }
    }
    out.family("itpms_tire_state", "gauge", "1 for the state a wheel is in.");
    for wheel in &snapshot.wheels {
        for state in STATES {
            let labels = format!("wheel=\"{}\",state=\"{state}\"", wheel.corner);
            out.line("itpms_tire_state", &labels, u8::from(wheel.state == state));
        }
    }
}

fn shown(wheel: &Wheel, value: f64) -> f64 {
    if wheel.valid { value } else { f64::NAN }
}

fn car(out: &mut Page, snapshot: &Snapshot) {
    out.family("itpms_all_fine", "gauge", "1 while every wheel is known to be fine and rows come.");
    out.line("itpms_all_fine", "", u8::from(snapshot.all_fine));
    out.family("itpms_alerts", "gauge", "Alerts that stand.");
    out.line("itpms_alerts", "", snapshot.alerts.len());
    out.family("itpms_speed_meters_per_second", "gauge", "Speed of the car.");
    out.line("itpms_speed_meters_per_second", "", snapshot.speed_m_s);
    out.family("itpms_distance_meters", "gauge", "Distance since the start.");
    out.line("itpms_distance_meters", "", snapshot.distance_m);
    out.family("itpms_sensor_fine", "gauge", "1 while nothing is wrong with an accelerometer.");
    for sensor in &snapshot.sensors {
        // A column is made of our own words; it needs no escaping.
        let labels = format!("sensor=\"{}\"", sensor.column);
        out.line("itpms_sensor_fine", &labels, u8::from(sensor.state == "fine"));
    }
}

struct Page(String);

impl Page {
    fn family(&mut self, name: &str, kind: &str, help: &str) {
        let _ = writeln!(self.0, "# HELP {name} {help}\n# TYPE {name} {kind}");
    }

    fn line(&mut self, name: &str, labels: &str, value: impl Display) {
        let value = value.to_string();
        // The format's own spelling of the infinite.
        let value = match &*value {
            "inf" => "+Inf",
            "-inf" => "-Inf",
            other => other,
        };
        let _ = match labels {
            "" => writeln!(self.0, "{name} {value}"),
            labels => writeln!(self.0, "{name}{{{labels}}} {value}"),
        };
    }
}
