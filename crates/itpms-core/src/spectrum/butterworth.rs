//! Butterworth filters in sections of order two.

use crate::memory::Blank;
use crate::real::Real;

/// Quality factors of the two sections of a Butterworth filter of order four.
pub(crate) const QUALITY: [f64; 2] = [0.541_196_1, 1.306_563];

/// A section of a low-pass or high-pass of order two, transposed direct form II.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Section<T> {
    gain: T,
    /// The numerator's middle coefficient over the others: two for a low-pass, minus two for a high-pass.
    middle: T,
    feedback: [T; 2],
}

impl<T: Real> Section<T> {
    pub(crate) fn low_pass(corner_hz: f64, rate_hz: f64, quality: f64) -> Self {
        let k = T::lit(core::f64::consts::PI * corner_hz / rate_hz).tan();
        Self::new(k, T::lit(quality), k * k, T::lit(2.0))
    }

    pub(crate) fn high_pass(corner_hz: f64, rate_hz: f64, quality: f64) -> Self {
        let k = T::lit(core::f64::consts::PI * corner_hz / rate_hz).tan();
        Self::new(k, T::lit(quality), T::one(), T::lit(-2.0))
    }

    fn new(k: T, quality: T, gain: T, middle: T) -> Self {
        let damped = k / quality;
        let norm = T::one() / (T::one() + damped + k * k);
        Self {
            gain: gain * norm,
            middle,
            feedback: [T::lit(2.0) * (k * k - T::one()) * norm, (T::one() - damped + k * k) * norm],
        }
    }

    pub(crate) fn push(&self, state: &mut [T; 2], input: T) -> T {
        let scaled = self.gain * input;
        let output = scaled + state[0];
        state[0] = self.middle * scaled - self.feedback[0] * output + state[1];
        state[1] = scaled - self.feedback[1] * output;
        output
    }
}
