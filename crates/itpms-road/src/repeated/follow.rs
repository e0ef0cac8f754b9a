//! The tire on a road that repeats itself: every pass over it is the same road seen through the stiffness of the moment, so passes tell how
//! the stiffness has changed since the road was learned; and once it has changed, what it was (docs/math/repeated-road.md, eq. 4-9).
//!
//! `wheel + θ force = road + noise` at every harmonic is linear in the compliance `θ` and in the road, so this is a Kalman filter, with no
//! likelihood to search. Fed with passes; knows nothing of samples, pressures or of how the period was found.

use itpms_core::Real;
use nalgebra::{Complex, Matrix4, SVector, Vector4};

use super::given::{Belief, Corner, Held};
use super::motion::{Gaussian, Motion, NOW, PassLikelihood, RATE, SLIP, STATES, THEN};
use super::pass::{HARMONICS, Harmonics, Pass, PassClock};
use super::transfer::{noise_gain, wheel_over_road};

/// Share of itself by which the road may change, per √s.
const ROAD_WALK: f64 = 0.001;
/// Memory in s of the residuals' size.
const EXCESS_MEMORY_S: f64 = 5.0;
/// Model error: the share of a period by which it may be mistaken about when a pressure changed, and the share
/// of a change by which it may be mistaken about how much (unsprung mass, spring).
const WHEN: f64 = 0.15;
const MODEL: f64 = 0.01;
/// Residual power over the road's beyond which a pass is no pass over the same road.
const STRANGE: f64 = 0.2;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Same,
    /// Another road, or something beside the road; nothing was learned.
    Strange,
}

#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Follower<T: Real> {
    /// Compliance in m/N that deviations are shares of.
    reference: T,
    motion: Motion<T>,
    /// Variance of the relative compliance when the road was met.
    met_variance: T,
    /// The road at every harmonic, for no deviation while it was learned; how much that deviation would change
    /// it; and the variance of the rest.
    road: Harmonics<T>,
    lever: Harmonics<T>,
    /// The force, times the reference compliance, while the road was learned.
    force: Harmonics<T>,
    variance: SVector<T, HARMONICS>,
    /// Residual power over expected power.
    pub(super) excess: T,
    pub(super) strangeness: T,
}

impl<T: Real> Follower<T> {
    /// Meets the road for the first time.
    pub(crate) fn meet(pass: &Pass<T>, clock: &PassClock<T>, corner: &Corner<T>, belief: &Belief<T>) -> Self {
        let reference = belief.theta;
        let force = pass.force * real(reference);
        let met_variance = belief.relative_sd * belief.relative_sd;
        let mut follower = Self {
            reference,
            motion: Motion::met(met_variance),
            met_variance,
            road: pass.wheel + force,
            lever: force,
            force,
            variance: SVector::zeros(),
            excess: T::lit(2.0),
            strangeness: T::zero(),
        };
        for harmonic in 0..clock.used() {
            follower.variance[harmonic] = follower.noise(clock, corner, harmonic);
        }
        follower
    }

    /// Compliance in m/N, its relative sd, and its relative change per second.
    pub(crate) fn compliance(&self, clock: &PassClock<T>) -> (T, T, T) {
        let Gaussian { state, covariance } = self.motion.all();
        let share = T::one() + state[NOW];
        let when = T::lit(WHEN) * clock.period_s() * state[RATE];
        let model = T::lit(MODEL) * (state[NOW] - state[THEN]);
        let variance = covariance[(NOW, NOW)].max(T::zero()) + when * when + model * model;
        (self.reference * share, variance.sqrt() / share, state[RATE] / share)
    }

    /// Probability that the pressure moves.
    pub(crate) fn moving(&self) -> T {
        self.motion.moving()
    }

    /// How many harmonics the road is made of, by the spread of their powers: one for a single tone.
    pub(crate) fn breadth(&self) -> T {
        let (mut sum, mut squares) = (T::zero(), T::zero());
        for z in self.road.iter() {
            let power = z.norm_sqr();
            sum += power;
            squares += power * power;
        }
        if squares > T::zero() { sum * sum / squares } else { T::zero() }
    }

    /// Takes off the state how far the passes have slipped since the last call, in s.
    pub(crate) fn take_slip(&mut self, clock: &PassClock<T>) -> T {
        let slip = self.motion.all().state[SLIP];
        for harmonic in 0..clock.used() {
            let angle = -slip * clock.frequency_hz(harmonic) / T::lit(10.0);
            let turn = Complex::new(angle.cos(), angle.sin());
            self.road[harmonic] *= turn;
            self.lever[harmonic] *= turn;
            self.force[harmonic] *= turn;
        }
        self.motion.for_each(|gaussian| gaussian.state[SLIP] -= slip);
        slip / T::lit(10.0 * core::f64::consts::TAU)
    }

