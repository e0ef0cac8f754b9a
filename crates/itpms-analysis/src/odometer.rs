//! How far the car has gone, where not every sample tells its speed. Called by reports, recorders of the road and the live monitor.

use itpms_core::conditioning::SpeedHold;

/// Longest step in s over which a way is counted: longer, and how far the car went is unknown.
const LONGEST_STEP_S: f64 = 10.0;

/// Counts the way by the trapezoidal rule, from the speeds that [`SpeedHold`] gives.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Odometer {
    speed: SpeedHold<f64>,
    time_s: f64,
    speed_m_s: f64,
    distance_m: f64,
}

impl Odometer {
    pub fn new() -> Self {
        Self { speed: SpeedHold::new(), time_s: f64::NAN, speed_m_s: f64::NAN, distance_m: f64::NAN }
    }

    /// Takes a sample's time in s and speed in m/s, NaN when it has none; gives the speed to go by, NaN when that is unknown.
    pub fn push(&mut self, time_s: f64, speed_m_s: f64) -> f64 {
        let speed_m_s = self.speed.take(time_s, speed_m_s);
        if speed_m_s.is_finite() && self.distance_m.is_nan() {
            self.distance_m = 0.0;
        }
        let (step_s, mean_m_s) = (time_s - self.time_s, 0.5 * (speed_m_s + self.speed_m_s));
        if step_s > 0.0 && step_s <= LONGEST_STEP_S && mean_m_s > 0.0 && mean_m_s.is_finite() {
            self.distance_m += mean_m_s * step_s;
        }
        (self.time_s, self.speed_m_s) = (time_s, speed_m_s);
        speed_m_s
    }

    /// The speed in m/s to go by, NaN when that is unknown.
    pub fn speed_m_s(&self) -> f64 {
        self.speed_m_s
    }

    /// The way in m so far, NaN while no speed was ever known.
    pub fn distance_m(&self) -> f64 {
        self.distance_m
    }
}

impl Default for Odometer {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_is_counted_where_the_speed_is_known() {
        let mut way = Odometer::new();
        assert!(way.push(0.0, f64::NAN).is_nan() && way.distance_m().is_nan());
        // 10 to 20 m/s within ten seconds are 150 m, however seldom the speed is sent.
        for tenths in 10..=110u32 {
            let time_s = 0.1 * f64::from(tenths);
            let is_sent = tenths.is_multiple_of(5);
            way.push(time_s, if is_sent { 9.0 + time_s } else { f64::NAN });
        }
        // A held speed is up to 0.4 s old, 0.2 s on average: 2 m short.
        assert!((way.distance_m() - 148.0).abs() < 0.1, "{}", way.distance_m());
        let before_m = way.distance_m();
        // Unknown for longer than it is held: 0.5 s count, at 20 m/s.
        for tenths in 111..=200u32 {
            way.push(0.1 * f64::from(tenths), f64::NAN);
        }
        assert!((way.distance_m() - before_m - 10.0).abs() < 0.1 && way.speed_m_s().is_nan());
        // Nor does a hole in the record, or a clock that goes back.
        let before_m = way.distance_m();
        for time_s in [20.0, 31.0, 5.0] {
            way.push(time_s, 20.0);
        }
        assert_eq!(way.distance_m(), before_m);
    }
}
