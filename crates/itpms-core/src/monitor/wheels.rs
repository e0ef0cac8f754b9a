//! The radius analysis of wheel speeds under a monitor: the same states and alerts as for a car with accelerations. Alone, or beside the
//! monitor of the accelerations.

#[cfg(test)]
mod tests;

use crate::conditioning::pauses::{PAUSE_S, ROUNDING_S};
use crate::decision::Tuning;
use crate::diagnosis::{Malfunction, Place, Sensor};
use crate::memory::{Blank, Placed};
use crate::model::{Corner, ParameterError, RadiusDifferences, Validity, Warning, Wheels};
use crate::real::Real;
use crate::torsion::CarTorsion;
use crate::warning::{Alert, Cause, Doubt, LeakOverDays, MonitorReport, WheelReport, WheelState};
use crate::wheel_speed::{
    RadiusCalibration, RadiusDay, RadiusDays, RadiusMonitor, RadiusReport, RadiusState, SlowLeak,
    WheelRadius, WheelSpeedConfig, WheelSpeedSample,
};

/// As of every [decision](crate::decision).
const DECISION: Tuning = Tuning::DEFAULT;
/// Usable driving in s after which what is more probable than .99 is reported, and after which a report that does not hold any more
/// is taken back. After as much unusable driving no tire is known to be fine any more: a loss in it would not have shown.
const LASTING_S: f64 = 60.0;
/// Share of its pressure above which a reading's loss makes a tire not fine, where the sd of the reading is smaller.
const LOW_READING: f64 = 0.08;
/// Probability below which a tire that days have named as leaking slowly no longer is.
const SLOW_LEAK_HOLDS: f64 = 0.9;

/// A radius analysis under its monitor; less than 5 kB in `f32`.
#[derive(Debug, Clone, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MonitoredWheels<T: Real> {
    radii: RadiusMonitor<T>,
    /// Seconds that are left of a calibration; zero: there is none.
    calibration_left_s: f64,
    /// Since when its state has been probable.
    since_s: f64,
    state: RadiusState,
    alert: Placed<Alert<T>>,
}

impl<T: Real> MonitoredWheels<T> {
    /// The monitor of a car's wheel speeds, uncalibrated.
    ///
    /// # Errors
    /// A length or a radius over pressure that no car has.
    pub fn new(config: &WheelSpeedConfig<T>) -> Result<Self, ParameterError> {
        let mut wheels = Self::unconfigured();
        wheels.configure(config)?;
        Ok(wheels)
    }

    /// Memory for a monitor, as a constant of zeros; [`configure`](Self::configure) fills it where it lies.
    #[must_use]
    pub const fn unconfigured() -> Self {
        <Self as crate::memory::Blank>::BLANK
    }

    /// Begins anew with this car, uncalibrated.
    ///
    /// # Errors
    /// As for [`new`](Self::new); the monitor is unconfigured then.
    pub fn configure(&mut self, config: &WheelSpeedConfig<T>) -> Result<(), ParameterError> {
        *self = Self::unconfigured();
        self.since_s = f64::NEG_INFINITY;
        self.radii.configure(config)
    }

