//! The backward pass: what later samples say about an earlier road height (docs/math/road.md, section 4).
//!
//! A segment stands for some tens of milliseconds of forward filtering between two snapshots of it. Called by
//! [`crate::recorder`]; knows nothing of rows, time or delays.

use crate::filter::RoadFilter;
use crate::model::{CoreMatrix, CoreState, Transition, add_multiple, combine};
use crate::recursion::Correction;
use itpms_core::Real;

/// A stretch of the forward pass, condensed to what the backward pass needs: memory for [`crate::RoadRecorder`], about 120 numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Segment<T: Real> {
    /// Number of the row after which the snapshot was taken.
    pub(crate) first_row: u64,
    pub(crate) time_s: f64,
    /// Covariance of the height's expectation with the core states at the snapshot.
    road_covariance: CoreState<T>,
    /// The expectation less the filter's output, m, and the expectation's variance, m².
    offset_m: T,
    road_variance_m2: T,
    /// From an error of the state at the snapshot to the error at the segment's end (eq. 15), transposed.
    propagation: CoreMatrix<T>,
    /// Score of the snapshot from the segment's innovations (eq. 16).
    score: CoreState<T>,
    /// How much they can say (eq. 17).
    information: CoreMatrix<T>,
    /// Result: what to add to the road at the snapshot, m.
    pub(crate) correction_m: T,
    /// Result: variance of the smoothed road at the snapshot, m².
    pub(crate) variance_m2: T,
}

impl<T: Real> Default for Segment<T> {
    fn default() -> Self {
        Self {
            first_row: 0,
            time_s: 0.0,
            road_covariance: CoreState::zeros(),
            offset_m: T::zero(),
            road_variance_m2: T::zero(),
            propagation: CoreMatrix::identity(),
            score: CoreState::zeros(),
            information: CoreMatrix::zeros(),
            correction_m: T::zero(),
            variance_m2: T::zero(),
        }
    }
}

impl<T: Real> Segment<T> {
    /// A segment that begins with the filter as it is now, after row `first_row`.
    pub(crate) fn begin(first_row: u64, time_s: f64, filter: &RoadFilter<T>) -> Self {
        Self {
            first_row,
            time_s,
            road_covariance: filter.road_covariance(),
            offset_m: filter.expected_offset_m(),
            road_variance_m2: filter.expected_variance_m2(),
            ..Self::default()
        }
    }

    /// One more sample of the forward pass: the step taken (`None` after a restart) and its corrections in order.
    pub(crate) fn extend(
        &mut self,
        transition: Option<&Transition<T>>,
        corrections: &[Option<Correction<T>>; 2],
    ) {
        self.propagation = match transition {
            Some(transition) => transition.apply_to_core_from_right(&self.propagation),
            // Nothing later says anything about what was before a restart.
            None => CoreMatrix::zeros(),
        };
        for c in corrections.iter().flatten() {
            let seen = combine(&self.propagation.data.0, &c.row);
            add_multiple(&mut self.score.data.0[0], c.innovation / c.variance, &seen);
            for (column, &from) in self.information.data.0.iter_mut().zip(&seen) {
                add_multiple(column, from / c.variance, &seen);
            }
            for (column, &gain) in self.propagation.data.0.iter_mut().zip(&c.gain.data.0[0]) {
                add_multiple(column, -gain, &seen);
            }
        }
    }

    /// Takes what all later segments say, adds what this one says, and draws the conclusion for its snapshot.
    pub(crate) fn conclude(&mut self, later: &Later<T>) -> Later<T> {
        let all = Later {
            score: self.score + self.propagation * later.score,
            information: self.information
                + self.propagation * (later.information * self.propagation.transpose()),
        };
        let c = &self.road_covariance;
        self.correction_m = self.offset_m + c.dot(&all.score);
        let explained = c.dot(&(all.information * c));
        self.variance_m2 = (self.road_variance_m2 - explained).max(T::zero());
        all
    }
}

/// The later samples' score and information of the state's error at a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Later<T: Real> {
    score: CoreState<T>,
    information: CoreMatrix<T>,
}

