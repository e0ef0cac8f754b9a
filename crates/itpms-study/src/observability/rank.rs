//! What the accelerations and all their derivatives fix, and what they leave free: the rank of the observability matrix
//! with the road as an unknown input (`docs/math/identifiability.md`, eq. 4-10).
//!
//! Called by the study. The unknowns are the states, the stiffnesses and the road with its derivatives at one instant;
//! the outputs are the accelerations with theirs. The matrix is the derivative of the latter by the former, exact (no
//! finite differences), in units that make all of them of order one.

use std::f64::consts::{FRAC_PI_2, TAU};

use itpms_core::estimate::CornerConfig;
use nalgebra::{Complex, DMatrix, DVector};
use rand::{RngExt as _, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::dual::Dual;
use crate::bound::transfers;

/// Derivatives of the outputs that are looked at; the rank stops changing at the second.
const ORDER: usize = 7;
/// Instants looked at.
const POINTS: u64 = 20;
/// Singular values below this share of the largest count as zero.
pub const TOLERANCE: f64 = 1e-10;
/// A direction of unit length that moves a stiffness by less than this does not move it.
const STILL: f64 = 1e-5;

/// What is known beside the accelerations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Known {
    Nothing,
    FirstStiffness,
    Road,
}

/// What becomes of the first wheel's stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stiffness {
    /// Nothing is said of it.
    Free,
    /// Only how much two stiffnesses differ.
    DifferenceOnly,
    /// It is fixed.
    Fixed,
    /// It was known beforehand.
    Known,
}

impl Stiffness {
    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Stiffness::Free => "free",
            Stiffness::DifferenceOnly => "difference only",
            Stiffness::Fixed => "fixed",
            Stiffness::Known => "known",
        }
    }
}

/// The rank in one case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RankCase {
    /// Who measures, and what is known.
    pub label: String,
    /// States, stiffnesses, road and its derivatives.
    pub unknowns: usize,
    /// Rank at every instant looked at.
    pub rank: usize,
    /// Directions of the unknowns no measurement sees.
    pub missing: usize,
    /// How many of them are body, wheel and road moving together (height and velocity): 0 to 2.
    pub drifts: usize,
    /// What becomes of the stiffness.
    pub stiffness: Stiffness,
    /// Smallest singular value kept, over the largest; the worst instant.
    pub smallest_kept: f64,
    /// Largest singular value taken for zero, over the largest; the worst instant; 0 where there is none.
    pub largest_dropped: f64,
    /// `|J v| / (|J| |v|)` for the exchange of stiffness for road, `v` of eq. 8; one wheel only.
    pub exchange_residual: Option<f64>,
}

/// A wheel in a case: its corner and its pressure in kPa.
type Wheel = (CornerConfig<f64>, f64);

/// All cases for a corner and the one behind it.
#[must_use]
pub(super) fn cases(front: &CornerConfig<f64>, rear: &CornerConfig<f64>) -> Vec<RankCase> {
    let full = front.placard_kpa;
    let low = 0.8 * full;
    let one = vec![(*front, full)];
    let alike = vec![(*front, full), (*front, full)];
    let after_loss = vec![(*front, low), (*front, full)];
    let unlike = vec![(*front, full), (*rear, rear.placard_kpa)];
    [
        ("one wheel, nothing known", &one, Known::Nothing),
        ("one wheel, its stiffness known", &one, Known::FirstStiffness),
        ("one wheel, the road known", &one, Known::Road),
        ("front and rear alike, same pressure", &alike, Known::Nothing),
        ("the same, pressures differ", &after_loss, Known::Nothing),
        ("the rear wheel another one", &unlike, Known::Nothing),
        ("repeated road, same pressure in both passes", &alike, Known::Nothing),
        ("the same, pressure lost between", &after_loss, Known::Nothing),
        ("the same, first pressure known (reset)", &after_loss, Known::FirstStiffness),
    ]
    .into_iter()
    .map(|(label, wheels, known)| case(label, wheels, known))
    .collect()
}

fn case(label: &str, wheels: &[Wheel], known: Known) -> RankCase {
    let mut found: Option<RankCase> = None;
    for seed in 0..POINTS {
        let here = at_point(label, wheels, known, ORDER, seed);
        found = Some(match found {
            None => here,
            Some(so_far) => worse(so_far, here),
        });
    }
    // POINTS is not zero.
    found.unwrap_or_else(|| at_point(label, wheels, known, ORDER, 0))
}

