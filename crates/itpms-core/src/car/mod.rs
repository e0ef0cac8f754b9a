//! The estimator of a whole car: up to four corners at once, each on its own road spectrum, and front and rear
//! together on the road they share.
//!
//! Called by the binary, the studies, the monitor and controllers. A corner without a partner on its side is estimated
//! as by [`Estimator`](crate::estimator::Estimator); nothing else here knows how many wheels a car has.

mod conclusion;
mod considered;
mod fusion;
mod loss;
mod radii;

use self::conclusion::Concluded;
use self::considered::Considered;
use self::fusion::Fusion;
use crate::conditioning::{Moment, SampleClock, estimators_rate};
use crate::estimator::{CornerEstimator, OutsideStiffness, Pace};
use crate::memory::{Blank, Placed};
use crate::model::{
    BodyFit, CalibrationError, CarConfig, CarEstimate, CarSample, Corner, Inflation, Misfit, ParameterError,
    QuarterCar, RadiusDifferences, Side, StrutReading, VehicleCalibration, positive,
};
use crate::real::Real;
use crate::suspension::{BodyEquation, Learning};

/// Error of the road's spectra on one road, as a share of the placard pressure.
const SPECTRUM_BIAS: f64 = 0.04;

/// Time in s between two conclusions, which may be twice as long while frames are worked on.
const CONCLUDE_S: f64 = 0.01;

/// From where the pressure may be learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Sources {
    /// From the road's spectrum, corner by corner, and from front and rear meeting the same road.
    #[default]
    #[blank]
    SpectrumAndSharedRoad,
    /// From each corner's road spectrum alone.
    Spectrum,
    /// From the shared road alone.
    SharedRoad,
}

/// How a car's estimator is used.
#[derive(Debug, Clone, Copy, PartialEq, Default, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EstimatorOptions {
    /// From where the pressure may be learned.
    pub sources: Sources,
    /// When tires may gain air.
    pub inflation: Inflation,
}

/// A running estimator of a car. A value: clone it, save it, go on.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CarEstimator<T: Real> {
    sources: Sources,
    clock: SampleClock<T>,
    corners: [Placed<CornerEstimator<T>>; 4],
    fusion: Placed<Fusion<T>>,
    considered: Considered<T>,
    /// Differences of the tires' radii by wheel speeds, if they are compared.
    radii: Placed<RadiusDifferences<T>>,
    body_equation: BodyEquation<T>,
    /// When the calibration that is under way ends, and how long it lasts if it has not begun.
    calibration_s: Option<f64>,
    calibration_ends_s: f64,
    concluded: Concluded<T>,
    /// Samples from one conclusion to the next, and how many are left until one that cannot wait.
    conclude_every: u32,
    conclude_in: u32,
    /// The side whose corners may work on their frames in this sample, where samples come fast.
    turn: Side,
}

impl<T: Real> CarEstimator<T> {
    /// An estimator for samples that come at about `sample_rate_hz`. A large value: a controller
    /// [configures](Self::configure) it in a `static`.
    ///
    /// # Errors
    /// The rate must be 100 to 2000 Hz, a wheelbase positive; parameters of a corner that the filters refuse are named.
    pub fn new(config: &CarConfig<T>, sample_rate_hz: f64) -> Result<Self, ParameterError> {
        let mut estimator = Self::unconfigured();
        estimator.configure(config, sample_rate_hz)?;
        Ok(estimator)
    }

    /// Memory for a car's estimator, as a constant: for a `static`, to be [configured](Self::configure) where it lies. Until then
    /// it is one of a car without corners.
    #[must_use]
    pub const fn unconfigured() -> Self {
        Self::BLANK
    }

