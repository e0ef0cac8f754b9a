//! Results as lines for people. Called by the binary; scripts read the JSON.

use std::fmt::Write as _;

use super::calibrate::Calibration;
use super::damper_result::DamperResult;
use super::estimate::Estimate;
use super::spring::SpringResult;

/// Rows of a table of tire tests that a terminal shows.
const MOST_ROWS: usize = 60;

/// Digits after the point for which the standard error has two significant ones, at most six.
fn decimals(standard_error: f64) -> usize {
    if !(standard_error > 0.0 && standard_error.is_finite()) {
        return 3;
    }
    let digits = 1.0 - standard_error.log10().floor();
    if digits > 0.0 { (digits as usize).min(6) } else { 0 }
}

pub(super) fn shown(estimate: &Estimate) -> String {
    let digits = decimals(estimate.standard_error);
    format!("{:.digits$} ± {:.digits$}", estimate.value, estimate.standard_error)
}

pub(super) fn interval((low, high): (f64, f64), standard_error: f64) -> String {
    let digits = decimals(standard_error);
    format!("95 %: {low:.digits$} to {high:.digits$}")
}

pub(super) fn line(out: &mut String, name: &str, value: &str, remark: &str) {
    let text = format!("{name:<24} {value:<28} {remark}");
    let _ = writeln!(out, "{}", text.trim_end());
}

pub(super) fn estimate_line(out: &mut String, name: &str, estimate: &Estimate, unit: &str) {
    let value = format!("{} {unit}", shown(estimate));
    line(out, name, value.trim_end(), &interval(estimate.interval_95(), estimate.standard_error));
}

pub(super) fn ending(out: &mut String, concerns: &[String]) {
    if concerns.is_empty() {
        line(out, "concerns", "none", "");
    }
    for concern in concerns {
        let _ = writeln!(out, "concern: {concern}");
    }
}

impl SpringResult {
    pub fn table(&self) -> String {
        let mut out = String::new();
        estimate_line(&mut out, "spring stiffness ks", &self.stiffness_n_per_m, "N/m");
        if let Some(friction) = &self.friction_n {
            line(&mut out, "friction", &format!("{} N", shown(friction)), "half the height of the loop");
        }
        let load = format!("{:.1} N", self.load_at_zero_n);
        line(&mut out, "load at zero", &load, "preload, midway between the directions");
        if let (Some(up), Some(down)) = self.rising_falling_n_per_m {
            line(&mut out, "rising / falling", &format!("{up:.0} / {down:.0} N/m"), "stiffness by direction");
        }
        if let Some(bend) = &self.nonlinearity {
            let [low, middle, high] = bend.tangent_n_per_m;
            let value = format!("{:.2} % of the load", bend.percent);
            let verdict = if bend.significant { "significant" } else { "within noise" };
            let remark = format!("{verdict}; {low:.0} / {middle:.0} / {high:.0} N/m at low / middle / high");
            line(&mut out, "nonlinearity", &value, &remark);
        }
        line(&mut out, "residual", &format!("{:.2} N rms", self.residual_rms_n), "");
        let travel = format!("{:.4} to {:.4} m", self.travel_m.0, self.travel_m.1);
        line(&mut out, "travel used", &travel, &format!("{} strokes", self.strokes));
        let rows = format!("{} used, {} left out", self.rows, self.rows_left_out);
        line(&mut out, "rows", &rows, "left out: next to turning points");
        line(&mut out, "standard error from", &self.error_basis.to_string(), "");
        if self.opposite_signs {
            line(&mut out, "signs", "opposite", "the load falls as the displacement grows");
        }
        ending(&mut out, &self.concerns);
        out
    }
}

impl DamperResult {
    /// A block about the damper and a line per run.
    pub fn table(&self) -> String {
        let mut out = String::new();
        estimate_line(&mut out, "damping cs", &self.damping_n_s_per_m, "N s/m");
        line(&mut out, "displacement grows", &format!("{} N s/m", shown(&self.rising_n_s_per_m)), "");
        line(&mut out, "displacement falls", &format!("{} N s/m", shown(&self.falling_n_s_per_m)), "");
        line(&mut out, "friction", &format!("{} N", shown(&self.friction_n)), "");
        if let Some(test) = &self.consistency {
            let value =
                format!("chi² {:.2}, dof {}, p {:.3}", test.chi_square, test.degrees_of_freedom, test.p);
            line(&mut out, "runs agree: damping", &value, "a linear damper has p above 0.01");
            let (friction, dof) = (test.friction_chi_square, test.degrees_of_freedom);
            let value = format!("chi² {friction:.2}, dof {dof}, p {:.3}", test.friction_p);
            line(&mut out, "runs agree: friction", &value, "");
        }
        if let Some(spring) = self.spring_n_per_m {
            line(&mut out, "spring subtracted", &format!("{spring} N/m"), "");
        }
        let rows = format!("{} used, {} left out", self.rows, self.rows_left_out);
        line(&mut out, "rows", &rows, "left out: after turning points, between runs");
        let basis = format!("how much {} blocks disagree", self.blocks);
        line(&mut out, "standard error from", &basis, "blocks of whole periods");
        if self.opposite_signs {
            line(&mut out, "signs", "opposite", "the force counts against the displacement");
        }
        self.runs_table(&mut out);
        ending(&mut out, &self.concerns);
        out
    }

