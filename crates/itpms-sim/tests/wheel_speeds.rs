//! The wheels' speeds through the crate's public face, against closed forms.

use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::{Pressure, Speed};
use itpms_sim::wheel_speeds::{WheelSpeedRow, WheelSpeedSpec};

/// On an even road without wind, seen without errors but the wheels' own noise.
const STILL: WheelSpeedSpec = WheelSpeedSpec {
    alone: true,
    car_seed: Some(1),
    latency_ms: 0.0,
    resolution_km_h: 0.0,
    lost_share: 0.0,
    radius_sd: 0.0,
    wear_per_km: 0.0,
    brake_imbalance: 0.0,
    grade_sd: 0.0,
    cross_slope_sd: 0.0,
    wind_m_s: 0.0,
    steering_m_s2: 0.0,
    load_share: 0.0,
    ..WheelSpeedSpec::DEFAULT
};

/// A car on a flat road: 240.8 and 216 kg over a front and a rear wheel, 56.9 and 50 kg of wheel.
fn drive(spec: WheelSpeedSpec, change: impl FnOnce(&mut Scenario)) -> Vec<(f64, f64, WheelSpeedRow)> {
    let text = r#"
name = "wheels"
duration_s = 60
rate_hz = 50
speed.constant_km_h = 72
road.surface = "flat"
[car]
[corner]
fl = { pressure.constant_kpa = 241.3 }
fr = { pressure.constant_kpa = 241.3 }
rl = { sprung_mass_kg = 216, unsprung_mass_kg = 50, pressure.constant_kpa = 241.3 }
rr = { sprung_mass_kg = 216, unsprung_mass_kg = 50, pressure.constant_kpa = 241.3 }
"#;
    let mut scenario = Scenario::from_toml(text, "test").unwrap();
    scenario.wheel_speeds = Some(spec);
    change(&mut scenario);
    Simulation::new(&scenario, 5)
        .unwrap()
        .map(|row| (row.time_s, row.speed_m_s, row.wheel_speeds.unwrap()))
        .collect()
}

/// Mean over a drive of the `ln` of each wheel's speed over the car's.
fn means(rows: &[(f64, f64, WheelSpeedRow)]) -> [f64; 4] {
    [0, 1, 2, 3].map(|i| {
        rows.iter().map(|(_, v, row)| (row.wheel_speed_m_s[i] / v).ln()).sum::<f64>() / rows.len() as f64
    })
}

/// Noise of 2e-4 and what swings with a turn of 1.9 m leave so much of a mean over 3000 rows.
const LEFT: f64 = 3e-5;

#[test]
fn a_wheel_that_rolls_freely_turns_with_its_radius() {
    let rows = drive(STILL, |_| {});
    let [_, _, rl, rr] = means(&rows);
    let radius = rows[0].2.ln_radius;
    assert!((rl + radius[2]).abs() < LEFT && (rr + radius[3]).abs() < LEFT, "{rl} {rr} {radius:?}");
    // A quarter less in one: by the tire's slope, drawn about .007, and its shape.
    let low = drive(STILL, |s| s.corner.rr.as_mut().unwrap().pressure = Pressure::ConstantKpa(0.75 * 241.3));
    let shift = means(&low)[3] - rr;
    assert!((shift / (-0.007 * 0.75f64.ln() * 1.066) - 1.0).abs() < 0.4, "{shift}");
    assert!((shift + low[0].2.ln_radius[3] - radius[3]).abs() < 2.0 * LEFT);
    assert!((means(&low)[2] - rl).abs() < 2.0 * LEFT);
}

#[test]
fn driven_wheels_slip_by_their_force_over_their_stiffness() {
    let rows = drive(STILL, |_| {});
    let slips =
        means(&rows).iter().zip(rows[0].2.ln_radius).map(|(ln, radius)| ln + radius).collect::<Vec<_>>();
    // Drag and the rear wheels' rolling resistance, on two tires of 50 times their load, drawn within 30 %.
    let (front_n, rear_n) = (9.81 * 297.7, 9.81 * 266.0);
    let linear = 0.5 * (0.4 * 400.0 + 0.011 * 2.0 * rear_n) / (50.0 * front_n);
    assert!((0.5 * (slips[0] + slips[1]) / linear - 1.0).abs() < 0.3, "{slips:?} {linear}");
    // Four times the force: four times the slip, but for the brush's curve of some percent.
    let uphill = drive(STILL, |s| {
        s.speed = Speed::PointsSKmH(vec![[0.0, 36.0], [60.0, 252.0]]);
    });
    let at = |rows: &[(f64, f64, WheelSpeedRow)]| {
        let [fl, fr, rl, rr] = means(rows);
        let radius =
            |i: usize| rows.iter().map(|(_, _, row)| row.ln_radius[i]).sum::<f64>() / rows.len() as f64;
        0.5 * (fl + fr - rl - rr + radius(0) + radius(1) - radius(2) - radius(3))
    };
    // At 1 m/s² and 20 m/s, around 10 s.
    let near = &uphill[450..550];
    let mass_kg = 2.0 * (297.7 + 266.0);
    let factor = 1.0 + mass_kg / (0.4 * 400.0 + 0.011 * 2.0 * rear_n);
    let found = at(near) / at(&rows);
    // Loads move to the rear by 4 % of the front's, which softens its tires; the curve adds 5 %; noise.
    assert!((found / factor - 1.08).abs() < 0.08, "{found} {factor}");
}

