//! A frame's log evidence for every (level mode, cell): roads are fitted in the cells that matter and in nodes between which the
//! others are interpolated (docs/math/informed.md, section 4), a few cells at a time.

use nalgebra::{Matrix3, Vector3};

use super::cells::Cells;
use super::dynamics::{CALM, JUMP, LEVEL_MODES};
use super::grid_posterior::Posterior;
use super::road_model::{Evidence, RoadBelief, RoadPrior};
use super::tables::{CELLS, NEAREST, Tables, cubic_weights};
use crate::memory::{Blank, Placed};
use crate::real::Real;

/// Every so many cells one is fitted, whatever its probability: the frame's evidence is smooth in between.
const NODES_APART: usize = 5;
/// Probability from which on a cell matters, and of such cells every so many are fitted, the most likely one among them.
const MATTERS: f64 = 1e-4;
const APART: usize = 2;
/// Mean power of a frame over what was expected from which on the level may have jumped; downwards below one over its square, as most frames have less than the mean.
const NOT_EXPECTED: f64 = 2.0;

/// The fits of one frame, as far as they are. See the [module](self).
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RoadFits<T: Real> {
    /// Cells that are fitted, a bit each; the first of them that is still to be.
    fitted: u64,
    next: usize,
    /// How often some are fitted, and how many are owed of those, in parts of one.
    times: u32,
    owed: u32,
    priors: [Placed<RoadPrior<T>>; LEVEL_MODES],
    /// The most likely cell before the frame, whose covariances will be everybody's.
    best: usize,
    /// Whether the frame is as expected, so that no level has jumped.
    expected: bool,
    log_evidence: [Cells<T>; LEVEL_MODES],
    covariance: [Matrix3<T>; LEVEL_MODES],
}

impl<T: Real> RoadFits<T> {
    /// Before the first fit, of which there are `times`; `nis` is the frame's mean power over what the most likely road had expected.
    pub(crate) fn begin(&mut self, posterior: &Posterior<T>, nis: T, times: u32) {
        (self.best, _) = posterior.most_likely();
        let (mass, best) = (posterior.cells(), self.best);
        let matters = |cell: usize| mass.get(cell).is_some_and(|mass| *mass > T::lit(MATTERS));
        let is_next = |cell: usize| cell.abs_diff(best).is_multiple_of(APART);
        let is_fitted =
            |cell: usize| cell.is_multiple_of(NODES_APART) || is_next(cell) && matters(cell) || cell == best;
        self.fitted = (0..CELLS).fold(0, |bits, cell| bits | u64::from(is_fitted(cell)) << cell);
        (self.next, self.times, self.owed) = (0, times.max(1), 0);
        for (prior, roads) in self.priors.iter_mut().zip(&posterior.road) {
            prior.set(RoadPrior::new(&roads.covariance));
        }
        self.expected = nis.max((T::one() / nis).sqrt()) < T::lit(NOT_EXPECTED);
        self.log_evidence.iter_mut().for_each(|cells| cells.fill(T::zero()));
        self.covariance = posterior.road.each_ref().map(|roads| roads.covariance);
    }

    pub(crate) fn fit_some(&mut self, posterior: &mut Posterior<T>, frame: &Evidence<T>, tables: &Tables<T>) {
        self.owed += self.fitted.count_ones();
        while self.owed >= self.times {
            self.owed -= self.times;
            let Some(cell) = above(self.fitted, self.next) else { return };
            self.next = cell + 1;
            let reading = frame.read(tables, cell);
            for (level, prior) in self.priors.iter().enumerate() {
                let Some(prior) = prior.as_ref().filter(|_| !(self.expected && level == JUMP)) else {
                    continue;
                };
                let road = posterior.road[level].get(cell);
                let from = if level == JUMP { road.as_loud_as(frame, &reading, tables) } else { road };
                let fitted = prior.fit(&road, from, frame, &reading, tables);
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

    /// With all fits done, completes the evidence, and gives the posterior the roads.
    pub(crate) fn finish(&mut self, posterior: &mut Posterior<T>) {
        let fitted = self.fitted;
        let is_fitted = |cell: usize| fitted >> cell & 1 == 1;
        for cell in (0..CELLS).filter(|&cell| !is_fitted(cell)) {
            let between = Between::around(cell, fitted);
            // A level that has not jumped is taken over from the calm one below.
            let levels = if self.expected { JUMP } else { LEVEL_MODES };
            for (roads, log_evidence) in posterior.road.iter_mut().zip(&mut self.log_evidence).take(levels) {
                between.interpolate(cell, roads, log_evidence);
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

    pub(crate) fn log_evidence(&self) -> &[Cells<T>; LEVEL_MODES] {
        &self.log_evidence
    }
}

/// The nearest cell below one that is among these, a bit each; and the nearest from one on.
fn below(cells: u64, cell: usize) -> Option<usize> {
    let below = cells & !(u64::MAX << (cell % 64));
    below.checked_ilog2().map(|cell| cell as usize)
}

fn above(cells: u64, from: usize) -> Option<usize> {
    let above = cells & (u64::MAX << (from % 64));
    (above != 0).then(|| above.trailing_zeros() as usize)
}

/// How a cell that was not fitted lies between those that were.
struct Between<T> {
    /// The nearest ones, two on each side where there are, and the weight of each in a cubic through all.
    nearest: [usize; NEAREST],
    weight: [T; NEAREST],
}

impl<T: Real> Between<T> {
    fn around(cell: usize, fitted: u64) -> Self {
        let (below, above) = (|from| below(fitted, from), |from| above(fitted, from + 1));
        // The first and the last cell are nodes.
        let next = [below(cell).unwrap_or(0), above(cell).unwrap_or(CELLS - 1)];
        let mut nearest =
            [below(next[0]).unwrap_or(0), next[0], next[1], above(next[1]).unwrap_or(CELLS - 1)];
        if nearest[0] == next[0] {
            nearest = [next[0], next[1], nearest[3], above(nearest[3]).unwrap_or(CELLS - 1)];
        } else if nearest[3] == next[1] {
            nearest = [below(nearest[0]).unwrap_or(0), nearest[0], next[0], next[1]];
        }
        let number = |cell: usize| T::whole(cell as u32);
        Self { nearest, weight: cubic_weights(nearest.map(number), number(cell)) }
    }

    /// Evidence and road of the cell, by cubics through those of four around it.
    fn interpolate(&self, cell: usize, roads: &mut RoadBelief<T>, log_evidence: &mut Cells<T>) {
        let at = |cell: &usize| log_evidence.get(*cell).copied().unwrap_or(T::zero());
        let both = self.nearest.iter().zip(&self.weight);
        let between = both.fold(T::zero(), |sum, (cell, &weight)| sum + weight * at(cell));
        if let Some(log_evidence) = log_evidence.get_mut(cell) {
            *log_evidence = between;
        }
        let both = self.nearest.iter().zip(&self.weight);
        let mean = both.fold(Vector3::zeros(), |sum, (&cell, &weight)| sum + roads.mean(cell) * weight);
        roads.set_mean(cell, &mean);
    }
}
