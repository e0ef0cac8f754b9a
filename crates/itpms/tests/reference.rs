//! `--save-reference` and `--reference`: what a reset taught goes from one drive to the next, or the command says why not.

use itpms_data::Vehicle;
use itpms_data::reference::StoredReference;

use crate::common::Bench;

const ESTIMATE: &str = "estimate drive.csv --vehicle car.toml -o est.csv";

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
