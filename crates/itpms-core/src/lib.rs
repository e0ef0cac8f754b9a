//! Indirect tire pressure monitoring from the accelerations of a car's body and wheels.
//!
//! This crate is what a controller ships: no heap, no clock, no files, no `unsafe`, generic over `f32` and `f64`. Time comes with every
//! sample, an estimator is a value that can be cloned, saved and resumed, and bad input is flagged, never believed.
//!
//! It starts from parameters of the car (masses, springs, dampers, the tire's stiffness over pressure), takes vertical accelerations of
//! body and wheel at 100 Hz to 2 kHz and the speed, and learns while the road moves the wheels. Accelerations are in m/s², positive
//! upward, with or without gravity; pressures are gauge pressures in kPa. Names end in their unit.
//!
//! # One wheel
//!
//! Body and wheel acceleration of one corner give its tire's pressure with a standard deviation. The road under the wheel is
//! estimated from its stiffness by the crate `itpms-road`.
//!
//! ```
//! use itpms_core::{CornerConfig, Estimator, Validity};
//!
//! # fn main() -> Result<(), itpms_core::ParameterError> {
//! // Masses, damper, spring and tire of the corner: here the paper's.
//! let corner = CornerConfig::<f64>::paper();
//! let sample_rate_hz = 500.0;
//! let mut estimator = Estimator::new(&corner, sample_rate_hz)?;
//! for k in 0..1000 {
//!     let time_s = f64::from(k) / sample_rate_hz;
//!     // From the sensors; NaN: the value is missing.
//!     let speed_m_s = 22.0;
//!     let (body_accel_m_s2, wheel_accel_m_s2) = (0.3 * (9.0 * time_s).sin(), 4.0 * (70.0 * time_s).sin());
//!     let estimate = estimator.update(time_s, speed_m_s, body_accel_m_s2, wheel_accel_m_s2);
//!     // Valid after some seconds on a road; before that `validity` says what is missing.
//!     if estimate.validity == Validity::Valid {
//!         println!("{} ± {} kPa", estimate.pressure_kpa, estimate.pressure_sd_kpa);
//!     }
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # A car under its monitor
//!
//! Four corners, front and rear over the same road, sensors watched, warnings given: what a controller runs. A calibration teaches it how
//! the car differs from its parameters; [`CarEstimator::calibration`] is what to store, [`MonitoredCar::load_calibration`] begins a
//! later drive with it.
//!
//! ```
//! use itpms_core::{CarConfig, CarSample, CornerConfig, CornerSample, MonitorConfig, MonitoredCar};
//!
//! # fn main() -> Result<(), itpms_core::ParameterError> {
//! let corner = CornerConfig::<f32>::paper();
//! let car = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.7) };
//! let sample_rate_hz = 200.0;
//! let mut car = MonitoredCar::new(&MonitorConfig::new(&car), sample_rate_hz)?;
//! // All tires have just been set to their placard pressures: the next ten minutes (600 s) teach the car.
//! car.begin_calibration(600.0)?;
//! # let read_sensors = || CornerSample { body_accel_m_s2: 0.1, wheel_accel_m_s2: 0.5 };
//! for k in 0..400 {
//!     let corners = [Some(read_sensors()); 4]; // front left, front right, rear left, rear right
//!     let sample = CarSample { time_s: f64::from(k) / 200.0, speed_m_s: 22.0, corners, wheel_speeds: None };
//!     let estimate = car.update(&sample);
//!     assert_eq!(estimate.time_s, sample.time_s);
//!     for alert in car.report().alerts() {
//!         // `Alert` prints as a sentence: which wheels, why, the numbers that decided, since when.
//!         println!("{alert}");
//!     }
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # On a controller
//!
//! A car of four corners is 143 kB in `f32`. It has its memory first, as a constant of zeros, and is configured where it lies. On a
//! Cortex-M4F that takes 6.5 kB of stack, and samples 9.9 kB. A car that has wheel speeds alone is a [`MonitoredWheels`] of 5 kB.
//!
//! ```
//! use std::sync::{Mutex, PoisonError}; // Or whatever guards a static on the controller.
//!
//! use itpms_core::{CarConfig, CornerConfig, MonitorConfig, MonitoredCar, ParameterError};
//!
//! static CAR: Mutex<MonitoredCar<f32>> = Mutex::new(MonitoredCar::unconfigured());
//!
//! # fn main() -> Result<(), ParameterError> {
//! let corner = CornerConfig::<f32>::paper();
//! let config = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.7) };
//! let mut car = CAR.lock().unwrap_or_else(PoisonError::into_inner);
//! car.configure(&MonitorConfig::new(&config), 200.0)?;
//! // From here on as above.
//! car.begin_calibration(600.0)?;
//! # Ok(())
//! # }
//! ```
//!
//! # The way of a sample
//!
//! Data goes one way: sample, conditioned sample, spectral frames, residual, belief, estimate, diagnosis and warning.
//!
//! | module | idea |
//! |---|---|
//! | [`model`] | the car and its signals: parameters, samples, estimates, calibration |
//! | [`conditioning`] | one clock and one speed, values checked and resampled, wheels that have left the road |
//! | [`spectrum`] | short spectral frames, reconstructed signals, transfer functions |
//! | `suspension` | the force in the struts, friction included, from the body's equation of motion |
//! | `single_wheel` | one corner: a Bayes filter on a grid of pressures that knows that a road looks like a road |
//! | `inter_axle` | front and rear over the same road: alignment and residual |
//! | `belief` | what is believed of the car: a bank of Gaussian hypotheses |
//! | [`estimator`] | the estimator of one corner |
//! | [`car`] | the estimator of a car: puts the above in order |
//! | `cold_pressure` | how warm the tires are, and what they would have cold |
//! | [`diagnosis`] | what is wrong with a sensor |
//! | [`warning`] | warnings, and when they are raised |
//! | [`monitor`] | a car's estimator under its monitor |
//! | [`wheel_speed`] | radius analysis: which tires differ from the others, from four wheel speeds alone |
//! | [`torsion`] | torsional analysis: by how much a tire's pressure has changed, from the tooth pulses of its wheel alone |
//! | `real` | [`Real`]: `f32` or `f64` |
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `serde` | saving and restoring of a running estimator and of calibrations, by the same version |
#![no_std]
#![forbid(unsafe_code)]
#![allow(clippy::op_ref)] // A matrix that is multiplied by value is copied on the stack first.

