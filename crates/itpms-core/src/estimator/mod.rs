//! The estimator of one corner, as a user holds it: samples in, [`CornerEstimate`]s out.

mod concluded;
mod corner;
mod fused_stiffness;
mod pulses;
mod reading;

pub(crate) use self::concluded::CornerConclusion;
pub(crate) use self::corner::CornerEstimator;
pub(crate) use self::fused_stiffness::FusedStiffness;
use self::pulses::PulseLevel;
use crate::conditioning::{SampleClock, SampleCounts, estimators_rate};
use crate::memory::Blank;
use crate::model::{AxleFit, Corner, CornerConfig, CornerEstimate, CornerSample, ParameterError, QuarterCar};
use crate::real::Real;
pub(crate) use crate::single_wheel::Pace;
pub use crate::single_wheel::{CALIBRATION_SD, OutsideStiffness, StiffnessPseudoMeasurement};
use crate::suspension::{BodyEquation, Learning};
use crate::torsion::TorsionPiece;

/// A running estimator of one corner. A value: clone it, save it, go on.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimator<T: Real> {
    clock: SampleClock<T>,
    corner: CornerEstimator<T>,
    body_equation: BodyEquation<T>,
    /// Information about the level from its wheel's pulses.
    pulses: PulseLevel<T>,
}

impl<T: Real> Estimator<T> {
    /// An estimator for a corner whose samples come at about `sample_rate_hz`, by value: some 19 KB in `f32`. A
    /// controller [configures](Self::configure) it in a `static`.
    ///
    /// # Errors
    /// The rate must be 100 to 2000 Hz; parameters of the corner that the filters refuse are named.
    pub fn new(config: &CornerConfig<T>, sample_rate_hz: f64) -> Result<Self, ParameterError> {
        let mut estimator = Self::unconfigured();
        estimator.configure(config, sample_rate_hz)?;
        Ok(estimator)
    }

    /// Memory for an estimator, as a constant: for a `static`, to be [configured](Self::configure) where it lies. Until then every
    /// sample is refused.
    #[must_use]
    pub const fn unconfigured() -> Self {
        Self::BLANK
    }

    /// What [`new`](Self::new) does, where the estimator lies: it takes little stack. Whatever was there is forgotten.
    ///
    /// # Errors
    /// As for [`new`](Self::new); the estimator is unconfigured then.
    pub fn configure(&mut self, config: &CornerConfig<T>, sample_rate_hz: f64) -> Result<(), ParameterError> {
        (self.clock, self.pulses) = (SampleClock::BLANK, PulseLevel::BLANK);
        let clock = SampleClock::new(estimators_rate(sample_rate_hz)?)?;
        self.corner.configure(config, sample_rate_hz)?;
        self.body_equation.configure(&[Some(*config), None, None, None], sample_rate_hz);
        self.clock = clock;
        Ok(())
    }

