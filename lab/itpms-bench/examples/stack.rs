//! Least stack with which a car is configured where it lies and takes its samples: `cargo run --release -p itpms-bench --example stack`.
//! With `-- --most 8 24`, ends with an error where building takes more KiB than the first in `f32`, or samples more than the second.
//!
//! Asks this program itself, over and over, with a thread that has more or less of it left: what has too little is killed.
#![allow(clippy::expect_used)] // As in the library: without its fixed drive there is nothing to measure.

use std::hint::black_box;
use std::process::{Command, ExitCode, Stdio};
use std::sync::Mutex;
use std::{env, thread};

use itpms_bench::car::{nominal, taken};
use itpms_core::Real;
use itpms_core::model::{CarSample, CornerSample};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

const RATE_HZ: f64 = 500.0;
/// Long enough for the shared road to be found, a sensor to be lost, reported to be out of order, and back.
const DRIVE_S: f64 = 40.0;
const LOST_S: std::ops::Range<f64> = 20.0..25.0;
/// Stack of the thread, in bytes, and to how many of them what is used of it is found out.
const STACK: usize = 1 << 20;
const STEP: usize = 256;

const TASKS: [(&str, &str); 2] = [("configure", "building a MonitoredCar"), ("update", "taking its samples")];

/// A controller's cars: memory that is there before anything is known, and costs no flash.
static CAR_F32: Mutex<MonitoredCar<f32>> = Mutex::new(MonitoredCar::unconfigured());
static CAR_F64: Mutex<MonitoredCar<f64>> = Mutex::new(MonitoredCar::unconfigured());

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

/// Calls the task once `bytes` of the stack below an address are used up.
#[inline(never)]
fn with_less(below: usize, bytes: usize, task: &mut dyn FnMut()) {
    let ballast = black_box([0u8; STEP / 4]);
    if below - (&raw const ballast).addr() < bytes {
        with_less(below, bytes, task);
    } else {
        task();
    }
    black_box(&ballast);
}

/// Does it with so many bytes of the stack used up, and does not come back if what is left is too little.
fn try_with<T: Real>(task: &str, bytes: usize, car: &'static Mutex<MonitoredCar<T>>) {
    let config = MonitorConfig::new(&nominal());
    let mut car = car.lock().expect("one thread");
    let samples = if task == "update" { samples::<T>() } else { Vec::new() };
    if task == "update" {
        car.configure(&config, RATE_HZ).expect("the drives' car");
    }
    let car = &mut *car;
    let mut work: Box<dyn FnMut() + Send> = match task {
        "configure" => Box::new(|| car.configure(&config, RATE_HZ).expect("the drives' car")),
        "update" => Box::new(|| {
            for sample in &samples {
                black_box(car.update(sample));
            }
        }),
        _ => Box::new(|| {}),
    };
    thread::scope(|scope| {
        let thread = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, || {
            let top = black_box(0u8);
            with_less((&raw const top).addr(), bytes, &mut work);
        });
        thread.expect("a thread").join().expect("no panic");
    });
}

fn survives(task: &str, scalar: &str, bytes: usize) -> bool {
    let mut this = Command::new(env::current_exe().expect("this program"));
    this.args([task, scalar, &bytes.to_string()]).stdout(Stdio::null()).stderr(Stdio::null());
    this.status().expect("this program again").success()
}

/// The most bytes of the stack that may be used up before the task.
fn most_used(task: &str, scalar: &str) -> usize {
    let (mut fine, mut too_many) = (0, STACK + STEP);
    assert!(survives(task, scalar, fine), "{task} {scalar}: more than {STACK} bytes");
    while too_many - fine > STEP {
        let middle = (fine + too_many) / 2 / STEP * STEP;
        if survives(task, scalar, middle) { fine = middle } else { too_many = middle }
    }
    fine
}

fn main() -> ExitCode {
    let args: Vec<String> = env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let most_kib = match args.as_slice() {
        ["--most", build, samples] => [build, samples].map(|kib| kib.parse().expect("KiB")),
        [task, scalar, bytes] => {
            let bytes = bytes.parse().expect("bytes");
            if *scalar == "f32" {
                try_with(task, bytes, &CAR_F32)
            } else {
                try_with(task, bytes, &CAR_F64)
            }
            return ExitCode::SUCCESS;
        }
        _ => [f64::INFINITY; 2],
    };
    let mut code = ExitCode::SUCCESS;
    for ((task, words), most_kib) in TASKS.into_iter().zip(most_kib) {
        for scalar in ["f32", "f64"] {
            let bytes = most_used("nothing", scalar) - most_used(task, scalar);
            let kib = bytes as f64 / 1024.0;
            println!("{words}, {scalar}: {kib:.2} KiB");
            if scalar == "f32" && kib > most_kib {
                eprintln!("{words} takes {kib:.2} KiB of stack in f32, at most {most_kib} KiB are allowed");
                code = ExitCode::FAILURE;
            }
        }
    }
    code
}
