//! One corner's way into the shared road: its road-velocity signals, smoothed and thinned, with the place on the road
//! at which each was taken. Fed with grid samples; knows nothing of the other corners.

use crate::conditioning::GridSample;
use crate::memory::blank;
use crate::real::Real;
use crate::spectrum::butterworth::{QUALITY, Section};
use crate::spectrum::reconstruction::{
    LAG, RELATIVE_ACCELERATION, RELATIVE_VELOCITY, Reconstruction, WHEEL_JERK, WHEEL_VELOCITY,
};

/// Signals kept of a corner: wheel velocity, wheel jerk, relative acceleration, relative velocity.
pub(crate) const KEPT: usize = 4;
/// Signals of an axle's side: those kept of a corner, and its relative velocity less that of the other side.
pub(crate) const SEEN: usize = KEPT + 1;
/// Those of both axles.
pub(crate) const BOTH: usize = 2 * SEEN;
/// Corner of the smoothing filter in Hz, well above the bins used.
const SMOOTH_HZ: f64 = 35.0;
/// Corner in Hz of the filter that keeps out what the sensors' noise becomes when it is integrated, and the body's own
/// swaying: both would leak into the lowest bin.
const LOWEST_HZ: f64 = 2.0;
/// Frequency in Hz of wheel hop: where the delay of that filter is taken.
const WHEEL_HOP_HZ: f64 = 12.0;
/// Time in s after which a tenth is left of what the filters answer to something short. Waiting longer cost more road than it
/// brought.
const ECHO_S: f64 = 0.05;
/// Thinned signals come at this rate in Hz at least.
const LEAST_RATE_HZ: f64 = 200.0;
/// Place of the relative velocity among them.
pub(crate) const RELATIVE: usize = 3;

/// A thinned set of signals.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Entry<T> {
    /// Time in s.
    pub(crate) time_s: f64,
    /// Distance driven in m.
    pub(crate) distance_m: f64,
    /// Speed in m/s.
    pub(crate) speed_m_s: T,
    /// The signals.
    pub(crate) signals: [T; KEPT],
    /// True if a sensor was at its limit since the last entry.
    pub(crate) invalid: bool,
    /// True if the wheel may have been in the air while the filters still held it.
    pub(crate) unloaded: bool,
    /// True if the signal was interrupted before this entry.
    pub(crate) after_gap: bool,
}

blank!(Entry<T> { time_s, distance_m, speed_m_s, signals, invalid, unloaded, after_gap });

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Channel<T> {
    reconstruction: Reconstruction<T>,
    sections: [Section<T>; 4],
    states: [[[T; 2]; 4]; KEPT],
    grid_period_s: f64,
    every: u32,
    step: u32,
    invalid: bool,
    /// When the wheel may last have been in the air.
    unloaded_s: f64,
    after_gap: bool,
}

blank!(Channel<T> {
    reconstruction, sections, states, grid_period_s, every, step, invalid, unloaded_s, after_gap,
});

impl<T: Real> Channel<T> {
    pub(crate) fn new(grid_period_s: f64) -> Self {
        let rate_hz = 1.0 / grid_period_s;
        Self {
            reconstruction: Reconstruction::new(grid_period_s, T::zero()),
            sections: [
                Section::low_pass(SMOOTH_HZ, rate_hz, QUALITY[0]),
                Section::low_pass(SMOOTH_HZ, rate_hz, QUALITY[1]),
                Section::high_pass(LOWEST_HZ, rate_hz, QUALITY[0]),
                Section::high_pass(LOWEST_HZ, rate_hz, QUALITY[1]),
            ],
            states: [[[T::zero(); 2]; 4]; KEPT],
            grid_period_s,
            every: every(rate_hz),
            step: 0,
            invalid: false,
            unloaded_s: f64::NEG_INFINITY,
            after_gap: true,
        }
    }

    /// Time between entries in s.
    pub(crate) fn period_s(&self) -> f64 {
        self.grid_period_s * f64::from(self.every)
    }

    /// Seconds by which the signals are late.
    pub(crate) fn filter_delay_s(&self) -> f64 {
        // Group delay of the low-pass, the sum of 1 / (q ω), of the high-pass, and the reconstruction's steps.
        let smoothing =
            QUALITY.iter().fold(0.0, |sum, q| sum + 1.0 / q) / (core::f64::consts::TAU * SMOOTH_HZ);
        smoothing + high_pass_late_s() + LAG as f64 * self.grid_period_s
    }

    #[inline(never)]
    fn restart(&mut self) {
        self.reconstruction.restart();
        self.states = [[[T::zero(); 2]; 4]; KEPT];
        self.after_gap = true;
        self.step = 0;
    }

