//! Both recursions on kfilter's `Kalman`: its `predict` and `update`, over a system and a measurement of one's own.

use itpms_core::Real;
use kfilter::kalman::{Kalman, KalmanFilter, KalmanPredict, KalmanPredictInput, KalmanUpdate};
use kfilter::measurement::{LinearisableMeasurement, Measurement};
use kfilter::system::{InputSystem, LinearisableSystem, NoInputSystem, System};
use nalgebra_of_kfilter::{SMatrix, SVector, Vector1};

use crate::peers::corner::{self, Corner, road_of};
use crate::peers::unknown_input::UnknownInput;
use crate::peers::{Number, Peer};

/// The corner as kfilter asks for it: what its own `NonLinearSystem` holds, and the car.
#[derive(Debug, Clone)]
#[allow(non_snake_case)]
struct CornerSystem<T: Number, const N: usize> {
    corner: Corner<T>,
    x: SVector<T, N>,
    Q: SMatrix<T, N, N>,
    F: SMatrix<T, N, N>,
    F_t: SMatrix<T, N, N>,
}

impl<T: Number, const N: usize> CornerSystem<T, N> {
    fn fresh() -> Self {
        let [_, process] = corner::variances::<T, N>();
        Self {
            corner: Corner::paper(),
            x: SVector::from(corner::start::<T, N>()),
            Q: SMatrix::from_diagonal(&SVector::from(process)),
            F: SMatrix::zeros(),
            F_t: SMatrix::zeros(),
        }
    }

    fn filter<const U: usize>() -> Kalman<T, N, U, Self> {
        let [initial, _] = corner::variances::<T, N>();
        Kalman::new_custom(Self::fresh(), SMatrix::from_diagonal(&SVector::from(initial)))
    }

    #[inline]
    fn go(&mut self, road: T) {
        let transition = self.corner.transition::<N>(self.x.as_slice(), road);
        self.F = SMatrix::from_fn(|i, j| transition[i][j]);
        self.F_t = self.F.transpose();
        self.x = SVector::from(self.corner.stepped(&self.x.into(), road));
    }
}

impl<T: Number, const N: usize, const U: usize> System<T, N, U> for CornerSystem<T, N> {
    fn covariance(&self) -> &SMatrix<T, N, N> {
        &self.Q
    }
    fn state(&self) -> &SVector<T, N> {
        &self.x
    }
    fn state_mut(&mut self) -> &mut SVector<T, N> {
        &mut self.x
    }
}

impl<T: Number, const N: usize, const U: usize> LinearisableSystem<T, N, U> for CornerSystem<T, N> {
    fn transition(&self) -> &SMatrix<T, N, N> {
        &self.F
    }
    fn transition_transpose(&self) -> &SMatrix<T, N, N> {
        &self.F_t
    }
}

impl<T: Number> InputSystem<T, 5, 1> for CornerSystem<T, 5> {
    fn step(&mut self, road: SVector<T, 1>) -> &SVector<T, 5> {
        self.go(road.x);
        &self.x
    }
    fn predict(&self, x: &SVector<T, 5>, road: &SVector<T, 1>) -> SVector<T, 5> {
        SVector::from(self.corner.stepped(&(*x).into(), road.x))
    }
}

impl<T: Number> NoInputSystem<T, 6> for CornerSystem<T, 6> {
    fn step(&mut self) -> &SVector<T, 6> {
        self.go(self.x[5]);
        &self.x
    }
    fn predict(&self, x: &SVector<T, 6>) -> SVector<T, 6> {
        SVector::from(self.corner.stepped(&(*x).into(), x[5]))
    }
}

/// Both accelerations.
#[derive(Debug, Clone)]
#[allow(non_snake_case)]
struct Accelerations<T: Number, const N: usize> {
    corner: Corner<T>,
    z: SVector<T, 2>,
    H: SMatrix<T, 2, N>,
    H_t: SMatrix<T, N, 2>,
    R: SMatrix<T, 2, 2>,
    /// Where it is not a state.
    road: T,
}

