//! The estimator of one corner, without a clock: samples in, [`CornerEstimate`]s out. Called by [`Estimator`](super::Estimator) and by
//! the car. Every sample passes the [`Resampler`], so the Bayes filter never sees a missing or absurd value.

use super::concluded::CornerConclusion;
use super::fused_stiffness::FusedStiffness;
use super::pulses::PulseLevel;
use super::reading::{Reading, is_known};
use crate::conditioning::pauses::{DECIDE_S, ENOUGH_S, PAUSE_S};
use crate::conditioning::wheel_lift::ContactWatch;
use crate::conditioning::{GridSample, LEAST_GRID_HZ, Resampler, SampleCounts};
use crate::memory::{Blank, Placed};
use crate::model::{
    AxleFit, BodyFit, Corner, CornerConfig, CornerSample, Level, Misfit, ParameterError, QuarterCar,
    Validity, positive,
};
use crate::real::Real;
use crate::single_wheel::{Informed, OutsideStiffness, Pace, StiffnessPseudoMeasurement};
use crate::spectrum::SIGNALS;
use crate::suspension::{BodyEquation, Strut, StrutFrame};
use crate::torsion::TorsionChange;

/// Longest time in s that an estimate waits for the verdict on body and wheel.
const UNJUDGED_S: f64 = 20.0;

/// The estimator of one corner, without a clock: its owner tells time and speed.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct CornerEstimator<T: Real> {
    config: CornerConfig<T>,
    resampler: Resampler<T>,
    informed: Informed<T>,
    /// What the Bayes filter last found, and the time of the step in which a frame or a repeated road was last learned from.
    reading: Reading<T>,
    read_s: f64,
    /// Length in s of the calibration drive at the start, and when it ends once that is known.
    calibration_s: f64,
    calibration_ends_s: Option<f64>,
    pinned_s: f64,
    contact: ContactWatch<T>,
    strut: Strut<T>,
    /// Variance in (N/m)² of the tire's stiffness by unknown friction of the strut.
    friction_variance: T,
    fit: BodyFit<T>,
    misfit: Placed<Misfit>,
    /// Since when there is something to believe, but for the verdict on body and wheel.
    judged_from_s: Option<f64>,
    has_fitted: bool,
    /// Seconds of information that the corner had when its sensors last sent nothing.
    learned_before_s: T,
}

impl<T: Real> CornerEstimator<T> {
    /// An estimator for a corner whose samples come at about `sample_rate_hz`.
    /// Errors: the rate must be positive and finite; parameters of the corner that the filters refuse are named.
    pub(crate) fn configure(
        &mut self,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<(), ParameterError> {
        positive("accel_noise_m_s2", config.accel_noise_or_usual_m_s2())?;
        self.config = *config;
        self.resampler = Resampler::new(sample_rate_hz, LEAST_GRID_HZ);
        let grid_period_s = self.resampler.grid_period_s();
        self.informed.configure(config, sample_rate_hz, grid_period_s);
        self.begin_reading();
        self.calibration_s = 0.0;
        self.calibration_ends_s = None;
        self.pinned_s = f64::NEG_INFINITY;
        self.contact = ContactWatch::new(&config.quarter_car);
        let noise = config.accel_noise_or_usual_m_s2();
        let noise_density = T::lit(2.0 / sample_rate_hz) * noise * noise;
        let car = &config.quarter_car;
        let masses_kg = [car.unsprung_mass_kg(), car.sprung_mass_kg()];
        self.strut.configure(self.resampler.grid_period_s(), masses_kg, noise_density);
        (self.fit, self.judged_from_s, self.has_fitted) = (BodyFit::BLANK, None, false);
        (self.friction_variance, self.learned_before_s) = (T::zero(), T::zero());
        self.misfit.clear();
        Ok(())
    }

    /// Its frames are worked on when those of the car's other corners are not; before the first sample.
    pub(crate) fn stagger(&mut self, corner: Corner) {
        self.informed.stagger(corner);
    }

    /// Sets the prior before the first frame.
    fn begin_reading(&mut self) {
        self.reading = Reading::of(&self.config, &self.informed.belief());
        self.read_s = f64::NEG_INFINITY;
    }

    /// Says that the tire has its placard pressure from the next sample on, for `seconds`: the driver's calibration.
    /// Errors: the length must be positive and finite.
    pub(crate) fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.calibration_s = positive("calibrate_s", seconds)?;
        self.calibration_ends_s = None;
        Ok(())
    }

