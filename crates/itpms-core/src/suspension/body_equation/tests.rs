// Where another crate of the build brings `std`, numbers have these functions by themselves.
#[allow(unused_imports)]
use nalgebra::ComplexField;

use super::*;
use crate::memory::configured;
use crate::random::Random;
use crate::spectrum::Frame;

const SPRUNG_KG: f64 = 240.8;
const DAMPING: f64 = 925.8;
const STIFFNESS: f64 = 29_114.0;

fn equation(corners: usize) -> BodyEquation<f64> {
    let mut corner = CornerConfig::paper().with_accel_noise(1e-3).unwrap();
    // A file that knows nothing of friction.
    (corner.uncertainty.friction_n, corner.uncertainty.friction_sd_n) = (0.0, 50.0);
    let corners = core::array::from_fn(|i| (i < corners).then_some(corner));
    configured(|equation: &mut BodyEquation<f64>| equation.configure(&corners, 500.0))
}

fn complex(random: &mut Random) -> Complex<f64> {
    Complex::new(random.normal(), random.normal())
}

/// Frames in which every strut moves by itself and the body of mass 4 m as `g` and the struts' forces say: dampers 10 % harder than
/// the file, bars of 0.3 and 0.12 springs, slip forces as given, and as much noise of the body as `noise` says of its own motion.
fn learn(equation: &mut BodyEquation<f64>, g: SMatrix<f64, 4, 4>, slip_n: [f64; ELEMENTS], noise: f64) {
    learn_late(equation, g, slip_n, noise, [0.0; 4]);
}

/// The same with wheels' sensors that are late, in s, and bodies that move a tenth as much as their wheels.
fn learn_late(
    equation: &mut BodyEquation<f64>,
    g: SMatrix<f64, 4, 4>,
    slip_n: [f64; ELEMENTS],
    noise: f64,
    late_s: [f64; 4],
) {
    let mut random = Random(5);
    let corners = Corner::ALL.into_iter().filter(|&corner| equation.body.has(corner)).count();
    for step in 1..=300 {
        let mut frames: [StrutFrame<f64>; 4] =
            core::array::from_fn(|_| StrutFrame { time_s: 0.2 * f64::from(step), spectra: Frame::zero() });
        for bin in 0..BINS {
            let s = Complex::new(0.0, core::f64::consts::TAU * (bin + 1) as f64 * FRICTION_SPACING_HZ);
            let velocity: [_; 4] = core::array::from_fn(|_| complex(&mut random) * 0.05);
            // Elements that follow the motion, and as much that does not.
            let elements: [[_; ELEMENTS]; 4] = core::array::from_fn(|i| {
                core::array::from_fn(|_| velocity[i] * 60.0 + complex(&mut random) * 3.0)
            });
            let force = |i: usize| {
                let bar = if corners == 4 { [0.3, 0.12][i / 2] } else { 0.0 };
                let friction = elements[i].iter().zip(slip_n).fold(s * 0.0, |sum, (&e, f)| sum + e * f);
                s * velocity[i] * (1.1 * DAMPING)
                    + velocity[i] * STIFFNESS
                    + (velocity[i] - velocity[i ^ 1]) * (STIFFNESS * bar)
                    + friction
            };
            let forces: [_; 4] = core::array::from_fn(force);
            for row in 0..4 {
                let body = (0..4).fold(s * 0.0, |sum, j| sum + forces[j] * g[(row, j)]);
                let body = body + complex(&mut random) * (noise * body.norm_sqr().sqrt() / 2f64.sqrt());
                // The delay is exp(-s τ), exactly; the wheel moves as the strut and a tenth more.
                let late = (s * -late_s[row]).exp();
                let wheel = s * s * velocity[row] * 1.1;
                let lag = wheel * (late - 1.0);
                let all = [
                    (BODY, body),
                    (ACCELERATION, s * velocity[row] + lag / s),
                    (VELOCITY, velocity[row] + lag / (s * s)),
                    (WHEEL, wheel * late),
                ];
                let set = |(signal, value): (usize, Complex<f64>)| {
                    frames[row].spectra.re[(bin, signal)] = value.re;
                    frames[row].spectra.im[(bin, signal)] = value.im;
                };
                let elements =
                    elements[row].iter().enumerate().map(|(e, &value)| (FRICTION + e, value * late));
                all.into_iter().chain(elements).for_each(set);
            }
        }
        let mut learn = || equation.learn(frames.each_ref().map(Some));
        // Bin by bin, how well friction is known, then the fit.
        assert!((0..=BINS).all(|_| learn() == Learning::UnderWay));
        assert!((0..PASSES).any(|_| learn() == Learning::Complete));
        assert_eq!(learn(), Learning::Idle, "the same frames again");
    }
}

