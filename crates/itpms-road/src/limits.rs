//! Observability of a road by two accelerometers: which wavelengths, how well (docs/math/road.md, section 5).
//!
//! Called by whoever states a record's band or an error bar for it; reads no data.

use nalgebra::Complex;

use crate::config::RoadConfig;
use crate::model::Model;
use itpms_core::Real;
use itpms_core::model::{ParameterError, positive};

/// Points of the integral over a band, evenly spaced in the logarithm of frequency.
const BAND_POINTS: usize = 128;

/// Accuracy of a road record for a road level and a sampling rate, in the steady state and with the right parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadLimits<T> {
    model: Model<T>,
    rate_hz: T,
}

impl<T: Real> RoadLimits<T> {
    /// Limits for a road of level `log_level` ([`crate::RoadLevel`]) seen by sensors sampled at `rate_hz`.
    /// Errors: the rate must be positive and finite, the level between -25 and 5.
    pub fn new(config: &RoadConfig<T>, log_level: T, rate_hz: T) -> Result<Self, ParameterError> {
        config.with_level(crate::RoadLevel::Fixed(log_level))?;
        Ok(Self { model: Model::of(config, log_level), rate_hz: positive("rate_hz", rate_hz)? })
    }

    /// One-sided density of the road at a frequency, m²/Hz: `2 q / w²`.
    pub fn road_density(&self, frequency_hz: T) -> T {
        let w = T::two_pi() * frequency_hz;
        T::lit(2.0) * self.model.road_intensity / (w * w)
    }

    /// One-sided density in m²/Hz of a flat road's height as the sensors' noise makes it, both sensors weighted as the
    /// filter does (eq. 19).
    pub fn noise_density(&self, frequency_hz: T) -> T {
        let two = T::lit(2.0);
        let w = T::two_pi() * frequency_hz;
        let (car, one) = (&self.model.car, Complex::new(T::one(), T::zero()));
        let (m_b, m_w, k_t) = (car.sprung_mass_kg(), car.unsprung_mass_kg(), self.model.stiffness_n_per_m);
        let s = Complex::new(T::zero(), w);
        let z = s * car.damping_n_s_per_m() + car.spring_n_per_m();
        // Body per wheel, wheel per road; and both per unexplained acceleration of the body.
        let body = s * s * m_b + z;
        let follow = z / body;
        let resist = s * s * m_w + z * (one - follow);
        let wheel = s * s * k_t / (resist + k_t);
        let (g_b, g_w) = (follow * wheel, wheel);
        let d_w = s * s * follow * m_b / (resist + k_t);
        let d_b = s * s * m_b / body + follow * d_w;
        let noise =
            two * self.model.noise_variance / self.rate_hz + two * self.model.bias_intensity / (w * w);
        let unexplained = two * self.model.body_intensity();
        let seen = g_b.norm_sqr() + g_w.norm_sqr();
        let confused = (d_b.conj() * g_b + d_w.conj() * g_w).norm_sqr();
        let lost = unexplained * confused / (noise + unexplained * (d_b.norm_sqr() + d_w.norm_sqr()));
        noise / (seen - lost)
    }

    /// Error of the smoothed record at a frequency over the road there, as amplitudes: 0 sees all, 1 nothing.
    pub fn relative_error(&self, frequency_hz: T) -> T {
        let (road, noise) = (self.road_density(frequency_hz), self.noise_density(frequency_hz));
        (noise / (road + noise)).sqrt()
    }

    /// The longest wavelength in m that is recorded to within `relative_error` (0 to 1) at `speed_m_s`: 0.7 is the
    /// usual half-power limit, 0.1 a record to measure in.
    pub fn longest_wavelength_m(&self, speed_m_s: T, relative_error: T) -> T {
        // The error falls with frequency up to the body's resonance: bisect below it.
        let (mut low, mut high) = (T::lit(1e-3).ln(), T::lit(10.0).ln());
        for _ in 0..40 {
            let middle = T::lit(0.5) * (low + high);
            if self.relative_error(middle.exp()) > relative_error { low = middle } else { high = middle }
        }
        speed_m_s / high.exp()
    }

    /// Standard deviation in m of the smoothed record's error within a band of frequencies in Hz.
    pub fn band_sd_m(&self, low_hz: T, high_hz: T) -> T {
        let step = (high_hz / low_hz).ln() / T::lit(BAND_POINTS as f64);
        let mut sum = T::zero();
        for i in 0..BAND_POINTS {
            let f = low_hz * (step * T::lit(i as f64 + 0.5)).exp();
            let error = self.relative_error(f);
            sum += error * error * self.road_density(f) * f * step;
        }
        sum.sqrt()
    }
}
