//! MCAP out, read back by the format's own crate.
#![cfg(feature = "mcap")]

use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use itpms_core::diagnosis::{Malfunction, Place, Sensor};
use itpms_core::model::{Corner, Wheels};
use itpms_core::warning::{Alert, Basis, Cause, Change, LeakOverDays, Reading};
use itpms_data::LogRow;
use itpms_data::convert::{Request, convert};
use itpms_data::log::{CornerColumns, LogColumns, LogCorner, LogMotion, LogOptions, MotionColumns};
use itpms_data::out::mcap::{FieldType, McapWriter, alert_fields};
use itpms_data::out::{Packing, transition_object};
use serde_json::{Map, Value};

use crate::common::write_log;

/// A message and its time in ns.
type Message = (u64, Map<String, Value>);

/// Messages of each topic, each of the types that its schema says.
fn read(path: &Path) -> BTreeMap<String, Vec<Message>> {
    let bytes = fs::read(path).unwrap();
    let mut topics = BTreeMap::<String, Vec<Message>>::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        assert_eq!(message.channel.message_encoding, "json");
        let schema = message.channel.schema.as_ref().unwrap();
        assert_eq!(schema.encoding, "jsonschema");
        let schema: Value = serde_json::from_slice(&schema.data).unwrap();
        let object: Map<String, Value> = serde_json::from_slice(&message.data).unwrap();
        assert_typed(&object, &schema);
        topics.entry(message.channel.topic.clone()).or_default().push((message.log_time, object));
    }
    topics
}

fn assert_typed(object: &Map<String, Value>, schema: &Value) {
    assert!(object.contains_key("time_s"), "{object:?}");
    for (name, value) in object {
        let expected = &schema["properties"][name]["type"];
        let found = match value {
            Value::Number(_) => "number",
            Value::Bool(_) => "boolean",
            Value::String(_) => "string",
            Value::Array(_) => "array",
            Value::Null | Value::Object(_) => panic!("{name}: {value}"),
        };
        assert_eq!(expected, found, "{name} in {schema}");
    }
}

/// Front left with its truth, rear right without; wheel sensors; the speed of every third row is missing.
fn rows(count: u32, start_s: f64) -> (LogColumns, Vec<LogRow>) {
    let truth = CornerColumns { pressure: true, road: false };
    let motion = MotionColumns { yaw_rate: true, ..MotionColumns::default() };
    let corners = [Some(truth), None, None, Some(CornerColumns::default())];
    let corner = |x: f64, pressure_kpa| LogCorner {
        body_accel_m_s2: (0.7 * x).sin(),
        wheel_accel_m_s2: if x % 5.0 == 0.0 { f64::NAN } else { x / 3.0 },
        pressure_kpa,
        road_m: f64::NAN,
    };
    let row = |k: u32| LogRow {
        time_s: start_s + f64::from(k) / 500.0,
        speed_m_s: if k.is_multiple_of(3) { f64::NAN } else { 20.5 },
        corners: [Some(corner(f64::from(k), 240.0)), None, None, Some(corner(-f64::from(k), f64::NAN))],
        motion: LogMotion { yaw_rate_rad_s: if k == 7 { f64::INFINITY } else { 0.1 }, ..LogMotion::UNKNOWN },
    };
    (LogColumns { speed: true, corners, motion }, (0..count).map(row).collect())
}

/// The fields of a message but for its time.
fn fields<const N: usize>(values: [(&str, f64); N]) -> Map<String, Value> {
    let known = values.into_iter().filter(|(_, value)| value.is_finite());
    known.map(|(name, value)| (name.to_owned(), Value::from(value))).collect()
}

#[test]
fn a_drive_log_keeps_every_bit_in_topics_of_its_wheels() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.mcap");
    let (columns, rows) = rows(20_000, 0.0);
    write_log(&path, columns, &rows);
    let topics = read(&path);
    assert_eq!(topics.keys().collect::<Vec<_>>(), ["/signals", "/signals/fl", "/signals/rr"]);
    for (k, row) in rows.iter().enumerate() {
        let [fl, _, _, rr] = row.corners.map(|corner| {
            corner.map(|corner| {
                [("body_accel_m_s2", corner.body_accel_m_s2), ("wheel_accel_m_s2", corner.wheel_accel_m_s2)]
            })
        });
        let mut fl = fields(fl.unwrap());
        fl.insert("pressure_kpa".to_owned(), Value::from(240.0));
        let car = fields([("speed_m_s", row.speed_m_s), ("yaw_rate_rad_s", row.motion.yaw_rate_rad_s)]);
        for (topic, mut expected) in
            [("/signals", car), ("/signals/fl", fl), ("/signals/rr", fields(rr.unwrap()))]
        {
            expected.insert("time_s".to_owned(), Value::from(row.time_s));
            // 2 ms are 2 000 000 ns.
            assert_eq!(topics[topic][k], (2_000_000 * k as u64, expected), "{topic} {k}");
        }
    }
    let bytes = fs::read(&path).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.stats.as_ref().unwrap().message_count, 60_000);
    // Chunks of a megabyte before they are packed, all in the index, each with its messages' places.
    let chunks = &summary.chunk_indexes;
    assert!(chunks.len() > 3 && chunks.iter().all(|chunk| chunk.uncompressed_size < 1_100_000), "{chunks:?}");
    assert!(chunks.iter().all(|chunk| chunk.compression == "zstd" && chunk.message_index_offsets.len() == 3));
}

