//! When to tell the driver: a low tire, said only when it is certain and has been for a while, taken back only when
//! it is clearly over; and sensors that allow no statement.

use crate::memory::blank;
use crate::model::{Validity, Warning};
use crate::real::Real;
use crate::warning::ONE_SIDED_95;

/// A tire is low below this share of the placard pressure, six tenths of the way to the 20 % loss that UN R141 asks for.
const LOW: f64 = 0.88;
/// It is fine again above this share.
const FINE: f64 = 0.92;
/// Seconds that a tire must be low before it is said, and fine before it is taken back.
const LOW_FOR_S: f64 = 2.0;
const FINE_FOR_S: f64 = 10.0;
/// Seconds without a usable signal before that is said.
const MALFUNCTION_FOR_S: f64 = 2.0;

/// Remembers since when a tire has been low, fine, or without signal.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct LowPressureWatch {
    low: bool,
    low_since_s: Option<f64>,
    fine_since_s: Option<f64>,
    bad_since_s: Option<f64>,
}

blank!(LowPressureWatch { low, low_since_s, fine_since_s, bad_since_s });

impl LowPressureWatch {
    pub(crate) fn new() -> Self {
        Self { low: false, low_since_s: None, fine_since_s: None, bad_since_s: None }
    }

    /// Takes the newest estimate, gives the warning that now stands.
    pub(crate) fn update<T: Real>(
        &mut self,
        time_s: f64,
        validity: Validity,
        pressure_kpa: T,
        pressure_sd_kpa: T,
        placard_kpa: T,
    ) -> Warning {
        let margin = T::lit(ONE_SIDED_95) * pressure_sd_kpa;
        let low = validity.is_valid() && pressure_kpa + margin < T::lit(LOW) * placard_kpa;
        let fine = validity.is_valid() && pressure_kpa - margin > T::lit(LOW) * placard_kpa
            || validity.is_valid() && pressure_kpa > T::lit(FINE) * placard_kpa;
        if held(&mut self.low_since_s, low, time_s, LOW_FOR_S) {
            self.low = true;
        }
        if held(&mut self.fine_since_s, fine, time_s, FINE_FOR_S) {
            self.low = false;
        }
        let bad = matches!(validity, Validity::BadSignal | Validity::Diverged);
        if held(&mut self.bad_since_s, bad, time_s, MALFUNCTION_FOR_S) {
            Warning::Malfunction
        } else if self.low {
            Warning::Low
        } else {
            Warning::None
        }
    }
}

/// True once `condition` has held for `prefailed_s`.
fn held(since_s: &mut Option<f64>, condition: bool, time_s: f64, prefailed_s: f64) -> bool {
    if !condition {
        *since_s = None;
        return false;
    }
    time_s - *since_s.get_or_insert(time_s) >= prefailed_s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feeds (pressure, sd) for ten steps a second.
    fn run(watch: &mut LowPressureWatch, from_s: f64, seconds: f64, pressure: f64, sd: f64) -> Warning {
        let mut last = Warning::None;
        for i in 0..(seconds * 10.0) as u32 {
            let time_s = from_s + f64::from(i) * 0.1;
            last = watch.update(time_s, Validity::Valid, pressure, sd, 241.3);
        }
        last
    }

    #[test]
    fn a_low_tire_is_said_after_two_seconds_and_kept_through_a_doubtful_spell() {
        let mut watch = LowPressureWatch::new();
        assert_eq!(run(&mut watch, 0.0, 1.9, 180.0, 8.0), Warning::None);
        assert_eq!(run(&mut watch, 1.9, 1.0, 180.0, 8.0), Warning::Low);
        assert_eq!(run(&mut watch, 3.0, 60.0, 205.0, 15.0), Warning::Low);
        assert_eq!(run(&mut watch, 63.0, 9.0, 240.0, 8.0), Warning::Low);
        assert_eq!(run(&mut watch, 72.0, 3.0, 240.0, 8.0), Warning::None);
    }

    #[test]
    fn an_uncertain_low_reading_is_not_said() {
        let mut watch = LowPressureWatch::new();
        // 180 + 1.64 * 25 = 221 kPa is above 0.88 * 241.3 = 212 kPa.
        assert_eq!(run(&mut watch, 0.0, 60.0, 180.0, 25.0), Warning::None);
    }

    #[test]
    fn a_lost_signal_is_said_and_taken_back() {
        let mut watch = LowPressureWatch::new();
        let at = |watch: &mut LowPressureWatch, t, validity| watch.update(t, validity, 240.0, 8.0, 241.3);
        assert_eq!(at(&mut watch, 0.0, Validity::BadSignal), Warning::None);
        assert_eq!(at(&mut watch, 2.5, Validity::BadSignal), Warning::Malfunction);
        assert_eq!(at(&mut watch, 2.6, Validity::Valid), Warning::None);
        assert_eq!(at(&mut watch, f64::NAN, Validity::BadSignal), Warning::None);
    }
}
