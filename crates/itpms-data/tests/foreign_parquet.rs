//! Parquet as others write it: narrow and whole numbers, required columns, nulls, other columns between, damage.
#![cfg(feature = "parquet")]

use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use itpms_data::LogReader;
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

/// 1000 rows in two row groups: time as double, speed as int64, body as float, wheel as int32 with nulls, a text
/// column and the true pressure as a required double.
fn write(path: &Path, schema: &str, compression: Compression) {
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let properties = WriterProperties::builder().set_compression(compression).build();
    let mut file =
        SerializedFileWriter::new(File::create(path).unwrap(), schema, Arc::new(properties)).unwrap();
    for group in 0..2i32 {
        let rows = || (group * 500)..(group * 500 + 500);
        let all = vec![1i16; 500];
        let mut out = file.next_row_group().unwrap();
        let mut column = out.next_column().unwrap().unwrap();
        let times: Vec<f64> = rows().map(|i| f64::from(i) / 100.0).collect();
        column.typed::<DoubleType>().write_batch(&times, Some(&all), None).unwrap();
        column.close().unwrap();
        let mut column = out.next_column().unwrap().unwrap();
        let notes = vec![ByteArray::from("note"); 500];
        column.typed::<ByteArrayType>().write_batch(&notes, Some(&all), None).unwrap();
        column.close().unwrap();
        let mut column = out.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&[20; 500], Some(&all), None).unwrap();
        column.close().unwrap();
        let mut column = out.next_column().unwrap().unwrap();
        let body: Vec<f32> = rows().map(|i| (i as f32 * 0.1).sin()).collect();
        column.typed::<FloatType>().write_batch(&body, Some(&all), None).unwrap();
        column.close().unwrap();
        let mut column = out.next_column().unwrap().unwrap();
        let there: Vec<i16> = rows().map(|i| i16::from(i % 5 != 0)).collect();
        let wheel: Vec<i32> = rows().filter(|i| i % 5 != 0).map(|i| i % 7 - 3).collect();
        column.typed::<Int32Type>().write_batch(&wheel, Some(&there), None).unwrap();
        column.close().unwrap();
        let mut column = out.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&[241.3; 500], None, None).unwrap();
        column.close().unwrap();
        out.close().unwrap();
    }
    file.close().unwrap();
}

const SCHEMA: &str = "message drive {
    optional double time_s;
    optional binary note (UTF8);
    optional int64 speed_m_s;
    optional float fl_body_accel_m_s2;
    optional int32 fl_wheel_accel_m_s2;
    required double fl_pressure_kpa;
}";

#[test]
fn numbers_of_any_width_are_read_and_nulls_are_missing() {
    let dir = tempfile::tempdir().unwrap();
    for compression in [Compression::UNCOMPRESSED, Compression::SNAPPY, Compression::ZSTD(Default::default())]
    {
        let path = dir.path().join("drive.parquet");
        write(&path, SCHEMA, compression);
        let mut log = LogReader::open(&path).unwrap();
        let mut count = 0i32;
        while let Some(row) = log.next_row().unwrap() {
            let corner = row.corners[0].unwrap();
            assert_eq!(
                (row.time_s, row.speed_m_s, corner.pressure_kpa),
                (f64::from(count) / 100.0, 20.0, 241.3)
            );
            assert_eq!(corner.body_accel_m_s2, f64::from((count as f32 * 0.1).sin()));
            if count % 5 == 0 {
                assert!(corner.wheel_accel_m_s2.is_nan());
            } else {
                assert_eq!(corner.wheel_accel_m_s2, f64::from(count % 7 - 3));
            }
            assert!(corner.road_m.is_nan());
            count += 1;
        }
        assert_eq!(count, 1000);
        assert_eq!(log.repairs().missing_accelerations, 200);
    }
}

#[test]
fn columns_that_are_no_plain_numbers_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.parquet");
    let stamps = SCHEMA.replace("int64 speed_m_s", "int64 speed_m_s (TIMESTAMP_MICROS)");
    write(&path, &stamps, Compression::SNAPPY);
    let text = LogReader::open(&path).unwrap_err().to_string();
    assert!(text.contains("column speed_m_s holds ") && text.contains("expected numbers"), "{text}");

    let text_time = SCHEMA.replace("note", "fl_road_m");
    write(&path, &text_time, Compression::SNAPPY);
    let text = LogReader::open(&path).unwrap_err().to_string();
    assert!(text.contains("column fl_road_m holds text, expected"), "{text}");
}

#[test]
fn what_is_not_parquet_is_reported_as_such() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.parquet");
    fs::write(&path, "").unwrap();
    assert!(LogReader::open(&path).unwrap_err().to_string().contains("the file is empty"));
    fs::write(&path, "time_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2\n0,1,2\n").unwrap();
    let text = LogReader::open(&path).unwrap_err().to_string();
    assert!(text.contains("drive.parquet: not a readable Parquet file: "), "{text}");
}

/// Cut anywhere or with bytes flipped anywhere, the file gives rows or an error, never a panic.
#[test]
fn a_damaged_file_is_an_error_and_no_crash() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.parquet");
    write(&path, SCHEMA, Compression::SNAPPY);
    let whole = fs::read(&path).unwrap();
    let read = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let mut log = LogReader::open(&path)?;
        while log.next_row()?.is_some() {}
        Ok::<(), itpms_data::DataError>(())
    };
    for length in (0..whole.len()).step_by(97) {
        assert!(read(&whole[..length]).is_err(), "{length}");
    }
    let mut seed = 1u64;
    for _ in 0..300 {
        let mut bytes = whole.clone();
        for _ in 0..3 {
            // A linear congruential generator (Knuth's MMIX) is random enough to choose victims.
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let place = (seed >> 33) as usize % bytes.len();
            bytes[place] ^= 1 << (seed >> 61);
        }
        let _ = read(&bytes);
    }
}
