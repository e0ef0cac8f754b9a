//! A journey: an everyday drive composed from the seed - how fast, over which roads, where it turns, stops and loads.
//!
//! Called by the simulation before a drive starts, and by whoever wants to know what a seed composes
//! ([`Scenario::composed`](super::Scenario::composed)). What comes out is an ordinary scenario with every point written out.

use std::f64::consts::FRAC_PI_2;

use rand::RngExt;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use super::tolerance::named_or_table;
use super::{ToleranceSpec, is_one, is_zero};
use crate::car::PayloadSpec;
use crate::error::{Result, within};
use crate::road::{AfterLast, Amplitude, RoadClass, Segment, Segments};
use crate::streams::{Purpose, generator};

/// What journeys are composed of. Stretches follow each other at random, each with a class of road and the speeds one drives there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct JourneySpec {
    pub stretch_s: [f64; 2],
    /// Smallest and largest slope `w` of the roads' spectra.
    pub slope: [f64; 2],
    pub lateral_m_s2: f64,
    pub load_chance: f64,
    /// Largest mass in kg at each of the four places that are loaded.
    pub load_kg: f64,
    /// By how many K tires warm up at 90 km/h; less when slower, and a little unequally. Where it is 0, they do not.
    #[serde(skip_serializing_if = "is_zero")]
    pub warms_by_k: f64,
    /// By how many K the air of the day is warmer than where the pressures were set.
    #[serde(skip_serializing_if = "is_zero")]
    pub air_k: f64,
    /// Chance that a right-angle turn at 5 to 7 m/s follows a while at one speed, in town.
    #[serde(skip_serializing_if = "is_zero")]
    pub junction_chance: f64,
    /// How strongly one brakes and speeds up, over the usual.
    #[serde(skip_serializing_if = "is_one")]
    pub gentle: f64,
    /// How far each seed's car may differ from what its estimator is given; not at all, if not given.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "named_or_table")]
    pub tolerances: Option<ToleranceSpec>,
}

impl Default for JourneySpec {
    fn default() -> Self {
        Self {
            stretch_s: [120.0, 480.0],
            slope: [1.8, 2.6],
            lateral_m_s2: 2.0,
            load_chance: 0.3,
            load_kg: 100.0,
            warms_by_k: 0.0,
            air_k: 0.0,
            junction_chance: 0.0,
            gentle: 1.0,
            tolerances: None,
        }
    }
}

/// Kinds of stretches: chance, classes of road, speeds in km/h, and the chance that one stops before the next speed.
/// Speeds are those at which a car on such a road stays on it (and its passengers in their seats).
struct Kind {
    chance: f64,
    classes: &'static [RoadClass],
    km_h: [f64; 2],
    stop_chance: f64,
}

const KINDS: [Kind; 5] = [
    Kind { chance: 0.3, classes: &[RoadClass::A, RoadClass::B], km_h: [20.0, 50.0], stop_chance: 0.5 },
    Kind { chance: 0.3, classes: &[RoadClass::A, RoadClass::B], km_h: [50.0, 100.0], stop_chance: 0.1 },
    Kind { chance: 0.2, classes: &[RoadClass::A], km_h: [90.0, 130.0], stop_chance: 0.0 },
    Kind { chance: 0.1, classes: &[RoadClass::C], km_h: [20.0, 40.0], stop_chance: 0.3 },
    Kind { chance: 0.1, classes: &[RoadClass::D], km_h: [10.0, 20.0], stop_chance: 0.1 },
];

/// The loaded places: beside the driver, two behind, the trunk; m behind the front axle and to the left. The driver is
/// part of the corners' sprung masses.
const PLACES: [[f64; 2]; 4] = [[1.3, -0.36], [2.15, 0.36], [2.15, -0.36], [3.2, 0.0]];

/// Fastest speed of a kind of stretch that has junctions; radii in m of the turns there and speeds in m/s, time in s into and out of one.
const TOWN_KM_H: f64 = 50.0;
const JUNCTION_M: [f64; 2] = [8.0, 16.0];
const JUNCTION_M_S: [f64; 2] = [5.0, 7.0];
const JUNCTION_RAMP_S: f64 = 0.8;
/// Fastest acceleration across at which one turns there, in m/s², where one drives as usual.
const JUNCTION_M_S2: f64 = 3.2;

pub(crate) struct Journey {
    pub(crate) points_s_km_h: Vec<[f64; 2]>,
    pub(crate) lateral_points_s_m_s2: Vec<[f64; 2]>,
    pub(crate) segments: Segments,
    pub(crate) payload: Vec<PayloadSpec>,
}

