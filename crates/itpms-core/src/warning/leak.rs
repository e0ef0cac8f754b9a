//! How fast a tire loses pressure: one that has surely lost a part of its pressure in this drive leaks fast while its loss grows against
//! the others'. Whether it is lost is for the [decision](crate::decision) to tell.

use nalgebra::RealField;

use crate::decision::Probabilities;
use crate::diagnosis::debounce::{Debouncer, Evidence};
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;
use crate::warning::Rules;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct LeakWatch<T> {
    leaks: [Debouncer; 4],
    /// The loss in kPa behind by [`growth_s`](super::Tuning::growth_s), a low pass of first order; NaN: nothing is known of it.
    behind_kpa: [T; 4],
    /// When that was.
    behind_s: [f64; 4],
    rate_kpa_per_min: [T; 4],
    probability: [T; 4],
}

impl<T: Real> LeakWatch<T> {
    pub(crate) fn new() -> Self {
        Self {
            leaks: [Debouncer::new(); 4],
            behind_kpa: [T::lit(f64::NAN); 4],
            behind_s: [f64::NEG_INFINITY; 4],
            rate_kpa_per_min: [T::zero(); 4],
            probability: [T::zero(); 4],
        }
    }

    /// The latch of a wheel, and the highest rate in kPa per minute since the first evidence of this leak: a fall that is
    /// over looks slower the longer ago it was; and how probable the loss is.
    pub(crate) fn of(&self, wheel: Corner) -> (&Debouncer, T, Option<T>) {
        (&self.leaks[wheel], self.rate_kpa_per_min[wheel], Some(self.probability[wheel]))
    }

    /// The wheel's past says nothing any more.
    pub(crate) fn forget(&mut self, wheel: Corner) {
        self.behind_kpa[wheel] = T::lit(f64::NAN);
    }

    /// The same, and what was reported of it was no tire's.
    pub(crate) fn retract(&mut self, wheel: Corner) {
        self.forget(wheel);
        self.leaks[wheel] = Debouncer::new();
    }

    /// Takes what each tire has lost in this drive, in kPa, where that is being learned; how probable it is that it has lost
    /// that [makes a leak](super::Tuning::leak_of_a_loss); and whether it may only seem so.
    pub(crate) fn update(
        &mut self,
        time_s: f64,
        step_s: f64,
        lost_kpa: &[Option<T>; 4],
        lost: &Probabilities<T>,
        is_doubted: [bool; 4],
        &Rules { limits, decision, tuning }: &Rules<'_, T>,
    ) {
        let growth = Corner::ALL.map(|wheel| self.growth(time_s, wheel, lost_kpa[wheel]?, tuning.growth_s));
        for wheel in Corner::ALL {
            let Some(own) = growth[wheel] else { continue };
            // If the others lose, too, only what this one loses more counts; if they gain, that is no loss.
            let (mut others, mut count) = (T::zero(), T::zero());
            for other in wheel.others().into_iter().filter_map(|other| growth[other]) {
                (others, count) = (others + other, count + T::one());
            }
            let rate = own - (others / count.at_least(T::one())).at_least(T::zero());
            self.probability[wheel] = lost.low(wheel);
            let leaks =
                rate >= limits.fast_leak_kpa_per_min && self.probability[wheel] > T::lit(decision.surely_low);
            if leaks {
                let before =
                    if self.leaks[wheel].is_suspected() { self.rate_kpa_per_min[wheel] } else { rate };
                self.rate_kpa_per_min[wheel] = before.at_least(rate);
            }
            let evidence = match (leaks, is_doubted[wheel]) {
                (true, true) => Evidence::NoData,
                (true, false) => Evidence::Prefailed,
                (false, _) => Evidence::Prepassed,
            };
            self.leaks[wheel].update(time_s, step_s, evidence, tuning.leak);
        }
    }

