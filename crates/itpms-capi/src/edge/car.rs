//! The functions of a car.

use core::ffi::{c_char, c_void};

use super::{
    init, itpms_problem, put_alert_text, put_alerts, put_calibration, put_events, read_calibration, with,
};
use crate::alert::{itpms_alert, itpms_event};
use crate::car::Car;
use crate::cold::{itpms_air, itpms_cold_report};
use crate::config::itpms_config;
use crate::estimate::itpms_estimate;
use crate::kept::Kept as _;
use crate::pointer::{self, Memory, bytes, bytes_mut, itpms_car, put, read};
use crate::sample::{itpms_sample, itpms_wheel_speed_sample};
use crate::status::itpms_status;

/// Bytes of memory that a car takes; at most `ITPMS_CAR_MAX_SIZE`.
#[unsafe(no_mangle)]
pub extern "C" fn itpms_car_size() -> usize {
    size_of::<Memory<Car>>()
}

/// Alignment in bytes of that memory; at most that of a `double`, or of a pointer where that is more.
#[unsafe(no_mangle)]
pub extern "C" fn itpms_car_align() -> usize {
    align_of::<Memory<Car>>()
}

/// Makes a car of `size` bytes of memory, which stays the caller's and may not move while the car is used; `*car` is what the other
/// functions take. Takes some 11 KiB of stack in `float`. What was in the memory is forgotten.
///
/// `problem` may be null; else it says what is wrong with the configuration. Errors: NULL_POINTER, MISALIGNED (memory by
/// `itpms_car_align`), TOO_SMALL, WRONG_SIZE, WRONG_VERSION, BAD_PARAMETER, BAD_CHOICE; there is no car then.
///
/// # Safety
/// Every pointer is null or points to memory of its type, `memory` to `size` bytes that nothing else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_init(
    memory: *mut c_void,
    size: usize,
    config: *const itpms_config,
    car: *mut *mut itpms_car,
    problem: *mut itpms_problem,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { init(memory, size, config, car, problem) }
}

/// Takes a sample of the accelerometers and writes what is known after it; `estimate` may be null. Values that are NaN are missing.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NO_CORNERS, BAD_TIME (the sample is left out).
///
/// # Safety
/// Every pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_update(
    car: *mut itpms_car,
    sample: *const itpms_sample,
    estimate: *mut itpms_estimate,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe {
        with(car, |car| {
            car.update(read(sample)?)?;
            if estimate.is_null() { Ok(()) } else { put(estimate, car.estimate()) }
        })
    }
}

/// Takes a sample of the wheel speeds.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NO_WHEEL_SPEEDS, BAD_TIME and BAD_CHOICE (the sample is left out).
///
/// # Safety
/// Every pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_update_wheel_speeds(
    car: *mut itpms_car,
    sample: *const itpms_wheel_speed_sample,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, |car| car.update_wheel_speeds(read(sample)?)) }
}

/// Takes the air around the car, as often as it is measured, before the sample of that time: its last values hold for half an hour.
/// Impossible ones count as missing. Where the temperature is known there are cold pressures, and warnings go by them
/// (docs/cold-pressure.md).
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NO_CORNERS.
///
/// # Safety
/// Every pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_update_air(car: *mut itpms_car, air: *const itpms_air) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, |car| car.update_air(read(air)?)) }
}

/// Writes what the tires would have cold, after the last sample.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.
///
/// # Safety
/// Every pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_cold(car: *mut itpms_car, report: *mut itpms_cold_report) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, |car| put(report, car.cold())) }
}

/// Writes what is known after the last sample.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.
///
/// # Safety
/// Every pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_estimate(
    car: *mut itpms_car,
    estimate: *mut itpms_estimate,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, |car| put(estimate, car.estimate())) }
}

