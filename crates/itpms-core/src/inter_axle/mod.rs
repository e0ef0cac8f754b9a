//! The second source of information: the rear wheel meets the road that the front wheel met a moment ago
//! (docs/math/shared-road.md).
//!
//! Both axles reconstruct the road velocity, each with the compliance of its tire; where they disagree, a compliance is
//! wrong. Because the axles carry different unsprung masses, the disagreement tells both pressures and not only their
//! difference. Used by the car's estimator; knows nothing of the road's spectrum but what it is told in words.
//!
//! | room | idea |
//! |---|---|
//! | `channel` | a corner's signals, thinned |
//! | `memory` | the front's last second, read where the rear is now |
//! | `acquire` | the delay, first and anew |
//! | `track` | one side: aligned, cut into frames |
//! | `constraint` | what the axles disagree on, and why |
//! | `imbalance` | what wheels that turn add to the road |
//! | `instrument`, `answer` | what a wheel would do on the road both agree on, and what it does |
//! | `coherence` | how far they share a road |
//! | `parameters` | what is unknown of the car |
//! | `scale` | the tires at their placard pressures, and what a spectrum should say of them |
//! | `modes`, `mode`, `mixture` | the belief, one Gaussian of it, and several added up to one |
//! | `belief` | what it says of the tires now |
//! | `word` | what a corner's road spectrum says of its tire |
//! | `alone` | what a corner finds by itself, where front and rear hardly share a road |
//! | `evidence` | what a frame says to one Gaussian of it |
//! | `reset` | tires that somebody has just set |
//! | `keepsake` | what was believed before a sensor lied |
//! | `lesson` | what that taught |
//! | `elsewhere`, `speed_latency` | a speed whose scale has changed, or that comes late: the axles meet elsewhere |

pub(crate) mod alignment;
pub(crate) mod residual;
#[cfg(test)]
mod tests;

use crate::belief::checkpoint::{Checkpoint, PreFaultEstimate};
use crate::belief::hypothesis_bank::HypothesisBank;
use crate::belief::single_wheel_estimate::SingleWheelEstimate;
use crate::belief::state::{DAMPING, SKEW, SKEW_UNIT_S, State, TIRE, WHEELBASE};
use crate::belief::stored_calibration::CalibrationResult;
use crate::belief::tire_scale::TireScale;
use crate::conditioning::GridSample;
use crate::inter_axle::alignment::axle_pair::{AxlePair, OppositeSide, PairingContext, SLOWEST_M_S};
use crate::inter_axle::alignment::channel::{Channel, Entry, RELATIVE};
use crate::inter_axle::alignment::realign::DelayDetection;
use crate::inter_axle::alignment::speed_latency::SpeedLatency;
use crate::inter_axle::residual::model::{AxleFrame, BOTH, Wheel};
use crate::inter_axle::residual::noise::within;
use crate::model::{CarConfig, CornerConfig, QuarterCar, VehicleCalibration};
use crate::real::Real;
use crate::spectrum::transfer::Body;

/// Spectral bins: 5, 10, ... 25 Hz.
pub(crate) const BINS: usize = 5;
/// Time between frames in s, and so the distance of the bins in Hz.
pub(crate) const HOP_S: f64 = 0.1;
pub(crate) const BIN_SPACING_HZ: f64 = 0.5 / HOP_S;
/// A frame of both axles' signals.
pub(crate) type Frame<T> = crate::spectrum::Frame<T, BINS, SIGNALS>;
/// Signals of both axles, and what they would be on the road both agree on.
pub(crate) const SIGNALS: usize = 2 * BOTH;
/// Middle of a bin in Hz.
pub(crate) fn bin_hz<T: Real>(bin: usize) -> T {
    T::lit((bin + 1) as f64 * BIN_SPACING_HZ)
}