    /// What [`new`](Self::new) does, where the estimator lies: it takes little stack. Whatever was there is forgotten.
    ///
    /// # Errors
    /// As for [`new`](Self::new); the estimator is unconfigured then.
    pub fn configure(&mut self, config: &CarConfig<T>, sample_rate_hz: f64) -> Result<(), ParameterError> {
        let configured = self.configure_corners(config, sample_rate_hz);
        if configured.is_err() {
            self.clear();
            return configured;
        }
        let grid_period_s =
            self.corners.iter().flatten().next().map_or(f64::NAN, CornerEstimator::grid_period_s);
        self.fusion.clear();
        if let Some(wheelbase_m) = Fusion::wheelbase_m(config) {
            self.fusion.place(|fusion| fusion.configure(config, wheelbase_m, sample_rate_hz, grid_period_s));
            // No sample is to work on all corners' frames, besides those of the axles.
            for corner in Corner::ALL {
                self.corners[corner].as_mut().into_iter().for_each(|estimator| estimator.stagger(corner));
            }
        }
        self.considered.configure(config);
        self.radii.clear();
        self.body_equation.configure(&config.corners, sample_rate_hz);
        self.sources = Sources::default();
        (self.calibration_s, self.calibration_ends_s) = (None, f64::NEG_INFINITY);
        self.concluded = Concluded::BLANK;
        (self.conclude_every, self.conclude_in) = ((sample_rate_hz * CONCLUDE_S).to_whole().max(1) as u32, 0);
        self.turn = Side::Left;
        Ok(())
    }

    fn configure_corners(
        &mut self,
        config: &CarConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<(), ParameterError> {
        self.clock = SampleClock::new(estimators_rate(sample_rate_hz)?)?;
        config.wheelbase_m.map(|wheelbase_m| positive("wheelbase_m", wheelbase_m)).transpose()?;
        for (place, corner) in self.corners.iter_mut().zip(Corner::ALL) {
            place.clear();
            if let Some(config) = &config.corners[corner] {
                place.try_place(|corner| corner.configure(config, sample_rate_hz))?;
            }
        }
        Ok(())
    }

    /// A car without corners, as before it was configured.
    pub(crate) fn clear(&mut self) {
        self.clock = SampleClock::BLANK;
        self.corners.iter_mut().for_each(Placed::clear);
        self.fusion.clear();
        self.radii.clear();
    }

    pub(crate) fn has_corners(&self) -> bool {
        self.corners.iter().any(|corner| corner.as_ref().is_some())
    }

    /// Uses the estimator otherwise; before the first sample. In place: a car by value on the stack is as large as a car.
    pub fn set_options(&mut self, options: &EstimatorOptions) {
        self.sources = options.sources;
        if let Some(fusion) = self.fusion.as_mut() {
            fusion.set_inflation(options.inflation);
        }
    }

    /// Takes the stiffness of a corner's tire that another source follows from the next sample on, in the place of what the corner's
    /// own frames show, until `None` is given.
    pub(crate) fn follow(&mut self, corner: Corner, stiffness: Option<OutsideStiffness<T>>) {
        if let Some(estimator) = self.corners[corner].as_mut() {
            estimator.follow(stiffness);
        }
    }

    /// Takes how the tires' radii differ from the next sample on, as [`MonitoredWheels`](crate::monitor::MonitoredWheels) finds it in wheel
    /// speeds, until `None` is given. A car without four corners whose axles share the road learns nothing from it.
    pub(crate) fn follow_radii(&mut self, radii: Option<RadiusDifferences<T>>) {
        self.radii.set(radii);
    }

    /// Says that all tires have their placard pressures from the next sample on, for `seconds`, in which the car should be
    /// driven: the driver's calibration. Whatever an earlier one had set is set anew, also while that lasts.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        // Where the belief knows the tires, a corner's own reading goes on: held at the placard's pressure it would learn the road as that
        // stiffness makes it, and what its spectrum reads too much would hardly show.
        let fusion = self.fusion.as_ref();
        for corner in Corner::ALL {
            let Some(estimator) = self.corners[corner].as_mut() else { continue };
            if !fusion.is_some_and(|fusion| fusion.has_partner(corner)) {
                estimator.begin_calibration(seconds)?;
            }
        }
        (self.calibration_s, self.conclude_in) = (Some(seconds), 0);
        if let Some(fusion) = self.fusion.as_mut() {
            fusion.drop_frames();
        }
        Ok(())
    }

    /// Seconds by which the speed was found to be late against the accelerations, allowed for since then; below zero where it is
    /// early, zero as long as nothing was found.
    pub fn speed_latency_s(&self) -> f64 {
        self.fusion.as_ref().map_or(0.0, Fusion::speed_latency_s)
    }

    /// Ends the calibration that is to begin or under way, as where a log ends with it; what it taught is there then.
    pub(crate) fn end_calibration(&mut self) {
        (self.calibration_s, self.calibration_ends_s) = (None, f64::NEG_INFINITY);
        self.conclude_in = 0;
        self.corners.iter_mut().flatten().for_each(CornerEstimator::end_calibration);
        if let Some(fusion) = self.fusion.as_mut() {
            fusion.set_calibrating(false);
        }
    }

