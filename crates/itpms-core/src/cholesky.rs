//! The Cholesky decomposition of a small matrix where it lies, with the operations of `nalgebra`'s in their order and so its bits, in a
//! third of the instructions: its views of rows and columns are set up anew for every pair of columns.

use nalgebra::SMatrix;

use crate::real::Real;

/// Makes of the lower triangle that of `L` with `L L'`, what is above the diagonal stays. False where a pivot is not positive.
#[must_use]
pub(crate) fn decompose<T: Real, const N: usize>(matrix: &mut SMatrix<T, N, N>) -> bool {
    eliminate(matrix, T::zero())
}

/// Makes of a matrix that may be semidefinite the lower triangular root `L` with `L L'`: where a pivot is what rounding has left of the
/// diagonal, its column is zero.
pub(crate) fn root<T: Real, const N: usize>(matrix: &mut SMatrix<T, N, N>) {
    eliminate(matrix, T::whole((N * N) as u32) * T::epsilon());
    matrix.fill_upper_triangle(T::zero(), 1);
}

/// Columns whose pivot is at most `rounding` of the diagonal become zero; false if there are any.
#[inline(never)]
fn eliminate<T: Real, const N: usize>(matrix: &mut SMatrix<T, N, N>, rounding: T) -> bool {
    let (columns, mut is_definite) = (&mut matrix.data.0, true);
    for j in 0..N {
        let (before, rest) = columns.split_at_mut(j);
        let Some(column) = rest.first_mut().and_then(|column| column.get_mut(j..)) else { return false };
        let least = column.first().map_or(T::ZERO, |&diagonal| rounding * diagonal);
        for earlier in before.iter() {
            let Some(earlier) = earlier.get(j..) else { return false };
            subtract(column, earlier);
        }
        let Some((pivot, below)) = column.split_first_mut() else { return false };
        if *pivot > least {
            *pivot = pivot.sqrt();
            below.iter_mut().for_each(|value| *value /= *pivot);
        } else {
            column.fill(T::zero());
            is_definite = false;
        }
    }
    is_definite
}

/// `column -= earlier * earlier[0]`.
#[inline(never)]
fn subtract<T: Real>(column: &mut [T], earlier: &[T]) {
    let Some(&first) = earlier.first() else { return };
    let by = -first;
    for (value, &earlier) in column.iter_mut().zip(earlier) {
        *value += by * earlier;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn it_is_what_nalgebra_finds() {
        let mut random = Random(7);
        let root = SMatrix::<f64, 9, 9>::from_fn(|_, _| random.normal());
        let matrix = root * root.transpose();
        let mut found = matrix;
        assert!(decompose(&mut found));
        assert_eq!(found.lower_triangle(), matrix.cholesky().unwrap().l());
        let single = matrix.map(|value| value as f32);
        let mut found = single;
        assert!(decompose(&mut found));
        assert_eq!(found.lower_triangle(), single.cholesky().unwrap().l());
    }

    #[test]
    fn the_root_of_what_has_no_rank_has_zeros() {
        let mut random = Random(3);
        for _ in 0..100 {
            // Rank 5, rows of very different size.
            let of =
                SMatrix::<f64, 9, 5>::from_fn(|row, _| random.normal() * 10f64.powi((row * 7 % 5) as i32));
            let whole = of * of.transpose();
            let (mut double, mut single) = (whole, whole.map(|value| value as f32));
            root(&mut double);
            root(&mut single);
            let sizes = whole.diagonal().map(f64::sqrt);
            let off = |found: SMatrix<f64, 9, 9>| {
                (found * found.transpose() - whole).component_div(&(sizes * sizes.transpose())).amax()
            };
            // Small pivots before the end make the rounding larger.
            assert!(off(double) < 1e4 * f64::EPSILON, "{}", off(double));
            assert!(off(single.map(f64::from)) < 1e4 * f64::from(f32::EPSILON), "{single}");
        }
        let mut nothing = SMatrix::<f64, 3, 3>::repeat(f64::NAN);
        root(&mut nothing);
        assert_eq!(nothing, SMatrix::<f64, 3, 3>::zeros());
    }

    #[test]
    fn what_is_not_positive_is_refused() {
        let mut matrix = SMatrix::<f64, 3, 3>::identity();
        matrix[(2, 2)] = -1.0;
        assert!(!decompose(&mut matrix));
        assert!(!decompose(&mut SMatrix::<f64, 3, 3>::repeat(f64::NAN)));
        assert!(!decompose(&mut SMatrix::<f64, 3, 3>::repeat(1.0)));
    }
}
