//! Calibration of a wheel's spectrum: its resonance and its shape, each a parabola of the speed
//! (`docs/math/wheel-speed.md`, eq. 17).

use nalgebra::{Matrix3, Vector3};

use super::calibration::{CURVES, TorsionCalibration, TorsionCurve};
use super::config::TorsionConfig;
use super::fit::{Fitted, SHAPES, Shape};
use crate::memory::Blank;
use crate::real::Real;

/// For level, slope and curvature over speed: mean and sd before a calibration.
type Prior = [(f64, f64); 3];
/// Slope, curvature and `ln` damping of a spectrum on roads, and what a piece of the same speed differs by.
const SHAPE_PRIORS: [(Prior, f64); SHAPES] = [
    ([(-1.5, 2.0), (0.0, 1.0), (0.0, 1.0)], 0.4),
    ([(0.0, 1.0), (0.0, 1.0), (0.0, 1.0)], 0.3),
    ([(-1.61, 0.4), (0.3, 0.3), (0.0, 0.3)], 0.1),
];
const RESONANCE_PRIOR: Prior = [(0.0, 5.0), (1.0, 2.0), (0.6, 1.0)];

/// A parabola of `x = (v - 20 m/s) / 10 m/s` as information.
#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Parabola<T: Real> {
    information: Matrix3<T>,
    vector: Vector3<T>,
}

impl<T: Real> Parabola<T> {
    fn new(prior: &Prior) -> Self {
        let inverse = prior.map(|(_, sd)| T::lit(1.0 / (sd * sd)));
        let vector = prior.map(|(mean, sd)| T::lit(mean / (sd * sd)));
        Self { information: Matrix3::from_diagonal(&Vector3::from(inverse)), vector: Vector3::from(vector) }
    }

    fn stored(&self) -> TorsionCurve<T> {
        // To the last bit what a file keeps: its upper triangle. Below it products were rounded in another order.
        let at = |i: usize, j: usize| self.information[(i.min(j), i.max(j))];
        let information = core::array::from_fn(|i| core::array::from_fn(|j| at(i, j)));
        TorsionCurve { information, vector: self.vector.into() }
    }

    fn of(stored: &TorsionCurve<T>) -> Self {
        Self { information: stored.information.into(), vector: stored.vector.into() }
    }

    fn learn(&mut self, x: &Vector3<T>, value: T, variance: T) {
        let weighed = x * (T::one() / variance);
        self.information += weighed * x.transpose();
        self.vector += weighed * value;
    }

    fn at(&self, x: &Vector3<T>) -> (T, T) {
        let covariance = self.information.try_inverse().unwrap_or_else(Matrix3::identity);
        let along = covariance * x;
        (along.dot(&self.vector), along.dot(x))
    }
}

#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Reference<T: Real> {
    shapes: [Parabola<T>; SHAPES],
    resonance: Parabola<T>,
    around_hz: T,
    pieces: u32,
}

impl<T: Real> Reference<T> {
    pub(super) fn new(config: &TorsionConfig<T>) -> Self {
        Self {
            shapes: SHAPE_PRIORS.map(|(prior, _)| Parabola::new(&prior)),
            resonance: Parabola::new(&RESONANCE_PRIOR),
            around_hz: config.resonance_hz,
            pieces: 0,
        }
    }

    pub(super) fn stored(&self) -> TorsionCalibration<T> {
        let mut curves = [TorsionCurve { information: [[T::zero(); 3]; 3], vector: [T::zero(); 3] }; CURVES];
        let [shapes @ .., resonance] = &mut curves;
        for (curve, parabola) in shapes.iter_mut().zip(&self.shapes) {
            *curve = parabola.stored();
        }
        *resonance = self.resonance.stored();
        TorsionCalibration { around_hz: self.around_hz, pieces: self.pieces, curves }
    }

    pub(super) fn of(stored: &TorsionCalibration<T>) -> Self {
        let [slope, curvature, damping, resonance] = stored.curves.map(|curve| Parabola::of(&curve));
        Self {
            shapes: [slope, curvature, damping],
            resonance,
            around_hz: stored.around_hz,
            pieces: stored.pieces,
        }
    }

    pub(super) fn pieces(&self) -> u32 {
        self.pieces
    }

    /// Slope, curvature and `ln` damping that are expected at a speed.
    pub(super) fn shape(&self, speed_m_s: T) -> Shape<T> {
        let x = over(speed_m_s);
        let mut shape = Shape { mean: [T::zero(); SHAPES], variance: [T::one(); SHAPES] };
        let places = shape.mean.iter_mut().zip(&mut shape.variance);
        for ((mean, variance), (parabola, (prior, sd))) in places.zip(self.shapes.iter().zip(&SHAPE_PRIORS)) {
            // Before a calibration there is no parabola yet but the prior's.
            let parabola = if self.around_hz > T::zero() { *parabola } else { Parabola::new(prior) };
            let (value, known) = parabola.at(&x);
            (*mean, *variance) = (value, known + T::lit(sd * sd));
        }
        shape
    }

    /// The resonance that is expected at a speed in Hz, and its variance.
    pub(super) fn resonance(&self, speed_m_s: T) -> (T, T) {
        let (value, variance) = self.resonance.at(&over(speed_m_s));
        (self.around_hz + value, variance)
    }

    pub(super) fn learn(&mut self, fitted: &Fitted<T>, speed_m_s: T, variance: T) {
        let x = over(speed_m_s);
        for ((parabola, value), (value_variance, (_, sd))) in
            self.shapes.iter_mut().zip(fitted.shape).zip(fitted.shape_variance.iter().zip(&SHAPE_PRIORS))
        {
            parabola.learn(&x, value, *value_variance + T::lit(sd * sd));
        }
        self.resonance.learn(&x, fitted.hz - self.around_hz, variance);
        self.pieces = self.pieces.saturating_add(1);
    }
}

fn over<T: Real>(speed_m_s: T) -> Vector3<T> {
    let x = (speed_m_s - T::lit(20.0)) * T::lit(0.1);
    Vector3::new(T::one(), x, x * x)
}

impl<T: Real> TorsionCalibration<T> {
    /// The resonance's standard deviation in Hz at the speed from 8 to 40 m/s at which it is known best.
    #[must_use]
    pub fn resonance_sd_hz(&self) -> T {
        let learned = Reference::of(self);
        let at = |speed: u32| learned.resonance(T::whole(speed)).1;
        (8..=40).map(at).fold(T::lit(1e6), T::at_most).sqrt()
    }
}
