//! Configuration of a published filter: initial state, covariances, and which reading of the
//! equations that can be read in two ways. Presets hold the paper's numbers.
//!
//! Used by [`crate::aekf_ui`]; knows nothing of the recursion.

use nalgebra::{Vector2, Vector5};

use crate::quarter_car::state;
use itpms_core::Real;
use itpms_core::model::{ParameterError, positive};

/// Which input estimate the correction of eq. (17) subtracts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CorrectionInput {
    /// `y - h(x⁻, u*_k)`, the new estimate: Yang, Pan and Huang (2007), whom the paper cites for the filter.
    #[default]
    Current,
    /// `y - h(x⁻, u*_{k-1})`, the previous one: eq. (17) as printed.
    Previous,
}

/// Which step's forgetting factor weights the prior covariance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FactorTiming {
    /// `lambda_{k-1}`, eq. (18) as printed.
    #[default]
    Previous,
    /// `lambda_k`, which the derivation in eq. (36) puts there.
    Same,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Forgetting<T> {
    /// `lambda = 1`: the EKF-UI (eq. 6-17).
    None,
    /// The one-step factor (eq. 28-33).
    #[default]
    OneStep,
    /// The iterative factor (eq. 25-27).
    Iterative(GradientDescent<T>),
}

/// Settings of the iterative factor. The paper gives no value for any of them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GradientDescent<T> {
    /// Step length `phi` of eq. (25) times the curvature `|dT/dlambda|²`, so that it has no unit; 1 is a Gauss-Newton step, less is damped.
    pub relative_step: T,
    /// `epsilon` of eq. (26): stop when the factor moves less than this.
    pub tolerance: T,
    /// Give up after this many iterations and use the last one.
    pub max_iterations: u16,
}

impl<T: Real> Default for GradientDescent<T> {
    fn default() -> Self {
        Self { relative_step: T::lit(0.5), tolerance: T::lit(1e-3), max_iterations: 50 }
    }
}

/// Everything a published filter needs besides the quarter car. All covariances are diagonal in the paper and here.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FilterConfig<T: Real> {
    /// `x_0` in the order and units of [`state`].
    pub initial_state: Vector5<T>,
    /// Diagonal of `P_0`, in the squared units of the state.
    pub initial_variance: Vector5<T>,
    /// `u*_0`: the road's height in m. (`S_0`, which eq. (12) also names, enters no later equation.)
    pub initial_road_m: T,
    /// Diagonal of `Q`, per step.
    pub process_variance: Vector5<T>,
    /// Diagonal of `R` in (m/s²)².
    pub measurement_variance: Vector2<T>,
    /// The reading of eq. (17).
    pub correction_input: CorrectionInput,
    /// How `lambda` is found.
    pub forgetting: Forgetting<T>,
    /// The reading of eq. (18).
    pub factor_timing: FactorTiming,
}

impl<T: Real> FilterConfig<T> {
    /// The paper's simulation study (Sec. 4): `x_0 = [0 0 0 0 220000]`, `P_0 = diag(1, 1, 1, 1, 1e5)`,
    /// `Q = 1e-10 I`, `R = 0.5 I`, one-step forgetting.
    pub fn paper_simulation() -> Self {
        Self::paper(220_000.0, 1e5, 1e-10, 0.5)
    }

    /// The paper's test bed (Sec. 5.1): `x_0 = [0 0 0 0 200000]`, `P_0 = diag(1, 1, 1, 1, 10)`, `Q = 1e-8 I`,
    /// `R = 10 I`, one-step forgetting.
    pub fn paper_bench() -> Self {
        Self::paper(200_000.0, 10.0, 1e-8, 10.0)
    }

    fn paper(stiffness: f64, stiffness_variance: f64, process: f64, measurement: f64) -> Self {
        let mut initial_state = Vector5::zeros();
        initial_state[state::TIRE_STIFFNESS] = T::lit(stiffness);
        let mut initial_variance = Vector5::repeat(T::one());
        initial_variance[state::TIRE_STIFFNESS] = T::lit(stiffness_variance);
        Self {
            initial_state,
            initial_variance,
            initial_road_m: T::zero(),
            process_variance: Vector5::repeat(T::lit(process)),
            measurement_variance: Vector2::repeat(T::lit(measurement)),
            correction_input: CorrectionInput::default(),
            forgetting: Forgetting::default(),
            factor_timing: FactorTiming::default(),
        }
    }

