//! One corner's way into the shared road: its road-velocity signals, smoothed and thinned, with the place on the road
//! at which each was taken. Fed with grid samples; knows nothing of the other corners.

use crate::informed::reconstruct::{
    LAG, RELATIVE_ACCELERATION, RELATIVE_VELOCITY, Reconstruction, WHEEL_JERK, WHEEL_VELOCITY,
};
use crate::intake::GridSample;
use crate::real::Real;

/// Signals kept of a corner: wheel velocity, wheel jerk, relative acceleration, relative velocity.
pub(super) const KEPT: usize = 4;
/// Corner of the smoothing filter in Hz, well above the bins used.
const SMOOTH_HZ: f64 = 35.0;
/// Thinned signals come at this rate in Hz at least.
const LEAST_RATE_HZ: f64 = 200.0;
/// Quality factors of the two sections of a Butterworth filter of order four.
const QUALITY: [f64; 2] = [0.541_196_1, 1.306_563];

/// Place of the relative velocity among them.
pub(super) const RELATIVE: usize = 3;

/// A thinned set of signals.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Entry<T> {
    /// Time in s.
    pub(super) time_s: f64,
    /// Way driven in m.
    pub(super) way_m: f64,
    /// Speed in m/s.
    pub(super) speed_m_s: T,
    /// The signals.
    pub(super) signals: [T; KEPT],
    /// True if a sensor was at its limit since the last entry.
    pub(super) spoiled: bool,
    /// True if the signal was interrupted before this entry.
    pub(super) after_gap: bool,
}

/// A low-pass section, transposed direct form II.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Section<T> {
    gain: T,
    feedback: [T; 2],
}

impl<T: Real> Section<T> {
    fn new(rate_hz: f64, quality: f64) -> Self {
        let k = T::lit(core::f64::consts::PI * SMOOTH_HZ / rate_hz).tan();
        let damped = k / T::lit(quality);
        let norm = T::one() / (T::one() + damped + k * k);
        Self {
            gain: k * k * norm,
            feedback: [T::lit(2.0) * (k * k - T::one()) * norm, (T::one() - damped + k * k) * norm],
        }
    }

    fn push(&self, state: &mut [T; 2], input: T) -> T {
        let scaled = self.gain * input;
        let output = scaled + state[0];
        state[0] = T::lit(2.0) * scaled - self.feedback[0] * output + state[1];
        state[1] = scaled - self.feedback[1] * output;
        output
    }
}

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Channel<T> {
    reconstruction: Reconstruction<T>,
    sections: [Section<T>; 2],
    states: [[[T; 2]; 2]; KEPT],
    grid_period_s: f64,
    every: u32,
    step: u32,
    spoiled: bool,
    after_gap: bool,
}

impl<T: Real> Channel<T> {
    pub(super) fn new(grid_period_s: f64) -> Self {
        let rate_hz = 1.0 / grid_period_s;
        Self {
            reconstruction: Reconstruction::new(grid_period_s),
            sections: QUALITY.map(|quality| Section::new(rate_hz, quality)),
            states: [[[T::zero(); 2]; 2]; KEPT],
            grid_period_s,
            every: every(rate_hz),
            step: 0,
            spoiled: false,
            after_gap: true,
        }
    }

    /// Time between entries in s.
    pub(super) fn period_s(&self) -> f64 {
        self.grid_period_s * f64::from(self.every)
    }

    /// Seconds by which the signals are late.
    pub(super) fn late_s(&self) -> f64 {
        // Group delay of the low-pass, the sum of 1 / (q ω), and the reconstruction's steps.
        let smoothing =
            QUALITY.iter().fold(0.0, |sum, q| sum + 1.0 / q) / (core::f64::consts::TAU * SMOOTH_HZ);
        smoothing + LAG as f64 * self.grid_period_s
    }

    /// Takes a grid step at `way_m`; gives an entry when one is due.
    pub(super) fn push(&mut self, sample: &GridSample<T>, way_m: f64) -> Option<Entry<T>> {
        if sample.after_gap {
            self.reconstruction.restart();
            self.states = [[[T::zero(); 2]; 2]; KEPT];
            self.after_gap = true;
            self.step = 0;
        }
        self.spoiled |= sample.saturated;
        let all = self.reconstruction.push(sample.body_accel_m_s2, sample.wheel_accel_m_s2);
        let mut signals =
            [all[WHEEL_VELOCITY], all[WHEEL_JERK], all[RELATIVE_ACCELERATION], all[RELATIVE_VELOCITY]];
        for (signal, states) in signals.iter_mut().zip(&mut self.states) {
            for (section, state) in self.sections.iter().zip(states) {
                *signal = section.push(state, *signal);
            }
        }
        self.step += 1;
        if self.step < self.every {
            return None;
        }
        self.step = 0;
        let entry = Entry {
            time_s: sample.time_s,
            way_m,
            speed_m_s: sample.speed_m_s,
            signals,
            spoiled: core::mem::take(&mut self.spoiled),
            after_gap: core::mem::take(&mut self.after_gap),
        };
        Some(entry)
    }
}

/// Grid steps per entry.
fn every(rate_hz: f64) -> u32 {
    ((rate_hz / LEAST_RATE_HZ + 1e-9) as u32).max(1)
}
