//! The vehicle's parameters, how well each is known and from where, and what of the result rests on it.
//!
//! Called by the page's writer. A wheel shows stiffness over mass, so a per cent of either is `p + k(0)/slope` over a hundred
//! (docs/math/unknown-car.md, eq. 6).

use std::fmt::Write as _;

use itpms_core::model::{CornerConfig, Level, PressureUnit};

use super::words::corner_name;
use super::{CornerReport, ReportData};
use crate::plot::escape;

itpms_core::labelled! {
    /// In the order of the table.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Parameter {
        TireOverMass = "Tire stiffness over unsprung mass",
        UnsprungMass = "Unsprung mass",
        Tire = "Tire stiffness at placard pressure",
        Slope = "Slope of stiffness over pressure",
        Damping = "Damping",
        Friction = "Friction of the strut",
        Spring = "Spring",
        SprungMass = "Sprung mass",
        TireDamping = "Damping of the tire",
    }
}

impl Parameter {
    fn unit(self) -> &'static str {
        match self {
            Self::SprungMass | Self::UnsprungMass => "kg",
            Self::Tire | Self::Spring => "kN/m",
            Self::TireOverMass => "1/s²",
            Self::Slope => "N/m per kPa",
            Self::Damping | Self::TireDamping => "N s/m",
            Self::Friction => "N",
        }
    }

    fn value(self, config: &CornerConfig<f64>) -> [f64; 2] {
        let (car, tire, known) = (&config.quarter_car, &config.tire, &config.uncertainty);
        let stiffness = tire.stiffness_n_per_m(config.placard_kpa);
        let share = |value: f64, sd: f64| [value, value * sd];
        match self {
            Self::SprungMass => share(car.sprung_mass_kg(), known.sprung_mass_relative_sd),
            Self::UnsprungMass => share(car.unsprung_mass_kg(), known.unsprung_mass_relative_sd),
            Self::Tire => share(1e-3 * stiffness, known.stiffness_relative_sd),
            Self::TireOverMass => share(stiffness / car.unsprung_mass_kg(), known.tire_relative_sd()),
            Self::Slope => [tire.stiffness_per_kpa(), tire.stiffness_per_kpa_sd()],
            Self::Damping => share(car.damping_n_s_per_m(), known.damping_relative_sd),
            Self::Spring => share(1e-3 * car.spring_n_per_m(), known.spring_relative_sd),
            Self::Friction => [known.friction_n, known.friction_sd_n],
            Self::TireDamping => [known.tire_damping_n_s_per_m, known.tire_damping_sd_n_s_per_m],
        }
    }

    /// What of the result rests on it, for a car whose level is a calibration's or the file's. Figures are those of the first corner.
    fn worth(self, corner: &CornerReport, unit: PressureUnit) -> String {
        let config = &corner.config;
        let lever_kpa =
            config.placard_kpa + config.tire.stiffness_at_zero() / config.tire.stiffness_per_kpa();
        let fifth_kpa = 0.2 * config.placard_kpa;
        let sd = config.uncertainty.tire_relative_sd();
        let (per_cent, of_fifth) = (unit.number(0.01 * lever_kpa, 1), unit.number(0.01 * fifth_kpa, 1));
        match (self, corner.level) {
            (Self::TireOverMass, Some(Level::Calibration | Level::StoredCalibration)) => format!(
                "a change since the calibration: {} {unit} (sd) of a loss of a fifth; the level is the calibration's",
                unit.number(sd * fifth_kpa, 1)
            ),
            (Self::TireOverMass, _) => {
                format!(
                    "the level of every pressure: {} {unit} (sd), until a calibration sets it",
                    unit.number(sd * lever_kpa, 0)
                )
            }
            (Self::UnsprungMass, Some(Level::Calibration | Level::StoredCalibration)) => {
                format!("1 % of it is {of_fifth} {unit} of a loss of a fifth")
            }
            (Self::Tire, Some(Level::Calibration | Level::StoredCalibration)) => {
                format!("1 % of it is {of_fifth} {unit} of a loss of a fifth, the other way")
            }
            (Self::UnsprungMass, _) => format!("1 % of it is {per_cent} {unit}"),
            (Self::Tire, _) => format!("1 % of it is {per_cent} {unit}, the other way"),
            (Self::Slope, _) => {
                format!("1 % of it is {of_fifth} {unit} of a loss of a fifth")
            }
            (Self::Damping, _) => "where the estimate begins: found on the way".into(),
            (Self::Friction, _) => "nothing: found from the body's motion".into(),
            (Self::Spring, _) => "little: it acts below the frequencies that show the tire".into(),
            (Self::SprungMass, _) => "little: the load is found on the way".into(),
            (Self::TireDamping, _) => "not used".into(),
        }
    }
}

/// The section; empty where there are no corners.
pub(super) fn section(data: &ReportData) -> String {
    let Some(first) = data.corners.first() else { return String::new() };
    let source = |parameter: Parameter| {
        data.provenance
            .sources
            .iter()
            .find(|(of, _)| *of == parameter)
            .map_or("–", |(_, source)| source.as_str())
    };
    let mut out = String::from(
        "<details class=\"fold\" id=\"parameters\"><summary><h2>The vehicle's parameters</h2></summary><p class=\"verdict\">What the estimate takes for the car, \
         ± one standard deviation, and what of the result rests on it.</p>\
         <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Parameters\"><table class=\"figures\"><thead><tr><td></td>",
    );
    for corner in &data.corners {
        let _ = write!(out, "<th scope=\"col\">{}</th>", corner_name(corner.corner));
    }
    out.push_str("<th scope=\"col\">From</th><th scope=\"col\">Rests on it</th></tr></thead><tbody>\n");
    for parameter in Parameter::ALL {
        let _ = write!(
            out,
            "<tr><th scope=\"row\">{}<small>{}</small></th>",
            parameter.label(),
            parameter.unit()
        );
        for corner in &data.corners {
            let _ = write!(out, "<td>{}</td>", shown(parameter.value(&corner.config)));
        }
        let _ = writeln!(
            out,
            "<td>{}</td><td>{}</td></tr>",
            escape(source(parameter)),
            parameter.worth(first, data.pressure_unit)
        );
    }
    out.push_str("</tbody></table></div></details>\n");
    out
}

/// As many digits as the standard deviation has two of; a value that is taken as exact has four.
fn shown([value, sd]: [f64; 2]) -> String {
    if !(sd > 0.0) {
        return format!("{value:.1}");
    }
    let decimals = (1.0 - sd.log10().floor()).clamp(0.0, 3.0) as usize;
    format!("{value:.decimals$} ± {sd:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_the_digits_of_its_deviation() {
        assert_eq!(shown([56.9, 2.845]), "56.9 ± 2.8");
        assert_eq!(shown([4097.5, 239.0]), "4098 ± 239");
        assert_eq!(shown([713.91, 0.0]), "713.9");
    }
}
