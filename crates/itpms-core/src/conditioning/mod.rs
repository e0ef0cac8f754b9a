//! Conditioning of samples: one time that only goes forward, a speed where not every sample tells it, values
//! checked and put on a uniform grid, wheels that have left the road.

pub(crate) mod clock;
pub(crate) mod pauses;
mod resampler;
mod sample_clock;
mod speed;
pub(crate) mod wheel_lift;

pub use self::resampler::{GridSample, Resampler, SampleCounts};
pub(crate) use self::sample_clock::estimators_rate;
pub use self::sample_clock::{Moment, SAMPLE_RATES_HZ, SampleClock};
pub(crate) use self::speed::STANDING_M_S;
pub use self::speed::{SpeedHold, is_a_cars};

/// Least rate in Hz of the grid that estimators work on.
pub const LEAST_GRID_HZ: f64 = 400.0;
/// Rate in Hz to which signals of wheel hop and below are thinned: five times the band's upper edge.
pub(crate) const THINNED_HZ: f64 = 100.0;
