//! How the compliance may move between two passes: three modes, each with a Gaussian of its own, mixed and weighed like
//! an interacting multiple model (docs/math/repeated-road.md, section 4).
//!
//! Knows nothing of roads: what a pass says comes as a score and an information matrix.

use itpms_core::Real;
use nalgebra::{Matrix4, Vector4};

use super::given::Held;

/// Deviation of the compliance now, as a share of the reference.
pub(crate) const NOW: usize = 0;
pub(crate) const RATE: usize = 1;
/// The deviation there was while the road was learned.
pub(crate) const THEN: usize = 2;
/// How far the passes have slipped against the learned road, in 1/(2π 10 Hz).
pub(crate) const SLIP: usize = 3;
pub(crate) const STATES: usize = 4;

/// Modes: at rest, drifting as with a slow leak or a pump, moving as in a puncture.
const MODES: usize = 3;
/// Random walk of the compliance per √s, of its rate per s and √s; a hundredth is some 3 kPa.
const WALK: [f64; MODES] = [0.0010, 0.0015, 0.003];
const RATE_WALK: [f64; MODES] = [0.0, 0.01, 0.06];
/// Seconds after which a rate is forgotten.
const RATE_MEMORY_S: [f64; MODES] = [0.2, 10.0, 5.0];
const CHANGES: [[f64; MODES]; MODES] = [[0.0, 0.03, 0.1], [0.05, 0.0, 0.03], [0.2, 0.2, 0.0]];
/// Standard deviations at which a change is half believed where the force is expected.
const DOUBT: f64 = 10.0;
/// Random walk of the slip in its units per √s.
const SLIP_WALK: f64 = 0.02;

/// Seconds after meeting a road in which no change is looked for: until the road is known, everything looks like one, and
/// changes tell the level.
const SETTLING_S: f64 = 5.0;
/// Relative sd of a level that is known well enough not to be learned from such: 6 kPa.
const KNOWN: f64 = 0.02;

/// What a pass measures of the state, at a state: its log-likelihood, the gradient of that, and the Fisher information.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PassLikelihood<T: Real> {
    pub(crate) log_likelihood: T,
    pub(crate) score: Vector4<T>,
    pub(crate) information: Matrix4<T>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Gaussian<T: Real> {
    pub(crate) state: Vector4<T>,
    pub(crate) covariance: Matrix4<T>,
}

impl<T: Real> Gaussian<T> {
    /// Nothing is known but that the compliance is what it was when the road was met, to this variance.
    fn met(variance: T) -> Self {
        let mut covariance = Matrix4::zeros();
        for (i, j) in [(NOW, NOW), (NOW, THEN), (THEN, NOW), (THEN, THEN)] {
            covariance[(i, j)] = variance;
        }
        Self { state: Vector4::zeros(), covariance }
    }

    fn predict(&mut self, mode: usize, seconds: T) {
        let mut transition = Matrix4::identity();
        transition[(NOW, RATE)] = seconds;
        transition[(RATE, RATE)] = (-seconds / T::lit(RATE_MEMORY_S[mode])).exp();
        self.state = transition * self.state;
        self.covariance = transition * self.covariance * transition.transpose();
        self.covariance[(NOW, NOW)] += T::lit(WALK[mode] * WALK[mode]) * seconds;
        self.covariance[(RATE, RATE)] += T::lit(RATE_WALK[mode] * RATE_WALK[mode]) * seconds;
    }

    /// Takes a change that is not clearly one for none. Where the force is expected decides what seems to be observable: two
    /// slightly different forces for the same compliance would let the level seem so, pass by pass.
    pub(crate) fn with_doubt(mut self) -> Self {
        let c = &self.covariance;
        let change = self.state[NOW] - self.state[THEN];
        let variance = c[(NOW, NOW)] - c[(NOW, THEN)] - c[(THEN, NOW)] + c[(THEN, THEN)];
        let doubt = T::lit(DOUBT * DOUBT) * variance.max(T::zero());
        let (clear, doubt) = (change * change * change * change, doubt * doubt);
        let believed = if clear > T::zero() { clear / (clear + doubt) } else { T::zero() };
        self.state[NOW] = self.state[THEN] + change * believed;
        self.state[RATE] *= believed;
        self
    }

    /// Takes what was reported; gives the log evidence, or nothing if it cannot be taken.
    fn update(&mut self, likelihood: &PassLikelihood<T>) -> Option<T> {
        let shrink = (Matrix4::identity() + self.covariance * likelihood.information).try_inverse()?;
        let covariance = shrink * self.covariance;
        let step = covariance * likelihood.score;
        let gain = likelihood.score.dot(&step) + shrink.determinant().max(T::lit(1e-30)).ln();
        let evidence = likelihood.log_likelihood + T::lit(0.5) * gain;
        self.state += step;
        self.covariance = (covariance + covariance.transpose()) * T::lit(0.5);
        (evidence.is_finite() && self.state.iter().all(|x| x.is_finite())).then_some(evidence)
    }
}

