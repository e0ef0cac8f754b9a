//! Forces once per turn of a wheel: the amplitude, how much of it grows with the square of the speed, and whether it rises in a drive
//! (docs/math/rotation.md).
//!
//! Called by [`crate::beside`] with the rows of a drive. An imbalance and a tire that is not round push a wheel with `F = K + M omega^2` once per turn;
//! what a wheel feels is `m_u a_w + (k_t + i w c_t) z_w + k_s (z_w - z_b) + c (v_w - v_b)`, where a damper's friction counts by what it is
//! to a small motion in a large one. Accelerations are taken down to the wheel's own turning in quarters of a second, windows of eight seconds
//! are added up, and what stands beside the line is noise. For the force no phase is kept from window to window: a radius that changes with the speed, and a
//! speed that is late, do not matter. Only the part that grows with the speed's square takes phases, and a wheel's own speed.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::suspension::Measured;

/// A quarter of a second is summed up; so many are a window.
const PART_S: f64 = 0.25;
const PARTS: usize = 32;
/// Slowest turning in rad/s that is looked at: 40 km/h.
const SLOWEST_RAD_S: f64 = 36.0;
/// Turning rates tried, as shares of that expected, up to so many steps either way; from where on they stand beside a line.
const STEP: f64 = 0.0025;
const STEPS: i32 = 16;
const BESIDE: i32 = 6;
/// Windows that make a line known, and standard deviations of their mean by which it stands out of the rest.
const FEWEST: usize = 8;
const FOUND_SDS: f64 = 4.5;
/// What parameters leave open of a force, and of an imbalance in g.
const FORCE_SD: f64 = 0.1;
const IMBALANCE_SD_G: f64 = 8.0;
/// An imbalance is parted from run-out where the speed's square has doubled, and is reported where the noise leaves so many g open.
const SWEEP: f64 = 2.0;
const KNOWN_G: f64 = 20.0;
/// Radius in m at which a weight sits.
const RIM_M: f64 = 0.2;
/// Windows whose phases are kept together: ten minutes; steps in rad over them, and how far a turning rate is looked for beside the line's.
const MOST_WINDOWS: usize = 75;
const FINE_RAD: f64 = 0.7;
const CELL: f64 = 0.004;
/// How late, and how early as a share of that, a speed may be, in s, and steps of it.
const LATE_S: f64 = 0.25;
const EARLY: f64 = 0.2;
const LATE_STEPS: i32 = 50;
/// Share of the line's power that has to be explained for phases to be believed, beside what a search finds in noise alone.
const COHERENT: f64 = 0.6;
const SEARCHED: f64 = 8.0;
/// Windows of a minute; a rise in N, and in standard deviations, in two minutes; speeds within this share are alike.
const MINUTE: usize = 7;
const RISE_N: f64 = 40.0;
const RISE_SDS: f64 = 4.0;
const ALIKE: f64 = 0.15;
/// Parts that are kept, whole minutes in either half: two hours. Of more the older half is forgotten.
const MOST_PARTS: usize = 128 * MINUTE * PARTS;
/// Corner in rad/s of the high pass that a strut's rate is known behind.
const RATE_RAD_S: f64 = TAU;

/// A wheel as it answers a force.
#[derive(Debug, Clone, Copy)]
pub struct TurningWheel {
    pub unsprung_mass_kg: f64,
    /// Tire in N/m, and its damping in N s/m.
    pub tire_n_per_m: f64,
    /// See above.
    pub tire_damping_n_s_per_m: f64,
    pub spring_n_per_m: f64,
    pub damping_n_s_per_m: f64,
    /// Friction of the strut in N.
    pub friction_n: f64,
}

itpms_core::labelled! {
    /// State of a wheel's force once per turn.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum RotationState {
        /// Too little was driven above 40 km/h.
        #[default]
        Slow = "slow",
        /// No force stands out of the road.
        NoLine = "no-line",
        Found = "found",
        /// It has risen in this drive.
        Rising = "rising",
    }
}

/// The force once per turn on a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OncePerTurn {
    pub state: RotationState,
    /// Its amplitude in N, root mean square over the drive's windows.
    pub force_n: Option<Measured>,
    /// Turning rate in rad/s that it holds for.
    pub at_rad_per_s: f64,
    /// Imbalance in g at 0.2 m, where the speed was swept.
    pub imbalance_g: Option<Measured>,
    /// By how much it has risen in N, and since when in s.
    pub rise: Option<(Measured, f64)>,
}

/// Sums over a quarter of a second.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    time_s: f64,
    turned_rad: f64,
    stretch: f64,
    rad_per_s: f64,
    /// Wheel and body, taken down: real and imaginary.
    accel: [[f64; 2]; 2],
    /// Mean square of the strut's rate.
    rate2: f64,
    count: f64,
}

