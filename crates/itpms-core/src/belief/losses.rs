//! From when on the losses of this drive are counted: once tires are known and nothing moves, and anew after whatever may have changed them
//! (docs/math/level-and-loss.md).

use crate::memory::Blank;

/// Seconds of shared road after which a tire's level is what it will be but for what is constant, and so cancels in a loss; after a
/// calibration, in which all tires were known, at once.
const SETTLING_S: f64 = 25.0;
const CALIBRATED_SETTLING_S: f64 = 1.0;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Losses {
    /// Since when, in s, if they are.
    since_s: Option<f64>,
    /// Seconds of shared road that have to be learned from before.
    settled_at_s: f64,
}

impl Losses {
    /// Not yet.
    pub(super) fn none() -> Self {
        Self { since_s: None, settled_at_s: SETTLING_S }
    }

    /// Tires may have changed: their levels have to be found anew. `learned_s`: seconds of shared road so far.
    pub(super) fn end(&mut self, learned_s: f64) {
        *self = Self { since_s: None, settled_at_s: learned_s + SETTLING_S };
    }

    /// A calibration has just ended. `learned_s`: seconds of shared road so far.
    pub(super) fn settle_soon(&mut self, learned_s: f64) {
        self.settled_at_s = learned_s + CALIBRATED_SETTLING_S;
    }

    pub(super) fn begin(&mut self, time_s: f64) {
        self.since_s = Some(time_s);
    }

    /// Whether they are to be counted from now on.
    pub(super) fn have_settled(&self, learned_s: f64) -> bool {
        self.since_s.is_none() && learned_s >= self.settled_at_s
    }

