//! A stored reference: what goes in comes out, and nothing else ever does.

use crate::stored;

use std::fs;

use itpms_core::model::Learned;
use itpms_core::torsion::{TorsionCalibration, TorsionCurve};
use itpms_data::Vehicle;
use itpms_data::reference::StoredReference;
use proptest::prelude::*;
use stored::{learned, new, old};

fn refusal(bytes: &[u8]) -> String {
    StoredReference::parse(bytes).unwrap_err().to_string()
}

/// A file whose checksum fits whatever its body is. The checksum comes from the program's own words about it, whose
/// algorithm is held against its published check value elsewhere.
fn sealed(format: &str, body: &str) -> String {
    let text = refusal(format!("itpms-reference {format} 0\n{body}").as_bytes());
    let (_, expected) = text.rsplit_once(' ').unwrap();
    format!("itpms-reference {format} {expected}\n{body}")
}

fn body() -> String {
    old().to_text().split_once('\n').unwrap().1.to_owned()
}

#[test]
fn what_was_saved_is_read_again_for_its_car() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("reference");
    for stored in [old(), new()] {
        stored.save(&path).unwrap();
        let read = StoredReference::read(&path).unwrap();
        assert_eq!(read, stored);
        assert_eq!(read.for_vehicle(&Vehicle::paper()).unwrap(), (Vehicle::paper(), &stored.reference));
    }
    assert_eq!(old().day(), "2030-03-17");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn a_torn_file_is_refused_wherever_it_was_cut() {
    let whole = old().to_text();
    for length in 0..whole.len() {
        assert!(StoredReference::parse(&whole.as_bytes()[..length]).is_err(), "cut to {length}");
    }
    // As a file system may leave it: the length is there, the rest of the bytes is zero, or still the older content's.
    let (other, mut torn) = (new().to_text(), 0);
    for length in 0..whole.len() {
        let zeroed = [&whole.as_bytes()[..length], &vec![0; whole.len() - length]].concat();
        assert!(StoredReference::parse(&zeroed).is_err(), "zero from {length}");
        let mixed =
            [&whole.as_bytes()[..length], other.as_bytes().get(length..).unwrap_or_default()].concat();
        if mixed != whole.as_bytes() && mixed != other.as_bytes() {
            torn += 1;
            assert!(StoredReference::parse(&mixed).is_err(), "mixed from {length}");
        }
    }
    assert!(torn > whole.len() / 2);
}

#[test]
fn a_flipped_bit_is_refused_wherever_it_is() {
    let mut bytes = old().to_text().into_bytes();
    let header = bytes.iter().position(|byte| *byte == b'\n').unwrap();
    for i in 0..bytes.len() {
        for bit in 0..8 {
            bytes[i] ^= 1 << bit;
            let text = refusal(&bytes);
            if i > header {
                assert!(text.contains("its checksum says"), "byte {i}, bit {bit}: {text}");
            }
            bytes[i] ^= 1 << bit;
        }
    }
}

#[test]
fn other_files_are_named_for_what_they_are() {
    assert_eq!(
        refusal(b"time_s,speed_m_s\n"),
        "is no learned reference: its beginning is \"time_s,speed_m_s\", expected \"itpms-reference\""
    );
    assert!(refusal(b"").contains("is no learned reference"));
    assert!(refusal(&[0xFF; 300]).contains("is no learned reference"));
    let dir = tempfile::tempdir().unwrap();
    let read = |path: &std::path::Path| StoredReference::read(path).unwrap_err().to_string();
    assert!(read(dir.path()).ends_with("is a directory, expected a file"));
    assert!(read(&dir.path().join("none")).ends_with("none: no such file"));
    let long = dir.path().join("long");
    fs::write(&long, [sealed("1", &body()), "#".repeat(70_000)].concat()).unwrap();
    assert!(read(&long).contains("65536 bytes"));
}

