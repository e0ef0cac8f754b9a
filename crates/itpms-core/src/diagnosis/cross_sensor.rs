//! Faults that show between several sensors: swapped, or with a wrong gain.

use crate::diagnosis::debounce::{DebounceTimes, Evidence};
use crate::diagnosis::fault_latch::{FaultLatch, SwapPattern};
use crate::diagnosis::matching::{Changed, Following, PAIRS, Plane, following, gathered, median};
use crate::diagnosis::moments::Moments;
use crate::diagnosis::signals::{BOUNCE_HZ, Block, SLOW_HZ, width_hz};
use crate::diagnosis::single_sensor::evidence;
use crate::diagnosis::wheel_gain::WheelGains;
use crate::diagnosis::{Fault, Malfunction, Place, Sensor, Tuning};
use crate::memory::Blank;
use crate::model::{Corner, HOP_BAND_HZ, SURELY_SD, Wheels};
use crate::real::Real;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct CrossSensorPlausibility<T: Real> {
    /// Power density in (m/s²)²/Hz of each corner's sensors' noise.
    noise_density: [T; 4],
    hop: Moments<T, 8>,
    bounce: Moments<T, 4>,
    /// Logs of hop power, wheel over body, averaged; NaN: unknown.
    ratio: [T; 4],
    /// The same in the last block alone.
    newest_ratio: [T; 4],
    patterns: [SwapPattern; 4],
    /// A body moves like a wheel, or the other way round; by corner.
    odd: [FaultLatch<T>; 4],
    /// Two wheels or two bodies are swapped, and how much speaks for it; by pair.
    pairs: [FaultLatch<T>; 6],
    for_swaps: [T; 6],
    /// Both sensors of corners are swapped, left with right or front with rear.
    corners: [FaultLatch<T>; 2],
    body_gains: [FaultLatch<T>; 4],
    wheel_gains: WheelGains<T>,
    /// A wheel sensor is upside down.
    reversed: [FaultLatch<T>; 4],
}

impl<T: Real> CrossSensorPlausibility<T> {
    pub(crate) fn configure(&mut self, noise_power: [T; 4], rate_hz: f64) {
        self.noise_density = noise_power.map(|power| power * T::lit(2.0 / rate_hz));
        self.hop = Moments::BLANK;
        self.bounce = Moments::BLANK;
        (self.ratio, self.newest_ratio) = ([T::lit(f64::NAN); 4], [T::lit(f64::NAN); 4]);
        self.patterns = [SwapPattern::AsLabeled; 4];
        self.odd.fill(FaultLatch::new());
        self.pairs.fill(FaultLatch::new());
        self.for_swaps = [T::zero(); 6];
        self.corners.fill(FaultLatch::new());
        self.body_gains.fill(FaultLatch::new());
        self.wheel_gains = WheelGains::new();
        self.reversed.fill(FaultLatch::new());
    }

    /// Drops what is only suspected: with a sensor out of order it cannot be checked whether they hold.
    pub(crate) fn drop_suspicions(&mut self) {
        let latches = self.pairs.iter_mut().chain(&mut self.corners).chain(&mut self.reversed);
        latches.for_each(FaultLatch::drop_suspicion);
        for (pair, sum) in self.pairs.iter().zip(&mut self.for_swaps) {
            if !pair.debouncer.is_active() {
                *sum = T::zero();
            }
        }
        self.wheel_gains.drop_suspicions();
    }

    /// Takes a block of a car that drives, with all eight sensors there and none of them odd by itself.
    pub(crate) fn take(&mut self, at: [f64; 2], block: &Block<T>, tuning: &Tuning) {
        if self.patterns != [SwapPattern::AsLabeled; 4] {
            return;
        }
        self.average(block, tuning);
        let plane = self.plane(tuning);
        let following = self.hop.mean(tuning.filled).and_then(|hop| following(&hop, tuning));
        self.judge_pairs(at, following.as_ref(), plane.as_ref(), tuning);
        self.judge_corners(at, following.as_ref(), plane.as_ref(), tuning);
        self.judge_direction(at, following.as_ref(), plane.as_ref(), tuning);
        self.judge_body_gains(at, plane.as_ref(), tuning);
    }

    fn noise(&self, i: Corner, band_hz: [f64; 2], tuning: &Tuning) -> T {
        self.noise_density[i] * T::lit(width_hz(band_hz) * tuning.over_noise)
    }

