//! Lines that are put in, found.

use super::*;

const WHEEL: TurningWheel = TurningWheel {
    unsprung_mass_kg: 40.0,
    tire_n_per_m: 220e3,
    tire_damping_n_s_per_m: 50.0,
    spring_n_per_m: 28e3,
    damping_n_s_per_m: 1800.0,
    friction_n: 0.0,
};
const BODY_KG: f64 = 380.0;

/// Accelerations of wheel and body for a force of one newton, solved from the equations of both.
fn answer(w: f64) -> [Complex<f64>; 2] {
    let strut = Complex::new(WHEEL.spring_n_per_m, w * WHEEL.damping_n_s_per_m);
    let tire = Complex::new(WHEEL.tire_n_per_m, w * WHEEL.tire_damping_n_s_per_m);
    let body = strut / (strut - BODY_KG * w * w);
    let z = 1.0 / (tire + strut - WHEEL.unsprung_mass_kg * w * w - strut * body);
    [-w * w * z, -w * w * z * body]
}

/// A wheel at these turning rates with a force of `run_out_n` and an imbalance, in noise of `noise` m/s² a sample.
fn driven(
    seconds: f64,
    turning: impl Fn(f64) -> f64,
    run_out_n: f64,
    kg_m: impl Fn(f64) -> f64,
    noise: f64,
    mut each: impl FnMut(&mut RotationWatch),
) -> RotationWatch {
    let (mut watch, step_s, mut turned, mut random) = (RotationWatch::default(), 0.005, 0.0, 1u64);
    let mut white = || {
        (0..12).fold(-6.0, |sum, _| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum + (random >> 11) as f64 / (1u64 << 53) as f64
        })
    };
    for k in 0..(seconds / step_s) as usize {
        let time_s = k as f64 * step_s;
        let w = turning(time_s);
        turned += w * step_s;
        // 90 degrees between the two.
        let force = Complex::from_polar(1.0, turned) * Complex::new(run_out_n, kg_m(time_s) * w * w);
        let [wheel, body] = answer(w).map(|answer| (answer * force).re + noise * white());
        watch.push(time_s, [wheel, body], w * 1.012);
        each(&mut watch);
    }
    watch
}

fn sweep(time_s: f64) -> f64 {
    75.0 + 30.0 * (time_s / 25.0).sin()
}

#[test]
fn a_sweep_parts_imbalance_from_run_out() {
    let found = driven(400.0, sweep, 25.0, |_| 0.006, 1.0, |_| {}).conclude(&WHEEL);
    let turning2 = found.at_rad_per_s.powi(2);
    let truth = 25f64.hypot(0.006 * turning2);
    let (force, grams) = (found.force_n.unwrap(), found.imbalance_g.unwrap());
    assert!((force.value / truth - 1.0).abs() < 0.1, "{force:?} {truth}");
    assert!((grams.value - 30.0).abs() < 8.0, "{grams:?}");
    assert!(found.rise.is_none() && found.state == RotationState::Found);
    // At one speed the force alone.
    let steady = driven(300.0, |_| 80.0, 25.0, |_| 0.006, 1.0, |_| {}).conclude(&WHEEL);
    assert!((steady.force_n.unwrap().value / 25f64.hypot(0.006 * 6400.0) - 1.0).abs() < 0.1);
    assert!(steady.imbalance_g.is_none());
}

#[test]
fn without_a_line_nothing_is_claimed() {
    let none = driven(300.0, sweep, 0.0, |_| 0.0, 1.0, |_| {}).conclude(&WHEEL);
    assert_eq!((none.state, none.force_n), (RotationState::NoLine, None));
    let slow = driven(300.0, |_| 20.0, 50.0, |_| 0.0, 1.0, |_| {}).conclude(&WHEEL);
    assert_eq!(slow.state, RotationState::Slow);
}

#[test]
fn a_weight_that_is_lost_is_an_event_and_a_steady_one_is_not() {
    let events = |lost_kg_m: f64| {
        let mut found = Vec::new();
        let kg_m = move |time_s: f64| if time_s > 240.0 { 0.003 + lost_kg_m } else { 0.003 };
        let steady = |time_s: f64| 80.0 + 2.0 * (time_s / 9.0).sin();
        driven(600.0, steady, 10.0, kg_m, 1.0, |watch| found.extend(watch.rises(&WHEEL)));
        found
    };
    assert!(events(0.0).is_empty());
    let found = events(0.012);
    let [(rise, since_s)] = found[..] else { panic!("{found:?}") };
    // From 10 and 19 N to 10 and 96.
    assert!((rise.value - 75.0).abs() < 3.0 * rise.sd, "{rise:?}");
    assert!((300.0..440.0).contains(&since_s), "{since_s}");
}
