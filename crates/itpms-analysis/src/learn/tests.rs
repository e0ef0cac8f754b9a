//! Closed forms of the update, and a small car that is drawn, read and learned.

use itpms_core::model::{CarConfig, Confidence, Corner, CornerConfig, ParameterUncertainty};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::Pressure;

use super::*;

const PLACARD_KPA: f64 = 241.3;

fn file() -> CarConfig<f64> {
    let uncertainty = ParameterUncertainty::of(Confidence::Rough);
    let corner = CornerConfig { uncertainty, ..CornerConfig::paper() };
    CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.7) }
}

/// A drive in which every wheel reads `factor` times the file's stiffness over mass at `kpa`.
fn drive(kpa: f64, factor: f64) -> DriveReading {
    let nominal = CornerConfig::<f64>::paper();
    let stiffness_over_mass =
        factor * nominal.tire.stiffness_n_per_m(kpa) / nominal.quarter_car.unsprung_mass_kg();
    let wheel = WheelReading { stiffness_over_mass, relative_sd: 0.0, seconds: 600.0 };
    DriveReading { pressures_kpa: [kpa; 4], wheels: [Some(wheel); 4], struts: [None; 4] }
}

#[test]
fn what_all_wheels_read_alike_divides_as_the_files_variances_do() {
    let learned = learn(&file(), &[drive(PLACARD_KPA, 1.06)]).unwrap();
    let corner = learned.corners[2].unwrap();
    // For the mean of all wheels everything is a scalar: masses 0.8² + 0.6²/2 of 10 %, tires 8 % and of that 2.4 % each by itself, car and road 1.5 % each
    // and a quarter of (1 %)².
    let (mass, tire) = (0.01 * (0.64 + 0.18), 0.0064 - 0.75 * 0.024f64.powi(2));
    let all = mass + tire + 2.0 * 0.015f64.powi(2) + 0.25e-4;
    let of = |parameter: &Parameter| (parameter.after / parameter.before).ln();
    assert!((of(&corner.unsprung_mass_kg) + 1.06f64.ln() * mass / all).abs() < 1e-9);
    assert!((of(&corner.tire_n_per_m) - 1.06f64.ln() * tire / all).abs() < 1e-9);
    // Stiffness over mass is known but for car, road and gauge; each of the two hardly better than before.
    let ratio = &corner.stiffness_over_mass;
    let sd = ratio.after_sd / ratio.after;
    assert!(sd < (2.0 * 0.015f64.powi(2) + 1e-4).sqrt() && sd > 0.02, "{sd}");
    assert!(ratio.is_learned());
    // Nothing of it shows in the slope at placard pressure, and the estimator is given the same as the table says.
    assert_eq!(learned.slope.after, 1.0);
    assert!(!learned.slope.is_learned());
    let learned_corner = learned.car.corners[2].unwrap();
    assert!((learned_corner.tire.stiffness_n_per_m(PLACARD_KPA) - corner.tire_n_per_m.after).abs() < 1e-6);
    assert_eq!(learned_corner.uncertainty.tire_relative_sd(), sd);
    assert!(
        learned_corner.tire.map_sd_kpa(PLACARD_KPA) < 1e-4
            && learned_corner.tire.map_sd_kpa(PLACARD_KPA - 50.0) > 2.0
    );
}

#[test]
fn two_pressures_teach_the_slope() {
    // A tire whose line is 8 % steeper, about its point at the placard's pressure.
    let tire = CornerConfig::<f64>::paper().tire;
    let at_180 = tire.stiffness_n_per_m(180.0);
    let steeper = 1.0 + 0.08 * tire.stiffness_per_kpa() * (180.0 - PLACARD_KPA) / at_180;
    let one = learn(&file(), &[drive(PLACARD_KPA, 1.0)]).unwrap();
    let two = learn(&file(), &[drive(PLACARD_KPA, 1.0), drive(180.0, steeper)]).unwrap();
    assert!((one.slope.after_sd - 0.05).abs() < 1e-9 && two.slope.after_sd < 0.046, "{:?}", two.slope);
    // As a scalar: what the two drives differ by, h u, with 1.5 % of either road and half of (1 %)² of either's wheels.
    let h = (PLACARD_KPA - 180.0) / (180.0 + 60_880.0 / 713.91);
    let noise = 2.0 * (0.015f64.powi(2) + 0.25e-4);
    let gain = 0.0025 * h / (h * h * 0.0025 + noise);
    assert!((two.slope.after - 1.0 - gain * 0.08 * h).abs() < 2e-3, "{:?} {gain}", two.slope);
}

