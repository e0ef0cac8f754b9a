//! An alert: which wheels, since when, and why, with the numbers that decided.

use core::fmt;

use crate::diagnosis::Malfunction;
use crate::memory::Blank;
use crate::model::{Level, PressureUnit, Wheels};
use crate::real::Real;

/// Alerts that were reported less than so many seconds apart are one: decisions are further apart, and rounding is nearer.
const SAME_S: f64 = 1e-3;

/// Something the driver or the workshop should know.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Alert<T> {
    /// Whom it is about.
    pub wheels: Wheels,
    /// Since when it has been so, in s, as far as is known.
    pub since_s: f64,
    /// When it was first reported, in s.
    pub reported_s: f64,
    /// Why.
    pub cause: Cause<T>,
}

/// Why an alert stands.
// With a tag of its own, so that the first variant of zeros is all zeros.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Cause<T> {
    /// The pressure is certainly below the limit.
    UnderInflated(Reading<T>),
    /// The pressure falls fast against that of the other wheels.
    FastLeak {
        /// The pressure now.
        reading: Reading<T>,
        /// How fast it fell at most since the leak began, over half a minute, in kPa per minute, positive.
        rate_kpa_per_min: T,
    },
    /// All wheels together are low, though none of them needs to be so for certain by itself.
    AllLow {
        /// Mean of pressure over reference.
        mean_share: T,
        /// Its standard deviation.
        sd_share: T,
        /// How probable it is that each has too little air.
        probability: T,
    },
    /// All wheels, or those of an axle, together read otherwise than a calibration of an earlier day: tires, wheels or dampers were changed, or all are too low
    /// or too high. Accelerations do not part the two.
    CommonShift {
        /// Mean of pressure over reference.
        mean_share: T,
        /// Its standard deviation, with what a car may change between two days.
        sd_share: T,
    },
    /// The pressure is certainly above the limit.
    OverInflated(Reading<T>),
    /// Far harder than the other tire of its axle, more than a tire is inflated: flat, on its rim.
    Flat(Reading<T>),
    /// A sensor or its wiring.
    Malfunction(Malfunction<T>),
    /// These wheels, or one of them, roll on a smaller radius than the others since the calibration: what wheel speeds show. How the level
    /// of all tires has changed is not known, but by tooth pulses: then it may be all four.
    Differs {
        /// Share of its pressure that the tire has lost; the largest of several tires.
        lost_share: T,
        /// Its standard deviation, with that of the radius over pressure.
        lost_sd_share: T,
        /// Whether all of them do; else it is one of them or more, and which is not known.
        is_known: bool,
        /// How probable that is: of the least probable of several, or that it is any of them.
        probability: T,
    },
    /// This wheel has lost air slowly since the calibration, over days none of which shows it by itself: by wheel speeds.
    SlowLeak(LeakOverDays<T>),
    /// Nothing could be learned for too long a time of driving.
    NoInformation {
        /// That time in s.
        driven_s: f64,
    },
}

impl<T: Real> Blank for Cause<T> {
    const BLANK: Self = Self::UnderInflated(Reading::BLANK);
}

/// The pressure that decided.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading<T> {
    /// Gauge pressure in kPa.
    pub pressure_kpa: T,
    /// Its standard deviation in kPa.
    pub sd_kpa: T,
    /// The limit it has passed, in kPa.
    pub limit_kpa: T,
    /// Reference pressure in kPa.
    pub reference_kpa: T,
    /// Basis of the reference.
    pub basis: Basis,
    /// How probable it is that the tire has too little air, or has lost so much in this drive; `None` of one that has too much.
    pub probability: Option<T>,
}

/// A leak that days show together: a wheel loses air slowly since the calibration.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LeakOverDays<T> {
    /// How probable it is.
    pub probability: T,
    /// Share of its pressure that the tire loses a day.
    pub lost_share_per_day: T,
    /// Its standard deviation, with that of the radius over pressure.
    pub lost_sd_share_per_day: T,
    /// Share of its pressure that it has lost in all.
    pub lost_share: T,
    /// Its standard deviation.
    pub lost_sd_share: T,
    /// Days that count.
    pub days: u32,
}

