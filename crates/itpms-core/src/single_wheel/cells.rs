//! Loops over the cells of the pressure grid. Functions of their own: a compiler that sees several of these loops at once unrolls them
//! into ten times the instructions, most of them addresses.
//!
//! Called by the posterior and the road fits; knows nothing of probabilities.

use nalgebra::SVector;

use super::tables::CELLS;
use crate::real::Real;

/// A number per cell.
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

/// `sum += cells * by`; nothing is done where `by` is zero.
#[inline(never)]
pub(super) fn add_scaled<T: Real>(sum: &mut [T], cells: &[T], by: T) {
    if by == T::zero() {
        return;
    }
    for (sum, &cell) in sum.iter_mut().zip(cells) {
        *sum += cell * by;
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

/// The sum of all.
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
