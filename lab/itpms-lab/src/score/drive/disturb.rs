//! Deviations of a real car and its sensors from the estimator's model: each alone, then all together.
//!
//! Called by the plan of the four-wheel parts. Every row is the puncture on the front wheels' track with one thing
//! changed; sizes are those that come with cars and sensors one can buy, or worse.

use itpms_core::model::Corner;
use itpms_sim::scenario::CornerSpec;
use itpms_sim::sensor::SensorSpec;

use super::{Drive, Plant, Setup};
use crate::runner::Result;

const SPEEDS_KM_H: [f64; 2] = [80.0, 20.0];
/// A car's way through bends: points [s, m/s²], to the left and to the right, before, in and after the drop.
const BENDS_S_M_S2: [[f64; 2]; 12] = [
    [4.0, 0.0],
    [5.0, 2.0],
    [8.0, 2.0],
    [9.0, 0.0],
    [12.0, 0.0],
    [13.0, -2.0],
    [20.0, -2.0],
    [21.0, 0.0],
    [24.0, 0.0],
    [25.0, 2.0],
    [33.0, 2.0],
    [34.0, 0.0],
];

struct Disturbance {
    name: &'static str,
    change: fn(Drive) -> Drive,
}

const fn disturbance(name: &'static str, change: fn(Drive) -> Drive) -> Disturbance {
    Disturbance { name, change }
}

const ALONE: [Disturbance; 31] = [
    disturbance("nothing", |drive| drive),
    disturbance("bends of 2 m/s2", bends),
    disturbance("payload +20 %", |d| corners(d, |_, c| c.truth.sprung_mass_factor = 1.2)),
    disturbance("payload -20 %", |d| corners(d, |_, c| c.truth.sprung_mass_factor = 0.8)),
    disturbance("dampers +20 %", |d| corners(d, |_, c| c.truth.damping_factor = 1.2)),
    disturbance("dampers -20 %", |d| corners(d, |_, c| c.truth.damping_factor = 0.8)),
    disturbance("dampers asymmetric .3", |d| corners(d, |_, c| c.truth.damper_asymmetry = 0.3)),
    // At 0.5 m/s half the force of a linear one.
    disturbance("dampers digressive 2 s/m", |d| corners(d, |_, c| c.truth.damper_digression_s_per_m = 2.0)),
    disturbance("springs +20 %", |d| corners(d, |_, c| c.truth.spring_factor = 1.2)),
    // 28 % stiffer where it is compressed by 5 cm.
    disturbance("springs progressive 5 /m", |d| corners(d, |_, c| c.truth.spring_progression_per_m = 5.0)),
    disturbance("friction 20 N", |d| corners(d, |_, c| c.truth.friction_n = 20.0)),
    disturbance("wheel gain fl +2 %", |d| wheel_sensor(d, fl_gain)),
    disturbance("wheel gain all +2 %", |d| wheel_sensor(d, |_, s| s.gain_error = 0.02)),
    disturbance("speed in the log +1 %", |drive| Drive { speed_factor: 1.01, ..drive }),
    disturbance("wheelbase in the file -1 %", short_wheelbase),
    disturbance("tires worn, -3 %", |d| corners(d, |_, c| c.truth.tire_stiffness_factor = 0.97)),
    disturbance("tire damping", |d| corners(d, |_, c| c.truth.tire_damping_n_s_per_m = 50.0)),
    disturbance("imbalance 35 g", |drive| imbalance(drive, 0.01)),
    disturbance("imbalance 10 g", |drive| imbalance(drive, 0.003)),
    disturbance("enveloping 0.1 m", |drive| enveloping(drive, 0.1)),
    disturbance("enveloping 0.2 m", |drive| enveloping(drive, 0.2)),
    disturbance("fl sensor 2 ms late", |d| wheel_sensor(d, |at, s| late(at, s, 2.0))),
    disturbance("fl sensor 4 ms late", |d| wheel_sensor(d, |at, s| late(at, s, 4.0))),
    disturbance("100 Hz", |drive| rate(drive, 100.0)),
    disturbance("200 Hz", |drive| rate(drive, 200.0)),
    disturbance("1000 Hz", |drive| rate(drive, 1000.0)),
    disturbance("unsprung +1 %", |d| corners(d, |_, c| c.truth.unsprung_mass_factor = 1.01)),
    disturbance("unsprung -1 %", |d| corners(d, |_, c| c.truth.unsprung_mass_factor = 0.99)),
    disturbance("unsprung +3 %", |d| corners(d, |_, c| c.truth.unsprung_mass_factor = 1.03)),
    disturbance("unsprung -3 %", |d| corners(d, |_, c| c.truth.unsprung_mass_factor = 0.97)),
    disturbance("1 cm off", |drive| drive.with_rear_offset_m(0.01)),
];

