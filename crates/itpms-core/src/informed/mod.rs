//! The default estimator of one corner: a Bayes filter on a grid of pressures that knows one more thing than the
//! paper's filter, namely that a road looks like a road (docs/math/informed.md).
//!
//! The spectrum of a road is a smooth power law. Reconstructed with a wrong stiffness it shows a wheel-hop peak or
//! notch near 10-14 Hz; how unlikely that is, for every stiffness of a grid, is the information. Short spectral frames
//! feed it ten times a second; leak modes and road-level modes say how fast belief may change.
//!
//! | room | idea |
//! |---|---|
//! | `reconstruct` | per sample: the signals that the road velocity is made of |
//! | `frame` | short spectra of them |
//! | `model` | what they should look like for every stiffness |
//! | `dynamics` | how pressure and road may change |
//! | `road_belief` | level, slope and enveloping of the road under one hypothesis |
//! | `posterior` | the belief, moved on and weighed |

mod dynamics;
mod frame;
mod model;
mod posterior;
mod reconstruct;
mod road_belief;

use self::frame::{BINS, Frame, FrameClock};
use self::model::{Body, Grid, Tables};
use self::posterior::Posterior;
use self::reconstruct::{
    RELATIVE_ACCELERATION, RELATIVE_VELOCITY, Reconstruction, WHEEL_JERK, WHEEL_VELOCITY,
};
use self::road_belief::Evidence;
use crate::estimate::CornerConfig;
use crate::intake::GridSample;
use crate::real::Real;

/// Share of a frame's log-likelihood that counts: frames under a sine window that overlap by half are counted twice.
const OVERLAP: f64 = 0.5;
/// Highest frequency used, as a share of the sampling rate.
const BAND: f64 = 0.25;
/// Frequency times enveloping length over speed up to which enveloping is a smooth loss.
const ENVELOPE_REACH: f64 = 0.55;
/// Speed in m/s below which nothing is learned.
const STANDING_M_S: f64 = 2.5;
/// Power over expected power above which a frame is an event (a pothole) and counts less.
const EVENT: f64 = 3.0;
/// Road velocity power over its noise at which learning starts.
const SIGNAL_TO_NOISE: f64 = 2.5;
/// Accelerometer noise in m/s² rms when nobody knows better.
const DEFAULT_NOISE_M_S2: f64 = 0.05;
/// Standard deviation in kPa of the pressure to start from.
const INITIAL_SD_KPA: f64 = 30.0;

/// The default one-corner estimator's core, fed with grid samples. See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Informed<T: Real> {
    config: CornerConfig<T>,
    grid: Grid<T>,
    body: Body<T>,
    tables: Tables<T>,
    reconstruction: Reconstruction<T>,
    clock: FrameClock<T>,
    posterior: Posterior<T>,
    noise_density: T,
    bins: usize,
    smoothed_snr: T,
    last_speed_m_s: T,
    saturated: bool,
}

impl<T: Real> Informed<T> {
    /// An estimator for samples that were taken at `sample_rate_hz` and come on a grid of `grid_period_s`.
    pub fn new(config: &CornerConfig<T>, sample_rate_hz: f64, grid_period_s: f64) -> Self {
        let clock = FrameClock::new(grid_period_s);
        let grid = Grid::new(config.placard_kpa);
        let car = &config.quarter_car;
        let body = Body {
            sprung_mass_kg: car.sprung_mass_kg(),
            unsprung_mass_kg: car.unsprung_mass_kg(),
            damping_n_s_per_m: car.damping_n_s_per_m(),
            spring_n_per_m: car.spring_n_per_m(),
        };
        let tables = Tables::new(clock.bin_spacing_hz(), sample_rate_hz, &grid, &config.tire, &body);
        let noise = config.accel_noise_m_s2.unwrap_or(T::lit(DEFAULT_NOISE_M_S2));
        let initial = config.initial_kpa.unwrap_or(config.placard_kpa);
        let initial_cell = (initial - grid.pressure_kpa(0)) / grid.step_kpa();
        let scale = config.placard_kpa / T::lit(dynamics::REFERENCE_KPA);
        let posterior =
            Posterior::new(clock.hop_s(), initial_cell, T::lit(INITIAL_SD_KPA) * scale / grid.step_kpa());
        let highest = (BAND * sample_rate_hz / clock.bin_spacing_hz()).clamp(4.0, BINS as f64);
        Self {
            config: *config,
            grid,
            body,
            tables,
            reconstruction: Reconstruction::new(grid_period_s),
            clock,
            posterior,
            noise_density: T::lit(2.0 / sample_rate_hz) * noise * noise,
            bins: highest as usize,
            smoothed_snr: T::lit(10.0),
            last_speed_m_s: T::lit(f64::NAN),
            saturated: false,
        }
    }

