//! Radius analysis: a tire that loses air rolls on a smaller radius and turns faster than the others. From four wheel speeds, and
//! what a bus says of yaw rate, acceleration and brakes, it finds which tires differ from the others since a calibration.
//! [`MonitoredWheels`](crate::monitor::MonitoredWheels) are its way in and out.
//!
//! A loss of all four alike is not seen in radii, but by tooth pulses
//! ([`update_with_pulses`](crate::monitor::MonitoredWheels::update_with_pulses)). `docs/math/wheel-speed.md` derives it.
//! It knows of nothing else here than [`model`](crate::model) and what [`torsion`](crate::torsion) says.
//!
//! ```
//! use itpms_core::MonitoredWheels;
//! use itpms_core::wheel_speed::{DrivenAxle, RadiusState, WheelSpeedConfig, WheelSpeedSample};
//!
//! # fn main() -> Result<(), itpms_core::ParameterError> {
//! // Wheelbase, tracks, driven axle.
//! let mut wheels = MonitoredWheels::<f32>::new(&WheelSpeedConfig::new(2.66, 1.56, 1.57, DrivenAxle::Front))?;
//! // The pressures have just been set: the next five minutes teach how the tires differ.
//! wheels.begin_calibration(300.0)?;
//! for k in 0..1000 {
//!     wheels.update(&WheelSpeedSample {
//!         time_s: f64::from(k) / 80.0,
//!         wheel_speed_m_s: [20.01, 20.0, 19.97, 19.98],
//!         yaw_rate_rad_s: 0.001,
//!         accel_x_m_s2: f32::NAN, // The bus does not say.
//!         accel_y_m_s2: f32::NAN,
//!         brake: Some(false),
//!     });
//!     assert_eq!(wheels.radii().state, RadiusState::Calibrating);
//! }
//! // Once it is there: to be stored, and loaded at the next start.
//! assert!(wheels.calibration().is_none());
//! # Ok(())
//! # }
//! ```

mod block;
mod calibration;
mod config;
mod filter;
mod gaussian;
mod hypotheses;
mod report;
mod sample;
mod sensor_watch;
#[cfg(test)]
pub(crate) mod tests;
mod yaw_witness;

use self::block::{BLOCK_S, Block, BlockSums};
use self::calibration::LEARNED;
pub use self::calibration::RadiusCalibration;
pub use self::config::{DrivenAxle, LoadUncertainty, WheelSpeedConfig};
use self::filter::Filter;
use self::hypotheses::{Decision, PLACES, Triangle, add_load, all_would_be_found, seen};
pub use self::report::{Pattern, RadiusReport, RadiusState, Unseen, WheelRadius};
pub use self::sample::WheelSpeedSample;
use self::sensor_watch::SensorWatch;
use self::yaw_witness::YawWitness;
use crate::conditioning::pauses::{LONG_STOP_S, PAUSE_S};
use crate::memory::Blank;
use crate::model::{Corner, ParameterError, RadiusDifferences, Wheels};
use crate::real::Real;
use crate::torsion::TorsionEvidence;

/// The three ratios: front left over right, rear left over right, front over rear.
const FRONT: usize = 0;
const REAR: usize = 1;
const AXLE: usize = 2;

/// The state, in thousandths (mrad/s where it is a yaw rate): three offsets, four radii since the calibration, slip per m/s², disturbances,
/// and by how much more per m/s² the left wheel of each axle slips than the right one.
const OFFSET: usize = 0;
const RADIUS: usize = 3;
const SLIP: usize = 7;
const YAW_BIAS: usize = 8;
const YAW_NOISE: usize = 9;
const FRONT_WANDER: usize = 10;
const REAR_WANDER: usize = 11;
const AXLE_FORCE: usize = 12;
const UNEQUAL_SLIP: usize = 13;
const STATES: usize = 15;
/// Log ratios are kept in thousandths, so that single precision holds their squares.
const SCALE: f64 = 1e3;

/// Usable driving in s that teaches anything.
const LEAST_CALIBRATION_S: f64 = 10.0;
/// Loss that radii are measured in: `-ln 0.8`, of a fifth.
const FIFTH: f64 = 0.223_143_55;

/// What the monitor does with a block.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Phase<T> {
    Uncalibrated,
    /// Learns, for so much more usable driving in s.
    Learning(T),
    Watching,
}

