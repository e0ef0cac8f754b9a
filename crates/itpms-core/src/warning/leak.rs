//! How fast a tire loses pressure against the others: what road, temperature and load do to all of them cancels. A fall is certain by the
//! pressure's own deviation, or by that of the loss in this drive where losses are counted: by the second a pressure that is found to have
//! another level than was believed has lost nothing.

use crate::diagnosis::debounce::{DebounceTimes, Debouncer, Evidence};
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

/// Seconds between two pressures that are kept, and how many are: the last two minutes.
const KEPT_EVERY_S: f64 = 5.0;
const KEPT: usize = 24;
/// Shortest and longest time in s over which a fall is judged: what is older lies before a hole in the record.
const SHORTEST_S: f64 = 10.0;
const LONGEST_S: f64 = (KEPT + 1) as f64 * KEPT_EVERY_S;
/// Standard deviations of its difference by which a pressure must have fallen, and the least fall as a share of the
/// reference.
const CERTAIN: f64 = 4.0;
const LEAST_FALL: f64 = 0.06;
const LEAK: DebounceTimes = DebounceTimes { set_s: 10.0, clear_s: 60.0 };

/// What falls if a tire leaks, in kPa, each with its variance in kPa²: its pressure, and the negative of what was lost of it in this drive
/// (NaN where losses are not counted).
type Kept<T> = Option<[[T; 2]; 2]>;

/// What is known of a wheel when it is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Height<T> {
    /// What falls; `None` where nothing is being learned.
    pub(crate) kpa: Kept<T>,
    /// Whether the tire is below where it should be, or has lost too much in this drive: what comes down to where it should be was read
    /// too high.
    pub(crate) is_short: bool,
    /// Whether the tire may only seem to fall.
    pub(crate) is_doubted: bool,
}

/// Pressures of all wheels over the last minutes, and who leaks.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct LeakWatch<T> {
    kept: [[Kept<T>; 4]; KEPT],
    kept_s: [f64; KEPT],
    leaks: [Debouncer; 4],
    rate_kpa_per_min: [T; 4],
}

impl<T: Real> LeakWatch<T> {
    pub(crate) fn new() -> Self {
        Self {
            kept: [[None; 4]; KEPT],
            kept_s: [f64::NEG_INFINITY; KEPT],
            leaks: [Debouncer::new(); 4],
            rate_kpa_per_min: [T::zero(); 4],
        }
    }

    /// The latch of a wheel, and the highest rate in kPa per minute since the first evidence of this leak: a fall that is
    /// over looks slower the longer ago it was.
    pub(crate) fn of(&self, wheel: Corner) -> (&Debouncer, T) {
        (&self.leaks[wheel], self.rate_kpa_per_min[wheel])
    }

    /// The wheel's past says nothing any more.
    pub(crate) fn forget(&mut self, wheel: Corner) {
        for kept in &mut self.kept {
            kept[wheel] = None;
        }
    }

    /// The same, and what was reported of it was no tire's.
    pub(crate) fn retract(&mut self, wheel: Corner) {
        self.forget(wheel);
        self.leaks[wheel] = Debouncer::new();
    }

    /// Takes what is known of the wheels.
    pub(crate) fn update(
        &mut self,
        time_s: f64,
        step_s: f64,
        wheels: &[Height<T>; 4],
        reference_kpa: [T; 4],
        least_kpa_per_min: T,
    ) {
        let now = wheels.map(|wheel| wheel.kpa);
        let lasted_s = self.kept_s.map(|kept_s| T::lit(time_s - kept_s));
        for wheel in Corner::ALL {
            if now[wheel].is_none() {
                continue;
            }
            let fall = self.steepest_fall(&lasted_s, wheel, &now, reference_kpa[wheel]);
            let evidence = match fall {
                Some(rate) if wheels[wheel].is_short && rate >= least_kpa_per_min => {
                    let leak = &self.leaks[wheel];
                    let before = if leak.is_suspected() { self.rate_kpa_per_min[wheel] } else { T::zero() };
                    self.rate_kpa_per_min[wheel] = before.max(rate);
                    if wheels[wheel].is_doubted { Evidence::NoData } else { Evidence::Prefailed }
                }
                _ => Evidence::Prepassed,
            };
            self.leaks[wheel].update(time_s, step_s, evidence, LEAK);
        }
        // Every `KEPT_EVERY_S`; at once where the clock was set back, as what was kept lies in the future then.
        if !(0.0..KEPT_EVERY_S).contains(&(time_s - self.kept_s[KEPT - 1])) {
            self.kept.rotate_left(1);
            self.kept_s.rotate_left(1);
            self.kept[KEPT - 1] = now;
            self.kept_s[KEPT - 1] = time_s;
        }
    }

