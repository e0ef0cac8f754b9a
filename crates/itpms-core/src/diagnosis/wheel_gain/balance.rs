//! Wheel sensors with a wrong gain. Below the body's own swing body and wheel go up and down together, so their ratio is the same at all
//! corners, and more so at both of an axle, which stand at the same distance from where the body pitches about. What both sides of one axle
//! differ by shows at the other one, too, where it is the road's (docs/math/monitor.md, section 3, "Gain of a wheel").

use crate::diagnosis::debounce::Evidence;
use crate::diagnosis::fault_latch::FaultLatch;
use crate::diagnosis::matching::{median, over_others};
use crate::diagnosis::signals::Block;
use crate::diagnosis::single_sensor::evidence;
use crate::diagnosis::{Fault, Malfunction, Place, Sensor, Tuning};
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

/// Gains of a car's wheel sensors, compared with each other.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WheelGainBalance<T: Real> {
    /// Logs of wheel over body, less the median of the four and less that of the axle's other corner.
    over_median: [T; 4],
    over_partner: [T; 4],
    /// The first as it is reported.
    as_reported: [T; 4],
    filled: T,
    /// Logs of the wheels' hop power over that of the others.
    hop: [T; 4],
    /// The most that a gain has been off since it is reported.
    largest_deviation: [T; 4],
    words: [FaultLatch<T>; 4],
    /// Since when the gain of each may be wrong, or those of both wheels of a side; NaN: it is not.
    pending_since_s: [f64; 4],
}

impl<T: Real> WheelGainBalance<T> {
    pub(crate) fn new() -> Self {
        Self { words: [FaultLatch::new(); 4], pending_since_s: [f64::NAN; 4], ..Self::BLANK }
    }

    /// Takes a block of a car that drives; `has_signal`: the slow band is louder than the sensors' noise in it.
    pub(crate) fn average(&mut self, block: &Block<T>, has_signal: bool, tuning: &Tuning) {
        let share = T::lit(1.0 / tuning.balance_blocks);
        let follow = |mean: &mut T, now: T, most: f64| {
            let most = T::lit(most);
            *mean += share * (now.clamp(-most, most) - *mean);
        };
        for (corner, hop) in Corner::ALL.into_iter().zip(&mut self.hop) {
            let level = T::lit(0.5) * over_others(&block.wheel_hop, corner).ln();
            if level.is_finite() {
                follow(hop, level, tuning.balance_step_hop);
            }
        }
        let logs = [0, 1, 2, 3].map(|i| T::lit(0.5) * (block.slow[4 + i] / block.slow[i]).ln());
        if !has_signal || logs.iter().any(|log| !log.is_finite()) {
            return;
        }
        let baseline = median(&mut logs.clone());
        for i in Corner::ALL {
            follow(&mut self.over_median[i], logs[i] - baseline, tuning.balance_step);
            follow(&mut self.over_partner[i], logs[i] - logs[i.same_axle()], tuning.balance_step);
            follow(&mut self.as_reported[i], logs[i] - baseline, tuning.balance_step_reported);
        }
        self.filled += share * (T::one() - self.filled);
    }

    /// Judges by what was taken; `flat`: the bodies are one plane, so none of them reads wrong.
    pub(crate) fn judge(&mut self, at: [f64; 2], flat: bool, tuning: &Tuning) {
        let counts = flat && self.filled >= T::lit(tuning.filled);
        for i in Corner::ALL {
            // A smooth road under one side, which rolls with the other, is one of both axles.
            let other_axle = self.over_partner[i.same_side()];
            let over_all = lesser(self.over_median[i], self.over_partner[i]);
            let own = lesser(over_all, self.over_partner[i] - other_axle);
            let of_side = lesser(self.over_partner[i], other_axle).abs();
            self.note_pending(i, at[0], flat, own.abs(), of_side, tuning);
            let deviation = counts.then(|| own / self.filled);
            let hop = T::lit(tuning.balance_hop);
            let agrees = deviation.is_some_and(|deviation| deviation.signum() * self.hop[i] > hop);
            let most = &mut self.largest_deviation[i];
            *most = if self.words[i].debouncer.is_active() {
                deviation.map_or(*most, |deviation| most.max(deviation.abs()))
            } else {
                T::zero()
            };
            let fine = T::lit(tuning.balance_fine).max(T::lit(tuning.balance_fine_share) * *most);
            let past = !agrees || *most > T::lit(tuning.balance_large);
            let wrong = T::lit(tuning.balance_wrong).max(fine);
            let evidence = deviation.map_or(Evidence::NoData, |deviation| {
                evidence(agrees && deviation.abs() > wrong, past && deviation.abs() < fine)
            });
            let sensor = Sensor { corner: i, place: Place::Wheel };
            let gain = (self.as_reported[i] / self.filled.max(T::lit(tuning.filled))).exp();
            self.words[i].update(at, evidence, tuning.balance, || Malfunction::Gain { sensor, gain });
        }
    }

