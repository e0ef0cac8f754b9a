//! Whether what a wheel's hop does to its body has changed at once (docs/math/monitor.md, section 3).
//!
//! Strut and sprung mass make a body's acceleration of its wheel's; the tire has no part in it. So a change within
//! seconds, at one corner alone, is one of a sensor's gain. Which of the two sensors, and whether it stays, takes longer to
//! say; until then the corner is kept from the estimator. A tire that loses its air moves the hop to where the other wheels
//! shake the body, too: the wheel's sensor by itself tells that, whatever its gain, as the hop is slower.

use crate::diagnosis::Tuning;
use crate::diagnosis::debounce::Debouncer;
use crate::diagnosis::matching::median;
use crate::diagnosis::single_sensor::evidence;
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

/// Newest blocks of which the middle one counts. A hole under one wheel shakes the bodies of all: at the others one block or
/// two, but not half of them, have a body that moves more than its wheel explains.
const NEWEST: usize = 9;

/// How a corner's hop looks in a block, as logs of powers.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Hop<T> {
    /// Strut's response to the wheel's motion over the body's acceleration.
    pub(crate) strut_over_body: T,
    /// The wheel's acceleration over what the strut makes of its motion: nearly the square of a frequency.
    pub(crate) wheel_over_strut: T,
}

/// A running quantity of a corner: what is usual of it, and by how much the newest blocks were off; newest last.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Baseline<T> {
    mean: T,
    deviation: [T; NEWEST],
}

/// A corner's usual hop, and whether it has left it.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WheelGainJump<T> {
    strut_over_body: Baseline<T>,
    wheel_over_strut: Baseline<T>,
    /// Blocks that the means are of.
    blocks: u32,
    debouncer: Debouncer,
    /// Whether the hop frequency is not the usual one: the tire has changed.
    hop_shifted: bool,
    /// Seconds for which it has been suspected, or the hop frequency not the usual one.
    lasted_s: f64,
}

impl<T: Real> Baseline<T> {
    /// Takes a block; the middle one of the newest.
    fn deviation(&mut self, log: T) -> T {
        self.deviation.rotate_left(1);
        self.deviation[NEWEST - 1] = log - self.mean;
        median(&mut self.deviation.clone())
    }

    fn learn(&mut self, log: T, blocks: u32, tuning: &Tuning) {
        let by = if blocks < tuning.jump_known_blocks { f64::INFINITY } else { tuning.jump_step };
        let by = T::lit(by);
        self.mean += (log - self.mean).clamp(-by, by) / T::lit(f64::from(blocks));
    }
}

impl<T: Real> WheelGainJump<T> {
    pub(crate) fn new() -> Self {
        Self { debouncer: Debouncer::new(), ..Self::BLANK }
    }

    /// Whether its corner is not to be learned from.
    pub(crate) fn is_suspected(&self) -> bool {
        self.debouncer.is_active()
    }

    fn learn(&mut self, hop: Hop<T>, tuning: &Tuning) {
        self.blocks = self.blocks.saturating_add(1).min(tuning.jump_usual_blocks);
        self.strut_over_body.learn(hop.strut_over_body, self.blocks, tuning);
        self.wheel_over_strut.learn(hop.wheel_over_strut, self.blocks, tuning);
    }

    fn note_hop(&mut self, wheel_over_strut: T, tuning: &Tuning) {
        let share = if self.hop_shifted { tuning.hysteresis } else { 1.0 };
        self.hop_shifted = wheel_over_strut > T::lit(share * tuning.jump_hop);
    }

    /// `beside`: another corner's hop frequency has changed.
    fn judge(
        &mut self,
        [time_s, step_s]: [f64; 2],
        strut_over_body: T,
        explained: bool,
        beside: bool,
        tuning: &Tuning,
    ) {
        let limit = T::lit(if beside { tuning.jump_beside } else { tuning.jump });
        let jumped = strut_over_body > limit && !self.hop_shifted;
        let evidence = evidence(jumped, self.hop_shifted || strut_over_body < T::lit(tuning.jump_fine));
        let suspected = self.debouncer.update(time_s, step_s, evidence, tuning.change);
        if (suspected || self.hop_shifted) && !explained {
            self.lasted_s += step_s;
        } else {
            self.lasted_s = 0.0;
        }
        self.give_up_in_time(tuning);
    }

    /// While one of the others is not known the corner cannot be held against them; what it is suspected of grows old.
    fn wait(&mut self, step_s: f64, tuning: &Tuning) {
        if self.is_suspected() {
            self.lasted_s += step_s;
            self.give_up_in_time(tuning);
        }
    }

    /// A misfit that lasts so long is another car.
    fn give_up_in_time(&mut self, tuning: &Tuning) {
        if self.lasted_s > tuning.change_longest_s {
            *self = Self::new();
        }
    }
}

