//! Frames that a log has twice: once sent and once received again, or once for each of two recorders on one bus.
//!
//! Judged by the first frames of a log, then asked for every frame of a bus that has such ones. Of two frames of one identifier with
//! the same data within a quarter of its cycle the second is an echo. Where close frames often differ, or the data of all identifiers mostly repeat
//! from cycle to cycle, equal ones prove nothing, and none is; unless one of the two was sent and the other received.

use std::collections::HashMap;

use crate::can::{CanFrame, CanId};

/// Share of a cycle within which an equal frame is an echo.
const OF_A_CYCLE: f64 = 0.25;
/// Frames of an identifier from which its cycle is known, and pairs from which a bus is judged.
const FEWEST: usize = 8;
/// Equal close pairs for each that differs, at least.
const TO_ONE: usize = 9;
/// Of the steps of an identifier sorted by their lengths, the one that is its cycle: so up to four copies of each frame are no matter.
const CYCLE_AT: f64 = 0.8;

#[derive(Debug, Default)]
pub(super) struct Echoes {
    /// The identifiers of buses that have echoes.
    cycles: HashMap<(u16, CanId), Cycle>,
    pub(super) count: u64,
}

#[derive(Debug)]
struct Cycle {
    close_s: f64,
    last: Option<CanFrame>,
}

/// Pairs of frames of one identifier that are close to each other, as far as they tell anything.
#[derive(Debug, Default, Clone, Copy)]
struct Evidence {
    equal: usize,
    different: usize,
}

impl Echoes {
    pub(super) fn of<'a>(frames: impl Iterator<Item = &'a CanFrame>) -> Self {
        let mut by_id: HashMap<(u16, CanId), Vec<&CanFrame>> = HashMap::new();
        for frame in frames {
            by_id.entry((frame.bus, frame.id)).or_default().push(frame);
        }
        let mut buses: HashMap<u16, Evidence> = HashMap::new();
        let mut cycles = HashMap::new();
        for (key, frames) in by_id {
            let Some(close_s) = close_s(&frames) else { continue };
            buses.entry(key.0).or_default().weigh(&frames, close_s);
            cycles.insert(key, Cycle { close_s, last: None });
        }
        cycles.retain(|(bus, _), _| buses.get(bus).is_some_and(Evidence::is_enough));
        Self { cycles, count: 0 }
    }

    pub(super) fn takes(&mut self, frame: &CanFrame) -> bool {
        if self.cycles.is_empty() {
            return false;
        }
        let Some(cycle) = self.cycles.get_mut(&(frame.bus, frame.id)) else { return false };
        let is_echo = cycle
            .last
            .is_some_and(|last| is_close(&last, frame, cycle.close_s) && last.payload == frame.payload);
        if is_echo {
            self.count += 1;
        } else {
            cycle.last = Some(*frame);
        }
        is_echo
    }
}

impl Evidence {
    fn weigh(&mut self, frames: &[&CanFrame], close_s: f64) {
        let (mut equal, mut other_direction, mut far_equal, mut far_different) = (0, 0, 0, 0);
        let mut frames = frames.iter();
        let Some(mut last) = frames.next() else { return };
        for frame in frames {
            match (is_close(last, frame, close_s), last.payload == frame.payload) {
                (true, true) => {
                    equal += 1;
                    other_direction += usize::from(last.direction != frame.direction);
                    continue;
                }
                (true, false) => self.different += 1,
                (false, true) => far_equal += 1,
                (false, false) => far_different += 1,
            }
            last = frame;
        }
        // Data that are the same from cycle to cycle are the same within one.
        if far_different > far_equal || 2 * other_direction > equal {
            self.equal += equal;
        }
    }

    fn is_enough(&self) -> bool {
        self.equal >= FEWEST && self.equal >= TO_ONE * self.different
    }
}

/// Within so many seconds an equal frame is an echo; `None` of too few frames.
fn close_s(frames: &[&CanFrame]) -> Option<f64> {
    if frames.len() < FEWEST {
        return None;
    }
    let mut steps: Vec<f64> = frames.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).collect();
    steps.sort_by(f64::total_cmp);
    let cycle_s = steps.get((CYCLE_AT * steps.len() as f64) as usize)?;
    Some(OF_A_CYCLE * cycle_s).filter(|close_s| *close_s > 0.0)
}

fn is_close(last: &CanFrame, frame: &CanFrame, close_s: f64) -> bool {
    (0.0..close_s).contains(&(frame.time_s - last.time_s)) && last.kind == frame.kind
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::can::Direction;

    fn frame(time_s: f64, id: u32, data: &[u8]) -> CanFrame {
        CanFrame::new(time_s, CanId::standard(id).unwrap(), data).unwrap()
    }

    /// How many of these frames are echoes, judged by the first half of them.
    fn echoes(frames: &[CanFrame]) -> u64 {
        let mut echoes = Echoes::of(frames[..frames.len() / 2].iter());
        let kept = frames.iter().filter(|frame| !echoes.takes(frame)).count();
        assert_eq!(kept as u64 + echoes.count, frames.len() as u64);
        echoes.count
    }

    /// A message of 100 Hz whose data change in each cycle, one of 100 Hz whose data do not; `copies` of each, `apart_s` from one to the next.
    fn log(copies: usize, apart_s: f64) -> Vec<CanFrame> {
        let mut frames = Vec::new();
        for k in 0..400_u32 {
            let time_s = 1.7e9 + 0.01 * f64::from(k);
            for copy in 0..copies {
                frames.push(frame(time_s + copy as f64 * apart_s, 1, &k.to_le_bytes()));
            }
            for copy in 0..copies {
                frames.push(frame(time_s + 0.004 + copy as f64 * apart_s, 2, &[7; 8]));
            }
        }
        frames
    }

    #[test]
    fn equal_frames_close_to_each_other_count_once() {
        for apart_s in [0.0, 20e-6, 1.1e-3] {
            assert_eq!(echoes(&log(2, apart_s)), 800, "{apart_s}");
        }
        assert_eq!(echoes(&log(3, 50e-6)), 1600);
        assert_eq!(echoes(&log(1, 0.0)), 0);
        // A third of a cycle is another frame.
        assert_eq!(echoes(&log(2, 3.4e-3)), 0);
    }

    #[test]
    fn a_bus_that_stands_still_or_has_a_coarse_clock_has_none() {
        // Two samples under each stamp of 10 ms, at first of a car that stands.
        let coarse = |k: u32| frame((f64::from(k) * 0.5).floor() * 0.01, 1, &(k.max(300) & !1).to_le_bytes());
        let standing: Vec<CanFrame> = (0..300).map(coarse).collect();
        assert_eq!(echoes(&standing), 0);
        let coarse = |k: u32| frame((f64::from(k) * 0.5).floor() * 0.01, 1, &k.to_le_bytes());
        assert_eq!(echoes(&(0..600).map(coarse).collect::<Vec<_>>()), 0);
        // Sent and received: even of a car that stands.
        let both = (0..300_u32).map(|k| CanFrame {
            direction: if k % 2 == 0 { Direction::Tx } else { Direction::Rx },
            ..frame(0.01 * f64::from(k / 2) + 20e-6 * f64::from(k % 2), 1, &[0; 8])
        });
        assert_eq!(echoes(&both.collect::<Vec<_>>()), 150);
    }
}
