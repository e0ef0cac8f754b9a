//! The ways in which the cars of the score's part `car` are not their files.
//!
//! Called by that part. Sizes are those of cars and roads one meets, or worse.

use itpms_core::model::Corner;
use itpms_sim::car::PayloadSpec;
use itpms_sim::plant::{Bending, Deviations};
use itpms_sim::road::{RoadSpec, Sleepers, Tracks, Washboard};
use itpms_sim::scenario::ToleranceSpec;
use itpms_sim::time_profile::Pressure;

use super::Drive;

/// One way in which a car is not its file.
#[derive(Debug)]
pub(super) struct Deviation {
    pub(super) name: &'static str,
    pub(super) change: fn(Drive, u64) -> Drive,
    /// The tire that is flat from the start, if one is.
    pub(super) flat: Option<Corner>,
}

const fn steady(name: &'static str, change: fn(Drive, u64) -> Drive) -> Deviation {
    Deviation { name, change, flat: None }
}

pub(super) const LIST: &[Deviation] = &[
    steady("as its file", |drive, _| drive),
    steady("friction 20 N", |drive, _| truth(drive, |_, t| t.friction_n = 20.0)),
    steady("friction 60 N", |drive, _| truth(drive, |_, t| t.friction_n = 60.0)),
    steady("friction 100 N", |drive, _| truth(drive, |_, t| t.friction_n = 100.0)),
    steady("unsprung +5 %", |drive, _| truth(drive, |_, t| t.unsprung_mass_factor = 1.05)),
    steady("unsprung -5 %", |drive, _| truth(drive, |_, t| t.unsprung_mass_factor = 0.95)),
    steady("unsprung front -5, rear +5 %", |drive, _| truth(drive, by_axle)),
    steady("tire damping 90 N s/m", |drive, _| truth(drive, |_, t| t.tire_damping_n_s_per_m = 90.0)),
    steady("top mounts 300 N/mm", |drive, _| truth(drive, |_, t| t.damper_mount_n_per_m = 3e5)),
    steady("hop dampers rear", |drive, _| truth(drive, hop_damper)),
    steady("body twists at 22 Hz", |drive, _| twisting(drive)),
    steady("sensors tilted 5 deg", |drive, _| tilted(drive, 5.0)),
    steady("soft ground 5 kN/mm", |drive, _| road(drive, |road| road.ground_n_per_m = Some(5e6))),
    steady("washboard 1 m, 2 mm", |drive, _| road(drive, |road| road.washboard.push(waves()))),
    steady("joints every 5 m, 5 mm", |drive, _| road(drive, |road| road.sleepers.push(joints()))),
    steady("all together", |drive, _| together(drive)),
    steady("drawn as typical", drawn),
    Deviation { name: "fl flat on its rim", change: |drive, _| on_rim(drive), flat: Some(Corner::FrontLeft) },
];

fn truth(drive: Drive, mut edit: impl FnMut(Corner, &mut Deviations)) -> Drive {
    drive.each_corner(|corner, spec| edit(corner, &mut spec.truth))
}

fn road(drive: Drive, edit: impl FnOnce(&mut RoadSpec)) -> Drive {
    drive.with_scenario(|scenario| edit(&mut scenario.road))
}

fn is_rear(corner: Corner) -> bool {
    matches!(corner, Corner::RearLeft | Corner::RearRight)
}

fn by_axle(corner: Corner, truth: &mut Deviations) {
    truth.unsprung_mass_factor = if is_rear(corner) { 1.05 } else { 0.95 };
}

/// As heavy as those of a family car, tuned to the rear wheels' hop.
fn hop_damper(corner: Corner, truth: &mut Deviations) {
    if is_rear(corner) {
        truth.hop_damper_kg = 4.0;
        truth.hop_damper_hz = 11.5;
    }
}

/// With a modal mass of 300 kg for a unit at each corner, 22 Hz is a torsional stiffness of some 15 kN m per degree.
fn twisting(mut drive: Drive) -> Drive {
    if let Some(car) = &mut drive.scenario.car {
        let participation = [1.0, -1.0, -1.0, 1.0];
        car.bending =
            Some(Bending { frequency_hz: 22.0, damping_ratio: 0.03, modal_mass_kg: 300.0, participation });
    }
    drive
}

fn tilted(drive: Drive, tilt_deg: f64) -> Drive {
    drive.with_scenario(|scenario| scenario.sensor.tilt_deg = tilt_deg)
}

fn waves() -> Washboard {
    Washboard { wavelength_m: 1.0, amplitude_m: 0.002, from_m: -1e6, to_m: 1e6, tracks: Tracks::Both }
}

fn joints() -> Sleepers {
    Sleepers {
        spacing_m: 5.0,
        length_m: 0.15,
        height_m: -0.005,
        edge_m: 0.05,
        from_m: -1e6,
        to_m: 1e6,
        tracks: Tracks::Both,
    }
}

fn together(drive: Drive) -> Drive {
    let drive = tilted(twisting(drive), 5.0);
    let drive = truth(drive, |corner, truth| {
        truth.friction_n = [40.0, 60.0, 80.0, 60.0][corner.index()];
        truth.tire_damping_n_s_per_m = 90.0;
        truth.damper_mount_n_per_m = 3e5;
        by_axle(corner, truth);
        hop_damper(corner, truth);
    });
    road(drive, |road| {
        road.ground_n_per_m = Some(5e6);
        road.washboard.push(waves());
        road.sleepers.push(joints());
    })
}

/// In front and behind, in kg.
pub(super) fn two_passengers() -> Vec<PayloadSpec> {
    [[1.3, -0.36], [2.15, 0.36]].map(|place_m| PayloadSpec::constant(place_m, 75.0)).to_vec()
}

/// A car as cars of `drive-normal` are drawn, with two passengers on every other drive.
fn drawn(mut drive: Drive, seed: u64) -> Drive {
    ToleranceSpec::typical().apply(seed, &mut drive.scenario);
    if let Some(car) = drive.scenario.car.as_mut().filter(|_| seed.is_multiple_of(2)) {
        car.payload = two_passengers();
    }
    drive
}

/// No pressure, and the rim 3 cm off the road would bear on it: the wheel's 2.9 kN need 4.8 cm of rubber alone.
fn on_rim(drive: Drive) -> Drive {
    drive.each_corner(|corner, spec| {
        if corner == Corner::FrontLeft {
            spec.pressure = Pressure::ConstantKpa(0.0);
            spec.truth.rim_deflection_m = 0.03;
        }
    })
}
