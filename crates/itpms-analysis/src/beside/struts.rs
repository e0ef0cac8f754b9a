//! Dampers and load of a drive: its rows to the spectra that these are read from, and the verdict in the end.

use itpms_core::model::Corner;
use itpms_data::reference::SuspensionReference;
use itpms_data::{LogRow, Vehicle};
use serde_json::{Map, Value, json};

use crate::suspension::{
    Because, CarBody, DamperHealth, Load, LoadState, Masses, Measured, SuspensionSpectra, SuspensionVerdict,
    Terms,
};

/// Listens to a drive of a car whose four corners are all measured.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct SuspensionWatch {
    car: CarBody,
    terms: Terms,
    spectra: SuspensionSpectra,
    reference: Option<SuspensionReference>,
}

impl SuspensionWatch {
    /// For rows so many seconds apart; `None` for a car that lacks a corner, in its file or in the log.
    pub fn new(
        vehicle: &Vehicle,
        corners: &[Corner],
        step_s: f64,
        reference: Option<SuspensionReference>,
    ) -> Option<Self> {
        let car = car_body(vehicle).filter(|_| Corner::ALL.iter().all(|corner| corners.contains(corner)))?;
        let details = &vehicle.details;
        let terms = Terms {
            adaptive_dampers: details.adaptive_dampers,
            level_control: details.level_control,
            gross_axle_kg: details.gross_axle_kg,
        };
        Some(Self { car, terms, spectra: SuspensionSpectra::new(step_s), reference })
    }

    pub fn take(&mut self, row: &LogRow) {
        let accelerations = row.corners.map(|corner| {
            corner.map_or([f64::NAN; 2], |corner| [corner.wheel_accel_m_s2, corner.body_accel_m_s2])
        });
        self.spectra.push(row.time_s, row.speed_m_s, &accelerations);
    }

    /// From here on against what the rows so far have taught, where they have taught anything; nothing else is kept of them.
    pub fn calibrate(&mut self) {
        let learned = self.conclude().learned.or(self.reference);
        self.spectra = self.spectra.begun_anew();
        self.reference = learned;
    }

    pub fn conclude(&self) -> SuspensionVerdict {
        SuspensionVerdict::of(&self.car, &self.spectra, self.reference.as_ref(), &self.terms)
    }
}

fn car_body(vehicle: &Vehicle) -> Option<CarBody> {
    let [Some(fl), Some(fr), Some(rl), Some(rr)] = &vehicle.corners else { return None };
    let corners = [fl, fr, rl, rr];
    Some(CarBody {
        sprung_mass_kg: corners.map(|corner| corner.quarter_car.sprung_mass_kg()),
        unsprung_mass_kg: corners.map(|corner| corner.quarter_car.unsprung_mass_kg()),
        damping_n_s_per_m: corners.map(|corner| corner.quarter_car.damping_n_s_per_m()),
        spring_n_per_m: corners.map(|corner| corner.quarter_car.spring_n_per_m()),
        spring_stiffening_per_m: vehicle.details.spring_stiffening_per_m.unwrap_or(0.0),
        accel_noise_m_s2: corners.map(|corner| corner.accel_noise_or_usual_m_s2()),
        tire_n_per_m: corners.map(|corner| corner.tire.stiffness_n_per_m(corner.placard_kpa)),
        tire_damping_n_s_per_m: corners.map(|corner| corner.uncertainty.tire_damping_n_s_per_m),
    })
}

fn measured(object: &mut Map<String, Value>, name: &str, sd: &str, measured: Option<Measured>) {
    let finite = measured.filter(|measured| measured.value.is_finite() && measured.sd.is_finite());
    object.insert(name.to_owned(), json!(finite.map(|measured| measured.value)));
    object.insert(sd.to_owned(), json!(finite.map(|measured| measured.sd)));
}

fn of_because(because: Option<Because>) -> Value {
    json!(because.map(Because::label))
}

/// The dampers of a drive; null where they are not looked at.
pub fn dampers_json(verdict: Option<&SuspensionVerdict>) -> Value {
    let Some(verdict) = verdict else { return Value::Null };
    let damper = |(corner, damper): (&Corner, &DamperHealth)| {
        let mut object = Map::new();
        measured(&mut object, "damping_n_s_per_m", "damping_sd_n_s_per_m", damper.damping_n_s_per_m);
        measured(&mut object, "over_reference", "over_reference_sd", damper.over_reference);
        measured(&mut object, "left_right", "left_right_sd", damper.left_right);
        measured(&mut object, "front_rear", "front_rear_sd", damper.front_rear);
        measured(&mut object, "wheel_damping_ratio", "wheel_damping_ratio_sd", damper.wheel_damping_ratio);
        object.insert("state".to_owned(), json!(damper.state.label()));
        object.insert("because".to_owned(), of_because(damper.because));
        (corner.label().to_owned(), Value::Object(object))
    };
    Value::Object(Corner::ALL.iter().zip(&verdict.dampers).map(damper).collect())
}

/// Loads of front and rear axle by the car's own sensors, and what may be on them.
#[derive(Debug, Clone, Copy)]
pub struct SentLoads {
    /// The last reading in kg; NaN: none.
    pub axle_kg: [f64; 2],
    pub gross_axle_kg: Option<[f64; 2]>,
}