    /// Weighs a pass `seconds` after the last one, and learns the road from it.
    pub(crate) fn follow(
        &mut self,
        pass: &Pass<T>,
        clock: &PassClock<T>,
        corner: &Corner<T>,
        held: Held,
        seconds: T,
    ) -> Verdict {
        self.motion.predict(seconds, held);
        let mut motion = self.motion;
        let is_updated = motion.update(|state, near| self.likelihood(pass, clock, corner, state, near));
        let (misfit, strangeness) = self.misfit(pass, clock, corner, &motion.all().state);
        self.strangeness = strangeness;
        if !(is_updated && strangeness < T::lit(STRANGE)) {
            return Verdict::Strange;
        }
        self.motion = motion;
        if held == Held::Yes {
            self.motion.hold(self.met_variance);
        }
        let forget = (seconds / T::lit(EXCESS_MEMORY_S)).min(T::one());
        self.excess += forget * (misfit - self.excess);
        self.learn_road(pass, clock, corner);
        Verdict::Same
    }

    /// Noise power of the reconstructed road in a pass.
    fn noise(&self, clock: &PassClock<T>, corner: &Corner<T>, harmonic: usize) -> T {
        let noise = noise_gain(&corner.quarter_car, self.reference, clock.frequency_hz(harmonic));
        noise * corner.noise_density / clock.period_s()
    }

    /// The road as a pass shows it at one harmonic, for a deviation now and its rate.
    fn seen(&self, pass: &Pass<T>, harmonic: usize, now: T, rate: T) -> Complex<T> {
        let force = pass.force[harmonic] * (T::one() + now) - pass.aged[harmonic] * rate;
        pass.wheel[harmonic] + force * self.reference
    }

    /// Residual of a pass at one harmonic, and what the slip adds to it per unit.
    fn residual(
        &self,
        pass: &Pass<T>,
        clock: &PassClock<T>,
        harmonic: usize,
        state: &Vector4<T>,
    ) -> (Complex<T>, Complex<T>) {
        let learned = self.road[harmonic] + self.lever[harmonic] * state[THEN];
        // A slip of τ turns the road by e^{-jωτ}.
        let slipped = learned * Complex::new(T::zero(), clock.frequency_hz(harmonic) / T::lit(10.0));
        let seen = self.seen(pass, harmonic, state[NOW], state[RATE]);
        (seen - learned + slipped * state[SLIP], slipped)
    }

    /// What a pass measures, of which a part is new, at a state: with the force as measured, or as the road would cause it
    /// at a state near the one looked for.
    fn likelihood(
        &self,
        pass: &Pass<T>,
        clock: &PassClock<T>,
        corner: &Corner<T>,
        state: &Vector4<T>,
        near: Option<&Vector4<T>>,
    ) -> PassLikelihood<T> {
        let mut likelihood = PassLikelihood {
            log_likelihood: T::zero(),
            score: Vector4::zeros(),
            information: Matrix4::zeros(),
        };
        for harmonic in 0..clock.used() {
            let (residual, slipped) = self.residual(pass, clock, harmonic, state);
            let force = match near {
                None => pass.force[harmonic] * self.reference,
                Some(near) => self.force[harmonic] * self.force_ratio(clock, corner, harmonic, near),
            };
            let mut slopes = [slipped; STATES];
            // How unevenly the force is spread over the pass shows in the measured one, without that noise.
            let uneven = (pass.aged[harmonic] - pass.force[harmonic] * age(clock)) * self.reference;
            (slopes[NOW], slopes[RATE], slopes[THEN]) =
                (force, -force * age(clock) - uneven, -self.lever[harmonic]);
            let variance =
                (self.noise(clock, corner, harmonic) + self.variance[harmonic]) * self.excess.max(T::one());
            let weight = T::lit(2.0) * PassClock::<T>::share() / variance;
            likelihood.log_likelihood -= T::lit(0.5) * weight * residual.norm_sqr();
            for i in 0..STATES {
                likelihood.score[i] -= weight * (slopes[i].conj() * residual).re;
                for j in 0..STATES {
                    likelihood.information[(i, j)] += weight * (slopes[i].conj() * slopes[j]).re;
                }
            }
        }
        likelihood
    }