    /// Gains are doubted earlier than they are reported, and those of both wheels of a side, too, which differ from the others by twice as much. An
    /// average of few blocks is off by more: by the root of their number. `own`, `of_side`: logs of the corner's gain and of those of its side, as far
    /// as the averages are filled.
    fn note_pending(&mut self, i: Corner, time_s: f64, flat: bool, own: T, of_side: T, tuning: &Tuning) {
        if !(flat && self.filled >= T::lit(0.5 * tuning.filled)) {
            return;
        }
        let few = (T::lit(tuning.filled) / self.filled).sqrt().max(T::one());
        let deviation = own.max(T::lit(0.5) * of_side) / (self.filled * few);
        let since_s = &mut self.pending_since_s[i];
        if deviation > T::lit(tuning.balance_fine) {
            *since_s = if since_s.is_nan() { time_s } else { *since_s };
        } else if deviation < T::lit(tuning.hysteresis * tuning.balance_fine)
            && !self.words[i].debouncer.is_active()
        {
            *since_s = f64::NAN;
        }
    }

    /// Whether the slow band alone makes a corner's gain look wrong: what its tire seems to be may be its sensor's.
    pub(crate) fn is_pending_fault(&self, corner: Corner) -> bool {
        !self.pending_since_s[corner].is_nan()
    }

    pub(crate) fn faults(&self) -> impl Iterator<Item = Fault<T>> {
        let since = self.words.iter().zip(self.pending_since_s);
        since.filter_map(|(word, pending_s)| {
            word.fault().map(|fault| Fault { since_s: fault.since_s.min(pending_s), ..fault })
        })
    }
}

