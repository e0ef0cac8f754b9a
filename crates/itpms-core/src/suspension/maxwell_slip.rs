//! Friction of a strut as elements in parallel that each stick like a spring until they slip (Maxwell-slip model: Lampaert, Al-Bender and
//! Swevers 2003), every one smooth as in Dahl's model (1968): docs/math/unknown-car.md, eq. 1.

use crate::memory::Blank;
use crate::real::Real;
use crate::spectrum::front_end::ELEMENTS;

/// How far in m each element is moved before it slips.
const SLIP_M: [f64; ELEMENTS] = [1e-4, 3e-4, 1e-3];
/// Leak in rad/s of the integral that makes the relative velocity: well below the body's own frequency, whose motion decides which way a
/// strut slips.
const LEAK_RAD_S: f64 = core::f64::consts::TAU * 0.15;

/// The elements' forces for a slip force of one newton each.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MaxwellSlip<T> {
    last_accel: T,
    velocity: T,
    force: [T; ELEMENTS],
}

impl<T: Real> MaxwellSlip<T> {
    /// Takes the acceleration of the wheel less that of the body, without the sensors' offsets; gives the force of each element, -1 to 1.
    pub(crate) fn push(&mut self, accel: T, dt: T) -> [T; ELEMENTS] {
        let half_leak = T::lit(0.5 * LEAK_RAD_S) * dt;
        let step = T::lit(0.5) * dt * (accel + self.last_accel);
        self.velocity = ((T::one() - half_leak) * self.velocity + step) / (T::one() + half_leak);
        self.last_accel = accel;
        let (way, towards) = (self.velocity.abs() * dt, self.velocity.signum());
        for (force, slip_m) in self.force.iter_mut().zip(SLIP_M) {
            *force = towards + (*force - towards) * (-way / T::lit(slip_m)).exp_fast();
        }
        self.force
    }
}

#[cfg(test)]
mod tests {
    // Where another crate of the build brings `std`, numbers have these functions by themselves.
    #[allow(unused_imports)]
    use nalgebra::ComplexField;

    use super::*;

    /// A sine of relative motion of this amplitude in m; gives the work of each element over the last cycle, per newton.
    fn work_of_a_cycle(amplitude_m: f64, frequency_hz: f64) -> [f64; ELEMENTS] {
        let (dt, omega) = (1e-4, core::f64::consts::TAU * frequency_hz);
        let (mut slip, mut work) = (MaxwellSlip::<f64>::BLANK, [0.0; ELEMENTS]);
        // Long enough for what the beginning left in the integral to fade: 60 s, of which the last cycle is looked at.
        let (all, cycle) = ((60.0 / dt) as usize, (1.0 / (frequency_hz * dt)) as usize);
        for i in 0..all {
            let angle = omega * i as f64 * dt;
            let force = slip.push(-amplitude_m * omega * omega * angle.sin(), dt);
            if i >= all - cycle {
                let way = amplitude_m * omega * angle.cos() * dt;
                work.iter_mut().zip(force).for_each(|(work, force)| *work += force * way);
            }
        }
        work
    }

    #[test]
    fn a_cycle_takes_the_work_of_coulomb_friction_less_the_sticking() {
        // 4 F A of Coulomb friction. Each turn begins at minus one and goes as 1 - 2 exp(-x/δ): that takes 2 δ less, twice a cycle.
        let amplitude = 0.01;
        for (work, slip_m) in work_of_a_cycle(amplitude, 8.0).into_iter().zip(SLIP_M) {
            let expected = 4.0 * amplitude - 4.0 * slip_m;
            assert!((work / expected - 1.0).abs() < 0.01, "{work} {expected}");
        }
    }

    #[test]
    fn friction_does_not_depend_on_the_rate() {
        let (slow, fast) = (work_of_a_cycle(0.004, 6.0), work_of_a_cycle(0.004, 15.0));
        for (slow, fast) in slow.into_iter().zip(fast) {
            assert!((slow / fast - 1.0).abs() < 0.02, "{slow} {fast}");
        }
    }

    #[test]
    fn what_hardly_moves_sticks_like_a_spring() {
        // 2 % of the slip distance: a spring of F/δ.
        let mut slip = MaxwellSlip::<f64>::BLANK;
        let (dt, omega, amplitude) = (1e-4, core::f64::consts::TAU * 8.0, 2e-6);
        let mut reach = [[f64::INFINITY, f64::NEG_INFINITY]; ELEMENTS];
        for i in 0..600_000 {
            let angle = omega * f64::from(i) * dt;
            let force = slip.push(-amplitude * omega * omega * angle.sin(), dt);
            if i >= 600_000 - 1250 {
                let widen = |([least, most], force): (&mut [f64; 2], f64)| {
                    (*least, *most) = (least.min(force), most.max(force));
                };
                reach.iter_mut().zip(force).for_each(widen);
            }
        }
        for ([least, most], slip_m) in reach.into_iter().zip(SLIP_M) {
            let swing = 0.5 * (most - least);
            assert!((swing / (amplitude / slip_m) - 1.0).abs() < 0.05, "{swing} {slip_m}");
        }
    }
}
