//! What front and rear of one side should agree on: the road velocity, from each axle's signals (docs/math/shared-road.md,
//! eq. 1-6). Gives the disagreement of a frame, bin by bin, and how it changes with every unknown quantity, and what the
//! sensors' noise does to both. Knows nothing of beliefs.

use nalgebra::{Complex, SMatrix, SVector};

use super::channel::KEPT;
use super::parameters::{DAMPING, GAIN, MASS, RATE, SKEW, SKEW_UNIT_S, SPRING, State, TIRE, WHEELBASE};
use super::{BINS, Frame, bin_hz};
use crate::informed::model::Body;
use crate::informed::reconstruct::LEAK_RAD_S;
use crate::real::Real;

/// Real numbers in a frame's disagreement: real and imaginary part of every bin.
pub(super) const ROWS: usize = 2 * BINS;
/// Quantities that a side's disagreement depends on: front tire, mass, damping, spring, the same of the rear, gain,
/// wheelbase, skew.
pub(super) const OWN: usize = 11;
/// Places among them.
pub(super) const FRONT_TIRE: usize = 0;
const REAR: usize = 4;
const OWN_GAIN: usize = 8;
const OWN_WHEELBASE: usize = 9;
const OWN_SKEW: usize = 10;

/// Rows and columns over a side's quantities.
pub(super) type Gram<T> = SMatrix<T, OWN, OWN>;
pub(super) type Score<T> = SVector<T, OWN>;

/// What is known of one axle's corner.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Wheel<T> {
    /// As in the vehicle file.
    pub(super) body: Body<T>,
    /// Compliance of the tire at placard pressure in m/N.
    pub(super) theta: T,
    /// Place in the order of [`Corner::ALL`](crate::sample::Corner::ALL).
    pub(super) corner: usize,
}

/// A complete frame of both axles, and where it was taken.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TrackFrame<T: Real> {
    /// Spectra of the front signals, then of the rear ones.
    pub(super) frame: Frame<T>,
    /// Time in s of its middle at the rear wheel.
    pub(super) middle_s: f64,
    /// Seconds from front to rear, and what wheelbase and skew were taken to be in aligning them.
    pub(super) delay_s: T,
    pub(super) used_wheelbase: T,
    pub(super) used_skew: T,
}

/// Where a side's quantities stand in the state.
pub(super) fn places(side: usize) -> [usize; OWN] {
    let (front, rear) = (side, side + 2);
    [
        TIRE + front,
        MASS + front,
        DAMPING + front,
        SPRING + front,
        TIRE + rear,
        MASS + rear,
        DAMPING + rear,
        SPRING + rear,
        GAIN + side,
        WHEELBASE,
        SKEW + side,
    ]
}

/// One axle's parameters as a state has them.
struct Axle<T> {
    /// Compliance in m/N of the tire, as it is and at placard pressure.
    theta: T,
    placard: T,
    /// Unsprung mass, damping, spring: as they are, and as the vehicle file says.
    factors: [T; 3],
    nominal: [T; 3],
}

impl<T: Real> Axle<T> {
    fn new(wheel: &Wheel<T>, state: &State<T>) -> Self {
        let at = |kind: usize| T::one() + state[kind + wheel.corner];
        let body = &wheel.body;
        let nominal = [body.unsprung_mass_kg, body.damping_n_s_per_m, body.spring_n_per_m];
        let factors = [nominal[0] * at(MASS), nominal[1] * at(DAMPING), nominal[2] * at(SPRING)];
        Self { theta: wheel.theta * at(TIRE), placard: wheel.theta, factors, nominal }
    }

