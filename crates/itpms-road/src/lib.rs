//! The road under a wheel from the accelerations of body and wheel, for a tire stiffness that another estimator knows (docs/math/road.md).
//!
//! Whoever knows the stiffness feeds [`RoadFilter`] for the causal height, or [`RoadUnderCar`] for all wheels of a car that [`itpms_core`]
//! estimates; whoever writes a road record feeds [`RoadRecorder`] for the smoothed one, with memory of its own; [`RoadLimits`] says which
//! wavelengths either can see. [`RepeatedRoads`] watches for a road that repeats itself, as on a test bed or a drum
//! (docs/math/repeated-road.md). Nothing here knows of distance or files.
//!
//! ```
//! use itpms_core::model::QuarterCar;
//! use itpms_road::{RoadConfig, RoadFilter, RoadRecorder, RoadRow, Segment, window_for};
//! use itpms_core::model::CornerSample;
//! # let log = (0..1_000).map(|i| (f64::from(i) * 0.002, (f64::from(i) * 0.1).sin()));
//! # let log: Vec<_> = log.map(|(t, a)| (t, CornerSample { body_accel_m_s2: 0.1 * a, wheel_accel_m_s2: a })).collect();
//!
//! let config = RoadConfig::new(QuarterCar::paper_table_2(), 233_000.0, 0.05)?;
//!
//! // Causal: one estimate a sample; the stiffness as often as there is a new one.
//! let mut filter = RoadFilter::new(&config);
//! for (time_s, sample) in &log {
//!     filter.set_stiffness(232_500.0, 4_000.0)?;
//!     let road = filter.update(*time_s, sample);
//!     println!("{:.3} s: {:.4} m +- {:.4}, {:?}", road.road_time_s, road.road_m, road.road_sd_m, road.validity);
//! }
//!
//! // A record: rows go in, smoothed rows come out some 30 s later, memory does not grow.
//! let (rows, segments) = window_for(500.0, config.lookahead_s());
//! let (rows, segments) = (vec![RoadRow::default(); rows], vec![Segment::default(); segments]);
//! let mut recorder = RoadRecorder::new(&config, rows, segments)?;
//! let mut record = Vec::new();
//! for (time_s, sample) in &log {
//!     recorder.filter_mut().set_stiffness(232_500.0, 4_000.0)?;
//!     recorder.push(*time_s, sample, |point| record.push((point.time_s, point.road_m)));
//! }
//! recorder.finish(|point| record.push((point.time_s, point.road_m)));
//! assert_eq!(record.len(), log.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![no_std]
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]
#![allow(clippy::op_ref)] // A matrix that is multiplied by value is copied on the stack first.

mod car;
mod clock;
mod config;
mod filter;
mod high_pass;
mod interpolate;
mod level;
mod limits;
mod model;
mod recorder;
mod recursion;
mod repeated;
mod row;
mod segment;

pub use car::{RoadUnderCar, RoadUnderWheel};
pub use config::{RoadConfig, RoadLevel, SensorDelay};
pub use filter::{RoadEstimate, RoadFilter};
pub use limits::RoadLimits;
pub use recorder::{RecorderMemoryError, RoadRecorder, window_for};
pub use repeated::{EstimatorOnRepeatedRoad, RepeatedRoad, RepeatedRoads, RoadPeriod, RoadRepetition};
pub use row::{RoadPoint, RoadRow};
pub use segment::Segment;
