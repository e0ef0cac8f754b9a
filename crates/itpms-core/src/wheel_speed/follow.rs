//! Whether the wheels of each axle follow the car's bends and accelerations as wheels do (docs/math/wheel-speed.md, eq. 7d): a speed that comes
//! late, or one wheel's under another's name, does not, and would be a loss whenever the car speeds up or turns.

use super::block::{BLOCK_S, Block};
use super::config::{DrivenAxle, WheelSpeedConfig};
use super::state::{AXLE, FRONT, REAR, SCALE};
use crate::diagnosis::{Malfunction, Place, Sensor};
use crate::memory::Blank;
use crate::model::{Corner, SURELY_SD, Wheels};
use crate::real::Real;
use crate::wheel_speed::Tuning;

/// How long what a place of the road does to a ratio lasts, in s.
const PLACE_S: f64 = 2.0;
/// Share of a bend that wheels follow the other way round, at least, which are exchanged left for right, and front over rear where two are exchanged
/// across; and below which it is doubtful.
const ACROSS: f64 = 0.5;
const MAYBE_TURNED: f64 = -0.2;

#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Following<T> {
    begun: bool,
    yaw_known: bool,
    /// Axles whose wheels turn alike in bends, which reads as a delay: none is read from them.
    coupled: [bool; 2],
    /// Usual ratios, the part of them due to bends, and the acceleration over the speed.
    usual: [T; 3],
    usual_bend: [T; 2],
    usual_speeding: T,
    /// Sums of each ratio less its bend times the acceleration over the speed, and of the square of the latter.
    late: [T; 3],
    speeding: T,
    /// Sum of squares of each axle's ratio less its bend.
    left: [T; 2],
    /// Sums of each ratio times its bend, and of the square of the bend.
    turned: [T; 3],
    bends: [T; 2],
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Astray {
    /// This wheel's speed comes late.
    Late(Corner),
    /// These two are exchanged, of an axle or across.
    Exchanged([Corner; 2]),
    /// Front and rear of a side are exchanged.
    Axles,
}

impl<T: Real> Following<T> {
    /// The next block does not follow the last one.
    pub(super) fn interrupt(&mut self) {
        self.begun = false;
    }

    /// Takes a block, braking or not, with the offset of its yaw rate, whether that is believed, and the axles whose wheels are coupled.
    pub(super) fn take(
        &mut self,
        block: &Block<T>,
        config: &WheelSpeedConfig<T>,
        bias_rad_s: T,
        believed: bool,
        coupled: [bool; 2],
    ) {
        self.coupled = coupled;
        let (tuning, v, ratio) = (config.tuning(), block.speed_m_s, block.ratio);
        let [memory_s, ..] = tuning.memory_s;
        // A tight bend makes more of a ratio than radii could.
        let sane = ratio.iter().all(|ratio| ratio.abs() < T::lit(5.0 * tuning.absurd_ratio));
        let calm = block.lateral_m_s2 < T::lit(tuning.most_force_m_s2);
        if !(v > T::lit(tuning.least_speed_m_s) && calm && sane) {
            return;
        }
        self.yaw_known = believed && block.yaw_rate_rad_s.is_some();
        let yaw = block.yaw_rate_rad_s.map_or(T::zero(), |yaw| yaw - bias_rad_s);
        let bend = [config.track_front_m, config.track_rear_m].map(|track| -T::lit(SCALE) * track * yaw / v);
        let speeding = block.slope_m_s2 / v;
        if !self.begun {
            (self.usual, self.usual_bend, self.usual_speeding, self.begun) = (ratio, bend, speeding, true);
            return;
        }
        let kept = T::lit(1.0 - BLOCK_S / memory_s);
        let follow = |usual: &mut T, now: T| {
            let beyond = now - *usual;
            *usual += T::lit(BLOCK_S / tuning.usual_s) * beyond;
            beyond
        };
        let speeding = follow(&mut self.usual_speeding, speeding);
        self.speeding = kept * self.speeding + speeding * speeding;
        let between = follow(&mut self.usual[AXLE], ratio[AXLE]);
        let mut mean_bend = T::zero();
        for i in [FRONT, REAR] {
            let bend = follow(&mut self.usual_bend[i], bend[i]);
            let ratio = follow(&mut self.usual[i], ratio[i]);
            let known_bend = if self.yaw_known { bend } else { T::zero() };
            let left = ratio - known_bend;
            self.late[i] = kept * self.late[i] + left * speeding;
            self.left[i] = kept * self.left[i] + left * left;
            mean_bend += T::lit(0.5) * bend;
            self.turned[i] = kept * self.turned[i] + ratio * bend;
            self.bends[i] = kept * self.bends[i] + bend * bend;
        }
        self.late[AXLE] = kept * self.late[AXLE] + between * speeding;
        self.turned[AXLE] = kept * self.turned[AXLE] + between * mean_bend;
    }