    /// Takes a grid step; gives an entry, at `distance_m`, when one is due.
    pub(crate) fn push(
        &mut self,
        sample: &GridSample<T>,
        distance_m: impl FnOnce() -> f64,
    ) -> Option<Entry<T>> {
        if sample.after_gap {
            self.restart();
        }
        self.invalid |= sample.invalid;
        if sample.unloaded {
            self.unloaded_s = sample.time_s;
        }
        let all = self.reconstruction.push(sample);
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
            distance_m: distance_m(),
            speed_m_s: sample.speed_m_s,
            signals,
            invalid: core::mem::take(&mut self.invalid),
            unloaded: sample.time_s - self.unloaded_s < ECHO_S,
            after_gap: core::mem::take(&mut self.after_gap),
        };
        Some(entry)
    }
}

/// Share of a signal's power that the high-pass leaves at a frequency in Hz.
pub(crate) fn high_pass_power<T: Real>(frequency_hz: T) -> T {
    let x = T::lit(LOWEST_HZ) / frequency_hz;
    T::one() / (T::one() + x.powi(8))
}

/// Group delay of the high-pass at wheel hop.
fn high_pass_late_s() -> f64 {
    // Of s²/(s² + s/q + 1) at s = ix: (1 + x²)/q / ((1 - x²)² + (x/q)²)
    let x2 = (WHEEL_HOP_HZ / LOWEST_HZ) * (WHEEL_HOP_HZ / LOWEST_HZ);
    let late = |q: f64| (1.0 + x2) / q / ((1.0 - x2) * (1.0 - x2) + x2 / (q * q));
    QUALITY.iter().fold(0.0, |sum, &q| sum + late(q)) / (core::f64::consts::TAU * LOWEST_HZ)
}

/// Grid steps per entry.
fn every(rate_hz: f64) -> u32 {
    ((rate_hz / LEAST_RATE_HZ + 1e-9) as u32).max(1)
}

#[cfg(test)]
mod tests {
    // Where another crate of the build brings `std`, numbers have these functions by themselves.
    #[allow(unused_imports)]
    use nalgebra::ComplexField;

    use super::*;

    /// What a settled filter of both sections makes of a sine: gain and lateness in s.
    fn response(frequency_hz: f64, rate_hz: f64) -> (f64, f64) {
        let sections = QUALITY.map(|quality| Section::high_pass(LOWEST_HZ, rate_hz, quality));
        let mut states = [[0.0; 2]; 2];
        let omega = core::f64::consts::TAU * frequency_hz;
        let (mut sine, mut cosine) = (0.0, 0.0);
        let (settled, all) = ((10.0 * rate_hz) as usize, (20.0 * rate_hz) as usize);
        for i in 0..all {
            let angle = omega * i as f64 / rate_hz;
            let mut x = angle.sin();
            for (section, state) in sections.iter().zip(&mut states) {
                x = section.push(state, x);
            }
            if i >= settled {
                sine += x * angle.sin();
                cosine += x * angle.cos();
            }
        }
        let half = 0.5 * (all - settled) as f64;
        let (sine, cosine) = (sine / half, cosine / half);
        ((sine * sine + cosine * cosine).sqrt(), -cosine.atan2(sine) / omega)
    }

    #[test]
    fn the_high_pass_has_the_gain_and_the_delay_it_is_said_to_have() {
        for frequency in [1.0f64, 2.0, 5.0, 12.0] {
            let (gain, _) = response(frequency, 500.0);
            // The bilinear rule moves a frequency f by (pi f / rate)²/3, far less than this.
            assert!((gain - high_pass_power(frequency).sqrt()).abs() < 2e-3, "{frequency}: {gain}");
        }
        // Group delay is the slope of the phase.
        let phase = |f: f64| core::f64::consts::TAU * f * response(f, 500.0).1;
        let group = (phase(12.5) - phase(11.5)) / core::f64::consts::TAU;
        assert!((group - high_pass_late_s()).abs() < 1e-4, "{group}");
    }

    #[test]
    fn a_wheel_in_the_air_is_heard_until_the_filters_have_forgotten() {
        // A wheel sensor that says 100 m/s² for 20 ms, and is believed to be in the air so long.
        let mut channel = Channel::<f64>::new(0.002);
        let (mut loudest, mut after) = (0.0f64, 0.0f64);
        for step in 0..200 {
            let pulse = (50..60).contains(&step);
            let entry = channel.push(
                &GridSample {
                    time_s: f64::from(step) * 0.002,
                    speed_m_s: 20.0,
                    body_accel_m_s2: 0.0,
                    wheel_accel_m_s2: if pulse { 100.0 } else { 0.0 },
                    after_gap: step == 0,
                    invalid: false,
                    unloaded: pulse,
                    strut_friction_m_s2: 0.0,
                },
                || 0.0,
            );
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
