//! The Cramer-Rao bound: how well any estimator could know a tire's pressure from one corner's two accelerations, or from
//! those of a front and a rear wheel that meet nearly the same road. Derivation in `docs/math/bound.md`.
//!
//! Called by the score and the report, which show it beside their results. It must never be fed to an estimator: it
//! needs the true pressure.
//!
//! | module | idea |
//! |---|---|
//! | `fisher` | information per second of stationary signals |
//! | `history` | pressures that change |
//! | `side` | two wheels on the road that they share |

mod fisher;
mod history;
mod side;

pub use history::{BoundPrior, BoundRecursion};
pub use side::{SideBound, TrackCoherence};

use fisher::Fisher;
pub use fisher::{LEVEL_HZ, STEP_HZ, transfers};
use itpms_core::model::CornerConfig;
use nalgebra::{Matrix2, Matrix3, Vector2};
use thiserror::Error;

use crate::spectrum::PowerLaw;

/// Prior of the road's spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RoadKnowledge {
    /// Nothing but that it is a power law: level and slope are estimated along with the pressure.
    Unknown,
    /// Level and slope are given. No estimator has that; it shows what knowing the road would be worth.
    Known,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundSetting {
    pub road: PowerLaw,
    /// The parameters of it that an estimator may know.
    pub road_knowledge: RoadKnowledge,
    pub speed_m_s: f64,
    /// Sampling rate in Hz: it spreads the noise's power up to half of it.
    pub rate_hz: f64,
    /// Noise of each accelerometer in m/s², rms per sample, white.
    pub accel_noise_m_s2: f64,
    /// Frequencies an estimator may use, in Hz, lowest and highest.
    pub band_hz: (f64, f64),
}

impl BoundSetting {
    /// The paper's drive: class A, w = 2.14, 20 km/h, 500 Hz, 0.05 m/s², 3 to 60 Hz, road unknown.
    pub fn paper() -> Self {
        Self {
            road: PowerLaw { gd_n0_m3: 16e-6, waviness: 2.14 },
            road_knowledge: RoadKnowledge::Unknown,
            speed_m_s: 20.0 / 3.6,
            rate_hz: 500.0,
            accel_noise_m_s2: 0.05,
            band_hz: (3.0, 60.0),
        }
    }

    /// Refuses a drive that no bound can be computed for.
    pub fn check(&self) -> Result<(), BoundError> {
        let positive = [
            ("road level Gd(n0) in m3", self.road.gd_n0_m3),
            ("speed_m_s", self.speed_m_s),
            ("rate_hz", self.rate_hz),
            ("accel_noise_m_s2", self.accel_noise_m_s2),
        ];
        if let Some((name, value)) = positive.into_iter().find(|(_, v)| !(*v > 0.0 && v.is_finite())) {
            return Err(BoundError::NotPositive { name, value });
        }
        if !self.road.waviness.is_finite() {
            return Err(BoundError::Slope(self.road.waviness));
        }
        let (low_hz, high_hz) = self.band_hz;
        if !(low_hz > 0.0 && low_hz < high_hz && high_hz <= self.rate_hz / 2.0) {
            return Err(BoundError::Band { low_hz, high_hz, half_rate_hz: self.rate_hz / 2.0 });
        }
        Ok(())
    }
}

/// A drive no bound can be computed for.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum BoundError {
    #[error("{name} is {value}, expected a positive, finite number")]
    NotPositive { name: &'static str, value: f64 },
    #[error("waviness is {0}, expected a finite number")]
    Slope(f64),
    #[error("rear offset is {0} m, expected a finite number")]
    Offset(f64),
    #[error("band from {low_hz} to {high_hz} Hz, expected 0 < low < high <= {half_rate_hz} Hz")]
    Band { low_hz: f64, high_hz: f64, half_rate_hz: f64 },
}

#[derive(Debug, Clone)]
pub struct CornerBound {
    fisher: Fisher,
    knowledge: RoadKnowledge,
    prior: BoundPrior,
}

