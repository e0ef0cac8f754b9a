//! Another plant than that of `itpms-sim`: a rigid body on four struts with digressive dampers that are harder in rebound, dry friction with its own
//! presliding, springs that stiffen, anti-roll bars, bump stops; wheels with imbalance; sensors with gains, offsets, noise and lateness. Roads, loads and
//! temperatures are drawn for each day.

use rand::RngExt as _;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

pub const G: f64 = 9.80665;
pub fn normal(r: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(r)
}
pub fn uniform(r: &mut Pcg64Mcg, a: f64, b: f64) -> f64 {
    a + (b - a) * r.random::<f64>()
}

#[derive(Clone, Debug)]
pub struct Car {
    pub ms: [f64; 4],
    pub mu: [f64; 4],
    pub wb: f64,
    pub track: f64,
    pub pitch: f64,
    pub roll: f64,
    pub ks: [f64; 4],
    pub bar: [f64; 2],
    pub cs: [f64; 4],
    /// rebound over compression; 1/(1+d|v|)
    pub rebound: [f64; 4],
    pub digression: [f64; 4],
    pub knee_v: f64,
    pub friction: [f64; 4],
    pub presliding: f64,
    pub prog: f64,
    pub kt: [f64; 4],
    pub gains: [[f64; 2]; 4],
    pub late: [usize; 4],
    pub imbalance: [f64; 4],
    pub other: bool,
    pub noise: f64,
}

pub fn car(r: &mut Pcg64Mcg, other: bool) -> Car {
    let m = uniform(r, 900.0, 1900.0);
    let f = uniform(r, 0.5, 0.62);
    let ms = [0.5 * m * f, 0.5 * m * f, 0.5 * m * (1.0 - f), 0.5 * m * (1.0 - f)];
    let (hf, hr) = (uniform(r, 1.1, 1.5), uniform(r, 1.2, 1.7));
    let (zf, zr) = (uniform(r, 0.22, 0.4), uniform(r, 0.22, 0.4));
    let mut ks = [0.0; 4];
    let mut cs = [0.0; 4];
    let mu0 = [uniform(r, 32.0, 50.0), uniform(r, 32.0, 50.0)];
    let (mut mu, mut kt) = ([0.0; 4], [0.0; 4]);
    let reb = [uniform(r, 1.0, 2.0), uniform(r, 1.0, 2.0)];
    let dig = [uniform(r, 0.0, 2.0), uniform(r, 0.0, 2.0)];
    let fr = [uniform(r, 15.0, 80.0), uniform(r, 15.0, 80.0)];
    let kt0 = uniform(r, 190e3, 280e3);
    let (mut rebound, mut digression, mut friction) = ([0.0; 4], [0.0; 4], [0.0; 4]);
    for i in 0..4 {
        let h = if i < 2 { hf } else { hr };
        let z = if i < 2 { zf } else { zr };
        ks[i] = ms[i] * (std::f64::consts::TAU * h).powi(2) * (1.0 + 0.02 * normal(r));
        cs[i] = 2.0 * z * (ms[i] * ks[i]).sqrt() * (1.0 + 0.03 * normal(r));
        mu[i] = mu0[i / 2] * (1.0 + 0.01 * normal(r));
        kt[i] = kt0 * (1.0 + 0.03 * normal(r));
        rebound[i] = if other { 2.0 } else { reb[i / 2] };
        digression[i] = dig[i / 2];
        friction[i] = fr[i / 2] * uniform(r, 0.8, 1.2);
    }
    Car {
        ms,
        mu,
        wb: uniform(r, 2.45, 2.95),
        track: 1.5,
        pitch: uniform(r, 0.85, 1.05),
        roll: uniform(r, 0.55, 0.75),
        ks,
        bar: [uniform(r, 0.1, 0.6), uniform(r, 0.0, 0.4)],
        cs,
        rebound,
        digression,
        knee_v: if other { 0.25 } else { f64::INFINITY },
        friction,
        presliding: uniform(r, 1e-4, 1e-3),
        prog: uniform(r, 0.0, 4.0),
        kt,
        gains: std::array::from_fn(|_| [1.0 + 0.01 * normal(r), 1.0 + 0.01 * normal(r)]),
        late: std::array::from_fn(
            |_| {
                if uniform(r, 0.0, 1.0) < 0.5 { 0 } else { uniform(r, 0.0, 3.0) as usize }
            },
        ),
        imbalance: std::array::from_fn(|_| uniform(r, 0.0, 0.012)),
        other,
        noise: uniform(r, 0.025, 0.075),
    }
}

#[derive(Clone, Debug)]
pub struct Day {
    pub load: [f64; 2],
    pub temperature: f64,
    pub gd: f64,
    pub speed: f64,
    pub holes: bool,
    pub seconds: f64,
    pub damper: [f64; 4],
}

