//! Estimates as CAN frames of our own DBC: a frame per wheel, one of further standard deviations and one of status with every estimate, and
//! with every tenth what is found beside the pressures.
//!
//! The frames are made from the very text that `itpms monitor --print-dbc` prints: what it says of bits, factors and
//! labels is what is sent.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use itpms_data::can::{CanFrame, CanId, Direction, FrameKind, candump};
use itpms_data::dbc::{Dbc, Message};
use serde_json::Value;

use super::{Output, WhenSlow};
use crate::engine::{Published, unix_s};
use crate::error::LiveError;
use crate::input::{Note, NoteSink};
use crate::snapshot::{Snapshot, SourceState, Wheel};

/// The description of our frames.
pub const DBC: &str = include_str!("itpms.dbc");

const STATUS: &str = "ITPMS_Status";
const DEVIATIONS: &str = "ITPMS_Deviations";
const COLD: &str = "ITPMS_Cold";
const DAMPERS: &str = "ITPMS_Dampers";
const LOAD: &str = "ITPMS_Load";
const TURNING: &str = "ITPMS_Turning";
/// Findings beside the pressures change slowly: sent once in so many sets.
const BESIDE_EVERY: u64 = 10;
const DAMPER_STATES: [&str; 6] = ["unknown", "learning", "fine", "weak", "worn", "stiff"];
const LOAD_STATES: [&str; 4] = ["unknown", "learning", "known", "overload"];
const TURNING_STATES: [&str; 4] = ["slow", "no-line", "found", "rising"];
const SENSOR_STATES: [&str; 6] = ["unknown", "learning", "fine", "leak", "drift", "stuck"];
const STATES: [&str; 6] = ["unknown", "fine", "low", "over", "malfunction", "uncertain"];
const WARNINGS: [&str; 3] = ["none", "low", "malfunction"];
const LEVELS: [&str; 2] = ["file", "calibration"];
const CORNERS: [&str; 4] = ["fl", "fr", "rl", "rr"];

/// Identifiers of our frames. Errors: our description is broken, which a test excludes.
pub fn identifiers() -> Result<Vec<CanId>, LiveError> {
    Ok(description()?.messages().iter().map(|message| message.id).collect())
}

fn description() -> Result<Dbc, LiveError> {
    Dbc::parse(DBC).map_err(|error| LiveError::Refused(format!("itpms.dbc: {error}")))
}

#[derive(Debug)]
pub struct Frames {
    dbc: Dbc,
    sets: u64,
}

impl Frames {
    /// A maker that has made none.
    pub fn new() -> Result<Self, LiveError> {
        Ok(Self { dbc: description()?, sets: 0 })
    }

    pub fn of(&mut self, snapshot: &Snapshot) -> Vec<CanFrame> {
        let sets = self.sets;
        self.sets += 1;
        // Sent again they are as old as before, and that is in them.
        let time_s = unix_s();
        let mut frames = Vec::with_capacity(6);
        for message in self.dbc.messages() {
            let frame = if message.name == STATUS {
                frame(message, time_s, |signal| status_value(snapshot, sets, signal))
            } else if message.name == DEVIATIONS {
                // Without wheels there is nothing to say.
                let any = !snapshot.wheels.is_empty();
                any.then(|| frame(message, time_s, |signal| deviation_value(snapshot, sets, signal)))
                    .flatten()
            } else if [COLD, DAMPERS, LOAD, TURNING].contains(&message.name.as_str()) {
                let due = sets.is_multiple_of(BESIDE_EVERY) && has(snapshot, &message.name);
                due.then(|| frame(message, time_s, |signal| beside_value(snapshot, sets, signal))).flatten()
            } else {
                let wheel = snapshot.wheels.iter().find(|wheel| message.name.ends_with(&upper(wheel.corner)));
                wheel.and_then(|wheel| frame(message, time_s, |signal| wheel_value(wheel, sets, signal)))
            };
            frames.extend(frame);
        }
        frames
    }
}

fn upper(corner: &str) -> String {
    format!("_{}", corner.to_uppercase())
}

fn frame(message: &Message, time_s: f64, value: impl Fn(&str) -> f64) -> Option<CanFrame> {
    let named = |place: usize| message.signals.get(place).map_or(f64::NAN, |signal| value(&signal.name));
    let payload = message.encode(named).ok()?;
    Some(CanFrame {
        time_s,
        bus: 0,
        id: message.id,
        kind: FrameKind::Data,
        direction: Direction::Tx,
        payload,
    })
}

