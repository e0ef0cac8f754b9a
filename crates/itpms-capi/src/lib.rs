//! Indirect tire pressure monitoring as a C library: `itpms.h` and a static library, in `f32` or, with feature `f64`, in `f64`.
//!
//! A car, or its wheel speeds alone, live in memory of the caller. The library has no heap, no globals, no clock and no files, and reads nothing but its arguments;
//! docs/c-library.md tells how it is built and used.
//!
//! | module | idea |
//! |---|---|
//! | `edge`, `pointer` | the functions that C calls, and its pointers: the only modules with `unsafe`, but for how memory begins |
//! | `config`, `read_config`, `sample` | what comes in |
//! | `estimate`, `cold`, `radii`, `alert` | what goes out |
//! | `car`, `wheels` | the car: two monitors and what was reported last; the same of wheel speeds alone |
//! | `kept` | what both of them do |
//! | `image` | bytes that are found whole or not at all |
//! | `status` | why a call did nothing |
//!
//! Compiled for `panic = "abort"`, as a controller has it, it is `no_std`; else it links with `std`, for the tests.
#![cfg_attr(panic = "abort", no_std)]
#![deny(unsafe_code, unsafe_op_in_unsafe_fn)]
#![allow(non_camel_case_types)] // Types have the names that they have in C.

mod alert;
mod car;
mod cold;
mod config;
mod edge;
mod estimate;
mod image;
mod kept;
mod pointer;
mod radii;
mod read_config;
mod sample;
mod status;
mod wheels;

pub use self::alert::{itpms_alert, itpms_basis, itpms_cause, itpms_event, itpms_malfunction};
pub use self::cold::{itpms_air, itpms_cold_report, itpms_cold_state, itpms_cold_wheel};
pub use self::config::{
    itpms_confidence, itpms_config, itpms_corner_config, itpms_driven, itpms_regulation,
    itpms_wheel_speed_config,
};
pub use self::edge::*;
pub use self::estimate::{
    itpms_doubt, itpms_estimate, itpms_level, itpms_radius_state, itpms_state, itpms_validity, itpms_warning,
    itpms_wheel,
};
pub use self::pointer::{itpms_car, itpms_wheels};
pub use self::radii::{itpms_radius_report, itpms_wheel_radius};
pub use self::sample::{itpms_brake, itpms_sample, itpms_wheel_speed_sample};
pub use self::status::itpms_status;

/// The scalar of the library: `float`, or `double` with `ITPMS_F64`, as the library was built.
#[cfg(not(feature = "f64"))]
pub type itpms_real = f32;
/// The scalar of the library.
#[cfg(feature = "f64")]
pub type itpms_real = f64;

/// Version of this interface, for `itpms_config`.
pub const ITPMS_API_VERSION: u32 = 1;

/// Bytes that a car takes at most, for memory that is there when the program starts; `itpms_car_size` is exact.
#[cfg(not(feature = "f64"))]
pub const ITPMS_CAR_MAX_SIZE: usize = 262_144;
/// Bytes that a car takes at most.
#[cfg(feature = "f64")]
pub const ITPMS_CAR_MAX_SIZE: usize = 524_288;

/// Bytes that wheel speeds alone take at most; `itpms_wheels_size` is exact.
#[cfg(not(feature = "f64"))]
pub const ITPMS_WHEELS_MAX_SIZE: usize = 5120;
/// Bytes that wheel speeds alone take at most.
#[cfg(feature = "f64")]
pub const ITPMS_WHEELS_MAX_SIZE: usize = 10_240;

/// Bytes that a stored calibration takes at most.
pub const ITPMS_CALIBRATION_MAX_SIZE: usize = 1024;

const _: () = assert!(size_of::<pointer::Memory<car::Car>>() <= ITPMS_CAR_MAX_SIZE);
const _: () = assert!(size_of::<pointer::Memory<wheels::Wheels>>() <= ITPMS_WHEELS_MAX_SIZE);

/// Nothing here is known to panic (`.ci/capi-library` looks, for a controller); the language wants a handler nevertheless.
#[cfg(panic = "abort")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
