//! Six hypotheses on the time between two blocks, each with its Gaussian: nothing, one of four tires leaks, or the block is an
//! outlier (an interacting multiple model filter; `docs/math/wheel-speed.md`, eq. 3-8).

use super::block::Block;
use super::calibration::{LEARNED, RadiusCalibration};
use super::config::{DrivenAxle, WheelSpeedConfig};
use super::gaussian::Gaussian;
use super::state::{
    AXLE, AXLE_FORCE, BEND, CHANGE, FRONT, FRONT_WANDER, OFFSET, REAR, REAR_WANDER, SCALE, SLIP, STATES,
    UNEQUAL_SLIP, YAW_BIAS, YAW_NOISE,
};
use crate::memory::Blank;
use crate::model::SEEN;
use crate::real::Real;
use crate::wheel_speed::Tuning;

/// Nothing happens; wheel `i` leaks: `1 + i`; the block is an outlier.
const MODES: usize = 6;
const QUIET: usize = 0;
const OUTLIER: usize = 5;

#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Filter<T> {
    modes: [Gaussian<T>; MODES],
    weight: [T; MODES],
    /// Slip of a dry road, in thousandths per m/s²: what the calibration found.
    dry_slip: T,
    /// See [`is_slippery`](Self::is_slippery).
    slippery: [bool; 2],
    /// Whether the last usable block had a yaw rate.
    pub yaw_known: bool,
    /// Whether its force was measured, grades included.
    pub grade_seen: bool,
}

impl<T: Real> Filter<T> {
    /// Nothing known of the car but how cars are; these are the radii of now, by which the offsets are meant.
    pub(super) fn begin(&mut self, config: &WheelSpeedConfig<T>, radius_1e3: &[T; 4]) {
        let tuning = config.tuning();
        let [slip_mean, slip_sd] = tuning.slip;
        let slip = match config.driven {
            DrivenAxle::Front => slip_mean,
            DrivenAxle::Rear => -slip_mean,
            DrivenAxle::Both => 0.0,
        };
        let mut mean = [T::zero(); STATES];
        mean[SLIP] = T::lit(slip);
        for (seen, radius) in SEEN.iter().zip(radius_1e3) {
            for (mean, seen) in mean[CHANGE..SLIP].iter_mut().zip(seen) {
                *mean += T::lit(*seen) * *radius;
            }
        }
        let mut sd = [T::lit(1e-4); STATES];
        [sd[OFFSET + FRONT], sd[OFFSET + REAR], sd[OFFSET + AXLE]] = tuning.offset_sd.map(T::lit);
        (sd[SLIP], sd[YAW_BIAS]) = (T::lit(slip_sd), T::lit(tuning.yaw_bias_sd));
        let [bend, bend_sd, _] = tuning.bend.map(T::lit);
        for (mean, sd) in mean[BEND..].iter_mut().zip(&mut sd[BEND..]) {
            (*mean, *sd) = (bend, bend_sd);
        }
        for (unequal, share) in sd[UNEQUAL_SLIP..BEND].iter_mut().zip(driven_shares(config.driven)) {
            *unequal += T::lit(tuning.unequal_share * share * slip_mean);
        }
        let disturbances = Disturbances::of(tuning, false, false);
        for (i, [wander, _]) in disturbances.0 {
            sd[i] = T::lit(wander);
        }
        let mut belief = Gaussian::independent(mean, sd);
        belief.widen_along(FRONT_WANDER, &[1.0, 1.0], disturbances.side::<T>());
        self.start(belief);
        self.dry_slip = T::lit(slip_mean + slip_sd);
    }

    /// As [`begin`](Self::begin), with what a calibration taught; any tire may have lost air since.
    pub(super) fn resume(&mut self, config: &WheelSpeedConfig<T>, calibration: &RadiusCalibration<T>) {
        self.begin(config, &[T::zero(); 4]);
        let mut belief = self.modes[QUIET];
        let rows = calibration.mean_1e3.iter().zip(&calibration.covariance_1e6);
        for (state, (mean, row)) in LEARNED.into_iter().zip(rows) {
            if let Some(place) = belief.mean.get_mut(state) {
                *place = *mean;
            }
            for (other, entry) in LEARNED.into_iter().zip(row) {
                belief.set(state, other, *entry);
            }
        }
        let [day, _, _] = config.tuning().slip_changes.map(T::lit);
        let slip = day * belief.mean[SLIP];
        belief.widen(SLIP, slip * slip);
        self.start(belief);
        self.dry_slip = dry_slip(&belief, config.tuning());
        self.stood(config);
    }

