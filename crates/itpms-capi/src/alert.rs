//! What the monitor says, with the numbers that decided, and as a sentence.

use core::fmt::{self, Write as _};

use itpms_core::diagnosis::{Malfunction, Place, Sensor};
use itpms_core::model::Wheels;
use itpms_core::warning::{Alert, Basis, Cause, Change, Reading};

use crate::itpms_real;

/// Why an alert stands.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_cause {
    /// The pressure is certainly below the limit.
    UnderInflated = 0,
    /// The pressure falls fast against that of the other wheels.
    FastLeak = 1,
    /// All wheels together are low.
    AllLow = 2,
    /// All wheels together read otherwise than a calibration of an earlier day.
    CommonShift = 3,
    /// The pressure is certainly above the limit.
    OverInflated = 4,
    /// Flat, on its rim.
    Flat = 5,
    /// A sensor or its wiring.
    Malfunction = 6,
    /// By the wheel speeds: it rolls on a smaller radius than the others since the calibration.
    Differs = 7,
    /// Nothing could be learned for too long a time of driving.
    NoInformation = 8,
    /// By the wheel speeds of several days: it has lost air slowly since the calibration.
    SlowLeak = 9,
}

/// What is wrong with sensors.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_malfunction {
    /// Nothing: the alert is about a tire.
    None = 0,
    /// It repeats one value.
    Stuck = 1,
    /// Too many of its samples are missing.
    Dropout = 2,
    /// Single samples far from their neighbors.
    Spikes = 3,
    /// Noisier than the same sensors at the other corners.
    Noise = 4,
    /// It reads too much or too little: `gain` times the truth.
    Gain = 5,
    /// Two sensors carry each other's name.
    Swapped = 6,
    /// Left and right of one axle carry each other's name; of which is unknown.
    SwappedSides = 7,
    /// Front and rear of one side carry each other's name; of which is unknown.
    SwappedAxles = 8,
    /// The corner's signals do not fit each other or the rest of the car.
    Inconsistent = 9,
}

/// What a pressure was held against.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_basis {
    /// Against its level as the configuration has it.
    Config = 0,
    /// Against what a calibration has set.
    Calibration = 1,
    /// Against the other tires.
    OtherTires = 2,
}

/// Something the driver or the workshop should know. Numbers that its cause does not have are NaN.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_alert {
    /// Since when it has been so, in s by the samples' clock, as far as is known.
    pub since_s: f64,
    /// When it was first reported, in s by the same clock.
    pub reported_s: f64,
    /// Of NO_INFORMATION: the time of driving in s.
    pub driven_s: f64,
    /// The wheels it is about: bit 0 front left, 1 front right, 2 rear left, 3 rear right.
    pub wheels: u32,
    /// An `itpms_cause`.
    pub cause: u32,
    /// An `itpms_basis`, of an alert with a pressure.
    pub basis: u32,
    /// An `itpms_malfunction`.
    pub malfunction: u32,
    /// The sensors with the malfunction: bits 0 to 3 the body's, 4 to 7 the wheels', 8 to 11 the wheel speeds'.
    pub sensors: u32,
    /// Of DIFFERS: 1 if all of `wheels` differ; 0 if one of them or more does, and which is not known.
    pub wheels_are_known: u32,
    /// The pressure that decided, in kPa gauge.
    pub pressure_kpa: itpms_real,
    /// Its standard deviation in kPa.
    pub pressure_sd_kpa: itpms_real,
    /// The limit that it has passed, in kPa.
    pub limit_kpa: itpms_real,
    /// What it should be, in kPa.
    pub reference_kpa: itpms_real,
    /// Of FAST_LEAK: how fast it fell at most, in kPa per minute.
    pub rate_kpa_per_min: itpms_real,
    /// Of ALL_LOW and COMMON_SHIFT: mean of pressure over reference. Of DIFFERS and SLOW_LEAK: the share of its pressure that the tire has lost.
    pub share: itpms_real,
    /// The standard deviation of `share`.
    pub share_sd: itpms_real,
    /// Of GAIN: reading over truth.
    pub gain: itpms_real,
    /// How probable it is, of what says that tires have too little air; NaN of FLAT.
    pub probability: itpms_real,
}

/// What began or ended.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_event {
    /// 1: the alert was raised; 0: it was taken back.
    pub has_begun: u32,
    /// The alert, as it stands or stood at the end.
    pub alert: itpms_alert,
}

/// A set of wheels as bits.
pub(crate) fn bits(wheels: Wheels) -> u32 {
    wheels.iter().fold(0, |bits, corner| bits | 1 << corner.index())
}