impl<T> Blank for Phase<T> {
    const BLANK: Self = Phase::Uncalibrated;
}

/// Finds which tires roll on a smaller radius than at the calibration; less than 4 kB in `f32`.
#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RadiusMonitor<T> {
    config: WheelSpeedConfig<T>,
    configured: bool,
    phase: Phase<T>,
    /// Usable driving of the calibration so far, in s.
    learned_s: T,
    calibration: Option<RadiusCalibration<T>>,
    /// The radii at the calibration against those at the pressures that should be, in thousandths.
    radius_1e3: [T; 4],
    filter: Filter<T>,
    sums: BlockSums<T>,
    /// A block ended with the last sample.
    ended: bool,
    /// The block before the last one was good.
    before_good: bool,
    /// The last block, which waits until the next one shows that no braking begins in it.
    last: Block<T>,
    /// The car stood for so long, in s.
    stood_s: f64,
    loads_may_differ: bool,
    yaw: YawWitness<T>,
    sensors: SensorWatch<T>,
    torsion: TorsionEvidence<T>,
    report: RadiusReport<T>,
}

impl<T: Real> RadiusMonitor<T> {
    /// Begins anew with this car, uncalibrated.
    ///
    /// # Errors
    /// A length or a radius over pressure that no car has; the monitor is unconfigured then.
    pub(crate) fn configure(&mut self, config: &WheelSpeedConfig<T>) -> Result<(), ParameterError> {
        *self = Self::BLANK;
        self.report.time_s = f64::NAN;
        self.report.forget(RadiusState::Uncalibrated);
        config.check()?;
        self.config = *config;
        self.configured = true;
        Ok(())
    }

    /// Learns how the tires differ during so much usable driving in s (300 to 600; at least 10 are taken) at pressures that are known: each
    /// is so much of what it should be (0.2 to 5; anything else counts as 1). An earlier calibration is forgotten.
    /// A tire that is low at the calibration is reported as low from its end on.
    pub(crate) fn begin_calibration_at(&mut self, usable_s: T, pressure_share: &[T; 4]) {
        if !self.configured {
            return;
        }
        self.phase = Phase::Learning(usable_s.at_least(T::lit(LEAST_CALIBRATION_S)));
        self.learned_s = T::zero();
        self.calibration = None;
        self.yaw = YawWitness::BLANK;
        self.loads_may_differ = false;
        let beta = self.config.radius_per_ln_pressure * T::lit(SCALE);
        let known = |share: &T| *share >= T::lit(0.2) && *share <= T::lit(5.0);
        self.radius_1e3 =
            pressure_share.map(|share| if known(&share) { beta * share.ln_fast() } else { T::zero() });
        self.filter.begin(&self.config, &self.radius_1e3);
        self.interrupt();
        self.report.forget(RadiusState::Calibrating);
    }

    /// What the last calibration taught; `None` before its end.
    #[must_use]
    pub(crate) fn calibration(&self) -> Option<&RadiusCalibration<T>> {
        self.calibration.as_ref()
    }

    /// The pressures are not known to be as they should be from here on: the calibration that goes on ends with what it has seen. Whether
    /// that was enough (10 s of usable driving); if not, nothing was learned.
    pub(crate) fn end_calibration(&mut self) -> bool {
        if !matches!(self.phase, Phase::Learning(_)) {
            return self.calibration.is_some();
        }
        if self.learned_s >= T::lit(LEAST_CALIBRATION_S) {
            self.learned();
            return true;
        }
        self.phase = Phase::Uncalibrated;
        self.report.forget(RadiusState::Uncalibrated);
        false
    }

    /// Begins a drive with a stored calibration. Loads may have changed since, and tires lost air. Whether it was one that a car can
    /// have; what is none changes nothing.
    #[must_use]
    pub(crate) fn load_calibration(&mut self, calibration: &RadiusCalibration<T>) -> bool {
        if !self.configured || !calibration.is_sane() {
            return false;
        }
        self.calibration = Some(*calibration);
        if calibration.leaves_out_yaw_rate {
            self.yaw.doubt();
        }
        self.loads_may_differ = true;
        self.watch_again(calibration);
        true
    }

    /// Whether half a second ended with the last sample, so that [`differences`](Self::differences) may be others.
    #[must_use]
    pub(crate) fn has_news(&self) -> bool {
        self.ended
    }

