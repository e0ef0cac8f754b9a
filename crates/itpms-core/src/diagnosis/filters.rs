//! Second-order sections, and averaging down to a lower rate.

use crate::memory::Blank;
use crate::real::Real;
use crate::spectrum::butterworth::QUALITY;

/// A second-order section (transposed direct form II).
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Section<T> {
    b: [T; 3],
    a: [T; 2],
    state: [T; 2],
}

/// Which side of its frequency a section lets through.
#[derive(Debug, Clone, Copy)]
enum Pass {
    High,
    Low,
}

impl<T: Real> Section<T> {
    /// Bilinear transform of a second-order section with its pole at `frequency` (a share of the rate) and quality `q`.
    fn new(pass: Pass, frequency: f64, q: f64) -> Self {
        let w = core::f64::consts::TAU * frequency;
        let (sin, cos) = nalgebra::ComplexField::sin_cos(w);
        let alpha = sin / (2.0 * q);
        let a0 = 1.0 + alpha;
        let (edge, middle) = match pass {
            Pass::High => (0.5 * (1.0 + cos), -(1.0 + cos)),
            Pass::Low => (0.5 * (1.0 - cos), 1.0 - cos),
        };
        Self {
            b: [edge, middle, edge].map(|b| T::lit(b / a0)),
            a: [-2.0 * cos, 1.0 - alpha].map(|a| T::lit(a / a0)),
            state: [T::zero(); 2],
        }
    }

    fn push(&mut self, x: T) -> T {
        let y = self.b[0] * x + self.state[0];
        self.state[0] = self.b[1] * x - self.a[0] * y + self.state[1];
        self.state[1] = self.b[2] * x - self.a[1] * y;
        y
    }
}

/// A band: fourth-order Butterworth high-pass, then low-pass.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Band<T> {
    sections: [Section<T>; 4],
}

impl<T: Real> Band<T> {
    pub(crate) fn new([low_hz, high_hz]: [f64; 2], rate_hz: f64) -> Self {
        let [broad, sharp] = QUALITY;
        Self {
            sections: [
                Section::new(Pass::High, low_hz / rate_hz, broad),
                Section::new(Pass::High, low_hz / rate_hz, sharp),
                Section::new(Pass::Low, high_hz / rate_hz, broad),
                Section::new(Pass::Low, high_hz / rate_hz, sharp),
            ],
        }
    }

    pub(crate) fn push(&mut self, x: T) -> T {
        self.sections.iter_mut().fold(x, |x, section| section.push(x))
    }
}

/// Means of so many values, for all eight sensors at once.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Averager<T> {
    of: u32,
    count: u32,
    sums: [T; 8],
}

impl<T: Real> Averager<T> {
    pub(crate) fn new(of: u32) -> Self {
        Self { of: of.max(1), count: 0, sums: [T::zero(); 8] }
    }

    /// The means, with every `of`-th call.
    pub(crate) fn push(&mut self, values: &[T; 8]) -> Option<[T; 8]> {
        for (sum, value) in self.sums.iter_mut().zip(values) {
            *sum += *value;
        }
        self.count += 1;
        if self.count < self.of {
            return None;
        }
        let scale = T::one() / T::whole(self.of);
        let means = self.sums.map(|sum| sum * scale);
        *self = Self::new(self.of);
        Some(means)
    }
}

/// Means under a triangle twice as long, for all eight sensors at once: what would come down from about the lower rate is less by
/// the square of an [`Averager`]'s gain there.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Triangle<T> {
    of: u32,
    count: u32,
    /// Under the rising half, which ends the next mean, and under the falling half.
    rising: [T; 8],
    falling: [T; 8],
    /// The rising half of the stretch before.
    risen: [T; 8],
}

impl<T: Real> Triangle<T> {
    pub(crate) fn new(of: u32) -> Self {
        Self { of: of.max(1), ..Self::BLANK }
    }

    /// The means, with every `of`-th call.
    pub(crate) fn push(&mut self, values: &[T; 8]) -> Option<[T; 8]> {
        let (up, down) = (T::whole(self.count), T::whole(self.of - self.count));
        for (i, value) in values.iter().enumerate() {
            self.rising[i] += up * *value;
            self.falling[i] += down * *value;
        }
        self.count += 1;
        if self.count < self.of {
            return None;
        }
        let scale = T::one() / (T::whole(self.of) * T::whole(self.of));
        let means = core::array::from_fn(|i| (self.risen[i] + self.falling[i]) * scale);
        *self = Self { risen: self.rising, ..Self::new(self.of) };
        Some(means)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    fn gain(hz: f64) -> f64 {
        let mut band = Band::<f64>::new([8.0, 20.0], 100.0);
        let mut power = 0.0;
        for i in 0..4000 {
            let y = band.push((core::f64::consts::TAU * hz * f64::from(i) / 100.0).sin());
            if i >= 2000 {
                power += y * y / 1000.0;
            }
        }
        power.sqrt()
    }

    #[test]
    fn a_band_passes_what_is_in_it() {
        // Butterworth: 1 in the middle, both edges at -3 dB, 24 dB an octave outside (the bilinear transform bends the upper edge to more).
        assert!((gain(12.6) - 1.0).abs() < 0.06, "{}", gain(12.6));
        assert!((gain(8.0) - 0.5f64.sqrt()).abs() < 0.03 && (gain(20.0) - 0.5f64.sqrt()).abs() < 0.03);
        assert!(gain(4.0) < 0.07 && gain(2.0) < 0.005 && gain(40.0) < 0.07);
    }

    #[test]
    fn averages_come_when_they_are_full() {
        let mut averager = Averager::<f64>::new(4);
        let out: Vec<_> = (0..9).filter_map(|i| averager.push(&[f64::from(i); 8])).collect();
        assert_eq!(out, [[1.5; 8], [5.5; 8]]);
    }

    #[test]
    fn what_would_come_down_from_the_lower_rate_is_lost_under_a_triangle() {
        // From 100 to 25 Hz; at 24.4 Hz, which comes down to 0.6 Hz, a mean leaves 2.5 % and the triangle its square.
        let amplitude = |hz: f64| {
            let (mut mean, mut triangle) = (Averager::<f64>::new(4), Triangle::<f64>::new(4));
            let mut powers = [0.0; 2];
            for i in 0..4000 {
                let values = [(core::f64::consts::TAU * hz * f64::from(i) / 100.0).sin(); 8];
                for (power, out) in powers.iter_mut().zip([mean.push(&values), triangle.push(&values)]) {
                    // The first triangle is half a one.
                    *power += out.filter(|_| i > 4).map_or(0.0, |out| out[3] * out[3] / 500.0);
                }
            }
            powers.map(f64::sqrt)
        };
        let [mean, triangle] = amplitude(24.4);
        assert!((0.02..0.03).contains(&mean) && triangle < 1.1 * mean * mean, "{mean} {triangle}");
        let [mean, triangle] = amplitude(0.6);
        assert!((mean - 1.0).abs() < 0.01 && (triangle - 1.0).abs() < 0.01, "{mean} {triangle}");
    }
}
