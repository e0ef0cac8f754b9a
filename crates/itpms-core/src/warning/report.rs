//! Report of the monitor: a state per wheel, and alerts that name wheels, numbers, since when and why.
//!
//! Made by the monitor; read by displays, files and studies. Holds no logic beyond reading it.

use crate::conditioning::clock::stamp_s;
use crate::memory::{Blank, Placed};
use crate::model::{Corner, Validity, Warning};
use crate::real::Real;
use crate::warning::Alert;

const OF_A_WHEEL: usize = Slot::NoInformation as usize + 1;
/// The place of the alert for all wheels together, after those of each.
pub(crate) const ALL_LOW_SLOT: usize = 4 * OF_A_WHEEL;
/// The place of that of a shift of all of them since a calibration.
pub(crate) const COMMON_SHIFT_SLOT: usize = ALL_LOW_SLOT + 1;
/// The place of the wheel speeds' alert.
const WHEEL_SPEED_SLOT: usize = COMMON_SHIFT_SLOT + 1;
/// Alerts that can stand at once.
const SLOTS: usize = WHEEL_SPEED_SLOT + 1;

#[derive(Debug, Clone, Copy)]
pub(crate) enum Slot {
    Low,
    Leak,
    Over,
    Flat,
    Malfunction,
    NoInformation,
}

impl Slot {
    pub(crate) fn of(self, corner: Corner) -> usize {
        OF_A_WHEEL * corner.index() + self as usize
    }
}

/// State of a wheel, as a label.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum WheelState {
    /// Unknown, and why. Never to be shown as "all good".
    Unknown(Doubt),
    /// Known to be neither low nor overfull.
    Fine,
    /// Under-inflated, leaking fast, falling with all the others, or flat on its rim.
    Low,
    /// Over-inflated.
    Over,
    /// A sensor of this corner is not to be trusted, or has sent nothing for too long.
    Malfunction,
}

crate::labelled! {
    /// Why a wheel's state is unknown.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub enum Doubt {
        /// Not enough has been seen since the start, or since a malfunction ended.
        Starting = "starting",
        /// Nothing to learn from: standing still, too smooth, hidden in noise, or learned too long ago.
        NoInformation = "no-information",
        /// There is a pressure, but it could be low as well as not.
        Uncertain = "uncertain",
        /// A sensor looks wrong; not for long enough to say so.
        Suspicion = "suspicion",
        /// The car does not move as its vehicle file says.
        Misfit = "misfit",
        /// The car stands: what the tires had when it stopped is known, not what they have now.
        Standing = "standing",
    }
}

impl WheelState {
    /// One word, the same in tables, JSON, frames and on pages: `unknown`, `uncertain` where there is a pressure that could be low as well as
    /// not, `fine`, `low`, `over` or `malfunction`.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            WheelState::Unknown(Doubt::Uncertain) => "uncertain",
            WheelState::Unknown(_) => "unknown",
            WheelState::Fine => "fine",
            WheelState::Low => "low",
            WheelState::Over => "over",
            WheelState::Malfunction => "malfunction",
        }
    }
}

/// One wheel as it is to be shown.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelReport<T> {
    /// In one word.
    pub state: WheelState,
    /// Whether the pressure may be shown. The estimator's own word, unless a sensor is suspect or worse.
    pub validity: Validity,
    /// The three words of `est.csv`.
    pub warning: Warning,
    /// Gauge pressure in kPa; means something only while valid.
    pub pressure_kpa: T,
    /// Its standard deviation in kPa.
    pub pressure_sd_kpa: T,
    /// Reference pressure in kPa.
    pub reference_kpa: T,
    /// When something was last learned of this wheel, in s; minus infinity: never.
    pub informed_s: f64,
}

/// Everything the monitor has to say after a sample.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MonitorReport<T: Real> {
    /// Time in s; like all times here, by the samples' clock as it is now.
    pub time_s: f64,
    /// The wheels, in the order of [`Corner::ALL`]; those that are monitored.
    pub wheels: [Option<WheelReport<T>>; 4],
    slots: [Placed<Alert<T>>; SLOTS],
    /// By how much the steady time is ahead of that clock, in s.
    set_back_s: f64,
}

impl<T: Real> MonitorReport<T> {
    /// Nothing is reported.
    #[must_use]
    pub fn empty() -> Self {
        Self { time_s: f64::NEG_INFINITY, wheels: [None; 4], slots: [Placed::BLANK; SLOTS], set_back_s: 0.0 }
    }

    /// Begins to write anew: at a steady time, so much ahead of the stamps.
    pub(crate) fn begin(&mut self, steady_s: f64, set_back_s: f64) {
        self.time_s = stamp_s(steady_s, set_back_s);
        self.set_back_s = set_back_s;
    }

    /// Writes an alert, its times being steady ones.
    pub(crate) fn put(&mut self, slot: usize, alert: Option<Alert<T>>) {
        let set_back_s = self.set_back_s;
        let alert = alert.map(|alert| Alert {
            since_s: stamp_s(alert.since_s, set_back_s),
            reported_s: stamp_s(alert.reported_s, set_back_s),
            ..alert
        });
        // An alert keeps the figures that decided it.
        let Some(place) = self.slots.get_mut(slot) else { return };
        let before = place.get();
        let stands = before.zip(alert.as_ref()).is_some_and(|(before, alert)| {
            before.cause.is_of_a_tire() && before.is_same_as(alert, T::zero().to_f64())
        });
        if !stands {
            place.set(alert);
        }
    }

    /// Writes what wheel speeds say, its times being the samples' own.
    pub(crate) fn put_of_wheel_speeds(&mut self, alert: Option<Alert<T>>) {
        if let Some(place) = self.slots.get_mut(WHEEL_SPEED_SLOT) {
            place.set(alert);
        }
    }

    /// The alerts that stand, wheel by wheel.
    pub fn alerts(&self) -> impl Iterator<Item = &Alert<T>> {
        self.slots.iter().flatten()
    }

    /// The alerts that name this wheel.
    pub fn alerts_of(&self, corner: Corner) -> impl Iterator<Item = &Alert<T>> {
        self.alerts().filter(move |alert| alert.wheels.contains(corner))
    }

    /// True if every wheel is known to be fine: the only time to say "all good".
    pub fn is_all_fine(&self) -> bool {
        let mut wheels = self.wheels.iter().flatten().peekable();
        wheels.peek().is_some() && wheels.all(|wheel| wheel.state == WheelState::Fine)
    }

    /// Alerts that began, changed or ended since `before`, in a fixed order.
    pub fn changes_since<'a>(&'a self, before: &'a Self) -> impl Iterator<Item = Change<T>> + 'a {
        let set_back_s = self.set_back_s - before.set_back_s;
        // Most places are empty in both: what would be handed out of a place is not moved before it is known to differ.
        let differ =
            move |(old, new): &(&Placed<Alert<T>>, &Placed<Alert<T>>)| match (old.as_ref(), new.as_ref()) {
                (Some(old), Some(new)) => !old.is_same_as(new, set_back_s),
                (old, new) => old.is_some() || new.is_some(),
            };
        let changed = before.slots.iter().zip(&self.slots).filter(differ);
        changed.flat_map(|(old, new)| {
            old.get().map(Change::Ended).into_iter().chain(new.get().map(Change::Begun))
        })
    }
}

/// A transition.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Change<T> {
    /// An alert was raised.
    Begun(Alert<T>),
    /// An alert was taken back; as it stood at the end.
    Ended(Alert<T>),
}