pub fn day(r: &mut Pcg64Mcg, seconds: f64, empty: bool) -> Day {
    Day {
        load: if empty { [0.0; 2] } else { [uniform(r, 0.0, 0.12), uniform(r, 0.0, 0.4)] },
        temperature: uniform(r, -10.0, 30.0),
        gd: 6e-6 * (uniform(r, 0.0, 1.0) * 10f64.ln()).exp(),
        speed: uniform(r, 45.0, 110.0) / 3.6,
        holes: uniform(r, 0.0, 1.0) < 0.33,
        seconds,
        damper: [1.0; 4],
    }
}

struct Road {
    z: [Vec<f64>; 2],
}

const DX: f64 = 0.01;

fn road(r: &mut Pcg64Mcg, gd: f64, length: f64, holes: bool) -> Road {
    let n = (length / DX) as usize + 10;
    let amp = (std::f64::consts::TAU * 0.1).powi(1) * (gd / (2.0 * DX)).sqrt() * DX;
    let leak = std::f64::consts::TAU / 100.0 * DX;
    let cross = std::f64::consts::TAU / uniform(r, 1.5, 5.0) * DX;
    let mut raw: [Vec<f64>; 3] = std::array::from_fn(|_| {
        let mut z = 0.0;
        (0..n)
            .map(|_| {
                z += -leak * z + amp * normal(r);
                z
            })
            .collect()
    });
    let mut out = [vec![0.0; n], vec![0.0; n]];
    let (mut low, mut h) = (0.0, [0.0; 2]);
    for i in 0..n {
        low += cross * (raw[0][i] - low);
        for s in 0..2 {
            h[s] += cross * (raw[1 + s][i] - h[s]);
            out[s][i] = low + raw[1 + s][i] - h[s];
        }
    }
    raw[0].clear();
    if holes {
        let count = (length / 150.0) as usize;
        for _ in 0..count {
            let (at, deep, long) =
                (uniform(r, 30.0, length - 30.0), uniform(r, -0.035, 0.02), uniform(r, 0.3, 0.9));
            let side = usize::from(uniform(r, 0.0, 1.0) < 0.5);
            let (a, m) = ((at / DX) as usize, (long / DX) as usize);
            for i in 0..m {
                out[side][a + i] += deep * 0.5 * (1.0 - (std::f64::consts::TAU * i as f64 / m as f64).cos());
            }
        }
    }
    // contact
    let w = 10;
    for s in &mut out {
        let mut acc = 0.0;
        let copy = s.clone();
        for i in 0..n {
            acc += copy[i];
            if i >= w {
                acc -= copy[i - w];
            }
            s[i] = acc / w as f64;
        }
    }
    Road { z: out }
}

