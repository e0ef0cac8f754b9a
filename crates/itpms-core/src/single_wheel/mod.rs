//! The default estimator of one corner: a Bayes filter on a grid of pressures that knows one more thing than the
//! paper's filter, namely that a road looks like a road (docs/math/informed.md).
//!
//! The spectrum of a road is a smooth power law. Reconstructed with a wrong stiffness it shows a wheel-hop peak or
//! notch near 10-14 Hz; how unlikely that is, for every stiffness of a grid, is the information. Short spectral frames
//! feed it some seventeen times a second; leak modes and road-level modes say how fast belief may change.
//!
//! | module | idea |
//! |---|---|
//! | `gate` | how much of a frame to believe |
//! | `outside` | a stiffness that another follows in its place |
//! | `tables` | what frames should look like for every stiffness of the grid |
//! | `dynamics` | how pressure and road may change |
//! | `road_model` | level, slope and enveloping of the road under one hypothesis |
//! | `cells` | loops over the grid |
//! | `grid_posterior` | the posterior over the grid, predicted and updated |
//! | `road_fits` | a frame's evidence for every cell and level mode |
//! | `frame_units` | in which order all of that is done, in units of which one falls on every grid step |

mod cells;
mod dynamics;
mod frame_units;
mod gate;
mod grid_posterior;
mod outside;
mod road_fits;
mod road_model;
mod tables;

use nalgebra::Complex;

use crate::conditioning::{GridSample, STANDING_M_S};
use crate::memory::{Blank, Placed};
use crate::model::{Corner, CornerConfig, QuarterCar, Side};
use crate::real::Real;
use crate::single_wheel::frame_units::FrameWork;
pub(crate) use crate::single_wheel::frame_units::Pace;
use crate::single_wheel::gate::Gate;
use crate::single_wheel::grid_posterior::Posterior;
pub use crate::single_wheel::outside::OutsideStiffness;
use crate::single_wheel::road_model::Evidence;
use crate::single_wheel::tables::{Grid, Tables};
use crate::spectrum::persistence::Persistence;
use crate::spectrum::reconstruction::{
    RELATIVE_ACCELERATION, RELATIVE_VELOCITY, ROAD_SIGNALS, SIGNALS, WHEEL_JERK, WHEEL_VELOCITY,
};
use crate::spectrum::transfer::{Body, DescribingFunction};
use crate::spectrum::{FrameClock, INDEPENDENT};

/// Spectral bins of a frame: 8.3, 16.7, ... 100 Hz.
const BINS: usize = 12;
/// Nominal time between frames in s; a frame lasts twice as long.
const HOP_S: f64 = 0.06;
/// Frames whose information the grid takes at once.
const FRAMES_AT_ONCE: f64 = 2.0;
/// A frame of the signals that make up the road velocity.
type Frame<T> = crate::spectrum::Frame<T, BINS, ROAD_SIGNALS>;

/// Highest frequency used, as a share of the sampling rate.
const BAND: f64 = 0.25;
/// Frequency times enveloping length over speed up to which enveloping is a smooth loss.
const ENVELOPE_REACH: f64 = 0.75;
/// Bins used however long the enveloping may be: up to 40 Hz, so that wheel hop has neighbours on both sides.
const LEAST_BINS: usize = 5;
/// Share by which the sd grows while the pressure surely moves fast: found on seeds of its own so that intervals cover
/// more of a drop without covering too much at other times.
const MOVING_SD: f64 = 0.7;
/// How well a calibration sets the pressure, as a share of the placard pressure: 3 kPa at 241.3 kPa.
pub const CALIBRATION_SD: f64 = 0.0125;
/// Seconds for which a change is taken to go on after an outside stiffness was last given.
const OLDEST_OUTSIDE_S: f64 = 0.3;
/// Least sd in cells with which an outside stiffness is put on the grid.
const LEAST_PIN_CELLS: f64 = 0.4;
/// Standard deviation in kPa of the pressure to start from.
const INITIAL_SD_KPA: f64 = 30.0;
/// Probability of the stiffest cells from which on the grid ends too soon: what it says is no measurement then, but a bound.
const MOST_AT_EDGE: f64 = 0.1;
/// Probability of an outermost cell from which on there is no pressure.
const BEYOND_RANGE: f64 = 0.5;

