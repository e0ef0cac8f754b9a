//! One day of a car: how fast, over which road, with whom, in which tires.
//!
//! Called by the path. A car's possible changes between two days are in [`CHANGES`].

use itpms_core::model::Corner;
use itpms_sim::car::{CarSpec, PayloadSpec};
use itpms_sim::plant::Deviations;
use itpms_sim::road::{RoadClass, RoadSpec};
use itpms_sim::scenario::Scenario;
use itpms_sim::time_profile::{Pressure, Speed};

use super::car::{OwnCar, Source};
use crate::runner::Result;
use crate::sensors::wheel_speeds_beside;

pub(super) const RATE_HZ: f64 = 200.0;
const CLASSES: [RoadClass; 3] = [RoadClass::A, RoadClass::B, RoadClass::C];
/// Slopes of the road's spectrum, even speeds in km/h, and how far they go up and down within minutes.
const SLOPE: [f64; 2] = [1.8, 2.3];
const KM_H: [f64; 2] = [55.0, 110.0];
const LEAST_OTHER_KM_H: f64 = 15.0;
const WAVE_KM_H: f64 = 8.0;
const WAVE_S: f64 = 45.0;
const PASSENGER_KG: f64 = 75.0;
/// What drivers and luggage weigh that is there on one day and not on the other, in kg, and where, in m behind the front axle and to the left.
const DRIVER: [f64; 2] = [1.3, 0.36];
const FRONT_SEAT: [f64; 2] = [1.3, -0.36];
const BACK_SEATS: [[f64; 2]; 2] = [[2.15, 0.36], [2.15, -0.36]];
const BOOT: [f64; 2] = [3.1, 0.0];

#[derive(Debug, Clone)]
pub(super) struct Day {
    class: RoadClass,
    slope: f64,
    km_h: f64,
    /// Masses in kg by their places.
    load: Vec<([f64; 2], f64)>,
    duration_s: f64,
    seed: u64,
    /// Seed of the car's wheel speeds, where it has some.
    pub(super) wheel_speeds: Option<u64>,
}

impl Day {
    /// The day of the calibration, and another one on another class of road, at another speed, with another load.
    pub(super) fn two(index: usize, seed: u64, [first_s, second_s]: [f64; 2]) -> [Self; 2] {
        // A car's own draws are another sequence.
        let mut draw = Source::new(seed ^ (1 << 40));
        let km_h = draw.within(KM_H);
        let other_km_h = loop {
            let other: f64 = draw.within(KM_H);
            if (other - km_h).abs() >= LEAST_OTHER_KM_H {
                break other;
            }
        };
        let mut day = |number: usize, km_h: f64, duration_s: f64| Self {
            class: CLASSES[(index + number) % CLASSES.len()],
            slope: draw.within(SLOPE),
            km_h,
            load: vec![(DRIVER, PASSENGER_KG)],
            duration_s,
            seed: seed.wrapping_add((number as u64 + 1) << 32),
            wheel_speeds: None,
        };
        // Neighbors in the list of cars go on the same class of road; each third class comes next on the later day.
        let first = day(0, km_h, first_s);
        let mut second = day(1 + (index / CLASSES.len()) % 2, other_km_h, second_s);
        second.load.extend(match index % 3 {
            0 => vec![],
            1 => vec![(FRONT_SEAT, PASSENGER_KG), (BOOT, 30.0)],
            _ => vec![(FRONT_SEAT, PASSENGER_KG), (BACK_SEATS[0], 60.0), (BOOT, 50.0)],
        });
        [first, second]
    }

    /// What is simulated of a car on it, changed so since its calibration; `lost` is the tire that loses air, by its pressure over time.
    pub(super) fn scenario(
        &self,
        car: &OwnCar,
        change: &Change,
        lost: Option<(Corner, Pressure)>,
    ) -> Result<(Scenario, u64)> {
        let mut scenario = Scenario::builtin("drive-puncture")?;
        scenario.rate_hz = RATE_HZ;
        scenario.duration_s = self.duration_s;
        scenario.wheelbase_m = car.wheelbase_m;
        scenario.road = RoadSpec { contact_length_m: 0.1, ..RoadSpec::iso8608(self.class, self.slope) };
        let waves = (self.duration_s / WAVE_S).ceil() as usize;
        let point = |i: usize| {
            [WAVE_S * i as f64, self.km_h + if i.is_multiple_of(2) { -WAVE_KM_H } else { WAVE_KM_H }]
        };
        scenario.speed = Speed::PointsSKmH((0..=waves).map(point).collect());
        let load = change.load.unwrap_or(&self.load);
        let payload = load.iter().map(|(place_m, kg)| PayloadSpec::constant(*place_m, *kg)).collect();
        scenario.car = Some(CarSpec { rear_offset_m: car.rear_offset_m, payload, ..CarSpec::default() });
        scenario.wheel_speeds = self.wheel_speeds.map(wheel_speeds_beside);
        for (corner, place) in scenario.corner.iter_mut() {
            let mut spec = car.corner(corner).clone();
            (change.edit)(&mut spec.truth);
            let cold_kpa = car.placard_kpa;
            spec.pressure = Pressure::ramp(cold_kpa, change.warm * cold_kpa, 0.0, self.duration_s);
            if let Some((_, pressure)) = lost.as_ref().filter(|(struck, _)| *struck == corner) {
                spec.pressure = pressure.clone();
            }
            *place = spec;
        }
        Ok((scenario, self.seed))
    }
}

