//! Recordings as files, and how they are read.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use itpms_core::model::Corner;
use itpms_data::LogRow;
use itpms_data::log::{LogColumns, LogOptions, UnitCheck};
use itpms_data::out::{LogWriter, Packing};

use crate::common::{Bench, Found, found};

pub(super) const NAMES: [&str; 6] = [
    "time_s",
    "speed_m_s",
    "fl_body_accel_m_s2",
    "fl_wheel_accel_m_s2",
    "rl_body_accel_m_s2",
    "rl_wheel_accel_m_s2",
];
pub(super) const RATE_HZ: f64 = 200.0;
pub(super) const ROWS: u32 = 6000;

/// A row of a recording: bodies and wheels that swing as such do, to the digit that a file has.
pub(super) fn values(recording: u32, k: u32) -> [f64; 6] {
    let t = f64::from(k) / RATE_HZ;
    let sensor = |column: u32, size: f64, hz: f64| {
        let seed = f64::from(7 * recording + column);
        let wave = |i: u32| {
            let hz = hz * (1.0 + 0.4 * (seed * 1.7 + f64::from(i) * 2.3).sin());
            (TAU * hz * t + seed * f64::from(i + 1)).sin()
        };
        let noise = (f64::from(k) * 12.9898 + seed * 78.233).sin() * 43_758.545_3;
        let value = size * ((0..5).map(wave).sum::<f64>() + 0.2 * (noise - noise.floor()));
        (value * 100.0).round() / 100.0 + 0.0
    };
    let wheels = [sensor(2, 3.0, 12.0), sensor(4, 3.0, 12.0)];
    [t, 22.22, sensor(1, 0.5, 2.0), wheels[0], sensor(3, 0.5, 2.0), wheels[1]]
}

pub(super) fn drive(recording: u32) -> Vec<[f64; 6]> {
    (0..ROWS).map(|k| values(recording, k)).collect()
}

pub(super) fn number(value: f64) -> String {
    format!("{value}")
}

/// A table whose cells `cell` writes, of its column and value.
pub(super) fn table(header: &str, rows: &[[f64; 6]], cell: impl Fn(usize, f64) -> String) -> String {
    let line = |row: &[f64; 6]| {
        let cells: Vec<String> = row.iter().enumerate().map(|(place, value)| cell(place, *value)).collect();
        cells.join(",") + "\n"
    };
    format!("{header}\n") + &rows.iter().map(line).collect::<String>()
}

/// The same where only the time is written otherwise.
pub(super) fn clocked(header: &str, rows: &[[f64; 6]], clock: impl Fn(f64) -> String) -> String {
    table(header, rows, |place, value| if place == 0 { clock(value) } else { number(value) })
}

pub(super) fn plain(rows: &[[f64; 6]]) -> String {
    table(&NAMES.join(","), rows, |_, value| number(value))
}

/// `hh:mm:ss.sss` of the seconds of a day, parted by `between`.
pub(super) fn day(of_day_s: f64, between: &str) -> String {
    let ms = (of_day_s * 1000.0).round() as u64 % 86_400_000;
    let (h, m, s) = (ms / 3_600_000, ms / 60_000 % 60, ms / 1000 % 60);
    format!("{h:02}{between}{m:02}{between}{s:02}.{:03}", ms % 1000)
}

impl Bench {
    /// A Parquet file of these rows, of the front or of both wheels.
    pub(super) fn parquet(&self, name: &str, rows: &[LogRow], both: bool) -> PathBuf {
        let path = self.write(name, "");
        let mut columns = LogColumns { speed: true, ..LogColumns::default() };
        columns.corners[Corner::RearLeft.index()] = Some(itpms_data::log::CornerColumns::default());
        if both {
            columns.corners[Corner::FrontLeft.index()] = Some(itpms_data::log::CornerColumns::default());
        }
        let mut writer =
            LogWriter::create_with(&path, columns, &LogOptions::default(), Packing::default()).unwrap();
        rows.iter().for_each(|row| writer.write(row).unwrap());
        writer.finish().unwrap().commit().unwrap();
        path
    }
}

pub(super) fn read_where(path: &Path, rows: &str) -> Result<Found, String> {
    let rows = rows.split_whitespace().map(|row| row.parse().unwrap()).collect();
    let options = LogOptions { rows, ..LogOptions::from(UnitCheck::Trusting) };
    let found = found(path, &options)?;
    Ok(Found { remarks: [found.mapping.clone(), found.remarks].concat(), ..found })
}

pub(super) fn read(path: &Path) -> Result<Found, String> {
    read_where(path, "")
}

/// The same values at the same times but for where these begin, which a date has to a microsecond.
pub(super) fn same(found: &[LogRow], expected: &[LogRow], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let off_s = found[0].time_s - expected[0].time_s;
    for (found, expected) in found.iter().zip(expected) {
        assert!((found.time_s - expected.time_s - off_s).abs() < 1e-6, "{what}: {found:?}");
        let values = |row: &LogRow| format!("{:?}", LogRow { time_s: 0.0, ..*row });
        assert_eq!(values(found), values(expected), "{what} at {}", expected.time_s);
    }
}