const TOGETHER: Disturbance = disturbance("all together", together);

/// The disturbed punctures under the whole car; all together under both cars.
pub(super) fn drives() -> Result<Vec<(Drive, Option<f64>)>> {
    let mut drives = vec![];
    for km_h in SPEEDS_KM_H {
        for disturbance in &ALONE {
            let drive = Drive::puncture(Plant::Car, km_h)?;
            drives.push(((disturbance.change)(drive).named(disturbance.name), None));
        }
        for plant in Plant::ALL {
            let drive = Drive::puncture(plant, km_h)?.with_setups(&[Setup::USUAL, Setup::RESET]);
            drives.push(((TOGETHER.change)(drive).named(TOGETHER.name), None));
        }
    }
    Ok(drives)
}

fn corners(drive: Drive, edit: impl FnMut(Corner, &mut CornerSpec)) -> Drive {
    drive.each_corner(edit)
}

fn wheel_sensor(drive: Drive, mut edit: impl FnMut(Corner, &mut SensorSpec)) -> Drive {
    let usual = drive.scenario.sensor;
    drive.each_corner(|corner, spec| edit(corner, spec.wheel_sensor.get_or_insert(usual)))
}

fn fl_gain(at: Corner, sensor: &mut SensorSpec) {
    if at == Corner::FrontLeft {
        sensor.gain_error = 0.02;
    }
}

fn late(at: Corner, sensor: &mut SensorSpec, delay_ms: f64) {
    if at == Corner::FrontLeft {
        sensor.delay_ms = delay_ms;
    }
}

/// Quarter cars cannot turn.
fn bends(mut drive: Drive) -> Drive {
    if let Some(car) = &mut drive.scenario.car {
        car.lateral_points_s_m_s2 = BENDS_S_M_S2.to_vec();
    }
    drive
}

/// Grams at a rim of 0.3 m. The wheels of quarter cars do not turn.
fn imbalance(drive: Drive, kg_m: f64) -> Drive {
    let turning = drive.scenario.car.is_some();
    drive.each_corner(|_, spec| spec.truth.imbalance_kg_m = if turning { kg_m } else { 0.0 })
}

fn enveloping(drive: Drive, contact_m: f64) -> Drive {
    drive.with_scenario(|scenario| scenario.road.contact_length_m = contact_m)
}

fn rate(drive: Drive, rate_hz: f64) -> Drive {
    drive.with_scenario(|scenario| scenario.rate_hz = rate_hz)
}

fn short_wheelbase(drive: Drive) -> Drive {
    Drive { wheelbase_m: 0.99 * drive.wheelbase_m, ..drive }
}

/// Everything at once, to either side by corner, so that no two corners are wrong in the same way.
fn together(drive: Drive) -> Drive {
    let drive = enveloping(imbalance(bends(drive), 0.01), 0.1).with_rear_offset_m(0.01);
    let drive = wheel_sensor(drive, |corner, sensor| {
        let i = corner.index();
        sensor.gain_error = [0.015, -0.015, -0.01, 0.01][i];
        sensor.delay_ms = [2.0, 0.0, 1.0, 2.0][i];
    });
    let drive = drive.each_corner(|corner, spec| {
        let i = corner.index();
        let truth = &mut spec.truth;
        truth.sprung_mass_factor = [1.08, 1.04, 1.2, 1.15][i];
        truth.unsprung_mass_factor = [1.01, 0.99, 1.0, 1.01][i];
        truth.damping_factor = [0.8, 0.9, 1.2, 1.1][i];
        truth.spring_factor = [1.05, 0.95, 1.1, 0.95][i];
        truth.tire_stiffness_factor = [0.99, 1.01, 1.0, 0.99][i];
        truth.damper_asymmetry = 0.2;
        truth.tire_damping_n_s_per_m = 30.0;
        truth.friction_n = 10.0;
    });
    Drive { speed_factor: 1.01, ..drive }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every disturbance makes a drive that can be driven, under both cars, and no two rows have one name.
    #[test]
    fn disturbed_drives_are_sound_and_differ() {
        let mut names = vec![];
        for (drive, _) in drives().unwrap() {
            drive.scenario.validate().unwrap();
            drive.file_config().unwrap();
            names.push(drive.name);
        }
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
        let usual = Drive::puncture(Plant::Car, 80.0).unwrap();
        for disturbance in ALONE.iter().skip(1) {
            let changed = (disturbance.change)(usual.clone());
            let same_drive = changed.scenario == usual.scenario;
            let same_stated =
                (changed.speed_factor, changed.wheelbase_m) == (usual.speed_factor, usual.wheelbase_m);
            assert!(!(same_drive && same_stated), "{}", disturbance.name);
        }
    }
}
