//! MCAP in: JSON, ROS 1, ROS 2 and protobuf, each message made by hand or by the crate of its format.
#![cfg(feature = "mcap")]

use std::collections::BTreeMap;

use itpms_data::LogRow;
use itpms_data::convert::{Request, convert};
use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::out::Packing;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::field_descriptor_proto::{Label, Type};
use prost_reflect::prost_types::{
    DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet,
};
use prost_reflect::{DescriptorPool, DynamicMessage, Value};

use crate::common::{Bench, listed, read};

const SAMPLES: u32 = 800;
/// Time of the first sample in ns since 1970.
const BEGAN_NS: u64 = 1_700_000_000_000_000_000;

/// Speed, and accelerations of the bodies and of the wheels in the order fl, fr, rl, rr. All are halves, so that a float of 32 bits has them, too.
fn sample(k: u32) -> (f64, [f64; 4], [f64; 4]) {
    let wave = |step: u32, most: u32| f64::from((k * step) % (2 * most + 1)) / 2.0 - f64::from(most) / 2.0;
    (20.0, [37, 41, 43, 47].map(|step| wave(step, 5)), [101, 103, 107, 109].map(|step| wave(step, 60)))
}

fn time_ns(k: u32) -> u64 {
    BEGAN_NS + u64::from(k) * 5_000_000
}

/// A topic: its name, encoding, schema (name, encoding, text), and the messages of sample `k`.
struct Topic<'a> {
    name: &'a str,
    encoding: &'a str,
    schema: (&'a str, &'a str, &'a [u8]),
    message: &'a dyn Fn(u32) -> Vec<u8>,
}

