//! Model of an accelerometer and its bus.
//!
//! Called by the simulation with filtered, sampled accelerations. Gravity is not in them; a bias can stand for it.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::error::{Result, not_negative, positive, within};
use crate::streams::{Purpose, generator};

/// An accelerometer as written in a scenario.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorSpec {
    /// White noise in m/s², rms per sample.
    pub noise_m_s2: f64,
    pub bias_m_s2: f64,
    /// Relative error of the gain: 0.01 reads 1 % too much.
    pub gain_error: f64,
    /// Step of the converter in m/s²; 0: none.
    pub resolution_m_s2: f64,
    /// Largest reading either way in m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_m_s2: Option<f64>,
    pub dropout_fraction: f64,
    /// Mean number of samples lost in a row.
    pub dropout_burst_samples: f64,
    /// Angle in degrees by which it leans forward: it reads `a_z cos + a_x sin`.
    pub tilt_deg: f64,
    /// Share of the fore-aft acceleration that it reads beside the vertical one, tilted or not.
    pub fore_aft_share: f64,
    /// Time in ms by which its readings are late, beyond the anti-alias filter.
    pub delay_ms: f64,
}

impl Default for SensorSpec {
    fn default() -> Self {
        Self {
            noise_m_s2: 0.05,
            bias_m_s2: 0.0,
            gain_error: 0.0,
            resolution_m_s2: 0.0,
            range_m_s2: None,
            dropout_fraction: 0.0,
            dropout_burst_samples: 1.0,
            tilt_deg: 0.0,
            fore_aft_share: 0.0,
            delay_ms: 0.0,
        }
    }
}

impl SensorSpec {
    /// A sensor with nothing but noise, in m/s² rms per sample.
    pub fn with_noise(noise_m_s2: f64) -> Self {
        Self { noise_m_s2, ..Self::default() }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        not_negative("noise_m_s2", self.noise_m_s2)?;
        within("bias_m_s2", self.bias_m_s2, -1e3, 1e3, "a bias within 1000 m/s2")?;
        within("gain_error", self.gain_error, -0.9, 9.0, "a share from -0.9 to 9")?;
        not_negative("resolution_m_s2", self.resolution_m_s2)?;
        if let Some(range) = self.range_m_s2 {
            positive("range_m_s2", range)?;
        }
        within("dropout_fraction", self.dropout_fraction, 0.0, 0.9, "a share from 0 to 0.9")?;
        within("dropout_burst_samples", self.dropout_burst_samples, 1.0, 1e6, "1 or more")?;
        within("tilt_deg", self.tilt_deg, -90.0, 90.0, "an angle from -90 to 90 degrees")?;
        within("fore_aft_share", self.fore_aft_share, -2.0, 2.0, "a share from -2 to 2")?;
        within("delay_ms", self.delay_ms, 0.0, 200.0, "a delay from 0 to 200 ms")
    }
}

