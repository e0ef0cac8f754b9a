//! Loops over the cells of the pressure grid. Functions of their own: a compiler that sees several of these loops at once unrolls them
//! into ten times the instructions, most of them addresses.
//!
//! Called by the posterior and the road fits; knows nothing of probabilities.

use nalgebra::SVector;

use super::dynamics::{REACH, TAPS};
use super::tables::CELLS;
use crate::real::Real;

pub(crate) type Cells<T> = SVector<T, CELLS>;

/// `sum += cells`.
#[inline(never)]
pub(super) fn add<T: Real>(sum: &mut Cells<T>, cells: &Cells<T>) {
    for (sum, &cell) in sum.as_mut_slice().iter_mut().zip(cells.as_slice()) {
        *sum += cell;
    }
}

/// `sum` and, one after the other, all of these.
#[inline(never)]
pub(super) fn add_all<T: Real, const N: usize>(sum: &mut Cells<T>, all: &[Cells<T>; N]) {
    let all = all.each_ref().map(|cells| &cells.data.0[0]);
    for (i, sum) in sum.as_mut_slice().iter_mut().enumerate().take(CELLS) {
        *sum = all.iter().fold(*sum, |sum, cells| sum + cells[i]);
    }
}

/// Every one becomes the sum of all, each times its rate (row) into this one (column).
#[inline(never)]
pub(super) fn mix<T: Real, const N: usize>(all: &mut [&mut Cells<T>; N], rates: &[[T; N]; N]) {
    for i in 0..CELLS {
        let before = all.each_ref().map(|cells| at(cells, i));
        for (cells, cell) in all.iter_mut().zip(mixed(&before, rates)) {
            set(cells, i, cell);
        }
    }
}

/// The sums of all of `from`, each times its rate (row) into one of `to` (column).
#[inline(never)]
pub(super) fn split<T: Real, const N: usize, const M: usize>(
    from: &[Cells<T>; N],
    rates: &[[T; M]; N],
    to: &mut [Cells<T>; M],
) {
    for i in 0..CELLS {
        let before = from.each_ref().map(|cells| at(cells, i));
        for (cells, cell) in to.iter_mut().zip(mixed(&before, rates)) {
            set(cells, i, cell);
        }
    }
}

#[inline(always)]
fn mixed<T: Real, const N: usize, const M: usize>(before: &[T; N], rates: &[[T; M]; N]) -> [T; M] {
    core::array::from_fn(|to| {
        before.iter().zip(rates).fold(T::zero(), |sum, (&cell, row)| sum + cell * row[to])
    })
}

#[inline(always)]
fn at<T: Real>(cells: &Cells<T>, i: usize) -> T {
    cells.get(i).copied().unwrap_or(T::ZERO)
}

#[inline(always)]
fn set<T: Real>(cells: &mut Cells<T>, i: usize, value: T) {
    if let Some(cell) = cells.get_mut(i) {
        *cell = value;
    }
}

/// Moves mass by a kernel; what leaves the grid is lost.
#[inline(never)]
pub(super) fn shift<T: Real>(cells: &mut Cells<T>, kernel: &[T; TAPS]) {
    let mut before = [T::zero(); CELLS + 2 * REACH];
    for (before, &cell) in before.iter_mut().skip(REACH).zip(cells.as_slice()) {
        *before = cell;
    }
    for (cell, before) in cells.as_mut_slice().iter_mut().zip(before.windows(TAPS)) {
        *cell = before.iter().rev().zip(kernel).fold(T::zero(), |sum, (&cell, &weight)| sum + cell * weight);
    }
}

/// `cells *= by`.
#[inline(never)]
pub(super) fn scale<T: Real>(cells: &mut Cells<T>, by: T) {
    cells.as_mut_slice().iter_mut().for_each(|cell| *cell *= by);
}

/// `cells *= factors`, each its own.
#[inline(never)]
pub(super) fn multiply<T: Real>(cells: &mut Cells<T>, factors: &Cells<T>) {
    for (cell, &factor) in cells.as_mut_slice().iter_mut().zip(factors.as_slice()) {
        *cell *= factor;
    }
}

#[inline(never)]
pub(super) fn sum<T: Real>(cells: &Cells<T>) -> T {
    let mut sum = T::zero();
    for &cell in cells.as_slice() {
        sum += cell;
    }
    sum
}

/// The largest of all and of `least`; NaN is passed over.
#[inline(never)]
pub(super) fn largest<T: Real>(cells: &Cells<T>, least: T) -> T {
    let mut largest = least;
    for &cell in cells.as_slice() {
        if cell > largest {
            largest = cell;
        }
    }
    largest
}

/// `e^(x - largest)` of every cell.
#[inline(never)]
pub(super) fn exponentials<T: Real>(into: &mut Cells<T>, cells: &Cells<T>, largest: T) {
    for (into, &cell) in into.as_mut_slice().iter_mut().zip(cells.as_slice()) {
        *into = (cell - largest).exp_fast();
    }
}

/// Mean and variance of a probability over cells.
#[inline(never)]
pub(super) fn moments<T: Real>(mass: &Cells<T>) -> (T, T) {
    let (mut mean, mut at) = (T::zero(), T::zero());
    for &p in mass.as_slice() {
        mean += p * at;
        at += T::one();
    }
    let (mut square, mut d) = (T::zero(), -mean);
    for &p in mass.as_slice() {
        square += p * d * d;
        d += T::one();
    }
    (mean, square)
}
