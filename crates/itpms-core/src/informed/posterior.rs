//! The belief: a probability for every (road level mode, leak mode, pressure cell), and for every (level mode, cell) a
//! Gaussian over the road's log level `c` and slope `w` (docs/math/informed.md, sections 2-4).
//!
//! `predict` moves the belief on by one frame, `update` weighs it with one. Knows nothing of samples or gates.

use nalgebra::SVector;

use super::dynamics::{
    ACTIVE, CALM, Dynamics, JUMP, JUMP_VARIANCE, LEAK_MODES, LEVEL_MODES, QUIET, REACH, SLOPE_MEAN, SLOPE_SD,
    TAPS,
};
use super::frame::BINS;
use super::model::{CELLS, Tables};
use crate::real::Real;

type Cells<T> = SVector<T, CELLS>;

/// Bounds of the road's log level and slope, and of their variances.
const LOWEST_LEVEL: f64 = -19.0;
const SLOPE_RANGE: [f64; 2] = [1.0, 3.4];
const LARGEST_VARIANCE: [f64; 2] = [9.0, 0.25];

/// A Gaussian over (log level, slope) per cell.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct RoadBelief<T: Real> {
    level: Cells<T>,
    slope: Cells<T>,
    level_variance: Cells<T>,
    slope_variance: Cells<T>,
    covariance: Cells<T>,
}

impl<T: Real> RoadBelief<T> {
    fn get(&self, cell: usize) -> Road<T> {
        Road {
            level: self.level[cell],
            slope: self.slope[cell],
            level_variance: self.level_variance[cell],
            slope_variance: self.slope_variance[cell],
            covariance: self.covariance[cell],
        }
    }

    fn set(&mut self, cell: usize, road: &Road<T>) {
        self.level[cell] = road.level;
        self.slope[cell] = road.slope;
        self.level_variance[cell] = road.level_variance;
        self.slope_variance[cell] = road.slope_variance;
        self.covariance[cell] = road.covariance;
    }
}

/// One Gaussian over (log level, slope).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Road<T> {
    pub(super) level: T,
    pub(super) slope: T,
    level_variance: T,
    slope_variance: T,
    covariance: T,
}

/// Collects weighted Gaussians and gives the one with the same mean and covariance.
struct MomentMatch<T> {
    reference: Road<T>,
    weight: T,
    first: [T; 2],
    second: [T; 3],
}

impl<T: Real> MomentMatch<T> {
    /// Sums are kept relative to `reference`, so that f32 keeps its digits.
    fn around(reference: Road<T>) -> Self {
        let zero = T::zero();
        Self { reference, weight: zero, first: [zero; 2], second: [zero; 3] }
    }

    fn add(&mut self, weight: T, road: &Road<T>) {
        let (dc, dw) = (road.level - self.reference.level, road.slope - self.reference.slope);
        self.weight += weight;
        self.first[0] += weight * dc;
        self.first[1] += weight * dw;
        self.second[0] += weight * (road.level_variance + dc * dc);
        self.second[1] += weight * (road.slope_variance + dw * dw);
        self.second[2] += weight * (road.covariance + dc * dw);
    }

    fn finish(&self) -> Road<T> {
        if !(self.weight > T::zero()) {
            return self.reference;
        }
        let (dc, dw) = (self.first[0] / self.weight, self.first[1] / self.weight);
        Road {
            level: self.reference.level + dc,
            slope: self.reference.slope + dw,
            level_variance: self.second[0] / self.weight - dc * dc,
            slope_variance: self.second[1] / self.weight - dw * dw,
            covariance: self.second[2] / self.weight - dc * dw,
        }
    }
}

/// One frame, ready to be weighed: `|V|² = a + 2 θ b + θ² c` per bin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Evidence<T> {
    pub(super) a: [T; BINS],
    pub(super) b: [T; BINS],
    pub(super) c: [T; BINS],
    /// Log gain of the tire's enveloping per bin.
    pub(super) log_envelope: [T; BINS],
    /// Bins in use.
    pub(super) bins: usize,
    /// One-sided accelerometer noise density in (m/s²)²/Hz.
    pub(super) noise_density: T,
    /// Exponent of the likelihood: overlap of the frames times the gates.
    pub(super) weight: T,
}

