//! Cars that differ as cars do: a journey's deviations of body, tires and sensors, drawn from the seed.
//!
//! Part of a scenario's `[journey]`; applied when the scenario is composed. What a corner already deviates by is kept and multiplied.

use std::fmt;

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::Scenario;
use crate::error::{Result, within};
use crate::sensor::SensorSpec;
use crate::streams::{Purpose, generator};
use itpms_core::model::Corner;

/// Standard deviations beyond which nothing is drawn.
const FARTHEST: f64 = 2.5;

/// How masses, springs, dampers, tires and gains are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Draw {
    /// Evenly between the largest deviations either way, which the shares are.
    #[default]
    Even,
    /// Normally, cut at two and a half standard deviations, which the shares are.
    Normal,
}

/// How far cars may differ. Shares are as [`Draw`] says; noise, delays and friction are drawn evenly.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ToleranceSpec {
    pub draw: Draw,
    /// Of each axle's sprung mass, as a share: equipment.
    pub sprung_mass: f64,
    pub unsprung_mass: f64,
    /// Of all unsprung masses together: what a file leaves out, or counts twice.
    pub unsprung_mass_common: f64,
    pub unsprung_mass_axle: f64,
    pub damping: f64,
    pub spring: f64,
    /// Of the stiffness of all tires together (make and wear), and in a third of it of each.
    pub tire_stiffness: f64,
    /// Most dry friction in a strut in N, each strut's drawn from none on; 0: what the scenario says.
    pub friction_n: f64,
    pub gain: f64,
    /// Factor by which all sensors may be noisier than their data sheet, or quieter.
    pub noise_factor: f64,
    /// Longest time in ms by which a wheel's sensor is late.
    pub delay_ms: f64,
}

impl Default for ToleranceSpec {
    fn default() -> Self {
        Self {
            draw: Draw::Even,
            sprung_mass: 0.05,
            unsprung_mass: 0.01,
            unsprung_mass_common: 0.0,
            unsprung_mass_axle: 0.0,
            damping: 0.15,
            spring: 0.05,
            tire_stiffness: 0.015,
            friction_n: 0.0,
            gain: 0.01,
            noise_factor: 2.0,
            delay_ms: 2.0,
        }
    }
}

impl ToleranceSpec {
    /// What separates a car from a vehicle file of confidence `typical`: the standard deviations of its masses and tires,
    /// worn dampers, and struts that rub.
    pub fn typical() -> Self {
        Self {
            draw: Draw::Normal,
            unsprung_mass: 0.0,
            unsprung_mass_common: 0.04,
            unsprung_mass_axle: 0.03,
            tire_stiffness: 0.03,
            friction_n: 100.0,
            ..Self::default()
        }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        for (name, share) in [
            ("sprung_mass", self.sprung_mass),
            ("unsprung_mass", self.unsprung_mass),
            ("unsprung_mass_common", self.unsprung_mass_common),
            ("unsprung_mass_axle", self.unsprung_mass_axle),
            ("damping", self.damping),
            ("spring", self.spring),
            ("tire_stiffness", self.tire_stiffness),
            ("gain", self.gain),
        ] {
            within(name, share, 0.0, 0.5, "a share from 0 to 0.5")?;
        }
        within("friction_n", self.friction_n, 0.0, 1000.0, "a friction from 0 to 1000 N")?;
        within("noise_factor", self.noise_factor, 1.0, 100.0, "a factor from 1 to 100")?;
        within("delay_ms", self.delay_ms, 0.0, 50.0, "a delay from 0 to 50 ms")
    }