fn status_value(snapshot: &Snapshot, sets: u64, signal: &str) -> f64 {
    let bits = |state: &str| {
        let places = CORNERS.iter().enumerate();
        let wheels = places.filter(|(_, corner)| {
            snapshot.wheels.iter().any(|wheel| wheel.corner == **corner && wheel.state == state)
        });
        wheels.map(|(place, _)| f64::from(1u8 << place)).sum()
    };
    match signal {
        "ITPMS_Counter" => (sets % 256) as f64,
        "ITPMS_Source" => match snapshot.source.state {
            SourceState::Live => 0.0,
            SourceState::Stale => 1.0,
            SourceState::Ended => 2.0,
        },
        "ITPMS_AllFine" => f64::from(u8::from(snapshot.all_fine)),
        "ITPMS_Alerts" => snapshot.alerts.len().min(15) as f64,
        "ITPMS_WheelsLow" => bits("low"),
        "ITPMS_WheelsMalfunction" => bits("malfunction"),
        "ITPMS_Latency" => snapshot.latency_ms.p99,
        "ITPMS_Distance" => snapshot.distance_m / 1000.0,
        _ => f64::NAN,
    }
}

fn deviation_value(snapshot: &Snapshot, sets: u64, signal: &str) -> f64 {
    let Some((what, whose)) = signal.rsplit_once('_') else { return f64::NAN };
    let found = |corner: &str| snapshot.wheels.iter().find(|wheel| wheel.corner.eq_ignore_ascii_case(corner));
    let left_of = |axle: &str| found(if axle == "F" { "fl" } else { "rl" });
    match what {
        "ITPMS_ChangeSd" => found(whose).map_or(f64::NAN, |wheel| wheel.change_sd_kpa),
        "ITPMS_AxleDifferenceSd" => {
            left_of(whose).and_then(|wheel| wheel.axle_difference_sd_kpa).unwrap_or(f64::NAN)
        }
        "ITPMS_Counter" => (sets % 16) as f64,
        _ => f64::NAN,
    }
}

/// Whether there is anything to send in such a frame.
fn has(snapshot: &Snapshot, message: &str) -> bool {
    let is = |what: &str| snapshot.beside.get(what).is_some_and(Value::is_object);
    match message {
        COLD => snapshot.wheels.iter().any(|wheel| wheel.cold_pressure_kpa.is_some()),
        DAMPERS => is("dampers"),
        LOAD => is("load"),
        _ => is("once_per_turn") || is("tire_sensors"),
    }
}

fn beside_value(snapshot: &Snapshot, sets: u64, signal: &str) -> f64 {
    let of_corner = signal.rsplit_once('_').map(|(what, corner)| (what, corner.to_ascii_lowercase()));
    let (what, corner) = of_corner.filter(|(what, _)| *what != "ITPMS").unwrap_or((signal, String::new()));
    let of = |group: &str, key: &str| {
        let group = snapshot.beside.get(group)?;
        (if corner.is_empty() { group } else { group.get(&corner)? }).get(key)
    };
    let number = |group, key| of(group, key).and_then(Value::as_f64).unwrap_or(f64::NAN);
    let word = |words: &[&str], group| {
        let word = of(group, "state").and_then(Value::as_str);
        word.map_or(0.0, |word| place(words, word))
    };
    let wheel = || snapshot.wheels.iter().find(|wheel| wheel.corner == corner);
    match what {
        "ITPMS_ColdPressure" => wheel().and_then(|wheel| wheel.cold_pressure_kpa).unwrap_or(f64::NAN),
        "ITPMS_ColdPressureSd" => wheel().and_then(|wheel| wheel.cold_pressure_sd_kpa).unwrap_or(f64::NAN),
        "ITPMS_Damper" => word(&DAMPER_STATES, "dampers"),
        "ITPMS_DamperOverReference" => number("dampers", "over_reference"),
        "ITPMS_DamperOverReferenceSd" => number("dampers", "over_reference_sd"),
        "ITPMS_FrontAxle" => number("load", "front_axle_kg"),
        "ITPMS_RearAxle" => number("load", "rear_axle_kg"),
        "ITPMS_TotalSd" => number("load", "total_sd_kg"),
        "ITPMS_Added" => number("load", "added_kg"),
        "ITPMS_AddedSd" => number("load", "added_sd_kg"),
        "ITPMS_LoadState" => word(&LOAD_STATES, "load"),
        "ITPMS_OncePerTurn" => number("once_per_turn", "force_n"),
        "ITPMS_OncePerTurnState" => word(&TURNING_STATES, "once_per_turn"),
        "ITPMS_TireSensor" => word(&SENSOR_STATES, "tire_sensors"),
        "ITPMS_Counter" => (sets / BESIDE_EVERY % 16) as f64,
        _ => f64::NAN,
    }
}

/// The place of a word among those of a signal.
fn place(words: &[&str], word: &str) -> f64 {
    words.iter().position(|one| *one == word).map_or(f64::NAN, |place| place as f64)
}

