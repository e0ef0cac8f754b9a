//! The estimating thread: it says when nothing comes, goes on bit by bit from a saved state, and waits for no output.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, mpsc};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use itpms_core::model::Corner;
use itpms_data::can::{CanFrame, CanId};
use itpms_data::dbc::{Dbc, Decoder};
use itpms_data::{LogRow, Vehicle};
use itpms_live::drive::DriveOptions;
use itpms_live::engine::{Engine, Published};
use itpms_live::feed::Feed;
use itpms_live::hub::Hub;
use itpms_live::input::{Input, Note, NoteSink, SourceName};
use itpms_live::monitor::{End, Monitor};
use itpms_live::output::{JsonLines, WhenSlow};
use itpms_live::queue::Queue;
use itpms_live::snapshot::SourceState;
use itpms_live::state::SavedDrive;

use crate::common::{notes, rows, snapshot, transition, with_large_stack};

fn engine(saved: Option<SavedDrive>) -> Engine {
    let source = SourceName { name: "test".to_owned(), kind: "replay" };
    Engine::new(Vehicle::paper(), DriveOptions::default(), source, saved, notes())
}

fn opened() -> Input {
    Input::Opened { sample_rate_hz: 200.0, corners: Corner::ALL.to_vec(), wheel_speeds: false }
}

fn input(row: LogRow) -> Input {
    Input::Row { row: Box::new(row), arrived: Instant::now() }
}

fn telling_engine(saved: Option<SavedDrive>) -> (Engine, Arc<Mutex<Vec<String>>>) {
    let reported = Arc::new(Mutex::new(Vec::new()));
    let notes: NoteSink = Arc::new({
        let reported = Arc::clone(&reported);
        move |note| {
            let (Note::Remark(text) | Note::Warning(text)) = note;
            reported.lock().unwrap().push(text);
        }
    });
    let source = SourceName { name: "test".to_owned(), kind: "replay" };
    (Engine::new(Vehicle::paper(), DriveOptions::default(), source, saved, notes), reported)
}

/// Estimates of these rows as JSON, without what depends on the wall clock; and the bytes of the state after them.
fn estimated(mut engine: Engine, rows: impl Iterator<Item = LogRow>) -> (Vec<String>, Vec<u8>) {
    let mut told = Vec::new();
    engine.open(200.0, &Corner::ALL, false).unwrap();
    for row in rows {
        engine
            .take(&row, None, &mut |published| {
                if let Published::Estimate(snapshot) = published {
                    let wheels = serde_json::to_string(&snapshot.wheels).unwrap();
                    told.push(format!("{} {} {wheels}", snapshot.time_s, snapshot.distance_m));
                }
            })
            .unwrap();
    }
    let saved = engine.saved().unwrap();
    (told, saved)
}

#[test]
fn a_saved_drive_goes_on_to_the_same_bits() {
    with_large_stack(resumed);
}

fn resumed() {
    let (all, last) = estimated(engine(None), rows(8000));
    let (first, saved) = estimated(engine(None), rows(3333));
    let options = DriveOptions::default();
    let saved = SavedDrive::parse(&saved, &Vehicle::paper(), &options).unwrap();
    let (second, last_again) = estimated(engine(Some(saved)), rows(8000).skip(3333));
    assert_eq!(all.len(), 400);
    // The roughness of a segment that a restart has cut in two is not known; all else is the same.
    let plain = |lines: &[String]| lines.iter().map(|line| strip(line)).collect::<Vec<_>>();
    assert_eq!(plain(&[first, second].concat()), plain(&all));
    // The estimator itself, every bit of it, is in the state.
    let car = |bytes: &[u8]| SavedDrive::parse(bytes, &Vehicle::paper(), &options).unwrap();
    assert_eq!(format!("{:?}", car(&last).drive()), format!("{:?}", car(&last_again).drive()));
}

