//! The simulated world: roads, quarter cars, accelerometers, and the scenarios that put them together.
//!
//! Called by whoever needs a drive whose truth is known (the score, the demo, tests). Knows nothing of log files or estimators; a
//! [`SimRow`](simulation::SimRow) carries what a log would hold and the truth beside it. The mathematics is in `docs/math/simulation.md`.
//!
//! | module | idea |
//! |---|---|
//! | [`road`] | ISO 8608 roads, measured profiles, potholes, repeated segments, the tire's contact length |
//! | [`time_profile`] | piecewise linear histories: the car's speed, a tire's pressure |
//! | [`plant`] | the true quarter car, or the whole car, with time-varying tire stiffness, integrated on a fine grid |
//! | [`car`] | the whole car as written down: track, inertia, anti-roll bars, load, turning |
//! | [`sensor`], [`antialias`] | what lies between a true acceleration and a logged one |
//! | [`fault`] | sensors that go wrong for a while |
//! | [`wheel_speeds`] | the speeds of the four wheels as a car's bus has them |
//! | [`pulses`] | the teeth of a wheel's speed sensor, and the torsion of tire and rim that they show |
//! | [`pressure_sensor`] | a test bed's reference: what a log holds in place of the true pressure |
//! | [`scenario`] | a drive written down: TOML files and the built-in ones |
//! | [`simulation`] | a scenario and a seed in, a stream of rows out, in bounded memory |
//!
//! ```
//! use itpms_core::model::Corner;
//! use itpms_sim::{scenario::Scenario, simulation::Simulation};
//!
//! let scenario = Scenario::builtin("paper-drop")?;
//! for row in Simulation::new(&scenario, 1)?.take(3) {
//!     let sample = row.car_sample().corners[Corner::FrontLeft];
//!     assert!(sample.is_some_and(|s| s.body_accel_m_s2.is_finite()));
//! }
//! # Ok::<(), itpms_sim::error::ScenarioError>(())
//! ```
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]

pub mod antialias;
pub mod car;
pub mod error;
pub mod fault;
pub mod plant;
pub mod pressure_sensor;
pub mod pulses;
pub mod road;
pub mod scenario;
pub mod sensor;
pub mod simulation;
mod streams;
mod text_file;
pub mod time_profile;
pub mod wheel_speeds;

/// The README's example is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