    fn average(&mut self, block: &Block<T>, tuning: &Tuning) {
        let [hop, bounce] =
            [HOP_BAND_HZ, BOUNCE_HZ].map(|band_hz| Corner::ALL.map(|i| self.noise(i, band_hz, tuning)));
        // The struts turn the wheels' motion into the bodies': both must be there.
        let least = T::lit(tuning.hop_over_noise / tuning.over_noise);
        if (0..4).all(|i| block.hop[(4 + i, 4 + i)] > least * hop[i]) {
            let wheels = block.hop.fixed_view::<4, 4>(4, 4).trace();
            self.hop.add_block(&block.hop, wheels, tuning.hop_blocks);
        }
        if (0..4).any(|i| block.bounce[(i, i)] > bounce[i]) {
            self.bounce.add_block(&block.bounce, block.bounce.trace(), tuning.bounce_blocks);
        }
    }

    fn plane(&self, tuning: &Tuning) -> Option<Plane<T>> {
        Plane::of(&self.bounce.mean(tuning.filled)?, T::zero())
    }

    /// Takes a block of a car that drives: does each wheel hop, and each body not? `alive`: the corners whose sensors move
    /// and whose values come.
    pub(crate) fn compare_wheel_and_body(
        &mut self,
        at: [f64; 2],
        block: &Block<T>,
        alive: [bool; 4],
        tuning: &Tuning,
    ) {
        self.newest_ratio = [T::lit(f64::NAN); 4];
        let body = |corner: Corner| block.hop[(corner.index(), corner.index())];
        let others = |power: &dyn Fn(Corner) -> T, own: Corner| {
            let mut alike = [T::zero(); 4];
            let others = Corner::ALL.into_iter().filter(|&other| other != own && alive[other]);
            median(gathered(others.map(power), &mut alike))
        };
        for corner in Corner::ALL.into_iter().filter(|&corner| alive[corner]) {
            let (b, w) = (body(corner), block.wheel_hop[corner]);
            if !(b.max(w) > self.noise(corner, HOP_BAND_HZ, tuning)) {
                continue;
            }
            let ratio = (w / b).ln();
            self.newest_ratio[corner] = ratio;
            let before = self.ratio[corner];
            let share = T::lit(1.0 / tuning.ratio_blocks);
            self.ratio[corner] = if before.is_finite() { before + share * (ratio - before) } else { ratio };
            let ratio = self.ratio[corner];
            let sensor = |place| Sensor { corner, place };
            // A wheel that reads little, or a body that reads much, is not a swap: then only one of the two differs from the other corners.
            let body_is_wheel = !((b / others(&body, corner)).ln() < T::lit(tuning.over_alike));
            let wheel_is_body =
                !((others(&|other| block.wheel_hop[other], corner) / w).ln() < T::lit(tuning.over_alike));
            self.patterns[corner] = match (ratio < T::lit(tuning.swapped_ratio), body_is_wheel, wheel_is_body)
            {
                (true, true, true) if ratio < T::lit(tuning.crossed_ratio) => SwapPattern::Crossed,
                (true, true, false) => SwapPattern::BodyIsWheel,
                (true, false, true) => SwapPattern::WheelIsBody,
                _ => SwapPattern::AsLabeled,
            };
            let odd = self.patterns[corner] != SwapPattern::AsLabeled;
            let malfunction = match self.patterns[corner] {
                SwapPattern::Crossed => Malfunction::Swapped(sensor(Place::Body), sensor(Place::Wheel)),
                _ => Malfunction::Inconsistent(corner),
            };
            let evidence = evidence(odd, ratio > T::lit(tuning.normal_ratio));
            self.odd[corner].update(at, evidence, tuning.compared, || malfunction);
        }
    }

    /// Whether body and wheel of a corner may be swapped.
    pub(crate) fn is_odd(&self, corner: Corner, tuning: &Tuning) -> bool {
        self.patterns[corner] != SwapPattern::AsLabeled
            || self.newest_ratio[corner] < T::lit(tuning.normal_ratio)
            || self.odd[corner].debouncer.is_suspected()
    }

    /// A car that stands.
    pub(crate) fn stand(&mut self, time_s: f64) {
        self.wheel_gains.stand(time_s);
    }