impl SensorSpec {
    /// Its reading of a vertical and a fore-aft acceleration.
    pub(crate) fn directions(&self) -> [f64; 2] {
        let (sin, cos) = self.tilt_deg.to_radians().sin_cos();
        [cos, sin + self.fore_aft_share]
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Sensor {
    spec: SensorSpec,
    noise: Pcg64,
    dropout: Pcg64,
    lost: bool,
}

impl Sensor {
    /// `number` tells the sensors of a drive apart.
    pub(crate) fn new(spec: &SensorSpec, seed: u64, number: u64) -> Self {
        let mut dropout = generator(seed, Purpose::Dropout, [number, 0]);
        let lost = dropout.random::<f64>() < spec.dropout_fraction;
        Self { spec: *spec, noise: generator(seed, Purpose::SensorNoise, [number, 0]), dropout, lost }
    }

    /// The log's value for a true acceleration in m/s²: gain, bias, noise, the sensor's range, the converter's
    /// steps, and NaN when it is lost on the way.
    pub(crate) fn read(&mut self, accel_m_s2: f64) -> f64 {
        let s = &self.spec;
        let white: f64 = StandardNormal.sample(&mut self.noise);
        let mut reading = accel_m_s2 * (1.0 + s.gain_error) + s.bias_m_s2 + s.noise_m_s2 * white;
        if let Some(range) = s.range_m_s2 {
            reading = reading.clamp(-range, range);
        }
        if s.resolution_m_s2 > 0.0 {
            reading = (reading / s.resolution_m_s2).round() * s.resolution_m_s2;
        }
        let reading = if self.lost { f64::NAN } else { reading };
        self.next_loss();
        reading
    }

    /// A two-state Markov chain: a loss ends with probability 1/B a sample and starts as often as keeps the share of
    /// lost samples at the one asked for.
    fn next_loss(&mut self) {
        let (share, burst) = (self.spec.dropout_fraction, self.spec.dropout_burst_samples);
        if share > 0.0 {
            let change = if self.lost { 1.0 / burst } else { (share / (burst * (1.0 - share))).min(1.0) };
            if self.dropout.random::<f64>() < change {
                self.lost = !self.lost;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_rms_asked_for_and_is_white() {
        let mut sensor = Sensor::new(&SensorSpec::with_noise(0.05), 1, 0);
        let n = 100_000;
        let x: Vec<f64> = (0..n).map(|_| sensor.read(2.0) - 2.0).collect();
        let mean = x.iter().sum::<f64>() / n as f64;
        let variance = x.iter().map(|x| x * x).sum::<f64>() / n as f64;
        let lag = x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n as f64;
        // Four standard deviations: of the mean 0.05/sqrt(n), of the variance σ² sqrt(2/n), of the lag σ²/sqrt(n).
        assert!(mean.abs() < 4.0 * 0.05 / (n as f64).sqrt());
        assert!((variance / 0.0025 - 1.0).abs() < 4.0 * (2.0 / n as f64).sqrt());
        assert!((lag / 0.0025).abs() < 4.0 / (n as f64).sqrt());
    }

    #[test]
    fn gain_bias_range_and_steps_act_in_that_order() {
        let spec = SensorSpec {
            gain_error: 0.02,
            bias_m_s2: 0.3,
            resolution_m_s2: 0.25,
            range_m_s2: Some(20.0),
            ..SensorSpec::with_noise(0.0)
        };
        let mut sensor = Sensor::new(&spec, 1, 0);
        // 10 * 1.02 + 0.3 = 10.5; 1 * 1.02 + 0.3 = 1.32, rounded to 1.25.
        assert_eq!(sensor.read(10.0), 10.5);
        assert_eq!(sensor.read(1.0), 1.25);
        assert_eq!((sensor.read(40.0), sensor.read(-40.0)), (20.0, -20.0));
    }

    #[test]
    fn losses_have_the_share_and_length_asked_for() {
        let spec = SensorSpec { dropout_fraction: 0.1, dropout_burst_samples: 5.0, ..SensorSpec::default() };
        let mut sensor = Sensor::new(&spec, 3, 0);
        let lost: Vec<bool> = (0..200_000).map(|_| sensor.read(0.0).is_nan()).collect();
        let share = lost.iter().filter(|l| **l).count() as f64 / lost.len() as f64;
        let bursts = lost.windows(2).filter(|w| !w[0] && w[1]).count() as f64;
        // 4000 bursts of geometric length: sd of their number 1.6 %, of the share about 2 %.
        assert!((share / 0.1 - 1.0).abs() < 0.08, "{share}");
        assert!((share * lost.len() as f64 / bursts / 5.0 - 1.0).abs() < 0.08);
    }

    #[test]
    fn losses_do_not_change_the_noise() {
        let mut whole = Sensor::new(&SensorSpec::default(), 3, 0);
        let mut torn = Sensor::new(&SensorSpec { dropout_fraction: 0.3, ..SensorSpec::default() }, 3, 0);
        for _ in 0..1000 {
            let (a, b) = (whole.read(1.0), torn.read(1.0));
            assert!(b.is_nan() || a == b);
        }
    }
}
