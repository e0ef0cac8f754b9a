//! MDF4 files through the crate's public face.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail as tests do")]

mod damage;
mod foreign;
mod round_trip;
