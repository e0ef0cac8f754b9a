//! Both recursions on minikalman's extended filter, in buffers on the stack: its `predict_nonlinear` and `correct_nonlinear`.

use itpms_core::Real;
use minikalman::buffers::types::{
    DirectProcessNoiseCovarianceMatrixBuffer, EstimateCovarianceMatrixBuffer,
    InnovationCovarianceMatrixBuffer, InnovationVectorBuffer, KalmanGainMatrixBuffer,
    MeasurementNoiseCovarianceMatrixBuffer, MeasurementVectorBuffer, ObservationMatrixMutBuffer,
    PredictedStateEstimateVectorBuffer, StateTransitionMatrixMutBuffer, StateVectorBuffer,
    TemporaryHPMatrixBuffer, TemporaryKHPMatrixBuffer, TemporaryPHTMatrixBuffer,
    TemporaryResidualCovarianceInvertedMatrixBuffer, TemporaryStateMatrixBuffer,
};
use minikalman::extended::{
    ExtendedKalman, ExtendedKalmanBuilder, ExtendedObservation, ExtendedObservationBuilder,
};
use minikalman::matrix::MatrixDataArray;
use minikalman::prelude::*;

use crate::peers::corner::{self, Corner, road_of};
use crate::peers::unknown_input::UnknownInput;
use crate::peers::{Number, Peer};

type Array<T, const ROWS: usize, const COLUMNS: usize, const ALL: usize> =
    MatrixDataArray<ROWS, COLUMNS, ALL, T>;

/// A filter of `N` states, `NN` the square of that.
type Filter<T, const N: usize, const NN: usize> = ExtendedKalman<
    N,
    T,
    StateTransitionMatrixMutBuffer<N, T, Array<T, N, N, NN>>,
    StateVectorBuffer<N, T, Array<T, N, 1, N>>,
    EstimateCovarianceMatrixBuffer<N, T, Array<T, N, N, NN>>,
    DirectProcessNoiseCovarianceMatrixBuffer<N, T, Array<T, N, N, NN>>,
    PredictedStateEstimateVectorBuffer<N, T, Array<T, N, 1, N>>,
    TemporaryStateMatrixBuffer<N, T, Array<T, N, N, NN>>,
>;

/// Two accelerations of `N` states, `M` twice that.
type Accelerations<T, const N: usize, const NN: usize, const M: usize> = ExtendedObservation<
    N,
    2,
    T,
    ObservationMatrixMutBuffer<2, N, T, Array<T, 2, N, M>>,
    MeasurementVectorBuffer<2, T, Array<T, 2, 1, 2>>,
    MeasurementNoiseCovarianceMatrixBuffer<2, T, Array<T, 2, 2, 4>>,
    InnovationVectorBuffer<2, T, Array<T, 2, 1, 2>>,
    InnovationCovarianceMatrixBuffer<2, T, Array<T, 2, 2, 4>>,
    KalmanGainMatrixBuffer<N, 2, T, Array<T, N, 2, M>>,
    TemporaryResidualCovarianceInvertedMatrixBuffer<2, T, Array<T, 2, 2, 4>>,
    TemporaryHPMatrixBuffer<2, N, T, Array<T, 2, N, M>>,
    TemporaryPHTMatrixBuffer<N, 2, T, Array<T, N, 2, M>>,
    TemporaryKHPMatrixBuffer<N, T, Array<T, N, N, NN>>,
>;

struct Extended<T: Number, const N: usize, const NN: usize, const M: usize> {
    corner: Corner<T>,
    filter: Filter<T, N, NN>,
    measurement: Accelerations<T, N, NN, M>,
}

impl<T: Number, const N: usize, const NN: usize, const M: usize> Extended<T, N, NN, M> {
    fn fresh() -> Self {
        let zero = T::zero();
        let [initial, process] = corner::variances::<T, N>();
        let diagonal = |of: [T; N]| core::array::from_fn(|k| if k / N == k % N { of[k / N] } else { zero });
        let [r_0, r_1] = corner::noise();
        let square: [T; NN] = [zero; NN];
        let wide: [T; M] = [zero; M];
        Self {
            corner: Corner::paper(),
            filter: ExtendedKalmanBuilder::new::<N, T>(
                square.into(),
                corner::start::<T, N>().into(),
                diagonal(initial).into(),
                diagonal(process).into(),
                [zero; N].into(),
                square.into(),
            ),
            measurement: ExtendedObservationBuilder::new::<N, 2, T>(
                wide.into(),
                [zero; 2].into(),
                [r_0, zero, zero, r_1].into(),
                [zero; 2].into(),
                [zero; 4].into(),
                wide.into(),
                [zero; 4].into(),
                wide.into(),
                wide.into(),
                square.into(),
            ),
        }
    }

