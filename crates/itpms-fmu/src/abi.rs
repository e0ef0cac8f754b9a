//! The common part of both versions' C interfaces: the instance behind a tool's pointer, names and arrays of the tool, states.
//!
//! # Safety
//! Of every function here: an instance is null or one from [`Instance::create`] that was not given back, and nothing else uses it now; a
//! text is null or ended by a zero; an array has so many values, which nothing else uses now; a state is null or one of this library. What
//! `free` and `free_state` are given is not used again.
#![allow(unsafe_code)]

use std::ffi::{CStr, c_char, c_void};
use std::path::PathBuf;
use std::slice;

use crate::description::token;
use crate::model::{Model, ModelError, Phase};
use crate::variables::Kind;

/// Return value of a function of the standard. Both versions have the first five alike.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code)] // The standard's numbers.
pub(crate) enum Status {
    Ok = 0,
    Warning = 1,
    Discard = 2,
    Error = 3,
    Fatal = 4,
}

/// Hands a message to the tool.
pub(crate) type Log = Box<dyn Fn(&CStr)>;

/// An instance: what a tool's pointer points to.
pub(crate) struct Instance {
    pub(crate) model: Model,
    log: Option<Log>,
}

impl Instance {
    /// An instance on the heap, to be given back to [`free`]; null where there can be none, which is logged.
    pub(crate) fn create(resources: Option<PathBuf>, found: Option<&str>, log: Option<Log>) -> *mut c_void {
        let made = resources
            .ok_or_else(|| ModelError::Vehicle("the tool does not say where the resources are".to_owned()))
            .and_then(|folder| Model::of_resources(&folder))
            .and_then(|model| {
                let expected = token(model.vehicle());
                if found == Some(expected.as_str()) {
                    return Ok(model);
                }
                let what = format!("the description is of another unit: {found:?}, expected {expected:?}");
                Err(ModelError::Vehicle(what))
            });
        match made {
            Ok(model) => Box::into_raw(Box::new(Self { model, log })).cast(),
            Err(error) => {
                say(log.as_ref(), &error.to_string());
                std::ptr::null_mut()
            }
        }
    }

    /// What became of something, reported to the tool if it went wrong.
    pub(crate) fn conclude(&self, result: Result<(), ModelError>) -> Status {
        match result {
            Ok(()) => Status::Ok,
            Err(error) => {
                say(self.log.as_ref(), &error.to_string());
                Status::Error
            }
        }
    }
}

fn say(log: Option<&Log>, text: &str) {
    let bytes: Vec<u8> = text.bytes().filter(|byte| *byte != 0).collect();
    if let (Some(log), Ok(text)) = (log, std::ffi::CString::new(bytes)) {
        log(&text);
    }
}

/// The instance behind a tool's pointer, for one call.
pub(crate) unsafe fn instance<'a>(pointer: *mut c_void) -> Option<&'a mut Instance> {
    // SAFETY: the caller's promise.
    unsafe { pointer.cast::<Instance>().as_mut() }
}

pub(crate) unsafe fn free(pointer: *mut c_void) {
    if !pointer.is_null() {
        // SAFETY: it came from `Box::into_raw`.
        drop(unsafe { Box::from_raw(pointer.cast::<Instance>()) });
    }
}

pub(crate) unsafe fn text<'a>(pointer: *const c_char) -> Option<&'a str> {
    // SAFETY: the caller's promise.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })?.to_str().ok()
}

unsafe fn array<'a, X>(pointer: *const X, count: usize) -> Option<&'a [X]> {
    if count == 0 {
        return Some(&[]);
    }
    // SAFETY: not null and aligned; the rest is the caller's promise.
    (!pointer.is_null() && pointer.is_aligned()).then(|| unsafe { slice::from_raw_parts(pointer, count) })
}

/// A tool's array to be written to.
unsafe fn array_mut<'a, X>(pointer: *mut X, count: usize) -> Option<&'a mut [X]> {
    if count == 0 {
        return Some(&mut []);
    }
    // SAFETY: not null and aligned; the rest is the caller's promise.
    (!pointer.is_null() && pointer.is_aligned()).then(|| unsafe { slice::from_raw_parts_mut(pointer, count) })
}