    /// Delay in s of the left wheel of each axle against the right one; without a yaw rate, which takes bends off, all of it of the axle
    /// that shows more. `None` where too little was seen. Of coupled wheels none.
    fn delays_s(&self, tuning: &Tuning) -> Option<[T; 2]> {
        if !(self.speeding > T::lit(tuning.speeding_seen)) {
            return None;
        }
        let [front, rear, _] = self.late.map(|late| -late / (T::lit(SCALE) * self.speeding));
        match (self.yaw_known, self.coupled) {
            (true, [front_coupled, rear_coupled]) => {
                let of = |coupled, delay| if coupled { T::zero() } else { delay };
                Some([of(front_coupled, front), of(rear_coupled, rear)])
            }
            // A bend does the same to both.
            (false, [false, false]) => Some([front - rear, T::zero()]),
            (false, _) => None,
        }
    }

    /// Sd of an axle's delay in s, by what neither bends nor the delay leave of its ratio: a place of the road, which does so for
    /// [`PLACE_S`], is one sample of it.
    fn delay_sd_s(&self, axle: usize, tuning: &Tuning) -> T {
        let [memory_s, ..] = tuning.memory_s;
        let explained = self.late[axle] * self.late[axle] / self.speeding;
        let left = (self.left[axle] - explained).at_least(T::zero());
        (left * T::lit(PLACE_S / memory_s) / self.speeding).sqrt() * T::lit(1.0 / SCALE)
    }

    /// Whether a ratio follows at least this share of an axle's change of ratio in bends.
    fn follows(&self, ratio: usize, axle: usize, share: f64) -> bool {
        self.turned[ratio] > T::lit(share) * self.bends[axle]
    }

    /// The two wheels across that are exchanged: what bends do to the axles is between them.
    fn across(&self, bends: f64) -> Option<[Corner; 2]> {
        let [fl, fr, rl, rr] = Corner::ALL;
        let stays = |i: usize| self.bends[i] > T::lit(bends) && !self.follows(i, i, ACROSS);
        if !(stays(FRONT) && stays(REAR)) {
            return None;
        }
        if self.follows(AXLE, FRONT, ACROSS) {
            return Some([fr, rl]);
        }
        (!self.follows(AXLE, FRONT, -ACROSS)).then_some([fl, rr])
    }

    /// Whether what looks like a loss may be a speed that does not follow.
    pub(super) fn is_doubtful(&self, tuning: &Tuning) -> bool {
        let ([bends, _], [_, doubted_s, exchanged_s]) = (tuning.bends_seen, tuning.late_s);
        let turned = |i: usize| self.bends[i] > T::lit(bends) && !self.follows(i, i, MAYBE_TURNED);
        if turned(FRONT) || turned(REAR) || self.across(bends).is_some() {
            return true;
        }
        let Some([front, rear]) = self.delays_s(tuning) else { return false };
        let late = [front, rear].iter().any(|delay| delay.abs() > T::lit(doubted_s));
        late || exchanged([front, rear], exchanged_s)
    }

