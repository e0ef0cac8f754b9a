//! CAN logs and DBC files through the crate's public face.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail as tests do")]

mod damage;
mod dbc;
mod dbc_any;
mod logs;
