//! Result of a damper's identification, and how well its runs agree.

use serde::Serialize;

use super::estimate::Estimate;

/// Damper parameters from sinusoidal excitation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DamperResult {
    /// Damping in N s/m: mean of both directions, friction separated.
    pub damping_n_s_per_m: Estimate,
    pub rising_n_s_per_m: Estimate,
    pub falling_n_s_per_m: Estimate,
    pub friction_n: Estimate,
    pub runs: Vec<RunResult>,
    /// Whether the runs agree; `None` for one run.
    pub consistency: Option<Consistency>,
    pub spring_n_per_m: Option<f64>,
    /// Whether force and displacement count in opposite directions.
    pub opposite_signs: bool,
    /// Groups of periods whose disagreement gives the standard errors.
    pub blocks: usize,
    pub rows: usize,
    /// Rows left out: after turning points, between the runs, or in no whole period.
    pub rows_left_out: usize,
    pub concerns: Vec<String>,
    /// Displacement in m, velocity in m/s, force in N and residual in N, run by run; for figures.
    #[serde(skip)]
    pub used: Vec<Vec<[f64; 4]>>,
}

/// One stretch of steady sine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunResult {
    pub record: String,
    pub frequency_hz: f64,
    pub amplitude_m: f64,
    pub velocity_m_s: f64,
    pub periods: usize,
    /// Damping in N s/m from this run alone, friction separated by the shape of the loop.
    pub damping_n_s_per_m: Estimate,
    pub friction_n: Estimate,
    /// Imaginary part of force over displacement at the frequency, over omega, in N s/m: friction counts as damping.
    pub equivalent_n_s_per_m: f64,
    /// Force in phase with the displacement in N/m, without the spring given: gas spring less moving mass times omega².
    pub in_phase_n_per_m: Estimate,
    pub residual_rms_n: f64,
    /// Root mean square departure of the displacement from a sine, as a share of its amplitude.
    pub distortion: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Consistency {
    pub chi_square: f64,
    pub friction_chi_square: f64,
    pub degrees_of_freedom: usize,
    /// Probability of a larger value for a linear damper.
    pub p: f64,
    pub friction_p: f64,
}
