//! CAN logs through the public face: what python-can wrote, what CANoe writes, every format there and back, and what is
//! cut, strange or nothing at all.

use std::fs;
use std::path::{Path, PathBuf};

use itpms_can_log::{
    CanFrame, CanId, Direction, FrameKind, FramePlace, FrameReader, FrameRepairs, FrameWriter, Payload,
};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn read(path: &Path) -> (Vec<CanFrame>, FrameRepairs) {
    let mut reader = FrameReader::open(path).unwrap();
    let mut frames = Vec::new();
    while let Some(frame) = reader.next_frame().unwrap() {
        frames.push(frame);
    }
    assert!(reader.next_frame().unwrap().is_none());
    (frames, reader.repairs().clone())
}

fn read_text(name: &str, text: &str) -> (Vec<CanFrame>, FrameRepairs) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    fs::write(&path, text).unwrap();
    read(&path)
}

fn message_of(name: &str, content: &[u8]) -> String {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    fs::write(&path, content).unwrap();
    let mut reader = match FrameReader::open(&path) {
        Ok(reader) => reader,
        Err(error) => return error.problem.to_string(),
    };
    loop {
        match reader.next_frame() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("{name} was read"),
            Err(error) => return error.problem.to_string(),
        }
    }
}

/// Frame number `i` of `tests/data/generate.py`, computed once more.
fn expected(i: u32) -> CanFrame {
    const FD_LENGTHS: [u32; 15] = [1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];
    let kind = match i % 8 {
        4 => FrameKind::Remote,
        5 => FrameKind::Fd { bit_rate_switch: true, error_state_indicator: false },
        6 => FrameKind::Fd { bit_rate_switch: false, error_state_indicator: true },
        7 => FrameKind::Error,
        _ => FrameKind::Data,
    };
    let length = if matches!(kind, FrameKind::Fd { .. }) { FD_LENGTHS[(i % 15) as usize] } else { i % 9 };
    let bytes: Vec<u8> = (0..length).map(|j| ((37 * i + 11 * j) % 256) as u8).collect();
    CanFrame {
        time_s: (1_795_195_053_250_000 + 12_500 * u64::from(i) + u64::from(i % 3)) as f64 / 1e6,
        bus: (i % 3) as u16,
        id: if i.is_multiple_of(4) {
            CanId::extended(0x18FF_0000 + 257 * i)
        } else {
            CanId::standard(0x100 + 7 * i % 0x700)
        }
        .unwrap(),
        kind,
        direction: if i.is_multiple_of(5) && kind != FrameKind::Error {
            Direction::Tx
        } else {
            Direction::Rx
        },
        payload: match kind {
            FrameKind::Remote => Payload::zeros(length as usize),
            _ => Payload::new(&bytes),
        }
        .unwrap(),
    }
}

/// All of them but for the time, which has to be within `tolerance_s`.
fn assert_same(found: &[CanFrame], expected: impl Iterator<Item = CanFrame>, tolerance_s: f64) {
    let expected: Vec<CanFrame> = expected.collect();
    assert_eq!(found.len(), expected.len());
    for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!(
            (found.time_s - expected.time_s).abs() <= tolerance_s,
            "{index}: {} {}",
            found.time_s,
            expected.time_s
        );
        assert_eq!(CanFrame { time_s: 0.0, ..*found }, CanFrame { time_s: 0.0, ..*expected }, "{index}");
    }
}

#[test]
fn what_python_can_writes_as_candump_is_read() {
    let (frames, repairs) = read(&data("python_can.log"));
    // It leaves out the length of a remote frame and writes each error as a bus error.
    let written = (0..48).map(expected).map(|frame| match frame.kind {
        FrameKind::Remote => CanFrame { payload: Payload::EMPTY, ..frame },
        FrameKind::Error => CanFrame { id: CanId::extended(0x80).unwrap(), ..frame },
        _ => frame,
    });
    // Both round microseconds to the nearest double.
    assert_same(&frames, written, 0.0);
    assert!(repairs.is_clean());
}

