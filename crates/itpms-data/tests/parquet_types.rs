//! Every type and codec of Parquet that holds numbers or times is read as those, and a folder of part files as one table. That what
//! pyarrow, polars and DuckDB write is read, too, `.ci/parquet_judge.py` checks.
#![cfg(feature = "parquet")]

use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::{LogReader, LogRow};
use parquet::basic::{BrotliLevel, Compression, GzipLevel, ZstdLevel};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FixedLenByteArray, FixedLenByteArrayType,
    Int32Type, Int64Type, Int96, Int96Type,
};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;

use crate::common::{self, listed};

const ROWS: i32 = 400;

type Group<'a> = SerializedRowGroupWriter<'a, File>;

fn column<T: DataType>(group: &mut Group<'_>, values: &[T::T]) {
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<T>().write_batch(values, None, None).unwrap();
    column.close().unwrap();
}

/// A drive of 100 Hz whose clock or whose body acceleration has the type in question: required columns, body -20 to 20, wheel twice of it.
fn write(path: &Path, schema: &str, compression: Compression, odd: impl Fn(&mut Group<'_>)) {
    let schema = Arc::new(parse_message_type(&format!("message drive {{ {schema} }}")).unwrap());
    let properties = Arc::new(WriterProperties::builder().set_compression(compression).build());
    let mut file = SerializedFileWriter::new(File::create(path).unwrap(), schema, properties).unwrap();
    let mut group = file.next_row_group().unwrap();
    odd(&mut group);
    group.close().unwrap();
    file.close().unwrap();
}

fn body(i: i32) -> i32 {
    i % 41 - 20
}

fn doubles(group: &mut Group<'_>, value: impl Fn(i32) -> f64) {
    column::<DoubleType>(group, &(0..ROWS).map(value).collect::<Vec<_>>());
}

fn read(path: &Path) -> Result<Vec<(f64, f64, f64)>, String> {
    let values = |row: &LogRow| {
        let corner = row.corners[0].unwrap();
        (row.time_s, corner.body_accel_m_s2, corner.wheel_accel_m_s2)
    };
    Ok(common::read(path)?.0.iter().map(values).collect())
}

fn bytes(value: &[u8]) -> FixedLenByteArray {
    FixedLenByteArray::from(value.to_vec())
}

const WHEEL: &str = "required double fl_wheel_accel_m_s2;";

#[test]
fn clocks_of_every_type_are_seconds() {
    type Clock = (&'static str, fn(&mut Group<'_>), f64);
    const FROM_S: f64 = 1_772_352_000.0;
    let clocks: [Clock; 10] = [
        ("int64 time_s (TIMESTAMP(MILLIS,true))", |g| column::<Int64Type>(g, &stamps(1000, true)), FROM_S),
        ("int64 time_s (TIMESTAMP_MICROS)", |g| column::<Int64Type>(g, &stamps(1_000_000, true)), FROM_S),
        (
            "int64 time_s (TIMESTAMP(NANOS,false))",
            |g| column::<Int64Type>(g, &stamps(1_000_000_000, true)),
            FROM_S,
        ),
        ("int96 time_s", |g| column::<Int96Type>(g, &julian()), FROM_S),
        ("int32 time_s (TIME_MILLIS)", |g| column::<Int32Type>(g, &narrow(&stamps(1000, false))), 0.0),
        ("int64 time_s (TIME(NANOS,false))", |g| column::<Int64Type>(g, &stamps(1_000_000_000, false)), 0.0),
        ("int64 time_s (DECIMAL(18,2))", |g| column::<Int64Type>(g, &stamps(100, false)), 0.0),
        (
            "fixed_len_byte_array(12) time_s (INTERVAL)",
            |g| {
                let interval = |i: i32| bytes(&[&[0; 8][..], &(10 * i).to_le_bytes()].concat());
                column::<FixedLenByteArrayType>(g, &(0..ROWS).map(interval).collect::<Vec<_>>());
            },
            0.0,
        ),
        ("double time_s", |g| doubles(g, |i| f64::from(i) / 100.0), 0.0),
        (
            "binary time_s (STRING)",
            |g| {
                let text =
                    |i: i32| format!("2026-03-01T08:{:02}:{:05.2}Z", i / 6000, f64::from(i % 6000) / 100.0);
                let texts: Vec<String> = (0..ROWS).map(text).collect();
                let cells: Vec<ByteArray> = texts.iter().map(|text| ByteArray::from(text.as_str())).collect();
                column::<ByteArrayType>(g, &cells);
            },
            FROM_S,
        ),
    ];
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.parquet");
    for (schema, clock, from_s) in clocks {
        let schema = format!("required {schema}; required double fl_body_accel_m_s2; {WHEEL}");
        write(&path, &schema, Compression::SNAPPY, |group| {
            clock(group);
            doubles(group, |i| f64::from(body(i)));
            doubles(group, |i| f64::from(2 * body(i)));
        });
        let rows = read(&path).unwrap_or_else(|text| panic!("{schema}: {text}"));
        assert_eq!(rows.len(), ROWS as usize, "{schema}");
        for (i, (time_s, ..)) in (0..ROWS).zip(rows) {
            // Seconds since 1970 in 64 bits have steps of 0.24 us.
            assert!((time_s - from_s - f64::from(i) / 100.0).abs() < 3e-7, "{schema}: {time_s}");
        }
        let listing = listed(&path);
        assert_eq!(
            (listing.clock.as_deref(), listing.groups[0].rate_hz),
            (Some("time_s"), Some(100.0)),
            "{schema}"
        );
    }
}

