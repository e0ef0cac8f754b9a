//! Wheel speeds alone, on a simulated drive with a nail in the front left tire after 100 s: what the library writes is what the core says of the
//! same samples, to the last bit.

use std::process::Command;
use std::{fs, ptr};

use itpms_capi::*;
use itpms_core::Real as _;
use itpms_core::model::Corner;
use itpms_core::monitor::MonitoredWheels;
use itpms_core::warning::{Doubt, WheelState};
use itpms_core::wheel_speed::{DrivenAxle, RadiusState, WheelSpeedConfig, WheelSpeedSample};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

use crate::from_c::{compile, crate_folder, library, prints};

const CALIBRATION_S: f64 = 60.0;
const NAIL_S: f64 = 100.0;
/// Of the drive; in that of seed 1 the front wheels seem coupled, and nothing is named.
const SEED: u64 = 2;

/// The drive, and its log as a table.
fn drive() -> (Vec<WheelSpeedSample<itpms_real>>, String) {
    let scenario = crate_folder().join("../../examples/firmware/wheels.toml");
    let rows = Simulation::new(&Scenario::from_file(&scenario).unwrap(), SEED).unwrap();
    let mut table = "time_s,speed_m_s,fl,fr,rl,rr,yaw_rate_rad_s,accel_x_m_s2,accel_y_m_s2,brake".to_owned();
    let samples = rows.map(|row| {
        let (time_s, bus) = (row.time_s, row.wheel_speeds.unwrap());
        let [fl, fr, rl, rr] = bus.wheel_speed_m_s;
        let (yaw, x, y, brake) = (bus.yaw_rate_rad_s, bus.accel_x_m_s2, bus.accel_y_m_s2, bus.brake);
        table += &format!("\n{time_s:?},,{fl:?},{fr:?},{rl:?},{rr:?},{yaw:?},{x:?},{y:?},{brake:?}");
        WheelSpeedSample {
            time_s,
            wheel_speed_m_s: bus.wheel_speed_m_s.map(|speed| speed as itpms_real),
            yaw_rate_rad_s: yaw as itpms_real,
            accel_x_m_s2: x as itpms_real,
            accel_y_m_s2: y as itpms_real,
            brake: Some(brake > 0.0),
        }
    });
    (samples.collect(), table + "\n")
}

fn core() -> MonitoredWheels<itpms_real> {
    let config = WheelSpeedConfig::new(2.7, 1.55, 1.55, DrivenAxle::Front);
    let mut wheels = MonitoredWheels::new(&config).unwrap();
    wheels.begin_calibration(CALIBRATION_S).unwrap();
    wheels
}

fn state(wheels: &MonitoredWheels<itpms_real>, corner: Corner) -> itpms_state {
    match wheels.state_of(corner) {
        WheelState::Unknown(Doubt::Uncertain) => itpms_state::Uncertain,
        WheelState::Unknown(_) => itpms_state::Unknown,
        WheelState::Fine => itpms_state::Fine,
        WheelState::Low => itpms_state::Low,
        other => panic!("{other:?} by wheel speeds"),
    }
}

/// Memory for the library, and the monitor in it.
struct InMemory {
    _memory: Box<[f64]>,
    wheels: *mut itpms_wheels,
}

fn in_memory() -> InMemory {
    let mut memory = vec![f64::NAN; ITPMS_WHEELS_MAX_SIZE / size_of::<f64>()].into_boxed_slice();
    let mut wheels = ptr::null_mut();
    let (place, size) = (memory.as_mut_ptr().cast(), size_of_val(&*memory));
    // SAFETY: an all-zero configuration is one, and every pointer points to what its type says.
    unsafe {
        let mut config: itpms_config = std::mem::zeroed();
        assert_eq!(itpms_config_init(&mut config, size_of::<itpms_config>()), itpms_status::Ok);
        config.wheelbase_m = 2.7;
        config.wheel_speeds.is_used = 1;
        (config.wheel_speeds.track_front_m, config.wheel_speeds.track_rear_m) = (1.55, 1.55);
        let status = itpms_wheels_init(place, size, &config, &mut wheels, ptr::null_mut());
        assert_eq!(status, itpms_status::Ok);
        assert_eq!(itpms_wheels_begin_calibration(wheels, CALIBRATION_S), itpms_status::Ok);
    }
    InMemory { _memory: memory, wheels }
}

fn sample_for_c(sample: &WheelSpeedSample<itpms_real>) -> itpms_wheel_speed_sample {
    itpms_wheel_speed_sample {
        time_s: sample.time_s,
        wheel_speed_m_s: sample.wheel_speed_m_s,
        yaw_rate_rad_s: sample.yaw_rate_rad_s,
        accel_x_m_s2: sample.accel_x_m_s2,
        accel_y_m_s2: sample.accel_y_m_s2,
        brake: if sample.brake == Some(true) { itpms_brake::On } else { itpms_brake::Off } as u32,
    }
}

