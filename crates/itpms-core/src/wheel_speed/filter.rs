//! Six hypotheses on the time between two blocks, each with its Gaussian: nothing, one of four tires leaks, or the block is an
//! outlier (an interacting multiple model filter; `docs/math/wheel-speed.md`, eq. 3-8).

use super::block::{Block, LEAST_NOISE};
use super::calibration::{BEND_MEAN, BEND_SD, LEARNED, RadiusCalibration};
use super::config::{DrivenAxle, WheelSpeedConfig};
use super::gaussian::Gaussian;
use super::state::{
    AXLE, AXLE_FORCE, BEND, CHANGE, FRONT, FRONT_WANDER, OFFSET, REAR, REAR_WANDER, SCALE, SLIP, STATES,
    UNEQUAL_SLIP, YAW_BIAS, YAW_NOISE,
};
use crate::memory::Blank;
use crate::model::SEEN;
use crate::real::Real;

/// Nothing happens; wheel `i` leaks: `1 + i`; the block is an outlier.
const MODES: usize = 6;
const QUIET: usize = 0;
const OUTLIER: usize = 5;

/// Walk of a radius in thousandths per √s: by itself, and in a leak.
const WALK: f64 = 0.01;
const LEAK_WALK: f64 = 4.0;
/// Leaks that begin and end per s, share of outliers.
const LEAK_BEGINS_PER_S: f64 = 1e-5;
const LEAK_ENDS_PER_S: f64 = 0.1;
const OUTLIERS: f64 = 0.02;
/// By how much an outlier's variance is larger.
const OUTLIER_VARIANCE: f64 = 64.0;
/// Slip is the road's, the load's and the day's: by which share of it that may change until another drive, while the car stands, and per √s
/// of driving.
const SLIP_SHARE_DAY: f64 = 1.0;
const SLIP_SHARE_STANDING: f64 = 0.25;
const SLIP_SHARE_WALK: f64 = 0.01;
/// How unequally a driven axle's two wheels slip, as a share of their slip: as their loads, their tires and the road under them differ;
/// beforehand and whenever the car has stood.
const UNEQUAL_SHARE: f64 = 0.25;
/// A road changes at once, where a block is an outlier: by which share of it the slip, by which share of the slip how unequally the wheels
/// of a driven axle slip, and in thousandths what parts the wheels of both axles alike.
const ROAD_SLIP: f64 = 0.3;
const ROAD_UNEQUAL: f64 = 0.15;
const ROAD_SIDE: f64 = 0.4;
/// Sd of the change of a bend's load effect while the car stands.
const BEND_STANDING_SD: f64 = 0.1;
/// Slip above this multiple of a dry road's means a road on which left and right differ from place to place; then the shares of the excess
/// slip by which the wheels of a driven axle differ, from one place to the next and per √s.
const SNOW: f64 = 1.8;
const MAYBE_SD: f64 = 1.0;
const SLIPPERY: f64 = 1.6;
const PLACES_SHARE: f64 = 0.5;
const PLACES_WALK: f64 = 0.1;
const PLACES_NOISE: f64 = 0.3;
/// Priors of a car before its first block, as sds in thousandths: its offsets of front, rear and between the axles; the driven axle's
/// slip per m/s², with its mean; a yaw rate's bias in 1e-3 rad/s.
const OFFSET_SD: [f64; 3] = [4.0, 4.0, 6.0];
const SLIP_MEAN: f64 = 3.5;
const LEAST_SLIP: f64 = 2.0;
const MOST_DRY_SLIP: f64 = 10.0;
const SLIP_SD: f64 = 2.0;
const YAW_BIAS_SD: f64 = 20.0;
const YAW_BIAS_KNOWN_SD: f64 = 5.0;
/// Sd in thousandths (1e-3 rad/s for the yaw rate) and time in s of each disturbance that wanders (docs/math/wheel-speed.md, table of the
/// states): the noise of a yaw rate, or of the one assumed where none is measured; the difference of an axle's wheels, front and rear; the
/// difference of the axles beside their force where that is measured, with a yaw rate alone, and with neither.
const YAW_MEASURED: (f64, f64) = (0.85, 1.0);
const YAW_UNKNOWN: (f64, f64) = (65.0, 4.0);
const OF_AN_AXLE: [(f64, f64); 2] = [(0.16, 25.0), (0.22, 25.0)];
/// The same of a road that differs from left to right, for both axles alike, with the same memory.
const OF_A_SIDE: f64 = 0.2;
const FORCE_MEASURED: (f64, f64) = (0.3, 20.0);
const FORCE_BY_SPEED: [(f64, f64); 2] = [(1.35, 13.0), (1.65, 13.0)];
/// A block's noise, eq. (7), beside its [least](LEAST_NOISE): its share of the spread within the block for each ratio, and for the axles'
/// without a yaw rate; and 1e-3 per m/s² to the side, without a yaw rate and with one, by which the bend's load is learned.
const SPREAD_SHARE: [f64; 3] = [0.06, 0.08, 0.07];
const SPREAD_SHARE_WITHOUT_YAW: f64 = 0.14;
const PER_LATERAL: [f64; 2] = [0.2, 0.1];
/// The same, as a share of the bend that is taken off: a yaw rate's gain, a track; and as a share of the slip, of an axle that is driven.
const PER_BEND: f64 = 0.02;
const PER_SLIP: f64 = 0.05;
/// Longest step of time over which a leak may begin or end, in s.
const LONGEST_STEP_S: f64 = 4.0;

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
        let slip = match config.driven {
            DrivenAxle::Front => SLIP_MEAN,
            DrivenAxle::Rear => -SLIP_MEAN,
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
        [sd[OFFSET + FRONT], sd[OFFSET + REAR], sd[OFFSET + AXLE]] = OFFSET_SD.map(T::lit);
        (sd[SLIP], sd[YAW_BIAS]) = (T::lit(SLIP_SD), T::lit(YAW_BIAS_SD));
        for (mean, sd) in mean[BEND..].iter_mut().zip(&mut sd[BEND..]) {
            (*mean, *sd) = (T::lit(BEND_MEAN), T::lit(BEND_SD));
        }
        for (unequal, share) in sd[UNEQUAL_SLIP..BEND].iter_mut().zip(driven_shares(config.driven)) {
            *unequal += T::lit(UNEQUAL_SHARE * share * SLIP_MEAN);
        }
        let disturbances = Disturbances::of(false, false);
        for (i, (wander, _)) in disturbances.0 {
            sd[i] = T::lit(wander);
        }
        let mut belief = Gaussian::independent(mean, sd);
        belief.widen_along(FRONT_WANDER, &[1.0, 1.0], T::lit(OF_A_SIDE * OF_A_SIDE));
        self.start(belief);
        self.dry_slip = T::lit(SLIP_MEAN + SLIP_SD);
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
        let slip = T::lit(SLIP_SHARE_DAY) * belief.mean[SLIP];
        belief.widen(SLIP, slip * slip);
        self.start(belief);
        self.dry_slip = dry_slip(&belief);
        self.stood(config.driven);
    }

    /// Whether the slip is surely beyond that of a dry road, and whether it may be.
    pub(super) fn is_slippery(&self) -> [bool; 2] {
        self.slippery
    }

    fn see_slip(&mut self) {
        // By all hypotheses: a tire that has just lost air would be slip to one that knows of no loss.
        let belief = self.belief();
        let (slip, sd) = (belief.mean[SLIP].abs(), belief.get(SLIP, SLIP).sqrt());
        let bounds = [slip - sd, slip + T::lit(MAYBE_SD) * sd];
        self.slippery = bounds.map(|slip| slip > T::lit(SNOW) * self.dry_slip);
    }

    /// Whether the slip is surely beyond that of any dry road.
    pub(super) fn is_on_snow(&self) -> bool {
        let quiet = &self.modes[QUIET];
        quiet.mean[SLIP].abs() - quiet.get(SLIP, SLIP).sqrt() > T::lit(MOST_DRY_SLIP)
    }

    /// The slip is that of a dry road: a calibration has learned it.
    pub(super) fn is_dry(&mut self) {
        self.dry_slip = dry_slip(&self.modes[QUIET]);
    }

    fn start(&mut self, belief: Gaussian<T>) {
        self.modes.iter_mut().for_each(|mode| *mode = belief);
        self.forget_leaks();
        self.slippery = [false; 2];
    }

    /// The car stood: tires may have lost air without a sample of it, and loads have changed. Whatever it was is in the offsets from which
    /// on changes are counted; they are learned anew.
    pub(super) fn stood(&mut self, driven: DrivenAxle) {
        for mode in &mut self.modes {
            for (i, sd) in OFFSET_SD.into_iter().enumerate() {
                mode.absorb(OFFSET + i, CHANGE + i);
                mode.widen(OFFSET + i, T::lit(sd * sd));
            }
            let slip = T::lit(SLIP_SHARE_STANDING) * mode.mean[SLIP];
            mode.widen(SLIP, slip * slip);
            for (i, share) in driven_shares(driven).into_iter().enumerate() {
                let unequal = T::lit(UNEQUAL_SHARE * share) * slip_size(mode);
                mode.widen(UNEQUAL_SLIP + i, unequal * unequal);
                mode.widen(BEND + i, T::lit(BEND_STANDING_SD * BEND_STANDING_SD));
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
    pub(super) fn predict(&mut self, step_s: T, driven: DrivenAxle, learning: bool) {
        let shares_driven = driven_shares(driven);
        if learning {
            for leak in &mut self.weight[1..OUTLIER] {
                *leak = T::lit(1e-12);
            }
        }
        self.mix(step_s.at_most(T::lit(LONGEST_STEP_S)));
        let disturbances = Disturbances::of(self.yaw_known, self.grade_seen);
        let mut share = [T::one(); STATES];
        for (i, (_, time_s)) in disturbances.0 {
            share[i] = (-step_s * T::lit(1.0 / time_s)).exp_fast();
        }
        for (number, mode) in self.modes.iter_mut().enumerate() {
            mode.shrink(&share);
            for (i, (sd, _)) in disturbances.0 {
                mode.widen(i, T::lit(sd * sd) * (T::one() - share[i] * share[i]));
            }
            let side = T::lit(OF_A_SIDE * OF_A_SIDE) * (T::one() - share[FRONT_WANDER] * share[FRONT_WANDER]);
            mode.widen_along(FRONT_WANDER, &[1.0, 1.0], side);
            let slip = T::lit(SLIP_SHARE_WALK) * mode.mean[SLIP];
            mode.widen(SLIP, (T::lit(1e-6) + slip * slip) * step_s);
            if number == OUTLIER {
                mode.widen_along(FRONT_WANDER, &[1.0, 1.0], T::lit(ROAD_SIDE * ROAD_SIDE));
                let slip = T::lit(ROAD_SLIP) * mode.mean[SLIP];
                mode.widen(SLIP, slip * slip);
            }
            let slippery = slippery(mode, self.dry_slip);
            for (i, share) in shares_driven.into_iter().enumerate() {
                let share = T::lit(share * share);
                let walks = T::lit(PLACES_WALK) * slippery;
                mode.widen(UNEQUAL_SLIP + i, share * walks * walks * step_s);
                if number == OUTLIER {
                    let (road, place) =
                        (T::lit(ROAD_UNEQUAL) * slip_size(mode), T::lit(PLACES_SHARE) * slippery);
                    mode.widen(UNEQUAL_SLIP + i, share * (road * road + place * place));
                }
            }
            mode.widen(YAW_BIAS, T::lit(1e-4) * step_s);
            if !learning {
                for (i, seen) in SEEN.iter().enumerate() {
                    // Without a yaw rate a step of a few seconds does not show which wheel it is: the decision finds out.
                    let this = number == 1 + i || !self.yaw_known && (1..OUTLIER).contains(&number);
                    let leaks = if this { LEAK_WALK * LEAK_WALK } else { 0.0 };
                    mode.widen_along(CHANGE, seen, T::lit(WALK * WALK + leaks) * step_s);
                }
            }
        }
    }

    /// Each hypothesis begins with what those it may have come from believe.
    fn mix(&mut self, step_s: T) {
        let weight = self.weight;
        let mut shares = [[T::zero(); MODES]; MODES];
        for ((to, shares), total) in shares.iter_mut().enumerate().zip(&mut self.weight) {
            let from = |from: usize| weight[from] * transition(from, to, step_s);
            *total = (0..MODES).fold(T::zero(), |sum, i| sum + from(i)).at_least(T::lit(1e-30));
            *shares = core::array::from_fn(|i| from(i) / *total);
        }
        Gaussian::mix(&mut self.modes, &shares);
    }

    pub(super) fn update(&mut self, block: &Block<T>, config: &WheelSpeedConfig<T>, learning: bool) {
        self.yaw_known = block.yaw_rate_rad_s.is_some();
        self.grade_seen = block.grade_seen;
        let measurements = {
            let quiet = &self.modes[QUIET];
            let slip_noise =
                T::lit(PER_SLIP) * slip_size(quiet) + T::lit(PLACES_NOISE) * slippery(quiet, self.dry_slip);
            Measurements::of(block, config, slip_noise)
        };
        let mut likelihood = [T::zero(); MODES];
        for (number, (mode, sum)) in self.modes.iter_mut().zip(&mut likelihood).enumerate() {
            let wider = T::lit(if number == OUTLIER { OUTLIER_VARIANCE } else { 1.0 });
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
        self.see_slip();
    }

    /// Belief of all hypotheses together.
    pub(super) fn belief(&self) -> Gaussian<T> {
        Gaussian::merged(self.weight.iter().copied().zip(&self.modes))
    }

    /// By how much left and right of each axle may slip unequally at this force on a slippery road, in thousandths.
    pub(super) fn unequal_slip_1e3(&self, force_m_s2: T, driven: DrivenAxle) -> [T; 2] {
        let slip = slippery(&self.modes[QUIET], self.dry_slip) * force_m_s2.abs();
        driven_shares(driven).map(|share| T::lit(share) * slip)
    }

    /// How large the slip is, or may be, in thousandths per m/s², and how large it is on a dry road.
    pub(super) fn slip_1e3(&self) -> [T; 2] {
        [slip_size(&self.modes[QUIET]), self.dry_slip]
    }

    /// The yaw rate's offset where nothing happens, and its sd, in rad/s.
    pub(super) fn yaw_bias_rad_s(&self) -> (T, T) {
        let quiet = &self.modes[QUIET];
        let sd = quiet.get(YAW_BIAS, YAW_BIAS).sqrt();
        let per_s = T::lit(1.0 / SCALE);
        match sd > T::zero() && sd < T::lit(YAW_BIAS_KNOWN_SD) {
            true => (quiet.mean[YAW_BIAS] * per_s, sd * per_s),
            false => (T::zero(), T::lit(YAW_BIAS_SD) * per_s),
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.weight.iter().all(|w| w.is_finite()) && self.modes.iter().all(Gaussian::is_finite)
    }
}

/// Probability per step of going from one hypothesis to another.
fn transition<T: Real>(from: usize, to: usize, step_s: T) -> T {
    let (begins, ends) = (T::lit(LEAK_BEGINS_PER_S) * step_s, T::lit(LEAK_ENDS_PER_S) * step_s);
    let outlier = T::lit(OUTLIERS);
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
fn slip_size<T: Real>(belief: &Gaussian<T>) -> T {
    belief.mean[SLIP].abs().at_least(T::lit(SLIP_MEAN))
}

/// The slip on a dry road that a calibration has found: at least that of the stiffest tires.
fn dry_slip<T: Real>(belief: &Gaussian<T>) -> T {
    belief.mean[SLIP].abs().at_least(T::lit(LEAST_SLIP))
}

/// By how much the slip is beyond that of a dry road.
fn slippery<T: Real>(belief: &Gaussian<T>, dry_slip: T) -> T {
    (belief.mean[SLIP].abs() - T::lit(SLIPPERY) * dry_slip).at_least(T::zero())
}

/// Share of the driving force of each axle.
fn driven_shares(driven: DrivenAxle) -> [f64; 2] {
    match driven {
        DrivenAxle::Front => [1.0, 0.0],
        DrivenAxle::Rear => [0.0, 1.0],
        DrivenAxle::Both => [0.5, 0.5],
    }
}

/// The disturbances that wander: their state, their sd in thousandths (rad/s for the yaw rate's) and their time in s.
struct Disturbances([(usize, (f64, f64)); 4]);

impl Disturbances {
    fn of(yaw_known: bool, grade_seen: bool) -> Self {
        let yaw = if yaw_known { YAW_MEASURED } else { YAW_UNKNOWN };
        let [with_yaw, without] = FORCE_BY_SPEED;
        let axle = match (yaw_known, grade_seen) {
            (_, true) => FORCE_MEASURED,
            (true, false) => with_yaw,
            (false, false) => without,
        };
        let [front, rear] = OF_AN_AXLE;
        Self([(YAW_NOISE, yaw), (FRONT_WANDER, front), (REAR_WANDER, rear), (AXLE_FORCE, axle)])
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
        let (one, half) = (T::one(), T::lit(0.5));
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
        let [front_share, rear_share, axle_share] = SPREAD_SHARE;
        let shares = [front_share, rear_share, if known { axle_share } else { SPREAD_SHARE_WITHOUT_YAW }];
        let curve = T::lit(PER_LATERAL[usize::from(known)]) * block.lateral_m_s2;
        let [front_slip, rear_slip] = driven_shares(config.driven).map(|share| T::lit(share) * slip_noise);
        let slip = [front_slip, rear_slip, slip_noise].map(|slip| slip * block.force_m_s2);
        let noise = |i: usize| {
            let spread = T::lit(shares[i]) * block.spread[i];
            let curve = if i == AXLE { T::zero() } else { curve };
            let bend = T::lit(PER_BEND) * turn[i];
            T::lit(LEAST_NOISE) + spread * spread + curve * curve + bend * bend + slip[i] * slip[i]
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
            let sum: f64 = (0..MODES).map(|to| transition(from, to, 0.5)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{from}: {sum}");
        }
    }
}
