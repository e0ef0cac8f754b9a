//! Whether what a wheel's hop does to its body has changed by so little that one hole could have made it: as a gain that is off by a
//! quarter or a third does (docs/math/monitor.md, section 3).
//!
//! Like [`crate::diagnosis::wheel_gain::jump`], but of powers that are averaged over seconds, and counting what the other wheels do to a body.

use crate::diagnosis::Tuning;
use crate::diagnosis::debounce::Debouncer;
use crate::diagnosis::matching::median;
use crate::diagnosis::signals::Block;
use crate::diagnosis::single_sensor::evidence;
use crate::diagnosis::wheel_gain::jump::Hop;
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

/// Effect of every wheel on its body, and whether it has shifted.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WheelGainShift<T> {
    /// Averaged shares of the power in the hop band: accelerations of the bodies, what the struts make of the wheels' motion, and
    /// accelerations of the wheels.
    bodies: [T; 4],
    struts: [T; 4],
    wheels: [T; 4],
    filled: T,
    corners: [Shift<T>; 4],
}

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Shift<T> {
    baseline: Hop<T>,
    /// Averages that the usual one is the mean of.
    blocks: u32,
    debouncer: Debouncer,
    /// Whether the hop is slower or quicker than usual.
    hop_shifted: bool,
    /// Seconds for which it has not been as usual.
    lasted_s: f64,
    /// Since when no tire makes it what it is; NaN: one might.
    pending_since_s: f64,
}

impl<T: Real> Shift<T> {
    fn new() -> Self {
        Self { debouncer: Debouncer::new(), pending_since_s: f64::NAN, ..Self::BLANK }
    }

    fn learn(&mut self, hop: Hop<T>, tuning: &Tuning) {
        self.blocks = self.blocks.saturating_add(1).min(tuning.shift_usual_blocks);
        let share = T::lit(1.0 / f64::from(self.blocks));
        self.baseline.strut_over_body += share * (hop.strut_over_body - self.baseline.strut_over_body);
        self.baseline.wheel_over_strut += share * (hop.wheel_over_strut - self.baseline.wheel_over_strut);
    }

    fn note_hop(&mut self, wheel_over_strut: T, tuning: &Tuning) {
        let share = if self.hop_shifted { tuning.hysteresis } else { 1.0 };
        self.hop_shifted = wheel_over_strut > T::lit(share * tuning.shift_hop);
    }

    /// Takes the newest average and its deviation from the usual one. `beside`: another corner's hop frequency has changed.
    fn judge(
        &mut self,
        [time_s, step_s]: [f64; 2],
        hop: Hop<T>,
        deviation: Hop<T>,
        explained: bool,
        beside: bool,
        tuning: &Tuning,
    ) {
        let (strut_over_body, fine) = (deviation.strut_over_body, T::lit(tuning.shift_fine));
        let by_tire = T::lit(tuning.shift_by_tire) * deviation.wheel_over_strut;
        let limit = T::lit(if beside { tuning.shift_beside } else { tuning.shift }) + by_tire;
        let pending_fault = strut_over_body > fine + by_tire && !self.hop_shifted;
        if !pending_fault {
            self.pending_since_s = f64::NAN;
        } else if self.pending_since_s.is_nan() {
            self.pending_since_s = time_s;
        }
        let evidence = evidence(
            strut_over_body > limit && !self.hop_shifted,
            self.hop_shifted || strut_over_body < fine,
        );
        let suspected = self.debouncer.update(time_s, step_s, evidence, tuning.change);
        let baseline = !suspected && !self.hop_shifted && strut_over_body < fine;
        self.lasted_s = if baseline || explained { 0.0 } else { self.lasted_s + step_s };
        if self.lasted_s > tuning.change_longest_s || (explained && !suspected) {
            // Another car; or it was wrong before its usual was known, and what was learned is not usual.
            *self = Self::new();
        } else if baseline {
            self.learn(hop, tuning);
        }
    }
}

impl<T: Real> WheelGainShift<T> {
    pub(crate) fn new() -> Self {
        Self { corners: [Shift::new(); 4], ..Self::BLANK }
    }

    /// Whether a corner is not to be learned from.
    pub(crate) fn is_suspected(&self, corner: Corner) -> bool {
        self.corners[corner].debouncer.is_active()
    }

    /// Whether a corner may be about to be suspected: what its tire seems to be may be its sensor's.
    pub(crate) fn is_pending_fault(&self, corner: Corner, now_s: f64, tuning: &Tuning) -> bool {
        now_s - self.corners[corner].pending_since_s < tuning.shift_wait_s
    }

