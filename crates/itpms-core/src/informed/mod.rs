//! The default estimator of one corner: a Bayes filter on a grid of pressures that knows one more thing than the
//! paper's filter, namely that a road looks like a road (docs/math/informed.md).
//!
//! The spectrum of a road is a smooth power law. Reconstructed with a wrong stiffness it shows a wheel-hop peak or
//! notch near 10-14 Hz; how unlikely that is, for every stiffness of a grid, is the information. Short spectral frames
//! feed it some seventeen times a second; leak modes and road-level modes say how fast belief may change.
//!
//! | room | idea |
//! |---|---|
//! | `reconstruct` | per sample: the signals that the road velocity is made of |
//! | `frame` | short spectra of them |
//! | `gate` | how much of a frame to believe |
//! | `body` | load and damping identified on the way |
//! | `model` | what they should look like for every stiffness |
//! | `dynamics` | how pressure and road may change |
//! | `road_belief` | level, slope and enveloping of the road under one hypothesis |
//! | `posterior` | the belief, moved on and weighed |

mod body;
mod dynamics;
mod frame;
mod gate;
mod model;
mod posterior;
mod reconstruct;
mod road_belief;

use self::body::BodyIdentification;
use self::frame::{BINS, Frame, FrameClock};
use self::gate::{Gate, SpeedKnowledge};
use self::model::{Body, Grid, Tables};
use self::posterior::Posterior;
use self::reconstruct::{
    RELATIVE_ACCELERATION, RELATIVE_VELOCITY, Reconstruction, WHEEL_JERK, WHEEL_VELOCITY,
};
use self::road_belief::Evidence;
use crate::estimate::CornerConfig;
use crate::intake::GridSample;
use crate::quarter_car::QuarterCar;
use crate::real::Real;

/// Share of a frame's log-likelihood that counts. Frames under a sine window that overlap by half say everything twice;
/// a little less than half lets the interval cover what the model leaves out.
const OVERLAP: f64 = 0.45;
/// Highest frequency used, as a share of the sampling rate.
const BAND: f64 = 0.25;
/// Frequency times enveloping length over speed up to which enveloping is a smooth loss.
const ENVELOPE_REACH: f64 = 0.75;
/// Bins used however long the enveloping may be: up to 40 Hz, so that wheel hop has neighbours on both sides.
const LEAST_BINS: usize = 5;
/// Speed in m/s below which nothing is learned.
const STANDING_M_S: f64 = 2.5;
/// Share by which the sd grows while the pressure surely moves fast: found on seeds of its own so that intervals cover
/// more of a drop without covering too much elsewhere.
const MOVING_SD: f64 = 0.7;
/// How well a reset sets the pressure, as a share of the placard pressure: 3 kPa at 241.3 kPa.
pub(crate) const RESET_SD: f64 = 0.0125;
/// Standard deviation in kPa of the pressure to start from.
const INITIAL_SD_KPA: f64 = 30.0;

