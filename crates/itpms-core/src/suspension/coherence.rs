//! How far a corner's body goes with its wheel: the coherence of the two sensors' accelerations (docs/math/unknown-car.md, section 3). Where
//! they have little to do with each other, no quarter car describes them, and what it makes of them is no tire.

use nalgebra::{Complex, SMatrix, SVector};

use crate::memory::Blank;
use crate::model::COHERENCE_BINS;
use crate::real::Real;
use crate::spectrum::transfer::{FRICTION_BINS as BINS, FRICTION_SPACING_HZ};

/// Memory in s of the powers.
pub(super) const MEMORY_S: f64 = 20.0;
/// Power over that of the sensors' noise from which on a frame counts.
const ABOVE_NOISE: f64 = 4.0;

/// Running powers of body and wheel, the sensors' noise taken off, and their cross power.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Coherence<T: Real> {
    body: SVector<T, BINS>,
    wheel: SVector<T, BINS>,
    cross: SMatrix<T, BINS, 2>,
    learned_s: T,
    /// See [`incoherence`](Self::incoherence): logarithms, which no sample should have to take.
    incoherence: T,
}

impl<T: Real> Coherence<T> {
    pub(super) fn new() -> Self {
        Self { incoherence: T::one(), ..Self::BLANK }
    }

    /// Takes the bins of a frame, body and wheel, that is so many seconds newer than the last; `noise`: power of either sensor's noise,
    /// per bin.
    pub(super) fn learn(&mut self, frame: &[[Complex<T>; 2]; BINS], noise: &[T; BINS], seconds: T) {
        let over_noise =
            COHERENCE_BINS.map(|bin| frame[bin][0].norm_sqr()).fold(T::zero(), |sum, power| sum + power)
                / COHERENCE_BINS.map(|bin| noise[bin]).fold(T::zero(), |sum, power| sum + power);
        if !(over_noise > T::lit(ABOVE_NOISE)) {
            return;
        }
        self.learned_s += seconds;
        let gain = T::one() - (-seconds / T::lit(MEMORY_S).min(self.learned_s)).exp();
        // Every frame counts alike, however loud.
        let loud = frame.iter().fold(T::zero(), |sum, [_, wheel]| sum + wheel.norm_sqr());
        let level = T::one() / loud.max(T::lit(1e-15));
        for (bin, [body, wheel]) in frame.iter().enumerate() {
            let cross = body * wheel.conj() * level;
            let follow = |of: &mut T, now: T| *of += gain * (now - *of);
            follow(&mut self.body[bin], (body.norm_sqr() - noise[bin]) * level);
            follow(&mut self.wheel[bin], (wheel.norm_sqr() - noise[bin]) * level);
            follow(&mut self.cross[(bin, 0)], cross.re);
            follow(&mut self.cross[(bin, 1)], cross.im);
        }
        self.incoherence = geometric_mean(COHERENCE_BINS.map(|bin| {
            let (re, im) = (self.cross[(bin, 0)], self.cross[(bin, 1)]);
            let powers = (self.body[bin] * self.wheel[bin]).max(T::lit(1e-15));
            T::one() - (re * re + im * im) / powers
        }));
    }

    pub(super) fn learned_s(&self) -> T {
        self.learned_s
    }

    /// One less the coherence: the geometric mean over the bins, without the bias of few averages: of `K` of them a coherence is estimated too
    /// high by its complement over `K`.
    pub(super) fn incoherence(&self) -> T {
        let averages = self.averages();
        (self.incoherence * averages / (averages - T::one()).max(T::one())).min(T::one())
    }

    /// Number of independent averages that it rests on: one for each frame's length.
    pub(super) fn averages(&self) -> T {
        self.learned_s.min(T::lit(2.0 * MEMORY_S)) * T::lit(FRICTION_SPACING_HZ)
    }
}

/// Geometric mean of shares, of which none is taken for less than a millionth.
pub(super) fn geometric_mean<T: Real>(values: impl ExactSizeIterator<Item = T>) -> T {
    let count = T::lit(values.len() as f64);
    (values.fold(T::zero(), |sum, value| sum + value.max(T::lit(1e-6)).ln()) / count).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn half_of_a_body_that_moves_by_itself_is_incoherent() {
        let mut random = Random(3);
        let mut complex = || Complex::new(random.normal(), random.normal());
        let mut coherence = Coherence::<f64>::new();
        for _ in 0..2000 {
            // Noise of a quarter of the wheel's power in either sensor.
            let frame = core::array::from_fn(|_| {
                let wheel = complex();
                let body = wheel * 0.3 + complex() * 0.3;
                [body * 4.0 + complex() * 0.5, wheel + complex() * 0.5]
            });
            coherence.learn(&frame, &[0.5; BINS], 0.2);
        }
        // Coherence 1/2; of the last hundred frames, five bins and noise.
        let incoherence = coherence.incoherence();
        assert!((incoherence - 0.5).abs() < 0.1, "{incoherence}");
        // A few frames in which hardly anything was received do not count.
        assert!((300.0..400.0).contains(&coherence.learned_s()));
    }

    #[test]
    fn noise_alone_is_not_looked_at() {
        let mut random = Random(4);
        let mut complex = || Complex::new(random.normal(), random.normal());
        let mut coherence = Coherence::<f64>::new();
        for _ in 0..100 {
            coherence.learn(&core::array::from_fn(|_| [complex(), complex()]), &[2.0; BINS], 0.2);
        }
        assert_eq!(coherence.learned_s(), 0.0);
    }
}
