//! MDF4 files that are cut, changed or nothing of the kind: no panic, no hang, no memory beyond bounds; an error with a
//! name, or what is readable and a word on what is not.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use itpms_mdf4::{
    ChannelKind, ChannelSpec, Compression, GroupSpec, Mdf4Reader, Mdf4Repair, Mdf4Writer, SampleFormat,
};
use proptest::prelude::*;

/// What reading a file gave, if it could be opened.
struct Read {
    samples: u64,
    /// Bits of all values, mixed: files with the same values have the same.
    digest: u64,
    repairs: Vec<Mdf4Repair>,
    errors: Vec<String>,
}

/// Reads all numbers of all groups. The bound on time is for a busy machine: the files here take milliseconds.
fn read_all(path: &Path) -> Result<Read, String> {
    let started = Instant::now();
    let found = read_groups(path);
    assert!(started.elapsed() < Duration::from_secs(20), "took {:?}", started.elapsed());
    found
}

fn read_groups(path: &Path) -> Result<Read, String> {
    let reader = Mdf4Reader::open(path).map_err(|error| error.to_string())?;
    let mut read = Read { samples: 0, digest: 0, repairs: reader.repairs().to_vec(), errors: Vec::new() };
    for (index, group) in reader.groups().iter().enumerate() {
        let numbers: Vec<usize> =
            (0..group.channels.len()).filter(|c| group.channels[*c].kind == ChannelKind::Number).collect();
        let mut cursor = match reader.cursor(index, &numbers) {
            Ok(cursor) => cursor,
            Err(error) => {
                read.errors.push(error.to_string());
                continue;
            }
        };
        let mut values = vec![0.0; numbers.len()];
        loop {
            match cursor.next(&mut values) {
                Ok(Some(time_s)) => {
                    read.samples += 1;
                    for value in values.iter().chain([&time_s]) {
                        read.digest = read.digest.rotate_left(1) ^ value.to_bits();
                    }
                }
                Ok(None) => break,
                Err(error) => {
                    read.errors.push(error.to_string());
                    break;
                }
            }
        }
        let progress = cursor.progress();
        assert!(progress == 1.0, "{progress}");
        read.repairs.extend_from_slice(cursor.repairs());
    }
    for messages in read.repairs.iter().map(ToString::to_string).chain(read.errors.iter().cloned()) {
        assert!(!messages.is_empty() && messages.len() < 5000, "{messages}");
    }
    Ok(read)
}

/// A new file: one that is overwritten goes to the disk at once on some file systems, ten thousand times.
fn put(path: &Path, bytes: &[u8]) {
    let _ = fs::remove_file(path);
    fs::write(path, bytes).unwrap();
}

/// The foreign files, and ours in three ways.
fn originals(directory: &Path) -> Vec<(String, Vec<u8>)> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let mut paths: Vec<PathBuf> = fs::read_dir(data).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "mf4" || extension == "dat"));
    paths.sort();
    assert!(paths.len() >= 10);
    for (name, compression) in [
        ("none", Compression::None),
        ("deflate", Compression::Deflate),
        ("transposed", Compression::Transposed),
    ] {
        paths.push(directory.join(format!("ours-{name}.mf4")));
        ours(paths.last().unwrap(), compression);
    }
    let named = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    paths.iter().map(|path| (named(path), fs::read(path).unwrap())).collect()
}

fn ours(path: &Path, compression: Compression) {
    let channel = |name: &str, format| ChannelSpec::new(name, "m/s^2", format);
    let channels = vec![channel("a", SampleFormat::Float32), channel("b", SampleFormat::Signed16)];
    let group =
        |name: &str| GroupSpec { name: name.to_owned(), comment: String::new(), channels: channels.clone() };
    let mut writer = Mdf4Writer::create(path, &[group("one"), group("two")], compression).unwrap();
    for i in 0..300 {
        let value = if i % 10 == 0 { f64::NAN } else { f64::from(i) };
        writer.write(0, f64::from(i) * 0.002, &[value, value]).unwrap();
        writer.write(1, f64::from(i) * 0.002, &[value / 4.0, value]).unwrap();
    }
    writer.finish().unwrap().commit().unwrap();
}

/// Marsaglia's xorshift64: enough to break files with.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, below: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % below.max(1)
    }
}

#[test]
fn a_file_cut_at_any_byte_is_read_up_to_there_or_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("cut.mf4");
    let mut dice = Dice(20_261_120);
    for (name, bytes) in originals(dir.path()) {
        put(&path, &bytes);
        let whole = read_all(&path).unwrap();
        assert!(whole.samples > 0, "{name}");
        for _ in 0..200 {
            let cut = dice.roll(bytes.len());
            put(&path, &bytes[..cut]);
            match read_all(&path) {
                Err(error) => assert!(error.contains("cut.mf4: "), "{error}"),
                Ok(read) => {
                    let repaired = read.repairs.len() + read.errors.len() > whole.repairs.len();
                    let complete = read.samples == whole.samples && read.digest == whole.digest;
                    // Of files that are cut by their nature the last words are the same.
                    let unfinished = name.starts_with("unfinalised");
                    assert!(repaired || complete || unfinished, "{name} cut at {cut}: nothing was said");
                }
            }
        }
    }
}

