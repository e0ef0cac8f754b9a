//! The belief: a probability for every (road level mode, leak mode, pressure cell), and for every (level mode, cell) a
//! Gaussian over the road's log level, slope and enveloping (docs/math/informed.md, sections 2-4).
//!
//! Predicted over a frame's hop in parts, and weighed with a frame's evidence. Knows nothing of samples or gates.

use nalgebra::Matrix3;

use crate::memory::Blank;
use crate::real::Real;
use crate::single_wheel::BINS;
use crate::single_wheel::cells::{self, Cells, moments};
use crate::single_wheel::dynamics::{
    CALM, Dynamics, FALL, JUMP, JUMP_VARIANCE, LEAK_MODES, LEVEL_MODES, QUIET, REACH, RISE, SLOPE_MEAN, TAPS,
};
use crate::single_wheel::road_model::{
    ENVELOPE, Evidence, LEVEL, MeanMatch, Road, RoadBelief, SLOPE, matched_covariance,
};
use crate::single_wheel::tables::{CELLS, Tables};

/// Pairs of frames after the start in which no leak begins: some two seconds.
const SETTLING_PAIRS: u32 = 17;
/// Pairs of frames whose likelihoods are added up to one pseudo-measurement for a filter outside: some 0.7 s. One alone says too little
/// for its innovation to show.
const PAIRS_PER_MEASUREMENT: u32 = 6;

/// Narrowest belief in cells that a pseudo-measurement is meant for, and its least information over the belief's.
const NARROWEST_CELLS: f64 = 1.2;
const LEAST_INFORMATION: f64 = 1e-3;

/// The mean and spread of the pressure, and what the modes say.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Summary<T> {
    pub(crate) mean_cell: T,
    pub(crate) variance_cells2: T,
    /// Probability that the pressure is falling or rising fast.
    pub(crate) moving: T,
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Posterior<T: Real> {
    weight: [[Cells<T>; LEAK_MODES]; LEVEL_MODES],
    pub(super) road: [RoadBelief<T>; LEVEL_MODES],
    dynamics: Dynamics<T>,
    /// Sum over the frames since the last pseudo-measurement of their log-likelihoods of each cell, and their number.
    given_log_likelihood: Cells<T>,
    given_pairs: u32,
    /// Frames until a leak is believed possible: while the road is unknown everything looks like one.
    settling_pairs: u32,
    /// False until the first frame has set the road's level.
    road_known: bool,
    /// The resulting likelihood of the pressure.
    summary: Summary<T>,
}

impl<T: Real> Posterior<T> {
    /// For frames that come every `hop_s`; [`restart`](Self::restart) has to follow.
    #[inline(never)]
    pub(crate) fn configure(&mut self, hop_s: f64) {
        self.dynamics = Dynamics::new(hop_s);
    }

    /// Nine tenths around `initial_cell` with sd `initial_sd_cells`, one tenth anywhere; quiet, road unknown.
    pub(crate) fn restart(&mut self, initial_cell: T, initial_sd_cells: T) {
        let mut bell = Cells::from_fn(|cell, _| {
            let z = (T::lit(cell as f64) - initial_cell) / initial_sd_cells;
            (T::lit(-0.5) * z * z).exp()
        });
        let mass = bell.sum();
        if mass > T::zero() {
            bell *= T::lit(0.9) / mass;
        }
        let start = bell.map(|p| p + T::lit(0.1 / CELLS as f64));
        let share = start.sum();
        self.weight.iter_mut().flatten().for_each(|cells| cells.fill(T::zero()));
        self.weight[CALM][QUIET] = start / share;
        let road = Road::unknown(T::zero());
        self.road.iter_mut().for_each(|roads| roads.fill(&road));
        self.given_log_likelihood.fill(T::zero());
        self.given_pairs = 0;
        self.settling_pairs = SETTLING_PAIRS;
        self.road_known = false;
        self.summarise();
    }

    /// Leaks begin and end: the first part of moving on by one frame. [`move_cells`](Self::move_cells) for every level mode,
    /// [`mix_roads`](Self::mix_roads), [`mix_level_modes`](Self::mix_level_modes) and [`diffuse_roads`](Self::diffuse_roads) follow.
    pub(crate) fn begin_or_end_leaks(&mut self) {
        if self.settling_pairs > 0 {
            self.settling_pairs -= 1;
        } else {
            self.mix_leak_modes();
        }
    }

