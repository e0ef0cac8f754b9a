//! A source with wheel speeds alone: the live monitor names the tire that lost air, and goes on with a saved state.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use itpms_data::log::LogMotion;
use itpms_data::{LogRow, Vehicle};
use itpms_live::drive::DriveOptions;
use itpms_live::engine::{Engine, Published};
use itpms_live::input::SourceName;
use itpms_live::state::SavedDrive;

use crate::common::{say, with_large_stack};

const RATE_HZ: f64 = 50.0;
const WHEELS: &str = r#"[vehicle]
name = "wheels"
wheelbase_m = 2.7
track_front_m = 1.55
track_rear_m = 1.55
driven = "front"
[corner.rr]
placard_kpa = 240.0
"#;

/// A car at 20 m/s on uneven tires; from 60 s on the rear right one is smaller by -.007 ln .75 = .2 %.
fn row(k: u32) -> LogRow {
    let time_s = f64::from(k) / RATE_HZ;
    let shake = |wheel: f64| 1e-3 * (f64::from(k) * (1.0 + 0.37 * wheel)).sin();
    let radius =
        [1.3e-3, -0.4e-3, -0.9e-3, if time_s < 60.0 { 0.6e-3 } else { 0.6e-3 + 0.007 * 0.75f64.ln() }];
    let speed = |i: usize| 20.0 * (1.0 - radius[i] + shake(i as f64));
    let motion = LogMotion {
        wheel_speed_m_s: [0, 1, 2, 3].map(speed),
        yaw_rate_rad_s: 0.0,
        accel_x_m_s2: 0.0,
        ..LogMotion::UNKNOWN
    };
    LogRow { time_s, speed_m_s: f64::NAN, corners: [None; 4], motion }
}

fn engine(saved: Option<SavedDrive>) -> Engine {
    let source = SourceName { name: "bus".to_owned(), kind: "replay" };
    let options = DriveOptions { calibrate_s: Some(40.0), ..DriveOptions::default() };
    Engine::new(Vehicle::parse(WHEELS).unwrap(), options, source, saved, say())
}

/// Alerts as they began, with what was reported of the wheels in the end.
fn driven(engine: &mut Engine, rows: std::ops::Range<u32>) -> (Vec<String>, serde_json::Value) {
    let mut alerts = Vec::new();
    for k in rows {
        engine
            .take(&row(k), None, &mut |published| {
                if let Published::Warning(transition) = published {
                    alerts.push(format!("{} {}", transition.event, transition.alert["text"]));
                }
            })
            .unwrap();
    }
    (alerts, serde_json::to_value(&engine.snapshot().wheels).unwrap())
}

#[test]
fn a_source_of_wheel_speeds_alone_is_monitored_and_saved() {
    with_large_stack(|| {
        let mut whole = engine(None);
        let (alerts, wheels) = driven(&mut whole, 0..6000);
        assert_eq!(alerts.len(), 1, "{alerts:?}");
        assert!(
            alerts[0].starts_with("begun \"rr differs from the other tires since the calibration"),
            "{alerts:?}"
        );
        let of = |i: usize, key: &str| wheels[i][key].clone();
        assert_eq!([0, 1, 2, 3].map(|i| of(i, "state")), ["fine", "fine", "fine", "low"]);
        // No pressure, but a quarter of 240 kPa lost against the others.
        assert!(
            of(3, "pressure_kpa").is_null() && of(3, "level") == "other-tires" && of(3, "valid") == false
        );
        assert!((of(3, "lost_kpa").as_f64().unwrap() - 60.0).abs() < 12.0, "{wheels}");
        // No one says that all is good by differences alone, and a speed is there.
        assert!(!whole.snapshot().all_fine && (whole.snapshot().speed_m_s - 20.0).abs() < 0.1);

        let mut first = engine(None);
        let (before, _) = driven(&mut first, 0..2500);
        let options = DriveOptions { calibrate_s: Some(40.0), ..DriveOptions::default() };
        let vehicle = Vehicle::parse(WHEELS).unwrap();
        let saved = SavedDrive::parse(&first.saved().unwrap(), &vehicle, &options).unwrap();
        let mut second = engine(Some(saved));
        let (after, again) = driven(&mut second, 2500..6000);
        assert_eq!([before, after].concat(), alerts);
        assert_eq!(again, wheels);
    });
}
