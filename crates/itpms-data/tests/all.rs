//! Files through the crate's public face.
//!
//! One program: the estimators are generic, and every program that uses them compiles them anew.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail as tests do")]

mod advice;
mod bad_logs;
mod bus_oddities;
mod common;
mod dbc;
mod drive_frames;
mod foreign_parquet;
mod listing;
mod mcap;
mod mcap_in;
mod mdf4_contents;
mod packed;
mod parquet_types;
mod pulses;
mod recordings;
mod reference;
mod reference_killed;
mod round_trip;
mod signals;
mod stamps;
mod stored;
mod text_tables;
mod tire_sensors;
mod truck_bus;
mod typical_cars;
mod vehicle_details;
mod vehicle_file;
mod wheel_speeds;
