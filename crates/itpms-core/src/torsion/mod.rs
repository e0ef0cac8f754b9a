//! Torsional analysis: a road shakes the belt of a tire around its rim, and at which frequency it does so most depends on how stiff the
//! sidewalls are, that is, on the pressure. From the times at which the teeth of one wheel's speed sensor pass, [`TorsionWheel`] finds
//! that frequency, piece by piece of some 30 s, and by how much the pressure has changed since a calibration. It needs no other wheel, so
//! that it sees all four alike; [`CarTorsion`] is the four of a car, whose evidence
//! [`MonitoredWheels`](crate::monitor::MonitoredWheels::update_with_pulses) weigh together with radii.
//!
//! `docs/math/wheel-speed.md`, "Torsion", derives it. It uses the filters of `conditioning` and `spectrum` and the numbers of a loss from
//! `decision`, and knows neither radii nor accelerations.
//!
//! ```
//! use itpms_core::torsion::{TorsionConfig, TorsionWheel};
//!
//! # fn main() -> Result<(), itpms_core::ParameterError> {
//! let mut wheel = TorsionWheel::<f32>::new(&TorsionConfig::new())?;
//! wheel.begin_calibration();
//! for edge in 0..60_000 {
//!     // Twenty meters per second and not a tremble: nothing is to be seen in that.
//!     if let Some(piece) = wheel.push(f64::from(edge) * 2.03e-3) {
//!         assert!(!piece.used);
//!     }
//! }
//! assert_eq!(wheel.change(), None);
//! # Ok(())
//! # }
//! ```

mod calibration;
mod car;
mod config;
mod evidence;
mod fit;
mod reference;
mod speed;
mod teeth;

use nalgebra::SVector;

pub use self::calibration::{TorsionCalibration, TorsionCurve};
pub use self::car::{CarTorsion, NoWheelSpeeds, WheelSensors};
pub use self::config::TorsionConfig;
use self::evidence::LEVEL_VARIANCE_KPA2;
pub(crate) use self::evidence::{TorsionEvidence, level_variance_kpa2};
use self::fit::{BINS, Fitted, Spectrum, fit};
use self::reference::Reference;
use self::speed::Speed;
use self::teeth::{Edge, Teeth};
use crate::conditioning::pauses::LONG_STOP_S;
use crate::memory::Blank;
use crate::model::{OUTLIER_SD, ParameterError};
use crate::real::Real;
use crate::spectrum::FrameClock;

/// Time between the steps of the speed, and between frames that overlap by half, in s.
const STEP_S: f64 = 1e-3;
const HOP_S: f64 = 0.256;
/// Frames of a piece: 30 s.
const FRAMES: u32 = 116;
/// Slowest speed in m/s: below it too few teeth pass.
const LEAST_SPEED_M_S: f64 = 7.0;
/// Change of speed within a piece, as a share, beyond which it is no piece of one speed.
const MOST_CHANGE: f64 = 0.15;
/// How far a pressure wanders in kPa per √s, and what stays unknown of it however much is driven, in kPa.
const WALK_KPA: f64 = 0.4;
const LEVEL_SD_KPA: f64 = 5.0;
/// What a tire may have lost in a [long stop](LONG_STOP_S) without being seen, in kPa (sd): what radius analysis takes its radius to have
/// changed by.
const STANDING_SD_KPA: f64 = 34.0;
/// By how much pieces of the same pressure and speed differ beside what a spectrum's length allows, in Hz: by road, load and slip stiffness.
const MODEL_SD_HZ: f64 = 0.6;
/// How well the Hz per kPa are known, as a share of them and so of every change: of a tire nothing is known of.
const SCALE_SD: f64 = 0.2;

/// Result of a piece of driving.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TorsionPiece<T> {
    /// Time of its end in s.
    pub time_s: f64,
    /// Mean speed in m/s.
    pub speed_m_s: T,
    /// Resonance in Hz and its standard deviation.
    pub resonance_hz: T,
    /// Of the spectrum's length alone; how far pieces differ beside that is in [`TorsionChange`].
    pub resonance_sd_hz: T,
    /// Power of the resonance over that of the edges' variation.
    pub signal_to_noise: T,
    /// Whether it is informative: not if the former is below 3, the standard deviation above 3.5 Hz or the resonance at an end of the searched
    /// band.
    pub used: bool,
    /// By how much the pressure had changed since the calibration as this piece says by itself, of pieces that carry something after it; how
    /// far the Hz per kPa are known is not in its standard deviation.
    pub change: Option<TorsionChange<T>>,
}

/// Change of pressure since the calibration.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TorsionChange<T> {
    /// In kPa.
    pub change_kpa: T,
    /// Its standard deviation.
    pub change_sd_kpa: T,
}

