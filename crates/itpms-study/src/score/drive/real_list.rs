//! The ways in which the cars of the score's part `car` are not their files.
//!
//! Called by that part. Sizes are those of cars one can buy, or worse.

use itpms_core::model::Corner;
use itpms_sim::plant::Deviations;

use super::Drive;

/// One way in which a car is not its file.
#[derive(Debug)]
pub(super) struct Deviation {
    pub(super) name: &'static str,
    /// The car of a seed.
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
    steady("unsprung front -5, rear +5 %", |drive, _| {
        truth(drive, |c, t| t.unsprung_mass_factor = by_axle(c))
    }),
    steady("tire damping 90 N s/m", |drive, _| truth(drive, |_, t| t.tire_damping_n_s_per_m = 90.0)),
];

fn truth(drive: Drive, mut edit: impl FnMut(Corner, &mut Deviations)) -> Drive {
    drive.each_corner(|corner, spec| edit(corner, &mut spec.truth))
}

fn by_axle(corner: Corner) -> f64 {
    if is_rear(corner) { 1.05 } else { 0.95 }
}

fn is_rear(corner: Corner) -> bool {
    matches!(corner, Corner::RearLeft | Corner::RearRight)
}
