//! The reference on a test bed: a pressure sensor that is slow, noisy and coarse, as real ones are.
//!
//! Called by the simulation. What it shows is what a log holds; the true pressure stays beside it in the row, and
//! nothing that is scored looks at the sensor.

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::error::{Result, not_negative};
use crate::streams::{Purpose, generator};

#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PressureSensorSpec {
    /// Time constant in s of its first-order lag.
    pub time_constant_s: f64,
    /// White noise in kPa, rms per sample.
    pub noise_kpa: f64,
    /// Step of its display in kPa; 0: none.
    pub resolution_kpa: f64,
}

impl PressureSensorSpec {
    pub(crate) fn validate(&self) -> Result<()> {
        not_negative("time_constant_s", self.time_constant_s)?;
        not_negative("noise_kpa", self.noise_kpa)?;
        not_negative("resolution_kpa", self.resolution_kpa)
    }
}

#[derive(Debug, Clone)]
pub(crate) struct PressureSensor {
    spec: PressureSensorSpec,
    noise: Pcg64,
    /// Time in s, true and lagging pressure in kPa of the last reading.
    last: Option<[f64; 3]>,
}

impl PressureSensor {
    /// `number` tells the corners of a drive apart.
    pub(crate) fn new(spec: &PressureSensorSpec, seed: u64, number: u64) -> Self {
        Self { spec: *spec, noise: generator(seed, Purpose::PressureNoise, [number, 0]), last: None }
    }

    /// Reading in kPa for a true pressure. Times increase; the first reading has caught up.
    pub(crate) fn read(&mut self, time_s: f64, true_kpa: f64) -> f64 {
        let lagging = match self.last {
            Some([last_s, last_kpa, lagging]) => self.follow(time_s - last_s, [last_kpa, true_kpa], lagging),
            None => true_kpa,
        };
        self.last = Some([time_s, true_kpa, lagging]);
        let white: f64 = StandardNormal.sample(&mut self.noise);
        let reading = lagging + self.spec.noise_kpa * white;
        if self.spec.resolution_kpa > 0.0 {
            (reading / self.spec.resolution_kpa).round() * self.spec.resolution_kpa
        } else {
            reading
        }
    }

    /// `τ dy/dt = p - y` over `dt` seconds, solved exactly for a pressure that moves straight from `from` to `to`.
    fn follow(&self, dt: f64, [from, to]: [f64; 2], lagging: f64) -> f64 {
        let tau = self.spec.time_constant_s;
        if !(tau > 0.0 && dt > 0.0) {
            return to;
        }
        // On a ramp the sensor ends up this far behind.
        let behind = tau * (to - from) / dt;
        to - behind + (lagging - from + behind) * (-dt / tau).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLOW: PressureSensorSpec =
        PressureSensorSpec { time_constant_s: 0.15, noise_kpa: 0.0, resolution_kpa: 0.0 };

    #[test]
    fn it_follows_a_ramp_as_the_closed_form_says() {
        let mut sensor = PressureSensor::new(&SLOW, 1, 0);
        let (rate, start) = (-16.4, 224.0);
        // Uneven steps: the solution does not depend on them. y = p0 + r (t - τ + τ e^{-t/τ}).
        for t in [0.0, 0.002, 0.01, 0.1, 0.13, 0.7, 3.0, 5.0] {
            let expected = start + rate * (t - 0.15 + 0.15 * (-t / 0.15f64).exp());
            assert!((sensor.read(t, start + rate * t) - expected).abs() < 1e-10, "{t}");
        }
    }

    #[test]
    fn it_shows_whole_steps_and_its_noise() {
        let spec = PressureSensorSpec { noise_kpa: 0.4, ..PressureSensorSpec::default() };
        let mut sensor = PressureSensor::new(&spec, 1, 0);
        let n = 20_000;
        let square = (0..n).map(|i| (sensor.read(f64::from(i), 200.0) - 200.0).powi(2)).sum::<f64>();
        // sd of a variance over n values: sqrt(2/n) = 1 %; four of them.
        assert!((square / f64::from(n) / 0.16 - 1.0).abs() < 0.04);
        let coarse = PressureSensorSpec { resolution_kpa: 2.0, ..PressureSensorSpec::default() };
        let mut sensor = PressureSensor::new(&coarse, 1, 0);
        assert_eq!([200.9, 201.1].map(|p| sensor.read(p, p)), [200.0, 202.0]);
    }

    #[test]
    fn without_a_time_constant_it_is_at_once() {
        let mut sensor = PressureSensor::new(&PressureSensorSpec::default(), 1, 0);
        assert_eq!([(0.0, 224.0), (0.1, 142.0)].map(|(t, p)| sensor.read(t, p)), [224.0, 142.0]);
    }
}