#[test]
fn four_struts_under_one_body_are_distinguished() {
    let mut equation = equation(4);
    let [mass, pitch, roll, _] = equation.body.parts();
    // Another pitch inertia than the guessed one, and forces of three elements.
    let slip_n = [20.0, 0.0, 45.0];
    learn(&mut equation, mass + pitch * 1.15 + roll * 0.9, slip_n, 0.0);
    for corner in Corner::ALL {
        for (found, slip_n) in equation.slip_forces_n(corner).into_iter().zip(slip_n) {
            assert!((found - slip_n).abs() < 1.5, "{corner:?}: {found} {slip_n}");
        }
        assert!((equation.parameters[DAMPER + corner.index()].exp() - 1.1).abs() < 0.02);
        assert!(equation.unexplained(corner).unwrap() < 1e-3);
        // A newton of the strut at its own corner, and a bar that the other wheel of the axle holds.
        let (found, i) = (equation.quarter_car(corner, 40.0), corner.index());
        let own = mass[(i, i)] + pitch[(i, i)] * 1.15 + roll[(i, i)] * 0.9;
        assert!((found.sprung_mass_kg * own - 1.0).abs() < 0.03, "{found:?}");
        let with_bar = STIFFNESS * (1.0 + [0.3, 0.12][corner.axle()]);
        assert!((found.spring_n_per_m / with_bar - 1.0).abs() < 0.03, "{found:?}");
    }
    assert!(
        (equation.parameters[BAR] - 0.3).abs() < 0.02 && (equation.parameters[BAR + 1] - 0.12).abs() < 0.02
    );
}

#[test]
fn four_corners_that_move_each_for_itself_are_a_body_that_warps() {
    let mut equation = equation(4);
    let own = SMatrix::from_diagonal_element(1.0 / SPRUNG_KG);
    learn(&mut equation, own, [0.0, 40.0, 0.0], 0.0);
    for corner in Corner::ALL {
        assert!(equation.unexplained(corner).unwrap() < 5e-3);
        let friction_n: f64 = equation.slip_forces_n(corner).iter().sum();
        assert!((friction_n - 40.0).abs() < 3.0, "{friction_n}");
    }
}

#[test]
fn what_the_struts_do_not_explain_is_reported() {
    let mut equation = equation(4);
    let [mass, pitch, roll, _] = equation.body.parts();
    // Of a motion n times its own amplitude off, n²/(1 + n²) is not explained.
    learn(&mut equation, mass + pitch + roll, [0.0; ELEMENTS], 0.7);
    for corner in Corner::ALL {
        let unexplained = equation.unexplained(corner).unwrap();
        assert!((unexplained - 0.49 / 1.49).abs() < 0.06, "{unexplained}");
    }
}

#[test]
fn a_corner_alone_has_its_own_friction_and_no_verdict_on_the_body() {
    let mut equation = equation(1);
    let g = equation.body.parts()[0];
    learn(&mut equation, g, [30.0, 0.0, 0.0], 0.0);
    let [found, ..] = equation.slip_forces_n(Corner::FrontLeft);
    assert!((found - 30.0).abs() < 1.5, "{found}");
    assert_eq!(equation.unexplained(Corner::FrontLeft), None);
    // Of a mass on a strut only ratios are seen: damper and spring over the mass.
    let identified = equation.quarter_car(Corner::FrontLeft, 40.0);
    let mass_kg = identified.sprung_mass_kg;
    assert!((identified.damping_n_s_per_m / mass_kg * SPRUNG_KG / (1.1 * DAMPING) - 1.0).abs() < 0.02);
    assert!((identified.spring_n_per_m / mass_kg * SPRUNG_KG / STIFFNESS - 1.0).abs() < 0.03);
    assert_eq!(equation.slip_forces_n(Corner::RearLeft), [0.0; ELEMENTS]);
    assert!((SPRUNG_KG * g[(0, 0)] - 1.0).abs() < 1e-12);
}