/// The less favorable of two instants in every respect.
fn worse(a: RankCase, b: RankCase) -> RankCase {
    let residual = match (a.exchange_residual, b.exchange_residual) {
        (Some(x), Some(y)) => Some(f64::max(x, y)),
        _ => None,
    };
    let smallest_kept = a.smallest_kept.min(b.smallest_kept);
    let largest_dropped = a.largest_dropped.max(b.largest_dropped);
    let base = if b.rank < a.rank { b } else { a };
    RankCase { smallest_kept, largest_dropped, exchange_residual: residual, ..base }
}

/// Where the unknowns stand in their vector.
struct Layout {
    wheels: usize,
    road_known: bool,
    order: usize,
}

impl Layout {
    fn stiffness(&self, wheel: usize) -> usize {
        4 * self.wheels + wheel
    }
    fn road(&self, derivative: usize) -> usize {
        5 * self.wheels + derivative
    }
    fn len(&self) -> usize {
        5 * self.wheels + if self.road_known { 0 } else { self.order + 1 }
    }
}

fn at_point(label: &str, wheels: &[Wheel], known: Known, order: usize, seed: u64) -> RankCase {
    let layout = Layout { wheels: wheels.len(), road_known: known == Known::Road, order };
    let motion = Motion::random(wheels, seed);
    let mut jacobian = motion.jacobian(wheels, &layout);
    if known == Known::FirstStiffness {
        // Known: its column asks for nothing.
        jacobian.column_mut(layout.stiffness(0)).fill(0.0);
    }
    let asked = layout.len() - usize::from(known == Known::FirstStiffness);
    // Wide enough for a full set of right singular vectors.
    let rows = jacobian.nrows().max(layout.len());
    let padded = jacobian.clone().resize_vertically(rows, 0.0);
    let svd = padded.svd(false, true);
    let values = &svd.singular_values;
    let largest = values.max();
    let rank = values.iter().filter(|&&v| v > TOLERANCE * largest).count();
    let over = |v: f64| v / largest;
    let kept = values.iter().copied().filter(|&v| v > TOLERANCE * largest).fold(f64::INFINITY, f64::min);
    let known_columns = usize::from(known == Known::FirstStiffness);
    let mut dropped: Vec<f64> = values.iter().copied().filter(|&v| !(v > TOLERANCE * largest)).collect();
    dropped.sort_by(f64::total_cmp);
    dropped.drain(..known_columns.min(dropped.len()));
    let null: Vec<DVector<f64>> = svd
        .v_t
        .iter()
        .flat_map(|v_t| {
            (0..values.len()).filter(|&i| !(values[i] > TOLERANCE * largest)).map(|i| v_t.row(i).transpose())
        })
        .collect();
    let size = jacobian.norm();
    let residual = |v: &DVector<f64>| (&jacobian * v).norm() / (size * v.norm());
    RankCase {
        label: label.to_owned(),
        unknowns: asked,
        rank,
        missing: asked - rank,
        drifts: motion.drifts(&layout).iter().filter(|v| residual(v) < TOLERANCE).count(),
        stiffness: stiffness(&null, &layout, known),
        smallest_kept: over(kept),
        largest_dropped: over(dropped.last().copied().unwrap_or(0.0)),
        exchange_residual: (wheels.len() == 1 && known == Known::Nothing)
            .then(|| residual(&motion.exchange(&layout))),
    }
}

fn stiffness(null: &[DVector<f64>], layout: &Layout, known: Known) -> Stiffness {
    // A reset is asked what becomes of the other wheel (the later pass).
    let asked = match (known, layout.wheels) {
        (Known::FirstStiffness, 1) => return Stiffness::Known,
        (Known::FirstStiffness, _) => layout.stiffness(1),
        _ => layout.stiffness(0),
    };
    let moves = |part: &dyn Fn(&DVector<f64>) -> f64| null.iter().any(|v| part(v).abs() > STILL);
    if !moves(&|v| v[asked]) {
        return Stiffness::Fixed;
    }
    if layout.wheels == 2 && !moves(&|v| v[layout.stiffness(0)] - v[layout.stiffness(1)]) {
        return Stiffness::DifferenceOnly;
    }
    Stiffness::Free
}

/// A steady motion over a road of six waves, looked at in one instant. Height in cm, time in `1 / omega`.
struct Motion {
    /// Radians per second that are one unit of inverse time: the first wheel's hop.
    omega: f64,
    /// Stiffness in N/m that is one unit: the first wheel's.
    unit_n_per_m: f64,
    /// Taylor coefficients of the road.
    road: Vec<f64>,
    /// Body height, its rate, wheel height, its rate, of each wheel.
    states: Vec<[f64; 4]>,
    /// Taylor coefficients of the first wheel's tire deflection `x_r - x_w`.
    deflection: Vec<f64>,
}