/// rows at 200 Hz: time, speed, [wheel, body] of each corner.
pub fn drive(car: &Car, day: &Day, r: &mut Pcg64Mcg, mut row: impl FnMut(f64, f64, &[[f64; 2]; 4])) {
    const SUB: usize = 10;
    let dt = 1.0 / 2000.0;
    let road = road(r, day.gd, day.speed * 1.15 * day.seconds + 60.0, day.holes);
    let warm = (1.0 + 0.0035 * (20.0 - day.temperature)).max(0.3);
    // loads: front and rear axle's sprung mass
    let mf = (car.ms[0] + car.ms[1]) * (1.0 + day.load[0]);
    let mr = (car.ms[2] + car.ms[3]) * (1.0 + day.load[1]);
    let m = mf + mr;
    let a = car.wb * mr / m; // front axle ahead of CG
    let (m0, mr0) = (car.ms.iter().sum::<f64>(), car.ms[2] + car.ms[3]);
    let a0 = car.wb * mr0 / m0;
    let jp = car.pitch * m0 * a0 * (car.wb - a0) + (m - m0) * 0.5 * (car.wb - a).powi(2).max(0.1);
    let jr = car.roll * m0 * (0.5 * car.track).powi(2) + (m - m0) * 0.15;
    let x = [a, a, a - car.wb, a - car.wb];
    let h = 0.5 * car.track;
    let y = [h, -h, h, -h];
    let sag: [f64; 4] = std::array::from_fn(|i| {
        let add = if i < 2 { 0.5 * (mf - car.ms[0] - car.ms[1]) } else { 0.5 * (mr - mr0) };
        // ln k = prog * x with k0 x ~ load: solve (k0/p)(exp(p x) - 1) = load
        let load = add * G;
        if car.prog > 1e-9 { (1.0 + load * car.prog / car.ks[i]).ln() / car.prog } else { load / car.ks[i] }
    });
    let ks: [f64; 4] = std::array::from_fn(|i| car.ks[i] * (car.prog * sag[i]).exp());
    let (mut z, mut th, mut ph, mut vz, mut vth, mut vph) = (0.0f64, 0.0f64, 0.0f64, 0.0f64, 0.0f64, 0.0f64);
    let (mut zw, mut vw) = ([0.0f64; 4], [0.0f64; 4]);
    let mut stick = [0.0f64; 4];
    let mut pos = 10.0f64;
    let n = (day.seconds * 2000.0) as usize;
    let fc = 60.0f64;
    let (k1, k2) = {
        let w = (std::f64::consts::PI * fc * dt).tan();
        (w, w * w)
    };
    let norm = 1.0 / (1.0 + 2f64.sqrt() * k1 + k2);
    let bq = [
        k2 * norm,
        2.0 * k2 * norm,
        k2 * norm,
        2.0 * (k2 - 1.0) * norm,
        (1.0 - 2f64.sqrt() * k1 + k2) * norm,
    ];
    let mut mem = [[[0.0f64; 2]; 2]; 4];
    let mut past = [[0.0f64; 8]; 4];
    let mut psi = [0.0f64; 4];
    let wob = uniform(r, 20.0, 60.0);
    for step in 0..n {
        let t = step as f64 * dt;
        let speed = day.speed * (1.0 + 0.1 * (std::f64::consts::TAU * t / wob).sin());
        pos += speed * dt;
        let cw = warm * (1.0 - 0.05 * (1.0 - (-t / 120.0).exp()));
        let mut f = [0.0; 4];
        let mut ab_in = [0.0; 4];
        let zb: [f64; 4] = std::array::from_fn(|i| z + x[i] * th + y[i] * ph);
        let vb: [f64; 4] = std::array::from_fn(|i| vz + x[i] * vth + y[i] * vph);
        for i in 0..4 {
            let (d, v) = (zw[i] - zb[i], vw[i] - vb[i]);
            // compression positive: wheel up against the body
            let spring =
                if car.prog > 1e-9 { ks[i] / car.prog * ((car.prog * d).exp() - 1.0) } else { ks[i] * d };
            let stop = 60e3 * ((d - 0.06).max(0.0) - (-d - 0.07).max(0.0));
            let other = zw[i ^ 1] - zb[i ^ 1];
            let bar = car.bar[i / 2] * 0.5 * (car.ks[i] + car.ks[i ^ 1]) * (d - other);
            let reb = if v < 0.0 {
                2.0 * car.rebound[i] / (1.0 + car.rebound[i])
            } else {
                2.0 / (1.0 + car.rebound[i])
            };
            let c = car.cs[i] * day.damper[i] * cw * reb;
            let damp = if car.other {
                // to half of the slope beyond a knee
                let k = car.knee_v;
                let s = v.abs();
                v.signum()
                    * c
                    * if s < 0.15 {
                        s
                    } else {
                        0.15 + (s - 0.15) * (1.0 / (1.0 + ((s - 0.15) / (k - 0.15)).min(1.0) * 2.0))
                    }
            } else {
                c * v / (1.0 + car.digression[i] * v.abs())
            };
            let towards = v.signum();
            stick[i] = towards + (stick[i] - towards) * (-v.abs() * dt / car.presliding).exp();
            f[i] = spring + stop + bar + damp + car.friction[i] * stick[i];
        }
        let az = f.iter().sum::<f64>() / m;
        let ath = (0..4).map(|i| f[i] * x[i]).sum::<f64>() / jp;
        let aph = (0..4).map(|i| f[i] * y[i]).sum::<f64>() / jr;
        let mut aw = [0.0; 4];
        for i in 0..4 {
            let at = (pos + 5.0 - if i >= 2 { car.wb } else { 0.0 }) / DX;
            let (k, fr) = (at as usize, at - at.floor());
            let s = &road.z[i % 2];
            let zr = if k + 1 < s.len() { s[k] + fr * (s[k + 1] - s[k]) } else { 0.0 };
            psi[i] += speed / 0.31 * dt;
            let static_load = (car.mu[i] + m / 4.0) * G;
            let tire = (car.kt[i] * (zr - zw[i])).max(-static_load);
            let omega = speed / 0.31;
            aw[i] =
                (tire - 50.0 * vw[i] - f[i] + car.imbalance[i] * omega * omega * psi[i].sin()) / car.mu[i];
            ab_in[i] = az + x[i] * ath + y[i] * aph;
        }
        vz += az * dt;
        vth += ath * dt;
        vph += aph * dt;
        z += vz * dt;
        th += vth * dt;
        ph += vph * dt;
        for i in 0..4 {
            vw[i] += aw[i] * dt;
            zw[i] += vw[i] * dt;
        }
        // sensors
        let mut out = [[0.0; 2]; 4];
        for i in 0..4 {
            let p = &mut past[i];
            p.rotate_right(1);
            p[0] = aw[i];
            let sig = [p[car.late[i]], ab_in[i]];
            for s in 0..2 {
                let w = &mut mem[i][s];
                let yv = bq[0] * sig[s] + w[0];
                w[0] = bq[1] * sig[s] - bq[3] * yv + w[1];
                w[1] = bq[2] * sig[s] - bq[4] * yv;
                out[i][s] = yv;
            }
        }
        if step % SUB == 0 {
            let rows: [[f64; 2]; 4] = std::array::from_fn(|i| {
                std::array::from_fn(|s| out[i][s] * car.gains[i][s] + car.noise * normal(r) + 0.1)
            });
            row(t, speed, &rows);
        }
    }
}
