//! Shared by the integration tests of this crate. Each test binary compiles its own copy and uses part of it.
#![allow(dead_code, unreachable_pub)]
// Helpers stand outside #[test], where clippy would ask for errors instead; a panic is what a failing test is.
#![allow(clippy::unwrap_used)]

pub mod band;
pub mod car_ride;
pub mod quarter_plant;
pub mod ride;
