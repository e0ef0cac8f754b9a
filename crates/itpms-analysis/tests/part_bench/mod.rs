//! A bench for springs and dampers with known answers: slow strokes and imposed sines, a part with friction that needs some
//! travel to turn round (Dahl 1968), sensors with white and with slow noise. Shares no line with the identification.
#![allow(dead_code, reason = "each test file uses a part of it")]

use std::f64::consts::TAU;

use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// The paper's bench, Sec. 5.1.
pub(crate) const SPRING_N_PER_M: f64 = 20_663.0;
pub(crate) const DAMPING_N_S_PER_M: f64 = 435.2;

/// Noise of a force sensor: white, and an autoregressive one that forgets with a time constant.
#[derive(Clone, Copy)]
pub(crate) struct Noise {
    pub(crate) white_n: f64,
    pub(crate) slow_n: f64,
    pub(crate) slow_s: f64,
}

pub(crate) const WHITE: Noise = Noise { white_n: 2.0, slow_n: 0.0, slow_s: 1.0 };
/// As large as the white one and far from white: hum, guides that stick, an amplifier that wanders.
pub(crate) const COLORED: Noise = Noise { white_n: 1.0, slow_n: 2.0, slow_s: 0.05 };

pub(crate) struct Dice(Pcg64Mcg);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    pub(crate) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Noise for `n` samples `dt` apart.
    pub(crate) fn noise(&mut self, noise: Noise, dt: f64, n: usize) -> Vec<f64> {
        let keep = (-dt / noise.slow_s).exp();
        let mut slow = noise.slow_n * self.normal();
        (0..n)
            .map(|_| {
                slow = keep * slow + noise.slow_n * (1.0 - keep * keep).sqrt() * self.normal();
                slow + noise.white_n * self.normal()
            })
            .collect()
    }
}

/// Dahl's friction along a displacement: `level_n` at most, turned round within a few `turn_m`.
pub(crate) fn friction(x: &[f64], level_n: f64, turn_m: f64) -> Vec<f64> {
    let mut force = 0.0;
    let mut before = x[0];
    x.iter()
        .map(|x| {
            let step = x - before;
            before = *x;
            // Exact for a straight step.
            let end = level_n * step.signum();
            force = end + (force - end) * (-step.abs() / turn_m).exp();
            force
        })
        .collect()
}

/// Slow strokes: `cycles` times up and down over ±`half_m` at `speed_m_s`.
pub(crate) struct SpringTest {
    pub(crate) cycles: usize,
    pub(crate) half_m: f64,
    pub(crate) speed_m_s: f64,
    pub(crate) rate_hz: f64,
    pub(crate) friction_n: f64,
    /// Growth of the stiffness from the middle to the end of the travel, as a share.
    pub(crate) progressive: f64,
    pub(crate) noise: Noise,
}

impl Default for SpringTest {
    fn default() -> Self {
        let (cycles, half_m, speed_m_s, rate_hz, friction_n) = (5, 0.03, 0.01, 20.0, 25.0);
        Self { cycles, half_m, speed_m_s, rate_hz, friction_n, progressive: 0.0, noise: WHITE }
    }
}

impl SpringTest {
    /// Displacement in m and load in N.
    pub(crate) fn record(&self, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let mut dice = Dice::new(seed);
        let dt = 1.0 / self.rate_hz;
        let stroke_s = 2.0 * self.half_m / self.speed_m_s;
        let n = (2.0 * stroke_s * self.cycles as f64 * self.rate_hz).round() as usize + 1;
        let x: Vec<f64> = (0..n)
            .map(|i| {
                let phase = (i as f64 * dt / stroke_s) % 2.0;
                self.half_m * (if phase < 1.0 { 2.0 * phase - 1.0 } else { 3.0 - 2.0 * phase })
            })
            .collect();
        let rubbing = friction(&x, self.friction_n, 2e-4);
        let noise = dice.noise(self.noise, dt, n);
        let load = (0..n)
            .map(|i| {
                let u = x[i] / self.half_m;
                SPRING_N_PER_M * x[i] * (1.0 + 0.5 * self.progressive * u) + 600.0 + rubbing[i] + noise[i]
            })
            .collect();
        // A good transducer: 5 micrometers.
        let x = x.iter().map(|x| x + 5e-6 * dice.normal()).collect();
        (x, load)
    }
}

/// One sine after the other, each as (frequency in Hz, amplitude in m, periods).
pub(crate) struct DamperTest {
    pub(crate) sines: Vec<(f64, f64, usize)>,
    pub(crate) rate_hz: f64,
    pub(crate) friction_n: f64,
    /// Travel in m over which friction turns round.
    pub(crate) turn_m: f64,
    pub(crate) spring_n_per_m: f64,
    /// Rebound over bump, minus one.
    pub(crate) asymmetry: f64,
    /// Exponent of the velocity; one is linear.
    pub(crate) exponent: f64,
    pub(crate) noise: Noise,
}

impl Default for DamperTest {
    fn default() -> Self {
        Self {
            sines: vec![(1.0, 0.02, 12), (2.0, 0.02, 15), (4.0, 0.012, 20)],
            rate_hz: 200.0,
            friction_n: 15.0,
            turn_m: 2e-4,
            spring_n_per_m: 0.0,
            asymmetry: 0.0,
            exponent: 1.0,
            noise: WHITE,
        }
    }
}

pub(crate) type Sine = (Vec<f64>, Vec<f64>, Vec<f64>);

impl DamperTest {
    /// Time in s, displacement in m, force in N: the sines one by one.
    pub(crate) fn records(&self, seed: u64) -> Vec<Sine> {
        let mut dice = Dice::new(seed);
        self.sines.iter().map(|sine| self.record(*sine, &mut dice)).collect()
    }

    fn record(&self, (frequency, amplitude, periods): (f64, f64, usize), dice: &mut Dice) -> Sine {
        let dt = 1.0 / self.rate_hz;
        let n = (periods as f64 / frequency * self.rate_hz).round() as usize + 1;
        let t: Vec<f64> = (0..n).map(|i| i as f64 * dt).collect();
        let angle = |t: f64| TAU * frequency * t;
        let x: Vec<f64> =
            t.iter().map(|t| amplitude * (angle(*t).sin() + 0.003 * (2.0 * angle(*t)).sin())).collect();
        let v: Vec<f64> = t
            .iter()
            .map(|t| amplitude * TAU * frequency * (angle(*t).cos() + 0.006 * (2.0 * angle(*t)).cos()))
            .collect();
        let rubbing = friction(&x, self.friction_n, self.turn_m);
        let noise = dice.noise(self.noise, dt, n);
        // The two directions have DAMPING_N_S_PER_M as their mean.
        let side = |v: f64| {
            if v > 0.0 {
                2.0 / (2.0 + self.asymmetry)
            } else {
                2.0 * (1.0 + self.asymmetry) / (2.0 + self.asymmetry)
            }
        };
        let viscous =
            |v: f64| DAMPING_N_S_PER_M * side(v) * 0.2 * (v.abs() / 0.2).powf(self.exponent) * v.signum();
        let force = (0..n)
            .map(|i| viscous(v[i]) + self.spring_n_per_m * x[i] + rubbing[i] + 40.0 + noise[i])
            .collect();
        let x = x.iter().map(|x| x + 2e-5 * dice.normal()).collect();
        (t, x, force)
    }
}