/// Share of a frame's log-likelihood that counts: they overlap by half.
pub(crate) const OVERLAP: f64 = 0.5;
/// Delay in sampling periods of the sensors' anti-alias filter, a Butterworth of order four at 0.3 of the rate.
pub(crate) const SENSOR_LATE_PERIODS: f64 = 2.613 / (core::f64::consts::TAU * 0.3);
/// Incoherence near wheel hop at which movements of several wheels begin half as often.
pub(crate) const RESTLESS: f64 = 0.02;
/// Entries of two corners within so many periods are of the same time.
pub(crate) const NEAR_PERIODS: f64 = 0.6;
/// Seconds after which a corner that has told nothing counts as silent.
pub(crate) const SILENT_S: f64 = 1.0;
/// Longest time in s over which a movement is followed without a frame, and between words where there are no frames; pauses
/// count for so long at most, and from so long on a tire may have been filled.
pub(crate) const LONGEST_STEP_S: f64 = 1.0;
pub(crate) const LONGEST_SILENCE_S: f64 = 3.0;
pub(crate) const LONGEST_PAUSE_S: f64 = 600.0;
pub(crate) const FILLING_S: f64 = 20.0;
/// Sd of what a car that was parked for long has lost or won of all pressures alike, as a share of them, and the time in s in which tires
/// become as cold as the air: 20 K are 23 kPa.
pub(crate) const PARKED_SD: f64 = 0.06;
pub(crate) const PARKED_S: f64 = 1800.0;
/// Time in s over which the speed of late is averaged.
pub(crate) const SPEED_S: f64 = 1.5;
/// Seconds of shared road after which the belief counts.
pub(crate) const ENOUGH_S: f64 = 2.0;
/// Seconds of driving after which the shared road is given up if it was not found.
pub(crate) const PATIENCE_S: f64 = 6.0;
/// Sd in s of the first delay that was found.
pub(crate) const FOUND_SD_S: f64 = 1e-3;
/// Sd of a tire's compliance, over that at placard pressure, when nobody watched.
pub(crate) const UNWATCHED_SD: f64 = 0.05;

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(crate) struct SharedRoad<T: Real> {
    pub(crate) wheelbase_m: T,
    pub(crate) wheels: [Option<Wheel<T>>; 4],
    pub(crate) scale: TireScale<T>,
    pub(crate) channels: [Channel<T>; 4],
    pub(crate) pairs: [AxlePair<T>; 2],
    /// The newest two entries of the rear corners, newest first.
    pub(crate) rear: [[Option<Entry<T>>; 2]; 2],
    pub(crate) bank: HypothesisBank<T>,
    /// The tires' compliances at the start, and what an earlier reset had taught.
    pub(crate) start: [T; 4],
    pub(crate) loaded: Option<VehicleCalibration<T>>,
    /// Seconds from front to rear wheel, left and right.
    pub(crate) delay_s: [T; 2],
    /// Seconds by which filters make the signals late, and by which the speed was found to be.
    pub(crate) filter_delay_s: f64,
    pub(crate) speed_latency_s: f64,
    /// Time to which the belief was moved on.
    pub(crate) believed_s: f64,
    pub(crate) newest_s: f64,
    pub(crate) distance_m: f64,
    pub(crate) speed_m_s: T,
    /// The same, averaged over some time.
    pub(crate) mean_speed_m_s: T,
    /// Seconds of shared road learned from.
    pub(crate) learned_s: f64,
    /// Seconds driven since a shared road was last learned from; all of them while nobody knows the speed.
    pub(crate) unshared_s: f64,
    pub(crate) calibrating: bool,
    /// Whether somebody ever said, on this drive or before it, what the tires have.
    pub(crate) calibrated: bool,
    /// What each corner finds by itself, and when it last said a word.
    pub(crate) alone: [SingleWheelEstimate<T>; 4],
    pub(crate) word_s: [f64; 4],
    /// Seconds of shared road learned from when the reset began, and what it taught.
    pub(crate) calibrating_from_s: f64,
    pub(crate) calibration_result: Option<CalibrationResult<T>>,
    /// What was believed of late, the newest first; and what of tires whose sensors were then suspected.
    pub(crate) kept: [Option<Checkpoint<T>>; 2],
    pub(crate) pre_fault: [Option<PreFaultEstimate<T>>; 4],
    /// Where each side last found the other axle's road, when it looked for it anew.
    pub(crate) delay_detections: [Option<DelayDetection<T>>; 2],
    pub(crate) speed_latency: SpeedLatency<T>,
}