impl Motion {
    fn random(wheels: &[Wheel], seed: u64) -> Self {
        let (corner, pressure) = &wheels[0];
        let unit_n_per_m = corner.tire.stiffness_n_per_m(*pressure);
        let omega = (unit_n_per_m / corner.quarter_car.unsprung_mass_kg()).sqrt();
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut road = vec![0.0; ORDER + 1];
        let mut states = vec![[0.0; 4]; wheels.len()];
        let mut deflection = vec![0.0; ORDER + 1];
        for hz in [1.3, 3.1, 5.9, 9.7, 14.3, 22.1] {
            let amplitude = rng.random_range(0.5..1.5);
            let phase = rng.random_range(0.0..TAU);
            let w = TAU * hz;
            let wave = Complex::from_polar(amplitude, phase);
            let coefficient = |wave: Complex<f64>, j: usize| {
                let turned = wave * Complex::from_polar(1.0, FRAC_PI_2 * j as f64);
                turned.re * (w / omega).powi(j as i32) / factorial(j)
            };
            for (j, sum) in road.iter_mut().enumerate() {
                *sum += coefficient(wave, j);
            }
            for (i, (corner, pressure)) in wheels.iter().enumerate() {
                // Accelerations over -w² are heights.
                let heights = transfers(corner, hz, *pressure).0.map(|a| -a / (w * w) * wave);
                for j in 0..2 {
                    states[i][j] += coefficient(heights[0], j);
                    states[i][2 + j] += coefficient(heights[1], j);
                }
                if i == 0 {
                    for (j, sum) in deflection.iter_mut().enumerate() {
                        *sum += coefficient(wave - heights[1], j);
                    }
                }
            }
        }
        Self { omega, unit_n_per_m, road, states, deflection }
    }

    /// Derivative of all outputs' Taylor coefficients by all unknowns (eq. 6).
    fn jacobian(&self, wheels: &[Wheel], layout: &Layout) -> DMatrix<f64> {
        let n = layout.len();
        let road: Vec<Dual> = (0..=layout.order)
            .map(|j| match layout.road_known {
                true => Dual::constant(self.road[j], n),
                false => Dual::unknown(self.road[j], layout.road(j), n),
            })
            .collect();
        let mut rows = Vec::new();
        for (i, (corner, pressure)) in wheels.iter().enumerate() {
            let relative = corner.tire.stiffness_n_per_m(*pressure) / self.unit_n_per_m;
            let k_t = Dual::unknown(relative, layout.stiffness(i), n);
            let start = [0, 1, 2, 3].map(|s| Dual::unknown(self.states[i][s], 4 * i + s, n));
            rows.extend(self.outputs(corner, &start, &k_t, &road));
        }
        DMatrix::from_fn(rows.len(), n, |i, j| rows[i].gradient[j])
    }

    /// Taylor coefficients of both accelerations: those of the states follow one by one from eq. (1) of the paper.
    fn outputs(&self, corner: &CornerConfig<f64>, start: &[Dual; 4], k_t: &Dual, road: &[Dual]) -> Vec<Dual> {
        let car = &corner.quarter_car;
        let per_time = self.omega * self.omega;
        let (k_s, c_s) = (car.spring_n_per_m(), car.damping_n_s_per_m() * self.omega);
        let (m_b, m_w) = (car.sprung_mass_kg() * per_time, car.unsprung_mass_kg() * per_time);
        let [mut x_b, mut v_b, mut x_w, mut v_w] = start.clone();
        let mut outputs = Vec::new();
        for (j, x_r) in road.iter().enumerate() {
            let suspension = &(&(&x_w - &x_b) * k_s) + &(&(&v_w - &v_b) * c_s);
            let tire = &(k_t * &(x_r - &x_w)) * self.unit_n_per_m;
            let (a_b, a_w) = (&suspension * m_b.recip(), &(&tire - &suspension) * m_w.recip());
            let next = ((j + 1) as f64).recip();
            (x_b, x_w) = (&v_b * next, &v_w * next);
            (v_b, v_w) = (&a_b * next, &a_w * next);
            outputs.extend([a_b, a_w]);
        }
        outputs
    }

