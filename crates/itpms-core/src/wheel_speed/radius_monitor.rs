//! The monitor of a car's radii: samples become blocks, blocks are learned from, and a calibration teaches what a change is held against. What it
//! decides is in `decide`.

mod decide;

use super::block::{BLOCK_S, Block, BlockSums};
use super::calibration::{LEARNED, RadiusCalibration};
use super::config::WheelSpeedConfig;
use super::days::{RadiusDays, SlowLeak};
use super::filter::Filter;
use super::follow::{Astray, Following};
use super::report::{RadiusReport, RadiusState};
use super::sensor_watch::SensorWatch;
use super::state::SCALE;
use super::yaw_witness::YawWitness;
use crate::conditioning::pauses::{LONG_STOP_S, PAUSE_S};
use crate::diagnosis::Malfunction;
use crate::memory::{Blank, Placed};
use crate::model::{Corner, ParameterError, RadiusDifferences, SEEN, WheelSpeedSample, Wheels};
use crate::real::Real;
use crate::torsion::TorsionEvidence;

/// Use of a block.
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

/// Finds which tires roll on a smaller radius than at the calibration; less than 5 kB in `f32`.
#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RadiusMonitor<T: Real> {
    config: WheelSpeedConfig<T>,
    configured: bool,
    phase: Phase<T>,
    /// Usable driving of the calibration so far, in s.
    learned_s: T,
    calibration: Placed<RadiusCalibration<T>>,
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
    /// The offsets from which changes are counted are not those of the calibration: they were learned anew since.
    began_anew: bool,
    /// The last calibration was driven on snow and taught nothing.
    refused_snow: bool,
    loads_may_differ: bool,
    yaw: YawWitness<T>,
    following: Following<T>,
    /// A speed did not follow the car in the last block.
    was_astray: bool,
    sensors: SensorWatch<T>,
    torsion: TorsionEvidence<T>,
    report: RadiusReport<T>,
    /// What the clock of the samples adds to s since 1970, and what the days since the calibration say.
    clock_began_unix_s: f64,
    days: RadiusDays<T>,
    slow_leak: SlowLeak<T>,
}

impl<T: Real> RadiusMonitor<T> {
    /// Begins anew with this car, uncalibrated.
    /// Errors: a length or a radius over pressure that no car has; the monitor is unconfigured then.
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
    /// is this share of its reference (0.2 to 5; anything else counts as 1). An earlier calibration is forgotten.
    /// A tire that is low at the calibration is reported as low from its end on.
    pub(crate) fn begin_calibration_at(&mut self, usable_s: T, pressure_share: &[T; 4]) {
        if !self.configured {
            return;
        }
        self.phase = Phase::Learning(usable_s.at_least(T::lit(self.config.tuning().least_calibration_s)));
        self.learned_s = T::zero();
        self.calibration.clear();
        self.refused_snow = false;
        self.load_days(&RadiusDays::BLANK);
        (self.yaw, self.following, self.was_astray) = (YawWitness::BLANK, Following::BLANK, false);
        (self.began_anew, self.loads_may_differ) = (false, false);
        let beta = self.config.radius_per_ln_pressure * T::lit(SCALE);
        let known = |share: &T| *share >= T::lit(0.2) && *share <= T::lit(5.0);
        self.radius_1e3 =
            pressure_share.map(|share| if known(&share) { beta * share.ln_fast() } else { T::zero() });
        self.filter.begin(&self.config, &self.radius_1e3);
        self.interrupt();
        self.report.forget(RadiusState::Calibrating);
    }

    /// Result of the last calibration; `None` before its end.
    #[must_use]
    pub(crate) fn calibration(&self) -> Option<&RadiusCalibration<T>> {
        self.calibration.as_ref()
    }

