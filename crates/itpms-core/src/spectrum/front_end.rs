//! A corner's signals, computed once for all who use them: as they are, and between 2 and 35 Hz, slow enough to be thinned. With the
//! friction of the strut taken out, as far as it is identified (docs/math/unknown-car.md, eq. 2).

use super::butterworth::{QUALITY, Section};
use super::reconstruction::{BODY_JERK, Channel, LAG, Reconstruction, SIGNALS, WHEEL_JERK};
use crate::conditioning::GridSample;
use crate::memory::Blank;
use crate::model::HOP_HZ;
use crate::real::Real;

/// Elements in parallel of which a strut's friction consists.
pub(crate) const ELEMENTS: usize = 3;
/// Corners in Hz of the band: the upper one well above the bins used; the lower one keeps out what the sensors' noise becomes when it is
/// integrated, and the body's own swaying: both would leak into the lowest bin.
const SMOOTH_HZ: f64 = 35.0;
const LOWEST_HZ: f64 = 2.0;

/// The signals of a corner at one step, and the rates of the friction's elements for a slip force of one newton each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Signals<T> {
    pub(crate) motion: [T; SIGNALS],
    pub(crate) friction: [T; ELEMENTS],
}

impl<T: Real> Signals<T> {
    /// The motion that is left without a friction of these slip forces in N: wheel jerk plus its rate over the unsprung mass, body jerk
    /// less its rate over the sprung one.
    pub(crate) fn without_friction(&self, slip_n: &[T; ELEMENTS], masses_kg: [T; 2]) -> [T; SIGNALS] {
        let rate_n_per_s =
            self.friction.iter().zip(slip_n).fold(T::zero(), |sum, (&unit, &force)| sum + unit * force);
        let [unsprung_kg, sprung_kg] = masses_kg;
        let mut motion = self.motion;
        motion[WHEEL_JERK] += rate_n_per_s / unsprung_kg;
        motion[BODY_JERK] -= rate_n_per_s / sprung_kg;
        motion
    }
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FrontEnd<T> {
    reconstruction: Reconstruction<T>,
    friction: [Channel<T>; ELEMENTS],
    sections: [Section<T>; 4],
    motion_states: [[[T; 2]; 4]; SIGNALS],
    friction_states: [[[T; 2]; 4]; ELEMENTS],
}

impl<T: Real> FrontEnd<T> {
    pub(crate) fn new(grid_period_s: f64) -> Self {
        let rate_hz = 1.0 / grid_period_s;
        Self {
            reconstruction: Reconstruction::new(grid_period_s),
            sections: [
                Section::low_pass(SMOOTH_HZ, rate_hz, QUALITY[0]),
                Section::low_pass(SMOOTH_HZ, rate_hz, QUALITY[1]),
                Section::high_pass(LOWEST_HZ, rate_hz, QUALITY[0]),
                Section::high_pass(LOWEST_HZ, rate_hz, QUALITY[1]),
            ],
            ..Self::BLANK
        }
    }

    /// The signal was interrupted: start again, keep the sensors' offsets.
    #[inline(never)]
    pub(crate) fn restart(&mut self) {
        self.reconstruction.restart();
        self.friction.iter_mut().for_each(Channel::restart);
        (self.motion_states, self.friction_states) = (Blank::BLANK, Blank::BLANK);
    }

    /// Takes a grid step; `friction` gives the forces of its elements for the wheel's acceleration less the body's, offsets taken off.
    /// Gives all signals three steps earlier, and those of the band, which are later by [`band_delay_s`].
    pub(crate) fn push(
        &mut self,
        sample: &GridSample<T>,
        friction: impl FnOnce(T) -> [T; ELEMENTS],
    ) -> [Signals<T>; 2] {
        let motion = self.reconstruction.push(sample);
        let mut all = Signals { motion, friction: friction(self.reconstruction.relative_accel()) };
        let (steps, dt) = self.reconstruction.steps();
        for (unit, channel) in all.friction.iter_mut().zip(&mut self.friction) {
            *unit = channel.step(*unit, steps, dt).2;
        }
        let mut band = all;
        let motion = band.motion.iter_mut().zip(&mut self.motion_states);
        for (signal, states) in motion.chain(band.friction.iter_mut().zip(&mut self.friction_states)) {
            for (section, state) in self.sections.iter().zip(states) {
                *signal = section.push(state, *signal);
            }
        }
        [all, band]
    }
}

/// Seconds by which the signals of the band are late.
pub(crate) fn band_delay_s(grid_period_s: f64) -> f64 {
    // Group delay of the low-pass, the sum of 1 / (q ω), of the high-pass, and the reconstruction's steps.
    let smoothing = QUALITY.iter().fold(0.0, |sum, q| sum + 1.0 / q) / (core::f64::consts::TAU * SMOOTH_HZ);
    smoothing + high_pass_late_s() + LAG as f64 * grid_period_s
}

/// Share of a signal's power that the high-pass leaves at a frequency in Hz.
pub(crate) fn high_pass_power<T: Real>(frequency_hz: T) -> T {
    let x = T::lit(LOWEST_HZ) / frequency_hz;
    T::one() / (T::one() + x.powi(8))
}

/// Group delay of the high-pass at wheel hop.
fn high_pass_late_s() -> f64 {
    // Of s²/(s² + s/q + 1) at s = ix: (1 + x²)/q / ((1 - x²)² + (x/q)²)
    let x2 = (HOP_HZ / LOWEST_HZ) * (HOP_HZ / LOWEST_HZ);
    let late = |q: f64| (1.0 + x2) / q / ((1.0 - x2) * (1.0 - x2) + x2 / (q * q));
    QUALITY.iter().fold(0.0, |sum, &q| sum + late(q)) / (core::f64::consts::TAU * LOWEST_HZ)
}

#[cfg(test)]
mod tests {
    // Where another crate of the build brings `std`, numbers have these functions by themselves.
    #[allow(unused_imports)]
    use nalgebra::ComplexField;

    use super::*;

    /// Gain and delay in s of a settled filter of both sections at a sine.
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
    fn the_high_pass_has_the_gain_and_the_delay_it_is_reported_to_have() {
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
}
