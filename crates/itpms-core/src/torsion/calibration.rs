//! Calibration of a wheel's torsion, to be stored and loaded at the next start. The teeth are not in it: which one passes
//! first after a start is not known, and they are found anew within half a minute.

use crate::memory::Blank;
use crate::real::Real;

/// Slope, curvature and `ln` damping of the spectrum, and the resonance.
pub(super) const CURVES: usize = 4;

/// A parabola `b_0 + b_1 y + b_2 y²` of the speed, `y = (v - 20 m/s) / 10 m/s`, as information: `information b = vector`.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TorsionCurve<T> {
    /// Inverse of the coefficients' covariance.
    pub information: [[T; 3]; 3],
    /// The former times the coefficients.
    pub vector: [T; 3],
}

/// The stored calibration, loaded at the next start (`docs/math/wheel-speed.md`, eq. 17).
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TorsionCalibration<T> {
    /// The resonance in Hz from which the last curve counts.
    pub around_hz: T,
    /// Pieces that taught it.
    pub pieces: u32,
    /// Slope, curvature and `ln` damping of the spectrum, and the resonance in Hz over `around_hz`.
    pub curves: [TorsionCurve<T>; CURVES],
}

impl<T: Real> TorsionCalibration<T> {
    /// Whether it can be of a tire: a resonance of 10 to 150 Hz, pieces, positive and symmetric information, coefficients that are finite.
    #[must_use]
    pub fn is_sane(&self) -> bool {
        let around = self.around_hz >= T::lit(10.0) && self.around_hz <= T::lit(150.0);
        around && self.pieces > 0 && self.curves.iter().all(TorsionCurve::is_sane)
    }
}

impl<T: Real> TorsionCurve<T> {
    fn is_sane(&self) -> bool {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.information;
        let symmetric = b == d && c == g && f == h;
        // Sylvester's criterion.
        let minor = a * e - b * b;
        let determinant = a * (e * i - f * f) - b * (b * i - f * c) + c * (b * f - e * c);
        let positive = a > T::zero() && minor > T::zero() && determinant > T::zero();
        symmetric && positive && determinant.is_finite() && self.vector.iter().all(|x| x.is_finite())
    }
}
