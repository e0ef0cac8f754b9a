//! Forces once per wheel turn in a drive: rows to the watch of each wheel, by its own speed where the car sends it.

use itpms_core::model::Corner;
use itpms_data::{LogRow, Vehicle};
use serde_json::{Map, Value, json};

use super::{Estimates, Identified};
use crate::rotation::{OncePerTurn, RotationState, RotationWatch, TurningWheel};
use crate::suspension::Measured;

/// Rolling radius in m where the file has none.
const USUAL_RADIUS_M: f64 = 0.31;

/// For how long in s a wheel's own speed goes on.
const HELD_S: f64 = 0.5;

#[derive(Debug, Clone)]
struct Wheel {
    wheel: TurningWheel,
    radius_m: f64,
    watch: RotationWatch,
    /// Turning rate by the wheel's own speed, and when it came.
    own: Option<(f64, f64)>,
}

/// Listens to the wheels of a drive.
#[derive(Debug, Clone)]
pub(super) struct Rotation {
    wheels: [Option<Wheel>; 4],
}

impl Rotation {
    pub(super) fn new(vehicle: &Vehicle, corners: &[Corner]) -> Self {
        let wheel = |corner: Corner| {
            let config = vehicle.corner(corner).filter(|_| corners.contains(&corner))?;
            let car = &config.quarter_car;
            let wheel = TurningWheel {
                unsprung_mass_kg: car.unsprung_mass_kg(),
                tire_n_per_m: config.initial_stiffness_n_per_m(),
                tire_damping_n_s_per_m: config.uncertainty.tire_damping_n_s_per_m,
                spring_n_per_m: car.spring_n_per_m(),
                damping_n_s_per_m: car.damping_n_s_per_m(),
                friction_n: config.uncertainty.friction_n,
            };
            let radius_m = vehicle.rolling_radius_m().unwrap_or(USUAL_RADIUS_M);
            Some(Wheel { wheel, radius_m, watch: RotationWatch::default(), own: None })
        };
        Self { wheels: Corner::ALL.map(wheel) }
    }

    /// Takes a row and what was estimated after it; hands on a force that has risen, as a line of `events.jsonl`.
    pub(super) fn take(
        &mut self,
        row: &LogRow,
        estimates: &Estimates,
        mut found: impl FnMut(Map<String, Value>),
    ) {
        for (place, wheel) in self.wheels.iter_mut().enumerate() {
            let (Some(wheel), Some(logged)) = (wheel, &row.corners[place]) else { continue };
            let [own_m_s, own_rad_s] =
                [row.motion.wheel_speed_m_s, row.motion.wheel_speed_rad_s].map(|of| of[place]);
            let own = if own_rad_s.is_finite() { own_rad_s } else { own_m_s / wheel.radius_m };
            if own.is_finite() {
                wheel.own = Some((row.time_s, own));
            }
            let rad_per_s = match wheel.own {
                Some((at_s, own)) if row.time_s - at_s < HELD_S => own,
                Some(_) => f64::NAN,
                None => row.speed_m_s / wheel.radius_m,
            };
            if let Some(estimate) = estimates[place].filter(|estimate| estimate.validity.is_valid()) {
                wheel.wheel.tire_n_per_m = estimate.stiffness_n_per_m;
            }
            wheel.watch.push(row.time_s, [logged.wheel_accel_m_s2, logged.body_accel_m_s2], rad_per_s);
            if let Some((rise, since_s)) = wheel.watch.rises(&wheel.wheel) {
                let label = Corner::ALL[place].label();
                let text = rise_text(label, rise, since_s);
                let event = json!({ "time_s": since_s, "event": "begun", "kind": "unbalance-rising", "wheels": [label], "rise_n": rise.value, "rise_sd_n": rise.sd, "text": text });
                found(event.as_object().cloned().unwrap_or_default());
            }
        }
    }

    /// The drive's result, with the car as it was identified.
    pub(super) fn conclude(&self, car: &Identified) -> [Option<OncePerTurn>; 4] {
        Corner::ALL.map(|corner| {
            let Wheel { wheel, watch, own, .. } = self.wheels[corner.index()].as_ref()?;
            let friction_n = car.friction_n[corner.index()].filter(|friction_n| *friction_n > 0.0);
            let damping = car.quarter_cars[corner.index()]
                .map_or(wheel.damping_n_s_per_m, |car| car.damping_n_s_per_m());
            let wheel = TurningWheel {
                damping_n_s_per_m: damping,
                friction_n: friction_n.unwrap_or(wheel.friction_n),
                ..*wheel
            };
            let found = watch.conclude(&wheel);
            // By the car's speed phases do not hold, and an imbalance would be another.
            Some(OncePerTurn { imbalance_g: found.imbalance_g.filter(|_| own.is_some()), ..found })
        })
    }
}

fn rise_text(label: &str, rise: Measured, since_s: f64) -> String {
    format!(
        "{label}: the force once per turn has risen by {:.0} N (sd {:.0}), found at {since_s:.0} s: snow in the rim, a lost weight, a damaged tire?",
        rise.value, rise.sd
    )
}

/// Of each wheel that is looked at; null without accelerations.
pub(super) fn json(wheels: &[Option<OncePerTurn>; 4]) -> Value {
    let measured = |of: Option<Measured>| of.map_or([None; 2], |of| [Some(of.value), Some(of.sd)]);
    let one = |(corner, one): (&Corner, &Option<OncePerTurn>)| {
        let one = one.as_ref()?;
        let ([force, force_sd], [grams, grams_sd]) = (measured(one.force_n), measured(one.imbalance_g));
        let [rise, rise_sd] = measured(one.rise.map(|(rise, _)| rise));
        let value = json!({
            "state": one.state.label(), "force_n": force, "force_sd_n": force_sd, "at_rad_per_s": one.force_n.map(|_| one.at_rad_per_s),
            "imbalance_g": grams, "imbalance_sd_g": grams_sd, "rise_n": rise, "rise_sd_n": rise_sd, "since_s": one.rise.map(|(_, since_s)| since_s),
        });
        Some((corner.label().to_owned(), value))
    };
    let all: Map<String, Value> = Corner::ALL.iter().zip(wheels).filter_map(one).collect();
    if all.is_empty() { Value::Null } else { Value::Object(all) }
}

/// A line of the wheels whose force is known.
pub fn rotation_line(wheels: &[Option<OncePerTurn>; 4]) -> Option<String> {
    let known = Corner::ALL.iter().zip(wheels).filter_map(|(corner, one)| {
        let (one, force) = (one.as_ref()?, one.as_ref()?.force_n?);
        let grams = one
            .imbalance_g
            .map_or_else(String::new, |of| format!(", imbalance {:.0} g (sd {:.0})", of.value, of.sd));
        Some(format!("{} {:.0} N (sd {:.0}){grams}", corner.label(), force.value, force.sd))
    });
    let known: Vec<String> = known.collect();
    (!known.is_empty()).then(|| format!("force once per turn: {}", known.join("; ")))
}

/// Forces that have risen, a sentence each.
pub(super) fn rises(wheels: &[Option<OncePerTurn>; 4], origin_s: f64) -> Vec<String> {
    let risen = Corner::ALL.iter().zip(wheels).filter_map(|(corner, one)| {
        let (rise, since_s) = one.as_ref().filter(|one| one.state == RotationState::Rising)?.rise?;
        Some(rise_text(corner.label(), rise, since_s - origin_s))
    });
    risen.collect()
}
