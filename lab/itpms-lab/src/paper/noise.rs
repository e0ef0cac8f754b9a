//! Fig. 15: the noise of the test bed's unsprung accelerometer and how normal it is.
//!
//! Called by [`super::reproduce`].

use itpms_sim::simulation::Simulation;

use super::case::Case;
use super::data::Data;
use super::plan::RESET_LONG_S;
use super::published::TABLE_5;
use super::section::{Section, Table, number};
use super::{CORNER, Request};
use crate::runner::Result;
use itpms_analysis::plot::{Axis, Figure, Ink, Panel, Stroke};

/// Half-width in m/s² and number of the histogram's bars.
const HALF_WIDTH: f64 = 2.5;
const BARS: usize = 50;
/// Time range of the left panels in s.
const DRAWN_S: f64 = 10.0;

struct Noise {
    variance: f64,
    points: Vec<(f64, f64)>,
    mean: f64,
    found: f64,
    skewness: f64,
    excess: f64,
}

impl Noise {
    /// The logged wheel acceleration less that of the same drive with a quiet sensor.
    fn of(variance: f64, request: &Request) -> Result<Self> {
        let case = Case::bench("bench-drop", RESET_LONG_S, request)?;
        let noisy = case.clone().with_wheel_noise_variance(variance)?;
        let quiet = case.with_wheel_noise_variance(0.0)?;
        let rows = |case: &Case| Simulation::new(&case.scenario, request.first_seed);
        let wheel = |row: &itpms_sim::simulation::SimRow| {
            row.corners[CORNER.index()].map_or(f64::NAN, |corner| corner.wheel_accel_m_s2)
        };
        let points: Vec<(f64, f64)> =
            rows(&noisy)?.zip(rows(&quiet)?).map(|(a, b)| (a.time_s, wheel(&a) - wheel(&b))).collect();
        let count = points.len() as f64;
        let mean = points.iter().map(|p| p.1).sum::<f64>() / count;
        let moment = |power: i32| points.iter().map(|p| (p.1 - mean).powi(power)).sum::<f64>() / count;
        let found = moment(2) * count / (count - 1.0);
        let (skewness, excess) = (moment(3) / moment(2).powf(1.5), moment(4) / moment(2).powi(2) - 3.0);
        Ok(Self { variance, points, mean, found, skewness, excess })
    }

    /// Density at a noise of `x` m/s² by the normal distribution with the sample's mean and variance.
    fn normal(&self, x: f64) -> f64 {
        (-(x - self.mean).powi(2) / (2.0 * self.found)).exp() / (std::f64::consts::TAU * self.found).sqrt()
    }

    /// (left, right, density)
    fn bars(&self) -> Vec<(f64, f64, f64)> {
        let width = 2.0 * HALF_WIDTH / BARS as f64;
        let mut counts = [0u32; BARS];
        for (_, x) in &self.points {
            let place = (x + HALF_WIDTH) / width;
            if let Some(count) = counts.get_mut(place as usize).filter(|_| place >= 0.0) {
                *count += 1;
            }
        }
        let density = |count: u32| f64::from(count) / (self.points.len() as f64 * width);
        let left = |i: usize| i as f64 * width - HALF_WIDTH;
        counts.iter().enumerate().map(|(i, &count)| (left(i), left(i) + width, density(count))).collect()
    }
}

