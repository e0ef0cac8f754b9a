//! The vehicle file: what it says, what it may not say, and the way back.

use itpms_core::model::{Confidence, Corner, CornerConfig, ParameterUncertainty, PressureMap};
use itpms_data::Vehicle;
use proptest::prelude::*;

/// The file of the documentation.
const SEDAN: &str = r#"[vehicle]
name = "mid-size sedan"
wheelbase_m = 2.7
[tire]                        # eq. (5)
stiffness_per_kpa = 713.91
stiffness_at_zero = 60880.0
[corner.fl]
sprung_mass_kg = 240.8
unsprung_mass_kg = 56.9
damping_n_s_per_m = 925.8
spring_n_per_m = 29114.0
placard_kpa = 241.3
accel_noise_m_s2 = 0.05
"#;

fn refusal(text: &str) -> String {
    Vehicle::parse(text).unwrap_err().to_string()
}

fn edited(from: &str, to: &str) -> String {
    assert!(SEDAN.contains(from), "{from}");
    refusal(&SEDAN.replacen(from, to, 1))
}

#[test]
fn the_documented_file_is_the_papers_corner() {
    let vehicle = Vehicle::parse(SEDAN).unwrap();
    assert_eq!((vehicle.name.as_str(), vehicle.wheelbase_m), ("mid-size sedan", Some(2.7)));
    // It does not say how well it is known.
    let uncertainty = ParameterUncertainty::of(Confidence::Typical);
    let typical = CornerConfig { uncertainty, ..CornerConfig::paper() };
    assert_eq!(vehicle.corner(Corner::FrontLeft), Some(&typical));
    assert_eq!(vehicle.corner(Corner::RearRight), None);
}

#[test]
fn a_corner_may_have_its_own_tire_and_integers_are_numbers() {
    let text = format!(
        "{SEDAN}[corner.fl.tire]\nstiffness_per_kpa = 800\nstiffness_at_zero = 0\nstiffness_per_kpa_sd = 8\n"
    );
    let vehicle = Vehicle::parse(&text).unwrap();
    let tire = vehicle.corner(Corner::FrontLeft).unwrap().tire;
    assert_eq!((tire.stiffness_per_kpa(), tire.stiffness_at_zero()), (800.0, 0.0));
    // var p = p² var(slope) / slope² alone: 1 % of the pressure.
    assert!((tire.map_sd_kpa(200.0) - 2.0).abs() < 1e-12);
}

#[test]
fn unknown_keys_are_named_with_their_line_and_the_nearest_known_one() {
    assert_eq!(
        edited("sprung_mass_kg", "sprung_mas_kg"),
        "line 8: unknown key sprung_mas_kg in [corner.fl] (did you mean sprung_mass_kg?), expected one of: \
         sprung_mass_kg, unsprung_mass_kg, damping_n_s_per_m, spring_n_per_m, placard_kpa, accel_noise_m_s2, \
         initial_kpa, tire, sprung_mass_relative_sd, unsprung_mass_relative_sd, spring_relative_sd, \
         damping_relative_sd, friction_n, friction_sd_n, tire_damping_n_s_per_m, tire_damping_sd_n_s_per_m"
    );
    assert!(edited("[corner.fl]", "[corner.lf]").starts_with("line 7: unknown key lf in [corner]"));
    assert!(
        edited("[tire]", "[tyre]").starts_with("line 4: unknown key tyre in the file (did you mean tire?)")
    );
    assert!(edited("wheelbase_m", "wheelbase").contains("line 3: unknown key wheelbase in [vehicle]"));
}

#[test]
fn values_out_of_range_are_named_with_their_table() {
    assert_eq!(
        edited("240.8", "-240"),
        "line 8: [corner.fl] sprung_mass_kg is -240, expected a positive, finite number"
    );
    for bad in ["0", "nan", "inf", "-inf"] {
        assert!(edited("56.9", bad).starts_with("line 9: [corner.fl] unsprung_mass_kg is "), "{bad}");
        assert!(edited("713.91", bad).starts_with("line 5: [tire] stiffness_per_kpa is "), "{bad}");
        assert!(edited("2.7", bad).starts_with("line 3: [vehicle] wheelbase_m is "), "{bad}");
        assert!(edited("0.05", bad).starts_with("line 13: [corner.fl] accel_noise_m_s2 is "), "{bad}");
    }
    assert_eq!(
        edited("60880.0", "-1"),
        "line 6: [tire] stiffness_at_zero is -1, expected a finite number, zero or more"
    );
    assert_eq!(
        edited("stiffness_at_zero = 60880.0", "stiffness_at_zero = 6e4\nstiffness_correlation = 2"),
        "line 7: [tire] stiffness_correlation is 2, expected a number between -1 and 1"
    );
}

