//! A mass on a spring and a damper: a hop damper, a mode of the body.
//!
//! Part of the whole car.

/// A mass with the square of its angular frequency and the damping over the mass.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Oscillator {
    pub(crate) mass_kg: f64,
    per_s2: f64,
    per_s: f64,
}

impl Oscillator {
    pub(crate) fn new(mass_kg: f64, hz: f64, ratio: f64) -> Self {
        let omega = std::f64::consts::TAU * hz;
        Self { mass_kg, per_s2: omega * omega, per_s: 2.0 * ratio * omega }
    }

    /// Acceleration in m/s² at a distance in m and a speed in m/s from where it rests.
    #[inline]
    pub(crate) fn pull_m_s2(&self, distance_m: f64, speed_m_s: f64) -> f64 {
        -self.per_s2 * distance_m - self.per_s * speed_m_s
    }
}