impl JourneySpec {
    pub(crate) fn validate(&self) -> Result<()> {
        let [shortest, longest] = self.stretch_s;
        within("stretch_s", shortest, 10.0, 1e5, "a time from 10 to 100000 s")?;
        within("stretch_s", longest, shortest, 1e5, "a longest time no less than the shortest")?;
        let [low, high] = self.slope;
        within("slope", low, 0.5, 4.0, "a number from 0.5 to 4")?;
        within("slope", high, low, 4.0, "a largest slope no less than the smallest")?;
        within("lateral_m_s2", self.lateral_m_s2, 0.0, 8.0, "an acceleration from 0 to 8 m/s2")?;
        within("load_chance", self.load_chance, 0.0, 1.0, "a chance from 0 to 1")?;
        within("warms_by_k", self.warms_by_k, 0.0, 60.0, "a temperature from 0 to 60 K")?;
        within("air_k", self.air_k, -60.0, 60.0, "a temperature from -60 to 60 K")?;
        within("junction_chance", self.junction_chance, 0.0, 1.0, "a chance from 0 to 1")?;
        within("gentle", self.gentle, 0.05, 2.0, "a number from 0.05 to 2")?;
        within("load_kg", self.load_kg, 0.0, 300.0, "a mass from 0 to 300 kg")?;
        self.tolerances.map_or(Ok(()), |tolerances| tolerances.validate().map_err(|e| e.within("tolerances")))
    }

    /// The journey of a seed, at least as long as asked for.
    pub(crate) fn compose(&self, seed: u64, duration_s: f64) -> Journey {
        let mut composer = Composer::new(self, seed);
        while composer.time_s < duration_s {
            composer.stretch();
        }
        composer.finish()
    }
}

struct Composer<'a> {
    spec: &'a JourneySpec,
    random: Pcg64,
    time_s: f64,
    speed_m_s: f64,
    distance_m: f64,
    /// Where the stretch that is driven starts.
    stretch_from_m: f64,
    road: Option<Segment>,
    speed: Vec<[f64; 2]>,
    lateral: Vec<[f64; 2]>,
    list: Vec<Segment>,
    loads: [Vec<[f64; 2]>; 4],
}

impl<'a> Composer<'a> {
    fn new(spec: &'a JourneySpec, seed: u64) -> Self {
        let mut composer = Self {
            spec,
            random: generator(seed, Purpose::Journey, [0, 0]),
            time_s: 0.0,
            speed_m_s: 0.0,
            distance_m: 0.0,
            stretch_from_m: 0.0,
            road: None,
            speed: vec![[0.0, 0.0]],
            lateral: vec![[0.0, 0.0]],
            list: Vec::new(),
            loads: [const { Vec::new() }; 4],
        };
        for place in 0..4 {
            let kg = composer.some_load_kg();
            composer.loads[place].push([0.0, kg]);
        }
        composer.hold(5.0);
        composer
    }

    fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.random.random::<f64>()
    }

    fn chance(&mut self, of: f64) -> bool {
        self.random.random::<f64>() < of
    }

    /// None, or someone.
    fn some_load_kg(&mut self) -> f64 {
        if self.chance(0.5) { 0.0 } else { self.between([0.4 * self.spec.load_kg, self.spec.load_kg]) }
    }

    fn stretch(&mut self) {
        let kind = self.kind();
        let class = kind.classes[(self.random.random::<f64>() * kind.classes.len() as f64) as usize];
        let road = Segment { length_m: 0.0, roughness: class.into(), slope: self.between(self.spec.slope) };
        let until_s = self.time_s + self.between(self.spec.stretch_s);
        let first_m_s = self.between(kind.km_h) / 3.6;
        // One slows down on the road one leaves, and speeds up on the next.
        if first_m_s < self.speed_m_s {
            self.change_speed(first_m_s);
            self.change_road(road);
        } else {
            self.change_road(road);
            self.change_speed(first_m_s);
        }
        loop {
            self.drive_on();
            if self.spec.junction_chance > 0.0
                && kind.km_h[1] <= TOWN_KM_H
                && self.chance(self.spec.junction_chance)
            {
                self.junction();
            }
            if self.chance(kind.stop_chance) {
                self.stop();
            }
            if self.time_s >= until_s {
                break;
            }
            let next_m_s = self.between(kind.km_h) / 3.6;
            self.change_speed(next_m_s);
        }
    }

    fn kind(&mut self) -> &'static Kind {
        let mut left = self.random.random::<f64>();
        for kind in &KINDS {
            left -= kind.chance;
            if left < 0.0 {
                return kind;
            }
        }
        &KINDS[0]
    }

    fn change_road(&mut self, road: Segment) {
        if let Some(last) = self.road.replace(road) {
            // As long as a car, at least: a stretch may be left before it is driven.
            let length_m = (self.distance_m - self.stretch_from_m).max(5.0);
            self.stretch_from_m += length_m;
            self.list.push(Segment { length_m, ..last });
        }
    }

    fn change_speed(&mut self, to_m_s: f64) {
        let rate = if to_m_s < self.speed_m_s { self.between([0.7, 2.5]) } else { self.between([0.5, 1.8]) };
        let takes_s = ((to_m_s - self.speed_m_s).abs() / (self.spec.gentle * rate)).max(0.5);
        self.time_s += takes_s;
        self.distance_m += 0.5 * (self.speed_m_s + to_m_s) * takes_s;
        self.speed_m_s = to_m_s;
        self.speed.push([self.time_s, 3.6 * to_m_s]);
    }

    fn hold(&mut self, for_s: f64) {
        self.time_s += for_s;
        self.distance_m += self.speed_m_s * for_s;
        self.speed.push([self.time_s, 3.6 * self.speed_m_s]);
    }

    /// A while at one speed, perhaps round a bend.
    fn drive_on(&mut self) {
        let (from_s, takes_s) = (self.time_s, self.between([8.0, 40.0]));
        self.hold(takes_s);
        if self.chance(0.6) {
            let most = self.spec.lateral_m_s2;
            let lateral = self.between([-most, most]);
            let starts_s = from_s + 0.1 + self.between([0.0, 0.3 * takes_s]);
            let lasts_s = self.between([2.0, 0.6 * takes_s]);
            self.lateral.extend([
                [starts_s, 0.0],
                [starts_s + 1.0, lateral],
                [starts_s + lasts_s - 0.9, lateral],
                [starts_s + lasts_s, 0.0],
            ]);
        }
    }

    /// Turns by a right angle to one side.
    fn junction(&mut self) {
        let radius_m = self.between(JUNCTION_M);
        let most_m_s = (JUNCTION_M_S2 * self.spec.gentle * radius_m).sqrt();
        let speed_m_s = self.between(JUNCTION_M_S).min(most_m_s);
        let side = if self.chance(0.5) { 1.0 } else { -1.0 };
        self.change_speed(speed_m_s);
        let lateral = side * speed_m_s * speed_m_s / radius_m;
        // The ramps turn it by as much as one of them at full curvature.
        let full_s = FRAC_PI_2 * radius_m / speed_m_s - JUNCTION_RAMP_S;
        let from_s = self.time_s + 0.1;
        self.hold(full_s + 2.0 * JUNCTION_RAMP_S + 0.2);
        self.lateral.extend([
            [from_s, 0.0],
            [from_s + JUNCTION_RAMP_S, lateral],
            [from_s + JUNCTION_RAMP_S + full_s, lateral],
            [from_s + 2.0 * JUNCTION_RAMP_S + full_s, 0.0],
        ]);
    }

    /// Stops for a while; people may get in or out.
    fn stop(&mut self) {
        self.change_speed(0.0);
        let (from_s, takes_s) = (self.time_s, self.between([6.0, 40.0]));
        self.hold(takes_s);
        if self.chance(self.spec.load_chance) {
            let place = (4.0 * self.random.random::<f64>()) as usize;
            let kg = self.some_load_kg();
            let before = self.loads[place].last().map_or(0.0, |point| point[1]);
            self.loads[place].extend([[from_s + 2.0, before], [from_s + 4.0, kg]]);
        }
    }

    fn finish(mut self) -> Journey {
        let length_m = (self.distance_m - self.stretch_from_m).max(5.0);
        self.list.extend(self.road.take().map(|last| Segment { length_m, ..last }));
        let payload = self
            .loads
            .into_iter()
            .zip(PLACES)
            .map(|(points_s_kg, [behind_front_m, left_m])| PayloadSpec {
                behind_front_m,
                left_m,
                points_s_kg,
            })
            .collect();
        Journey {
            points_s_km_h: self.speed,
            lateral_points_s_m_s2: self.lateral,
            segments: Segments {
                list: self.list,
                after_last: AfterLast::Hold,
                amplitude: Amplitude::Gaussian,
            },
            payload,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time_profile::TimeProfile;

    #[test]
    fn a_junction_turns_by_a_right_angle() {
        for (gentle, slowest) in [(1.0, 4.9), (0.35, 2.9)] {
            let spec = JourneySpec { gentle, ..JourneySpec::default() };
            let mut composer = Composer::new(&spec, 3);
            composer.junction();
            let [v, a] = [&composer.speed, &composer.lateral].map(|points| TimeProfile::new(points).unwrap());
            let mut heading = 0.0;
            for i in 0..200_000 {
                let at_s = (f64::from(i) + 0.5) * 2e-4;
                let speed = v.value(at_s).max(0.1) / 3.6;
                heading += 2e-4 * a.value(at_s) / speed;
                assert!(a.value(at_s).abs() <= JUNCTION_M_S2 * gentle + 1e-9);
                assert!(a.value(at_s) == 0.0 || (slowest..7.0).contains(&speed), "{speed}");
            }
            assert!((heading.abs() - FRAC_PI_2).abs() < 1e-4, "{heading}");
        }
    }

    #[test]
    fn a_journey_has_junctions_only_if_it_says_so() {
        let usual = JourneySpec::default();
        let with = JourneySpec { junction_chance: 0.5, ..usual.clone() };
        let sharp = |spec: &JourneySpec| {
            let lateral = spec.compose(5, 3600.0).lateral_points_s_m_s2;
            let points = lateral.iter().filter(|point| point[1].abs() > spec.lateral_m_s2);
            points.count()
        };
        assert_eq!(sharp(&usual), 0);
        assert!(sharp(&with) > 10, "{}", sharp(&with));
    }
}
