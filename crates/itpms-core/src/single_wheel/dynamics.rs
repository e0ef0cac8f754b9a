//! How a tire's pressure and a road's level may change: five leak modes with drift and diffusion, three level modes
//! (docs/math/informed.md, section 3). Plain numbers and the matrices made from them.

use nalgebra::SMatrix;

use crate::memory::Blank;
use crate::real::Real;

pub(crate) const LEAK_MODES: usize = 5;
pub(crate) const LEVEL_MODES: usize = 3;
/// Cells that a mode's kernel reaches on each side.
pub(crate) const REACH: usize = 2;
/// Taps of a mode's kernel.
pub(crate) const TAPS: usize = 2 * REACH + 1;

pub(crate) const QUIET: usize = 0;
/// Index of the leak mode of a fast fall.
pub(crate) const FALL: usize = 2;
/// Index of the leak mode of re-inflation.
pub(crate) const RISE: usize = 3;
pub(crate) const CALM: usize = 0;
/// Index of the jumping road level mode.
pub(crate) const JUMP: usize = 2;

/// The pressure of the reference placard, which all numbers below are for; other tires scale with theirs.
pub(crate) const REFERENCE_KPA: f64 = 241.3;

/// Drift in kPa/s and diffusion in kPa/√s: quiet, active, fall, rise, slow fall.
const LEAKS: [(f64, f64); LEAK_MODES] = [(0.0, 0.2), (0.0, 2.0), (-50.0, 15.0), (8.0, 6.0), (-2.5, 2.5)];

/// Transition rates per second, from, to.
const LEAK_RATES: [(usize, usize, f64); 12] = [
    (0, 2, 0.02),
    (0, 3, 0.01),
    (0, 1, 0.005),
    (0, 4, 0.02),
    (2, 1, 0.3),
    (3, 1, 0.2),
    (1, 0, 0.03),
    (1, 2, 0.05),
    (1, 3, 0.15),
    (1, 4, 0.03),
    (4, 0, 0.05),
    (4, 2, 0.01),
];

/// Diffusion of the log level in 1/√s while calm and while drifting.
const LEVEL_DIFFUSION: [f64; LEVEL_MODES] = [0.01, 0.4, 0.4];
/// Variance that a jump adds per step to the log level and to the slope.
pub(crate) const JUMP_VARIANCE: [f64; 2] = [4.0, 0.01];
/// Slope: mean, stationary sd, relaxation time in s.
pub(crate) const SLOPE_MEAN: f64 = 2.2;
pub(crate) const SLOPE_SD: f64 = 0.4;
const SLOPE_RELAXATION_S: f64 = 500.0;
/// Squared enveloping length in (0.1 m)²: sd at the start, and diffusion in 1/√s (a soft tire has a longer patch).
pub(crate) const ENVELOPE_SD: f64 = 1.0;
const ENVELOPE_DIFFUSION: f64 = 0.005;

/// Everything a prediction step needs, made once for a step length.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Dynamics<T: Real> {
    /// Mode transitions per step, `[from][to]`.
    pub(crate) leak: [[T; LEAK_MODES]; LEAK_MODES],
    pub(crate) level: [[T; LEVEL_MODES]; LEVEL_MODES],
    /// Where a cell's mass goes in a step, per leak mode.
    pub(crate) kernel: [[T; TAPS]; LEAK_MODES],
    /// The same while nothing can be learned.
    pub(crate) hold_kernel: [T; TAPS],
    /// Variance of the log level per step, per level mode.
    pub(crate) level_variance: [T; LEVEL_MODES],
    /// Share of the slope's deviation left after a step, and the variance that comes in.
    pub(crate) slope_keep: T,
    pub(crate) slope_variance: T,
    /// Variance of the envelope parameter per step.
    pub(crate) envelope_variance: T,
}

