//! The library as C programs use it: compiled by gcc as C99 without a warning, linked with this build's static library. Skipped, and reported
//! to be, where there is no gcc.

use std::ffi::OsStr;
use std::fs;
use std::mem::offset_of;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::SystemTime;

use itpms_capi::*;
use itpms_core::Real as _;
use itpms_core::model::{CarConfig, CarSample, CornerConfig, QuarterCar};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

const WARNINGS: [&str; 5] = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"];

/// What a program prints, if it ends well.
pub(crate) fn prints(output: &Output) -> String {
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{}\n{out}{err}", output.status);
    out.into_owned()
}

pub(crate) fn crate_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// Compiles a program of these sources with a library.
pub(crate) fn compile(library: &Path, sources: &[PathBuf], program: &Path) {
    let precision = if cfg!(feature = "f64") { "-DITPMS_F64" } else { "-DITPMS_F32" };
    let mut gcc = Command::new("gcc");
    gcc.args(WARNINGS).args(["-O1", precision, "-I"]).arg(crate_folder().join("include")).args(sources);
    gcc.arg(library).args(["-lm", "-lpthread", "-ldl", "-o"]).arg(program);
    prints(&gcc.output().unwrap());
}

/// The static library of this build and what `layout.c` prints with it; `None` without gcc. Of several that other features have left the
/// newest one in this precision is of the present sources.
pub(crate) fn library(folder: &Path) -> Option<(PathBuf, String)> {
    if Command::new("gcc").arg("--version").output().is_err() {
        eprintln!("SKIPPED: there is no gcc");
        return None;
    }
    let built = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let is_one = |path: &PathBuf| {
        let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
        name.starts_with("libitpms_capi") && name.ends_with(".a")
    };
    let changed = |path: &PathBuf| {
        fs::metadata(path).and_then(|data| data.modified()).unwrap_or(SystemTime::UNIX_EPOCH)
    };
    let mut libraries: Vec<PathBuf> =
        fs::read_dir(built).unwrap().map(|entry| entry.unwrap().path()).filter(is_one).collect();
    libraries.sort_by_key(changed);
    let program = folder.join("layout");
    for library in libraries.into_iter().rev() {
        compile(&library, &[crate_folder().join("tests/c/layout.c")], &program);
        let output = Command::new(&program).output().unwrap();
        if output.status.code() != Some(3) {
            return Some((library, prints(&output)));
        }
    }
    panic!("no static library beside the test program");
}

#[test]
fn structs_lie_in_c_as_they_do_here() {
    let folder = tempfile::tempdir().unwrap();
    let Some((_, printed)) = library(folder.path()) else { return };
    macro_rules! lies {
        ($($name:ident $last:ident)*) => {
            [$(format!("{} {} {}", stringify!($name), size_of::<$name>(), offset_of!($name, $last))),*]
        };
    }
    let here = lies!(
        itpms_corner_config tire_damping_sd_n_s_per_m
        itpms_wheel_speed_config load_front_passengers_sd
        itpms_config home_altitude_m
        itpms_air altitude_m
        itpms_cold_wheel add_kpa
        itpms_cold_report wheels
        itpms_sample wheel_accel_m_s2
        itpms_wheel_speed_sample brake
        itpms_wheel radius_lost_share_sd
        itpms_estimate low_wheels
        itpms_wheel_radius lost_share_sd
        itpms_radius_report loads_may_differ
        itpms_alert probability
        itpms_event alert
        itpms_problem expected
    );
    assert_eq!(printed.lines().collect::<Vec<_>>(), here);
}

#[test]
fn every_promise_of_the_header_holds() {
    let folder = tempfile::tempdir().unwrap();
    let Some((library, _)) = library(folder.path()) else { return };
    for name in ["contract", "wheels_contract"] {
        let program = folder.path().join(name);
        compile(&library, &[crate_folder().join("tests/c").join(name).with_extension("c")], &program);
        assert_eq!(prints(&Command::new(&program).output().unwrap()), "0 broken\n", "{name}");
    }
}

/// The car of `drive-puncture`, as its vehicle file has it.
fn puncture_car() -> MonitorConfig<itpms_real> {
    let front = CornerConfig::<itpms_real>::paper();
    let car = front.quarter_car;
    let rear = QuarterCar::new(216.0, 50.0, car.damping_n_s_per_m(), car.spring_n_per_m()).unwrap();
    let rear = CornerConfig { quarter_car: rear, ..front };
    MonitorConfig::new(&CarConfig {
        corners: [Some(front), Some(front), Some(rear), Some(rear)],
        wheelbase_m: Some(2.7),
    })
}