/// The text after the wheel's name.
impl<T: Real> fmt::Display for LeakOverDays<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [rate, rate_sd, lost, sd] =
            [self.lost_share_per_day, self.lost_sd_share_per_day, self.lost_share, self.lost_sd_share]
                .map(|share| 100.0 * share.to_f64());
        write!(
            f,
            "loses {rate:.1} % (sd {rate_sd:.1}) of its pressure a day, {lost:.0} % (sd {sd:.0}) since the calibration, by the wheel speeds of {} days",
            self.days
        )
    }
}

crate::labelled! {
    /// Basis of a reference pressure.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Blank)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub enum Basis {
        /// Against its level as the vehicle file has it.
        #[blank]
        VehicleFile = "file",
        /// Against what a calibration has set.
        Calibration = "calibration",
        /// Against the other tires: its level is not known that well, but it is surely lower than they are.
        OtherTires = "other-tires",
    }
}

impl Basis {
    /// The same for a person.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Basis::Calibration => "against the calibration",
            Basis::VehicleFile => "by the vehicle file",
            Basis::OtherTires => "against the other tires",
        }
    }
}

impl From<Level> for Basis {
    fn from(level: Level) -> Self {
        match level {
            Level::Calibration | Level::StoredCalibration => Basis::Calibration,
            Level::VehicleFile => Basis::VehicleFile,
            Level::OtherTires => Basis::OtherTires,
        }
    }
}

impl<T> Cause<T> {
    /// Whether it says that a tire has too little air.
    #[must_use]
    pub fn is_low(&self) -> bool {
        matches!(
            self,
            Cause::UnderInflated(_)
                | Cause::FastLeak { .. }
                | Cause::AllLow { .. }
                | Cause::Flat(_)
                | Cause::Differs { .. }
                | Cause::SlowLeak(_)
        )
    }

    /// Whether it is a tire that it speaks of, and not a sensor or that nothing is known.
    pub(crate) fn is_of_a_tire(&self) -> bool {
        !matches!(self, Cause::Malfunction(_) | Cause::NoInformation { .. })
    }

    /// One word: `under-inflated`, `fast-leak`, `all-low`, `common-shift`, `over-inflated`, `flat`, `differs`, `slow-leak`, `malfunction` or `no-information`.
    #[must_use]
    pub fn label(&self) -> &'static str {
        match self {
            Cause::UnderInflated(_) => "under-inflated",
            Cause::FastLeak { .. } => "fast-leak",
            Cause::AllLow { .. } => "all-low",
            Cause::CommonShift { .. } => "common-shift",
            Cause::OverInflated(_) => "over-inflated",
            Cause::Flat(_) => "flat",
            Cause::Differs { .. } => "differs",
            Cause::SlowLeak(_) => "slow-leak",
            Cause::Malfunction(_) => "malfunction",
            Cause::NoInformation { .. } => "no-information",
        }
    }
}

impl<T> Alert<T> {
    /// Whether this is what became of it, perhaps with newer numbers, after the clock was set back by so much in between.
    pub(crate) fn is_same_as(&self, other: &Self, set_back_s: f64) -> bool {
        let same_fault = match (&self.cause, &other.cause) {
            (Cause::Malfunction(a), Cause::Malfunction(b)) => a.is_same_as(b),
            (a, b) => a.label() == b.label(),
        };
        same_fault
            && self.wheels == other.wheels
            && (self.reported_s - set_back_s - other.reported_s).abs() < SAME_S
    }
}

impl<T: Real> Reading<T> {
    /// What a tire lost at most within half a minute, in kPa, by the largest rate of its fast leak: no more than it lacks of its reference.
    pub fn lost_within_half_a_minute_kpa(&self, rate_kpa_per_min: T) -> T {
        let lacks = (self.reference_kpa - self.pressure_kpa).at_least(T::ZERO);
        (rate_kpa_per_min * T::lit(0.5)).at_most(lacks)
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, unit: PressureUnit) -> fmt::Result {
        let [pressure, sd, limit, reference] =
            [self.pressure_kpa, self.sd_kpa, self.limit_kpa, self.reference_kpa]
                .map(|kpa| unit.number(kpa.to_f64(), 0));
        let basis = self.basis.words();
        let share = 100.0 * (self.limit_kpa / self.reference_kpa).to_f64();
        write!(f, "{pressure} {unit} (sd {sd}), limit {limit} ({share:.0} % of {reference}), {basis}")
    }
}

impl<T: Real> fmt::Display for Reading<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, PressureUnit::Kpa)
    }
}

