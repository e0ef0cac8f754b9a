//! A speed that says that the car stands while its wheels roll: a broken wire reads as zero.
//!
//! Called by the monitor with every sample. A speed that is not to be believed is unknown: then every wheel goes by its own
//! road, which is less but not wrong. Thresholds: docs/math/monitor.md, section 2.

use crate::diagnosis::Tuning;
use crate::memory::Blank;
use crate::model::CarSample;
use crate::real::Real;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Spread<T> {
    count: T,
    mean: T,
    squares: T,
    /// The last two values, and the sum of the squares of second differences.
    last: [T; 2],
    rough: T,
}

impl<T: Real> Spread<T> {
    fn new() -> Self {
        Self { last: [T::lit(f64::NAN); 2], ..Self::BLANK }
    }

    fn take(&mut self, value: T) {
        if value.is_finite() {
            self.count += T::one();
            let off = value - self.mean;
            self.mean += off / self.count;
            self.squares += off * (value - self.mean);
        }
        let [before, last] = self.last;
        let second = value - last - last + before;
        if second.is_finite() {
            self.rough += second * second;
        }
        self.last = [last, value];
    }

    /// Without what white noise adds, whose second differences have 1² + 2² + 1² times its power; those of a wheel's hop have nearly none.
    /// `None` without a value.
    fn rms(&self) -> Option<T> {
        let motion = self.squares - self.rough / T::lit(6.0);
        (self.count > T::zero()).then(|| (motion / self.count).at_least(T::zero()).sqrt())
    }
}

/// Holds a speed of zero against the wheels.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Standstill<T> {
    /// When the look under way began; NaN: the car does not count as standing.
    from_s: f64,
    wheels: [Spread<T>; 4],
    /// What the last look found by itself, and what two in a row did: one may hold garbage.
    rolled: bool,
    denied: bool,
}

impl<T: Real> Standstill<T> {
    pub(crate) fn new() -> Self {
        Self { from_s: f64::NAN, wheels: [Spread::new(); 4], rolled: false, denied: false }
    }

    /// Takes a sample and its speed, or the one that goes on, in m/s; gives the speed to go by, NaN when that is unknown.
    pub(crate) fn take(&mut self, time_s: f64, speed_m_s: T, sample: &CarSample<T>, tuning: &Tuning) -> T {
        if !(speed_m_s.abs() <= T::lit(tuning.standing_m_s)) {
            *self = Self::new();
            return speed_m_s;
        }
        let look_s = time_s - self.from_s;
        // A first look, or one after a hole.
        if !(look_s <= 2.0 * tuning.standing_s) {
            self.rolled = false;
            self.look_anew(time_s);
        } else if look_s >= tuning.standing_s {
            self.judge(tuning);
            self.look_anew(time_s);
        }
        for (wheel, corner) in self.wheels.iter_mut().zip(&sample.corners) {
            wheel.take(corner.map_or(T::lit(f64::NAN), |corner| corner.wheel_accel_m_s2));
        }
        if self.denied { T::lit(f64::NAN) } else { speed_m_s }
    }

    fn look_anew(&mut self, time_s: f64) {
        self.from_s = time_s;
        self.wheels = [Spread::new(); 4];
    }

    /// The second loudest wheel decides, or the only one: a single sensor may be noisy.
    fn judge(&mut self, tuning: &Tuning) {
        let (mut loudest, mut second) = (None, None);
        for rms in self.wheels.iter().filter_map(Spread::rms) {
            if loudest.is_none_or(|most| rms > most) {
                second = loudest.replace(rms);
            } else if second.is_none_or(|most| rms > most) {
                second = Some(rms);
            }
        }
        if let Some(rms) = second.or(loudest) {
            let share = if self.denied { tuning.hysteresis } else { 1.0 };
            let rolls = rms > T::lit(share * tuning.rolling_m_s2);
            if rolls == self.rolled {
                self.denied = rolls;
            }
            self.rolled = rolls;
        }
    }