/// The one nearer to zero of two that agree in their sign, else nothing.
fn lesser<T: Real>(a: T, b: T) -> T {
    match (a > T::zero(), b > T::zero()) {
        (true, true) => a.min(b),
        (false, false) => a.max(b),
        _ => T::zero(),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;

    const BLOCK_S: f64 = 0.5;
    const TUNING: Tuning = Tuning::DEFAULT;

    struct Drive {
        gains: WheelGainBalance<f64>,
        time_s: f64,
    }

    impl Drive {
        fn new() -> Self {
            Self { gains: WheelGainBalance::new(), time_s: 0.0 }
        }

        /// Drives on with these logs of every wheel's reading over what is usual, in the slow band and in its hop's; gives when
        /// something was reported first.
        fn on(&mut self, seconds: f64, slow: [f64; 4], hop: [f64; 4]) -> Option<f64> {
            let power = |log: f64| (2.0 * log).exp();
            let [a, b, c, d] = slow.map(power);
            let block = Block {
                hop: SMatrix::zeros(),
                wheel_hop: hop.map(power),
                bounce: SMatrix::zeros(),
                slow: [1.0, 1.0, 1.0, 1.0, a, b, c, d],
            };
            let mut reported_s = None;
            for _ in 0..(seconds / BLOCK_S) as u32 {
                self.time_s += BLOCK_S;
                self.gains.average(&block, true, &TUNING);
                self.gains.judge([self.time_s, BLOCK_S], true, &TUNING);
                if self.gains.faults().next().is_some() {
                    reported_s.get_or_insert(self.time_s);
                }
            }
            reported_s
        }

        fn active(&self) -> Option<Malfunction<f64>> {
            self.gains.faults().next().map(|fault| fault.malfunction)
        }
    }

    fn front_right(log: f64) -> [f64; 4] {
        [0.0, log, 0.0, 0.0]
    }

    #[test]
    fn a_gain_by_a_quarter_is_reported_and_taken_back() {
        let mut drive = Drive::new();
        assert_eq!(drive.on(60.0, [0.0; 4], [0.0; 4]), None);
        let deviation = 0.75_f64.ln();
        let reported_s = drive.on(60.0, front_right(deviation), front_right(deviation)).unwrap() - 60.0;
        // On its way from 0 to 0.288 with 10 s an average is 0.14 after 6.7 s, and 0.15 of the hop after 7.4 s; 5 s more.
        let closed_form =
            -10.0 * (1.0 - TUNING.balance_hop.max(TUNING.balance_wrong) / deviation.abs()).ln() + 5.0;
        assert!((reported_s - closed_form).abs() < 1.5, "{reported_s} s, {closed_form} s");
        let sensor = Sensor { corner: Corner::FrontRight, place: Place::Wheel };
        let Some(Malfunction::Gain { sensor: named, gain }) = drive.active() else { unreachable!() };
        assert!(named == sensor && (0.75..0.9).contains(&gain), "{named:?} {gain}");
        drive.on(40.0, [0.0; 4], [0.0; 4]);
        assert_eq!(drive.active(), None);
    }

    /// As soon as a fifth of the average is filled, or a quarter for both wheels of a side, which nothing reports.
    #[test]
    fn a_gain_is_doubted_long_before_it_is_reported() {
        let (gain, side) = (1.25_f64.ln(), 0.75_f64.ln());
        for slow in [front_right(gain), [0.0, side, 0.0, side], [side, 0.0, side, 0.0]] {
            let mut drive = Drive::new();
            assert_eq!(drive.on(2.0, slow, [0.0; 4]), None);
            assert!(!drive.gains.is_pending_fault(Corner::FrontRight));
            assert_eq!(drive.on(1.0, slow, [0.0; 4]), None);
            assert!(drive.gains.is_pending_fault(Corner::FrontRight));
            assert_eq!(drive.on(120.0, slow, [0.0; 4]), None);
            // From 0.22 to less than 0.055 in 10 s times ln 4.
            assert_eq!(drive.on(16.0, [0.0; 4], [0.0; 4]), None);
            assert!(!drive.gains.is_pending_fault(Corner::FrontRight));
        }
        let mut drive = Drive::new();
        drive.on(60.0, front_right(gain), front_right(gain));
        assert_eq!(drive.gains.faults().next().map(|fault| fault.since_s), Some(2.5));
    }

    #[test]
    fn neither_band_alone_accuses_a_wheel_nor_a_hole() {
        let mut drive = Drive::new();
        // A tire with little air hops less; loads and pitching change the slow band.
        assert_eq!(drive.on(120.0, [0.0; 4], front_right(-0.4)), None);
        assert_eq!(drive.on(120.0, front_right(-0.2), [0.0; 4]), None);
        // The whole axle, as a car that pitches near the band.
        assert_eq!(drive.on(120.0, [-0.2, -0.2, 0.0, 0.0], [-0.3, -0.3, 0.0, 0.0]), None);
        // With little air, and a hole every ten seconds that makes two of a block.
        for _ in 0..12 {
            assert_eq!(drive.on(0.5, front_right(-2.0), front_right(-0.4)), None);
            assert_eq!(drive.on(9.5, [0.0; 4], front_right(-0.4)), None);
        }
        assert_eq!(drive.on(120.0, front_right(f64::NAN), front_right(-0.4)), None);
    }

    /// A quiet road under the right wheels: their bodies move with the left ones. (Reported of a healthy sensor once in 230 everyday hours.)
    #[test]
    fn a_side_that_rolls_with_the_other_is_no_gain() {
        let mut drive = Drive::new();
        assert_eq!(drive.on(120.0, [0.1, -0.1, 0.1, -0.17], [0.0, 0.0, 0.0, -0.25]), None);
        // But a gain that is wrong beside that is.
        assert!(drive.on(120.0, [0.1, -0.1, 0.1, -0.4], [0.0, 0.0, 0.0, -0.3]).is_some());
    }

    #[test]
    fn nothing_is_judged_while_the_band_is_silent_or_a_body_reads_wrong() {
        let mut gains = WheelGainBalance::new();
        let loud = Block {
            hop: SMatrix::zeros(),
            wheel_hop: [0.25, 1.0, 1.0, 1.0],
            bounce: SMatrix::zeros(),
            slow: [1.0, 1.0, 1.0, 1.0, 0.25, 1.0, 1.0, 1.0],
        };
        for (has_signal, flat) in [(false, true), (true, false)] {
            for block in 0..200 {
                gains.average(&loud, has_signal, &TUNING);
                gains.judge([f64::from(block) * BLOCK_S, BLOCK_S], flat, &TUNING);
                assert!(gains.faults().next().is_none());
            }
        }
    }
}