/// Use of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Phase {
    #[blank]
    Idle,
    Learning,
    Watching,
}

/// The torsional analysis of one wheel; less than 2.5 kB in `f32`.
#[derive(Debug, Clone, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TorsionWheel<T: Real> {
    config: TorsionConfig<T>,
    phase: Phase,
    teeth: Teeth<T>,
    speed: Speed<T>,
    frames: FrameClock<T, BINS, 1>,
    power: SVector<T, BINS>,
    number: u32,
    begun_s: f64,
    turned_rad: T,
    slowest: T,
    fastest: T,
    reference: Reference<T>,
    change_kpa: T,
    variance_kpa2: T,
    /// The variance without any piece since the calibration.
    prior_kpa2: T,
    last_s: f64,
}

impl<T: Real> TorsionWheel<T> {
    /// A wheel with this sensor and tire, uncalibrated.
    ///
    /// # Errors
    /// A number that no wheel has.
    pub fn new(config: &TorsionConfig<T>) -> Result<Self, ParameterError> {
        let mut wheel = Self::BLANK;
        wheel.configure(config)?;
        Ok(wheel)
    }

    /// Begins anew with this sensor and tire, uncalibrated.
    fn configure(&mut self, config: &TorsionConfig<T>) -> Result<(), ParameterError> {
        config.check()?;
        *self = Self::BLANK;
        self.config = *config;
        self.teeth.configure(config.teeth);
        self.frames.configure(HOP_S, STEP_S);
        self.last_s = f64::NAN;
        Ok(())
    }

    /// The pressure is as it should be from the next piece on: learns how the resonance and its spectrum depend on the speed.
    pub fn begin_calibration(&mut self) {
        self.phase = Phase::Learning;
        self.reference = Reference::new(&self.config);
        self.drop_piece();
    }

    /// Ends the calibration; whether a piece was seen in it.
    pub fn end_calibration(&mut self) -> bool {
        let learned = self.phase == Phase::Learning && self.reference.pieces() > 0;
        self.phase = if learned { Phase::Watching } else { Phase::Idle };
        self.start();
        learned
    }

    fn start(&mut self) {
        // What no piece tells of a level it does not tell of the calibration's either.
        let variance = T::lit(LEVEL_VARIANCE_KPA2);
        (self.change_kpa, self.variance_kpa2, self.prior_kpa2) = (T::zero(), variance, variance);
        self.drop_piece();
    }

    /// The result of the last calibration; `None` before its end.
    #[must_use]
    pub fn calibration(&self) -> Option<TorsionCalibration<T>> {
        (self.phase == Phase::Watching).then(|| self.reference.stored())
    }

    /// Begins a drive with a stored calibration; the tire may have lost air since. Whether it was one that a tire can have; what is none
    /// changes nothing.
    #[must_use]
    pub fn load_calibration(&mut self, calibration: &TorsionCalibration<T>) -> bool {
        if !calibration.is_sane() {
            return false;
        }
        self.reference = Reference::of(calibration);
        self.phase = Phase::Watching;
        self.start();
        self.widen();
        true
    }

    /// A tire may have lost air without a sample of it.
    fn widen(&mut self) {
        let standing = T::lit(STANDING_SD_KPA * STANDING_SD_KPA);
        self.variance_kpa2 += standing;
        self.prior_kpa2 += standing;
    }

    /// By how much the pressure has changed since the calibration; `None` before its end.
    #[must_use]
    pub fn change(&self) -> Option<TorsionChange<T>> {
        (self.phase == Phase::Watching).then(|| TorsionChange {
            change_kpa: self.change_kpa,
            change_sd_kpa: self
                .variance_kpa2
                .sqrt()
                .hypot(T::lit(LEVEL_SD_KPA))
                .hypot(T::lit(SCALE_SD) * self.change_kpa),
        })
    }

    /// The same as what the pieces alone say, without what is believed beforehand (`docs/math/wheel-speed.md`, eq. 18): the change in kPa and
    /// its information, in 1/kPa², zero where there was no piece.
    pub(crate) fn seen(&self) -> (T, T) {
        if self.phase != Phase::Watching {
            return (T::zero(), T::zero());
        }
        let information = T::one() / self.variance_kpa2 - T::one() / self.prior_kpa2;
        if !(information > T::lit(1e-7)) {
            return (T::zero(), T::zero());
        }
        (self.change_kpa / self.variance_kpa2 / information, information)
    }

    /// Where the teeth were found to be: by how many pitches each lies too far on, from an unknown first one on.
    #[must_use]
    pub fn tooth_errors(&self) -> &[T] {
        self.teeth.errors()
    }