/// The state under all modes. See the [module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Motion<T: Real> {
    modes: [Gaussian<T>; MODES],
    probability: [T; MODES],
    /// Seconds until a change is looked for.
    settling_s: T,
}

impl<T: Real> Motion<T> {
    pub(crate) fn met(variance: T) -> Self {
        let probability = [T::one(), T::zero(), T::zero()];
        let settling_s = if variance < T::lit(KNOWN * KNOWN) { T::zero() } else { T::lit(SETTLING_S) };
        Self { modes: [Gaussian::met(variance); MODES], probability, settling_s }
    }

    /// The compliance is what it was when the road was met, with the error it had then; the slip stays.
    pub(crate) fn hold(&mut self, variance: T) {
        let all = self.all();
        let mut held = Gaussian::met(variance);
        held.state[SLIP] = all.state[SLIP];
        held.covariance[(SLIP, SLIP)] = all.covariance[(SLIP, SLIP)];
        *self = Self { modes: [held; MODES], ..Self::met(variance) };
    }

    pub(crate) fn predict(&mut self, seconds: T, held: Held) {
        for gaussian in &mut self.modes {
            gaussian.covariance[(SLIP, SLIP)] += T::lit(SLIP_WALK * SLIP_WALK) * seconds;
        }
        if held == Held::Yes {
            return;
        }
        self.settling_s = (self.settling_s - seconds).max(T::zero());
        if !(self.settling_s > T::zero()) {
            self.mix(seconds);
        }
        for (mode, gaussian) in self.modes.iter_mut().enumerate() {
            gaussian.predict(mode, seconds);
        }
    }

    /// Each mode takes over from the others what may have changed to it.
    fn mix(&mut self, seconds: T) {
        let old = *self;
        for (to, (mode, probability)) in self.modes.iter_mut().zip(&mut self.probability).enumerate() {
            let weights: [T; MODES] = core::array::from_fn(|from| {
                let leaving = CHANGES[from].iter().sum::<f64>();
                let stays = (-T::lit(leaving) * seconds).exp();
                let changes = (T::one() - stays) * T::lit(CHANGES[from][to] / leaving);
                (if from == to { stays } else { changes }) * old.probability[from]
            });
            (*mode, *probability) = matched(&old.modes, &weights);
        }
    }

    /// Weighs all modes with a pass; false, and nothing changed, if it cannot be taken.
    ///
    /// `likelihood` gives what the pass says at a state, with the force as measured or as expected at another one. The first is
    /// near enough to find where to expect it.
    pub(crate) fn update(
        &mut self,
        likelihood: impl Fn(&Vector4<T>, Option<&Vector4<T>>) -> PassLikelihood<T>,
    ) -> bool {
        let mut next = *self;
        let mut evidence = [T::zero(); MODES];
        for (gaussian, evidence) in next.modes.iter_mut().zip(&mut evidence) {
            let state = gaussian.state;
            let mut near = *gaussian;
            let found = near.update(&likelihood(&state, None));
            let near = near.with_doubt();
            match found.and_then(|_| gaussian.update(&likelihood(&state, Some(&near.state)))) {
                Some(value) => *evidence = value,
                None => return false,
            }
        }
        *self = next;
        self.weigh(&evidence);
        true
    }

    fn weigh(&mut self, evidence: &[T; MODES]) {
        let largest = evidence.iter().fold(evidence[0], |a, &b| a.max(b));
        let mut total = T::zero();
        for (probability, &evidence) in self.probability.iter_mut().zip(evidence) {
            *probability *= (evidence - largest).exp();
            total += *probability;
        }
        for probability in &mut self.probability {
            *probability /= total;
        }
    }

    /// Mean and covariance over all modes.
    pub(crate) fn all(&self) -> Gaussian<T> {
        matched(&self.modes, &self.probability).0
    }

    pub(crate) fn moving(&self) -> T {
        T::one() - self.probability[0]
    }

    pub(crate) fn for_each(&mut self, change: impl Fn(&mut Gaussian<T>)) {
        for gaussian in &mut self.modes {
            change(gaussian);
        }
    }
}

/// The Gaussian with mean and covariance of a weighted sum, and the sum of the weights.
fn matched<T: Real>(parts: &[Gaussian<T>; MODES], weights: &[T; MODES]) -> (Gaussian<T>, T) {
    let total = weights.iter().fold(T::zero(), |sum, &w| sum + w);
    if !(total > T::zero()) {
        return (parts[0], T::zero());
    }
    let mut state = Vector4::zeros();
    for (part, &weight) in parts.iter().zip(weights) {
        state += part.state * (weight / total);
    }
    let mut covariance = Matrix4::zeros();
    for (part, &weight) in parts.iter().zip(weights) {
        let off = part.state - state;
        covariance += (part.covariance + off * off.transpose()) * (weight / total);
    }
    (Gaussian { state, covariance }, total)
}
