//! The functions that C calls. What both kinds of memory do stands here, once.
#![allow(unsafe_code)]

mod car;
mod wheels;

use core::ffi::{CStr, c_char, c_void};

pub use self::car::*;
pub use self::wheels::*;
use crate::alert::{itpms_alert, itpms_event, write_text};
use crate::config::itpms_config;
use crate::kept::Kept;
use crate::pointer::{self, Handle, bytes, bytes_mut, check, put, read};
use crate::read_config::Refusal;
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

/// What a call does with what its first pointer stands for.
///
/// # Safety
/// `handle` is null or was made by an init; nothing else uses it now.
unsafe fn with<H: Handle>(
    handle: *mut H,
    call: impl FnOnce(&mut H::Kept) -> Result<(), itpms_status>,
) -> itpms_status {
    // SAFETY: the caller's promise.
    status(unsafe { pointer::kept(handle) }.and_then(call))
}

/// # Safety
/// As for `itpms_car_init`.
unsafe fn init<H: Handle>(
    memory: *mut c_void,
    size: usize,
    config: *const itpms_config,
    handle: *mut *mut H,
    problem: *mut itpms_problem,
) -> itpms_status {
    if !problem.is_aligned() {
        return itpms_status::Misaligned;
    }
    // SAFETY: the caller's promise.
    let refusal = match unsafe { make(memory, size, config, handle) } {
        Ok(()) => return itpms_status::Ok,
        Err(refusal) => refusal,
    };
    // SAFETY: the caller's promise. Without a place for it the problem goes unsaid.
    let _ = unsafe { put(problem, refusal.problem()) };
    refusal.status
}

/// # Safety
/// As for `itpms_car_init`.
unsafe fn make<H: Handle>(
    memory: *mut c_void,
    size: usize,
    config: *const itpms_config,
    handle: *mut *mut H,
) -> Result<(), Refusal> {
    check(memory.cast::<u8>())?;
    check(handle)?;
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
    // SAFETY: the caller's promise.
    unsafe { put(handle, pointer::make(memory, size, config)?) }?;
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

/// # Safety
/// As for `itpms_car_alerts`.
unsafe fn put_alerts<H: Handle>(
    handle: *mut H,
    alerts: *mut itpms_alert,
    capacity: usize,
    count: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise; no place is written beyond `capacity`.
    unsafe {
        with(handle, |kept| {
            let (mut there_are, mut written) = (0, Ok(()));
            kept.alerts(|i, alert| {
                if i < capacity && written.is_ok() {
                    written = put(alerts.wrapping_add(i), alert.into());
                }
                there_are = i + 1;
            });
            written?;
            put(count, there_are)?;
            if there_are > capacity { Err(itpms_status::TooSmall) } else { Ok(()) }
        })
    }
}

/// # Safety
/// As for `itpms_car_alert_text`.
unsafe fn put_alert_text<H: Handle>(
    handle: *mut H,
    index: usize,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe {
        with(handle, |kept| {
            let mut takes = Err(itpms_status::BadIndex);
            kept.alerts(|i, alert| {
                if i == index {
                    takes = bytes_mut(text.cast(), capacity).map(|text| write_text(text, alert));
                }
            });
            let takes = takes?;
            if !length.is_null() {
                put(length, takes)?;
            }
            if takes > capacity { Err(itpms_status::TooSmall) } else { Ok(()) }
        })
    }
}

/// # Safety
/// As for `itpms_car_events`.
unsafe fn put_events<H: Handle>(
    handle: *mut H,
    events: *mut itpms_event,
    capacity: usize,
    count: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise; no place is written beyond `capacity`.
    unsafe {
        with(handle, |kept| {
            check(events)?;
            check(count)?;
            let (there_are, result) =
                kept.events(capacity, |i, change| events.wrapping_add(i).write(change.into()));
            put(count, there_are)?;
            result
        })
    }
}

/// # Safety
/// As for `itpms_car_save_calibration`.
unsafe fn put_calibration<H: Handle>(
    handle: *mut H,
    memory: *mut c_void,
    size: usize,
    written: *mut usize,
) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(handle, |kept| put(written, kept.save_calibration(bytes_mut(memory, size)?)?)) }
}

/// # Safety
/// As for `itpms_car_load_calibration`.
unsafe fn read_calibration<H: Handle>(handle: *mut H, memory: *const c_void, size: usize) -> itpms_status {
    // SAFETY: the caller's promise.
    unsafe { with(handle, |kept| kept.load_calibration(bytes(memory, size)?)) }
}
