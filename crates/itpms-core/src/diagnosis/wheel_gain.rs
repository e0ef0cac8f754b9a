//! Wheel sensors with a wrong gain, from the start or from some moment on (docs/math/monitor.md, section 3, "Gain of a wheel").
//!
//! A gain moves three logs of its corner against those of every other one by its own log: what the strut makes of the wheel over what the body
//! does, against what that was before; the wheel over the body in the slow band; and the wheel's hop. Each may be something else's: of the first a
//! load's or a damper's, of the second a pitching car's, of the third a tire's. A road that is rough on one side, or under one axle, leaves a
//! corner as one other is. So log-likelihood ratios are summed for each of the three and each pair of corners, and what the two weakest
//! of the three have against a corner, compared with the corner that it differs from least, must be enough.

use crate::diagnosis::matching::median;
use crate::diagnosis::signals::Block;
use crate::diagnosis::{Fault, Malfunction, Place, Sensor, Tuning};
use crate::memory::{Blank, Placed};
use crate::model::{Corner, Wheels};
use crate::real::Real;

/// Gains of a car's wheel sensors, compared with each other.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WheelGains<T: Real> {
    /// How much more one corner reads than another, summed: log-likelihood ratios of strut over body, slow band and hop, the first less what
    /// the tire of the one explains; and of the first, less what that of the other explains.
    sums: [[[T; 4]; 4]; 4],
    /// Logs of strut over body, halved, and of wheel over strut, nearly the square of the hop frequency: the mean of so many blocks.
    usual: [[T; 4]; 2],
    usual_blocks: u32,
    /// By how much the second is off, averaged.
    hop_shift: [T; 4],
    /// Logs of wheel over body in the slow band, less their median, averaged.
    slow: [T; 4],
    slow_blocks: u32,
    suspected: Wheels,
    /// Seconds for which one has been suspected, and none reported.
    lasted_s: f64,
    /// When the strut had last nothing against a corner, and when the car last stood.
    strut_since_s: [f64; 4],
    stood_s: f64,
    /// Since when the gain of each may be wrong, or those of both wheels of a side; NaN: it is not.
    pending_since_s: [f64; 4],
    fault: Placed<Fault<T>>,
    /// Log of the least gain that the sums look for at the corner that is reported.
    size: T,
}

impl<T: Real> WheelGains<T> {
    pub(crate) fn new() -> Self {
        Self { stood_s: f64::NEG_INFINITY, pending_since_s: [f64::NAN; 4], ..Self::BLANK }
    }

    /// A standing car may be loaded.
    pub(crate) fn stand(&mut self, time_s: f64) {
        self.stood_s = time_s;
    }

    /// Drops what is only suspected.
    pub(crate) fn drop_suspicions(&mut self) {
        if self.fault.get().is_none() {
            self.sums = [[[T::zero(); 4]; 4]; 4];
            (self.suspected, self.lasted_s, self.pending_since_s) = (Wheels::NONE, 0.0, [f64::NAN; 4]);
        }
    }

