//! Logs and results through files and back.
#![cfg(feature = "parquet")]

use std::fs;
use std::path::Path;

use itpms_core::model::{Corner, CornerEstimate, Diagnostics, Level, Loss, Validity, Warning};
use itpms_core::warning::{Doubt, WheelState};
use itpms_data::log::{AirColumns, CornerColumns, LogColumns, LogCorner, UnitCheck};
use itpms_data::out::{EstimateRow, EstimateWriter, RoadPoint, RoadWriter, WheelSpeedUse};
use itpms_data::{DataError, LogReader, LogRow};
use proptest::prelude::*;

use crate::common::write_log;

fn read(path: &Path) -> (LogColumns, Vec<LogRow>) {
    let mut log = LogReader::open_with(path, &UnitCheck::Trusting.into()).unwrap();
    (*log.columns(), log.by_ref().map(Result::unwrap).collect())
}

/// All bits of a row; every NaN counts as the same.
fn bits(row: &LogRow) -> Vec<u64> {
    let mut values = vec![row.time_s, row.speed_m_s];
    for c in row.corners.iter().flatten() {
        values.extend([c.body_accel_m_s2, c.wheel_accel_m_s2, c.pressure_kpa, c.road_m]);
    }
    values.into_iter().map(|v| if v.is_nan() { f64::NAN.to_bits() } else { v.to_bits() }).collect()
}

/// Any finite number or a missing one.
fn cell() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => any::<f64>().prop_map(|v| if v.is_finite() { v } else { f64::NAN }),
        2 => Just(f64::NAN),
        1 => Just(-0.0),
    ]
}

fn corner(truth: bool) -> impl Strategy<Value = LogCorner> {
    (cell(), cell(), cell(), cell()).prop_map(move |(b, w, p, r)| LogCorner {
        body_accel_m_s2: b,
        wheel_accel_m_s2: w,
        pressure_kpa: if truth { p } else { f64::NAN },
        road_m: r,
    })
}

prop_compose! {
    fn rows()(cells in prop::collection::vec((cell(), corner(true), corner(false), 0.001..0.004f64), 2..40))
        -> Vec<LogRow> {
        let mut time_s = -0.5;
        let mut rows: Vec<LogRow> = cells.into_iter().map(|(speed_m_s, fl, rr, dt)| {
            time_s += dt;
            LogRow::without_motion(time_s, speed_m_s, [Some(fl), None, None, Some(rr)])
        }).collect();
        // A log without a single value is refused, and rightly; see bad_logs.rs.
        rows[0].corners[0] = Some(LogCorner {
            body_accel_m_s2: 1.0, wheel_accel_m_s2: 2.0, pressure_kpa: f64::NAN, road_m: 0.0,
        });
        rows
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn csv_to_parquet_to_csv_keeps_every_bit(rows in rows()) {
        let dir = tempfile::tempdir().unwrap();
        let [first, middle, last] = ["a.csv", "b.parquet", "c.csv"].map(|name| dir.path().join(name));
        let columns = LogColumns {
            speed: true,
            corners: [
                Some(CornerColumns { pressure: true, road: true }), None, None,
                Some(CornerColumns { pressure: false, road: true }),
            ],
            ..LogColumns::default()
        };
        write_log(&first, columns, &rows);
        for (from, to) in [(&first, &middle), (&middle, &last)] {
            let (columns_read, rows_read) = read(from);
            prop_assert_eq!(columns_read, columns);
            prop_assert_eq!(rows_read.iter().map(bits).collect::<Vec<_>>(), rows.iter().map(bits).collect::<Vec<_>>());
            write_log(to, columns_read, &rows_read);
        }
        prop_assert_eq!(fs::read(&first).unwrap(), fs::read(&last).unwrap());
    }
}

#[test]
fn a_long_drive_crosses_row_groups_and_batches() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("long.parquet");
    let columns = LogColumns {
        speed: false,
        corners: [None, Some(CornerColumns::default()), None, None],
        ..LogColumns::default()
    };
    let count = 65_536 * 2 + 777;
    let rows: Vec<LogRow> = (0..count)
        .map(|i| {
            let wheel = if i % 3 == 0 { f64::NAN } else { f64::from(i % 100) };
            let right = Some(LogCorner::measured(f64::from(i).sin(), wheel));
            LogRow::without_motion(f64::from(i) / 1000.0, f64::NAN, [None, right, None, None])
        })
        .collect();
    write_log(&path, columns, &rows);
    let mut log = LogReader::open(&path).unwrap();
    for row in &rows {
        assert_eq!(bits(&log.next_row().unwrap().unwrap()), bits(row));
    }
    assert!(log.next_row().unwrap().is_none());
    assert!((log.progress() - 1.0).abs() < 1e-12);
    assert_eq!(log.repairs().missing_accelerations, (count as u64).div_ceil(3));
    assert_eq!(log.survey().sample_rate_hz, 1000.0);
}

