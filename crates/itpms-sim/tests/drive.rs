//! Drives of a whole car, through the public face: what the built-in ones are, and what a car must do.

use itpms_core::model::Corner;
use itpms_sim::antialias::AntiAliasSpec;
use itpms_sim::car::{CarSpec, PayloadSpec};
use itpms_sim::plant::Deviations;
use itpms_sim::road::{Line, ProfileSpec, Road, RoadClass, RoadSpec, Side, Surface};
use itpms_sim::scenario::{CornerSpec, JourneySpec, Scenario};
use itpms_sim::sensor::SensorSpec;
use itpms_sim::simulation::{CornerRow, SimRow, Simulation};
use itpms_sim::time_profile::{Pressure, Speed};

pub(crate) fn builtin(name: &str) -> Scenario {
    Scenario::builtin(name).unwrap()
}

pub(crate) fn drive(scenario: &Scenario, seed: u64) -> Vec<SimRow> {
    Simulation::new(scenario, seed).unwrap().collect()
}

fn corner(row: &SimRow, corner: Corner) -> CornerRow {
    row.corners[corner.index()].unwrap()
}

fn all(row: &SimRow) -> [CornerRow; 4] {
    Corner::ALL.map(|c| corner(row, c))
}

/// The puncture's car without noise, short, on a flat road.
fn silent(duration_s: f64) -> Scenario {
    Scenario {
        duration_s,
        road: RoadSpec::default(),
        sensor: SensorSpec::with_noise(0.0),
        ..builtin("drive-puncture")
    }
}

#[test]
fn the_drives_are_those_of_the_contract() {
    let names: Vec<&str> = Scenario::builtin_names().filter(|n| n.starts_with("drive-")).collect();
    assert_eq!(names, ["drive-puncture", "drive-slow-leak", "drive-diffusion", "drive-normal"]);
    for name in names {
        let s = builtin(name);
        assert!(s.car.is_some() && s.wheelbase_m == 2.7 && s.sensor.noise_m_s2 == 0.05, "{name}");
        for c in Corner::ALL {
            let configured = s.corner_config(c).unwrap().quarter_car;
            let rear = matches!(c, Corner::RearLeft | Corner::RearRight);
            let masses = (configured.sprung_mass_kg(), configured.unsprung_mass_kg());
            assert_eq!(masses, if rear { (216.0, 50.0) } else { (240.8, 56.9) }, "{name}");
        }
    }
    let at =
        |s: &Scenario, c: Corner, t: f64| s.corner.get(c).unwrap().pressure.profile_kpa().unwrap().value(t);
    let puncture = builtin("drive-puncture");
    assert_eq!(puncture.speed, Speed::ConstantKmH(80.0));
    assert_eq!([19.0, 22.5].map(|t| at(&puncture, Corner::FrontLeft, t)), [241.3, 137.9]);
    let leak = builtin("drive-slow-leak");
    // Half a kPa a minute.
    assert!((at(&leak, Corner::RearRight, 600.0) - 236.3).abs() < 1e-9);
    let speed = leak.speed.profile_m_s().unwrap();
    assert_eq!([speed.minimum(), speed.maximum()].map(|v| (3.6 * v).round()), [20.0, 100.0]);
    let diffusion = builtin("drive-diffusion");
    for c in Corner::ALL {
        assert!((at(&diffusion, c, 3900.0) / at(&diffusion, c, 300.0) - 0.8).abs() < 1e-12);
        assert_eq!(at(&builtin("drive-normal"), c, 3000.0), 241.3);
    }
}

#[test]
fn a_seed_is_a_journey_and_seeds_differ() {
    let normal = builtin("drive-normal");
    assert_eq!(normal.composed(5).unwrap(), normal.composed(5).unwrap());
    assert_ne!(normal.composed(5).unwrap().speed, normal.composed(6).unwrap().speed);
    let short = Scenario { duration_s: 30.0, ..normal };
    let rows = drive(&short, 5);
    // NaN-free, so equality is that of all values.
    assert_eq!(rows, drive(&short, 5));
    assert_ne!(rows, drive(&short, 6));
    // A composed journey is an ordinary scenario, whose drive is the same.
    assert_eq!(rows, drive(&short.composed(5).unwrap(), 5));
}

