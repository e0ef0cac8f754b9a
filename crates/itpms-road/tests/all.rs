//! The road under a wheel through its public face.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

/// Plants and random numbers of the core's own tests.
#[path = "../../itpms-core/tests/common/mod.rs"]
mod common;
mod repeated_road;
mod road_estimate;
mod under_car;