#[test]
fn a_wheel_that_is_detected_late_is_no_friction() {
    let mut equation = equation(4);
    let [mass, pitch, roll, _] = equation.body.parts();
    let (slip_n, late_s) = ([20.0, 0.0, 45.0], [1.5e-3, 0.0, -1e-3, 0.5e-3]);
    learn_late(&mut equation, mass + pitch + roll, slip_n, 0.0, late_s);
    for (corner, late_s) in Corner::ALL.into_iter().zip(late_s) {
        let found_s = DELAY_S * equation.parameters[DELAY + corner.index()];
        assert!((found_s - late_s).abs() < 1e-4, "{corner:?}: {found_s} {late_s}");
        let friction_n: f64 = equation.slip_forces_n(corner).iter().sum();
        assert!((friction_n - 65.0).abs() < 3.0, "{corner:?}: {friction_n}");
    }
}

#[test]
fn friction_that_is_known_leaves_the_models_error_of_its_stiffness() {
    let mut equation = equation(4);
    let [mass, pitch, roll, _] = equation.body.parts();
    assert_eq!(equation.stiffness_variance(Corner::FrontLeft), 0.0);
    let slip_n = [20.0, 0.0, 45.0];
    learn(&mut equation, mass + pitch + roll, slip_n, 0.0);
    for corner in Corner::ALL {
        // Elements of 60 N/m per newton each, in phase with the deflection; a fifth of their sum.
        let expected = 0.2 * 60.0 * slip_n.iter().sum::<f64>();
        let sd = equation.stiffness_variance(corner).sqrt();
        assert!((sd / expected - 1.0).abs() < 0.1, "{sd} {expected}");
        let [damping, spring] = equation.strut_variance(corner);
        assert!((spring.sqrt() * STIFFNESS / sd - 1.0).abs() < 1e-9);
        // Nothing of it damps.
        assert!(damping.sqrt() < 0.02, "{damping}");
    }
}

/// The file's until four seconds were seen, from the first frame on.
#[test]
fn friction_begins_where_the_file_has_it() {
    let mut corner = CornerConfig::paper().with_accel_noise(1e-3).unwrap();
    (corner.uncertainty.friction_n, corner.uncertainty.friction_sd_n) = (45.0, 6.0);
    let equation =
        configured(|equation: &mut BodyEquation<f64>| equation.configure(&[Some(corner); 4], 500.0));
    for force in equation.slip_forces_n(Corner::RearLeft) {
        // 45 - 6²/45, a third each.
        assert!((force - 44.2 / 3.0).abs() < 1e-9, "{force}");
    }
    // It may as well be all in one element: each is known to (45² + 12²)^(1/2) N.
    let prior = equation.with_prior()
        [crate::cholesky::packed::<SIZE>(slip(0, Corner::RearLeft), slip(0, Corner::RearLeft))];
    assert!((FORCE_N / prior.sqrt() - (45.0f64.powi(2) + 144.0).sqrt()).abs() < 1e-9);
}

#[test]
fn friction_of_which_little_was_seen_leaves_the_stiffness_open() {
    let mut equation = equation(1);
    let g = equation.body.parts()[0];
    // Half of the body's motion is something else.
    learn(&mut equation, g, [30.0, 0.0, 0.0], 1.0);
    let model = 0.2 * 60.0 * equation.slip_forces_n(Corner::FrontLeft).iter().sum::<f64>();
    assert!(equation.stiffness_variance(Corner::FrontLeft).sqrt() > 1.2 * model);
    assert_eq!(equation.stiffness_variance(Corner::RearLeft), 0.0);
}

#[test]
fn what_is_read_of_a_strut_belongs_to_the_files_mass() {
    let mut equation = equation(4);
    assert!(equation.reading(Corner::FrontLeft).is_none());
    let [mass, pitch, roll, _] = equation.body.parts();
    // A body a quarter heavier than the file: of all forces and the mass only the ratios are in the signals.
    learn(&mut equation, (mass + pitch * 1.15 + roll * 0.9) / 1.25, [20.0, 0.0, 45.0], 0.0);
    for corner in Corner::ALL {
        let reading = equation.reading(corner).unwrap();
        assert!((reading.ln_damping - (1.1f64 / 1.25).ln()).abs() < 0.02, "{reading:?}");
        assert!((reading.ln_spring + 1.25f64.ln()).abs() < 0.03, "{reading:?}");
        assert!((reading.friction_n - 65.0 / 1.25).abs() < 2.0, "{reading:?}");
        let sds = [reading.ln_damping_sd, reading.ln_spring_sd, reading.friction_sd_n / 65.0];
        assert!(sds.iter().all(|sd| *sd > 0.0 && *sd < 0.05), "{reading:?}");
    }
}
