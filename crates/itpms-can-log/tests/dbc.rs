//! DBC files by hand, with values by hand: both byte orders, signs, floats, multiplexing, long identifiers, CAN FD, and what is broken.

use std::path::Path;

use itpms_can_log::dbc::{Dbc, Message};
use itpms_can_log::{CanId, Payload};

fn dbc(text: &str) -> Dbc {
    let dbc = Dbc::parse(text).unwrap();
    assert_eq!(dbc.problems(), []);
    dbc
}

fn standard(dbc: &Dbc, id: u32) -> &Message {
    dbc.message(CanId::standard(id).unwrap()).unwrap()
}

fn decoded(message: &Message, data: &[u8]) -> Vec<(String, f64)> {
    let mut values = Vec::new();
    message.decode(data, |place, value| values.push((message.signals[place].name.clone(), value)));
    values
}

fn named(values: &[(&str, f64)]) -> Vec<(String, f64)> {
    values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

#[test]
fn both_byte_orders_with_sign_and_scale() {
    let dbc = dbc(r#"
BO_ 291 M: 8 X
 SG_ IntelUnsigned : 0|16@1+ (0.5,-100) [0|0] "km/h" Y
 SG_ IntelSigned : 20|12@1- (1,0) [0|0] "" Y,Z
 SG_ MotorolaUnsigned : 39|12@0+ (1,0) [0|0] "" Y
 SG_ MotorolaSigned : 43|12@0- (0.1,0) [0|0] "" Y
"#);
    // Bytes 34 12: 0x1234 = 4660, half of it less 100. Bits 20 to 31: upper half of byte 2, byte 3: 0xABC -> negative.
    // Motorola from bit 39, the top of byte 4: 0xDEF. Then 0x801, negative: -2047.
    let data = [0x34, 0x12, 0xC0, 0xAB, 0xDE, 0xF8, 0x01, 0x00];
    assert_eq!(
        decoded(standard(&dbc, 291), &data),
        named(&[
            ("IntelUnsigned", 2230.0),
            ("IntelSigned", f64::from(0xABC - 0x1000)),
            ("MotorolaUnsigned", f64::from(0xDEF)),
            ("MotorolaSigned", -2047.0 * 0.1),
        ])
    );
    assert_eq!(standard(&dbc, 291).signals[1].receivers, ["Y", "Z"]);
}

#[test]
fn floats_and_64_bits() {
    let dbc = dbc(r#"
BO_ 1 M: 16 X
 SG_ Single : 7|32@0- (1,0) [0|0] "" Y
 SG_ Double : 32|64@1- (2,1) [0|0] "" Y
BO_ 2 N: 8 X
 SG_ Long : 7|64@0+ (1,0) [0|0] "" Y
SIG_VALTYPE_ 1 Single : 1;
SIG_VALTYPE_ 1 Double : 2;
"#);
    // IEEE 754: 1.5 is 3FC00000, -0.75 is BFE8000000000000.
    let data = [0x3F, 0xC0, 0, 0, 0, 0, 0, 0, 0, 0, 0xE8, 0xBF, 0, 0, 0, 0];
    assert_eq!(decoded(standard(&dbc, 1), &data), named(&[("Single", 1.5), ("Double", -0.5)]));
    let data = [0x80, 0, 0, 0, 0, 0, 0, 0];
    assert_eq!(decoded(standard(&dbc, 2), &data), named(&[("Long", 9_223_372_036_854_775_808.0)]));
    assert!(standard(&dbc, 1).fd && !standard(&dbc, 2).fd);
}

#[test]
fn a_multiplexer_selects_and_is_selected() {
    let dbc = dbc(r#"
BO_ 1 Simple: 8 X
 SG_ Page M : 0|8@1+ (1,0) [0|0] "" Y
 SG_ Always : 8|8@1+ (1,0) [0|0] "" Y
 SG_ OnZero m0 : 16|8@1+ (1,0) [0|0] "" Y
 SG_ OnSeven m7 : 16|8@1+ (10,0) [0|0] "" Y
BO_ 2 Extended: 8 X
 SG_ Outer M : 0|4@1+ (1,0) [0|0] "" Y
 SG_ Inner m1M : 4|4@1+ (1,0) [0|0] "" Y
 SG_ Deep m2 : 8|8@1+ (1,0) [0|0] "" Y
 SG_ Ranged m0 : 8|8@1+ (1,0) [0|0] "" Y
SG_MUL_VAL_ 2 Inner Outer 1-1;
SG_MUL_VAL_ 2 Deep Inner 2-3, 9-9;
SG_MUL_VAL_ 2 Ranged Outer 4-6;
"#);
    let simple = standard(&dbc, 1);
    assert_eq!(
        decoded(simple, &[0, 5, 6, 0, 0, 0, 0, 0]),
        named(&[("Page", 0.0), ("Always", 5.0), ("OnZero", 6.0)])
    );
    assert_eq!(
        decoded(simple, &[7, 5, 6, 0, 0, 0, 0, 0]),
        named(&[("Page", 7.0), ("Always", 5.0), ("OnSeven", 60.0)])
    );
    assert_eq!(decoded(simple, &[1, 5, 6, 0, 0, 0, 0, 0]), named(&[("Page", 1.0), ("Always", 5.0)]));
    let extended = standard(&dbc, 2);
    for (byte, expected) in [
        (0x21, named(&[("Outer", 1.0), ("Inner", 2.0), ("Deep", 8.0)])),
        (0x91, named(&[("Outer", 1.0), ("Inner", 9.0), ("Deep", 8.0)])),
        (0x41, named(&[("Outer", 1.0), ("Inner", 4.0)])),
        // The inner one's bits say 2, but the outer one does not select it.
        (0x22, named(&[("Outer", 2.0)])),
        (0x25, named(&[("Outer", 5.0), ("Ranged", 8.0)])),
    ] {
        assert_eq!(decoded(extended, &[byte, 8, 0, 0, 0, 0, 0, 0]), expected, "{byte:02X}");
    }
}

#[test]
fn identifiers_attributes_labels_and_comments() {
    let dbc = dbc(r#"
VERSION "x"
NS_ :
    NS_DESC_
    CM_
    SG_MUL_VAL_
BS_:
BU_: A B
 C
VAL_TABLE_ T 1 "a; b" 0 "c" ;
BO_ 2147484004 Same: 8 A
 SG_ S : 0|8@1+ (1,0) [0|0] "°C" Vector__XXX
BO_ 356 Other: 8 A
 SG_ S : 0|8@1+ (1,0) [0|0] "" Vector__XXX
BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX
 SG_ Orphan : 0|8@1+ (1,0) [0|0] "" Vector__XXX
CM_ "of
everything; SG_ and
 BO_ 5 in it";
CM_ SG_ 356 S "two
lines with \"quotes\"";
CM_ BO_ 356 "a message";
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 1000;
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","StandardCAN_FD";
BA_DEF_DEF_ "GenMsgCycleTime" 100;
BA_ "GenMsgCycleTime" BO_ 356 20;
BA_ "VFrameFormat" BO_ 356 2;
BA_ "BusType" "CAN FD";
VAL_ 356 S 255 "SNA" 0 "zero" ;
SIG_GROUP_ 356 G 1 : S;
"#);
    assert_eq!(dbc.messages().len(), 2);
    let long = dbc.message(CanId::extended(356).unwrap()).unwrap();
    assert_eq!((long.name.as_str(), long.cycle_s, long.fd), ("Same", Some(0.1), false));
    let short = standard(&dbc, 356);
    assert_eq!((short.name.as_str(), short.cycle_s, short.fd), ("Other", Some(0.02), true));
    assert_eq!(short.comment, "a message");
    assert_eq!(short.signals[0].comment, "two\nlines with \"quotes\"");
    assert_eq!(short.signals[0].labels, [(255, "SNA".to_owned()), (0, "zero".to_owned())]);
    assert!(short.signals[0].is_not_available(255) && !short.signals[0].is_not_available(0));
    assert_eq!(long.signals[0].unit, "°C");
    // The same in code page 1252.
    let bytes = b"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m/s\xb2\" Y\n";
    assert_eq!(Dbc::from_bytes(bytes).unwrap().messages()[0].signals[0].unit, "m/s²");
}

/// The problems of this text, one per line of the answer.
fn problems(text: &str) -> Vec<String> {
    let good = "BO_ 9 Good: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" Y\n";
    let dbc = Dbc::parse(&format!("{good}{text}")).unwrap();
    assert_eq!(standard(&dbc, 9).signals.len(), 1);
    dbc.problems().iter().map(ToString::to_string).collect()
}

#[test]
fn what_is_broken_is_named_and_the_rest_is_read() {
    for (text, expected) in [
        (
            "BO_ 1 M: 2 X\n SG_ A : 8|9@1+ (1,0) [0|0] \"\" Y\n SG_ B : 0|8@1+ (1,0) [0|0] \"\" Y\n",
            "line 4: message M, signal A: 9 bits from bit 8 on do not lie within the message's 2 bytes; left out",
        ),
        (
            "BO_ 1 M: 2 X\n SG_ A : 0|9@0+ (1,0) [0|0] \"\" Y\n SG_ B : 0|10@0+ (1,0) [0|0] \"\" Y\n",
            "line 5: message M, signal B: 10 bits from bit 0 on do not lie within the message's 2 bytes; left out",
        ),
        (
            "BO_ 1 M: 2 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" Y\n SG_ B : 7|2@1+ (1,0) [0|0] \"\" Y\n",
            "line 5: message M: signal B overlaps A (line 4); both are kept",
        ),
        (
            "BO_ 1 M: 2 X\n SG_ A : 0|65@1+ (1,0) [0|0] \"\" Y\n",
            "line 4: message M, signal A: 65 bits, expected 1 to 64; left out",
        ),
        (
            "BO_ 1 M: 2 X\n SG_ A : 0|8@1+ (0,0) [0|0] \"\" Y\n",
            "line 4: message M, signal A: the factor is 0, expected another number; left out",
        ),
        (
            "BO_ 1 M: 2 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" Y\n SG_ A : 8|8@1+ (1,0) [0|0] \"\" Y\n",
            "line 5: message M has a second signal A (first in line 4); left out",
        ),
        (
            "BO_ 9 M: 2 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" Y\n",
            "line 3: message M has the identifier of Good (line 1); left out",
        ),
        (
            "BO_ 2048 M: 2 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" Y\n",
            "line 3: message M has identifier 2048, expected at most 2047, or with bit 31 set at most 29 bits more; \
             left out",
        ),
        ("BO_ 1 M: 65 X\n", "line 3: message M has 65 bytes, expected at most 64; left out"),
        (
            "BO_ 1 M: 2 X\n SG_ A m0 : 0|8@1+ (1,0) [0|0] \"\" Y\n",
            "line 4: message M, signal A: its multiplexer (M) is not there; left out",
        ),
        (
            "BO_ 1 M: 4 X\n SG_ P M : 0|8@1+ (1,0) [0|0] \"\" Y\n SG_ Q M : 8|8@1+ (1,0) [0|0] \"\" Y\n \
             SG_ A m0 : 16|8@1+ (1,0) [0|0] \"\" Y\n",
            "line 6: message M, signal A: 2 multiplexers and no SG_MUL_VAL_ that says which; left out",
        ),
        (
            "BO_ 1 M: 2 X\n SG_ A : 0|8@1- (1,0) [0|0] \"\" Y\nSIG_VALTYPE_ 1 A : 1;\n",
            "line 4: message M, signal A: a float of 8 bits, expected 32; left out",
        ),
        (
            "SIG_VALTYPE_ 1 A : 1;\n",
            "line 3: SIG_VALTYPE_ speaks of signal A of message 1, which is not there; passed over",
        ),
        (
            "Hello, world\n",
            "line 3: found \"Hello, world\", expected a statement such as BO_ or SG_; passed over",
        ),
        (
            " SG_ A : 0|8@1+ (1.2.3,0) [0|0] \"\" Y\n",
            "line 3: SG_: found \"1.2.3,0) [0|0] \\\"\\\" Y\", expected a finite factor; left out",
        ),
        (
            " SG_ A : 0|8@1+ (1,0) [0|1e999] \"\" Y\n",
            "line 3: SG_: found \"1e999] \\\"\\\" Y\", expected a finite maximum; left out",
        ),
        (
            " SG_ A : 0|8@2+ (1,0) [0|0] \"\" Y\n",
            "line 3: SG_: found \"2+ (1,0) [0|0] \\\"\\\" Y\", expected 1+, 1-, 0+ or 0- (byte order and sign); left out",
        ),
        (
            " SG_ A : 0|8@1+ (1,0) [0|0] \"m\n\n",
            "line 3: SG_: found no end of a string, expected a quote; left out",
        ),
        ("BO_ x M: 8 X\n", "line 3: BO_: found \"x M: 8 X\", expected an identifier; left out"),
        (
            "CM_ BO_ 9 \"half\nVAL_ 9 S 1 \"on\" ;\n",
            "line 3: CM_: found \"on\\\" ;\", expected a semicolon after the comment; left out",
        ),
    ] {
        assert_eq!(problems(text), [expected], "{text}");
    }
}

#[test]
fn multiplexers_in_a_circle_and_those_who_depend_on_them_are_left_out() {
    let text = "BO_ 1 M: 8 X\n SG_ A m0M : 0|8@1+ (1,0) [0|0] \"\" Y\n SG_ B m0M : 8|8@1+ (1,0) [0|0] \"\" Y\n \
                SG_ C m0 : 16|8@1+ (1,0) [0|0] \"\" Y\n SG_ D : 24|8@1+ (1,0) [0|0] \"\" Y\n\
                SG_MUL_VAL_ 1 A B 0-0;\nSG_MUL_VAL_ 1 B A 0-0;\nSG_MUL_VAL_ 1 C B 0-0;\n";
    let found = problems(text);
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found.iter().all(|problem| problem.ends_with("its multiplexers select each other; left out")));
}

#[test]
fn a_file_without_a_message_is_refused() {
    let text = Dbc::parse("").unwrap_err().to_string();
    assert_eq!(text, "no message with a usable signal in 1 lines, expected a DBC file (BO_ and SG_)");
    let text = Dbc::parse("<html>\n</html>\n").unwrap_err().to_string();
    assert!(text.contains("; line 1: found \"<html>\", expected a statement"), "{text}");
    let error = Dbc::read(Path::new("no-such.dbc")).unwrap_err().to_string();
    assert_eq!(error, "no-such.dbc: no such file");
}

#[test]
fn a_short_frame_has_the_signals_that_are_in_it() {
    let dbc = dbc("BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" Y\n SG_ B : 15|16@0+ (1,0) [0|0] \"\" Y\n");
    assert_eq!(decoded(standard(&dbc, 1), &[1, 2]), named(&[("A", 1.0)]));
    assert_eq!(decoded(standard(&dbc, 1), &[1, 2, 3]), named(&[("A", 1.0), ("B", f64::from(0x0203))]));
    assert_eq!(decoded(standard(&dbc, 1), &[]), []);
}

#[test]
fn encoding_rounds_and_keeps_to_the_range() {
    let dbc = dbc(r#"
BO_ 1 M: 9 X
 SG_ U : 0|8@1+ (0.5,0) [0|100] "" Y
 SG_ S : 15|16@0- (0.01,0) [0|0] "" Y
 SG_ F : 24|32@1- (1,0) [0|0] "" Y
 SG_ P M : 56|2@1+ (1,0) [0|0] "" Y
 SG_ X m0 : 58|6@1+ (1,0) [0|0] "" Y
 SG_ Y m1 : 58|6@1+ (1,0) [0|0] "" Y
SIG_VALTYPE_ 1 F : 1;
VAL_ 1 S -32768 "SNA" ;
"#);
    let message = standard(&dbc, 1);
    let encode =
        |values: [f64; 6]| message.encode(|place| values[place]).map(|data| data.as_slice().to_vec());
    // 12.26 is nearest to 12.5 (raw 25); -3.275 to -3.28 or -3.27; 1.5 as above; page 1 with 9 in it.
    let data = encode([12.26, -3.27, 1.5, 1.0, 5.0, 9.0]).unwrap();
    // Nine bytes are no length of a frame, twelve are.
    assert_eq!(data, [25, 0xFE, 0xB9, 0, 0, 0xC0, 0x3F, 1 | 9 << 2, 0, 0, 0, 0]);
    // Beyond the range of the file (100), beyond that of the bits (327.67, three of 64).
    let data = encode([1e9, 1e9, 1e300, 77.0, 5.0, 9.0]).unwrap();
    let f32_max = f32::MAX.to_le_bytes();
    assert_eq!(data[..8], [200, 0x7F, 0xFF, f32_max[0], f32_max[1], f32_max[2], f32_max[3], 3]);
    // Nothing to say: by its label where there is one, as a float, else an error.
    let data = encode([0.0, f64::NAN, f64::NAN, 0.0, 0.0, 0.0]).unwrap();
    assert_eq!(data[1..3], [0x80, 0x00]);
    assert!(message.signals[2].physical(message.raw(2, &data).unwrap()).is_nan());
    assert_eq!(
        encode([f64::NAN; 6]).unwrap_err().to_string(),
        "message M, signal U: has no value, and no label that says so (SNA), expected a number"
    );
}

#[test]
fn a_payload_is_never_longer_than_a_frame() {
    let dbc = dbc("BO_ 1 M: 64 X\n SG_ A : 504|8@1+ (1,0) [0|0] \"\" Y\n");
    let data = standard(&dbc, 1).encode(|_| 7.0).unwrap();
    assert_eq!((data.len(), data.as_slice()[63]), (Payload::MOST, 7));
}

const J1939: &str = r#"
BO_ 2566852862 Speed: 8 ESP
 SG_ VehicleSpeed : 0|16@1+ (0.01,0) [0|655.34] "km/h" SUSP

BO_ 2552236798 ToOneNode: 8 ESP
 SG_ Torque : 0|8@1+ (1,0) [0|255] "" SUSP

BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";
BA_ "VFrameFormat" BO_ 2566852862 3;
BA_ "VFrameFormat" BO_ 2552236798 3;
"#;

#[test]
fn a_parameter_group_is_itself_whoever_sends_it() {
    let dbc = Dbc::parse(J1939).unwrap();
    let name = |id: u32| dbc.message(CanId::extended(id).unwrap()).map(|message| message.name.as_str());
    // 0x18FF10FE: group 0xFF10 from the null address; from 0x0B, and with another priority.
    assert_eq!(name(0x18FF_10FE), Some("Speed"));
    assert_eq!(name(0x18FF_100B), Some("Speed"));
    assert_eq!(name(0x0CFF_100B), Some("Speed"));
    // From 0xF0 on the byte that follows is the group's.
    assert_eq!(name(0x18FF_110B), None);
    // Below 0xF0 that byte is the node that it is for.
    assert_eq!(name(0x1820_210B), Some("ToOneNode"));
    // Other files mean the identifier as it stands.
    let plain = Dbc::parse(&J1939.replace("J1939PG", "Other")).unwrap();
    assert!(plain.message(CanId::extended(0x18FF_100B).unwrap()).is_none());
    // The whole bus, where no message says it.
    let (messages, _) = J1939.split_once("BA_DEF_").unwrap();
    let bus = Dbc::parse(&format!("{messages}BA_ \"ProtocolType\" \"J1939\";\n")).unwrap();
    assert!(bus.message(CanId::extended(0x18FF_100B).unwrap()).is_some());
}

#[test]
fn names_that_were_shortened_are_read_in_full() {
    let text = r#"
BO_ 528 Suspension_Of_The_Front_Axle_Le: 4 SUSP
 SG_ Wheel_Vertical_Acceleration_FL_T : 0|16@1- (0.01,0) [0|0] "m/s^2" ESP
 SG_ Short : 16|16@1- (0.01,0) [0|0] "m/s^2" ESP

BA_DEF_ BO_ "SystemMessageLongSymbol" STRING ;
BA_DEF_ SG_ "SystemSignalLongSymbol" STRING ;
BA_DEF_DEF_ "SystemSignalLongSymbol" "";
BA_ "SystemMessageLongSymbol" BO_ 528 "Suspension_Of_The_Front_Axle_Left";
BA_ "SystemSignalLongSymbol" SG_ 528 Wheel_Vertical_Acceleration_FL_T "Wheel_Vertical_Acceleration_FL_Target_Of_Control";
VAL_ 528 Wheel_Vertical_Acceleration_FL_T -32768 "SNA" ;
"#;
    let dbc = Dbc::parse(text).unwrap();
    assert!(dbc.problems().is_empty(), "{:?}", dbc.problems());
    let message = &dbc.messages()[0];
    assert_eq!(message.name, "Suspension_Of_The_Front_Axle_Left");
    assert_eq!(message.signals[0].name, "Wheel_Vertical_Acceleration_FL_Target_Of_Control");
    assert_eq!(
        message.signals[0].labels.len(),
        1,
        "what stands after the attribute calls it by the short name"
    );
    assert_eq!(message.signals[1].name, "Short");
}