    /// The car of a seed. Its estimator is given what it was given before, the sensors' noise included.
    pub fn apply(&self, seed: u64, scenario: &mut Scenario) {
        let source =
            |index| Source { random: generator(seed, Purpose::Tolerance, [index, 0]), draw: self.draw };
        // What was added later has numbers of its own: the others stay what they were.
        let (mut draw, mut later) = (source(0), source(1));
        let common = later.factor(self.unsprung_mass_common);
        let by_axle = [0, 1].map(|_| common * later.factor(self.unsprung_mass_axle));
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
            let friction_n = 0.5 * self.friction_n * (1.0 + later.either_way(1.0));
            let Some(spec) = scenario.corner.get_mut(corner) else { continue };
            spec.truth.sprung_mass_factor *= sprung;
            spec.truth.spring_factor *= spring;
            spec.truth.unsprung_mass_factor *= unsprung * by_axle[corner.index() / 2];
            spec.truth.damping_factor *= damping;
            spec.truth.tire_stiffness_factor *= tire;
            if self.friction_n > 0.0 {
                spec.truth.friction_n = friction_n;
            }
            let specified = spec.wheel_sensor.unwrap_or(usual).noise_m_s2;
            if spec.accel_noise_m_s2.is_none() && specified > 0.0 {
                spec.accel_noise_m_s2 = Some(specified);
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

struct Source {
    random: Pcg64,
    draw: Draw,
}

impl Source {
    fn either_way(&mut self, most: f64) -> f64 {
        most * (2.0 * self.random.random::<f64>() - 1.0)
    }

    fn factor(&mut self, share: f64) -> f64 {
        let drawn = match self.draw {
            Draw::Even => self.either_way(1.0),
            Draw::Normal => loop {
                let normal: f64 = StandardNormal.sample(&mut self.random);
                if normal.abs() <= FARTHEST {
                    break normal;
                }
            },
        };
        1.0 + share * drawn
    }
}

/// `"none"`, `"typical"` or a table.
pub(crate) fn named_or_table<'de, D: Deserializer<'de>>(from: D) -> Result<Option<ToleranceSpec>, D::Error> {
    from.deserialize_any(NamedOrTable)
}

struct NamedOrTable;

impl<'de> Visitor<'de> for NamedOrTable {
    type Value = Option<ToleranceSpec>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"typical\", \"none\" or a table of tolerances")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Self::Value, E> {
        match name {
            "typical" => Ok(Some(ToleranceSpec::typical())),
            "none" => Ok(None),
            _ => Err(E::invalid_value(Unexpected::Str(name), &self)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        ToleranceSpec::deserialize(MapAccessDeserializer::new(map)).map(Some)
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
    fn cars_differ_within_their_tolerances_and_the_estimator_knows_nothing_of_it() {
        let scenario = normal();
        let mut gains = vec![];
        for seed in 0..200 {
            let car = scenario.composed(seed).unwrap();
            for (corner, spec) in car.corner.iter() {
                assert_eq!(car.corner_config(corner).unwrap(), scenario.corner_config(corner).unwrap());
                assert!((spec.truth.unsprung_mass_factor - 1.0).abs() <= 0.01);
                assert!((spec.truth.tire_stiffness_factor - 1.0).abs() <= 0.0202);
                // The scenario's true car stays.
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
    fn typical_cars_scatter_as_their_files_say() {
        let scenario = Scenario::builtin("drive-normal").unwrap();
        assert_eq!(scenario.journey.as_ref().unwrap().tolerances, Some(ToleranceSpec::typical()));
        let cars: Vec<Scenario> = (0..1000).map(|seed| scenario.composed(seed).unwrap()).collect();
        let truth = |car: &Scenario, corner| car.corner.get(corner).unwrap().truth;
        let variance =
            |of: &dyn Fn(&Scenario) -> f64| cars.iter().map(|car| of(car).powi(2)).sum::<f64>() / 1000.0;
        let mass = |car: &Scenario, corner| truth(car, corner).unsprung_mass_factor - 1.0;
        // 4 and 3 % make 5 % of an axle, 3 and 3 % their difference; cut at 2.5 sd a normal variance is 0.911 of
        // itself. A thousand cars know it to 4.5 % (one sd).
        let axle = variance(&|car| mass(car, Corner::FrontLeft)).sqrt();
        let difference = variance(&|car| mass(car, Corner::FrontLeft) - mass(car, Corner::RearRight)).sqrt();
        let tire = variance(&|car| truth(car, Corner::RearLeft).tire_stiffness_factor - 1.0).sqrt();
        for (found, sd) in [(axle, 0.05), (difference, 0.03 * 2f64.sqrt()), (tire, (9e-4f64 + 1e-4).sqrt())] {
            assert!((found / (sd * 0.911f64.sqrt()) - 1.0).abs() < 0.08, "{found} {sd}");
        }
        let friction = |car: &Scenario| truth(car, Corner::FrontRight).friction_n;
        let mean = cars.iter().map(friction).sum::<f64>() / 1000.0;
        // Evenly up to 100 N: the mean's sd is 0.9 N.
        assert!((mean - 50.0).abs() < 4.0 && cars.iter().all(|car| (0.0..=100.0).contains(&friction(car))));
    }

    #[test]
    fn tolerances_have_names() {
        let text = include_str!("../../scenarios/drive-normal.toml");
        let read = |tolerances: &str| {
            let text = text.replace("tolerances = \"typical\"", &format!("tolerances = {tolerances}"));
            Scenario::from_toml(&text, "file.toml")
        };
        assert_eq!(read("\"none\"").unwrap().journey.unwrap().tolerances, None);
        let table = read("{ gain = 0.02 }").unwrap().journey.unwrap().tolerances;
        assert_eq!(table, Some(ToleranceSpec { gain: 0.02, ..ToleranceSpec::default() }));
        let refused = read("\"rough\"").unwrap_err().to_string();
        assert!(refused.contains("string \"rough\", expected \"typical\", \"none\" or a table"), "{refused}");
        let unknown = read("{ gian = 0.02 }").unwrap_err().to_string();
        assert!(unknown.contains("unknown field `gian`"), "{unknown}");
        // Without tolerances the car is the scenario's own, whatever the seed.
        let exact = read("\"none\"").unwrap();
        assert_eq!(exact.composed(1).unwrap().corner, exact.corner);
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
        let error = scenario.validate().unwrap_err().to_string();
        assert!(error.contains("journey.tolerances.gain is NaN, expected a share from 0 to 0.5"), "{error}");
    }
}
