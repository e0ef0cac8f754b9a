//! One corner's way into the shared road: its road-velocity signals, thinned, with the place on the road at which each was taken. Fed
//! with grid samples and signals of the band; knows nothing of the other corners.

use crate::conditioning::GridSample;
use crate::inter_axle::alignment::way::Way;
use crate::memory::Blank;
use crate::real::Real;
use crate::spectrum::reconstruction::{
    RELATIVE_ACCELERATION, RELATIVE_VELOCITY, SIGNALS, WHEEL_JERK, WHEEL_VELOCITY,
};

/// Signals kept of a corner: wheel velocity, wheel jerk, relative acceleration, relative velocity.
pub(crate) const KEPT: usize = 4;
/// Signals of a front corner: those kept, and its relative velocity less that of the other side.
pub(crate) const FRONT: usize = KEPT + 1;
/// Signals of a rear corner: the same, and the other side's wheel jerk less its own.
pub(crate) const SEEN: usize = FRONT + 1;
/// Those of both axles, the front's first.
pub(crate) const BOTH: usize = FRONT + SEEN;

/// Place of a corner's signal among those of both axles; `None`: the front's jerk against the other side's, which is not needed.
pub(crate) fn place(axle: usize, signal: usize) -> Option<usize> {
    (signal < if axle == 0 { FRONT } else { SEEN }).then_some(axle * FRONT + signal)
}

/// Time in s after which the filters' response to a pulse has decayed to a tenth. Waiting longer cost more road than it
/// brought.
const ECHO_S: f64 = 0.05;
/// Thinned signals come at this rate in Hz at least.
const LEAST_RATE_HZ: f64 = 200.0;
/// Places of the wheel's jerk and the relative velocity among them.
pub(crate) const JERK: usize = 1;
pub(crate) const RELATIVE: usize = 3;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Entry<T> {
    pub(crate) time_s: f64,
    /// Where the car was; `None` while the speed is unknown.
    pub(crate) way: Option<Way>,
    pub(crate) speed_m_s: T,
    pub(crate) signals: [T; KEPT],
    /// True if a sensor was at its limit since the last entry.
    pub(crate) invalid: bool,
    /// True if the wheel may have been in the air while the filters still held it.
    pub(crate) unloaded: bool,
    /// True if the signal was interrupted before this entry.
    pub(crate) after_gap: bool,
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Channel {
    grid_period_s: f64,
    every: u32,
    step: u32,
    invalid: bool,
    /// Grid steps for which the filters still hold a wheel that may have been in the air.
    echo_steps: u32,
    most_echo_steps: u32,
    after_gap: bool,
}

impl Channel {
    pub(crate) fn new(grid_period_s: f64) -> Self {
        Self {
            grid_period_s,
            every: every(1.0 / grid_period_s),
            most_echo_steps: (ECHO_S / grid_period_s + 0.5) as u32,
            after_gap: true,
            ..Self::BLANK
        }
    }

    pub(crate) fn period_s(&self) -> f64 {
        self.grid_period_s * f64::from(self.every)
    }

    /// Takes a grid step and its signals; gives an entry, taken at `way`, when one is due.
    pub(crate) fn push<T: Real>(
        &mut self,
        sample: &GridSample<T>,
        signals: &[T; SIGNALS],
        way: impl FnOnce() -> Option<Way>,
    ) -> Option<Entry<T>> {
        if sample.after_gap {
            (self.after_gap, self.step, self.echo_steps) = (true, 0, 0);
        }
        self.invalid |= sample.invalid;
        let echo_steps =
            if sample.unloaded { self.most_echo_steps } else { self.echo_steps.saturating_sub(1) };
        self.echo_steps = echo_steps;
        self.step += 1;
        if self.step < self.every {
            return None;
        }
        self.step = 0;
        let entry = Entry {
            time_s: sample.time_s,
            way: way(),
            speed_m_s: sample.speed_m_s,
            signals: [WHEEL_VELOCITY, WHEEL_JERK, RELATIVE_ACCELERATION, RELATIVE_VELOCITY]
                .map(|i| signals[i]),
            invalid: core::mem::take(&mut self.invalid),
            unloaded: self.echo_steps > 0,
            after_gap: core::mem::take(&mut self.after_gap),
        };
        Some(entry)
    }
}

fn every(rate_hz: f64) -> u32 {
    ((rate_hz / LEAST_RATE_HZ + 1e-9) as u32).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::front_end::{ELEMENTS, FrontEnd};

    #[test]
    fn a_wheel_in_the_air_is_detected_until_the_filters_have_forgotten() {
        // A wheel sensor that says 100 m/s² for 20 ms, and is believed to be in the air so long.
        let (mut channel, mut front_end) = (Channel::new(0.002), FrontEnd::<f64>::new(0.002));
        let (mut loudest, mut after) = (0.0f64, 0.0f64);
        for step in 0..200 {
            let pulse = (50..60).contains(&step);
            let sample = GridSample {
                time_s: f64::from(step) * 0.002,
                step_s: 0.002,
                speed_m_s: 20.0,
                body_accel_m_s2: 0.0,
                wheel_accel_m_s2: if pulse { 100.0 } else { 0.0 },
                after_gap: step == 0,
                invalid: false,
                unloaded: pulse,
            };
            let [_, band] = front_end.push(&sample, |_| [0.0; ELEMENTS]);
            let entry = channel.push(&sample, &band.motion, || None);
            let Some(entry) = entry else { continue };
            // The wheel's jerk is the pulse itself, differentiated: what integrates, the high-pass lets ring for longer.
            let jerk = entry.signals[1].abs();
            if entry.unloaded {
                assert!((0.1..0.12 + ECHO_S).contains(&entry.time_s), "{entry:?}");
                loudest = loudest.max(jerk);
            } else {
                after = after.max(jerk);
            }
        }
        assert!(loudest > 0.0 && after < 0.1 * loudest, "{after} after, {loudest} while it was in the air");
    }
}
