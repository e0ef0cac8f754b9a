//! The car around its corners, as written in a scenario: one rigid body that heaves, pitches and rolls, what it carries,
//! and how it turns and brakes.
//!
//! Part of a scenario; the simulation builds the plant's body and its motion from it. Where the body's center of
//! gravity lies is not written here: the corners' sprung masses are their static shares of the body, so they say it.

pub(crate) mod motion;

use serde::{Deserialize, Serialize};

use crate::error::{Result, within};
use crate::plant::{Bending, Body, Load};
use crate::time_profile::TimeProfile;

/// The car of a scenario. Without one its corners are quarter cars on their own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CarSpec {
    pub track_front_m: f64,
    /// Distance in m between the rear wheels' tracks.
    pub track_rear_m: f64,
    /// Height in m of the center of gravity over the road.
    pub cg_height_m: f64,
    /// Radius of gyration in m of the unloaded body against pitch.
    pub pitch_gyration_m: f64,
    /// Radius of gyration in m of the unloaded body against roll.
    pub roll_gyration_m: f64,
    /// Front anti-roll bar in N m per rad of roll between body and axle.
    pub antiroll_front_n_m_per_rad: f64,
    /// Rear anti-roll bar in N m per rad.
    pub antiroll_rear_n_m_per_rad: f64,
    /// How far to the left of the front wheels the rear ones run in m, on a straight road.
    pub rear_offset_m: f64,
    /// Slip angle in rad of the rear axle per m/s² of lateral acceleration: carries the rear wheels outwards.
    pub rear_slip_rad_per_m_s2: f64,
    /// Smallest radius in m the car can turn with: limits the curvature that a lateral acceleration asks for.
    pub tightest_radius_m: f64,
    /// Time in s over which braking and driving forces come and go.
    pub rise_s: f64,
    /// Lateral acceleration over time, points `[time in s, m/s²]`, to the left; straight ahead, if not given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lateral_points_s_m_s2: Vec<[f64; 2]>,
    /// How its body bends; not at all, if not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bending: Option<Bending>,
    /// Load beyond the corners' sprung masses.
    pub payload: Vec<PayloadSpec>,
}

/// A passenger or a piece of luggage: a mass at a place, coming and going over time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PayloadSpec {
    pub behind_front_m: f64,
    /// Distance in m to the left of the car's middle.
    pub left_m: f64,
    /// Points `[time in s, mass in kg]`, straight between them.
    pub points_s_kg: Vec<[f64; 2]>,
}

impl Default for CarSpec {
    fn default() -> Self {
        Self {
            track_front_m: 1.55,
            track_rear_m: 1.55,
            cg_height_m: 0.55,
            pitch_gyration_m: 1.25,
            roll_gyration_m: 0.62,
            antiroll_front_n_m_per_rad: 20_000.0,
            antiroll_rear_n_m_per_rad: 8000.0,
            rear_offset_m: 0.0,
            rear_slip_rad_per_m_s2: 0.004,
            tightest_radius_m: 6.0,
            rise_s: 0.3,
            lateral_points_s_m_s2: Vec::new(),
            bending: None,
            payload: Vec::new(),
        }
    }
}

impl CarSpec {
    pub(crate) fn validate(&self) -> Result<()> {
        for (name, track_m) in [("track_front_m", self.track_front_m), ("track_rear_m", self.track_rear_m)] {
            within(name, track_m, 0.5, 4.0, "a width from 0.5 to 4 m")?;
        }
        within("cg_height_m", self.cg_height_m, 0.0, 3.0, "a height from 0 to 3 m")?;
        for (name, radius_m) in
            [("pitch_gyration_m", self.pitch_gyration_m), ("roll_gyration_m", self.roll_gyration_m)]
        {
            within(name, radius_m, 0.1, 5.0, "a radius from 0.1 to 5 m")?;
        }
        for (name, bar) in [
            ("antiroll_front_n_m_per_rad", self.antiroll_front_n_m_per_rad),
            ("antiroll_rear_n_m_per_rad", self.antiroll_rear_n_m_per_rad),
        ] {
            within(name, bar, 0.0, 500_000.0, "from 0 to 500000 N m/rad")?;
        }
        within("rear_offset_m", self.rear_offset_m, -1.0, 1.0, "a distance from -1 to 1 m")?;
        let slip = self.rear_slip_rad_per_m_s2;
        within("rear_slip_rad_per_m_s2", slip, 0.0, 0.05, "from 0 to 0.05 rad per m/s2")?;
        within("tightest_radius_m", self.tightest_radius_m, 3.0, 100.0, "a radius from 3 to 100 m")?;
        within("rise_s", self.rise_s, 0.01, 5.0, "a time from 0.01 to 5 s")?;
        self.lateral_m_s2().map_err(|e| e.within("lateral_points_s_m_s2"))?;
        self.bending.map_or(Ok(()), |bending| bending.validate().map_err(|e| e.within("bending")))?;
        self.payload.iter().try_for_each(|p| p.validate().map_err(|e| e.within("payload")))
    }

    /// Lateral acceleration in m/s² over time, as asked for.
    pub(crate) fn lateral_m_s2(&self) -> Result<TimeProfile> {
        if self.lateral_points_s_m_s2.is_empty() {
            return Ok(TimeProfile::constant(0.0));
        }
        for [_, a] in &self.lateral_points_s_m_s2 {
            within("m/s2", *a, -12.0, 12.0, "an acceleration from -12 to 12")?;
        }
        TimeProfile::new(&self.lateral_points_s_m_s2)
    }

