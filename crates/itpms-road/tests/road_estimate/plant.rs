//! A small world of its own for the road tests: an ISO 8608 road with random amplitude and phase, a quarter car
//! integrated by Runge-Kutta at 4 or 8 kHz, an anti-alias filter, sensors. It shares no code with the crate.

use std::f64::consts::PI;

/// SplitMix64 with Box-Muller.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.bits() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }
    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (2.0 * PI * self.uniform()).cos()
    }
}

/// In-place radix-2 transform `X_k = sum x_n exp(sign 2 pi i n k / N)`.
pub(crate) fn fft(re: &mut [f64], im: &mut [f64], sign: f64) {
    let n = re.len();
    let mut j = 0;
    for i in 1..n {
        let mut bit = n >> 1;
        while j & bit != 0 {
            j ^= bit;
            bit >>= 1;
        }
        j |= bit;
        if i < j {
            re.swap(i, j);
            im.swap(i, j);
        }
    }
    let mut len = 2;
    while len <= n {
        let (half, step) = (len / 2, sign * 2.0 * PI / len as f64);
        let twiddle: Vec<(f64, f64)> =
            (0..half).map(|k| ((step * k as f64).cos(), (step * k as f64).sin())).collect();
        for start in (0..n).step_by(len) {
            for (k, &(c, s)) in twiddle.iter().enumerate() {
                let (a, b) = (start + k, start + k + half);
                let (xr, xi) = (re[b] * c - im[b] * s, re[b] * s + im[b] * c);
                (re[b], im[b]) = (re[a] - xr, im[a] - xi);
                re[a] += xr;
                im[a] += xi;
            }
        }
        len *= 2;
    }
}

/// Two-pole section `b/a` with its state.
#[derive(Clone)]
pub(crate) struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
    z: [f64; 2],
}

impl Biquad {
    /// Bilinear, prewarped Butterworth sections of fourth order; `high` for the high-pass.
    pub(crate) fn butterworth_4(cutoff_hz: f64, rate_hz: f64, high: bool) -> Vec<Biquad> {
        let k = (PI * cutoff_hz / rate_hz).tan();
        [0.765_366_864_7, 1.847_759_065]
            .iter()
            .map(|damping| {
                let norm = 1.0 / (1.0 + damping * k + k * k);
                let b0 = if high { norm } else { k * k * norm };
                let b1 = if high { -2.0 * b0 } else { 2.0 * b0 };
                let a = [2.0 * (k * k - 1.0) * norm, (1.0 - damping * k + k * k) * norm];
                Biquad { b: [b0, b1, b0], a, z: [0.0; 2] }
            })
            .collect()
    }
    pub(crate) fn step(&mut self, x: f64) -> f64 {
        let y = self.b[0] * x + self.z[0];
        self.z[0] = self.b[1] * x - self.a[0] * y + self.z[1];
        self.z[1] = self.b[2] * x - self.a[1] * y;
        y
    }
}

#[derive(Clone)]
pub(crate) struct Drive {
    pub(crate) seed: u64,
    pub(crate) speed_kmh: f64,
    /// `Gd(n0)` in m³.
    pub(crate) roughness: f64,
    pub(crate) waviness: f64,
    pub(crate) rate_hz: f64,
    pub(crate) seconds: f64,
    pub(crate) noise: f64,
    /// Cutoff of the Butterworth low-pass before sampling, as a share of the rate; 0: none.
    pub(crate) cutoff_per_rate: f64,
    /// sprung, unsprung mass, damping, spring, tire stiffness
    pub(crate) car: [f64; 5],
    pub(crate) offsets: [f64; 2],
}

pub(crate) const CLASS_A: f64 = 16e-6;
pub(crate) const CLASS_B: f64 = 64e-6;
pub(crate) const CLASS_C: f64 = 256e-6;
/// Paper's eq. (5) at 241.3 kPa.
pub(crate) const STIFFNESS: f64 = 713.91 * 241.3 + 60_880.0;

impl Drive {
    pub(crate) fn new(seed: u64, speed_kmh: f64, roughness: f64) -> Self {
        Self {
            seed,
            speed_kmh,
            roughness,
            waviness: 2.0,
            rate_hz: 500.0,
            seconds: 60.0,
            noise: 0.05,
            cutoff_per_rate: 0.3,
            car: [240.8, 56.9, 925.8, 29_114.0, STIFFNESS],
            offsets: [0.0; 2],
        }
    }

    pub(crate) fn speed(&self) -> f64 {
        self.speed_kmh / 3.6
    }
}

