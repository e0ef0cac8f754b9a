//! Scenario files: what is accepted, what is refused, and with which words.

use itpms_sim::error::ScenarioError;
use itpms_sim::road::{Extension, RoadClass, Segment, Surface};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

const SMALL: &str = r#"
name = "small"
duration_s = 1
rate_hz = 200
[speed]
constant_km_h = 50
[road]
surface = "flat"
[corner.fl.pressure]
constant_kpa = 230
"#;

/// One of everything, with what it means.
const FULL: &str = include_str!("../scenarios/example-everything.toml");

const CAR: &str = include_str!("../scenarios/example-car.toml");

fn refused(text: &str) -> String {
    Scenario::from_toml(text, "file.toml").unwrap_err().to_string()
}

#[test]
fn written_and_read_again_a_scenario_is_the_same() {
    let mut all: Vec<Scenario> =
        Scenario::builtin_names().map(|name| Scenario::builtin(name).unwrap()).collect();
    all.extend([SMALL, FULL, CAR].map(|text| Scenario::from_toml(text, "test").unwrap()));
    for scenario in all {
        let text = scenario.to_toml().unwrap();
        assert_eq!(Scenario::from_toml(&text, "again").unwrap(), scenario, "{text}");
    }
}

#[test]
fn every_field_reaches_its_place() {
    let s = Scenario::from_toml(FULL, "test").unwrap();
    let Surface::Segments(segments) = &s.road.surface else { panic!("{:?}", s.road.surface) };
    assert_eq!(segments.list[0], Segment { length_m: 50.0, roughness: RoadClass::A.into(), slope: 1.8 });
    assert!((segments.list[1].roughness.gd_n0_m3() - 500e-6).abs() < 1e-15);
    assert_eq!((s.road.pothole[0].edge_m, s.road.step[0].height_m), (0.05, -0.01));
    let fl = s.corner.fl.as_ref().unwrap();
    assert_eq!((fl.truth.sprung_mass_factor, fl.truth.spring_factor), (1.08, 1.0));
    assert_eq!(fl.wheel_sensor.unwrap().noise_m_s2, 0.3);
    let configured = s.corner_config(itpms_core::model::Corner::FrontLeft).unwrap();
    assert_eq!((configured.placard_kpa, configured.accel_noise_m_s2), (250.0, Some(0.12)));
    assert_eq!(configured.quarter_car.sprung_mass_kg(), 300.0);
    assert_eq!(fl.pressure_sensor.unwrap().time_constant_s, 0.2);
    let rows: Vec<_> = Simulation::new(&s, 1).unwrap().collect();
    assert_eq!(rows.len(), 1000);
    assert!(rows.iter().all(|r| r.corners[0].is_some() && r.corners[1].is_none() && r.corners[3].is_some()));
}

#[test]
fn every_field_of_a_car_reaches_its_place() {
    let s = Scenario::from_toml(CAR, "test").unwrap();
    let car = s.car.as_ref().unwrap();
    assert_eq!((car.track_front_m, car.antiroll_rear_n_m_per_rad, car.rise_s), (1.52, 6000.0, 0.3));
    assert_eq!((car.payload[0].left_m, car.payload[0].points_s_kg[1]), (-0.36, [1.5, 75.0]));
    let fl = s.corner.fl.as_ref().unwrap();
    assert_eq!((fl.truth.imbalance_kg_m, fl.truth.spring_progression_per_m), (0.004, 2.0));
    assert_eq!(fl.wheel_sensor.unwrap().delay_ms, 4.0);
    // Every key the program knows is in the example.
    for line in s.to_toml().unwrap().lines() {
        let key = line.split(" = ").next().unwrap();
        let of_a_car = line.contains(" = ") && (CAR.contains(key) || FULL.contains(key));
        assert!(of_a_car || !line.contains(" = "), "{line}");
    }
    let rows: Vec<_> = Simulation::new(&s, 1).unwrap().collect();
    assert_eq!(rows.len(), 4000);
    assert!(rows.iter().flat_map(|r| r.corners).all(|c| c.unwrap().body_accel_m_s2.is_finite()));
}

#[test]
fn syntax_errors_say_where_and_what() {
    for (from, to, expected) in [
        (
            "rate_hz = 200",
            "rate_hz = \"fast\"",
            "file.toml, line 4, column 11: invalid type: string \"fast\", expected f64",
        ),
        ("rate_hz", "rate_khz", "file.toml, line 4, column 1: unknown field `rate_khz`, expected one of"),
        (
            "constant_km_h",
            "constant_mph",
            "line 6, column 1: unknown variant `constant_mph`, expected one of `constant_km_h`, `points_s_km_h`, `journey`",
        ),
        (
            "\"flat\"",
            "\"bumpy\"",
            "line 8, column 11: unknown variant `bumpy`, expected one of `flat`, `iso8608`, `bench`, `segments`, `profile`, `journey`",
        ),
        ("[corner.fl.", "[corner.f1.", "unknown field `f1`, expected one of `fl`, `fr`, `rl`, `rr`"),
        ("duration_s = 1", "", "missing field `duration_s`"),
        (
            "surface = \"flat\"",
            "surface.iso8608.roughness = \"I\"",
            "line 8, column 29: invalid value: string \"I\", expected a road class from \"A\" to \"H\" or Gd(n0) in m3",
        ),
        ("= 200", "= = 200", "file.toml, line 4, column 11"),
    ] {
        let message = refused(&SMALL.replacen(from, to, 1));
        assert!(message.contains(expected), "{message}\nexpected: {expected}");
        assert!(!message.contains('\n'), "{message}");
    }
}