    /// Says that the tire has its placard pressure from the next sample on, for `seconds`: a calibration.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.corner.begin_calibration(seconds)
    }

    /// Takes the stiffness that another source follows from the next sample on, in place of the corner's own frames,
    /// until `None` is given.
    pub fn follow(&mut self, stiffness: Option<OutsideStiffness<T>>) {
        self.corner.follow(stiffness);
    }

    /// Takes one sample: time in s, speed in m/s, body and wheel acceleration in m/s²; NaN is a missing value. Gives
    /// the estimate after it. A missing speed is the last one, for half a second ([`SpeedHold`](crate::conditioning::SpeedHold)). A sample that cannot be
    /// used is counted, and the estimate says so when it matters. It warns of nothing: that is a [monitor](crate::monitor)'s.
    pub fn update(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        body_accel_m_s2: T,
        wheel_accel_m_s2: T,
    ) -> CornerEstimate<T> {
        let corner = CornerSample { body_accel_m_s2, wheel_accel_m_s2 };
        let at = self.clock.take(time_s, speed_m_s);
        match at.time_s {
            Some(steady_s) => self.corner.take(steady_s, at.speed_m_s, &corner, Pace::Works, |_, _| {}),
            None => self.corner.refuse(),
        }
        if self.body_equation.learn([self.corner.strut_frame(), None, None, None]) == Learning::Complete {
            self.corner.set_strut(&self.body_equation, Corner::FrontLeft);
        }
        let with_pulses = self.corner.with_pulses(&mut self.pulses, at.now_s);
        self.corner.conclude(at.now_s, with_pulses.as_ref(), &AxleFit::BLANK).at(time_s)
    }

    /// Takes a piece of its wheel's torsional analysis, calibrated at the placard pressure
    /// ([`TorsionWheel::push`](crate::torsion::TorsionWheel::push) gives it, of pulses up to the last sample's time). Pieces tell by how much the
    /// accelerations read too much, as far as the vehicle file leaves that open; what moves fast is left to the accelerations.
    ///
    /// ```
    /// use itpms_core::torsion::{TorsionConfig, TorsionWheel};
    /// use itpms_core::{CornerConfig, Estimator};
    ///
    /// # fn main() -> Result<(), itpms_core::ParameterError> {
    /// let mut estimator = Estimator::<f32>::new(&CornerConfig::paper(), 500.0)?;
    /// let mut wheel = TorsionWheel::new(&TorsionConfig::new())?;
    /// for k in 0..1000 {
    ///     let time_s = f64::from(k) / 500.0;
    ///     estimator.update(time_s, 20.0, 0.01, -0.02);
    ///     // When a tooth passed.
    ///     if let Some(piece) = wheel.push(time_s) {
    ///         estimator.take_piece(&piece);
    ///     }
    /// }
    /// # Ok(())
    /// # }
    /// ```
    pub fn take_piece(&mut self, piece: &TorsionPiece<T>) {
        if let Some(change) = &piece.change {
            self.corner.take_piece(change, &mut self.pulses);
        }
    }

    /// Starts again from the corner's initial pressure, as after a tire change. Counted.
    pub fn restart(&mut self) {
        self.body_equation.restart();
        self.corner.restart();
        self.pulses = PulseLevel::BLANK;
    }

    /// What the frames since the last call tell of the stiffness by themselves, whatever was believed before: a measurement for a filter
    /// outside. `None` until there are enough of them. These measurements are independent of each other, but not of the estimates.
    pub fn take_pseudo_measurement(&mut self) -> Option<StiffnessPseudoMeasurement<T>> {
        self.corner.take_pseudo_measurement()
    }

    /// The car as it seems to be now: sprung mass, damping and spring as identified on the way.
    pub fn quarter_car(&self) -> QuarterCar<T> {
        self.corner.quarter_car()
    }

    /// Counts of the samples so far.
    pub fn counts(&self) -> SampleCounts {
        self.corner.counts()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditioning::pauses::ENOUGH_S;

    const RATE_HZ: f64 = 200.0;

    /// Drives on for some seconds, the wheel's sensor reading `gain` of a random acceleration; the largest probability of a change.
    fn drive(estimator: &mut Estimator<f64>, random: &mut u64, from_s: f64, to_s: f64, gain: f64) -> f64 {
        let mut noise = || {
            *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*random >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut largest = 0.0_f64;
        for i in (from_s * RATE_HZ) as usize..(to_s * RATE_HZ) as usize {
            estimator.update(i as f64 / RATE_HZ, 20.0, noise(), 10.0 * gain * noise());
            largest = largest.max(estimator.corner.change_probability());
        }
        largest
    }

    /// A calibration that is ended is over for the corner, too: its pressure is not vouched for any more.
    #[test]
    fn a_calibration_that_is_ended_holds_nothing() {
        let sd_n_per_m = |ends: bool| {
            let mut estimator = Estimator::new(&CornerConfig::paper(), RATE_HZ).unwrap();
            let mut random = 1;
            estimator.corner.begin_calibration(100.0).unwrap();
            drive(&mut estimator, &mut random, 0.0, 10.0, 1.0);
            if ends {
                estimator.corner.end_calibration();
            }
            drive(&mut estimator, &mut random, 10.0, 20.0, 1.0);
            estimator.corner.own_stiffness().1
        };
        let (held, free) = (sd_n_per_m(false), sd_n_per_m(true));
        assert!(free > 1.5 * held, "{free} and {held} N/m");
    }

    /// What a corner saw of a leak before its sensor fell silent is not kept for true as long as nothing can tell otherwise: it has no say
    /// meanwhile, and none until it has seen anew for as long as an estimate takes.
    #[test]
    fn what_was_seen_before_a_silence_does_not_count() {
        let mut estimator = Estimator::new(&CornerConfig::paper(), RATE_HZ).unwrap();
        let mut random = 1;
        let mut drive = |from_s, to_s, gain| drive(&mut estimator, &mut random, from_s, to_s, gain);
        assert!(drive(0.0, 10.0, 1.0) > 0.01);
        // Half a second until it is known that nothing comes.
        assert!(drive(10.0, 11.0, f64::NAN) > 0.01);
        assert_eq!(drive(11.0, 30.0, f64::NAN), 0.0);
        assert_eq!(drive(30.0, 30.0 + ENOUGH_S, 1.0), 0.0);
        assert!(drive(30.0 + ENOUGH_S, 36.0, 1.0) > 0.01);
    }
}
