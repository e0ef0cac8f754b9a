//! Belief about the road under one hypothesis of the pressure: a Gaussian over its log level, its slope and
//! the length over which the tire averages it, and how a frame changes that belief (docs/math/informed.md, eq. 13-19).
//!
//! Called by the road fits, the posterior and the gate; knows nothing of probabilities of pressures.

use nalgebra::{Matrix3, SMatrix, Vector3};

use crate::memory::Blank;
use crate::real::{Real, SMALLEST};
use crate::single_wheel::BINS;
use crate::single_wheel::dynamics::{ENVELOPE_SD, SLOPE_MEAN, SLOPE_SD};
use crate::single_wheel::tables::{CELLS, CellTables, Tables};

const PARAMETERS: usize = 3;
/// Log of the velocity power density at 10 Hz, `c`.
pub(crate) const LEVEL: usize = 0;
/// Slope `w` of the displacement spectrum.
pub(crate) const SLOPE: usize = 1;
/// Squared length over which the tire averages the road, in units of (0.1 m)², `q`.
pub(crate) const ENVELOPE: usize = 2;

/// Bounds of the three, the largest variances they may have, and the largest step of one Gauss-Newton pass.
const LOWEST: [f64; PARAMETERS] = [-19.0, 1.0, -1.0];
const HIGHEST: [f64; PARAMETERS] = [20.0, 3.4, 20.0];
const LARGEST_VARIANCE: [f64; PARAMETERS] = [9.0, 0.25, 16.0];
const LARGEST_STEP: f64 = 1.0;
/// Steepest fall of the velocity power, as an exponent of frequency, that the window's tables are made for.
const STEEPEST: f64 = -3.0;

/// One frame, ready to be weighed: the road velocity reconstructed with `θ` has the power `a + 2 θ b + θ² c` per bin.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Evidence<T> {
    pub(crate) a: [T; BINS],
    pub(crate) b: [T; BINS],
    pub(crate) c: [T; BINS],
    /// Log power lost per unit of [`ENVELOPE`] in each bin, at the speed of this frame.
    pub(crate) envelope: [T; BINS],
    pub(crate) bins: usize,
    /// One-sided accelerometer noise density in (m/s²)²/Hz.
    pub(crate) noise_density: T,
    /// Exponent of the likelihood: overlap of the frames times the gates.
    pub(crate) weight: T,
}

impl<T: Real> Evidence<T> {
    /// Of this frame and another one: their powers' weighted mean, counted as often as both.
    pub(crate) fn with(&self, other: &Self) -> Self {
        let weight = self.weight + other.weight;
        if !(weight > T::zero()) {
            return *other;
        }
        let (one, two) = (self.weight / weight, other.weight / weight);
        let mean = |a: &[T; BINS], b: &[T; BINS]| core::array::from_fn(|bin| one * a[bin] + two * b[bin]);
        let bins = match (self.weight > T::zero(), other.weight > T::zero()) {
            (true, true) => self.bins.min(other.bins),
            (true, false) => self.bins,
            _ => other.bins,
        };
        Self {
            a: mean(&self.a, &other.a),
            b: mean(&self.b, &other.b),
            c: mean(&self.c, &other.c),
            envelope: mean(&self.envelope, &other.envelope),
            bins,
            noise_density: self.noise_density,
            weight,
        }
    }

    /// Power density of the road velocity reconstructed with `theta`.
    fn power(&self, bin: usize, theta: T) -> T {
        let power = self.a[bin] + theta * (T::lit(2.0) * self.b[bin] + theta * self.c[bin]);
        power.at_least(T::lit(1e-24))
    }

    /// Power densities of the road velocity reconstructed with the stiffness of a cell.
    pub(crate) fn powers(&self, tables: &Tables<T>, cell: usize) -> [T; BINS] {
        let theta = tables.theta[cell.min(CELLS - 1)];
        core::array::from_fn(|bin| self.power(bin, theta))
    }

