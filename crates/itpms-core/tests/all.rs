//! The core through its public face.
//!
//! One program: the estimators are generic, and every program that uses them compiles them anew.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]
#![allow(clippy::duplicate_mod, reason = "an example brings its own copy of the car that it drives")]

mod car_clock;
mod car_fallen_silent;
mod car_garbage;
mod car_saved;
mod common;
mod estimator_driving;
mod estimator_faults;
mod estimator_garbage;
mod estimator_reset;
mod estimator_saved;
mod examples;
mod fall_interval;
mod in_place;
mod inter_axle;
mod inter_axle_speed;
mod monitor;
mod monitor_corner;
mod resampler;
mod rollback;