/// The default one-corner estimator's core, fed with grid samples. See the [module](self).
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Informed<T: Real> {
    config: CornerConfig<T>,
    grid: Grid<T>,
    /// The car as it seems to be now.
    body: Body<T>,
    tables: Tables<T>,
    /// Equivalent spring and damper of the strut's friction.
    friction: DescribingFunction<T>,
    clock: FrameClock<T, BINS, ROAD_SIGNALS>,
    posterior: Posterior<T>,
    sample_rate_hz: f64,
    grid_period_s: f64,
    noise_density: T,
    bins: usize,
    gate: Gate<T>,
    /// How much of the road near wheel hop is one line.
    persistence: Persistence<T>,
    variance_growth: T,
    learned_s: T,
    last_speed_m_s: T,
    invalid: bool,
    /// The stiffness that another source follows in the place of the frames, while one does, and when it was given.
    outside: Placed<OutsideStiffness<T>>,
    outside_s: f64,
    last_time_s: f64,
    /// Remaining work on the newest frame.
    work: FrameWork<T>,
}

impl<T: Real> Informed<T> {
    /// An estimator where it lies, for samples that were taken at `sample_rate_hz` and come on a grid of `grid_period_s`.
    pub(crate) fn configure(&mut self, config: &CornerConfig<T>, sample_rate_hz: f64, grid_period_s: f64) {
        (self.config, self.sample_rate_hz, self.grid_period_s) = (*config, sample_rate_hz, grid_period_s);
        self.clock.configure(HOP_S, grid_period_s);
        let spacing_hz = self.clock.bin_spacing_hz();
        self.bins = (BAND * sample_rate_hz / spacing_hz).clamp(1.0, BINS as f64) as usize;
        let noise = config.accel_noise_or_usual_m_s2();
        self.noise_density = T::lit(2.0 / sample_rate_hz) * noise * noise;
        self.grid = Grid::new(config.placard_kpa);
        let body = Body::from(&config.quarter_car);
        self.posterior.configure(FRAMES_AT_ONCE * self.clock.hop_s());
        self.tables.configure(spacing_hz, sample_rate_hz, &self.grid, &config.tire, &body);
        self.work.set_late(false);
        self.restart();
    }

    /// Its pairs of frames end when those of the car's other axle begin, and those of the right wheels half a hop after the left ones'; before
    /// the first sample.
    pub(crate) fn stagger(&mut self, corner: Corner) {
        self.work.set_late(corner.side().rear() == corner);
        if corner.side() == Side::Right {
            self.clock.delay();
        }
    }

    /// Forgets everything, as before the first sample. The tables come back to the car as configured cell by cell: all of them at once
    /// are the work of a hundred samples.
    pub(crate) fn restart(&mut self) {
        self.clock.restart();
        let config = &self.config;
        let initial = config.initial_kpa.unwrap_or(config.placard_kpa);
        let initial_cell = (initial - self.grid.pressure_kpa(0)) / self.grid.step_kpa();
        let scale = config.placard_kpa / T::lit(dynamics::REFERENCE_KPA);
        let sd_cells = T::lit(INITIAL_SD_KPA) * scale / self.grid.step_kpa();
        self.posterior.restart(initial_cell, sd_cells);
        self.body = Body::from(&config.quarter_car);
        self.friction = DescribingFunction::BLANK;
        self.gate = Gate::new();
        self.persistence = Persistence::new(self.clock.hop_s());
        (self.variance_growth, self.learned_s) = (T::one(), T::zero());
        self.last_speed_m_s = T::lit(f64::NAN);
        self.invalid = false;
        self.outside.clear();
        (self.outside_s, self.last_time_s) = (f64::NAN, f64::NAN);
        self.work.clear();
    }

    /// Takes one grid sample and its signals; true when the belief has moved.
    pub(crate) fn push(&mut self, sample: &GridSample<T>, signals: &[T; SIGNALS], pace: Pace) -> bool {
        if sample.after_gap {
            self.clock.restart();
            self.work.drop_first();
        }
        self.last_time_s = sample.time_s;
        self.invalid |= sample.invalid;
        let learned = self.work_on(pace);
        let Some(signals) = signals.first_chunk() else { return learned };
        // By reference: it would be moved about.
        if let Some(frame) = &self.clock.push(signals) {
            self.begin_frame(frame, sample.speed_m_s);
        }
        learned
    }

    /// Takes the stiffness that another source follows; its frames count nothing until `None` is given.
    pub(crate) fn follow(&mut self, outside: Option<OutsideStiffness<T>>) {
        if let Some(outside) = &outside {
            let tire = &self.config.tire;
            let pressure = tire.pressure_kpa(outside.stiffness_n_per_m);
            let sd = outside.stiffness_sd_n_per_m / tire.stiffness_per_kpa();
            let cell = (pressure - self.grid.pressure_kpa(0)) / self.grid.step_kpa();
            self.posterior.pin(cell, (sd / self.grid.step_kpa()).max(T::lit(LEAST_PIN_CELLS)));
            self.learned_s += outside.learned_s;
            self.outside_s = self.last_time_s;
        }
        self.outside.set(outside);
    }

