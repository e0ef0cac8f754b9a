//! The optional keys of the vehicle file: read, refused, written back, and resolved to standard deviations.

use itpms_core::model::Corner;
use itpms_data::Vehicle;
use itpms_data::vehicle::{Confidence, Driven, ParameterUncertainty, VehicleDetails};
use proptest::prelude::*;

const FULL: &str = r#"[vehicle]
name = "everything"
confidence = "measured"
track_front_m = 1.55
track_rear_m = 1.54
driven = "rear"
[tire]
stiffness_per_kpa = 700.0
stiffness_at_zero = 60000.0
stiffness_relative_sd = 0.02
rolling_radius_m = 0.31
radius_per_ln_pressure = 0.005
torsion_hz = 45.0
torsion_hz_per_kpa = 0.045
teeth = 48
[corner.fl]
sprung_mass_kg = 300.0
unsprung_mass_kg = 40.0
damping_n_s_per_m = 1500.0
spring_n_per_m = 25000.0
placard_kpa = 230.0
sprung_mass_relative_sd = 0.01
unsprung_mass_relative_sd = 0.012
spring_relative_sd = 0.04
damping_relative_sd = 0.06
friction_n = 25.0
friction_sd_n = 5.0
tire_damping_n_s_per_m = 60.0
tire_damping_sd_n_s_per_m = 15.0
[corner.rl]
sprung_mass_kg = 280.0
unsprung_mass_kg = 38.0
damping_n_s_per_m = 1400.0
spring_n_per_m = 24000.0
placard_kpa = 230.0
"#;

fn refusal(from: &str, to: &str) -> String {
    assert!(FULL.contains(from), "{from}");
    Vehicle::parse(&FULL.replacen(from, to, 1)).unwrap_err().to_string()
}

#[test]
fn every_key_arrives_where_it_belongs() {
    let vehicle = Vehicle::parse(FULL).unwrap();
    let details = &vehicle.details;
    assert_eq!(details.confidence, Confidence::Measured);
    assert_eq!((details.track_front_m, details.track_rear_m), (Some(1.55), Some(1.54)));
    assert_eq!(details.driven, Some(Driven::Rear));
    let rear = &details.corners[Corner::RearLeft.index()];
    assert_eq!((rear.tire.teeth, rear.tire.torsion_hz, rear.friction_n), (Some(48), Some(45.0), None));
    let front = vehicle.uncertainty(Corner::FrontLeft);
    assert_eq!(
        front,
        ParameterUncertainty {
            sprung_mass_relative_sd: 0.01,
            unsprung_mass_relative_sd: 0.012,
            spring_relative_sd: 0.04,
            damping_relative_sd: 0.06,
            stiffness_relative_sd: 0.02,
            stiffness_over_mass_relative_sd: None,
            friction_n: 25.0,
            friction_sd_n: 5.0,
            tire_damping_n_s_per_m: 60.0,
            tire_damping_sd_n_s_per_m: 15.0,
        }
    );
    // The rear corner says nothing: what is usual for measured parameters, but for the common tire.
    let usual = ParameterUncertainty::of(Confidence::Measured);
    let rear = vehicle.uncertainty(Corner::RearLeft);
    assert_eq!(rear, ParameterUncertainty { stiffness_relative_sd: 0.02, ..usual });
    assert_eq!(Vehicle::parse(&vehicle.to_toml()).unwrap(), vehicle);
}

#[test]
fn a_tire_over_its_mass_may_be_known_better_than_both() {
    let text = FULL.replacen("teeth = 48", "teeth = 48\nstiffness_over_mass_relative_sd = 0.015", 1);
    let vehicle = Vehicle::parse(&text).unwrap();
    let front = vehicle.uncertainty(Corner::FrontLeft);
    assert_eq!((front.stiffness_over_mass_relative_sd, front.tire_relative_sd()), (Some(0.015), 0.015));
    // 1.5 % of 230 kPa and of 60000 / 700 kPa.
    assert!((vehicle.level_sd_kpa(&Corner::ALL) - 0.015 * (230.0 + 600.0 / 7.0)).abs() < 1e-9);
    // Without the key 1.2 and 2 % make 2.3.
    let without = Vehicle::parse(FULL).unwrap().uncertainty(Corner::FrontLeft);
    assert!((without.tire_relative_sd() - 0.012f64.hypot(0.02)).abs() < 1e-12);
    assert_eq!(Vehicle::parse(&vehicle.to_toml()).unwrap(), vehicle);
}