    /// The same with another way to find the factor; [`Forgetting::None`] makes it the EKF-UI.
    pub fn with_forgetting(self, forgetting: Forgetting<T>) -> Self {
        Self { forgetting, ..self }
    }

    /// The same with the other reading of eq. (17).
    pub fn with_correction_input(self, correction_input: CorrectionInput) -> Self {
        Self { correction_input, ..self }
    }

    /// The same with the other reading of eq. (18).
    pub fn with_factor_timing(self, factor_timing: FactorTiming) -> Self {
        Self { factor_timing, ..self }
    }

    /// The same from another initial stiffness in N/m.
    pub fn with_initial_stiffness(mut self, stiffness_n_per_m: T) -> Self {
        self.initial_state[state::TIRE_STIFFNESS] = stiffness_n_per_m;
        self
    }

    /// Itself, if a filter can start from it. Errors: names the first value that is not finite, or not positive where it must be:
    /// variances, the initial stiffness, the descent's settings.
    pub fn validated(self) -> Result<Self, ParameterError> {
        for value in self.initial_state.iter().copied() {
            finite("initial_state", value)?;
        }
        finite("initial_road_m", self.initial_road_m)?;
        positive("initial stiffness in N/m", self.initial_state[state::TIRE_STIFFNESS])?;
        for (name, values) in
            [("initial_variance", &self.initial_variance), ("process_variance", &self.process_variance)]
        {
            for value in values.iter().copied() {
                positive(name, value)?;
            }
        }
        for value in self.measurement_variance.iter().copied() {
            positive("measurement_variance", value)?;
        }
        if let Forgetting::Iterative(descent) = self.forgetting {
            positive("relative_step", descent.relative_step)?;
            positive("tolerance", descent.tolerance)?;
            positive("max_iterations", T::lit(f64::from(descent.max_iterations)))?;
        }
        Ok(self)
    }
}

fn finite<T: Real>(name: &'static str, value: T) -> Result<T, ParameterError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ParameterError { name, value: value.to_f64(), expected: "a finite number" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_presets_are_the_papers_numbers_and_valid() {
        let simulation = FilterConfig::<f64>::paper_simulation().validated().unwrap();
        assert_eq!(simulation.initial_state, Vector5::new(0.0, 0.0, 0.0, 0.0, 220_000.0));
        assert_eq!(simulation.initial_variance, Vector5::new(1.0, 1.0, 1.0, 1.0, 1e5));
        assert_eq!(simulation.process_variance, Vector5::repeat(1e-10));
        assert_eq!(simulation.measurement_variance, Vector2::repeat(0.5));
        let bench = FilterConfig::<f64>::paper_bench().validated().unwrap();
        assert_eq!(bench.initial_state[4], 200_000.0);
        assert_eq!(bench.initial_variance, Vector5::new(1.0, 1.0, 1.0, 1.0, 10.0));
        assert_eq!(bench.process_variance, Vector5::repeat(1e-8));
        assert_eq!(bench.measurement_variance, Vector2::repeat(10.0));
    }

    #[test]
    fn what_no_filter_can_start_from_is_named() {
        let good = FilterConfig::<f64>::paper_simulation();
        let name = |config: FilterConfig<f64>| config.validated().unwrap_err().name;
        assert_eq!(name(good.with_initial_stiffness(-1.0)), "initial stiffness in N/m");
        assert_eq!(name(good.with_initial_stiffness(f64::NAN)), "initial_state");
        assert_eq!(name(FilterConfig { initial_road_m: f64::INFINITY, ..good }), "initial_road_m");
        assert_eq!(name(FilterConfig { initial_variance: Vector5::zeros(), ..good }), "initial_variance");
        assert_eq!(
            name(FilterConfig { process_variance: -Vector5::repeat(1.0), ..good }),
            "process_variance"
        );
        assert_eq!(
            name(FilterConfig { measurement_variance: Vector2::repeat(f64::NAN), ..good }),
            "measurement_variance"
        );
        let descent = GradientDescent { max_iterations: 0, ..GradientDescent::default() };
        assert_eq!(name(good.with_forgetting(Forgetting::Iterative(descent))), "max_iterations");
    }
}
