//! A symmetric 5x5 covariance in fifteen numbers, and its way through one step. Derivation: `docs/math/lean-aekf-ui.md`, sections 1 and 2.
//!
//! Called by [`crate::lean`]; knows nothing of the factor's choice or of divergence.

use nalgebra::Matrix5;

use crate::lean::jacobian::{AccelerationRows, StateVector};
use itpms_core::Real;

/// Upper triangle of a symmetric 5x5 matrix by rows: 00 01 02 03 04 11 12 13 14 22 23 24 33 34 44.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Covariance<T>([T; 15]);

/// Places of the diagonal in [`Covariance`].
const DIAGONAL: [usize; 5] = [0, 5, 9, 12, 14];

impl<T: Real> Covariance<T> {
    pub fn from_diagonal(variance: &StateVector<T>) -> Self {
        let mut packed = [T::zero(); 15];
        for (place, value) in DIAGONAL.into_iter().zip(variance) {
            packed[place] = *value;
        }
        Self(packed)
    }

    /// All 25 elements.
    pub fn to_matrix(&self) -> Matrix5<T> {
        let rows = self.rows();
        Matrix5::from_fn(|i, j| rows[i][j])
    }

    #[inline(always)]
    pub fn diagonal(&self) -> StateVector<T> {
        DIAGONAL.map(|place| self.0[place])
    }

    /// True if no element is NaN or infinite. A sum beyond the largest number counts as infinite.
    #[inline(always)]
    pub fn is_finite(&self) -> bool {
        // Opposite infinities add up to NaN.
        self.0.iter().fold(T::zero(), |sum, value| sum + *value).is_finite()
    }

    #[inline(always)]
    fn rows(&self) -> [StateVector<T>; 5] {
        let p = &self.0;
        [
            [p[0], p[1], p[2], p[3], p[4]],
            [p[1], p[5], p[6], p[7], p[8]],
            [p[2], p[6], p[9], p[10], p[11]],
            [p[3], p[7], p[10], p[12], p[13]],
            [p[4], p[8], p[11], p[13], p[14]],
        ]
    }

    /// `A P Aᵀ` for the Euler step of `dt_s` seconds; the rows must have been scaled by `dt_s`.
    #[inline(always)]
    pub fn propagated(&self, rows: &AccelerationRows<T>, dt_s: T) -> Self {
        // (56)  column j of AP is A times column j of P, row i of (AP)Aᵀ is A times row i of AP
        let [p_0, p_1, p_2, p_3, p_4] = self.rows();
        let c_0 = rows.step(&p_0, dt_s);
        let c_1 = rows.step(&p_1, dt_s);
        let c_2 = rows.step(&p_2, dt_s);
        let c_3 = rows.step(&p_3, dt_s);
        let c_4 = rows.step(&p_4, dt_s);
        let f_0 = rows.step(&[c_0[0], c_1[0], c_2[0], c_3[0], c_4[0]], dt_s);
        let f_1 = rows.step(&[c_0[1], c_1[1], c_2[1], c_3[1], c_4[1]], dt_s);
        let f_2 = rows.step(&[c_0[2], c_1[2], c_2[2], c_3[2], c_4[2]], dt_s);
        let f_3 = rows.step(&[c_0[3], c_1[3], c_2[3], c_3[3], c_4[3]], dt_s);
        let f_4 = c_4[4];
        Self([
            f_0[0], f_0[1], f_0[2], f_0[3], f_0[4], f_1[1], f_1[2], f_1[3], f_1[4], f_2[2], f_2[3], f_2[4],
            f_3[3], f_3[4], f_4,
        ])
    }

    /// `F h_0` and `F h_1`.
    #[inline(always)]
    pub fn times_acceleration_rows(&self, rows: &AccelerationRows<T>) -> [StateVector<T>; 2] {
        let products = self.rows().map(|row| rows.times(&row));
        [products.map(|[body, _]| body), products.map(|[_, wheel]| wheel)]
    }

    /// `F + Q` for the diagonal of `Q`.
    pub fn plus_diagonal(mut self, process_variance: &StateVector<T>) -> Self {
        for (place, value) in DIAGONAL.into_iter().zip(process_variance) {
            self.0[place] += *value;
        }
        self
    }

