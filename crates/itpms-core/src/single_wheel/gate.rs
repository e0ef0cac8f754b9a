//! How much of a frame to believe: nothing while the road is hidden in sensor noise, less when a frame is an event
//! such as a pothole that no stationary road explains (docs/math/informed.md, section 5).

use crate::memory::Blank;
use crate::model::HOP_BAND_HZ;
use crate::real::Real;
use crate::single_wheel::road_model::{Evidence, Road};
use crate::single_wheel::tables::Tables;

/// Power over expected power above which a frame counts as an event, and counts less.
const EVENT: f64 = 3.0;
/// Road power over noise power at which learning starts; at twice this all of a frame counts.
const SIGNAL_TO_NOISE: f64 = 2.5;
/// Share of the newest frame in the smoothed signal-to-noise ratio.
const SMOOTHING: f64 = 0.3;
/// The same while the speed is unknown: a car that rolls to a halt unseen must not be read from its last creeping.
const SIGNAL_TO_NOISE_BLIND: f64 = 12.0;
/// Factor between quick and slow mean power at which a drive of unknown speed counts as pulling away or braking, and
/// the share of the newest frame in either mean.
const CHANGE_BLIND: f64 = 3.0;
const QUICK: f64 = 0.12;
const SLOW: f64 = 0.006;
/// Velocity power in (m/s)²/Hz beyond any road: ISO 8608 class H at 70 km/h reaches two at 10 Hz.
const NO_ROAD: f64 = 3.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SpeedKnowledge {
    Known,
    Unknown,
}

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Gate<T> {
    signal_to_noise: T,
    /// Mean log power of the last half second and the last ten seconds.
    quick_log_power: T,
    slow_log_power: T,
    /// False until the first frame.
    running: bool,
    nis: T,
    open: T,
}

impl<T: Real> Gate<T> {
    pub(crate) fn new() -> Self {
        let one = T::one();
        Self { signal_to_noise: one, nis: one, ..Self::BLANK }
    }

    /// Judges a frame from the most likely cell and the road believed there.
    pub(crate) fn look(
        &mut self,
        frame: &Evidence<T>,
        tables: &Tables<T>,
        cell: usize,
        road: &Road<T>,
        speed: SpeedKnowledge,
    ) {
        let (reading, expected) = (frame.read(tables, cell), road.powers(frame, tables));
        let (mut ratio, mut hop_bins) = (T::zero(), T::zero());
        let (mut nis, mut largest) = (T::zero(), T::zero());
        for (bin, &road) in expected.iter().enumerate().take(frame.bins) {
            let (power, noise) = (reading.power[bin], reading.expected.noise[bin]);
            largest = largest.max(power);
            if tables.frequency_squared[bin] <= T::lit(HOP_BAND_HZ[1] * HOP_BAND_HZ[1]) {
                ratio += power / noise;
                hop_bins += T::one();
            }
            nis += power / (road + noise);
        }
        self.nis = nis / T::lit(frame.bins as f64);
        self.signal_to_noise += T::lit(SMOOTHING) * (ratio / hop_bins - self.signal_to_noise);
        let needed = match speed {
            SpeedKnowledge::Known => SIGNAL_TO_NOISE,
            SpeedKnowledge::Unknown => SIGNAL_TO_NOISE_BLIND,
        };
        self.open = (self.signal_to_noise / T::lit(needed) - T::one()).clamp(T::zero(), T::one());
        let steady = self.is_steady((ratio / hop_bins).max(T::lit(1e-6)).ln());
        if !(largest < T::lit(NO_ROAD)) || (speed == SpeedKnowledge::Unknown && !steady) {
            self.open = T::zero();
        }
        if self.nis > T::lit(EVENT) {
            let share = T::lit(EVENT) / self.nis;
            self.open *= share * share;
        }
        if !(self.open.is_finite() && self.nis.is_finite()) {
            *self = Self::new();
        }
    }

    /// Whether the power of late is what it was before; takes the newest log power.
    fn is_steady(&mut self, log_power: T) -> bool {
        if !self.running {
            self.running = true;
            self.quick_log_power = log_power;
            self.slow_log_power = log_power;
        }
        self.quick_log_power += T::lit(QUICK) * (log_power - self.quick_log_power);
        self.slow_log_power += T::lit(SLOW) * (log_power - self.slow_log_power);
        (self.quick_log_power - self.slow_log_power).abs() < T::lit(CHANGE_BLIND).ln()
    }

    /// Nothing of the last frame counts.
    pub(crate) fn close(&mut self) {
        self.open = T::zero();
    }

    /// Share of the last frame that counts, 0 to 1.
    pub(crate) fn open(&self) -> T {
        self.open
    }

    /// Mean power over expected power of the last frame.
    pub(crate) fn nis(&self) -> T {
        self.nis
    }
}