impl SentLoads {
    /// Whether an axle carries more than it may.
    fn is_over(&self) -> bool {
        self.gross_axle_kg
            .is_some_and(|gross| self.axle_kg.iter().zip(gross).any(|(sent, gross)| *sent > gross))
    }

    /// That in a line, where anything was sent.
    pub fn line(&self) -> Option<String> {
        let one = |(name, kg): (&str, f64)| kg.is_finite().then(|| format!("{name} axle {kg:.0} kg"));
        let axles: Vec<String> = ["front", "rear"].into_iter().zip(self.axle_kg).filter_map(one).collect();
        let over = if self.is_over() { ": OVERLOAD" } else { "" };
        (!axles.is_empty()).then(|| format!("load by the car's own sensors: {}{over}", axles.join(", ")))
    }
}

/// Axle loads; null where they are neither estimated nor sent.
pub(super) fn load_json(verdict: Option<&SuspensionVerdict>, sent: &SentLoads) -> Value {
    let mut object = Map::new();
    if sent.line().is_some() {
        let [front, rear] = sent.axle_kg.map(|kg| Some(kg).filter(|kg| kg.is_finite()));
        object.insert(
            "sent".to_owned(),
            json!({ "front_axle_kg": front, "rear_axle_kg": rear, "overload": sent.is_over() }),
        );
    }
    let Some(SuspensionVerdict { load: Load { masses, state, because, .. }, .. }) = verdict else {
        return if object.is_empty() { Value::Null } else { Value::Object(object) };
    };
    let of = |of: fn(&Masses) -> Measured| masses.as_ref().map(of);
    measured(&mut object, "front_axle_kg", "front_axle_sd_kg", of(|masses| masses.axles_kg[0]));
    measured(&mut object, "rear_axle_kg", "rear_axle_sd_kg", of(|masses| masses.axles_kg[1]));
    measured(&mut object, "total_kg", "total_sd_kg", of(|masses| masses.total_kg));
    measured(&mut object, "added_kg", "added_sd_kg", of(|masses| masses.added_kg));
    object.insert("state".to_owned(), json!(state.label()));
    object.insert("because".to_owned(), of_because(*because));
    Value::Object(object)
}

/// Left against right of each axle, without its full stop: of any drive with four corners; what it says of a healthy car is that its dampers are alike.
pub fn left_right_lines(verdict: &SuspensionVerdict) -> Vec<String> {
    let axle = |(name, at): (&str, usize)| {
        let [left, right] = [Corner::ALL[at], Corner::ALL[at + 1]].map(Corner::label);
        let damper = &verdict.dampers[at];
        match (damper.left_right, damper.because) {
            (Some(Measured { value, sd }), _) => {
                let apart = value.abs() > LEFT_RIGHT_LIMIT && value.abs() > 3.0 * sd;
                let weaker = if value < 0.0 { left } else { right };
                let advice = match apart {
                    true => format!(": look at the damper {weaker}, which damps less"),
                    false => ", alike".to_owned(),
                };
                format!("{name} dampers: {left} over {right} {:.2} (sd {sd:.2}){advice}", 1.0 + value)
            }
            (None, because) => {
                format!("{name} dampers: not judged: {}", because.map_or("nothing was read", Because::text))
            }
        }
    };
    [("front", 0), ("rear", 2)].into_iter().map(axle).collect()
}

/// Difference of an axle's dampers, as a share, above which it is reported to a person.
const LEFT_RIGHT_LIMIT: f64 = 0.18;

/// Dampers and load in lines; none without a reference, where nothing is judged.
pub fn suspension_lines(verdict: Option<&SuspensionVerdict>) -> Vec<String> {
    let Some(verdict) = verdict else { return Vec::new() };
    if verdict.dampers[0].because == Some(Because::NoReference) {
        return Vec::new();
    }
    let [first, ..] = &verdict.dampers;
    let mut lines = Vec::new();
    let of = |(corner, damper): (&Corner, &DamperHealth)| {
        let over = damper.over_reference.map_or_else(String::new, |over| format!(" {:.2}", over.value));
        format!("{} {}{over}", corner.label(), damper.state.label())
    };
    let all: Vec<String> = Corner::ALL.iter().zip(&verdict.dampers).map(of).collect();
    lines.push(match first.because.filter(|_| first.damping_n_s_per_m.is_none()) {
        Some(because) => format!("dampers: {}: {}", first.state.label(), because.text()),
        None => format!("dampers over the reference: {}", all.join(", ")),
    });
    lines.push(match (&verdict.load.masses, verdict.load.because) {
        (Some(Masses { axles_kg: [front, rear], total_kg, added_kg }), _) => format!(
            "load: front axle {:.0} kg, rear axle {:.0} kg, total {:.0} kg (sd {:.0}), {:+.0} kg since the reference{}",
            front.value,
            rear.value,
            total_kg.value,
            total_kg.sd,
            added_kg.value,
            if verdict.load.state == LoadState::Overload { ": OVERLOAD" } else { "" }
        ),
        (None, because) => {
            format!("load: {}: {}", verdict.load.state.label(), because.map_or("nothing was read", Because::text))
        }
    });
    lines
}
