//! The belief: a probability for every (road level mode, leak mode, pressure cell), and for every (level mode, cell) a
//! Gaussian over the road's log level, slope and enveloping (docs/math/informed.md, sections 2-4).
//!
//! `predict` moves the belief on by one frame, `update` weighs it with one. Knows nothing of samples or gates.

use nalgebra::SVector;

use crate::memory::blank;
use crate::real::Real;
use crate::single_wheel::BINS;
use crate::single_wheel::dynamics::{
    CALM, Dynamics, FALL, JUMP, JUMP_VARIANCE, LEAK_MODES, LEVEL_MODES, QUIET, REACH, RISE, SLOPE_MEAN, TAPS,
};
use crate::single_wheel::road_model::{ENVELOPE, Evidence, LEVEL, MomentMatch, Road, RoadBelief, SLOPE};
use crate::single_wheel::tables::{CELLS, Tables};

/// Frames after the start in which no leak begins: some two seconds.
const SETTLING_FRAMES: u32 = 33;
/// Frames whose likelihoods are added up to one word for a filter outside: some 0.7 s. One frame alone says too little
/// for its surprise to show.
const FRAMES_PER_WORD: u32 = 12;

/// Narrowest belief in cells that a word is meant for, and the least that a word says, over what was believed before.
const NARROWEST_CELLS: f64 = 1.2;
const LEAST_SAID: f64 = 1e-3;

type Cells<T> = SVector<T, CELLS>;

/// The mean and spread of the pressure, and what the modes say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Summary<T> {
    /// Mean cell, fractional.
    pub(crate) mean_cell: T,
    /// Variance in cells².
    pub(crate) variance_cells2: T,
    /// Probability that the pressure is falling or rising fast.
    pub(crate) moving: T,
}

/// The whole belief. See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Posterior<T: Real> {
    weight: [[Cells<T>; LEAK_MODES]; LEVEL_MODES],
    road: [RoadBelief<T>; LEVEL_MODES],
    dynamics: Dynamics<T>,
    /// Sum of what the frames since the last word said of each cell, and their number.
    told_log_likelihood: Cells<T>,
    told_frames: u32,
    /// Frames until a leak is believed possible: while the road is unknown everything looks like one.
    settling_frames: u32,
    /// False until the first frame has set the road's level.
    road_known: bool,
}

blank!(Posterior<T> { weight, road, dynamics, told_log_likelihood, told_frames, settling_frames, road_known });

impl<T: Real> Posterior<T> {
    /// Nine tenths around `initial_cell` with sd `initial_sd_cells`, one tenth anywhere; quiet, road unknown.
    pub(crate) fn configure(&mut self, hop_s: f64, initial_cell: T, initial_sd_cells: T) {
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
        self.dynamics = Dynamics::new(hop_s);
        self.told_log_likelihood.fill(T::zero());
        self.told_frames = 0;
        self.settling_frames = SETTLING_FRAMES;
        self.road_known = false;
    }

    /// Moves on by one frame. `speed_ratio` is the speed over that of the last step (one if unknown): a faster car
    /// meets the same road with more power.
    pub(crate) fn predict(&mut self, log_speed_ratio: T) {
        if self.settling_frames > 0 {
            self.settling_frames -= 1;
        } else {
            self.mix_leak_modes();
        }
        for level in 0..LEVEL_MODES {
            self.move_cells(level);
        }
        self.mix_level_modes();
        self.diffuse_roads(log_speed_ratio);
        self.normalise();
    }