#[test]
fn journeys_have_everything_and_load_only_at_stops() {
    let normal = builtin("drive-normal");
    let mut classes = Vec::new();
    let (mut stops, mut load_changes, mut fastest) = (0, 0, 0.0f64);
    for seed in 0..20 {
        let s = normal.composed(seed).unwrap();
        let speed = s.speed.profile_m_s().unwrap();
        fastest = fastest.max(3.6 * speed.maximum());
        let Speed::PointsSKmH(points) = &s.speed else { panic!() };
        assert!(points.last().unwrap()[0] >= 3600.0);
        assert!(points.iter().all(|p| (0.0..=130.0).contains(&p[1])));
        stops += points.windows(2).filter(|p| p[0][1] > 0.0 && p[1][1] == 0.0).count();
        for pair in points.windows(2) {
            let slope = (pair[1][1] - pair[0][1]) / 3.6 / (pair[1][0] - pair[0][0]);
            assert!((-2.51..=1.81).contains(&slope), "{slope}");
        }
        let Surface::Segments(segments) = &s.road.surface else { panic!() };
        assert!(segments.list.iter().all(|x| (1.8..=2.6).contains(&x.slope)));
        classes.extend(segments.list.iter().map(|x| x.roughness.gd_n0_m3()));
        for item in s.car.unwrap().payload {
            for pair in item.points_s_kg.windows(2).filter(|p| p[0][1] != p[1][1]) {
                load_changes += 1;
                for t in [pair[0][0], pair[1][0]] {
                    assert_eq!(speed.value(t), 0.0, "seed {seed}, {t} s");
                }
            }
        }
    }
    for class in [RoadClass::A, RoadClass::B, RoadClass::C, RoadClass::D] {
        assert!(classes.contains(&class.gd_n0_m3()), "{class}");
    }
    assert!(fastest > 120.0 && stops > 100 && load_changes > 20, "{fastest} {stops} {load_changes}");
}

#[test]
fn on_one_road_with_a_dynamic_index_of_one_a_car_is_four_quarter_cars() {
    // Both tracks are one profile, so nothing rolls; equal corners and k_y = L/2 part front and rear; with its center of
    // gravity on the road braking moves nothing. Speeds change, stops included.
    let points_m = (0..400)
        .map(|i| f64::from(i) * 0.5)
        .map(|x| [x, 0.004 * (x * 1.7).sin() + 0.01 * (x * 0.31).cos()])
        .collect();
    let profile = ProfileSpec { points_m, ..ProfileSpec::default() };
    let mut s = silent(12.0);
    s.road = RoadSpec { surface: Surface::Profile(profile), contact_length_m: 0.1, ..RoadSpec::default() };
    s.speed = Speed::PointsSKmH(vec![[0.0, 0.0], [4.0, 60.0], [7.0, 60.0], [10.0, 0.0]]);
    for (_, spec) in s.corner.iter_mut() {
        *spec = CornerSpec::paper(Pressure::ramp(241.3, 150.0, 5.0, 3.0));
    }
    s.car = Some(CarSpec {
        cg_height_m: 0.0,
        pitch_gyration_m: 1.35,
        antiroll_front_n_m_per_rad: 0.0,
        antiroll_rear_n_m_per_rad: 0.0,
        ..CarSpec::default()
    });
    let car = drive(&s, 1);
    let apart = drive(&Scenario { car: None, ..s }, 1);
    for (a, b) in car.iter().zip(&apart) {
        for (x, y) in all(a).into_iter().zip(all(b)) {
            // Rounding only.
            assert!((x.body_accel_m_s2 - y.body_accel_m_s2).abs() < 1e-8, "{}", a.time_s);
            assert!((x.wheel_accel_m_s2 - y.wheel_accel_m_s2).abs() < 1e-8, "{}", a.time_s);
            assert_eq!(x.road_m, y.road_m);
        }
    }
    assert!(car.iter().any(|r| all(r)[2].wheel_accel_m_s2.abs() > 1.0));
}

#[test]
fn standing_still_nothing_moves_but_noise() {
    let mut s = silent(5.0);
    s.speed = Speed::ConstantKmH(0.0);
    s.road = RoadSpec::iso8608(RoadClass::C, 2.0);
    s.car = Some(CarSpec {
        lateral_points_s_m_s2: vec![[0.0, 1.0]],
        rear_offset_m: 0.03,
        payload: vec![PayloadSpec::constant([2.0, 0.4], 80.0)],
        ..CarSpec::default()
    });
    s.corner.iter_mut().for_each(|(_, spec)| spec.truth.imbalance_kg_m = 0.01);
    s.settle_s = 15.0;
    for row in drive(&s, 1) {
        assert_eq!((row.speed_m_s, row.distance_m), (0.0, 0.0));
        for c in all(&row) {
            // 15 s of settling: exp(-1.5 * 15) = 2e-10 of 1 m/s2.
            assert!(c.body_accel_m_s2.abs() < 1e-8 && c.wheel_accel_m_s2.abs() < 1e-8, "{c:?}");
            assert!(c.road_m.is_finite());
        }
    }
    s.sensor = SensorSpec::with_noise(0.1);
    let rows = drive(&s, 1);
    let square: f64 = rows.iter().flat_map(all).map(|c| c.wheel_accel_m_s2.powi(2)).sum::<f64>();
    // 10 000 values: sd of the mean square 1.4 %.
    assert!((square / (4 * rows.len()) as f64 / 0.01 - 1.0).abs() < 0.06);
}