    /// Takes a block in which all four corners move. `settled`: the filters have forgotten what was wrong, and the car drives; `has_slow`: the slow
    /// band is louder than the sensors' noise in it.
    pub(crate) fn take(
        &mut self,
        at: [f64; 2],
        block: &Block<T>,
        [settled, has_slow]: [bool; 2],
        tuning: &Tuning,
    ) {
        let half = T::lit(0.5);
        let log = |wheel: T, body: T| (wheel / body).ln();
        let strut = [0, 1, 2, 3].map(|i| half * log(block.hop[(4 + i, 4 + i)], block.hop[(i, i)]));
        let hop = [0, 1, 2, 3].map(|i| log(block.wheel_hop[i], block.hop[(4 + i, 4 + i)]));
        let [usual_strut, usual_hop] = self.usual;
        let less = |logs: [T; 4], usual: [T; 4]| Corner::ALL.map(|i| logs[i] - usual[i]);
        let (strut, hop) = (less(strut, usual_strut), less(hop, usual_hop));
        if self.usual_blocks >= tuning.gain_known_blocks {
            let share = T::lit(1.0 / tuning.ratio_blocks);
            for (shift, hop) in self.hop_shift.iter_mut().zip(hop) {
                *shift += share * (hop - *shift);
            }
            let usual = median(&mut self.hop_shift.clone());
            let by_tire = self.hop_shift.map(|shift| shift - usual);
            self.weigh(0, strut, by_tire, tuning);
            self.weigh(3, strut, by_tire, tuning);
        }
        let slow = [0, 1, 2, 3].map(|i| half * log(block.slow[4 + i], block.slow[i]));
        if settled && has_slow && slow.iter().all(|log| log.is_finite()) {
            self.slow_blocks = self.slow_blocks.saturating_add(1);
            let share = T::lit(1.0 / f64::from(self.slow_blocks).min(tuning.hop_blocks));
            let usual = median(&mut slow.clone());
            for (mean, slow) in self.slow.iter_mut().zip(slow) {
                *mean += share * (slow - usual - *mean);
            }
            self.weigh(1, slow, [T::zero(); 4], tuning);
        }
        if settled {
            self.weigh(2, block.wheel_hop.map(|power| half * power.ln()), [T::zero(); 4], tuning);
        }
        self.judge(at, tuning);
        if self.suspected == Wheels::NONE && self.fault.get().is_none() {
            self.usual_blocks = self.usual_blocks.saturating_add(1).min(tuning.gain_usual_blocks);
            let share = T::lit(1.0 / f64::from(self.usual_blocks));
            for (usual, off) in self.usual.iter_mut().zip([strut, hop]) {
                Corner::ALL.into_iter().for_each(|i| usual[i] += share * off[i]);
            }
        }
    }

    /// Adds for every pair of corners the log-likelihood ratio of one reading more by the least gain to both reading alike, less what the tire of the one
    /// that would be wrong explains: in row 3 the other. A tire that loses air hops more slowly, and its corner reads less.
    fn weigh(&mut self, row: usize, logs: [T; 4], by_tire: [T; 4], tuning: &Tuning) {
        let Some((sums, sd)) = self.sums.get_mut(row).zip(tuning.gain_sd.get(row % 3)) else { return };
        let (sd, least, most) = (T::lit(*sd), T::lit(tuning.gain_least), T::lit(tuning.cusum));
        let reported = self.fault.get().map(|fault| fault.malfunction.wheels()).unwrap_or(Wheels::NONE);
        let outlier = T::lit(tuning.gain_outlier) * sd;
        for (i, j) in pairs() {
            let size = if reported.contains(i) || reported.contains(j) { self.size } else { least };
            let by_tire = if row == 3 { -by_tire[j] } else { by_tire[i] }.max(T::zero());
            let more = (logs[i] - logs[j]).clamp(-outlier, outlier) - by_tire - T::lit(0.5) * size;
            sums[i][j] = (sums[i][j] + size * more / (sd * sd)).clamp(T::zero(), most);
        }
    }

    /// What the witnesses have against a corner that reads more than every other one, or less.
    fn against(&self, corner: Corner, more: bool) -> [T; 3] {
        let [strut_more, slow, hop, strut_less] = &self.sums;
        [if more { strut_more } else { strut_less }, slow, hop].map(|sums| {
            let others =
                corner.others().map(|other| if more { sums[corner][other] } else { sums[other][corner] });
            others.into_iter().fold(others[0], |least, other| least.min(other))
        })
    }

    /// What the two weakest witnesses have against it.
    fn sum(&self, corner: Corner, more: bool, tuning: &Tuning) -> T {
        let [strut, slow, hop] = self.against(corner, more);
        // What began with a stop may be a load.
        let is_load = self.strut_since_s[corner] < self.stood_s + tuning.gain_load_s;
        let strut = if is_load { T::zero() } else { strut };
        strut + slow + hop - strut.max(slow).max(hop)
    }

