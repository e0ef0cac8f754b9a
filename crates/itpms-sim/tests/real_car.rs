//! A real car's properties beyond its file, against closed forms: mounts, hop dampers, a body that twists, a rim, soft ground,
//! roads that repeat, sensors that lean.

use std::f64::consts::TAU;

use itpms_core::model::QuarterCar;
use itpms_sim::antialias::AntiAliasSpec;
use itpms_sim::plant::{Bending, Body, CarInput, Deviations, FullCar, Plant, StepInput};
use itpms_sim::road::{RoadClass, RoadSpec, Sleepers, Tracks, Washboard};
use itpms_sim::scenario::{CornerSpec, Scenario};
use itpms_sim::sensor::SensorSpec;
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::{Pressure, Speed};
use nalgebra::{Complex, Matrix2, SMatrix, SVector, Vector2};

use crate::full_car::{H, assert_close, at_rest};

const K_T: f64 = 220_000.0;

/// Fourier coefficient of `a = Re(A e^{iωt})`, a value for every step, from after `skip` steps on.
#[derive(Clone, Copy, Default)]
struct Line(Complex<f64>);

impl Line {
    fn push(&mut self, value: f64, f: f64, time_s: f64, count: usize) {
        self.0 += Complex::from_polar(2.0 / count as f64, -TAU * f * time_s) * value;
    }
}

/// Body and wheel acceleration of a quarter car per meter of road, its strut a complex stiffness.
fn quarter(f: f64, strut: Complex<f64>, k_t: f64) -> [Complex<f64>; 2] {
    let (w2, [m_b, m_w]) = ((TAU * f).powi(2), [240.8, 56.9]);
    let dynamic = Matrix2::new(strut - w2 * m_b, -strut, -strut, strut + k_t - w2 * m_w);
    let places = dynamic.lu().solve(&Vector2::new(Complex::new(0.0, 0.0), Complex::new(k_t, 0.0))).unwrap();
    [places[0] * -w2, places[1] * -w2]
}

#[test]
fn a_damper_on_its_mount_moves_a_quarter_car_as_the_closed_form_says() {
    let mount = 100_000.0;
    for f in [1.5, 6.0, 11.0, 25.0] {
        let truth = Deviations { damper_mount_n_per_m: mount, ..Deviations::default() };
        let mut plant = Plant::new(&QuarterCar::paper_table_2(), &truth, 0.0).unwrap();
        let road = |t: f64| (TAU * f * t).cos() * (t / 0.5).min(1.0);
        let (skip, count) = (48_000, 8000);
        let mut lines = [Line::default(); 2];
        for i in 0..skip + count {
            let t = i as f64 * H;
            let road_m = [road(t), road(t + 0.5 * H), road(t + H)];
            plant.step(H, &StepInput { road_m, stiffness_n_per_m: [K_T; 2] });
            if i >= skip {
                lines
                    .iter_mut()
                    .zip(plant.accelerations_m_s2())
                    .for_each(|(line, a)| line.push(a, f, t + H, count));
            }
        }
        let damper = Complex::new(0.0, TAU * f * 925.8);
        let strut = Complex::new(29_114.0, 0.0) + damper * mount / (damper + mount);
        for (line, exact) in lines.iter().zip(quarter(f, strut, K_T)) {
            // The extension's speed is even within a step: (ωh)²/12 of the damper's force, 1e-4 at 25 Hz.
            assert!((line.0 - exact).norm() < 2e-3 * exact.norm(), "{f} Hz: {} {exact}", line.0);
        }
    }
}

fn body(bending: Option<Bending>) -> Body {
    Body { antiroll_n_m_per_rad: [0.0; 2], bending, ..crate::full_car::body() }
}

const TWIST: Bending = Bending {
    frequency_hz: 22.0,
    damping_ratio: 0.05,
    modal_mass_kg: 300.0,
    participation: [1.0, -0.9, -0.8, 1.1],
};
const HOP: [f64; 3] = [4.0, 11.0, 0.15];

fn corners(truth: Deviations) -> [(QuarterCar<f64>, Deviations); 4] {
    crate::full_car::corners().map(|(configured, _)| (configured, truth))
}

fn hop_damped(hop_damper_ratio: f64) -> Deviations {
    let [hop_damper_kg, hop_damper_hz, _] = HOP;
    Deviations { hop_damper_kg, hop_damper_hz, hop_damper_ratio, ..Deviations::default() }
}

