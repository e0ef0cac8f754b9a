//! Cars that differ as cars do: a journey's deviations of body, tires and sensors, drawn from the seed.
//!
//! Part of a scenario's `[journey]`; applied when the scenario is composed. What a corner already deviates by is kept and
//! multiplied.

use rand::RngExt;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use super::Scenario;
use crate::error::{InvalidValue, within};
use crate::sensor::SensorSpec;
use crate::streams::{Purpose, generator};
use itpms_core::model::Corner;

/// The largest deviations either way; each is drawn evenly in between.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ToleranceSpec {
    /// Of each axle's sprung mass, as a share: equipment.
    pub sprung_mass: f64,
    /// Of each unsprung mass: another rim.
    pub unsprung_mass: f64,
    /// Of each damper: age.
    pub damping: f64,
    /// Of each axle's springs.
    pub spring: f64,
    /// Of the stiffness of all tires together (make and wear), and in a third of it of each.
    pub tire_stiffness: f64,
    /// Of each sensor's gain.
    pub gain: f64,
    /// Factor by which all sensors may be noisier than their data sheet, or quieter.
    pub noise_factor: f64,
    /// Longest time in ms by which a wheel's sensor is late.
    pub delay_ms: f64,
}

impl Default for ToleranceSpec {
    fn default() -> Self {
        Self {
            sprung_mass: 0.05,
            unsprung_mass: 0.01,
            damping: 0.15,
            spring: 0.05,
            tire_stiffness: 0.015,
            gain: 0.01,
            noise_factor: 2.0,
            delay_ms: 2.0,
        }
    }
}

impl ToleranceSpec {
    pub(crate) fn validate(&self) -> Result<(), InvalidValue> {
        for (name, share) in [
            ("sprung_mass", self.sprung_mass),
            ("unsprung_mass", self.unsprung_mass),
            ("damping", self.damping),
            ("spring", self.spring),
            ("tire_stiffness", self.tire_stiffness),
            ("gain", self.gain),
        ] {
            within(name, share, 0.0, 0.5, "a share from 0 to 0.5")?;
        }
        within("noise_factor", self.noise_factor, 1.0, 100.0, "a factor from 1 to 100")?;
        within("delay_ms", self.delay_ms, 0.0, 50.0, "a delay from 0 to 50 ms")
    }

    /// The car of a seed. Its estimator is told what it was told before, the sensors' noise included.
    pub(crate) fn apply(&self, seed: u64, scenario: &mut Scenario) {
        let mut draw = Draw(generator(seed, Purpose::Tolerance, [0, 0]));
        let noise = self.noise_factor.powf(draw.either_way(1.0));
        let tires = draw.factor(self.tire_stiffness);
        let axles = [0, 1].map(|_| [draw.factor(self.sprung_mass), draw.factor(self.spring)]);
        let usual = scenario.sensor;
        for corner in Corner::ALL {
            // Drawn for every corner, so that a corner left out changes nothing for the others.
            let [sprung, spring] = axles[corner.index() / 2];
            let (unsprung, damping) = (draw.factor(self.unsprung_mass), draw.factor(self.damping));
            let tire = tires * draw.factor(self.tire_stiffness / 3.0);
            let gains = [draw.factor(self.gain), draw.factor(self.gain)];
            let late_ms = 0.5 * self.delay_ms * (1.0 + draw.either_way(1.0));
            let Some(spec) = scenario.corner.get_mut(corner) else { continue };
            spec.truth.sprung_mass_factor *= sprung;
            spec.truth.spring_factor *= spring;
            spec.truth.unsprung_mass_factor *= unsprung;
            spec.truth.damping_factor *= damping;
            spec.truth.tire_stiffness_factor *= tire;
            let told = spec.wheel_sensor.unwrap_or(usual).noise_m_s2;
            if spec.accel_noise_m_s2.is_none() && told > 0.0 {
                spec.accel_noise_m_s2 = Some(told);
            }
            let changed = |sensor: Option<SensorSpec>, gain: f64, late_ms: f64| {
                let sensor = sensor.unwrap_or(usual);
                Some(SensorSpec {
                    noise_m_s2: noise * sensor.noise_m_s2,
                    gain_error: (1.0 + sensor.gain_error) * gain - 1.0,
                    delay_ms: sensor.delay_ms + late_ms,
                    ..sensor
                })
            };
            spec.body_sensor = changed(spec.body_sensor, gains[0], 0.0);
            spec.wheel_sensor = changed(spec.wheel_sensor, gains[1], late_ms);
        }
    }
}

/// Draws deviations.
struct Draw(Pcg64);

impl Draw {
    fn either_way(&mut self, most: f64) -> f64 {
        most * (2.0 * self.0.random::<f64>() - 1.0)
    }

    fn factor(&mut self, share: f64) -> f64 {
        1.0 + self.either_way(share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normal() -> Scenario {
        let mut scenario = Scenario::builtin("drive-normal").unwrap();
        if let Some(journey) = &mut scenario.journey {
            journey.tolerances = Some(ToleranceSpec::default());
        }
        scenario
    }

    #[test]
    fn cars_differ_within_their_tolerances_and_the_estimator_is_not_told() {
        let scenario = normal();
        let mut gains = vec![];
        for seed in 0..200 {
            let car = scenario.composed(seed).unwrap();
            for (corner, spec) in car.corner.iter() {
                assert_eq!(car.corner_config(corner).unwrap(), scenario.corner_config(corner).unwrap());
                assert!((spec.truth.unsprung_mass_factor - 1.0).abs() <= 0.01);
                assert!((spec.truth.tire_stiffness_factor - 1.0).abs() <= 0.0202);
                // What the scenario says of the true car stays.
                assert_eq!(spec.truth.friction_n, 10.0);
                let sensor = spec.wheel_sensor.unwrap();
                assert!((0.025..=0.1).contains(&sensor.noise_m_s2) && (0.0..=2.0).contains(&sensor.delay_ms));
                gains.push(sensor.gain_error / 0.01);
            }
            let fl = &car.corner.fl.as_ref().unwrap().truth;
            assert_eq!(fl.spring_factor, car.corner.fr.as_ref().unwrap().truth.spring_factor);
        }
        // 800 even draws in -1..1: variance 1/3 with a relative sd of sqrt(0.8 / 800) = 3 %.
        let variance = gains.iter().map(|g| g * g).sum::<f64>() / gains.len() as f64;
        assert!(gains.iter().all(|g| g.abs() <= 1.0) && (variance - 1.0 / 3.0).abs() < 0.04, "{variance}");
    }

    #[test]
    fn the_journey_is_the_same_with_any_car() {
        let mut nominal = normal();
        if let Some(journey) = &mut nominal.journey {
            journey.tolerances = None;
        }
        let (a, b) = (normal().composed(5).unwrap(), nominal.composed(5).unwrap());
        assert_eq!((a.speed, a.road, a.car), (b.speed, b.road, b.car));
        assert_ne!(a.corner, b.corner);
    }

    #[test]
    fn tolerances_that_make_no_sense_are_refused() {
        let mut scenario = normal();
        if let Some(journey) = &mut scenario.journey {
            journey.tolerances = Some(ToleranceSpec { gain: f64::NAN, ..ToleranceSpec::default() });
        }
        let message = scenario.validate().unwrap_err().to_string();
        assert!(
            message.contains("journey.tolerances.gain is NaN, expected a share from 0 to 0.5"),
            "{message}"
        );
    }
}
