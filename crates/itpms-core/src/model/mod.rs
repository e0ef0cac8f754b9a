//! The car and its signals: parameters, samples, estimates, calibration. Knows no estimator.

mod air;
mod body_fit;
mod calibration;
mod car;
mod car_estimate;
mod estimate;
mod pressure_unit;
mod quarter_car;
mod radius_differences;
mod sample;
mod strut_reading;
mod tire;
mod uncertainty;
mod wheel_hop;
mod wheels;

pub(crate) use self::air::SEA_LEVEL_KPA;
pub use self::air::{Air, standard_atmosphere_kpa};
pub(crate) use self::body_fit::{AxleFit, COHERENCE_BINS, UNEXPLAINED_BINS};
pub use self::body_fit::{BodyFit, Misfit};
pub use self::calibration::{CalibrationError, CornerCalibration, Learned, VehicleCalibration};
pub(crate) use self::calibration::{UNCALIBRATED_BIAS_SD, UNKNOWN_COUPLING_SD};
pub use self::car::{CarConfig, Inflation};
pub use self::car_estimate::{CarEstimate, TrackState};
pub use self::estimate::{
    ColdPressure, CornerConfig, CornerEstimate, Diagnostics, Level, Loss, Validity, Warning,
};
pub use self::pressure_unit::PressureUnit;
pub use self::quarter_car::{ParameterError, QuarterCar, positive};
pub(crate) use self::radius_differences::{RadiusDifferences, SEEN};
pub(crate) use self::sample::{ABSURD_M_S2, Side};
pub use self::sample::{CarSample, Corner, CornerSample, WheelSpeedSample};
pub use self::strut_reading::StrutReading;
pub use self::tire::{PressureMap, RegressionError};
pub use self::uncertainty::{Confidence, ParameterUncertainty};
pub(crate) use self::uncertainty::{ONE_SIDED_95, OUTLIER_SD, SURELY_SD};
pub(crate) use self::wheel_hop::{HOP_BAND_HZ, HOP_HZ};
pub use self::wheels::Wheels;
