//! Covariance of the belief's quantities, of which every entry is there once.
//!
//! A symmetric matrix of odd size has each pair of quantities at exactly one distance of at most half the size, if quantities are taken
//! to lie on a circle: so its wrapped diagonals, `(i, i + d mod n)` for `d` from 0 to `(n - 1) / 2`, hold every entry once, and each of them
//! is as long as the state. What is done to all entries runs along them in two pieces, before and behind the place where they wrap.

use core::ops::{Index, IndexMut, Range};

use nalgebra::SMatrix;

use super::state::{SIZE, State};
use crate::memory::Blank;
use crate::real::Real;

/// Wrapped diagonals.
const DIAGONALS: usize = SIZE / 2 + 1;
const _: () = assert!(SIZE % 2 == 1, "with an even size half a diagonal would be there twice");

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Covariance<T: Real> {
    /// A diagonal a column.
    diagonals: SMatrix<T, SIZE, DIAGONALS>,
}

/// Rows and columns of the entries of a diagonal, of the first `size` quantities.
fn pieces(diagonal: usize, size: usize) -> [[Range<usize>; 2]; 2] {
    let left_out = SIZE.saturating_sub(size);
    [
        [0..size.saturating_sub(diagonal), diagonal..size],
        [SIZE.saturating_sub(diagonal)..size, 0..diagonal.saturating_sub(left_out)],
    ]
}

/// Where an entry is: its place on its diagonal, and which one that is.
fn place((i, j): (usize, usize)) -> (usize, usize) {
    let distance = if j >= i { j - i } else { j + SIZE - i };
    let (from, diagonal) = if distance < DIAGONALS { (i, distance) } else { (j, SIZE - distance) };
    (from.min(SIZE - 1), diagonal.min(DIAGONALS - 1))
}

impl<T: Real> Index<(usize, usize)> for Covariance<T> {
    type Output = T;

    fn index(&self, at: (usize, usize)) -> &T {
        &self.diagonals[place(at)]
    }
}

/// An entry and the one across the diagonal are the same.
impl<T: Real> IndexMut<(usize, usize)> for Covariance<T> {
    fn index_mut(&mut self, at: (usize, usize)) -> &mut T {
        &mut self.diagonals[place(at)]
    }
}

impl<T: Real> Covariance<T> {
    /// Nothing goes with anything, and nothing varies.
    pub(crate) fn clear(&mut self) {
        self.diagonals.fill(T::zero());
    }

    /// What another one is.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.diagonals.copy_from(&other.diagonals);
    }

    pub(crate) fn variances(&self) -> State<T> {
        self.diagonals.column(0).into_owned()
    }

    pub(crate) fn set_variances(&mut self, variances: &State<T>) {
        self.diagonals.set_column(0, variances);
    }

    pub(crate) fn column(&self, of: usize) -> State<T> {
        let mut column = State::zeros();
        self.add_column(of, T::one(), &mut column);
        column
    }

    /// Adds the covariances of one quantity with all, so many times.
    pub(crate) fn add_column(&self, of: usize, times: T, sum: &mut State<T>) {
        self.for_each_of(of, |other, covariance| {
            if let Some(sum) = sum.get_mut(other) {
                *sum += times * covariance;
            }
        });
    }

    /// Shows the covariances of one quantity with all, each with the other quantity.
    #[inline(always)]
    pub(crate) fn for_each_of(&self, of: usize, mut show: impl FnMut(usize, T)) {
        for (distance, diagonal) in self.diagonals.data.0.iter().enumerate() {
            let ahead = if of + distance < SIZE { of + distance } else { of + distance - SIZE };
            if let Some(&covariance) = diagonal.get(of) {
                show(ahead, covariance);
            }
            let behind = if of >= distance { of - distance } else { of + SIZE - distance };
            if distance > 0
                && let Some(&covariance) = diagonal.get(behind)
            {
                show(behind, covariance);
            }
        }
    }

    /// Nothing goes with one quantity any more; its variance is this.
    pub(crate) fn isolate(&mut self, at: usize, variance: T) {
        (0..SIZE).for_each(|i| self[(i, at)] = T::zero());
        self[(at, at)] = variance;
    }

    /// Changes every entry of the first `size` quantities, given the values that belong to its row and to its column.
    fn change(&mut self, size: usize, by: [&State<T>; 2], mut change: impl FnMut(&mut T, T, T)) {
        let [by_row, by_column] = by.map(|by| by.as_slice());
        for (distance, diagonal) in self.diagonals.data.0.iter_mut().enumerate() {
            for [rows, columns] in pieces(distance, size) {
                let values = (diagonal.get_mut(rows.clone()), by_row.get(rows), by_column.get(columns));
                let (Some(entries), Some(by_row), Some(by_column)) = values else { continue };
                for ((entry, &row), &column) in entries.iter_mut().zip(by_row).zip(by_column) {
                    change(entry, row, column);
                }
            }
        }
    }

    /// Quantities that follow one another have so much more in common, as a variance that is in each one's already.
    pub(crate) fn add_in_common(&mut self, quantities: Range<usize>, variance: T) {
        for i in quantities.clone() {
            (quantities.start..i).for_each(|j| self[(i, j)] += variance);
        }
    }

    /// One quantity becomes this share of itself.
    pub(crate) fn shrink_one(&mut self, at: usize, share: T) {
        (0..SIZE).for_each(|other| self[(at, other)] *= share);
        self[(at, at)] *= share;
    }

    /// Each quantity becomes this share of itself.
    pub(crate) fn shrink(&mut self, share: &State<T>) {
        self.change(SIZE, [share, share], |entry, row, column| *entry *= row * column);
    }

    /// Adds `times direction direction^T`.
    pub(crate) fn add_product(&mut self, times: T, direction: &State<T>) {
        let scaled = direction * times;
        self.change(SIZE, [&scaled, direction], |entry, row, column| *entry += row * column);
    }

    /// The entries of the first `size` quantities become these shares of themselves, of another's and of `direction direction^T`.
    pub(crate) fn join(&mut self, size: usize, shares: [T; 3], other: &Self, direction: &State<T>) {
        let (of, [own, others, between]) = (direction.as_slice(), shares);
        let both = self.diagonals.data.0.iter_mut().zip(&other.diagonals.data.0);
        for (distance, (diagonal, other)) in both.enumerate() {
            for [rows, columns] in pieces(distance, size) {
                let values =
                    (diagonal.get_mut(rows.clone()), other.get(rows.clone()), of.get(rows), of.get(columns));
                let (Some(entries), Some(joined), Some(by_row), Some(by_column)) = values else { continue };
                let by = by_row.iter().zip(by_column);
                for ((entry, &joined), (&row, &column)) in entries.iter_mut().zip(joined).zip(by) {
                    *entry = own * *entry + others * joined + between * row * column;
                }
            }
        }
    }

    /// Takes off `B B'`, given the rows of `B`: of each with itself and with those that follow it up to half the way round.
    pub(crate) fn take_off<const N: usize>(&mut self, rows: &[[T; N]; SIZE]) {
        for (i, row) in rows.iter().enumerate() {
            let (wrapped, ahead) = rows.split_at(i);
            let (near, far) = self.diagonals.data.0.split_at_mut(ahead.len().min(DIAGONALS));
            take_products_off(near, i, row, ahead);
            take_products_off(far, i, row, wrapped);
        }
    }

    /// No variance is negative, as rounding may make one that is nearly zero.
    pub(crate) fn hold_variances(&mut self) {
        self.diagonals.column_mut(0).apply(|variance| *variance = variance.max(T::zero()));
    }
}

