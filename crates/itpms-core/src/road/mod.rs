//! The road under a wheel from the accelerations of body and wheel, for a tire stiffness known from elsewhere
//! (docs/math/road.md).
//!
//! An estimator that knows the stiffness feeds [`RoadFilter`] for the causal height; whoever writes a road record
//! feeds [`RoadRecorder`] for the smoothed one, with memory of its own; [`RoadLimits`] says which wavelengths
//! either can see. Nothing here knows of pressure, distance or files.

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
mod row;
mod segment;

pub use config::{RoadConfig, RoadLevel, SensorDelay};
pub use filter::{RoadEstimate, RoadFilter};
pub use limits::RoadLimits;
pub use recorder::{RecorderMemoryError, RoadRecorder, window_for};
pub use row::{RoadPoint, RoadRow};
pub use segment::Segment;
