//! What is unknown of the car, as one vector: where each quantity stands, how far it may be from the vehicle file, and
//! how fast it may change (docs/math/shared-road.md, section 3).

use core::ops::Range;

use nalgebra::SVector;

use crate::memory::Blank;
use crate::model::{Corner, Side, UNCALIBRATED_BIAS_SD, UNKNOWN_COUPLING_SD};
use crate::real::Real;

pub(crate) const SIZE: usize = 37;
/// Compliance of each tire over the one at placard pressure, less one.
pub(crate) const TIRE: usize = 0;
/// Relative deviations of unsprung mass, damping and spring of each corner.
pub(crate) const MASS: usize = 4;
pub(crate) const DAMPING: usize = 8;
pub(crate) const SPRING: usize = 12;
/// Stiffness of each axle's anti-roll bar at a wheel, over its spring's.
pub(crate) const BAR: usize = 16;
/// Share of a rear wheel's unsprung mass that moves with the other one: of a twist beam, of a solid axle.
pub(crate) const COUPLING: usize = 18;
/// Gain of the front wheel's sensor over the rear one's, left and right, less one.
pub(crate) const GAIN: usize = 19;
/// Relative deviation of wheelbase over speed.
pub(crate) const WHEELBASE: usize = 21;
/// Time by which the rear wheel's sensor is late, left and right, in units of [`SKEW_UNIT_S`].
pub(crate) const SKEW: usize = 22;
/// What the road's spectrum reads too much of each tire, as a share of the placard pressure: in part the same of all ([`IN_COMMON`]).
pub(crate) const SPECTRUM_BIAS: usize = 24;
pub(crate) const SPECTRUM_BIASES: Range<usize> = SPECTRUM_BIAS..SPECTRUM_BIAS + 4;
/// What the shared road reads too much of each tire's compliance, as a share of that at placard pressure.
pub(crate) const ROAD_BIAS: usize = 28;
/// Level of each tire: its compliance, as [`TIRE`] is one, when its loss of this drive began to be counted. It is constant, and what it is
/// wrong by cancels in the loss, which is [`TIRE`] less this.
pub(crate) const LEVEL: usize = 32;
/// Rate of change in 1/s of the compliances that move.
pub(crate) const RATE: usize = 36;

const _: () = assert!(RATE == SIZE - 1);

/// Standard deviation of a spectrum's bias, and the share of its variance that all corners have in common.
pub(crate) const SPECTRUM_BIAS_SD: f64 = 0.05;
pub(crate) const IN_COMMON: f64 = 0.64;

/// Quantities that a side's residual depends on: front tire, mass, damping, spring, anti-roll bar, the same of the rear, its axle's
/// coupling, gain, and by how much the rear reads the road too late ([`SideReading`]).
pub(crate) const SIDE_SIZE: usize = 13;
/// Where the rear's begin among them.
pub(crate) const SIDE_REAR: usize = 5;
/// The two tires.
pub(crate) const SIDE_TIRES: [usize; 2] = [0, SIDE_REAR];
/// The two anti-roll bars and the coupling: what the other side's wheels act by.
pub(crate) const SIDE_OTHERS: [usize; 3] = [4, SIDE_REAR + 4, SIDE_REAR + 5];
pub(crate) const SIDE_GAIN: usize = 11;
pub(crate) const SIDE_SKEW: usize = 12;

/// So that skews are of the size of the other quantities.
pub(crate) const SKEW_UNIT_S: f64 = 0.1;

/// Stiffness of a rear anti-roll bar over that of the front one, and how far it may be from that, over the spring's.
const BAR_SHARE: f64 = 0.4;
const BAR_SPREAD: f64 = 0.06;

/// Standard deviation of [`ROAD_BIAS`] at the start and in the end, and the time in s between: what the model leaves out (a
/// sensor late by a millisecond, corners that one body ties together) is taken for tires only slowly. It grows nearly four times more
/// slowly than a tire's own compliance may, or it would take a loss of all four for its own.
const ROAD_BIAS_SD: [f64; 2] = [UNCALIBRATED_BIAS_SD, 0.03];
const ROAD_BIAS_S: f64 = 36_000.0;

pub(crate) type State<T> = SVector<T, SIZE>;

/// Standard deviations before anything is learned, unsprung masses known as the vehicle file says; the rate's is that of a hypothesis
/// that moves.
pub(crate) fn prior_sd<T: Real>(mass_sd: &[T; 4]) -> State<T> {
    let mut prior = filled([
        0.11,
        0.0,
        0.15,
        0.1,
        0.3,
        UNKNOWN_COUPLING_SD,
        0.012,
        0.01,
        0.02,
        SPECTRUM_BIAS_SD,
        ROAD_BIAS_SD[0],
        0.0,
        0.0,
    ]);
    prior.fixed_rows_mut::<4>(MASS).copy_from_slice(mass_sd);
    prior
}