    /// The highest rate of a fall that is certain, in kPa per minute.
    fn steepest_fall(
        &self,
        lasted_s: &[T; KEPT],
        wheel: Corner,
        now: &[Kept<T>; 4],
        reference_kpa: T,
    ) -> Option<T> {
        let mut steepest = None;
        for (kept, lasted_s) in self.kept.iter().zip(lasted_s) {
            let Some((before, after)) = kept[wheel].zip(now[wheel]) else { continue };
            if !(*lasted_s >= T::lit(SHORTEST_S) && *lasted_s < T::lit(LONGEST_S)) {
                continue;
            }
            for (of, ([before, variance_before], [after, variance])) in
                before.into_iter().zip(after).enumerate()
            {
                // If the others fell, too, only what this one fell more counts; if they rose, that is no fall.
                let fall = before - after - others_fall(kept, now, wheel, of).max(T::zero());
                let certain = T::lit(CERTAIN * CERTAIN) * (variance + variance_before);
                if fall > T::lit(LEAST_FALL) * reference_kpa && fall * fall > certain {
                    let rate = fall * T::lit(60.0) / *lasted_s;
                    steepest = Some(steepest.map_or(rate, |steepest: T| steepest.max(rate)));
                }
            }
        }
        steepest
    }
}

/// Mean fall of the other wheels, in kPa, of what falls of this number.
fn others_fall<T: Real>(kept: &[Kept<T>; 4], now: &[Kept<T>; 4], wheel: Corner, of: usize) -> T {
    let (mut sum, mut count) = (T::zero(), T::zero());
    for other in Corner::ALL.into_iter().filter(|&other| other != wheel) {
        let [before, after] = [kept, now].map(|wheels| wheels[other]?.get(of).map(|[kpa, _]| *kpa));
        if let Some((before, after)) =
            before.zip(after).filter(|(before, after)| (*before - *after).is_finite())
        {
            sum += before - after;
            count += T::one();
        }
    }
    sum / count.max(T::one())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes what wheel 0 has, the others 240 kPa, each with an sd of 2, after another 0.1 s.
    fn take(watch: &mut LeakWatch<f64>, time_s: f64, kpa: f64, is_doubted: bool) {
        let other = pressure(240.0, 2.0);
        let wheels = [Height { is_doubted, ..pressure(kpa, 2.0) }, other, other, other];
        watch.update(time_s, 0.1, &wheels, [240.0; 4], 3.0);
    }

    /// A wheel of this pressure, which should be 240 kPa.
    fn pressure(kpa: f64, sd_kpa: f64) -> Height<f64> {
        let kpa_and_loss = [[kpa, sd_kpa * sd_kpa], [f64::NAN; 2]];
        Height { kpa: Some(kpa_and_loss), is_short: kpa < 240.0, is_doubted: false }
    }

    /// Seconds until wheel 0 is reported to leak and the rate reported, while it falls at `kpa_per_min` and the others at `all`.
    fn active(kpa_per_min: f64, all: f64, sd: f64) -> Option<(f64, f64)> {
        let mut watch = LeakWatch::<f64>::new();
        for i in 0..6000 {
            let time_s = f64::from(i) * 0.1;
            let other = pressure(240.0 - all / 60.0 * time_s, sd);
            let wheels = [pressure(240.0 - kpa_per_min / 60.0 * time_s, sd), other, other, other];
            watch.update(time_s, 0.1, &wheels, [240.0; 4], 3.0);
            assert!(!watch.of(Corner::FrontRight).0.is_active());
            if watch.of(Corner::FrontLeft).0.is_active() {
                return Some((time_s, watch.of(Corner::FrontLeft).1));
            }
        }
        None
    }

    #[test]
    fn a_fall_is_reported_when_it_is_certain_and_with_its_rate() {
        // sd 2: the difference's is 2.8, so 14.4 kPa (6 %) decide; 60 kPa/min falls that in 14.4 s, then 10 s of waiting.
        let (at_s, rate) = active(60.0, 0.0, 2.0).unwrap();
        assert!((24.0..26.5).contains(&at_s) && (rate - 60.0).abs() < 1.0, "{at_s} {rate}");
        // sd 8: 45 kPa are certain; two minutes at 12 kPa/min are not enough.
        assert_eq!(active(12.0, 0.0, 8.0), None);
    }

    #[test]
    fn seconds_in_which_the_tire_is_doubted_do_not_count() {
        for (doubted_s, active) in [(0.0, true), (9.0, false)] {
            let mut watch = LeakWatch::<f64>::new();
            // One kPa in a second: 14.4 kPa, then ten seconds.
            for i in 0..300 {
                let time_s = f64::from(i) * 0.1;
                take(&mut watch, time_s, 240.0 - time_s, time_s > 30.0 - doubted_s);
            }
            assert_eq!(watch.of(Corner::FrontLeft).0.is_active(), active);
        }
    }

    #[test]
    fn a_fall_that_is_over_has_the_rate_it_had() {
        let mut watch = LeakWatch::<f64>::new();
        for i in 0..900 {
            let time_s = f64::from(i) * 0.1;
            let fallen = 100.0 * ((time_s - 30.0) / 5.0).clamp(0.0, 1.0);
            take(&mut watch, time_s, 240.0 - fallen, false);
        }
        // 100 kPa within the shortest time that is looked at: 10 s, up to 15 as pressures are kept every 5. Over the minute
        // since then it would be 100 kPa/min.
        let (leak, rate) = watch.of(Corner::FrontLeft);
        assert!(leak.is_active() && (399.0..=601.0).contains(&rate), "{rate}");
    }

    #[test]
    fn what_a_night_has_cost_is_no_fast_leak() {
        let mut watch = LeakWatch::<f64>::new();
        for i in 0..1200 {
            // One second of the time of tomorrow, then 60 s of today, then the morning: 60 kPa less.
            let (time_s, kpa) = match i {
                0..10 => (1e9 + 0.1 * f64::from(i), 240.0),
                10..610 => (0.1 * f64::from(i), 240.0),
                _ => (3e4 + 0.1 * f64::from(i), 180.0),
            };
            take(&mut watch, time_s, kpa, false);
            assert!(!watch.of(Corner::FrontLeft).0.is_suspected(), "{time_s}");
        }
        // What is kept is of the morning: a leak that begins is reported.
        for i in 1200..1600 {
            let kpa = 180.0 - 0.1 * f64::from(i - 1200);
            take(&mut watch, 3e4 + 0.1 * f64::from(i), kpa, false);
        }
        assert!(watch.of(Corner::FrontLeft).0.is_active());
    }

    /// A pressure of which 20 kPa are found to be a level that was believed too high, then the loss, which is known apart from that.
    #[test]
    fn a_level_that_is_learned_is_no_leak_and_a_loss_is_one() {
        let mut watch = LeakWatch::<f64>::new();
        let other = Height { kpa: Some([[240.0, 100.0], [0.0, 4.0]]), ..pressure(240.0, 10.0) };
        for i in 0..1200 {
            let time_s = f64::from(i) * 0.1;
            let wheel = match i {
                0..300 => Height { kpa: Some([[255.0, 100.0], [0.0, 4.0]]), ..pressure(255.0, 10.0) },
                _ => {
                    let lost = (0.5 * (time_s - 60.0)).max(0.0);
                    let level = 255.0 - 20.0 * ((time_s - 30.0) / 20.0).min(1.0);
                    Height {
                        kpa: Some([[level - lost, 100.0], [-lost, 4.0]]),
                        ..pressure(level - lost, 10.0)
                    }
                }
            };
            watch.update(time_s, 0.1, &[wheel, other, other, other], [240.0; 4], 3.0);
            assert!(time_s > 60.0 || !watch.of(Corner::FrontLeft).0.is_suspected(), "{time_s}");
        }
        let (leak, rate) = watch.of(Corner::FrontLeft);
        assert!(leak.is_active() && (rate - 30.0).abs() < 1.0, "{rate}");
    }

    #[test]
    fn what_all_do_is_no_leak() {
        assert_eq!(active(60.0, 60.0, 2.0), None);
        assert!(active(60.0, 20.0, 2.0).is_some());
        // Two minutes at 2 kPa a minute are below the least rate and the least fall.
        assert_eq!(active(2.0, 0.0, 0.5), None);
    }
}
