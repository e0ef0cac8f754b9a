//! The live monitor from outside.
//!
//! One program: the estimators are generic, and every program that uses them compiles them anew.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail as tests do")]

mod common;
mod http;
mod http_client;
mod made_up;
mod monitor;
mod mqtt;
mod wheel_speeds;
