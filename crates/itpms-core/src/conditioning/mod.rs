//! What makes samples fit to be used: one time that only goes forward, a speed where not every sample tells it, values
//! checked and put on a uniform grid, wheels that have left the road.

pub(crate) mod clock;
mod resampler;
mod sample_clock;
mod speed;
pub(crate) mod wheel_lift;

pub use self::resampler::{GridSample, Resampler, SampleCounts};
pub use self::sample_clock::{Moment, SampleClock};
pub(crate) use self::speed::STANDING_M_S;
pub use self::speed::{SpeedHold, is_a_cars};

/// Least rate in Hz of the grid that estimators work on.
pub const LEAST_GRID_HZ: f64 = 400.0;

/// A value that has not come for so many s is missing; until then the last one goes on. A car that brakes hard is 4 m/s slower by then.
pub(crate) const MISSING_S: f64 = 0.5;
/// So many s without a sample are a pause: what was under way is given up, and what was last known is old.
pub(crate) const PAUSE_S: f64 = 1.0;
/// Standing for so many s, loads may change and a tire may lose air without being seen.
pub(crate) const LONG_STOP_S: f64 = 10.0;
