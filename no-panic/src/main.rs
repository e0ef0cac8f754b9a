//! Links only if nothing in a car's life can panic: `cd no-panic && cargo build --release`.
//!
//! The panic handler calls a function that does not exist. Where the compiler can prove that no panic is ever reached, the handler is left
//! out and with it the call; where one is left, the linker says so. Nothing is run. `--features left` puts one in: then it must not link.
//! `--features count` has a handler that links, so that `.ci/no_panic.py` can say where panics are left.
#![no_std]
#![no_main]

use core::panic::PanicInfo;

use itpms_core::model::{Corner, VehicleCalibration};
use itpms_core::monitor::MonitoredWheels;
use itpms_core::torsion::{CarTorsion, TorsionCalibration, TorsionConfig, TorsionWheel};
use itpms_core::warning::MonitorReport;
use itpms_core::wheel_speed::{RadiusCalibration, WheelSpeedConfig, WheelSpeedSample};
use itpms_core::{CarSample, MonitorConfig, MonitoredCar};

/// What a controller calls: the car configured where it lies, its stored calibration, a calibration drive, its samples, what it
/// says. Returns how many of the wheels are reported on.
#[unsafe(no_mangle)]
extern "C" fn car(
    car: &mut MonitoredCar<f32, Option<&'static mut CarTorsion<f32>>>,
    config: &MonitorConfig<f32>,
    calibration: &VehicleCalibration<f32>,
    sample: &CarSample<f32>,
    rate_hz: f64,
) -> usize {
    if car.configure(config, rate_hz).is_err() || car.load_calibration(calibration).is_err() {
        return 0;
    }
    let estimate = car.update(sample);
    if car.begin_calibration(sample.time_s).is_ok() {
        car.end_calibration();
    }
    #[cfg(feature = "left")]
    core::hint::black_box([0u8; 4][sample.time_s as usize]);
    estimate.corners.iter().flatten().count()
        + car.report().wheels.iter().flatten().count()
        + car.wheels_mut().map_or(0, |wheels| usize::from(wheels.alert().is_some()))
}

/// The same of the tooth pulses of one wheel.
#[unsafe(no_mangle)]
extern "C" fn wheel(wheel: &mut TorsionWheel<f32>, config: &TorsionConfig<f32>, edge_s: f64) -> usize {
    let Ok(new) = TorsionWheel::new(config) else { return 0 };
    *wheel = new;
    wheel.begin_calibration();
    let piece = wheel.push(edge_s);
    wheel.end_calibration();
    usize::from(piece.is_some_and(|piece| piece.used))
        + usize::from(wheel.change().is_some())
        + wheel.tooth_errors().len()
}

/// The same of a car's four.
#[unsafe(no_mangle)]
extern "C" fn wheels(
    car: &mut CarTorsion<f32>,
    configs: &[TorsionConfig<f32>; 4],
    placard_kpa: &[f32; 4],
    learned: &[Option<(TorsionCalibration<f32>, f32)>; 4],
    corner: &Corner,
    edge_s: f64,
) -> usize {
    if car.configure(configs, placard_kpa).is_err() || !car.load_calibration(learned) {
        return 0;
    }
    car.begin_calibration_at(placard_kpa);
    let piece = car.push(*corner, edge_s);
    let known = car.changes().iter().flatten().count() + car.calibration().iter().flatten().count();
    car.end_calibration() + usize::from(piece.is_some()) + known
}

/// The same of four wheel speeds, with the pulses' evidence and without.
#[unsafe(no_mangle)]
extern "C" fn speeds(
    speeds: &mut MonitoredWheels<f32>,
    config: &WheelSpeedConfig<f32>,
    learned: &RadiusCalibration<f32>,
    sample: &WheelSpeedSample<f32>,
    torsion: &mut CarTorsion<f32>,
    report: &mut MonitorReport<f32>,
) -> usize {
    if speeds.configure(config).is_err() || !speeds.load_calibration(learned) {
        return 0;
    }
    if speeds.begin_calibration_at(sample.time_s, &sample.wheel_speed_m_s).is_ok() {
        speeds.update(sample);
    }
    speeds.update_with_pulses(sample, Some(torsion));
    speeds.write_report_into(report);
    usize::from(speeds.end_calibration())
        + usize::from(speeds.calibration().is_some())
        + usize::from(speeds.alert().is_some())
        + report.wheels.iter().flatten().count()
}

#[cfg(not(feature = "count"))]
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_left() -> !;
    }
    // SAFETY: never called, as a program with this call does not link.
    unsafe { a_panic_is_left() }
}

#[cfg(feature = "count")]
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}
