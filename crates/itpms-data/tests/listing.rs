//! A log's content is the same in every format.

use std::path::{Path, PathBuf};

use itpms_core::model::Corner;
use itpms_data::LogRow;
use itpms_data::log::{CornerColumns, LogColumns, LogCorner, LogOptions, Slot};
use itpms_data::out::{LogWriter, Packing};
use itpms_data::signals::{ListedSignal, Lister, Listing, resolve};

const ROWS: u32 = 2000;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/can").join(name)
}

/// Four seconds at 500 Hz: a ramp of the speed from 10 to 20 m/s, one corner; every tenth body acceleration is missing.
fn write(path: &Path) {
    let mut corners = [None; 4];
    corners[Corner::FrontLeft.index()] = Some(CornerColumns { pressure: true, road: false });
    let columns = LogColumns { speed: true, corners, ..LogColumns::default() };
    let options = LogOptions {
        dbc: Some(example("car.dbc")),
        signals: Some(example("map.toml")),
        ..LogOptions::default()
    };
    let is_bus_log = path.extension().is_some_and(|extension| extension == "log");
    let options = if is_bus_log { options } else { LogOptions::default() };
    let mut writer = LogWriter::create_with(path, columns, &options, Packing::default()).unwrap();
    for i in 0..ROWS {
        let share = f64::from(i) / f64::from(ROWS - 1);
        let body_accel_m_s2 = if i % 10 == 9 { f64::NAN } else { -3.0 + 6.0 * share };
        let corner = LogCorner {
            body_accel_m_s2,
            wheel_accel_m_s2: 20.0 * share,
            pressure_kpa: 240.0,
            road_m: f64::NAN,
        };
        let mut corners = [None; 4];
        corners[0] = Some(corner);
        writer.write(&LogRow::without_motion(f64::from(i) * 2e-3, 10.0 + 10.0 * share, corners)).unwrap();
    }
    writer.finish().unwrap().commit().unwrap();
}

fn list(path: &Path, dbc: Option<&Path>) -> Listing {
    let mut lister = Lister::open(path, dbc, &[]).unwrap();
    let mut steps = 0;
    while lister.step().unwrap() {
        assert!((0.0..=1.0).contains(&lister.progress()));
        steps += 1;
        assert!(steps < 1000);
    }
    lister.finish()
}

/// The listed signal of a column, and the rate of its group.
fn found(listing: &Listing, map: Option<&Path>, slot: Slot) -> (ListedSignal, f64) {
    let map = map.map(|path| itpms_data::signals::SignalMap::read(path).unwrap());
    let resolved = resolve(&listing.candidates(), map.as_ref()).unwrap();
    let candidate = resolved.get(slot).unwrap().candidate;
    let firsts = listing.first_candidates();
    let (group, first) = listing
        .groups
        .iter()
        .zip(firsts)
        .find(|(group, first)| (*first..first + group.signals.len()).contains(&candidate))
        .unwrap();
    (group.signals[candidate - first].clone(), group.rate_hz.unwrap())
}

fn check(extension: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("drive.{extension}"));
    write(&path);
    let (dbc, map) = (example("car.dbc"), example("map.toml"));
    let is_bus_log = extension == "log";
    let listing = list(&path, is_bus_log.then_some(dbc.as_path()));
    let map = is_bus_log.then_some(map.as_path());
    // The bus has the speed in km/h, and steps of 0.01 m/s² at the wheel; half a step is what may be lost.
    let (per_m_s, slack) = if is_bus_log { (3.6, 0.005) } else { (1.0, 1e-12) };
    let (speed, _) = found(&listing, map, Slot::Speed);
    assert!((speed.min - 10.0 * per_m_s).abs() <= slack, "{speed:?}");
    let wheel = Slot::all().find(|slot| slot.name() == "fl_wheel_accel_m_s2").unwrap();
    let (wheel, rate_hz) = found(&listing, map, wheel);
    assert!((wheel.max - 20.0).abs() <= slack && wheel.samples == u64::from(ROWS), "{wheel:?}");
    assert_eq!(rate_hz, 500.0);
    let body = Slot::all().find(|slot| slot.name() == "fl_body_accel_m_s2").unwrap();
    let (body, _) = found(&listing, map, body);
    // A missing value may be sent as not available, or not at all.
    assert_eq!(body.samples, u64::from(ROWS) * 9 / 10, "{body:?}");
    let (first_s, last_s) = listing.span_s.unwrap();
    assert!((last_s - first_s - f64::from(ROWS - 1) * 2e-3).abs() < 2e-3);
}

#[test]
fn csv() {
    check("csv");
}

#[cfg(feature = "parquet")]
#[test]
fn parquet() {
    check("parquet");
}

#[cfg(feature = "mdf4")]
#[test]
fn mdf4() {
    check("mf4");
}

#[cfg(feature = "can")]
#[test]
fn candump() {
    check("log");
}
