//! Indirect tire pressure monitoring from the accelerations of a car's body and wheels.
//!
//! This crate is what a controller ships: no heap, no clock, no files, no `unsafe`, generic over `f32` and `f64`.
//! Time comes with every sample, an estimator is a value, and bad input is flagged, never believed.
//!
//! | room | idea |
//! |---|---|
//! | [`quarter_car`] | parameters, dynamics, outputs, Jacobians (paper eq. 1-4) |
//! | [`pressure`] | stiffness and pressure of a tire (paper eq. 5) |
//! | [`sample`] | what comes in: one time, up to four corners |
//! | [`speed`] | speed and way, where not every sample tells them |
//! | [`estimate`] | what goes out: pressure, stiffness, their sd, validity, warning |
//! | `clock` | a time that only goes forwards |
//! | [`intake`] | bad values refused and counted, jitter regridded |
//! | [`estimator`] | one interface before all estimators of a corner |
//! | [`car`] | the estimator of a whole car |
//! | [`monitor`] | what is wrong with tires and sensors, since when and why |
//! | [`informed`] | the default estimator: a Bayes filter that knows that a road looks like a road |
//! | [`filter`] | the paper's filters to the letter, which cannot find the stiffness, and mended |
//! | [`road`] | the road under a wheel, for a known stiffness: causal, and smoothed for a record |
#![no_std]
#![forbid(unsafe_code)]

mod belief;
pub mod car;
pub mod conditioning;
pub mod diagnosis;
pub mod estimator;
mod inter_axle;
pub mod model;
pub mod monitor;
pub mod published;
#[cfg(test)]
mod random;
pub mod real;
pub mod road;
pub mod single_wheel;
mod spectrum;
pub mod warning;
