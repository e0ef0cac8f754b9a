//! Which raw values of a signal say that it has none.
//!
//! Labels decide. On SAE J1939 the standard's ranges do (SAE J1939-71, transmitted signal ranges): above the largest value of a number
//! follow indicators, reserved ones, "error" and "not available". Elsewhere senders take an end of the raw numbers for that. A stated range
//! alone proves nothing, as many are wrong: an end counts where it lies beyond it, and no other value does.

use super::message::{Kind, Signal};
use super::missing::Missing;
use crate::CanId;

/// Names of raw values that say that there is no value.
const NOT_AVAILABLE: [&str; 9] = [
    "sna",
    "signal not available",
    "signalnotavailable",
    "not available",
    "notavailable",
    "not valid",
    "invalid",
    "n/a",
    "error",
];

/// The highest byte of the smallest J1939 number that is no value.
const J1939_FIRST: u64 = 0xFB;

impl Missing {
    /// Of a signal that is complete, of a message with this identifier.
    pub(super) fn of(signal: &Signal, id: CanId, j1939: bool) -> Self {
        let mask = signal.layout.mask();
        let says_so = |label: &str| {
            let plain = label.trim().replace('_', " ").to_lowercase();
            NOT_AVAILABLE.contains(&plain.as_str())
        };
        let labels = signal.labels.iter().filter(|(_, label)| says_so(label));
        let from = j1939_from(signal.layout.bits()).filter(|_| signal.kind == Kind::Unsigned);
        Self {
            labelled: labels.map(|(raw, _)| *raw as u64 & mask).collect(),
            from: from.filter(|from| j1939 || (id.is_extended() && has_range_of_j1939(signal, *from))),
            ends: ends(signal),
        }
    }
}

/// The first number of so many bits that is no value on J1939; of states, which have less than a byte, the last two are none.
fn j1939_from(bits: u16) -> Option<u64> {
    match bits {
        0 | 1 => None,
        2..8 => Some((1 << bits) - 2),
        _ => Some(J1939_FIRST << (bits - 8)),
    }
}

/// Whether a stated range ends where the standard's does: a file without attributes says by that what it describes.
fn has_range_of_j1939(signal: &Signal, from: u64) -> bool {
    let off = signal.physical(from - 1) - signal.max;
    signal.layout.bits() >= 8 && is_stated(signal) && off.abs() <= 0.5 * signal.factor.abs()
}

fn is_stated(signal: &Signal) -> bool {
    signal.min < signal.max
}

/// The ends of the raw numbers, by either way to read a sign, that lie beyond the stated range by more than its rounding.
fn ends(signal: &Signal) -> Vec<u64> {
    let (bits, mask) = (signal.layout.bits(), signal.layout.mask());
    if bits < 2 || !is_stated(signal) || matches!(signal.kind, Kind::Float32 | Kind::Float64) {
        return Vec::new();
    }
    let sign = mask ^ (mask >> 1);
    let zero = Some(0).filter(|_| signal.kind == Kind::Unsigned);
    // Where raw numbers without a sign stand for values of both signs, those of the middle are the smallest values and no ends.
    let has_middle = zero.is_some() && signal.physical(0) * signal.physical(mask) < 0.0;
    let signed_ends = [sign, sign - 1].into_iter().filter(|_| !has_middle);
    let margin = 0.5 * signal.factor.abs();
    let beyond = |raw: &u64| {
        let value = signal.physical(*raw);
        value < signal.min - margin || value > signal.max + margin
    };
    [mask].into_iter().chain(signed_ends).chain(zero).filter(beyond).collect()
}

#[cfg(test)]
mod tests {
    use crate::dbc::{Dbc, NoValue};

    /// Raw values, and why the signal of this line, in a message of this identifier, has none then.
    fn why(id: u64, signal: &str, tail: &str, raw: &[u64]) -> Vec<Option<NoValue>> {
        let text = format!("BO_ {id} M: 8 X\n SG_ S : {signal} \"\" X\n{tail}\n");
        let dbc = Dbc::parse(&text).unwrap();
        let signal = &dbc.messages()[0].signals[0];
        raw.iter().map(|raw| signal.no_value(*raw)).collect()
    }