    /// The pressure is known now: a cell and its sd in cells. The roads learned under it stay.
    pub(crate) fn pin(&mut self, cell: T, sd_cells: T) {
        let bell = Cells::from_fn(|i, _| {
            let z = (T::lit(i as f64) - cell) / sd_cells;
            (T::lit(-0.5) * z * z).exp() + T::lit(1e-12)
        });
        for modes in &mut self.weight {
            let mut all = Cells::zeros();
            for cells in modes.iter_mut() {
                all += &*cells;
                *cells = Cells::zeros();
            }
            modes[QUIET] = all.map(|p| p.max(T::lit(1e-12))).component_mul(&bell);
        }
        self.normalise();
    }

    /// Moves on by one frame in which nothing can be learned: the pressure may wander, all else stays.
    pub(crate) fn hold(&mut self) {
        for cells in self.weight.as_flattened_mut() {
            cells::shift(cells, &self.dynamics.hold_kernel);
        }
        self.normalise();
    }

    fn mix_leak_modes(&mut self) {
        for level in &mut self.weight {
            cells::mix(&mut level.each_mut(), &self.dynamics.leak);
        }
    }

    /// Shifts and spreads every leak mode of a level mode; the road beliefs go along with the mass.
    pub(crate) fn move_cells(&mut self, level: usize) {
        let level = level.min(LEVEL_MODES - 1);
        let kernels = &self.dynamics.kernel;
        let old = &self.weight[level];
        // Mass that leaves a cell by a tap, whatever the leak mode.
        let mut leaving = [Cells::zeros(); TAPS];
        cells::split(old, kernels, &mut leaving);
        let roads = &mut self.road[level];
        let means = roads.mean;
        for to in 0..CELLS {
            let mut matched = MeanMatch::around(roads.mean(to));
            // Mass that arrives at `to` from `from = to - (tap - REACH)`.
            let taps = (to + REACH + 1).saturating_sub(CELLS)..TAPS.min(to + REACH + 1);
            for (tap, leaving) in leaving.iter().enumerate().take(taps.end).skip(taps.start) {
                let from = (to + REACH - tap).min(CELLS - 1);
                matched.add(leaving[from], &means.column(from).into_owned());
            }
            roads.set_mean(to, &matched.finish());
        }
        for (cells, kernel) in self.weight[level].iter_mut().zip(kernels) {
            cells::shift(cells, kernel);
        }
    }

    /// Roads become smoother or rougher: what is believed of them goes along.
    pub(crate) fn mix_roads(&mut self) {
        let rates = self.dynamics.level;
        let (best, _) = self.most_likely();
        let mut mass = [Cells::zeros(); LEVEL_MODES];
        for (mass, modes) in mass.iter_mut().zip(&self.weight) {
            cells::add_all(mass, modes);
        }
        let weights = |cell: usize, to: usize| -> [T; LEVEL_MODES] {
            core::array::from_fn(|from| rates[from][to] * mass[from].get(cell).copied().unwrap_or(T::zero()))
        };
        let covariances = self.mixed_covariances(best, |to| weights(best, to));
        for cell in 0..CELLS {
            let means = self.road.each_ref().map(|roads| roads.mean(cell));
            for (to, roads) in self.road.iter_mut().enumerate() {
                let mut matched = MeanMatch::around(means[to]);
                for (weight, mean) in weights(cell, to).into_iter().zip(&means) {
                    matched.add(weight, mean);
                }
                roads.set_mean(cell, &matched.finish());
            }
        }
        for (roads, covariance) in self.road.iter_mut().zip(covariances) {
            roads.covariance = covariance;
        }
    }

    /// Covariances of the level modes as roads of a cell are mixed, by the weights that each has in one.
    #[inline(never)]
    fn mixed_covariances(
        &self,
        cell: usize,
        weights: impl Fn(usize) -> [T; LEVEL_MODES],
    ) -> [Matrix3<T>; LEVEL_MODES] {
        let roads = self.road.each_ref().map(|roads| roads.get(cell));
        core::array::from_fn(|to| {
            let weights = weights(to);
            let mixture = core::array::from_fn::<_, LEVEL_MODES, _>(|from| (weights[from], roads[from]));
            matched_covariance(&mixture).unwrap_or(roads[to].covariance)
        })
    }

    /// Roads become smoother or rougher: the probabilities follow, and are [normalised](Self::normalise).
    pub(crate) fn mix_level_modes(&mut self) {
        for mode in 0..LEAK_MODES {
            cells::mix(&mut self.weight.each_mut().map(|level| &mut level[mode]), &self.dynamics.level);
        }
        self.normalise();
    }