    /// Takes in an edge at a time in s; what a piece has shown that ends with it. Times that go back, and edges that come far too early
    /// or late, begin a piece anew.
    pub fn push(&mut self, time_s: f64) -> Option<TorsionPiece<T>> {
        let before_s = core::mem::replace(&mut self.last_s, time_s);
        let pitch_rad = T::lit(core::f64::consts::TAU) / T::whole(self.config.teeth);
        if time_s - before_s > LONG_STOP_S {
            self.widen();
        }
        let interval_s = T::lit(time_s - before_s);
        let pitches = match self.teeth.push(interval_s) {
            Edge::Tooth(pitches) => pitches,
            Edge::Lost => {
                self.drop_piece();
                return None;
            }
        };
        let rate_rad_s = pitch_rad * pitches / interval_s;
        let speed_m_s = rate_rad_s * self.config.rolling_radius_m;
        if !self.teeth.learned() || !(speed_m_s > T::lit(LEAST_SPEED_M_S)) {
            self.drop_piece();
            return None;
        }
        if self.number == 0 && !(self.slowest > T::zero()) {
            (self.begun_s, self.slowest, self.fastest) = (before_s, speed_m_s, speed_m_s);
        }
        self.slowest = self.slowest.at_most(speed_m_s);
        self.fastest = self.fastest.at_least(speed_m_s);
        self.turned_rad += pitch_rad * pitches;
        let Self { speed, frames, power, number, .. } = self;
        speed.push(before_s, time_s, rate_rad_s, |trembling| {
            if let Some(frame) = frames.push(&[trembling]) {
                *number += 1;
                for (bin, power) in power.iter_mut().enumerate() {
                    *power += frame.at(bin, 0).norm_sqr();
                }
            }
        });
        if self.fastest > self.slowest * T::lit(1.0 + MOST_CHANGE) {
            self.drop_piece();
            return None;
        }
        (self.number >= FRAMES).then(|| self.end_piece(time_s))
    }

    fn drop_piece(&mut self) {
        self.number = 0;
        self.power = SVector::zeros();
        (self.slowest, self.fastest, self.turned_rad) = (T::zero(), T::zero(), T::zero());
        self.frames.restart();
        self.speed.restart();
    }

    fn end_piece(&mut self, time_s: f64) -> TorsionPiece<T> {
        let share = T::one() / T::whole(self.number);
        let lasted_s = T::lit(time_s - self.begun_s);
        let rate_rad_s = self.turned_rad / lasted_s;
        let speed_m_s = rate_rad_s * self.config.rolling_radius_m;
        let pitch_rad = T::lit(core::f64::consts::TAU) / T::whole(self.config.teeth);
        let spectrum = Spectrum {
            power: self.power * share,
            frames: self.number,
            tooth_hz: rate_rad_s / pitch_rad,
            edge_variance_rad2: self.teeth.edge_variance() * pitch_rad * pitch_rad,
        };
        let fitted = fit(&spectrum, &self.reference.shape(speed_m_s));
        let change = self.take(&fitted, speed_m_s, lasted_s);
        self.drop_piece();
        TorsionPiece {
            time_s,
            speed_m_s,
            resonance_hz: fitted.hz,
            resonance_sd_hz: fitted.sd_hz,
            signal_to_noise: fitted.signal_to_noise,
            used: fitted.carries(),
            change,
        }
    }

    /// A piece's pressure, which is believed from then on.
    fn take(&mut self, fitted: &Fitted<T>, speed_m_s: T, lasted_s: T) -> Option<TorsionChange<T>> {
        let walk = T::lit(WALK_KPA * WALK_KPA) * lasted_s;
        self.variance_kpa2 += walk;
        self.prior_kpa2 += walk;
        if !fitted.carries() {
            return None;
        }
        let model = T::lit(MODEL_SD_HZ * MODEL_SD_HZ);
        let variance = fitted.sd_hz * fitted.sd_hz + model;
        match self.phase {
            Phase::Idle => None,
            Phase::Learning => {
                self.reference.learn(fitted, speed_m_s, variance);
                None
            }
            Phase::Watching => {
                let (expected_hz, expected_variance) = self.reference.resonance(speed_m_s);
                let per_hz = T::one() / self.config.resonance_per_kpa;
                let change_kpa = (fitted.hz - expected_hz) * per_hz;
                let residual = change_kpa - self.change_kpa;
                let noise = (variance + expected_variance) * per_hz * per_hz;
                let all = noise + self.variance_kpa2;
                if residual * residual < T::lit(OUTLIER_SD * OUTLIER_SD) * all {
                    let gain = self.variance_kpa2 / all;
                    self.change_kpa += gain * residual;
                    self.variance_kpa2 -= gain * self.variance_kpa2;
                } else {
                    self.widen();
                }
                Some(TorsionChange { change_kpa, change_sd_kpa: noise.sqrt() })
            }
        }
    }
}