    /// Whether the slip is surely beyond that of a dry road, and whether it may be.
    pub(super) fn is_slippery(&self) -> [bool; 2] {
        self.slippery
    }

    fn see_slip(&mut self, tuning: &Tuning) {
        // By all hypotheses: a tire that has just lost air would be slip to one that knows of no loss.
        let belief = self.belief();
        let (slip, sd) = (belief.mean[SLIP].abs(), belief.get(SLIP, SLIP).sqrt());
        let beyond = T::lit(tuning.slippery) * self.dry_slip;
        self.slippery = [slip - sd, slip + sd].map(|slip| slip > beyond);
    }

    /// Whether the slip is surely beyond that of any dry road.
    pub(super) fn is_on_snow(&self, tuning: &Tuning) -> bool {
        let (quiet, [_, most]) = (&self.modes[QUIET], tuning.dry_slip.map(T::lit));
        quiet.mean[SLIP].abs() - quiet.get(SLIP, SLIP).sqrt() > most
    }

    /// The slip is that of a dry road: a calibration has learned it.
    pub(super) fn is_dry(&mut self, tuning: &Tuning) {
        self.dry_slip = dry_slip(&self.modes[QUIET], tuning);
    }

    fn start(&mut self, belief: Gaussian<T>) {
        self.modes.iter_mut().for_each(|mode| *mode = belief);
        self.forget_leaks();
        self.slippery = [false; 2];
    }

    /// The car stood: tires may have lost air without a sample of it, and loads have changed. Whatever it was is in the offsets from which
    /// on changes are counted; they are learned anew.
    pub(super) fn stood(&mut self, config: &WheelSpeedConfig<T>) {
        let tuning = config.tuning();
        let [_, standing, _] = tuning.slip_changes.map(T::lit);
        let [_, _, bend_sd] = tuning.bend;
        for mode in &mut self.modes {
            for (i, sd) in tuning.offset_sd.into_iter().enumerate() {
                mode.absorb(OFFSET + i, CHANGE + i);
                mode.widen(OFFSET + i, T::lit(sd * sd));
            }
            let slip = standing * mode.mean[SLIP];
            mode.widen(SLIP, slip * slip);
            for (i, share) in driven_shares(config.driven).into_iter().enumerate() {
                let unequal = T::lit(tuning.unequal_share * share) * slip_size(mode, tuning);
                mode.widen(UNEQUAL_SLIP + i, unequal * unequal);
                mode.widen(BEND + i, T::lit(bend_sd * bend_sd));
            }
        }
        self.forget_leaks();
    }

    /// No tire is believed to leak.
    fn forget_leaks(&mut self) {
        self.weight = [T::lit(1e-6); MODES];
        self.weight[QUIET] = T::one() - T::lit(5e-6);
    }

    /// `step_s` later.
    pub(super) fn predict(&mut self, step_s: T, config: &WheelSpeedConfig<T>, learning: bool) {
        let (tuning, shares_driven) = (config.tuning(), driven_shares(config.driven));
        let [_, _, slip_walk] = tuning.slip_changes.map(T::lit);
        let [road_slip, road_unequal] = tuning.road_changes.map(T::lit);
        let [places, places_walk, _] = tuning.places.map(T::lit);
        let [walk, leak_walk] = tuning.walk;
        let walks = [0.0, leak_walk * leak_walk].map(|leaks| walk * walk + leaks);
        if learning {
            for leak in &mut self.weight[1..OUTLIER] {
                *leak = T::lit(1e-12);
            }
        }
        // Over a longer one more leaks would end than there are.
        self.mix(step_s.at_most(T::lit(4.0)), tuning);
        let disturbances = Disturbances::of(tuning, self.yaw_known, self.grade_seen);
        let mut share = [T::one(); STATES];
        for (i, [_, time_s]) in disturbances.0 {
            share[i] = (-step_s * T::lit(1.0 / time_s)).exp_fast();
        }
        for (number, mode) in self.modes.iter_mut().enumerate() {
            mode.shrink(&share);
            for (i, [sd, _]) in disturbances.0 {
                mode.widen(i, T::lit(sd * sd) * (T::one() - share[i] * share[i]));
            }
            let side = disturbances.side::<T>() * (T::one() - share[FRONT_WANDER] * share[FRONT_WANDER]);
            mode.widen_along(FRONT_WANDER, &[1.0, 1.0], side);
            let slip = slip_walk * mode.mean[SLIP];
            mode.widen(SLIP, (T::lit(1e-6) + slip * slip) * step_s);
            if number == OUTLIER {
                mode.widen_along(FRONT_WANDER, &[1.0, 1.0], T::lit(4.0) * disturbances.side::<T>());
                let slip = road_slip * mode.mean[SLIP];
                mode.widen(SLIP, slip * slip);
            }
            let slippery = slippery(mode, self.dry_slip, tuning);
            for (i, share) in shares_driven.into_iter().enumerate() {
                let share = T::lit(share * share);
                let walks = places_walk * slippery;
                mode.widen(UNEQUAL_SLIP + i, share * walks * walks * step_s);
                if number == OUTLIER {
                    let (road, place) = (road_unequal * slip_size(mode, tuning), places * slippery);
                    mode.widen(UNEQUAL_SLIP + i, share * (road * road + place * place));
                }
            }
            mode.widen(YAW_BIAS, T::lit(1e-4) * step_s);
            if !learning {
                for (i, seen) in SEEN.iter().enumerate() {
                    // Without a yaw rate a step of a few seconds does not show which wheel it is: the decision finds out.
                    let this = number == 1 + i || !self.yaw_known && (1..OUTLIER).contains(&number);
                    mode.widen_along(CHANGE, seen, T::lit(walks[usize::from(this)]) * step_s);
                }
            }
        }
    }