    /// Roads wander: the last part of moving on. `log_speed_ratio` is the logarithm of the speed over that of the last step (zero if
    /// unknown): a faster car meets the same road with more power.
    pub(crate) fn diffuse_roads(&mut self, log_speed_ratio: T) {
        let d = &self.dynamics;
        for (mode, roads) in self.road.iter_mut().enumerate() {
            let jump = if mode == JUMP { JUMP_VARIANCE.map(T::lit) } else { [T::zero(); 2] };
            let mut road = roads.get(0);
            road.covariance.row_mut(SLOPE).scale_mut(d.slope_keep);
            road.covariance.column_mut(SLOPE).scale_mut(d.slope_keep);
            road.covariance[(LEVEL, LEVEL)] += d.level_variance[mode] + jump[0];
            road.covariance[(SLOPE, SLOPE)] += d.slope_variance + jump[1];
            road.covariance[(ENVELOPE, ENVELOPE)] += d.envelope_variance;
            road.cap_variance();
            roads.covariance = road.covariance;
            let typical = T::lit(SLOPE_MEAN);
            for cell in 0..CELLS {
                let mut mean = roads.mean(cell);
                let slope = mean[SLOPE];
                mean[LEVEL] += (slope - T::one()) * log_speed_ratio;
                mean[SLOPE] = typical + d.slope_keep * (slope - typical);
                let mut road = Road { mean, covariance: road.covariance };
                road.clamp();
                roads.set_mean(cell, &road.mean);
            }
        }
    }

    /// Weighs the belief with a frame's log evidence for every level mode and cell.
    pub(crate) fn weigh(&mut self, log_evidence: &[Cells<T>; LEVEL_MODES]) {
        let none = T::lit(f64::NEG_INFINITY);
        let largest = log_evidence.iter().fold(none, |largest, cells| cells::largest(cells, largest));
        let mut likelihood = [Cells::zeros(); LEVEL_MODES];
        for (likelihood, evidence) in likelihood.iter_mut().zip(log_evidence) {
            cells::exponentials(likelihood, evidence, largest);
        }
        self.remember_frame(&likelihood);
        for (modes, factor) in self.weight.iter_mut().zip(&likelihood) {
            modes.iter_mut().for_each(|cells| cells::multiply(cells, factor));
        }
        self.normalise();
    }

    /// Adds what this frame reported of each cell, whatever was believed of the cells before: the level modes' likelihood,
    /// averaged with their shares there.
    fn remember_frame(&mut self, likelihood: &[Cells<T>; LEVEL_MODES]) {
        // Where all mass is gone the modes count alike.
        let floor = T::lit(1e-30);
        let (mut weighed, mut total) = (Cells::zeros(), Cells::zeros());
        for (modes, likelihood) in self.weight.iter().zip(likelihood) {
            let mut share = Cells::repeat(floor);
            cells::add_all(&mut share, modes);
            cells::add(&mut total, &share);
            cells::multiply(&mut share, likelihood);
            cells::add(&mut weighed, &share);
        }
        let both = weighed.as_slice().iter().zip(total.as_slice());
        for (given, (&weighed, &total)) in self.given_log_likelihood.as_mut_slice().iter_mut().zip(both) {
            *given += (weighed / total).at_least(floor).ln_fast();
        }
        self.given_pairs += 1;
    }

    /// What the frames since the last pseudo-measurement reported by themselves: the mean cell and the variance in cells² of a Gaussian
    /// that turns the uniform belief into theirs. `None` until there are enough frames, or if they reported nothing.
    pub(crate) fn take_pseudo_measurement(&mut self) -> Option<(T, T)> {
        if self.given_pairs < PAIRS_PER_MEASUREMENT {
            return None;
        }
        let largest = self.given_log_likelihood.max();
        let likelihood = self.given_log_likelihood.map(|l| (l - largest).exp());
        self.given_log_likelihood = Cells::zeros();
        self.given_pairs = 0;
        let (mean, variance) = moments(&(likelihood / likelihood.sum()));
        let (uniform_mean, uniform_variance) = moments(&Cells::repeat(T::lit(1.0 / CELLS as f64)));
        // A cell is a small uniform distribution of its own.
        let variance = variance + T::lit(1.0 / 12.0);
        let information = T::one() / variance - T::one() / uniform_variance;
        let weighted = mean / variance - uniform_mean / uniform_variance;
        (information > T::lit(1e-6)).then(|| (weighted / information, T::one() / information))
    }