    /// The pressures are not known to be as they should be from here on: the calibration that goes on ends with what it has seen. Whether
    /// that was enough (10 s of usable driving); if not, nothing was learned.
    pub(crate) fn end_calibration(&mut self) -> bool {
        if !matches!(self.phase, Phase::Learning(_)) {
            return self.calibration.as_ref().is_some();
        }
        if self.learned_s >= T::lit(self.config.tuning().least_calibration_s) {
            self.learned();
            return self.calibration.as_ref().is_some();
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
        self.calibration.set(Some(*calibration));
        if calibration.leaves_out_yaw_rate {
            self.yaw.doubt();
        }
        self.loads_may_differ = true;
        self.watch_again(calibration);
        true
    }

    /// `d ln R / d ln p`, and its sd as a share of it.
    #[must_use]
    pub(crate) fn radius_per_ln_pressure(&self) -> (T, T) {
        (self.config.radius_per_ln_pressure, self.config.radius_per_ln_pressure_sd)
    }

    /// The samples' times count from here, in s since 1970.
    pub(crate) fn clock_began(&mut self, unix_s: f64) {
        self.clock_began_unix_s = unix_s;
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
        let driving = || {
            let (change, [covariance, _]) = self.driving();
            (change, covariance)
        };
        let (change_1e3, covariance_1e6) = self.since_calibration().unwrap_or_else(driving);
        Some(RadiusDifferences {
            change_1e3,
            covariance_1e6,
            per_ln_pressure: self.config.radius_per_ln_pressure,
            per_ln_pressure_relative_sd: self.config.radius_per_ln_pressure_sd,
        })
    }

    /// Whether the last calibration was refused because the driven wheels slipped as they do on snow.
    #[must_use]
    pub(crate) fn refused_snow(&self) -> bool {
        self.refused_snow
    }

    /// The tires have rolled so many km since the calibration: they have worn, each by itself.
    pub(crate) fn age(&mut self, km: T) {
        let [wear, _] = self.config.tuning().wear;
        if let Some(calibration) = self.calibration.as_mut().filter(|_| km > T::zero()) {
            let sd = T::lit(wear) * km;
            for seen in SEEN {
                for (i, row) in calibration.covariance_1e6.iter_mut().enumerate().take(seen.len()) {
                    for (j, entry) in row.iter_mut().enumerate().take(seen.len()) {
                        *entry += T::lit(seen[i] * seen[j]) * sd * sd;
                    }
                }
            }
        }
    }

    /// The last report.
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

    /// The wheels that have had no speed for a second while others had one: nothing is compared meanwhile.
    #[must_use]
    pub(crate) fn missing(&self) -> Wheels {
        self.sensors.missing()
    }

    /// The wheel whose speed is none of a tire that rolls beside the others, and how many times theirs it is.
    #[must_use]
    pub(crate) fn odd(&self) -> Option<(Corner, T)> {
        self.sensors.odd(self.config.tuning())
    }

    /// The malfunction of speeds that do not follow the car, and whose.
    #[must_use]
    pub(crate) fn does_not_follow(&self) -> Option<(Wheels, Malfunction<T>)> {
        self.astray().map(Astray::malfunction)
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
        // A gap, or another clock, is no time in which others moved.
        let follows_s = if step_s > 0.0 && step_s < PAUSE_S { T::lit(step_s) } else { T::zero() };
        self.sensors.note_missing(sample, follows_s);
        if sample.complete() {
            let moved = self.stuck().is_empty();
            let tuning = self.config.tuning();
            self.sensors.take(sample, follows_s, tuning);
            if self.stuck().is_empty() {
                self.sums.add(sample);
            } else if moved {
                // For a second or more it has been so.
                self.following = Following::BLANK;
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
        self.following.interrupt();
        self.sums.begin(f64::NEG_INFINITY);
    }

    /// No sample came for some time: the car may have stood.
    fn gap(&mut self, step_s: f64) {
        self.interrupt();
        if step_s > 0.0 {
            if self.phase != Phase::Uncalibrated {
                // Disturbances have gone their way, too; an hour later nothing is left of them.
                self.filter.predict(
                    T::lit(step_s.min(3600.0)),
                    &self.config,
                    matches!(self.phase, Phase::Learning(_)),
                );
            }
            self.stand(step_s);
        }
    }

    fn stand(&mut self, step_s: f64) {
        let before_s = self.stood_s;
        self.stood_s += step_s;
        if self.phase == Phase::Watching && before_s < LONG_STOP_S && !(self.stood_s < LONG_STOP_S) {
            (self.began_anew, self.loads_may_differ) = (true, true);
            self.filter.stood(&self.config);
        }
    }

    fn end_block(&mut self) {
        let tuning = self.config.tuning();
        let mut block = self.sums.conclude(&self.config, self.sensors.step_m_s());
        let slip_1e3 = self.filter.unequal_slip_1e3(block.force_m_s2, &self.config);
        if self.yaw.take(&block, &self.config, self.filter.yaw_bias_rad_s(tuning), slip_1e3) {
            let doubted = self.yaw.is_doubted();
            if let Some(calibration) = self.calibration.as_mut() {
                calibration.leaves_out_yaw_rate = doubted;
            }
            // A sensor that is right again is no reason to forget; one that was wrong is, and an axle that was taken to be free.
            if doubted || self.yaw.coupled() != [false; 2] {
                self.learn_again();
            }
        }
        self.follow(&mut block);
        if self.yaw.is_doubted() {
            block.yaw_rate_rad_s = None;
        }
        block.hide(self.coupled(), slip_1e3, tuning.sides);
        if block.good {
            self.sensors.take_block(&block, tuning);
        }
        if self.sums.stood() {
            self.stand(BLOCK_S);
        } else {
            if block.speed_m_s > T::zero() {
                self.stood_s = 0.0;
            }
            for unseen_s in &mut self.report.unseen_s {
                *unseen_s += T::lit(BLOCK_S);
            }
        }
        let learning = matches!(self.phase, Phase::Learning(_));
        if self.phase != Phase::Uncalibrated {
            self.filter.predict(T::lit(BLOCK_S), &self.config, learning);
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

    /// The axles whose wheels a differential keeps alike: those that were found to turn alike in wide bends, and the driven ones of a car with
    /// limited slip as long as they are not known to turn freely.
    fn coupled(&self) -> [bool; 2] {
        let (found, free, driven) = (self.yaw.coupled(), self.yaw.free(), self.config.driven.axles());
        core::array::from_fn(|i| found[i] || self.config.limited_slip && driven[i] && !free[i])
    }

    /// Whether the wheels follow the car; what was learned with one that does not is forgotten, and nothing is learned from it.
    fn follow(&mut self, block: &mut Block<T>) {
        let (bias_rad_s, believed) =
            (self.filter.yaw_bias_rad_s(self.config.tuning()).0, !self.yaw.is_doubted());
        self.following.take(block, &self.config, bias_rad_s, believed, self.coupled());
        let is_astray = self.astray().is_some();
        if is_astray != self.was_astray {
            self.was_astray = is_astray;
            self.learn_again();
        }
        block.good &= !is_astray;
    }

    /// The speeds that do not follow the car's bends and accelerations as a wheel's does.
    fn astray(&self) -> Option<Astray> {
        let per_m_s2 = T::lit(1.0 / SCALE) * self.last.speed_m_s;
        let slip_s = self.filter.slip_1e3(self.config.tuning()).map(|slip| per_m_s2 * slip);
        // What is known of the road is forgotten with what was learned: that makes no right speed of a wrong one.
        let slippery = self.filter.is_slippery()[1] && !self.was_astray;
        self.following.astray(&self.config, slippery, slip_s)
    }

    /// A block was taken in.
    fn used(&mut self, block: &Block<T>) {
        for (unseen_s, _) in self.report.unseen_s.iter_mut().zip(&block.used).filter(|(_, used)| **used) {
            *unseen_s = T::zero();
        }
        match self.phase {
            Phase::Uncalibrated => {}
            Phase::Learning(left_s) => {
                // A difference that a coupled axle hides can neither be learned nor compared.
                let seen = block
                    .used
                    .iter()
                    .zip(block.hidden.iter().chain(&[false]))
                    .all(|(used, hidden)| *used || *hidden);
                let seen_s = if seen { T::lit(BLOCK_S) } else { T::zero() };
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
        self.refused_snow = self.filter.is_on_snow(self.config.tuning());
        if self.refused_snow {
            self.phase = Phase::Uncalibrated;
            self.report.forget(RadiusState::Uncalibrated);
            return;
        }
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
        self.calibration.set(Some(calibration));
        self.load_days(&RadiusDays::since(self.clock_began_unix_s + self.report.time_s));
        self.filter.is_dry(self.config.tuning());
        self.phase = Phase::Watching;
        self.report.forget(RadiusState::Uninformed);
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
        match self.calibration.get() {
            Some(calibration) => self.watch_again(&calibration),
            None => self.filter.begin(&self.config, &self.radius_1e3),
        }
    }

    fn watch_again(&mut self, calibration: &RadiusCalibration<T>) {
        self.phase = Phase::Watching;
        self.began_anew = true;
        self.filter.resume(&self.config, calibration);
        self.interrupt();
        self.report.forget(RadiusState::Uninformed);
    }
}