    /// Each hypothesis begins with what those it may have come from believe.
    fn mix(&mut self, step_s: T, tuning: &Tuning) {
        let weight = self.weight;
        let mut shares = [[T::zero(); MODES]; MODES];
        for ((to, shares), total) in shares.iter_mut().enumerate().zip(&mut self.weight) {
            let from = |from: usize| weight[from] * transition(from, to, step_s, tuning);
            *total = (0..MODES).fold(T::zero(), |sum, i| sum + from(i)).at_least(T::lit(1e-30));
            *shares = core::array::from_fn(|i| from(i) / *total);
        }
        Gaussian::mix(&mut self.modes, &shares);
    }

    pub(super) fn update(&mut self, block: &Block<T>, config: &WheelSpeedConfig<T>, learning: bool) {
        self.yaw_known = block.yaw_rate_rad_s.is_some();
        self.grade_seen = block.grade_seen;
        let tuning = config.tuning();
        let ([_, outlier_variance], [_, _, places]) = (tuning.outliers, tuning.places.map(T::lit));
        let measurements = {
            let quiet = &self.modes[QUIET];
            let slip_noise = T::lit(tuning.per_slip) * slip_size(quiet, tuning)
                + places * slippery(quiet, self.dry_slip, tuning);
            Measurements::of(block, config, slip_noise)
        };
        let mut likelihood = [T::zero(); MODES];
        for (number, (mode, sum)) in self.modes.iter_mut().zip(&mut likelihood).enumerate() {
            let wider = T::lit(if number == OUTLIER { outlier_variance } else { 1.0 });
            let Measurements { h, z, noise } = &measurements;
            for (((used, h), z), noise) in block.used.iter().zip(h).zip(z).zip(noise) {
                if *used {
                    *sum += mode.measure(h, *z, *noise * wider);
                }
            }
        }
        let best = likelihood.iter().fold(likelihood[QUIET], |best, l| best.at_least(*l));
        let mut total = T::zero();
        for (number, (weight, likelihood)) in self.weight.iter_mut().zip(likelihood).enumerate() {
            *weight *= (likelihood - best).exp_fast();
            if !learning && self.yaw_known && (1..OUTLIER).contains(&number) {
                // A tire that leaks becomes smaller, never larger: the ratio of its axle tells.
                let (wheel, mode) = (number - 1, &self.modes[number]);
                let (axle, left) = (wheel / 2, wheel % 2 == 0);
                let state = CHANGE + axle;
                let smaller = if left { -mode.mean[state] } else { mode.mean[state] };
                *weight *= normal_distribution(smaller / mode.get(state, state).sqrt());
            }
            *weight = weight.at_least(T::lit(1e-20));
            total += *weight;
        }
        for weight in &mut self.weight {
            *weight /= total;
        }
        self.see_slip(tuning);
    }

    /// Belief of all hypotheses together.
    pub(super) fn belief(&self) -> Gaussian<T> {
        Gaussian::merged(self.weight.iter().copied().zip(&self.modes))
    }