/// Reads variables of a kind into a tool's array.
pub(crate) unsafe fn get<X>(
    pointer: *mut c_void,
    kind: Kind,
    references: *const u32,
    count: usize,
    values: *mut X,
    of: fn(f64) -> X,
) -> Status {
    // SAFETY: the caller's promise.
    let (instance, references, values) =
        unsafe { (instance(pointer), array(references, count), array_mut(values, count)) };
    let (Some(instance), Some(references), Some(values)) = (instance, references, values) else {
        return Status::Error;
    };
    for (reference, place) in references.iter().zip(values) {
        match instance.model.get(*reference).filter(|(variable, _)| variable.kind == kind) {
            Some((_, value)) => *place = of(value),
            None => return Status::Error,
        }
    }
    Status::Ok
}

/// Sets variables of a kind from a tool's array.
pub(crate) unsafe fn set<X: Copy>(
    pointer: *mut c_void,
    kind: Kind,
    references: *const u32,
    count: usize,
    values: *const X,
    of: fn(X) -> f64,
) -> Status {
    // SAFETY: the caller's promise.
    let (instance, references, values) =
        unsafe { (instance(pointer), array(references, count), array(values, count)) };
    let (Some(instance), Some(references), Some(values)) = (instance, references, values) else {
        return Status::Error;
    };
    for (reference, value) in references.iter().zip(values) {
        let is_of_kind = instance.model.get(*reference).is_some_and(|(variable, _)| variable.kind == kind);
        if !is_of_kind || !instance.model.set(*reference, of(*value)) {
            return Status::Error;
        }
    }
    Status::Ok
}

unsafe fn on(pointer: *mut c_void, act: impl FnOnce(&mut Model) -> Result<(), ModelError>) -> Status {
    // SAFETY: the caller's promise.
    let Some(instance) = (unsafe { instance(pointer) }) else { return Status::Error };
    let result = act(&mut instance.model);
    instance.conclude(result)
}

pub(crate) unsafe fn step(pointer: *mut c_void, time_s: f64, step_s: f64) -> Status {
    // SAFETY: the caller's promise.
    unsafe { on(pointer, |model| model.step(time_s, step_s)) }
}

