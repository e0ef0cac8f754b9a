//! Whatever is in a DBC file or a frame: an answer, no panic; and what is encoded decodes to the same.

use std::fmt::Write as _;

use itpms_can_log::dbc::{Dbc, Kind, Message};
use proptest::prelude::*;

use crate::damage::Lcg;

const CAR: &[u8] = include_bytes!("../../../examples/can/car.dbc");
/// What car.dbc has not: multiplexing, floats, long identifiers, CAN FD, attributes.
const RICH: &[u8] = include_bytes!("data/rich.dbc");

/// Everything that can be done with a description, with these data in every message.
fn exercise(bytes: &[u8], data: &[u8]) {
    let Ok(dbc) = Dbc::from_bytes(bytes) else { return };
    for message in dbc.messages() {
        message.decode(data, |place, _| assert!(place < message.signals.len()));
        if let Ok(payload) = message.encode(|place| place as f64) {
            assert_eq!(payload.len(), message.frame_length());
            message.decode(payload.as_slice(), |_, _| {});
        }
    }
    dbc.problems().iter().for_each(|problem| assert!(problem.to_string().len() < 2000));
}

#[rustfmt::skip]
const PIECES: [&[u8]; 24] = [
    b"\"", b";", b"\n", b" ", b"M ", b"m0 ", b"m1M ", b"BO_ ", b" SG_ ", b"VAL_ ", b"SG_MUL_VAL_ ", b"SIG_VALTYPE_ ", b"CM_ ",
    b"0", b"99999999999999999999", b"-1", b"1e400", b"@0-", b"|", b"\xff", b"\\\"", b"4294967295", b"\xef\xbf\xbd", b"BA_ ",
];

/// One to eight changes: bits, pieces put in, stretches taken out or repeated, or the end cut off.
fn mutated(original: &[u8], dice: &mut Lcg) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..=dice.below(8) {
        let at = dice.below(bytes.len());
        let end = (at + 1 + dice.below(60)).min(bytes.len());
        match dice.below(6) {
            0 if at < bytes.len() => bytes[at] ^= 1 << dice.below(8),
            1 => {
                bytes.splice(at..at, PIECES[dice.below(PIECES.len())].iter().copied());
            }
            2 => {
                bytes.drain(at..end);
            }
            3 => {
                let stretch = bytes[at..end].to_vec();
                let to = dice.below(bytes.len());
                bytes.splice(to..to, stretch);
            }
            4 if at < bytes.len() => bytes[at] = b"0123456789"[dice.below(10)],
            5 if dice.below(20) == 0 => bytes.truncate(at),
            _ => {}
        }
    }
    bytes
}

#[test]
fn ten_thousand_mutated_files() {
    let mut dice = Lcg(1);
    let data: Vec<u8> = (0..64).map(|i| (i * 37) as u8).collect();
    for i in 0..10_000 {
        let original = if i % 2 == 0 { CAR } else { RICH };
        exercise(&mutated(original, &mut dice), &data[..dice.below(65)]);
    }
}

#[test]
fn a_file_cut_anywhere() {
    for end in 0..RICH.len() {
        exercise(&RICH[..end], &[0xA5; 64]);
    }
}

#[test]
fn many_lines_cost_time_in_proportion() {
    // What could be quadratic: strings that do not end, signals that overlap, statements without a semicolon.
    for line in [
        "CM_ \"",
        "VAL_ 1 S 1 \"",
        "BA_DEF_ \"",
        "SG_MUL_VAL_ 1 A B 0-0",
        "EV_ x \"\\\"",
        "VERSION \"\\\"",
        "VAL_TABLE_ T 1",
    ] {
        let text = format!(
            "BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" Y\n{}",
            format!("{line}\n").repeat(50_000)
        );
        exercise(text.as_bytes(), &[]);
    }
    let mut text = String::from("BO_ 1 M: 64 X\n SG_ P M : 0|8@1+ (1,0) [0|0] \"\" Y\n");
    for i in 0..5_000 {
        let _ = writeln!(text, " SG_ S{i} m{i} : 8|64@1+ (1,0) [0|0] \"\" Y");
    }
    let dbc = Dbc::parse(&text).unwrap();
    assert_eq!(dbc.messages()[0].signals.len(), 2048);
    assert_eq!(dbc.problems().len(), 1);
    exercise(text.as_bytes(), &[1; 64]);
}

fn one_signal(start: u64, bits: u64, order: u8, sign: char, scale: (f64, f64)) -> Option<Message> {
    let (factor, offset) = scale;
    let text = format!(
        "BO_ 1 M: 64 X\n SG_ S : {start}|{bits}@{order}{sign} ({factor:?},{offset:?}) [0|0] \"\" Y\n"
    );
    Dbc::parse(&text).ok().map(|dbc| dbc.messages()[0].clone())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400), data in prop::collection::vec(any::<u8>(), 0..65)) {
        exercise(&bytes, &data);
    }

    #[test]
    fn any_words(words in prop::collection::vec(prop::sample::select(&[
        "BO_", "SG_", "VAL_", "CM_", "SG_MUL_VAL_", "SIG_VALTYPE_", "BA_", "BA_DEF_", "1", "8", "S", "M", "m0", "m0M", ":",
        "|", "@1+", "0|8@1-", "7|16@0+", "(1,0)", "[0|0]", "\"\"", "\"", ";", "\n", "0-1", "\"SNA\"", "1 M: 8 X\n",
    ][..]), 0..80)) {
        exercise(words.join(" ").as_bytes(), &[0x55; 64]);
    }

    #[test]
    fn what_is_encoded_decodes_to_the_same(
        start in 0u64..512, bits in 1u64..=48, order in 0u8..2, signed in any::<bool>(), raw in any::<u64>(),
        scale in prop::sample::select(&[(1.0, 0.0), (0.01, -100.0), (-0.5, 7.25), (1e-3, 0.0), (3600.0, 1e6)][..]),
    ) {
        let sign = if signed { '-' } else { '+' };
        let Some(message) = one_signal(start, bits, order, sign, scale) else { return Ok(()) };
        let signal = &message.signals[0];
        let raw = raw & (u64::MAX >> (64 - bits));
        let physical = signal.physical(raw);
        // Four roundings of half a 2^-52th each are less than half a step of a number of 48 bits.
        prop_assert_eq!(signal.bits_of(physical), Some(raw));
        let payload = message.encode(|_| physical).unwrap();
        prop_assert_eq!(message.raw(0, payload.as_slice()), Some(raw));
    }

    #[test]
    fn any_value_is_kept_within_the_bits(
        bits in 1u64..=64, signed in any::<bool>(), value in any::<f64>(),
    ) {
        let Some(message) = one_signal(0, bits, 1, if signed { '-' } else { '+' }, (0.1, 0.0)) else { return Ok(()) };
        let signal = &message.signals[0];
        prop_assert!(matches!(signal.kind, Kind::Signed | Kind::Unsigned));
        if value.is_nan() {
            prop_assert_eq!(signal.bits_of(value), None);
        } else {
            let back = signal.physical(signal.bits_of(value).unwrap());
            let largest = 0.1 * 2f64.powi(bits as i32 - i32::from(signed));
            let least = if signed { -largest } else { 0.0 };
            // Nearest of the range, to half a step and what 53 bits hold.
            let nearest = value.clamp(least, largest - 0.1);
            prop_assert!((back - nearest).abs() <= 0.0500001 + 1e-15 * nearest.abs(), "{} {} {}", value, back, nearest);
        }
    }
}