#[derive(Debug)]
pub(super) struct Change {
    pub(super) name: &'static str,
    edit: fn(&mut Deviations),
    /// Pressure at the end of the drive over that at its start.
    warm: f64,
    /// Its load in place of the day's, in kg by place.
    load: Option<&'static [([f64; 2], f64)]>,
}

const fn changed(name: &'static str, edit: fn(&mut Deviations)) -> Change {
    Change { name, edit, warm: 1.0, load: None }
}

pub(super) const SAME: Change = changed("nothing", |_| {});

/// What may be different on a later day, and what is another car.
pub(super) const CHANGES: &[Change] = &[
    Change {
        load: Some(&[(DRIVER, 75.0), (BACK_SEATS[0], 75.0), (BACK_SEATS[1], 75.0), (BOOT, 100.0)]),
        ..changed("load +250 kg", |_| {})
    },
    Change { load: Some(&[]), ..changed("load -75 kg", |_| {}) },
    // Rubber that is 30 K warmer is some 3 % softer; the air has a tenth more.
    Change { warm: 1.1, ..changed("warms up", |truth| truth.tire_stiffness_factor *= 0.97) },
    // 5 mm of tread are some 1.5 kg of 45, and the belt stands nearer to the road.
    changed("worn tires", |truth| {
        truth.unsprung_mass_factor *= 0.967;
        truth.tire_stiffness_factor *= 1.03;
    }),
    changed("tires 20 % stiffer", |truth| truth.tire_stiffness_factor *= 1.2),
    changed("tires 15 % softer", |truth| truth.tire_stiffness_factor *= 0.85),
    changed("wheels 10 % heavier", |truth| truth.unsprung_mass_factor *= 1.1),
    changed("dampers x 2.2", |truth| truth.damping_factor *= 2.2),
    changed("dampers x 0.55", |truth| truth.damping_factor *= 0.55),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_later_day_has_another_road_speed_and_load_and_the_same_car() {
        for index in 0..24 {
            let car = OwnCar::draw(index, index as u64).unwrap();
            let [first, later] = Day::two(index, index as u64, [600.0, 130.0]);
            assert!(first.class != later.class && (first.km_h - later.km_h).abs() >= 15.0);
            assert!(first.seed != later.seed);
            let (before, _) = first.scenario(&car, &SAME, None).unwrap();
            let (after, _) = later.scenario(&car, &SAME, None).unwrap();
            before.validate().unwrap();
            let parts = |of: &Scenario| {
                let corners = [&of.corner.fl, &of.corner.fr, &of.corner.rl, &of.corner.rr];
                corners
                    .map(|corner| corner.as_ref().map(|c| (c.truth, c.unsprung_mass_kg, c.damping_n_s_per_m)))
            };
            assert_eq!(parts(&before), parts(&after));
            // The loss is of one tire's pressure alone.
            let loss = Pressure::ramp(230.0, 184.0, 60.0, 10.0);
            let (losing, _) = later.scenario(&car, &SAME, Some((Corner::RearLeft, loss))).unwrap();
            assert_eq!(losing.corner.fl, after.corner.fl);
            assert_ne!(losing.corner.rl, after.corner.rl);
        }
        let car = OwnCar::draw(0, 7).unwrap();
        let [_, later] = Day::two(0, 7, [600.0, 130.0]);
        for change in CHANGES {
            let (changed, _) = later.scenario(&car, change, None).unwrap();
            changed.validate().unwrap();
            let (same, _) = later.scenario(&car, &SAME, None).unwrap();
            assert!(changed.corner != same.corner || changed.car != same.car, "{}", change.name);
        }
    }
}