impl<T: Real> Evidence<T> {
    /// Power density of the road velocity reconstructed with `theta`.
    pub(super) fn power(&self, bin: usize, theta: T) -> T {
        let power = self.a[bin] + theta * (T::lit(2.0) * self.b[bin] + theta * self.c[bin]);
        power.max(T::lit(1e-24))
    }
}

/// The mean and spread of the pressure, and what the modes say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Summary<T> {
    /// Mean cell, fractional.
    pub(super) mean_cell: T,
    /// Variance in cells².
    pub(super) variance_cells2: T,
    /// Probability that the pressure is moving.
    pub(super) moving: T,
}

/// The whole belief. See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Posterior<T: Real> {
    weight: [[Cells<T>; LEAK_MODES]; LEVEL_MODES],
    road: [RoadBelief<T>; LEVEL_MODES],
    dynamics: Dynamics<T>,
    /// False until the first frame has set the road's level.
    road_known: bool,
}

impl<T: Real> Posterior<T> {
    /// Nine tenths around `initial_cell` with sd `initial_sd_cells`, one tenth anywhere; quiet, road unknown.
    pub(super) fn new(hop_s: f64, initial_cell: T, initial_sd_cells: T) -> Self {
        let mut bell = Cells::from_fn(|cell, _| {
            let z = (T::lit(cell as f64) - initial_cell) / initial_sd_cells;
            (T::lit(-0.5) * z * z).exp()
        });
        let mass = bell.sum();
        if mass > T::zero() {
            bell *= T::lit(0.9) / mass;
        }
        let start = bell.map(|p| p + T::lit(0.1 / CELLS as f64));
        let mut weight = [[Cells::zeros(); LEAK_MODES]; LEVEL_MODES];
        let share = start.sum();
        weight[CALM][QUIET] = start / share;
        let road = RoadBelief {
            level: Cells::repeat(T::lit(-9.0)),
            slope: Cells::repeat(T::lit(SLOPE_MEAN)),
            level_variance: Cells::repeat(T::lit(LARGEST_VARIANCE[0])),
            slope_variance: Cells::repeat(T::lit(SLOPE_SD * SLOPE_SD)),
            covariance: Cells::zeros(),
        };
        Self {
            weight,
            road: [road.clone(), road.clone(), road],
            dynamics: Dynamics::new(hop_s),
            road_known: false,
        }
    }

    /// Moves on by one frame. `speed_ratio` is the speed over that of the last step (one if unknown): a faster car
    /// meets the same road with more power.
    pub(super) fn predict(&mut self, log_speed_ratio: T) {
        self.mix_leak_modes();
        for level in 0..LEVEL_MODES {
            self.move_cells(level);
        }
        self.mix_level_modes();
        self.diffuse_roads(log_speed_ratio);
        self.normalise();
    }