const VEHICLE: &str = "
[vehicle]
name = \"of drive-puncture\"
wheelbase_m = 2.7
confidence = \"measured\"
[tire]
stiffness_per_kpa = 713.91 # N/m per kPa
stiffness_at_zero = 60880.0
";

/// The example's log and vehicle file, and the samples in its log.
fn drive(log: &Path, vehicle: &Path) -> (f64, Vec<CarSample<itpms_real>>) {
    let mut text = VEHICLE.to_owned();
    for (label, masses) in
        [("fl", [240.8, 56.9]), ("fr", [240.8, 56.9]), ("rl", [216.0, 50.0]), ("rr", [216.0, 50.0])]
    {
        let [sprung, unsprung] = masses;
        text += &format!("[corner.{label}]\nsprung_mass_kg = {sprung:?}\nunsprung_mass_kg = {unsprung:?}\n");
        text += "damping_n_s_per_m = 925.8\nspring_n_per_m = 29114.0\nplacard_kpa = 241.3\naccel_noise_m_s2 = 0.05\n";
    }
    fs::write(vehicle, text).unwrap();
    let scenario = Scenario { duration_s: 26.0, ..Scenario::builtin("drive-puncture").unwrap() };
    let rows = Simulation::new(&scenario, 3).unwrap();
    let mut table = "time_s,speed_m_s".to_owned();
    for label in ["fl", "fr", "rl", "rr"] {
        table += &format!(",{label}_body_accel_m_s2,{label}_wheel_accel_m_s2");
    }
    let mut samples = Vec::new();
    for row in rows {
        let sample = row.car_sample();
        table += &format!("\n{:?},{:?}", sample.time_s, sample.speed_m_s);
        for corner in sample.corners.iter().flatten() {
            table += &format!(",{:?},{:?}", corner.body_accel_m_s2, corner.wheel_accel_m_s2);
        }
        let narrowed = sample.corners.map(|corner| {
            corner.map(|corner| itpms_core::CornerSample {
                body_accel_m_s2: corner.body_accel_m_s2 as itpms_real,
                wheel_accel_m_s2: corner.wheel_accel_m_s2 as itpms_real,
            })
        });
        samples.push(CarSample {
            time_s: sample.time_s,
            speed_m_s: sample.speed_m_s as itpms_real,
            corners: narrowed,
            wheel_speeds: None,
        });
    }
    fs::write(log, table + "\n").unwrap();
    (scenario.rate_hz, samples)
}

/// The example's lines to the last bit: what it prints is what the core says of the same samples.
#[test]
fn the_example_prints_what_the_core_estimates() {
    let folder = tempfile::tempdir().unwrap();
    let Some((library, _)) = library(folder.path()) else { return };
    let [program, log, vehicle] = ["pressures", "drive.csv", "car.toml"].map(|name| folder.path().join(name));
    let sources =
        ["pressures.c", "vehicle_file.c"].map(|name| crate_folder().join("../../examples/c").join(name));
    compile(&library, &sources, &program);
    let (rate_hz, samples) = drive(&log, &vehicle);
    let output = Command::new(&program).arg(&log).arg(&vehicle).arg("5").output().unwrap();
    let printed = prints(&output);
    let mut lines = printed.lines().skip(1);
    let mut car = Box::new(MonitoredCar::unconfigured());
    car.configure(&puncture_car(), rate_hz).unwrap();
    car.begin_calibration(5.0).unwrap();
    let (mut next_s, mut compared) = (f64::NEG_INFINITY, 0);
    for sample in &samples {
        let estimate = car.update(sample);
        if sample.time_s < next_s {
            continue;
        }
        next_s = sample.time_s + 0.1 - 1e-9;
        let line: Vec<&str> = lines.next().unwrap().split(',').collect();
        assert_eq!(line.len(), 13);
        for (i, corner) in estimate.corners.iter().flatten().enumerate() {
            let number = |cell: usize| line[1 + 3 * i + cell].parse::<f64>().unwrap();
            // Both are NaN at first.
            assert_eq!(number(0).to_bits(), corner.pressure_kpa.to_f64().to_bits(), "{line:?}");
            assert_eq!(number(1).to_bits(), corner.pressure_sd_kpa.to_f64().to_bits(), "{line:?}");
            assert_eq!(line[3 + 3 * i], car.report().wheels[i].unwrap().state.label());
            compared += 1;
        }
    }
    assert!(compared >= 4 * 260 && lines.next().is_none());
    // The nail at 20 s.
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("fl under-inflated: "));
    assert_eq!(samples.len(), 13_000);
}