    pub(crate) fn read(&self, tables: &Tables<T>, cell: usize) -> Reading<T> {
        let mut of_cell = tables.of_cell(cell);
        of_cell.noise.iter_mut().for_each(|noise| *noise *= self.noise_density);
        of_cell.determinant_noise.iter_mut().for_each(|noise| *noise *= self.noise_density);
        Reading { power: self.powers(tables, cell), expected: of_cell }
    }
}

/// A frame under one cell's stiffness, whatever the road: power densities per bin.
pub(crate) struct Reading<T> {
    /// Of the reconstructed road velocity.
    pub(crate) power: [T; BINS],
    /// The expected frame, with the noise of these sensors.
    pub(crate) expected: CellTables<T>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Road<T: Real> {
    pub(crate) mean: Vector3<T>,
    pub(crate) covariance: Matrix3<T>,
}

impl<T: Real> Road<T> {
    /// Prior, with a level guessed from outside.
    pub(crate) fn unknown(level: T) -> Self {
        let variance = [LARGEST_VARIANCE[LEVEL], SLOPE_SD * SLOPE_SD, ENVELOPE_SD * ENVELOPE_SD];
        Self {
            mean: Vector3::new(level.max(T::lit(LOWEST[LEVEL])), T::lit(SLOPE_MEAN), T::zero()),
            covariance: Matrix3::from_diagonal(&Vector3::from(variance.map(T::lit))),
        }
    }

    /// Exponent of the velocity power around a bin: the power law's and what enveloping adds to it.
    fn exponent(&self, frame: &Evidence<T>, bin: usize) -> T {
        let local = T::lit(2.0) * (T::one() - self.mean[ENVELOPE] * frame.envelope[bin]) - self.mean[SLOPE];
        local.at_least(T::lit(STEEPEST))
    }

    /// Log of the road's power density in a bin, as the sensors see it.
    fn log_power(&self, tables: &Tables<T>, frame: &Evidence<T>, bin: usize) -> T {
        let power_law = (T::lit(2.0) - self.mean[SLOPE]) * tables.log_frequency[bin];
        self.mean[LEVEL] + power_law - self.mean[ENVELOPE] * frame.envelope[bin]
            + tables.log_window(bin, self.exponent(frame, bin))
    }

    /// Length in m over which the tire averages the road at most, as far as is known: one sd above the mean.
    pub(crate) fn longest_envelope_m(&self) -> T {
        let sd = self.covariance[(ENVELOPE, ENVELOPE)].max(T::zero()).sqrt();
        T::lit(0.1) * (self.mean[ENVELOPE] + sd).max(T::lit(1e-4)).sqrt()
    }

    /// Keeps the mean inside its bounds; what is moved takes the others along as their covariance says.
    pub(crate) fn clamp(&mut self) {
        let bounds = [0, 1, 2].map(|i| [LOWEST[i], HIGHEST[i]].map(T::lit));
        for (i, [lowest, highest]) in bounds.into_iter().enumerate() {
            let excess = self.mean[i].clamp(lowest, highest) - self.mean[i];
            if excess != T::zero() {
                self.mean += self.covariance.column(i) * (excess / self.covariance[(i, i)]);
            }
        }
    }

    /// Keeps the variances inside their bounds; shrinks rows and columns alike, so that the covariance stays positive.
    pub(crate) fn cap_variance(&mut self) {
        for (i, largest) in LARGEST_VARIANCE.map(T::lit).into_iter().enumerate() {
            let variance = self.covariance[(i, i)];
            if variance > largest {
                let shrink = (largest / variance).sqrt();
                self.covariance.row_mut(i).scale_mut(shrink);
                self.covariance.column_mut(i).scale_mut(shrink);
            }
        }
    }

    /// The road's power density in every bin in use, as the sensors see it.
    pub(crate) fn powers(&self, frame: &Evidence<T>, tables: &Tables<T>) -> [T; BINS] {
        let mut powers = [T::zero(); BINS];
        for (bin, power) in powers.iter_mut().enumerate().take(frame.bins) {
            *power = self.log_power(tables, frame, bin).exp_fast();
        }
        powers
    }