#[test]
fn ten_thousand_changed_files_bring_no_panic_and_no_hang() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("changed.mf4");
    let originals = originals(dir.path());
    let mut dice = Dice(3);
    let (mut opened, mut samples) = (0, 0);
    for round in 0..10_000 {
        let mut bytes = originals[round % originals.len()].1.clone();
        for _ in 0..=dice.roll(4) {
            change(&mut bytes, &mut dice);
        }
        put(&path, &bytes);
        if let Ok(read) = read_all(&path) {
            opened += 1;
            samples += read.samples;
        }
    }
    // Most changes hit data or texts: if hardly any file could be opened, the test tests nothing.
    assert!(opened > 5000 && samples > 1_000_000, "{opened} opened, {samples} samples");
    assert!(peak_memory_mb() < 256, "{} MB", peak_memory_mb());
}

/// One change: a byte, a number that may be a length or a link, a piece that is missing, twice there, or zeros.
fn change(bytes: &mut [u8], dice: &mut Dice) {
    let length = bytes.len();
    let at = dice.roll(length);
    // Lengths, links and counts lie on multiples of eight.
    let aligned = at / 8 * 8;
    let number = match dice.roll(6) {
        0 => dice.roll(length) as u64 / 8 * 8,
        1 => length as u64 - dice.roll(64) as u64,
        2 => u64::MAX - dice.roll(64) as u64,
        3 => 1 << dice.roll(64),
        4 => dice.roll(1000) as u64,
        _ => dice.roll(usize::MAX) as u64,
    };
    match dice.roll(6) {
        0 | 1 => bytes[at] = dice.roll(256) as u8,
        2 | 3 if aligned + 8 <= length => bytes[aligned..aligned + 8].copy_from_slice(&number.to_le_bytes()),
        4 => {
            let end = (at + 1 + dice.roll(64)).min(length);
            bytes[at..end].fill(0);
        }
        5 if length > 200 => {
            let (from, count) = (dice.roll(length - 100), dice.roll(100));
            let piece = bytes[from..from + count].to_vec();
            let end = (at + count).min(length);
            bytes[at..end].copy_from_slice(&piece[..end - at]);
        }
        _ => bytes[at] ^= 1 << dice.roll(8),
    }
}

/// The most memory this process ever had; 0 where that is unknown.
fn peak_memory_mb() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kilobytes| kilobytes.parse::<u64>().ok()).unwrap_or(0) / 1024
}

#[test]
fn what_is_no_mdf4_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("no.mf4");
    let messages = |bytes: &[u8]| {
        put(&path, bytes);
        Mdf4Reader::open(&path).unwrap_err().problem.to_string()
    };
    assert_eq!(messages(b""), "not an MDF file: it begins with \"\", expected \"MDF     \" or \"UnFinMF \"");
    assert_eq!(
        messages(b"time_s,speed"),
        "not an MDF file: it begins with \"time_s,s\", expected \"MDF     \" or \"UnFinMF \""
    );
    let mut bytes = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/plain.mf4")).unwrap();
    assert_eq!(
        messages(&bytes[..100]),
        "cut off after 100 bytes, expected at least the 168 of the identification and the header"
    );
    let first = u64::from_le_bytes(bytes[88..96].try_into().unwrap());
    let cut = messages(&bytes[..first as usize + 10]);
    assert_eq!(
        cut,
        format!(
            "no channel group can be read: data group at byte {first}: the file ends at byte {}",
            first + 10
        )
    );
    bytes[28..30].copy_from_slice(&520u16.to_le_bytes());
    assert_eq!(messages(&bytes), "MDF version 5.20, expected 2.00 to 4.39");
    bytes[28..30].copy_from_slice(&330u16.to_le_bytes());
    assert_eq!(messages(&bytes), "header at byte 64: found \"##\", expected \"HD\"");
    assert!(
        Mdf4Reader::open(dir.path()).unwrap_err().to_string().ends_with("is a directory, expected a file")
    );
    let missing = Mdf4Reader::open(&dir.path().join("missing.mf4")).unwrap_err().to_string();
    assert!(missing.ends_with("missing.mf4: no such file"));
}

