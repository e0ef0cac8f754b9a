//! How long samples may stay away.

/// A value that has not come for so many s is missing; until then the last one goes on. A car that brakes hard is 4 m/s slower by then.
pub(crate) const MISSING_S: f64 = 0.5;
/// So many s without a sample are a pause: what was under way is given up, and what was last known is old.
pub(crate) const PAUSE_S: f64 = 1.0;
/// Standing for so many s, loads may change and a tire may lose air without being seen.
pub(crate) const LONG_STOP_S: f64 = 10.0;