fn wheel_value(wheel: &Wheel, sets: u64, signal: &str) -> f64 {
    // The corner's two letters tell the wheels' signals apart.
    match signal.get(..signal.len().saturating_sub(3)).unwrap_or_default() {
        "ITPMS_Pressure" => wheel.pressure_kpa,
        "ITPMS_PressureSd" => wheel.pressure_sd_kpa,
        "ITPMS_State" => place(&STATES, wheel.state),
        "ITPMS_Valid" => f64::from(u8::from(wheel.valid)),
        "ITPMS_Reference" => wheel.reference_kpa,
        "ITPMS_Warning" => place(&WARNINGS, wheel.warning),
        "ITPMS_Level" => place(&LEVELS, wheel.level),
        "ITPMS_Counter" => (sets % 16) as f64,
        "ITPMS_Gate" => wheel.gate,
        _ => f64::NAN,
    }
}

enum Target {
    /// A file of candump's lines.
    File(BufWriter<File>),
    #[cfg(target_os = "linux")]
    Bus(bus::Bus),
}

/// Frames to an interface or to a file of candump's lines.
pub struct CanOut {
    name: String,
    interface: String,
    target: Target,
    frames: Frames,
}

impl CanOut {
    /// Opens an interface (a name without a dot and a slash) or a file. Errors: there is no such interface, or the file cannot be written.
    pub fn open(target: &str, notes: &NoteSink) -> Result<Self, LiveError> {
        let frames = Frames::new()?;
        let name = target.to_owned();
        if is_interface(target) {
            let (interface, target) = (name.clone(), open_bus(target, notes)?);
            return Ok(Self { name, interface, target, frames });
        }
        let file = File::options().create(true).append(true).open(Path::new(target));
        let file = file.map_err(|error| LiveError::Output { target: name.clone(), error })?;
        let target = Target::File(BufWriter::new(file));
        Ok(Self { name, interface: "itpms0".to_owned(), target, frames })
    }

    /// The output at work: a bus is never waited for, a file is.
    pub fn start(self) -> Output {
        let when_slow = match self.target {
            Target::File(_) => WhenSlow::Wait,
            #[cfg(target_os = "linux")]
            Target::Bus(_) => WhenSlow::LoseEstimates,
        };
        Output::start(when_slow, self, Self::write, |mut out| out.flushed(Ok(())))
    }

    fn write(&mut self, waiting: &mut VecDeque<Published>) -> Result<(), LiveError> {
        let mut written = Ok(());
        for published in waiting.drain(..) {
            let Published::Estimate(snapshot) = published else { continue };
            for frame in self.frames.of(&snapshot) {
                written = written.and_then(|()| match &mut self.target {
                    Target::File(file) => writeln!(file, "{}", candump::format_line(&frame, &self.interface)),
                    #[cfg(target_os = "linux")]
                    Target::Bus(bus) => {
                        bus.send(&frame);
                        Ok(())
                    }
                });
            }
        }
        self.flushed(written)
    }

    fn flushed(&mut self, written: io::Result<()>) -> Result<(), LiveError> {
        let flushed = match &mut self.target {
            Target::File(file) => written.and_then(|()| file.flush()),
            #[cfg(target_os = "linux")]
            Target::Bus(_) => written,
        };
        flushed.map_err(|error| LiveError::Output { target: self.name.clone(), error })
    }
}

/// Whether this names an interface rather than a file.
pub fn is_interface(target: &str) -> bool {
    !target.contains(['.', '/', '\\'])
}

#[cfg(target_os = "linux")]
fn open_bus(interface: &str, notes: &NoteSink) -> Result<Target, LiveError> {
    bus::Bus::open(interface, notes).map(Target::Bus)
}

#[cfg(not(target_os = "linux"))]
fn open_bus(interface: &str, _notes: &NoteSink) -> Result<Target, LiveError> {
    let error = io::Error::new(io::ErrorKind::Unsupported, "SocketCAN is Linux's alone; expected a file");
    Err(LiveError::Output { target: interface.to_owned(), error })
}

/// An interface that frames are sent on, opened again when it was gone.
#[cfg(target_os = "linux")]
mod bus {
    use std::io;
    use std::time::{Duration, Instant};

    use super::{CanFrame, LiveError, Note, NoteSink};
    use socketcan::{CanDataFrame, CanSocket, EmbeddedFrame as _, Socket as _, StandardId};

    /// How long a full buffer of the interface is waited for.
    const PATIENCE: Duration = Duration::from_millis(20);
    /// How long an interface is not tried again.
    const PAUSE: Duration = Duration::from_secs(1);

    pub(super) struct Bus {
        name: String,
        socket: Option<CanSocket>,
        tried: Instant,
        failed: bool,
        notes: NoteSink,
    }

