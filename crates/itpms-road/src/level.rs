//! How rough the road is (docs/math/road.md, eq. 9, 10): the level at wheel hop from the power of the wheel's
//! acceleration, drawn out to long waves with the slope that the recorded road shows.
//!
//! Called by [`crate::filter`] with every wheel acceleration and height. The first part does not depend on the
//! filter's own estimate, and the second only ever raises the level, so that a level too low cannot confirm itself.
use itpms_core::Real;

/// Memory of the power in s: long enough for 20 % in the level, short enough for a change of surface.
const MEMORY_S: f64 = 2.0;
/// Cutoff in Hz that takes gravity and the sensor's offset away, well below wheel hop.
const HIGH_PASS_HZ: f64 = 1.0;
/// Until then the start value holds: the high-pass has not settled.
const SETTLE_S: f64 = 0.3;
/// Lowest level: a very smooth road at a walking pace. Below, nothing can be seen of a road anyway.
const LOWEST: f64 = -16.0;
/// Highest level: far worse than ISO 8608's class H at motorway speed.
const HIGHEST: f64 = 2.0;

/// Corner in Hz above which the height's power is taken.
const SLOW_HIGH_PASS_HZ: f64 = 0.3;
const SLOW_MEMORY_S: f64 = 20.0;
/// The level matters where noise and road are alike, near 0.07 Hz, the height's power sits near 0.4 Hz and the
/// wheel's near 10: `ln(10/0.07) / ln(10/0.4)` draws a power law out.
const DRAWN_OUT: f64 = 1.5;
/// A waviness of 3 between 10 and 0.07 Hz, no more.
const STEEPEST: f64 = 5.0;

/// Running power of the wheel's acceleration, and the road level it means.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct LevelTracker<T> {
    mean: T,
    power: T,
    weight: T,
    seen_s: T,
    log_level: T,
    slow: SlowPower<T>,
}

/// Power of the height above [`SLOW_HIGH_PASS_HZ`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct SlowPower<T> {
    mean: T,
    power: T,
    weight: T,
}

impl<T: Real> LevelTracker<T> {
    pub(crate) fn new(log_level: T) -> Self {
        let zero = T::zero();
        Self { mean: zero, power: zero, weight: zero, seen_s: zero, log_level, slow: SlowPower::nothing() }
    }

    /// The level `c` at long waves: natural logarithm of (m/s)²/Hz.
    pub(crate) fn log_level(&self) -> T {
        if !(self.slow.weight > T::lit(0.1)) {
            return self.log_level;
        }
        // A random walk of density e^c behind a first-order high-pass: variance e^c / (8 pi f).
        let density = self.slow.power / self.slow.weight * T::lit(8.0 * SLOW_HIGH_PASS_HZ) * T::pi();
        let steeper = (density.max(T::lit(1e-12)).ln() - self.log_level) * T::lit(DRAWN_OUT);
        self.log_level + steeper.max(T::zero()).min(T::lit(STEEPEST))
    }

    /// One more height in m of the filter, without its slow part.
    pub(crate) fn update_slow(&mut self, road_m: T, step_s: T) {
        let step_s = step_s.min(T::lit(0.1));
        let slow = &mut self.slow;
        slow.mean += step_s * T::lit(SLOW_HIGH_PASS_HZ) * T::two_pi() * (road_m - slow.mean);
        let forget = step_s / T::lit(SLOW_MEMORY_S);
        let fluctuation = road_m - slow.mean;
        slow.power += forget * (fluctuation * fluctuation - slow.power);
        slow.weight += forget * (T::one() - slow.weight);
    }

    /// Heights begin anew.
    pub(crate) fn forget_slow(&mut self) {
        self.slow = SlowPower::nothing();
    }

    /// One more wheel acceleration, `step_s` after the last; `power_per_intensity` from [`crate::model::Model::wheel_power_per_intensity`].
    pub(crate) fn update(
        &mut self,
        wheel_accel_m_s2: T,
        step_s: T,
        noise_variance: T,
        power_per_intensity: T,
    ) {
        let step_s = step_s.min(T::lit(0.1));
        if !(self.seen_s > T::zero()) {
            self.mean = wheel_accel_m_s2;
        }
        self.seen_s += step_s;
        let high_pass = step_s * T::lit(HIGH_PASS_HZ) * T::two_pi();
        self.mean += high_pass.min(T::one()) * (wheel_accel_m_s2 - self.mean);
        if !(self.seen_s > T::lit(SETTLE_S)) {
            return;
        }
        let fluctuation = wheel_accel_m_s2 - self.mean;
        let forget = step_s / T::lit(MEMORY_S);
        self.power += forget * (fluctuation * fluctuation - self.power);
        // Dividing by the weight collected so far makes the young mean unbiased.
        self.weight += forget * (T::one() - self.weight);
        let road_power = self.power / self.weight - noise_variance;
        // One-sided density 2 q = e^c.
        let density = T::lit(2.0) * road_power / power_per_intensity;
        let lowest = T::lit(LOWEST);
        self.log_level = if density > lowest.exp() { density.ln().min(T::lit(HIGHEST)) } else { lowest };
    }
}

impl<T: Real> SlowPower<T> {
    fn nothing() -> Self {
        Self { mean: T::zero(), power: T::zero(), weight: T::zero() }
    }
}
