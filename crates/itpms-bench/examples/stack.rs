//! Least stack with which a car's estimator is built and takes its samples: `cargo run --release -p itpms-bench --example stack`.
//!
//! Asks this program itself, over and over, with a thread that has more or less of it: what has too little is killed.
#![allow(clippy::expect_used)] // As in the library: without its fixed drive there is nothing to measure.

use std::hint::black_box;
use std::process::{Command, Stdio};
use std::{env, thread};

use itpms_bench::car::{shipped, taken};
use itpms_core::model::{CarSample, CornerSample};
use itpms_core::real::Real;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

const RATE_HZ: f64 = 500.0;
/// Long enough for the shared road to be found, a sensor to be lost, said to be out of order, and back.
const DRIVE_S: f64 = 40.0;
const LOST_S: std::ops::Range<f64> = 20.0..25.0;
/// Between these, in KiB, to 4 KiB.
const LEAST_KIB: usize = 16;
const MOST_KIB: usize = 16 << 10;
const STEP_KIB: usize = 4;

const TASKS: [(&str, &str); 2] = [("new", "building a MonitoredCar"), ("update", "taking its samples")];

fn samples<T: Real>() -> Vec<CarSample<T>> {
    let mut scenario = Scenario::builtin("drive-puncture").expect("a built-in drive");
    (scenario.rate_hz, scenario.duration_s) = (RATE_HZ, DRIVE_S);
    let rows = Simulation::new(&scenario, 1).expect("a built-in drive");
    let lose = |mut sample: CarSample<f64>| {
        if let Some(front_right) = sample.corners[1].as_mut().filter(|_| LOST_S.contains(&sample.time_s)) {
            *front_right = CornerSample { wheel_accel_m_s2: f64::NAN, ..*front_right };
        }
        sample
    };
    rows.map(|row| taken(&lose(row.car_sample()))).collect()
}

/// Does it with so much stack, and does not come back if that is too little.
fn try_with<T: Real>(task: &str, kib: usize) {
    let thread = thread::Builder::new().stack_size(kib << 10);
    let thread = if task == "new" {
        thread.spawn(|| {
            black_box(shipped::<T>(RATE_HZ));
        })
    } else {
        let (mut car, samples) = (Box::new(shipped::<T>(RATE_HZ)), samples::<T>());
        thread.spawn(move || {
            for sample in &samples {
                black_box(car.update(sample));
            }
        })
    };
    thread.expect("a thread").join().expect("no panic");
}

fn is_enough(task: &str, scalar: &str, kib: usize) -> bool {
    let mut this = Command::new(env::current_exe().expect("this program"));
    this.args([task, scalar, &kib.to_string()]).stdout(Stdio::null()).stderr(Stdio::null());
    this.status().expect("this program again").success()
}

fn least_kib(task: &str, scalar: &str) -> usize {
    let (mut short, mut enough) = (LEAST_KIB, MOST_KIB);
    assert!(is_enough(task, scalar, enough), "{task} {scalar}: more than {MOST_KIB} KiB");
    while enough - short > STEP_KIB {
        let middle = (short + enough) / 2 / STEP_KIB * STEP_KIB;
        if is_enough(task, scalar, middle) { enough = middle } else { short = middle }
    }
    enough
}

fn main() {
    let args: Vec<String> = env::args().skip(1).collect();
    if let [task, scalar, kib] = args.as_slice() {
        let kib = kib.parse().expect("KiB");
        return if scalar == "f32" { try_with::<f32>(task, kib) } else { try_with::<f64>(task, kib) };
    }
    for (task, words) in TASKS {
        for scalar in ["f32", "f64"] {
            println!("{words}, {scalar}: {} KiB", least_kib(task, scalar));
        }
    }
}