    /// Body, wheel and road lifted together, and set off together (eq. 9).
    fn drifts(&self, layout: &Layout) -> Vec<DVector<f64>> {
        if layout.road_known {
            return Vec::new();
        }
        (0..2)
            .map(|derivative| {
                let mut v = DVector::zeros(layout.len());
                for wheel in 0..layout.wheels {
                    v[4 * wheel + derivative] = 1.0;
                    v[4 * wheel + 2 + derivative] = 1.0;
                }
                v[layout.road(derivative)] = 1.0;
                v
            })
            .collect()
    }

    /// A stiffer tire on a road nearer to the wheel (eq. 8).
    fn exchange(&self, layout: &Layout) -> DVector<f64> {
        let mut v = DVector::zeros(layout.len());
        v[layout.stiffness(0)] = 1.0;
        for j in 0..=layout.order {
            v[layout.road(j)] = -self.deflection[j];
        }
        v
    }
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::quarter_car::QuarterCar;

    fn rear() -> CornerConfig<f64> {
        CornerConfig {
            quarter_car: QuarterCar::new(216.0, 50.0, 925.8, 29_114.0).unwrap(),
            ..CornerConfig::paper()
        }
    }

    #[test]
    fn ranks_are_those_of_the_derivation() {
        // missing directions, drifts among them, and the stiffness: counted by hand in section 2 of the page.
        use Stiffness::{DifferenceOnly, Fixed, Free, Known};
        let expected = [
            (3, 2, Free),
            (2, 2, Known),
            (0, 0, Fixed),
            (3, 2, DifferenceOnly),
            (2, 2, Fixed),
            (2, 2, Fixed),
            (3, 2, DifferenceOnly),
            (2, 2, Fixed),
            (2, 2, Fixed),
        ];
        let found = cases(&CornerConfig::paper(), &rear());
        assert_eq!(found.len(), expected.len());
        for (case, (missing, drifts, stiffness)) in found.iter().zip(expected) {
            assert_eq!(
                (case.missing, case.drifts, case.stiffness),
                (missing, drifts, stiffness),
                "{case:#?}"
            );
            // A clear gap between what counts and what does not.
            assert!(case.smallest_kept > 1e3 * case.largest_dropped.max(1e-16), "{case:#?}");
        }
        assert!(found[0].exchange_residual.unwrap() < 1e-14);
    }

    #[test]
    fn derivatives_of_the_outputs_are_those_of_the_motion() {
        // The Taylor coefficients from the states must be those of the sum of waves: accelerations known in closed form.
        let wheels = [(CornerConfig::paper(), 200.0)];
        let layout = Layout { wheels: 1, road_known: true, order: ORDER };
        let motion = Motion::random(&wheels, 3);
        let n = layout.len();
        let road: Vec<Dual> = motion.road.iter().map(|&u| Dual::constant(u, n)).collect();
        let start = motion.states[0].map(|s| Dual::constant(s, n));
        let found = motion.outputs(&wheels[0].0, &start, &Dual::constant(1.0, n), &road);
        // x_w'' from the deflection: x_w = x_r - deflection, coefficient j+2 times (j+2)(j+1).
        for j in 0..=ORDER - 2 {
            let wheel = (motion.road[j + 2] - motion.deflection[j + 2]) * ((j + 2) * (j + 1)) as f64;
            let value = found[2 * j + 1].value;
            assert!((value - wheel).abs() < 1e-12 * (1.0 + wheel.abs()), "{j}: {value} {wheel}");
        }
    }

    #[test]
    fn the_gradient_is_the_finite_difference() {
        let wheels = [(CornerConfig::paper(), 200.0)];
        let layout = Layout { wheels: 1, road_known: false, order: ORDER };
        let motion = Motion::random(&wheels, 5);
        let jacobian = motion.jacobian(&wheels, &layout);
        let n = layout.len();
        let values = |k_t: f64| -> Vec<f64> {
            let road: Vec<Dual> = motion.road.iter().map(|&u| Dual::constant(u, n)).collect();
            let start = motion.states[0].map(|s| Dual::constant(s, n));
            let outputs = motion.outputs(&wheels[0].0, &start, &Dual::constant(k_t, n), &road);
            outputs.iter().map(|dual| dual.value).collect()
        };
        let (up, down) = (values(1.0 + 1e-5), values(1.0 - 1e-5));
        for (row, (up, down)) in up.iter().zip(down).enumerate() {
            let difference = (up - down) / 2e-5;
            let found = jacobian[(row, layout.stiffness(0))];
            assert!((found - difference).abs() < 1e-7 * (1.0 + found.abs()), "{row}: {found} {difference}");
        }
    }
}