/// Takes off the products of a row, which is the `i`-th, with others: one a diagonal.
#[inline(always)]
fn take_products_off<T: Real, const N: usize>(
    diagonals: &mut [[T; SIZE]],
    i: usize,
    row: &[T; N],
    others: &[[T; N]],
) {
    for (diagonal, other) in diagonals.iter_mut().zip(others) {
        if let Some(entry) = diagonal.get_mut(i) {
            *entry -= product(row, other);
        }
    }
}

/// Of a length that the compiler knows: it keeps the first one in registers.
#[inline(always)]
pub(super) fn product<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (&a, &b)| sum + a * b)
}

#[cfg(test)]
impl Covariance<f64> {
    pub(crate) fn dense(&self) -> SMatrix<f64, SIZE, SIZE> {
        SMatrix::from_fn(|i, j| self[(i, j)])
    }

    pub(crate) fn of(dense: &SMatrix<f64, SIZE, SIZE>) -> Self {
        Self { diagonals: SMatrix::from_fn(|i, d| dense[(i, (i + d) % SIZE)]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Dense = SMatrix<f64, SIZE, SIZE>;

    fn dense(seed: usize) -> Dense {
        let any = Dense::from_fn(|i, j| (((seed + 7 * i + 3 * j + i * j) % 23) as f64 - 11.0) / 10.0);
        any + any.transpose()
    }

    fn state(seed: usize) -> State<f64> {
        State::from_fn(|i, _| (((seed + 5 * i) % 17) as f64 - 8.0) / 10.0)
    }

    /// Every operation against the same of the matrix with all its entries.
    #[test]
    fn all_is_as_of_the_whole_matrix() {
        let (a, b, v) = (dense(1), dense(4), state(2));
        let packed = |dense: &Dense| Covariance::of(dense);
        assert_eq!(packed(&a).dense(), a);
        for i in 0..SIZE {
            assert_eq!(packed(&a).column(i), a.column(i));
        }
        let near = |found: &Covariance<f64>, expected: &Dense| {
            assert!((found.dense() - expected).amax() < 1e-12);
        };
        let mut c = packed(&a);
        c.shrink(&v);
        near(&c, &(Dense::from_diagonal(&v) * a * Dense::from_diagonal(&v)));
        let mut c = packed(&a);
        c.add_product(-0.3, &v);
        near(&c, &(a - v * v.transpose() * 0.3));
        let mut c = packed(&a);
        c.isolate(5, 0.7);
        let expected = Dense::from_fn(|i, j| match (i == 5, j == 5) {
            (true, true) => 0.7,
            (false, false) => a[(i, j)],
            _ => 0.0,
        });
        near(&c, &expected);
        for size in [SIZE, SIZE - 1] {
            let mut c = packed(&a);
            c.join(size, [0.6, 0.4, 0.3], &packed(&b), &v);
            let whole = a * 0.6 + b * 0.4 + v * v.transpose() * 0.3;
            near(&c, &Dense::from_fn(|i, j| if i.max(j) < size { whole[(i, j)] } else { a[(i, j)] }));
        }
        let mut c = packed(&a);
        c.take_off(&b.data.0);
        near(&c, &(a - b.transpose() * b));
    }
}