#[test]
fn the_format_before_is_read_as_knowing_nothing_of_the_shared_road() {
    let older: String = body()
        .lines()
        .filter(|line| !line.contains("shared_road_bias"))
        .fold(String::new(), |text, line| text + line + "\n");
    let read = StoredReference::parse(sealed("1", &older).as_bytes()).unwrap();
    let mut expected = old().reference;
    expected.rear_axle_coupling = Learned { value: 0.0, sd: 0.15 };
    for corner in expected.corners.iter_mut().flatten() {
        corner.shared_road_bias = Learned { value: 0.0, sd: 0.015 };
    }
    assert_eq!(read.reference, expected);
    // A file of today that lacks it is not taken for one of then.
    assert!(refusal(sealed("2", &older).as_bytes()).contains("shared_road_bias"));
}

/// A deviation of the wheelbase counts from the file's; where that was assumed, from the wheelbase that was found.
#[test]
fn an_assumed_wheelbase_is_replaced_by_the_one_that_was_found() {
    let mut reference = learned(1.0);
    reference.wheelbase.value = -0.08;
    let measured = Vehicle::paper();
    let refused = StoredReference::new(&measured, reference, 0).unwrap_err().to_string();
    assert!(refused.contains("a wheelbase of 2.48 m, the vehicle file has 2.7 m"), "{refused}");
    assert!(refused.contains("wheelbase_sd_m = 0.15"), "{refused}");
    let text =
        measured.to_toml().replacen("wheelbase_m = 2.7", "wheelbase_m = 2.7\nwheelbase_sd_m = 0.15", 1);
    let assumed = Vehicle::parse(&text).unwrap();
    assert_eq!(Vehicle::parse(&assumed.to_toml()).unwrap(), assumed);
    let stored = StoredReference::new(&assumed, reference, 0).unwrap();
    let read = StoredReference::parse(stored.to_text().as_bytes()).unwrap();
    let (known, stated) = read.for_vehicle(&assumed).unwrap();
    assert!((known.wheelbase_m.unwrap() - 2.7 * 0.92).abs() < 1e-12 && stated.wheelbase.value == 0.0);
    assert_eq!(stated.wheelbase.sd, reference.wheelbase.sd);
}

#[test]
fn a_newer_format_is_distinguished_from_damage() {
    let newer = sealed("10", "something that nobody knows yet");
    assert_eq!(
        refusal(newer.as_bytes()),
        "the learned reference has format 10, expected at most 9: a newer itpms wrote it"
    );
    let damaged = newer.replace("nobody", "n0body");
    assert!(refusal(damaged.as_bytes()).contains("is damaged"));
}

#[test]
fn whole_files_with_impossible_contents_are_refused_too() {
    assert_eq!(StoredReference::parse(sealed("9", &body()).as_bytes()).unwrap(), old());
    let edited = |from: &str, to: &str| {
        let body = body();
        assert!(body.contains(from), "{from}");
        refusal(sealed("9", &body.replacen(from, to, 1)).as_bytes())
    };
    assert!(
        edited("unsprung_mass = 0.01", "unsprung_mass = 0.6").contains("not plausible: unsprung_mass lies")
    );
    assert!(
        edited("wheelbase_sd = 0.0004", "wheelbase_sd = 0.0").contains("not plausible: wheelbase is not")
    );
    assert!(edited("driving_s = 612.5", "driving_s = nan").contains("not plausible: learned_s"));
    assert!(edited("[corner.fl]", "[corner.xx]").contains("unknown key xx in [corner]"));
    assert!(edited("unix_s = \"19", "unix_s = \"-19").contains("does not have a time"));
    assert!(edited("gain_sd = 0.002\n", "").contains("[learned.left] has no gain_sd"));
    assert!(edited("= 612.5", "= = 612.5").contains("not valid TOML"));
    let mut bad = learned(1.0);
    bad.skew_s[1].sd = f64::NAN;
    assert!(StoredReference::new(&Vehicle::paper(), bad, 0).is_err());
    bad = learned(1.0);
    bad.corners = [None; 4];
    assert!(StoredReference::new(&Vehicle::paper(), bad, 0).is_err());
}