#[test]
fn values_in_another_unit_are_suspected() {
    // Tons, N/mm, bar, mm, N/m per bar, mm/s².
    for (from, to, key) in [
        ("240.8", "0.2408", "sprung_mass_kg"),
        ("29114.0", "29.114", "spring_n_per_m"),
        ("241.3", "2.413", "placard_kpa"),
        ("241.3", "35", "placard_kpa"),
        ("60880.0", "60.88", "stiffness_at_zero"),
        // As heavy as what it carries: exchanged.
        ("56.9", "569", "unsprung_mass_kg"),
        ("2.7", "2700", "wheelbase_m"),
        ("713.91", "71391", "stiffness_per_kpa"),
        ("0.05", "50", "accel_noise_m_s2"),
    ] {
        let text = edited(from, to);
        assert!(
            text.contains(&format!("{key} is {to}, expected ")) && text.contains("(another unit?"),
            "{text}"
        );
    }
    // Where the estimate starts is a pressure like the placard's.
    let started = |kpa: &str| Vehicle::parse(&format!("{SEDAN}initial_kpa = {kpa}\n"));
    for (bad, expected) in [
        (
            "2.4",
            "line 14: [corner.fl] initial_kpa is 2.4, expected 20 to 1500 (another unit? 2.4 bar is 240 kPa)",
        ),
        (
            "241300",
            "line 14: [corner.fl] initial_kpa is 241300, expected 20 to 1500 (another unit? 241300 Pa is 241 kPa)",
        ),
        ("0", "line 14: [corner.fl] initial_kpa is 0, expected a positive, finite number"),
        ("nan", "line 14: [corner.fl] initial_kpa is NaN, expected a positive, finite number"),
    ] {
        assert_eq!(started(bad).unwrap_err().to_string(), expected);
    }
    assert_eq!(started("20").unwrap().corner(Corner::FrontLeft).unwrap().initial_kpa, Some(20.0));
}

#[test]
fn missing_keys_wrong_types_and_broken_toml() {
    assert_eq!(edited("placard_kpa = 241.3\n", ""), "[corner.fl] has no placard_kpa (table at line 7)");
    assert_eq!(
        edited("stiffness_at_zero = 60880.0\n", ""),
        "[tire] has no stiffness_at_zero (table at line 4)"
    );
    assert_eq!(
        edited("240.8", "\"heavy\""),
        "line 8: [corner.fl] sprung_mass_kg is the text \"heavy\", expected a number"
    );
    assert!(edited("\"mid-size sedan\"", "3").starts_with("line 2: [vehicle] name is of type integer"));
    assert!(edited("wheelbase_m = 2.7", "wheelbase_m = ").starts_with("line 3: not valid TOML: "));
    assert!(refusal("").starts_with("no corner is described"));
    assert!(refusal("[corner]\n").starts_with("no corner is described"));
    let text = refusal(&SEDAN[SEDAN.find("[corner").unwrap()..]);
    assert!(text.starts_with("[corner.fl] has no tire"), "{text}");
}

#[test]
fn errors_of_a_file_start_with_its_name() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("vehicle.toml");
    let text = Vehicle::read(&path).unwrap_err().to_string();
    assert!(text.ends_with("vehicle.toml: no such file"), "{text}");
    assert!(Vehicle::read(dir.path()).unwrap_err().to_string().ends_with("is a directory, expected a file"));
    std::fs::write(&path, SEDAN.replace("240.8", "-240")).unwrap();
    let text = Vehicle::read(&path).unwrap_err().to_string();
    assert!(text.contains("vehicle.toml: line 8: [corner.fl] sprung_mass_kg is -240, expected"), "{text}");
}

proptest! {
    /// What is written reads back: exactly for what is stored, to nine digits for the tire's uncertainty, which is
    /// written from three of its variances.
    #[test]
    fn a_written_vehicle_reads_back(
        name in "\\PC*",
        id in proptest::option::of("\\PC*"),
        wheelbase in proptest::option::of(1.0..6.0f64),
        slope in 100.0..3000.0f64,
        sds in proptest::option::of((0.1..50.0f64, 1.0..5000.0f64, -0.99..0.99f64)),
        initial in proptest::option::of(20.0..400.0f64),
        own_tire in any::<bool>(),
    ) {
        let dir = tempfile::tempdir().unwrap();
        let mut tire = PressureMap::new(slope, 60_880.0).unwrap();
        if let Some((a, b, c)) = sds {
            tire = tire.with_uncertainty(a, b, c).unwrap();
        }
        let learned = id.clone();
        let mut vehicle = Vehicle { name, id, learned, wheelbase_m: wheelbase, ..Vehicle::paper() };
        vehicle.corners[2] = None;
        for corner in vehicle.corners.iter_mut().flatten() {
            *corner = CornerConfig { tire, initial_kpa: initial, ..*corner };
        }
        if own_tire && let Some(corner) = &mut vehicle.corners[3] {
            corner.tire = PressureMap::paper_eq_5();
        }
        let path = dir.path().join("vehicle.toml");
        vehicle.write(&path).unwrap();
        let again = Vehicle::read(&path).unwrap();
        prop_assert_eq!(
            (&again.name, &again.id, &again.learned),
            (&vehicle.name, &vehicle.id, &vehicle.learned)
        );
        let commented = vehicle.to_commented_toml(&["of\na".to_owned()], &|_, key| Some(format!("{key}\n= 1")));
        prop_assert_eq!(&Vehicle::parse(&commented).unwrap(), &again);
        prop_assert_eq!(again.wheelbase_m, vehicle.wheelbase_m);
        for (a, b) in again.corners.iter().zip(&vehicle.corners) {
            let (Some(a), Some(b)) = (a, b) else { prop_assert!(a.is_none() && b.is_none()); continue };
            prop_assert_eq!(CornerConfig { tire: b.tire, ..*a }, *b);
            for p in [0.0, 100.0, 300.0] {
                prop_assert_eq!(a.tire.stiffness_n_per_m(p), b.tire.stiffness_n_per_m(p));
                let (a, b) = (a.tire.map_sd_kpa(p), b.tire.map_sd_kpa(p));
                // Correlations near one cancel most of the variance, hence not nine digits but six.
                prop_assert!((a - b).abs() <= 1e-6 * b.max(1e-3), "{} {}", a, b);
            }
        }
    }
}
