//! The whole car: four wheels of a simulated drive, so that front and rear really meet the same road, through the
//! estimator as it is shipped or with parts of it left out.

use std::sync::Arc;

use itpms_core::Real;
use itpms_core::car::CarEstimator;
use itpms_core::model::{CarConfig, CarEstimate, CarSample, CornerConfig, CornerSample, QuarterCar};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_road::RoadUnderCar;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

/// Seconds that warm the car up: until the shared road is found and the corners are valid.
const WARM_UP_S: f64 = 8.0;
/// Seconds over which costs repeat, nearly: ten frames of a corner and six of a side.
pub const STRETCH_S: f64 = 0.6;
const DRIVE_S: f64 = 12.0;
const WHEELBASE_M: f64 = 2.7;
/// Masses in kg of a rear corner: body, wheel.
const REAR_KG: [f64; 2] = [216.0, 50.0];

/// How much of the estimator runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    Everything,
    /// The same without road heights.
    WithoutRoad,
    WithoutRoadAndMonitor,
    CornersAlone,
}

#[derive(Clone)]
enum Car<T: Real> {
    Monitored { car: Box<MonitoredCar<T>>, road: RoadUnderCar<T> },
    Bare(Box<CarEstimator<T>>),
}

/// Configuration of the car of the built-in drives.
pub fn nominal<T: Real>() -> CarConfig<T> {
    let front = CornerConfig::<T>::paper();
    let car = &front.quarter_car;
    let [sprung, unsprung] = REAR_KG.map(T::lit);
    let rear = QuarterCar::new(sprung, unsprung, car.damping_n_s_per_m(), car.spring_n_per_m());
    let rear = CornerConfig { quarter_car: rear.expect("a lighter corner"), ..front };
    CarConfig {
        corners: [Some(front), Some(front), Some(rear), Some(rear)],
        wheelbase_m: Some(T::lit(WHEELBASE_M)),
    }
}

pub fn shipped<T: Real>(rate_hz: f64) -> Box<MonitoredCar<T>> {
    monitored(&MonitorConfig::new(&nominal()), rate_hz)
}

fn monitored<T: Real>(config: &MonitorConfig<T>, rate_hz: f64) -> Box<MonitoredCar<T>> {
    let mut car = Box::new(MonitoredCar::unconfigured());
    car.configure(config, rate_hz).expect("the drives' car");
    car
}

/// A simulated sample as the estimator takes it.
pub fn taken<T: Real>(sample: &CarSample<f64>) -> CarSample<T> {
    let corners = sample.corners.map(|corner| {
        corner.map(|c| CornerSample {
            body_accel_m_s2: T::lit(c.body_accel_m_s2),
            wheel_accel_m_s2: T::lit(c.wheel_accel_m_s2),
        })
    });
    CarSample { time_s: sample.time_s, speed_m_s: T::lit(sample.speed_m_s), corners, wheel_speeds: None }
}

/// A car under way, and how far it has come.
#[derive(Clone)]
pub struct RunningCar<T: Real> {
    car: Car<T>,
    /// Made beforehand, so that making them is not measured.
    samples: Arc<[CarSample<T>]>,
    next: usize,
    rate_hz: f64,
}

impl<T: Real> RunningCar<T> {
    /// Warmed up on `drive-puncture`, before the nail: 80 km/h on a class A road.
    pub fn new(extent: Extent, rate_hz: f64) -> Self {
        let mut scenario = Scenario::builtin("drive-puncture").expect("a built-in drive");
        (scenario.rate_hz, scenario.duration_s) = (rate_hz, DRIVE_S);
        let rows = Simulation::new(&scenario, 1).expect("a built-in drive");
        let mut config = nominal();
        if extent == Extent::CornersAlone {
            config.wheelbase_m = None;
        }
        let car = match extent {
            Extent::Everything | Extent::WithoutRoad => {
                let mut road = RoadUnderCar::unconfigured();
                if extent == Extent::Everything {
                    road.configure(&config, rate_hz).expect("the drives' car");
                }
                Car::Monitored { car: monitored(&MonitorConfig::new(&config), rate_hz), road }
            }
            Extent::WithoutRoadAndMonitor | Extent::CornersAlone => {
                let estimator = CarEstimator::new(&config, rate_hz).expect("the drives' car");
                Car::Bare(Box::new(estimator))
            }
        };
        let samples = rows.map(|row| taken(&row.car_sample())).collect();
        let mut running = Self { car, samples, next: 0, rate_hz };
        running.advance_by((WARM_UP_S * rate_hz) as usize);
        let estimate = running.advance();
        assert!(estimate.corners.iter().flatten().all(|corner| corner.validity.is_valid()));
        assert!(extent == Extent::CornersAlone || estimate.tracks.iter().all(|track| track.shared));
        running
    }

    pub fn stretch(&self) -> usize {
        (STRETCH_S * self.rate_hz) as usize
    }

    pub fn advance(&mut self) -> CarEstimate<T> {
        let sample = &self.samples[self.next];
        self.next += 1;
        match &mut self.car {
            Car::Monitored { car, road } => {
                let mut estimate = car.update(sample);
                road.update(sample, &car.estimator().quarter_cars(), &mut estimate);
                estimate
            }
            Car::Bare(car) => car.update(sample),
        }
    }

    pub fn advance_by(&mut self, count: usize) {
        for _ in 0..count {
            self.advance();
        }
    }

    /// Goes on until the next sample is the one, of a stretch, that completes most frames of corners and sides.
    pub fn advance_to_most_frames(&mut self) {
        let frames = self.clone().frames();
        let most = frames.iter().copied().max().flatten();
        let at = frames.iter().position(|&count| count == most);
        self.advance_by(at.unwrap_or_default());
    }

    /// Goes on until the next sample completes no frame.
    pub fn advance_to_no_frame(&mut self) {
        let at = self.clone().frames().iter().position(|&count| count == Some(0));
        self.advance_by(at.unwrap_or_default());
    }

    /// How many frames each sample of the next stretch completes, seen from outside: their diagnostics change. Nothing is
    /// known of the first one.
    fn frames(mut self) -> Vec<Option<usize>> {
        let estimates: Vec<_> = (0..self.stretch()).map(|_| self.advance()).collect();
        let counts = estimates.windows(2).map(|pair| {
            let [before, now] = [&pair[0], &pair[1]];
            let corners = now.corners.iter().flatten().zip(before.corners.iter().flatten());
            let corners = corners.filter(|(a, b)| a.diagnostics.nis != b.diagnostics.nis).count();
            let tracks = now.tracks.iter().zip(&before.tracks);
            Some(corners + tracks.filter(|(a, b)| a.incoherence != b.incoherence).count())
        });
        std::iter::once(None).chain(counts).collect()
    }
}
