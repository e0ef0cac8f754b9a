//! A ride as the estimators meet one: any speed, any sampling rate, jittered clocks, bumps. Written from eq. (1)
//! without the crate's own model: a road of slope -2, Runge-Kutta at 4 kHz, a Butterworth low-pass, sensors.

use super::quarter_plant::{Random, derivative, runge_kutta, stiffness};
use itpms_core::Real;
use itpms_core::estimator::Estimator;
use itpms_core::model::{CornerConfig, CornerEstimate};

/// Steps of the plant per second.
pub const PLANT_HZ: f64 = 4000.0;
/// Seconds driven before the first row, so that the car already swings.
const WARM_UP_S: f64 = 3.0;

/// A ride's inputs. Functions are of the time in s since the first row.
#[derive(Clone)]
pub struct Ride {
    pub seed: u64,
    pub seconds: f64,
    pub rate_hz: f64,
    /// Standard deviation of a row's time, as a share of the sampling period, bounded by twice that.
    pub jitter: f64,
    /// `Gd(n0)` in m³.
    pub roughness_m3: fn(f64) -> f64,
    pub noise_m_s2: f64,
    pub offset_m_s2: f64,
    pub speed_m_s: fn(f64) -> f64,
    pub pressure_kpa: fn(f64) -> f64,
    /// Road height beside the random one, in m.
    pub bump_m: fn(f64) -> f64,
}

impl Ride {
    /// 40 s on a class B road at 50 km/h, 500 Hz, noise 0.05 m/s², 230 kPa: not low, and not where an estimator starts.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            seconds: 40.0,
            rate_hz: 500.0,
            jitter: 0.0,
            roughness_m3: |_| 64e-6,
            noise_m_s2: 0.05,
            offset_m_s2: 0.0,
            speed_m_s: |_| 50.0 / 3.6,
            pressure_kpa: |_| 230.0,
            bump_m: |_| 0.0,
        }
    }

    pub fn rows(&self) -> Vec<Row> {
        let (body, wheel) = self.accelerations();
        let mut noise = Random::new(self.seed ^ 0x5EED);
        let mut clock = Random::new(self.seed ^ 0xC10C);
        let count = (self.seconds * self.rate_hz) as usize;
        (0..count)
            .map(|k| {
                let shift = self.jitter * clock.normal().clamp(-2.0, 2.0);
                let time_s = (k as f64 + shift) / self.rate_hz;
                let at = (time_s + WARM_UP_S) * PLANT_HZ;
                let mut sensor =
                    |signal: &[f64]| cubic(signal, at) + self.offset_m_s2 + self.noise_m_s2 * noise.normal();
                Row {
                    time_s,
                    speed_m_s: (self.speed_m_s)(time_s),
                    body: sensor(&body),
                    wheel: sensor(&wheel),
                    pressure_kpa: (self.pressure_kpa)(time_s),
                }
            })
            .collect()
    }

    /// Body and wheel acceleration at 4 kHz, from the warm-up's start, behind the anti-alias filter.
    fn accelerations(&self) -> (Vec<f64>, Vec<f64>) {
        let mut random = Random::new(self.seed);
        let h = 1.0 / PLANT_HZ;
        let steps = ((self.seconds + WARM_UP_S) * PLANT_HZ) as usize + 8;
        let mut filters = [low_pass(0.3 * self.rate_hz), low_pass(0.3 * self.rate_hz)];
        let (mut x, mut rough) = ([0.0; 4], 0.0);
        let (mut body, mut wheel) = (Vec::with_capacity(steps), Vec::with_capacity(steps));
        for i in 0..steps {
            let time_s = i as f64 * h - WARM_UP_S;
            let k_t = stiffness((self.pressure_kpa)(time_s));
            // Road velocity: white, one-sided density (2 pi n0)² Gd V in (m/s)²/Hz.
            let speed = (self.speed_m_s)(time_s.max(0.0));
            let roughness_m3 = (self.roughness_m3)(time_s);
            let density = (std::f64::consts::TAU * 0.1).powi(2) * roughness_m3 * speed;
            let slope = (density * PLANT_HZ / 2.0).sqrt() * random.normal();
            let road = |t: f64| rough + slope * t + (self.bump_m)(time_s + t);
            let d = derivative(&x, k_t, road(0.0));
            for ((signal, a), sections) in
                [(&mut body, d[1]), (&mut wheel, d[3])].into_iter().zip(&mut filters)
            {
                signal.push(sections.iter_mut().fold(a, |a, section| section.step(a)));
            }
            x = runge_kutta(&x, h, |x, t| derivative(x, k_t, road(t)));
            rough += slope * h;
        }
        (body, wheel)
    }
}

/// One row of a log, and the truth.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub time_s: f64,
    pub speed_m_s: f64,
    pub body: f64,
    pub wheel: f64,
    pub pressure_kpa: f64,
}

/// Catmull-Rom between points a twentieth or less of the signal's shortest period apart.
fn cubic(signal: &[f64], at: f64) -> f64 {
    let i = (at.floor() as usize).clamp(1, signal.len() - 3);
    let t = at - i as f64;
    let [a, b, c, d] = [signal[i - 1], signal[i], signal[i + 1], signal[i + 2]];
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}

/// A two-pole section, bilinear with its edge in place.
pub struct Section {
    b0: f64,
    a: [f64; 2],
    held: [f64; 2],
}

impl Section {
    pub fn step(&mut self, x: f64) -> f64 {
        let y = self.b0 * x + self.held[0];
        self.held = [2.0 * self.b0 * x - self.a[0] * y + self.held[1], self.b0 * x - self.a[1] * y];
        y
    }
}

/// Butterworth of fourth order: poles at 22.5 and 67.5 degrees.
pub fn low_pass(edge_hz: f64) -> [Section; 2] {
    let k = (std::f64::consts::PI * edge_hz / PLANT_HZ).tan();
    [22.5f64, 67.5].map(|degrees| {
        let damping = 2.0 * degrees.to_radians().cos();
        let a0 = 1.0 + damping * k + k * k;
        Section {
            b0: k * k / a0,
            a: [2.0 * (k * k - 1.0) / a0, (1.0 - damping * k + k * k) / a0],
            held: [0.0; 2],
        }
    })
}

/// The paper's corner with its noise known, at the rate given.
pub fn estimator<T: Real>(rate_hz: f64) -> Estimator<T> {
    Estimator::new(&CornerConfig::paper(), rate_hz).unwrap()
}

pub fn feed<T: Real>(estimator: &mut Estimator<T>, row: &Row) -> CornerEstimate<T> {
    estimator.update(row.time_s, T::lit(row.speed_m_s), T::lit(row.body), T::lit(row.wheel))
}

pub fn informed(rate_hz: f64, rows: &[Row]) -> Vec<CornerEstimate<f64>> {
    let mut estimator = estimator(rate_hz);
    rows.iter().map(|row| feed(&mut estimator, row)).collect()
}

/// Error over standard deviation.
pub fn normalised(estimate: &CornerEstimate<f64>, truth_kpa: f64) -> f64 {
    (estimate.pressure_kpa - truth_kpa) / estimate.pressure_sd_kpa
}
