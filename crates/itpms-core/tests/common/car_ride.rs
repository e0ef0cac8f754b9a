//! A car of four quarter cars on two tracks, rear wheels behind front ones on the same road. Written from eq. (1) without
//! the crate's own model: a road of slope -2 over distance, Runge-Kutta at 4 kHz, a Butterworth low-pass, sensors.

use itpms_core::Real;
use itpms_core::car::CarEstimator;
use itpms_core::model::{
    CarConfig, CarEstimate, CarSample, Confidence, CornerConfig, CornerSample, ParameterUncertainty,
    PressureMap, QuarterCar,
};

use super::quarter_plant::{KS, Random, runge_kutta, stiffness};
use super::ride::{PLANT_HZ, low_pass};

/// Sprung and unsprung mass, damping of front and rear.
const AXLES: [[f64; 3]; 2] = [[240.8, 56.9, 925.8], [216.0, 50.0, 870.0]];
pub const PLACARD_KPA: f64 = 241.3;
pub const WHEELBASE_M: f64 = 2.7;
pub const RATE_HZ: f64 = 500.0;
/// Points of the road per meter.
const PER_M: f64 = 200.0;
/// Seconds at the first speed before the first row.
const WARM_UP_S: f64 = 3.0;

#[derive(Clone, Copy)]
pub struct CarRide {
    pub seed: u64,
    pub seconds: f64,
    pub speed_m_s: fn(f64) -> f64,
    pub pressure_kpa: fn(f64) -> [f64; 4],
    /// Displacement power density of the road in m³ at 0.1 cycles/m.
    pub roughness_m3: f64,
}

impl CarRide {
    /// 15 s at 60 km/h on a class B road, one tire at 200 kPa and the others near the placard.
    pub fn new(seed: u64) -> Self {
        Self {
            roughness_m3: 64e-6,
            seed,
            seconds: 15.0,
            speed_m_s: |_| 60.0 / 3.6,
            pressure_kpa: |_| [200.0, 235.0, 240.0, 245.0],
        }
    }

    pub fn rows(&self) -> Vec<CarSample<f64>> {
        let h = 1.0 / PLANT_HZ;
        let steps = ((self.seconds + WARM_UP_S) * PLANT_HZ) as usize;
        let speed = |i: usize| (self.speed_m_s)((i as f64 * h - WARM_UP_S).max(0.0));
        let mut distance_m = vec![5.0];
        (0..steps).for_each(|i| distance_m.push(distance_m[i] + h * speed(i)));
        let accelerations: Vec<_> = (0..4).map(|corner| self.corner(corner, &distance_m)).collect();
        let mut noise = Random::new(self.seed ^ 0x5EED);
        let every = (PLANT_HZ / RATE_HZ) as usize;
        ((WARM_UP_S * PLANT_HZ) as usize..steps)
            .step_by(every)
            .map(|i| CarSample {
                time_s: i as f64 * h - WARM_UP_S,
                speed_m_s: speed(i),
                corners: std::array::from_fn(|corner| {
                    let (body, wheel) = accelerations[corner][i];
                    Some(CornerSample {
                        body_accel_m_s2: body + 0.05 * noise.normal(),
                        wheel_accel_m_s2: wheel + 0.05 * noise.normal(),
                    })
                }),
                wheel_speeds: None,
            })
            .collect()
    }