    /// By how much the road's spectra alone read more than the placard's pressures in the last calibration on this drive, the mean over the
    /// wheels, and its standard deviation with what the vehicle file leaves open, in kPa. Far from zero, the tires were not set.
    pub fn calibration_excess_kpa(&self) -> Option<[T; 2]> {
        let (excess, sd) = self.fusion.as_ref()?.calibration_excess_kpa()?;
        let considered = self.considered.mean_sd_kpa();
        let bias = T::lit(SPECTRUM_BIAS) * self.considered.mean_placard_kpa();
        Some([excess, (sd * sd + considered * considered + bias * bias).sqrt()])
    }

    /// Result of the last calibration; `None` before it is over, or when it saw too little shared road.
    pub fn calibration(&self) -> Option<VehicleCalibration<T>> {
        self.fusion.as_ref().filter(|_| self.calibration_s.is_none())?.calibration()
    }

    /// Begins with what a calibration on an earlier drive taught; before the first sample.
    ///
    /// # Errors
    /// An implausible calibration, or one of other corners or other placard pressures.
    pub fn load_calibration(&mut self, calibration: &VehicleCalibration<T>) -> Result<(), CalibrationError> {
        calibration.check()?;
        self.fusion.as_mut().map_or(Ok(()), |fusion| fusion.load_calibration(calibration))
    }

    /// Starts one corner again, as after its sensors were out of order; the others go on.
    #[inline(never)]
    pub fn restart_corner(&mut self, corner: Corner) {
        if let Some(estimator) = self.corners[corner].as_mut() {
            estimator.restart();
        }
        self.concluded.corners[corner].clear();
        self.body_equation.restart();
        self.conclude_in = 0;
        if let Some(fusion) = self.fusion.as_mut() {
            fusion.restart(corner);
        }
    }

    /// For some seconds sensors of the `suspected` corners (in the order of [`Corner::ALL`]) may have been wrong: that a gain has
    /// changed, or that a sensor carries another one's name, shows only later. What the axles have taught in the last six to
    /// twelve seconds is taken back, if it contradicts what was known before of anything but those corners' own tires.
    #[inline(never)]
    pub fn rollback(&mut self, suspected: [bool; 4]) {
        self.conclude_in = 0;
        if let Some(fusion) = self.fusion.as_mut() {
            fusion.rollback(suspected);
        }
    }

    /// Takes one sample, gives the estimate after it. A missing speed is the last one, for half a second ([`SpeedHold`](crate::conditioning::SpeedHold)).
    pub fn update(&mut self, sample: &CarSample<T>) -> CarEstimate<T> {
        let at = self.clock.take(sample.time_s, sample.speed_m_s);
        self.update_at(&at, sample, false)
    }

    /// The clock of the car, for whoever screens samples before they are taken.
    pub(crate) fn clock(&mut self) -> &mut SampleClock<T> {
        &mut self.clock
    }

    /// The same with time and speed as they were taken; the sample's own speed does not count. `is_taken`: something else is much work already.
    pub(crate) fn update_at(
        &mut self,
        at: &Moment<T>,
        sample: &CarSample<T>,
        is_taken: bool,
    ) -> CarEstimate<T> {
        let mut corners_work = false;
        match at.time_s {
            Some(time_s) => corners_work = self.take(time_s, at.speed_m_s, sample, is_taken),
            // Counted corner by corner.
            None => self.corners.iter_mut().flatten().for_each(CornerEstimator::refuse),
        }
        // No sample does more than one of these: a part of a frame, of the struts' identification, or a corner's own measurement; and that not beside
        // the corners' frames.
        let mut has_room = self.fusion.as_mut().is_none_or(|fusion| fusion.work_on(at.now_s, is_taken));
        // A calibration that is to begin is much work by itself.
        if has_room && self.calibration_s.is_none() {
            has_room = !self.identify();
        }
        has_room &= !corners_work || self.calibration_s.is_some();
        // Nor is one drawn beside one of these, unless it would come late.
        let concludes = self.conclude_in == 0 || has_room && self.conclude_in <= self.conclude_every;
        if concludes {
            self.conclude(at.now_s, has_room, sample);
            self.conclude_in = 2 * self.conclude_every;
        }
        self.conclude_in = self.conclude_in.saturating_sub(1);
        let corners = Corner::ALL.map(|corner| self.estimate(corner, at.now_s, sample));
        let Concluded { correlation, loss_correlation, tracks, .. } = self.concluded;
        CarEstimate { time_s: sample.time_s, corners, correlation, loss_correlation, tracks }
    }