mod belief;
pub mod car;
mod cholesky;
mod cold_pressure;
pub mod conditioning;
pub mod decision;
pub mod diagnosis;
pub mod estimator;
mod inter_axle;
mod labelled;
mod memory;
pub mod model;
pub mod monitor;
#[cfg(test)]
mod random;
mod real;
mod single_wheel;
pub mod spectrum;
mod suspension;
pub mod torsion;
mod tuning;
pub mod warning;
pub mod wheel_speed;

#[doc(inline)]
pub use self::car::{CarEstimator, EstimatorOptions};
#[doc(inline)]
pub use self::diagnosis::{Malfunction, Sensor};
#[doc(inline)]
pub use self::estimator::Estimator;
#[doc(inline)]
pub use self::model::{
    Air, CarConfig, CarEstimate, CarSample, ColdPressure, Corner, CornerConfig, CornerEstimate, CornerSample,
    ParameterError, PressureMap, QuarterCar, Validity, VehicleCalibration, Warning,
};
#[doc(inline)]
pub use self::monitor::{MonitorConfig, MonitoredCar, MonitoredWheels};
#[doc(inline)]
pub use self::real::Real;
#[doc(inline)]
pub use self::warning::{Alert, Cause, Limits, MonitorReport, Regulation, WheelState};

/// The README's example is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