#[test]
fn the_report_is_the_cores_to_the_last_bit() {
    let (mut core, held) = (core(), in_memory());
    let mut warned_s = None;
    for sample in &drive().0 {
        core.update(sample);
        // SAFETY: an all-zero report is one, and every pointer points to what its type says.
        let told = unsafe {
            let mut report: itpms_radius_report = std::mem::zeroed();
            let status = itpms_wheels_update(held.wheels, &sample_for_c(sample), &mut report);
            assert_eq!(status, itpms_status::Ok);
            report
        };
        let radii = core.radii();
        assert_eq!(told.time_s.to_bits(), sample.time_s.to_bits());
        assert_eq!(told.any_low_probability.to_bits(), radii.any_low_probability.to_bits());
        let low: Vec<Corner> =
            Corner::ALL.into_iter().filter(|corner| told.low_wheels & 1 << corner.index() != 0).collect();
        let (state_reported, wheels) = match radii.state {
            RadiusState::Uncalibrated => (itpms_radius_state::Uncalibrated, vec![]),
            RadiusState::Calibrating => (itpms_radius_state::Calibrating, vec![]),
            RadiusState::Uninformed => (itpms_radius_state::Uninformed, vec![]),
            RadiusState::NoneDiffers => (itpms_radius_state::NoneDiffers, vec![]),
            RadiusState::Low(wheels) => (itpms_radius_state::Low, wheels.iter().collect()),
            RadiusState::OneOf(wheels) => (itpms_radius_state::OneOf, wheels.iter().collect()),
        };
        assert_eq!((told.state, low), (state_reported as u32, wheels), "{} s", sample.time_s);
        for ((corner, told), radius) in Corner::ALL.into_iter().zip(&told.wheels).zip(&radii.wheels) {
            let bits = |values: [itpms_real; 5]| values.map(itpms_real::to_bits);
            assert_eq!(
                bits([
                    told.low_probability,
                    told.radius_change,
                    told.radius_change_sd,
                    told.lost_share,
                    told.lost_share_sd
                ]),
                bits([
                    radius.low_probability,
                    radius.change,
                    radius.change_sd,
                    radius.lost_share,
                    radius.lost_share_sd
                ]),
                "{corner:?} at {} s",
                sample.time_s
            );
            assert_eq!(told.state, state(&core, corner) as u32);
            assert_eq!(told.is_informed == 1, radius.informed());
        }
        if told.wheels[0].state == itpms_state::Low as u32 {
            warned_s = warned_s.or(Some(sample.time_s));
        }
    }
    // The tire has lost a quarter 8.3 s after the nail.
    assert!(warned_s.is_some_and(|s| s > NAIL_S && s < NAIL_S + 30.0), "{warned_s:?}");
}

/// The same by way of the example, compiled as C: its lines and its alert.
#[test]
fn the_example_prints_what_the_core_says() {
    let folder = tempfile::tempdir().unwrap();
    let Some((library, _)) = library(folder.path()) else { return };
    let [program, log, vehicle] = ["wheels", "drive.csv", "car.toml"].map(|name| folder.path().join(name));
    let examples = crate_folder().join("../../examples/c");
    compile(&library, &["wheels.c", "vehicle_file.c"].map(|name| examples.join(name)), &program);
    let (samples, table) = drive();
    fs::write(&log, table).unwrap();
    fs::write(
        &vehicle,
        "[vehicle]\nwheelbase_m = 2.7\ntrack_front_m = 1.55\ntrack_rear_m = 1.55\ndriven = \"front\"\n",
    )
    .unwrap();
    let output =
        Command::new(&program).arg(&log).arg(&vehicle).arg(CALIBRATION_S.to_string()).output().unwrap();
    let printed = prints(&output);
    let mut lines = printed.lines().skip(1);
    let mut core = core();
    let (mut next_s, mut alerts, mut reported) = (f64::NEG_INFINITY, String::new(), None);
    for sample in &samples {
        core.update(sample);
        if core.alert() != reported {
            reported = core.alert();
            alerts += &reported.map_or(String::new(), |alert| format!("{alert}\n"));
        }
        if sample.time_s < next_s {
            continue;
        }
        next_s = sample.time_s + 0.5 - 1e-9;
        let line: Vec<&str> = lines.next().unwrap().split(',').collect();
        assert_eq!(line.len(), 13);
        for (i, radius) in core.radii().wheels.iter().enumerate() {
            let number = |cell: usize| line[1 + 3 * i + cell].parse::<f64>().unwrap();
            let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
            assert!(same(number(0), radius.lost_share.to_f64()), "{line:?}");
            assert!(same(number(1), radius.lost_share_sd.to_f64()), "{line:?}");
        }
    }
    assert!(lines.next().is_none() && samples.len() == 18_000);
    assert!(alerts.starts_with("fl differs from the other tires since the calibration"), "{alerts}");
    assert_eq!(String::from_utf8_lossy(&output.stderr), alerts);
}

#[test]
fn it_takes_at_most_five_kibibytes() {
    let most = if cfg!(feature = "f64") { 10_240 } else { 5_120 };
    assert!(itpms_wheels_size() <= most, "{}", itpms_wheels_size());
}
