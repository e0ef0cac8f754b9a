//! A healthy car's struts and body, as a table of a stored reference and back.

use std::fmt::Write as _;

use super::ReferenceProblem;
use crate::error::Problem;
use crate::toml_table::Table;

pub const FRICTION_ELEMENTS: usize = 3;

/// Struts and body of a healthy car, in the kilograms of its vehicle file (docs/math/dampers.md). Corners in the order of
/// [`Corner::ALL`](itpms_core::model::Corner::ALL), axles front and rear.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SuspensionReference {
    pub sprung_mass_kg: f64,
    pub rear_share: f64,
    /// Distance of the center of gravity from the middle to the left, over half of the track.
    pub left_offset: f64,
    /// Pitch inertia over mass and the square of the wheelbase.
    pub pitch: f64,
    /// Roll inertia over mass and the square of half of the track.
    pub roll: f64,
    /// How freely the body warps, from zero for a rigid one to one.
    pub warp: f64,
    /// Damping in N s/m at small speeds, without friction.
    pub damping_n_s_per_m: [f64; 4],
    /// By how much damping is more in rebound than in compression, in N s/m.
    pub asymmetry_n_s_per_m: [f64; 4],
    /// Force over the square of the speed in N s²/m²: negative where dampers are digressive.
    pub knee_n_s2_per_m2: [f64; 4],
    pub spring_n_per_m: [f64; 4],
    pub bar_n_per_m: [f64; 2],
    pub friction_n: [[f64; FRICTION_ELEMENTS]; 4],
    /// Time in s by which each wheel's sensor is later than the body's.
    pub lateness_s: [f64; 4],
    /// Damping in N s/m at a tenth of a meter per second (rms), which later drives are compared with.
    pub hydraulic_n_s_per_m: [f64; 4],
    /// Share of dry friction in what the struts damped meanwhile, the largest of the four.
    pub friction_share: f64,
    pub driving_s: f64,
}

impl SuspensionReference {
    /// All numbers with their keys; a name for the four corners stands for one number each.
    fn numbers(&mut self) -> Vec<(String, &mut f64)> {
        let mut all: Vec<(String, &mut f64)> = vec![
            ("sprung_mass_kg".to_owned(), &mut self.sprung_mass_kg),
            ("rear_share".to_owned(), &mut self.rear_share),
            ("left_offset".to_owned(), &mut self.left_offset),
            ("pitch".to_owned(), &mut self.pitch),
            ("roll".to_owned(), &mut self.roll),
            ("warp".to_owned(), &mut self.warp),
            ("friction_share".to_owned(), &mut self.friction_share),
            ("driving_s".to_owned(), &mut self.driving_s),
        ];
        for (value, axle) in self.bar_n_per_m.iter_mut().zip(["front", "rear"]) {
            all.push((format!("{axle}_bar_n_per_m"), value));
        }
        let of_corners = [
            ("damping_n_s_per_m", &mut self.damping_n_s_per_m),
            ("asymmetry_n_s_per_m", &mut self.asymmetry_n_s_per_m),
            ("knee_n_s2_per_m2", &mut self.knee_n_s2_per_m2),
            ("spring_n_per_m", &mut self.spring_n_per_m),
            ("lateness_s", &mut self.lateness_s),
            ("hydraulic_n_s_per_m", &mut self.hydraulic_n_s_per_m),
        ];
        for (name, values) in of_corners {
            all.extend(
                values.iter_mut().zip(CORNERS).map(|(value, corner)| (format!("{corner}_{name}"), value)),
            );
        }
        for (elements, corner) in self.friction_n.iter_mut().zip(CORNERS) {
            let keyed = elements.iter_mut().enumerate();
            all.extend(keyed.map(|(element, value)| (format!("{corner}_friction_{element}_n"), value)));
        }
        all
    }