impl From<&Alert<itpms_real>> for itpms_alert {
    fn from(alert: &Alert<itpms_real>) -> Self {
        let nan = itpms_real::NAN;
        let mut alert_out = Self {
            since_s: alert.since_s,
            reported_s: alert.reported_s,
            driven_s: f64::NAN,
            wheels: bits(alert.wheels),
            cause: cause(&alert.cause) as u32,
            basis: itpms_basis::Config as u32,
            malfunction: itpms_malfunction::None as u32,
            sensors: 0,
            wheels_are_known: 1,
            pressure_kpa: nan,
            pressure_sd_kpa: nan,
            limit_kpa: nan,
            reference_kpa: nan,
            rate_kpa_per_min: nan,
            share: nan,
            share_sd: nan,
            gain: nan,
            probability: nan,
        };
        match &alert.cause {
            Cause::UnderInflated(reading) | Cause::OverInflated(reading) | Cause::Flat(reading) => {
                alert_out.put_reading(reading);
            }
            Cause::FastLeak { reading, rate_kpa_per_min } => {
                alert_out.put_reading(reading);
                alert_out.rate_kpa_per_min = *rate_kpa_per_min;
            }
            Cause::AllLow { mean_share, sd_share, probability } => {
                (alert_out.share, alert_out.share_sd) = (*mean_share, *sd_share);
                alert_out.probability = *probability;
            }
            Cause::CommonShift { mean_share, sd_share } => {
                (alert_out.share, alert_out.share_sd) = (*mean_share, *sd_share);
            }
            Cause::Differs { lost_share, lost_sd_share, is_known, probability } => {
                (alert_out.share, alert_out.share_sd) = (*lost_share, *lost_sd_share);
                alert_out.probability = *probability;
                alert_out.wheels_are_known = u32::from(*is_known);
            }
            Cause::SlowLeak(leak) => {
                (alert_out.share, alert_out.share_sd) = (leak.lost_share, leak.lost_sd_share);
                alert_out.probability = leak.probability;
            }
            Cause::Malfunction(malfunction) => alert_out.put_malfunction(malfunction),
            Cause::NoInformation { driven_s } => alert_out.driven_s = *driven_s,
        }
        alert_out
    }
}

impl From<&Change<itpms_real>> for itpms_event {
    fn from(change: &Change<itpms_real>) -> Self {
        match change {
            Change::Begun(alert) => Self { has_begun: 1, alert: alert.into() },
            Change::Ended(alert) => Self { has_begun: 0, alert: alert.into() },
        }
    }
}

impl itpms_alert {
    fn put_reading(&mut self, reading: &Reading<itpms_real>) {
        self.pressure_kpa = reading.pressure_kpa;
        self.pressure_sd_kpa = reading.sd_kpa;
        self.limit_kpa = reading.limit_kpa;
        self.reference_kpa = reading.reference_kpa;
        self.probability = reading.probability.unwrap_or(itpms_real::NAN);
        self.basis = match reading.basis {
            Basis::VehicleFile => itpms_basis::Config,
            Basis::Calibration => itpms_basis::Calibration,
            Basis::OtherTires => itpms_basis::OtherTires,
        } as u32;
    }

    fn put_malfunction(&mut self, malfunction: &Malfunction<itpms_real>) {
        let (kind, sensors) = match malfunction {
            Malfunction::Stuck(sensor) => (itpms_malfunction::Stuck, bit(sensor)),
            Malfunction::Dropout(sensor) => (itpms_malfunction::Dropout, bit(sensor)),
            Malfunction::Spikes(sensor) => (itpms_malfunction::Spikes, bit(sensor)),
            Malfunction::Noise(sensor) => (itpms_malfunction::Noise, bit(sensor)),
            Malfunction::Gain { sensor, gain } => {
                self.gain = *gain;
                (itpms_malfunction::Gain, bit(sensor))
            }
            Malfunction::Swapped(a, b) => (itpms_malfunction::Swapped, bit(a) | bit(b)),
            Malfunction::SwappedSides => (itpms_malfunction::SwappedSides, 0),
            Malfunction::SwappedAxles => (itpms_malfunction::SwappedAxles, 0),
            Malfunction::Inconsistent(_) => (itpms_malfunction::Inconsistent, 0),
        };
        (self.malfunction, self.sensors) = (kind as u32, sensors);
    }
}

fn bit(sensor: &Sensor) -> u32 {
    let row = match sensor.place {
        Place::Body => 0,
        Place::Wheel => 4,
        Place::WheelSpeed => 8,
    };
    1 << (row + sensor.corner.index())
}

fn cause(cause: &Cause<itpms_real>) -> itpms_cause {
    match cause {
        Cause::UnderInflated(_) => itpms_cause::UnderInflated,
        Cause::FastLeak { .. } => itpms_cause::FastLeak,
        Cause::AllLow { .. } => itpms_cause::AllLow,
        Cause::CommonShift { .. } => itpms_cause::CommonShift,
        Cause::OverInflated(_) => itpms_cause::OverInflated,
        Cause::Flat(_) => itpms_cause::Flat,
        Cause::Malfunction(_) => itpms_cause::Malfunction,
        Cause::Differs { .. } => itpms_cause::Differs,
        Cause::SlowLeak(_) => itpms_cause::SlowLeak,
        Cause::NoInformation { .. } => itpms_cause::NoInformation,
    }
}

/// Writes a text into bytes, as much as there is room for, and a zero behind it; gives how many bytes all of it takes with its zero.
pub(crate) fn write_text(place: &mut [u8], text: impl fmt::Display) -> usize {
    let mut into = Text { place, length: 0 };
    // What is too long is counted; nothing else can fail.
    let _ = write!(into, "{text}");
    let end = into.length.min(into.place.len().saturating_sub(1));
    if let Some(zero) = into.place.get_mut(end) {
        *zero = 0;
    }
    into.length + 1
}

struct Text<'a> {
    place: &'a mut [u8],
    length: usize,
}

impl fmt::Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let room = self.place.iter_mut().skip(self.length);
        room.zip(text.bytes()).for_each(|(place, byte)| *place = byte);
        self.length += text.len();
        Ok(())
    }
}
