//! The inverse of a small matrix, with the operations of `nalgebra`'s in their order and so its bits, but without its
//! checks of indices, which end in a panic as far as a compiler can see.

use core::ops::Range;

use nalgebra::SMatrix;

use crate::real::Real;

/// By LU with partial pivoting, where the matrix lies; `out` is the identity before. False for a singular matrix.
#[must_use]
pub(super) fn invert<T: Real, const N: usize>(lu: &mut SMatrix<T, N, N>, out: &mut SMatrix<T, N, N>) -> bool {
    for i in 0..N {
        let (mut pivot, mut largest) = (i, lu[(i, i)].abs());
        for row in i + 1..N {
            let size = lu[(row, i)].abs();
            if size > largest {
                (pivot, largest) = (row, size);
            }
        }
        let pivot = pivot.min(N - 1);
        if lu.get((pivot, i)).is_none_or(T::is_zero) {
            return false;
        }
        if pivot != i {
            for column in 0..N {
                (lu[(i, column)], lu[(pivot, column)]) = (lu[(pivot, column)], lu[(i, column)]);
                (out[(i, column)], out[(pivot, column)]) = (out[(pivot, column)], out[(i, column)]);
            }
        }
        let over = T::one() / lu[(i, i)];
        (i + 1..N).for_each(|row| lu[(row, i)] *= over);
        for column in i + 1..N {
            let by = -lu[(i, column)];
            let (pivots, columns) = lu.data.0.split_at_mut(i + 1);
            if let (Some(pivots), Some(columns)) = (pivots.last(), columns.get_mut(column - i - 1)) {
                add_scaled(columns, pivots, by, i + 1..N);
            }
        }
    }
    for column in 0..N {
        for i in 0..N {
            let by = -out[(i, column)];
            add_scaled(&mut out.data.0[column], &lu.data.0[i], by, i + 1..N);
        }
        for i in (0..N).rev() {
            if lu[(i, i)].is_zero() {
                return false;
            }
            let value = out[(i, column)] / lu[(i, i)];
            out[(i, column)] = value;
            add_scaled(&mut out.data.0[column], &lu.data.0[i], -value, 0..i);
        }
    }
    true
}

/// `to += by * from` in these rows.
#[inline(always)]
fn add_scaled<T: Real, const N: usize>(to: &mut [T; N], from: &[T; N], by: T, rows: Range<usize>) {
    let Some((to, from)) = to.get_mut(rows.clone()).zip(from.get(rows)) else { return };
    for (to, &from) in to.iter_mut().zip(from) {
        *to = by * from + *to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn inverse<T: Real, const N: usize>(mut matrix: SMatrix<T, N, N>) -> Option<SMatrix<T, N, N>> {
        let mut out = SMatrix::identity();
        invert(&mut matrix, &mut out).then_some(out)
    }

    fn compared<const N: usize>(random: &mut Random) {
        // Rows of very different size, so that pivots change places.
        let matrix =
            SMatrix::<f64, N, N>::from_fn(|row, _| random.normal() * 10f64.powi((row * 7 % 5) as i32));
        assert_eq!(inverse(matrix), matrix.try_inverse());
        let single = matrix.map(|value| value as f32);
        assert_eq!(inverse(single), single.try_inverse());
        let product = matrix * inverse(matrix).unwrap();
        assert!((product - SMatrix::identity()).amax() < 1e-8, "{product}");
    }

    #[test]
    fn it_has_the_bits_of_nalgebras() {
        let mut random = Random(1);
        for _ in 0..200 {
            compared::<13>(&mut random);
            compared::<6>(&mut random);
        }
    }

    #[test]
    fn what_has_no_inverse_gets_none() {
        assert_eq!(inverse(SMatrix::<f64, 6, 6>::zeros()), None);
        let mut twice = SMatrix::<f64, 6, 6>::identity();
        twice[(3, 3)] = 0.0;
        assert_eq!(inverse(twice), None);
    }
}
