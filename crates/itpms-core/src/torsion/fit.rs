//! The frequency of a resonance in a mean spectrum: Whittle's likelihood over a grid of frequencies, what is not asked for fitted at
//! each (`docs/math/wheel-speed.md`, eq. 15, 16).

use nalgebra::{Matrix4, SVector, Vector4};

use super::HOP_S;
use crate::real::Real;
use crate::spectrum::INDEPENDENT;

/// Bins of a frame, from one distance of bins on: up to 74 Hz.
pub(super) const BINS: usize = 38;
/// Band in Hz, and its upper limit as a share of the teeth's rate.
const FROM_HZ: f64 = 24.0;
const MOST_OF_TEETH: f64 = 0.36;
/// The grid of resonances in Hz.
const LOWEST_HZ: f64 = 32.0;
const GRID_HZ: f64 = 0.5;
const GRID: usize = 69;
/// Steps of Gauss and Newton at the grid's first frequency, and at the others from their neighbor on.
const FIRST_STEPS: usize = 12;
const STEPS: usize = 4;
/// Least power over noise, largest standard deviation in Hz.
const LEAST_SIGNAL: f64 = 3.0;
const MOST_SD_HZ: f64 = 3.5;

/// Slope, curvature, `ln` damping.
pub(super) const SHAPES: usize = 3;

/// Prior of a spectrum's shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape<T> {
    pub mean: [T; SHAPES],
    pub variance: [T; SHAPES],
}

/// A mean periodogram of a wheel's rate in (rad/s)²/Hz.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spectrum<T> {
    pub power: SVector<T, BINS>,
    pub frames: u32,
    pub tooth_hz: T,
    pub edge_variance_rad2: T,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Fitted<T> {
    pub hz: T,
    pub sd_hz: T,
    pub signal_to_noise: T,
    pub shape: [T; SHAPES],
    pub shape_variance: [T; SHAPES],
}

impl<T: Real> Fitted<T> {
    pub(super) fn carries(&self) -> bool {
        let highest_hz = LOWEST_HZ + GRID_HZ * (GRID - 1) as f64;
        let inside = self.hz > T::lit(LOWEST_HZ + 1.0) && self.hz < T::lit(highest_hz - 2.0);
        self.signal_to_noise > T::lit(LEAST_SIGNAL) && self.sd_hz < T::lit(MOST_SD_HZ) && inside
    }
}

/// A bin that counts: frequency, power, share that sampling by teeth leaves of a tremble, and power of the edges' noise.
#[derive(Debug, Clone, Copy)]
struct Bin<T> {
    hz: T,
    power: T,
    left: T,
    noise: T,
}

impl<T: Real> Spectrum<T> {
    fn bins(&self) -> impl Iterator<Item = Bin<T>> + Clone + '_ {
        let most_hz = T::lit(MOST_OF_TEETH) * self.tooth_hz;
        self.power
            .iter()
            .enumerate()
            .map(move |(bin, power)| {
                let hz = T::lit(0.5 / HOP_S * (bin + 1) as f64);
                let of_teeth = hz / self.tooth_hz;
                // sinc⁴ of a mean from tooth to tooth and of holding it: sinc x = 1 - (pi x)²/6 + (pi x)⁴/120.
                let square = T::lit(9.869_604) * of_teeth * of_teeth;
                let sinc = T::one() - square * (T::lit(1.0 / 6.0) - square * T::lit(1.0 / 120.0));
                let left = sinc * sinc * sinc * sinc;
                let density = T::lit(78.956_835) * self.edge_variance_rad2 * hz * hz / self.tooth_hz;
                Bin { hz, power: *power, left, noise: density * left }
            })
            .filter(move |bin| bin.hz >= T::lit(FROM_HZ) && bin.hz <= most_hz)
    }

    /// Mean of power over noise near the resonance, less the noise itself.
    fn signal_to_noise(&self) -> T {
        let (mut sum, mut number) = (T::zero(), T::zero());
        for bin in self.bins().filter(|bin| bin.hz > T::lit(35.0) && bin.hz < T::lit(55.0)) {
            sum += bin.power / bin.noise - T::one();
            number += T::one();
        }
        if number > T::zero() { sum / number } else { T::zero() }
    }
}

