//! Figures of an identification: the data with what was fitted, and what is left. Called by the binary.

use super::calibrate::Calibration;
use super::damper_result::DamperResult;
use super::estimate::NORMAL_95;
use super::spring::SpringResult;
use crate::plot::{Axis, Figure, Ink, Panel, Stroke};

/// Points of a curve that are drawn as dots at most: more hide each other.
const DOTS: usize = 400;
const INKS: [Ink; 6] = [Ink::Default, Ink::Adaptive, Ink::Mended, Ink::Plain, Ink::Extra, Ink::Light];

/// Every n-th element, so that at most [`DOTS`] are left.
fn spread<T: Copy>(all: &[T]) -> impl Iterator<Item = T> + '_ {
    all.iter().copied().step_by(all.len().div_ceil(DOTS).max(1))
}

impl SpringResult {
    /// Load over displacement with the line, and the residuals.
    pub fn figure(&self) -> Figure {
        let sign = if self.opposite_signs { -1.0 } else { 1.0 };
        let k = sign * self.stiffness_n_per_m.value;
        let line = |x: f64| (1e3 * x, self.load_at_zero_n + k * x);
        let millimetres = || Axis::linear("Displacement", "mm");
        let measured = spread(&self.used).map(|(x, load, _)| (1e3 * x, load, 0.0)).collect();
        let mut data = Panel::new("a", "Load and displacement", millimetres(), Axis::linear("Load", "N"))
            .dots("measured", Ink::Default, measured)
            .line("best line", Ink::Truth, Stroke::Solid, vec![line(self.travel_m.0), line(self.travel_m.1)]);
        let ends = |offset: f64| {
            [self.travel_m.0, self.travel_m.1].map(|x| (line(x).0, line(x).1 + offset)).to_vec()
        };
        if let Some(friction) = &self.friction_n {
            for (name, offset) in [("line ± friction", friction.value), ("", -friction.value)] {
                data = data.line(name, Ink::Muted, Stroke::Dashed, ends(offset));
            }
        }
        let residual = Axis::linear("Residual", "N");
        let left = Panel::new("b", "Residual, each stroke about its own offset", millimetres(), residual)
            .dots("", Ink::Default, spread(&self.used).map(|(x, _, e)| (1e3 * x, e, 0.0)).collect())
            .level(Ink::Truth, 0.0, "");
        Figure::new("identify-spring", "Spring stiffness from load and displacement")
            .describe(format!(
                "ks = {:.0} ± {:.1} N/m from {} strokes, friction left between the line and the data.",
                self.stiffness_n_per_m.value, self.stiffness_n_per_m.standard_error, self.strokes
            ))
            .panel(data)
            .panel(left)
    }
}

impl DamperResult {
    /// Force over velocity, damping by run, and the residuals.
    pub fn figure(&self) -> Figure {
        let velocity = || Axis::linear("Velocity", "m/s");
        let force = Axis::linear("Force", "N");
        let mut data = Panel::new("a", "Force without its share of displacement", velocity(), force);
        let mut left =
            Panel::new("b", "Residual", velocity(), Axis::linear("Residual", "N")).level(Ink::Truth, 0.0, "");
        let share = |v: f64| {
            let c = if v > 0.0 { self.rising_n_s_per_m.value } else { self.falling_n_s_per_m.value };
            c * v + self.friction_n.value * v.signum()
        };
        let fastest = self.runs.iter().map(|run| run.velocity_m_s).fold(0.0, f64::max);
        for (i, (run, rows)) in self.runs.iter().zip(&self.used).enumerate() {
            let ink = INKS[i % INKS.len()];
            let name = format!("{:.3} Hz, {:.1} mm", run.frequency_hz, 1e3 * run.amplitude_m);
            // What velocity explains, and what nothing does.
            data = data.dots(name, ink, spread(rows).map(|[_, v, _, e]| (v, share(v) + e, 0.0)).collect());
            left = left.dots("", ink, spread(rows).map(|[_, v, _, e]| (v, e, 0.0)).collect());
        }
        let gap = f64::NAN;
        let model = [-fastest, -1e-6, gap, 1e-6, fastest].map(|v| (v, share(v)));
        data = data.line("fit", Ink::Truth, Stroke::Solid, model.to_vec());
        let by_run: Vec<_> = self
            .runs
            .iter()
            .map(|run| {
                let c = &run.damping_n_s_per_m;
                (run.velocity_m_s, c.value, NORMAL_95 * c.standard_error)
            })
            .collect();
        let equivalent: Vec<_> =
            self.runs.iter().map(|run| (run.velocity_m_s, run.equivalent_n_s_per_m, 0.0)).collect();
        let c = self.damping_n_s_per_m.value;
        let runs = Panel::new(
            "c",
            "Damping by run",
            Axis::linear("Velocity amplitude", "m/s").holding(0.0).holding(1.06 * fastest),
            Axis::linear("Damping", "N s/m"),
        )
        .level(Ink::Truth, c, "all runs")
        .dots("run alone, 95 %", Ink::Truth, by_run)
        .dots("friction counted as damping", Ink::Muted, equivalent);
        Figure::new("identify-damper", "Damping from sinusoidal excitation")
            .describe(format!(
                "cs = {c:.1} ± {:.2} N s/m from {} runs.",
                self.damping_n_s_per_m.standard_error,
                self.runs.len()
            ))
            .columns(2)
            .panel(data)
            .panel(left)
            .panel(runs)
    }
}

impl Calibration {
    /// The line with its band, and the residuals.
    pub fn figure(&self) -> Figure {
        let pressure = || Axis::linear("Gauge pressure", "kPa");
        let (low, high) =
            super::guard::range(&self.rows.iter().map(|row| row.pressure_kpa).collect::<Vec<_>>());
        let margin = 0.1 * (high - low);
        let at = |i: i32| low - margin + (high - low + 2.0 * margin) * f64::from(i) / 60.0;
        let band = |center: &dyn Fn(f64) -> f64, scale: f64| -> Vec<(f64, f64, f64)> {
            (0..=60)
                .map(|i| {
                    let (p, half) = (at(i), self.band_95_n_per_m(at(i)));
                    (p, scale * (center(p) - half), scale * (center(p) + half))
                })
                .collect()
        };
        let line = |p: f64| self.map.stiffness_n_per_m(p);
        let ends = [0, 60].map(|i| (at(i), 1e-3 * line(at(i)))).to_vec();
        let rows = self.rows.iter();
        let measured = rows.clone().map(|row| (row.pressure_kpa, 1e-3 * row.stiffness_n_per_m, 0.0));
        let residuals = rows.map(|row| (row.pressure_kpa, row.residual_n_per_m, 0.0));
        let data =
            Panel::new("a", "Tire stiffness and pressure", pressure(), Axis::linear("Stiffness", "kN/m"))
                .band("95 % band of the line", Ink::Light, band(&line, 1e-3))
                .line("least squares", Ink::Truth, Stroke::Solid, ends)
                .dots("measured", Ink::Default, measured.collect());
        let left = Panel::new("b", "Residual", pressure(), Axis::linear("Measured less line", "N/m"))
            .band("", Ink::Light, band(&|_| 0.0, 1.0))
            .level(Ink::Truth, 0.0, "")
            .dots("", Ink::Default, residuals.collect());
        Figure::new("calibrate", "Pressure-stiffness line of a tire")
            .describe(format!(
                "{:.3} N/m per kPa and {:.1} N/m at zero, R² {:.5}.",
                self.stiffness_per_kpa.value, self.stiffness_at_zero.value, self.r_squared
            ))
            .panel(data)
            .panel(left)
    }
}