    /// Since when they are counted, in s.
    pub(super) fn since_s(&self) -> Option<f64> {
        self.since_s
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use nalgebra::{Matrix2, Vector2};

    use crate::belief::Onset;
    use crate::belief::Tires;
    use crate::belief::gaussian::{Circumstances, Hypothesis};
    use crate::belief::state::{LEVEL, State, TIRE};
    use crate::belief::{Belief, LONGEST_PAUSE_S};
    use crate::memory::{Blank, configured};
    use crate::model::Corner::{self, FrontLeft, FrontRight, RearLeft};
    use crate::model::{CarConfig, CornerConfig};

    const ONSET: Onset<f64> = Onset { rates: [0.0; 4], longest_step_s: 1.0 };

    fn belief() -> Belief<f64> {
        let config = CarConfig { corners: [Some(CornerConfig::paper()); 4], wheelbase_m: Some(2.7) };
        let mut belief = configured(|belief: &mut Belief<f64>| belief.configure(&config));
        belief.predict(0.0, &ONSET);
        belief
    }

    fn one(quantity: usize) -> State<f64> {
        State::from_fn(|i, _| if i == quantity { 1.0 } else { 0.0 })
    }

    /// A tire whose level is wrong by 0.11 and measured to 0.02 before and after something happened to it: a textbook Kalman filter over
    /// level and compliance finds the same, the level learns from what comes later, and the loss does not know how wrong the level is.
    #[test]
    fn a_loss_is_known_better_than_its_level() {
        let (noise, happened) = (0.02_f64.powi(2), 0.05_f64.powi(2));
        let mut hypothesis = configured(|hypothesis: &mut Hypothesis<f64>| {
            hypothesis.start(&[0.0; 4], &Circumstances::of_a_car([0.01; 4]).mass_sd);
        });
        hypothesis.update(&one(TIRE + 1), 0.08, noise);
        hypothesis.begin_loss(FrontRight);
        assert_eq!(
            [hypothesis.loss(FrontRight), hypothesis.loss_covariance(FrontRight, FrontRight)],
            [0.0; 2]
        );
        let variance = hypothesis.covariance[(TIRE + 1, TIRE + 1)];
        let (mut mean, mut covariance) =
            (Vector2::repeat(hypothesis.mean[TIRE + 1]), Matrix2::repeat(variance));
        hypothesis.covariance[(TIRE + 1, TIRE + 1)] += happened;
        covariance[(0, 0)] += happened;
        for measured in [0.2, 0.23, 0.21] {
            let innovation = measured - hypothesis.mean[TIRE + 1];
            hypothesis.update(&one(TIRE + 1), innovation, noise);
            let gain = covariance.column(0) / (covariance[(0, 0)] + noise);
            mean += gain * (measured - mean[0]);
            covariance -= gain * covariance.row(0);
        }
        let at = [TIRE + 1, LEVEL + 1];
        for i in 0..2 {
            assert!((hypothesis.mean[at[i]] - mean[i]).abs() < 1e-12);
            for j in 0..2 {
                assert!((hypothesis.covariance[(at[i], at[j])] - covariance[(i, j)]).abs() < 1e-12);
            }
        }
        let loss_variance = covariance[(0, 0)] + covariance[(1, 1)] - 2.0 * covariance[(0, 1)];
        assert!((hypothesis.loss_covariance(FrontRight, FrontRight) - loss_variance).abs() < 1e-12);
        // The level was measured once, 0.02 of 0.11: as good as the loss's own.
        assert!(hypothesis.loss(FrontRight) > 0.1 && loss_variance.sqrt() < 0.03);
    }

    /// Of two tires only the difference is measured, as on a side: it grows by 0.2. That the first has lost so much and that the other one has
    /// gained it is equally likely to a Gaussian. With losses that are never negative it is the first: the exact posterior, enumerated, has its
    /// mass within 1/400 of the bound, and the projection lies there.
    #[test]
    fn of_a_side_the_tire_that_lost_is_found_as_by_exact_enumeration() {
        let (noise, happened, margin) = (0.002_f64, 0.02_f64, 0.02_f64);
        let mut hypothesis = configured(|hypothesis: &mut Hypothesis<f64>| {
            hypothesis.start(&[0.0; 4], &Circumstances::of_a_car([0.01; 4]).mass_sd);
        });
        Corner::ALL.into_iter().for_each(|tire| hypothesis.begin_loss(tire));
        for tire in 0..4 {
            hypothesis.covariance[(TIRE + tire, TIRE + tire)] += happened * happened;
        }
        // The levels' difference was known.
        hypothesis.update(&(one(LEVEL) - one(LEVEL + 2)), 0.0, 1e-10);
        hypothesis.update(&(one(TIRE) - one(TIRE + 2)), 0.2, noise * noise);
        assert!(
            (hypothesis.loss(FrontLeft) - 0.1).abs() < 2e-3 && (hypothesis.loss(RearLeft) + 0.1).abs() < 2e-3
        );
        hypothesis.hold_loss_above(RearLeft, -margin);
        let (mut weight, mut first, mut second) = (0.0, 0.0, 0.0);
        for i in 0..800 {
            for j in 0..800 {
                let [a, b] = [i, j].map(|cell| -margin + 0.0005 * f64::from(cell));
                let exponent = (a * a + b * b) / (happened * happened) + ((a - b - 0.2) / noise).powi(2);
                let here = (-0.5 * exponent).exp();
                (weight, first, second) = (weight + here, first + here * a, second + here * b);
            }
        }
        let exact = [first / weight, second / weight];
        assert!(
            (hypothesis.loss(FrontLeft) - exact[0]).abs() < 4e-3,
            "{} {exact:?}",
            hypothesis.loss(FrontLeft)
        );
        assert!(
            (hypothesis.loss(RearLeft) - exact[1]).abs() < 4e-3,
            "{} {exact:?}",
            hypothesis.loss(RearLeft)
        );
    }

    fn counted(belief: &mut Belief<f64>) -> bool {
        let mut tires = Tires::BLANK;
        belief.refresh(&mut tires);
        tires.count_losses
    }

    /// Losses are counted once tires have settled; a night ends that, and so does whatever sets or restarts tires.
    #[test]
    fn losses_are_counted_between_what_may_change_tires() {
        let mut belief = belief();
        belief.settle(24.0);
        assert!(!counted(&mut belief));
        belief.settle(1.5);
        assert!(counted(&mut belief));
        belief.predict(10.0, &ONSET);
        belief.settle(0.1);
        assert!(counted(&mut belief), "a halt at a light");
        belief.predict(20.0 + LONGEST_PAUSE_S, &ONSET);
        belief.settle(0.1);
        assert!(!counted(&mut belief), "a night");
        belief.settle(25.0);
        assert!(counted(&mut belief));
        belief.begin_calibration();
        belief.settle(10.0);
        assert!(!counted(&mut belief), "in a calibration nothing is lost");
        belief.set_calibrating(false);
        belief.settle(1.5);
        assert!(counted(&mut belief), "known from the calibration");
        belief.restart();
        assert!(!counted(&mut belief));
    }

    /// Of a tire whose sensors were out of order what it had lost before is still known, less well; so are the others' losses.
    #[test]
    fn a_tire_that_restarts_may_have_lost_more() {
        let mut belief = belief();
        belief.settle(26.0);
        belief.predict(1.0, &ONSET);
        for tire in [0, 3] {
            belief.update_scalar(1e-10, |state| (one(TIRE + tire), 1e-3 - state[TIRE + tire]));
        }
        let mut tires = Tires::BLANK;
        belief.refresh(&mut tires);
        let before = tires.losses_after(&[0.0; 4]).unwrap();
        belief.restart_tire(FrontLeft);
        belief.refresh(&mut tires);
        let after = tires.losses_after(&[0.0; 4]).unwrap();
        assert!((after.0 - before.0).amax() < 1e-12);
        let (before, after) = (before.1[0], after.1[0]);
        assert!(before[(0, 0)].sqrt() < 0.002 && after[(0, 0)].sqrt() > 0.04);
        assert_eq!(after[(3, 3)], before[(3, 3)]);
    }
}