#[test]
fn starting_and_stopping_nod_the_body_and_leave_it_at_rest() {
    let mut s = silent(20.0);
    s.speed = Speed::PointsSKmH(vec![[0.0, 0.0], [2.0, 0.0], [4.0, 36.0], [6.0, 36.0], [8.0, 0.0]]);
    let rows = drive(&s, 1);
    let front = |t: f64| all(&rows[(500.0 * t) as usize])[0].body_accel_m_s2;
    let rear = |t: f64| all(&rows[(500.0 * t) as usize])[3].body_accel_m_s2;
    // Forces come over 0.3 s around the start: half way the nose goes up and the tail down, into braking the other way.
    assert!(front(2.0) > 0.1 && rear(2.0) < -0.1, "{} {}", front(2.0), rear(2.0));
    assert!(front(6.0) < -0.1 && rear(6.0) > 0.1, "{} {}", front(6.0), rear(6.0));
    assert!((rows.last().unwrap().distance_m - 40.0).abs() < 1e-9);
    assert!(all(rows.last().unwrap()).iter().all(|c| c.body_accel_m_s2.abs() < 1e-6));
}

#[test]
fn rear_wheels_follow_one_wheelbase_later_at_any_speed_and_beside_where_told() {
    let mut s = silent(12.0);
    s.road = RoadSpec::iso8608(RoadClass::B, 2.0);
    s.speed =
        Speed::PointsSKmH(vec![[0.0, 0.0], [4.0, 40.0], [7.0, 10.0], [9.0, 0.0], [10.0, 0.0], [12.0, 50.0]]);
    let line = Line::of_track(Side::Right, 1.55);
    for (offset_m, line) in [(0.0, line), (-0.03, line.beside(0.03))] {
        s.car = Some(CarSpec { rear_offset_m: offset_m, ..CarSpec::default() });
        let mut road = Road::along(&s.road, line, 3, 0.005).unwrap();
        for row in drive(&s, 3) {
            let rear = corner(&row, Corner::RearRight).road_m;
            assert!((rear - road.height_m(row.distance_m - 2.7)).abs() < 1e-12, "{} s", row.time_s);
        }
    }
}

#[test]
fn a_bend_carries_the_rear_wheels_off_the_front_ones_track_and_back() {
    let mut s = silent(30.0);
    s.road = RoadSpec::iso8608(RoadClass::A, 2.0);
    s.speed = Speed::ConstantKmH(36.0);
    let lateral = vec![[9.0, 0.0], [10.0, 3.0], [15.0, 3.0], [16.0, 0.0]];
    s.car = Some(CarSpec { lateral_points_s_m_s2: lateral, ..CarSpec::default() });
    let rows = drive(&s, 3);
    // 2.7 m at 10 m/s: 135 rows. In the bend L (L/2R - slip) = 2.7 (2.7 0.03/2 - 0.012) = 7.7 cm.
    let difference = |from: usize, to: usize| {
        let square = (from..to)
            .map(|i| {
                let (front, rear) =
                    (corner(&rows[i], Corner::FrontLeft), corner(&rows[i + 135], Corner::RearLeft));
                (front.road_m - rear.road_m).powi(2)
            })
            .sum::<f64>();
        (square / (to - from) as f64).sqrt()
    };
    assert!(difference(0, 4000) < 1e-12);
    // Two lines d apart differ by 2 ∫ Gd (1 - γ) dn; for w = 2 that is 4π Gd n0² d ∫ (1 - x K_1(x)) / x² dx = 2π² Gd n0² d
    // (the integral is π/2), here 2.4e-7 m²: 0.5 mm. Over 30 m a few dozen independent differences: 30 %.
    let expected = (2.0 * std::f64::consts::PI.powi(2) * 16e-8 * 0.077).sqrt();
    let found = difference(5600, 7100);
    assert!((found / expected - 1.0).abs() < 0.3, "{found} {expected}");
    // Back on the track: the lag of a wheelbase has forgotten 7 cm after 30 of them.
    assert!(difference(13_000, 14_000) < 1e-6);
}

#[test]
fn a_late_sensor_says_later_what_a_prompt_one_says() {
    let mut s = silent(3.0);
    s.road = RoadSpec::iso8608(RoadClass::A, 2.0);
    let prompt = drive(&s, 1);
    let late = SensorSpec { delay_ms: 6.0, ..SensorSpec::with_noise(0.0) };
    s.corner.fl.as_mut().unwrap().wheel_sensor = Some(late);
    let rows = drive(&s, 1);
    for i in 3..1500 {
        let [before, now] = [&prompt[i - 3], &rows[i]].map(|row| corner(row, Corner::FrontLeft));
        // 6 ms are 3 rows.
        assert!((now.wheel_accel_m_s2 - before.wheel_accel_m_s2).abs() < 1e-9);
        assert_eq!(now.body_accel_m_s2, corner(&prompt[i], Corner::FrontLeft).body_accel_m_s2);
    }
}

