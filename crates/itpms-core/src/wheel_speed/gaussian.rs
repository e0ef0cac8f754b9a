//! Belief about offsets, radii and disturbances under one hypothesis: a Gaussian whose covariance is kept once, not twice.

use super::state::STATES;
use crate::memory::Blank;
use crate::real::Real;

/// Numbers of a symmetric matrix of an even number of states, as rows of half of it: what is saved knows no longer arrays.
const ROW: usize = STATES / 2;
const ROWS: usize = STATES + 1;

/// Mean and lower triangle of the covariance, row by row without gaps.
#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Gaussian<T> {
    pub mean: [T; STATES],
    covariance: [[T; ROW]; ROWS],
}

impl<T: Real> Gaussian<T> {
    pub(super) fn independent(mean: [T; STATES], sd: [T; STATES]) -> Self {
        let mut belief = Self { mean, covariance: [[T::zero(); ROW]; ROWS] };
        for (i, sd) in sd.into_iter().enumerate() {
            belief.set(i, i, sd * sd);
        }
        belief
    }

    pub(super) fn get(&self, i: usize, j: usize) -> T {
        self.covariance.as_flattened().get(place(i, j)).copied().unwrap_or(T::ZERO)
    }

    pub(super) fn set(&mut self, i: usize, j: usize, value: T) {
        if let Some(entry) = self.covariance.as_flattened_mut().get_mut(place(i, j)) {
            *entry = value;
        }
    }

    /// Adds a state to another, and forgets it: it is zero from here on.
    pub(super) fn absorb(&mut self, into: usize, from: usize) {
        let of_both = self.get(into, into) + T::lit(2.0) * self.get(into, from) + self.get(from, from);
        for other in (0..STATES).filter(|other| *other != into) {
            let sum = self.get(into, other) + self.get(from, other);
            self.set(into, other, sum);
        }
        self.set(into, into, of_both);
        for other in 0..STATES {
            self.set(from, other, T::zero());
        }
        let taken = self.mean.get(from).copied().unwrap_or(T::ZERO);
        if let Some(mean) = self.mean.get_mut(into) {
            *mean += taken;
        }
        if let Some(mean) = self.mean.get_mut(from) {
            *mean = T::zero();
        }
    }

    pub(super) fn widen(&mut self, i: usize, variance: T) {
        if let Some(entry) = self.covariance.as_flattened_mut().get_mut(place(i, i)) {
            *entry += variance;
        }
    }

    /// Widens states from `first` on along a direction, by a variance.
    pub(super) fn widen_along<const N: usize>(&mut self, first: usize, direction: &[f64; N], variance: T) {
        for (i, a) in direction.iter().enumerate() {
            for (j, b) in direction.iter().enumerate().take(i + 1) {
                if let Some(entry) = self.covariance.as_flattened_mut().get_mut(place(first + i, first + j)) {
                    *entry += T::lit(a * b) * variance;
                }
            }
        }
    }

    /// Each state shrinks to a share of itself, as a wandering disturbance does in a step of time.
    pub(super) fn shrink(&mut self, share: &[T; STATES]) {
        let mut entries = self.covariance.as_flattened_mut().iter_mut();
        for (i, (mean, row)) in self.mean.iter_mut().zip(share).enumerate() {
            *mean *= *row;
            for (entry, column) in entries.by_ref().take(i + 1).zip(share) {
                *entry *= *row * *column;
            }
        }
    }