#[test]
fn a_burst_of_a_bus_that_wakes_up_does_not_set_the_rate() {
    with_large_stack(|| {
        let (mut engine, reported) = telling_engine(None);
        let burst = rows(12).map(|row| LogRow { time_s: 0.4 * row.time_s, ..row });
        let then = rows(1000).map(|row| LogRow { time_s: 3.0 + row.time_s, ..row });
        for row in burst.chain(then) {
            engine.take(&row, None, &mut |_| {}).unwrap();
        }
        assert_eq!(engine.snapshot().source.rate_hz, 200.0);
        let reported = reported.lock().unwrap();
        assert!(reported.len() == 1 && reported[0].contains("2.0 ms apart: bursts"), "{reported:?}");
    });
}

#[test]
fn an_old_snapshot_is_dated_by_its_data() {
    with_large_stack(|| {
        let mut engine = engine(None);
        engine.open(200.0, &Corner::ALL, false).unwrap();
        // Before the first row, when the monitor began.
        let begun_s = engine.snapshot().unix_s;
        thread::sleep(Duration::from_millis(30));
        assert_eq!(engine.snapshot().unix_s, begun_s);
        let before_s = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs_f64();
        assert!((before_s - 60.0..before_s - 0.029).contains(&begun_s), "{} {before_s}", begun_s);
        rows(400).for_each(|row| engine.take(&row, None, &mut |_| {}).unwrap());
        let dated = engine.snapshot();
        assert!((before_s - 0.1..before_s + 60.0).contains(&dated.unix_s), "{} {before_s}", dated.unix_s);
        thread::sleep(Duration::from_millis(30));
        engine.source_mut().state = SourceState::Stale;
        assert_eq!(engine.snapshot().unix_s, dated.unix_s);
        engine.take(&rows(401).last().unwrap(), None, &mut |_| {}).unwrap();
        assert!(engine.snapshot().unix_s > dated.unix_s + 0.029);
    });
}

#[test]
fn a_clock_that_is_set_back_is_no_other_car() {
    with_large_stack(|| {
        // Four seconds on, a second back; and a saved drive whose clock is ahead of the one of today.
        let (_, bytes) = estimated(engine(None), rows(4000));
        let saved = SavedDrive::parse(&bytes, &Vehicle::paper(), &DriveOptions::default()).unwrap();
        let back =
            |row: LogRow| LogRow { time_s: row.time_s + if row.time_s < 4.0 { 0.0 } else { -1.0 }, ..row };
        let all: Vec<LogRow> = rows(1200).map(back).collect();
        for (saved, first_s) in [(None, 0.0), (Some(saved), 0.15)] {
            let resumed = usize::from(saved.is_some());
            let (mut engine, reported) = telling_engine(saved);
            engine.open(200.0, &Corner::ALL, false).unwrap();
            let mut reported_s = Vec::new();
            for row in &all {
                let notify = &mut |published| {
                    if let Published::Estimate(snapshot) = published {
                        reported_s.push(snapshot.time_s);
                    }
                };
                engine.take(row, None, notify).unwrap();
            }
            let set_back = 1 + resumed as u64;
            assert_eq!(engine.out_of_order(), 15 * set_back);
            assert_eq!(engine.drive().unwrap().time_s(), all[1199].time_s);
            // Ten a second all the while.
            assert!((reported_s[0] - first_s).abs() < 0.08 && reported_s.len() >= 58, "{reported_s:?}");
            let reported = reported.lock().unwrap();
            let count =
                reported.iter().filter(|text| text.contains("what is known of the car stays")).count();
            assert_eq!((count, reported.len()), (1 + resumed, 1 + 2 * resumed), "{reported:?}");
        }
    });
}

#[test]
fn numbers_in_another_unit_are_reported_once() {
    with_large_stack(|| {
        let (mut engine, reported) = telling_engine(None);
        engine.open(200.0, &Corner::ALL, false).unwrap();
        for mut row in rows(5000) {
            for corner in row.corners.iter_mut().flatten() {
                corner.body_accel_m_s2 *= 0.01;
                corner.wheel_accel_m_s2 *= 0.01;
            }
            engine.take(&row, None, &mut |_| {}).unwrap();
        }
        let reported = reported.lock().unwrap();
        assert!(reported.len() == 1 && reported[0].contains("wrong units suspected"), "{reported:?}");
    });
}