#[test]
fn times_before_1970_begin_there() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.mcap");
    let (columns, rows) = rows(300, -0.5);
    write_log(&path, columns, &rows);
    let messages = &read(&path)["/signals"];
    assert_eq!((messages[0].0, &messages[0].1["time_s"]), (0, &Value::from(-0.5)));
    assert_eq!((messages[250].0, &messages[250].1["time_s"]), (500_000_000, &Value::from(0.0)));
}

#[cfg(feature = "mdf4")]
#[test]
fn the_date_of_a_measurement_is_that_of_its_messages() {
    use itpms_data::mdf4::{ChannelSpec, Compression, GroupSpec, Mdf4Writer, SampleFormat};
    let dir = tempfile::tempdir().unwrap();
    let [mf4, mcap] = ["drive.mf4", "drive.mcap"].map(|name| dir.path().join(name));
    let channels = ["fl_body_accel_m_s2", "fl_wheel_accel_m_s2"];
    let channels = channels.map(|name| ChannelSpec::new(name, "m/s^2", SampleFormat::Float64)).to_vec();
    let group = GroupSpec { name: "drive".to_owned(), comment: String::new(), channels };
    let mut writer = Mdf4Writer::create(&mf4, &[group], Compression::None).unwrap();
    writer.set_start_ns(1_700_000_000_250_000_000);
    for k in 0..400 {
        let x = f64::from(k);
        writer.write(0, x / 200.0, &[(0.7 * x).sin(), 9.0 * (0.3 * x).sin()]).unwrap();
    }
    writer.finish().unwrap().commit().unwrap();
    let request = Request {
        input: &mf4,
        output: &mcap,
        options: &LogOptions::default(),
        packing: Packing::Packed,
        position: false,
    };
    convert(&request, &mut |_| ControlFlow::Continue(())).unwrap().unwrap().file.commit().unwrap();
    let messages = &read(&mcap)["/signals/fl"];
    assert_eq!(messages.len(), 400);
    assert_eq!((messages[0].0, &messages[0].1["time_s"]), (1_700_000_000_250_000_000, &Value::from(0.0)));
    assert_eq!(messages[100].0, 1_700_000_000_750_000_000);
}

#[test]
fn every_alert_is_what_its_schema_says_and_what_is_not_known_is_left_out() {
    let reading = Reading {
        pressure_kpa: 180.0,
        sd_kpa: f64::NAN,
        limit_kpa: 193.0,
        reference_kpa: 241.0,
        basis: Basis::Calibration,
        probability: Some(0.998),
    };
    let sensor = Sensor { corner: Corner::RearLeft, place: Place::Wheel };
    let causes = [
        Cause::UnderInflated(reading),
        Cause::FastLeak { reading, rate_kpa_per_min: 30.0 },
        Cause::AllLow { mean_share: 0.75, sd_share: 0.01, probability: 0.998 },
        Cause::Malfunction(Malfunction::Gain { sensor, gain: 1.5 }),
        Cause::Differs { lost_share: 0.25, lost_sd_share: 0.05, is_known: true, probability: 0.9995 },
        Cause::SlowLeak(LeakOverDays {
            probability: 0.995,
            lost_share_per_day: 0.005,
            lost_sd_share_per_day: 0.001,
            lost_share: 0.15,
            lost_sd_share: 0.03,
            days: 30,
        }),
        Cause::NoInformation { driven_s: 600.0 },
    ];
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("alerts.mcap");
    let mut writer = McapWriter::new(fs::File::create(&path).unwrap()).unwrap();
    let mut topic = writer.add_topic("/alerts", alert_fields()).unwrap();
    for cause in causes {
        let alert = Alert { wheels: Wheels::from(Corner::RearLeft), since_s: 10.0, reported_s: 12.0, cause };
        writer.write(&mut topic, 12.5, transition_object(12.5, &Change::Begun(alert))).unwrap();
    }
    writer.finish().unwrap();
    let topics = read(&path);
    let alerts = &topics["/alerts"];
    assert_eq!(alerts.len(), 7);
    let (time_ns, low) = &alerts[0];
    assert_eq!(*time_ns, 12_500_000_000);
    assert!(low["pressure_kpa"] == 180.0 && !low.contains_key("sd_kpa"), "{low:?}");
    assert_eq!(low["wheels"], serde_json::json!(["rl"]));
    // All fields that the schema names are there in one alert or another.
    for (name, _) in alert_fields().filter(|(name, _)| name != "sd_kpa") {
        assert!(alerts.iter().any(|(_, alert)| alert.contains_key(&name)), "{name}");
    }
}

#[test]
fn a_growing_file_can_be_read_up_to_its_last_chunk() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("live.mcap");
    let mut writer = McapWriter::new(fs::File::create(&path).unwrap()).unwrap();
    let mut topic = writer.add_topic("/a", [("x".to_owned(), FieldType::Number)]).unwrap();
    for k in 0..10 {
        writer.write(&mut topic, f64::from(k), Map::from_iter([("x".to_owned(), Value::from(k))])).unwrap();
        if k == 6 {
            writer.flush().unwrap();
        }
    }
    // As a power cut leaves it.
    let bytes = fs::read(&path).unwrap();
    let options = mcap::read::Options::IgnoreEndMagic.into();
    let stream = mcap::MessageStream::new_with_options(&bytes, options).unwrap();
    assert_eq!(stream.map_while(Result::ok).count(), 7);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_in_its_own_words() {
    let file = fs::File::options().write(true).open("/dev/full").unwrap();
    let error = McapWriter::new(file).unwrap_err();
    assert!(error.to_string().starts_with("No space left"), "{error}");
}
