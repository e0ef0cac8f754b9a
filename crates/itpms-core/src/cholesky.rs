//! The Cholesky decomposition of a small matrix where it lies, with the operations of `nalgebra`'s in their order and so its bits, in a
//! third of the instructions: its views of rows and columns are set up anew for every pair of columns.

use nalgebra::{SMatrix, SVector};

use crate::real::Real;

/// Makes of the lower triangle that of `L` with `L L'`, what is above the diagonal stays. False where a pivot is not positive.
#[must_use]
pub(crate) fn decompose<T: Real, const N: usize>(matrix: &mut SMatrix<T, N, N>) -> bool {
    eliminate::<T, N>(matrix.as_mut_slice(), whole::<N>, T::zero())
}

/// The same of a lower triangle that is packed by columns.
#[must_use]
pub(crate) fn decompose_packed<T: Real, const N: usize>(lower: &mut [T]) -> bool {
    eliminate::<T, N>(lower, packed::<N>, T::zero())
}

/// Makes of a matrix that may be semidefinite the lower triangular root `L` with `L L'`: where a pivot is what rounding has left of the
/// diagonal, its column is zero.
pub(crate) fn root<T: Real, const N: usize>(matrix: &mut SMatrix<T, N, N>) {
    eliminate::<T, N>(matrix.as_mut_slice(), whole::<N>, T::whole((N * N) as u32) * T::epsilon());
    matrix.fill_upper_triangle(T::zero(), 1);
}

/// `L^-1 b` for the lower triangle of a matrix.
pub(crate) fn solve<T: Real, const N: usize>(lower: &SMatrix<T, N, N>, b: &SVector<T, N>) -> SVector<T, N> {
    let mut solved = *b;
    substitute(lower.as_slice(), whole::<N>, &mut solved);
    solved
}

/// The same of a packed one, in place.
pub(crate) fn solve_packed<T: Real, const N: usize>(lower: &[T], b: &mut SVector<T, N>) {
    substitute(lower, packed::<N>, b);
}

/// `L'^-1 b` for a packed `L`, in place.
#[inline(never)]
pub(crate) fn solve_packed_transposed<T: Real, const N: usize>(lower: &[T], b: &mut SVector<T, N>) {
    for k in (0..N).rev() {
        let Some((value, below)) = b.as_mut_slice().get_mut(k..).and_then(<[T]>::split_first_mut) else {
            return;
        };
        let Some((&pivot, column)) = lower.get(packed::<N>(k, k)..).and_then(<[T]>::split_first) else {
            return;
        };
        *value = below.iter().zip(column).fold(*value, |sum, (&below, &by)| sum - by * below) / pivot;
    }
}

/// Where an entry is in memory, by row and column: of a whole matrix, and of a packed lower triangle.
fn whole<const N: usize>(row: usize, column: usize) -> usize {
    column * N + row
}

pub(crate) fn packed<const N: usize>(row: usize, column: usize) -> usize {
    let at = column * (2 * N - 1).saturating_sub(column) / 2 + row;
    at.min((N * (N + 1) / 2).saturating_sub(1))
}

/// Columns whose pivot is at most `rounding` of the diagonal become zero; false if there are any.
#[inline(never)]
fn eliminate<T: Real, const N: usize>(values: &mut [T], at: fn(usize, usize) -> usize, rounding: T) -> bool {
    let mut is_definite = true;
    for j in 0..N {
        let Some((before, rest)) = values.split_at_mut_checked(at(j, j)) else { return false };
        let Some(column) = rest.get_mut(..N - j) else { return false };
        let least = column.first().map_or(T::ZERO, |&diagonal| rounding * diagonal);
        for k in 0..j {
            let Some(earlier) = before.get(at(j, k)..at(j, k) + column.len()) else { return false };
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

#[inline(never)]
fn substitute<T: Real, const N: usize>(lower: &[T], at: fn(usize, usize) -> usize, b: &mut SVector<T, N>) {
    for k in 0..N {
        let Some((value, below)) = b.as_mut_slice().get_mut(k..).and_then(<[T]>::split_first_mut) else {
            return;
        };
        let Some((&pivot, column)) = lower.get(at(k, k)..).and_then(<[T]>::split_first) else { return };
        if *value != T::zero() {
            *value /= pivot;
            below.iter_mut().zip(column).for_each(|(below, &by)| *below -= by * *value);
        }
    }
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
        let l = matrix.cholesky().unwrap().l();
        assert_eq!(found.lower_triangle(), l);
        let b = SVector::from_fn(|_, _| random.normal());
        assert!((l * solve(&found, &b) - b).amax() < 1e-12);
        let columns = matrix.column_iter().enumerate();
        let mut values = columns.flat_map(|(i, column)| column.into_iter().skip(i).copied());
        let mut lower: [f64; 45] = core::array::from_fn(|_| values.next().unwrap());
        assert!(decompose_packed::<_, 9>(&mut lower));
        let (mut solved, mut transposed) = (b, b);
        solve_packed(&lower, &mut solved);
        solve_packed_transposed(&lower, &mut transposed);
        assert_eq!(solved, solve(&found, &b));
        assert!((l.transpose() * transposed - b).amax() < 1e-12);
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
