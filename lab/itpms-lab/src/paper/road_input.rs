//! The simulation's input: road and its spectrum (Fig. 5), pressure over time (Fig. 6).
//!
//! Called by [`super::reproduce`].

use itpms_sim::simulation::Simulation;
use rayon::prelude::*;

use super::case::Case;
use super::data::Data;
use super::outcome::Outcome;
use super::published::SLOPE;
use super::section::{Section, number};
use super::{CORNER, Request};
use crate::runner::Result;
use crate::score::stats::Spread;
use itpms_analysis::plot::{Axis, Figure, Ink, Panel, Stroke};
use itpms_analysis::spectrum::{Psd, RoadFit, Welch, fit_power_law};

/// Length in m of a segment of Welch's method.
const SEGMENT_M: f64 = 60.0;
/// Where the line is drawn through, in cycles/m. The longest wave fits three times into a segment.
const BAND_PER_M: (f64, f64) = (0.05, 10.0);
/// Spectra beyond this are below what the simulated road holds of waves.
const DRAWN_PER_M: f64 = 50.0;

/// A road's density and the line through it.
struct Spectrum {
    psd: Psd,
    fit: RoadFit,
}

fn spectrum(road_m: &[f64], spacing_m: f64) -> Result<Option<Spectrum>> {
    let half = (0.5 * SEGMENT_M / spacing_m) as usize;
    let mut welch = Welch::new(2 * half, spacing_m)?;
    road_m.iter().for_each(|&height| welch.push(height));
    let Some(psd) = welch.psd() else { return Ok(None) };
    let fit = fit_power_law(&psd, BAND_PER_M.0, BAND_PER_M.1)?;
    Ok(Some(Spectrum { psd, fit }))
}

fn slopes(request: &Request) -> Result<Vec<f64>> {
    let case = Case::simulation("paper-drop", request)?;
    let one = |turn: usize| {
        let seed = request.first_seed.wrapping_add(turn as u64);
        let (mut road, mut spacing_m) = (vec![], 0.0);
        for row in Simulation::new(&case.scenario, seed)? {
            if let Some(corner) = row.corners[CORNER.index()] {
                road.push(corner.road_m);
                spacing_m = row.speed_m_s / case.scenario.rate_hz;
            }
        }
        Ok(spectrum(&road, spacing_m)?.map_or(f64::NAN, |found| found.fit.law.waviness))
    };
    (0..request.seeds).into_par_iter().map(one).collect()
}

/// The section and the slopes over the seeds.
pub(super) fn section(request: &Request, drop: &Outcome, speed_m_s: f64) -> Result<(Section, Spread)> {
    let spacing_m = speed_m_s / drop.rate_hz;
    let slopes = Spread::of(slopes(request)?);
    let found = spectrum(&drop.truth.road_m, spacing_m)?;
    let law = found.as_ref().map(|found| found.fit.law);
    let text = format!(
        "<p>The paper drives over a measured road (its reference 30) that it does not print; it says that the spectrum has a slope of \
         −{SLOPE}. Our roads are drawn at random with exactly that slope, at the level Gd(n0) = {gd:e} m³ (class A of ISO 8608 is 16e-6), as Gaussian processes: a \
         different road for every seed. One record of 222 m does not fix a slope: over the {n} roads of this study the line \
         through a single record has a slope of −{median} (10 to 90 %: −{p10} to −{p90}). The road of Fig. 5 has −{w}.</p>",
        gd = request.road_gd_n0_m3,
        n = request.seeds,
        median = number(slopes.median, 2),
        p10 = number(slopes.p10, 2),
        p90 = number(slopes.p90, 2),
        w = number(law.map_or(f64::NAN, |law| law.waviness), 2),
    );
    let time: Vec<(f64, f64)> =
        drop.truth.road_time_s.iter().copied().zip(drop.truth.road_m.iter().map(|z| 1e3 * z)).collect();
    let mut data = vec![Data::new("figure-05", "Road under the wheel at 20 km/h").curve(
        "time_s",
        "road_mm",
        &every(&time, 10),
    )];
    let mut figure = Figure::new("figure-05", "Figure 5: Road input of the simulation")
        .describe("A rough line over 40 s, and a spectrum that falls as a straight line on double-logarithmic axes.")
        .panel(
            Panel::new("a", "Road under the wheel, 20 km/h", Axis::linear("Time", "s").within(0.0, drop.duration_s), Axis::linear("Height", "mm"))
                .line("our road, first seed", Ink::Truth, Stroke::Solid, time),
        );
    if let Some(found) = found {
        let (panel, columns) = psd_panel(&found);
        figure = figure.panel(panel);
        data.push(columns);
    }
    let caption = format!(
        "(a) the road of the first seed for 40 s; (b) its displacement spectrum by Welch's method (Hann window, segments of {SEGMENT_M} m, half \
         overlapping), the line through it between {} and {} cycles/m, smoothed as ISO 8608 does, and a line with the paper's \
         slope through the same level. The paper's Fig. 5 shows its own road; ours must agree in slope alone.",
        BAND_PER_M.0, BAND_PER_M.1
    );
    let section = Section::new("input", "Simulation study, input: Figures 5 and 6")
        .text(text)
        .figure(figure, caption, data)
        .figure(
            scenario(drop),
            "The tire's pressure and, by eq. (5), its stiffness: 241.3 kPa (35 psi) until 20 s, then down to 137.9 kPa (20 psi) \
             within 2.5 s. The paper does not say when the loss begins; 20 s is read off the standard scenario.",
            vec![
                Data::new("figure-06", "A sudden loss of pressure")
                    .numbers("time_s", drop.truth.time_s.iter().copied())
                    .numbers("pressure_kpa", drop.truth.pressure_kpa.iter().copied())
                    .numbers("stiffness_n_per_m", drop.truth.stiffness_n_per_m.iter().copied()),
            ],
        );
    Ok((section, slopes))
}