    /// Accelerations of a corner's body and wheel at the plant's rate.
    fn corner(&self, corner: usize, distance_m: &[f64]) -> Vec<(f64, f64)> {
        let mut random = Random::new(self.seed ^ (1 + corner as u64 % 2));
        // Height as a random walk over distance: Gd(n) = roughness (n0/n)² is white in slope, with a variance of
        // (2 pi n0)² Gd / 2 per meter.
        let step = ((core::f64::consts::TAU * 0.1).powi(2) * self.roughness_m3 / 2.0 / PER_M).sqrt();
        let mut heights = vec![0.0];
        for i in 0..(distance_m[distance_m.len() - 1] * PER_M) as usize + 2 {
            heights.push(heights[i] + step * random.normal());
        }
        let behind_m = if corner < 2 { 0.0 } else { WHEELBASE_M };
        let road = |distance_m: f64| {
            let at = (distance_m - behind_m) * PER_M;
            let (i, share) = (at as usize, at.fract());
            heights[i] + share * (heights[i + 1] - heights[i])
        };
        let [sprung, unsprung, damping] = AXLES[corner / 2];
        let stiffness_at =
            |step: usize| stiffness((self.pressure_kpa)(step as f64 / PLANT_HZ - WARM_UP_S)[corner]);
        let rates = |x: &[f64; 4], road: f64, k_t: f64| {
            let suspension = KS * (x[2] - x[0]) + damping * (x[3] - x[1]);
            [x[1], suspension / sprung, x[3], (k_t * (road - x[2]) - suspension) / unsprung]
        };
        let start = road(distance_m[0]);
        let mut x = [start, 0.0, start, 0.0];
        let mut filters = [low_pass(0.3 * RATE_HZ), low_pass(0.3 * RATE_HZ)];
        distance_m
            .windows(2)
            .enumerate()
            .map(|(step, way)| {
                let k_t = stiffness_at(step);
                let (from, to) = (road(way[0]), road(way[1]));
                let d = rates(&x, from, k_t);
                x = runge_kutta(&x, 1.0 / PLANT_HZ, |x, t| rates(x, from + (to - from) * t * PLANT_HZ, k_t));
                let [body, wheel] = &mut filters;
                (
                    body.iter_mut().fold(d[1], |a, section| section.step(a)),
                    wheel.iter_mut().fold(d[3], |a, section| section.step(a)),
                )
            })
            .collect()
    }
}

/// The car of these rides, as its vehicle file says.
pub fn config<T: Real>() -> CarConfig<T> {
    let corner = |axle: usize| {
        let [sprung, unsprung, damping] = AXLES[axle].map(T::lit);
        let car = QuarterCar::new(sprung, unsprung, damping, T::lit(KS)).unwrap();
        let placard = T::lit(PLACARD_KPA);
        let measured = ParameterUncertainty::of(Confidence::Measured);
        let corner = CornerConfig::new(car, PressureMap::paper_eq_5(), placard).unwrap();
        CornerConfig { uncertainty: measured, ..corner }.with_accel_noise(T::lit(0.05))
    };
    let corners = [0, 0, 1, 1].map(|axle| Some(corner(axle).unwrap()));
    CarConfig { corners, wheelbase_m: Some(T::lit(WHEELBASE_M)) }
}

/// A row in another precision.
pub fn cast<T: Real>(row: &CarSample<f64>) -> CarSample<T> {
    CarSample {
        time_s: row.time_s,
        speed_m_s: T::lit(row.speed_m_s),
        corners: row.corners.map(|corner| {
            corner.map(|c| CornerSample {
                body_accel_m_s2: T::lit(c.body_accel_m_s2),
                wheel_accel_m_s2: T::lit(c.wheel_accel_m_s2),
            })
        }),
        wheel_speeds: None,
    }
}

pub fn car<T: Real>(config: &CarConfig<T>) -> CarEstimator<T> {
    CarEstimator::new(config, RATE_HZ).unwrap()
}

/// The same, its first seconds being a calibration.
pub fn calibrated<T: Real>(seconds: f64) -> CarEstimator<T> {
    let mut car = car(&config());
    car.begin_calibration(seconds).unwrap();
    car
}

pub fn drive<T: Real>(car: &mut CarEstimator<T>, rows: &[CarSample<f64>]) -> Vec<CarEstimate<T>> {
    rows.iter().map(|row| car.update(&cast(row))).collect()
}

/// Pressure and sd of the corners that are there must be finite where they are called valid.
pub fn sound<T: Real>(estimate: &CarEstimate<T>) {
    for corner in estimate.corners.iter().flatten().filter(|corner| corner.validity.is_valid()) {
        assert!(corner.pressure_kpa.is_finite() && corner.pressure_sd_kpa > T::zero(), "{corner:?}");
        assert!(corner.pressure_sd_kpa.is_finite() && corner.stiffness_n_per_m.is_finite(), "{corner:?}");
    }
    for (i, row) in estimate.correlation.iter().enumerate() {
        assert!(row[i] == T::one() && row.iter().all(|r| r.abs() <= T::lit(1.0 + 1e-3)), "{row:?}");
    }
}
