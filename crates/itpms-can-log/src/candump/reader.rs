//! A file of candump's lines as frames. Called by `FrameReader`; knows what only a whole file tells: whether short time
//! stamps are differences, and which interface is which bus.

use std::collections::VecDeque;

use super::parse::{Clock, EXPECTED, LineProblem, parse};
use crate::error::CanProblem;
use crate::frame::CanFrame;
use crate::frame_source::FrameSource;
use crate::interfaces::Interfaces;
use crate::lines::{TextLines, beginning};
use crate::repairs::{FramePlace, FrameRepairs};
use crate::strange::StrangeLines;

/// Frames looked at to tell differences from times since the beginning.
const SURVEY_FRAMES: usize = 512;

#[derive(Debug)]
pub(crate) struct CandumpReader {
    lines: TextLines,
    interfaces: Interfaces,
    /// Frames read ahead while the clock is not known.
    ahead: VecDeque<(CanFrame, Clock)>,
    stamps: Stamps,
    strange: StrangeLines,
}

/// How the file's short time stamps are meant.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stamps {
    /// Not looked at yet.
    Unknown,
    Times,
    /// Each is the time since the frame before; the sum so far in s.
    Differences(f64),
}

impl CandumpReader {
    pub(crate) fn new(lines: TextLines) -> Self {
        Self {
            lines,
            interfaces: Interfaces::default(),
            ahead: VecDeque::new(),
            stamps: Stamps::Unknown,
            strange: StrangeLines::new("lines such as (1436509052.249713) can0 123#DEADBEEF", EXPECTED),
        }
    }

    /// Reads ahead until it is known what the stamps mean.
    fn survey(&mut self, repairs: &mut FrameRepairs) -> Result<(), CanProblem> {
        while self.ahead.len() < SURVEY_FRAMES {
            let Some(next) = self.next_line(repairs)? else { break };
            self.ahead.push_back(next);
            if next.1 == Clock::Epoch {
                self.stamps = Stamps::Times;
                return Ok(());
            }
        }
        let stamps: Vec<f64> = self.ahead.iter().map(|(frame, _)| frame.time_s).collect();
        self.stamps = if are_differences(&stamps) {
            repairs.assume(
                "the time stamps are differences from frame to frame (candump -td) and were summed"
                    .to_owned(),
            );
            Stamps::Differences(0.0)
        } else {
            Stamps::Times
        };
        Ok(())
    }

    /// The frame of the next line that has one, with the stamp as it stands.
    fn next_line(&mut self, repairs: &mut FrameRepairs) -> Result<Option<(CanFrame, Clock)>, CanProblem> {
        while self.lines.advance()? {
            let place = FramePlace::Line(self.lines.number());
            match parse(self.lines.text()) {
                Ok(_)
                    if self.strange.any_understood
                        && !self.lines.is_terminated()
                        && !is_whole(self.lines.text()) =>
                {
                    repairs.cut_off = Some(place);
                }
                Ok(line) => {
                    let mut frame = line.frame;
                    frame.bus = self.interfaces.bus(line.interface, frame.bus, repairs);
                    self.strange.any_understood = true;
                    return Ok(Some((frame, line.clock)));
                }
                Err(LineProblem::Blank) => {}
                Err(LineProblem::Lost(frames)) => repairs.lost_by_logger += frames,
                Err(_) if !self.lines.is_terminated() && self.strange.any_understood => {
                    repairs.cut_off = Some(place)
                }
                Err(LineProblem::NoTimeStamp) if !self.strange.any_understood => {
                    let found = beginning(self.lines.text());
                    return Err(CanProblem::NoTimeStamp { line: self.lines.number(), found });
                }
                Err(LineProblem::NotUnderstood(expected)) => {
                    self.strange.count(&self.lines, expected, repairs)?;
                }
                Err(LineProblem::NoTimeStamp) => self.strange.count(&self.lines, "a time stamp", repairs)?,
            }
        }
        self.strange.end(&self.lines).map(|()| None)
    }
}

impl FrameSource for CandumpReader {
    fn next_frame(&mut self, repairs: &mut FrameRepairs) -> Result<Option<CanFrame>, CanProblem> {
        if self.stamps == Stamps::Unknown {
            self.survey(repairs)?;
        }
        let next = match self.ahead.pop_front() {
            Some(next) => Some(next),
            None => self.next_line(repairs)?,
        };
        let Some((mut frame, clock)) = next else { return Ok(None) };
        if let (Stamps::Differences(sum_s), Clock::Relative) = (&mut self.stamps, clock) {
            *sum_s += frame.time_s;
            frame.time_s = *sum_s;
        }
        Ok(Some(frame))
    }

    fn progress(&self) -> f64 {
        self.lines.progress()
    }
}

/// Whether a last line without its end is whole all the same: `123#1122` may have been `123#112233`, but a direction or
/// a length in brackets says that nothing is missing.
fn is_whole(line: &[u8]) -> bool {
    matches!(line, [.., b' ', b'R' | b'T' | b'r' | b't']) || line.contains(&b'[') || line.contains(&b'{')
}

const FEWEST_STAMPS: usize = 16;

/// Whether stamps are differences from frame to frame. Times grow: the middle one of the later half lies beyond all of
/// the earlier half. Differences do not.
fn are_differences(stamps: &[f64]) -> bool {
    if stamps.len() < FEWEST_STAMPS {
        return false;
    }
    let (early, late) = stamps.split_at(stamps.len() / 2);
    let latest_early = early.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut late = late.to_vec();
    late.sort_by(f64::total_cmp);
    match late.get(late.len() / 2) {
        Some(middle) => *middle > 0.0 && latest_early >= *middle,
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_computed_from_times() {
        let jitter = |index: u32| f64::from(index * 7919 % 100) * 1e-5;
        let differences: Vec<f64> =
            (0..500).map(|index| if index == 0 { 0.0 } else { 0.01 + jitter(index) }).collect();
        let times: Vec<f64> = differences
            .iter()
            .scan(0.0, |sum, step| {
                *sum += step;
                Some(*sum)
            })
            .collect();
        assert!(are_differences(&differences));
        assert!(!are_differences(&times));
        // Two sockets are not read in the order of time.
        let mut swapped = times.clone();
        swapped.chunks_exact_mut(2).for_each(|pair| pair.swap(0, 1));
        assert!(!are_differences(&swapped));
        assert!(!are_differences(&[]));
        assert!(!are_differences(&[0.0]));
        assert!(!are_differences(&[0.0; 100]));
        assert!(are_differences(&[0.01; 100]));
    }
}