    /// From the next sample on the tire's pressure is no longer known.
    pub(crate) fn end_calibration(&mut self) {
        (self.calibration_s, self.calibration_ends_s) = (0.0, None);
    }

    /// See [`Estimator::follow`](super::Estimator::follow).
    pub(crate) fn follow(&mut self, outside: Option<OutsideStiffness<T>>) {
        self.informed.follow(outside);
        self.read_s = self.informed.last_time_s();
        self.reading = Reading::of(&self.config, &self.informed.belief());
    }

    /// Probability that the pressure moves, as the corner by itself sees it. What it saw before its sensors sent nothing does not count,
    /// neither meanwhile nor until it has seen as much again as an estimate takes.
    pub(crate) fn change_probability(&self) -> T {
        let seen_s = self.informed.learned_s() - self.learned_before_s;
        if seen_s < T::lit(ENOUGH_S) { T::zero() } else { self.reading.change_probability }
    }

    /// Stiffness and its sd in N/m, as the corner by itself sees them.
    pub(crate) fn own_stiffness(&self) -> (T, T) {
        (self.reading.stiffness_n_per_m, self.with_friction(self.reading.stiffness_sd_n_per_m))
    }

    /// A standard deviation in N/m with what friction that is not known adds to it.
    fn with_friction(&self, sd_n_per_m: T) -> T {
        (sd_n_per_m * sd_n_per_m + self.friction_variance).sqrt()
    }

    pub(crate) fn quarter_car(&self) -> QuarterCar<T> {
        self.informed.quarter_car()
    }

    /// Counts a sample whose time is not to be used.
    pub(crate) fn refuse(&mut self) {
        let lost = T::lit(f64::NAN);
        self.resampler.push(f64::NAN, lost, lost, lost, |_| {});
    }

    /// The first half of [`Estimator::update`]: takes the sample with the speed to go by, and shows every grid step and its signals of the band to `tap`.
    #[inline(never)]
    pub(crate) fn take(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        corner: &CornerSample<T>,
        pace: Pace,
        mut tap: impl FnMut(&GridSample<T>, &[T; SIGNALS]),
    ) {
        let (informed, contact, strut) = (&mut self.informed, &mut self.contact, &mut self.strut);
        let mut learned_s = None;
        let (body, wheel) = (corner.body_accel_m_s2, corner.wheel_accel_m_s2);
        self.resampler.push(time_s, speed_m_s, body, wheel, |sample| {
            let contact = contact.look(&sample);
            let sample = GridSample { unloaded: contact.unloaded, ..sample };
            let [all, band] = strut.push(&sample);
            let invalid = sample.invalid || contact.hopping;
            if informed.push(&GridSample { invalid, ..sample }, &all, pace) {
                learned_s = Some(sample.time_s);
            }
            tap(&sample, &band);
        });
        if let Some(learned_s) = learned_s {
            self.read_s = learned_s;
            self.reading = Reading::of(&self.config, &self.informed.belief());
        }
        self.hold_calibration(time_s);
    }

    /// How much of the work on its newest frames is done.
    pub(crate) fn units_done(&self) -> usize {
        self.informed.units_done()
    }

    /// What the last frames reported of the stiffness to one who believed in this one with that sd, in N/m, when there is something new.
    pub(crate) fn pseudo_measurement(
        &mut self,
        believed: impl FnOnce() -> (T, T),
    ) -> Option<StiffnessPseudoMeasurement<T>> {
        self.informed.pseudo_measurement(believed)
    }

    /// Whether there is something new in them.
    pub(crate) fn has_pseudo_measurement(&self) -> bool {
        self.informed.has_pseudo_measurement()
    }

    /// See [`Estimator::take_pseudo_measurement`](super::Estimator::take_pseudo_measurement).
    pub(crate) fn take_pseudo_measurement(&mut self) -> Option<StiffnessPseudoMeasurement<T>> {
        self.informed.take_pseudo_measurement()
    }

    /// Whether the road is one line, as a washboard's is.
    pub(crate) fn is_on_line(&self) -> bool {
        self.informed.is_on_line()
    }

    /// The newest frame of the force that moves the body here.
    pub(crate) fn strut_frame(&self) -> Option<&StrutFrame<T>> {
        self.strut.frame()
    }

