//! `--save-reference` and `--reference`: what a reset taught goes from one drive to the next, or the command says why not.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

mod common;

use common::Bench;
use itpms_core::car::{Learned, LearnedCorner, LearnedReference};
use itpms_data::Vehicle;
use itpms_data::reference::StoredReference;

/// A drive of one corner, its vehicle, and a reference of it.
fn bench() -> (Bench, StoredReference) {
    let bench = Bench::with_drive();
    let vehicle = Vehicle::read(&bench.path("car.toml")).unwrap();
    let small = |sd: f64| Learned { value: 0.0, sd };
    let corner = LearnedCorner {
        placard_kpa: 241.3,
        unsprung_mass: small(0.01),
        damping: small(0.1),
        spring: small(0.1),
        spectrum_bias_kpa: small(5.0),
    };
    let learned = LearnedReference {
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
    bench.run(&format!("{ESTIMATE} --reference car.reference")).success();
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
        text.starts_with("car.reference: the reference was learned on a vehicle whose set of parameters"),
        "{text}"
    );
    assert!(refusal("--reference car.reference --estimator ekf-ui").contains("only informed learns"));
}

#[test]
fn options_that_do_not_go_together_are_refused() {
    let (bench, stored) = bench();
    for arguments in ["--save-reference new", "--reference car.reference --calibrate-s 10"] {
        let outcome = bench.run(&format!("{ESTIMATE} {arguments}"));
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
    }
    let reset = format!("{ESTIMATE} --calibrate-s 10");
    let refusal = |arguments: &str| bench.run(&format!("{reset} {arguments}")).refusal().to_owned();
    assert!(refusal("--save-reference car.toml").contains("is the vehicle file itself"));
    assert!(refusal("--save-reference est.csv").contains("is given for two outputs"));
    assert!(refusal("--save-reference no/where").contains("does not exist"));
    assert_eq!(StoredReference::read(&bench.path("car.reference")).unwrap(), stored);
}

#[test]
fn a_reset_that_was_not_over_saves_nothing_and_keeps_the_older_reference() {
    let (bench, stored) = bench();
    // The drive lasts 40 s.
    let outcome = bench.run(&format!("{ESTIMATE} --calibrate-s 60 --save-reference car.reference"));
    assert!(outcome.refusal().starts_with("car.reference: nothing was learned"), "{outcome:?}");
    assert_eq!(StoredReference::read(&bench.path("car.reference")).unwrap(), stored);
    assert_eq!(bench.names(), ["car.reference", "car.toml", "drive.csv"]);
}
