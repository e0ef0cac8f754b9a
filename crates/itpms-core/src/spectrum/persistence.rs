//! How much of a road is one line that goes on and on, as a washboard's is (docs/math/shared-road.md, section 5).
//!
//! A road under a tire read rightly is nearly white: what its frames show in a bin are independent numbers. A line of frequency `f`
//! turns by `2π f τ` in a lag `τ`, frame after frame, so the mean of `V_k V_{k-n}*` over the mean of `|V_k|²` has a magnitude near one.
//! Frames that repeat each other like this are no new evidence, and a wheel that seems to hop is shaken.

use nalgebra::Complex;

use crate::memory::Blank;
use crate::real::Real;

/// Bins of a frame around wheel hop.
const NEAR_HOP: usize = 2;
/// Frames from one to the next that shares no sample with it, and one more.
const LAG: usize = 3;
/// Time constant in s of a road's coherence, that of frames with earlier ones and that of both axles: a line whose speed changes turns faster
/// or slower meanwhile, and bends begin.
pub(crate) const COHERENCE_S: f64 = 2.0;
/// Time constant in s in which incoherence becomes lasting, or usual; it ends at once.
pub(crate) const LASTING_S: f64 = 20.0;
/// Squared coherence from which on the road is a line. Of 33 independent frames it is exceeded once in 10^10 times; wheels out of balance on
/// the smoothest road reach 0.4, a washboard at wheel hop has 0.75 while the speed changes.
const LINE: f64 = 0.5;
const LEAST_FRAMES: u32 = 10;

/// Running means of a few bins around wheel hop.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Persistence<T: Real> {
    /// The newest frames' road velocities, newest first.
    before: [[Complex<T>; NEAR_HOP]; LAG],
    product: Complex<T>,
    power: T,
    frames: u32,
    hop_s: f64,
}

impl<T: Real> Persistence<T> {
    /// For frames of which one comes every `hop_s`.
    pub(crate) fn new(hop_s: f64) -> Self {
        Self { hop_s, ..Self::BLANK }
    }

    pub(crate) fn take(&mut self, road: [Complex<T>; NEAR_HOP]) {
        let keep = T::lit(1.0 - self.hop_s / COHERENCE_S);
        (self.product, self.power) = (self.product * keep, self.power * keep);
        let [newest, newer, oldest] = self.before;
        for (now, then) in road.iter().zip(&oldest) {
            self.product += *now * then.conj();
            self.power += T::lit(0.5) * (now.norm_sqr() + then.norm_sqr());
        }
        self.before = [road, newest, newer];
        self.frames = self.frames.saturating_add(1);
        if !(self.power.is_finite() && self.product.norm_sqr().is_finite()) {
            *self = Self::new(self.hop_s);
        }
    }

    /// Whether the road is one line: its frames are no new evidence then.
    pub(crate) fn is_line(&self) -> bool {
        self.frames >= LEAST_FRAMES && self.product.norm_sqr() > self.power * self.power * T::lit(LINE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOP_S: f64 = 0.06;

    /// Complex white noise of unit power, by sums of twelve uniform numbers.
    fn white(state: &mut u64) -> Complex<f64> {
        let mut uniform = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        Complex::new(normal(), normal()) * 0.5_f64.sqrt()
    }

    /// A line that moves by `hz_per_s`, of `power` over noise of unit power; the share of the frames after the first two seconds that are
    /// taken for one.
    fn share_on_line(power: f64, hz_per_s: f64) -> f64 {
        let (mut persistence, mut state) = (Persistence::new(HOP_S), 7);
        let (frames, mut on_line) = (2000, 0);
        for k in 0..frames {
            let time_s = HOP_S * f64::from(k);
            // To and fro within two seconds each, as with a speed that wanders.
            let phase =
                core::f64::consts::TAU * (11.0 * time_s + 0.5 * hz_per_s * time_s.rem_euclid(2.0).powi(2));
            let line = Complex::new(phase.cos(), phase.sin()) * power.sqrt();
            persistence.take([line + white(&mut state), line + white(&mut state)]);
            on_line += u32::from(k > 33 && persistence.is_line());
        }
        f64::from(on_line) / f64::from(frames - 34)
    }

    #[test]
    fn a_line_is_found_while_its_frequency_moves_and_noise_is_none() {
        assert_eq!(share_on_line(0.0, 0.0), 0.0);
        // Half of the power: a coherence of a half, a quarter squared.
        assert_eq!(share_on_line(1.0, 0.0), 0.0);
        assert!(share_on_line(20.0, 0.0) == 1.0);
        assert!(share_on_line(20.0, 0.3) > 0.95, "{}", share_on_line(20.0, 0.3));
    }

    #[test]
    fn what_is_no_number_is_forgotten() {
        let mut persistence = Persistence::new(HOP_S);
        let one = [Complex::new(1.0, 0.0); NEAR_HOP];
        (0..20).for_each(|_| persistence.take(one));
        assert!(persistence.is_line());
        persistence.take([Complex::new(f64::NAN, 0.0); NEAR_HOP]);
        assert_eq!(persistence, Persistence::new(HOP_S));
    }
}