#[test]
fn another_car_is_refused_by_name_id_or_parameters() {
    let car = Vehicle::paper();
    let refusal = |vehicle: &Vehicle| old().for_vehicle(vehicle).unwrap_err().to_string();
    let named = Vehicle { name: "another".to_owned(), ..car.clone() };
    assert_eq!(
        refusal(&named),
        "the reference was learned on a vehicle whose name is \"paper, Table 2\", expected \"another\""
    );
    let numbered = Vehicle { id: Some("7".to_owned()), ..car.clone() };
    assert!(refusal(&numbered).ends_with("whose id is not given, expected \"7\""));
    let stored = StoredReference::new(&numbered, learned(1.0), 0).unwrap();
    assert!(stored.for_vehicle(&numbered).is_ok() && stored.for_vehicle(&car).is_err());
    // Every parameter the deviations count from; not the noise of the sensors.
    let text = car.to_toml();
    for (key, of_it) in [
        ("wheelbase_m", true),
        ("stiffness_per_kpa", true),
        ("stiffness_at_zero", true),
        ("sprung_mass_kg", true),
        ("unsprung_mass_kg", true),
        ("damping_n_s_per_m", true),
        ("spring_n_per_m", true),
        ("placard_kpa", true),
        ("accel_noise_m_s2", false),
    ] {
        let line = text.lines().rfind(|line| line.starts_with(key)).unwrap();
        let value: f64 = line.split_once(" = ").unwrap().1.parse().unwrap();
        let changed = text.replacen(line, &format!("{key} = {:?}", value * 1.001), 1);
        let changed = Vehicle::parse(&changed).unwrap();
        assert_eq!(old().for_vehicle(&changed).is_err(), of_it, "{key}");
    }
}

proptest! {
    #[test]
    fn any_name_and_numbers_come_back(name in "\\PC*", id in proptest::option::of("\\PC*"), scale in 0.01..1.0f64, when in 0..4_000_000_000_000u64) {
        let vehicle = Vehicle { name, id, ..Vehicle::paper() };
        let stored = StoredReference::new(&vehicle, learned(scale), when).unwrap();
        prop_assert_eq!(&StoredReference::parse(stored.to_text().as_bytes()).unwrap(), &stored);
        prop_assert!(stored.for_vehicle(&vehicle).is_ok());
    }

    #[test]
    fn any_bytes_are_refused_in_words(bytes in proptest::collection::vec(any::<u8>(), 0..400), begun in any::<bool>()) {
        let bytes = if begun { [b"itpms-reference ".as_slice(), &bytes].concat() } else { bytes };
        prop_assert!(!refusal(&bytes).is_empty());
    }
}

/// Written by hand, with a checksum that fits.
#[test]
fn a_bar_that_pushes_is_in_no_car() {
    let line = body().lines().find(|line| line.starts_with("front_bar = ")).unwrap().to_owned();
    let text = refusal(sealed("9", &body().replace(&line, "front_bar = -1.0")).as_bytes());
    assert!(text.contains("not plausible: bar"), "{text}");
    // Noise about no bar at all is none, nor are a solid axle's springs at 65 % of its half track: 0.65² - 1.
    for bar in ["-0.05", "-0.5775"] {
        let line_of = format!("front_bar = {bar}");
        assert!(StoredReference::parse(sealed("9", &body().replace(&line, &line_of)).as_bytes()).is_ok());
    }
}