    const STATED: Option<NoValue> = Some(NoValue::Stated);
    const END: Option<NoValue> = Some(NoValue::RawEnd);
    const J1939: &str = "BA_ \"ProtocolType\" \"J1939\";";
    /// PGN 0xFEF1 from source address 0, and the same from the null address.
    const FROM_0: u64 = 0x98FE_F100;
    const FROM_NULL: u64 = 0x98FE_F1FE;

    #[test]
    fn on_j1939_the_ranges_of_the_standard_decide() {
        let word = "0|16@1+ (1,0) [0|0]";
        assert_eq!(
            why(FROM_0, word, J1939, &[0xFAFF, 0xFB00, 0xFE00, 0xFFFF]),
            [None, STATED, STATED, STATED]
        );
        assert_eq!(why(FROM_0, "0|8@1+ (1,0) [0|0]", J1939, &[0xFA, 0xFB, 0xFF]), [None, STATED, STATED]);
        let long = [0xFAFF_FFFF, 0xFB00_0000, 0xFFFF_FFFF];
        assert_eq!(why(FROM_0, "0|32@1+ (1,0) [0|0]", J1939, &long), [None, STATED, STATED]);
        assert_eq!(why(FROM_0, "0|12@1+ (1,0) [0|0]", J1939, &[0xFAF, 0xFB0]), [None, STATED]);
        assert_eq!(why(FROM_0, "0|2@1+ (1,0) [0|0]", J1939, &[0, 1, 2, 3]), [None, None, STATED, STATED]);
        // A number with a sign is none of the standard's.
        assert_eq!(why(FROM_0, "0|16@1- (1,0) [0|0]", J1939, &[0xFFFF, 0x8000]), [None, None]);
        // Without attributes: the null address sends nothing, and a range that ends where the standard's does.
        assert_eq!(why(FROM_NULL, word, "", &[0xFAFF, 0xFB00]), [None, STATED]);
        let speed = "0|16@1+ (0.00390625,0) [0|250.996]";
        assert_eq!(why(FROM_0, speed, "", &[0xFAFF, 0xFE00, 0xFFFF]), [None, STATED, STATED]);
        assert_eq!(why(FROM_0, word, "", &[0xFFFF]), [None]);
        assert_eq!(why(0x123, speed, "", &[0xFE00, 0xFFFF]), [None, END], "eleven bits are no J1939");
    }

    #[test]
    fn elsewhere_an_end_beyond_the_stated_range_is_no_value() {
        let signed = "0|16@1- (0.01,0) [-327|327]";
        assert_eq!(why(1, signed, "", &[0x8000, 0x7FFF, 0xFFFF, 0, 0x8001]), [END, END, None, None, None]);
        // The whole range, whether it is rounded or not, or none: no end lies beyond it.
        for range in ["[-327.68|327.67]", "[-327.7|327.7]", "[0|0]"] {
            assert_eq!(why(1, &format!("0|16@1- (0.01,0) {range}"), "", &[0x8000, 0x7FFF]), [None, None]);
        }
        // A range that is wrong takes no value away but these.
        let wrong = "0|16@1- (0.01,0) [-1|1]";
        assert_eq!(why(1, wrong, "", &[2000, 0x8000 + 2000, 0x7FFE, 0x7FFF]), [None, None, None, END]);
        let unsigned = "0|12@1+ (0.5,-100) [-50|400]";
        assert_eq!(why(1, unsigned, "", &[0xFFF, 0, 0xFFE, 1]), [END, END, None, None]);
        // Signed minus one in a number that is unsigned, and the other way round.
        assert_eq!(why(1, "0|16@1+ (0.01,0) [0|300]", "", &[0x8000, 0x7FFF, 0xFFFF]), [END, END, END]);
        assert_eq!(why(1, "0|16@1- (0.01,0) [0|300]", "", &[0xFFFF]), [END]);
        // A yaw rate of 0.3 deg/s to the right, which the range of a careless file leaves out.
        let centered = "1|10@0+ (0.244,-125) [0|250]";
        assert_eq!(why(1, centered, "", &[0x1FF, 0x200, 0, 0x3FF]), [None, None, END, None]);
        let labelled = "VAL_ 1 S 4095 \"SNA\" ;";
        assert_eq!(why(1, unsigned, labelled, &[0xFFF]), [STATED]);
    }
}
