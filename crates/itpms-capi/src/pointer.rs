//! Pointers of a C program become references here, and nowhere else.
//!
//! Every pointer is checked for null and alignment; that it points to memory of its type, which nothing else uses during the call, is
//! what C promises.
#![allow(unsafe_code)]

use core::ffi::c_void;
use core::slice;

use crate::car::Car;
use crate::status::itpms_status;

/// A car, in memory of the caller. What is in it is the library's own.
pub struct itpms_car {
    _private: (),
}

/// A reference to what a pointer points to.
///
/// # Safety
/// A pointer that is not null and aligned points to an `X` that is initialized and not written to while the reference lives.
pub(crate) unsafe fn read<'a, X>(pointer: *const X) -> Result<&'a X, itpms_status> {
    check(pointer)?;
    // SAFETY: not null and aligned; the rest is the caller's promise.
    Ok(unsafe { &*pointer })
}

/// Puts a value where a pointer points to.
///
/// # Safety
/// A pointer that is not null and aligned points to memory for an `X`.
pub(crate) unsafe fn put<X>(pointer: *mut X, value: X) -> Result<(), itpms_status> {
    check(pointer)?;
    // SAFETY: not null and aligned; the rest is the caller's promise.
    unsafe { pointer.write(value) };
    Ok(())
}

/// The car in a C program's memory.
///
/// # Safety
/// A pointer that is not null and aligned points to memory that `itpms_car_init` was given, and nothing else uses it now.
pub(crate) unsafe fn car<'a>(car: *mut itpms_car) -> Result<&'a mut Car, itpms_status> {
    let car = car.cast::<Car>();
    check(car)?;
    // SAFETY: not null and aligned, and memory of the size of a car, which begins with its mark (`Car` has it as a plain number).
    if !Car::is_one(unsafe { (&raw const (*car).magic).read() }) {
        return Err(itpms_status::NotACar);
    }
    // SAFETY: what bears the mark was made by `Car::blank` and configured.
    Ok(unsafe { &mut *car })
}

/// As many bytes as the caller has.
///
/// # Safety
/// A pointer that is not null points to so many initialized bytes that nothing else writes to now.
pub(crate) unsafe fn bytes<'a>(bytes: *const c_void, size: usize) -> Result<&'a [u8], itpms_status> {
    check(bytes.cast::<u8>())?;
    // SAFETY: not null; the rest is the caller's promise. No object is larger than half of the memory.
    Ok(unsafe { slice::from_raw_parts(bytes.cast(), size.min(isize::MAX.unsigned_abs())) })
}

/// The same to be written to. They are set to zero first: C does not promise that there is anything in them.
///
/// # Safety
/// A pointer that is not null points to so many bytes that nothing else uses now.
pub(crate) unsafe fn bytes_mut<'a>(bytes: *mut c_void, size: usize) -> Result<&'a mut [u8], itpms_status> {
    let (bytes, size) = (bytes.cast::<u8>(), size.min(isize::MAX.unsigned_abs()));
    check(bytes)?;
    // SAFETY: not null; the rest is the caller's promise.
    Ok(unsafe {
        bytes.write_bytes(0, size);
        slice::from_raw_parts_mut(bytes, size)
    })
}

pub(crate) fn check<X>(pointer: *const X) -> Result<(), itpms_status> {
    if pointer.is_null() {
        Err(itpms_status::NullPointer)
    } else if !pointer.is_aligned() {
        Err(itpms_status::Misaligned)
    } else {
        Ok(())
    }
}
