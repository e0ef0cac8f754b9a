//! Spectra over exactly one period of the road, in step with it: the harmonics of the wheel's velocity and of the
//! force's, renewed several times per period (docs/math/repeated-road.md, eq. 3).
//!
//! Over a whole period of a periodic signal the harmonics do not leak into one another, so no window is needed.

use nalgebra::{Complex, SVector};

use itpms_core::Real;

pub(crate) const HARMONICS: usize = 24;
/// Parts that a period is summed up in; a pass is renewed with each.
pub(crate) const PARTS: usize = 6;
/// Share by which the period is corrected of the error that would explain a whole slip.
const CLOCK_GAIN: f64 = 0.05;
/// Lowest and highest frequency used in Hz: below, the tire hardly shows, above the noise grows.
const LOWEST_HZ: f64 = 4.5;
const HIGHEST_HZ: f64 = 40.0;
/// Highest frequency used, as a share of the sampling rate.
const BAND: f64 = 0.25;

pub(crate) type Harmonics<T> = SVector<Complex<T>, HARMONICS>;

/// One period, seen by the wheel: `v_r = wheel + θ force` at every harmonic. Scaled so that white noise of one-sided
/// density `N` has the mean power `N / T`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Pass<T: Real> {
    pub(crate) wheel: Harmonics<T>,
    pub(crate) force: Harmonics<T>,
    /// The same force, every part of it times its age in s.
    pub(crate) aged: Harmonics<T>,
}

impl<T: Real> Pass<T> {
    fn zero() -> Self {
        let zero = Complex::new(T::zero(), T::zero());
        Self { wheel: Harmonics::repeat(zero), force: Harmonics::repeat(zero), aged: Harmonics::repeat(zero) }
    }
}

/// Sums up the period under way, part by part.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PassClock<T: Real> {
    dt: T,
    period_s: T,
    /// Lowest harmonic in use, and how many.
    first: u32,
    used: usize,
    /// Where in the period the next step lies, 0 to 1.
    phase: T,
    /// The last parts, the one under way at `part`, and how many are complete.
    parts: [Pass<T>; PARTS],
    part: usize,
    complete: usize,
}

impl<T: Real> PassClock<T> {
    /// A clock for samples taken at `sample_rate_hz` that come on a grid, and a road of that period.
    pub(crate) fn new(sample_rate_hz: f64, grid_period_s: T, period_s: T) -> Self {
        let period = period_s.to_f64();
        let lowest = (LOWEST_HZ * period) as u32 + 1;
        let highest = (HIGHEST_HZ.min(BAND * sample_rate_hz) * period) as u32;
        Self {
            dt: grid_period_s,
            period_s,
            first: lowest,
            used: ((highest + 1).saturating_sub(lowest) as usize).min(HARMONICS),
            phase: T::zero(),
            parts: [Pass::zero(); PARTS],
            part: 0,
            complete: 0,
        }
    }

    /// Share of a period after which a pass is renewed.
    pub(crate) fn share() -> T {
        T::lit(1.0 / PARTS as f64)
    }

    pub(crate) fn period_s(&self) -> T {
        self.period_s
    }

    pub(crate) fn used(&self) -> usize {
        self.used
    }

    /// The road came round later than its clock gave, by `slip_s` in a part of a period: a period that is longer by
    /// [`PARTS`] times that would explain it, and is corrected by [`CLOCK_GAIN`] of that.
    pub(crate) fn follow_slip(&mut self, slip_s: T) {
        let gain = T::lit(CLOCK_GAIN * PARTS as f64);
        let limit = T::lit(0.05) * self.period_s;
        self.period_s += (gain * slip_s).clamp(-limit, limit);
    }

    /// Goes on after an interruption: the period under way is lost, the place in it is not.
    pub(crate) fn skip(&mut self, seconds: T) {
        let phase = self.phase + seconds / self.period_s;
        let within = phase - phase.floor();
        self.phase = within;
        self.complete = 0;
        self.part = ((within * T::lit(PARTS as f64)).to_f64() as usize).min(PARTS - 1);
        self.parts.fill(Pass::zero());
    }

