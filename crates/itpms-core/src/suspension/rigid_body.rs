//! How a force at one corner accelerates the body at another: a rigid body heaves, pitches and rolls; one that twists, up to four corners
//! that move each for itself, warps, too (docs/math/unknown-car.md, eq. 3).

use nalgebra::SMatrix;

use crate::memory::Blank;
use crate::model::{Corner, Side};
use crate::real::Real;

/// Radii of gyration squared, over the product of the distances to the axles, and over half of the track squared: what is usual for
/// cars (Genta, Morello: The Automotive Chassis, 2009).
const PITCH: f64 = 0.95;
const ROLL: f64 = 0.65;

/// Ways in which the body moves: heave, pitch, roll, warp.
pub(super) const MODES: usize = 4;

/// Acceleration of every corner in m/s² for a newton at every other, at nominal masses.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RigidBody<T: Real> {
    /// Sprung masses in kg, and which there are.
    mass_kg: [T; 4],
    present: [bool; 4],
}

impl<T: Real> RigidBody<T> {
    pub(super) fn new(mass_kg: [Option<T>; 4]) -> Self {
        Self {
            mass_kg: mass_kg.map(|mass| mass.unwrap_or(T::one())),
            present: mass_kg.map(|mass| mass.is_some()),
        }
    }

    pub(super) fn has(&self, corner: Corner) -> bool {
        self.present[corner]
    }

    /// Whether all four corners carry one body: fewer are taken each for itself.
    pub(super) fn is_whole(&self) -> bool {
        self.present == [true; 4]
    }

    /// The parts of `g` in 1/kg that go with mass, pitch and roll inertia, and that of the warp, by which a body that twists freely
    /// would have four corners of their own.
    pub(super) fn parts(&self) -> [SMatrix<T, 4, 4>; MODES] {
        let m = &self.mass_kg;
        if !self.is_whole() {
            let own = |i: usize| if self.present[i] { T::one() / m[i] } else { T::zero() };
            let own = SMatrix::from_fn(|i, j| if i == j { own(i) } else { T::zero() });
            return [own, SMatrix::zeros(), SMatrix::zeros(), SMatrix::zeros()];
        }
        let (front, rear) = (m[0] + m[1], m[2] + m[3]);
        let total = front + rear;
        // Distances of the axles from the center of gravity, over the wheelbase.
        let x = [rear / total, rear / total, -front / total, -front / total];
        let side = |i: usize| if Corner::ALL[i].side() == Side::Left { T::one() } else { -T::one() };
        let pitch = front * rear / total * T::lit(PITCH);
        let roll = total * T::lit(ROLL);
        [
            SMatrix::repeat(T::one() / total),
            SMatrix::from_fn(|i, j| x[i] * x[j] / pitch),
            SMatrix::from_fn(|i, j| side(i) * side(j) / roll),
            SMatrix::from_fn(
                |i, j| if (i == j) || (i + j == 3) { T::one() / total } else { -T::one() / total },
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_in_proportion_to_the_masses_lift_the_body_without_turning_it() {
        let body = RigidBody::new([Some(240.0), Some(240.0), Some(200.0), Some(200.0)]);
        let [mass, pitch, roll, _] = body.parts();
        let force = nalgebra::SVector::<f64, 4>::new(240.0, 240.0, 200.0, 200.0);
        // One m/s² at every corner.
        let lifted = (mass + pitch + roll) * force;
        assert!(lifted.iter().all(|a| (a - 1.0).abs() < 1e-12), "{lifted}");
    }

    #[test]
    fn with_the_inertias_of_four_separate_masses_a_corner_moves_alone() {
        // Radii of gyration for which pitch and roll of the body are those of four masses at the corners: 1 and 1.
        let body = RigidBody::new([Some(220.0); 4]);
        let [mass, pitch, roll, warp] = body.parts();
        let g = mass + pitch * PITCH + roll * ROLL + warp;
        for i in 0..4 {
            for j in 0..4 {
                let own = if i == j { 1.0 / 220.0 } else { 0.0 };
                assert!((g[(i, j)] - own).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_corner_by_itself_is_a_mass() {
        let [own, pitch, roll, warp] = RigidBody::new([Some(250.0), None, None, None]).parts();
        assert!((own[(0, 0)] - 0.004f64).abs() < 1e-12 && own[(1, 1)] == 0.0);
        assert_eq!([pitch, roll, warp], [SMatrix::<f64, 4, 4>::zeros(); 3]);
    }
}