    /// Each becomes the mixture of all with the shares of its row, which add up to one: number by number, so that no copy of all is needed.
    pub(super) fn mix<const N: usize>(parts: &mut [Self; N], shares: &[[T; N]; N]) {
        let mut means = [[T::zero(); N]; STATES];
        let mut centers = [[T::zero(); N]; STATES];
        for (i, (means, centers)) in means.iter_mut().zip(&mut centers).enumerate() {
            *means = core::array::from_fn(|from| parts[from].mean[i]);
            for ((center, shares), part) in centers.iter_mut().zip(shares).zip(parts.iter_mut()) {
                *center = present(shares, means).fold(T::zero(), |sum, (share, mean)| sum + share * mean);
                part.mean[i] = *center;
            }
        }
        for (i, (row, row_centers)) in means.iter().zip(&centers).enumerate() {
            for (j, (column, column_centers)) in means.iter().zip(&centers).enumerate().take(i + 1) {
                let entries: [T; N] = core::array::from_fn(|from| parts[from].get(i, j));
                let of_both = row_centers.iter().zip(column_centers);
                for (((row_center, column_center), shares), part) in of_both.zip(shares).zip(parts.iter_mut())
                {
                    let both: [T; N] = core::array::from_fn(|from| {
                        entries[from] + (row[from] - *row_center) * (column[from] - *column_center)
                    });
                    part.set(i, j, present(shares, &both).fold(T::zero(), |sum, (share, x)| sum + share * x));
                }
            }
        }
    }

    /// A mixture's mean and covariance, the weights adding up to one.
    pub(super) fn merged<'a>(parts: impl Iterator<Item = (T, &'a Self)> + Clone) -> Self
    where
        T: 'a,
    {
        let mut merged = Self { mean: [T::zero(); STATES], covariance: [[T::zero(); ROW]; ROWS] };
        for (weight, part) in parts.clone() {
            for (sum, mean) in merged.mean.iter_mut().zip(&part.mean) {
                *sum += weight * *mean;
            }
        }
        for (weight, part) in parts {
            let mut away = [T::zero(); STATES];
            for ((away, mean), center) in away.iter_mut().zip(&part.mean).zip(&merged.mean) {
                *away = *mean - *center;
            }
            let mut entries =
                merged.covariance.as_flattened_mut().iter_mut().zip(part.covariance.as_flattened());
            for (i, row) in away.iter().enumerate() {
                for ((sum, entry), column) in entries.by_ref().take(i + 1).zip(&away) {
                    *sum += weight * (*entry + *row * *column);
                }
            }
        }
        merged
    }

    /// One measurement `z = sum h x` with its noise variance; returns its log likelihood without constants.
    pub(super) fn measure(&mut self, h: &[T; STATES], z: T, noise: T) -> T {
        let mut seen = [T::zero(); STATES];
        for (i, seen) in seen.iter_mut().enumerate() {
            for (j, h) in h.iter().enumerate() {
                if *h != T::zero() {
                    *seen += self.get(i, j) * *h;
                }
            }
        }
        let dot = |x: &[T; STATES]| h.iter().zip(x).fold(T::zero(), |sum, (h, x)| sum + *h * *x);
        let (residual, variance) = (z - dot(&self.mean), dot(&seen) + noise);
        if !(variance > T::zero()) || !residual.is_finite() {
            return T::zero();
        }
        let gain = T::one() / variance;
        let mut entries = self.covariance.as_flattened_mut().iter_mut();
        for (i, (mean, row)) in self.mean.iter_mut().zip(&seen).enumerate() {
            *mean += *row * gain * residual;
            for (entry, column) in entries.by_ref().take(i + 1).zip(&seen) {
                *entry -= *row * gain * *column;
            }
        }
        self.keep_positive();
        T::lit(-0.5) * (residual * residual * gain + variance.ln_fast())
    }

    /// Rounding in single precision may not make a variance negative.
    fn keep_positive(&mut self) {
        for i in 0..STATES {
            if !(self.get(i, i) > T::lit(1e-9)) {
                self.set(i, i, T::lit(1e-9));
            }
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.mean.iter().chain(self.covariance.as_flattened()).all(|x| x.is_finite())
    }
}

/// The parts of a mixture that have a share, with their numbers.
fn present<T: Real>(shares: &[T], numbers: &[T]) -> impl Iterator<Item = (T, T)> {
    shares.iter().copied().zip(numbers.iter().copied()).filter(|(share, _)| *share > T::zero())
}

fn place(i: usize, j: usize) -> usize {
    let (row, column) = if i < j { (j, i) } else { (i, j) };
    row * (row + 1) / 2 + column
}
