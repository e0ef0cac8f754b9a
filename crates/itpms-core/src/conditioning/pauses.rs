//! How long samples may stay away, and for how long they have to have come.

/// A value that has not come for so many s is missing; until then the last one goes on. A car that brakes hard is 4 m/s slower by then.
pub(crate) const MISSING_S: f64 = 0.5;
/// So many s without a sample are a pause: what was under way is given up, and what was last known is old.
pub(crate) const PAUSE_S: f64 = 1.0;
/// Standing for so many s, loads may change and a tire may lose air without being seen.
pub(crate) const LONG_STOP_S: f64 = 10.0;
/// So many s of driving have to have been learned from before an estimate, a fit or a state counts: sixteen independent frames of 0.12 s,
/// whose mean power is known to a quarter.
pub(crate) const ENOUGH_S: f64 = 2.0;
/// Seconds between two steps of the work that is not due with every sample: decisions on pressures, and holding those that a calibration sets.
pub(crate) const DECIDE_S: f64 = 0.1;
/// Largest rounding error of an hour of steps added up, in s.
pub(crate) const ROUNDING_S: f64 = 1e-6;