#[test]
fn values_out_of_range_are_named_with_their_table() {
    for (from, to, expected) in [
        (
            "rate_hz = 200",
            "rate_hz = 0",
            "scenario `small`: rate_hz is 0, expected a rate from 20 to 10000 Hz",
        ),
        (
            "= 230",
            "= -5",
            "scenario `small`: corner.fl.pressure.kPa is -5, expected a finite number, zero or more",
        ),
        ("= 50", "= nan", "scenario `small`: speed.km/h is NaN, expected a speed from 0 to 500"),
        (
            "surface = \"flat\"",
            "surface.iso8608 = { roughness = \"A\", slope = 9 }",
            "road.surface.iso8608.slope is 9",
        ),
        (
            "[corner.fl.pressure]",
            "[corner.fl.truth]\nfriction_n = -1\n[corner.fl.pressure]",
            "corner.fl.truth.friction_n is -1",
        ),
        (
            "[corner.fl.pressure]",
            "[corner.fl]\nsprung_mass_kg = 0\n[corner.fl.pressure]",
            "corner.fl.sprung_mass_kg is 0",
        ),
        ("[road]", "[clock]\njitter = 0.5\n[road]", "clock.jitter is 0.5"),
    ] {
        let message = refused(&SMALL.replacen(from, to, 1));
        assert!(message.contains(expected), "{message}\nexpected: {expected}");
    }
    let none = SMALL.replacen("[corner.fl.pressure]\nconstant_kpa = 230", "[corner]", 1);
    assert!(refused(&none).contains("corner is empty, expected at least one of fl, fr, rl, rr"));
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let message = Scenario::load("paper-dorp").unwrap_err().to_string();
    assert_eq!(
        message,
        "no scenario `paper-dorp` (did you mean `paper-drop`?); \
         built in: paper-drop, paper-deep-drop, paper-drop-recover, bench-drop, bench-drop-recover, bench-slow, \
         drive-puncture, drive-slow-leak, drive-diffusion, drive-normal; \
         or give a TOML file"
    );
    let message = Scenario::builtin("xyz").unwrap_err().to_string();
    assert!(message.starts_with("no scenario `xyz`; built in: paper-drop"), "{message}");
}

#[test]
fn files_are_found_and_their_profiles_beside_them() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.toml");
    let road: String =
        (0..100).map(|i| format!("{} {}\n", 0.25 * f64::from(i), 0.01 * f64::from(i % 7))).collect();
    std::fs::write(dir.path().join("road.txt"), road).unwrap();
    let text = SMALL.replacen(
        "surface = \"flat\"",
        "surface.profile = { file = \"road.txt\", extend = \"mirror\" }",
        1,
    );
    std::fs::write(&path, &text).unwrap();
    let scenario = Scenario::load(path.to_str().unwrap()).unwrap();
    let Surface::Profile(profile) = &scenario.road.surface else { panic!() };
    assert_eq!(profile.extend, Extension::Mirror);
    assert_eq!(Simulation::new(&scenario, 1).unwrap().count(), 200);

    std::fs::write(dir.path().join("road.txt"), "0 0\n1 0\n").unwrap();
    let message = Simulation::new(&scenario, 1).unwrap_err().to_string();
    assert_eq!(message, "scenario `small`, road profile: 2 points, expected at least 4");
    assert!(matches!(Scenario::load("no/such.toml"), Err(ScenarioError::Read { .. })));
}

#[test]
fn faults_are_read_checked_and_act() {
    let with = |fault: &str| SMALL.replacen("[speed]", &format!("[[fault]]\n{fault}\n[speed]"), 1);
    let stuck = "corner = \"fl\"\nsensor = \"wheel\"\nfrom_s = 0.5\nto_s = 0.75\nkind = \"stuck\"";
    let faulty = Scenario::from_toml(&with(stuck), "test").unwrap();
    let clean: Vec<_> = Simulation::new(&Scenario::from_toml(SMALL, "test").unwrap(), 1).unwrap().collect();
    let rows: Vec<_> = Simulation::new(&faulty, 1).unwrap().collect();
    let wheel =
        |rows: &[itpms_sim::simulation::SimRow], i: usize| rows[i].corners[0].unwrap().wheel_accel_m_s2;
    assert_eq!(rows.len(), clean.len());
    for (i, row) in rows.iter().enumerate() {
        let lasts = row.time_s >= 0.5 && row.time_s < 0.75;
        let expected =
            if lasts { wheel(&clean, clean.partition_point(|r| r.time_s < 0.5)) } else { wheel(&clean, i) };
        assert_eq!(wheel(&rows, i), expected, "{}", row.time_s);
    }
    let itself = stuck.replace("\"stuck\"", "{ swap = { with = { corner = \"fl\", sensor = \"wheel\" } } }");
    assert!(
        refused(&with(&itself)).contains("fault.kind.swap.with is the same sensor, expected another one")
    );
    assert!(refused(&with(&stuck.replace("0.75", "0.25"))).contains("fault.to_s is 0.25"));
    assert!(
        refused(&with(&stuck.replace("stuck", "dead")))
            .contains("unknown variant `dead`, expected one of `stuck`")
    );
}
