//! The causal road under the wheels of a car that is being estimated.

use itpms_core::Real;
use itpms_core::conditioning::SampleClock;
use itpms_core::model::{
    CarConfig, CarEstimate, CarSample, CornerConfig, CornerEstimate, CornerSample, ParameterError,
    QuarterCar, Validity,
};

use crate::{RoadConfig, RoadFilter};

/// Seconds between two updates of a filter with stiffness and masses: another one costs a discretisation.
const FOLLOW_S: f64 = 0.1;

/// The road under one wheel, for the stiffness that its estimator finds.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadUnderWheel<T: Real> {
    filter: RoadFilter<T>,
    followed_s: f64,
}

impl<T: Real> RoadUnderWheel<T> {
    /// A road that nothing is known of yet. Errors: parameters of the corner that the filter refuses are named.
    pub fn new(config: &CornerConfig<T>) -> Result<Self, ParameterError> {
        let noise = config.accel_noise_or_usual_m_s2();
        let road = RoadConfig::new(config.quarter_car, config.initial_stiffness_n_per_m(), noise)?;
        Ok(Self { filter: RoadFilter::new(&road), followed_s: f64::NEG_INFINITY })
    }

    /// Takes a sample's time in s and accelerations, the corner as it seems to be and its estimate after the sample, and sets the
    /// estimate's road: NaN until the filter has settled. Sensors that are not to be believed tell nothing of the road, either.
    pub fn update(
        &mut self,
        time_s: f64,
        values: &CornerSample<T>,
        quarter_car: QuarterCar<T>,
        estimate: &mut CornerEstimate<T>,
    ) {
        if !(time_s - self.followed_s < FOLLOW_S) {
            self.followed_s = time_s;
            // Refused only outside its range: the road keeps the stiffness that it had.
            let _ = self.filter.set_stiffness(estimate.stiffness_n_per_m, estimate.stiffness_sd_n_per_m);
            self.filter.set_quarter_car(quarter_car);
        }
        let unknown = T::lit(f64::NAN);
        let lost = CornerSample { body_accel_m_s2: unknown, wheel_accel_m_s2: unknown };
        let values = if estimate.validity == Validity::BadSignal { &lost } else { values };
        let road = self.filter.update(time_s, values);
        (estimate.road_m, estimate.road_sd_m) =
            if road.validity.is_valid() { (road.road_m, road.road_sd_m) } else { (unknown, unknown) };
    }
}

/// The roads under all wheels of a car.
///
/// ```
/// use itpms_core::{CarConfig, CarSample, CornerConfig, CornerSample, MonitorConfig, MonitoredCar};
/// use itpms_road::RoadUnderCar;
///
/// # fn main() -> Result<(), itpms_core::ParameterError> {
/// let config = CarConfig { corners: [Some(CornerConfig::<f64>::paper()); 4], wheelbase_m: Some(2.7) };
/// let mut car = MonitoredCar::new(&MonitorConfig::new(&config), 200.0)?;
/// let mut road = RoadUnderCar::new(&config, 200.0)?;
/// # let corner = CornerSample { body_accel_m_s2: 0.1, wheel_accel_m_s2: 0.5 };
/// # let sample = CarSample { time_s: 0.0, speed_m_s: 20.0, corners: [Some(corner); 4], wheel_speeds: None };
/// let mut estimate = car.update(&sample);
/// road.update(&sample, &car.estimator().quarter_cars(), &mut estimate);
/// // `road_m` and `road_sd_m` of each corner are set now; NaN until the filters have settled.
/// # assert!(estimate.corners[0].is_some_and(|corner| corner.road_m.is_nan()));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadUnderCar<T: Real> {
    clock: Option<SampleClock<T>>,
    wheels: [Option<RoadUnderWheel<T>>; 4],
}

impl<T: Real> RoadUnderCar<T> {
    /// Roads that nothing is known of yet, under the corners of a car whose samples come at about `sample_rate_hz`.
    /// Errors: the rate must be positive and finite; parameters of a corner that its filter refuses are named.
    pub fn new(config: &CarConfig<T>, sample_rate_hz: f64) -> Result<Self, ParameterError> {
        let mut roads = Self::unconfigured();
        roads.configure(config, sample_rate_hz)?;
        Ok(roads)
    }

    /// Memory for the roads, as a constant: for a `static`, to be [configured](Self::configure) where it lies. Until then no road is known.
    pub const fn unconfigured() -> Self {
        Self { clock: None, wheels: [const { None }; 4] }
    }

    /// What [`new`](Self::new) does, where the roads lie: it takes little stack. Whatever was there is forgotten.
    pub fn configure(&mut self, config: &CarConfig<T>, sample_rate_hz: f64) -> Result<(), ParameterError> {
        self.clear();
        for (wheel, corner) in self.wheels.iter_mut().zip(&config.corners) {
            *wheel = corner.as_ref().map(RoadUnderWheel::new).transpose()?;
        }
        self.clock = Some(SampleClock::new(sample_rate_hz)?);
        Ok(())
    }

    pub fn clear(&mut self) {
        self.clock = None;
        self.wheels.iter_mut().for_each(|wheel| *wheel = None);
    }

    /// Takes a sample, the corners as they seem to be and the estimate after the sample, and sets the estimate's roads.
    pub fn update(
        &mut self,
        sample: &CarSample<T>,
        quarter_cars: &[Option<QuarterCar<T>>; 4],
        estimate: &mut CarEstimate<T>,
    ) {
        let Some(clock) = &mut self.clock else { return };
        let now_s = clock.take(sample.time_s, sample.speed_m_s).now_s;
        let corners = sample.corners.iter().zip(quarter_cars).zip(&mut estimate.corners);
        for (wheel, ((values, quarter_car), corner)) in self.wheels.iter_mut().zip(corners) {
            if let (Some(wheel), Some(values), Some(quarter_car), Some(corner)) =
                (wheel, values, quarter_car, corner)
            {
                wheel.update(now_s, values, *quarter_car, corner);
            }
        }
    }
}