    /// By how much the ratios of the radii have changed since the calibration; `None` without one.
    #[must_use]
    pub(crate) fn differences(&self) -> Option<RadiusDifferences<T>> {
        if self.phase != Phase::Watching {
            return None;
        }
        let (change_1e3, [covariance_1e6, _]) = self.changes();
        Some(RadiusDifferences {
            change_1e3,
            covariance_1e6,
            per_ln_pressure: self.config.radius_per_ln_pressure,
            per_ln_pressure_relative_sd: self.config.radius_per_ln_pressure_sd,
        })
    }

    /// What was reported last.
    #[must_use]
    pub(crate) fn report(&self) -> &RadiusReport<T> {
        &self.report
    }

    /// Whether the yaw rate went against what the wheels show of bends: it is left out from then on, as if there were none.
    #[must_use]
    pub(crate) fn doubts_yaw_rate(&self) -> bool {
        self.yaw.is_doubted()
    }

    /// The wheels whose sensors repeat one value while others move: nothing is learned meanwhile.
    #[must_use]
    pub(crate) fn stuck(&self) -> Wheels {
        self.sensors.stuck()
    }

    /// What tooth pulses say of the pressures from here on, by themselves: it counts in every decision.
    pub(crate) fn see_pulses(&mut self, torsion: &TorsionEvidence<T>) {
        self.torsion = *torsion;
    }

    /// Takes in a sample, of 10 Hz or more; speeds that no wheel has, and times that go back, are left out.
    pub(crate) fn update(&mut self, sample: &WheelSpeedSample<T>) -> &RadiusReport<T> {
        let time_s = sample.time_s;
        if !self.configured || !time_s.is_finite() {
            return &self.report;
        }
        let step_s = time_s - self.report.time_s;
        self.ended = false;
        if !(step_s > 0.0 && step_s < PAUSE_S) {
            if step_s <= 0.0 && step_s > -PAUSE_S {
                return &self.report;
            }
            // The first sample, a gap, or another clock.
            self.gap(step_s);
            self.sums.begin(time_s);
            self.ended = true;
        } else if self.sums.is_over(time_s) {
            self.end_block();
            self.sums.begin(time_s);
            self.ended = true;
        }
        self.report.time_s = time_s;
        if sample.complete() {
            let moved = self.stuck().is_empty();
            // A gap, or another clock, is no time in which others moved.
            let follows = step_s > 0.0 && step_s < PAUSE_S;
            self.sensors.take(sample, if follows { T::lit(step_s) } else { T::zero() });
            if self.stuck().is_empty() {
                self.sums.add(sample);
            } else if moved {
                // For a second or more it has been so.
                self.learn_again();
                self.sums.begin(time_s);
            }
        }
        &self.report
    }

    /// Forgets the blocks that have begun.
    fn interrupt(&mut self) {
        self.before_good = false;
        self.last.good = false;
        self.yaw.interrupt();
        self.sums.begin(f64::NEG_INFINITY);
    }

    /// No sample came for some time: the car may have stood.
    fn gap(&mut self, step_s: f64) {
        self.interrupt();
        if step_s > 0.0 {
            if self.phase != Phase::Uncalibrated {
                // Disturbances have gone their way, too; an hour later nothing is left of them.
                self.filter.predict(T::lit(step_s.min(3600.0)), matches!(self.phase, Phase::Learning(_)));
            }
            self.stand(step_s);
        }
    }

    fn stand(&mut self, step_s: f64) {
        let before_s = self.stood_s;
        self.stood_s += step_s;
        if self.phase == Phase::Watching && before_s < LONG_STOP_S && !(self.stood_s < LONG_STOP_S) {
            self.loads_may_differ = true;
            self.filter.stood(self.config.driven);
        }
    }

    fn end_block(&mut self) {
        let mut block = self.sums.conclude(&self.config, self.sensors.step_m_s());
        if self.yaw.take(&block, &self.config) {
            if let Some(calibration) = self.calibration.as_mut() {
                calibration.leaves_out_yaw_rate = true;
            }
            self.learn_again();
        }
        if self.yaw.is_doubted() {
            block.yaw_rate_rad_s = None;
        }
        if self.sums.stood() {
            self.stand(BLOCK_S);
        } else if block.speed_m_s > T::zero() {
            self.stood_s = 0.0;
        }
        let learning = matches!(self.phase, Phase::Learning(_));
        if self.phase != Phase::Uncalibrated {
            self.filter.predict(T::lit(BLOCK_S), learning);
            if self.before_good && self.last.good && block.good {
                let last = self.last;
                self.filter.update(&last, &self.config, learning);
                self.used(&last);
            }
            if !self.filter.is_finite() {
                self.restart();
            }
        }
        self.before_good = self.last.good;
        self.last = block;
    }