    /// The value before anything was read.
    fn nothing() -> Self {
        Self {
            sprung_mass_kg: f64::NAN,
            rear_share: f64::NAN,
            left_offset: f64::NAN,
            pitch: f64::NAN,
            roll: f64::NAN,
            warp: f64::NAN,
            damping_n_s_per_m: [f64::NAN; 4],
            asymmetry_n_s_per_m: [f64::NAN; 4],
            knee_n_s2_per_m2: [f64::NAN; 4],
            spring_n_per_m: [f64::NAN; 4],
            bar_n_per_m: [f64::NAN; 2],
            friction_n: [[f64::NAN; FRICTION_ELEMENTS]; 4],
            lateness_s: [f64::NAN; 4],
            hydraulic_n_s_per_m: [f64::NAN; 4],
            friction_share: f64::NAN,
            driving_s: f64::NAN,
        }
    }

    /// Whether a car may be so.
    pub fn is_sane(&self) -> bool {
        let mut copy = *self;
        let is_finite = copy.numbers().iter().all(|(_, value)| value.is_finite());
        let positive = [self.sprung_mass_kg, self.pitch, self.roll, self.driving_s];
        let positive = positive.iter().chain(&self.spring_n_per_m).chain(&self.hydraulic_n_s_per_m);
        is_finite
            && positive.into_iter().all(|value| *value > 0.0)
            && self.rear_share > 0.0
            && self.rear_share < 1.0
    }
}

const CORNERS: [&str; 4] = ["fl", "fr", "rl", "rr"];

pub(super) fn write(out: &mut String, learned: &SuspensionReference) {
    out.push_str("\n[suspension]\n");
    let mut learned = *learned;
    for (key, value) in learned.numbers() {
        // `{:?}` is the shortest form that reads back as the same number.
        let _ = writeln!(out, "{key} = {value:?}");
    }
}

pub(super) fn read(table: &Table<'_>) -> Result<SuspensionReference, Problem> {
    let mut learned = SuspensionReference::nothing();
    let keys: Vec<String> = learned.numbers().into_iter().map(|(key, _)| key).collect();
    table.check_keys(&keys.iter().map(String::as_str).collect::<Vec<_>>())?;
    for (key, value) in learned.numbers() {
        *value = table.needed_number(&key)?;
    }
    match learned.is_sane() {
        true => Ok(learned),
        false => Err(ReferenceProblem::Lacks("struts that a car has").into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::StoredReference;
    use crate::vehicle::Vehicle;
    use itpms_core::model::{CornerCalibration, Learned, VehicleCalibration};

    #[test]
    fn struts_are_stored_and_read_back() {
        let mut learned = SuspensionReference::nothing();
        learned.numbers().into_iter().enumerate().for_each(|(i, (_, value))| *value = 0.5 + 0.01 * i as f64);
        let nothing = Learned { value: 0.0, sd: 0.1 };
        let corner = CornerCalibration {
            placard_kpa: 241.3,
            unsprung_mass: nothing,
            damping: nothing,
            spring: nothing,
            spectrum_bias_kpa: nothing,
            shared_road_bias: nothing,
        };
        let calibration = VehicleCalibration {
            corners: [Some(corner); 4],
            bar: [nothing; 2],
            rear_axle_coupling: nothing,
            gain: [nothing; 2],
            wheelbase: nothing,
            skew_s: [nothing; 2],
            learned_s: 600.0,
        };
        let stored = StoredReference::new(&Vehicle::paper(), calibration, 1_900_000_000).unwrap();
        let old = stored.to_text();
        assert!(
            old.starts_with("itpms-reference 9 ")
                && StoredReference::parse(old.as_bytes()).unwrap() == stored
        );
        let stored = stored.with_suspension(Some(learned));
        let text = stored.to_text();
        assert!(text.starts_with("itpms-reference 9 "), "{text}");
        assert_eq!(StoredReference::parse(text.as_bytes()).unwrap(), stored);
        learned.spring_n_per_m[2] = -1.0;
        let text = stored.with_suspension(Some(learned)).to_text();
        assert!(StoredReference::parse(text.as_bytes()).is_err());
    }
}
