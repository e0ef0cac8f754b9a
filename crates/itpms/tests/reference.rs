//! `--save-reference` and `--reference`: what a reset taught goes from one drive to the next, or the command says why not.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use common::Bench;
use itpms_core::model::{CornerCalibration, Learned, VehicleCalibration};
use itpms_data::Vehicle;
use itpms_data::reference::StoredReference;

/// A drive of one corner, its vehicle, and a reference of it.
fn bench() -> (Bench, StoredReference) {
    let bench = Bench::with_drive();
    let vehicle = Vehicle::read(&bench.path("car.toml")).unwrap();
    let small = |sd: f64| Learned { value: 0.0, sd };
    let corner = CornerCalibration {
        placard_kpa: 241.3,
        unsprung_mass: small(0.01),
        damping: small(0.1),
        spring: small(0.1),
        spectrum_bias_kpa: small(5.0),
        shared_road_bias: small(0.01),
    };
    let learned = VehicleCalibration {
        corners: [Some(corner), None, None, None],
        bar: [Learned { value: 0.25, sd: 0.02 }, Learned { value: 0.1, sd: 0.02 }],
        gain: [small(0.01); 2],
        wheelbase: small(0.01),
        skew_s: [small(0.001); 2],
        learned_s: 300.0,
    };
    let stored = StoredReference::new(&vehicle, learned, 1_900_000_000).unwrap();
    stored.save(&bench.path("car.reference")).unwrap();
    (bench, stored)
}

const ESTIMATE: &str = "estimate drive.csv --vehicle car.toml -o est.csv";

#[test]
fn a_good_reference_is_taken_and_left_as_it_is() {
    let (bench, stored) = bench();
    let outcome = bench.run(&format!("{ESTIMATE} --reference car.reference"));
    outcome.success();
    // One corner has nothing to gain from it.
    assert!(outcome.stderr.contains("car.reference: without effect"), "{}", outcome.stderr);
    assert_eq!(StoredReference::read(&bench.path("car.reference")).unwrap(), stored);
}

#[test]
fn a_reference_that_cannot_be_used_ends_the_command_before_anything_is_written() {
    let (bench, stored) = bench();
    let refusal = |arguments: &str| {
        let outcome = bench.run(&format!("{ESTIMATE} {arguments}"));
        let text = outcome.refusal().to_owned();
        assert!(!bench.path("est.csv").exists());
        text
    };
    assert!(refusal("--reference none").ends_with("none: no such file"));
    assert!(refusal("--reference drive.csv").starts_with("drive.csv: is no learned reference"));
    bench.write("cut", &stored.to_text()[..200]);
    assert!(refusal("--reference cut").starts_with("cut: the learned reference is damaged"));
    bench.write("car.toml", bench.read("car.toml").replace("925.8", "950.0"));
    let text = refusal("--reference car.reference");
    assert!(
        text.starts_with("car.reference: the reference was learned on a vehicle whose set of parameters")
            && text.ends_with(" as in car.toml"),
        "{text}"
    );
    assert!(refusal("--reference car.reference --estimator ekf-ui").contains("only informed learns"));
}

#[test]
fn a_log_that_is_a_reset_from_end_to_end_teaches_what_it_holds() {
    let bench = Bench::new();
    bench.write(
        "four.toml",
        "name = \"four\"\nduration_s = 20.0\nrate_hz = 200.0\nspeed.constant_km_h = 60.0\ncar = {}\n\
         road.surface.iso8608 = { roughness = \"B\", slope = 2.0 }\n\
         corner.fl.pressure.constant_kpa = 241.3\ncorner.fr.pressure.constant_kpa = 241.3\n\
         corner.rl.pressure.constant_kpa = 241.3\ncorner.rr.pressure.constant_kpa = 241.3\n",
    );
    bench.run("simulate four.toml -o drive.csv --vehicle-out car.toml").success();
    bench.run(&format!("{ESTIMATE} --calibrate-s 20 --save-reference whole.reference")).success();
    StoredReference::read(&bench.path("whole.reference")).unwrap();
}

