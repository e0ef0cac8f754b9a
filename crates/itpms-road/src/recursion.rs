//! The Kalman recursion behind the road estimate: mean, covariance, prediction, correction (docs/math/road.md, section 3).
//!
//! Called by [`crate::filter`]. Knows nothing of time stamps, missing values or levels.

use crate::model::{
    CORE, CoreState, Matrix, Model, STATES, State, Transition, add_multiple, combine, state, symmetrise,
};
use itpms_core::Real;
use nalgebra::{Matrix2, Vector2};

/// Steps further from the one at hand than this share of it get their own discretisation.
const STEP_TOLERANCE: f64 = 1e-3;

/// A measured acceleration's way into the state, kept for the backward pass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Correction<T> {
    pub(crate) row: CoreState<T>,
    pub(crate) gain: CoreState<T>,
    pub(crate) innovation: T,
    pub(crate) variance: T,
}

/// The height's expectation beside the height that is given out (eq. 13). The expectation of a height is a poor
/// height: it shrinks all wavelengths to be right about a slow drift that does not show, so the filter's output keeps the
/// tire deflection's gain. The backward pass starts from expectations and needs the difference.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct HeightTwin<T: Real> {
    /// Expectation less output, of height and integral.
    mean: Vector2<T>,
    /// Covariance of that difference: the output's covariance less the expectation's.
    covariance: Matrix2<T>,
}

impl<T: Real> HeightTwin<T> {
    fn same() -> Self {
        Self { mean: Vector2::zeros(), covariance: Matrix2::zeros() }
    }

    fn predict(&mut self, block: &Matrix2<T>) {
        self.mean = block * self.mean;
        self.covariance = block * self.covariance * block.transpose();
    }

    fn correct(&mut self, gain_difference: &Vector2<T>, innovation: T, variance: T) {
        self.mean += gain_difference * innovation;
        self.covariance += gain_difference * gain_difference.transpose() * variance;
    }
}

/// Which transition a prediction took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lean {
    /// On the body's measured acceleration.
    Aided,
    /// On the model alone.
    Free,
}

/// Mean and covariance, and the transitions at hand.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Recursion<T: Real> {
    x: State<T>,
    p: Matrix<T>,
    twin: HeightTwin<T>,
    aided: Option<Transition<T>>,
    free: Option<Transition<T>>,
}

impl<T: Real> Recursion<T> {
    /// Nothing known but what kind of road and how large the sensors' offsets may be.
    pub(crate) fn new(model: &Model<T>, bias_sd_m_s2: T) -> Self {
        let p = prior(model, bias_sd_m_s2);
        Self { x: State::zeros(), p, twin: HeightTwin::same(), aided: None, free: None }
    }

    /// The model has changed: the next prediction discretises it anew.
    pub(crate) fn forget_transitions(&mut self) {
        self.aided = None;
        self.free = None;
    }

    /// Steps the state over `step_s`; leans on the body's acceleration if one is given.
    pub(crate) fn predict(&mut self, model: &Model<T>, step_s: T, body_accel_m_s2: Option<T>) -> Lean {
        let (transition, lean) = match body_accel_m_s2 {
            Some(_) => (recall(&mut self.aided, step_s, |h| model.aided(h)), Lean::Aided),
            None => (recall(&mut self.free, step_s, |h| model.free(h)), Lean::Free),
        };
        self.twin.predict(&transition.height_block());
        self.x = transition.state(&self.x, body_accel_m_s2.unwrap_or_else(T::zero));
        self.p = transition.covariance(&self.p);
        lean
    }

    /// The transition of the last prediction.
    pub(crate) fn transition(&self, lean: Lean) -> Option<&Transition<T>> {
        match lean {
            Lean::Aided => self.aided.as_ref(),
            Lean::Free => self.free.as_ref(),
        }
    }

    /// Scalar measurement update in Joseph form: `P <- (I - K h) P (I - K h)^T + K R K^T` (eq. 12), which holds for
    /// any gain. The core's is Kalman's; the height's is the tire deflection's (eq. 11).
    pub(crate) fn correct(&mut self, row: CoreState<T>, measured: T, noise: T) -> Correction<T> {
        let cross = combine(&self.p.data.0, &row);
        let variance = dot(&row, &cross) + noise;
        let innovation = measured - dot(&row, &self.x.data.0[0]);
        let mut gain = cross.map(|cross| cross / variance);
        let expected = [gain[state::ROAD], gain[state::ROAD_INTEGRAL]];
        gain[state::ROAD] = gain[state::TIRE];
        gain[state::ROAD_INTEGRAL] = T::zero();
        let differs = Vector2::new(expected[0] - gain[state::ROAD], expected[1]);
        self.twin.correct(&differs, innovation, variance);
        add_multiple(&mut self.x.data.0[0], innovation, &gain);
        // `P - K (P h)^T`, and of that what is left of `P h`, a column at a time.
        for (column, cross) in self.p.data.0.iter_mut().zip(cross) {
            add_multiple(column, -cross, &gain);
        }
        let mut rest = combine(&self.p.data.0, &row);
        add_multiple(&mut rest, -noise, &gain);
        for (column, gain) in self.p.data.0.iter_mut().zip(gain) {
            add_multiple(column, -gain, &rest);
        }
        symmetrise(&mut self.p);
        Correction { row, gain: CoreState::from_fn(|i, _| gain[i]), innovation, variance }
    }