/// Accelerations of tops and wheels to a cosine of 1 mm under one wheel, from Lagrange's equations of heave, pitch, roll,
/// four wheels, the bending and four hop dampers, built from the energies.
fn exact(f: f64, wheel: usize, b: &Body, k_t: [f64; 4], hop_kg: f64) -> [[Complex<f64>; 2]; 4] {
    let cars = corners(Deviations::default());
    let mode = b.bending.unwrap_or(Bending { participation: [0.0; 4], ..TWIST });
    let mut m = SMatrix::<f64, 12, 12>::zeros();
    let (mut c, mut k) = (m, m);
    let mut masses = vec![b.mass_kg, b.pitch_kg_m2, b.roll_kg_m2];
    masses.extend(cars.iter().map(|(car, _)| car.unsprung_mass_kg()));
    masses.push(mode.modal_mass_kg);
    masses.extend([hop_kg.max(1.0); 4]);
    m.set_diagonal(&SVector::from_iterator(masses));
    let omega = TAU * mode.frequency_hz;
    k[(7, 7)] += mode.modal_mass_kg * omega * omega;
    c[(7, 7)] += mode.modal_mass_kg * 2.0 * mode.damping_ratio * omega;
    let mut tops = [SVector::<f64, 12>::zeros(); 4];
    for i in 0..4 {
        let [x, y] = b.struts_m[i];
        tops[i][0] = 1.0;
        tops[i][1] = -x;
        tops[i][2] = y;
        tops[i][7] = mode.participation[i];
        let mut stretch = tops[i];
        stretch[3 + i] = -1.0;
        c += cars[i].0.damping_n_s_per_m() * stretch * stretch.transpose();
        k += cars[i].0.spring_n_per_m() * stretch * stretch.transpose();
        k[(3 + i, 3 + i)] += k_t[i];
        let mut hop = SVector::<f64, 12>::zeros();
        hop[3 + i] = -1.0;
        hop[8 + i] = 1.0;
        let w = TAU * HOP[1];
        k += hop_kg * w * w * hop * hop.transpose();
        c += hop_kg * 2.0 * HOP[2] * w * hop * hop.transpose();
        if hop_kg == 0.0 {
            // Hangs on nothing: kept from being singular.
            k[(8 + i, 8 + i)] += 1.0;
        }
    }
    let w = TAU * f;
    let dynamic = (k - m * w * w).map(|x| Complex::new(x, 0.0)) + c.map(|x| Complex::new(0.0, w * x));
    let mut force = SVector::<Complex<f64>, 12>::zeros();
    force[3 + wheel] = Complex::new(1e-3 * k_t[wheel], 0.0);
    let q = dynamic.lu().solve(&force).unwrap();
    [0, 1, 2, 3].map(|i| {
        let top: Complex<f64> = (0..12).map(|j| q[j] * tops[i][j]).sum();
        [top * -w * w, q[3 + i] * -w * w]
    })
}

fn simulated(f: f64, wheel: usize, b: &Body, truth: Deviations, k_t: f64) -> [[Complex<f64>; 2]; 4] {
    let mut car = FullCar::new(b, &corners(truth), [0.0; 4]).unwrap();
    let mut lines = [[Line::default(); 2]; 4];
    let (skip, count) = (40_000, 8000);
    for i in 0..skip + count {
        let t = i as f64 * H;
        let mut road_m = [[0.0; 3]; 4];
        road_m[wheel] = [0.0, 0.5, 1.0].map(|part| 1e-3 * (TAU * f * (t + part * H)).cos());
        car.step(H, &CarInput { road_m, stiffness_n_per_m: [[k_t; 2]; 4], ..at_rest([0.0; 4]) });
        if i >= skip {
            let accelerations = car.accelerations_m_s2();
            let pairs = lines.iter_mut().flatten().zip(accelerations.iter().flatten());
            pairs.for_each(|(line, a)| line.push(*a, f, t + H, count));
        }
    }
    lines.map(|corner| corner.map(|line| line.0))
}

/// As for the rigid car: RK4, and what is left of the start.
const TOLERANCE: f64 = 2e-4;

#[test]
fn a_body_that_twists_and_hop_dampers_are_the_linear_systems() {
    let hop = hop_damped(HOP[2]);
    for f in [1.5, 9.0, 11.0, 13.0, 22.0, 30.0] {
        for (what, bending, truth) in
            [("twist", Some(TWIST), Deviations::default()), ("hop", None, hop), ("both", Some(TWIST), hop)]
        {
            let b = body(bending);
            let expected = exact(f, 2, &b, [K_T; 4], truth.hop_damper_kg);
            assert_close(simulated(f, 2, &b, truth, K_T), expected, TOLERANCE, &format!("{what}, {f} Hz"));
        }
    }
}