    fn judge(&mut self, [time_s, step_s]: [f64; 2], tuning: &Tuning) {
        let [doubt, suspect] = tuning.gain_doubted;
        let [enough, doubt, suspect] = [1.0, doubt, suspect].map(|share| T::lit(tuning.cusum * share));
        let mut suspected = Wheels::NONE;
        for i in Corner::ALL {
            let [[more, slow_more, _], [less, slow_less, _]] =
                [true, false].map(|more| self.against(i, more));
            let (strut, slow) = (more.max(less), slow_more.max(slow_less));
            if !(strut > T::zero()) {
                self.strut_since_s[i] = time_s;
            }
            if strut >= suspect || (strut > T::zero() && self.suspected.contains(i)) {
                suspected = suspected | i.into();
            }
            let is_pending = strut >= doubt || slow >= doubt || self.of_side(i) >= enough;
            let since_s = &mut self.pending_since_s[i];
            *since_s = if is_pending { since_s.min(time_s) } else { f64::NAN };
        }
        self.suspected = suspected;
        match self.fault.get() {
            Some(fault) => {
                let Malfunction::Gain { sensor, gain } = fault.malfunction else { return };
                if !(self.sum(sensor.corner, gain > T::one(), tuning) > T::zero()) {
                    self.fault.set(None);
                }
            }
            None => self.report(time_s, enough, tuning),
        }
        let is_open = suspected != Wheels::NONE && self.fault.get().is_none();
        self.lasted_s = if is_open { self.lasted_s + step_s } else { 0.0 };
        if self.lasted_s > tuning.change_longest_s {
            *self = Self { stood_s: self.stood_s, ..Self::new() }; // Another car.
        }
    }

    /// What the slow band has against both wheels of a side.
    fn of_side(&self, i: Corner) -> T {
        let slow = &self.sums[1];
        let [[a, b], [c, d]] = [i, i.same_side()].map(|i| [i, i.same_axle()]);
        slow[a][b].min(slow[c][d]).max(slow[b][a].min(slow[d][c]))
    }

    fn report(&mut self, time_s: f64, enough: T, tuning: &Tuning) {
        let all = Corner::ALL.into_iter().flat_map(|corner| [(corner, true), (corner, false)]);
        let Some((corner, more)) =
            all.into_iter().find(|&(corner, more)| self.sum(corner, more, tuning) >= enough)
        else {
            return;
        };
        let least = T::lit(tuning.gain_least);
        let log = if more { self.slow[corner] } else { -self.slow[corner] }.max(least);
        let most = tuning.gain_sd.iter().fold(f64::INFINITY, |least, sd| least.min(*sd));
        self.size = (T::lit(tuning.gain_fine) * log).max(least).min(T::lit(tuning.gain_outlier * most));
        let gain = if more { log.exp() } else { (-log).exp() };
        let malfunction = Malfunction::Gain { sensor: Sensor { corner, place: Place::Wheel }, gain };
        let since_s = self.pending_since_s[corner].min(time_s);
        self.fault.set(Some(Fault { malfunction, since_s, reported_s: time_s }));
    }

    /// The corners not to be learned from.
    pub(crate) fn suspected(&self) -> Wheels {
        self.suspected
    }

    /// Whether what a corner's tire seems to be may be its sensor's.
    pub(crate) fn is_pending_fault(&self, corner: Corner) -> bool {
        !self.pending_since_s[corner].is_nan()
    }

    pub(crate) fn fault(&self) -> Option<Fault<T>> {
        self.fault.get()
    }
}