impl<T: Number, const N: usize> Accelerations<T, N> {
    fn fresh() -> Self {
        Self {
            corner: Corner::paper(),
            z: SVector::zeros(),
            H: SMatrix::zeros(),
            H_t: SMatrix::zeros(),
            R: SMatrix::from_diagonal(&SVector::from(corner::noise())),
            road: T::zero(),
        }
    }

    /// Linear about a state; `H`.
    #[inline]
    fn look(&mut self, x: &SVector<T, N>) -> [[T; N]; 2] {
        let rows = self.corner.rows::<N>(x.as_slice(), road_of(x.as_slice(), self.road));
        self.H = SMatrix::from_fn(|i, j| rows[i][j]);
        self.H_t = self.H.transpose();
        rows
    }
}

impl<T: Number, const N: usize> Measurement<T, N, 2> for Accelerations<T, N> {
    fn covariance(&self) -> &SMatrix<T, 2, 2> {
        &self.R
    }
    fn measurement(&self) -> &SVector<T, 2> {
        &self.z
    }
    fn set_measurement(&mut self, z: SVector<T, 2>) {
        self.z = z;
    }
    fn predict(&self, x: &SVector<T, N>) -> SVector<T, 2> {
        SVector::from(self.corner.accelerations(x.as_slice(), road_of(x.as_slice(), self.road)))
    }
}

impl<T: Number, const N: usize> LinearisableMeasurement<T, N, 2> for Accelerations<T, N> {
    fn observation(&self) -> &SMatrix<T, 2, N> {
        &self.H
    }
    fn observation_transpose(&self) -> &SMatrix<T, N, 2> {
        &self.H_t
    }
}

/// AEKF-UI with the one-step factor: kfilter predicts and corrects, the road is found in between.
#[derive(Debug, Clone)]
pub struct Step<T: Number> {
    filter: Kalman<T, 5, 1, CornerSystem<T, 5>>,
    measurement: Accelerations<T, 5>,
    input: UnknownInput<T>,
}

impl<T: Number> Peer for Step<T> {
    type Scalar = T;

    fn fresh() -> Self {
        Self {
            filter: CornerSystem::filter(),
            measurement: Accelerations::fresh(),
            input: UnknownInput::fresh(),
        }
    }

    #[inline]
    fn step(&mut self, measured: [T; 2]) {
        let Self { filter, measurement, input } = self;
        // (18): λ A P Aᵀ = A λP Aᵀ
        *filter.covariance_mut() *= input.lambda;
        let Ok(x) = filter.predict(Vector1::new(input.road)).copied() else { return };
        let rows = measurement.look(&x);
        measurement.set_measurement(SVector::from(measured));
        let z = measurement.z - measurement.predict(&x);
        let covariance = filter.covariance();
        let by_road = measurement.corner.by_road(x.as_slice());
        let found = input.find(|i, j| covariance[(i, j)], &rows, by_road, z.into());
        measurement.road = input.road;
        if filter.update(measurement).is_err() {
            return;
        }
        let gained = SVector::from(found.gained);
        *filter.covariance_mut() += gained * gained.transpose() * found.variance;
    }

    fn found(&self) -> [f64; 6] {
        let [x_b, v_b, x_w, v_w, k_t] = (*self.filter.state()).into();
        [x_b, v_b, x_w, v_w, k_t, self.input.road].map(Real::to_f64)
    }
}

/// An ordinary EKF with the road as sixth state.
#[derive(Debug, Clone)]
pub struct Ordinary<T: Number> {
    filter: Kalman<T, 6, 0, CornerSystem<T, 6>>,
    measurement: Accelerations<T, 6>,
}

impl<T: Number> Peer for Ordinary<T> {
    type Scalar = T;

    fn fresh() -> Self {
        Self { filter: CornerSystem::filter(), measurement: Accelerations::fresh() }
    }

    #[inline]
    fn step(&mut self, measured: [T; 2]) {
        let Ok(x) = self.filter.predict().copied() else { return };
        self.measurement.look(&x);
        self.measurement.set_measurement(SVector::from(measured));
        // An error leaves the prediction, which the comparison would see.
        let _ = self.filter.update(&self.measurement);
    }

    fn found(&self) -> [f64; 6] {
        let found: [T; 6] = (*self.filter.state()).into();
        found.map(Real::to_f64)
    }
}
