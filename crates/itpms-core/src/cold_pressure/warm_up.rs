//! By how much a tire is warmer than the air: a first-order lag behind speed and air, and all that is not known of it.

use crate::conditioning::STANDING_M_S;
use crate::memory::Blank;
use crate::real::Real;

/// Rise in K per m/s in the long run: 22 K at 100 km/h. Flexing heats in proportion to the way, and the air that cools hardly goes by faster.
const RISE_K_PER_M_S: f64 = 22.0 * 3.6 / 100.0;
/// Standard deviation between tires, loads and roads, as a share, of this rise and of the time constants.
const TIRES_SD: f64 = 0.3;
/// Time constants in s with which a tire follows while it rolls and while it stands or crawls.
const ROLLING_S: f64 = 660.0;
pub(crate) const STANDING_S: f64 = 1800.0;
/// Standard deviation in K of a tire's temperature against the air's at the start: it may have been driven before, or have stood in a garage.
const HISTORY_SD_K: f64 = 6.0;
/// The same in K of the air's temperature: the sensor is in the warmth of engine and road.
const AMBIENT_SD_K: f64 = 1.5;
/// Substitute for an unknown speed in m/s, and its standard deviation.
const UNKNOWN_M_S: f64 = 14.0;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct WarmUp<T> {
    /// Warmth by rolling.
    driven_k: T,
    /// The air's temperature in degrees Celsius as the tire has taken it on; NaN before one is known.
    soaked_c: T,
    /// Derivative of the tire's temperature by the logarithm of the time constant.
    lag_k: T,
    /// Standard deviations: of the time before the start, and of unknown speeds.
    history_k: T,
    unknown_k: T,
}

impl<T: Real> WarmUp<T> {
    /// A tire of which nothing is known but that it is hardly warmer than the air.
    pub(super) fn new() -> Self {
        Self { soaked_c: T::lit(f64::NAN), history_k: T::lit(HISTORY_SD_K), ..Self::BLANK }
    }

    /// So many seconds at this speed in m/s (NaN: unknown), in air of this temperature in degrees Celsius. Exact for a speed and a
    /// temperature that stay.
    pub(super) fn advance(&mut self, step_s: f64, speed_m_s: T, ambient_c: Option<T>) {
        let known = speed_m_s.is_finite();
        let speed_m_s = if known { speed_m_s.abs() } else { T::lit(UNKNOWN_M_S) };
        let lag_s = if speed_m_s < T::lit(STANDING_M_S) { STANDING_S } else { ROLLING_S };
        let steps = T::lit(step_s / lag_s);
        let kept = (-steps).exp_fast();
        let taken = T::one() - kept;
        let behind_k = T::lit(RISE_K_PER_M_S) * speed_m_s - self.driven_k;
        let mut all_behind_k = behind_k;
        self.driven_k += taken * behind_k;
        if let Some(ambient_c) = ambient_c {
            if self.soaked_c.is_finite() {
                let behind_c = ambient_c - self.soaked_c;
                all_behind_k += behind_c;
                self.soaked_c += taken * behind_c;
            } else {
                self.soaked_c = ambient_c;
            }
        }
        self.lag_k = kept * (self.lag_k - steps * all_behind_k);
        self.history_k *= kept;
        let unknown_k = if known { T::zero() } else { T::lit(RISE_K_PER_M_S * UNKNOWN_M_S) };
        self.unknown_k += taken * (unknown_k - self.unknown_k);
    }

    /// By how much the tire is warmer than air of this temperature in degrees Celsius, and its standard deviation.
    pub(super) fn excess_k(&self, ambient_c: T) -> [T; 2] {
        let lag_of_air_k = if self.soaked_c.is_finite() { self.soaked_c - ambient_c } else { T::zero() };
        let square = |value: T| value * value;
        let variance = square(T::lit(TIRES_SD) * self.driven_k)
            + square(T::lit(TIRES_SD) * self.lag_k)
            + square(self.history_k)
            + square(self.unknown_k)
            + T::lit(AMBIENT_SD_K * AMBIENT_SD_K);
        [self.driven_k + lag_of_air_k, variance.sqrt()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tire after so many steps of 0.1 s.
    fn after(steps: u32, speed_m_s: f64, ambient_c: f64) -> WarmUp<f64> {
        let mut warm_up = WarmUp::new();
        (0..steps).for_each(|_| warm_up.advance(0.1, speed_m_s, Some(ambient_c)));
        warm_up
    }

    #[test]
    fn a_tire_warms_up_by_the_closed_form() {
        let speed_m_s = 100.0 / 3.6;
        for minutes in [1.0, 11.0, 60.0] {
            let x: f64 = minutes * 60.0 / ROLLING_S;
            let [excess_k, sd_k] = after((600.0 * minutes) as u32, speed_m_s, 10.0).excess_k(10.0);
            let expected_k = 22.0 * (1.0 - (-x).exp());
            let lag_k = TIRES_SD * 22.0 * x * (-x).exp();
            let parts = [TIRES_SD * expected_k, lag_k, HISTORY_SD_K * (-x).exp(), AMBIENT_SD_K];
            let expected_sd_k = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
            assert!((excess_k - expected_k).abs() < 1e-6, "{minutes}: {excess_k} {expected_k}");
            assert!((sd_k - expected_sd_k).abs() < 2e-3, "{minutes}: {sd_k} {expected_sd_k}");
            // One long step equals many short ones, within the error of the lag's discretization.
            let mut at_once = WarmUp::new();
            at_once.advance(0.1, speed_m_s, Some(10.0));
            at_once.advance(minutes * 60.0 - 0.1, speed_m_s, Some(10.0));
            assert!((at_once.excess_k(10.0)[0] - excess_k).abs() < 1e-6);
        }
    }

    #[test]
    fn what_was_before_the_start_is_forgotten() {
        let sds = [0, 60, 600, 3600].map(|seconds| after(10 * seconds, 5.0, 10.0).excess_k(10.0)[1]);
        assert!(sds.windows(2).all(|pair| pair[1] < pair[0]), "{sds:?}");
        assert!((sds[0] - (HISTORY_SD_K * HISTORY_SD_K + AMBIENT_SD_K * AMBIENT_SD_K).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn a_tire_follows_the_air_slowly() {
        let mut warm_up = after(36_000, 20.0, 10.0);
        // Through a tunnel: the air is 8 K warmer at once, the tire is not.
        let [before_k, _] = warm_up.excess_k(10.0);
        assert!((warm_up.excess_k(18.0)[0] - (before_k - 8.0)).abs() < 1e-9);
        (0..36_000).for_each(|_| warm_up.advance(0.1, 20.0, Some(18.0)));
        assert!((warm_up.excess_k(18.0)[0] - before_k).abs() < 0.1);
    }

    #[test]
    fn an_unknown_speed_is_a_guess_that_is_less_sure() {
        let [known, unknown] = [14.0, f64::NAN].map(|speed| after(36_000, speed, 10.0).excess_k(10.0));
        assert!((known[0] - unknown[0]).abs() < 1e-9 && unknown[1] > 2.0 * known[1], "{known:?} {unknown:?}");
    }
}