/// The pressures are not lost for it.
#[test]
fn a_calibration_that_was_not_over_saves_nothing_and_keeps_the_older_reference() {
    let (bench, stored) = bench();
    // The drive lasts 40 s.
    let outcome = bench.run(&format!("{ESTIMATE} --calibrate-s 60 --save-reference car.reference"));
    assert_eq!(outcome.code, Some(2), "{outcome:?}");
    let said = outcome.stderr.lines().last().unwrap_or_default();
    assert!(
        said.contains(
            "car.reference: nothing was learned: the calibration of 60 s is longer than the drive of 40.0 s"
        ),
        "{outcome:?}"
    );
    assert_eq!(StoredReference::read(&bench.path("car.reference")).unwrap(), stored);
    assert_eq!(bench.names(), ["car.reference", "car.toml", "drive.csv", "est.csv"]);
    assert!(bench.read("est.csv").lines().count() > 300);
}

/// Mean pressure and sd in kPa of each corner, 8 to 20 s into the drive.
fn read(bench: &Bench) -> [[f64; 2]; 4] {
    let text = bench.read("est.csv");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let column = |name: &str| names.iter().position(|other| *other == name).unwrap();
    let value = |row: &[&str], column: usize| row[column].parse::<f64>().unwrap();
    let within = |row: &&Vec<&str>| (8.0..20.0).contains(&value(row, column("time_s")));
    ["fl", "fr", "rl", "rr"].map(|corner| {
        ["pressure_kpa", "pressure_sd_kpa"].map(|what| {
            let at = column(&format!("{corner}_{what}"));
            let values: Vec<f64> = rows.iter().filter(within).map(|row| value(row, at)).collect();
            values.iter().sum::<f64>() / values.len() as f64
        })
    })
}

#[test]
fn what_one_drive_taught_sharpens_the_next() {
    let bench = Bench::new();
    bench.run("simulate drive-puncture --seed 3 -o reset.csv --vehicle-out car.toml").success();
    bench.run("simulate drive-puncture --seed 4 -o drive.csv").success();
    // A car of which no more is known than is usual: a calibration of another day cannot sharpen what was measured.
    let car = bench.read("car.toml");
    bench.write("car.toml", car.replace("confidence = \"measured\"", "confidence = \"typical\""));
    // All tires hold 241.3 kPa for 20 s.
    let saves = "--calibrate-s 15 --save-reference car.reference";
    bench.run(&format!("estimate reset.csv --vehicle car.toml -o reset-est.csv {saves}")).success();
    let vehicle = Vehicle::read(&bench.path("car.toml")).unwrap();
    let stored = StoredReference::read(&bench.path("car.reference")).unwrap();
    let learned = *stored.for_vehicle(&vehicle).unwrap().1;
    assert!(learned.corners.iter().all(Option::is_some), "{learned:?}");
    // No longer than the reset, and most of it.
    assert!((5.0..=15.0).contains(&learned.learned_s), "{learned:?}");
    // The simulated car is the one of its file: nothing may be learned that is not there.
    for corner in learned.corners.iter().flatten() {
        for quantity in [corner.unsprung_mass, corner.damping, corner.spring] {
            assert!(quantity.value.abs() < 4.0 * quantity.sd, "{learned:?}");
        }
    }
    bench.run(ESTIMATE).success();
    let without = read(&bench);
    bench.run(&format!("{ESTIMATE} --reference car.reference")).success();
    for ([pressure, sd], [_, sd_without]) in read(&bench).into_iter().zip(without) {
        // Who knows the car better knows the pressures better, and is right: four sds leave one in ten thousand out.
        assert!(sd < 0.9 * sd_without, "{sd} {sd_without}");
        assert!((pressure - 241.3).abs() < 4.0 * sd, "{pressure} {sd}");
    }
}
