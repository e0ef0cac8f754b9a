//! How the accelerations change with the car itself: the derivatives that an uncertain car costs.
//!
//! Called by `information`.

use std::f64::consts::TAU;

use itpms_core::model::CornerConfig;
use nalgebra::{Complex, Vector2};

/// Logarithms of unsprung mass, sprung mass, damping and spring: an uncertain corner's parameters, in this order.
pub(super) const CAR_PARAMETERS: usize = 4;

/// How well a vehicle file is believed, as relative sd: the estimators' priors (`docs/math/informed.md`, section 6), and
/// one per cent of the unsprung mass.
pub(super) const CAR_SD: [f64; CAR_PARAMETERS] = [0.01, 0.15, 0.20, 0.05];

/// Derivatives of the transfer from road to (body, wheel) acceleration by the four logarithms, in 1/s².
pub(super) fn slopes(
    corner: &CornerConfig<f64>,
    frequency_hz: f64,
    pressure_kpa: f64,
) -> [Vector2<Complex<f64>>; CAR_PARAMETERS] {
    let car = &corner.quarter_car;
    let k_t = corner.tire.stiffness_n_per_m(pressure_kpa);
    let s = Complex::new(0.0, TAU * frequency_hz);
    let one = Complex::new(1.0, 0.0);
    let (damper, spring) = (s * car.damping_n_s_per_m(), Complex::from(car.spring_n_per_m()));
    let (body, wheel) = (s * s * car.sprung_mass_kg(), s * s * car.unsprung_mass_kg());
    let z = damper + spring;
    // B = Z / (m_b s² + Z), D = m_w s² + Z (1 - B), H = k_t / (D + k_t)
    let b = z / (body + z);
    let d = wheel + z * (one - b);
    let h = Complex::from(k_t) / (d + k_t);
    let b_by_z = body / ((body + z) * (body + z));
    let b_by_body = -z * body / ((body + z) * (body + z));
    // By (B, D): d(s² H (B, 1)) = s² (H dB - H B dD / (D + k_t), -H dD / (D + k_t))
    let slope = |db: Complex<f64>, dd: Complex<f64>| {
        let dh = -h * dd / (d + k_t);
        Vector2::new(h * db + dh * b, dh) * (s * s)
    };
    let by_suspension = |dz: Complex<f64>| slope(b_by_z * dz, dz * (one - b) - z * b_by_z * dz);
    [
        slope(Complex::from(0.0), wheel),
        slope(b_by_body, -z * b_by_body),
        by_suspension(damper),
        by_suspension(spring),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_analysis::bound::transfers;
    use itpms_core::model::QuarterCar;

    #[test]
    fn slopes_are_finite_differences() {
        for f in [2.0, 9.0, 11.5, 40.0] {
            let found = slopes(&CornerConfig::paper(), f, 200.0);
            for (i, found) in found.iter().enumerate() {
                let at = |e: f64| {
                    let factor = |k: usize| if k == i { e.exp() } else { 1.0 };
                    let quarter_car = QuarterCar::new(
                        240.8 * factor(1),
                        56.9 * factor(0),
                        925.8 * factor(2),
                        29_114.0 * factor(3),
                    )
                    .unwrap();
                    transfers(&CornerConfig { quarter_car, ..CornerConfig::paper() }, f, 200.0).0
                };
                let expected = (at(1e-5) - at(-1e-5)) / Complex::from(2e-5);
                // Second order in the step: 1e-10 times the sharpness of the resonance, squared; and rounding, 1e-11.
                assert!(
                    (found - expected).norm() < 1e-7 * (expected.norm() + 1e-3 * at(0.0).norm()),
                    "{f} {i}"
                );
            }
        }
    }
}
