//! FMI 2.0.4, co-simulation: the functions of `fmi2Functions.h`, every one of them.
#![allow(unsafe_code, non_snake_case)]

use std::ffi::{CStr, c_char, c_int, c_void};
use std::path::PathBuf;

use crate::abi::{self, Instance, Log, Status};
use crate::model::Phase;
use crate::variables::Kind;

type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// `fmi2CallbackFunctions`; memory is this library's own.
#[repr(C)]
pub(crate) struct Callbacks {
    logger: Option<Logger>,
    allocate_memory: *const c_void,
    free_memory: *const c_void,
    step_finished: *const c_void,
    component_environment: *mut c_void,
}

const CO_SIMULATION: c_int = 1;

/// The folder of a URI `file:///path`; a path without a scheme is one, too.
fn folder(location: &str) -> Option<PathBuf> {
    let Some(rest) = location.strip_prefix("file:") else { return Some(PathBuf::from(location)) };
    let path = rest.strip_prefix("//").map_or(rest, |rest| rest.strip_prefix("localhost").unwrap_or(rest));
    let (bytes, mut decoded, mut i) = (path.as_bytes(), Vec::new(), 0);
    while let Some(byte) = bytes.get(i) {
        let escape = (*byte == b'%').then(|| path.get(i + 1..i + 3)).flatten();
        match escape.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(escaped) => {
                decoded.push(escaped);
                i += 3;
            }
            None => {
                decoded.push(*byte);
                i += 1;
            }
        }
    }
    let path = String::from_utf8(decoded).ok()?;
    // Before a drive's letter stands a slash that is none of its path.
    let drive = path.strip_prefix('/').filter(|path| path.as_bytes().get(1) == Some(&b':'));
    Some(PathBuf::from(drive.unwrap_or(&path)))
}

/// # Safety
/// The callbacks are the tool's, and live as long as the instance.
unsafe fn log(callbacks: *const Callbacks, name: *const c_char) -> Option<Log> {
    // SAFETY: the caller's promise.
    let callbacks = unsafe { callbacks.as_ref() }?;
    let (logger, environment) = (callbacks.logger?, callbacks.component_environment);
    let name = if name.is_null() {
        c"itpms".to_owned()
    } else {
        // SAFETY: a text of the tool.
        unsafe { CStr::from_ptr(name) }.to_owned()
    };
    Some(Box::new(move |text| {
        let status = Status::Error as c_int;
        // SAFETY: the tool's function, called as the standard says; the text is no format but its argument.
        unsafe {
            logger(
                environment,
                name.as_ptr(),
                status,
                c"logStatusError".as_ptr(),
                c"%s".as_ptr(),
                text.as_ptr(),
            )
        };
    }))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    location: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    _logging: c_int,
) -> *mut c_void {
    if kind != CO_SIMULATION {
        return std::ptr::null_mut();
    }
    // SAFETY: what the tool hands over by the standard.
    unsafe { Instance::create(abi::text(location).and_then(folder), abi::text(guid), log(callbacks, name)) }
}

abi::functions! {
    fmi2FreeInstance(instance: *mut c_void) = abi::free(instance);
    fmi2SetupExperiment(instance: *mut c_void, _tolerance_defined: c_int, _tolerance: f64, _start_time: f64, _stop_defined: c_int, _stop_time: f64) -> Status = abi::there(instance);
    fmi2SetDebugLogging(instance: *mut c_void, _on: c_int, _count: usize, _categories: *const *const c_char) -> Status = abi::there(instance);
    fmi2EnterInitializationMode(instance: *mut c_void) -> Status = abi::there(instance);
    fmi2ExitInitializationMode(instance: *mut c_void) -> Status = abi::enter(instance, Phase::Initialized);
    fmi2Terminate(instance: *mut c_void) -> Status = abi::enter(instance, Phase::Terminated);
    fmi2DoStep(instance: *mut c_void, time_s: f64, step_s: f64, _no_set_state_prior: c_int) -> Status = abi::step(instance, time_s, step_s);
}

abi::access! {
    fmi2GetReal fmi2SetReal(f64), Kind::Real, |value| value, |value| value;
    fmi2GetInteger fmi2SetInteger(c_int), Kind::Integer, |value| value as c_int, f64::from;
    fmi2GetBoolean fmi2SetBoolean(c_int), Kind::Boolean, |value| c_int::from(value > 0.5), |value| f64::from(u8::from(value != 0));
}

abi::state_functions! {
    fmi2Reset fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate
    fmi2SerializedFMUstateSize fmi2SerializeFMUstate fmi2DeSerializeFMUstate
}

// Functions that the description says are not there.
abi::not_there! {
    fmi2GetString fmi2SetString fmi2GetDirectionalDerivative fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives fmi2CancelStep
    fmi2GetStatus fmi2GetRealStatus fmi2GetIntegerStatus fmi2GetBooleanStatus fmi2GetStringStatus
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uri_is_a_folder() {
        for (location, path) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file:/tmp/r", "/tmp/r"),
            ("file://localhost/tmp/r", "/tmp/r"),
            ("file:///C:/Temp/r", "C:/Temp/r"),
            ("/tmp/100%", "/tmp/100%"),
            ("file:///tmp/100%", "/tmp/100%"),
        ] {
            assert_eq!(folder(location), Some(PathBuf::from(path)), "{location}");
        }
    }
}