pub(super) fn fit<T: Real>(spectrum: &Spectrum<T>, shape: &Shape<T>) -> Fitted<T> {
    let weight = T::lit(INDEPENDENT) * T::whole(spectrum.frames);
    let mut problem = Problem::new(spectrum, shape, weight);
    let mut best = T::lit(-1e30);
    let mut logs = [T::zero(); GRID];
    let (mut shape, mut shape_variance) = (shape.mean, shape.variance);
    for (number, log) in logs.iter_mut().enumerate() {
        let hz = T::lit(LOWEST_HZ + GRID_HZ * number as f64);
        let steps = if number == 0 { FIRST_STEPS } else { STEPS };
        let (likelihood, covariance) = problem.at(hz, steps);
        *log = likelihood;
        if likelihood > best {
            best = likelihood;
            let [_, slope, curvature, damping] = problem.value.into();
            shape = [slope, curvature, damping];
            shape_variance = [covariance.m22, covariance.m33, covariance.m44];
        }
    }
    let (mut sum, mut first, mut second) = (T::zero(), T::zero(), T::zero());
    for (number, log) in logs.into_iter().enumerate() {
        let (weight, at) = ((log - best).exp_fast(), T::lit(GRID_HZ * number as f64));
        sum += weight;
        first += weight * at;
        second += weight * at * at;
    }
    let mean = first / sum;
    // A grid's own step is known no better than it is wide.
    let variance = (second / sum - mean * mean).at_least(T::lit(GRID_HZ * GRID_HZ / 12.0));
    let sd_hz = variance.sqrt();
    let hz = mean + T::lit(LOWEST_HZ);
    let signal_to_noise = spectrum.signal_to_noise();
    if hz.is_finite() && sd_hz.is_finite() {
        Fitted { hz, sd_hz, signal_to_noise, shape, shape_variance }
    } else {
        Fitted { hz: T::zero(), sd_hz: T::lit(1e3), signal_to_noise: T::zero(), shape, shape_variance }
    }
}

/// Level, slope, curvature and `ln` damping at a frequency.
struct Problem<'a, T: Real> {
    spectrum: &'a Spectrum<T>,
    weight: T,
    value: Vector4<T>,
    expected: Vector4<T>,
    information: Vector4<T>,
}

/// A bin's frequency over 45 Hz in `ln`, and its squared ratio to the resonance.
fn places<T: Real>(bin: &Bin<T>, hz: T) -> (T, T) {
    let ratio = bin.hz / hz;
    ((bin.hz * T::lit(1.0 / 45.0)).ln_fast(), ratio * ratio)
}

impl<'a, T: Real> Problem<'a, T> {
    fn new(spectrum: &'a Spectrum<T>, shape: &Shape<T>, weight: T) -> Self {
        let (mut sum, mut number) = (T::lit(1e-20), T::lit(1e-20));
        for bin in spectrum.bins() {
            sum += bin.power;
            number += T::one();
        }
        let [slope, curvature, damping] = shape.mean;
        let expected = Vector4::new((sum / number).ln_fast(), slope, curvature, damping);
        let [a, q, z] = shape.variance.map(|variance| T::one() / variance);
        let information = Vector4::new(T::lit(1.0 / 9.0), a, q, z);
        Self { spectrum, weight, value: expected, expected, information }
    }

    /// Log of the likelihood of a frequency, the rest integrated out near its best values, and their covariance.
    fn at(&mut self, hz: T, steps: usize) -> (T, Matrix4<T>) {
        let mut hessian = Matrix4::identity();
        for _ in 0..steps {
            let mut gradient = (self.expected - self.value).component_mul(&self.information);
            hessian = Matrix4::from_diagonal(&self.information);
            for bin in self.spectrum.bins() {
                let (x, ratio) = places(&bin, hz);
                let (signal, damped) = self.signal(x, ratio);
                let all = signal * bin.left + bin.noise;
                let share = signal * bin.left / all;
                let slope = Vector4::new(T::one(), x, x * x, -damped) * share;
                gradient += slope * (self.weight * (bin.power / all - T::one()));
                hessian += slope * slope.transpose() * self.weight;
            }
            let Some(inverse) = hessian.try_inverse() else { break };
            // No longer, lest it jump over the maximum.
            let most = T::lit(0.7);
            self.value += (inverse * gradient).map(|step| step.at_least(-most).at_most(most));
        }
        let away = self.value - self.expected;
        let mut log = -T::lit(0.5) * away.component_mul(&away).dot(&self.information);
        for bin in self.spectrum.bins() {
            let (x, ratio) = places(&bin, hz);
            let all = self.signal(x, ratio).0 * bin.left + bin.noise;
            log -= self.weight * (all.ln_fast() + bin.power / all);
        }
        log -= T::lit(0.5) * hessian.determinant().at_least(T::lit(1e-30)).ln_fast();
        (log, hessian.try_inverse().unwrap_or_else(Matrix4::identity))
    }

    /// The spectrum without noise, and by how much its `ln` falls with that of the damping.
    fn signal(&self, x: T, ratio: T) -> (T, T) {
        let [level, slope, curvature, damping] = self.value.into();
        let square = T::lit(4.0) * (damping + damping).exp_fast() * ratio;
        let apart = T::one() - ratio;
        let below = apart * apart + square;
        ((level + x * (slope + x * curvature)).exp_fast() / below, T::lit(2.0) * square / below)
    }
}