    /// Whether enough frames were seen for a pseudo-measurement.
    pub(crate) fn has_enough_frames(&self) -> bool {
        self.given_pairs >= PAIRS_PER_MEASUREMENT
    }

    /// The frames since the last pseudo-measurement as one for the belief `cell` with `sd_cells`: mean and variance in cells² of the Gaussian
    /// that turns that belief into the posterior. The likelihood is skewed, so a Gaussian of its own per belief is more exact than one for
    /// all. The variance is large, never negative, where the frames have no information.
    pub(crate) fn pseudo_measurement(&mut self, cell: T, sd_cells: T) -> Option<(T, T)> {
        if !self.has_enough_frames() {
            return None;
        }
        let sd = sd_cells.clamp(T::lit(NARROWEST_CELLS), T::lit(CELLS as f64));
        let believed = Cells::from_fn(|i, _| {
            let z = (T::lit(i as f64) - cell) / sd;
            (T::lit(-0.5) * z * z).exp() + T::lit(1e-30)
        });
        let largest = self.given_log_likelihood.max();
        let likelihood = self.given_log_likelihood.map(|l| (l - largest).exp());
        self.given_log_likelihood = Cells::zeros();
        self.given_pairs = 0;
        let (before, before_variance) = moments(&(believed / believed.sum()));
        let after = believed.component_mul(&likelihood);
        let (mean, variance) = moments(&(after / after.sum()));
        let least = T::lit(LEAST_INFORMATION) / before_variance;
        let information = (T::one() / variance - T::one() / before_variance).max(least);
        let pull = (mean - before) / variance;
        let given = (before + pull / information, T::one() / information);
        (given.0.is_finite() && given.1.is_finite()).then_some(given)
    }

    /// The first frame sets the level that the road is searched around.
    pub(super) fn meet_road(&mut self, frame: &Evidence<T>, tables: &Tables<T>) {
        if self.road_known {
            return;
        }
        let typical = Road::unknown(T::zero()).powers(frame, tables);
        for cell in 0..CELLS {
            let power = frame.powers(tables, cell);
            let sum = (0..frame.bins.min(BINS)).fold(T::zero(), |sum, bin| sum + power[bin] / typical[bin]);
            let road = Road::unknown((sum / T::lit(frame.bins as f64)).ln());
            for roads in &mut self.road {
                roads.set_mean(cell, &road.mean);
                roads.covariance = road.covariance;
            }
        }
        self.road_known = true;
    }

    /// Makes the weights probabilities, and sums up what they say.
    pub(crate) fn normalise(&mut self) {
        let total = cells::sum(&self.cells());
        if total > T::zero() && total.is_finite() {
            let by = T::one() / total;
            self.weight.as_flattened_mut().iter_mut().for_each(|cells| cells::scale(cells, by));
        }
        self.summarise();
    }

    fn summarise(&mut self) {
        let (mean_cell, variance_cells2) = moments(&self.cells());
        let moving = self.weight.iter().map(|level| cells::sum(&level[FALL]) + cells::sum(&level[RISE]));
        let moving = moving.fold(T::zero(), |sum, weight| sum + weight);
        self.summary = Summary { mean_cell, variance_cells2, moving: moving.min(T::one()) };
    }

    /// The most likely (level mode, cell), and the road believed there.
    pub(crate) fn most_likely(&self) -> (usize, Road<T>) {
        let (mut best, mut at) = (T::lit(-1.0), (&self.road[0], 0));
        for (road, modes) in self.road.iter().zip(&self.weight) {
            let mut mass = Cells::zeros();
            cells::add_all(&mut mass, modes);
            let cell = mass.imax().min(CELLS - 1);
            if mass[cell] > best {
                best = mass[cell];
                at = (road, cell);
            }
        }
        (at.1, at.0.get(at.1))
    }

    pub(crate) fn cells(&self) -> Cells<T> {
        let mut mass = Cells::zeros();
        self.weight.iter().for_each(|modes| cells::add_all(&mut mass, modes));
        mass
    }

    /// Probability of the stiffest two cells: of more, for all the grid knows.
    pub(crate) fn stiff_edge(&self) -> T {
        let cells = self.cells();
        cells[CELLS - 2] + cells[CELLS - 1]
    }

    /// Probability of the softest cell or of the stiffest, whichever is more: what lies there is a bound and no measurement.
    pub(crate) fn edge(&self) -> T {
        let cells = self.cells();
        cells[0].max(cells[CELLS - 1])
    }

    pub(crate) fn summary(&self) -> Summary<T> {
        self.summary
    }
}