    /// What surely does not follow; on a slippery road the driven wheels may do as they like.
    /// `slip_s`: the slip per m/s² times the speed, as which it looks like a delay, and what it is on a dry road.
    pub(super) fn astray(
        &self,
        config: &WheelSpeedConfig<T>,
        slippery: bool,
        [slip_s, dry_slip_s]: [T; 2],
    ) -> Option<Astray> {
        let (tuning, driven) = (config.tuning(), config.driven);
        let ([_, bends], [late_s, doubted_s, _]) = (tuning.bends_seen, tuning.late_s);
        let seen = |i: usize| self.bends[i] > T::lit(bends);
        let [fl, fr, rl, rr] = Corner::ALL;
        for (i, other, axle) in [(FRONT, REAR, [fl, fr]), (REAR, FRONT, [rl, rr])] {
            let alone = !self.follows(i, i, -ACROSS) && self.follows(other, other, ACROSS);
            if seen(i) && seen(other) && alone {
                return Some(Astray::Exchanged(axle));
            }
        }
        if let Some(two) = self.across(bends) {
            return Some(Astray::Exchanged(two));
        }
        if !self.yaw_known {
            return None;
        }
        let delays = self.delays_s(tuning)?;
        // By how much the front axle speeds up before the rear one: its slip, of which nothing is left where one of its wheels is exchanged.
        let ahead_s = self.late[AXLE] / (T::lit(SCALE) * self.speeding);
        let ahead_s = [ahead_s, -ahead_s];
        let slips = |axle: usize, least_s: T| driven.axles()[axle] && !(ahead_s[axle] < least_s);
        let half = T::lit(0.5) * dry_slip_s;
        let pushed = driven != DrivenAxle::Both && (slips(FRONT, half) || slips(REAR, half));
        if !slippery && !pushed && exchanged(delays, doubted_s) {
            return Some(Astray::Axles);
        }
        let [front, rear] = delays.map(|delay| delay.abs());
        let (axle, delay, other) = if front > rear { (0, delays[0], rear) } else { (1, delays[1], front) };
        // What both axles do is a bend, and coupled wheels do not show one.
        let alone = other < T::lit(0.5) * delay.abs() && self.coupled == [false; 2];
        // A driven wheel that slips more than the other brings its axle forward; one that comes late holds it back, by half of the delay.
        let is_driven = driven.axles()[axle];
        let slips = slips(axle, dry_slip_s - T::lit(0.25) * delay.abs());
        // They slip unequally in proportion to the acceleration, by twice the usual share of the slip at most.
        let by_slip_s = if is_driven { T::lit(2.0 * tuning.unequal_share) * slip_s } else { T::zero() };
        let doubt_s = T::lit(SURELY_SD) * self.delay_sd_s(axle, tuning);
        let late = alone && delay.abs() > T::lit(late_s) + by_slip_s + doubt_s && !slips && !slippery;
        let corner = *Corner::ALL.get(2 * axle + usize::from(!(delay > T::zero())))?;
        late.then_some(Astray::Late(corner))
    }
}

/// Whether front and rear lag by about as much, in opposite directions.
fn exchanged<T: Real>([front, rear]: [T; 2], least_s: f64) -> bool {
    let (small, large) = (front.abs().at_most(rear.abs()), front.abs().at_least(rear.abs()));
    front * rear < T::zero() && small > T::lit(least_s) && small > T::lit(0.5) * large
}

impl Astray {
    pub(super) fn malfunction<T>(self) -> (Wheels, Malfunction<T>) {
        let sensor = |corner: Corner| Sensor { corner, place: Place::WheelSpeed };
        match self {
            Astray::Late(corner) => (corner.into(), Malfunction::Inconsistent(corner)),
            Astray::Exchanged([a, b]) => {
                (Wheels::from(a) | Wheels::from(b), Malfunction::Swapped(sensor(a), sensor(b)))
            }
            Astray::Axles => (Corner::ALL.into_iter().collect(), Malfunction::SwappedAxles),
        }
    }
}

#[cfg(test)]
mod tests {
    // Where another crate of the build brings `std`, numbers have these functions by themselves.
    #[allow(unused_imports)]
    use nalgebra::ComplexField;

    use super::*;

    const TRACK: f64 = 1.55;
    const FREE: [bool; 2] = [false; 2];

    /// Speeds of the four wheels of a car that speeds up, slows down and turns, on tires of unequal size; `slip`: of the front wheels.
    fn speeds(time_s: f64, slip: f64) -> ([f64; 4], f64, f64) {
        let v = 15.0 + 4.0 * (time_s / 7.0).sin();
        let slope = 4.0 / 7.0 * (time_s / 7.0).cos();
        let yaw = 0.08 * (time_s / 5.0).sin();
        let side = 0.5 * TRACK * yaw;
        let front = 1.0 + slip * slope;
        ([1.001 * front * (v - side), front * (v + side), 0.9995 * (v - side), v + side], yaw, slope)
    }