    /// All tires have the pressures they should have for so many seconds from the next sample on; a second or more without a sample does
    /// not count. What was driven well in them teaches how the tires differ.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.begin_calibration_at(seconds, &[T::one(); 4])
    }

    /// The same where each tire has this share of its reference pressure.
    ///
    /// # Errors
    /// As for [`begin_calibration`](Self::begin_calibration).
    pub fn begin_calibration_at(
        &mut self,
        seconds: f64,
        pressure_share: &[T; 4],
    ) -> Result<(), ParameterError> {
        crate::model::positive("calibration_s", seconds)?;
        self.calibration_left_s = seconds;
        self.radii.begin_calibration_at(T::lit(seconds), pressure_share);
        self.alert.clear();
        Ok(())
    }

    /// Ends the calibration that is under way with what it has seen; whether that taught anything.
    pub fn end_calibration(&mut self) -> bool {
        self.calibration_left_s = 0.0;
        self.radii.end_calibration()
    }

    /// The calibration's result, once it is over.
    #[must_use]
    pub fn calibration(&self) -> Option<&RadiusCalibration<T>> {
        self.radii.calibration()
    }

    /// Loads the calibration of an earlier drive; `false` if no car can have it.
    #[must_use]
    pub fn load_calibration(&mut self, calibration: &RadiusCalibration<T>) -> bool {
        self.radii.load_calibration(calibration)
    }

    /// Whether the last calibration taught nothing because the driven wheels slipped as they do on snow.
    #[must_use]
    pub fn refused_snow(&self) -> bool {
        self.radii.refused_snow()
    }

    /// The tires have rolled so many km since the [calibration that was loaded](Self::load_calibration): each has worn by itself, so that
    /// their radii are known less well.
    pub fn age_calibration(&mut self, km: T) {
        self.radii.age(km);
    }

    /// Loads the days since the [calibration that was loaded](Self::load_calibration); `false` if no car can have them.
    #[must_use]
    pub fn load_days(&mut self, days: &RadiusDays<T>) -> bool {
        let is_one = days.is_sane();
        if is_one {
            self.radii.load_days(days);
        }
        is_one
    }

    /// Takes in another day, the newest one of its [days](Self::days); `false` if it is older than the last one.
    pub fn add_day(&mut self, day: &RadiusDay<T>) -> bool {
        let counts = self.radii.add_day(day);
        self.judge();
        counts
    }

    /// The days since the calibration, this one included: to be stored with it. Only days with dates count.
    #[must_use]
    pub fn days(&self) -> &RadiusDays<T> {
        self.radii.days()
    }

    /// The slow leak that they show, with its probability.
    #[must_use]
    pub fn slow_leak(&self) -> &SlowLeak<T> {
        self.radii.slow_leak()
    }

    /// The samples' times count from here, in s since 1970; without it they are dates from 1e8 s on.
    pub fn clock_began(&mut self, unix_s: f64) {
        self.radii.clock_began(unix_s);
    }

    /// Whether [`differences`](Self::differences) may be others after the last sample.
    #[must_use]
    pub(crate) fn has_news(&self) -> bool {
        self.radii.has_news()
    }

    /// By how much the ratios of the radii have changed since the calibration; `None` without one.
    #[must_use]
    pub(crate) fn differences(&self) -> Option<RadiusDifferences<T>> {
        self.radii.differences()
    }

    /// Whether the yaw rate went against what the wheels show of bends: it is left out from then on, as if there were none.
    #[must_use]
    pub fn doubts_yaw_rate(&self) -> bool {
        self.radii.doubts_yaw_rate()
    }

    /// The report of radii and losses.
    #[must_use]
    pub fn radii(&self) -> &RadiusReport<T> {
        self.radii.report()
    }

    /// The alert that stands, if one does.
    #[must_use]
    pub fn alert(&self) -> Option<Alert<T>> {
        self.alert.get()
    }

    /// Takes in a sample.
    pub fn update(&mut self, sample: &WheelSpeedSample<T>) {
        if self.is_calibrating() {
            // Steps are added up: a stray stamp, or a clock that is set, is a pause and no end.
            let step_s = sample.time_s - self.radii.report().time_s;
            if step_s > 0.0 && step_s < PAUSE_S {
                self.calibration_left_s -= step_s;
            }
            if !(self.calibration_left_s > ROUNDING_S) {
                self.end_calibration();
            }
        }
        self.radii.update(sample);
        self.judge();
    }

    /// The same of a car whose tooth pulses are read, too: those up to this sample's time are in `pulses`, whose calibration ends with this
    /// one's.
    pub fn update_with_pulses(&mut self, sample: &WheelSpeedSample<T>, pulses: Option<&mut CarTorsion<T>>) {
        let Some(torsion) = pulses else { return self.update(sample) };
        let calibrated = self.is_calibrating();
        self.radii.see_pulses(&torsion.evidence());
        self.update(sample);
        if calibrated && !self.is_calibrating() {
            torsion.end_calibration();
        }
    }

    /// Whether a calibration is under way, or begins with the next sample.
    #[must_use]
    pub fn is_calibrating(&self) -> bool {
        self.calibration_left_s > 0.0
    }

    /// The fault of the wheels' sensors, and of which.
    fn malfunction(&self) -> Option<(Wheels, Malfunction<T>)> {
        let sensor = |corner: Corner| Sensor { corner, place: Place::WheelSpeed };
        let (missing, stuck) = (self.radii.missing(), self.radii.stuck());
        if let Some(corner) = missing.iter().next() {
            return Some((missing, Malfunction::Dropout(sensor(corner))));
        }
        if let Some(corner) = stuck.iter().next() {
            return Some((stuck, Malfunction::Stuck(sensor(corner))));
        }
        if let Some((corner, gain)) = self.radii.odd() {
            return Some((corner.into(), Malfunction::Gain { sensor: sensor(corner), gain }));
        }
        self.radii.does_not_follow()
    }

    /// Raises an alert, or takes one back.
    fn judge(&mut self) {
        let report = self.radii.report();
        let now_s = report.time_s;
        if report.state != self.state {
            (self.state, self.since_s) = (report.state, now_s - report.lasted_s.to_f64());
        }
        if let Some((wheels, malfunction)) = self.malfunction() {
            let stands = |alert: &Alert<T>| matches!(alert.cause, Cause::Malfunction(known) if alert.wheels == wheels && known.is_same_as(&malfunction));
            if !self.alert.as_ref().is_some_and(stands) {
                let cause = Cause::Malfunction(malfunction);
                self.alert.set(Some(Alert { wheels, since_s: now_s, reported_s: now_s, cause }));
            }
            return;
        }
        if self.alert.as_ref().is_some_and(|alert| matches!(alert.cause, Cause::Malfunction(_))) {
            self.alert.clear();
        }
        let (lasts, leaks) = (report.lasted_s >= T::lit(LASTING_S), self.slow_leak_alert(now_s));
        let leaks_among =
            |wheels: Wheels| leaks.is_some_and(|leak| leak.wheels.iter().all(|wheel| wheels.contains(wheel)));
        let (wheels, is_known, probability) = match report.state {
            RadiusState::Low(wheels) => {
                let least = wheels.iter().map(|c| low_probability(report, c)).fold(T::one(), T::at_most);
                (wheels, true, least)
            }
            // Days that name one of them know more.
            RadiusState::OneOf(wheels) if !leaks_among(wheels) => (wheels, false, report.any_low_probability),
            _ => {
                let standing = self
                    .alert
                    .get()
                    .filter(|alert| leaks.is_some_and(|new| alert.wheels == new.wheels && is_slow(alert)));
                match (leaks, standing) {
                    // It goes on, with what is known by now.
                    (Some(new), Some(alert)) => self.alert.set(Some(Alert { cause: new.cause, ..alert })),
                    _ if lasts || self.radii.calibration().is_none() || self.alert.as_ref().is_none() => {
                        self.alert.set(leaks)
                    }
                    _ => {}
                }
                return;
            }
        };
        let same = |alert: &Alert<T>| alert.wheels == wheels && knows(alert) == is_known && !is_slow(alert);
        let doubt = T::one() - probability;
        if self.alert.as_ref().is_some_and(same) || !(lasts || doubt < T::lit(DECISION.beyond_doubt)) {
            return;
        }
        let lost =
            |corner: Corner| report.wheels.get(corner.index()).map(|w| (w.lost_share, w.lost_share_sd));
        let larger = |a: (T, T), b: (T, T)| if b.0 > a.0 { b } else { a };
        let (lost_share, lost_sd_share) =
            wheels.iter().filter_map(lost).reduce(larger).unwrap_or((T::zero(), T::zero()));
        self.alert.set(Some(Alert {
            wheels,
            since_s: self.since_s,
            reported_s: now_s,
            cause: Cause::Differs { lost_share, lost_sd_share, is_known, probability },
        }));
    }

    /// The alert of a slow leak by the days since the calibration.
    fn slow_leak_alert(&self, now_s: f64) -> Option<Alert<T>> {
        let leak = self.radii.slow_leak();
        let (wheel, probability) = leak.likeliest();
        let named = |alert: &Alert<T>| is_slow(alert) && alert.wheels == wheel.into();
        let stands = self.alert.as_ref().is_some_and(named);
        if !(probability > T::lit(if stands { SLOW_LEAK_HOLDS } else { DECISION.surely_low })) {
            return None;
        }
        let (beta, beta_sd) = self.radii.radius_per_ln_pressure();
        let ln_per_day = leak.rate_per_day / beta;
        let sd = (leak.rate_sd_per_day / beta).hypot(ln_per_day * beta_sd);
        let left = (ln_per_day * leak.day).exp_fast();
        let cause = Cause::SlowLeak(LeakOverDays {
            probability,
            lost_share_per_day: -ln_per_day,
            lost_sd_share_per_day: sd,
            lost_share: T::one() - left,
            lost_sd_share: left * sd * leak.day,
            days: leak.days,
        });
        Some(Alert { wheels: wheel.into(), since_s: now_s, reported_s: now_s, cause })
    }

    /// Writes what is reported of the tires, with its time, and what is known of each wheel.
    pub fn write_report_into(&self, report: &mut MonitorReport<T>) {
        let radii = self.radii.report();
        report.begin(radii.time_s, 0.0);
        for (corner, wheel) in Corner::ALL.into_iter().zip(&mut report.wheels) {
            *wheel = Some(self.wheel(corner));
        }
        report.put_of_wheel_speeds(self.alert.get());
    }

    fn wheel(&self, corner: Corner) -> WheelReport<T> {
        let (radii, nan) = (self.radii.report(), T::lit(f64::NAN));
        let state = self.state_of(corner);
        let known = !matches!(
            state,
            WheelState::Malfunction | WheelState::Unknown(Doubt::Starting | Doubt::NoInformation)
        );
        WheelReport {
            state,
            validity: match state {
                WheelState::Malfunction => Validity::BadSignal,
                _ if known => Validity::Valid,
                WheelState::Unknown(Doubt::Starting) => Validity::Starting,
                _ => Validity::NoInformation,
            },
            warning: match state {
                WheelState::Low => Warning::Low,
                WheelState::Malfunction => Warning::Malfunction,
                _ => Warning::None,
            },
            pressure_kpa: nan,
            pressure_sd_kpa: nan,
            reference_kpa: nan,
            informed_s: if known { radii.informed_s } else { f64::NEG_INFINITY },
        }
    }

    /// The state of a wheel; a tire that does not differ from the others is fine.
    #[must_use]
    pub fn state_of(&self, corner: Corner) -> WheelState {
        let radii = self.radii.report();
        if self.malfunction().is_some_and(|(wheels, _)| wheels.contains(corner)) {
            return WheelState::Malfunction;
        }
        let suspected = match radii.state {
            RadiusState::Uncalibrated | RadiusState::Calibrating => {
                return WheelState::Unknown(Doubt::Starting);
            }
            RadiusState::Low(wheels) | RadiusState::OneOf(wheels) => wheels,
            RadiusState::Uninformed | RadiusState::NoneDiffers => Wheels::NONE,
        };
        match self.alert.as_ref().filter(|alert| alert.wheels.contains(corner)) {
            Some(alert) if knows(alert) => return WheelState::Low,
            Some(_) => return WheelState::Unknown(Doubt::Uncertain),
            None if suspected.contains(corner) => return WheelState::Unknown(Doubt::Uncertain),
            None => {}
        }
        let is_known = radii.unseen_s.get(corner.axle()).is_some_and(|s| *s < T::lit(LASTING_S));
        match radii.wheels.get(corner.index()).filter(|wheel| is_known && wheel.informed()) {
            Some(wheel) if wheel.low_probability < T::lit(DECISION.surely_not_low) && !reads_low(wheel) => {
                WheelState::Fine
            }
            Some(_) => WheelState::Unknown(Doubt::Uncertain),
            None => WheelState::Unknown(Doubt::NoInformation),
        }
    }
}

fn low_probability<T: Real>(report: &RadiusReport<T>, corner: Corner) -> T {
    report.wheels.get(corner.index()).map_or(T::zero(), |wheel| wheel.low_probability)
}

/// Whether a tire's reading is of one that has lost air, though that is not probable: pulses of all four that read low.
fn reads_low<T: Real>(wheel: &WheelRadius<T>) -> bool {
    wheel.lost_share > T::lit(LOW_READING) && wheel.lost_share > wheel.lost_share_sd
}

/// Whether an alert knows which wheels it is about.
fn knows<T>(alert: &Alert<T>) -> bool {
    matches!(alert.cause, Cause::Differs { is_known: true, .. } | Cause::SlowLeak(_))
}

fn is_slow<T>(alert: &Alert<T>) -> bool {
    matches!(alert.cause, Cause::SlowLeak(_))
}