    /// Whether the car counted as standing and does not.
    pub(crate) fn is_denied(&self) -> bool {
        self.denied
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::model::CornerSample;

    /// Seconds of a car whose wheels shake with these rms about gravity, at 200 Hz; gives the speeds to go by.
    fn drive(
        standstill: &mut Standstill<f64>,
        from_s: f64,
        speed_m_s: f64,
        rms: [f64; 4],
        seconds: f64,
    ) -> Vec<f64> {
        let sample = |k: u32| {
            let time_s = from_s + f64::from(k) / 200.0;
            let wave = (core::f64::consts::TAU * 11.0 * time_s).sin() * core::f64::consts::SQRT_2;
            let corner =
                |rms: f64| CornerSample { body_accel_m_s2: 9.81, wheel_accel_m_s2: 9.81 + rms * wave };
            CarSample { time_s, speed_m_s, corners: rms.map(|rms| Some(corner(rms))), wheel_speeds: None }
        };
        let samples = (0..(200.0 * seconds) as u32).map(sample);
        samples.map(|sample| standstill.take(sample.time_s, speed_m_s, &sample, &Tuning::DEFAULT)).collect()
    }

    #[test]
    fn a_zero_is_unknown_while_wheels_roll() {
        let mut standstill = Standstill::new();
        assert!(drive(&mut standstill, 0.0, 20.0, [5.0; 4], 2.0).iter().all(|v| *v == 20.0));
        // The wire breaks: after two seconds it is no longer believed.
        let broken = drive(&mut standstill, 2.0, 0.0, [5.0; 4], 5.0);
        assert!(broken[..399].iter().all(|v| *v == 0.0) && broken[401..].iter().all(|v| v.is_nan()));
        assert!(standstill.is_denied());
        // The car stands indeed, with its engine running; drives on, and stands.
        let stands = drive(&mut standstill, 7.0, 0.0, [0.3; 4], 4.0);
        assert!(stands[601..].iter().all(|v| *v == 0.0));
        assert_eq!(drive(&mut standstill, 11.0, 0.2, [5.0; 4], 2.0)[399], 0.2);
        assert!(drive(&mut standstill, 13.0, 0.0, [0.9; 4], 5.0).iter().all(|v| *v == 0.0));
    }

    /// Sensors of 1 m/s², in a car that stands and in one that rolls with a broken wire.
    #[test]
    fn noise_is_no_rolling_and_hides_none() {
        let mut random = crate::random::Random(3);
        let mut stand = |standstill: &mut Standstill<f64>, from_s: f64, rms: f64| {
            (0..1600).fold(0.0, |_, k| {
                let time_s = from_s + f64::from(k) / 200.0;
                let wave = (core::f64::consts::TAU * 11.0 * time_s).sin() * core::f64::consts::SQRT_2 * rms;
                let mut corner = || CornerSample {
                    body_accel_m_s2: 9.81,
                    wheel_accel_m_s2: 9.81 + wave + random.normal(),
                };
                let corners = [(); 4].map(|()| Some(corner()));
                standstill.take(
                    time_s,
                    0.0,
                    &CarSample { time_s, speed_m_s: 0.0, corners, wheel_speeds: None },
                    &Tuning::DEFAULT,
                )
            })
        };
        let mut standstill = Standstill::new();
        assert_eq!(stand(&mut standstill, 0.0, 0.0), 0.0);
        assert!(stand(&mut standstill, 8.0, 1.6).is_nan());
        assert_eq!(stand(&mut standstill, 16.0, 0.2), 0.0);
    }

    #[test]
    fn a_single_sample_of_garbage_does_not_make_a_car_roll() {
        let mut standstill = Standstill::new();
        drive(&mut standstill, 0.0, 0.0, [0.1; 4], 3.0);
        let corner = CornerSample { body_accel_m_s2: 9.81, wheel_accel_m_s2: -400.0 };
        let glitch =
            CarSample { time_s: 3.0, speed_m_s: 0.0, corners: [Some(corner); 4], wheel_speeds: None };
        assert_eq!(standstill.take(3.0, 0.0, &glitch, &Tuning::DEFAULT), 0.0);
        assert!(drive(&mut standstill, 3.005, 0.0, [0.1; 4], 5.0).iter().all(|v| *v == 0.0));
    }

    #[test]
    fn one_noisy_sensor_of_several_proves_nothing_nor_does_an_unknown_speed() {
        let mut standstill = Standstill::new();
        assert!(drive(&mut standstill, 0.0, 0.0, [9.0, 0.1, 0.1, f64::NAN], 5.0).iter().all(|v| *v == 0.0));
        let only = [f64::NAN, f64::NAN, 9.0, f64::NAN];
        assert!(drive(&mut standstill, 5.0, 0.0, only, 3.0)[599].is_nan());
        assert!(drive(&mut standstill, 8.0, f64::NAN, [9.0; 4], 3.0).iter().all(|v| v.is_nan()));
        assert!(!standstill.is_denied());
        // Without a single value nothing is found; a hole begins anew.
        assert!(drive(&mut standstill, 11.0, 0.0, [f64::NAN; 4], 3.0).iter().all(|v| *v == 0.0));
        assert_eq!(drive(&mut standstill, 60.0, 0.0, [9.0; 4], 0.5)[99], 0.0);
    }
}
