//! Where a ring's teeth are, from the times at which they pass, and by how much an edge varies (`docs/math/wheel-speed.md`, eq. 12, 13).

use crate::memory::Blank;
use crate::real::Real;

pub(super) const MOST_TEETH: usize = 96;
/// Turns from which the teeth are known well enough, and up to which each turn counts alike.
const LEAST_TURNS: u32 = 200;
const MOST_TURNS: u32 = 20_000;
/// By how much an interval may differ from the turn's mean, in `ln`.
const MOST_APART: f64 = 0.4;
/// Memory of an edge's variance in edges.
const EDGES: f64 = 4096.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Edge<T> {
    /// The next tooth, so many pitches after the one before.
    Tooth(T),
    /// Not known which: the ring is found anew.
    Lost,
}

#[derive(Debug, Clone, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Teeth<T> {
    number: usize,
    /// The tooth that passed last, counted from an unknown one.
    tooth: usize,
    /// Intervals since the ring was found.
    intervals: u32,
    /// `ln` of the last turn's intervals by tooth, over the first one's, and their sum.
    logs: Ring<T>,
    sum: T,
    first: T,
    /// Mean excess of each interval over its turn's mean, in pitches.
    longer: Ring<T>,
    turns: u32,
    /// By how many pitches each tooth lies too far on.
    errors: Ring<T>,
    /// The last two residuals; means of the square of one and of its product with each of the two before.
    residuals: [T; 2],
    products: [T; 3],
}

/// A number for each tooth, as rows that can be saved.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Ring<T>([[T; 16]; MOST_TEETH / 16]);

impl<T: Real> crate::memory::Blank for Ring<T> {
    const BLANK: Self = Self([[T::ZERO; 16]; MOST_TEETH / 16]);
}

impl<T: Real> Ring<T> {
    fn get(&self, tooth: usize) -> T {
        self.0.as_flattened().get(tooth).copied().unwrap_or(T::ZERO)
    }

    fn at(&mut self, tooth: usize) -> Option<&mut T> {
        self.0.as_flattened_mut().get_mut(tooth)
    }
}

impl<T: Real> Teeth<T> {
    pub(super) fn configure(&mut self, teeth: u32) {
        *self = crate::memory::Blank::BLANK;
        self.number = teeth as usize;
    }

    pub(super) fn learned(&self) -> bool {
        self.turns >= LEAST_TURNS
    }

    pub(super) fn errors(&self) -> &[T] {
        self.errors.0.as_flattened().get(..self.number).unwrap_or_default()
    }

    /// Variance of an edge about its tooth in squared pitches. Edges that vary each by themselves make neighboring intervals differ in
    /// opposite directions; what the wheel does in truth changes evenly over three intervals, so that it leaves nothing in this sum.
    pub(super) fn edge_variance(&self) -> T {
        let [square, next, second] = self.products;
        // No edge's time is known better than to 20 ns of 2 ms, which is more than what arithmetic rounds to.
        (T::lit(0.3) * square - T::lit(0.4) * next + T::lit(0.1) * second).at_least(T::lit(1e-10))
    }

    pub(super) fn push(&mut self, interval_s: T) -> Edge<T> {
        if !(interval_s > T::zero()) {
            self.configure(self.number as u32);
            return Edge::Lost;
        }
        let log = interval_s.ln_fast();
        if self.intervals == 0 {
            self.first = log;
        }
        let log = log - self.first;
        let counted = (self.intervals as usize).min(self.number);
        let mean = self.sum / T::whole((counted as u32).max(1));
        if counted > 0 && !((log - mean).abs() < T::lit(MOST_APART)) {
            self.configure(self.number as u32);
            return Edge::Lost;
        }
        let before = self.tooth;
        self.tooth = if self.tooth + 1 < self.number { self.tooth + 1 } else { 0 };
        let tooth = self.tooth;
        if let Some(place) = self.logs.at(tooth) {
            self.sum += log - *place;
            *place = log;
        }
        self.intervals = self.intervals.saturating_add(1);
        if self.tooth == 0 {
            self.end_turn();
        }
        let far = self.errors.get(tooth) - self.errors.get(before);
        if self.intervals as usize > self.number {
            self.compare();
            let residual = log - mean - far;
            let [last, before] = self.residuals;
            for (product, other) in self.products.iter_mut().zip([residual, last, before]) {
                *product += T::lit(1.0 / EDGES) * (residual * other - *product);
            }
            self.residuals = [residual, last];
        }
        Edge::Tooth(T::one() + far)
    }

    /// The interval half a turn ago against the mean of the turn about it: a speed that changes evenly is in neither.
    fn compare(&mut self) {
        let half = self.number / 2;
        let tooth = if self.tooth >= half { self.tooth - half } else { self.tooth + self.number - half };
        let beyond = self.logs.get(tooth) - self.sum / T::whole(self.number as u32);
        let share = T::one() / T::whole(self.turns.clamp(1, MOST_TURNS));
        if let Some(longer) = self.longer.at(tooth) {
            *longer += share * (beyond - *longer);
        }
    }

    /// Rounding does not add up over turns; and the errors follow what has been learned.
    fn end_turn(&mut self) {
        let turn = |ring: &Ring<T>, number: usize| {
            ring.0.as_flattened().iter().take(number).fold(T::zero(), |sum, x| sum + *x)
        };
        let share = T::one() / T::whole(self.number as u32);
        // What all speeds share goes out of the numbers that are kept.
        if self.intervals as usize > self.number {
            let mean = turn(&self.logs, self.number) * share;
            for log in self.logs.0.as_flattened_mut().iter_mut().take(self.number) {
                *log -= mean;
            }
            self.first += mean;
            self.turns = self.turns.saturating_add(1);
        }
        self.sum = turn(&self.logs, self.number);
        let mean = turn(&self.longer, self.number) * share;
        let mut far = T::zero();
        let places = self.errors.0.as_flattened_mut().iter_mut().zip(self.longer.0.as_flattened());
        for (error, longer) in places.take(self.number) {
            far += *longer - mean;
            *error = far;
        }
        let mean = turn(&self.errors, self.number) * share;
        for error in self.errors.0.as_flattened_mut().iter_mut().take(self.number) {
            *error -= mean;
        }
    }
}
