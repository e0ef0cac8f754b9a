//! What the benchmarks feed to the estimators: one wheel on a rough road ([`wheel`]), four of them ([`car`]), and the published filter's
//! step on other people's Kalman filters ([`peers`]).
//!
//! Feature `host`, on by default, is what needs an operating system; without it the peers run on a controller (`examples/firmware`).
#![cfg_attr(not(feature = "host"), no_std)]
#![forbid(unsafe_code)]
#![allow(clippy::expect_used)] // A benchmark whose fixed parameters are refused has nothing to measure.

#[cfg(feature = "host")]
pub mod car;
#[cfg(feature = "peer-steps")]
pub mod peers;
#[cfg(feature = "host")]
pub mod wheel;

#[cfg(feature = "host")]
pub use wheel::{
    HOP, PUBLISHED_WARM_UP, RATE_HZ, Running, SPEED_M_S, WARM_UP, lean, published, road, sample,
};