impl<T: Real> Dynamics<T> {
    pub(crate) fn new(hop_s: f64) -> Self {
        let step_kpa = REFERENCE_KPA * crate::single_wheel::tables::STEP;
        let kernel =
            |drift: f64, diffusion: f64| kernel(drift * hop_s, diffusion * diffusion * hop_s, step_kpa);
        let keep = 1.0 - hop_s / SLOPE_RELAXATION_S;
        let (calm_out, drift_out, jump) = (0.005 * hop_s, 0.3 * hop_s, 0.003 * hop_s);
        let level = [
            [1.0 - calm_out - jump, calm_out, jump],
            [drift_out, 1.0 - drift_out - jump, jump],
            [0.5, 0.5, 0.0],
        ];
        Self {
            leak: leak_transitions(hop_s).map(|row| row.map(T::lit)),
            level: level.map(|row| row.map(T::lit)),
            kernel: LEAKS.map(|(drift, diffusion)| kernel(drift, diffusion).map(T::lit)),
            hold_kernel: kernel(0.0, 2.0).map(T::lit),
            level_variance: LEVEL_DIFFUSION.map(|sd| T::lit(sd * sd * hop_s)),
            slope_keep: T::lit(keep),
            slope_variance: T::lit(SLOPE_SD * SLOPE_SD * (1.0 - keep * keep)),
            envelope_variance: T::lit(ENVELOPE_DIFFUSION * ENVELOPE_DIFFUSION * hop_s),
        }
    }
}

/// `exp(Q h)` by its series: `Q h` is small.
fn leak_transitions(hop_s: f64) -> [[f64; LEAK_MODES]; LEAK_MODES] {
    let mut rate = SMatrix::<f64, LEAK_MODES, LEAK_MODES>::zeros();
    for (from, to, per_s) in LEAK_RATES {
        rate[(from, to)] += per_s * hop_s;
        rate[(from, from)] -= per_s * hop_s;
    }
    let (mut sum, mut term) = (SMatrix::identity(), SMatrix::<f64, LEAK_MODES, LEAK_MODES>::identity());
    for order in 1..12 {
        term = term * rate / f64::from(order);
        sum += term;
    }
    core::array::from_fn(|from| core::array::from_fn(|to| sum[(from, to)]))
}

/// Weights on cells -2 to 2 with the exact mean. Their variance is the one asked for and, where the shift is no whole
/// number of cells, `part (1 - part)` cells² more for the two points that it takes.
fn kernel(shift_kpa: f64, variance_kpa2: f64, step_kpa: f64) -> [f64; TAPS] {
    let shift = shift_kpa / step_kpa;
    let whole = nalgebra::ComplexField::floor(shift);
    let part = shift - whole;
    let spread = variance_kpa2 / (step_kpa * step_kpa);
    let side = 0.5 * spread.min(0.66);
    let mut taps = [0.0; TAPS];
    let mut add = |cell: f64, weight: f64| {
        let index = cell + REACH as f64;
        if index >= 0.0
            && let Some(tap) = taps.get_mut(index as usize)
        {
            *tap += weight;
        }
    };
    for (cell, weight) in [(whole, 1.0 - part), (whole + 1.0, part)] {
        add(cell - 1.0, weight * side);
        add(cell, weight * (1.0 - 2.0 * side));
        add(cell + 1.0, weight * side);
    }
    taps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mode_transitions_are_probabilities() {
        let dynamics = Dynamics::<f64>::new(0.1);
        for row in dynamics.leak.iter() {
            assert!(
                (row.iter().sum::<f64>() - 1.0).abs() < 1e-12
                    && row.iter().all(|&p| (0.0..=1.0).contains(&p))
            );
        }
        for row in dynamics.level.iter() {
            assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn kernels_keep_mass_and_mean() {
        let dynamics = Dynamics::<f64>::new(0.1);
        for (taps, (drift, _)) in dynamics.kernel.iter().zip(LEAKS) {
            let mass: f64 = taps.iter().sum();
            let mean: f64 = taps.iter().enumerate().map(|(i, w)| (i as f64 - REACH as f64) * w).sum();
            assert!((mass - 1.0).abs() < 1e-12);
            assert!((mean * 8.0 - drift * 0.1).abs() < 1e-9);
        }
    }
}