    #[inline]
    fn state(&self) -> [T; N] {
        let x = self.filter.state_vector();
        core::array::from_fn(|i| x[i])
    }

    /// Predicts, and makes the measurement linear about the prediction: `H`.
    #[inline]
    fn predict(&mut self, found: T) -> [[T; N]; 2] {
        let (corner, x) = (self.corner, self.state());
        let road = road_of(&x, found);
        let transition = corner.transition::<N>(&x, road);
        let jacobian = self.filter.state_transition_jacobian_mut().as_mut_slice();
        for (to, row) in jacobian.chunks_exact_mut(N).zip(&transition) {
            to.copy_from_slice(row);
        }
        let stepped = corner.stepped(&x, road);
        self.filter.predict_nonlinear(|_, next| next.as_mut_slice().copy_from_slice(&stepped));
        let x = self.state();
        let rows = corner.rows::<N>(&x, road_of(&x, found));
        let jacobian = self.measurement.observation_jacobian_matrix_mut().as_mut_slice();
        for (to, row) in jacobian.chunks_exact_mut(N).zip(&rows) {
            to.copy_from_slice(row);
        }
        rows
    }

    #[inline]
    fn correct(&mut self, measured: [T; 2], found: T) {
        let corner = self.corner;
        self.measurement.measurement_vector_mut().as_mut_slice().copy_from_slice(&measured);
        self.filter.correct_nonlinear(&mut self.measurement, |x, expected| {
            let x = x.as_slice();
            expected.as_mut_slice().copy_from_slice(&corner.accelerations(x, road_of(x, found)));
        });
    }
}

/// AEKF-UI with the one-step factor: minikalman predicts and corrects, the road is found in between.
pub struct Step<T: Number> {
    extended: Extended<T, 5, 25, 10>,
    input: UnknownInput<T>,
}

impl<T: Number> Peer for Step<T> {
    type Scalar = T;

    fn fresh() -> Self {
        Self { extended: Extended::fresh(), input: UnknownInput::fresh() }
    }

    #[inline]
    fn step(&mut self, measured: [T; 2]) {
        let Self { extended, input } = self;
        // (18): λ A P Aᵀ = A λP Aᵀ
        for value in extended.filter.estimate_covariance_mut().as_mut_slice() {
            *value *= input.lambda;
        }
        let rows = extended.predict(input.road);
        let x = extended.state();
        let [body, wheel] = extended.corner.accelerations(&x, input.road);
        let z = [measured[0] - body, measured[1] - wheel];
        let covariance = extended.filter.estimate_covariance().as_slice();
        let found = input.find(|i, j| covariance[5 * i + j], &rows, extended.corner.by_road(&x), z);
        extended.correct(measured, input.road);
        let covariance = extended.filter.estimate_covariance_mut().as_mut_slice();
        for (row, by) in covariance.chunks_exact_mut(5).zip(found.gained) {
            for (value, gained) in row.iter_mut().zip(found.gained) {
                *value += by * gained * found.variance;
            }
        }
    }

    fn found(&self) -> [f64; 6] {
        let [x_b, v_b, x_w, v_w, k_t] = self.extended.state();
        [x_b, v_b, x_w, v_w, k_t, self.input.road].map(Real::to_f64)
    }
}

/// An ordinary EKF with the road as sixth state.
pub struct Ordinary<T: Number>(Extended<T, 6, 36, 12>);

impl<T: Number> Peer for Ordinary<T> {
    type Scalar = T;

    fn fresh() -> Self {
        Self(Extended::fresh())
    }

    #[inline]
    fn step(&mut self, measured: [T; 2]) {
        self.0.predict(T::zero());
        self.0.correct(measured, T::zero());
    }

    fn found(&self) -> [f64; 6] {
        self.0.state().map(Real::to_f64)
    }
}
