//! The estimators of a drive, one per corner, side by side.

use itpms_core::estimate::CornerEstimate;
use itpms_core::estimator::Estimator;
use itpms_core::quarter_car::QuarterCar;
use itpms_core::sample::Corner;
use itpms_data::{LogRow, Vehicle};

use crate::args::EstimateArgs;
use crate::exit::Failure;

/// What is known after a row, in the order of [`Corner::ALL`].
pub(super) type Estimates = [Option<CornerEstimate<f64>>; 4];

/// Load and damping as identified, in the order of [`Corner::ALL`].
pub(super) type QuarterCars = [Option<QuarterCar<f64>>; 4];

/// The running estimators.
pub(super) struct Drive {
    estimators: [Option<Estimator<f64>>; 4],
}

impl Drive {
    pub(super) fn new(
        args: &EstimateArgs,
        vehicle: &Vehicle,
        corners: &[Corner],
        sample_rate_hz: f64,
    ) -> Result<Self, Failure> {
        let mut estimators = [const { None }; 4];
        for corner in corners {
            if let Some(config) = vehicle.corner(*corner) {
                let fail = |error| Failure::Usage(format!("corner {}: {error}", corner.label()));
                let estimator = Estimator::new(args.estimator, config, sample_rate_hz).map_err(fail)?;
                let mut estimator = estimator.with_road_repetition(args.road_repeats);
                if let Some(seconds) = args.calibrate_s {
                    estimator = estimator.with_reset_drive(seconds).map_err(fail)?;
                }
                estimators[corner.index()] = Some(estimator);
            }
        }
        Ok(Self { estimators })
    }

    /// The cars as they seem to be now, in the order of [`Corner::ALL`].
    pub(super) fn quarter_cars(&self) -> QuarterCars {
        self.estimators.each_ref().map(|estimator| estimator.as_ref().map(Estimator::quarter_car))
    }

    pub(super) fn update(&mut self, row: &LogRow) -> Estimates {
        let mut estimates = [None; 4];
        for ((estimate, estimator), corner) in
            estimates.iter_mut().zip(&mut self.estimators).zip(&row.corners)
        {
            if let (Some(estimator), Some(c)) = (estimator, corner) {
                *estimate =
                    Some(estimator.update(row.time_s, row.speed_m_s, c.body_accel_m_s2, c.wheel_accel_m_s2));
            }
        }
        estimates
    }
}
