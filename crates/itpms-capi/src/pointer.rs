//! Pointers of a C program become references here, and nowhere else.
//!
//! Every pointer is checked for null and alignment; that it points to memory of its type, which nothing else uses during the call, is
//! what C promises.
#![allow(unsafe_code)]

use core::ffi::c_void;
use core::slice;

use crate::car::Car;
use crate::config::itpms_config;
use crate::kept::Kept;
use crate::read_config::Refusal;
use crate::status::itpms_status;
use crate::wheels::Wheels;

/// A car, in memory of the caller. What is in it is the library's own.
pub struct itpms_car {
    _private: (),
}

/// Four wheel speeds without a car around them, in memory of the caller. What is in it is the library's own.
pub struct itpms_wheels {
    _private: (),
}

/// What C has a pointer to.
pub(crate) trait Handle {
    /// What lies there.
    type Kept: Kept;
}

impl Handle for itpms_car {
    type Kept = Car;
}

impl Handle for itpms_wheels {
    type Kept = Wheels;
}

/// The caller's memory: a mark, and what bears it.
#[repr(C)]
pub(crate) struct Memory<X> {
    mark: u32,
    kept: X,
}

/// Configures memory where it lies. What was in it is forgotten; it bears its mark only if that succeeds.
///
/// # Safety
/// `memory` is null or points to `size` bytes that nothing else uses.
pub(crate) unsafe fn make<H: Handle>(
    memory: *mut c_void,
    size: usize,
    config: &itpms_config,
) -> Result<*mut H, Refusal> {
    let place = memory.cast::<Memory<H::Kept>>();
    check(place)?;
    if size < size_of::<Memory<H::Kept>>() {
        return Err(itpms_status::TooSmall.into());
    }
    // SAFETY: large enough, aligned, and the caller's to give; what is referred to was made the line before.
    let kept = unsafe {
        (&raw mut (*place).mark).write(0);
        H::Kept::blank(&raw mut (*place).kept);
        &mut (*place).kept
    };
    kept.configure(config)?;
    // SAFETY: as above.
    unsafe { (&raw mut (*place).mark).write(H::Kept::MARK) };
    Ok(memory.cast())
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

/// What a C program's pointer stands for.
///
/// # Safety
/// A pointer that is not null and aligned points to memory that an init was given, and nothing else uses it now.
pub(crate) unsafe fn kept<'a, H: Handle>(handle: *mut H) -> Result<&'a mut H::Kept, itpms_status> {
    let place = handle.cast::<Memory<H::Kept>>();
    check(place)?;
    // SAFETY: not null and aligned; the mark stands first, a plain number.
    if unsafe { (&raw const (*place).mark).read() } != H::Kept::MARK {
        return Err(itpms_status::NotACar);
    }
    // SAFETY: what bears the mark was blank and was configured.
    Ok(unsafe { &mut (*place).kept })
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