    /// Seconds on the clock of the samples at the last one.
    pub(crate) fn last_time_s(&self) -> f64 {
        self.last_time_s
    }

    /// Takes over the car as it seems to be now, and what the strut's friction makes of its motion.
    pub(crate) fn set_strut(&mut self, body: Body<T>, friction: &DescribingFunction<T>) {
        (self.body, self.friction) = (body, *friction);
    }

    /// Whether the road is one line, as a washboard's is.
    pub(crate) fn is_on_line(&self) -> bool {
        self.persistence.is_line()
    }

    /// Tells that the tire has its placard pressure now, as during a calibration.
    pub(crate) fn set_to_placard(&mut self) {
        let cell = (self.config.placard_kpa - self.grid.pressure_kpa(0)) / self.grid.step_kpa();
        self.posterior.pin(cell, T::lit(CALIBRATION_SD) * self.config.placard_kpa / self.grid.step_kpa());
    }

    /// Seconds of full information since the start.
    pub(crate) fn learned_s(&self) -> T {
        self.learned_s
    }

    /// The force on the tire's spring in a bin, its rate in N/s: `U_2 = m_w J + c_s A + k_s V`.
    fn force_rate(&self, frame: &Frame<T>, bin: usize) -> Complex<T> {
        frame.at(bin, WHEEL_JERK) * self.body.unsprung_mass_kg
            + frame.at(bin, RELATIVE_ACCELERATION) * self.body.damping_n_s_per_m
            + frame.at(bin, RELATIVE_VELOCITY) * self.body.spring_n_per_m
    }

    /// The road velocity in the bins around wheel hop, at the compliance in m/N of a tire.
    fn road_near_hop(&self, frame: &Frame<T>, theta: T) -> [Complex<T>; 2] {
        core::array::from_fn(|bin| frame.at(bin, WHEEL_VELOCITY) + self.force_rate(frame, bin) * theta)
    }

    /// `|V|² = |U_1|² + 2 θ Re(U_1 U_2*) + θ² |U_2|²`, with the wheel's velocity `U_1`.
    fn evidence(&self, frame: &Frame<T>, speed_m_s: T, envelope_m: T) -> Evidence<T> {
        let speed = if speed_m_s > T::lit(STANDING_M_S) { speed_m_s } else { T::lit(15.0) };
        let reach = T::lit(ENVELOPE_REACH) * speed / (T::lit(self.clock.bin_spacing_hz()) * envelope_m);
        let bins = (reach.to_whole().max(0) as usize).max(LEAST_BINS).min(self.bins);
        let mut evidence = Evidence {
            a: [T::zero(); BINS],
            b: [T::zero(); BINS],
            c: [T::zero(); BINS],
            envelope: [T::zero(); BINS],
            bins,
            noise_density: self.noise_density,
            weight: T::lit(INDEPENDENT),
        };
        let unit = T::pi() * T::lit(0.1) / speed;
        for bin in 0..BINS {
            evidence.envelope[bin] = unit * unit * self.tables.frequency_squared[bin] / T::lit(3.0);
            let (velocity, force_rate) = (frame.at(bin, WHEEL_VELOCITY), self.force_rate(frame, bin));
            evidence.a[bin] = velocity.norm_sqr();
            evidence.b[bin] = velocity.re * force_rate.re + velocity.im * force_rate.im;
            evidence.c[bin] = force_rate.norm_sqr();
        }
        evidence
    }

    /// The car as it seems to be now: sprung mass, damping and spring as the body's equation of motion has them, which does not contain
    /// the tire; the unsprung mass as configured.
    pub(crate) fn quarter_car(&self) -> QuarterCar<T> {
        let body = &self.body;
        QuarterCar::new(
            body.sprung_mass_kg,
            body.unsprung_mass_kg,
            body.damping_n_s_per_m,
            body.spring_n_per_m,
        )
        .unwrap_or(self.config.quarter_car)
    }

