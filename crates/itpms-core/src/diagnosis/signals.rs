//! The bands in which sensors are held against each other, and their moments, block by block (docs/math/monitor.md, section 3).
//!
//! | band | what is in it |
//! |---|---|
//! | hop, 8-20 Hz | the wheels hop: a wheel sensor sees some ten times what a body sensor sees, and a corner's body follows its own wheel |
//! | bounce, 1-6 Hz | the body moves as one rigid plane |
//! | slow, 0.4-0.9 Hz | body and wheel go up and down together, whatever dampers and load |

use nalgebra::SMatrix;

use crate::conditioning::THINNED_HZ;
use crate::diagnosis::filters::{Averager, Band, Triangle};
use crate::diagnosis::moments::Moments;
use crate::memory::Blank;
use crate::model::{CarConfig, HOP_BAND_HZ};
use crate::real::Real;

/// Bands in Hz of bounce and of slower motion; that of hop is [`HOP_BAND_HZ`].
pub(crate) const BOUNCE_HZ: [f64; 2] = [1.0, 6.0];
pub(crate) const SLOW_HZ: [f64; 2] = [0.4, 0.9];
/// Rate in Hz to which samples are averaged before bounce and slow; before hop it is [`THINNED_HZ`].
const SLOW_RATE_HZ: f64 = 25.0;
/// Leak of the integrators in rad/s: far below the band.
const LEAK_RAD_S: f64 = 6.0;

pub(crate) const fn width_hz([low, high]: [f64; 2]) -> f64 {
    high - low
}

/// Moments of a block. Bodies first, then wheels, each in the order of `Corner::ALL`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Block<T: Real> {
    /// Hop band: accelerations of the bodies, and what the struts make of the wheels' motion, in (m/s²)².
    pub(crate) hop: SMatrix<T, 8, 8>,
    /// Hop band: power of the wheels' accelerations.
    pub(crate) wheel_hop: [T; 4],
    /// Bounce band: accelerations of the bodies.
    pub(crate) bounce: SMatrix<T, 4, 4>,
    /// Slow band: accelerations of bodies and wheels.
    pub(crate) slow: [T; 8],
}

/// A corner's strut: what the wheel's velocity and displacement do to the body, per second and per second squared.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Strut<T> {
    damping_per_s: T,
    spring_per_s2: T,
    velocity: T,
    displacement: T,
}

/// Filters of eight sensors and the block that runs.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Signals<T: Real> {
    to_quick: Averager<T>,
    to_slow: Averager<T>,
    /// The slow band has a hundredth of the wheels' power near the lower rate: it takes a better filter.
    to_slow_band: Triangle<T>,
    quick_step_s: T,
    hop: [Band<T>; 8],
    bounce: [Band<T>; 4],
    slow: [Band<T>; 8],
    struts: [Strut<T>; 4],
    hop_moments: Moments<T, 8>,
    bounce_moments: Moments<T, 4>,
    wheel_hop: [T; 4],
    slow_power: [T; 8],
    quick_steps: u32,
    slow_steps: u32,
}

impl<T: Real> Signals<T> {
    pub(crate) fn configure(&mut self, car: &CarConfig<T>, rate_hz: f64) {
        let by = (rate_hz / THINNED_HZ).clamp(1.0, 1e6) as u32;
        let quick_hz = rate_hz / f64::from(by);
        let slow_by = (quick_hz / SLOW_RATE_HZ).clamp(1.0, 1e6) as u32;
        let slow_hz = quick_hz / f64::from(slow_by);
        let zero = T::zero();
        let strut = |corner: &Option<crate::model::CornerConfig<T>>| {
            let (damping_per_s, spring_per_s2) = corner.as_ref().map_or((zero, zero), |corner| {
                let car = &corner.quarter_car;
                let mass = car.sprung_mass_kg();
                (car.damping_n_s_per_m() / mass, car.spring_n_per_m() / mass)
            });
            Strut { damping_per_s, spring_per_s2, velocity: zero, displacement: zero }
        };
        self.to_quick = Averager::new(by);
        self.to_slow = Averager::new(slow_by);
        self.to_slow_band = Triangle::new(slow_by);
        self.quick_step_s = T::lit(1.0 / quick_hz);
        self.hop.fill(Band::new(HOP_BAND_HZ, quick_hz));
        self.bounce.fill(Band::new(BOUNCE_HZ, slow_hz));
        self.slow.fill(Band::new(SLOW_HZ, slow_hz));
        self.struts = car.corners.each_ref().map(strut);
        self.hop_moments = Moments::BLANK;
        self.bounce_moments = Moments::BLANK;
        (self.wheel_hop, self.slow_power) = ([zero; 4], [zero; 8]);
        (self.quick_steps, self.slow_steps) = (0, 0);
    }

    /// Takes a sample of every sensor, bodies first.
    pub(crate) fn push(&mut self, values: &[T; 8]) {
        let Some(quick) = self.to_quick.push(values) else { return };
        self.push_quick(&quick);
        if let Some(slow) = self.to_slow.push(&quick) {
            self.push_slow(&slow);
        }
        if let Some(slow) = self.to_slow_band.push(&quick) {
            self.push_slow_band(&slow);
        }
    }

    fn push_quick(&mut self, values: &[T; 8]) {
        let dt = self.quick_step_s;
        let mut z = [T::zero(); 8];
        for (i, (band, value)) in self.hop.iter_mut().zip(values).enumerate() {
            let accel = band.push(*value);
            if let Some(wheel) = i.checked_sub(4) {
                self.wheel_hop[wheel] += accel * accel;
                z[i] = self.struts[wheel].push(accel, dt);
            } else {
                z[i] = accel;
            }
        }
        self.hop_moments.push(&z);
        self.quick_steps += 1;
    }

    fn push_slow(&mut self, values: &[T; 8]) {
        let mut bodies = [T::zero(); 4];
        for (i, body) in bodies.iter_mut().enumerate() {
            *body = self.bounce[i].push(values[i]);
        }
        self.bounce_moments.push(&bodies);
    }

    fn push_slow_band(&mut self, values: &[T; 8]) {
        for ((power, band), value) in self.slow_power.iter_mut().zip(&mut self.slow).zip(values) {
            let accel = band.push(*value);
            *power += accel * accel;
        }
        self.slow_steps += 1;
    }

    /// Ends the block. `None` if nothing was in it.
    pub(crate) fn end_block(&mut self) -> Option<Block<T>> {
        let (hop, bounce) = (self.hop_moments.end_block(), self.bounce_moments.end_block());
        let per_quick = T::one() / T::lit(f64::from(self.quick_steps.max(1)));
        let per_slow = T::one() / T::lit(f64::from(self.slow_steps.max(1)));
        let wheel_hop = self.wheel_hop.map(|power| power * per_quick);
        let slow = self.slow_power.map(|power| power * per_slow);
        (self.wheel_hop, self.slow_power) = ([T::zero(); 4], [T::zero(); 8]);
        (self.quick_steps, self.slow_steps) = (0, 0);
        Some(Block { hop: hop?, wheel_hop, bounce: bounce?, slow })
    }
}

impl<T: Real> Strut<T> {
    /// Acceleration of a body at rest by spring and damper, in m/s², after a step of the wheel's acceleration.
    fn push(&mut self, accel: T, dt: T) -> T {
        let keep = T::one() - T::lit(LEAK_RAD_S) * dt;
        self.velocity = keep * self.velocity + dt * accel;
        self.displacement = keep * self.displacement + dt * self.velocity;
        self.damping_per_s * self.velocity + self.spring_per_s2 * self.displacement
    }
}
