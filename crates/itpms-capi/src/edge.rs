//! The functions that C calls.
#![allow(unsafe_code)]

use core::ffi::{CStr, c_char, c_void};

use crate::alert::{itpms_alert, itpms_event, write_text};
use crate::car::Car;
use crate::config::itpms_config;
use crate::estimate::itpms_estimate;
use crate::pointer::{self, bytes, bytes_mut, check, itpms_car, put, read};
use crate::read_config::{Config, Refusal};
use crate::sample::{itpms_sample, itpms_wheel_speed_sample};
use crate::status::{self, itpms_status};

/// What is wrong with a configuration.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_problem {
    /// What was given.
    pub value: f64,
    /// The corner it is about: 0 front left, 1 front right, 2 rear left, 3 rear right; 4: none.
    pub corner: u32,
    /// The parameter's name, ended by a zero; empty where it is about none.
    pub parameter: [c_char; 48],
    /// What would be accepted, ended by a zero.
    pub expected: [c_char; 48],
}

fn status(result: Result<(), itpms_status>) -> itpms_status {
    result.err().unwrap_or(itpms_status::Ok)
}

/// The library's version, as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn itpms_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => c"",
        };
    VERSION.as_ptr()
}

/// A status as a sentence in English, for any number.
#[unsafe(no_mangle)]
pub extern "C" fn itpms_status_text(status: u32) -> *const c_char {
    status::text(status).as_ptr()
}

/// Bytes of memory that a car takes; at most `ITPMS_CAR_MAX_SIZE`.
#[unsafe(no_mangle)]
pub extern "C" fn itpms_car_size() -> usize {
    size_of::<Car>()
}

/// Alignment in bytes of that memory; at most that of a `double`, or of a pointer where that is more.
#[unsafe(no_mangle)]
pub extern "C" fn itpms_car_align() -> usize {
    align_of::<Car>()
}

/// Fills a configuration with its defaults: what is not known is NaN, no corner is measured, no wheel speed used.
///
/// `struct_size` is `sizeof *config`. Errors: NULL_POINTER, MISALIGNED, WRONG_SIZE (nothing is written then).
///
/// # Safety
/// `config` is null or points to `struct_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_config_init(config: *mut itpms_config, struct_size: usize) -> itpms_status {
    if struct_size != itpms_config::SIZE {
        return itpms_status::WrongSize;
    }
    // SAFETY: the caller's promise.
    status(unsafe { put(config, itpms_config::unknown()) })
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
    let refusal = match unsafe { init(memory, size, config, car) } {
        Ok(()) => return itpms_status::Ok,
        Err(refusal) => refusal,
    };
    // SAFETY: the caller's promise. Without a place for it the problem goes unsaid.
    let _ = unsafe { put(problem, refusal.problem()) };
    refusal.status
}

/// # Safety
/// As for `itpms_car_init`.
unsafe fn init(
    memory: *mut c_void,
    size: usize,
    config: *const itpms_config,
    car: *mut *mut itpms_car,
) -> Result<(), Refusal> {
    let place = memory.cast::<Car>();
    check(place)?;
    check(car)?;
    // The size stands first, so that no more is read than there is.
    check(config)?;
    // SAFETY: the caller's promise.
    if unsafe { (&raw const (*config).struct_size).read() } as usize != itpms_config::SIZE {
        return Err(itpms_status::WrongSize.into());
    }
    // SAFETY: the caller's promise, for a struct of this size.
    let config = unsafe { read(config) }?;
    if config.api_version != crate::ITPMS_API_VERSION {
        return Err(itpms_status::WrongVersion.into());
    }
    if size < size_of::<Car>() {
        return Err(itpms_status::TooSmall.into());
    }
    // SAFETY: as large as a car, aligned for one, and the caller's to give.
    let made = unsafe {
        Car::blank(place);
        &mut *place
    };
    made.configure(&Config::read(config)?)?;
    // SAFETY: the caller's promise.
    unsafe { put(car, place.cast()) }?;
    Ok(())
}

impl Refusal {
    fn problem(&self) -> itpms_problem {
        let text = |text: &str| {
            let mut bytes = [0; 48];
            write_text(&mut bytes, text);
            bytes.map(|byte| byte as c_char)
        };
        let (name, value, expected) =
            self.error.as_ref().map_or(("", f64::NAN, ""), |error| (error.name, error.value, error.expected));
        itpms_problem { value, corner: self.corner as u32, parameter: text(name), expected: text(expected) }
    }
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
    status(unsafe {
        pointer::car(car).and_then(|car| {
            car.update(read(sample)?)?;
            if estimate.is_null() { Ok(()) } else { put(estimate, car.estimate()) }
        })
    })
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
    status(unsafe { pointer::car(car).and_then(|car| car.update_wheel_speeds(read(sample)?)) })
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
    status(unsafe { pointer::car(car).and_then(|car| put(estimate, car.estimate())) })
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
    // SAFETY: the caller's promise; no place is written beyond `capacity`.
    status(unsafe {
        pointer::car(car).and_then(|car| {
            let report = car.report();
            for (i, alert) in report.alerts().take(capacity).enumerate() {
                put(alerts.wrapping_add(i), alert.into())?;
            }
            let there_are = report.alerts().count();
            put(count, there_are)?;
            if there_are > capacity { Err(itpms_status::TooSmall) } else { Ok(()) }
        })
    })
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
    status(unsafe {
        pointer::car(car).and_then(|car| {
            let report = car.report();
            let alert = report.alerts().nth(index).ok_or(itpms_status::BadIndex)?;
            let takes = write_text(bytes_mut(text.cast(), capacity)?, alert);
            if !length.is_null() {
                put(length, takes)?;
            }
            if takes > capacity { Err(itpms_status::TooSmall) } else { Ok(()) }
        })
    })
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
    // SAFETY: the caller's promise; no place is written beyond `capacity`.
    status(unsafe {
        pointer::car(car).and_then(|car| {
            check(events)?;
            check(count)?;
            let (there_are, result) =
                car.events(capacity, |i, change| events.wrapping_add(i).write(change.into()));
            put(count, there_are)?;
            result
        })
    })
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
    status(unsafe { pointer::car(car).and_then(|car| car.begin_calibration(seconds)) })
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
    status(unsafe { pointer::car(car).and_then(Car::end_calibration) })
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
    status(unsafe {
        pointer::car(car).and_then(|car| put(written, car.save_calibration(bytes_mut(memory, size)?)?))
    })
}

/// Begins a drive with a stored calibration, before the first sample.
///
/// Errors: NULL_POINTER, MISALIGNED, NOT_A_CAR, DAMAGED, OTHER_FORMAT, OTHER_CAR, IMPLAUSIBLE.
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
    status(unsafe { pointer::car(car).and_then(|car| car.load_calibration(bytes(memory, size)?)) })
}

/// Bytes that `itpms_car_save_state` takes now; 0 if `car` is no car.
///
/// # Safety
/// `car` is null or a car.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn itpms_car_state_size(car: *mut itpms_car) -> usize {
    // SAFETY: the caller's promise.
    unsafe { pointer::car(car) }.map_or(0, |car| car.state_size())
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
    status(unsafe {
        pointer::car(car).and_then(|car| put(written, car.save_state(bytes_mut(memory, size)?)?))
    })
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
    status(unsafe { pointer::car(car).and_then(|car| car.restore_state(bytes(memory, size)?)) })
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
    status(unsafe { pointer::car(car).and_then(Car::reset) })
}