/// Writes the alerts that stand, up to `capacity`, and into `*count` how many there are: at most 27.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL (`*count` says what it takes; the first ones are written).
///
/// # Safety
/// Every pointer is null or points to what its type says, `alerts` to `capacity` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_alerts(
    car: *mut itpms_car,
    alerts: *mut itpms_alert,
    capacity: usize,
    count: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { put_alerts(car, alerts, capacity, count) }
}

/// Writes the alert `index` of those that stand as a sentence in English, ended by a zero. `*length` (may be null) becomes the bytes that
/// all of it takes with its zero: some 200.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_INDEX, TOO_SMALL (the beginning is written).
///
/// # Safety
/// Every pointer is null or points to what its type says, `text` to `capacity` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_alert_text(
    car: *mut itpms_car,
    index: usize,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { put_alert_text(car, index, text, capacity, length) }
}

/// Writes what alerts began or ended since this was last called, and into `*count` how many did: at most 54.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL (`*count` says what it takes; nothing is written, and nothing is lost).
///
/// # Safety
/// Every pointer is null or points to what its type says, `events` to `capacity` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_events(
    car: *mut itpms_car,
    events: *mut itpms_event,
    capacity: usize,
    count: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { put_events(car, events, capacity, count) }
}

/// All tires have their placard pressures from the next sample on, for so many seconds (600 are usual), in which the car should be driven:
/// what it differs by from its configuration is learned.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_DURATION.
///
/// # Safety
/// `car` is null or a car.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_begin_calibration(car: *mut itpms_car, seconds: f64) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, |car| car.begin_calibration(seconds)) }
}

/// Ends the calibration that is under way with what it has seen.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NOT_CALIBRATED (it is ended, and taught nothing).
///
/// # Safety
/// `car` is null or a car.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_end_calibration(car: *mut itpms_car) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, Car::end_calibration) }
}

/// Writes what a calibration taught, once it is over, to be stored: some hundred bytes, at most `ITPMS_CALIBRATION_MAX_SIZE`; `*written`
/// becomes how many.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NOT_CALIBRATED, TOO_SMALL.
///
/// # Safety
/// Every pointer is null or points to what its type says, `memory` to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_save_calibration(
    car: *mut itpms_car,
    memory: *mut c_void,
    size: usize,
    written: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { put_calibration(car, memory, size, written) }
}

/// Begins a drive with a stored calibration, before the first sample.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, DAMAGED, OTHER_FORMAT, OTHER_CAR, IMPLAUSIBLE, TOO_LATE.
///
/// # Safety
/// Every pointer is null or points to what its type says, `memory` to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_load_calibration(
    car: *mut itpms_car,
    memory: *const c_void,
    size: usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { read_calibration(car, memory, size) }
}

/// Bytes that `itpms_car_save_state` takes now; 0 if `car` is no car.
///
/// # Safety
/// `car` is null or a car.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_state_size(car: *mut itpms_car) -> usize {
    // SAFETY: the caller's promise.
    unsafe { pointer::kept(car) }.map_or(0, |car| car.state_size())
}

/// Writes all that a car knows, configuration included, with a version and a checksum: it goes on from there to the same bits.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL.
///
/// # Safety
/// Every pointer is null or points to what its type says, `memory` to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_save_state(
    car: *mut itpms_car,
    memory: *mut c_void,
    size: usize,
    written: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, |car| put(written, car.save_state(bytes_mut(memory, size)?)?)) }
}

/// Goes on from a state that was saved by the same version of the library in the same precision. `car` has been made with any
/// configuration; it gets that of the state. Takes several times `itpms_car_size` of stack: a small controller keeps the car's memory
/// itself instead.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, DAMAGED, OTHER_FORMAT.
///
/// # Safety
/// Every pointer is null or points to what its type says, `memory` to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_restore_state(
    car: *mut itpms_car,
    memory: *const c_void,
    size: usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, |car| car.restore_state(bytes(memory, size)?)) }
}

/// Begins anew with the configuration that the car was made with; a calibration is forgotten.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.
///
/// # Safety
/// `car` is null or a car.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_reset(car: *mut itpms_car) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(car, Car::reset) }
}