pub(crate) unsafe fn reset(pointer: *mut c_void) -> Status {
    let anew = |model: &mut Model| {
        model.reset();
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { on(pointer, anew) }
}

/// The tool has initialized or terminated it.
pub(crate) unsafe fn enter(pointer: *mut c_void, phase: Phase) -> Status {
    // SAFETY: the caller's promise.
    unsafe { on(pointer, |model| model.enter(phase)) }
}

/// Whether there is an instance: what a function answers that has nothing to do.
pub(crate) unsafe fn there(pointer: *mut c_void) -> Status {
    // SAFETY: the caller's promise.
    unsafe { on(pointer, |_| Ok(())) }
}

/// Keeps the state in `*state`, which is null or an earlier one.
pub(crate) unsafe fn get_state(pointer: *mut c_void, state: *mut *mut c_void) -> Status {
    // SAFETY: the caller's promise.
    let (Some(instance), Some(state)) = (unsafe { (instance(pointer), state.as_mut()) }) else {
        return Status::Error;
    };
    // SAFETY: null or a state of ours.
    match unsafe { state.cast::<Model>().as_mut() } {
        Some(kept) => *kept = instance.model.clone(),
        None => *state = Box::into_raw(Box::new(instance.model.clone())).cast(),
    }
    Status::Ok
}

/// Goes back to a state.
pub(crate) unsafe fn set_state(pointer: *mut c_void, state: *mut c_void) -> Status {
    // SAFETY: the caller's promise.
    let (Some(instance), Some(kept)) = (unsafe { (instance(pointer), state.cast::<Model>().as_ref()) })
    else {
        return Status::Error;
    };
    instance.model = kept.clone();
    Status::Ok
}

pub(crate) unsafe fn free_state(pointer: *mut c_void, state: *mut *mut c_void) -> Status {
    // SAFETY: the caller's promise.
    let (Some(_), Some(state)) = (unsafe { (instance(pointer), state.as_mut()) }) else {
        return Status::Error;
    };
    if !state.is_null() {
        // SAFETY: it came from `Box::into_raw`.
        drop(unsafe { Box::from_raw(state.cast::<Model>()) });
        *state = std::ptr::null_mut();
    }
    Status::Ok
}

pub(crate) unsafe fn state_size(pointer: *mut c_void, state: *mut c_void, size: *mut usize) -> Status {
    // SAFETY: the caller's promise.
    let (Some(instance), Some(kept), Some(size)) =
        (unsafe { (instance(pointer), state.cast::<Model>().as_ref(), size.as_mut()) })
    else {
        return Status::Error;
    };
    instance.conclude(kept.to_bytes().map(|bytes| *size = bytes.len()))
}

pub(crate) unsafe fn write_state(
    pointer: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> Status {
    // SAFETY: the caller's promise.
    let (Some(instance), Some(kept), Some(place)) =
        (unsafe { (instance(pointer), state.cast::<Model>().as_ref(), array_mut(bytes, size)) })
    else {
        return Status::Error;
    };
    instance.conclude(kept.to_bytes().and_then(|bytes| {
        let place = place.get_mut(..bytes.len());
        let place = place
            .ok_or_else(|| ModelError::State(format!("takes {} bytes, there are {size}", bytes.len())))?;
        place.copy_from_slice(&bytes);
        Ok(())
    }))
}

/// Reads a state of bytes into `*state`, as [`get_state`] does.
pub(crate) unsafe fn read_state(
    pointer: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> Status {
    // SAFETY: the caller's promise.
    let (Some(instance), Some(bytes)) = (unsafe { (instance(pointer), array(bytes, size)) }) else {
        return Status::Error;
    };
    let mut restored = Instance { model: instance.model.clone(), log: None };
    let result = restored.model.restore(bytes);
    if result.is_err() {
        return instance.conclude(result);
    }
    // SAFETY: an instance of ours and the tool's pointer.
    unsafe { get_state((&raw mut restored).cast(), state) }
}

/// Functions of the standard, each with what is done with its arguments.
macro_rules! functions {
    ($($name:ident($($argument:ident: $type:ty),*) $(-> $out:ty)? = $done:expr;)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name($($argument: $type),*) $(-> $out)? {
            // SAFETY: the tool's instance; `FreeInstance` is its last call.
            unsafe { $done }
        }
    )*};
}

/// Getter and setter of a type; FMI 3 says how many values there are, which are as many as references, since every variable is one number.
macro_rules! access {
    ($($get:ident $set:ident($type:ty $(, $values:ident)?), $kind:expr, $of:expr, $into:expr;)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $get(
            instance: *mut c_void,
            references: *const u32,
            count: usize,
            values: *mut $type,
            $($values: usize,)?
        ) -> $crate::abi::Status {
            $(if $values != count {
                return $crate::abi::Status::Error;
            })?
            // SAFETY: the tool's instance and arrays.
            unsafe { $crate::abi::get(instance, $kind, references, count, values, $of) }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $set(
            instance: *mut c_void,
            references: *const u32,
            count: usize,
            values: *const $type,
            $($values: usize,)?
        ) -> $crate::abi::Status {
            $(if $values != count {
                return $crate::abi::Status::Error;
            })?
            // SAFETY: the tool's instance and arrays.
            unsafe { $crate::abi::set(instance, $kind, references, count, values, $into) }
        }
    )*};
}

/// Functions that are not there: by C's calling convention it does not matter what they are called with.
macro_rules! not_there {
    ($($name:ident)*) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $name() -> $crate::abi::Status {
            $crate::abi::Status::Error
        }
    )*};
}

/// The functions of both versions that differ in nothing but their names: reset; get, set and free a state; its size as bytes; to bytes and
/// back.
macro_rules! state_functions {
    ($reset:ident $get:ident $set:ident $free:ident $size:ident $write:ident $read:ident) => {
        $crate::abi::state_functions! { @
            $reset(instance: *mut c_void) reset;
            $get(instance: *mut c_void, state: *mut *mut c_void) get_state;
            $set(instance: *mut c_void, state: *mut c_void) set_state;
            $free(instance: *mut c_void, state: *mut *mut c_void) free_state;
            $size(instance: *mut c_void, state: *mut c_void, size: *mut usize) state_size;
            $write(instance: *mut c_void, state: *mut c_void, bytes: *mut u8, size: usize) write_state;
            $read(instance: *mut c_void, bytes: *const u8, size: usize, state: *mut *mut c_void) read_state;
        }
    };
    (@ $($name:ident($($argument:ident: $type:ty),*) $function:ident;)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name($($argument: $type),*) -> Status {
            // SAFETY: the tool's instance, state, bytes and number.
            unsafe { abi::$function($($argument),*) }
        }
    )*};
}
pub(crate) use {access, functions, not_there, state_functions};