pub(super) fn every(points: &[(f64, f64)], nth: usize) -> Vec<(f64, f64)> {
    points.iter().copied().step_by(nth).collect()
}

fn psd_panel(found: &Spectrum) -> (Panel, Data) {
    let law = found.fit.law;
    let densities: Vec<(f64, f64)> = found
        .psd
        .frequencies
        .iter()
        .copied()
        .zip(found.psd.densities.iter().copied())
        .filter(|(n, _)| *n <= DRAWN_PER_M)
        .collect();
    let ends = [BAND_PER_M.0, BAND_PER_M.1];
    // Through the middle of our line, with the paper's slope.
    let middle = (BAND_PER_M.0 * BAND_PER_M.1).sqrt();
    let papers = |n: f64| law.density_m3(middle) * (n / middle).powf(-SLOPE);
    let frequency = Axis::logarithmic("Spatial frequency", "cycles/m");
    let ours = format!("line through ours: slope \u{2212}{:.2}", law.waviness);
    let theirs = format!("the paper's slope: \u{2212}{SLOPE}");
    let panel = Panel::new("b", "Its displacement spectrum", frequency, Axis::logarithmic("Density", "m³"))
        .line("Welch", Ink::Light, Stroke::Solid, densities.clone())
        .line(ours, Ink::Default, Stroke::Bold, ends.map(|n| (n, law.density_m3(n))).to_vec())
        .line(theirs, Ink::Paper, Stroke::Dashed, ends.map(|n| (n, papers(n))).to_vec());
    let data = Data::new("figure-05-spectrum", "Displacement spectrum of the road")
        .curve("spatial_frequency_per_m", "density_m3", &densities)
        .numbers("line_density_m3", densities.iter().map(|(n, _)| law.density_m3(*n)))
        .numbers("paper_slope_density_m3", densities.iter().map(|(n, _)| papers(*n)));
    (panel, data)
}

fn scenario(drop: &Outcome) -> Figure {
    let line = |values: &[f64], factor: f64| {
        drop.truth.time_s.iter().copied().zip(values.iter().map(|v| v * factor)).collect::<Vec<_>>()
    };
    let time = || Axis::linear("Time", "s").within(0.0, drop.duration_s);
    let pressure = line(&drop.truth.pressure_kpa, 1.0);
    let stiffness = line(&drop.truth.stiffness_n_per_m, 1e-3);
    let kn_per_m = Axis::linear("Tire stiffness", "kN/m").within(140.0, 250.0);
    Figure::new("figure-06", "Figure 6: A sudden loss of pressure")
        .describe("Pressure and stiffness fall on a ramp from 20 to 22.5 s.")
        .panel(
            Panel::new("a", "Tire pressure", time(), Axis::linear("Pressure", "kPa").within(100.0, 260.0))
                .line("truth", Ink::Truth, Stroke::Solid, pressure)
                .level(Ink::Muted, 206.8, "30 psi, the paper's threshold"),
        )
        .panel(Panel::new("b", "Tire stiffness", time(), kn_per_m).line(
            "truth",
            Ink::Truth,
            Stroke::Solid,
            stiffness,
        ))
}