    /// Road and its derivatives by tire, mass, damping, spring, from wheel velocity and the three force signals.
    fn road(&self, signals: [Complex<T>; KEPT]) -> (Complex<T>, [Complex<T>; 4]) {
        let [velocity, jerk, relative_acceleration, relative_velocity] = signals;
        let force = jerk * self.factors[0]
            + relative_acceleration * self.factors[1]
            + relative_velocity * self.factors[2];
        let slope = [
            force * self.placard,
            jerk * (self.theta * self.nominal[0]),
            relative_acceleration * (self.theta * self.nominal[1]),
            relative_velocity * (self.theta * self.nominal[2]),
        ];
        (velocity + force * self.theta, slope)
    }
}

/// One bin of a disagreement.
#[derive(Clone, Copy)]
struct Bin<T> {
    apart: Complex<T>,
    /// By every one of the side's quantities.
    slope: [Complex<T>; OWN],
    ahead: Complex<T>,
    behind: Complex<T>,
}

/// Disagreement of a frame and its derivatives.
pub(super) struct Disagreement<T: Real> {
    pub(super) rows: SVector<T, ROWS>,
    pub(super) slope: SMatrix<T, ROWS, OWN>,
    /// Road power of every bin, mean of the axles.
    pub(super) road_power: [T; BINS],
    /// `Re(∂R/∂p R*)` of every quantity with its own axle's road.
    pub(super) lean: SMatrix<T, BINS, OWN>,
}

/// How the front tire's compliance was different when the front wheel was here, for a state's rate.
pub(super) fn front_then<T: Real>(state: &State<T>, front: usize, moves: &[T; 4], delay_s: T) -> State<T> {
    let mut then = *state;
    then[TIRE + front] -= moves[front] * state[RATE] * delay_s;
    then
}

/// Compares the axles of a side for a state; `moves` says how the tires' compliances follow the rate.
pub(super) fn compare<T: Real>(
    taken: &TrackFrame<T>,
    wheels: &[Wheel<T>; 2],
    side: usize,
    state: &State<T>,
    moves: &[T; 4],
) -> Disagreement<T> {
    let then = front_then(state, wheels[0].corner, moves, taken.delay_s);
    let axles = [Axle::new(&wheels[0], &then), Axle::new(&wheels[1], state)];
    let gain = T::one() + state[GAIN + side];
    let late_s = taken.delay_s * (state[WHEELBASE] - taken.used_wheelbase)
        + T::lit(SKEW_UNIT_S) * (state[SKEW + side] - taken.used_skew);
    let mut out = Disagreement {
        rows: SVector::zeros(),
        slope: SMatrix::zeros(),
        road_power: [T::zero(); BINS],
        lean: SMatrix::zeros(),
    };
    for bin in 0..BINS {
        out.put(bin, &compare_bin(taken, &axles, gain, late_s, bin));
    }
    out
}

fn compare_bin<T: Real>(
    taken: &TrackFrame<T>,
    axles: &[Axle<T>; 2],
    gain: T,
    late_s: T,
    bin: usize,
) -> Bin<T> {
    let signals = |axle: usize| {
        core::array::from_fn(|i| {
            let column = axle * KEPT + i;
            Complex::new(taken.frame.re[(bin, column)], taken.frame.im[(bin, column)])
        })
    };
    let (front, front_slope) = axles[0].road(signals(0));
    let (behind, rear_slope) = axles[1].road(signals(1));
    let ahead = front * gain;
    let omega = T::two_pi() * bin_hz::<T>(bin);
    let turn = Complex::new(T::zero(), omega) * (ahead + behind) * T::lit(0.5);
    let mut slope = [Complex::new(T::zero(), T::zero()); OWN];
    for i in 0..REAR {
        slope[i] = front_slope[i] * gain;
        slope[REAR + i] = -rear_slope[i];
    }
    slope[OWN_GAIN] = front;
    slope[OWN_WHEELBASE] = -turn * taken.delay_s;
    slope[OWN_SKEW] = -turn * T::lit(SKEW_UNIT_S);
    Bin { apart: ahead - behind - turn * late_s, slope, ahead, behind }
}

