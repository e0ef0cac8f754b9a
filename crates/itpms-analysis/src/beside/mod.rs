//! Monitoring of a car beside its pressures, as a drive goes on: dampers and load, the tires' own sensors, forces once per wheel turn.
//!
//! Called by `itpms-drive` with the rows of a log and by `itpms-live` with those of a source, so that both say the same. Touches no pressure.

mod sensor_watch;
mod struts;
mod turning;

use itpms_core::car::CarEstimator;
use itpms_core::model::{Corner, CornerEstimate, PressureUnit, QuarterCar};
use itpms_data::out::RadiusRow;
use itpms_data::reference::SuspensionReference;
use itpms_data::{LogRow, Vehicle};
use serde_json::{Map, Value, json};

pub use self::sensor_watch::{SensorState, WatchedSensor};
use self::sensor_watch::{SensorWatch, sensors_json};
use self::struts::load_json;
pub use self::struts::{SentLoads, SuspensionWatch, dampers_json, left_right_lines, suspension_lines};
use self::turning::Rotation;
pub use self::turning::rotation_line;
use crate::rotation::OncePerTurn;
use crate::suspension::SuspensionVerdict;

/// The corners' estimates after a row, in the order of [`Corner::ALL`].
type Estimates = [Option<CornerEstimate<f64>>; 4];

/// The car as the estimator has identified it, in the order of [`Corner::ALL`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Identified {
    pub quarter_cars: [Option<QuarterCar<f64>>; 4],
    pub friction_n: [Option<f64>; 4],
}

impl Identified {
    /// By an estimator; nothing of a car without one.
    pub fn by(estimator: Option<&CarEstimator<f64>>) -> Self {
        estimator.map_or_else(Self::default, |estimator| Self {
            quarter_cars: estimator.quarter_cars(),
            friction_n: Corner::ALL.map(|corner| Some(estimator.fit(corner)?.0.friction_n)),
        })
    }
}

#[derive(Debug, Clone)]
pub struct Beside {
    suspension: Option<SuspensionWatch>,
    sensors: SensorWatch,
    rotation: Rotation,
    sensors_kpa: [f64; 4],
    sent_loads: SentLoads,
}

impl Beside {
    /// For rows of these corners so many seconds apart; `reference`: what the car was when it was healthy.
    pub fn new(
        vehicle: &Vehicle,
        corners: &[Corner],
        step_s: f64,
        reference: Option<SuspensionReference>,
    ) -> Self {
        let gross_axle_kg = vehicle.details.gross_axle_kg;
        Self {
            suspension: SuspensionWatch::new(vehicle, corners, step_s, reference),
            sensors: SensorWatch::new(Corner::ALL.map(|corner| vehicle.placard_kpa(corner))),
            rotation: Rotation::new(vehicle, corners),
            sensors_kpa: [f64::NAN; 4],
            sent_loads: SentLoads { axle_kg: [f64::NAN; 2], gross_axle_kg },
        }
    }

    /// Takes a row and what was estimated after it; hands on what is newly found, as a line of `events.jsonl`.
    pub fn take(
        &mut self,
        row: &LogRow,
        estimates: &Estimates,
        radii: Option<&RadiusRow>,
        mut found: impl FnMut(Map<String, Value>),
    ) {
        if let Some(suspension) = &mut self.suspension {
            suspension.take(row);
        }
        let sent = row.motion.tire_sensor_kpa.into_iter().chain(row.motion.axle_kg);
        for (last, sent) in self.sensors_kpa.iter_mut().chain(&mut self.sent_loads.axle_kg).zip(sent) {
            if sent.is_finite() {
                *last = sent;
            }
        }
        self.sensors.take(row, estimates, radii, |corner, sensor| {
            sensor.event(corner).into_iter().for_each(&mut found);
        });
        self.rotation.take(row, estimates, &mut found);
    }

    /// Last readings of the tires' own sensors in kPa; NaN: none.
    pub fn sent_kpa(&self) -> [f64; 4] {
        self.sensors_kpa
    }

    /// The findings so far, which takes some tenths of a second.
    pub fn conclude(&self, car: &Identified) -> Findings {
        Findings {
            suspension: self.suspension.as_ref().map(SuspensionWatch::conclude),
            sensors_kpa: self.sensors_kpa,
            sensors: self.sensors.conclude(),
            sent_loads: self.sent_loads,
            once_per_turn: self.rotation.conclude(car),
        }
    }
}

/// A drive's results beside its pressures, in the order of [`Corner::ALL`].
#[derive(Debug, Clone)]
pub struct Findings {
    /// Dampers and load, where all four corners are measured.
    pub suspension: Option<SuspensionVerdict>,
    /// Last readings of the tires' own sensors in kPa; NaN: none.
    pub sensors_kpa: [f64; 4],
    /// What is known of them.
    pub sensors: [WatchedSensor; 4],
    /// Loads of the axles by the car's own sensors.
    pub sent_loads: SentLoads,
    /// Forces once per wheel turn, of corners with accelerations.
    pub once_per_turn: [Option<OncePerTurn>; 4],
}

impl Findings {
    /// As in `itpms estimate --json`: each null where it is not looked at.
    pub fn json(&self) -> [(&'static str, Value); 5] {
        [
            ("dampers", dampers_json(self.suspension.as_ref())),
            ("load", load_json(self.suspension.as_ref(), &self.sent_loads)),
            ("once_per_turn", turning::json(&self.once_per_turn)),
            ("tire_sensors_kpa", sent_json(&self.sensors_kpa)),
            ("tire_sensors", sensors_json(&self.sensors)),
        ]
    }

    /// In lines, as the command shows them after those of the pressures.
    pub fn lines(&self) -> Vec<String> {
        let lines = suspension_lines(self.suspension.as_ref()).into_iter();
        lines.chain(self.sent_loads.line()).chain(rotation_line(&self.once_per_turn)).collect()
    }

    /// Reservations about a drive that began at `origin_s`, a sentence each.
    pub fn concerns(&self, origin_s: f64, unit: PressureUnit) -> Vec<String> {
        let of = |(corner, sensor): (&Corner, &WatchedSensor)| sensor.text(*corner, origin_s, unit);
        let sensors = Corner::ALL.iter().zip(&self.sensors).filter_map(of);
        sensors.chain(turning::rises(&self.once_per_turn, origin_s)).collect()
    }
}

/// Last readings of the tires' own sensors; null where none.
fn sent_json(sensors_kpa: &[f64; 4]) -> Value {
    let sent = Corner::ALL.iter().zip(sensors_kpa).filter(|(_, kpa)| kpa.is_finite());
    let sent: Map<String, Value> =
        sent.map(|(corner, kpa)| (corner.label().to_owned(), json!(kpa))).collect();
    if sent.is_empty() { Value::Null } else { Value::Object(sent) }
}
