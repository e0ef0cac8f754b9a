//! The estimator of one corner, and the road that may repeat itself under it.

use itpms_core::conditioning::SampleClock;
use itpms_core::model::{CornerConfig, CornerEstimate, CornerSample, ParameterError};
use itpms_core::{Estimator, Real};

use super::{RepeatedRoad, RoadRepetition};

/// An [`Estimator`] that follows what a road that repeats itself shows of the tire.
///
/// ```
/// use itpms_core::CornerConfig;
/// use itpms_road::{EstimatorOnRepeatedRoad, RoadPeriod, RoadRepetition};
///
/// # fn main() -> Result<(), itpms_core::ParameterError> {
/// // A drum that comes round every 0.66 s; `RoadRepetition::Detect` finds that by itself.
/// let repetition = RoadRepetition::Every(RoadPeriod::new(0.66)?);
/// let mut corner = EstimatorOnRepeatedRoad::new(&CornerConfig::<f64>::paper(), 500.0, repetition)?;
/// corner.estimator_mut().begin_calibration(10.0)?;
/// let estimate = corner.update(0.0, 5.6, 0.1, 0.5);
/// assert!(!estimate.validity.is_valid());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EstimatorOnRepeatedRoad<T: Real> {
    estimator: Estimator<T>,
    clock: SampleClock<T>,
    road: RepeatedRoad<T>,
}

impl<T: Real> EstimatorOnRepeatedRoad<T> {
    /// An estimator for a corner whose samples come at about `sample_rate_hz`, on a road of which this is known.
    /// Errors: the rate must be positive and finite; parameters of the corner that the filters refuse are named.
    pub fn new(
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
        repetition: RoadRepetition,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            estimator: Estimator::new(config, sample_rate_hz)?,
            clock: SampleClock::new(sample_rate_hz)?,
            road: RepeatedRoad::new(config, sample_rate_hz, repetition)?,
        })
    }

    pub fn estimator(&self) -> &Estimator<T> {
        &self.estimator
    }

    /// The estimator, to calibrate or to restart it.
    pub fn estimator_mut(&mut self) -> &mut Estimator<T> {
        &mut self.estimator
    }

    /// As [`Estimator::update`].
    pub fn update(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        body_accel_m_s2: T,
        wheel_accel_m_s2: T,
    ) -> CornerEstimate<T> {
        let estimate = self.estimator.update(time_s, speed_m_s, body_accel_m_s2, wheel_accel_m_s2);
        if let Some(steady_s) = self.clock.take(time_s, speed_m_s).time_s {
            let (values, car) =
                (CornerSample { body_accel_m_s2, wheel_accel_m_s2 }, self.estimator.quarter_car());
            let estimator = &mut self.estimator;
            self.road.update(steady_s, &values, &car, &estimate, |stiffness| estimator.follow(stiffness));
        }
        estimate
    }
}
