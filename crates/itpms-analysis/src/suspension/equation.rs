//! The body's equation of motion, linear in the signals: what each of them counts in what is left of each corner's acceleration
//! (docs/math/dampers.md, eq. 1 to 4).

use itpms_data::reference::FRICTION_ELEMENTS;
use nalgebra::{Complex, SMatrix, SVector};

use super::car_body::CarBody;
use super::signals::{BODY, FRICTION, SIGNALS, SIZE, SQUARE, VELOCITY, WAY, WHEEL};
use super::spectra::ALL;

/// Unknowns. Logarithm of the mass over the file's; share of the rear axle; offset to the left; logarithms of the inertias; warp; dampers over
/// the file's; logarithms of the springs over the file's; bars over the springs of the file; lateness in ms; asymmetry and knee (per m/s)
/// over the file's damping; slip forces in [`FORCE_N`].
pub(super) const MASS: usize = 0;
pub(super) const REAR: usize = 1;
pub(super) const LEFT: usize = 2;
pub(super) const PITCH: usize = 3;
pub(super) const ROLL: usize = 4;
pub(super) const WARP: usize = 5;
pub(super) const DAMPER: usize = 6;
pub(super) const SPRING: usize = 10;
pub(super) const BAR: usize = 14;
pub(super) const LATE: usize = 16;
pub(super) const ASYMMETRY: usize = 20;
pub(super) const KNEE: usize = 24;
pub(super) const SLIP: usize = 28;
pub(super) const UNKNOWNS: usize = SLIP + 4 * FRICTION_ELEMENTS;
pub(super) const FORCE_N: f64 = 60.0;
pub(super) const LATE_S: f64 = 1e-3;

pub(super) type Parameters = SVector<f64, UNKNOWNS>;
/// What each signal counts in the residual of each corner.
pub(super) type Weights = SMatrix<Complex<f64>, ALL, 4>;

/// Where an element's slip force of a corner stands.
pub(super) fn slip(corner: usize, element: usize) -> usize {
    SLIP + corner * FRICTION_ELEMENTS + element
}

/// Acceleration in m/s² of each corner for a newton at every other (eq. 2).
pub(super) fn compliance(car: &CarBody, p: &Parameters) -> SMatrix<f64, 4, 4> {
    let per_kg = (-p[MASS]).exp() / car.sprung_mass_kg();
    let x = [p[REAR], p[REAR], p[REAR] - 1.0, p[REAR] - 1.0];
    let y = [1.0 - p[LEFT], -1.0 - p[LEFT], 1.0 - p[LEFT], -1.0 - p[LEFT]];
    let warp = [1.0, -1.0, -1.0, 1.0];
    let (pitch, roll) = ((-p[PITCH]).exp(), (-p[ROLL]).exp());
    SMatrix::from_fn(|i, j| {
        per_kg * (1.0 + x[i] * x[j] * pitch + y[i] * y[j] * roll + warp[i] * warp[j] * p[WARP])
    })
}

/// What each signal counts in the force of a corner's strut (eq. 3), at an angular frequency.
fn force(car: &CarBody, p: &Parameters, corner: usize, omega: f64) -> SVector<Complex<f64>, ALL> {
    let s = Complex::new(0.0, omega);
    let (damping, spring) =
        (car.damping_n_s_per_m[corner], car.spring_n_per_m[corner] * p[SPRING + corner].exp());
    let axle = corner / 2;
    let bar = p[BAR + axle] * car.axle_spring_n_per_m(axle);
    let mut weights = SVector::zeros();
    // What the wheel's sensor tells late is advanced: of the deflection it is the wheel's part, of what is made of its rate all.
    let advance = |corner: usize| (s * (p[LATE + corner] * LATE_S)).exp();
    let mut deflection = |corner: usize, n_per_m: f64, n_s_per_m: f64| {
        let late = (advance(corner) - 1.0) / s;
        let at = corner * SIGNALS;
        weights[at + VELOCITY] += Complex::new(n_s_per_m, 0.0);
        weights[at + WAY] += Complex::new(n_per_m, 0.0);
        weights[at + WHEEL] += late * n_s_per_m + late / s * n_per_m;
    };
    deflection(corner, spring + bar, damping * p[DAMPER + corner]);
    deflection(corner ^ 1, -bar, 0.0);
    let (at, advance) = (corner * SIGNALS, advance(corner));
    weights[at + SIZE] += advance * (damping * p[ASYMMETRY + corner]);
    weights[at + SQUARE] += advance * (damping * p[KNEE + corner]);
    for element in 0..FRICTION_ELEMENTS {
        weights[at + FRICTION + element] += advance * (FORCE_N * p[slip(corner, element)]);
    }
    weights
}

/// What each signal counts in what is left of each corner's acceleration (eq. 4).
pub(super) fn residual(car: &CarBody, p: &Parameters, omega: f64) -> Weights {
    let g = compliance(car, p);
    let forces: [_; 4] = std::array::from_fn(|corner| force(car, p, corner, omega));
    let mut weights = Weights::zeros();
    for row in 0..4 {
        let mut column = weights.column_mut(row);
        for (corner, force) in forces.iter().enumerate() {
            column.axpy(Complex::new(-g[(row, corner)], 0.0), force, Complex::new(1.0, 0.0));
        }
        column[row * SIGNALS + BODY] += Complex::new(1.0, 0.0);
    }
    weights
}