    /// By how much left and right of each axle may slip unequally at this force on a slippery road, in thousandths.
    pub(super) fn unequal_slip_1e3(&self, force_m_s2: T, config: &WheelSpeedConfig<T>) -> [T; 2] {
        let slip = slippery(&self.modes[QUIET], self.dry_slip, config.tuning()) * force_m_s2.abs();
        driven_shares(config.driven).map(|share| T::lit(share) * slip)
    }

    /// How large the slip is, or may be, in thousandths per m/s², and how large it is on a dry road.
    pub(super) fn slip_1e3(&self, tuning: &Tuning) -> [T; 2] {
        [slip_size(&self.modes[QUIET], tuning), self.dry_slip]
    }

    /// The yaw rate's offset where nothing happens, and its sd, in rad/s.
    pub(super) fn yaw_bias_rad_s(&self, tuning: &Tuning) -> (T, T) {
        let quiet = &self.modes[QUIET];
        let sd = quiet.get(YAW_BIAS, YAW_BIAS).sqrt();
        let per_s = T::lit(1.0 / SCALE);
        match sd > T::zero() && sd < T::lit(0.25 * tuning.yaw_bias_sd) {
            true => (quiet.mean[YAW_BIAS] * per_s, sd * per_s),
            false => (T::zero(), T::lit(tuning.yaw_bias_sd) * per_s),
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.weight.iter().all(|w| w.is_finite()) && self.modes.iter().all(Gaussian::is_finite)
    }
}

/// Probability per step of going from one hypothesis to another.
fn transition<T: Real>(from: usize, to: usize, step_s: T, tuning: &Tuning) -> T {
    let [begins, ends] = tuning.leaks_per_s.map(|per_s| T::lit(per_s) * step_s);
    let [outlier, _] = tuning.outliers.map(T::lit);
    let stays = |leaves: T| T::one() - leaves - outlier;
    match (from, to) {
        (_, OUTLIER) => outlier,
        (QUIET | OUTLIER, QUIET) => stays(T::lit(4.0) * begins),
        (QUIET | OUTLIER, _) => begins,
        (_, QUIET) => ends,
        _ if from == to => stays(ends),
        _ => T::zero(),
    }
}

/// How large the slip is, or may be: that of a car with two driven axles is not in the ratio between them.
fn slip_size<T: Real>(belief: &Gaussian<T>, tuning: &Tuning) -> T {
    let [usual, _] = tuning.slip.map(T::lit);
    belief.mean[SLIP].abs().at_least(usual)
}

/// The slip on a dry road that a calibration has found: at least that of the stiffest tires.
fn dry_slip<T: Real>(belief: &Gaussian<T>, tuning: &Tuning) -> T {
    let [least, _] = tuning.dry_slip.map(T::lit);
    belief.mean[SLIP].abs().at_least(least)
}

/// By how much the slip is beyond that of a dry road.
fn slippery<T: Real>(belief: &Gaussian<T>, dry_slip: T, tuning: &Tuning) -> T {
    (belief.mean[SLIP].abs() - T::lit(tuning.slippery) * dry_slip).at_least(T::zero())
}

/// Share of the driving force of each axle.
fn driven_shares(driven: DrivenAxle) -> [f64; 2] {
    match driven {
        DrivenAxle::Front => [1.0, 0.0],
        DrivenAxle::Rear => [0.0, 1.0],
        DrivenAxle::Both => [0.5, 0.5],
    }
}

/// The disturbances that wander: their state, with their sd in thousandths (rad/s for the yaw rate's) and their time in s; and the sd of the
/// one of both axles alike, which has the time of theirs.
struct Disturbances([(usize, [f64; 2]); 4], f64);

impl Disturbances {
    fn of(tuning: &Tuning, yaw_known: bool, grade_seen: bool) -> Self {
        let yaw = if yaw_known { tuning.yaw_measured } else { tuning.yaw_unknown };
        let [with_yaw, without, force_s] = tuning.force_by_speed;
        let axle = match (yaw_known, grade_seen) {
            (_, true) => tuning.force_measured,
            (true, false) => [with_yaw, force_s],
            (false, false) => [without, force_s],
        };
        let [front, rear, side, time_s] = tuning.of_an_axle;
        let (front, rear) = ((FRONT_WANDER, [front, time_s]), (REAR_WANDER, [rear, time_s]));
        Self([(YAW_NOISE, yaw), front, rear, (AXLE_FORCE, axle)], side)
    }

