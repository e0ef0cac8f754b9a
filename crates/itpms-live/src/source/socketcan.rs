//! A SocketCAN interface of Linux, classic and FD. Survives bus-off and an interface that goes down and up again.
//!
//! The thread reads, stamps and hands on; when the estimate is behind, the oldest waiting frames are lost and counted, so
//! that the socket is always read. Frames have the kernel's time of their arrival, which goes on when the clock is set.
//! Frames that the kernel dropped because this thread did not run for too long are not counted.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use std::{io, thread};

use itpms_data::can::{CanFrame, CanId, Direction, FrameKind, Payload};
use socketcan::{
    CanAnyFrame, CanFdSocket, EmbeddedFrame as _, Frame as _, ShouldRetry as _, Socket as _,
    SocketOptions as _,
};

use crate::broker::Backoff;
use crate::error::LiveError;
use crate::input::{Input, SourceName};
use crate::queue::Queue;
use crate::source::bus_time::BusTime;

/// How long a read waits without looking whether an end is wanted.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// Bytes that the kernel keeps for us: some 5000 frames.
const KERNEL_BUFFER: usize = 4 << 20;
/// Bits of an error frame's identifier (linux/can/error.h).
const BUS_OFF: u32 = 0x40;
const RESTARTED: u32 = 0x100;

pub fn name(interface: &str) -> SourceName {
    SourceName { name: interface.to_owned(), kind: "socketcan" }
}

#[derive(Debug)]
pub struct Interface {
    name: String,
    socket: CanFdSocket,
}

impl Interface {
    /// Opens an interface such as `can0`. Errors: there is no such interface, or no right to it.
    pub fn open(interface: &str) -> Result<Self, LiveError> {
        let socket = open(interface)
            .map_err(|error| LiveError::Interface { interface: interface.to_owned(), error })?;
        Ok(Self { name: interface.to_owned(), socket })
    }

    pub fn start(self, inputs: Arc<Queue<Input>>, stop: Arc<AtomicBool>) {
        thread::spawn(move || {
            listen(self, &inputs, &stop);
            inputs.close();
        });
    }
}

fn open(interface: &str) -> io::Result<CanFdSocket> {
    let socket = CanFdSocket::open(interface)?;
    socket.set_read_timeout(LOOK_EVERY)?;
    socket.set_recv_timestamp(true)?;
    // Without them a bus-off is just silence.
    socket.set_error_filter_accept_all()?;
    // Less than was asked for is less, and no reason not to listen.
    let _ = socket.as_raw_socket().set_recv_buffer_size(KERNEL_BUFFER);
    Ok(socket)
}

enum Received {
    Frame,
    /// Nothing in the time given, or something that is not for us.
    Silence,
    BusOff,
    /// The controller is back on the bus.
    Restarted,
    /// The interface is down or gone.
    Broken(io::Error),
}

fn listen(interface: Interface, inputs: &Queue<Input>, stop: &AtomicBool) {
    let bus = bus_of(&interface.name);
    let mut socket = Some(interface.socket);
    let mut backoff = Backoff::default();
    let mut well = true;
    let mut clock = BusClock { time: BusTime::default(), began: Instant::now() };
    while !stop.load(Ordering::Relaxed) {
        let Some(open_socket) = socket.take().or_else(|| open(&interface.name).ok()) else {
            thread::sleep(backoff.next());
            continue;
        };
        let received = read(&open_socket, bus, &mut clock, inputs);
        let news = match &received {
            Received::BusOff if well => Some(Input::Disconnected("bus-off".to_owned())),
            Received::Broken(error) if well => Some(Input::Disconnected(error.to_string())),
            Received::Frame | Received::Restarted if !well => Some(Input::Reconnected),
            _ => None,
        };
        if let Some(news) = news {
            well = matches!(news, Input::Reconnected);
            inputs.push_now(news, may_go);
        }
        match received {
            Received::Broken(_) => thread::sleep(backoff.next()),
            received => {
                if matches!(received, Received::Frame) {
                    backoff.reset();
                }
                socket = Some(open_socket);
            }
        }
    }
}

/// Frames may go when there is no room; what happened to the bus may not.
fn may_go(input: &Input) -> bool {
    matches!(input, Input::Frame { .. })
}

/// The source of a frame's time.
struct BusClock {
    time: BusTime,
    began: Instant,
}

impl BusClock {
    fn time_s(&mut self, stamp: SystemTime) -> f64 {
        let unix_s =
            |time: SystemTime| time.duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64());
        self.time.of(unix_s(stamp), unix_s(SystemTime::now()), self.began.elapsed().as_secs_f64())
    }
}

fn read(socket: &CanFdSocket, bus: u16, clock: &mut BusClock, inputs: &Queue<Input>) -> Received {
    let (frame, stamp) = match socket.read_frame_with_timestamps() {
        Ok((frame, stamps)) => (frame, stamps.socket.unwrap_or_else(SystemTime::now)),
        Err(error) if error.should_retry() || error.kind() == io::ErrorKind::Interrupted => {
            return Received::Silence;
        }
        Err(error) => return Received::Broken(error),
    };
    if let CanAnyFrame::Error(error) = &frame {
        return match error.error_bits() {
            bits if bits & BUS_OFF != 0 => Received::BusOff,
            bits if bits & RESTARTED != 0 => Received::Restarted,
            _ => Received::Silence,
        };
    }
    let Some(frame) = ours(&frame, clock.time_s(stamp), bus) else { return Received::Silence };
    let waited = stamp.elapsed().unwrap_or_default();
    let now = Instant::now();
    let arrived = now.checked_sub(waited).unwrap_or(now);
    inputs.push_now(Input::Frame { frame, arrived }, may_go);
    Received::Frame
}

fn ours(frame: &CanAnyFrame, time_s: f64, bus: u16) -> Option<CanFrame> {
    let kind = match frame {
        CanAnyFrame::Normal(_) => FrameKind::Data,
        CanAnyFrame::Remote(_) => FrameKind::Remote,
        CanAnyFrame::Error(_) => FrameKind::Error,
        CanAnyFrame::Fd(fd) => {
            FrameKind::Fd { bit_rate_switch: fd.is_brs(), error_state_indicator: fd.is_esi() }
        }
    };
    let id = frame.raw_id();
    let id = if frame.is_extended() { CanId::extended(id) } else { CanId::standard(id) }?;
    let payload = match kind {
        FrameKind::Remote => Payload::zeros(frame.dlc()),
        _ => Payload::new(frame.data()),
    }?;
    Some(CanFrame { time_s, bus, id, kind, direction: Direction::Rx, payload })
}

/// The number at the end of an interface's name, as candump's lines have it.
pub(crate) fn bus_of(interface: &str) -> u16 {
    let start = interface.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    interface.get(start..).and_then(|digits| digits.parse().ok()).unwrap_or(0)
}