    /// Takes over what the body's equation of motion tells of the strut.
    pub(crate) fn set_strut(&mut self, equation: &BodyEquation<T>, corner: Corner) {
        let slip_forces_n = equation.slip_forces_n(corner);
        self.strut.set_slip_forces(slip_forces_n);
        let body = equation.quarter_car(corner, self.config.quarter_car.unsprung_mass_kg());
        self.informed.set_strut(body, &equation.describing_function(corner));
        self.friction_variance = equation.stiffness_variance(corner);
        self.fit.unexplained = equation.unexplained(corner);
        self.fit.friction_n = slip_forces_n.into_iter().fold(T::zero(), |sum, force| sum + force);
    }

    /// How well body and wheel go together, and what does not.
    pub(crate) fn fit(&self) -> (BodyFit<T>, Option<Misfit>) {
        (self.fit, self.misfit.get())
    }

    /// Pressure in kPa as the corner by itself reads it, with its variance by the signals and what the vehicle file leaves open of it.
    fn own_pressure(&self) -> (T, T, T) {
        let tire = &self.config.tire;
        let (stiffness_n_per_m, sd_n_per_m) = self.own_stiffness();
        let [sd, open] = [sd_n_per_m, self.config.uncertainty.tire_relative_sd() * stiffness_n_per_m]
            .map(|n_per_m| n_per_m / tire.stiffness_per_kpa());
        (tire.pressure_kpa(stiffness_n_per_m), sd * sd, open * open)
    }

    /// The stiffness with what the pulses of the wheel tell of its level; `None` where they add nothing, and in a calibration.
    pub(super) fn with_pulses(&self, pulses: &mut PulseLevel<T>, time_s: f64) -> Option<FusedStiffness<T>> {
        let (pressure_kpa, variance_kpa2, open_kpa2) = self.own_pressure();
        pulses.read(time_s, pressure_kpa, variance_kpa2);
        let (excess_kpa, left_kpa2) = pulses.excess(open_kpa2);
        if self.calibration_s > 0.0 || !(left_kpa2 < open_kpa2) {
            return None;
        }
        let per_kpa = self.config.tire.stiffness_per_kpa();
        let (stiffness_n_per_m, sd_n_per_m) = self.own_stiffness();
        Some(FusedStiffness {
            stiffness_n_per_m: stiffness_n_per_m + excess_kpa * per_kpa,
            stiffness_sd_n_per_m: sd_n_per_m,
            considered_sd_n_per_m: left_kpa2.sqrt() * per_kpa,
            level: Level::VehicleFile,
            changing: self.reading.change_probability,
            learned_s: self.informed.learned_s(),
            learning: false,
            has_signal: true,
        })
    }

    /// Takes a piece of the pulses of its wheel; not in a calibration.
    pub(super) fn take_piece(&self, piece: &TorsionChange<T>, pulses: &mut PulseLevel<T>) {
        if !(self.calibration_s > 0.0) {
            let (pressure_kpa, _, open_kpa2) = self.own_pressure();
            pulses.take(piece, self.config.placard_kpa, pressure_kpa, open_kpa2);
        }
    }

    pub(crate) fn grid_period_s(&self) -> f64 {
        self.resampler.grid_period_s()
    }

    /// Concludes what is known now, the second part of [`Estimator::update`]: with a `fused` stiffness, if there is one, and how
    /// well front and rear of the side go together.
    pub(crate) fn conclude(
        &mut self,
        time_s: f64,
        fused: Option<&FusedStiffness<T>>,
        axles: &AxleFit<T>,
    ) -> CornerConclusion<T> {
        let Reading { stiffness_n_per_m, stiffness_sd_n_per_m, .. } = self.reading;
        if !(stiffness_n_per_m.is_finite() && stiffness_sd_n_per_m.is_finite()) {
            self.restart();
        }
        let mut reading = self.reading_at(time_s);
        match fused {
            Some(fused) => reading.fuse(&self.config, fused),
            None => reading.stiffness_sd_n_per_m = self.with_friction(reading.stiffness_sd_n_per_m),
        }
        (self.fit.incoherence, self.fit.averages) = (self.strut.incoherence(), self.strut.averages());
        (self.fit.hop_excess, self.fit.response_error) = (axles.hop_excess, axles.response_error);
        self.fit.is_apart = axles.is_apart;
        self.misfit.set(self.fit.misfit(self.misfit.get()));
        let (considered, level) = self.considered(time_s, &reading, fused);
        self.concluded(time_s, reading, considered, level)
    }

    /// The reading at a time: nothing is being learned where no frame comes, as in a hole of the record.
    fn reading_at(&self, time_s: f64) -> Reading<T> {
        if (0.0..PAUSE_S).contains(&(time_s - self.read_s)) {
            return self.reading;
        }
        Reading { gate: T::zero(), ..self.reading }
    }

