//! Puts the sources of information in order: front and rear over the same road, and each corner's road spectrum, fused into one
//! belief about the car (docs/math/shared-road.md). Data goes one way: entry, alignment, residual, belief, fused estimate.
//!
//! | module | idea |
//! |---|---|
//! | `frame_units` | in which order a frame of both axles is learned from, unit by unit |
//! | `pseudo_measurement` | the tire's stiffness by a corner's road spectrum, as a measurement of the belief |
//! | `realign` | a speed whose scale changes, or that is late: the axles meet at another delay than believed |
//! | `single_wheel_estimate` | what a corner finds by itself, where front and rear hardly share a road |
//! | `calibration_reading` | what the spectra read while a calibration says what is true |
//! | `output` | stiffnesses and their covariance, as they are now |

mod calibration_reading;
mod frame_units;
mod output;
mod pseudo_measurement;
mod realign;
mod single_wheel_estimate;

use self::calibration_reading::CalibrationReading;
use self::frame_units::FrameQueue;
pub(super) use self::output::{FusedEstimate, FusedLosses};
use self::realign::DelayDetection;
pub(super) use self::single_wheel_estimate::SingleWheelEstimate;
use crate::belief::state::{SKEW, SKEW_UNIT_S, State, WHEELBASE};
use crate::belief::{Belief, FrictionError, LONGEST_SILENCE_S, Onset, Tires};
use crate::conditioning::GridSample;
use crate::conditioning::pauses::{ENOUGH_S, PAUSE_S};
use crate::inter_axle::alignment::axle_pair::AxlePair;
use crate::inter_axle::alignment::delay_search::{Found, GIVE_UP_S};
use crate::inter_axle::alignment::speed_latency::SpeedLatency;
use crate::inter_axle::{Aligned, HOP_S, InterAxle};
use crate::memory::Blank;
use crate::model::{
    AxleFit, CalibrationError, CarConfig, Corner, Inflation, Level, QuarterCar, Side, TrackState,
    VehicleCalibration,
};
use crate::real::Real;
use crate::spectrum::SIGNALS;
use crate::suspension::BodyEquation;

/// Seconds of driving after which front and rear do not meet the same road.
const APART_S: f64 = 20.0;
/// Sd in s of the first delay that was found.
const FOUND_SD_S: f64 = 1e-3;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Fusion<T: Real> {
    inter_axle: InterAxle<T>,
    belief: Belief<T>,
    /// Each corner's own estimate, and when its spectrum last gave a pseudo-measurement.
    single_wheel: [SingleWheelEstimate<T>; 4],
    pseudo_measured_s: [f64; 4],
    /// Where each side last found the other axle's road, when it looked for it anew.
    detections: [Option<DelayDetection<T>>; 2],
    speed_latency: SpeedLatency<T>,
    calibration_reading: CalibrationReading<T>,
    /// Variance in (N/m)² of each corner's stiffness at wheel hop by unknown friction.
    friction_variance: [T; 4],
    queue: FrameQueue<T>,
    /// Belief about the tires as of the last frame that was learned from.
    tires: Tires<T>,
}

impl<T: Real> Fusion<T> {
    /// The wheelbase in m of a car with both corners of a side; `None`: there is nothing to fuse.
    pub(super) fn wheelbase_m(config: &CarConfig<T>) -> Option<T> {
        InterAxle::wheelbase_m(config)
    }

    pub(super) fn configure(
        &mut self,
        config: &CarConfig<T>,
        wheelbase_m: T,
        sample_rate_hz: f64,
        grid_period_s: f64,
    ) {
        self.inter_axle.configure(config, wheelbase_m, sample_rate_hz, grid_period_s);
        self.belief.configure(config);
        self.single_wheel = [SingleWheelEstimate::BLANK; 4];
        self.pseudo_measured_s = [f64::NEG_INFINITY; 4];
        self.detections = [None; 2];
        self.speed_latency = SpeedLatency::BLANK;
        self.calibration_reading = CalibrationReading::BLANK;
        self.friction_variance = [T::zero(); 4];
        self.queue.configure(sample_rate_hz);
        self.belief.refresh(&mut self.tires);
    }