impl CornerBound {
    /// The bound for a corner; the setting's noise counts, not the configuration's.
    pub fn new(corner: &CornerConfig<f64>, setting: &BoundSetting) -> Result<Self, BoundError> {
        setting.check()?;
        Ok(Self {
            fisher: Fisher::new(corner, setting),
            knowledge: setting.road_knowledge,
            prior: BoundPrior::default(),
        })
    }

    /// The same with another idea of how pressure and road change, for [`history`](Self::history).
    pub fn with_prior(self, prior: BoundPrior) -> Self {
        Self { prior, ..self }
    }

    /// Fisher information per second about (pressure in kPa, natural logarithm of the road's level at 10 Hz, slope
    /// `w`), 3x3, at a gauge pressure in kPa.
    pub fn information_matrix_per_second(&self, pressure_kpa: f64) -> Matrix3<f64> {
        self.fisher.per_second(pressure_kpa)
    }

    /// Information about the pressure alone in 1/(kPa² s), what level and slope cost taken off when they are unknown (Schur complement).
    pub fn information_per_second_kpa2(&self, pressure_kpa: f64) -> f64 {
        let f = self.fisher.per_second(pressure_kpa);
        match self.knowledge {
            RoadKnowledge::Known => f[(0, 0)],
            RoadKnowledge::Unknown => {
                let road = Matrix2::new(f[(1, 1)], f[(1, 2)], f[(2, 1)], f[(2, 2)]);
                let cross = Vector2::new(f[(0, 1)], f[(0, 2)]);
                road.try_inverse().map_or(f64::NAN, |inverse| f[(0, 0)] - (inverse * cross).dot(&cross))
            }
        }
    }

    /// Smallest standard deviation in kPa of an unbiased estimate of a constant pressure after `seconds` of driving,
    /// nothing known beforehand. Holds once a few periods of the wheel hop (0.1 s) have been seen.
    pub fn sd_kpa(&self, seconds: f64, pressure_kpa: f64) -> f64 {
        (self.information_per_second_kpa2(pressure_kpa) * seconds).sqrt().recip()
    }

    /// The same with a Gaussian prior of standard deviation `prior_sd_kpa` on the pressure.
    pub fn sd_with_prior_kpa(&self, seconds: f64, pressure_kpa: f64, prior_sd_kpa: f64) -> f64 {
        (self.information_per_second_kpa2(pressure_kpa) * seconds + prior_sd_kpa.powi(-2)).sqrt().recip()
    }

    /// Bound on the standard deviation in kPa at each time (s, increasing) of a drive with these true pressures
    /// (kPa), for an estimate from the measurements up to then; `prior_sd_kpa` is the sd before the first. What it
    /// assumes of changing pressures is [`BoundPrior`]'s. As long as the shorter of both slices.
    pub fn history(&self, times_s: &[f64], pressures_kpa: &[f64], prior_sd_kpa: f64) -> Vec<f64> {
        let mut recursion = self.recursion(prior_sd_kpa);
        let mut last: Option<(f64, f64)> = None;
        let drive = times_s.iter().zip(pressures_kpa);
        drive
            .map(|(&time, &pressure)| {
                if let Some((time_before, pressure_before)) = last {
                    let dt = time - time_before;
                    recursion.drive(dt, pressure, (pressure - pressure_before) / dt);
                }
                last = Some((time, pressure));
                recursion.sd_kpa()
            })
            .collect()
    }