    /// `λ F + Q - k vᵀ` for a gain `k = v/c`, which makes it symmetric: prior and correction in one.
    #[inline(always)]
    pub fn updated(
        &self,
        lambda: T,
        process_variance: &StateVector<T>,
        k: &StateVector<T>,
        v: &StateVector<T>,
    ) -> Self {
        let (f, q) = (&self.0, process_variance);
        // (18)  P⁻ = λF + Q,  (61)  P⁺ = P⁻ - k vᵀ
        let of = |place: usize, i: usize, j: usize| lambda * f[place] - k[i] * v[j];
        let variance = |place: usize, i: usize| lambda * f[place] + q[i] - k[i] * v[i];
        Self([
            variance(0, 0),
            of(1, 0, 1),
            of(2, 0, 2),
            of(3, 0, 3),
            of(4, 0, 4),
            variance(5, 1),
            of(6, 1, 2),
            of(7, 1, 3),
            of(8, 1, 4),
            variance(9, 2),
            of(10, 2, 3),
            of(11, 2, 4),
            variance(12, 3),
            of(13, 3, 4),
            variance(14, 4),
        ])
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix5, Vector5};

    use super::*;
    use crate::lean::jacobian::Corner;
    use crate::quarter_car;
    use itpms_core::model::QuarterCar;

    fn packed(m: &Matrix5<f64>) -> Covariance<f64> {
        let mut values = [0.0; 15];
        let upper = (0..5).flat_map(|i| (i..5).map(move |j| (i, j)));
        values.iter_mut().zip(upper).for_each(|(value, at)| *value = m[at]);
        Covariance(values)
    }

    fn symmetric() -> Matrix5<f64> {
        let l = Matrix5::from_fn(|i, j| if j <= i { 1.0 / (2.0 + i as f64 - 0.7 * j as f64) } else { 0.0 });
        l * l.transpose()
    }

    #[test]
    fn packing_loses_nothing() {
        let p = symmetric();
        assert_eq!(packed(&p).to_matrix(), p);
        let variance = [1.0, 2.0, 3.0, 4.0, 5.0];
        let diagonal = Covariance::from_diagonal(&variance);
        assert_eq!(diagonal.to_matrix(), Matrix5::from_diagonal(&Vector5::from(variance)));
        assert_eq!(diagonal.diagonal(), variance);
    }

    #[test]
    fn a_step_is_that_of_full_matrices() {
        let car = QuarterCar::<f64>::paper_table_2();
        let (x, road, dt) = (Vector5::new(0.012, -0.21, -0.004, 0.35, 198_000.0), 0.007, 2e-3);
        let corner = Corner::new(&car);
        let p = symmetric();
        let a = Matrix5::identity() + quarter_car::derivative_jacobian(&car, &x, road) * dt;
        let full = a * p * a.transpose();
        let step = corner.acceleration_rows(&x.into(), road, dt);
        let found = packed(&p).propagated(&step, dt);
        assert!((found.to_matrix() - full).amax() < 1e-13 * full.amax());

        let rows = corner.acceleration_rows(&x.into(), road, 1.0);
        let seen = full * quarter_car::output_jacobian(&car, &x, road).transpose();
        let [f_0, f_1] = found.times_acceleration_rows(&rows);
        assert!((Vector5::from(f_0) - seen.column(0)).amax() < 1e-13 * seen.column(0).amax());
        assert!((Vector5::from(f_1) - seen.column(1)).amax() < 1e-13 * seen.column(1).amax());

        let q = [1.0, 2.0, 3.0, 4.0, 5.0];
        let prior = full * 1.7 + Matrix5::from_diagonal(&Vector5::from(q));
        let k = f_0.map(|value| value / 11.0);
        let reduced = prior - seen.column(0) * seen.column(0).transpose() / 11.0;
        assert!((found.updated(1.7, &q, &k, &f_0).to_matrix() - reduced).amax() < 1e-12 * reduced.amax());
        let predicted = full + Matrix5::from_diagonal(&Vector5::from(q));
        assert!((found.plus_diagonal(&q).to_matrix() - predicted).amax() < 1e-13 * predicted.amax());
    }

    #[test]
    fn what_is_not_finite_anywhere_is_seen() {
        for place in 0..15 {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut p = packed(&symmetric());
                assert!(p.is_finite());
                p.0[place] = bad;
                assert!(!p.is_finite());
            }
        }
    }
}