pub(super) fn section(request: &Request) -> Result<Section> {
    let mut noises = vec![];
    for row in TABLE_5 {
        noises.push(Noise::of(row.setting, request)?);
    }
    let mut figure = Figure::new("figure-15", "Figure 15: Noise of the unsprung accelerometer")
        .describe("Three white noises over time and their histograms with normal distributions.");
    let mut data = vec![];
    for (noise, letters) in noises.iter().zip([["a", "b"], ["c", "d"], ["e", "f"]]) {
        let title = |what: &str| format!("{what}, σ² = {:.3} (m/s²)²", noise.variance);
        let bars = noise.bars();
        let normal: Vec<(f64, f64)> =
            (0..=100).map(|i| f64::from(i) * 0.05 - HALF_WIDTH).map(|x| (x, noise.normal(x))).collect();
        let drawn = noise.points.iter().copied().filter(|p| p.0 <= DRAWN_S).collect();
        let time = Axis::linear("Time", "s").within(0.0, DRAWN_S);
        let density = Axis::linear("Density", "s²/m").within(0.0, 0.9);
        let values = || Axis::linear("Noise", "m/s²").within(-HALF_WIDTH, HALF_WIDTH);
        figure = figure
            .panel(Panel::new(letters[0], title("Noise"), time, values()).height(230.0).line(
                "noise",
                Ink::Light,
                Stroke::Thin,
                drawn,
            ))
            .panel(
                Panel::new(letters[1], title("Histogram"), values(), density)
                    .height(230.0)
                    .bars("histogram", Ink::Light, bars.clone())
                    .line("normal distribution fitted", Ink::Default, Stroke::Solid, normal),
            );
        let suffix = letters[1];
        let file = if data.is_empty() { "figure-15".to_owned() } else { format!("figure-15-{suffix}") };
        data.push(
            Data::new(file, title("Histogram of the noise"))
                .numbers("noise_from_m_s2", bars.iter().map(|b| b.0))
                .numbers("noise_to_m_s2", bars.iter().map(|b| b.1))
                .numbers("density_s2_per_m", bars.iter().map(|b| b.2))
                .numbers("normal_density_s2_per_m", bars.iter().map(|b| noise.normal(0.5 * (b.0 + b.1)))),
        );
    }
    Ok(Section::new("noise", "Test bed: sensor noise, Figures 15 and 16, Table 5")
        .figure(
            figure,
            "First seed: what the noisy accelerometer logs less what a quiet one logs in the same drive, over 10 of the 60 s, and the \
             histogram of all of it with the normal distribution of the same mean and variance.",
            data,
        )
        .table(
            moments(&noises),
            "Wanted variance, variance of the drawn record, and how normal it is: skewness and excess kurtosis are 0 for a normal \
             distribution, give or take two standard errors.",
        ))
}

fn moments(noises: &[Noise]) -> Table {
    let column = |pick: &dyn Fn(&Noise) -> f64| noises.iter().map(pick).collect::<Vec<_>>();
    let count = |noise: &Noise| noise.points.len() as f64;
    let errors = |noise: &Noise| {
        let n = count(noise);
        (noise.found * (2.0 / (n - 1.0)).sqrt(), (6.0 / n).sqrt(), (24.0 / n).sqrt())
    };
    let data = Data::new("figure-15-moments", "Moments of the noise")
        .numbers("wanted_variance_m2_s4", column(&|n| n.variance))
        .numbers("variance_m2_s4", column(&|n| n.found))
        .numbers("variance_standard_error_m2_s4", column(&|n| errors(n).0))
        .numbers("mean_m_s2", column(&|n| n.mean))
        .numbers("skewness", column(&|n| n.skewness))
        .numbers("skewness_standard_error", column(&|n| errors(n).1))
        .numbers("excess_kurtosis", column(&|n| n.excess))
        .numbers("excess_kurtosis_standard_error", column(&|n| errors(n).2))
        .numbers("samples", column(&count));
    let head = ["Wanted σ² (m/s²)²", "Found σ²", "Skewness", "Excess kurtosis"];
    let mut table = Table::new("Moments of the noise in Figure 15", &head, data);
    for noise in noises {
        let (variance, skewness, excess) = errors(noise);
        let with = |value: f64, error: f64| format!("{} ± {}", number(value, 3), number(error, 3));
        table = table.row([
            number(noise.variance, 3),
            format!("{} ± {}", number(noise.found, 4), number(variance, 4)),
            with(noise.skewness, skewness),
            with(noise.excess, excess),
        ]);
    }
    table
}
