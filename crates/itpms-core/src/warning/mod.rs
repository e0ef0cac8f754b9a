//! When to warn of what: limits, pressures against them, and what is reported.

mod alert;
pub(crate) mod all_low;
pub(crate) mod leak;
mod limits;
pub(crate) mod low;
pub(crate) mod reference_pressure;
pub(crate) mod report;

pub use self::alert::{Alert, Basis, Cause, Reading};
pub use self::limits::{Limits, Regulation};
pub use self::report::{Change, Doubt, MonitorReport, WheelReport, WheelState};

/// A pressure whose level rests on the vehicle file alone may be a healthy tire's unless it is below its reference by so many sds: three
/// healthy wheels of a hundred thousand read so low. What the file leaves open is another with every car and the same all the while: no
/// waiting averages it.
pub(crate) const NOT_HEALTHY: f64 = 4.0;