fn stamps(per_s: i64, since_1970: bool) -> Vec<i64> {
    let from_s = if since_1970 { 1_772_352_000 } else { 0 };
    (0..i64::from(ROWS)).map(|i| from_s * per_s + i * per_s / 100).collect()
}

fn narrow(values: &[i64]) -> Vec<i32> {
    values.iter().map(|value| i32::try_from(*value).unwrap()).collect()
}

/// 2026-03-01 is Julian day 2461101; 08:00 are 28 800 s.
fn julian() -> Vec<Int96> {
    let stamp = |i: i64| {
        let ns = 28_800_000_000_000 + i * 10_000_000;
        Int96::from(vec![ns as u32, (ns >> 32) as u32, 2_461_101])
    };
    (0..i64::from(ROWS)).map(stamp).collect()
}

#[test]
fn numbers_of_every_type_are_what_they_mean() {
    type Body = (&'static str, fn(&mut Group<'_>), fn(i32) -> f64);
    let plain = |i: i32| f64::from(body(i));
    let bodies: [Body; 9] = [
        ("int32 fl_body_accel_m_s2 (INTEGER(8,true))", |g| column::<Int32Type>(g, &all(body)), plain),
        (
            "int32 fl_body_accel_m_s2 (UINT_32)",
            |g| column::<Int32Type>(g, &all(|i| i32::MIN + i)),
            |i| 2f64.powi(31) + f64::from(i),
        ),
        (
            "int64 fl_body_accel_m_s2 (INTEGER(64,false))",
            |g| column::<Int64Type>(g, &vec![-2048; ROWS as usize]),
            |_| 2f64.powi(64) - 2048.0,
        ),
        (
            "int32 fl_body_accel_m_s2 (DECIMAL(5,2))",
            |g| column::<Int32Type>(g, &all(|i| 25 * body(i))),
            |i| f64::from(25 * body(i)) / 100.0,
        ),
        (
            "fixed_len_byte_array(5) fl_body_accel_m_s2 (DECIMAL(10,1))",
            |g| {
                let digits = all(|i| bytes(&i64::from(5 * body(i)).to_be_bytes()[3..]));
                column::<FixedLenByteArrayType>(g, &digits);
            },
            |i| f64::from(5 * body(i)) / 10.0,
        ),
        (
            "fixed_len_byte_array(2) fl_body_accel_m_s2 (FLOAT16)",
            |g| {
                // 1.5, 2.0 and -0.25 in IEEE 754's half precision.
                let half = all(|i| bytes(&[0x3e00u16, 0x4000, 0xb400][i as usize % 3].to_le_bytes()));
                column::<FixedLenByteArrayType>(g, &half);
            },
            |i| [1.5, 2.0, -0.25][i as usize % 3],
        ),
        (
            "boolean fl_body_accel_m_s2",
            |g| column::<BoolType>(g, &all(|i| i % 2 == 0)),
            |i| f64::from(u8::from(i % 2 == 0)),
        ),
        ("int64 fl_body_accel_m_s2", |g| column::<Int64Type>(g, &all(|i| i64::from(body(i)))), plain),
        ("double fl_body_accel_m_s2", |g| doubles(g, |i| f64::from(body(i))), plain),
    ];
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.parquet");
    for (schema, odd, expected) in bodies {
        let schema = format!("required double time_s; required {schema}; {WHEEL}");
        write(&path, &schema, Compression::UNCOMPRESSED, |group| {
            doubles(group, |i| f64::from(i) / 100.0);
            odd(group);
            doubles(group, |i| f64::from(2 * body(i)));
        });
        let rows = read(&path).unwrap_or_else(|text| panic!("{schema}: {text}"));
        for (i, (_, value, _)) in (0..ROWS).zip(rows) {
            assert_eq!(value, expected(i), "{schema}, row {i}");
        }
    }
}