    /// The same at the level at which a frame's mean power is as expected: where it has jumped, Gauss and Newton's steps are too short.
    pub(crate) fn as_loud_as(
        mut self,
        frame: &Evidence<T>,
        reading: &Reading<T>,
        tables: &Tables<T>,
    ) -> Self {
        let expected = self.powers(frame, tables).into_iter().zip(&reading.expected.noise);
        let ratio = |(signal, noise): (T, &T), power: T| power / (signal + *noise);
        let all = expected.zip(reading.power).take(frame.bins);
        let sum = all.fold(T::zero(), |sum, (expected, power)| sum + ratio(expected, power));
        self.mean[LEVEL] += (sum / T::lit(frame.bins as f64)).at_least(T::lit(1e-6)).ln_fast();
        self.clamp();
        self
    }

    /// Score and Fisher information of the road's parameters for one frame.
    fn score(
        &self,
        frame: &Evidence<T>,
        reading: &Reading<T>,
        tables: &Tables<T>,
    ) -> (Vector3<T>, Matrix3<T>) {
        let signal = self.powers(frame, tables);
        let (zero, mut score) = (T::zero(), Vector3::zeros());
        let [mut cc, mut cw, mut cq, mut ww, mut wq, mut qq] = [zero; 6];
        for (bin, &signal) in signal.iter().enumerate().take(frame.bins) {
            let share = T::one() / (signal + reading.expected.noise[bin]);
            let excess = reading.power[bin] * share - T::one();
            // ∂ ln M / ∂(c, w, q) = S/M (1, -ln(f/10), -envelope); what the window adds hardly changes.
            let level = signal * share;
            let (slope, envelope) = (-level * tables.log_frequency[bin], -level * frame.envelope[bin]);
            score += Vector3::new(level, slope, envelope) * excess;
            (cc, cw, cq) = (cc + level * level, cw + level * slope, cq + level * envelope);
            (ww, wq, qq) = (ww + slope * slope, wq + slope * envelope, qq + envelope * envelope);
        }
        (score, Matrix3::new(cc, cw, cq, cw, ww, wq, cq, wq, qq))
    }

    /// `Σ ln(S + N_d) + |V|²/M + ln|H|²`: the frame's negative log-likelihood.
    fn misfit(&self, frame: &Evidence<T>, reading: &Reading<T>, tables: &Tables<T>, prior: &Self) -> T {
        let signal = self.powers(frame, tables);
        let (mut misfit, mut pair) = (T::zero(), T::one());
        for (bin, &signal) in signal.iter().enumerate().take(frame.bins) {
            let log_gain = reading.expected.log_gain(bin, prior.exponent(frame, bin));
            misfit += reading.power[bin] / (signal + reading.expected.noise[bin]) + log_gain;
            // One logarithm for two bins; more would leave the range of f32.
            pair *= signal + reading.expected.determinant_noise[bin];
            if bin % 2 == 1 || bin + 1 == frame.bins {
                misfit += pair.at_least(T::lit(1e-37)).ln_fast();
                pair = T::one();
            }
        }
        misfit
    }
}

/// What the cells of a level mode believe of the road before a frame, but for the mean: one covariance, and what is made of it.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RoadPrior<T: Real> {
    information: Matrix3<T>,
    log_determinant: T,
}

pub(crate) struct Fitted<T: Real> {
    pub(crate) road: Road<T>,
    pub(crate) log_evidence: T,
}

impl<T: Real> RoadPrior<T> {
    /// `None` where the covariance has lost its rank.
    pub(crate) fn new(covariance: &Matrix3<T>) -> Option<Self> {
        let log_determinant = covariance.determinant().at_least(T::lit(SMALLEST)).ln_fast();
        covariance.try_inverse().map(|information| Self { information, log_determinant })
    }