#[test]
fn a_tuned_mass_makes_two_modes_of_one() {
    // Den Hartog: an undamped absorber tuned to the frequency forced holds its wheel still.
    let held = simulated(11.0, 0, &body(None), hop_damped(0.0), K_T)[0][1].norm();
    let free = simulated(11.0, 0, &body(None), Deviations::default(), K_T)[0][1].norm();
    assert!(held < 1e-3 * free, "{held} {free}");
}

#[test]
fn on_its_rim_a_wheel_is_as_stiff_as_rubber_and_rim_together() {
    let (rubber, rim) = (60_880.0, 400_000.0);
    let truth = |rim_deflection_m| Deviations {
        rim_deflection_m,
        rim_stiffness_n_per_m: rim,
        ..Deviations::default()
    };
    let b = body(None);
    // 2.8 kN on 61 kN/m would sink by 46 mm: every wheel rests on its rim, and presses it by 5.8 mm, more than it swings.
    for f in [5.0, 12.0, 18.0] {
        let expected = exact(f, 1, &b, [rubber + rim; 4], 0.0);
        assert_close(simulated(f, 1, &b, truth(0.002), rubber), expected, TOLERANCE, "rim");
    }
    // With 233 kN/m and 30 mm none does, and what it swings does not reach it.
    let expected = exact(11.0, 1, &b, [233_000.0; 4], 0.0);
    assert_close(simulated(11.0, 1, &b, truth(0.03), 233_000.0), expected, TOLERANCE, "full");
}

/// A corner of its own at 20 m/s, without noise and filter.
fn corner(road: RoadSpec) -> Scenario {
    let mut s = Scenario::builtin("paper-drop").unwrap();
    s.corner.fl = Some(CornerSpec::paper(Pressure::ConstantKpa(241.3)));
    (s.duration_s, s.rate_hz, s.settle_s) = (8.0, 500.0, 12.0);
    s.speed = Speed::ConstantKmH(72.0);
    s.sensor = SensorSpec::with_noise(0.0);
    s.antialias = AntiAliasSpec { order: 0, corner: 0.3 };
    s.road = road;
    s
}

fn wheel_m_s2(s: &Scenario) -> Vec<f64> {
    Simulation::new(s, 1).unwrap().map(|row| row.corners[0].unwrap().wheel_accel_m_s2).collect()
}

#[test]
fn a_washboard_is_a_line_at_speed_over_wavelength() {
    let waves =
        Washboard { wavelength_m: 1.25, amplitude_m: 0.002, from_m: -1e4, to_m: 1e4, tracks: Tracks::Both };
    let s = corner(RoadSpec { washboard: vec![waves], ..RoadSpec::default() });
    let a = wheel_m_s2(&s);
    let f = 20.0 / 1.25;
    let mut line = Line::default();
    a.iter().enumerate().for_each(|(i, v)| line.push(*v, f, i as f64 / 500.0, a.len()));
    let k_t = s.corner.fl.as_ref().unwrap().tire.map().unwrap().stiffness_n_per_m(241.3);
    let [_, wheel] = quarter(f, Complex::new(29_114.0, TAU * f * 925.8), k_t);
    // The road's grid (cubic, 5 mm) and the plant's steps: below 1e-4.
    assert!((line.0.norm() / (0.002 * wheel.norm()) - 1.0).abs() < 1e-3, "{} {}", line.0, wheel);
    // Nothing beside the line: all power is its.
    let power = a.iter().map(|a| a * a).sum::<f64>() / a.len() as f64;
    assert!((0.5 * line.0.norm_sqr() / power - 1.0).abs() < 1e-3);
}

#[test]
fn sleepers_are_lines_at_multiples_of_speed_over_spacing() {
    let s = corner(RoadSpec {
        sleepers: vec![Sleepers {
            spacing_m: 5.0,
            length_m: 0.3,
            height_m: 0.005,
            edge_m: 0.1,
            from_m: -1e4,
            to_m: 1e4,
            tracks: Tracks::Both,
        }],
        ..RoadSpec::default()
    });
    let a = wheel_m_s2(&s);
    let power = a.iter().map(|a| a * a).sum::<f64>() / a.len() as f64;
    let lines: f64 = (1..60)
        .map(|k| {
            let mut line = Line::default();
            a.iter()
                .enumerate()
                .for_each(|(i, v)| line.push(*v, 4.0 * f64::from(k), i as f64 / 500.0, a.len()));
            0.5 * line.0.norm_sqr()
        })
        .sum();
    assert!(power > 1.0 && (lines / power - 1.0).abs() < 1e-3, "{lines} {power}");
}

