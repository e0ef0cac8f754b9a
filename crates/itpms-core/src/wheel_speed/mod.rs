//! Radius analysis: a tire that loses air rolls on a smaller radius and turns faster than the others. From four wheel speeds, and
//! what a bus says of yaw rate, acceleration and brakes, it finds which tires differ from the others since a calibration.
//! [`MonitoredWheels`](crate::monitor::MonitoredWheels) are its way in and out.
//!
//! A loss of all four alike is not seen in radii, but by tooth pulses
//! ([`update_with_pulses`](crate::monitor::MonitoredWheels::update_with_pulses)). `docs/math/wheel-speed.md` derives it.
//! It uses the readings of [`torsion`](crate::torsion) and the decision, and knows nothing of accelerations of wheels.
//!
//! ```
//! use itpms_core::MonitoredWheels;
//! use itpms_core::wheel_speed::{DrivenAxle, RadiusState, WheelSpeedConfig, WheelSpeedSample};
//!
//! # fn main() -> Result<(), itpms_core::ParameterError> {
//! // Wheelbase, tracks, driven axle.
//! let mut wheels = MonitoredWheels::<f32>::new(&WheelSpeedConfig::new(2.66, 1.56, 1.57, DrivenAxle::Front))?;
//! // The pressures have just been set: the next five minutes teach how the tires differ.
//! wheels.begin_calibration(300.0)?;
//! for k in 0..1000 {
//!     wheels.update(&WheelSpeedSample {
//!         time_s: f64::from(k) / 80.0,
//!         wheel_speed_m_s: [20.01, 20.0, 19.97, 19.98],
//!         yaw_rate_rad_s: 0.001,
//!         accel_x_m_s2: f32::NAN, // The bus does not say.
//!         accel_y_m_s2: f32::NAN,
//!         brake: Some(false),
//!     });
//!     assert_eq!(wheels.radii().state, RadiusState::Calibrating);
//! }
//! // Once it is there: to be stored, and loaded at the next start.
//! assert!(wheels.calibration().is_none());
//! # Ok(())
//! # }
//! ```

mod block;
mod calibration;
mod config;
mod days;
mod filter;
mod follow;
mod gaussian;
mod hypotheses;
mod radius_monitor;
mod report;
mod sample;
mod sensor_watch;
mod state;
#[cfg(test)]
pub(crate) mod tests;
mod tuning;
mod yaw_witness;

pub use self::calibration::RadiusCalibration;
pub use self::config::{DrivenAxle, LoadUncertainty, WheelSpeedConfig};
pub use self::days::{RadiusDay, RadiusDays, SlowLeak};
pub(crate) use self::radius_monitor::RadiusMonitor;
pub use self::report::{Pattern, RadiusReport, RadiusState, Unseen, WheelRadius};
pub use self::tuning::Tuning;
pub use crate::model::WheelSpeedSample;
