//! The one clock and the one speed of whoever takes samples.

use super::SpeedHold;
use super::clock::SteadyClock;
use crate::memory::Blank;
use crate::model::{ParameterError, positive};
use crate::real::Real;

/// Rates in Hz of samples that an estimator is for, 100 Hz to 2 kHz by a clock that is wrong by a twentieth: slower ones do not show how a
/// wheel hops.
pub const SAMPLE_RATES_HZ: core::ops::RangeInclusive<f64> = 95.0..=2100.0;

/// Makes of the samples' stamps a time that only goes forward, and of their speeds one to go by.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SampleClock<T> {
    clock: SteadyClock,
    speed: SpeedHold<T>,
}

/// Time and speed of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment<T> {
    /// Steady time in s, from the first stamp on; `None`: the stamp is not to be used.
    pub time_s: Option<f64>,
    /// Steady time in s of the last sample whose stamp was believed; minus infinity before the first.
    pub now_s: f64,
    /// The latest that the steady time may be, in s, whether the stamp was believed or not; infinite if unknown.
    pub latest_s: f64,
    /// Offset of the steady time from the stamps in s.
    pub ahead_s: f64,
    /// Speed to go by in m/s: a missing one is the last one, for half a second ([`SpeedHold`]); NaN: unknown.
    pub speed_m_s: T,
}

/// A rate of samples that an estimator is for: one of [`SAMPLE_RATES_HZ`].
pub(crate) fn estimators_rate(sample_rate_hz: f64) -> Result<f64, ParameterError> {
    match SAMPLE_RATES_HZ.contains(&sample_rate_hz) {
        true => Ok(sample_rate_hz),
        false => {
            Err(ParameterError { name: "sample_rate_hz", value: sample_rate_hz, expected: "100 to 2000 Hz" })
        }
    }
}

impl<T: Real> SampleClock<T> {
    /// A clock for samples that come at about `sample_rate_hz`.
    ///
    /// # Errors
    /// The rate must be positive and finite.
    pub fn new(sample_rate_hz: f64) -> Result<Self, ParameterError> {
        let sample_rate_hz = positive("sample_rate_hz", sample_rate_hz)?;
        Ok(Self { clock: SteadyClock::new(sample_rate_hz), speed: SpeedHold::new() })
    }

    /// Takes a sample's stamp in s and its speed in m/s, NaN when it has none.
    pub fn take(&mut self, stamp_s: f64, speed_m_s: T) -> Moment<T> {
        let time_s = self.clock.take(stamp_s);
        Moment {
            time_s,
            now_s: self.clock.now_s(),
            latest_s: self.clock.at_latest_s(stamp_s),
            ahead_s: self.clock.ahead_s(),
            speed_m_s: time_s.map_or(T::lit(f64::NAN), |time_s| self.speed.take(time_s, speed_m_s)),
        }
    }
}
