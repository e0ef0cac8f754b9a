//! How a wheel moves forward and back, as far as a tilted accelerometer sees it.
//!
//! Called by a corner in motion. The tire's force stands on the road: where the road rises, it points backwards by its
//! slope. The wheel gives way on its suspension's rubber, a spring and a damper against the body, which goes as the car.

use std::f64::consts::TAU;

/// Frequency and damping ratio of a wheel on its suspension's rubber, fore and aft (some 15 to 20 Hz on cars).
const HZ: f64 = 17.0;
const RATIO: f64 = 0.2;

#[derive(Debug, Clone)]
pub(crate) struct ForeAft {
    per_wheel_kg: f64,
    place_m: f64,
    rate_m_s: f64,
}

impl ForeAft {
    pub(crate) fn new(unsprung_kg: f64) -> Self {
        Self { per_wheel_kg: unsprung_kg.recip(), place_m: 0.0, rate_m_s: 0.0 }
    }

    /// Acceleration in m/s² forward, against the body, at the end of a step on a slope with what the tire carries in N.
    pub(crate) fn step(&mut self, step_s: f64, slope: f64, tire_n: f64) -> f64 {
        let omega = TAU * HZ;
        let pushed = -slope * tire_n * self.per_wheel_kg;
        let acceleration = pushed - omega * omega * self.place_m - 2.0 * RATIO * omega * self.rate_m_s;
        // Symplectic: stable up to 2/ω, 19 ms, and exact enough far below it.
        self.rate_m_s += step_s * acceleration;
        self.place_m += step_s * self.rate_m_s;
        acceleration
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The acceleration answers a force's sine by `r²/sqrt((1 - r²)² + (2 ζ r)²)` with `r` the frequency over its own.
    #[test]
    fn a_slope_shakes_the_wheel_as_the_closed_form_says() {
        let (mass_kg, tire_n, slope, h) = (50.0, 3000.0, 0.01, 1.0 / 4000.0);
        for hz in [3.0, 17.0, 40.0] {
            let mut wheel = ForeAft::new(mass_kg);
            let (mut sine, mut cosine) = (0.0, 0.0);
            for i in 0..12_000 {
                let t = f64::from(i) * h;
                let a = wheel.step(h, slope * (TAU * hz * t).sin(), tire_n);
                if i >= 8000 {
                    sine += a * (TAU * hz * t).sin() / 2000.0;
                    cosine += a * (TAU * hz * t).cos() / 2000.0;
                }
            }
            let r = hz / HZ;
            let expected =
                slope * tire_n / mass_kg * r * r / ((1.0 - r * r).powi(2) + (2.0 * RATIO * r).powi(2)).sqrt();
            // First order in a damping of 2 ζ ω h = 1 %.
            assert!(
                (sine.hypot(cosine) / expected - 1.0).abs() < 0.02,
                "{hz} Hz: {sine} {cosine} {expected}"
            );
        }
    }
}