#[test]
fn old_files_are_typical() {
    let text = Vehicle::paper().to_toml().replace("confidence = \"measured\"\n", "");
    let vehicle = Vehicle::parse(&text).unwrap();
    assert_eq!(vehicle.details, VehicleDetails::default());
    // 4 % that all wheels share and 3 % that tell the axles apart: 5 % together.
    let typical = vehicle.uncertainty(Corner::FrontLeft);
    assert!((typical.common_mass_relative_sd() - 0.04).abs() < 1e-12);
    assert!((typical.axle_mass_relative_sd() - 0.03).abs() < 1e-12);
    assert!((typical.common_mass_relative_sd().hypot(typical.axle_mass_relative_sd()) - 0.05).abs() < 1e-12);
}

#[test]
fn less_confidence_is_a_larger_deviation_everywhere() {
    let [measured, typical, rough] = Confidence::ALL.map(ParameterUncertainty::<f64>::of);
    for (better, worse) in [(measured, typical), (typical, rough)] {
        assert!(better.sprung_mass_relative_sd < worse.sprung_mass_relative_sd);
        assert!(better.unsprung_mass_relative_sd < worse.unsprung_mass_relative_sd);
        assert!(better.spring_relative_sd < worse.spring_relative_sd);
        assert!(better.damping_relative_sd < worse.damping_relative_sd);
        assert!(better.stiffness_relative_sd < worse.stiffness_relative_sd);
        assert!(better.friction_sd_n < worse.friction_sd_n);
        assert!(better.tire_relative_sd() < worse.tire_relative_sd());
    }
}

#[test]
fn values_that_mean_nothing_are_refused_with_their_line() {
    for (from, to, message) in [
        (
            "\"measured\"",
            "\"sure\"",
            "line 3: [vehicle] confidence is the text \"sure\", expected \"measured\", \"typical\" or \"rough\"",
        ),
        ("\"measured\"", "1", "line 3: [vehicle] confidence is of type integer, expected text in quotes"),
        (
            "\"rear\"",
            "\"4wd\"",
            "line 6: [vehicle] driven is the text \"4wd\", expected \"front\", \"rear\" or \"all\"",
        ),
        ("1.55", "1550", "line 4: [vehicle] track_front_m is 1550, expected 0.3 to 4 (another unit?)"),
        ("1.54", "-1", "line 5: [vehicle] track_rear_m is -1, expected a positive, finite number"),
        (
            "relative_sd = 0.012",
            "relative_sd = 1.2",
            "line 23: [corner.fl] unsprung_mass_relative_sd is 1.2, expected a relative standard deviation from 0 to 1 (0.05 is 5 %)",
        ),
        (
            "relative_sd = 0.04",
            "relative_sd = nan",
            "line 24: [corner.fl] spring_relative_sd is NaN, expected a relative standard deviation from 0 to 1 (0.05 is 5 %)",
        ),
        (
            "friction_n = 25.0",
            "friction_n = -1",
            "line 26: [corner.fl] friction_n is -1, expected 0 to 5000 N",
        ),
        (
            "tire_damping_n_s_per_m = 60.0",
            "tire_damping_n_s_per_m = inf",
            "line 28: [corner.fl] tire_damping_n_s_per_m is inf, expected 0 to 20000 N s/m",
        ),
        (
            "teeth = 48",
            "teeth = 48.5",
            "line 15: [tire] teeth is 48.5, expected a whole number from 2 to 1000",
        ),
        ("teeth = 48", "teeth = 1", "line 15: [tire] teeth is 1, expected a whole number from 2 to 1000"),
        ("0.31", "310", "line 11: [tire] rolling_radius_m is 310, expected 0.1 to 1.5 (another unit?)"),
        (
            "torsion_hz = 45.0",
            "torsion_hz = 0",
            "line 13: [tire] torsion_hz is 0, expected a positive, finite number",
        ),
        ("0.005", "3", "line 12: [tire] radius_per_ln_pressure is 3, expected a number from -0.5 to 0.5"),
    ] {
        assert_eq!(refusal(from, to), message);
    }
    let text = refusal("friction_sd_n", "friction_sd");
    assert!(text.contains("unknown key friction_sd in [corner.fl] (did you mean friction_sd_n?)"), "{text}");
}