    /// Takes the time and the speed of the samples that follow.
    pub(super) fn drive(&mut self, time_s: f64, speed_m_s: T) {
        self.inter_axle.drive(time_s, speed_m_s);
    }

    /// Takes a grid step of a corner and its signals. Apart, as the pairs' and the corners' parts are: where all of it is one, the addresses of hundreds of
    /// fields are computed with every sample, whether they are needed or not.
    #[inline(never)]
    pub(super) fn push(&mut self, corner: Corner, sample: &GridSample<T>, signals: &[T; SIGNALS]) {
        let Some(entry) = self.inter_axle.take(corner, sample, signals) else { return };
        let side = corner.side();
        let (queue, now_s) = (&mut self.queue, self.inter_axle.travel().time_s());
        match self.inter_axle.align(side, &entry, &self.belief, |frame| queue.enqueue(side, frame, now_s)) {
            None => {}
            Some(Aligned::FirstDelay(found)) => self.update_delay(side, &found),
            Some(Aligned::OtherDelay(found)) => self.realign(side, found, entry.time_s),
        }
    }

    /// Updates wheelbase and skew with the delay that was found first.
    #[inline(never)]
    fn update_delay(&mut self, side: Side, found: &Found<T>) {
        let at = SKEW + side.index();
        let (unit, [wheelbase, skew]) = (T::lit(SKEW_UNIT_S), found.used);
        self.belief.update_scalar(T::lit(FOUND_SD_S * FOUND_SD_S), |state| {
            let mut slope = State::zeros();
            slope[WHEELBASE] = found.delay_s;
            slope[at] = unit;
            let expected = found.delay_s * (state[WHEELBASE] - wheelbase) + unit * (state[at] - skew);
            (slope, found.later_s - expected)
        });
    }

    fn onset(&self) -> Onset<T> {
        let lasting = self.inter_axle.pairs.each_ref().map(AxlePair::lasting_incoherence);
        Onset {
            rates: Corner::ALL.map(|corner| self.single_wheel[corner].onset_rate(lasting[corner.side()])),
            longest_step_s: if self.inter_axle.spectral_only() { LONGEST_SILENCE_S } else { PAUSE_S },
        }
    }

    /// Drops the checkpoints and saves what is believed now.
    fn checkpoint_anew(&mut self) {
        if let Some(time_s) = self.belief.checkpoint_anew() {
            self.inter_axle.pairs.iter_mut().for_each(|pair| pair.checkpoint(time_s));
        }
    }

    fn restore(&mut self) {
        if let Some(time_s) = self.belief.restore() {
            self.inter_axle.pairs.iter_mut().for_each(|pair| pair.restore(time_s));
        }
    }

    /// For some seconds sensors of the `suspected` corners may have been wrong: what was learned meanwhile is taken back, if it
    /// contradicts what was known before.
    pub(super) fn rollback(&mut self, suspected: [bool; 4]) {
        self.drop_frames();
        if let Some(time_s) = self.belief.rollback(suspected) {
            self.inter_axle.pairs.iter_mut().for_each(|pair| pair.restore(time_s));
            self.checkpoint_anew();
        }
    }

    /// A corner's sensors were out of order.
    pub(super) fn restart(&mut self, corner: Corner) {
        self.drop_frames();
        self.belief.restart_tire(corner);
    }

    /// Takes over whether the road under a corner is one line.
    pub(super) fn set_on_line(&mut self, corner: Corner, on_line: bool) {
        self.inter_axle.set_on_line(corner, on_line);
    }