#[test]
fn what_wheel_speeds_taught_is_stored_with_the_rest_or_alone() {
    let mut covariance_1e6 = [[0.0; 8]; 8];
    for (i, row) in covariance_1e6.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            *value = if i == j { 0.01 * (1 + i) as f64 } else { 1e-4 * (1 + i * j + i + j) as f64 };
        }
    }
    let radii = itpms_core::wheel_speed::RadiusCalibration {
        mean_1e3: [-1.48, -1.54, 3.25, 1.5, 0.2, -0.1, -0.6, -0.4],
        covariance_1e6,
        radius_1e3: [0.0, 0.0, 0.0, -2.4],
        leaves_out_yaw_rate: false,
    };
    let doubtful = itpms_core::wheel_speed::RadiusCalibration { leaves_out_yaw_rate: true, ..radii };
    let of_doubtful = StoredReference::of_wheel_speeds(&Vehicle::paper(), doubtful, 1_900_000_000);
    assert_eq!(StoredReference::parse(of_doubtful.to_text().as_bytes()).unwrap(), of_doubtful);
    let beside = old().with_wheel_speeds(Some(radii));
    assert_eq!(StoredReference::parse(beside.to_text().as_bytes()).unwrap(), beside);
    let alone = StoredReference::of_wheel_speeds(&Vehicle::paper(), radii, 1_900_000_000);
    assert!(!alone.has_corners());
    assert_eq!(StoredReference::parse(alone.to_text().as_bytes()).unwrap(), alone);
    // An older program reports that it is too old; of wheel speeds alone it reads on.
    assert!(
        alone.to_text().starts_with("itpms-reference 6 ")
            && old().to_text().starts_with("itpms-reference 9 ")
    );
    let mut broken = radii;
    broken.covariance_1e6[2][2] = -1.0;
    let broken = StoredReference::of_wheel_speeds(&Vehicle::paper(), broken, 0);
    // Tooth pulses come with them, of the wheels of which something was learned.
    let curve = TorsionCurve {
        information: [[3.0, 0.25, 0.1], [0.25, 2.0, -0.3], [0.1, -0.3, 1.0]],
        vector: [-1.5, 1.0 / 3.0, 0.7],
    };
    let torsion = TorsionCalibration { around_hz: 49.5, pieces: 31, curves: [curve; 4] };
    let pulses = alone.clone().with_torsion([None, Some((torsion, -12.5)), None, Some((torsion, 0.0))]);
    assert!(pulses.to_text().starts_with("itpms-reference 6 "));
    assert_eq!(StoredReference::parse(pulses.to_text().as_bytes()).unwrap(), pulses);
    let none = TorsionCalibration { pieces: 31, around_hz: 500.0, curves: [curve; 4] };
    let none = alone.clone().with_torsion([Some((none, 0.0)), None, None, None]);
    assert!(refusal(none.to_text().as_bytes()).contains("a torsion that a tire has"));
    let text = StoredReference::parse(broken.to_text().as_bytes()).unwrap_err().to_string();
    assert!(text.contains("wheel speeds that a car has"), "{text}");
}

#[test]
fn days_are_stored_with_the_wheel_speeds_and_what_is_none_is_refused() {
    use itpms_core::wheel_speed::{RadiusCalibration, RadiusDay, RadiusDays};
    let mut radii = RadiusCalibration::<f64>::nothing();
    (0..8).for_each(|i| radii.covariance_1e6[i][i] = 0.25);
    let alone = StoredReference::of_wheel_speeds(&Vehicle::paper(), radii, 1_900_000_000);
    let mut days = RadiusDays::since(1.9e9);
    let covariance_1e6 = [0.2, 0.01, 0.3, -0.02, 1.0 / 3.0, 1.5];
    days.newest = RadiusDay { day: 23.4567, change_1e3: [0.1, -0.2, 0.3], covariance_1e6 };
    let first = alone.clone().with_days(&days);
    assert_eq!(StoredReference::parse(first.to_text().as_bytes()).unwrap(), first);
    days.count = 21;
    days.information = [1.0, 20.0, 500.0].map(|by| [5.0, 0.1, 4.0, 0.2, -0.3, 1.0].map(|x| by * x));
    days.vector = [[0.1, 2.5, -3.0], [1e-3, 70.0, -1.0 / 3.0]];
    let later = alone.clone().with_days(&days);
    assert_eq!(StoredReference::parse(later.to_text().as_bytes()).unwrap(), later);
    assert!(later.to_text().starts_with("itpms-reference 7 ") && later.to_text().len() < 8192);
    let refused = |days: &RadiusDays<f64>| refusal(alone.clone().with_days(days).to_text().as_bytes());
    let mut broken = days;
    broken.information[2][5] = -1.0;
    assert!(refused(&broken).contains("days that a car has"), "{}", refused(&broken));
    broken = days;
    broken.newest.change_1e3[1] = f64::INFINITY;
    assert!(!refused(&broken).is_empty());
    // Days of what?
    let without = old().with_days(&days);
    assert!(refusal(without.to_text().as_bytes()).contains("does not have wheel speeds"));
}