    /// How fast a loss grows, in kPa per minute: a ramp is behind by its rate times `growth_s`. After a pause that long, or a clock that
    /// was set back, it is counted anew.
    fn growth(&mut self, time_s: f64, wheel: Corner, lost_kpa: T, growth_s: f64) -> Option<T> {
        let passed_s = time_s - core::mem::replace(&mut self.behind_s[wheel], time_s);
        let behind_kpa = &mut self.behind_kpa[wheel];
        if !((0.0..growth_s).contains(&passed_s) && behind_kpa.is_finite()) {
            *behind_kpa = lost_kpa;
        }
        let behind = lost_kpa - *behind_kpa;
        *behind_kpa += behind * T::lit(RealField::clamp(passed_s, 0.0, growth_s) / growth_s);
        behind.is_finite().then(|| behind * T::lit(60.0 / growth_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decision::{self, Shares, Since};
    use crate::warning::{Regulation, Tuning};

    /// A tenth of a second after another: wheel 0 has lost this much of 240 kPa, the others that, each with this sd.
    fn take(watch: &mut LeakWatch<f64>, time_s: f64, lost_kpa: [f64; 2], sd_kpa: f64, is_doubted: bool) {
        let [own, others] = lost_kpa;
        let lost_kpa = [own, others, others, others];
        let correlation = core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
        let lacking = lost_kpa.map(|kpa| Some([kpa, sd_kpa].map(|kpa| kpa / 240.0)));
        let shares = Shares::new(&lacking, &correlation);
        let (limits, decision, tuning) =
            (Regulation::UnR141.into(), &decision::Tuning::DEFAULT, &Tuning::DEFAULT);
        let rules = Rules { limits: &limits, decision, tuning };
        let lost = shares.probabilities(0.2 * tuning.leak_of_a_loss, Since::Beginning, decision).unwrap();
        watch.update(time_s, 0.1, &lost_kpa.map(Some), &lost, [is_doubted; 4], &rules);
    }

    /// Seconds until wheel 0 is reported to leak and the rate reported, while it falls at `kpa_per_min` and the others at `all`.
    fn active(kpa_per_min: f64, all: f64, sd_kpa: f64) -> Option<(f64, f64)> {
        let mut watch = LeakWatch::<f64>::new();
        for i in 0..1500 {
            let time_s = f64::from(i) * 0.1;
            take(&mut watch, time_s, [kpa_per_min, all].map(|rate| rate / 60.0 * time_s), sd_kpa, false);
            assert!(!watch.of(Corner::FrontRight).0.is_active());
            if watch.of(Corner::FrontLeft).0.is_active() {
                return Some((time_s, watch.of(Corner::FrontLeft).1));
            }
        }
        None
    }

    #[test]
    fn a_fall_is_reported_when_it_is_certain_and_with_its_rate() {
        // 6 % are 14.4 kPa, a little more with an sd of 2: at 60 kPa/min 15 to 20 s, then 10 s of waiting. A ramp is seen up to e^(-t / 30 s).
        let (at_s, rate) = active(60.0, 0.0, 2.0).unwrap();
        assert!((24.4..30.0).contains(&at_s), "{at_s}");
        assert!((rate - 60.0 * (1.0 - (-at_s / 30.0).exp())).abs() < 0.5, "{rate}");
        // At 2 kPa/min it is no fast one.
        assert_eq!(active(2.0, 0.0, 0.5), None);
    }

    #[test]
    fn seconds_in_which_the_tire_is_doubted_do_not_count() {
        for (doubted_s, active) in [(0.0, true), (9.0, false)] {
            let mut watch = LeakWatch::<f64>::new();
            for i in 0..300 {
                let time_s = f64::from(i) * 0.1;
                take(&mut watch, time_s, [time_s, 0.0], 2.0, time_s > 30.0 - doubted_s);
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
            take(&mut watch, time_s, [fallen, 0.0], 2.0, false);
        }
        // 100 kPa in 5 s by a low pass of 30 s: 100 (1 - e^(-1/6)) 6 behind, each half a minute.
        let (leak, rate, _) = watch.of(Corner::FrontLeft);
        assert!(leak.is_active() && (rate - 184.2).abs() < 2.0, "{rate}");
    }

    #[test]
    fn what_a_night_has_cost_is_no_fast_leak() {
        let mut watch = LeakWatch::<f64>::new();
        for i in 0..1200 {
            // One second of the time of tomorrow, then 60 s of today, then the morning: 60 kPa less.
            let (time_s, lost_kpa) = match i {
                0..10 => (1e9 + 0.1 * f64::from(i), 0.0),
                10..610 => (0.1 * f64::from(i), 0.0),
                _ => (3e4 + 0.1 * f64::from(i), 60.0),
            };
            take(&mut watch, time_s, [lost_kpa, 0.0], 2.0, false);
            assert!(!watch.of(Corner::FrontLeft).0.is_suspected(), "{time_s}");
        }
        // A leak that begins then is reported.
        for i in 1200..1600 {
            take(&mut watch, 3e4 + 0.1 * f64::from(i), [60.0 + 0.1 * f64::from(i - 1200), 0.0], 2.0, false);
        }
        assert!(watch.of(Corner::FrontLeft).0.is_active());
    }

    #[test]
    fn what_all_do_is_no_leak() {
        assert_eq!(active(60.0, 60.0, 2.0), None);
        assert!(active(60.0, 20.0, 2.0).is_some());
    }
}