#[test]
fn soft_ground_is_a_spring_under_the_tire() {
    let ground = 2e6;
    let soft = corner(RoadSpec { ground_n_per_m: Some(ground), ..RoadSpec::iso8608(RoadClass::B, 2.0) });
    let mut worn = corner(RoadSpec::iso8608(RoadClass::B, 2.0));
    let spec = worn.corner.fl.as_mut().unwrap();
    let k_t = spec.tire.map().unwrap().stiffness_n_per_m(241.3);
    // Two springs in series: a force sinks them by F/k_t + F/k_g.
    spec.truth.tire_stiffness_factor = 1.0 / (1.0 + k_t / ground);
    for (a, b) in wheel_m_s2(&soft).into_iter().zip(wheel_m_s2(&worn)) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    // Values stated for the tire are the tire's.
    let row = Simulation::new(&soft, 1).unwrap().last().unwrap().corners[0].unwrap();
    assert!((row.stiffness_n_per_m - k_t).abs() < 1e-6);
}

#[test]
fn a_sensor_that_leans_reads_braking() {
    let mut s = Scenario::builtin("drive-puncture").unwrap();
    (s.duration_s, s.rate_hz) = (8.0, 200.0);
    s.speed = Speed::PointsSKmH(vec![[0.0, 108.0], [1.0, 108.0], [8.5, 0.0]]);
    s.road = RoadSpec::default();
    let lean = SensorSpec { tilt_deg: 30.0, fore_aft_share: 0.1, ..SensorSpec::with_noise(0.0) };
    s.sensor = lean;
    let row = Simulation::new(&s, 1).unwrap().last().unwrap();
    // The car brakes by 4 m/s2 and has long pitched: nothing moves up or down, and the wheels go as the car.
    for corner in row.corners.into_iter().flatten() {
        for reading in [corner.body_accel_m_s2, corner.wheel_accel_m_s2] {
            assert!((reading + 4.0 * (0.5 + 0.1)).abs() < 2e-3, "{reading}");
        }
    }
    // Upright it reads none of it.
    s.sensor = SensorSpec::with_noise(0.0);
    let row = Simulation::new(&s, 1).unwrap().last().unwrap();
    assert!(row.corners[0].unwrap().wheel_accel_m_s2.abs() < 2e-3);
}

#[test]
fn values_that_make_no_sense_are_named() {
    let with = |edit: &dyn Fn(&mut Deviations)| {
        let mut s = Scenario::builtin("drive-puncture").unwrap();
        edit(&mut s.corner.fl.as_mut().unwrap().truth);
        s.validate().unwrap_err().to_string()
    };
    for (message, expected) in [
        (with(&|t| t.friction_shares = [0.0; 3]), "corner.fl.truth.friction_shares is 0 throughout"),
        (
            with(&|t| t.friction_presliding_m[1] = f64::NAN),
            "friction_presliding_m is NaN, expected distances",
        ),
        (with(&|t| t.hop_damper_kg = 60.0), "hop_damper_kg is 60, expected a mass from 0 to 50 kg"),
        (with(&|t| t.damper_mount_n_per_m = -1.0), "damper_mount_n_per_m is -1, expected 0, or from"),
        (with(&|t| t.rim_deflection_m = f64::NAN), "rim_deflection_m is NaN"),
    ] {
        assert!(message.contains(expected), "{message}");
    }
    let mut alone = corner(RoadSpec::default());
    alone.corner.fl.as_mut().unwrap().truth.hop_damper_kg = 4.0;
    let message = alone.validate().unwrap_err().to_string();
    assert!(message.contains("corner.fl.truth.hop_damper_kg is 4, expected a [car], or 0"), "{message}");
    let mut soft = corner(RoadSpec { ground_n_per_m: Some(0.0), ..RoadSpec::default() });
    assert!(soft.validate().unwrap_err().to_string().contains("road.ground_n_per_m is 0"));
    soft.road = RoadSpec::default();
    soft.sensor.tilt_deg = f64::NAN;
    assert!(soft.validate().unwrap_err().to_string().contains("sensor.tilt_deg is NaN"));
}