fn estimate(pressure_kpa: f64, validity: Validity, warning: Warning) -> CornerEstimate<f64> {
    CornerEstimate {
        time_s: 0.1,
        stiffness_n_per_m: 220_000.0,
        stiffness_sd_n_per_m: 1000.0,
        pressure_kpa,
        pressure_sd_kpa: 1.4,
        change_sd_kpa: 1.1,
        axle_difference_sd_kpa: Some(3.25),
        loss: None,
        cold: None,
        level: Level::Calibration,
        road_m: 0.001,
        road_sd_m: 0.0001,
        validity,
        warning,
        diagnostics: Diagnostics {
            forgetting: 1.0,
            nis: 1.0,
            gate: 1.0,
            change_probability: 0.0,
            pressure_variance_kpa2: 2.0,
        },
    }
}

#[test]
fn estimates_have_the_promised_columns_and_words() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("est.csv");
    let mut writer = EstimateWriter::create(
        &path,
        &[Corner::FrontLeft, Corner::RearRight],
        WheelSpeedUse::None,
        AirColumns::default(),
    )
    .unwrap();
    let loss = Loss {
        level_kpa: 241.0,
        is_whole: 1,
        lost_kpa: 60.5,
        lost_sd_kpa: 4.5,
        change_sd_kpa: 3.0,
        excess_kpa: 60.0,
        excess_sd_kpa: 5.0,
    };
    let low = CornerEstimate { loss: Some(loss), ..estimate(180.5, Validity::Valid, Warning::Low) };
    let broken = estimate(f64::NAN, Validity::BadSignal, Warning::Malfunction);
    let states = [Some(WheelState::Low), None, None, Some(WheelState::Unknown(Doubt::Uncertain))];
    let mut write = |time_s, estimates: [_; 4], states: [_; 4]| {
        writer.write(&EstimateRow { time_s, estimates: &estimates, states: &states, radii: None }).unwrap();
    };
    write(0.1, [Some(low), None, None, None], states);
    write(0.2, [Some(low), None, None, Some(broken)], [Some(WheelState::Malfunction); 4]);
    let file = writer.finish().unwrap();
    assert!(!path.exists());
    file.commit().unwrap();
    assert_eq!(
        fs::read_to_string(&path).unwrap(),
        "time_s,fl_pressure_kpa,fl_pressure_sd_kpa,fl_stiffness_n_per_m,fl_valid,fl_warning,fl_change_sd_kpa,fl_level,fl_axle_difference_sd_kpa,fl_lost_kpa,fl_lost_sd_kpa,fl_state,\
         rr_pressure_kpa,rr_pressure_sd_kpa,rr_stiffness_n_per_m,rr_valid,rr_warning,rr_change_sd_kpa,rr_level,rr_axle_difference_sd_kpa,rr_lost_kpa,rr_lost_sd_kpa,rr_state\n\
         0.1,180.5,1.4,220000,true,low,1.1,calibration,3.25,60.5,4.5,low,,,,false,none,,file,,,,uncertain\n\
         0.2,180.5,1.4,220000,true,low,1.1,calibration,3.25,60.5,4.5,malfunction,,1.4,220000,false,malfunction,1.1,calibration,3.25,,,malfunction\n"
    );
}

#[test]
fn roads_have_the_promised_columns() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("road.csv");
    let mut writer = RoadWriter::create(&path, &[Corner::FrontLeft, Corner::RearLeft]).unwrap();
    let point = RoadPoint { road_m: -0.0012, road_sd_m: 0.00005 };
    writer.write(0.5, 2.75, &[Some(point), None, None, None]).unwrap();
    writer.finish().unwrap().commit().unwrap();
    assert_eq!(
        fs::read_to_string(&path).unwrap(),
        "time_s,distance_m,fl_road_m,rl_road_m,fl_road_sd_m,rl_road_sd_m\n0.5,2.75,-0.0012,,0.00005,\n"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_by_name_in_both_formats() {
    let dir = tempfile::tempdir().unwrap();
    let link = dir.path().join("est.parquet");
    std::os::unix::fs::symlink("/dev/full", &link).unwrap();
    for path in [Path::new("/dev/full"), &link] {
        let fill = || {
            let mut writer =
                EstimateWriter::create(path, &Corner::ALL, WheelSpeedUse::None, AirColumns::default())?;
            for i in 0..5000 {
                let e = Some(estimate(f64::from(i).sqrt(), Validity::Valid, Warning::None));
                let (time_s, estimates, states) = (f64::from(i), &[e; 4], &[None; 4]);
                writer.write(&EstimateRow { time_s, estimates, states, radii: None })?;
            }
            Ok::<_, DataError>(writer.finish()?.commit()?)
        };
        let text: String = fill().unwrap_err().to_string();
        assert!(text.starts_with(&format!("{}: cannot be written: No space left", path.display())), "{text}");
    }
}

#[test]
fn an_output_of_unknown_kind_is_refused_before_anything_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("est.xlsx");
    let text = EstimateWriter::create(&path, &Corner::ALL, WheelSpeedUse::None, AirColumns::default())
        .unwrap_err()
        .to_string();
    assert!(text.ends_with("est.xlsx: unknown file extension .xlsx, expected .csv or .parquet"), "{text}");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}