#[derive(Debug, Clone, Default)]
pub struct RotationWatch {
    parts: Vec<Part>,
    now: Part,
    turned_rad: f64,
    /// Stretches within which it is known.
    stretch: f64,
    last_s: Option<f64>,
    begun_s: f64,
    rate_m_s: f64,
    /// Parts up to which a rise was looked for, and what was found.
    looked: usize,
    rise: Option<(Measured, f64)>,
}

#[derive(Debug, Clone, Copy)]
struct Window {
    time_s: f64,
    rad_per_s2: f64,
    /// Square of the amplitude, without the noise, and the noise.
    power: f64,
    noise: f64,
    /// The force, taken down to how far the wheel had turned in the window's middle, and in which stretch.
    force: Complex<f64>,
    turned_rad: f64,
    stretch: f64,
}

impl RotationWatch {
    /// Takes a row: accelerations of wheel and body in m/s², turning rate in rad/s by the wheel's own speed.
    pub fn push(&mut self, time_s: f64, [wheel, body]: [f64; 2], rad_per_s: f64) {
        let step_s = self.last_s.replace(time_s).map_or(f64::NAN, |last_s| time_s - last_s);
        if !(rad_per_s >= 0.0 && step_s > 0.0 && step_s < PART_S) {
            // How far it has turned since is not known.
            self.stretch += 1.0;
            self.now = Part::default();
            return;
        }
        self.turned_rad += rad_per_s * step_s;
        let usable = wheel.is_finite() && body.is_finite() && rad_per_s > SLOWEST_RAD_S;
        if !usable {
            self.now = Part::default();
            return;
        }
        if self.now.count == 0.0 {
            self.begun_s = time_s;
        }
        self.rate_m_s = (self.rate_m_s + step_s * (wheel - body)) * (1.0 - RATE_RAD_S * step_s).max(0.0);
        let (sin, cos) = self.turned_rad.rem_euclid(TAU).sin_cos();
        for (sum, accel) in self.now.accel.iter_mut().zip([wheel, body]) {
            sum[0] += accel * cos;
            sum[1] -= accel * sin;
        }
        self.now.turned_rad += self.turned_rad;
        self.now.rad_per_s += rad_per_s;
        self.now.rate2 += self.rate_m_s * self.rate_m_s;
        self.now.count += 1.0;
        if time_s - self.begun_s >= PART_S {
            if self.parts.len() >= MOST_PARTS {
                self.parts.drain(..MOST_PARTS / 2);
                self.looked = self.looked.saturating_sub(MOST_PARTS / 2);
            }
            let part = std::mem::take(&mut self.now);
            let n = part.count;
            self.parts.push(Part {
                time_s,
                turned_rad: part.turned_rad / n,
                stretch: self.stretch,
                rad_per_s: part.rad_per_s / n,
                accel: part.accel.map(|sum| sum.map(|value| 2.0 * value / n)),
                rate2: part.rate2 / n,
                count: n,
            });
        }
    }

    /// Looks whether the force has risen, once a minute; what is newly found.
    pub fn rises(&mut self, wheel: &TurningWheel) -> Option<(Measured, f64)> {
        if self.rise.is_some() || self.parts.len() < self.looked + MINUTE * PARTS {
            return None;
        }
        self.looked = self.parts.len();
        let windows = self.windows(wheel, self.line(wheel)?.0);
        let minutes: Vec<(f64, f64, f64)> = windows.chunks_exact(MINUTE).map(minute).collect();
        let (last, earlier) =
            minutes.split_at_checked(minutes.len().checked_sub(2)?).map(|(before, last)| (last, before))?;
        let alike = |minute: &&(f64, f64, f64)| last.iter().all(|one| (minute.0 / one.0).ln().abs() < ALIKE);
        let before: Vec<_> = earlier.iter().filter(alike).collect();
        let count = before.len() as f64;
        let base = before.iter().map(|minute| minute.1).sum::<f64>() / count;
        let base_sd = (before.iter().map(|minute| minute.2 * minute.2).sum::<f64>()).sqrt() / count;
        let risen = |minute: &(f64, f64, f64)| {
            minute.1 - base > RISE_N && minute.1 - base > RISE_SDS * minute.2.hypot(base_sd)
        };
        if !last.iter().all(risen) {
            return None;
        }
        let newest = last.last()?;
        let measured = Measured {
            value: newest.1 - base,
            sd: newest.2.hypot(base_sd).hypot(FORCE_SD * (newest.1 - base)),
        };
        self.rise = Some((measured, windows.last()?.time_s));
        self.rise
    }