    /// Somebody knows the pressure now: a cell and its sd in cells. The roads learned under it stay.
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
        for level in 0..LEVEL_MODES {
            for mode in 0..LEAK_MODES {
                self.weight[level][mode] = shifted(&self.weight[level][mode], &self.dynamics.hold_kernel);
            }
        }
        self.normalise();
    }

    fn mix_leak_modes(&mut self) {
        for level in &mut self.weight {
            let mut mixed = [Cells::zeros(); LEAK_MODES];
            for (from, row) in self.dynamics.leak.iter().enumerate() {
                for (to, &rate) in row.iter().enumerate() {
                    if rate > T::zero() {
                        mixed[to] += level[from] * rate;
                    }
                }
            }
            *level = mixed;
        }
    }

    /// Shifts and spreads every leak mode of a level mode; the road beliefs go along with the mass.
    fn move_cells(&mut self, level: usize) {
        let kernels = &self.dynamics.kernel;
        let old = &self.weight[level];
        let roads = self.road[level].clone();
        for to in 0..CELLS {
            let mut matched = MomentMatch::around(roads.get(to));
            for tap in 0..TAPS {
                // Mass that arrives at `to` from `from = to - (tap - REACH)`.
                let Some(from) = (to + REACH).checked_sub(tap).filter(|&from| from < CELLS) else { continue };
                let mut mass = T::zero();
                for (mode, kernel) in kernels.iter().enumerate() {
                    mass += kernel[tap] * old[mode][from];
                }
                if mass > T::zero() {
                    matched.add(mass, &roads.get(from));
                }
            }
            self.road[level].set(to, &matched.finish());
        }
        for (mode, kernel) in kernels.iter().enumerate() {
            self.weight[level][mode] = shifted(&self.weight[level][mode], kernel);
        }
    }

    fn mix_level_modes(&mut self) {
        let rates = self.dynamics.level;
        for cell in 0..CELLS {
            let mass: [T; LEVEL_MODES] =
                core::array::from_fn(|l| self.weight[l].iter().fold(T::zero(), |sum, mode| sum + mode[cell]));
            let roads: [Road<T>; LEVEL_MODES] = core::array::from_fn(|l| self.road[l].get(cell));
            for to in 0..LEVEL_MODES {
                let mut matched = MomentMatch::around(roads[to]);
                for from in 0..LEVEL_MODES {
                    matched.add(rates[from][to] * mass[from], &roads[from]);
                }
                self.road[to].set(cell, &matched.finish());
            }
        }
        for mode in 0..LEAK_MODES {
            let old = self.weight.each_ref().map(|level| level[mode]);
            for (to, level) in self.weight.iter_mut().enumerate() {
                let cells = &mut level[mode];
                *cells = Cells::zeros();
                for (from, row) in rates.iter().enumerate() {
                    *cells += old[from] * row[to];
                }
            }
        }
    }

    fn diffuse_roads(&mut self, log_speed_ratio: T) {
        let d = &self.dynamics;
        for (mode, roads) in self.road.iter_mut().enumerate() {
            let jump = if mode == JUMP { JUMP_VARIANCE.map(T::lit) } else { [T::zero(); 2] };
            for cell in 0..CELLS {
                let mut road = roads.get(cell);
                let slope = road.mean[SLOPE];
                road.mean[LEVEL] += (slope - T::one()) * log_speed_ratio;
                let typical = T::lit(SLOPE_MEAN);
                road.mean[SLOPE] = typical + d.slope_keep * (slope - typical);
                road.covariance.row_mut(SLOPE).scale_mut(d.slope_keep);
                road.covariance.column_mut(SLOPE).scale_mut(d.slope_keep);
                road.covariance[(LEVEL, LEVEL)] += d.level_variance[mode] + jump[0];
                road.covariance[(SLOPE, SLOPE)] += d.slope_variance + jump[1];
                road.covariance[(ENVELOPE, ENVELOPE)] += d.envelope_variance;
                road.cap();
                roads.set(cell, &road);
            }
        }
    }

    /// Weighs the belief with a frame.
    pub(crate) fn update(&mut self, frame: &Evidence<T>, tables: &Tables<T>) {
        if !self.road_known {
            self.meet_road(frame, tables);
        }
        let mut log_evidence = [Cells::zeros(); LEVEL_MODES];
        let mut largest = T::lit(f64::NEG_INFINITY);
        for cell in 0..CELLS {
            let reading = frame.read(tables, cell);
            for (roads, log_evidence) in self.road.iter_mut().zip(&mut log_evidence) {
                let (fitted, evidence) = roads.get(cell).weigh(frame, &reading, tables);
                roads.set(cell, &fitted);
                log_evidence[cell] = evidence;
                largest = largest.max(evidence);
            }
        }
        self.remember_frame(&log_evidence, largest);
        for (modes, log_evidence) in self.weight.iter_mut().zip(&log_evidence) {
            let factor = log_evidence.map(|e| (e - largest).exp());
            for cells in modes {
                cells.component_mul_assign(&factor);
            }
        }
        self.normalise();
    }

    /// Adds what this frame said of each cell, whatever was believed of the cells before: the level modes' evidence,
    /// averaged with their shares there.
    fn remember_frame(&mut self, log_evidence: &[Cells<T>; LEVEL_MODES], largest: T) {
        // Where all mass is gone the modes count alike.
        let floor = T::lit(1e-30);
        for cell in 0..CELLS {
            let (mut said, mut total) = (T::zero(), T::zero());
            for (modes, evidence) in self.weight.iter().zip(log_evidence) {
                let share = modes.iter().fold(floor, |sum, cells| sum + cells[cell]);
                said += share * (evidence[cell] - largest).exp();
                total += share;
            }
            self.told_log_likelihood[cell] += (said / total).max(floor).ln();
        }
        self.told_frames += 1;
    }

    /// What the frames since the last word said by themselves: the mean cell and the variance in cells² of a Gaussian
    /// that turns the uniform belief into theirs. `None` until there are enough frames, or if they said nothing.
    pub(crate) fn take_pseudo_measurement(&mut self) -> Option<(T, T)> {
        if self.told_frames < FRAMES_PER_WORD {
            return None;
        }
        let largest = self.told_log_likelihood.max();
        let likelihood = self.told_log_likelihood.map(|l| (l - largest).exp());
        self.told_log_likelihood = Cells::zeros();
        self.told_frames = 0;
        let (mean, variance) = moments(&(likelihood / likelihood.sum()));
        let (uniform_mean, uniform_variance) = moments(&Cells::repeat(T::lit(1.0 / CELLS as f64)));
        // A cell is a small uniform distribution of its own.
        let variance = variance + T::lit(1.0 / 12.0);
        let information = T::one() / variance - T::one() / uniform_variance;
        let weighted = mean / variance - uniform_mean / uniform_variance;
        (information > T::lit(1e-6)).then(|| (weighted / information, T::one() / information))
    }

    /// Whether enough frames were seen for a word.
    pub(crate) fn has_word(&self) -> bool {
        self.told_frames >= FRAMES_PER_WORD
    }

    /// What the frames since the last word said to somebody who believed in `cell` with `sd_cells`: the mean and variance
    /// in cells² of a Gaussian that turns that belief into theirs. The likelihood is skewed, so this is better than a
    /// Gaussian for everybody. The variance is large, never negative, where they said nothing.
    pub(crate) fn pseudo_measurement(&mut self, cell: T, sd_cells: T) -> Option<(T, T)> {
        if !self.has_word() {
            return None;
        }
        let sd = sd_cells.clamp(T::lit(NARROWEST_CELLS), T::lit(CELLS as f64));
        let believed = Cells::from_fn(|i, _| {
            let z = (T::lit(i as f64) - cell) / sd;
            (T::lit(-0.5) * z * z).exp() + T::lit(1e-30)
        });
        let largest = self.told_log_likelihood.max();
        let likelihood = self.told_log_likelihood.map(|l| (l - largest).exp());
        self.told_log_likelihood = Cells::zeros();
        self.told_frames = 0;
        let (before, before_variance) = moments(&(believed / believed.sum()));
        let after = believed.component_mul(&likelihood);
        let (mean, variance) = moments(&(after / after.sum()));
        let least = T::lit(LEAST_SAID) / before_variance;
        let information = (T::one() / variance - T::one() / before_variance).max(least);
        let pull = (mean - before) / variance;
        let word = (before + pull / information, T::one() / information);
        (word.0.is_finite() && word.1.is_finite()).then_some(word)
    }

    /// The first frame sets the level that the road is searched around.
    fn meet_road(&mut self, frame: &Evidence<T>, tables: &Tables<T>) {
        let typical = Road::unknown(T::zero()).powers(frame, tables);
        for cell in 0..CELLS {
            let power = frame.read(tables, cell).power;
            let sum = (0..frame.bins.min(BINS)).fold(T::zero(), |sum, bin| sum + power[bin] / typical[bin]);
            let road = Road::unknown((sum / T::lit(frame.bins as f64)).ln());
            for roads in &mut self.road {
                roads.set(cell, &road);
            }
        }
        self.road_known = true;
    }

    fn normalise(&mut self) {
        let mut total = T::zero();
        for level in &self.weight {
            for cells in level {
                total += cells.sum();
            }
        }
        if total > T::zero() && total.is_finite() {
            for level in &mut self.weight {
                for cells in level {
                    *cells /= total;
                }
            }
        }
    }

    /// The most likely (level mode, cell), and the road believed there.
    pub(crate) fn most_likely(&self) -> (usize, Road<T>) {
        let (mut best, mut at) = (T::lit(-1.0), (&self.road[0], 0));
        for (road, modes) in self.road.iter().zip(&self.weight) {
            let mut mass = Cells::zeros();
            for cells in modes {
                mass += cells;
            }
            let cell = mass.imax().min(CELLS - 1);
            if mass[cell] > best {
                best = mass[cell];
                at = (road, cell);
            }
        }
        (at.1, at.0.get(at.1))
    }

    /// Probability per cell.
    pub(crate) fn cells(&self) -> Cells<T> {
        let mut mass = Cells::zeros();
        for level in &self.weight {
            for cells in level {
                mass += cells;
            }
        }
        mass
    }

    /// Probability of the stiffest two cells: of more, for all the grid knows.
    pub(crate) fn stiff_edge(&self) -> T {
        let cells = self.cells();
        cells[CELLS - 2] + cells[CELLS - 1]
    }

    pub(crate) fn summary(&self) -> Summary<T> {
        let (mean, square) = moments(&self.cells());
        let mut falling_or_rising = T::zero();
        for level in &self.weight {
            falling_or_rising += level[FALL].sum() + level[RISE].sum();
        }
        Summary { mean_cell: mean, variance_cells2: square, moving: falling_or_rising.min(T::one()) }
    }
}

/// Mean and variance of a probability over cells.
fn moments<T: Real>(mass: &Cells<T>) -> (T, T) {
    let (mut mean, mut square) = (T::zero(), T::zero());
    for (cell, &p) in mass.iter().enumerate() {
        mean += p * T::lit(cell as f64);
    }
    for (cell, &p) in mass.iter().enumerate() {
        let d = T::lit(cell as f64) - mean;
        square += p * d * d;
    }
    (mean, square)
}

/// Mass moved by a kernel; what leaves the grid is lost.
fn shifted<T: Real>(cells: &Cells<T>, kernel: &[T; TAPS]) -> Cells<T> {
    let mut moved = Cells::zeros();
    for (tap, &weight) in kernel.iter().enumerate() {
        if !(weight > T::zero()) {
            continue;
        }
        for to in 0..CELLS {
            if let Some(from) = (to + REACH).checked_sub(tap).filter(|&from| from < CELLS) {
                moved[to] += weight * cells[from];
            }
        }
    }
    moved
}