    /// What the frames since the last pseudo-measurement say by themselves, whatever was believed before: a stiffness measurement for
    /// a filter outside. `None` until there are enough of them. Frames are tempered, so pseudo-measurements may be added up.
    pub(crate) fn take_pseudo_measurement(&mut self) -> Option<StiffnessPseudoMeasurement<T>> {
        if let Some(outside) = self.outside.as_mut() {
            let stiffness_n_per_m = outside.stiffness_n_per_m;
            let sd_n_per_m = outside.independent_sd_n_per_m.take()?;
            return Some(StiffnessPseudoMeasurement { stiffness_n_per_m, sd_n_per_m });
        }
        let (cell, variance) = self.posterior.take_pseudo_measurement()?;
        let pressure_kpa = self.grid.pressure_kpa(0) + cell * self.grid.step_kpa();
        let per_cell = self.grid.step_kpa() * self.config.tire.stiffness_per_kpa();
        Some(StiffnessPseudoMeasurement {
            stiffness_n_per_m: self.config.tire.stiffness_n_per_m(pressure_kpa),
            sd_n_per_m: variance.sqrt() * per_cell,
        })
    }

    /// The belief while another source follows the stiffness.
    fn outside_belief(&self, outside: &OutsideStiffness<T>) -> Belief<T> {
        let age_s = T::lit((self.last_time_s - self.outside_s).clamp(0.0, OLDEST_OUTSIDE_S));
        let change = T::one() + outside.rate_per_s * age_s;
        let sd_n_per_m = outside.stiffness_sd_n_per_m * change;
        Belief {
            pressure_kpa: self.config.tire.pressure_kpa(outside.stiffness_n_per_m * change),
            pressure_sd_kpa: sd_n_per_m / self.config.tire.stiffness_per_kpa(),
            moving: outside.change_probability,
            nis: outside.nis,
            gate: T::one(),
            variance_growth: T::one(),
            learned_s: self.learned_s,
            is_in_range: true,
        }
    }

    /// Whether there is something new for a filter that believes in a stiffness.
    pub(crate) fn has_pseudo_measurement(&self) -> bool {
        self.posterior.has_enough_frames()
    }

    /// As [`take_pseudo_measurement`](Self::take_pseudo_measurement), for a filter that believes in a stiffness
    /// with an sd, both in N/m; `believed` is called only when a pseudo-measurement is due.
    pub(crate) fn pseudo_measurement(
        &mut self,
        believed: impl FnOnce() -> (T, T),
    ) -> Option<StiffnessPseudoMeasurement<T>> {
        if self.outside.as_ref().is_some() {
            return self.take_pseudo_measurement();
        }
        if !self.posterior.has_enough_frames() {
            return None;
        }
        let (stiffness_n_per_m, sd_n_per_m) = believed();
        let step = self.grid.step_kpa();
        let tire = &self.config.tire;
        let beyond = self.posterior.stiff_edge() > T::lit(MOST_AT_EDGE);
        let cell = (tire.pressure_kpa(stiffness_n_per_m) - self.grid.pressure_kpa(0)) / step;
        let sd_cells = sd_n_per_m / tire.stiffness_per_kpa() / step;
        let (cell, variance) = self.posterior.pseudo_measurement(cell, sd_cells).filter(|_| !beyond)?;
        let pressure_kpa = self.grid.pressure_kpa(0) + cell * step;
        Some(StiffnessPseudoMeasurement {
            stiffness_n_per_m: tire.stiffness_n_per_m(pressure_kpa),
            sd_n_per_m: variance.sqrt() * step * tire.stiffness_per_kpa(),
        })
    }

    pub(crate) fn belief(&self) -> Belief<T> {
        if let Some(outside) = self.outside.as_ref() {
            return self.outside_belief(outside);
        }
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
            nis: self.gate.nis(),
            gate: self.gate.open(),
            variance_growth: self.variance_growth,
            learned_s: self.learned_s,
            is_in_range: self.posterior.edge() < T::lit(BEYOND_RANGE),
        }
    }
}

/// Belief after a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Belief<T> {
    pub(crate) pressure_kpa: T,
    pub(crate) pressure_sd_kpa: T,
    pub(crate) moving: T,
    /// Power of the last frame over its expectation: about 1 when the model holds.
    pub(crate) nis: T,
    /// Share of the last frame that was used, 0 to 1.
    pub(crate) gate: T,
    /// Factor by which the variance grew in the last prediction.
    pub(crate) variance_growth: T,
    pub(crate) learned_s: T,
    /// Whether the pressure lies within the range that is looked at, and not at an end of it.
    pub(crate) is_in_range: bool,
}

/// A measurement of the stiffness, by a few frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessPseudoMeasurement<T> {
    /// Stiffness in N/m; may lie outside what is possible when it says little.
    pub stiffness_n_per_m: T,
    /// Its standard deviation in N/m.
    pub sd_n_per_m: T,
}