    fn side<T: Real>(&self) -> T {
        T::lit(self.1 * self.1)
    }
}

/// A block's three ratios as measurements of the state, in thousandths.
struct Measurements<T> {
    h: [[T; STATES]; 3],
    z: [T; 3],
    noise: [T; 3],
}

impl<T: Real> Measurements<T> {
    fn of(block: &Block<T>, config: &WheelSpeedConfig<T>, slip_noise: T) -> Self {
        let (tuning, one, half) = (config.tuning(), T::one(), T::lit(0.5));
        let mut h = [[T::zero(); STATES]; 3];
        [h[FRONT][OFFSET + FRONT], h[REAR][OFFSET + REAR], h[AXLE][OFFSET + AXLE]] = [-one; 3];
        [h[FRONT][CHANGE + FRONT], h[REAR][CHANGE + REAR], h[AXLE][CHANGE + AXLE]] = [-one; 3];
        [h[FRONT][FRONT_WANDER], h[REAR][REAR_WANDER]] = [one; 2];
        [h[AXLE][SLIP], h[AXLE][AXLE_FORCE]] = [block.force_m_s2, one];
        [h[FRONT][UNEQUAL_SLIP], h[REAR][UNEQUAL_SLIP + 1]] = [block.force_m_s2; 2];
        let known = block.yaw_rate_rad_s.is_some();
        let to_left = block.yaw_rate_rad_s.unwrap_or(T::zero()) * block.speed_m_s;
        [h[FRONT][BEND], h[REAR][BEND + 1]] = [to_left; 2];
        let front = config.track_front_m / block.speed_m_s;
        let rear = config.track_rear_m / block.speed_m_s;
        [h[FRONT][YAW_BIAS], h[FRONT][YAW_NOISE]] = [front, -front];
        [h[REAR][YAW_BIAS], h[REAR][YAW_NOISE]] = [rear, -rear];
        let yaw = block.yaw_rate_rad_s.unwrap_or(T::zero()) * T::lit(SCALE);
        let way = config.wheelbase_m / block.speed_m_s * yaw;
        let turn = [-front * yaw, -rear * yaw, half * way * way * T::lit(1.0 / SCALE)];
        let curve = T::lit(tuning.per_lateral[usize::from(known)]) * block.lateral_m_s2;
        let [front_slip, rear_slip] = driven_shares(config.driven).map(|share| T::lit(share) * slip_noise);
        let slip = [front_slip, rear_slip, slip_noise].map(|slip| slip * block.force_m_s2);
        let noise = |i: usize| {
            let twice = if known || i != AXLE { 1.0 } else { 2.0 };
            let spread = T::lit(twice * tuning.spread_share) * block.spread[i];
            let curve = if i == AXLE { T::zero() } else { curve };
            let bend = T::lit(tuning.per_bend) * turn[i];
            T::lit(tuning.block_noise) + spread * spread + curve * curve + bend * bend + slip[i] * slip[i]
        };
        Self {
            h,
            z: [block.ratio[0] - turn[0], block.ratio[1] - turn[1], block.ratio[2] - turn[2]],
            noise: [noise(FRONT), noise(REAR), noise(AXLE)],
        }
    }
}

/// The standard normal distribution function; right to 1e-7 (Abramowitz and Stegun, 26.2.17).
pub(super) fn normal_distribution<T: Real>(x: T) -> T {
    let t = T::one() / (T::one() + T::lit(0.231_641_9) * x.abs());
    let high = T::lit(1.781_477_937) + t * (T::lit(-1.821_255_978) + t * T::lit(1.330_274_429));
    let polynomial = t * (T::lit(0.319_381_530) + t * (T::lit(-0.356_563_782) + t * high));
    let tail = T::lit(0.398_942_280_4) * (T::lit(-0.5) * x * x).exp_fast() * polynomial;
    if x > T::zero() { T::one() - tail } else { tail }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_distribution_is_that_of_the_tables() {
        for (x, p) in [(0.0f64, 0.5), (1.0, 0.841_344_746), (-1.959_963_985, 0.025), (3.0, 0.998_650_102)] {
            assert!((normal_distribution(x) - p).abs() < 1e-7, "{x}: {}", normal_distribution(x));
        }
    }

    #[test]
    fn from_every_hypothesis_something_follows() {
        for from in 0..MODES {
            let sum: f64 = (0..MODES).map(|to| transition(from, to, 0.5, &Tuning::DEFAULT)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{from}: {sum}");
        }
    }
}