    /// What the drive has shown.
    pub fn conclude(&self, wheel: &TurningWheel) -> OncePerTurn {
        if self.parts.len() < FEWEST * PARTS {
            return OncePerTurn::default();
        }
        let Some((at, found)) = self.line(wheel) else { return OncePerTurn::default() };
        let windows = self.windows(wheel, at);
        let count = windows.len() as f64;
        let mean = |of: &dyn Fn(&Window) -> f64| windows.iter().map(of).sum::<f64>() / count;
        let power = mean(&|one| one.power);
        // Of a force that grows with the square.
        let at_rad_per_s = mean(&|one| one.rad_per_s2 * one.rad_per_s2).sqrt().sqrt();
        if !found || !(power > 0.0) {
            return OncePerTurn { state: RotationState::NoLine, at_rad_per_s, ..OncePerTurn::default() };
        }
        let force = power.sqrt();
        let noise = (mean(&|one| one.noise * one.noise + 2.0 * one.power.max(0.0) * one.noise) / count)
            .sqrt()
            / (2.0 * force);
        let force_n = Some(Measured { value: force, sd: noise.hypot(FORCE_SD * force) });
        let state = if self.rise.is_some() { RotationState::Rising } else { RotationState::Found };
        OncePerTurn {
            state,
            force_n,
            at_rad_per_s,
            imbalance_g: imbalance_g(&windows, f64::from(at) * STEP),
            rise: self.rise,
        }
    }

    /// The forces in a window at `N` turning rates, the first of them `from` steps off, each `every` steps from the one before.
    fn forces_at<const N: usize>(
        (parts, forces): &(&[Part], Vec<Complex<f64>>),
        from: i32,
        every: i32,
    ) -> [Complex<f64>; N] {
        let (middle, count) = (parts[parts.len() / 2].turned_rad, parts.len() as f64);
        let mut sums = [Complex::new(0.0, 0.0); N];
        for (part, force) in parts.iter().zip(forces) {
            let turn =
                |steps: i32| Complex::from_polar(1.0, -f64::from(steps) * STEP * (part.turned_rad - middle));
            let (mut turned, further) = (force * turn(from), turn(every));
            for sum in &mut sums {
                *sum += turned;
                turned *= further;
            }
        }
        sums.map(|sum| sum / count)
    }

    /// Windows of one stretch of driving, with the forces of their parts.
    fn stretches(&self, wheel: &TurningWheel) -> Vec<(&[Part], Vec<Complex<f64>>)> {
        let whole = |parts: &&[Part]| parts[PARTS - 1].time_s - parts[0].time_s < 1.2 * PARTS as f64 * PART_S;
        let windows = self.parts.chunks_exact(PARTS).filter(whole);
        windows.map(|parts| (parts, parts.iter().map(|part| force(wheel, part)).collect())).collect()
    }

    /// Steps by which the wheel turns otherwise than expected, and whether it is a line.
    fn line(&self, wheel: &TurningWheel) -> Option<(i32, bool)> {
        let windows = self.stretches(wheel);
        if windows.len() < FEWEST {
            return None;
        }
        let mut sums = [0.0; 2 * STEPS as usize + 1];
        for window in &windows {
            let forces: [_; 2 * STEPS as usize + 1] = Self::forces_at(window, -STEPS, 1);
            sums.iter_mut().zip(forces).for_each(|(sum, force)| *sum += force.norm_sqr());
        }
        let best = (0..sums.len()).max_by(|a, b| sums[*a].total_cmp(&sums[*b]))?;
        let mut rest: Vec<f64> =
            (0..sums.len()).filter(|at| at.abs_diff(best) >= BESIDE as usize).map(|at| sums[at]).collect();
        rest.sort_by(f64::total_cmp);
        let median = rest.get(rest.len() / 2)?;
        let found = sums[best] > median * (1.0 + FOUND_SDS / (windows.len() as f64).sqrt());
        Some((best as i32 - STEPS, found))
    }

    fn windows(&self, wheel: &TurningWheel, at: i32) -> Vec<Window> {
        const FAR: i32 = BESIDE + 8;
        let of = |window: &(&[Part], Vec<Complex<f64>>)| {
            let parts = window.0;
            let forces: [_; FAR as usize + 1] = Self::forces_at(window, at - FAR, 2);
            let middle = FAR as usize / 2;
            let beside = forces.iter().enumerate();
            let beside = beside.filter(|(place, _)| 2 * place.abs_diff(middle) >= BESIDE as usize);
            let noises: Vec<f64> = beside.map(|(_, force)| force.norm_sqr()).collect();
            let noise = noises.iter().sum::<f64>() / noises.len() as f64;
            let rad_per_s2 =
                parts.iter().map(|part| part.rad_per_s.powi(2)).sum::<f64>() / parts.len() as f64;
            let force = forces[middle];
            let Part { turned_rad, stretch, .. } = parts[PARTS / 2];
            Window {
                time_s: parts[PARTS - 1].time_s,
                rad_per_s2,
                power: force.norm_sqr() - noise,
                noise,
                force,
                turned_rad,
                stretch,
            }
        };
        self.stretches(wheel).iter().map(of).collect()
    }
}