    pub(crate) fn drop_suspicions(&mut self) {
        for corner in self.corners.iter_mut().filter(|corner| corner.debouncer.is_active()) {
            *corner = Shift::new();
        }
    }

    /// Takes a block in which all four corners are read, and the corners of which it is reported already what is wrong.
    pub(crate) fn take(&mut self, at: [f64; 2], block: &Block<T>, explained: [bool; 4], tuning: &Tuning) {
        self.average(block, tuning);
        if self.filled < T::lit(tuning.shift_filled) {
            return;
        }
        let hops = self.hops(tuning);
        let blocks =
            self.corners.iter().fold(tuning.shift_usual_blocks, |least, corner| least.min(corner.blocks));
        let deviation = |of: fn(&Hop<T>) -> T, known: u32| {
            let deviation = Corner::ALL.map(|i| of(&hops[i]) - of(&self.corners[i].baseline));
            Corner::ALL.map(|i| if blocks < known { T::zero() } else { apart(&deviation, i) })
        };
        let (wheel_over_strut, strut_over_body) = (
            deviation(|hop| hop.wheel_over_strut, tuning.shift_hop_known_blocks),
            deviation(|hop| hop.strut_over_body, tuning.shift_known_blocks),
        );
        for (corner, wheel_over_strut) in self.corners.iter_mut().zip(wheel_over_strut) {
            corner.note_hop(wheel_over_strut, tuning);
        }
        let hop_shifted = self.corners.each_ref().map(|corner| corner.hop_shifted);
        for i in Corner::ALL {
            let beside = i.others().into_iter().any(|other| hop_shifted[other]);
            let deviation =
                Hop { strut_over_body: strut_over_body[i], wheel_over_strut: wheel_over_strut[i] };
            self.corners[i].judge(at, hops[i], deviation, explained[i], beside, tuning);
        }
    }

    /// Every block counts alike, however rough its road.
    fn average(&mut self, block: &Block<T>, tuning: &Tuning) {
        let all = (4..8).fold(T::zero(), |sum, i| sum + block.hop[(i, i)]);
        let share = T::lit(1.0 / tuning.hop_blocks);
        let follow = |mean: &mut T, power: T| *mean += share * (power / all - *mean);
        for i in 0..4 {
            follow(&mut self.bodies[i], block.hop[(i, i)]);
            follow(&mut self.struts[i], block.hop[(4 + i, 4 + i)]);
            follow(&mut self.wheels[i], block.wheel_hop[i]);
        }
        self.filled += share * (T::one() - self.filled);
    }

    /// What the struts of all wheels give a body over what it has; and the hop frequency: logs of powers.
    fn hops(&self, tuning: &Tuning) -> [Hop<T>; 4] {
        let all = self.struts.iter().fold(T::zero(), |sum, strut| sum + *strut);
        Corner::ALL.map(|i| {
            let own = self.struts[i];
            let given = own + T::lit(tuning.shift_to_others) * (all - own);
            Hop {
                strut_over_body: (given / self.bodies[i]).ln(),
                wheel_over_strut: (self.wheels[i] / own).ln(),
            }
        })
    }
}