#[test]
fn a_file_that_was_learned_goes_on_where_it_was() {
    let once = learn(&file(), &[drive(PLACARD_KPA, 1.06)]).unwrap();
    let again = learn(&once.car, &[drive(PLACARD_KPA, 1.06)]).unwrap();
    let [once, again] = [once, again].map(|learned| learned.corners[0].unwrap().stiffness_over_mass);
    // What the file's masses and tires vary by (as above) of all that varies was believed at once; of the rest some comes, and the second
    // time more is known.
    let (file, drive) =
        (0.01 * (0.64 + 0.18) + 0.0064 - 0.75 * 0.024f64.powi(2), 2.0 * 0.015f64.powi(2) + 0.25e-4);
    let believed = (once.after / once.before).ln() / 1.06f64.ln();
    assert!((believed - file / (file + drive)).abs() < 1e-9, "{believed}");
    let believed = (again.after / once.before).ln() / 1.06f64.ln();
    assert!(believed > file / (file + drive) && believed < 1.0, "{believed}");
    assert!(again.after_sd < once.after_sd, "{again:?}");
    assert!((again.before_sd - once.after_sd).abs() < 1e-9 * once.after_sd);
}

#[test]
fn a_strut_is_weighed_against_its_file() {
    let mut reading = drive(PLACARD_KPA, 1.0);
    let strut = StrutMean { damping_n_s_per_m: 1_200.0, spring_n_per_m: 29_114.0, friction_n: 80.0 };
    reading.struts = [Some(strut); 4];
    let corner = learn(&file(), &[reading, reading]).unwrap().corners[1].unwrap();
    // 30 % of the file against 5 % of the fit with 15 % of the sprung mass, twice on the same car.
    let (file, read) = (1.0 / 0.09, 1.0 / (0.05f64.powi(2) + 0.15f64.powi(2)));
    let damping = 925.8 * ((1_200.0f64 / 925.8).ln() * read / (file + read)).exp();
    assert!((corner.damping_n_s_per_m.after - damping).abs() < 1e-6);
    assert!((corner.damping_n_s_per_m.after_sd / damping - (file + read).sqrt().recip()).abs() < 1e-9);
    // 40 ± 40 N against 80 ± 13.4.
    let (file, read) = (1.0 / 1_600.0, 1.0 / (36.0 + 144.0));
    assert!((corner.friction_n.after - (40.0 * file + 80.0 * read) / (file + read)).abs() < 1e-9);
}

#[test]
fn drives_that_show_nothing_are_named() {
    assert_eq!(learn(&file(), &[]), Err(LearnError::NoDrive));
    let nothing = DriveReading { wheels: [None; 4], ..drive(PLACARD_KPA, 1.0) };
    assert_eq!(learn(&file(), &[drive(PLACARD_KPA, 1.0), nothing]), Err(LearnError::TooLittle(2)));
}

/// A car whose front wheels have 0.5 of the file's unsprung mass: by the file their tires have twice the pressure that they have, which no tire has.
#[test]
fn a_tire_that_is_far_from_its_file_is_read_at_its_known_pressure() {
    let mut scenario = Scenario::builtin("drive-puncture").unwrap();
    (scenario.duration_s, scenario.rate_hz) = (150.0, 200.0);
    for (_, spec) in scenario.corner.iter_mut() {
        spec.pressure = Pressure::ConstantKpa(spec.placard_kpa);
    }
    let truth = Corner::ALL.map(|corner| scenario.corner_config(corner).unwrap());
    let mut file = scenario.clone();
    for corner in [Corner::FrontLeft, Corner::FrontRight] {
        let Some(spec) = file.corner.get_mut(corner) else { unreachable!() };
        spec.unsprung_mass_kg *= 2.0;
    }
    let config = file.car_config().unwrap();
    let pressures_kpa = truth.map(|corner| corner.placard_kpa);
    let mut off = Vec::new();
    for seed in 1..=5 {
        let mut listener = Listener::new(&config, pressures_kpa, scenario.rate_hz).unwrap();
        Simulation::new(&scenario, seed).unwrap().for_each(|row| listener.take(&row.car_sample()));
        for ((wheel, corner), kpa) in listener.finish().wheels.iter().zip(&truth).zip(pressures_kpa) {
            let right = corner.tire.stiffness_n_per_m(kpa) / corner.quarter_car.unsprung_mass_kg();
            off.push((wheel.as_ref().unwrap().stiffness_over_mass / right).ln().abs());
        }
    }
    // In the mean square a tenth of the file's error remains, and every wheel is nearer to the car than to its file.
    let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    let (file, worst) = (2.0f64.ln(), off.iter().copied().fold(0.0, f64::max));
    assert!(rms < 0.1 * file && worst < 0.5 * file, "{rms}: {off:?}");
}