    /// While the calibration drive lasts, says so to the estimator ten times a second.
    fn hold_calibration(&mut self, time_s: f64) {
        if !(self.calibration_s > 0.0 && time_s.is_finite()) {
            return;
        }
        let ends_s = *self.calibration_ends_s.get_or_insert(time_s + self.calibration_s);
        if !(time_s < ends_s) {
            self.calibration_s = 0.0;
        } else if !(time_s - self.pinned_s < DECIDE_S) {
            self.pinned_s = time_s;
            self.informed.set_to_placard();
            self.reading = Reading::of(&self.config, &self.informed.belief());
        }
    }

    /// Starts again from the corner's initial pressure, as after a tire change. Counted.
    pub(crate) fn restart(&mut self) {
        self.resampler.interrupt();
        self.strut.restart();
        (self.fit, self.judged_from_s, self.has_fitted) = (BodyFit::BLANK, None, false);
        self.misfit.clear();
        self.informed.restart();
        self.begin_reading();
        self.learned_before_s = T::zero();
    }

    pub(crate) fn counts(&self) -> SampleCounts {
        self.resampler.counts()
    }

    /// Standard deviation in N/m that the vehicle file leaves open: masses and stiffnesses of a wheel times one factor look the same.
    fn considered(&self, time_s: f64, reading: &Reading<T>, fused: Option<&FusedStiffness<T>>) -> (T, Level) {
        let calibrating = self.calibration_ends_s.is_some_and(|ends_s| time_s < ends_s);
        let (sd, level) = match fused {
            Some(fused) => (fused.considered_sd_n_per_m, fused.level),
            None if calibrating => (T::zero(), Level::Calibration),
            None => {
                let sd = self.config.uncertainty.tire_relative_sd() * reading.stiffness_n_per_m;
                (sd, Level::VehicleFile)
            }
        };
        let doubt = self.misfit.get().and_then(|misfit| misfit.doubt(level)).map_or(T::zero(), T::lit);
        let doubt = doubt * reading.stiffness_n_per_m;
        ((sd * sd + doubt * doubt).sqrt(), level)
    }

    /// Whether body and wheel have still to be found to go together; a log of nothing but pieces is believed without in the end. A car that
    /// was calibrated has fitted before: that it seems to is enough.
    fn is_unjudged(&mut self, time_s: f64, level: Level) -> bool {
        if self.has_fitted {
            return false;
        }
        if self.fit.incoherence.is_some() {
            self.has_fitted = level == Level::StoredCalibration || self.fit.is_surely_usable(level);
            return !self.has_fitted;
        }
        let from_s = *self.judged_from_s.get_or_insert(time_s);
        !(time_s - from_s >= UNJUDGED_S)
    }

    fn concluded(
        &mut self,
        time_s: f64,
        reading: Reading<T>,
        considered_sd_n_per_m: T,
        level: Level,
    ) -> CornerConclusion<T> {
        let tire = &self.config.tire;
        let pressure_kpa = tire.pressure_kpa(reading.stiffness_n_per_m);
        let change_sd_n_per_m = reading.stiffness_sd_n_per_m;
        let stiffness_sd_n_per_m =
            (change_sd_n_per_m * change_sd_n_per_m + considered_sd_n_per_m * considered_sd_n_per_m).sqrt();
        let pressure_sd_kpa = tire.pressure_sd_kpa(pressure_kpa, stiffness_sd_n_per_m);
        let change_sd_kpa = change_sd_n_per_m / tire.stiffness_per_kpa();
        let bad = self.resampler.is_bad();
        if bad {
            self.learned_before_s = self.informed.learned_s();
        }
        let unjudged = reading.validity.is_valid() && self.is_unjudged(time_s, level);
        let validity = match reading.validity {
            _ if bad => Validity::BadSignal,
            Validity::Valid | Validity::NoInformation
                if self.misfit.get().is_some_and(|misfit| misfit.doubt(level).is_none()) =>
            {
                Validity::Misfit
            }
            Validity::Valid if unjudged => Validity::Starting,
            // A level that is not known well is none the less one: only what the signals tell is asked for.
            Validity::Valid if !is_known(&self.config, change_sd_kpa) => Validity::NoInformation,
            validity => validity,
        };
        CornerConclusion {
            reading,
            stiffness_sd_n_per_m,
            pressure_kpa,
            pressure_sd_kpa,
            change_sd_kpa,
            level,
            validity,
            axle_difference_sd_kpa: None,
            loss: None,
        }
    }
}
