//! FMI 3.0, co-simulation: the functions of `fmi3Functions.h`, every one of them.
#![allow(unsafe_code, non_snake_case)]

use std::ffi::{c_char, c_int, c_void};
use std::path::PathBuf;

use crate::abi::{self, Instance, Log, Status};
use crate::model::Phase;
use crate::variables::Kind;

type Logger = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    logger: Option<Logger>,
    _intermediate_update: *const c_void,
) -> *mut c_void {
    let log = logger.map(|logger| {
        let log: Log = Box::new(move |text| {
            // SAFETY: the tool's function, called as the standard says.
            unsafe { logger(environment, Status::Error as c_int, c"logStatusError".as_ptr(), text.as_ptr()) };
        });
        log
    });
    // SAFETY: what the tool hands over by the standard.
    unsafe { Instance::create(abi::text(resources).map(PathBuf::from), abi::text(token), log) }
}

abi::functions! {
    fmi3FreeInstance(instance: *mut c_void) = abi::free(instance);
    fmi3SetDebugLogging(instance: *mut c_void, _on: bool, _count: usize, _categories: *const *const c_char) -> Status = abi::there(instance);
    fmi3EnterInitializationMode(instance: *mut c_void, _tolerance_defined: bool, _tolerance: f64, _start_time: f64, _stop_defined: bool, _stop_time: f64) -> Status = abi::there(instance);
    fmi3ExitInitializationMode(instance: *mut c_void) -> Status = abi::enter(instance, Phase::Initialized);
    fmi3Terminate(instance: *mut c_void) -> Status = abi::enter(instance, Phase::Terminated);
}

abi::access! {
    fmi3GetFloat64 fmi3SetFloat64(f64, value_count), Kind::Real, |value| value, |value| value;
    fmi3GetInt32 fmi3SetInt32(i32, value_count), Kind::Integer, |value| value as i32, f64::from;
    // A C program's `bool` is a byte that may hold anything.
    fmi3GetBoolean fmi3SetBoolean(u8, value_count), Kind::Boolean, |value| u8::from(value > 0.5), |value| f64::from(u8::from(value != 0));
}

abi::state_functions! {
    fmi3Reset fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState
    fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    time_s: f64,
    step_s: f64,
    _no_set_state_prior: bool,
    event_needed: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_successful_time_s: *mut f64,
) -> Status {
    // SAFETY: the tool's instance.
    let status = unsafe { abi::step(instance, time_s, step_s) };
    let reached_s = if status == Status::Ok { time_s + step_s } else { time_s };
    // SAFETY: the tool's places for the answers.
    unsafe {
        for answer in [event_needed, terminate, early_return] {
            if !answer.is_null() {
                answer.write(false);
            }
        }
        if !last_successful_time_s.is_null() {
            last_successful_time_s.write(reached_s);
        }
    }
    status
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateModelExchange() -> *mut c_void {
    std::ptr::null_mut()
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateScheduledExecution() -> *mut c_void {
    std::ptr::null_mut()
}

// Functions that the description says are not there.
abi::not_there! {
    fmi3GetFloat32 fmi3SetFloat32 fmi3GetInt8 fmi3SetInt8 fmi3GetUInt8 fmi3SetUInt8 fmi3GetInt16 fmi3SetInt16 fmi3GetUInt16 fmi3SetUInt16
    fmi3GetUInt32 fmi3SetUInt32 fmi3GetInt64 fmi3SetInt64 fmi3GetUInt64 fmi3SetUInt64 fmi3GetString fmi3SetString fmi3GetBinary
    fmi3SetBinary fmi3GetClock fmi3SetClock fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3GetDirectionalDerivative
    fmi3GetAdjointDerivative fmi3EnterConfigurationMode fmi3ExitConfigurationMode fmi3EnterEventMode fmi3GetIntervalDecimal
    fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal
    fmi3SetShiftFraction fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep
    fmi3SetTime fmi3SetContinuousStates fmi3GetContinuousStateDerivatives fmi3GetEventIndicators fmi3GetContinuousStates
    fmi3GetNominalsOfContinuousStates fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates fmi3EnterStepMode
    fmi3GetOutputDerivatives fmi3ActivateModelPartition
}