impl<T: Real> Disagreement<T> {
    fn put(&mut self, bin: usize, found: &Bin<T>) {
        self.rows[bin] = found.apart.re;
        self.rows[BINS + bin] = found.apart.im;
        self.road_power[bin] = T::lit(0.5) * (found.ahead.norm_sqr() + found.behind.norm_sqr());
        for (i, slope) in found.slope.iter().enumerate() {
            self.slope[(bin, i)] = slope.re;
            self.slope[(BINS + bin, i)] = slope.im;
            // The rear stands in the disagreement with a minus sign, and so does its derivative.
            let road = if (REAR..OWN_GAIN).contains(&i) { -found.behind } else { found.ahead };
            self.lean[(bin, i)] = slope.re * road.re + slope.im * road.im;
        }
        self.lean[(bin, OWN_WHEELBASE)] = T::zero();
        self.lean[(bin, OWN_SKEW)] = T::zero();
    }

    /// `Re(C* C)` of a bin.
    pub(super) fn gram(&self, bin: usize) -> Gram<T> {
        let (re, im) = (self.slope.row(bin), self.slope.row(BINS + bin));
        re.transpose() * re + im.transpose() * im
    }
}

/// Keeps of a gram what one axle has with itself: what differs between the axles is independent between them.
pub(super) fn within_axles<T: Real>(gram: &Gram<T>) -> Gram<T> {
    let axle = |i: usize| usize::from((REAR..OWN_GAIN).contains(&i));
    Gram::from_fn(|i, j| {
        if i < OWN_WHEELBASE && j < OWN_WHEELBASE && axle(i) == axle(j) { gram[(i, j)] } else { T::zero() }
    })
}

/// What the sensors' noise leaves in a bin: power of the disagreement, of its product with the derivatives, and of the
/// derivatives with each other.
pub(super) struct SensorNoise<T: Real> {
    pub(super) power: [T; BINS],
    pub(super) score: [Score<T>; BINS],
    pub(super) gram: [Gram<T>; BINS],
}

/// The noise of a side's four sensors, by their densities in (m/s²)²/Hz, front and rear.
pub(super) fn sensor_noise<T: Real>(
    wheels: &[Wheel<T>; 2],
    side: usize,
    state: &State<T>,
    densities: &[T; 2],
) -> SensorNoise<T> {
    let axles = [Axle::new(&wheels[0], state), Axle::new(&wheels[1], state)];
    let gain = T::one() + state[GAIN + side];
    let mut noise =
        SensorNoise { power: [T::zero(); BINS], score: [Score::zeros(); BINS], gram: [Gram::zeros(); BINS] };
    for bin in 0..BINS {
        let omega = T::two_pi() * bin_hz::<T>(bin);
        let s = Complex::new(T::zero(), omega);
        let one = Complex::new(T::one(), T::zero());
        let zero = Complex::new(T::zero(), T::zero());
        let leak = omega * omega / (omega * omega + T::lit(LEAK_RAD_S * LEAK_RAD_S));
        // What unit noise of a wheel's sensor, and of a body's, makes of the four signals.
        let through = [[one / s, s, one, one / s], [zero, zero, -one, -one / s]];
        for (axle, density) in axles.iter().zip(densities).enumerate().map(|(i, (a, d))| ((i, a), *d)) {
            let (index, axle) = axle;
            let scale = if index == 0 { gain } else { -T::one() };
            for signals in through {
                let (road, slope) = axle.road(signals);
                let mut all = [zero; OWN];
                for i in 0..REAR {
                    all[index * REAR + i] = slope[i] * scale;
                }
                if index == 0 {
                    all[OWN_GAIN] = road;
                }
                let apart = road * scale;
                let weight = leak * density;
                noise.power[bin] += weight * apart.norm_sqr();
                for i in 0..OWN {
                    noise.score[bin][i] += weight * (all[i].re * apart.re + all[i].im * apart.im);
                    for j in 0..OWN {
                        noise.gram[bin][(i, j)] += weight * (all[i].re * all[j].re + all[i].im * all[j].im);
                    }
                }
            }
        }
    }
    noise
}