#[test]
fn what_python_can_writes_as_asc_is_read() {
    let (frames, repairs) = read(&data("python_can.asc"));
    // Of an error it writes the channel alone.
    let written = (0..48).map(expected).map(|frame| match frame.kind {
        FrameKind::Error => CanFrame { id: CanId::extended(0).unwrap(), payload: Payload::EMPTY, ..frame },
        _ => frame,
    });
    // A date since 1970 as a double has steps of 0.24 us; two additions.
    assert_same(&frames, written, 0.5e-6);
    assert!(repairs.is_clean());
    // "Start of measurement" and an event.
    assert_eq!(repairs.passed_over, 2);
}

#[test]
#[cfg(feature = "mdf4")]
fn bus_loggings_in_mdf4_are_read_by_whatever_layout() {
    // By python-can, data in place; by hand after the standard, bits side by side: data in blocks of their own, or between the records of one stream.
    let of_mdf4 = "../../../itpms-mdf4/tests/data/bus";
    for path in ["python_can.mf4", &format!("{of_mdf4}-apart.mf4"), &format!("{of_mdf4}-mixed.mf4")] {
        let (frames, repairs) = read(&data(path));
        // A time since the beginning is added to the date: two roundings of 0.24 us.
        assert_same(&frames, (0..48).map(expected), 0.5e-6);
        assert!(repairs.warnings().is_empty(), "{path}: {:?}", repairs.warnings());
    }
}

#[test]
#[cfg(feature = "mdf4")]
fn an_mdf4_file_of_signals_has_no_frames() {
    let other = FrameReader::open(&data("../../../itpms-mdf4/tests/data/plain.mf4")).unwrap_err().to_string();
    assert!(other.contains("no frames of a CAN bus, expected a channel group with CAN_DataFrame"), "{other}");
}

#[test]
fn what_python_can_writes_as_trace_and_table_is_read() {
    let (frames, repairs) = read(&data("python_can.trc"));
    // It writes classic data frames alone.
    let classic = |frame: &CanFrame| frame.kind == FrameKind::Data;
    // The first stamp is days since 1899 as a double, steps of 0.6 us.
    assert_same(&frames, (0..48).map(expected).filter(classic), 1.5e-6);
    assert!(repairs.is_clean(), "{:?}", repairs.warnings());

    let (frames, repairs) = read(&data("python_can.csv"));
    // The table has neither bus nor direction, nor says which frames are those of CAN FD.
    let of_table = |frame: CanFrame| {
        let plain = FrameKind::Fd { bit_rate_switch: false, error_state_indicator: false };
        let kind = match frame.kind {
            FrameKind::Fd { .. } if frame.length() > 8 => plain,
            FrameKind::Fd { .. } => FrameKind::Data,
            kind => kind,
        };
        CanFrame { bus: 0, direction: Direction::Rx, kind, ..frame }
    };
    assert_same(&frames, (0..48).map(expected).map(of_table), 0.0);
    assert!(repairs.is_clean(), "{:?}", repairs.warnings());
}

#[test]
fn what_python_can_writes_as_blf_is_read_compressed_or_not() {
    for name in ["python_can.blf", "python_can_stored.blf"] {
        let (frames, repairs) = read(&data(name));
        // Stamps are cut to whole nanoseconds, the sum is a double.
        assert_same(&frames, (0..48).map(expected), 0.5e-6);
        assert!(repairs.is_clean(), "{name}: {:?}", repairs.warnings());
        assert_eq!((repairs.frames, repairs.passed_over), (48, 1));
    }
}

