//! A frame's log evidence for every (level mode, cell): roads are fitted in the cells that matter and in nodes between which the
//! others are interpolated (docs/math/informed.md, section 4), a few cells at a time.

use nalgebra::Matrix3;

use super::dynamics::{CALM, JUMP, LEVEL_MODES};
use super::grid_posterior::{Cells, Posterior};
use super::road_model::{Evidence, RoadBelief, RoadPrior};
use super::tables::{CELLS, Tables};
use crate::memory::{Placed, blank};
use crate::real::Real;

/// Every so many cells one is fitted, whatever its probability: the frame's evidence is smooth in between.
const NODES_APART: usize = 5;
/// Probability from which on a cell is fitted for itself.
const MATTERS: f64 = 1e-4;
/// Mean power of a frame over what was expected from which on the level may have jumped.
const NOT_EXPECTED: f64 = 2.0;

/// The fits of one frame, as far as they are. See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RoadFits<T: Real> {
    /// Cells that are fitted, a bit each; the first of them that is still to be, and how many are at a time.
    fitted: u64,
    next: usize,
    at_a_time: u32,
    priors: [Placed<RoadPrior<T>>; LEVEL_MODES],
    /// The most likely cell before the frame, whose covariances will be everybody's.
    best: usize,
    /// Whether the frame is as expected, so that no level has jumped.
    expected: bool,
    log_evidence: [Cells<T>; LEVEL_MODES],
    covariance: [Matrix3<T>; LEVEL_MODES],
}

blank!(RoadFits<T> { fitted, next, at_a_time, priors, best, expected, log_evidence, covariance });

impl<T: Real> RoadFits<T> {
    /// Before the first fit, of which there are `times`; `nis` is the frame's mean power over what the most likely road had
    /// expected.
    pub(crate) fn begin(&mut self, posterior: &Posterior<T>, nis: T, times: u32) {
        (self.best, _) = posterior.most_likely();
        let (mass, best) = (posterior.cells(), self.best);
        let matters = |cell: usize| mass.get(cell).is_some_and(|mass| *mass > T::lit(MATTERS));
        let is_fitted = |cell: usize| cell.is_multiple_of(NODES_APART) || cell == best || matters(cell);
        self.fitted = (0..CELLS).fold(0, |bits, cell| bits | u64::from(is_fitted(cell)) << cell);
        (self.next, self.at_a_time) = (0, self.fitted.count_ones().div_ceil(times.max(1)));
        for (prior, roads) in self.priors.iter_mut().zip(&posterior.road) {
            prior.set(RoadPrior::new(&roads.covariance));
        }
        self.expected = nis < T::lit(NOT_EXPECTED);
        self.log_evidence.iter_mut().for_each(|cells| cells.fill(T::zero()));
        self.covariance = posterior.road.each_ref().map(|roads| roads.covariance);
    }

    /// Fits the next cells.
    pub(crate) fn fit_some(&mut self, posterior: &mut Posterior<T>, frame: &Evidence<T>, tables: &Tables<T>) {
        for _ in 0..self.at_a_time {
            let Some(cell) = (self.next..CELLS).find(|&cell| self.is_fitted(cell)) else { return };
            self.next = cell + 1;
            let reading = frame.read(tables, cell);
            for (level, prior) in self.priors.iter().enumerate() {
                let Some(prior) = prior.as_ref().filter(|_| !(self.expected && level == JUMP)) else {
                    continue;
                };
                let fitted = prior.fit(&posterior.road[level].get(cell), frame, &reading, tables);
                posterior.road[level].set_mean(cell, &fitted.road.mean);
                if let Some(log_evidence) = self.log_evidence[level].get_mut(cell) {
                    *log_evidence = fitted.log_evidence;
                }
                if cell == self.best {
                    self.covariance[level] = fitted.road.covariance;
                }
            }
        }
    }

    fn is_fitted(&self, cell: usize) -> bool {
        self.fitted >> cell & 1 == 1
    }

    /// With all fits done, completes the evidence, and gives the posterior the roads.
    pub(crate) fn finish(&mut self, posterior: &mut Posterior<T>) {
        for (roads, log_evidence) in posterior.road.iter_mut().zip(&mut self.log_evidence) {
            for cell in (0..CELLS).filter(|cell| self.fitted >> cell & 1 == 0) {
                interpolate(cell, roads, log_evidence);
            }
        }
        let [calm, _, jump] = &self.priors;
        if let (true, Some(calm), Some(jump)) = (self.expected, calm.as_ref(), jump.as_ref())
            && let Some((covariance, less)) = jump.as_expected(calm, &self.covariance[CALM])
        {
            posterior.road[JUMP].mean = posterior.road[CALM].mean;
            self.covariance[JUMP] = covariance;
            self.log_evidence[JUMP] = self.log_evidence[CALM].add_scalar(less);
        }
        for (roads, covariance) in posterior.road.iter_mut().zip(self.covariance) {
            roads.covariance = covariance;
        }
    }

    /// The evidence of all cells, once it is complete.
    pub(crate) fn log_evidence(&self) -> &[Cells<T>; LEVEL_MODES] {
        &self.log_evidence
    }
}

/// Evidence and road of a cell that was not fitted: a cubic through the evidence of four nodes around it, a line through the roads
/// of two.
fn interpolate<T: Real>(cell: usize, roads: &mut RoadBelief<T>, log_evidence: &mut Cells<T>) {
    let nodes = CELLS.div_ceil(NODES_APART);
    let below = cell / NODES_APART;
    let first = below.saturating_sub(1).min(nodes - 4);
    // Lagrange's polynomials at the nodes 0, 1, 2, 3.
    let x = T::lit(1.0 / NODES_APART as f64) * T::lit((cell - first * NODES_APART) as f64);
    let [one, two, three] = [1.0, 2.0, 3.0].map(|node| x - T::lit(node));
    let (sixth, half) = (T::lit(1.0 / 6.0), T::lit(0.5));
    let weights =
        [-one * two * three * sixth, x * two * three * half, -x * one * three * half, x * one * two * sixth];
    let node = |i: usize| log_evidence.get((first + i) * NODES_APART).copied().unwrap_or(T::zero());
    let between = weights.iter().enumerate().fold(T::zero(), |sum, (i, &weight)| sum + weight * node(i));
    if let Some(log_evidence) = log_evidence.get_mut(cell) {
        *log_evidence = between;
    }
    let share = T::lit(1.0 / NODES_APART as f64) * T::lit((cell % NODES_APART) as f64);
    let [low, high] = [below, below + 1].map(|node| roads.mean(node * NODES_APART));
    roads.set_mean(cell, &(low + (high - low) * share));
}