fn write(compression: Option<Compression>, late_ns: impl Fn(u32) -> u64, topics: &[Topic<'_>]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let options = WriteOptions::new().compression(compression).chunk_size(Some(20_000));
    let mut writer: Writer<_> = options.create(&mut bytes).unwrap();
    let channels: Vec<u16> = topics
        .iter()
        .map(|topic| {
            let (name, encoding, text) = topic.schema;
            let schema = writer.add_schema(name, encoding, text).unwrap();
            writer.add_channel(schema, topic.name, topic.encoding, &BTreeMap::new()).unwrap()
        })
        .collect();
    for k in 0..SAMPLES {
        for (topic, channel_id) in topics.iter().zip(&channels) {
            let log_time = time_ns(k) + late_ns(k);
            let header =
                MessageHeader { channel_id: *channel_id, sequence: k, log_time, publish_time: log_time };
            writer.write_to_known_channel(&header, &(topic.message)(k)).unwrap();
        }
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

fn read_bytes(bench: &Bench, bytes: &[u8]) -> Result<(Vec<LogRow>, Vec<String>), String> {
    read(&bench.write("drive.mcap", bytes))
}

fn check(bytes: &[u8], what: &str) {
    let (rows, messages) = read_bytes(&Bench::new(), bytes).unwrap();
    assert_eq!((rows.len(), messages), (SAMPLES as usize, Vec::new()), "{what}");
    for (k, row) in (0..).zip(&rows) {
        let (speed, bodies, wheels) = sample(k);
        // A number of 64 bits has the present date to 0.24 us.
        assert!((row.time_s - time_ns(k) as f64 / 1e9).abs() < 1e-6, "{what} {k}");
        assert_eq!(row.speed_m_s, speed, "{what} {k}");
        assert_eq!(row.corners.map(|corner| corner.unwrap().body_accel_m_s2), bodies, "{what} {k}");
        assert_eq!(row.corners.map(|corner| corner.unwrap().wheel_accel_m_s2), wheels, "{what} {k}");
    }
}

#[test]
fn json_is_read_flat_nested_and_in_arrays_of_four() {
    let flat = |k: u32| {
        let (speed, bodies, wheels) = sample(k);
        let corners = ["fl", "fr", "rl", "rr"].iter().zip(bodies.iter().zip(&wheels));
        let corners =
            corners.map(|(c, (b, w))| format!(",\"{c}_body_accel_m_s2\":{b},\"{c}_wheel_accel_m_s2\":{w}"));
        format!("{{\"note\":\"x\",\"speed_m_s\":{speed}{}}}", corners.collect::<String>()).into_bytes()
    };
    let arrays = |k: u32| {
        let (_, bodies, wheels) = sample(k);
        format!("{{\"id\":null,\"susp\":{{\"body_accel_m_s2\":{bodies:?},\"wheel_accel_m_s2\":{wheels:?}}}}}")
            .into_bytes()
    };
    let speed = |k: u32| format!("{{\"v\":{{\"vehicle_speed_kmh\":{}}}}}", sample(k).0 * 3.6).into_bytes();
    let topic =
        |name, message| Topic { name, encoding: "json", schema: ("any", "jsonschema", b"{}"), message };
    for compression in [None, Some(Compression::Lz4), Some(Compression::Zstd)] {
        check(&write(compression, |_| 0, &[topic("/car", &flat)]), "flat");
    }
    check(&write(None, |_| 0, &[topic("/chassis", &arrays), topic("/speed", &speed)]), "arrays");
}

/// Numbers of CDR, each at a multiple of its size.
#[derive(Default)]
struct Cdr {
    bytes: Vec<u8>,
    big_endian: bool,
    packed: bool,
}

impl Cdr {
    fn put<const N: usize>(&mut self, little: [u8; N]) {
        while !self.packed && !self.bytes.len().is_multiple_of(N) {
            self.bytes.push(0);
        }
        let mut bytes = little;
        if self.big_endian {
            bytes.reverse();
        }
        self.bytes.extend_from_slice(&bytes);
    }

    fn text(&mut self, text: &str) {
        let zero = usize::from(!self.packed);
        self.put(((text.len() + zero) as u32).to_le_bytes());
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.resize(self.bytes.len() + zero, 0);
    }
}

const IMU: &str = "# of one mass\nstd_msgs/Header header\nfloat64[9] covariance\nint8 KIND=3\nuint8 mode  # none\ngeometry_msgs/Vector3 linear_acceleration\nstring[] notes\n================================================================================\nMSG: std_msgs/Header\nSTAMP\nstring frame_id\n================================================================================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n================================================================================\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z 0\n";

#[test]
fn ros_is_read_by_its_definition_and_at_its_own_stamps() {
    let imu = |k: u32, mut cdr: Cdr, z: f64| {
        if cdr.packed {
            cdr.put(k.to_le_bytes());
        }
        cdr.put(((time_ns(k) / 1_000_000_000) as u32).to_le_bytes());
        cdr.put(((time_ns(k) % 1_000_000_000) as u32).to_le_bytes());
        cdr.text("frame");
        (0..9).for_each(|_| cdr.put(0.5_f64.to_le_bytes()));
        cdr.put([7]);
        [1.0, 2.0, z].iter().for_each(|value: &f64| cdr.put(value.to_le_bytes()));
        cdr.put(2_u32.to_le_bytes());
        ["a", "longer"].iter().for_each(|text| cdr.text(text));
        let head = if cdr.packed { Vec::new() } else { vec![0, u8::from(!cdr.big_endian), 0, 0] };
        [head, cdr.bytes].concat()
    };
    let bench = Bench::new();
    for (encoding, schema, big_endian) in
        [("cdr", "ros2msg", false), ("cdr", "ros2msg", true), ("ros1", "ros1msg", false)]
    {
        let packed = encoding == "ros1";
        let text = IMU.replace(
            "STAMP",
            if packed { "uint32 seq\ntime stamp" } else { "builtin_interfaces/Time stamp" },
        );
        let cdr = || Cdr { bytes: Vec::new(), big_endian, packed };
        let masses: Vec<(String, usize, bool)> = (0..4)
            .flat_map(|c| [true, false].map(|body| (c, body)))
            .map(|(c, body)| {
                let mass = if body { "body" } else { "wheel" };
                (format!("/{mass}/{}/imu", ["fl", "fr", "rl", "rr"][c]), c, body)
            })
            .collect();
        let values = masses.iter().map(|(_, c, body)| {
            move |k: u32| {
                let (_, bodies, wheels) = sample(k);
                imu(k, cdr(), if *body { bodies[*c] } else { wheels[*c] })
            }
        });
        let values: Vec<_> = values.collect();
        let speed = |k: u32| format!("{{\"speed_m_s\":{}}}", sample(k).0).into_bytes();
        let mut topics: Vec<Topic<'_>> = masses
            .iter()
            .zip(&values)
            .map(|((name, ..), message)| Topic {
                name,
                encoding,
                schema: ("sensor_msgs/msg/Imu", schema, text.as_bytes()),
                message,
            })
            .collect();
        topics.push(Topic {
            name: "/speed",
            encoding: "json",
            schema: ("any", "jsonschema", b"{}"),
            message: &speed,
        });
        // The recorder is late by up to 2 ms, the sensors' stamps are not.
        let late_ns = |k: u32| u64::from(k * 7919 % 2001) * 1000;
        let bytes = write(Some(Compression::Zstd), late_ns, &topics);
        let (rows, messages) = read_bytes(&bench, &bytes).unwrap();
        assert_eq!((rows.len(), messages), (SAMPLES as usize, Vec::new()), "{encoding} {big_endian}");
        for (k, row) in (0..).zip(&rows) {
            assert!((row.time_s - time_ns(k) as f64 / 1e9).abs() < 1e-6, "{encoding} {k}");
            assert_eq!(
                row.corners.map(|corner| corner.unwrap().wheel_accel_m_s2),
                sample(k).2,
                "{encoding} {k}"
            );
            assert_eq!(
                row.corners.map(|corner| corner.unwrap().body_accel_m_s2),
                sample(k).1,
                "{encoding} {k}"
            );
        }
    }
}

#[test]
fn protobuf_is_read_by_its_description_and_zeros_that_are_not_sent_are_zeros() {
    let field = |name: &str, number, kind: Type| FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        label: Some(Label::Optional.into()),
        r#type: Some(kind.into()),
        ..FieldDescriptorProto::default()
    };
    let corner = DescriptorProto {
        name: Some("Corner".to_owned()),
        field: vec![field("body_accel_m_s2", 1, Type::Double), field("wheel_accel_m_s2", 2, Type::Float)],
        ..DescriptorProto::default()
    };
    let corners = ["fl", "fr", "rl", "rr"].iter().zip(2..).map(|(name, number)| FieldDescriptorProto {
        type_name: Some(".demo.Corner".to_owned()),
        ..field(name, number, Type::Message)
    });
    let car = DescriptorProto {
        name: Some("Car".to_owned()),
        field: [field("speed_m_s", 1, Type::Float)].into_iter().chain(corners).collect(),
        ..DescriptorProto::default()
    };
    let file = FileDescriptorProto {
        name: Some("car.proto".to_owned()),
        package: Some("demo".to_owned()),
        message_type: vec![corner, car],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    let schema = FileDescriptorSet { file: vec![file] }.encode_to_vec();
    let pool = DescriptorPool::decode(schema.as_slice()).unwrap();
    let [car, corner] = ["demo.Car", "demo.Corner"].map(|name| pool.get_message_by_name(name).unwrap());
    let message = |k: u32| {
        let (speed, bodies, wheels) = sample(k);
        let mut of_car = DynamicMessage::new(car.clone());
        of_car.set_field_by_name("speed_m_s", Value::F32(speed as f32));
        for (c, name) in ["fl", "fr", "rl", "rr"].iter().enumerate() {
            let mut of_corner = DynamicMessage::new(corner.clone());
            of_corner.set_field_by_name("body_accel_m_s2", Value::F64(bodies[c]));
            of_corner.set_field_by_name("wheel_accel_m_s2", Value::F32(wheels[c] as f32));
            of_car.set_field_by_name(name, Value::Message(of_corner));
        }
        of_car.encode_to_vec()
    };
    let topic = Topic {
        name: "/car",
        encoding: "protobuf",
        schema: ("demo.Car", "protobuf", &schema),
        message: &message,
    };
    let bytes = write(Some(Compression::Zstd), |_| 0, &[topic]);
    check(&bytes, "protobuf");
}

#[test]
fn what_this_program_writes_comes_back_and_its_estimates_are_no_measurements() {
    let bench = Bench::new();
    let row = |k: u32| {
        let (speed, bodies, wheels) = sample(k);
        format!("{:.3},{speed},{},{},241.5\n", f64::from(k) * 0.005, bodies[0], wheels[0])
    };
    let head = "time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2,fl_pressure_kpa\n";
    let text = bench.write("drive.csv", head.to_owned() + &(0..SAMPLES).map(row).collect::<String>());
    let options = LogOptions { units: UnitCheck::Trusting, ..LogOptions::default() };
    let request = Request {
        input: &text,
        output: &bench.path("drive.mcap"),
        options: &options,
        packing: Packing::Packed,
        position: false,
    };
    convert(&request, &mut |_| std::ops::ControlFlow::Continue(())).unwrap().unwrap().file.commit().unwrap();
    for (back, row) in read(&bench.path("drive.mcap")).unwrap().0.iter().zip(read(&text).unwrap().0) {
        assert_eq!(format!("{back:?}"), format!("{row:?}"));
    }
    assert_eq!(read(&bench.path("drive.mcap")).unwrap().0.len(), SAMPLES as usize);
}

#[test]
fn a_file_that_is_cut_off_or_none_says_so() {
    let flat = |k: u32| {
        let (speed, bodies, wheels) = sample(k);
        format!(
            "{{\"speed_m_s\":{speed},\"fl_body_accel_m_s2\":{},\"fl_wheel_accel_m_s2\":{}}}",
            bodies[0], wheels[0]
        )
        .into_bytes()
    };
    let opaque = |_: u32| vec![1, 2, 3];
    let topics = [
        Topic { name: "/car", encoding: "json", schema: ("any", "jsonschema", b"{}"), message: &flat },
        Topic { name: "/odd", encoding: "cbor", schema: ("any", "", b""), message: &opaque },
    ];
    let bench = Bench::new();
    let bytes = write(Some(Compression::Zstd), |_| 0, &topics);
    let (rows, messages) = read_bytes(&bench, &bytes[..bytes.len() / 2]).unwrap();
    assert!(rows.len() > 100 && rows.len() < 700, "{}", rows.len());
    assert_eq!(messages, ["the file is cut off; what is whole was read"]);
    let listing = listed(&bench.path("drive.mcap"));
    assert_eq!((listing.kind, listing.unread.len()), ("topic", 1));
    assert!(listing.unread[0].why.contains("cbor"), "{:?}", listing.unread);
    // Any damage is an end or an error, and no panic.
    let plain = write(None, |_| 0, &topics);
    for at in (8..plain.len()).step_by(397) {
        let mut damaged = plain.clone();
        damaged[at] ^= 0xFF;
        let messages =
            read_bytes(&bench, &damaged).map_or_else(|error| error, |(_, messages)| messages.join(" "));
        assert_eq!(messages.lines().count().max(1), 1, "{at}: {messages}");
    }
    let text = read_bytes(&bench, b"no MCAP at all, and longer than its beginning").unwrap_err();
    assert!(text.contains("does not begin as an MCAP file"), "{text}");
    assert!(read_bytes(&bench, b"").unwrap_err().contains("the file is empty, expected an MCAP file"));
    let none = [Topic { name: "/odd", encoding: "cbor", schema: ("any", "", b""), message: &opaque }];
    let text = read_bytes(&bench, &write(None, |_| 0, &none)).unwrap_err();
    assert!(text.contains("/odd is messages in \"cbor\""), "{text}");
}