fn strip(line: &str) -> String {
    let mut parts = line.split(",\"iri_m_per_km\":");
    let first = parts.next().unwrap().to_owned();
    parts.fold(first, |all, part| all + &part[part.find('}').unwrap()..])
}

#[test]
fn a_state_that_is_damaged_foreign_or_of_another_car_is_refused_in_words() {
    with_large_stack(refused);
}

fn refused() {
    let (_, bytes) = estimated(engine(None), rows(1000));
    let (vehicle, options) = (Vehicle::paper(), DriveOptions::default());
    let refusal = |bytes: &[u8], vehicle: &Vehicle| SavedDrive::parse(bytes, vehicle, &options).unwrap_err();
    // Any byte, also of the checksum itself.
    for place in (0..bytes.len()).step_by(bytes.len() / 97) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        let why = refusal(&damaged, &vehicle);
        assert!(why.contains("damaged") || why.contains("no saved state"), "{place}: {why}");
    }
    for length in [0, 5, 30, 40, bytes.len() / 2, bytes.len() - 1] {
        refusal(&bytes[..length], &vehicle);
    }
    let mut other = vehicle.clone();
    other.corners[0].as_mut().unwrap().placard_kpa = 250.0;
    assert!(refusal(&bytes, &other).contains("with another id or other parameters"));
    let regulation =
        itpms_core::warning::Regulation::ALL.into_iter().find(|r| *r != options.settings.regulation);
    let mut others = options.clone();
    others.settings.regulation = regulation.unwrap();
    assert!(SavedDrive::parse(&bytes, &vehicle, &others).unwrap_err().contains("was made with"));
    assert!(SavedDrive::parse(&bytes, &vehicle, &options).is_ok());
}

#[test]
fn silence_is_reported_within_a_second_and_a_half_and_rows_end_it() {
    let hub = Hub::new();
    let inputs = Arc::new(Queue::new(1000));
    let monitor = Monitor::new(engine(None), Arc::clone(&hub), vec![], None, notes());
    let thread = thread::Builder::new().stack_size(8 << 20);
    let thread = thread.spawn({
        let inputs = Arc::clone(&inputs);
        move || monitor.run(&inputs, || false).unwrap()
    });
    let thread = thread.unwrap();
    let state = |hub: &Hub| hub.latest().map(|snapshot| snapshot.source.state);
    let wait = |wanted: SourceState, most: Duration| {
        let start = Instant::now();
        while state(&hub) != Some(wanted) {
            assert!(start.elapsed() < most, "{:?} instead of {wanted:?}", state(&hub));
            thread::sleep(Duration::from_millis(5));
        }
        start.elapsed()
    };
    inputs.push(opened());
    let mut drive = rows(600);
    inputs.push_all(drive.by_ref().take(300).map(input));
    wait(SourceState::Live, Duration::from_secs(5));
    let silent = wait(SourceState::Stale, Duration::from_secs(5));
    // A second of silence, a look at the clock every 50 ms, and a busy machine.
    assert!(silent < Duration::from_millis(2500), "{silent:?}");
    assert!(!hub.latest().unwrap().all_fine);
    inputs.push_all(drive.map(input));
    wait(SourceState::Live, Duration::from_secs(5));
    inputs.push(Input::Ended);
    assert_eq!(thread.join().unwrap(), End::SourceEnded);
    assert_eq!(state(&hub), Some(SourceState::Ended));
    assert_eq!(hub.latest().unwrap().source.rows, 600);
}

const DBC: &str = "\
VERSION \"\"
BU_: A
BO_ 528 Left: 6 A
 SG_ fl_body_accel_m_s2 : 0|16@1- (0.002,0) [0|0] \"m/s^2\" A
 SG_ fl_wheel_accel_m_s2 : 16|16@1- (0.01,0) [0|0] \"m/s^2\" A
 SG_ speed_m_s : 32|16@1+ (0.01,0) [0|0] \"m/s\" A
";