impl<T: Real> SharedRoad<T> {
    /// A shared road for the sides that have both corners; `None` if there is none, or no wheelbase.
    pub(crate) fn new(config: &CarConfig<T>, sample_rate_hz: f64, grid_period_s: f64) -> Option<Self> {
        let wheelbase_m = config.wheelbase_m?;
        let wheel = |corner: usize| {
            config.corners[corner].as_ref().map(|c| {
                let car = &c.quarter_car;
                let body = Body {
                    sprung_mass_kg: car.sprung_mass_kg(),
                    unsprung_mass_kg: car.unsprung_mass_kg(),
                    damping_n_s_per_m: car.damping_n_s_per_m(),
                    spring_n_per_m: car.spring_n_per_m(),
                };
                let theta = T::one() / c.tire.stiffness_n_per_m(c.placard_kpa);
                Wheel { body, theta, corner }
            })
        };
        let wheels = core::array::from_fn(wheel);
        if !(wheels[0].is_some() && wheels[2].is_some() || wheels[1].is_some() && wheels[3].is_some()) {
            return None;
        }
        let of = |value: &dyn Fn(&CornerConfig<T>) -> T| {
            core::array::from_fn(|i| config.corners[i].as_ref().map_or(T::one(), value))
        };
        let channels: [Channel<T>; 4] = core::array::from_fn(|_| Channel::new(grid_period_s));
        let period_s = channels[0].period_s();
        let noise = |i: usize| {
            let sd = config.corners[i].as_ref().map_or(T::zero(), |c| c.accel_noise_or_usual_m_s2());
            sd * sd * T::lit(2.0 / sample_rate_hz)
        };
        let pairs =
            core::array::from_fn(|side| AxlePair::new(side, period_s, [noise(side), noise(side + 2)]));
        let start = core::array::from_fn(|i| {
            let softer = |c: &CornerConfig<T>| {
                c.tire.stiffness_n_per_m(c.placard_kpa) / c.initial_stiffness_n_per_m() - T::one()
            };
            config.corners[i].as_ref().map_or(T::zero(), softer)
        });
        Some(Self {
            wheelbase_m,
            wheels,
            scale: TireScale {
                slope: of(&|c| c.tire.stiffness_per_kpa()),
                placard_n_per_m: of(&|c| c.tire.stiffness_n_per_m(c.placard_kpa)),
                placard_kpa: of(&|c| c.placard_kpa),
            },
            pairs,
            rear: [[None; 2]; 2],
            bank: HypothesisBank::new(&start),
            start,
            loaded: None,
            delay_s: [T::zero(); 2],
            filter_delay_s: channels[0].filter_delay_s() + SENSOR_LATE_PERIODS / sample_rate_hz,
            channels,
            speed_latency_s: 0.0,
            believed_s: f64::NAN,
            newest_s: f64::NAN,
            distance_m: 0.0,
            speed_m_s: T::lit(f64::NAN),
            mean_speed_m_s: T::zero(),
            learned_s: 0.0,
            unshared_s: 0.0,
            calibrating: false,
            calibrated: false,
            alone: [SingleWheelEstimate::silent(); 4],
            word_s: [f64::NEG_INFINITY; 4],
            calibrating_from_s: 0.0,
            calibration_result: None,
            kept: [None, None],
            pre_fault: [None; 4],
            delay_detections: [None; 2],
            speed_latency: SpeedLatency::new(),
        })
    }

    /// Says how fast the car is, before its corners' samples of that time.
    pub(crate) fn drive(&mut self, time_s: f64, speed_m_s: T) {
        let seconds = time_s - self.newest_s;
        let follows = seconds > 0.0 && seconds < 0.5;
        if follows && self.speed_m_s.is_finite() {
            let mean = if speed_m_s.is_finite() {
                T::lit(0.5) * (speed_m_s + self.speed_m_s)
            } else {
                self.speed_m_s
            };
            self.distance_m += mean.to_f64() * seconds;
            self.mean_speed_m_s += (mean - self.mean_speed_m_s) * T::lit((seconds / SPEED_S).min(1.0));
            if mean > T::lit(SLOWEST_M_S) {
                self.unshared_s += seconds;
            }
        } else if follows {
            self.unshared_s += seconds;
        }
        if time_s.is_finite() {
            self.newest_s = time_s;
        }
        self.speed_m_s = speed_m_s;
    }