#[test]
fn every_format_gives_back_what_went_in() {
    let dir = tempfile::tempdir().unwrap();
    // Enough frames for several containers of a BLF.
    let frames: Vec<CanFrame> = (0..6000).map(expected).collect();
    for (name, tolerance_s) in
        [("all.log", 0.0), ("all.CANDUMP", 0.0), ("all.asc", 0.5e-6), ("all.blf", 0.5e-6)]
    {
        let path = dir.path().join(name);
        let mut writer = FrameWriter::create(&path).unwrap();
        frames.iter().for_each(|frame| writer.write(frame).unwrap());
        assert!(!path.exists());
        writer.finish().unwrap().commit().unwrap();
        let (read, repairs) = read(&path);
        let kept = frames.iter().map(|frame| match (frame.kind, name) {
            (FrameKind::Error, "all.asc") => {
                CanFrame { id: CanId::extended(0).unwrap(), payload: Payload::EMPTY, ..*frame }
            }
            // A frame's identifier is no class of errors: it is written as a bus error.
            (FrameKind::Error, "all.log" | "all.CANDUMP") => {
                CanFrame { id: CanId::extended(0x80).unwrap(), payload: Payload::EMPTY, ..*frame }
            }
            _ => *frame,
        });
        assert_same(&read, kept, tolerance_s);
        assert!(repairs.is_clean(), "{name}: {:?}", repairs.warnings());
    }
}

#[test]
fn an_empty_log_is_written_and_read_where_the_format_has_a_header() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["empty.asc", "empty.blf"] {
        let path = dir.path().join(name);
        FrameWriter::create(&path).unwrap().finish().unwrap().commit().unwrap();
        assert_eq!(read(&path).0, []);
    }
}

#[test]
fn a_time_that_no_log_can_hold_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let mut writer = FrameWriter::create(&dir.path().join("a.log")).unwrap();
    for time_s in [-1e-6, f64::NAN, f64::INFINITY, 1e12] {
        let error = writer.write(&CanFrame { time_s, ..expected(0) }).unwrap_err();
        assert!(error.to_string().contains("expected 0 s to the end of the year 9999"), "{error}");
    }
}

#[test]
fn candumps_screen_is_read_whatever_the_stamps_count_from() {
    let rows: Vec<u32> = (0..100).collect();
    // 10 ms and a jitter of up to 1 ms that no clock of a bus is without.
    let step_us = |i: u32| if i == 0 { 0 } else { 10_000 + u64::from(i * 7919 % 1000) };
    let times_us: Vec<u64> = rows
        .iter()
        .scan(0, |sum, i| {
            *sum += step_us(*i);
            Some(*sum)
        })
        .collect();
    let line = |us: u64, digits: usize, i: u32| {
        let (whole, fraction) = (us / 1_000_000, us % 1_000_000);
        format!(" ({whole:0digits$}.{fraction:06})  can0  {:03X}   [2]  12 {i:02X}\n", 0x100 + i)
    };
    let absolute: String =
        rows.iter().map(|i| line(1_436_509_052_000_000 + times_us[*i as usize], 10, *i)).collect();
    let from_zero: String = rows.iter().map(|i| line(times_us[*i as usize], 3, *i)).collect();
    let differences: String = rows.iter().map(|i| line(step_us(*i), 3, *i)).collect();
    for (text, start_s) in [(&absolute, 1_436_509_052.0), (&from_zero, 0.0), (&differences, 0.0)] {
        let (frames, repairs) = read_text("screen.log", text);
        assert_eq!(frames.len(), 100);
        for (frame, us) in frames.iter().zip(&times_us) {
            assert!((frame.time_s - start_s - *us as f64 / 1e6).abs() < 0.5e-6);
        }
        assert_eq!(repairs.assumptions.len(), usize::from(text == &differences));
    }
}

