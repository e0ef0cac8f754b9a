//! One of the paper's filters on each corner of a car. They know nothing of each other: front and rear over the same road is the default
//! estimator's.

use itpms_core::Real;
use itpms_core::conditioning::SampleClock;
use itpms_core::model::{CarEstimate, CarSample, Corner, ParameterError, TrackState};
use itpms_core::monitor::{Monitor, MonitorConfig, MonitoredWheels};
use itpms_core::warning::MonitorReport;

use crate::{EstimatorKind, PaperEstimator};

/// A car whose corners are estimated by one of the paper's filters. The corrected one is under the monitor; the filters as published,
/// which are never valid, are not.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PaperCar<T: Real> {
    kind: EstimatorKind,
    clock: SampleClock<T>,
    corners: [Option<PaperEstimator<T>>; 4],
    monitor: Monitor<T>,
}

impl<T: Real> PaperCar<T> {
    /// A car for samples that come at about `sample_rate_hz`; one without corners for [`EstimatorKind::Informed`], which is none of the
    /// paper's. Errors: the rate must be positive and finite, limits and references numbers in order; parameters of a corner that the
    /// filter refuses are named.
    pub fn new(
        kind: EstimatorKind,
        config: &MonitorConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<Self, ParameterError> {
        let mut corners = [const { None }; 4];
        for (place, corner) in corners.iter_mut().zip(&config.car.corners) {
            if let Some(corner) = corner {
                *place = PaperEstimator::new(kind, corner, sample_rate_hz)?;
            }
        }
        let (clock, monitor) = (SampleClock::new(sample_rate_hz)?, Monitor::new(config, sample_rate_hz)?);
        Ok(Self { kind, clock, corners, monitor })
    }

    /// All tires have their placard pressures from the next sample on, for `seconds`. Errors: the length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.corners.iter_mut().flatten().try_for_each(|corner| corner.begin_calibration(seconds))?;
        self.monitor.begin_calibration(seconds)
    }

    /// Takes one sample; gives the estimate after it.
    pub fn update(&mut self, sample: &CarSample<T>) -> CarEstimate<T> {
        if self.kind.is_as_published() {
            return self.estimate(sample);
        }
        let at = self.clock.take(sample.time_s, sample.speed_m_s);
        let (at, screened) = self.monitor.screen(&at, sample);
        let mut estimate = self.estimate(&screened);
        for corner in self.monitor.judge(&at, &mut estimate).iter() {
            if let Some(estimator) = &mut self.corners[corner.index()] {
                estimator.restart();
            }
        }
        estimate
    }

    fn estimate(&mut self, sample: &CarSample<T>) -> CarEstimate<T> {
        let mut corners = [None; 4];
        for corner in Corner::ALL {
            let i = corner.index();
            if let (Some(estimator), Some(values)) = (&mut self.corners[i], sample.corners[i]) {
                let (body, wheel) = (values.body_accel_m_s2, values.wheel_accel_m_s2);
                corners[i] = Some(estimator.update(sample.time_s, sample.speed_m_s, body, wheel));
            }
        }
        let correlation =
            [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| if i == j { T::one() } else { T::zero() }));
        CarEstimate {
            time_s: sample.time_s,
            corners,
            correlation,
            loss_correlation: correlation,
            tracks: [TrackState::unknown(); 2],
        }
    }

    /// Takes what the wheel speeds of the same car show now into the report ([`Monitor::follow_wheels`]).
    pub fn follow_wheels(&mut self, wheels: &MonitoredWheels<T>) {
        self.monitor.follow_wheels(wheels);
    }

    /// The monitor's report after the last sample.
    pub fn report(&self) -> &MonitorReport<T> {
        self.monitor.report()
    }

    /// Whether the speed contradicts the wheels by a standstill.
    pub fn denies_standstill(&self) -> bool {
        self.monitor.denies_standstill()
    }
}