    /// Information about the axles at a time at which no corner was measured.
    pub(crate) fn without_corners(&self, time_s: f64) -> CarEstimate<T> {
        let Concluded { correlation, loss_correlation, tracks, .. } = self.concluded;
        CarEstimate { time_s, corners: [None; 4], correlation, loss_correlation, tracks }
    }

    /// Gives a sample's values to the corners and to the road they share; true if corners worked on their frames, where samples come fast.
    #[inline(never)]
    fn take(&mut self, time_s: f64, speed_m_s: T, sample: &CarSample<T>, is_taken: bool) -> bool {
        if let Some(fusion) = self.fusion.as_mut() {
            fusion.drive(time_s, speed_m_s);
        }
        let is_fast = self.fusion.as_ref().is_some_and(Fusion::is_fast);
        let concludes_next = self.conclude_in <= self.conclude_every && (!is_fast || self.has_measurement());
        let has_other_work = match self.fusion.as_ref() {
            _ if is_taken && is_fast => true,
            Some(fusion) if !fusion.is_at_rest() => fusion.is_large_next(),
            _ => self.body_equation.is_learning() || concludes_next,
        };
        let turn = self.turn;
        self.turn = turn.other();
        let mut corners_work = false;
        for corner in Corner::ALL {
            let estimator = self.corners[corner].as_mut();
            let (Some(estimator), Some(values)) = (estimator, &sample.corners[corner]) else { continue };
            let pace = match has_other_work && self.conclude_every > 1 {
                true => Pace::Waits,
                false if is_fast && corner.side() != turn => Pace::Yields,
                false => Pace::Works,
            };
            let before = estimator.units_done();
            match self.fusion.as_mut() {
                Some(fusion) => {
                    let mut tap = |step: &_, signals: &_| fusion.push(corner, step, signals);
                    estimator.take(time_s, speed_m_s, values, pace, &mut tap);
                }
                None => estimator.take(time_s, speed_m_s, values, pace, |_, _| {}),
            }
            corners_work |= is_fast && estimator.units_done() != before;
        }
        corners_work
    }

    /// Whether a corner's own measurement is to be made with the next conclusion.
    fn has_measurement(&self) -> bool {
        self.corners.iter().flatten().any(CornerEstimator::has_pseudo_measurement)
    }

    /// Identifies the struts and the body that they carry; true if there was something to do.
    #[inline(never)]
    fn identify(&mut self) -> bool {
        let frames = self.corners.each_ref().map(|corner| corner.as_ref()?.strut_frame());
        match self.body_equation.learn(frames) {
            Learning::Idle => return false,
            Learning::UnderWay => return true,
            Learning::Complete => {}
        }
        for corner in Corner::ALL {
            let Some(estimator) = self.corners[corner].as_mut() else { continue };
            estimator.set_strut(&self.body_equation, corner);
            if let Some(fusion) = self.fusion.as_mut() {
                fusion.set_strut(corner, &estimator.quarter_car(), &self.body_equation);
            }
        }
        true
    }

    /// How well body and wheel of a corner go together, and what does not, if the car has that corner.
    pub fn fit(&self, corner: Corner) -> Option<(BodyFit<T>, Option<Misfit>)> {
        self.corners[corner].as_ref().map(CornerEstimator::fit)
    }

    /// Identified parameters of each strut over the last minute, in the order of [`Corner::ALL`]; `None` where too little was seen. Computed when asked.
    pub fn strut_readings(&self) -> [Option<StrutReading<T>>; 4] {
        Corner::ALL.map(|corner| self.body_equation.reading(corner))
    }

    /// The cars as they seem to be now, in the order of [`Corner::ALL`].
    pub fn quarter_cars(&self) -> [Option<QuarterCar<T>>; 4] {
        self.corners.each_ref().map(|estimator| estimator.as_ref().map(CornerEstimator::quarter_car))
    }
}