pub(crate) struct Log {
    pub(crate) rate_hz: f64,
    pub(crate) time: Vec<f64>,
    pub(crate) body: Vec<f64>,
    pub(crate) wheel: Vec<f64>,
    /// Truth sampled as a log's truth column is: what is shorter than two samples folds into it.
    pub(crate) road: Vec<f64>,
    /// Truth without what the sampling folds, by a zero-phase low-pass at 0.35 of the rate before it.
    pub(crate) road_unfolded: Vec<f64>,
}

/// Longest wavelength in the road: 500 m.
const LONGEST: f64 = 500.0;
const WARM_UP_S: f64 = 5.0;

pub(crate) fn drive(d: &Drive) -> Log {
    let mut random = Random::new(d.seed);
    let every =
        if d.rate_hz > 1000.0 { (8000.0 / d.rate_hz) as usize } else { (4000.0 / d.rate_hz) as usize };
    let fine = d.rate_hz * every as f64;
    let n = ((2.5 * (d.seconds + WARM_UP_S) * fine) as usize).next_power_of_two();
    let road = road(&mut random, d, n, fine);
    let mut unfolded = road.clone();
    for _ in 0..2 {
        let mut sections = Biquad::butterworth_4(0.35 * d.rate_hz, fine, false);
        for v in &mut unfolded {
            *v = sections.iter_mut().fold(*v, |v, s| s.step(v));
        }
        unfolded.reverse();
    }
    let steps = ((d.seconds + WARM_UP_S) * fine) as usize;
    let [m_b, m_w, c_s, k_s, k_t] = d.car;
    let accelerations = |x: &[f64; 4], r: f64| {
        let suspension = k_s * (x[2] - x[0]) + c_s * (x[3] - x[1]);
        (suspension / m_b, (k_t * (r - x[2]) - suspension) / m_w)
    };
    let f = |x: &[f64; 4], r: f64| {
        let (a_b, a_w) = accelerations(x, r);
        [x[1], a_b, x[3], a_w]
    };
    let mut low_pass =
        [0, 1].map(|_| Biquad::butterworth_4(d.cutoff_per_rate.max(0.01) * d.rate_hz, fine, false));
    let mut x = [road[0], 0.0, road[0], 0.0];
    let h = 1.0 / fine;
    let mut log = Log {
        rate_hz: d.rate_hz,
        time: vec![],
        body: vec![],
        wheel: vec![],
        road: vec![],
        road_unfolded: vec![],
    };
    for i in 0..steps {
        let (a_b, a_w) = accelerations(&x, road[i]);
        let mut y = [a_b, a_w];
        if d.cutoff_per_rate > 0.0 {
            for (y, sections) in y.iter_mut().zip(&mut low_pass) {
                *y = sections.iter_mut().fold(*y, |y, s| s.step(y));
            }
        }
        let t = i as f64 * h - WARM_UP_S;
        if i % every == 0 && t >= 0.0 {
            log.time.push(t);
            log.body.push(y[0] + d.offsets[0] + d.noise * random.normal());
            log.wheel.push(y[1] + d.offsets[1] + d.noise * random.normal());
            log.road.push(road[i]);
            log.road_unfolded.push(unfolded[i]);
        }
        let middle = 0.5 * (road[i] + road[i + 1]);
        let add = |x: &[f64; 4], k: &[f64; 4], s: f64| std::array::from_fn(|j| x[j] + s * k[j]);
        let k1 = f(&x, road[i]);
        let k2 = f(&add(&x, &k1, 0.5 * h), middle);
        let k3 = f(&add(&x, &k2, 0.5 * h), middle);
        let k4 = f(&add(&x, &k3, h), road[i + 1]);
        x = std::array::from_fn(|j| x[j] + h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
    }
    log
}

/// Height over time on the fine grid, 0 at the start.
fn road(random: &mut Random, d: &Drive, n: usize, fine: f64) -> Vec<f64> {
    let (mut re, mut im) = (vec![0.0; n], vec![0.0; n]);
    let df = fine / n as f64;
    for k in 1..n / 2 {
        let f = k as f64 * df;
        if f < d.speed() / LONGEST || f > 0.4 * fine {
            continue;
        }
        let density = d.roughness * (f / d.speed() / 0.1).powf(-d.waviness) / d.speed();
        // Real and imaginary part normal: Rayleigh amplitude, uniform phase; the variance of the sum is S df.
        let s = (density * df / 4.0).sqrt();
        re[k] = s * random.normal();
        im[k] = s * random.normal();
        re[n - k] = re[k];
        im[n - k] = -im[k];
    }
    fft(&mut re, &mut im, 1.0);
    let start = re[0];
    re.iter().map(|z| z - start).collect()
}