#[test]
fn a_relative_asc_sums_every_event_and_a_decimal_one_is_decimal() {
    let text = "date Fri Nov 20 05:17:33.500 pm 2026\r\nbase dec  timestamps relative\r\nno internal events logged\r\n\
                   0.250000 1  291             Rx   d 2 222 173 Length = 0\r\n\
                   0.125000 1  Statistic: D 1 R 0 XD 0 XR 0 E 0 O 0 B 0.00%\r\n\
                   0.125000 2  419430400x      Tx   d 1 7\r\n";
    let (frames, repairs) = read_text("relative.asc", text);
    let start_s = 1_795_195_053.5;
    assert_eq!(frames.iter().map(|frame| frame.time_s).collect::<Vec<_>>(), [start_s + 0.25, start_s + 0.5]);
    assert_eq!((frames[0].id, frames[0].data()), (CanId::standard(0x123).unwrap(), &[0xDE, 0xAD][..]));
    assert_eq!((frames[1].id, frames[1].bus), (CanId::extended(0x1900_0000).unwrap(), 1));
    assert_eq!(repairs.passed_over, 1);
}

#[test]
fn a_second_trigger_block_counts_where_its_stamps_begin_again() {
    let block = |seconds: u32, stamp: &str| {
        format!(
            "Begin TriggerBlock Fri Nov 20 17:00:{seconds:02} 2026\n {stamp} 1 123 Rx d 0\nEnd TriggerBlock\n"
        )
    };
    let header = "date Fri Nov 20 17:00:00 2026\nbase hex  timestamps absolute\n";
    let times = |text: &str| {
        let (frames, _) = read_text("blocks.asc", text);
        frames.iter().map(|frame| frame.time_s - 1_795_194_000.0).collect::<Vec<_>>()
    };
    assert_eq!(times(&format!("{header}{}{}", block(0, "1.5"), block(30, "31.5"))), [1.5, 31.5]);
    assert_eq!(times(&format!("{header}{}{}", block(0, "1.5"), block(30, "0.25"))), [1.5, 30.25]);
}

#[test]
fn lines_that_mean_nothing_are_left_out_and_counted() {
    let text = "(1.0) can0 123#11\nDROPCOUNT: dropped 5 CAN frames on 'can0' socket (total drops 5)\nwhat?\n\n(1.1) can0 123#1\n(1.2) can0 123#12\n(1.3) can0 12";
    let (frames, repairs) = read_text("odd.log", text);
    assert_eq!(frames.len(), 2);
    assert_eq!((repairs.not_understood, repairs.lost_by_logger), (2, 5));
    assert_eq!(repairs.first_not_understood.as_ref().unwrap().place, FramePlace::Line(3));
    assert_eq!(repairs.cut_off, Some(FramePlace::Line(7)));
    assert_eq!(repairs.warnings().len(), 3);

    // Cut within the stamp of a line, which alone would be an event.
    let cut = "date Fri Nov 20 17:00:00 2026\nbase hex  timestamps absolute\n0.5 1 123 Rx d 1 11\n   0.7";
    let (frames, repairs) = read_text("cut.asc", cut);
    assert_eq!((frames.len(), repairs.cut_off), (1, Some(FramePlace::Line(4))));

    let long = format!("(1.0) can0 123#11\n{}\n(1.2) can0 123#12\n", "x".repeat(3_000_000));
    let (frames, repairs) = read_text("long.log", &long);
    assert_eq!((frames.len(), repairs.not_understood), (2, 1));
}