/// Every two corners, either way round.
fn pairs() -> impl Iterator<Item = (Corner, Corner)> {
    Corner::ALL.into_iter().flat_map(|i| i.others().map(|j| (i, j)))
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;

    const BLOCK_S: f64 = 0.5;
    const TUNING: Tuning = Tuning::DEFAULT;

    /// How rough each wheel's road is, the masses over the wheels, their sensors' gains, the change of their hop frequency and of the slow band, as
    /// logs the last two.
    #[derive(Clone, Copy)]
    struct Drive {
        rough: [f64; 4],
        masses: [f64; 4],
        gains: [f64; 4],
        hop_shift: [f64; 4],
        slow: [f64; 4],
    }

    const BASELINE: Drive =
        Drive { rough: [1.0; 4], masses: [1.0; 4], gains: [1.0; 4], hop_shift: [0.0; 4], slow: [0.0; 4] };

    struct Car {
        gains: WheelGains<f64>,
        time_s: f64,
    }

    impl Car {
        fn that_has_driven(seconds: f64) -> Self {
            let mut car = Self { gains: WheelGains::new(), time_s: 0.0 };
            assert!(car.until(seconds, |_| BASELINE, |car| car.is_suspect()).is_none());
            car
        }

        fn block(&mut self, drive: &Drive) {
            self.time_s += BLOCK_S;
            let mut hop = SMatrix::zeros();
            for i in 0..4 {
                hop[(i, i)] = (drive.rough[i] / drive.masses[i]).powi(2);
                hop[(4 + i, 4 + i)] = (drive.rough[i] * drive.gains[i]).powi(2);
            }
            let wheel_hop = [0, 1, 2, 3].map(|i| hop[(4 + i, 4 + i)] * drive.hop_shift[i].exp());
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| (drive.gains[i] * drive.slow[i].exp()).powi(2));
            let slow = [1.0, 1.0, 1.0, 1.0, a, b, c, d];
            let block = Block { hop, wheel_hop, bounce: SMatrix::zeros(), slow };
            self.gains.take([self.time_s, BLOCK_S], &block, [true; 2], &TUNING);
        }

        /// Seconds until something holds, within so many.
        fn until(
            &mut self,
            seconds: f64,
            drive: impl Fn(u32) -> Drive,
            holds: impl Fn(&Self) -> bool,
        ) -> Option<f64> {
            (0..(seconds / BLOCK_S) as u32).find_map(|i| {
                self.block(&drive(i));
                holds(self).then(|| f64::from(i + 1) * BLOCK_S)
            })
        }

        fn is_suspect(&self) -> bool {
            self.gains.suspected() != Wheels::NONE || self.is_reported()
        }

        fn is_reported(&self) -> bool {
            self.gains.fault().is_some()
        }

        fn is_pending(&self) -> bool {
            Corner::ALL.into_iter().any(|corner| self.gains.is_pending_fault(corner))
        }
    }

    fn gain(gain: f64) -> Drive {
        Drive { gains: [1.0, gain, 1.0, 1.0], ..BASELINE }
    }

    /// What a block adds to each sum, of a gain's log.
    fn per_block(log: f64) -> [f64; 3] {
        TUNING.gain_sd.map(|sd| TUNING.gain_least * (log - 0.5 * TUNING.gain_least) / (sd * sd))
    }

    #[test]
    fn a_gain_that_changes_is_suspected_reported_and_taken_back() {
        for factor in [0.75_f64, 1.35] {
            let mut car = Car::that_has_driven(60.0);
            let [strut, slow, hop] = per_block(factor.ln().abs());
            let suspected_s = car.until(60.0, |_| gain(factor), Car::is_suspect).unwrap();
            let expected_s = BLOCK_S * (TUNING.gain_doubted[1] * TUNING.cusum / strut).ceil();
            // Until then the usual, a mean of 120 blocks, follows by a tenth.
            assert!((expected_s..1.2 * expected_s).contains(&suspected_s), "{factor}: {suspected_s} s");
            assert_eq!(car.gains.suspected(), Corner::FrontRight.into());
            let reported_s = suspected_s + car.until(60.0, |_| gain(factor), Car::is_reported).unwrap();
            assert_eq!(reported_s, BLOCK_S * (TUNING.cusum / (slow + hop)).ceil(), "{factor}");
            let fault = car.gains.fault().unwrap();
            assert!((60.0..60.0 + suspected_s).contains(&(fault.since_s - BLOCK_S)), "{}", fault.since_s);
            let Malfunction::Gain { sensor, gain: found } = fault.malfunction else { unreachable!() };
            assert_eq!(sensor, Sensor { corner: Corner::FrontRight, place: Place::Wheel });
            assert!((found.ln() / factor.ln() - 0.9).abs() < 0.1, "{found}");
            assert!(car.until(300.0, |_| gain(factor), |car| !car.is_reported()).is_none());
            // Two of the full sums, by half of the square of what is looked for over the variance a block.
            let size = (TUNING.gain_fine * found.ln().abs()).max(TUNING.gain_least);
            let longest_s = BLOCK_S * TUNING.cusum * 2.0 * (TUNING.gain_sd[2] / size).powi(2);
            let back_s = car.until(120.0, |_| BASELINE, |car| !car.is_suspect()).unwrap();
            assert!(back_s < 1.1 * longest_s, "{back_s} s, {longest_s} s");
        }
    }

    #[test]
    fn a_gain_that_is_wrong_from_the_start_has_two_witnesses_that_must_both_be_sure() {
        let mut car = Car { gains: WheelGains::new(), time_s: 0.0 };
        let doubted_s = car.until(60.0, |_| gain(0.75), Car::is_pending).unwrap();
        let [_, slow, _] = per_block(0.75_f64.ln().abs());
        assert_eq!(doubted_s, BLOCK_S * (TUNING.gain_doubted[0] * TUNING.cusum / slow).ceil());
        let reported_s = doubted_s + car.until(60.0, |_| gain(0.75), Car::is_suspect).unwrap();
        assert_eq!(reported_s, BLOCK_S * (TUNING.cusum / slow).ceil());
        assert_eq!(car.gains.fault().unwrap().since_s, doubted_s);
    }

    #[test]
    fn no_witness_accuses_a_wheel_alone() {
        let front_right = |log: f64| [0.0, log, 0.0, 0.0];
        for drive in [
            // A tire with little air, a car that pitches near the slow band, a load.
            Drive { hop_shift: front_right(-0.8), ..BASELINE },
            Drive { slow: front_right(-0.4), ..BASELINE },
            Drive { masses: [1.0, 1.4, 1.0, 1.0], ..BASELINE },
            // What a tire that falls from 240 to 140 kPa makes.
            Drive { masses: [1.0, 0.75, 1.0, 1.0], hop_shift: front_right(-0.2), ..BASELINE },
            // Roads of one side, loads and roads of one axle.
            Drive { rough: [1.0, 10.0, 1.0, 10.0], slow: [0.0, 0.4, 0.0, 0.4], ..BASELINE },
            Drive { masses: [1.0, 1.0, 1.4, 1.4], rough: [1.0, 1.0, 2.0, 2.0], ..BASELINE },
        ] {
            let mut car = Car::that_has_driven(60.0);
            assert!(car.until(300.0, |_| drive, Car::is_reported).is_none());
        }
    }

    #[test]
    fn roads_holes_and_tires_make_no_suspicion() {
        let hole = |i: u32, wheel: u32| if i.is_multiple_of(6) && i / 6 % 4 == wheel { 8.0 } else { 1.0 };
        let mut car = Car::that_has_driven(60.0);
        let holes = |i| Drive { rough: [0, 1, 2, 3].map(|wheel| hole(i, wheel)), ..BASELINE };
        assert!(car.until(300.0, holes, Car::is_suspect).is_none());
        let flat = Drive { masses: [0.75, 1.0, 1.0, 1.0], hop_shift: [-0.2, 0.0, 0.0, 0.0], ..BASELINE };
        assert!(car.until(300.0, |_| flat, Car::is_suspect).is_none());
        let side = Drive { rough: [10.0, 1.0, 10.0, 1.0], ..BASELINE };
        assert!(car.until(300.0, |_| side, Car::is_suspect).is_none());
    }

    /// A load that makes its tire hop harder, and shifts the slow band a little: with both witnesses it would be a gain.
    #[test]
    fn what_begins_with_a_stop_may_be_a_load() {
        let load = Drive {
            masses: [1.0, 1.4, 1.0, 1.0],
            slow: [0.0, 0.15, 0.0, 0.0],
            rough: [1.0, 1.0, 1.0, 1.0],
            ..BASELINE
        };
        let mut car = Car::that_has_driven(60.0);
        assert!(car.until(100.0, |_| load, |car| car.is_suspect()).is_some());
        let mut car = Car::that_has_driven(60.0);
        car.gains.stand(car.time_s);
        assert!(car.until(100.0, |_| load, Car::is_reported).is_none() && car.is_suspect());
        // What stays is another car in the end, and so it is where another fault explains it.
        let lasted_s = car.until(100.0, |_| load, |car| !car.is_suspect()).unwrap();
        assert!((100.0 + lasted_s - TUNING.change_longest_s).abs() < 10.0, "{lasted_s} s");
        let mut car = Car::that_has_driven(60.0);
        car.until(100.0, |_| load, Car::is_suspect);
        car.gains.drop_suspicions();
        assert!(!car.is_suspect() && !car.is_pending());
    }

    #[test]
    fn both_wheels_of_a_side_are_doubted_and_not_reported() {
        let side = Drive { gains: [1.0, 0.75, 1.0, 0.75], ..BASELINE };
        let mut car = Car::that_has_driven(60.0);
        assert!(car.until(60.0, |_| side, |car| car.is_pending()).is_some());
        assert!(car.until(60.0, |_| side, |car| car.is_suspect()).is_none());
    }
}