    /// Takes over the quarter car that a corner seems to be, what its friction is, and how well it is known.
    pub(super) fn set_strut(&mut self, corner: Corner, car: &QuarterCar<T>, equation: &BodyEquation<T>) {
        let damped_n_s_per_m = equation.friction_damping(corner);
        self.inter_axle.set_strut(corner, car, damped_n_s_per_m, &self.belief);
        self.friction_variance[corner] = equation.stiffness_variance(corner);
        let [damping, spring] = equation.strut_variance(corner);
        let damped = damped_n_s_per_m / equation.damper_n_s_per_m(corner);
        self.belief.set_friction_error(corner, FrictionError { damping, spring, damped });
    }

    pub(super) fn set_single_wheel(&mut self, corner: Corner, estimate: SingleWheelEstimate<T>) {
        self.single_wheel[corner] = estimate;
    }

    pub(super) fn set_inflation(&mut self, inflation: Inflation) {
        self.belief.set_inflation(inflation);
    }

    /// What frames are being learned from does not count any more.
    pub(super) fn drop_frames(&mut self) {
        self.queue.clear();
    }

    pub(super) fn begin_calibration(&mut self) {
        self.belief.begin_calibration();
        self.calibration_reading = CalibrationReading::BLANK;
    }

    /// By how much the spectra read more than the placard's pressures in the last calibration, the mean over the corners, and its sd as
    /// far as they tell, in kPa.
    pub(super) fn calibration_excess_kpa(&self) -> Option<(T, T)> {
        self.calibration_reading.mean_kpa()
    }

    /// Says that a calibration goes on, or that it is over or there was none.
    pub(super) fn set_calibrating(&mut self, active: bool) {
        self.belief.set_calibrating(active);
    }

    pub(super) fn calibration(&self) -> Option<VehicleCalibration<T>> {
        self.belief.calibration().copied()
    }

    /// Begins with what an earlier calibration taught.
    /// Errors: a calibration of other corners or other placard pressures.
    pub(super) fn load_calibration(
        &mut self,
        calibration: &VehicleCalibration<T>,
    ) -> Result<(), CalibrationError> {
        self.belief.load_calibration(calibration)
    }

    /// Reference of the tires' level.
    pub(super) fn level(&self) -> Level {
        self.belief.level()
    }

    /// How well front and rear of a side go together on their road.
    pub(super) fn axle_fit(&self, side: Side) -> AxleFit<T> {
        let pair = &self.inter_axle.pairs[side];
        AxleFit {
            hop_excess: pair.hop_excess(),
            response_error: pair.response_error(),
            is_apart: self.is_apart(),
        }
    }

    /// Whether front and rear have never met the same road, though the car drove at a known speed.
    fn is_apart(&self) -> bool {
        let (aligned, travel) = (AxlePair::is_aligned, self.inter_axle.travel());
        let known = travel.speed_m_s().is_finite() && travel.unshared_s() > T::lit(APART_S);
        known && !self.inter_axle.pairs.iter().any(aligned)
    }

    pub(super) fn has_partner(&self, corner: Corner) -> bool {
        self.inter_axle.has_partner(corner)
    }

    /// Whether the belief is better than what the corners find by themselves: while the shared road may still be found, and from then on.
    pub(super) fn is_trusted(&self) -> bool {
        self.learned_s() >= ENOUGH_S || self.inter_axle.travel().unshared_s() < T::lit(GIVE_UP_S)
    }

    /// Seconds of shared road that the belief rests on; half a frame more, so that rounding does not decide when it is enough.
    fn learned_s(&self) -> f64 {
        self.belief.learned_s() + 0.25 * HOP_S
    }

    /// Whether a side's road is being learned from, and its incoherence.
    pub(super) fn track(&self, side: Side) -> TrackState<T> {
        self.inter_axle.pairs[side].track(self.inter_axle.travel().time_s())
    }

    pub(super) fn speed_latency_s(&self) -> f64 {
        self.inter_axle.speed_latency_s()
    }
}