#[test]
fn what_is_no_log_says_what_was_found_and_what_was_expected() {
    let screen = b"  can0  123   [4]  DE AD BE EF\n";
    assert!(message_of("a.log", screen).contains("candump -L"), "{}", message_of("a.log", screen));
    assert!(message_of("a.log", b"").starts_with("the file is empty"));
    assert!(message_of("a.asc", b"\n\n").starts_with("the file is empty"));
    assert!(message_of("a.blf", b"").starts_with("the file is empty"));
    let csv = message_of("a.log", b"time_s,speed_m_s\n0,1\n");
    assert!(csv.contains("line 1 is \"time_s,speed_m_s\"") && csv.contains("(1436509052.249713)"), "{csv}");
    let many = message_of("a.asc", "no such thing here\n".replace("no", "never").repeat(50_000).as_bytes());
    assert!(many.contains("none of the first 10000 lines"), "{many}");
    let table = message_of("a.asc", b"0.0 1.5 2.5\n0.1 1.6 2.6\n");
    assert!(table.contains("line 1 is \"0.0 1.5 2.5\""), "{table}");
    let blf = message_of("a.blf", &[b'x'; 500]);
    assert!(blf.contains("\"xxxx\"") && blf.contains("LOGG"), "{blf}");
    let mut hollow = fs::read(data("python_can.blf")).unwrap();
    hollow[144..].fill(0xAA);
    assert!(message_of("a.blf", &hollow).contains("LOBJ"), "{}", message_of("a.blf", &hollow));
    assert!(message_of("a.pcap", b"x").contains(".log or .candump"));
    if cfg!(feature = "mdf4") {
        assert!(message_of("a.mf4", b"x").starts_with("not an MDF file"));
    }
    assert!(message_of("a.csv", b"time_s,speed_m_s\n").contains("expected a line of a table of frames"));
    let trace = message_of("a.trc", b";$FILEVERSION=2.1\n1 1.0 DT 1 0001 Rx - 0\n");
    assert!(trace.contains("line 2 is \"1 1.0 DT"), "{trace}");
    assert!(message_of("a.log", b"***BUSMASTER Ver 3***\n").starts_with("the file is empty"));
    let written = FrameWriter::create(Path::new("a.trc")).unwrap_err().to_string();
    assert!(written.contains("expected .log or .candump (candump), .asc or .blf"), "{written}");
}

#[test]
fn a_blf_is_read_past_a_damaged_container() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("all.blf");
    let frames: Vec<CanFrame> = (0..12_000).map(expected).collect();
    let mut writer = FrameWriter::create(&path).unwrap();
    frames.iter().for_each(|frame| writer.write(frame).unwrap());
    writer.finish().unwrap().commit().unwrap();
    let mut bytes = fs::read(&path).unwrap();
    let containers: Vec<usize> =
        (0..bytes.len() - 4).filter(|at| bytes[*at..].starts_with(b"LOBJ")).collect();
    assert!(containers.len() >= 4, "{}", containers.len());
    // The second container does not inflate beyond its middle.
    let middle = (containers[1] + containers[2]) / 2;
    bytes[middle..middle + 40].fill(0xFF);
    fs::write(&path, &bytes).unwrap();
    let (read, repairs) = read(&path);
    assert!(!repairs.is_clean());
    assert!(read.len() < frames.len() && read.len() > frames.len() / 2);
    // Nothing is made up: but for the damaged bytes themselves, the frames read are a subsequence of those written.
    let mut written = frames.iter();
    let strange = read
        .iter()
        .filter(|found| {
            let same = |frame: &&CanFrame| {
                (frame.time_s - found.time_s).abs() < 0.5e-6
                    && CanFrame { time_s: 0.0, ..**frame } == CanFrame { time_s: 0.0, ..**found }
            };
            let ahead = written.clone().position(|frame| same(&frame));
            ahead.map(|ahead| written.nth(ahead)).is_none()
        })
        .count();
    // Deflate has no check sums within a stream: some objects around the damage may be wrong.
    assert!(strange <= 100, "{strange} frames that nobody wrote");
    // The last container is whole.
    assert_same(&read[read.len() - 1000..], frames[frames.len() - 1000..].iter().copied(), 0.5e-6);
}

#[test]
fn progress_goes_from_nothing_to_all() {
    for name in ["python_can.log", "python_can.asc", "python_can.blf"] {
        let mut reader = FrameReader::open(&data(name)).unwrap();
        assert!(reader.progress() < 0.2);
        let mut last = 0.0;
        while reader.next_frame().unwrap().is_some() {
            assert!((last..=1.0).contains(&reader.progress()));
            last = reader.progress();
        }
        assert_eq!(reader.progress(), 1.0, "{name}");
    }
}
