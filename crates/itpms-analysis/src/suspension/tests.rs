//! Whole drives of a small car: a rigid body on four linear struts with a little dry friction, on wheels that a road shakes.

use itpms_core::model::Corner;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;

use super::{Because, CarBody, DamperState, LoadState, SuspensionSpectra, SuspensionVerdict, Terms};

const STEP_S: f64 = 0.005;
/// Steps of the plant in one of the log.
const FINE: usize = 8;

fn file() -> CarBody {
    CarBody {
        sprung_mass_kg: [330.0, 330.0, 270.0, 270.0],
        unsprung_mass_kg: [40.0; 4],
        damping_n_s_per_m: [1500.0; 4],
        spring_n_per_m: [24e3, 24e3, 22e3, 22e3],
        spring_stiffening_per_m: 0.0,
        accel_noise_m_s2: [0.0; 4],
        tire_n_per_m: [220e3; 4],
        tire_damping_n_s_per_m: [50.0; 4],
    }
}

/// So many seconds at a road of this roughness, with dampers over the file's and kg added at the rear.
fn drive(seconds: f64, road: f64, damper: [f64; 4], added_rear_kg: f64) -> SuspensionSpectra {
    let car = file();
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let rear_kg = 540.0 + added_rear_kg;
    let (mass, dt) = (660.0 + rear_kg, STEP_S / FINE as f64);
    let rear = rear_kg / mass;
    let x = [rear, rear, rear - 1.0, rear - 1.0].map(|x| 2.7 * x);
    let y = [0.75, -0.75, 0.75, -0.75];
    let (pitch, roll) = (0.95 * mass * 2.7 * 2.7 * rear * (1.0 - rear), 0.65 * mass * 0.75 * 0.75);
    let (mut body, mut rate) = ([0.0; 3], [0.0; 3]);
    let (mut wheel, mut wheel_rate, mut ground, mut stick) = ([0.0; 4], [0.0; 4], [0.0f64; 4], [0.0; 4]);
    let mut spectra = SuspensionSpectra::new(STEP_S);
    for step in 0..(seconds / dt) as usize {
        let (mut accel, mut out) = ([0.0; 3], [[0.0; 2]; 4]);
        for i in 0..4 {
            // A road whose slope is white, leaking over seconds.
            let white: f64 = (0..4).map(|_| random.random::<f64>() - 0.5).sum();
            ground[i] += road * white * dt.sqrt() - 0.5 * ground[i] * dt;
            let up = body[0] + x[i] * body[1] + y[i] * body[2];
            let v = wheel_rate[i] - rate[0] - x[i] * rate[1] - y[i] * rate[2];
            stick[i] = v.signum() + (stick[i] - v.signum()) * (-v.abs() * dt / 4e-4).exp();
            let force = car.damping_n_s_per_m[i] * damper[i] * v
                + car.spring_n_per_m[i] * (wheel[i] - up)
                + 25.0 * stick[i];
            let tire = car.tire_n_per_m[i] * (ground[i] - wheel[i]);
            out[i][0] = (tire - force) / 40.0;
            accel =
                [accel[0] + force / mass, accel[1] + force * x[i] / pitch, accel[2] + force * y[i] / roll];
        }
        for i in 0..4 {
            out[i][1] = accel[0] + x[i] * accel[1] + y[i] * accel[2];
            wheel_rate[i] += out[i][0] * dt;
            wheel[i] += wheel_rate[i] * dt;
        }
        for i in 0..3 {
            rate[i] += accel[i] * dt;
            body[i] += rate[i] * dt;
        }
        if step % FINE == 0 {
            spectra.push(dt * step as f64, 20.0, &out);
        }
    }
    spectra
}

const ROAD: f64 = 0.012;

#[test]
fn a_damper_that_has_lost_most_and_a_load_are_found_against_the_reference() {
    let (car, terms) = (file(), Terms::default());
    let healthy = SuspensionVerdict::of(&car, &drive(120.0, ROAD, [1.0; 4], 0.0), None, &terms);
    assert!(healthy.dampers.iter().all(|damper| damper.because == Some(Because::NoReference)));
    assert_eq!(healthy.load.because, Some(Because::NoReference));
    let reference = healthy.learned.unwrap();
    for (found, truth) in reference.spring_n_per_m.into_iter().zip(car.spring_n_per_m) {
        assert!((found / truth - 1.0).abs() < 0.06, "{reference:?}");
    }
    let later = drive(90.0, ROAD, [1.0, 1.0, 0.3, 1.0], 200.0);
    let verdict = SuspensionVerdict::of(&car, &later, Some(&reference), &terms);
    let states = verdict.dampers.map(|damper| damper.state);
    assert_eq!(states, [DamperState::Fine, DamperState::Fine, DamperState::Worn, DamperState::Fine]);
    let over = verdict.dampers[Corner::RearLeft.index()].over_reference.unwrap();
    assert!((over.value - 0.3).abs() < 0.06, "{over:?}");
    let left_right = verdict.dampers[Corner::RearRight.index()].left_right.unwrap();
    assert!((left_right.value + 0.7).abs() < 0.06, "{left_right:?}");
    let masses = verdict.load.masses.unwrap();
    assert!((masses.added_kg.value - 200.0).abs() < 60.0, "{masses:?}");
    assert!((masses.axles_kg[1].value - 820.0).abs() < 50.0, "{masses:?}");
    assert_eq!(verdict.load.state, LoadState::Known);
    // The same drive of a car whose rear axle may not carry it, and of such as are not judged.
    let overloaded = Terms { gross_axle_kg: Some([900.0, 700.0]), ..terms };
    let verdict = SuspensionVerdict::of(&car, &later, Some(&reference), &overloaded);
    assert_eq!(verdict.load.state, LoadState::Overload);
    let adaptive = Terms { adaptive_dampers: true, ..terms };
    let verdict = SuspensionVerdict::of(&car, &later, Some(&reference), &adaptive);
    assert!(verdict.dampers.iter().all(|damper| damper.state == DamperState::Unknown));
    let leveled = Terms { level_control: true, ..terms };
    let verdict = SuspensionVerdict::of(&car, &later, Some(&reference), &leveled);
    assert_eq!((verdict.load.masses, verdict.load.because), (None, Some(Because::LevelControl)));
    assert_eq!(verdict.dampers[Corner::RearLeft.index()].state, DamperState::Worn);
}

#[test]
fn too_short_too_smooth_and_too_rough_are_reported() {
    let because = |spectra: &SuspensionSpectra| {
        SuspensionVerdict::of(&file(), spectra, None, &Terms::default()).dampers[0].because
    };
    assert_eq!(because(&drive(15.0, ROAD, [1.0; 4], 0.0)), Some(Because::Short));
    assert_eq!(because(&drive(60.0, 0.0005, [1.0; 4], 0.0)), Some(Because::Smooth));
    assert_eq!(because(&drive(60.0, 0.3, [1.0; 4], 0.0)), Some(Because::Rough));
}

#[test]
fn what_is_missing_or_stands_is_no_drive() {
    let mut spectra = SuspensionSpectra::new(STEP_S);
    for i in 0..20_000 {
        let speed = if i < 10_000 { 0.0 } else { 20.0 };
        let value = if i < 10_000 { 1.0 } else { f64::NAN };
        spectra.push(STEP_S * f64::from(i), speed, &[[value; 2]; 4]);
    }
    assert_eq!(spectra.usable_s(), 0.0);
}