proptest! {
    /// A written file reads back to the bit, whichever keys are there.
    #[test]
    fn details_read_back(
        confidence in prop::sample::select(Confidence::ALL.to_vec()),
        driven in proptest::option::of(prop::sample::select(Driven::ALL.to_vec())),
        track in proptest::option::of(0.5..3.0f64),
        sd in proptest::option::of(0.0..1.0f64),
        newtons in proptest::option::of(0.0..500.0f64),
        teeth in proptest::option::of(2u32..1000),
        own in any::<bool>(),
    ) {
        let mut vehicle = Vehicle::paper();
        let mut details = vehicle.details;
        (details.confidence, details.driven, details.track_rear_m) = (confidence, driven, track);
        for corner in &mut details.corners {
            (corner.damping_relative_sd, corner.friction_sd_n) = (sd, newtons);
            (corner.tire.teeth, corner.tire.stiffness_relative_sd) = (teeth, sd);
        }
        if own {
            details.corners[1].tire.teeth = Some(77);
        }
        vehicle = vehicle.with_details(details);
        prop_assert_eq!(Vehicle::parse(&vehicle.to_toml()).unwrap(), vehicle);
    }
}

const WHEELS: &str = r#"[vehicle]
name = "wheels"
wheelbase_m = 2.66
track_front_m = 1.55
track_rear_m = 1.53
driven = "rear"
limited_slip = true
[tire]
rolling_radius_m = 0.31
radius_per_ln_pressure = 0.005
radius_per_ln_pressure_sd = 0.002
[corner.rl]
placard_kpa = 250.0
"#;

#[test]
fn a_file_without_masses_is_complete_for_wheel_speeds() {
    let vehicle = Vehicle::parse(WHEELS).unwrap();
    let config = vehicle.wheel_speed_config().unwrap();
    assert_eq!((config.wheelbase_m, config.track_front_m, config.track_rear_m), (2.66, 1.55, 1.53));
    assert!(config.limited_slip && config.driven == itpms_core::wheel_speed::DrivenAxle::Rear);
    assert!((config.radius_per_ln_pressure_sd - 0.4).abs() < 1e-12);
    assert_eq!(vehicle.placard_kpa(Corner::RearLeft), Some(250.0));
    assert_eq!(vehicle.placard_kpa(Corner::FrontLeft), None);
    assert_eq!(vehicle.rolling_radius_m(), Some(0.31));
    assert_eq!(Vehicle::parse(&vehicle.to_toml()).unwrap(), vehicle);
    // The missing keys are named, and then it takes masses.
    for key in ["wheelbase_m", "track_front_m", "track_rear_m", "driven"] {
        let without: String =
            WHEELS.lines().filter(|line| !line.starts_with(key)).map(|l| format!("{l}\n")).collect();
        let text = Vehicle::parse(&without).unwrap_err().to_string();
        assert!(text.contains("stiffness_per_kpa"), "{text}");
    }
    let text = Vehicle::parse("[vehicle]\nwheelbase_m = 2.66\n").unwrap_err().to_string();
    assert!(text.contains("track_front_m"), "{text}");
    // Half a corner is no wheel alone.
    let half = WHEELS.replace("placard_kpa = 250.0", "placard_kpa = 250.0\nsprung_mass_kg = 300.0");
    assert!(Vehicle::parse(&half).unwrap_err().to_string().contains("tire.stiffness_per_kpa"));
    let word = WHEELS.replace("limited_slip = true", "limited_slip = \"yes\"");
    assert!(Vehicle::parse(&word).unwrap_err().to_string().contains("expected true or false"));
    // A car with masses may have both.
    let both = Vehicle::parse(FULL).unwrap();
    assert_eq!(both.wheel_speed_config().unwrap_err(), "wheelbase_m");
}

#[test]
fn what_is_read_off_a_car_makes_a_file_for_its_wheel_speeds() {
    use itpms_data::vehicle::typical::{AxleWheels, FrontRear, WheelsOfACar};
    let axles = AxleWheels { track_m: [None, Some(1.6)], driven: Driven::Front, limited_slip: false };
    let tire = "205/55R16".parse().unwrap();
    let car =
        WheelsOfACar { name: None, tire, wheelbase_m: 2.66, axles, placard_kpa: FrontRear::both(230.0) };
    let (text, vehicle) = car.vehicle_file().unwrap();
    assert_eq!(vehicle.details.track_rear_m, Some(1.6));
    // 205/55R16 is 631.9 mm in diameter; a turn rolls 3.05 of them: 1.927 m, a radius of .3067 m.
    assert!((vehicle.rolling_radius_m().unwrap() - 0.307).abs() < 1e-9, "{text}");
    assert_eq!(vehicle.placard_kpa(Corner::FrontRight), Some(230.0));
    assert!(WheelsOfACar { wheelbase_m: 26.6, ..car }.vehicle_file().is_err());
}