/// Frame `i` of a bus of 200 Hz, with a pattern that is no stuck sensor.
fn frame(i: u32) -> Input {
    let bytes = [(i * 37) as u8, 0, (i * 91) as u8, 0, 0xd0, 0x07];
    let frame = CanFrame::new(f64::from(i) / 200.0, CanId::standard(528).unwrap(), &bytes).unwrap();
    Input::Frame { frame, arrived: Instant::now() }
}

#[test]
fn after_a_silence_of_the_bus_rows_come_as_before() {
    let hub = Hub::new();
    let inputs = Arc::new(Queue::new(10_000));
    let feed = Feed::new(Decoder::new(Dbc::parse(DBC).unwrap(), None).unwrap(), Vec::new());
    let monitor = Monitor::new(engine(None), Arc::clone(&hub), vec![], None, notes()).with_feed(feed);
    let thread = thread::Builder::new().stack_size(8 << 20);
    let thread = thread.spawn({
        let inputs = Arc::clone(&inputs);
        move || monitor.run(&inputs, || false).unwrap()
    });
    let thread = thread.unwrap();
    let state = || hub.latest().map(|snapshot| snapshot.source.state);
    let wait = |wanted: SourceState| {
        let start = Instant::now();
        while state() != Some(wanted) {
            assert!(start.elapsed() < Duration::from_secs(10), "{:?} instead of {wanted:?}", state());
            thread::sleep(Duration::from_millis(5));
        }
    };
    inputs.push_all((0..1000).map(frame));
    wait(SourceState::Live);
    wait(SourceState::Stale);
    // The last row did not wait for a frame after it.
    assert_eq!(hub.latest().unwrap().source.rows, 1000);
    // Frame by frame, so that the thread looks at its clock in between.
    for i in 1000..1200 {
        inputs.push(frame(i));
        thread::sleep(Duration::from_millis(2));
    }
    let now = hub.latest().unwrap();
    assert_eq!(now.source.state, SourceState::Live);
    // A row waits at most for the two after it, here 4 ms, and a busy machine.
    assert!(now.latency_ms.p50 < 100.0, "{:?}", now.latency_ms);
    inputs.push(Input::Ended);
    assert_eq!(thread.join().unwrap(), End::SourceEnded);
    assert_eq!(hub.latest().unwrap().source.rows, 1200);
}

/// Takes nothing until it is let go.
struct Stuck {
    gate: mpsc::Receiver<()>,
    open: Arc<AtomicBool>,
    text: Arc<Mutex<Vec<u8>>>,
}

impl Write for Stuck {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if !self.open.load(Ordering::Relaxed) {
            let _ = self.gate.recv();
        }
        self.text.lock().unwrap().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_reader_that_does_not_read_stalls_nothing_and_gets_every_warning_in_the_end() {
    let (release, gate) = mpsc::channel();
    let open = Arc::new(AtomicBool::new(false));
    let text = Arc::new(Mutex::new(Vec::new()));
    let stuck = Stuck { gate, open: Arc::clone(&open), text: Arc::clone(&text) };
    let output = JsonLines::to("stuck", Box::new(stuck)).start(WhenSlow::LoseEstimates);
    let start = Instant::now();
    for seq in 0..20_000 {
        output.publish(&Published::Estimate(snapshot(seq)));
        if seq % 100 == 0 {
            output.publish(&Published::Warning(transition(seq / 100)));
        }
    }
    assert!(start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
    assert!(output.dropped() > 10_000);
    open.store(true, Ordering::Relaxed);
    release.send(()).unwrap();
    output.finish().unwrap();
    let text = String::from_utf8(text.lock().unwrap().clone()).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    let lines: Vec<_> = lines.collect();
    let of = |kind: &'static str| lines.iter().filter(move |line| line["type"] == kind);
    let warnings: Vec<u64> = of("warning").map(|line| line["seq"].as_u64().unwrap()).collect();
    assert!(warnings.into_iter().eq(0..200));
    assert_eq!(of("estimate").next_back().unwrap()["seq"], 19_999);
}