#[test]
fn a_damaged_block_in_the_middle_costs_its_samples_and_no_others() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("hole.mf4");
    for compression in [Compression::Deflate, Compression::Transposed] {
        // Records of 20 bytes: 52 428 in a block of a megabyte, the last block has 20 144.
        let specs = [GroupSpec {
            name: "g".to_owned(),
            comment: String::new(),
            channels: vec![
                ChannelSpec::new("i", "", SampleFormat::Float64),
                ChannelSpec::new("j", "", SampleFormat::Float32),
            ],
        }];
        let mut writer = Mdf4Writer::create(&path, &specs, compression).unwrap();
        for i in 0..125_000 {
            writer.write(0, f64::from(i) * 1e-3, &[f64::from(i), f64::from(i % 100)]).unwrap();
        }
        writer.finish().unwrap().commit().unwrap();
        let mut bytes = fs::read(&path).unwrap();
        let places: Vec<usize> = (0..bytes.len() - 4).filter(|at| bytes[*at..at + 4] == *b"##DZ").collect();
        assert_eq!(places.len(), 3);
        // Amid the compressed bytes of the second block.
        bytes[(places[1] + places[2]) / 2] ^= 0x55;
        put(&path, &bytes);

        let reader = Mdf4Reader::open(&path).unwrap();
        let mut cursor = reader.cursor(0, &[1]).unwrap();
        let (mut value, mut expected) = ([0.0], 0);
        while let Some(time_s) = cursor.next(&mut value).unwrap() {
            if expected == 52_428 {
                expected = 104_856;
            }
            assert_eq!((time_s, value[0]), (f64::from(expected) * 1e-3, f64::from(expected)));
            expected += 1;
        }
        assert_eq!(expected, 125_000);
        let messages: Vec<String> = cursor.repairs().iter().map(ToString::to_string).collect();
        let block = format!("compressed block at byte {}: cannot be unpacked; it is left out", places[1]);
        assert_eq!(
            messages,
            [
                format!("group \"g\": {block}"),
                "group \"g\": 52428 samples in damaged blocks are left out".to_owned(),
                "group \"g\": read 72572 of 125000 samples, the others are not there".to_owned()
            ]
        );
    }
}

#[test]
fn of_a_long_file_of_ours_that_is_cut_the_part_before_the_cut_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("long.mf4");
    // Records of 16 bytes: 65 536 in a block, sixteen blocks in a list, 1.2 million are a list and two blocks.
    let channels = vec![ChannelSpec::new("i", "", SampleFormat::Float64)];
    let specs = [GroupSpec { name: "g".to_owned(), comment: String::new(), channels }];
    let mut writer = Mdf4Writer::create(&path, &specs, Compression::Transposed).unwrap();
    for i in 0..1_200_000 {
        writer.write(0, f64::from(i), &[f64::from(i)]).unwrap();
    }
    writer.finish().unwrap().commit().unwrap();
    let bytes = fs::read(&path).unwrap();
    put(&path, &bytes[..bytes.len() * 19 / 20]);
    let reader = Mdf4Reader::open(&path).unwrap();
    let mut cursor = reader.cursor(0, &[1]).unwrap();
    let (mut value, mut read) = ([0.0], 0);
    while let Some(time_s) = cursor.next(&mut value).unwrap() {
        assert_eq!((time_s, value[0]), (f64::from(read), f64::from(read)));
        read += 1;
    }
    assert_eq!(read, 16 * 65_536);
    let last = cursor.repairs().last().unwrap().to_string();
    assert_eq!(last, "group \"g\": read 1048576 of 1200000 samples, the others are not there");
}

#[test]
fn rings_of_links_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("ring.mf4");
    ours(&path, Compression::None);
    let original = fs::read(&path).unwrap();
    let find = |id: &[u8]| (0..original.len() - 4).find(|at| original[*at..at + 4] == *id).unwrap();
    // A data group, channel group and channel that are followed by themselves.
    for id in [b"##DG", b"##CG", b"##CN"] {
        let at = find(id);
        let mut bytes = original.clone();
        bytes[at + 24..at + 32].copy_from_slice(&(at as u64).to_le_bytes());
        put(&path, &bytes);
        let read = read_all(&path).unwrap();
        let messages: Vec<String> = read.repairs.iter().map(ToString::to_string).collect();
        assert!(
            messages.iter().any(|messages| messages.contains("a link back to a block that was read before")),
            "{messages:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]
    /// Any bytes behind a good beginning, and any bytes at all.
    #[test]
    fn any_bytes_bring_no_panic(bytes in prop::collection::vec(any::<u8>(), 0..4000), good in any::<bool>()) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("any.mf4");
        let mut all = bytes;
        if good && all.len() > 64 {
            all[..8].copy_from_slice(b"MDF     ");
            all[28..30].copy_from_slice(&410u16.to_le_bytes());
        }
        put(&path, &all);
        let _ = read_all(&path);
    }
}
