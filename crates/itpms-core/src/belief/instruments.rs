//! Bias of a side's road as long as its instruments have not been learned: the same for both its tires, and smaller with every frame
//! (docs/math/shared-road.md, section 4). Knows nothing of frames but how many there were.

use super::gaussian::Hypothesis;
use super::state::ROAD_BIAS;
use crate::memory::Blank;
use crate::model::{Side, UNCALIBRATED_BIAS_SD};
use crate::real::Real;

/// Standard deviation, as a share of a compliance, of the bias with the first frame, and the frames after which half of it is left.
const FIRST_SD: f64 = 0.3;
const HALF: f64 = 15.0;
/// Frames after which nothing of it is left to speak of: 1 %.
const ALL: f64 = 1500.0;

/// How many frames each side's instruments have learned from since the belief began.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Instruments<T> {
    frames: [T; 2],
    /// What front and rear of each side read too much before the first of them, as far as is known.
    before: [[T; 2]; 2],
}

impl<T: Real> Instruments<T> {
    pub(super) fn restart(&mut self) {
        self.frames = [T::zero(); 2];
    }

    /// A frame comes that counts `weight`: what is left of the bias after `n` frames is `HALF / (n + HALF)` of the first.
    pub(super) fn learn(&mut self, side: Side, weight: T, hypotheses: &mut [Hypothesis<T>]) {
        let [front, rear] = [side.front(), side.rear()].map(|corner| ROAD_BIAS + corner.index());
        let (frames, before) = (&mut self.frames[side.index()], &mut self.before[side.index()]);
        if *frames > T::lit(ALL) {
            return;
        }
        if !(*frames > T::zero()) {
            for hypothesis in hypotheses.iter_mut() {
                for at in [(front, front), (rear, rear), (front, rear)] {
                    hypothesis.covariance[at] += T::lit(FIRST_SD * FIRST_SD);
                }
            }
            if let Some(constant) = hypotheses.first() {
                *before = [constant.mean[front], constant.mean[rear]];
            }
        }
        let stays = (*frames + T::lit(HALF)) / (*frames + T::lit(HALF) + weight);
        *frames += weight;
        let lasting = T::lit(UNCALIBRATED_BIAS_SD * UNCALIBRATED_BIAS_SD) * (T::one() - stays * stays);
        for hypothesis in hypotheses {
            for (at, before) in [front, rear].into_iter().zip(*before) {
                hypothesis.covariance.shrink_one(at, stays);
                hypothesis.mean[at] = before + (hypothesis.mean[at] - before) * stays;
                hypothesis.covariance[(at, at)] += lasting;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the closed form: after `n` frames `15/(n + 15)` of the first deviation is left, the same of both tires, and the lasting one beside it;
    /// what was known before stays.
    #[test]
    fn what_is_read_too_much_fades_with_the_frames() {
        let mut hypotheses = [Hypothesis::<f64>::BLANK];
        hypotheses[0].start(&[0.0; 4], &[0.02; 4]);
        let [front, rear] = [ROAD_BIAS, ROAD_BIAS + 2];
        hypotheses[0].mean[front] = 0.01;
        let lasting = hypotheses[0].covariance[(front, front)];
        let mut instruments = Instruments::<f64>::BLANK;
        for n in 1..=400 {
            instruments.learn(Side::Left, 1.0, &mut hypotheses);
            let left = 0.3 * 15.0 / (f64::from(n) + 15.0);
            let covariance = &hypotheses[0].covariance;
            assert!((covariance[(front, rear)] - left * left).abs() < 1e-12, "{n}");
            assert!((covariance[(rear, rear)] - left * left - lasting).abs() < 1e-12, "{n}");
        }
        assert!((hypotheses[0].mean[front] - 0.01).abs() < 1e-12 && hypotheses[0].mean[rear].abs() < 1e-12);
        assert_eq!(hypotheses[0].covariance[(front, ROAD_BIAS + 1)], 0.0);
    }
}