    impl Bus {
        pub(super) fn open(name: &str, notes: &NoteSink) -> Result<Self, LiveError> {
            let socket = open(name).map_err(|error| LiveError::Output { target: name.to_owned(), error })?;
            let (name, notes) = (name.to_owned(), std::sync::Arc::clone(notes));
            Ok(Self { name, socket: Some(socket), tried: Instant::now(), failed: false, notes })
        }

        /// Sends, or says once that it cannot.
        pub(super) fn send(&mut self, frame: &CanFrame) {
            if self.socket.is_none() && self.tried.elapsed() > PAUSE {
                self.tried = Instant::now();
                self.socket = open(&self.name).ok();
            }
            let Some(socket) = &self.socket else { return };
            // All our identifiers have 11 bits and all our frames 8 bytes.
            let id = u16::try_from(frame.id.value()).ok().and_then(StandardId::new);
            let Some(frame) = id.and_then(|id| CanDataFrame::new(id, frame.data())) else { return };
            match socket.write_frame(&frame) {
                Ok(()) if self.failed => {
                    self.failed = false;
                    (self.notes)(Note::Remark(format!("{}: takes frames again", self.name)));
                }
                Ok(()) => {}
                Err(error) => {
                    if !std::mem::replace(&mut self.failed, true) {
                        (self.notes)(Note::Warning(format!("{}: takes no frames: {error}", self.name)));
                    }
                    // A full buffer empties itself; anything else needs a new socket.
                    if error.kind() != io::ErrorKind::WouldBlock && error.raw_os_error() != Some(105) {
                        self.tried = Instant::now();
                        self.socket = None;
                    }
                }
            }
        }
    }

    fn open(name: &str) -> io::Result<CanSocket> {
        let socket = CanSocket::open(name)?;
        socket.set_write_timeout(PATIENCE)?;
        Ok(socket)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use serde_json::json;

    use super::*;

    #[test]
    fn what_is_found_beside_the_pressures_is_in_frames_of_its_own() {
        let beside = json!({
            "dampers": { "rl": { "state": "worn", "over_reference": 0.49, "over_reference_sd": 0.04 } },
            "load": { "state": "overload", "front_axle_kg": 812.0, "rear_axle_kg": 905.0, "total_sd_kg": 34.0, "added_kg": -241.0, "added_sd_kg": null },
            "once_per_turn": { "fr": { "state": "rising", "force_n": 81.3 } },
            "tire_sensors": { "rr": { "state": "stuck" } },
        });
        let cold = Wheel {
            corner: "fl",
            cold_pressure_kpa: Some(218.2),
            cold_pressure_sd_kpa: Some(5.1),
            ..Wheel::default()
        };
        let beside = beside.as_object().unwrap().clone().into();
        let snapshot = Snapshot { wheels: vec![cold], beside, ..Snapshot::default() };
        let mut frames = Frames::new().unwrap();
        let (first, second) = (frames.of(&snapshot), frames.of(&snapshot));
        assert_eq!(first.len(), second.len() + 4, "with every tenth set");
        let dbc = description().unwrap();
        let mut found = HashMap::new();
        for frame in &first {
            let message = dbc.message(frame.id).unwrap();
            message.decode(frame.data(), |place, value| {
                found.insert(message.signals[place].name.clone(), value);
            });
        }
        for (signal, value, half_a_step) in [
            ("ITPMS_ColdPressure_FL", 218.2, 0.25),
            ("ITPMS_ColdPressureSd_FL", 5.1, 1.0),
            ("ITPMS_Damper_RL", 4.0, 0.0),
            ("ITPMS_Damper_FL", 0.0, 0.0),
            ("ITPMS_DamperOverReference_RL", 0.49, 0.005),
            ("ITPMS_DamperOverReferenceSd_RL", 0.04, 0.01),
            ("ITPMS_FrontAxle", 812.0, 1.0),
            ("ITPMS_RearAxle", 905.0, 1.0),
            ("ITPMS_TotalSd", 34.0, 1.0),
            ("ITPMS_Added", -241.0, 1.0),
            ("ITPMS_LoadState", 3.0, 0.0),
            ("ITPMS_OncePerTurn_FR", 81.3, 0.5),
            ("ITPMS_OncePerTurnState_FR", 3.0, 0.0),
            ("ITPMS_TireSensor_RR", 5.0, 0.0),
        ] {
            let sent = found.get(signal).copied().unwrap_or(f64::NAN);
            assert!((sent - value).abs() <= half_a_step + 1e-9, "{signal}: {sent}");
        }
        // An unknown value is no number.
        for unknown in ["ITPMS_AddedSd", "ITPMS_OncePerTurn_FL", "ITPMS_ColdPressure_RR"] {
            assert!(found.get(unknown).is_none_or(|value| value.is_nan()), "{unknown} {found:?}");
        }
    }
}
