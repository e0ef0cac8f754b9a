//! Shared by the integration tests of this crate. Each test binary compiles its own copy and uses part of it.
#![allow(dead_code, unreachable_pub)]

pub mod band;
pub mod quarter_plant;
