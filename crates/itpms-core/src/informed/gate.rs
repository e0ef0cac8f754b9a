//! How much of a frame to believe: nothing while the road is hidden in sensor noise, less when a frame is an event
//! such as a pothole that no stationary road explains (docs/math/informed.md, section 5).

use super::model::Tables;
use super::road_belief::{Evidence, Road};
use crate::real::Real;

/// Power over expected power above which a frame counts as an event, and counts less.
const EVENT: f64 = 3.0;
/// Road power over noise power at which learning starts; at twice this all of a frame counts.
const SIGNAL_TO_NOISE: f64 = 2.5;
/// Share of the newest frame in the smoothed signal-to-noise ratio.
const SMOOTHING: f64 = 0.3;
/// Highest frequency in Hz of that ratio: where wheel hop lives.
const HOP_BAND_HZ: f64 = 20.0;

/// The gate's memory and its last verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Gate<T> {
    signal_to_noise: T,
    surprise: T,
    open: T,
}

impl<T: Real> Gate<T> {
    pub(super) fn new() -> Self {
        Self { signal_to_noise: T::one(), surprise: T::one(), open: T::zero() }
    }

    /// Judges a frame from the most likely cell and the road believed there.
    pub(super) fn look(&mut self, frame: &Evidence<T>, tables: &Tables<T>, cell: usize, road: &Road<T>) {
        let theta = tables.theta[cell];
        let (mut ratio, mut hop_bins) = (T::zero(), T::zero());
        let mut surprise = T::zero();
        for bin in 0..frame.bins {
            let power = frame.power(bin, theta);
            let noise = frame.noise_density * tables.noise[(bin, cell)];
            if tables.frequency_squared[bin] <= T::lit(HOP_BAND_HZ * HOP_BAND_HZ) {
                ratio += power / noise;
                hop_bins += T::one();
            }
            surprise += power / (road.log_power(tables, frame, bin).exp() + noise);
        }
        self.surprise = surprise / T::lit(frame.bins as f64);
        self.signal_to_noise += T::lit(SMOOTHING) * (ratio / hop_bins - self.signal_to_noise);
        self.open = (self.signal_to_noise / T::lit(SIGNAL_TO_NOISE) - T::one()).clamp(T::zero(), T::one());
        if self.surprise > T::lit(EVENT) {
            self.open *= T::lit(EVENT) / self.surprise;
        }
        if !(self.open.is_finite() && self.surprise.is_finite()) {
            *self = Self::new();
        }
    }

    /// Nothing of the last frame counts.
    pub(super) fn close(&mut self) {
        self.open = T::zero();
    }

    /// Share of the last frame that counts, 0 to 1.
    pub(super) fn open(&self) -> T {
        self.open
    }

    /// Mean power over expected power of the last frame.
    pub(super) fn surprise(&self) -> T {
        self.surprise
    }
}