    pub(crate) fn is_sound(&self) -> bool {
        // Zero times what is not finite is no number.
        let mut zeros = [T::zero(); STATES];
        for column in self.p.data.0.iter().chain(&self.x.data.0) {
            add_multiple(&mut zeros, T::zero(), column);
        }
        zeros.iter().all(|&zero| zero == T::zero()) && (0..STATES).all(|i| self.p[(i, i)] > T::zero())
    }

    pub(crate) fn mean(&self) -> &State<T> {
        &self.x
    }

    /// Variance of the height given out, m².
    pub(crate) fn road_variance_m2(&self) -> T {
        self.p[(state::ROAD, state::ROAD)]
    }

    /// Height of the expectation above the height given out, m.
    pub(crate) fn expected_offset_m(&self) -> T {
        self.twin.mean[0]
    }

    /// Variance of the height's expectation, m².
    pub(crate) fn expected_variance_m2(&self) -> T {
        self.p[(state::ROAD, state::ROAD)] - self.twin.covariance[(0, 0)]
    }

    /// Covariance of the height's expectation (and of the height given out) with the core states.
    pub(crate) fn road_covariance(&self) -> CoreState<T> {
        self.p.fixed_view::<CORE, 1>(0, state::ROAD).into_owned()
    }
}

/// `h x` of a measurement's row and a state, or a column of the covariance.
#[inline(always)]
fn dot<T: Real>(row: &CoreState<T>, x: &[T; STATES]) -> T {
    row.iter().zip(x).fold(T::zero(), |sum, (&row, &x)| sum + row * x)
}

/// The covariance of a car that has been driving unobserved for long, with unknown sensor offsets.
fn prior<T: Real>(model: &Model<T>, bias_sd_m_s2: T) -> Matrix<T> {
    let mut p = *model.free(T::lit(10.0) / model.low_cut_rad_per_s).noise();
    for i in [state::BODY_BIAS, state::WHEEL_BIAS] {
        p.fill_row(i, T::zero());
        p.fill_column(i, T::zero());
        p[(i, i)] = bias_sd_m_s2 * bias_sd_m_s2;
    }
    p
}

/// The transition at hand if it fits the step, else a new one.
fn recall<T: Real>(
    slot: &mut Option<Transition<T>>,
    step_s: T,
    make: impl FnOnce(T) -> Transition<T>,
) -> &Transition<T> {
    if slot.as_ref().is_some_and(|known| !((known.step_s - step_s).abs() <= T::lit(STEP_TOLERANCE) * step_s))
    {
        *slot = None;
    }
    slot.get_or_insert_with(|| make(step_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RoadConfig;
    use itpms_core::model::QuarterCar;
    use proptest::prelude::*;

    /// Smallest eigenvalue of the covariance's correlation matrix, and its largest asymmetry.
    fn check<T: Real>(steps: &[(u8, i16, i16)], stiffness: f64, log_level: f64) -> (f64, f64) {
        let config =
            RoadConfig::<T>::new(QuarterCar::paper_table_2(), T::lit(stiffness), T::lit(0.05)).unwrap();
        let model = Model::of(&config, T::lit(log_level));
        let mut recursion = Recursion::new(&model, T::lit(10.0));
        let (mut smallest, mut asymmetry) = (f64::MAX, 0.0_f64);
        for &(kind, body, wheel) in steps.iter().cycle().take(steps.len() * 40) {
            let (body, wheel) = (T::lit(f64::from(body) * 1e-2), T::lit(f64::from(wheel) * 1e-2));
            let step_s = T::lit([0.002, 0.002, 0.0013, 0.5][usize::from(kind % 4)]);
            recursion.predict(&model, step_s, (kind & 4 == 0).then_some(body));
            if kind & 8 == 0 {
                recursion.correct(model.body_row(), body, model.body_variance(step_s));
            }
            if kind & 16 == 0 {
                recursion.correct(model.wheel_row(), wheel, model.noise_variance);
            }
            assert!(recursion.is_sound());
            assert!(recursion.expected_variance_m2() > T::zero());
            let p = recursion.p.map(Real::to_f64);
            let scale = p.map_diagonal(f64::sqrt);
            let correlation =
                nalgebra::SMatrix::<f64, 9, 9>::from_fn(|i, j| p[(i, j)] / (scale[i] * scale[j]));
            smallest = smallest.min(correlation.symmetric_eigenvalues().min());
            asymmetry = asymmetry.max((correlation - correlation.transpose()).amax());
        }
        (smallest, asymmetry)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Whatever is measured or missing in whatever rhythm: symmetric to the bit, and positive semi-definite to the
        /// precision of the scalar (the correlation's eigenvalues sum to nine).
        #[test]
        fn the_covariance_stays_one(
            steps in prop::collection::vec((any::<u8>(), any::<i16>(), any::<i16>()), 1..20),
            stiffness in 6e4..4e5,
            // Up to the roughest class of ISO 8608 at 30 m/s; what is rougher restarts the filter where single precision does not hold it.
            log_level in -16.0..-1.5,
        ) {
            let (smallest, asymmetry) = check::<f64>(&steps, stiffness, log_level);
            prop_assert!(smallest > -1e-10 && asymmetry == 0.0, "{smallest} {asymmetry}");
            let (smallest, asymmetry) = check::<f32>(&steps, stiffness, log_level);
            prop_assert!(smallest > -1e-3 && asymmetry == 0.0, "{smallest} {asymmetry}");
        }
    }
}