    /// A block was taken in.
    fn used(&mut self, block: &Block<T>) {
        match self.phase {
            Phase::Uncalibrated => {}
            Phase::Learning(left_s) => {
                // What a coupled axle hides cannot be learned.
                let seen_s = if block.used == [true; 3] { T::lit(BLOCK_S) } else { T::zero() };
                let left_s = left_s - seen_s;
                self.learned_s += seen_s;
                self.phase = Phase::Learning(left_s);
                if !(left_s > T::zero()) {
                    self.learned();
                }
            }
            Phase::Watching => self.decide(block),
        }
    }

    fn learned(&mut self) {
        let belief = self.filter.belief();
        let (radius_1e3, leaves_out_yaw_rate) = (self.radius_1e3, self.yaw.is_doubted());
        let mut calibration =
            RadiusCalibration { radius_1e3, leaves_out_yaw_rate, ..RadiusCalibration::BLANK };
        let rows = calibration.mean_1e3.iter_mut().zip(&mut calibration.covariance_1e6);
        for (state, (mean, row)) in LEARNED.into_iter().zip(rows) {
            *mean = belief.mean.get(state).copied().unwrap_or(T::ZERO);
            for (other, entry) in LEARNED.into_iter().zip(row) {
                *entry = belief.get(state, other);
            }
        }
        self.calibration = Some(calibration);
        self.phase = Phase::Watching;
        self.report.forget(RadiusState::Uninformed);
    }

    /// The changes of the three ratios in thousandths, their covariance, and that of the offsets from which they are counted, each with
    /// what loads may have done.
    fn changes(&self) -> ([T; 3], [Triangle<T>; 2]) {
        let belief = self.filter.belief();
        let radius = core::array::from_fn(|i| belief.mean[RADIUS + i]);
        let (change, covariance) = seen(&radius, |i, j| belief.get(RADIUS + i, RADIUS + j));
        let offsets = PLACES.map(|(i, j)| belief.get(OFFSET + i, OFFSET + j));
        let mut covariances = [covariance, offsets];
        if self.loads_may_differ {
            covariances.iter_mut().for_each(|covariance| add_load(covariance, &self.config.load));
        }
        (change, covariances)
    }

    fn decide(&mut self, block: &Block<T>) {
        let (change, [covariance, offsets]) = self.changes();
        let fifth = T::lit(FIFTH * SCALE) * self.config.radius_per_ln_pressure;
        let decision = Decision::of(&change, &covariance, &offsets, fifth, &self.torsion);
        self.report.unseen = Unseen {
            all_alike: !all_would_be_found(&self.torsion),
            which_of_a_diagonal: !self.filter.yaw_known,
            loads: self.loads_may_differ,
            hidden_by_torque: hidden(block),
        };
        self.report.differ(&change, &covariance);
        self.report.decide(&decision, &self.config, &self.torsion, T::lit(BLOCK_S));
    }

    /// A sensor was wrong, and so is what was learned with it: a calibration that goes on begins anew.
    fn learn_again(&mut self) {
        if let Phase::Learning(left_s) = self.phase {
            self.phase = Phase::Learning(left_s + self.learned_s);
            self.learned_s = T::zero();
        }
        self.restart();
        self.interrupt();
    }

    /// Numbers ran away: what was learned is kept, the rest begins anew.
    fn restart(&mut self) {
        match self.calibration {
            Some(calibration) => self.watch_again(&calibration),
            None => self.filter.begin(&self.config, &self.radius_1e3),
        }
    }

    fn watch_again(&mut self, calibration: &RadiusCalibration<T>) {
        self.phase = Phase::Watching;
        self.filter.resume(&self.config, calibration);
        self.interrupt();
        self.report.forget(RadiusState::Uninformed);
    }
}

/// The wheels that torque hides.
fn hidden<T: Real>(block: &Block<T>) -> Wheels {
    Corner::ALL.into_iter().filter(|corner| block.hidden[corner.axle()]).collect()
}