    /// Takes the block that was just compared, of a car none of whose sensors is odd by itself: is a wheel's gain wrong? `settled`: it drives, and
    /// the filters have forgotten what was wrong.
    pub(crate) fn judge_wheel_gains(
        &mut self,
        at: [f64; 2],
        block: &Block<T>,
        settled: bool,
        tuning: &Tuning,
    ) {
        // A wheel's effect on a body is the corner's own only while all bodies are one.
        let warp = self.plane(tuning).map(|plane| plane.warp);
        let latches = self.odd.iter().chain(&self.pairs).chain(&self.reversed).chain(&self.corners);
        let explained = latches.chain(&self.body_gains).any(|latch| latch.debouncer.is_active());
        if explained || warp.is_some_and(|warp| warp > T::lit(tuning.bent_warp)) {
            self.wheel_gains.drop_suspicions();
            return;
        }
        let flat = warp.is_some_and(|warp| warp < T::lit(tuning.flat_warp));
        let least = T::lit(tuning.hop_over_noise / tuning.over_noise);
        let moves = |corner: Corner| {
            let i = corner.index();
            let loud = block.hop[(i, i)] > least * self.noise(corner, HOP_BAND_HZ, tuning);
            let reads =
                loud && self.newest_ratio[corner].is_finite() && block.hop[(4 + i, 4 + i)] > T::zero();
            // A swapped sensor reads so much more than its own that sums would be long in forgetting it.
            reads && !self.is_odd(corner, tuning)
        };
        if flat && Corner::ALL.into_iter().all(moves) {
            let sum = |powers: T, power: T| powers + power;
            let slow = block.slow.iter().copied().fold(T::zero(), sum);
            // A body's sensor and a wheel's at each corner.
            let noise = Corner::ALL.map(|i| T::lit(2.0) * self.noise(i, SLOW_HZ, tuning));
            let has_slow = slow > noise.into_iter().fold(T::zero(), sum);
            self.wheel_gains.take(at, block, [settled, has_slow], tuning);
        }
    }

    fn judge_pairs(
        &mut self,
        at: [f64; 2],
        following: Option<&Following<T>>,
        plane: Option<&Plane<T>>,
        tuning: &Tuning,
    ) {
        let bent = plane.filter(|plane| plane.warp > T::lit(tuning.bent_warp));
        let place = if bent.is_some() { Place::Body } else { Place::Wheel };
        let Some(Following { own_over_other, .. }) = following else { return };
        let least = own_over_other.iter().fold(own_over_other[0], |least, other| least.min(*other));
        let (step_s, sure) = (T::lit(at[1]), T::lit(tuning.cusum));
        for (k, [i, j]) in PAIRS.into_iter().enumerate() {
            let own = own_over_other[k];
            // Bodies that are no plane, and none if two of them change places, are not one rigid body: each follows other wheels, too.
            if !own.is_finite() || bent.is_some_and(|plane| !plane.is_put_back_by([i, j], tuning)) {
                continue;
            }
            if own > T::zero() || own <= least {
                self.for_swaps[k] = (self.for_swaps[k] - own * step_s).clamp(T::zero(), sure);
            }
            let sum = self.for_swaps[k];
            let set_s = if sum < sure { f64::INFINITY } else { 0.0 };
            let evidence = evidence(sum > sure * T::lit(tuning.cusum_suspected), !(sum > T::zero()));
            let sensor = |corner| Sensor { corner, place };
            let malfunction = || Malfunction::Swapped(sensor(i), sensor(j));
            self.pairs[k].update(at, evidence, DebounceTimes { set_s, clear_s: 0.0 }, malfunction);
        }
    }

    /// Bodies that follow their wheels but are no plane as they are, and one if two corners change places.
    fn judge_corners(
        &mut self,
        at: [f64; 2],
        following: Option<&Following<T>>,
        plane: Option<&Plane<T>>,
        tuning: &Tuning,
    ) {
        let own = |f: &Following<T>| f.own_over_other.iter().all(|log| *log > T::zero());
        let follows = following.is_some_and(own);
        for (word, changed) in self.corners.iter_mut().zip([Changed::Sides, Changed::Axles]) {
            let evidence = plane.map_or(Evidence::NoData, |plane| {
                evidence(
                    follows && plane.changed_places(tuning) == Some(changed),
                    plane.warp < T::lit(tuning.flat_warp),
                )
            });
            word.update(at, evidence, tuning.swap, || match changed {
                Changed::Sides => Malfunction::SwappedSides,
                Changed::Axles => Malfunction::SwappedAxles,
            });
        }
    }

