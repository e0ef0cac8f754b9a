//! A filter of one's own beside the published one and the default: `cargo run --release -p itpms-paper --example own_filter`.
//!
//! All three get the samples of the paper's sudden loss (Fig. 7), whose truth is known. [`Hop`] stands for yours: it takes the tire's
//! stiffness from the frequency at which the wheel's acceleration, band-passed around wheel hop, crosses zero.

use std::error::Error;

use itpms_core::Estimator;
use itpms_core::model::{Corner, CornerConfig, CornerSample};
use itpms_paper::{AekfUi, FilterConfig, Forgetting};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

/// Errors count from here on, as in the study.
const JUDGED_FROM_S: f64 = 3.0;
const SEEDS: std::ops::RangeInclusive<u64> = 1..=5;

/// Wheel hop by zero crossings, forgotten with a time constant: `k_t = m_w ω² - k_s`, scaled to be right at the start.
struct Hop {
    corner: CornerConfig<f64>,
    step_s: f64,
    /// States of two low-passes and a high-pass, and what came out of them.
    passes: [f64; 3],
    before_m_s2: f64,
    crossings_per_s: f64,
    seen_s: f64,
    scale: f64,
}

impl Hop {
    /// Corners of the low-passes and the high-pass, in rad/s.
    const LOW_RAD_S: f64 = 80.0;
    const HIGH_RAD_S: f64 = 50.0;
    /// Time constant of the mean, and how long the start lasts, in s.
    const MEAN_S: f64 = 2.0;
    const START_S: f64 = 8.0;

    fn new(corner: CornerConfig<f64>, step_s: f64) -> Self {
        Self {
            corner,
            step_s,
            passes: [0.0; 3],
            before_m_s2: 0.0,
            crossings_per_s: 20.0,
            seen_s: 0.0,
            scale: 1.0,
        }
    }

    fn pressure_kpa(&mut self, sample: &CornerSample<f64>) -> f64 {
        let [first, second, slow] = &mut self.passes;
        *first += Self::LOW_RAD_S * self.step_s * (sample.wheel_accel_m_s2 - *first);
        *second += Self::LOW_RAD_S * self.step_s * (*first - *second);
        *slow += Self::HIGH_RAD_S * self.step_s * (*second - *slow);
        let near_hop_m_s2 = *second - *slow;
        let crossed = near_hop_m_s2 * self.before_m_s2 < 0.0;
        self.before_m_s2 = near_hop_m_s2;
        let rate = if crossed { 1.0 / self.step_s } else { 0.0 };
        self.crossings_per_s += self.step_s / Self::MEAN_S * (rate - self.crossings_per_s);
        self.seen_s += self.step_s;
        let (car, tire) = (&self.corner.quarter_car, &self.corner.tire);
        let omega = std::f64::consts::PI * self.crossings_per_s;
        let stiffness = car.unsprung_mass_kg() * omega * omega - car.spring_n_per_m();
        if self.seen_s < Self::START_S {
            self.scale = tire.stiffness_n_per_m(self.corner.placard_kpa) / stiffness;
        }
        tire.pressure_kpa(self.scale * stiffness)
    }
}

/// Root of the mean square of errors.
#[derive(Default)]
struct Errors {
    square: f64,
    count: f64,
}

impl Errors {
    fn push(&mut self, error_kpa: f64) {
        self.square += error_kpa * error_kpa;
        self.count += 1.0;
    }

    fn rmse_kpa(&self) -> f64 {
        (self.square / self.count).sqrt()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let scenario = Scenario { rate_hz: 1000.0, ..Scenario::builtin("paper-drop")? };
    let corner = scenario.corner_config(Corner::FrontLeft)?;
    let step_s = 1.0 / scenario.rate_hz;
    println!("RMSE in kPa over t > {JUDGED_FROM_S} s\nseed    own   aekf-ui   default");
    for seed in SEEDS {
        let mut own = Hop::new(corner, step_s);
        let tuning = FilterConfig::paper_simulation().with_forgetting(Forgetting::OneStep);
        let mut published = AekfUi::new(corner.quarter_car, tuning)?;
        let mut default = Estimator::new(&corner, scenario.rate_hz)?;
        let mut errors: [Errors; 3] = Default::default();
        for row in Simulation::new(&scenario, seed)? {
            let Some(wheel) = row.corners[Corner::FrontLeft.index()] else { continue };
            let (body_accel_m_s2, wheel_accel_m_s2) = (wheel.body_accel_m_s2, wheel.wheel_accel_m_s2);
            let sample = CornerSample { body_accel_m_s2, wheel_accel_m_s2 };
            let estimate = default.update(row.time_s, row.speed_m_s, body_accel_m_s2, wheel_accel_m_s2);
            let estimates_kpa = [
                own.pressure_kpa(&sample),
                corner.tire.pressure_kpa(published.step(step_s, &sample).stiffness_n_per_m()),
                estimate.pressure_kpa,
            ];
            if row.time_s > JUDGED_FROM_S {
                for (errors, estimate_kpa) in errors.iter_mut().zip(estimates_kpa) {
                    errors.push(estimate_kpa - wheel.pressure_kpa);
                }
            }
        }
        let [own, published, default] = errors.map(|errors| errors.rmse_kpa());
        println!("{seed:4} {own:6.1} {published:9.1} {default:9.1}");
    }
    Ok(())
}