/// Variance of the rear bar's stiffness, given that of the front one's, and their covariance: it is a share of the front one's, give or
/// take, as only their difference shows in the roads.
pub(crate) fn rear_bar_variance<T: Real>(front: T) -> [T; 2] {
    let (share, spread) = (T::lit(BAR_SHARE), T::lit(BAR_SPREAD));
    [share * share * front + spread * spread, share * front]
}

/// Growth of the standard deviations in a second, of those that change by themselves.
pub(crate) fn wander_sd<T: Real>() -> State<T> {
    let mut wander = filled([8e-4, 5e-5, 1e-3, 1e-3, 1e-3, 5e-5, 5e-5, 1e-4, 5e-4, 1.4e-3, 0.0, 0.0, 0.0]);
    let road_bias = T::lit(ROAD_BIAS_SD[1]) * T::lit(2.0 / ROAD_BIAS_S).sqrt();
    wander.fixed_rows_mut::<4>(ROAD_BIAS).fill(road_bias);
    wander
}

/// Standard deviations to which quantities come that nothing is learned of: the prior's, and a larger one of [`ROAD_BIAS`].
pub(crate) fn end_sd<T: Real>(prior: &State<T>) -> State<T> {
    let mut end = *prior;
    end.fixed_rows_mut::<4>(ROAD_BIAS).fill(T::lit(ROAD_BIAS_SD[1]));
    end
}

/// How fast, in 1/s, a quantity that nothing is learned of returns to what the vehicle file says: so that its wandering
/// comes to [`end_sd`]. Tires and their levels have no such place.
pub(crate) fn return_rate<T: Real>(prior: &State<T>) -> State<T> {
    let (wander, end) = (wander_sd::<T>(), end_sd(prior));
    State::from_fn(|i, _| {
        if (TIRE..TIRE + 4).contains(&i) || i >= LEVEL {
            T::zero()
        } else {
            let share = wander[i] / end[i];
            T::lit(0.5) * share * share
        }
    })
}

/// What a side's quantities are in a frame: which of the state's, each so many times. A tire and its bias are read as one, and so are skew
/// and wheelbase, which both make the rear late, the wheelbase by its share of the time in s from front to rear.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SideReading<T> {
    pub(crate) side: Side,
    pub(crate) delay_s: T,
}

impl<T: Real> SideReading<T> {
    /// Place among the side's quantities and in the state, and how many times.
    pub(crate) fn parts(&self) -> [(usize, usize, T); SIDE_SIZE + 3] {
        let (places, one) = (side_indices(self.side), T::one());
        let [front, rear] = SIDE_TIRES;
        core::array::from_fn(|part| match places.get(part) {
            Some(&place) => (part, place, one),
            None if part == SIDE_SIZE => (front, places[front] - TIRE + ROAD_BIAS, one),
            None if part == SIDE_SIZE + 1 => (rear, places[rear] - TIRE + ROAD_BIAS, one),
            None => (SIDE_SKEW, WHEELBASE, self.delay_s / T::lit(SKEW_UNIT_S)),
        })
    }
}

/// Where a side's quantities stand in the state.
pub(crate) fn side_indices(side: Side) -> [usize; SIDE_SIZE] {
    let (front, rear) = (side.front().index(), side.rear().index());
    [
        TIRE + front,
        MASS + front,
        DAMPING + front,
        SPRING + front,
        BAR,
        TIRE + rear,
        MASS + rear,
        DAMPING + rear,
        SPRING + rear,
        BAR + 1,
        COUPLING,
        GAIN + side.index(),
        SKEW + side.index(),
    ]
}

/// A tire's compliance as the shared road reads it, over that at placard pressure.
pub(crate) fn read_compliance<T: Real>(state: &State<T>, corner: Corner) -> T {
    T::one() + state[TIRE + corner.index()] + state[ROAD_BIAS + corner.index()]
}

/// One value per kind of quantity, in the order above.
fn filled<T: Real>(kinds: [f64; 13]) -> State<T> {
    let starts = [
        TIRE,
        MASS,
        DAMPING,
        SPRING,
        BAR,
        COUPLING,
        GAIN,
        WHEELBASE,
        SKEW,
        SPECTRUM_BIAS,
        ROAD_BIAS,
        LEVEL,
        RATE,
        SIZE,
    ];
    let mut all = State::zeros();
    for ((from, to), value) in starts.iter().zip(&starts[1..]).zip(kinds) {
        all.iter_mut().take(*to).skip(*from).for_each(|of| *of = T::lit(value));
    }
    all
}