    fn runs_table(&self, out: &mut String) {
        let _ = writeln!(
            out,
            "\n{:>9} {:>9} {:>9} {:>7} {:>18} {:>16} {:>11} {:>16} {:>9}",
            "frequency",
            "amplitude",
            "velocity",
            "periods",
            "damping alone",
            "friction alone",
            "Im F/x / w",
            "in phase",
            "residual"
        );
        let _ = writeln!(
            out,
            "{:>9} {:>9} {:>9} {:>7} {:>18} {:>16} {:>11} {:>16} {:>9}",
            "Hz", "m", "m/s", "", "N s/m", "N", "N s/m", "N/m", "N rms"
        );
        for run in &self.runs {
            let _ = writeln!(
                out,
                "{:>9.4} {:>9.5} {:>9.4} {:>7} {:>18} {:>16} {:>11.1} {:>16} {:>9.2}  {}",
                run.frequency_hz,
                run.amplitude_m,
                run.velocity_m_s,
                run.periods,
                shown(&run.damping_n_s_per_m),
                shown(&run.friction_n),
                run.equivalent_n_s_per_m,
                shown(&run.in_phase_n_per_m),
                run.residual_rms_n,
                run.record
            );
        }
        out.push('\n');
    }
}

impl Calibration {
    /// The line, its tests and the residuals.
    pub fn table(&self) -> String {
        let mut out = String::new();
        let (slope, zero) = (&self.stiffness_per_kpa, &self.stiffness_at_zero);
        for (name, c, unit) in [("slope", slope, "N/m per kPa"), ("stiffness at zero", zero, "N/m")] {
            let digits = decimals(c.standard_error);
            let value = format!("{:.digits$} ± {:.digits$} {unit}", c.value, c.standard_error);
            line(&mut out, name, &value, &interval(c.interval_95, c.standard_error));
        }
        line(&mut out, "correlation", &format!("{:.4}", self.correlation), "of the two");
        line(&mut out, "R²", &format!("{:.6}", self.r_squared), "");
        let residual = format!("{:.1} N/m", self.residual_sd_n_per_m);
        let in_kpa = format!("standard deviation; {:.2} kPa", self.residual_sd_kpa);
        line(&mut out, "residual", &residual, &in_kpa);
        line(&mut out, "rows", &format!("{}, {} pressures", self.rows.len(), self.pressures), "");
        for (name, test, remark) in [
            ("lack of fit", &self.lack_of_fit, "means of repeats about the line"),
            ("curvature", &self.curvature, "a parabola against the line"),
        ] {
            let value = match test {
                Some(test) => {
                    let (upper, lower) = test.degrees_of_freedom;
                    format!("F({upper},{lower}) {:.2}, p {:.3}", test.f, test.p)
                }
                None => "not testable with these rows".to_owned(),
            };
            line(&mut out, name, &value, remark);
        }
        let _ = writeln!(
            out,
            "\n{:>9} {:>11} {:>11} {:>9} {:>9} {:>11}\n{:>9} {:>11} {:>11} {:>9} {:>9} {:>11}",
            "pressure",
            "measured",
            "line",
            "band 95 %",
            "residual",
            "studentized",
            "kPa",
            "N/m",
            "N/m",
            "± N/m",
            "N/m",
            ""
        );
        for row in self.rows.iter().take(MOST_ROWS) {
            let studentized = row.studentized.map_or_else(|| "-".to_owned(), |t| format!("{t:.2}"));
            let _ = writeln!(
                out,
                "{:>9.2} {:>11.1} {:>11.1} {:>9.1} {:>9.1} {:>11}",
                row.pressure_kpa,
                row.stiffness_n_per_m,
                row.fitted_n_per_m,
                row.band_95_n_per_m,
                row.residual_n_per_m,
                studentized
            );
        }
        if let Some(more @ 1..) = self.rows.len().checked_sub(MOST_ROWS) {
            let _ = writeln!(out, "and {more} more; all of them are in the JSON and in the figure");
        }
        out.push('\n');
        ending(&mut out, &self.concerns);
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_as_many_digits_as_its_error_deserves() {
        let text =
            |value, standard_error| shown(&Estimate { value, standard_error, degrees_of_freedom: 9.0 });
        assert_eq!(text(20_663.417, 4.35), "20663.4 ± 4.3");
        assert_eq!(text(435.2178, 0.0312), "435.218 ± 0.031");
        assert_eq!(text(20_663.4, 43.1), "20663 ± 43");
        assert_eq!(text(1.0, 0.0), "1.000 ± 0.000");
    }
}