    pub(crate) fn frequency_hz(&self, harmonic: usize) -> T {
        T::lit(f64::from(self.first) + harmonic as f64) / self.period_s
    }

    /// Adds one grid step of both velocities; gives the last period when a part is complete.
    pub(crate) fn push(&mut self, wheel: T, force: T) -> Option<Pass<T>> {
        let step = self.dt / self.period_s;
        let edge = T::lit((self.part + 1) as f64 / PARTS as f64);
        let middle = self.phase + T::lit(0.5) * step;
        let ends = self.phase + step;
        // A step across the edge belongs to both parts.
        let inside = ((edge - self.phase) / step).min(T::one());
        self.add(middle, wheel * inside, force * inside);
        if !(ends >= edge) {
            self.phase = ends;
            return None;
        }
        self.complete = (self.complete + 1).min(PARTS);
        let pass = (self.complete == PARTS).then(|| self.sum());
        self.part = (self.part + 1) % PARTS;
        self.parts[self.part] = Pass::zero();
        self.phase = if self.part == 0 { ends - T::one() } else { ends };
        let outside = T::one() - inside;
        self.add(middle, wheel * outside, force * outside);
        pass
    }

    fn add(&mut self, phase: T, wheel: T, force: T) {
        let angle = -T::two_pi() * phase;
        let turn = Complex::new(angle.cos(), angle.sin());
        let start = angle * T::lit(f64::from(self.first));
        let mut at = Complex::new(start.cos(), start.sin());
        let part = &mut self.parts[self.part];
        for harmonic in 0..self.used {
            part.wheel[harmonic] += at * wheel;
            part.force[harmonic] += at * force;
            at *= turn;
        }
    }

    fn sum(&self) -> Pass<T> {
        // c = √2 / T ∫ u e^{-jωt} dt
        let scale = T::lit(core::f64::consts::SQRT_2) * self.dt / self.period_s;
        let mut pass = Pass::zero();
        for back in 0..PARTS {
            let part = &self.parts[(self.part + PARTS - back) % PARTS];
            let age = T::lit((back as f64 + 0.5) / PARTS as f64) * self.period_s;
            pass.wheel += part.wheel;
            pass.force += part.force;
            pass.aged += part.force * Complex::new(age, T::zero());
        }
        for sum in [&mut pass.wheel, &mut pass.force, &mut pass.aged] {
            *sum *= Complex::new(scale, T::zero());
        }
        pass
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_come_out_with_amplitude_and_phase() {
        // 0.6631 s is no whole number of steps.
        let (dt, period) = (0.002, 0.6631);
        let mut clock = PassClock::<f64>::new(500.0, dt, period);
        let tone = |harmonic: f64, phase: f64, t: f64| {
            (core::f64::consts::TAU * harmonic * t / period + phase).cos()
        };
        let mut last = None;
        for i in 0..2000 {
            // The middle of a step.
            let t = (f64::from(i) + 0.5) * dt;
            let wheel = 0.3 * tone(7.0, 0.4, t) + 0.2 * tone(12.0, -1.0, t) + 0.5 * tone(1.0, 0.0, t);
            last = clock.push(wheel, 2.0 * tone(8.0, 0.9, t)).or(last);
        }
        let pass = last.unwrap();
        let at = |harmonic: u32| (harmonic - clock.first) as usize;
        // √2 times half the amplitude; sums instead of integrals cost (π k dt / T)² / 6 at harmonic k, 0.2 % at 12.
        let expect = |z: Complex<f64>, amplitude: f64, phase: f64| {
            let size = amplitude / core::f64::consts::SQRT_2;
            let wanted = Complex::new(size * phase.cos(), size * phase.sin());
            assert!((z - wanted).norm_sqr().sqrt() < 0.003 * amplitude.max(0.5), "{z} for {wanted}");
        };
        expect(pass.wheel[at(7)], 0.3, 0.4);
        expect(pass.wheel[at(12)], 0.2, -1.0);
        expect(pass.wheel[at(9)], 0.0, 0.0);
        expect(pass.force[at(8)], 2.0, 0.9);
    }
}