    /// Takes a grid step of a corner.
    pub(crate) fn push(&mut self, corner: usize, sample: &GridSample<T>) {
        let distance_m = if self.speed_m_s.is_finite() {
            // The road that the signals tell lies as far back as filters delay them: at another speed, another way.
            let filter_delay_s = self.filter_delay_s - self.speed_latency_s;
            self.distance_m - self.speed_m_s.to_f64() * (self.newest_s - sample.time_s + filter_delay_s)
        } else {
            f64::NAN
        };
        let Some(entry) = self.channels[corner].push(sample, distance_m) else { return };
        let side = corner % 2;
        if corner < 2 {
            self.pairs[side].front(&entry);
            return;
        }
        // One entry late, so that the other side's of the same time is there, too.
        let [newest, _] = self.rear[side];
        self.rear[side] = [Some(entry), newest];
        if let Some(entry) = newest {
            self.roll(side, &entry);
        }
    }

    /// Takes an entry of a rear corner to the road that the front met.
    pub(crate) fn roll(&mut self, side: usize, entry: &Entry<T>) {
        let (Some(front), Some(rear)) = (self.wheels[side], self.wheels[side + 2]) else { return };
        let beside = self.beside(side, entry);
        let (wheelbase, skew) = (self.bank.quantity(WHEELBASE).0, self.bank.quantity(SKEW + side).0);
        let road = PairingContext {
            wheelbase_m: self.wheelbase_m,
            wheels: [front, rear],
            wheelbase,
            skew,
            state: &self.bank.bank[self.bank.most_likely()].mean,
        };
        if !self.pairs[side].is_aligned() {
            if let Some(found) = self.pairs[side].search(entry, &road) {
                let (unit, [wheelbase, skew]) = (T::lit(SKEW_UNIT_S), found.used);
                self.bank.update(T::lit(FOUND_SD_S * FOUND_SD_S), |state| {
                    let mut slope = State::zeros();
                    slope[WHEELBASE] = found.delay_s;
                    slope[SKEW + side] = unit;
                    let expected =
                        found.delay_s * (state[WHEELBASE] - wheelbase) + unit * (state[SKEW + side] - skew);
                    (slope, found.later_s - expected)
                });
            }
            return;
        }
        let [left, right] = &mut self.pairs;
        let (own, other) = if side == 0 { (left, right) } else { (right, left) };
        let taken = own.pair(entry, beside, other, &road);
        let found = own.search_again(entry, &road);
        if let Some(taken) = taken {
            self.learn(side, &[front, rear], &taken);
        }
        if let Some(found) = found {
            self.realign(side, found, entry.time_s);
        }
    }

    /// How the suspension of the other rear corner moves at the same time.
    pub(crate) fn beside(&self, side: usize, entry: &Entry<T>) -> OppositeSide<T> {
        let near_s = NEAR_PERIODS * self.channels[0].period_s();
        let apart_s = |other: &&Entry<T>| (other.time_s - entry.time_s).abs();
        let others = || self.rear[1 - side].iter().flatten();
        match others().find(|other| apart_s(other) < near_s && !other.invalid) {
            Some(other) => OppositeSide::Known(other.signals[RELATIVE]),
            None if others().all(|other| apart_s(&other) > SILENT_S) => OppositeSide::Silent,
            None => OppositeSide::Missed,
        }
    }

    pub(crate) fn learn(&mut self, side: usize, wheels: &[Wheel<T>; 2], taken: &AxleFrame<T>) {
        self.predict_to(taken.middle_s);
        self.keep();
        for corner in [side, side + 2] {
            self.pre_fault[corner].take_if(|tire| tire.is_settled(taken.middle_s));
        }
        self.delay_s[side] = taken.delay_s;
        let beside = self.pairs[1 - side].is_parting();
        let meanwhile = self.pairs[side].found_meanwhile(&self.pairs[1 - side], taken.middle_s);
        if self.pairs[side].update_residual(&mut self.bank, wheels, taken, self.calibrated, beside, meanwhile)
        {
            self.learned_s += 0.5 * HOP_S;
            self.unshared_s = 0.0;
        }
        let softest = self.scale.softest();
        self.bank.drop_impossible(&softest);
        if !self.bank.is_sound(&softest) {
            self.begin_again();
        }
    }

    /// The belief has become impossible, or rests on something that was wrong: begins again with what resets taught.
    pub(crate) fn begin_again(&mut self) {
        self.bank.begin_again(&self.start);
        self.learned_s = 0.0;
        self.kept = [None, None];
        if let Some(reference) = self.learned().or(self.loaded) {
            // It was learned for this car, or accepted before.
            let _ = self.load_calibration(&reference);
        }
        if self.calibrating {
            self.set_tires();
        }
    }

