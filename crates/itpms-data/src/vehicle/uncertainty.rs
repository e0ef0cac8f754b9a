//! Uncertainty of a corner's parameters in a vehicle file (docs/vehicle.md, section 3).

use itpms_core::model::{Confidence, ParameterUncertainty};

use super::details::CornerDetails;

/// The file's own figures; for what it leaves out those of its confidence.
pub(super) fn uncertainty(stated: &CornerDetails, confidence: Confidence) -> ParameterUncertainty<f64> {
    let usual = ParameterUncertainty::<f64>::of(confidence);
    ParameterUncertainty {
        sprung_mass_relative_sd: stated.sprung_mass_relative_sd.unwrap_or(usual.sprung_mass_relative_sd),
        unsprung_mass_relative_sd: stated
            .unsprung_mass_relative_sd
            .unwrap_or(usual.unsprung_mass_relative_sd),
        spring_relative_sd: stated.spring_relative_sd.unwrap_or(usual.spring_relative_sd),
        damping_relative_sd: stated.damping_relative_sd.unwrap_or(usual.damping_relative_sd),
        stiffness_relative_sd: stated.tire.stiffness_relative_sd.unwrap_or(usual.stiffness_relative_sd),
        stiffness_over_mass_relative_sd: stated.tire.stiffness_over_mass_relative_sd,
        friction_n: stated.friction_n.unwrap_or(usual.friction_n),
        friction_sd_n: stated.friction_sd_n.unwrap_or(usual.friction_sd_n),
        tire_damping_n_s_per_m: stated.tire_damping_n_s_per_m.unwrap_or(usual.tire_damping_n_s_per_m),
        tire_damping_sd_n_s_per_m: stated
            .tire_damping_sd_n_s_per_m
            .unwrap_or(usual.tire_damping_sd_n_s_per_m),
    }
}