#[test]
fn what_makes_no_sense_is_refused_with_its_name() {
    let message = |s: &Scenario| s.validate().unwrap_err().to_string();
    let car = |car: CarSpec| Scenario { car: Some(car), ..builtin("drive-puncture") };
    for (spec, expected) in [
        (
            CarSpec { track_front_m: f64::NAN, ..CarSpec::default() },
            "car.track_front_m is NaN, expected a width from 0.5 to 4 m",
        ),
        (CarSpec { roll_gyration_m: 0.0, ..CarSpec::default() }, "car.roll_gyration_m is 0"),
        (CarSpec { rear_offset_m: 2.0, ..CarSpec::default() }, "car.rear_offset_m is 2"),
        (
            CarSpec { lateral_points_s_m_s2: vec![[0.0, 20.0]], ..CarSpec::default() },
            "car.lateral_points_s_m_s2.m/s2 is 20",
        ),
        (
            CarSpec { payload: vec![PayloadSpec::constant([1.0, 0.0], -1.0)], ..CarSpec::default() },
            "car.payload.kg is -1",
        ),
    ] {
        assert!(message(&car(spec)).contains(expected), "{expected}");
    }
    let mut three = builtin("drive-puncture");
    three.corner.rr = None;
    assert!(message(&three).contains("car is given with 3 of the corners, expected all of fl, fr, rl, rr"));
    let mut apart = Scenario { car: None, ..builtin("drive-puncture") };
    apart.corner.fl.as_mut().unwrap().truth.imbalance_kg_m = 0.01;
    assert!(
        message(&apart)
            .contains("corner.fl.truth.imbalance_kg_m is 0.01, expected a [car], or 0 without one")
    );
    let lost = Scenario { speed: Speed::Journey, ..builtin("drive-puncture") };
    assert!(message(&lost).contains("expected a scenario with a [journey]"));
    let half = Scenario { journey: Some(JourneySpec::default()), ..builtin("drive-puncture") };
    assert!(message(&half).contains("speed is given beside a [journey], expected \"journey\""));
    let tired = Scenario {
        journey: Some(JourneySpec { slope: [2.0, 1.0], ..JourneySpec::default() }),
        ..builtin("drive-normal")
    };
    assert!(
        message(&tired).contains("journey.slope is 1, expected a largest slope no less than the smallest")
    );
}

#[test]
fn an_antialias_filter_is_a_cars_too() {
    // The same drive without the filter has more at the wheel and the same truth.
    let mut s = silent(3.0);
    s.road = RoadSpec::iso8608(RoadClass::A, 2.0);
    let with = drive(&s, 1);
    let without = drive(&Scenario { antialias: AntiAliasSpec { order: 0, corner: 0.3 }, ..s }, 1);
    let power = |rows: &[SimRow]| rows.iter().map(|r| all(r)[1].wheel_accel_m_s2.powi(2)).sum::<f64>();
    assert!(power(&without) > power(&with));
    assert!(with.iter().zip(&without).all(|(a, b)| all(a)[1].road_m == all(b)[1].road_m));
}

#[test]
fn a_tire_with_a_contact_length_needs_no_finer_grid() {
    let mut s = silent(6.0);
    s.road = RoadSpec { contact_length_m: 0.1, ..RoadSpec::iso8608(RoadClass::B, 2.0) };
    s.speed = Speed::ConstantKmH(120.0);
    s.antialias.order = 0;
    for (_, spec) in s.corner.iter_mut() {
        spec.truth = Deviations { friction_n: 10.0, ..Deviations::default() };
    }
    // 1.6 kHz beside 12.8 kHz, at the same instants.
    let (coarse, fine) = (Scenario { rate_hz: 200.0, ..s.clone() }, Scenario { rate_hz: 1600.0, ..s });
    let (mut difference, mut power) = (0.0, 0.0);
    for (row, reference) in drive(&coarse, 4).iter().zip(drive(&fine, 4).iter().step_by(8)) {
        let (a, b) = (corner(row, Corner::RearLeft), corner(reference, Corner::RearLeft));
        difference += (a.wheel_accel_m_s2 - b.wheel_accel_m_s2).powi(2);
        power += b.wheel_accel_m_s2.powi(2);
    }
    // Steps of 0.6 ms are a 24th of the wheel hop's radian period: (1/24)^4 / 120 of Runge-Kutta's error is nothing; what
    // differs are waves shorter than 4 cm, of which the contact leaves a hundredth.
    let share = (difference / power).sqrt();
    assert!(share < 1e-3, "{share}");
}
