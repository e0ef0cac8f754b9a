//! A source with wheel speeds alone: the live monitor names the tire that lost air, and goes on with a saved state.

use std::path::PathBuf;

use itpms_core::model::Corner;
use itpms_data::log::LogMotion;
use itpms_data::pulses::Pulse;
use itpms_data::{LogRow, Vehicle};
use itpms_live::drive::DriveOptions;
use itpms_live::engine::{Engine, Published};
use itpms_live::input::SourceName;
use itpms_live::state::SavedDrive;

use crate::common::{notes, with_large_stack};

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
    engine_with(saved, options())
}

fn options() -> DriveOptions {
    calibrating(40.0, None)
}

fn calibrating(seconds: f64, pulses: Option<&str>) -> DriveOptions {
    let mut options = DriveOptions::default();
    options.settings.calibrate_s = Some(seconds);
    options.settings.pulses = pulses.map(PathBuf::from);
    options
}

fn engine_with(saved: Option<SavedDrive>, options: DriveOptions) -> Engine {
    let source = SourceName { name: "bus".to_owned(), kind: "replay" };
    Engine::new(Vehicle::parse(WHEELS).unwrap(), options, source, saved, notes())
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
        let vehicle = Vehicle::parse(WHEELS).unwrap();
        let saved = SavedDrive::parse(&first.saved().unwrap(), &vehicle, &options()).unwrap();
        let mut second = engine(Some(saved));
        let (after, again) = driven(&mut second, 2500..6000);
        assert_eq!([before, after].concat(), alerts);
        assert_eq!(again, wheels);
    });
}

/// Teeth of four wheels between two times in s: 48 a turn of 0.3 m at 20 m/s, not quite evenly.
fn pulses(from_s: f64, to_s: f64) -> Vec<Pulse> {
    const PITCH_S: f64 = std::f64::consts::TAU * 0.3 / 48.0 / 20.0;
    let passes = |k: u32| f64::from(k) * PITCH_S + 3e-6 * (f64::from(k % 48) * 0.7).sin();
    let numbers = (0u32..).skip_while(|k| passes(*k) <= from_s).take_while(|k| passes(*k) <= to_s);
    numbers.flat_map(|k| Corner::ALL.map(|wheel| Pulse { time_s: passes(k), wheel })).collect()
}

/// A drive in halves, its pulses from the beginning each time, is the whole drive to the last bit.
#[test]
fn pulses_count_once_however_often_the_monitor_starts() {
    with_large_stack(|| {
        let others = ["fl", "fr", "rl"].map(|c| format!("[corner.{c}]\nplacard_kpa = 240.0\n")).concat();
        let file = format!("{WHEELS}{others}[tire]\nrolling_radius_m = 0.3\n");
        let vehicle = Vehicle::parse(&file).unwrap();
        let with_pulses = || calibrating(40.0, Some("pulses.csv"));
        let start = |saved: Option<Vec<u8>>, options: DriveOptions| {
            let saved = saved.map(|bytes| SavedDrive::parse(&bytes, &vehicle, &options).unwrap());
            let source = SourceName { name: "bus".to_owned(), kind: "replay" };
            Engine::new(vehicle.clone(), options, source, saved, notes())
        };
        let drive = |engine: &mut Engine, rows: std::ops::Range<u32>| {
            for k in rows.clone() {
                // As a replay hands them over: what passed before the first row, too.
                let before = if k == rows.start { 0.0 } else { row(k - 1).time_s };
                pulses(before, row(k).time_s).into_iter().for_each(|pulse| engine.pulse(pulse));
                engine.take(&row(k), None, &mut |_| ()).unwrap();
            }
            engine.saved().unwrap()
        };
        let whole = drive(&mut start(None, with_pulses()), 0..3000);
        let half = drive(&mut start(None, with_pulses()), 0..1500);
        assert_eq!(drive(&mut start(Some(half), with_pulses()), 1500..3000), whole);
        // They are a part of the saved state; restored from a state without them, they stay absent.
        let without = drive(&mut start(None, options()), 0..1500);
        let later = drive(&mut start(Some(without.clone()), options()), 1500..3000);
        assert!(later != whole && drive(&mut start(Some(without), with_pulses()), 1500..3000) == later);
    });
}

#[test]
fn pulses_without_wheel_speeds_or_placards_are_refused() {
    with_large_stack(|| {
        let with_pulses = calibrating(40.0, Some("pulses.csv"));
        let word = engine_with(None, with_pulses.clone()).open(RATE_HZ, &[], true).unwrap_err().to_string();
        assert!(word.contains("has no placard_kpa of all four corners"), "{word}");
        let car = Vehicle::paper();
        let source = SourceName { name: "bus".to_owned(), kind: "replay" };
        let mut engine = Engine::new(car, with_pulses.clone(), source, None, notes());
        let word = engine.open(200.0, &[Corner::FrontLeft], false).unwrap_err().to_string();
        assert!(word.contains("tooth pulses count together with wheel speeds"), "{word}");
    });
}

/// Three minutes every fourth day, with dates; the front left tire loses 1.5 % a day. Saved at each end, as by a monitor that is switched off.
#[test]
fn days_of_a_saved_state_name_a_slow_leak() {
    with_large_stack(|| {
        let options = calibrating(150.0, None);
        let mut saved = None;
        let mut named = Vec::new();
        for day in (0..32u32).step_by(4) {
            let mut engine = engine_with(saved.take(), options.clone());
            let mut alerts = Vec::new();
            for k in 0..9000 {
                let mut row = row(k % 3000);
                row.time_s = 1.7e9 + 86_400.0 * f64::from(day) + f64::from(k) / RATE_HZ;
                // Every wheel goes with the car as it speeds up and slows down.
                let pace = 1.0 + 0.1 * (0.2 * f64::from(k) / RATE_HZ).sin();
                row.motion.wheel_speed_m_s = row.motion.wheel_speed_m_s.map(|speed| speed * pace);
                row.motion.wheel_speed_m_s[0] *= 1.0 - 0.007 * f64::from(day) * 0.985f64.ln();
                let mut publish = |published| {
                    if let Published::Warning(transition) = published {
                        alerts.push(format!("{} {}", transition.event, transition.alert["text"]));
                    }
                };
                engine.take(&row, None, &mut publish).unwrap();
            }
            named.extend(alerts.into_iter().map(|alert| (day, alert)));
            let bytes = engine.saved().unwrap();
            saved = Some(SavedDrive::parse(&bytes, &Vehicle::parse(WHEELS).unwrap(), &options).unwrap());
        }
        let slow = |text: &str| text.starts_with("begun \"fl slow leak: loses");
        assert!(named.iter().any(|(day, text)| *day < 32 && slow(text)), "{named:?}");
        assert!(named.iter().all(|(_, text)| text.contains("\"fl ")), "{named:?}");
    });
}
