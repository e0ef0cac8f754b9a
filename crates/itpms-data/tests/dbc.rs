//! Which signals of a bus are columns, and what becomes of its frames.
#![cfg(feature = "can")]

use std::path::Path;

use itpms_data::can::{CanFrame, CanId};
use itpms_data::dbc::{Dbc, Decoder, candidates};
use itpms_data::log::Slot;
use itpms_data::signals::{SignalMap, resolve};

fn dbc(text: &str) -> Dbc {
    let dbc = Dbc::parse(text).unwrap();
    assert_eq!(dbc.problems(), []);
    dbc
}

#[test]
fn a_decoder_hands_on_what_is_mapped_and_counts_the_rest() {
    let dbc = dbc(r#"
BO_ 1 ESP: 4 X
 SG_ VehicleSpeed : 7|16@0+ (0.01,0) [0|655.34] "km/h" Y
 SG_ YawRate : 23|16@0- (0.01,0) [0|0] "deg/s" Y
BO_ 2 Other: 4 X
 SG_ Counter : 0|8@1+ (1,0) [0|0] "" Y
VAL_ 1 VehicleSpeed 65535 "SNA" ;
"#);
    let mut decoder = Decoder::new(dbc.clone(), None).unwrap();
    assert_eq!(decoder.slots(), [Slot::Speed]);
    let frame = |time_s, id, data: &[u8]| CanFrame::new(time_s, CanId::standard(id).unwrap(), data).unwrap();
    let mut frames = vec![
        frame(0.0, 1, &[0x0E, 0x10, 0, 0]),
        frame(0.1, 1, &[0xFF, 0xFF, 0, 0]),
        frame(0.2, 1, &[0x0E]),
        frame(0.3, 2, &[1, 2, 3, 4]),
        frame(0.4, 3, &[1, 2, 3, 4]),
    ];
    let mut elsewhere = frames[0];
    elsewhere.bus = 1;
    let mut remote = frames[0];
    remote.kind = itpms_data::can::FrameKind::Remote;
    frames.extend([elsewhere, remote]);
    let mut readings = Vec::new();
    for frame in &frames {
        decoder.decode(frame, &mut |reading| readings.push(reading));
    }
    // 0x0E10 is 3600: 36 km/h, 10 m/s.
    assert!((readings[0].value - 10.0).abs() < 1e-12 && readings[0].time_s == 0.0);
    assert!(readings[1].value.is_nan() && readings.len() == 2);
    let counts = decoder.counts();
    assert_eq!((counts.frames, counts.used, counts.other, counts.unknown), (7, 3, 1, 1));
    assert_eq!((counts.short, counts.other_bus, counts.without_data, counts.not_available), (1, 1, 1, 1));
    // A map that asks for what is not there.
    let map =
        SignalMap::parse("[signals]\nspeed_m_s = \"ESP.VehicelSpeed\"\n", Path::new("map.toml")).unwrap();
    let text = Decoder::new(dbc, Some(&map)).unwrap_err().to_string();
    assert!(text.ends_with("the nearest name of 3 is \"ESP.VehicleSpeed\""), "{text}");
}

#[test]
fn the_example_car_is_mapped() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/can");
    let dbc = Dbc::read(&folder.join("car.dbc")).unwrap();
    assert_eq!(dbc.problems(), []);
    let map = SignalMap::read(&folder.join("map.toml")).unwrap();
    // Everything but the time.
    let of_the_car = |slot: &Slot| {
        let others = ["_wheel_speed_", "_tpms_"];
        matches!(slot, Slot::Motion(_) | Slot::Air(_) | Slot::Position(_) | Slot::Axle(_))
            || others.iter().any(|other| slot.name().contains(other))
    };
    let all: Vec<Slot> = Slot::all().filter(|slot| *slot != Slot::Time && !of_the_car(slot)).collect();
    assert_eq!(Decoder::new(dbc.clone(), Some(&map)).unwrap().slots(), all);
    // By names alone: all but the wheels, which this car calls axles.
    let by_names = Decoder::new(dbc, None).unwrap();
    assert_eq!(by_names.slots().len(), all.len() - 4);
    assert!(by_names.resolved().unusable().is_some());
}

const J1939: &str = r#"
BO_ 2566852862 Speed: 8 ESP
 SG_ VehicleSpeed : 0|16@1+ (0.01,0) [0|655.34] "km/h" SUSP

BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";
BA_ "VFrameFormat" BO_ 2566852862 3;
"#;

#[test]
fn of_two_senders_of_a_group_the_first_counts_unless_the_other_is_the_described_one() {
    let dbc = Dbc::parse(J1939).unwrap();
    let mut decoder = Decoder::new(dbc, None).unwrap();
    let mut speeds = |id: u32, raw: u16| {
        let data = [raw.to_le_bytes().to_vec(), vec![0; 6]].concat();
        let frame = CanFrame::new(0.0, CanId::extended(id).unwrap(), &data).unwrap();
        let mut found = Vec::new();
        decoder.decode(&frame, &mut |reading| found.push(reading.value));
        found
    };
    assert_eq!(speeds(0x18FF_100B, 3600), [10.0]);
    assert!(speeds(0x18FF_1021, 7200).is_empty());
    assert_eq!(speeds(0x18FF_10FE, 7200), [20.0]);
    assert!(speeds(0x18FF_100B, 3600).is_empty());
    assert_eq!(decoder.counts().other_sender, 2);
}

#[test]
fn a_target_whose_name_was_shortened_is_no_measurement() {
    let dbc = dbc(r#"
BO_ 528 SUSP_Left: 4 SUSP
 SG_ Wheel_Vertical_Acceleration_FL_T : 0|16@1- (0.01,0) [0|0] "m/s^2" ESP
 SG_ Short : 16|16@1- (0.01,0) [0|0] "m/s^2" ESP

BA_DEF_ SG_ "SystemSignalLongSymbol" STRING ;
BA_ "SystemSignalLongSymbol" SG_ 528 Wheel_Vertical_Acceleration_FL_T "Wheel_Vertical_Acceleration_FL_Target_Of_Control";
"#);
    // A target is no measurement; without the attribute it could not be known.
    assert!(resolve(&candidates(&dbc), None).unwrap().iter().next().is_none());
}