    /// The force now over that while the road was learned. Taken from the force learned then, and not measured now, the slope
    /// is free of the noise that force and residual have in common and that would pull towards less force; and with
    /// no change it is one, so that the level never seems to show where only changes do.
    fn force_ratio(
        &self,
        clock: &PassClock<T>,
        corner: &Corner<T>,
        harmonic: usize,
        near: &Vector4<T>,
    ) -> Complex<T> {
        let one = Complex::new(T::one(), T::zero());
        let per_road = |deviation: T| {
            let share = T::one() + deviation;
            let h =
                wheel_over_road(&corner.quarter_car, self.reference * share, clock.frequency_hz(harmonic));
            (one - h) / Complex::new(share, T::zero())
        };
        per_road(near[NOW] - age(clock) * near[RATE]) / per_road(near[THEN])
    }

    /// Mean residual power over what was expected, and over the road's.
    fn misfit(&self, pass: &Pass<T>, clock: &PassClock<T>, corner: &Corner<T>, state: &Vector4<T>) -> (T, T) {
        let (mut misfit, mut against, mut road) = (T::zero(), T::zero(), T::zero());
        for harmonic in 0..clock.used() {
            let noise = self.noise(clock, corner, harmonic);
            let power = self.residual(pass, clock, harmonic, state).0.norm_sqr();
            misfit += power / (noise + self.variance[harmonic]);
            against += power / noise;
            road += self.road[harmonic].norm_sqr() / noise;
        }
        (misfit / T::lit(clock.used() as f64), against / road)
    }

    /// Averages a pass into the road, seen with the compliance `1 + α + β d` that goes with a deviation `d` then.
    fn learn_road(&mut self, pass: &Pass<T>, clock: &PassClock<T>, corner: &Corner<T>) {
        let share = PassClock::<T>::share();
        let believed = self.motion.all();
        let near = believed.with_doubt().state;
        let age = age(clock);
        let [now, rate, then] = [NOW, RATE, THEN].map(|i| believed.covariance.column(i).into_owned());
        let cross = now[THEN] - age * rate[THEN];
        let beta = if then[THEN] > T::lit(1e-12) { cross / then[THEN] } else { T::zero() };
        let alpha = believed.state[NOW] - beta * believed.state[THEN];
        let (mut gain_sum, mut weight_sum) = (T::zero(), T::zero());
        for harmonic in 0..clock.used() {
            let noise = self.noise(clock, corner, harmonic) * self.excess.max(T::one());
            let (road, lever) = (self.road[harmonic], self.lever[harmonic]);
            let walk = T::lit(ROAD_WALK * ROAD_WALK) * road.norm_sqr();
            let variance = self.variance[harmonic] + walk * share * clock.period_s();
            let gain = variance / (variance + noise / share);
            let force = pass.force[harmonic] * self.reference;
            let seen = self.seen(pass, harmonic, alpha, believed.state[RATE]);
            let angle = believed.state[SLIP] * clock.frequency_hz(harmonic) / T::lit(10.0);
            let back = Complex::new(angle.cos(), angle.sin());
            let force_then = force * back / self.force_ratio(clock, corner, harmonic, &near);
            self.force[harmonic] = self.force[harmonic] * real(T::one() - gain) + force_then * real(gain);
            self.road[harmonic] = road + (seen * back - road) * gain;
            self.lever[harmonic] = lever + (force * back * beta - lever) * gain;
            self.variance[harmonic] = variance * (T::one() - gain);
            let weight = force.norm_sqr() / noise;
            gain_sum += gain * weight;
            weight_sum += weight;
        }
        // The deviation's uncertainty now enters the road, alike at all harmonics.
        let during = now[NOW] - (age + age) * now[RATE] + age * age * rate[RATE];
        let rest = during - beta * beta * then[THEN];
        if weight_sum > T::zero() && rest > T::zero() {
            let gain = gain_sum / weight_sum;
            self.motion.for_each(|gaussian| {
                gaussian.covariance[(THEN, THEN)] += gain * gain * rest;
                gaussian.covariance[(NOW, THEN)] += gain * rest;
                gaussian.covariance[(THEN, NOW)] += gain * rest;
            });
        }
    }
}

/// How old a pass is on average, in s.
fn age<T: Real>(clock: &PassClock<T>) -> T {
    T::lit(0.5) * clock.period_s()
}

fn real<T: Real>(value: T) -> Complex<T> {
    Complex::new(value, T::zero())
}