    /// Moves on by one frame in which nothing can be learned: the pressure may wander, all else stays.
    pub(super) fn hold(&mut self) {
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
        let old_roads = self.road.clone();
        for cell in 0..CELLS {
            let mass: [T; LEVEL_MODES] =
                core::array::from_fn(|l| self.weight[l].iter().fold(T::zero(), |sum, mode| sum + mode[cell]));
            let roads: [Road<T>; LEVEL_MODES] = core::array::from_fn(|l| old_roads[l].get(cell));
            for to in 0..LEVEL_MODES {
                let mut matched = MomentMatch::around(roads[to]);
                for from in 0..LEVEL_MODES {
                    matched.add(rates[from][to] * mass[from], &roads[from]);
                }
                self.road[to].set(cell, &matched.finish());
            }
        }
        let old = self.weight;
        for (to, level) in self.weight.iter_mut().enumerate() {
            for (mode, cells) in level.iter_mut().enumerate() {
                *cells = Cells::zeros();
                for (from, row) in rates.iter().enumerate() {
                    *cells += old[from][mode] * row[to];
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
                road.level += (road.slope - T::one()) * log_speed_ratio;
                road.level_variance += d.level_variance[mode] + jump[0];
                let mean = T::lit(SLOPE_MEAN);
                road.slope = mean + d.slope_keep * (road.slope - mean);
                road.slope_variance =
                    road.slope_variance * d.slope_keep * d.slope_keep + d.slope_variance + jump[1];
                road.covariance *= d.slope_keep;
                road.cap();
                roads.set(cell, &road);
            }
        }
    }

    /// Weighs the belief with a frame.
    pub(super) fn update(&mut self, frame: &Evidence<T>, tables: &Tables<T>) {
        if !self.road_known {
            self.meet_road(frame, tables);
        }
        let mut log_evidence = [Cells::zeros(); LEVEL_MODES];
        let mut largest = T::lit(f64::NEG_INFINITY);
        for level in 0..LEVEL_MODES {
            for cell in 0..CELLS {
                let prior = self.road[level].get(cell);
                let (posterior, evidence) = weigh(frame, tables, cell, &prior);
                self.road[level].set(cell, &posterior);
                log_evidence[level][cell] = evidence;
                largest = largest.max(evidence);
            }
        }
        for level in 0..LEVEL_MODES {
            let factor = log_evidence[level].map(|e| (e - largest).exp());
            for cells in &mut self.weight[level] {
                cells.component_mul_assign(&factor);
            }
        }
        self.normalise();
    }

    /// The first frame sets the level that the road is searched around.
    fn meet_road(&mut self, frame: &Evidence<T>, tables: &Tables<T>) {
        for roads in &mut self.road {
            for cell in 0..CELLS {
                let theta = tables.theta[cell];
                let mut sum = T::zero();
                for bin in 0..frame.bins {
                    let shape = tables.log_leak[bin]
                        + T::lit(2.0 - SLOPE_MEAN) * tables.log_frequency[bin]
                        + frame.log_envelope[bin];
                    sum += frame.power(bin, theta) * (-shape).exp();
                }
                let mean = sum / T::lit(frame.bins as f64);
                roads.level[cell] = mean.ln().max(T::lit(LOWEST_LEVEL));
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
    pub(super) fn most_likely(&self) -> (usize, Road<T>) {
        let (mut best, mut at) = (T::lit(-1.0), (0, 0));
        for (level, modes) in self.weight.iter().enumerate() {
            let mut mass = Cells::zeros();
            for cells in modes {
                mass += cells;
            }
            let cell = mass.imax();
            if mass[cell] > best {
                best = mass[cell];
                at = (level, cell);
            }
        }
        (at.1, self.road[at.0].get(at.1))
    }

    /// Probability per cell.
    pub(super) fn cells(&self) -> Cells<T> {
        let mut mass = Cells::zeros();
        for level in &self.weight {
            for cells in level {
                mass += cells;
            }
        }
        mass
    }

    pub(super) fn summary(&self) -> Summary<T> {
        let mass = self.cells();
        let (mut mean, mut square) = (T::zero(), T::zero());
        for cell in 0..CELLS {
            mean += mass[cell] * T::lit(cell as f64);
        }
        for cell in 0..CELLS {
            let d = T::lit(cell as f64) - mean;
            square += mass[cell] * d * d;
        }
        let mut still = T::zero();
        for level in &self.weight {
            still += level[QUIET].sum() + level[ACTIVE].sum();
        }
        Summary { mean_cell: mean, variance_cells2: square, moving: (T::one() - still).max(T::zero()) }
    }
}

impl<T: Real> Road<T> {
    /// Keeps the belief inside its bounds and its covariance positive.
    fn cap(&mut self) {
        self.level = self.level.max(T::lit(LOWEST_LEVEL));
        self.slope = self.slope.clamp(T::lit(SLOPE_RANGE[0]), T::lit(SLOPE_RANGE[1]));
        let shrink = |variance: &mut T, largest: f64, covariance: &mut T| {
            let largest = T::lit(largest);
            if *variance > largest {
                *covariance *= (largest / *variance).sqrt();
                *variance = largest;
            }
        };
        shrink(&mut self.level_variance, LARGEST_VARIANCE[0], &mut self.covariance);
        shrink(&mut self.slope_variance, LARGEST_VARIANCE[1], &mut self.covariance);
    }

    /// Log of the road's power density in a bin.
    pub(super) fn log_power(&self, tables: &Tables<T>, frame: &Evidence<T>, bin: usize) -> T {
        self.level
            + tables.log_leak[bin]
            + frame.log_envelope[bin]
            + (T::lit(2.0) - self.slope) * tables.log_frequency[bin]
    }
}

/// Fits the road to a frame under one cell's stiffness (two Gauss-Newton passes) and gives the fitted belief and the
/// log evidence of the frame.
fn weigh<T: Real>(frame: &Evidence<T>, tables: &Tables<T>, cell: usize, prior: &Road<T>) -> (Road<T>, T) {
    let theta = tables.theta[cell];
    let one = T::one();
    // Prior information P⁻¹.
    let determinant = prior.level_variance * prior.slope_variance - prior.covariance * prior.covariance;
    let determinant = determinant.max(T::lit(1e-12));
    let info = [
        prior.slope_variance / determinant,
        prior.level_variance / determinant,
        -prior.covariance / determinant,
    ];
    let mut fit = *prior;
    let mut fit_info_determinant = one;
    for _ in 0..2 {
        let (mut score, mut fisher) = ([T::zero(); 2], [T::zero(); 3]);
        for bin in 0..frame.bins {
            let signal = fit.log_power(tables, frame, bin).exp();
            let expected = signal + frame.noise_density * tables.noise[(bin, cell)];
            let share = signal / expected;
            let excess = frame.power(bin, theta) / expected - one;
            // d ln S / d(c, w) = (1, -ln(f/10))
            let (ac, aw) = (share, -share * tables.log_frequency[bin]);
            score[0] += excess * ac;
            score[1] += excess * aw;
            fisher[0] += ac * ac;
            fisher[1] += aw * aw;
            fisher[2] += ac * aw;
        }
        let (dc, dw) = (prior.level - fit.level, prior.slope - fit.slope);
        let g = [
            frame.weight * score[0] + info[0] * dc + info[2] * dw,
            frame.weight * score[1] + info[2] * dc + info[1] * dw,
        ];
        let a: [T; 3] = core::array::from_fn(|i| frame.weight * fisher[i] + info[i]);
        let a_determinant = a[0] * a[1] - a[2] * a[2];
        let step = [(a[1] * g[0] - a[2] * g[1]) / a_determinant, (a[0] * g[1] - a[2] * g[0]) / a_determinant];
        fit = Road {
            level: (fit.level + step[0].clamp(-one, one)).max(T::lit(LOWEST_LEVEL)),
            slope: (fit.slope + step[1]).clamp(T::lit(SLOPE_RANGE[0]), T::lit(SLOPE_RANGE[1])),
            level_variance: a[1] / a_determinant,
            slope_variance: a[0] / a_determinant,
            covariance: -a[2] / a_determinant,
        };
        fit_info_determinant = a_determinant;
    }
    let mut misfit = T::zero();
    for bin in 0..frame.bins {
        let signal = fit.log_power(tables, frame, bin).exp();
        let expected = signal + frame.noise_density * tables.noise[(bin, cell)];
        let determinant = signal + frame.noise_density * tables.determinant_noise[(bin, cell)];
        misfit += determinant.ln() + frame.power(bin, theta) / expected + tables.log_gain[(bin, cell)];
    }
    let (dc, dw) = (fit.level - prior.level, fit.slope - prior.slope);
    let distance = info[0] * dc * dc + T::lit(2.0) * info[2] * dc * dw + info[1] * dw * dw;
    // ½ ln det(P / P_post) = ½ ln(det P · det Λ_post)
    let occam = (determinant * fit_info_determinant).ln();
    (fit, -frame.weight * misfit - T::lit(0.5) * (distance + occam))
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