/// A wheel's force once per turn, from its accelerations.
fn force(wheel: &TurningWheel, part: &Part) -> Complex<f64> {
    let w = part.rad_per_s;
    let [a, b] = part.accel.map(|[re, im]| Complex::new(re, im));
    // Of a normally distributed rate; a mean square of nothing is no motion, and no friction.
    let slips = wheel.friction_n * (2.0 / std::f64::consts::PI).sqrt() / part.rate2.sqrt().max(1e-3);
    // z = -a / w^2, v = -i a / w.
    let of = |n_per_m: f64, n_s_per_m: f64| Complex::new(n_per_m / (w * w), n_s_per_m / w);
    let tire = of(wheel.tire_n_per_m, wheel.tire_damping_n_s_per_m);
    let strut = of(wheel.spring_n_per_m, wheel.damping_n_s_per_m + slips);
    (wheel.unsprung_mass_kg - tire) * a - strut * (a - b)
}

/// Turning rate, amplitude and its standard deviation of some windows.
fn minute(windows: &[Window]) -> (f64, f64, f64) {
    let count = windows.len() as f64;
    let mean = |of: &dyn Fn(&Window) -> f64| windows.iter().map(of).sum::<f64>() / count;
    let (power, turning2, noise) =
        (mean(&|one| one.power), mean(&|one| one.rad_per_s2), mean(&|one| one.noise));
    let force = power.max(0.0).sqrt();
    let sd =
        ((noise * noise + 2.0 * power.max(0.0) * noise) / count).sqrt() / (2.0 * force.max(noise.sqrt()));
    (turning2.sqrt(), force, sd)
}

/// The part of the force that grows with the square of the turning rate, `F = K + M w^2` of complex forces, where the phases of windows can be
/// kept: the turning rate, `off` from that expected, and how late the speed is are those by which most is explained.
fn imbalance_g(windows: &[Window], off: f64) -> Option<Measured> {
    let ratio = |chunk: &[Window]| {
        let mut turnings: Vec<f64> = chunk.iter().map(|one| one.rad_per_s2).collect();
        turnings.sort_by(f64::total_cmp);
        let quantile = |share: f64| turnings[(share * (turnings.len() - 1) as f64) as usize];
        quantile(0.9) / quantile(0.1)
    };
    let together =
        windows.chunk_by(|a, b| a.stretch == b.stretch).flat_map(|stretch| stretch.chunks(MOST_WINDOWS));
    let chunk = together
        .filter(|chunk| chunk.len() >= FEWEST && ratio(chunk) > SWEEP)
        .max_by(|a, b| a.len().cmp(&b.len()))?;
    let count = chunk.len() as f64;
    let mean2 = chunk.iter().map(|one| one.rad_per_s2).sum::<f64>() / count;
    let spread = chunk.iter().map(|one| (one.rad_per_s2 - mean2).powi(2)).sum::<f64>();
    let noise = chunk.iter().map(|one| one.noise).sum::<f64>() / count;
    let turned_rad = chunk[chunk.len() - 1].turned_rad - chunk[0].turned_rad;
    let fine = FINE_RAD / turned_rad;
    let cells = (CELL / fine).ceil() as i32;
    let mut best = (0.0, Complex::new(0.0, 0.0));
    for late in 0..=LATE_STEPS {
        let late_s = LATE_S * (f64::from(late) / f64::from(LATE_STEPS) - EARLY);
        let begun: Vec<Complex<f64>> = chunk
            .iter()
            .map(|one| one.force * Complex::from_polar(1.0, -late_s * one.rad_per_s2.sqrt()))
            .collect();
        for cell in -cells..=cells {
            let rate = off + f64::from(cell) * fine;
            let (mut sum, mut slope) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
            for (one, begun) in chunk.iter().zip(&begun) {
                let force = begun * Complex::from_polar(1.0, -rate * (one.turned_rad - chunk[0].turned_rad));
                sum += force;
                slope += force * (one.rad_per_s2 - mean2);
            }
            let explained = sum.norm_sqr() / count + slope.norm_sqr() / spread;
            if explained > best.0 {
                best = (explained, slope / spread);
            }
        }
    }
    let all = chunk.iter().map(|one| one.power + one.noise).sum::<f64>();
    if !(best.0 > COHERENT * (all - noise * count) + SEARCHED * noise) {
        return None;
    }
    // kg m to g at the rim.
    let per = 1e3 / RIM_M;
    let (grams, noise_g) = (best.1.norm() * per, (0.5 * noise / spread).sqrt() * per);
    (noise_g < KNOWN_G)
        .then_some(Measured { value: grams, sd: noise_g.hypot(IMBALANCE_SD_G).hypot(FORCE_SD * grams) })
}

#[cfg(test)]
mod tests;