    /// A body that goes down when its wheel goes up, while the bodies are one plane: the wheel's sensor is upside down.
    fn judge_direction(
        &mut self,
        at: [f64; 2],
        following: Option<&Following<T>>,
        plane: Option<&Plane<T>>,
        tuning: &Tuning,
    ) {
        let flat = plane.is_some_and(|plane| plane.warp < T::lit(tuning.bent_warp));
        for corner in Corner::ALL {
            let evidence = following.filter(|_| flat).map_or(Evidence::NoData, |following| {
                let (own, sd) = (following.own[corner], following.own_sd[corner]);
                evidence(own < T::lit(-SURELY_SD) * sd, own > T::zero())
            });
            let sensor = Sensor { corner, place: Place::Wheel };
            let gain = -T::one();
            self.reversed[corner].update(at, evidence, tuning.swap, || Malfunction::Gain { sensor, gain });
        }
    }

    fn judge_body_gains(&mut self, at: [f64; 2], plane: Option<&Plane<T>>, tuning: &Tuning) {
        for corner in Corner::ALL {
            let mut gain = T::one();
            let evidence = plane.map_or(Evidence::NoData, |plane| {
                gain = plane.gain;
                let gains = [gain, plane.heave_gain];
                let within = |gain: T, log: f64| gain > T::zero() && gain.ln().abs() < T::lit(log);
                let wrong =
                    gains.iter().all(|&gain| gain.is_finite() && !within(gain, tuning.body_gain_wrong))
                        && (gain > T::one()) == (plane.heave_gain > T::one());
                let his = plane.wrong_gain(tuning) == Some(corner);
                let fine = gains.iter().any(|&gain| within(gain, tuning.body_gain_fine));
                evidence(
                    his && wrong && plane.warp > T::lit(0.5 * tuning.flat_warp),
                    fine || plane.warp < T::lit(0.3 * tuning.flat_warp),
                )
            });
            let sensor = Sensor { corner, place: Place::Body };
            self.body_gains[corner]
                .update(at, evidence, tuning.body_gain, || Malfunction::Gain { sensor, gain });
        }
    }

    /// Faults by the first corner they name.
    pub(crate) fn faults(&self) -> [Option<Fault<T>>; 4] {
        let mut faults = [None; 4];
        let crossed = self.crossed();
        let odd = if crossed.is_some() { &self.odd[..0] } else { &self.odd[..] };
        let latches = odd.iter().chain(&self.pairs).chain(&self.reversed);
        let latches = latches.chain(&self.corners).chain(&self.body_gains);
        let all =
            crossed.into_iter().chain(latches.filter_map(FaultLatch::fault)).chain(self.wheel_gains.fault());
        for fault in all {
            if let Some(corner) = fault.malfunction.wheels().iter().next() {
                faults[corner].get_or_insert(fault);
            }
        }
        faults
    }

    /// A body that is a wheel at one corner and a wheel that is a body at another: these two are swapped.
    fn crossed(&self) -> Option<Fault<T>> {
        let only = |patterns: SwapPattern| {
            let is_one = |&i: &Corner| self.odd[i].debouncer.is_active() && self.patterns[i] == patterns;
            let mut those = Corner::ALL.into_iter().filter(is_one);
            those.next().filter(|_| those.next().is_none())
        };
        let (body, wheel) = (only(SwapPattern::BodyIsWheel)?, only(SwapPattern::WheelIsBody)?);
        let sensor = |corner, place| Sensor { corner, place };
        let swapped = Malfunction::Swapped(sensor(body, Place::Body), sensor(wheel, Place::Wheel));
        Some(Fault::from_debouncer(&self.odd[body].debouncer, swapped))
    }

    /// The corners whose gain may be about to be suspected.
    pub(crate) fn pending_fault(&self) -> Wheels {
        Corner::ALL.into_iter().filter(|&corner| self.wheel_gains.is_pending_fault(corner)).collect()
    }

    /// The corners whose sensors may be swapped, or whose gain may have changed. That a gain was wrong all the time is waited for.
    pub(crate) fn suspects(&self, tuning: &Tuning) -> Wheels {
        // A body that moves like its wheel is suspect at once.
        let odd = |corner: &Corner| self.newest_ratio[*corner] < T::lit(tuning.swapped_ratio);
        self.late_detection() | Corner::ALL.into_iter().filter(odd).collect()
    }

    /// Those among them of which it took seconds to find out.
    pub(crate) fn late_detection(&self) -> Wheels {
        let latches = self.odd.iter().chain(&self.pairs).chain(&self.reversed).chain(&self.corners);
        let suspected = latches.filter(|latch| latch.debouncer.is_suspected());
        suspected
            .filter_map(|word| word.malfunction.as_ref())
            .fold(self.wheel_gains.suspected(), |all, malfunction| all | malfunction.wheels())
    }
}