/// The sentence of an alert with its pressures in a unit.
struct AlertIn<'a, T> {
    alert: &'a Alert<T>,
    unit: PressureUnit,
}

impl<T: Real> Alert<T> {
    /// The alert's sentence with its pressures in this unit.
    #[must_use]
    pub fn shown_in(&self, unit: PressureUnit) -> impl fmt::Display {
        AlertIn { alert: self, unit }
    }
}

/// A sentence for a person: wheels, why, the numbers, since when.
impl<T: Real> fmt::Display for Alert<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.shown_in(PressureUnit::Kpa).fmt(f)
    }
}

impl<T: Real> fmt::Display for AlertIn<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { alert, unit } = *self;
        let wheels = alert.wheels;
        match &alert.cause {
            Cause::UnderInflated(reading) => {
                write!(f, "{wheels} under-inflated: ")?;
                reading.write(f, unit)?;
            }
            Cause::FastLeak { reading, rate_kpa_per_min } => {
                let lost_kpa = reading.lost_within_half_a_minute_kpa(*rate_kpa_per_min);
                let [lost, pressure, sd, reference] =
                    [lost_kpa, reading.pressure_kpa, reading.sd_kpa, reading.reference_kpa]
                        .map(|kpa| unit.number(kpa.to_f64(), 0));
                // It is the loss that counts, whatever the level.
                write!(f, "{wheels} fast leak: lost up to {lost} {unit} within half a minute, ")?;
                write!(f, "now {pressure} {unit} (sd {sd}) of {reference}")?;
            }
            Cause::AllLow { mean_share, sd_share, .. } => {
                let [mean, sd] = [mean_share, sd_share].map(|share| 100.0 * share.to_f64());
                write!(f, "all wheels low: at {mean:.0} % (sd {sd:.0}) of their reference")?;
            }
            Cause::CommonShift { mean_share, sd_share } => {
                let [mean, sd] = [mean_share, sd_share].map(|share| 100.0 * share.to_f64());
                let all = if mean < 100.0 { "under" } else { "over" };
                write!(
                    f,
                    "{wheels}: the tires together read {mean:.0} % (sd {sd:.0}) of what the stored calibration expects: changed tires, "
                )?;
                write!(
                    f,
                    "wheels or dampers, or all of them {all}-inflated; check the pressures, then calibrate again"
                )?;
            }
            Cause::OverInflated(reading) => {
                write!(f, "{wheels} over-inflated: ")?;
                reading.write(f, unit)?;
            }
            Cause::Flat(reading) => {
                let share = (reading.pressure_kpa / reading.reference_kpa).to_f64();
                write!(
                    f,
                    "{wheels} flat: on its rim, or else inflated to {share:.1} times what it should have; stop and look"
                )?;
            }
            Cause::Differs { lost_share, lost_sd_share, is_known, .. } => {
                let [lost, sd] = [lost_share, lost_sd_share].map(|share| 100.0 * share.to_f64());
                match (is_known, wheels.iter().count()) {
                    (true, 4) => write!(
                        f,
                        "all four tires have lost air since the calibration, up to {lost:.0} % (sd {sd:.0}) of their pressure"
                    )?,
                    (true, 1) => write!(f, "{} differs from the other tires since the calibration", wheels)?,
                    (true, _) => write!(f, "{} differ from the other tires since the calibration", wheels)?,
                    (false, 4) => {
                        write!(f, "one of the tires differs from the others since the calibration")?
                    }
                    (false, _) => {
                        write!(f, "one of {} differs from the other tires since the calibration", wheels)?;
                    }
                }
                if *is_known && wheels.iter().count() < 4 {
                    let which = if wheels.iter().count() == 1 { "it" } else { "the lowest" };
                    write!(f, ": {which} turns as with {lost:.0} % (sd {sd:.0}) of its pressure lost")?;
                }
                write!(f, ", by the wheel speeds")?;
            }
            Cause::SlowLeak(leak) => write!(f, "{wheels} slow leak: {leak}")?,
            Cause::Malfunction(malfunction) => write!(f, "malfunction: {malfunction}")?,
            Cause::NoInformation { driven_s } => {
                write!(f, "{wheels}: nothing learned in {:.0} min of driving", driven_s / 60.0)?;
            }
        }
        write!(f, "; since {:.1} s, reported at {:.1} s", alert.since_s, alert.reported_s)
    }
}
