//! CAN logs that are damaged in every way: cut at random places, bytes changed, or noise from the start. Never a panic,
//! never more frames than the bytes can hold, an error or a reading that says what it left out.

use std::fs;
use std::path::Path;

use itpms_can_log::{FrameKind, FrameReader, candump};
use proptest::prelude::*;

/// A small generator with a published sequence (Numerical Recipes' LCG), so that no test depends on a library's stream.
pub(crate) struct Lcg(pub(crate) u64);

impl Lcg {
    pub(crate) fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % most.max(1)
    }
}

const LOGS: [&str; 4] = ["python_can.log", "python_can.asc", "python_can.blf", "python_can_stored.blf"];

fn original(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)).unwrap()
}

/// Reads a file to its end or error; the frames there were, and whether all is reported to be well.
fn read(path: &Path) -> (u64, bool) {
    let Ok(mut reader) = FrameReader::open(path) else { return (0, false) };
    let mut frames = 0;
    loop {
        match reader.next_frame() {
            Ok(Some(frame)) => {
                frames += 1;
                assert!(frame.data().len() <= 64);
                assert!(frame.time_s.is_finite());
                assert!((0.0..=1.0).contains(&reader.progress()));
            }
            Ok(None) => return (frames, reader.repairs().is_clean()),
            Err(error) => {
                assert!(!error.to_string().is_empty());
                return (frames, false);
            }
        }
    }
}

/// Puts bytes under a name where nothing is: overwriting makes some file systems wait for the disk.
fn put(path: &Path, bytes: &[u8]) {
    let _ = fs::remove_file(path);
    fs::write(path, bytes).unwrap();
}

/// Reads so many files, each with one to eight changes.
fn mutate(name: &str, files: usize, seed: u64, most_survive: bool) {
    let original = original(name);
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(Path::new(name).file_name().unwrap());
    let mut random = Lcg(seed);
    let mut survivors = 0;
    for _ in 0..files {
        let mut bytes = original.clone();
        for _ in 0..=random.below(8) {
            let at = random.below(bytes.len());
            match random.below(6) {
                0 => bytes[at] ^= 1 << random.below(8),
                1 => bytes[at] = random.below(256) as u8,
                2 => {
                    bytes.remove(at);
                }
                3 => bytes.insert(at, random.below(256) as u8),
                4 => {
                    let end = (at + 1 + random.below(64)).min(bytes.len());
                    let copied = bytes[at..end].to_vec();
                    let to = random.below(bytes.len());
                    bytes.splice(to..to, copied);
                }
                _ => {
                    // Sizes and counts that lie.
                    let end = (at + 4).min(bytes.len());
                    let lie = [u32::MAX, 0, 0x7FFF_FFFF, 1 << 24, 15][random.below(5)].to_le_bytes();
                    bytes[at..end].copy_from_slice(&lie[..end - at]);
                }
            }
        }
        put(&path, &bytes);
        let (frames, _) = read(&path);
        // 48 frames and what duplicated stretches add.
        assert!(frames <= 48 + 8 * 8, "{frames} frames");
        survivors += u32::from(frames > 0);
    }
    // Most damage leaves most of a log readable, but a byte more or less moves what links point at.
    let least = if most_survive { files / 2 } else { files / 10 };
    assert!(survivors as usize > least, "{name}: frames in {survivors} of {files}");
}

#[test]
fn ten_thousand_mutations_of_candump() {
    mutate(LOGS[0], 10_000, 1, true);
}

#[test]
fn ten_thousand_mutations_of_asc() {
    mutate(LOGS[1], 10_000, 2, true);
}

#[test]
fn ten_thousand_mutations_of_blf() {
    mutate(LOGS[2], 5_000, 3, true);
    mutate(LOGS[3], 5_000, 4, true);
}

#[test]
#[cfg(feature = "mdf4")]
fn thousands_of_mutations_of_bus_loggings() {
    for (name, seed) in [
        ("python_can.mf4", 21),
        ("../../../itpms-mdf4/tests/data/bus-apart.mf4", 22),
        ("../../../itpms-mdf4/tests/data/bus-mixed.mf4", 23),
    ] {
        mutate(name, 2_000, seed, false);
    }
}

#[test]
fn thousands_of_mutations_of_traces_and_tables() {
    for (name, seed) in [("python_can.trc", 24), ("python_can.csv", 25)] {
        mutate(name, 2_000, seed, true);
    }
}

#[test]
fn a_log_cut_anywhere_is_read_up_to_there() {
    let dir = tempfile::tempdir().unwrap();
    for (name, seed) in LOGS.into_iter().zip(5..) {
        let original = original(name);
        let path = dir.path().join(name);
        let mut random = Lcg(seed);
        let mut cuts: Vec<usize> = (0..200).map(|_| random.below(original.len())).collect();
        cuts.sort_unstable();
        let mut before = 0;
        for cut in cuts {
            put(&path, &original[..cut]);
            let (frames, _) = read(&path);
            // A longer piece holds no fewer frames: what is whole is read.
            assert!(frames >= before, "{name} cut at {cut}: {frames} frames, {before} in a shorter piece");
            before = frames;
        }
        assert!(before > 40, "{name}: {before}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn noise_is_an_error_or_a_reading(bytes in proptest::collection::vec(any::<u8>(), 0..2000), which in 0..3_usize) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(["a.log", "a.asc", "a.blf"][which]);
        put(&path, &bytes);
        read(&path);
    }

    #[test]
    fn noise_behind_a_header_is_an_error_or_a_reading(bytes in proptest::collection::vec(any::<u8>(), 0..2000)) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.blf");
        let head = original(LOGS[2])[..176].to_vec();
        fs::write(&path, [head, bytes].concat()).unwrap();
        read(&path);
    }

    #[test]
    fn any_text_is_a_line_or_not(line in "[ (]{0,2}[0-9.:-]{0,20}[) ]{0,2}[a-z0-9]{0,6} [0-9A-F#R.\\[\\] _TX]{0,40}") {
        if let Ok(parsed) = candump::parse_line(&line) {
            // Every frame read can be written and is read back the same, up to the six digits of the stamp.
            let again = candump::format_line(&parsed.frame, "can0");
            let again = candump::parse_line(&again).unwrap().frame;
            prop_assert!(again.data() == parsed.frame.data() || again.kind == FrameKind::Error);
            prop_assert_eq!(again.kind, parsed.frame.kind);
            prop_assert!((again.time_s - parsed.frame.time_s).abs() <= 0.51e-6 + parsed.frame.time_s * 1e-15);
        }
    }
}

#[test]
fn two_hundred_thousand_containers_with_nothing_in_them_take_no_time() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("empty.blf");
    let original = original("python_can.blf");
    let (header, objects) = original.split_at(144);
    // RFC 1950 and 1951: a stream of zlib with one final block of nothing, and the Adler-32 of nothing.
    let nothing = [0x78, 0x9c, 0x03, 0x00, 0x00, 0x00, 0x00, 0x01];
    let mut container = b"LOBJ\x10\0\x01\0\x28\0\0\0\x0a\0\0\0\x02\0".to_vec();
    container.resize(32, 0);
    container.extend_from_slice(&nothing);
    put(&path, &[header, &container.repeat(200_000), objects].concat());
    let whole = dir.path().join("python_can.blf");
    put(&whole, &original);
    let (frames, is_clean) = read(&whole);
    let begun = std::time::Instant::now();
    assert_eq!(read(&path), (frames, is_clean));
    assert!(frames > 0 && begun.elapsed() < std::time::Duration::from_secs(3), "{:?}", begun.elapsed());
}