/// By how much a corner is off from all others and from the other one of its side, whichever is less: where one side is
/// rough and the other smooth, both bodies of the smooth one move with the rough one's wheels.
fn apart<T: Real>(deviation: &[T; 4], corner: Corner) -> T {
    let (own, mut others) = (deviation[corner], corner.others().map(|other| deviation[other]));
    let (all, side) = (own - median(&mut others), own - deviation[corner.same_side()]);
    if all * side > T::zero() { all.abs().min(side.abs()) } else { T::zero() }
}

/// Takes a block in which all four corners are read, and the corners of which it is reported already what is wrong.
pub(crate) fn jumps<T: Real>(
    corners: &mut [WheelGainJump<T>; 4],
    at: [f64; 2],
    hops: &[Hop<T>; 4],
    explained: [bool; 4],
    tuning: &Tuning,
) {
    if corners.iter().all(|corner| corner.blocks >= tuning.jump_known_blocks) {
        let strut_over_body =
            Corner::ALL.map(|i| corners[i].strut_over_body.deviation(hops[i].strut_over_body));
        let wheel_over_strut =
            Corner::ALL.map(|i| corners[i].wheel_over_strut.deviation(hops[i].wheel_over_strut));
        for corner in Corner::ALL {
            corners[corner].note_hop(apart(&wheel_over_strut, corner), tuning);
        }
        let hop_shifted = corners.each_ref().map(|corner| corner.hop_shifted);
        for corner in Corner::ALL {
            let beside = corner.others().into_iter().any(|other| hop_shifted[other]);
            corners[corner].judge(at, apart(&strut_over_body, corner), explained[corner], beside, tuning);
        }
    } else {
        for (corner, _) in corners.iter_mut().zip(explained).filter(|(_, explained)| !explained) {
            corner.wait(at[1], tuning);
        }
    }
    for (i, corner) in corners.iter_mut().enumerate() {
        match (corner.is_suspected() || corner.hop_shifted, explained[i]) {
            (true, _) => {}
            // It was wrong before its usual was known: what was learned is not.
            (false, true) => *corner = WheelGainJump::new(),
            (false, false) => corner.learn(hops[i], tuning),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK_S: f64 = 0.5;
    const TUNING: Tuning = Tuning::DEFAULT;

    /// Four corners that have driven a minute: body and wheel as 4.5 in a log, a little more or less by corner and block.
    struct Car {
        corners: [WheelGainJump<f64>; 4],
        blocks: u32,
        /// By how much the hops are quicker than before.
        hop_shift: [f64; 4],
    }

    impl Car {
        fn that_has_driven(blocks: u32) -> Self {
            let mut car = Self { corners: [WheelGainJump::new(); 4], blocks: 0, hop_shift: [0.0; 4] };
            for _ in 0..blocks {
                car.block([0.0; 4], false);
                assert_eq!(car.suspects(), [false; 4]);
            }
            car
        }

        fn block(&mut self, more: [f64; 4], explained: bool) {
            self.blocks += 1;
            let baseline = |i: usize| 4.5 + 0.2 * (f64::from(self.blocks) * (1.0 + 0.7 * i as f64)).sin();
            let hops = [0, 1, 2, 3].map(|i| Hop {
                strut_over_body: baseline(i) + more[i],
                wheel_over_strut: 8.0 + self.hop_shift[i],
            });
            let at = [BLOCK_S * f64::from(self.blocks), BLOCK_S];
            jumps(&mut self.corners, at, &hops, [explained, false, false, false], &TUNING);
        }

        fn suspects(&self) -> [bool; 4] {
            self.corners.each_ref().map(WheelGainJump::is_suspected)
        }

        /// Seconds until the first corner's suspicion is `wanted`.
        fn until(&mut self, wanted: bool, more: f64, explained: bool) -> f64 {
            let from = self.blocks;
            while self.suspects()[0] != wanted {
                self.block([more, 0.0, 0.0, 0.0], explained);
                assert_eq!(self.suspects()[1..], [false; 3]);
                assert!(self.blocks - from < 1000, "never");
            }
            f64::from(self.blocks - from) * BLOCK_S
        }
    }

    #[test]
    fn a_gain_that_changes_is_suspected_within_three_seconds_and_until_it_is_back() {
        for gain in [0.5_f64, 2.0] {
            let mut car = Car::that_has_driven(120);
            let more = 2.0 * gain.ln();
            assert!(car.until(true, more, false) <= 3.0);
            for _ in 0..100 {
                car.block([more, 0.0, 0.0, 0.0], false);
                assert_eq!(car.suspects(), [true, false, false, false]);
            }
            assert!(car.until(false, 0.0, false) <= 4.0);
        }
    }

    #[test]
    fn holes_and_another_road_are_no_jump() {
        let mut car = Car::that_has_driven(120);
        // Every other wheel in turn meets a hole: the body above the others is shaken for a second.
        for i in 0..200 {
            let shaken = |corner: usize| if i % 5 < 2 && i / 5 % 4 != corner as u32 { -3.0 } else { 0.0 };
            car.block([0, 1, 2, 3].map(shaken), false);
            assert_eq!(car.suspects(), [false; 4], "{i}");
        }
        // A road on which all four answer otherwise; one that is rough on the left only.
        for more in [[1.5; 4], [0.0, -2.0, 0.0, -2.0]] {
            for i in 0..100 {
                car.block(more, false);
                assert_eq!(car.suspects(), [false; 4], "{i}");
            }
        }
    }

    #[test]
    fn what_stays_unexplained_is_another_car_in_the_end() {
        let mut car = Car::that_has_driven(120);
        car.until(true, 1.4, false);
        let lasted_s = car.until(false, 1.4, false);
        assert!((lasted_s - TUNING.change_longest_s).abs() < 2.0, "{lasted_s}");
        // But not while a wrong gain is reported.
        let mut car = Car::that_has_driven(120);
        car.until(true, 1.4, false);
        for _ in 0..1000 {
            car.block([1.4, 0.0, 0.0, 0.0], true);
            assert!(car.suspects()[0]);
        }
    }

    #[test]
    fn a_hop_that_is_slower_is_another_tire_and_no_gain() {
        let mut car = Car::that_has_driven(120);
        car.hop_shift[0] = -0.3;
        for _ in 0..300 {
            car.block([-1.4, 0.0, 0.0, 0.0], false);
            assert_eq!(car.suspects(), [false; 4]);
        }
        // By then it is the usual, and a gain that changes is seen again.
        assert!(car.until(true, 0.0, false) <= 3.0);
    }

    #[test]
    fn a_body_that_a_flat_tire_shakes_is_no_gain_and_one_of_a_half_is() {
        let beside_a_flat_tire = || Car { hop_shift: [0.0, 0.0, -0.3, 0.0], ..Car::that_has_driven(120) };
        let mut car = beside_a_flat_tire();
        for _ in 0..20 {
            car.block([-0.95, 0.0, 0.0, 0.0], false);
            assert_eq!(car.suspects(), [false; 4]);
        }
        assert!(beside_a_flat_tire().until(true, 2.0 * 0.5_f64.ln(), false) <= 3.0);
        // Where nothing else has happened as much is suspected.
        assert!(Car::that_has_driven(120).until(true, -0.95, false) <= 3.0);
    }

    #[test]
    fn what_was_wrong_from_the_start_is_not_the_usual() {
        let mut car = Car::that_has_driven(0);
        for active in [false, true] {
            for _ in 0..60 {
                car.block([1.4, 0.0, 0.0, 0.0], active);
                assert_eq!(car.suspects(), [false; 4]);
            }
        }
        for _ in 0..60 {
            car.block([0.0; 4], false);
            assert_eq!(car.suspects(), [false; 4]);
        }
        assert!(car.until(true, 1.4, false) <= 3.0);
    }

    #[test]
    fn a_suspicion_ends_while_another_corner_is_known_to_be_wrong() {
        let mut car = Car::that_has_driven(120);
        let block = |car: &mut Car, explained: [bool; 4]| {
            let at = [0.0, BLOCK_S];
            let hops =
                [1.4, 0.0, 0.0, 0.0].map(|more| Hop { strut_over_body: 4.5 + more, wheel_over_strut: 8.0 });
            jumps(&mut car.corners, at, &hops, explained, &TUNING);
        };
        car.until(true, 1.4, false);
        let mut lasted_s = 0.0;
        while car.suspects()[0] {
            block(&mut car, [false, true, false, false]);
            lasted_s += BLOCK_S;
            assert!(lasted_s < 2.0 * TUNING.change_longest_s, "never");
        }
        assert!((lasted_s - TUNING.change_longest_s).abs() < 5.0, "{lasted_s}");
    }

    #[test]
    fn nothing_is_suspected_before_the_usual_is_known() {
        // As many blocks off as make a jump later, and none of them suspect yet.
        let mut car = Car::that_has_driven(TUNING.jump_known_blocks - 5);
        for _ in 0..5 {
            car.block([3.0, 0.0, 0.0, 0.0], false);
            assert_eq!(car.suspects(), [false; 4]);
        }
        let mut car = Car::that_has_driven(120);
        for _ in 0..5 {
            car.block([3.0, 0.0, 0.0, 0.0], false);
        }
        assert_eq!(car.suspects(), [true, false, false, false]);
    }
}