/// By how much a corner is off from all others, from the other one of its side and from that of its axle, whichever is least; nothing if
/// they differ in sign. A load is one of an axle, a rough road one of a side.
fn apart<T: Real>(deviation: &[T; 4], corner: Corner) -> T {
    let mut others = corner.others().map(|other| deviation[other]);
    let apart = [median(&mut others), deviation[corner.same_side()], deviation[corner.same_axle()]]
        .map(|other| deviation[corner] - other);
    let alike = apart.iter().all(|apart| *apart > T::zero()) || apart.iter().all(|apart| *apart < T::zero());
    if alike {
        apart.iter().fold(T::lit(f64::INFINITY), |least, apart| least.min(apart.abs()))
    } else {
        T::zero()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;

    const BLOCK_S: f64 = 0.5;
    const TUNING: Tuning = Tuning::DEFAULT;

    /// How rough each wheel's road is, the masses over the wheels, their sensors' gains and the change of their hop frequency, as a log.
    struct Drive {
        rough: [f64; 4],
        masses: [f64; 4],
        gains: [f64; 4],
        hop_shift: [f64; 4],
    }

    impl Drive {
        const BASELINE: Self =
            Self { rough: [1.0; 4], masses: [1.0; 4], gains: [1.0; 4], hop_shift: [0.0; 4] };
    }

    /// A car whose bodies get what their own wheels and the others give them.
    struct Car {
        shifts: WheelGainShift<f64>,
        blocks: u32,
    }

    impl Car {
        fn that_has_driven(blocks: u32) -> Self {
            let mut car = Self { shifts: WheelGainShift::new(), blocks: 0 };
            for _ in 0..blocks {
                car.read([1.0; 4], [false; 4]);
                assert_eq!(car.suspects(), [false; 4]);
            }
            car
        }

        fn read(&mut self, gains: [f64; 4], explained: [bool; 4]) {
            self.block(&Drive { gains, ..Drive::BASELINE }, explained);
        }

        fn block(&mut self, drive: &Drive, explained: [bool; 4]) {
            let Drive { rough, masses, gains, hop_shift } = drive;
            self.blocks += 1;
            let phase = |i: usize| f64::from(self.blocks) * (1.0 + 0.7 * i as f64);
            let moves = [0, 1, 2, 3].map(|i| (rough[i] * (0.3 * phase(i).sin()).exp()).powi(2));
            let mut hop = SMatrix::zeros();
            for i in 0..4 {
                let given = moves[i] + 0.08 * moves[i ^ 1] + 0.05 * moves[i ^ 2] + 0.02 * moves[i ^ 3];
                hop[(i, i)] = given / masses[i].powi(2);
                hop[(4 + i, 4 + i)] = moves[i] * gains[i].powi(2);
            }
            let wheel_hop = [0, 1, 2, 3].map(|i| hop[(4 + i, 4 + i)] * hop_shift[i].exp());
            let block = Block { hop, wheel_hop, bounce: SMatrix::zeros(), slow: [1.0; 8] };
            self.shifts.take([BLOCK_S * f64::from(self.blocks), BLOCK_S], &block, explained, &TUNING);
        }

        fn suspects(&self) -> [bool; 4] {
            Corner::ALL.map(|corner| self.shifts.is_suspected(corner))
        }

        fn pending_fault(&self) -> [bool; 4] {
            let now_s = BLOCK_S * f64::from(self.blocks);
            Corner::ALL.map(|corner| self.shifts.is_pending_fault(corner, now_s, &TUNING))
        }

        /// Seconds until the suspicion of the front left wheel is `wanted`, with this gain.
        fn until(&mut self, wanted: bool, gain: f64) -> f64 {
            let from = self.blocks;
            while self.suspects()[0] != wanted {
                self.read([gain, 1.0, 1.0, 1.0], [false; 4]);
                assert_eq!(self.suspects()[1..], [false; 3]);
                assert!(self.blocks - from < 1000, "never");
            }
            f64::from(self.blocks - from) * BLOCK_S
        }
    }

    #[test]
    fn a_gain_that_changes_by_a_quarter_is_suspected_until_it_is_back() {
        // The log moves by 0.52 and 0.55; the averages of 6 s would have 0.35 of that after 6.7 s and 6.1 s, but for what a block
        // has more or less.
        for gain in [0.75, 1.35] {
            let mut car = Car::that_has_driven(120);
            let suspected_s = car.until(true, gain);
            assert!((4.0..12.0).contains(&suspected_s), "{gain}: {suspected_s} s");
            for _ in 0..100 {
                car.read([gain, 1.0, 1.0, 1.0], [false; 4]);
                assert_eq!(car.suspects(), [true, false, false, false]);
            }
            assert!(car.until(false, 1.0) < 10.0);
        }
    }

    #[test]
    fn before_a_corner_is_suspected_it_is_strange_and_not_for_long() {
        // 0.2 of 0.52 after 2.9 s; suspected after 6.7, but for what a block has more or less.
        let mut car = Car::that_has_driven(120);
        let mut strange_s = 0.0;
        while !car.suspects()[0] {
            car.read([0.75, 1.0, 1.0, 1.0], [false; 4]);
            let pending_fault = car.pending_fault();
            assert_eq!(pending_fault[1..], [false; 3]);
            strange_s += if pending_fault[0] { BLOCK_S } else { 0.0 };
        }
        assert!((2.0..9.0).contains(&strange_s), "{strange_s} s");
        // A gain of 0.82 makes 0.34, too little for a suspicion. What lasts is no reason to wait any more.
        let mut car = Car::that_has_driven(120);
        let pending_fault = (0..120).filter(|_| {
            car.read([0.82, 1.0, 1.0, 1.0], [false; 4]);
            car.pending_fault()[0]
        });
        let strange_s = BLOCK_S * pending_fault.count() as f64;
        assert!(
            (0.6 * TUNING.shift_wait_s..=1.5 * TUNING.shift_wait_s).contains(&strange_s),
            "{strange_s} s"
        );
        assert_eq!(car.suspects(), [false; 4]);
        // Nor is what a tire that falls makes.
        let mut car = Car::that_has_driven(120);
        let (masses, hop_shift) = ([1.25, 1.0, 1.0, 1.0], [-0.25, 0.0, 0.0, 0.0]);
        for _ in 0..120 {
            car.block(&Drive { masses, hop_shift, ..Drive::BASELINE }, [false; 4]);
            assert_eq!(car.pending_fault(), [false; 4]);
        }
    }

    #[test]
    fn what_is_strange_passes_though_nobody_looks() {
        let mut car = Car::that_has_driven(120);
        while !car.pending_fault()[0] {
            car.read([0.75, 1.0, 1.0, 1.0], [false; 4]);
        }
        let now_s = BLOCK_S * f64::from(car.blocks);
        assert!(car.shifts.is_pending_fault(Corner::FrontLeft, now_s + 0.9 * TUNING.shift_wait_s, &TUNING));
        assert!(!car.shifts.is_pending_fault(Corner::FrontLeft, now_s + TUNING.shift_wait_s, &TUNING));
    }

    #[test]
    fn what_stays_is_another_car_in_the_end_unless_it_is_reported_why() {
        let mut car = Car::that_has_driven(120);
        car.until(true, 0.75);
        let lasted_s = car.until(false, 0.75);
        assert!(
            (0.9 * TUNING.change_longest_s..=TUNING.change_longest_s).contains(&lasted_s),
            "{lasted_s} s"
        );
        let mut car = Car::that_has_driven(120);
        car.until(true, 0.75);
        let explained = [true, false, false, false];
        for _ in 0..1000 {
            car.read([0.75, 1.0, 1.0, 1.0], explained);
            assert!(car.suspects()[0]);
        }
    }

    #[test]
    fn roads_loads_holes_and_other_tires_are_no_shift() {
        let drive = |drive: &dyn Fn(u32) -> Drive| {
            let mut car = Car::that_has_driven(120);
            for i in 0..300 {
                car.block(&drive(i), [false; 4]);
                assert_eq!(car.suspects(), [false; 4], "{i}");
            }
        };
        // The left side is ten times as rough; a hole under one wheel after the other.
        drive(&|_| Drive { rough: [10.0, 1.0, 10.0, 1.0], ..Drive::BASELINE });
        let hole = |i: u32, wheel: u32| if i.is_multiple_of(6) && i / 6 % 4 == wheel { 8.0 } else { 1.0 };
        drive(&|i| Drive { rough: [0, 1, 2, 3].map(|wheel| hole(i, wheel)), ..Drive::BASELINE });
        // A third more over the rear axle.
        drive(&|_| Drive { masses: [1.0, 1.0, 1.33, 1.33], ..Drive::BASELINE });
        // The same over one wheel would be a shift, were its hop not slower than before.
        let masses = [1.25, 1.0, 1.0, 1.0];
        drive(&|_| Drive { masses, hop_shift: [-0.4, 0.0, 0.0, 0.0], ..Drive::BASELINE });
        // Or over another one than that with a flat tire.
        drive(&|_| Drive { masses, hop_shift: [0.0, 0.0, -0.4, 0.0], ..Drive::BASELINE });
    }

    #[test]
    fn a_tire_that_goes_flat_before_the_usual_is_known_is_no_shift() {
        // A tire that falls from 250 to 190 kPa: a smaller change than that of its wheel's power, and a slower hop.
        let (masses, hop_shift) = ([1.25, 1.0, 1.0, 1.0], [-0.25, 0.0, 0.0, 0.0]);
        for blocks in [20, 30, 40, TUNING.shift_known_blocks] {
            let mut car = Car::that_has_driven(blocks);
            for i in 0..300 {
                car.block(&Drive { masses, hop_shift, ..Drive::BASELINE }, [false; 4]);
                assert_eq!(car.suspects(), [false; 4], "after {blocks} blocks and {i}");
            }
        }
    }

    #[test]
    fn nothing_is_suspected_before_the_usual_is_known() {
        let mut car = Car::that_has_driven(TUNING.shift_known_blocks);
        for _ in 0..4 {
            car.read([3.0, 1.0, 1.0, 1.0], [false; 4]);
            assert_eq!(car.suspects(), [false; 4]);
        }
        // One that is wrong from the start, and then reported, is not the usual.
        let mut car = Car { shifts: WheelGainShift::new(), blocks: 0 };
        for active in [false, true] {
            for _ in 0..60 {
                let explained = [active, false, false, false];
                car.read([0.75, 1.0, 1.0, 1.0], explained);
                assert_eq!(car.suspects(), [false; 4]);
            }
        }
        for _ in 0..120 {
            car.read([1.0; 4], [false; 4]);
            assert_eq!(car.suspects(), [false; 4]);
        }
        car.until(true, 0.75);
    }
}