/// The default one-corner estimator's core, fed with grid samples. See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Informed<T: Real> {
    config: CornerConfig<T>,
    grid: Grid<T>,
    body: BodyIdentification<T>,
    tables: Tables<T>,
    reconstruction: Reconstruction<T>,
    clock: FrameClock<T>,
    posterior: Posterior<T>,
    noise_density: T,
    bins: usize,
    gate: Gate<T>,
    variance_growth: T,
    learned_s: T,
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
        let noise = config.accel_noise_or_usual_m_s2();
        let initial = config.initial_kpa.unwrap_or(config.placard_kpa);
        let initial_cell = (initial - grid.pressure_kpa(0)) / grid.step_kpa();
        let scale = config.placard_kpa / T::lit(dynamics::REFERENCE_KPA);
        let posterior =
            Posterior::new(clock.hop_s(), initial_cell, T::lit(INITIAL_SD_KPA) * scale / grid.step_kpa());
        let highest = (BAND * sample_rate_hz / clock.bin_spacing_hz()).clamp(1.0, BINS as f64);
        Self {
            config: *config,
            grid,
            body: BodyIdentification::new(body),
            tables,
            reconstruction: Reconstruction::new(grid_period_s),
            clock,
            posterior,
            noise_density: T::lit(2.0 / sample_rate_hz) * noise * noise,
            bins: highest as usize,
            gate: Gate::new(),
            variance_growth: T::one(),
            learned_s: T::zero(),
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

    /// Tells that the tire has its placard pressure now, as during a reset.
    pub fn pin_to_placard(&mut self) {
        let cell = (self.config.placard_kpa - self.grid.pressure_kpa(0)) / self.grid.step_kpa();
        self.posterior.pin(cell, T::lit(RESET_SD) * self.config.placard_kpa / self.grid.step_kpa());
    }

    fn learn(&mut self, frame: &Frame<T>, speed_m_s: T) {
        let (cell, road) = self.posterior.most_likely();
        let mut evidence = self.evidence(frame, speed_m_s, road.longest_envelope_m());
        let speed = if speed_m_s.is_finite() { SpeedKnowledge::Known } else { SpeedKnowledge::Unknown };
        self.gate.look(&evidence, &self.tables, cell, &road, speed);
        if self.saturated || speed_m_s < T::lit(STANDING_M_S) {
            self.gate.close();
        }
        self.saturated = false;
        evidence.weight *= self.gate.open();
        let ratio = speed_m_s / self.last_speed_m_s;
        self.last_speed_m_s = speed_m_s;
        let before = self.posterior.summary().variance_cells2;
        if evidence.weight > T::zero() {
            let known = ratio > T::zero() && ratio.is_finite();
            self.posterior.predict(if known { ratio.ln() } else { T::zero() });
        } else {
            self.posterior.hold();
        }
        let after = self.posterior.summary().variance_cells2;
        self.variance_growth = (after / before.max(T::lit(1e-3))).max(T::one());
        if evidence.weight > T::zero() {
            self.posterior.update(&evidence, &self.tables);
            let seconds = self.gate.open() * T::lit(self.clock.hop_s());
            self.learned_s += seconds;
            let spacing = T::lit(self.clock.bin_spacing_hz());
            self.body.learn(frame, spacing, self.noise_density, evidence.weight, seconds);
        }
        self.tables.refresh_next(&self.body.body());
    }

    /// `|V|² = |U_1|² + 2 θ Re(U_1 U_2*) + θ² |U_2|²` with `U_2 = m_w J + c_s A + k_s V`.
    fn evidence(&self, frame: &Frame<T>, speed_m_s: T, envelope_m: T) -> Evidence<T> {
        let speed = if speed_m_s > T::lit(STANDING_M_S) { speed_m_s } else { T::lit(15.0) };
        let reach = T::lit(ENVELOPE_REACH) * speed / (T::lit(self.clock.bin_spacing_hz()) * envelope_m);
        let bins = (reach.to_f64() as usize).max(LEAST_BINS).min(self.bins);
        let body = self.body.body();
        let parts = [
            (WHEEL_JERK, body.unsprung_mass_kg),
            (RELATIVE_ACCELERATION, body.damping_n_s_per_m),
            (RELATIVE_VELOCITY, body.spring_n_per_m),
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

    /// The car as it seems to be now: sprung mass, damping and spring identified from the relation between body and
    /// wheel, which does not contain the tire; the unsprung mass as configured.
    pub fn quarter_car(&self) -> QuarterCar<T> {
        let body = self.body.body();
        QuarterCar::new(
            body.sprung_mass_kg,
            body.unsprung_mass_kg,
            body.damping_n_s_per_m,
            body.spring_n_per_m,
        )
        .unwrap_or(self.config.quarter_car)
    }

    /// What the frames since the last word say by themselves, whatever was believed before: a stiffness measurement for
    /// a filter outside. `None` until there are enough of them. Frames are tempered, so words may be added up.
    pub fn take_word(&mut self) -> Option<StiffnessWord<T>> {
        let (cell, variance) = self.posterior.take_word()?;
        let pressure_kpa = self.grid.pressure_kpa(0) + cell * self.grid.step_kpa();
        let per_cell = self.grid.step_kpa() * self.config.tire.stiffness_per_kpa();
        Some(StiffnessWord {
            stiffness_n_per_m: self.config.tire.stiffness_n_per_m(pressure_kpa),
            sd_n_per_m: variance.sqrt() * per_cell,
        })
    }

    /// What is believed now.
    pub fn belief(&self) -> Belief<T> {
        let summary = self.posterior.summary();
        let step = self.grid.step_kpa();
        // A cell is a small uniform distribution of its own.
        let variance = (summary.variance_cells2 + T::lit(1.0 / 12.0)) * step * step;
        // While the pressure moves, no single drift fits and the mean lags: the sd says so.
        let lag = T::one() + T::lit(MOVING_SD) * summary.moving;
        Belief {
            pressure_kpa: self.grid.pressure_kpa(0) + summary.mean_cell * step,
            pressure_sd_kpa: variance.sqrt() * lag,
            moving: summary.moving,
            surprise: self.gate.surprise(),
            gate: self.gate.open(),
            variance_growth: self.variance_growth,
            learned_s: self.learned_s,
        }
    }
}

/// What the estimator believes after a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Belief<T> {
    /// Posterior mean of the pressure in kPa.
    pub pressure_kpa: T,
    /// Its standard deviation in kPa.
    pub pressure_sd_kpa: T,
    /// Probability that the pressure is changing.
    pub moving: T,
    /// Power of the last frame over its expectation: about 1 when the model holds.
    pub surprise: T,
    /// Share of the last frame that was used, 0 to 1.
    pub gate: T,
    /// Factor by which the variance grew in the last prediction.
    pub variance_growth: T,
    /// Seconds of full information so far.
    pub learned_s: T,
}

/// A measurement of the stiffness, by a few frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessWord<T> {
    /// Stiffness in N/m; may lie outside what is possible when it says little.
    pub stiffness_n_per_m: T,
    /// Its standard deviation in N/m.
    pub sd_n_per_m: T,
}