    pub(crate) fn predict_to(&mut self, time_s: f64) {
        if !self.believed_s.is_finite() {
            self.believed_s = time_s;
        }
        let seconds = time_s - self.believed_s;
        if !(seconds > 0.0) {
            return;
        }
        self.believed_s = time_s;
        if seconds > if self.spectral_only() { LONGEST_SILENCE_S } else { LONGEST_STEP_S } {
            // Nobody watched: what moved then is over, and a tire may have been filled.
            self.kept = [None, None];
            self.bank
                .predict_gap(T::lit(seconds.min(LONGEST_PAUSE_S)), seconds > FILLING_S && !self.calibrating);
            if seconds > LONGEST_PAUSE_S && !self.calibrating {
                let sd = T::lit(PARKED_SD) * (T::one() - T::lit(-seconds / PARKED_S).exp());
                self.bank.change_temperature(&core::array::from_fn(|corner| sd * self.scale.share(corner)));
            }
            return;
        }
        let known = self.is_learned();
        let onset_scale = if known { [T::one(), self.several_onset_scale()] } else { [T::zero(); 2] };
        let onset_rate = |i: usize| self.alone[i].onset_rate(self.pairs[i % 2].lasting_incoherence());
        let onset_rates = core::array::from_fn(|i| if known { onset_rate(i) } else { T::zero() });
        self.bank.predict(T::lit(seconds), onset_scale, &onset_rates);
    }

    /// Takes over the quarter car that a corner seems to be.
    pub(crate) fn look_at(&mut self, corner: usize, car: &QuarterCar<T>) {
        let state = &self.bank.bank[self.bank.most_likely()].mean;
        let Some(wheel) = &mut self.wheels[corner] else { return };
        // How the body answers its wheel depends on damping over mass.
        let damping = wheel.body.damping_n_s_per_m * (T::one() + state[DAMPING + corner]);
        wheel.body.sprung_mass_kg = car.sprung_mass_kg() * damping / car.damping_n_s_per_m();
    }

    /// Takes over what a corner's own spectrum tells it now.
    pub(crate) fn watch(&mut self, corner: usize, alone: SingleWheelEstimate<T>) {
        self.alone[corner] = alone;
    }

    /// How far a surprise may be taken for a movement of several wheels: hardly, where front and rear meet different roads.
    pub(crate) fn several_onset_scale(&self) -> T {
        within(self.pairs[0].incoherence().max(self.pairs[1].incoherence()), RESTLESS)
    }

    /// A corner's sensors were out of order: its tire may have changed meanwhile, and before it was noticed only seemed to.
    /// During a reset it is what somebody has set.
    pub(crate) fn restart(&mut self, corner: usize) {
        self.kept = [None, None];
        let pre_fault = self.pre_fault[corner].take();
        if self.calibrating {
            self.set_tire(corner);
            return;
        }
        if let Some(tire) = pre_fault {
            self.bank.begin_with(TIRE + corner, &tire.before, T::zero(), T::one());
        }
        self.bank.forget_tire(corner, T::lit(UNWATCHED_SD));
    }

    /// Whether a corner has a partner on its side.
    pub(crate) fn has_partner(&self, corner: usize) -> bool {
        self.wheels[corner % 2].is_some() && self.wheels[corner % 2 + 2].is_some()
    }

    /// Whether no side gives frames and words are all there is.
    pub(crate) fn spectral_only(&self) -> bool {
        (0..2).all(|side| !self.has_partner(side) || self.pairs[side].spectral_only())
    }

    /// Whether its belief is the better one: while the shared road may still be found, and from then on.
    pub(crate) fn is_trusted(&self) -> bool {
        self.seconds_learned() >= ENOUGH_S || self.unshared_s < PATIENCE_S
    }

    /// Seconds of shared road that the belief rests on; half a frame more, so that rounding does not decide when it is enough.
    pub(crate) fn seconds_learned(&self) -> f64 {
        self.learned_s + 0.25 * HOP_S
    }

    /// Whether a side's road is being learned from, and its incoherence.
    pub(crate) fn side(&self, side: usize) -> (bool, T) {
        self.pairs[side].state(self.newest_s)
    }
}