    /// The unloaded body on corners with these (true) static shares in kg.
    pub(crate) fn body(&self, wheelbase_m: f64, shares_kg: [f64; 4]) -> Body {
        let mass_kg: f64 = shares_kg.iter().sum();
        let [fl, fr, rl, rr] = shares_kg;
        let behind_m = wheelbase_m * (rl + rr) / mass_kg;
        let left_m = 0.5 * (self.track_front_m * (fl - fr) + self.track_rear_m * (rl - rr)) / mass_kg;
        let strut = |x: f64, y: f64| [x, y - left_m];
        let (front, rear) = (behind_m, behind_m - wheelbase_m);
        let (half_front, half_rear) = (0.5 * self.track_front_m, 0.5 * self.track_rear_m);
        Body {
            mass_kg,
            pitch_kg_m2: mass_kg * self.pitch_gyration_m.powi(2),
            roll_kg_m2: mass_kg * self.roll_gyration_m.powi(2),
            height_m: self.cg_height_m,
            struts_m: [
                strut(front, half_front),
                strut(front, -half_front),
                strut(rear, half_rear),
                strut(rear, -half_rear),
            ],
            antiroll_n_m_per_rad: [self.antiroll_front_n_m_per_rad, self.antiroll_rear_n_m_per_rad],
            bending: self.bending,
        }
    }

    /// How far to the left of the front wheel of its side each rear wheel runs because the axles differ in width, in m.
    pub(crate) fn wider_m(&self) -> [f64; 2] {
        let half = 0.5 * (self.track_rear_m - self.track_front_m);
        [half, -half]
    }

    /// Whether the rear wheels' distance from the front ones' track changes with time.
    pub(crate) fn wanders(&self) -> bool {
        self.lateral_points_s_m_s2.iter().any(|[_, a]| *a != 0.0)
    }
}

impl PayloadSpec {
    /// At so many m behind the front axle and to the left.
    pub fn constant([behind_front_m, left_m]: [f64; 2], mass_kg: f64) -> Self {
        Self { behind_front_m, left_m, points_s_kg: vec![[0.0, mass_kg]] }
    }

    fn validate(&self) -> Result<()> {
        within("behind_front_m", self.behind_front_m, -2.0, 8.0, "a distance from -2 to 8 m")?;
        within("left_m", self.left_m, -2.0, 2.0, "a distance from -2 to 2 m")?;
        for [_, kg] in &self.points_s_kg {
            within("kg", *kg, 0.0, 5000.0, "a mass from 0 to 5000 kg")?;
        }
        self.mass_kg().map(|_| ())
    }

    pub(crate) fn mass_kg(&self) -> Result<TimeProfile> {
        TimeProfile::new(&self.points_s_kg)
    }
}

/// Load of a car over time.
#[derive(Debug, Clone)]
pub(crate) struct Payload {
    items: Vec<(TimeProfile, [f64; 2])>,
    masses_kg: Vec<f64>,
}

impl Payload {
    /// Places are taken from the body's center of gravity.
    pub(crate) fn new(spec: &CarSpec, body: &Body) -> Result<Self> {
        let front = 0.5 * (body.struts_m[0][0] + body.struts_m[1][0]);
        let middle = 0.5 * (body.struts_m[0][1] + body.struts_m[1][1]);
        let items = spec
            .payload
            .iter()
            .map(|p| Ok((p.mass_kg()?, [front - p.behind_front_m, middle + p.left_m])))
            .collect::<Result<Vec<_>>>()?;
        Ok(Self { masses_kg: vec![0.0; items.len()], items })
    }

    /// The load at a time in s, if it is not that of the last call (at first: none).
    pub(crate) fn changed(&mut self, time_s: f64) -> Option<Vec<Load>> {
        let mut changed = false;
        for ((mass, _), last) in self.items.iter().zip(&mut self.masses_kg) {
            let now = mass.value(time_s);
            changed |= now != *last;
            *last = now;
        }
        let loads = || {
            let places = self.items.iter().map(|(_, at_m)| *at_m);
            self.masses_kg.iter().zip(places).map(|(&mass_kg, at_m)| Load { mass_kg, at_m }).collect()
        };
        changed.then(loads)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_masses_are_the_bodys_static_shares() {
        let spec = CarSpec { track_rear_m: 1.6, ..CarSpec::default() };
        let shares = [250.0, 240.0, 215.0, 220.0];
        let body = spec.body(2.7, shares);
        // No moment about the center of gravity, to either side or fore and aft.
        for axis in 0..2 {
            let moment: f64 = shares.iter().zip(body.struts_m).map(|(m, at)| m * at[axis]).sum();
            assert!(moment.abs() < 1e-9, "{axis}: {moment}");
        }
        assert!((body.mass_kg - 925.0).abs() < 1e-9);
        assert!((body.struts_m[0][0] - body.struts_m[2][0] - 2.7).abs() < 1e-12);
        assert!((body.struts_m[2][1] - body.struts_m[3][1] - 1.6).abs() < 1e-12);
        assert!(spec.wider_m().iter().zip([0.025, -0.025]).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn a_load_is_detected_when_it_changes() {
        let item =
            PayloadSpec { behind_front_m: 2.0, left_m: -0.3, points_s_kg: vec![[10.0, 0.0], [12.0, 80.0]] };
        let spec = CarSpec { payload: vec![item], ..CarSpec::default() };
        let body = spec.body(2.7, [240.0; 4]);
        let mut payload = Payload::new(&spec, &body).unwrap();
        assert_eq!(payload.changed(0.0), None);
        assert_eq!(payload.changed(11.0), Some(vec![Load { mass_kg: 40.0, at_m: [1.35 - 2.0, -0.3] }]));
        assert_eq!(payload.changed(11.0), None);
    }
}
