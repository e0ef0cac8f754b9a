//! Both recursions written out with `nalgebra`'s static matrices, as one would do without a library for filters: no guards, no record.

use itpms_core::Real;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::peers::corner::{self, Corner};
use crate::peers::{Number, Peer};

/// What both hold.
#[derive(Debug, Clone)]
#[allow(non_snake_case)]
struct Kalman<T: Real, const N: usize> {
    corner: Corner<T>,
    x: SVector<T, N>,
    P: SMatrix<T, N, N>,
    Q: SMatrix<T, N, N>,
    R: Matrix2<T>,
}

impl<T: Real, const N: usize> Kalman<T, N> {
    fn fresh() -> Self {
        let [initial, process] = corner::variances::<T, N>();
        Self {
            corner: Corner::paper(),
            x: SVector::from(corner::start::<T, N>()),
            P: SMatrix::from_diagonal(&SVector::from(initial)),
            Q: SMatrix::from_diagonal(&SVector::from(process)),
            R: Matrix2::from_diagonal(&Vector2::from(corner::noise())),
        }
    }

    /// `A`, by rows.
    #[allow(non_snake_case)]
    #[inline]
    fn transition(&self, road: T) -> SMatrix<T, N, N> {
        let A = self.corner.transition::<N>(self.x.as_slice(), road);
        SMatrix::from_fn(|i, j| A[i][j])
    }

    #[allow(non_snake_case)]
    #[inline]
    fn observation(&self, road: T) -> SMatrix<T, 2, N> {
        let H = self.corner.rows::<N>(self.x.as_slice(), road);
        SMatrix::from_fn(|i, j| H[i][j])
    }

    #[inline]
    fn stepped(&self, road: T) -> SVector<T, N> {
        SVector::from(self.corner.stepped(&self.x.into(), road))
    }

    #[inline]
    fn expected(&self, road: T) -> Vector2<T> {
        Vector2::from(self.corner.accelerations(self.x.as_slice(), road))
    }
}

/// AEKF-UI with the one-step factor.
#[derive(Debug, Clone)]
#[allow(non_snake_case)]
pub struct Step<T: Real> {
    kalman: Kalman<T, 5>,
    u: T,
    lambda: T,
    G_1: Matrix2<T>,
    G_2: T,
}

impl<T: Real> Step<T> {
    /// `λ`, the last factor.
    pub fn lambda(&self) -> f64 {
        self.lambda.to_f64()
    }
}

impl<T: Number> Peer for Step<T> {
    type Scalar = T;

    fn fresh() -> Self {
        let (zero, one) = (T::zero(), T::one());
        Self { kalman: Kalman::fresh(), u: zero, lambda: one, G_1: Matrix2::zeros(), G_2: zero }
    }

    #[allow(non_snake_case)]
    #[inline]
    fn step(&mut self, measured: [T; 2]) {
        let (y, one) = (Vector2::from(measured), T::one());
        // (13), (7), (8)
        let A = self.kalman.transition(self.u);
        let F = A * self.kalman.P * A.transpose();
        self.kalman.x = self.kalman.stepped(self.u);
        let Kalman { Q, R, corner, x, .. } = &self.kalman;
        // (15), (19)
        let H = self.kalman.observation(self.u);
        let D = Vector2::new(T::zero(), corner.by_road(x.as_slice()));
        let z = y - self.kalman.expected(self.u);
        // (31)-(33)
        self.G_1 = self.G_1 / self.lambda + z * z.transpose();
        self.G_2 = self.G_2 / self.lambda + one;
        // (28)-(30)
        let M = H * F * H.transpose();
        let N = self.G_1 / self.G_2 - H * Q * H.transpose() - R;
        let wanted = N.trace() / M.trace();
        // (18), with the last factor
        let P = F * self.lambda + Q;
        self.lambda = if wanted > one { wanted } else { one };
        // (16), with R⁻¹(I - HK) = C⁻¹
        let PHt = P * H.transpose();
        let Some(C_inverse) = (H * PHt + R).try_inverse() else { return };
        let K = PHt * C_inverse;
        let weight = D.transpose() * C_inverse;
        let S = one / (weight * D).x;
        self.u += S * (weight * z).x;
        // (17): the Kalman filter's, and what it lacks for an input that had to be found
        let gained = K * D;
        let x = x + K * (y - self.kalman.expected(self.u));
        let P = P - K * (H * P) + gained * gained.transpose() * S;
        self.kalman.x = x;
        self.kalman.P = P;
    }

    fn found(&self) -> [f64; 6] {
        let [x_b, v_b, x_w, v_w, k_t] = self.kalman.x.into();
        [x_b, v_b, x_w, v_w, k_t, self.u].map(Real::to_f64)
    }
}

/// An ordinary EKF with the road as sixth state.
#[derive(Debug, Clone)]
pub struct Ordinary<T: Real>(Kalman<T, 6>);

impl<T: Number> Peer for Ordinary<T> {
    type Scalar = T;

    fn fresh() -> Self {
        Self(Kalman::fresh())
    }

    #[allow(non_snake_case)]
    #[inline]
    fn step(&mut self, measured: [T; 2]) {
        let kalman = &mut self.0;
        let A = kalman.transition(kalman.x[5]);
        let P = A * kalman.P * A.transpose() + kalman.Q;
        kalman.x = kalman.stepped(kalman.x[5]);
        let H = kalman.observation(kalman.x[5]);
        let z = Vector2::from(measured) - kalman.expected(kalman.x[5]);
        let PHt = P * H.transpose();
        let Some(C_inverse) = (H * PHt + kalman.R).try_inverse() else { return };
        let K = PHt * C_inverse;
        kalman.x += K * z;
        kalman.P = P - K * (H * P);
    }

    fn found(&self) -> [f64; 6] {
        let found: [T; 6] = self.0.x.into();
        found.map(Real::to_f64)
    }
}
