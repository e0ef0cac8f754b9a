//! The functions of wheel speeds alone.

use core::ffi::{c_char, c_void};

use super::{
    init, itpms_problem, put_alert_text, put_alerts, put_calibration, put_events, read_calibration, with,
};
use crate::alert::{itpms_alert, itpms_event};
use crate::config::itpms_config;
use crate::kept::Kept as _;
use crate::pointer::{Memory, itpms_wheels, put, read};
use crate::radii::itpms_radius_report;
use crate::sample::itpms_wheel_speed_sample;
use crate::status::itpms_status;
use crate::wheels::Wheels;

/// Bytes of memory that wheel speeds alone take; at most `ITPMS_WHEELS_MAX_SIZE`.
#[unsafe(no_mangle)]
pub extern "C" fn itpms_wheels_size() -> usize {
    size_of::<Memory<Wheels>>()
}

/// Alignment in bytes of that memory; at most that of a `double`.
#[unsafe(no_mangle)]
pub extern "C" fn itpms_wheels_align() -> usize {
    align_of::<Memory<Wheels>>()
}

/// Makes a monitor of wheel speeds of `size` bytes of memory, as `itpms_car_init` makes a car. Of the configuration `wheelbase_m` and
/// `wheel_speeds` are read, and nothing else.
///
/// `problem` may be null; else it says what is wrong with the configuration. Errors: NULL_POINTER, MISALIGNED (memory by
/// `itpms_wheels_align`), TOO_SMALL, WRONG_SIZE, WRONG_VERSION, BAD_PARAMETER, BAD_CHOICE; there is no monitor then.
///
/// # Safety
/// Every pointer is null or points to memory of its type, `memory` to `size` bytes that nothing else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_init(
    memory: *mut c_void,
    size: usize,
    config: *const itpms_config,
    wheels: *mut *mut itpms_wheels,
    problem: *mut itpms_problem,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { init(memory, size, config, wheels, problem) }
}

/// Takes a sample and writes what is known after it; `report` may be null. Values that are NaN are missing.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_TIME and BAD_CHOICE (the sample is left out).
///
/// # Safety
/// Every pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_update(
    wheels: *mut itpms_wheels,
    sample: *const itpms_wheel_speed_sample,
    report: *mut itpms_radius_report,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe {
        with(wheels, |wheels| {
            wheels.update(read(sample)?)?;
            if report.is_null() { Ok(()) } else { put(report, wheels.report()) }
        })
    }
}

/// Writes what is known after the last sample.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.
///
/// # Safety
/// Every pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_report(
    wheels: *mut itpms_wheels,
    report: *mut itpms_radius_report,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(wheels, |wheels| put(report, wheels.report())) }
}

/// As `itpms_car_alerts`; there is at most 1.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL (`*count` says what it takes).
///
/// # Safety
/// Every pointer is null or points to what its type says, `alerts` to `capacity` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_alerts(
    wheels: *mut itpms_wheels,
    alerts: *mut itpms_alert,
    capacity: usize,
    count: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { put_alerts(wheels, alerts, capacity, count) }
}

/// As `itpms_car_alert_text`.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_INDEX, TOO_SMALL (the beginning is written).
///
/// # Safety
/// Every pointer is null or points to what its type says, `text` to `capacity` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_alert_text(
    wheels: *mut itpms_wheels,
    index: usize,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { put_alert_text(wheels, index, text, capacity, length) }
}

/// As `itpms_car_events`; there are at most 2.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, TOO_SMALL (`*count` says what it takes; nothing is written, and nothing is lost).
///
/// # Safety
/// Every pointer is null or points to what its type says, `events` to `capacity` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_events(
    wheels: *mut itpms_wheels,
    events: *mut itpms_event,
    capacity: usize,
    count: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { put_events(wheels, events, capacity, count) }
}

/// All tires have the pressures they should have from the next sample on, for so many seconds (600 are usual), in which the car should
/// be driven: how the tires differ is learned. Nothing is reported without.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, BAD_DURATION.
///
/// # Safety
/// `wheels` is null or was made by `itpms_wheels_init`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_begin_calibration(
    wheels: *mut itpms_wheels,
    seconds: f64,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(wheels, |wheels| wheels.begin_calibration(seconds)) }
}

/// Ends the calibration that is under way with what it has seen; that takes 10 s of driving at least.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NOT_CALIBRATED (it is ended, and taught nothing).
///
/// # Safety
/// `wheels` is null or was made by `itpms_wheels_init`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_end_calibration(wheels: *mut itpms_wheels) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(wheels, Wheels::end_calibration) }
}

/// Writes what a calibration taught, once it is over, to be stored: 201 bytes in `float`, 385 in `double`; `*written` becomes how many.
/// It is not the calibration of a car, and no car takes it.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, NOT_CALIBRATED, TOO_SMALL.
///
/// # Safety
/// Every pointer is null or points to what its type says, `memory` to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_save_calibration(
    wheels: *mut itpms_wheels,
    memory: *mut c_void,
    size: usize,
    written: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { put_calibration(wheels, memory, size, written) }
}

/// Begins a drive with a stored calibration, before the first sample.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, DAMAGED, OTHER_FORMAT, IMPLAUSIBLE, TOO_LATE.
///
/// # Safety
/// Every pointer is null or points to what its type says, `memory` to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_load_calibration(
    wheels: *mut itpms_wheels,
    memory: *const c_void,
    size: usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { read_calibration(wheels, memory, size) }
}

/// Begins anew with the configuration that the monitor was made with; a calibration is forgotten.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR.
///
/// # Safety
/// `wheels` is null or was made by `itpms_wheels_init`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_wheels_reset(wheels: *mut itpms_wheels) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(wheels, Wheels::reset) }
}
