//! The body's equation of motion, linear in the signals: what each of them counts in what is left of each corner's acceleration
//! (docs/math/dampers.md, eq. 1 to 4).

use itpms_data::reference::FRICTION_ELEMENTS;
use nalgebra::{Complex, SMatrix, SVector};

use super::car_body::CarBody;
use super::signals::{FRICTION, SIGNALS, SIZE, SQUARE, VELOCITY, WAY, WHEEL};
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
/// A sum of a few signals: the place of each, and its weight.
pub(super) type Sparse = Vec<(usize, Complex<f64>)>;

/// Where an element's slip force of a corner stands.
pub(super) fn slip(corner: usize, element: usize) -> usize {
    SLIP + corner * FRICTION_ELEMENTS + element
}

/// Acceleration in m/s² of each corner for a newton at every other (eq. 2), and its derivatives by the parameters from [`MASS`] to [`WARP`].
pub(super) fn compliance(
    car: &CarBody,
    p: &Parameters,
) -> (SMatrix<f64, 4, 4>, [SMatrix<f64, 4, 4>; DAMPER]) {
    let per_kg = (-p[MASS]).exp() / car.sprung_mass_kg();
    let x = [p[REAR], p[REAR], p[REAR] - 1.0, p[REAR] - 1.0];
    let y = [1.0 - p[LEFT], -1.0 - p[LEFT], 1.0 - p[LEFT], -1.0 - p[LEFT]];
    let warp = [1.0, -1.0, -1.0, 1.0];
    let (pitch, roll) = ((-p[PITCH]).exp(), (-p[ROLL]).exp());
    let matrix = |of: &dyn Fn(usize, usize) -> f64| SMatrix::from_fn(|i, j| per_kg * of(i, j));
    let g = matrix(&|i, j| 1.0 + x[i] * x[j] * pitch + y[i] * y[j] * roll + warp[i] * warp[j] * p[WARP]);
    let slopes = [
        -g,
        matrix(&|i, j| (x[i] + x[j]) * pitch),
        matrix(&|i, j| -(y[i] + y[j]) * roll),
        matrix(&|i, j| -x[i] * x[j] * pitch),
        matrix(&|i, j| -y[i] * y[j] * roll),
        matrix(&|i, j| warp[i] * warp[j]),
    ];
    (g, slopes)
}

/// The force of a strut (eq. 3) at an angular frequency, and its derivatives by its parameters.
pub(super) struct Strut {
    pub(super) force: Sparse,
    pub(super) slopes: Vec<(usize, Sparse)>,
}

impl Strut {
    pub(super) fn new(car: &CarBody, p: &Parameters, corner: usize, omega: f64) -> Self {
        let s = Complex::new(0.0, omega);
        let real = |value: f64| Complex::new(value, 0.0);
        // A late wheel sensor is advanced: of the deflection the wheel's part, of the signals made of its rate all.
        let advance = |corner: usize| (s * (p[LATE + corner] * LATE_S)).exp();
        let deflection = |corner: usize, n_per_m: f64| {
            let late = (advance(corner) - 1.0) / s;
            [(corner * SIGNALS + WAY, real(n_per_m)), (corner * SIGNALS + WHEEL, late / s * n_per_m)]
        };
        let (axle, other, at) = (corner / 2, corner ^ 1, corner * SIGNALS);
        let damping = car.damping_n_s_per_m[corner];
        let spring = car.spring_n_per_m[corner] * p[SPRING + corner].exp();
        let bar = car.axle_spring_n_per_m(axle);
        let (now, late) = (advance(corner), (advance(corner) - 1.0) / s);
        let mut slopes = vec![
            (DAMPER + corner, vec![(at + VELOCITY, real(damping)), (at + WHEEL, late * damping)]),
            (SPRING + corner, deflection(corner, spring).to_vec()),
            (BAR + axle, [deflection(corner, bar), deflection(other, -bar)].concat()),
            (ASYMMETRY + corner, vec![(at + SIZE, now * damping)]),
            (KNEE + corner, vec![(at + SQUARE, now * damping)]),
        ];
        let element = |element| (slip(corner, element), vec![(at + FRICTION + element, now * FORCE_N)]);
        slopes.extend((0..FRICTION_ELEMENTS).map(element));
        // The force is linear in all of these but the logarithm of the spring; an advanced signal's derivative is s times it.
        let mut force = [real(0.0); ALL];
        for (i, weights) in &slopes {
            let value = if *i == SPRING + corner { 1.0 } else { p[*i] };
            weights.iter().for_each(|(signal, weight)| force[*signal] += weight * value);
        }
        let n_s_per_m = real(damping * p[DAMPER + corner]) + (spring + bar * p[BAR + axle]) / s;
        let mut of_late = vec![(at + WHEEL, now * n_s_per_m * LATE_S)];
        of_late.extend((SIZE..SIGNALS).map(|signal| (at + signal, force[at + signal] * s * LATE_S)));
        let of_other = advance(other) / s * (-bar * p[BAR + axle] * LATE_S);
        slopes.push((LATE + corner, of_late));
        slopes.push((LATE + other, vec![(other * SIGNALS + WHEEL, of_other)]));
        let force = force.into_iter().enumerate().filter(|(_, weight)| *weight != real(0.0)).collect();
        Self { force, slopes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let car = CarBody {
            sprung_mass_kg: [330.0, 330.0, 270.0, 280.0],
            unsprung_mass_kg: [40.0; 4],
            damping_n_s_per_m: [1500.0, 1600.0, 1300.0, 1200.0],
            spring_n_per_m: [24e3, 23e3, 22e3, 21e3],
            spring_stiffening_per_m: 0.0,
            accel_noise_m_s2: [0.0; 4],
            tire_n_per_m: [220e3; 4],
            tire_damping_n_s_per_m: [50.0; 4],
        };
        let p = Parameters::from_fn(|i, _| 0.3 + 0.05 * (i as f64).sin());
        const STEP: f64 = 1e-5;
        let moved = |i: usize, by: f64| {
            let mut p = p;
            p[i] += by;
            p
        };
        let (_, slopes) = compliance(&car, &p);
        for (i, slope) in slopes.into_iter().enumerate() {
            let [more, less] = [STEP, -STEP].map(|by| compliance(&car, &moved(i, by)).0);
            // A difference's own error goes as the square of the step; numbers are some 1e-3.
            assert!(((more - less) / (2.0 * STEP) - slope).norm() < 1e-9, "{i}");
        }
        for corner in 0..4 {
            let dense = |weights: Sparse| {
                let mut all = SVector::<Complex<f64>, ALL>::zeros();
                weights.into_iter().for_each(|(signal, weight)| all[signal] += weight);
                all
            };
            let force = |p: &Parameters| dense(Strut::new(&car, p, corner, 20.0).force);
            let slopes = Strut::new(&car, &p, corner, 20.0).slopes;
            for i in DAMPER..UNKNOWNS {
                let own = slopes.iter().find(|(known, _)| *known == i).map(|(_, slope)| slope.clone());
                let [more, less] = [STEP, -STEP].map(|by| force(&moved(i, by)));
                let difference = (more - less) / Complex::new(2.0 * STEP, 0.0);
                // Weights reach 2e4.
                assert!((difference - dense(own.unwrap_or_default())).norm() < 1e-4, "{corner} {i}");
            }
        }
    }
}