#[test]
fn in_a_bend_the_outer_wheels_have_the_longer_way() {
    let lateral = 0.8;
    let rows = drive(STILL, |s| s.car.as_mut().unwrap().lateral_points_s_m_s2 = vec![[0.0, lateral]]);
    let [_, _, rl, rr] = means(&rows);
    let radius = rows[0].2.ln_radius;
    let curvature = lateral / 400.0;
    let expected = (1.0 - 0.5 * 1.55 * curvature).ln() - (1.0 + 0.5 * 1.55 * curvature).ln();
    assert!((rl - rr + radius[2] - radius[3] - expected).abs() < 2.0 * LEFT, "{} {expected}", rl - rr);
    // To the left: the yaw rate is positive, and within the sensor's offset.
    let yaw = rows.iter().map(|(_, _, row)| row.yaw_rate_rad_s).sum::<f64>() / rows.len() as f64;
    assert!((yaw - lateral / 20.0).abs() < 0.02, "{yaw}");
}

#[test]
fn a_locked_axle_turns_alike_and_an_open_one_shows_its_low_tire() {
    let apart = |locking_n: f64| {
        let rows = drive(WheelSpeedSpec { locking_n, ..STILL }, |s| {
            s.corner.fl.as_mut().unwrap().pressure = Pressure::ConstantKpa(160.0);
        });
        let [fl, fr, ..] = means(&rows);
        fl - fr
    };
    assert!(apart(0.0) > 2e-3 && apart(1e4).abs() < LEFT, "{} {}", apart(0.0), apart(1e4));
}

#[test]
fn messages_come_late_in_steps_and_hold() {
    let spec = WheelSpeedSpec { latency_ms: 30.0, resolution_km_h: 0.1, ..STILL };
    let ramp = |s: &mut Scenario| {
        s.speed = Speed::PointsSKmH(vec![[0.0, 36.0], [60.0, 144.0]]);
        s.rate_hz = 200.0;
    };
    let rows = drive(spec, ramp);
    for four in rows.chunks(4) {
        assert!(four.iter().all(|(_, _, row)| row == &four[0].2));
    }
    let late = rows.iter().skip(100).map(|(_, v, row)| v - row.wheel_speed_m_s[2] * row.ln_radius[2].exp());
    let late = late.sum::<f64>() / (rows.len() - 100) as f64;
    // 30 ms and on the mean one and a half of four rows of 5 ms, at .5 m/s².
    assert!((late - 0.5 * 0.0375).abs() < 1e-3, "{late}");
    let steps = rows.iter().flat_map(|(_, _, row)| row.wheel_speed_m_s).map(|v| v * 36.0);
    assert!(steps.clone().all(|step| (step - step.round()).abs() < 1e-9));
    let lossy = drive(WheelSpeedSpec { lost_share: 0.3, resolution_km_h: 0.0, ..STILL }, |_| {});
    let held = lossy.windows(2).filter(|w| w[0].2.wheel_speed_m_s == w[1].2.wheel_speed_m_s).count() as f64;
    // Of 3000: four standard deviations are 3.3 %.
    assert!((held / lossy.len() as f64 - 0.3).abs() < 0.034, "{held}");
}

#[test]
fn what_the_bus_does_not_say_is_missing_and_the_rest_stays() {
    let mute = WheelSpeedSpec { yaw_rate: false, accel_x: false, accel_y: false, brake: false, ..STILL };
    for ((_, _, full), (_, _, row)) in drive(STILL, |_| {}).iter().zip(drive(mute, |_| {})) {
        assert_eq!(full.wheel_speed_m_s, row.wheel_speed_m_s);
        assert!(
            [row.yaw_rate_rad_s, row.accel_x_m_s2, row.accel_y_m_s2, row.brake].iter().all(|x| x.is_nan())
        );
    }
}

#[test]
fn accelerations_keep_every_digit_beside_wheel_speeds_and_wheel_speeds_without_them() {
    let mut plain = Scenario::builtin("drive-normal").unwrap();
    plain.duration_s = 20.0;
    let with = |alone: bool| {
        let wheels = WheelSpeedSpec { alone, ..WheelSpeedSpec::default() };
        Simulation::new(&Scenario { wheel_speeds: Some(wheels), ..plain.clone() }, 2).unwrap()
    };
    for ((before, beside), alone) in Simulation::new(&plain, 2).unwrap().zip(with(false)).zip(with(true)) {
        assert!(before.wheel_speeds.is_none() && alone.corners == [None; 4]);
        assert_eq!((before.corners, before.distance_m), (beside.corners, beside.distance_m));
        assert!(beside.wheel_speeds.is_some() && beside.wheel_speeds == alone.wheel_speeds);
    }
}

#[test]
fn wheel_speeds_need_a_car_and_values_that_are_some() {
    let refused = |text: &str| Scenario::from_toml(text, "file.toml").unwrap_err().to_string();
    let quarter = r#"
name = "small"
duration_s = 1
rate_hz = 200
speed.constant_km_h = 50
road.surface = "flat"
wheel_speeds = {}
corner.fl.pressure.constant_kpa = 230
"#;
    assert!(
        refused(quarter).contains("car is missing, expected a [car] for the [wheel_speeds]"),
        "{}",
        refused(quarter)
    );
    let lost = quarter.replace("wheel_speeds = {}", "wheel_speeds = { lost_share = 1.0 }");
    assert!(refused(&lost).contains("wheel_speeds.lost_share is 1, expected a share from 0 to 0.9"));
}