    /// Takes one grid sample; true when a frame was completed and the belief has moved.
    pub fn push(&mut self, sample: &GridSample<T>) -> bool {
        if sample.after_gap {
            self.reconstruction.restart();
            self.clock.restart();
        }
        self.saturated |= sample.saturated;
        let signals = self.reconstruction.push(sample.body_accel_m_s2, sample.wheel_accel_m_s2);
        match self.clock.push(&signals) {
            Some(frame) => {
                self.learn(&frame, sample.speed_m_s);
                true
            }
            None => false,
        }
    }

    fn learn(&mut self, frame: &Frame<T>, speed_m_s: T) {
        let (cell, road) = self.posterior.most_likely();
        let mut evidence = self.evidence(frame, speed_m_s, road.envelope_m());
        let theta = self.tables.theta[cell];
        // Signal over noise from 5 to 20 Hz, and power over expected power, where the belief is now.
        let (mut snr, mut surprise) = (T::zero(), T::zero());
        for bin in 0..evidence.bins {
            let power = evidence.power(bin, theta);
            let noise = self.noise_density * self.tables.noise[(bin, cell)];
            if bin < 4 {
                snr += power / noise / T::lit(4.0);
            }
            let expected = road.log_power(&self.tables, &evidence, bin).exp() + noise;
            surprise += power / expected / T::lit(evidence.bins as f64);
        }
        self.smoothed_snr += T::lit(0.3) * (snr - self.smoothed_snr);
        let mut gate = (self.smoothed_snr / T::lit(SIGNAL_TO_NOISE) - T::one()).clamp(T::zero(), T::one());
        if speed_m_s < T::lit(STANDING_M_S) || self.saturated {
            gate = T::zero();
        }
        if surprise > T::lit(EVENT) {
            gate *= T::lit(EVENT) / surprise;
        }
        self.saturated = false;
        evidence.weight *= gate;
        let ratio = speed_m_s / self.last_speed_m_s;
        self.last_speed_m_s = speed_m_s;
        if gate > T::zero() {
            self.posterior.predict(if ratio > T::zero() && ratio.is_finite() {
                ratio.ln()
            } else {
                T::zero()
            });
            self.posterior.update(&evidence, &self.tables);
        } else {
            self.posterior.hold();
        }
        self.tables.refresh_next(&self.body);
    }

    /// `|V|² = |U_1|² + 2 θ Re(U_1 U_2*) + θ² |U_2|²` with `U_2 = m_w J + c_s A + k_s V`.
    fn evidence(&self, frame: &Frame<T>, speed_m_s: T, envelope_m: T) -> Evidence<T> {
        let speed = if speed_m_s > T::lit(STANDING_M_S) { speed_m_s } else { T::lit(15.0) };
        let reach = T::lit(ENVELOPE_REACH) * speed
            / (T::lit(self.clock.bin_spacing_hz()) * envelope_m.max(T::lit(1e-3)));
        let bins = (reach.to_f64() as usize).clamp(4, self.bins);
        let parts = [
            (WHEEL_JERK, self.body.unsprung_mass_kg),
            (RELATIVE_ACCELERATION, self.body.damping_n_s_per_m),
            (RELATIVE_VELOCITY, self.body.spring_n_per_m),
        ];
        let mut evidence = Evidence {
            a: [T::zero(); BINS],
            b: [T::zero(); BINS],
            c: [T::zero(); BINS],
            envelope: [T::zero(); BINS],
            bins,
            noise_density: self.noise_density,
            weight: T::lit(OVERLAP),
        };
        let unit = T::pi() * T::lit(0.1) / speed;
        for bin in 0..BINS {
            evidence.envelope[bin] = unit * unit * self.tables.frequency_squared[bin] / T::lit(3.0);
            evidence.a[bin] = frame.cross(bin, WHEEL_VELOCITY, WHEEL_VELOCITY);
            for (i, p) in parts {
                evidence.b[bin] += p * frame.cross(bin, WHEEL_VELOCITY, i);
                for (j, q) in parts {
                    evidence.c[bin] += p * q * frame.cross(bin, i, j);
                }
            }
        }
        evidence
    }

    /// Mean and sd of the pressure in kPa.
    pub fn pressure_kpa(&self) -> (T, T) {
        let summary = self.posterior.summary();
        let step = self.grid.step_kpa();
        let variance = (summary.variance_cells2 + T::lit(1.0 / 12.0)) * step * step;
        (self.grid.pressure_kpa(0) + summary.mean_cell * step, variance.sqrt())
    }
}