    fn driven(
        config: &WheelSpeedConfig<f64>,
        wheel: impl Fn(usize, f64) -> f64,
        yaw_gain: f64,
        coupled: [bool; 2],
    ) -> Following<f64> {
        let mut following = Following::<f64>::BLANK;
        for k in 0..240 {
            let time_s = 0.5 * f64::from(k);
            let [fl, fr, rl, rr] = core::array::from_fn(|i| wheel(i, time_s));
            let ratio =
                [(fl / fr).ln(), (rl / rr).ln(), 0.5 * (fl * fr / (rl * rr)).ln()].map(|ln| SCALE * ln);
            let (_, yaw, slope) = speeds(time_s, 0.0);
            let speed_m_s = 15.0 + 4.0 * (time_s / 7.0).sin();
            let yaw_rate_rad_s = Some(yaw_gain * yaw);
            let block = Block { ratio, speed_m_s, yaw_rate_rad_s, slope_m_s2: slope, ..Block::BLANK };
            following.take(&block, config, 0.0, true, coupled);
        }
        following
    }

    #[test]
    fn a_late_speed_is_known_by_its_delay_and_an_exchanged_one_by_the_bends() {
        let config = WheelSpeedConfig::new(2.7, TRACK, TRACK, DrivenAxle::Front);
        let astray = |following: &Following<f64>| following.astray(&config, false, [3.5e-3 * 15.0; 2]);
        let usual = |i: usize, time_s: f64| speeds(time_s, 3.5e-3).0[i];
        let right = driven(&config, usual, 1.0, FREE);
        assert!(astray(&right).is_none() && !right.is_doubtful(&Tuning::DEFAULT), "{right:?}");
        for (late, corner) in [(0, Corner::FrontLeft), (1, Corner::FrontRight), (3, Corner::RearRight)] {
            for delay_s in [0.1, 0.2, 0.5] {
                let by_s = |i: usize| if i == late { delay_s } else { 0.0 };
                let following = driven(&config, |i, time_s| usual(i, time_s - by_s(i)), 1.0, FREE);
                let found = following.delays_s(&Tuning::DEFAULT).unwrap()[late / 2];
                let expected = if late % 2 == 0 { delay_s } else { -delay_s };
                // To first order; what is usual follows by 10 s.
                assert!((found / expected - 1.0).abs() < 0.15, "{late} {delay_s}: {found}");
                assert_eq!(astray(&following), Some(Astray::Late(corner)), "{late} {delay_s}");
            }
        }
        // A tire that has lost a third is none of this.
        let low = driven(&config, |i, time_s| usual(i, time_s) * if i == 2 { 1.003 } else { 1.0 }, 1.0, FREE);
        assert!(astray(&low).is_none() && !low.is_doubtful(&Tuning::DEFAULT));
        let exchanged = |a: usize, b: usize| {
            let of =
                |i: usize| [(a, b), (b, a)].into_iter().find(|(from, _)| *from == i).map_or(i, |(_, to)| to);
            driven(&config, |i, time_s| usual(of(i), time_s), 1.0, FREE)
        };
        let [fl, fr, rl, rr] = Corner::ALL;
        assert_eq!(astray(&exchanged(0, 1)), Some(Astray::Exchanged([fl, fr])));
        assert_eq!(astray(&exchanged(2, 3)), Some(Astray::Exchanged([rl, rr])));
        assert_eq!(astray(&exchanged(0, 3)), Some(Astray::Exchanged([fl, rr])));
        assert_eq!(astray(&exchanged(1, 2)), Some(Astray::Exchanged([fr, rl])));
        // Front and rear of a side differ by their slip alone: 3.5e-3 per m/s² at 15 m/s are 50 ms.
        assert_eq!(astray(&exchanged(0, 2)), Some(Astray::Axles));
        assert!(exchanged(0, 2).is_doubtful(&Tuning::DEFAULT));
        // A sensor turned round is another matter: both axles do the same.
        assert!(astray(&driven(&config, usual, -1.0, FREE)).is_none());
    }

    /// Wheels that a preload keeps alike follow no bend; where the car slows down for its bends, that reads as a delay.
    #[test]
    fn wheels_of_an_axle_that_turn_alike_are_not_late() {
        let config = WheelSpeedConfig::new(2.7, TRACK, TRACK, DrivenAxle::Rear);
        let alike = |i: usize, time_s: f64| {
            let (speeds, ..) = speeds(time_s, 0.0);
            if i < 2 { speeds[i] } else { 0.5 * (speeds[2] + speeds[3]) }
        };
        let late = |coupled| {
            let following = driven(&config, alike, 1.0, coupled);
            let [_, delay_s] = following.delays_s(&Tuning::DEFAULT).unwrap();
            (delay_s.abs(), following.astray(&config, false, [3.5e-3 * 15.0; 2]))
        };
        assert!(late(FREE).0 > Tuning::DEFAULT.late_s[1]);
        assert_eq!(late([false, true]), (0.0, None));
    }
}