fn all<T>(value: impl Fn(i32) -> T) -> Vec<T> {
    (0..ROWS).map(value).collect()
}

const PLAIN: &str =
    "required double time_s; required double fl_body_accel_m_s2; required double fl_wheel_accel_m_s2;";

fn plain(path: &Path, compression: Compression, rows: impl Fn(i32) -> bool) {
    write(path, PLAIN, compression, |group| {
        let kept: Vec<i32> = (0..ROWS).filter(|i| rows(*i)).collect();
        for value in [|i: i32| f64::from(i) / 100.0, |i| f64::from(body(i)), |i| f64::from(2 * body(i))] {
            column::<DoubleType>(group, &kept.iter().map(|i| value(*i)).collect::<Vec<_>>());
        }
    });
}

#[test]
fn every_codec_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.parquet");
    plain(&path, Compression::UNCOMPRESSED, |_| true);
    let expected = read(&path).unwrap();
    for compression in [
        Compression::SNAPPY,
        Compression::GZIP(GzipLevel::default()),
        Compression::BROTLI(BrotliLevel::default()),
        Compression::LZ4,
        Compression::LZ4_RAW,
        Compression::ZSTD(ZstdLevel::default()),
    ] {
        plain(&path, compression, |_| true);
        assert_eq!(read(&path).unwrap(), expected, "{compression}");
    }
}

#[test]
fn a_folder_of_part_files_is_one_log_in_the_order_of_its_clock() {
    let dir = tempfile::tempdir().unwrap();
    let whole = dir.path().join("whole.parquet");
    plain(&whole, Compression::SNAPPY, |_| true);
    let expected = read(&whole).unwrap();
    let folder = dir.path().join("drive");
    let fresh = || {
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("day=1")).unwrap();
        fs::write(folder.join("_SUCCESS"), "").unwrap();
        fs::write(folder.join(".part-0.crc"), "crc").unwrap();
    };
    // One after the other, named in another order, one of them empty.
    fresh();
    plain(&folder.join("part-0.parquet"), Compression::SNAPPY, |i| i >= 250);
    plain(&folder.join("part-1.parquet"), Compression::ZSTD(ZstdLevel::default()), |i| i < 100);
    plain(&folder.join("day=1/part-2.parquet"), Compression::SNAPPY, |i| (100..250).contains(&i));
    plain(&folder.join("part-3.parquet"), Compression::SNAPPY, |_| false);
    assert_eq!(read(&folder).unwrap(), expected);
    // Dealt out among them.
    fresh();
    for part in 0..3 {
        plain(&folder.join(format!("part-{part}.parquet")), Compression::SNAPPY, |i| i % 3 == part);
    }
    assert_eq!(read(&folder).unwrap(), expected);
    // Another file among them is named.
    write(&folder.join("part-9.parquet"), "required double time_s;", Compression::SNAPPY, |group| {
        doubles(group, f64::from);
    });
    let text = read(&folder).unwrap_err();
    assert!(text.ends_with("part-9.parquet: column fl_body_accel_m_s2 is missing"), "{text}");
    // A folder without any part is no log.
    let empty = dir.path().join("empty");
    fs::create_dir(&empty).unwrap();
    assert!(read(&empty).unwrap_err().contains("is a directory, expected a file"));
}

#[test]
fn an_index_without_a_name_is_the_clock_and_the_written_map_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.parquet");
    let schema = format!(
        "required double fl_body_accel_m_s2; {WHEEL} required int64 __index_level_0__ (TIMESTAMP(NANOS,true));"
    );
    write(&path, &schema, Compression::SNAPPY, |group| {
        doubles(group, |i| f64::from(body(i)));
        doubles(group, |i| f64::from(2 * body(i)));
        column::<Int64Type>(group, &stamps(1_000_000_000, true));
    });
    assert_eq!(read(&path).unwrap().len(), ROWS as usize);
    let listing = listed(&path);
    let resolved = itpms_data::signals::resolve(&listing.candidates(), None).unwrap();
    let map = dir.path().join("map.toml");
    fs::write(&map, resolved.to_toml(listing.clock.as_deref())).unwrap();
    assert!(fs::read_to_string(&map).unwrap().contains("\ntime_s = \"__index_level_0__\"\n"));
    let options = LogOptions { signals: Some(map), ..LogOptions::from(UnitCheck::Trusting) };
    let mut log = LogReader::open_with(&path, &options).unwrap();
    assert_eq!(log.next_row().unwrap().unwrap().time_s, 1_772_352_000.0);
}
