//! A quarter car on a rough road, written from eq. (1) without the crate's own model: road as integrated white
//! noise (slope -2), Runge-Kutta at 4 kHz, an anti-alias filter without delay, sensors with white noise.

use itpms_core::model::CornerSample;

/// The paper's Table 2 and eq. (5), written out.
pub const MB: f64 = 240.8;
pub const MW: f64 = 56.9;
pub const CS: f64 = 925.8;
pub const KS: f64 = 29_114.0;
pub const SLOPE: f64 = 713.91;
pub const AT_ZERO: f64 = 60_880.0;

/// Steps of the plant per second.
const PLANT_HZ: f64 = 4000.0;

pub fn stiffness(pressure_kpa: f64) -> f64 {
    SLOPE * pressure_kpa + AT_ZERO
}

pub fn pressure(stiffness_n_per_m: f64) -> f64 {
    (stiffness_n_per_m - AT_ZERO) / SLOPE
}

/// The paper's Fig. 6: 241.3 kPa until 20 s, down to 137.9 in 2.5 s.
pub fn fig_6_kpa(time_s: f64) -> f64 {
    241.3 + (137.9 - 241.3) * ((time_s - 20.0) / 2.5).clamp(0.0, 1.0)
}

/// SplitMix64 with Box-Muller on top: enough for tests, and the same on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xA076_1D64_78BD_642F) ^ 0x1234_5678_9ABC_DEF1)
    }

    /// Uniform in (0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + 0.5 / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// A drive's record: samples at `dt_s`, and the truth at the same instants.
pub struct Drive {
    pub dt_s: f64,
    pub samples: Vec<CornerSample<f64>>,
    pub pressure_kpa: Vec<f64>,
    pub road_m: Vec<f64>,
    pub wheel_m: Vec<f64>,
}

/// A drive of `duration_s` on a road of ISO class A (16e-6 m³) at 20 km/h with slope -2, sampled at `rate_hz` with
/// white sensor noise of `noise` m/s² rms.
pub fn drive(
    seed: u64,
    duration_s: f64,
    rate_hz: f64,
    noise: f64,
    pressure_kpa: impl Fn(f64) -> f64,
) -> Drive {
    let mut random = Random::new(seed);
    let h = 1.0 / PLANT_HZ;
    let steps = (duration_s * PLANT_HZ) as usize + 200;
    // Gd(n) = Gd(n0) (n0/n)²: road velocity white, one-sided density (2 pi n0)² Gd(n0) V in (m/s)²/Hz.
    let density = (std::f64::consts::TAU * 0.1).powi(2) * 16e-6 * (20.0 / 3.6);
    let velocity_sd = (density * PLANT_HZ / 2.0).sqrt();
    let mut x = [0.0; 4];
    let mut road = 0.0;
    let (mut accelerations, mut roads, mut wheels) = (vec![], vec![], vec![]);
    for i in 0..steps {
        let k_t = stiffness(pressure_kpa(i as f64 * h));
        let slope = velocity_sd * random.normal();
        let d = derivative(&x, k_t, road);
        accelerations.push((d[1], d[3]));
        roads.push(road);
        wheels.push(x[2]);
        x = runge_kutta(&x, h, |x, t| derivative(x, k_t, road + slope * t));
        road += slope * h;
    }
    let every = (PLANT_HZ / rate_hz).round() as usize;
    let taps = low_pass(0.3 * rate_hz / PLANT_HZ);
    let half = taps.len() / 2;
    let mut out =
        Drive { dt_s: 1.0 / rate_hz, samples: vec![], pressure_kpa: vec![], road_m: vec![], wheel_m: vec![] };
    // The first sample stands where the filter has its first full window.
    let mut i = every.max(half.next_multiple_of(every));
    while i + half < steps && out.samples.len() < (duration_s * rate_hz) as usize {
        let window = &accelerations[i - half..=i + half];
        let sum =
            |pick: fn(&(f64, f64)) -> f64| window.iter().zip(&taps).map(|(a, w)| w * pick(a)).sum::<f64>();
        out.samples.push(CornerSample {
            body_accel_m_s2: sum(|a| a.0) + noise * random.normal(),
            wheel_accel_m_s2: sum(|a| a.1) + noise * random.normal(),
        });
        out.pressure_kpa.push(pressure_kpa(i as f64 * h));
        out.road_m.push(roads[i]);
        out.wheel_m.push(wheels[i]);
        i += every;
    }
    out
}

/// Eq. (1) as `[x_b, v_b, x_w, v_w]'`.
pub fn derivative(x: &[f64; 4], k_t: f64, road: f64) -> [f64; 4] {
    let suspension = KS * (x[2] - x[0]) + CS * (x[3] - x[1]);
    [x[1], suspension / MB, x[3], (k_t * (road - x[2]) - suspension) / MW]
}

pub fn runge_kutta(x: &[f64; 4], h: f64, f: impl Fn(&[f64; 4], f64) -> [f64; 4]) -> [f64; 4] {
    let at = |k: &[f64; 4], s: f64| std::array::from_fn(|i| x[i] + s * k[i]);
    let k1 = f(x, 0.0);
    let k2 = f(&at(&k1, h / 2.0), h / 2.0);
    let k3 = f(&at(&k2, h / 2.0), h / 2.0);
    let k4 = f(&at(&k3, h), h);
    std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// Symmetric (hence without delay) windowed sinc with its edge at `edge` cycles per step, gain 1 at rest.
fn low_pass(edge: f64) -> Vec<f64> {
    let half = (1.5 / edge) as i32;
    let taps: Vec<f64> = (-half..=half)
        .map(|i| {
            let t = f64::from(i);
            let sinc = if i == 0 {
                1.0
            } else {
                (std::f64::consts::TAU * edge * t).sin() / (std::f64::consts::TAU * edge * t)
            };
            sinc * (0.5 + 0.5 * (std::f64::consts::PI * t / f64::from(half + 1)).cos())
        })
        .collect();
    let sum: f64 = taps.iter().sum();
    taps.iter().map(|w| w / sum).collect()
}

pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0f64), |(s, n), v| (s + v * v, n + 1.0));
    (sum / count).sqrt()
}

/// Median, and the 10 % and 90 % quantiles around it.
pub fn quantiles(values: &[f64]) -> (f64, f64, f64) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |q: f64| sorted[((sorted.len() - 1) as f64 * q).round() as usize];
    (at(0.1), at(0.5), at(0.9))
}