    /// The recursion behind [`history`](Self::history), for drives that stop in between.
    pub fn recursion(&self, prior_sd_kpa: f64) -> BoundRecursion {
        BoundRecursion::new(&self.fisher, self.knowledge, self.prior, prior_sd_kpa)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::QuarterCar;

    const P: f64 = 241.3;

    fn bound(high_hz: f64, road_knowledge: RoadKnowledge) -> CornerBound {
        let setting = BoundSetting { band_hz: (3.0, high_hz), road_knowledge, ..BoundSetting::paper() };
        CornerBound::new(&CornerConfig::paper(), &setting).unwrap()
    }

    #[test]
    fn figures_of_an_independent_computation() {
        // kPa sqrt(s), from a separate script; stated to the unit.
        use RoadKnowledge::{Known, Unknown};
        for (high_hz, knowledge, expected) in
            [(30.0, Unknown, 41.0), (60.0, Unknown, 36.0), (30.0, Known, 23.0), (60.0, Known, 18.0)]
        {
            let found = bound(high_hz, knowledge).sd_kpa(1.0, P);
            assert!((found - expected).abs() < 0.5, "{high_hz} Hz, {knowledge:?}: {found}");
        }
        for (damping, expected) in [(400.0, 23.0), (926.0, 38.0), (2500.0, 79.0)] {
            let corner = CornerConfig {
                quarter_car: QuarterCar::new(240.8, 56.9, damping, 29_114.0).unwrap(),
                ..CornerConfig::paper()
            };
            let setting = BoundSetting { band_hz: (3.0, 40.0), ..BoundSetting::paper() };
            let found = CornerBound::new(&corner, &setting).unwrap().sd_kpa(1.0, P);
            assert!((found - expected).abs() < 0.5, "{damping} N s/m: {found}");
        }
        for (pressure_kpa, expected) in [(40.0, 26.70), (138.5, 31.25), (300.0, 38.63)] {
            let found = bound(60.0, Unknown).sd_kpa(1.0, pressure_kpa);
            assert!((found - expected).abs() < 0.01, "{pressure_kpa} kPa: {found}");
        }
    }

    #[test]
    fn speed_and_class_barely_matter_while_the_road_is_louder_than_the_noise() {
        let reference = bound(60.0, RoadKnowledge::Unknown).sd_kpa(1.0, P);
        for (speed_m_s, level) in [(80.0 / 3.6, 16e-6), (20.0 / 3.6, 256e-6), (120.0 / 3.6, 1024e-6)] {
            let road = PowerLaw { gd_n0_m3: level, waviness: 2.14 };
            let setting = BoundSetting { speed_m_s, road, ..BoundSetting::paper() };
            let sd = CornerBound::new(&CornerConfig::paper(), &setting).unwrap().sd_kpa(1.0, P);
            // More road never hurts; here it is a hundred times the noise at the wheel hop already.
            assert!(sd < reference && sd > 0.999 * reference, "{speed_m_s} m/s, {level}: {sd}");
        }
        // Noise of 30 m/s2, as loud as the wheel hop itself, does drown it.
        let loud = BoundSetting { accel_noise_m_s2: 30.0, ..BoundSetting::paper() };
        assert!(CornerBound::new(&CornerConfig::paper(), &loud).unwrap().sd_kpa(1.0, P) > 2.0 * reference);
    }

    #[test]
    fn time_and_prior_add_as_information() {
        let b = bound(60.0, RoadKnowledge::Unknown);
        assert!((b.sd_kpa(16.0, P) * 4.0 - b.sd_kpa(1.0, P)).abs() < 1e-9);
        assert!((b.sd_with_prior_kpa(0.0, P, 30.0) - 30.0).abs() < 1e-9);
        let together = b.sd_with_prior_kpa(5.0, P, 30.0).powi(-2);
        assert!((together - b.sd_kpa(5.0, P).powi(-2) - 30f64.powi(-2)).abs() < 1e-12);
    }

    #[test]
    fn settings_are_checked() {
        let corner = CornerConfig::paper();
        let good = BoundSetting::paper();
        let refused = |setting: BoundSetting| CornerBound::new(&corner, &setting).unwrap_err().to_string();
        assert!(refused(BoundSetting { speed_m_s: 0.0, ..good }).contains("speed_m_s"));
        assert!(refused(BoundSetting { accel_noise_m_s2: f64::NAN, ..good }).contains("accel_noise_m_s2"));
        assert!(refused(BoundSetting { band_hz: (3.0, 260.0), ..good }).contains("250"));
        assert!(refused(BoundSetting { band_hz: (3.0, f64::NAN), ..good }).contains("band"));
        let road = PowerLaw { gd_n0_m3: 1e-6, waviness: f64::NAN };
        assert!(refused(BoundSetting { road, ..good }).contains("waviness"));
    }
}