impl<T: Real> Later<T> {
    /// No later samples.
    pub(crate) fn nothing() -> Self {
        Self { score: CoreState::zeros(), information: CoreMatrix::zeros() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::RoadLevel;
    use crate::model::{CORE, Matrix, Model, State, state};
    use crate::{RoadConfig, RoadFilter};
    use itpms_core::model::{CornerSample, QuarterCar};
    use nalgebra::{SMatrix, SVector};

    const SAMPLES: usize = 20;
    const VALUES: usize = 2 * SAMPLES;
    const STEP_S: f64 = 0.002;

    fn config() -> RoadConfig<f64> {
        // A body believed to the letter, so that its acceleration is a measurement only and all is jointly normal;
        // offsets and low cut such that so short a record says something about the height.
        RoadConfig::new(QuarterCar::paper_table_2(), 233_000.0, 0.05)
            .and_then(|c| c.with_level(RoadLevel::Fixed(-8.0)))
            .and_then(|c| c.with_body_mismatch(0.0))
            .and_then(|c| c.with_bias(0.1, 3e-4))
            .and_then(|c| c.with_low_cut_hz(1.0))
            .unwrap()
    }

    /// Mean and variance of the height at every sample, given all measurements, by one dense solution of the joint normal distribution.
    fn dense(y: &SVector<f64, VALUES>) -> ([f64; SAMPLES], [f64; SAMPLES]) {
        let model = Model::of(&config(), -8.0);
        let step = model.free(STEP_S);
        let mut p = *model.free(10.0 / model.low_cut_rad_per_s).noise();
        for i in [state::BODY_BIAS, state::WHEEL_BIAS] {
            p.fill_row(i, 0.0);
            p.fill_column(i, 0.0);
            p[(i, i)] = 0.01;
        }
        let mut h = SMatrix::<f64, 2, 9>::zeros();
        h.fixed_view_mut::<1, CORE>(0, 0).copy_from(&model.body_row().transpose());
        h.fixed_view_mut::<1, CORE>(1, 0).copy_from(&model.wheel_row().transpose());
        // lagged[k] = Cov(x_(j+k), x_j) for the j at hand.
        let mut of_y = SMatrix::<f64, VALUES, VALUES>::zeros();
        let mut of_height = SMatrix::<f64, SAMPLES, VALUES>::zeros();
        let mut prior = [0.0; SAMPLES];
        for (j, prior) in prior.iter_mut().enumerate() {
            *prior = p[(state::ROAD, state::ROAD)];
            let mut lagged: Matrix<f64> = p;
            for k in j..SAMPLES {
                let block = h * lagged * h.transpose();
                of_y.fixed_view_mut::<2, 2>(2 * k, 2 * j).copy_from(&block);
                of_y.fixed_view_mut::<2, 2>(2 * j, 2 * k).copy_from(&block.transpose());
                let later_height: State<f64> = lagged.row(state::ROAD).transpose();
                let earlier_height: State<f64> = lagged.column(state::ROAD).into_owned();
                of_height.fixed_view_mut::<1, 2>(k, 2 * j).copy_from(&(h * later_height).transpose());
                of_height.fixed_view_mut::<1, 2>(j, 2 * k).copy_from(&(h * earlier_height).transpose());
                lagged = step.apply(&lagged);
            }
            p = step.covariance(&p);
        }
        of_y += SMatrix::<f64, VALUES, VALUES>::identity() * 0.0025;
        let solved = of_y.cholesky().unwrap();
        let mean = of_height * solved.solve(y);
        let explained = of_height * solved.solve(&of_height.transpose());
        (core::array::from_fn(|i| mean[i]), core::array::from_fn(|i| prior[i] - explained[(i, i)]))
    }

    #[test]
    fn forward_and_backward_together_are_the_dense_solution() {
        let y = SVector::<f64, VALUES>::from_fn(|i, _| {
            3.0 * (i as f64 * 0.7).sin() + ((i * i) as f64 * 0.3).cos()
        });
        let (mean, variance) = dense(&y);
        let mut filter = RoadFilter::new(&config());
        let mut segments = [Segment::default(); SAMPLES];
        let mut forward = [0.0; SAMPLES];
        let mut begun = 0;
        for i in 0..SAMPLES {
            let sample = CornerSample { body_accel_m_s2: y[2 * i], wheel_accel_m_s2: y[2 * i + 1] };
            let advance = filter.advance(i as f64 * STEP_S, &sample);
            if begun > 0 {
                let transition = advance.step.and_then(|step| filter.transition(step));
                segments[begun - 1].extend(transition, &advance.corrections);
            }
            forward[i] = filter.road_m();
            // Segments of one, two, three samples in turn.
            if [0, 1, 3, 6, 7, 9, 12, 13, 15, 18].contains(&i) {
                segments[begun] = Segment::begin(i as u64, 0.0, &filter);
                begun += 1;
            }
        }
        let mut later = Later::nothing();
        for segment in segments[..begun].iter_mut().rev() {
            later = segment.conclude(&later);
            let i = segment.first_row as usize;
            let height = forward[i] + segment.correction_m;
            assert!((height - mean[i]).abs() < 1e-9, "{i}: {height} {}", mean[i]);
            assert!((segment.variance_m2 / variance[i] - 1.0).abs() < 1e-6, "{i}");
        }
        // And it is not all for nothing: the later samples do correct the forward height.
        assert!(segments[..begun].iter().any(|s| s.correction_m.abs() > 1e-5));
    }
}
