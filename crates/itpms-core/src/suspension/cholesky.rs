//! The Cholesky decomposition of a small matrix where it lies, with the operations of `nalgebra`'s in their order and so its bits, in a
//! third of the instructions: its views of rows and columns are set up anew for every pair of columns.

use nalgebra::SMatrix;

use crate::real::Real;

/// Makes of the lower triangle that of `L` with `L L'`, what is above the diagonal stays. False where a pivot is not positive.
#[must_use]
#[inline(never)]
pub(super) fn decompose<T: Real, const N: usize>(matrix: &mut SMatrix<T, N, N>) -> bool {
    let columns = &mut matrix.data.0;
    for j in 0..N {
        let (before, rest) = columns.split_at_mut(j);
        let Some(column) = rest.first_mut() else { return false };
        let Some(column) = column.get_mut(j..) else { return false };
        for earlier in before.iter() {
            let Some(earlier) = earlier.get(j..) else { return false };
            subtract(column, earlier);
        }
        let Some((pivot, below)) = column.split_first_mut() else { return false };
        if !(*pivot > T::zero()) {
            return false;
        }
        *pivot = pivot.sqrt();
        below.iter_mut().for_each(|value| *value /= *pivot);
    }
    true
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
    fn what_is_not_positive_is_refused() {
        let mut matrix = SMatrix::<f64, 3, 3>::identity();
        matrix[(2, 2)] = -1.0;
        assert!(!decompose(&mut matrix));
        assert!(!decompose(&mut SMatrix::<f64, 3, 3>::repeat(f64::NAN)));
        assert!(!decompose(&mut SMatrix::<f64, 3, 3>::repeat(1.0)));
    }
}