    /// Fits the road to a frame under one cell's stiffness (two Gauss-Newton passes from a road near it).
    pub(crate) fn fit(
        &self,
        prior: &Road<T>,
        mut road: Road<T>,
        frame: &Evidence<T>,
        reading: &Reading<T>,
        tables: &Tables<T>,
    ) -> Fitted<T> {
        for _ in 0..2 {
            let (score, information) = road.score(frame, reading, tables);
            let slope = score * frame.weight + self.information * (prior.mean - road.mean);
            let Some(covariance) = (information * frame.weight + self.information).try_inverse() else {
                let misfit = prior.misfit(frame, reading, tables, prior);
                return Fitted { road: *prior, log_evidence: -frame.weight * misfit };
            };
            let largest = T::lit(LARGEST_STEP);
            road.mean += (covariance * slope).map(|step| step.clamp(-largest, largest));
            road.covariance = covariance;
            road.clamp();
        }
        let d = road.mean - prior.mean;
        let distance = d.dot(&(self.information * d));
        let misfit = road.misfit(frame, reading, tables, prior);
        let log_evidence = -frame.weight * misfit - T::lit(0.5) * (distance + self.occam(&road.covariance));
        Fitted { road, log_evidence }
    }

    /// `ln det(P / P_post)`: what a frame's fit costs for having been free.
    fn occam(&self, fitted: &Matrix3<T>) -> T {
        self.log_determinant - fitted.determinant().at_least(T::lit(SMALLEST)).ln_fast()
    }

    /// The belief and the evidence that this wider prior comes to by a frame that is as `other` had expected it, given the other's fit:
    /// both have the same likelihood then, and the wider one pays for its freedom.
    pub(crate) fn as_expected(&self, other: &Self, fitted: &Matrix3<T>) -> Option<(Matrix3<T>, T)> {
        let likelihood = fitted.try_inverse()? - other.information;
        let covariance = (likelihood + self.information).try_inverse()?;
        let log_evidence = T::lit(0.5) * (other.occam(fitted) - self.occam(&covariance));
        Some((covariance, log_evidence))
    }
}

/// The roads of all cells of a level mode: a mean for every cell, and one covariance, that of the most likely cell.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RoadBelief<T: Real> {
    pub(crate) mean: SMatrix<T, PARAMETERS, CELLS>,
    pub(crate) covariance: Matrix3<T>,
}

impl<T: Real> RoadBelief<T> {
    /// The same belief everywhere.
    pub(crate) fn fill(&mut self, road: &Road<T>) {
        self.mean.column_iter_mut().for_each(|mut mean| mean.copy_from(&road.mean));
        self.covariance = road.covariance;
    }

    pub(crate) fn get(&self, cell: usize) -> Road<T> {
        Road { mean: self.mean(cell), covariance: self.covariance }
    }

    pub(crate) fn mean(&self, cell: usize) -> Vector3<T> {
        let cell = cell.min(CELLS - 1);
        Vector3::from_fn(|i, _| self.mean[(i.min(2), cell)])
    }

    pub(crate) fn set_mean(&mut self, cell: usize, mean: &Vector3<T>) {
        self.mean.set_column(cell.min(CELLS - 1), mean);
    }
}

pub(crate) struct MeanMatch<T: Real> {
    reference: Vector3<T>,
    weight: T,
    first: Vector3<T>,
}

impl<T: Real> MeanMatch<T> {
    /// Sums are kept relative to `reference`, so that f32 keeps its digits.
    pub(crate) fn around(reference: Vector3<T>) -> Self {
        Self { reference, weight: T::zero(), first: Vector3::zeros() }
    }

    pub(crate) fn add(&mut self, weight: T, mean: &Vector3<T>) {
        self.weight += weight;
        self.first += (mean - self.reference) * weight;
    }

    /// The reference where there is no weight.
    pub(crate) fn finish(&self) -> Vector3<T> {
        match self.weight > T::zero() {
            true => self.reference + self.first * (T::one() / self.weight),
            false => self.reference,
        }
    }
}

pub(crate) fn matched_covariance<T: Real>(mixture: &[(T, Road<T>)]) -> Option<Matrix3<T>> {
    let reference = mixture.first()?.1.mean;
    let (mut weight, mut first, mut second) = (T::zero(), Vector3::zeros(), Matrix3::zeros());
    for (share, road) in mixture {
        let d = road.mean - reference;
        weight += *share;
        first += d * *share;
        second += (road.covariance + d * d.transpose()) * *share;
    }
    let mean = first / weight;
    (weight > T::zero()).then(|| second / weight - mean * mean.transpose())
}
