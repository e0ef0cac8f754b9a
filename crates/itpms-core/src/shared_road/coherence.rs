//! Whether front and rear really share a road now, frequency by frequency, and what that is worth: the information in a
//! frame, free of what noise and a road that is not quite the same do to it (docs/math/shared-road.md, section 5).

use nalgebra::{SMatrix, SVector};

use super::constraint::{Disagreement, Gram, OWN, Score, SensorNoise, within_axles};
use super::{BINS, OVERLAP};
use crate::real::Real;

/// Incoherence assumed before anything was seen, and the least that is believed: no damper is linear.
const START: f64 = 0.01;
const LEAST: f64 = 3e-4;
/// The most that is believed.
const MOST: f64 = 2.0;
/// Largest step of a frame's estimate, as a multiple of what is believed, and more.
const LARGEST_STEP: f64 = 6.0;
const LARGEST_MORE: f64 = 0.01;
/// Time constants in s of the incoherence, of the road's power and of the derivatives' products.
const INCOHERENCE_S: f64 = 2.0;
const POWER_S: f64 = 1.0;
const GRAM_S: f64 = 4.0;
/// Frames before the products are good enough to learn from.
const FRAMES: u32 = 10;
/// Share of the information that is kept whatever noise is said to be in it.
const KEPT_SHARE: f64 = 0.05;

/// Running averages of one side.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(super) struct Coherence<T: Real> {
    /// Share of the power that is not common, per bin: as believed, and as seen, which may be nothing.
    incoherence: SVector<T, BINS>,
    seen: SVector<T, BINS>,
    /// Road power per bin; zero before the first frame.
    power: SVector<T, BINS>,
    /// Products of the derivatives with each other and with the road, over the road's power.
    gram: [Gram<T>; BINS],
    lean: SMatrix<T, BINS, OWN>,
    frames: u32,
}

/// What is expected of a frame, and what it is worth.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Expectation<T: Real> {
    /// Power of the disagreement, per bin.
    pub(super) power: [T; BINS],
    /// What noise does to the score.
    pub(super) score: Score<T>,
    /// Takes the score to what may be believed of it, `W`, and the information that is in that, `W A`. `None` while too
    /// little was seen.
    pub(super) worth: Option<(Gram<T>, Gram<T>)>,
}

impl<T: Real> Coherence<T> {
    pub(super) fn new() -> Self {
        Self {
            incoherence: SVector::repeat(T::lit(START)),
            seen: SVector::zeros(),
            power: SVector::zeros(),
            gram: [Gram::zeros(); BINS],
            lean: SMatrix::zeros(),
            frames: 0,
        }
    }

    /// Road power to be expected in a bin, half of it the frame's own.
    fn road(&self, bin: usize, now: T) -> T {
        let usual = if self.power[bin] > T::zero() { self.power[bin] } else { now };
        T::lit(0.5) * (usual + now)
    }

    /// What to expect of a frame with this road power, given the sensors' noise.
    pub(super) fn expect(&self, road_power: &[T; BINS], noise: &SensorNoise<T>) -> Expectation<T> {
        let mut power = [T::zero(); BINS];
        let mut score = Score::zeros();
        let (mut all, mut clean) = (Gram::zeros(), Gram::zeros());
        for bin in 0..BINS {
            let road = self.road(bin, road_power[bin]);
            power[bin] = self.incoherence[bin] * road + noise.power[bin] + T::lit(1e-12);
            let weight = T::lit(2.0 * OVERLAP) / power[bin];
            // Half of what is not common is in each axle.
            let apart = T::lit(0.5) * self.seen[bin];
            score += (self.lean.row(bin).transpose() * (apart * road) + noise.score[bin]) * weight;
            let gram = self.gram[bin] * road;
            all += gram * weight;
            clean += (gram - within_axles(&gram) * apart - noise.gram[bin]) * weight;
        }
        let worth = if self.frames < FRAMES { None } else { worth(&all, &clean) };
        Expectation { power, score, worth }
    }

    /// Learns from a frame and what remained of it: power over what was expected, per bin.
    pub(super) fn learn(
        &mut self,
        expected: &Expectation<T>,
        found: &Disagreement<T>,
        ratio: &[T; BINS],
        noise: &SensorNoise<T>,
        seconds: T,
    ) {
        self.frames = self.frames.saturating_add(1);
        let count = T::one() / T::lit(f64::from(self.frames));
        let gain = |time_s: f64| (T::one() - (-seconds / T::lit(time_s)).exp()).max(count);
        let (fast, gram) = (gain(POWER_S), gain(GRAM_S));
        let slow = T::one() - (-seconds / T::lit(INCOHERENCE_S)).exp();
        for (bin, &ratio) in ratio.iter().enumerate() {
            let now = found.road_power[bin];
            let here = self.road(bin, now);
            let most = self.incoherence[bin] * T::lit(LARGEST_STEP) + T::lit(LARGEST_MORE);
            let seen = ((expected.power[bin] * ratio - noise.power[bin]) / here).min(most);
            self.seen[bin] = (self.seen[bin] + slow * (seen - self.seen[bin])).clamp(T::zero(), T::lit(MOST));
            let step = slow * (seen - self.incoherence[bin]);
            self.incoherence[bin] = (self.incoherence[bin] + step).clamp(T::lit(LEAST), T::lit(MOST));
            let change = now - self.power[bin];
            self.power[bin] += fast * change;
            let power = self.power[bin].max(T::lit(1e-30));
            let change = found.gram(bin) / power - self.gram[bin];
            self.gram[bin] += change * gram;
            for p in 0..OWN {
                let change = found.lean[(bin, p)] / power - self.lean[(bin, p)];
                self.lean[(bin, p)] += gram * change;
            }
        }
    }

    /// Incoherence near wheel hop.
    pub(super) fn near_wheel_hop(&self) -> T {
        T::lit(0.5) * (self.incoherence[1] + self.incoherence[2])
    }
}

/// `W = A G^-1` and `W A` for the products with noise, `G`, and without it, `A`.
fn worth<T: Real>(all: &Gram<T>, clean: &Gram<T>) -> Option<(Gram<T>, Gram<T>)> {
    let mut all = *all;
    for i in 0..OWN {
        all[(i, i)] *= T::lit(1.0 + 1e-4);
    }
    // No more noise is taken off than leaves something in every direction.
    let kept = all * T::lit(KEPT_SHARE);
    let mut share = T::one();
    let mut sure = *clean;
    while (sure - kept).cholesky().is_none() {
        share -= T::lit(0.1);
        if !(share > T::lit(0.05)) {
            return None;
        }
        sure = all + (clean - all) * share;
    }
    let inverse = all.cholesky()?.inverse();
    let weight = sure * inverse;
    let information = weight * sure;
    Some((weight, (information + information.transpose()) * T::lit(0.5)))
}
