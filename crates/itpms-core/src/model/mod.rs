//! The car and its signals: parameters, samples, estimates, calibration. Knows no estimator.

mod calibration;
mod car;
mod estimate;
pub mod quarter_car;
mod sample;
mod tire;
mod wheels;

pub use self::calibration::{CalibrationError, CornerCalibration, Learned, VehicleCalibration};
pub use self::car::{CarConfig, Inflation};
pub use self::estimate::{CornerConfig, CornerEstimate, Diagnostics, Validity, Warning};
pub(crate) use self::quarter_car::positive;
pub use self::quarter_car::{ParameterError, QuarterCar};
pub use self::sample::{CarSample, Corner, CornerSample, Sample};
pub use self::tire::{PressureMap, RegressionError};
pub use self::wheels::Wheels;
