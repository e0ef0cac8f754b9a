//! Two lines along one road: the coherence of an isotropic surface.
//!
//! Called by the surfaces. An isotropic surface whose profiles have the spectrum `n^-w` has the spectrum
//! `(n² + m²)^(-(w+1)/2)` in the plane; over a distance `d` across the road, profiles share (`simulation.md`, eq. 9)
//!
//! `γ(n, d) = 2/Γ(ν) (π n d)^ν K_ν(2π n d)`, `ν = w/2`
//!
//! of their amplitude at `n` cycles/m: all of the waves much longer than `d`, none of the much shorter ones.

use std::f64::consts::{PI, TAU};

use super::Side;
use super::iso8608::Iso8608;
use crate::streams::Purpose;

/// Coherence of two profiles of an isotropic surface, 0 to 1: `distance_m` apart, at a spatial frequency, for a
/// spectrum of slope `w`. It is real (the waves are in phase); its square is what an estimate from spectra is of.
pub fn coherence(cycles_per_m: f64, distance_m: f64, slope: f64) -> f64 {
    of_phase(TAU * cycles_per_m * distance_m.abs(), 0.5 * slope)
}

/// `2^(1-ν)/Γ(ν) x^ν K_ν(x)`.
fn of_phase(x: f64, nu: f64) -> f64 {
    if x < 1e-6 {
        return 1.0;
    }
    2f64.powf(1.0 - nu) / libm::tgamma(nu) * x.powf(nu) * bessel_k(nu, x)
}

/// Modified Bessel function of the second kind, `∫ exp(-x cosh t) cosh(ν t) dt` from 0, by the trapezoidal rule: its
/// error falls like exp(-π²/step) for an integrand that ends so steeply.
fn bessel_k(nu: f64, x: f64) -> f64 {
    const STEP: f64 = 0.1;
    let mut sum = 0.5 * (-x).exp();
    for i in 1.. {
        let t = STEP * f64::from(i);
        let decay = x * t.cosh() - nu * t;
        if decay > 745.0 {
            break;
        }
        sum += 0.5 * ((-decay).exp() + (-decay - 2.0 * nu * t).exp());
    }
    STEP * sum
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    side: Side,
    /// From the left wheels' track to the right wheels'; none: the tracks are independent roads.
    track_m: Option<f64>,
    offset_m: f64,
}

impl Line {
    /// Under the wheels of one side, on a road of its own.
    pub fn alone(side: Side) -> Self {
        Self { side, track_m: None, offset_m: 0.0 }
    }

    /// Under the front wheels of one side of a car of this track width, on one isotropic surface.
    pub fn of_track(side: Side, track_m: f64) -> Self {
        Self { side, track_m: Some(track_m), offset_m: 0.0 }
    }

    /// The same, moved sideways; to which side makes no difference.
    pub fn beside(self, offset_m: f64) -> Self {
        Self { offset_m: offset_m.abs(), ..self }
    }

    pub fn side(&self) -> Side {
        self.side
    }

    /// The independent roads that the line is made of; `number` tells stretches apart, `bin_cycles_per_m` is the first
    /// of so many harmonics.
    pub(crate) fn sources(
        &self,
        iso: &Iso8608,
        number: u64,
        bin_cycles_per_m: f64,
        harmonics: usize,
    ) -> Vec<Source> {
        let left = Source { purpose: Purpose::Road, stream: 2 * number, weights: Vec::new() };
        let right = Source { stream: 2 * number + 1, ..left.clone() };
        let own = match self.side {
            Side::Left => left.clone(),
            Side::Right => right.clone(),
        };
        let mut sources = match (self.side, self.track_m) {
            (Side::Left, _) | (_, None) => vec![own.clone()],
            (Side::Right, Some(track_m)) => {
                let [common, rest] = shares(iso.slope, track_m, bin_cycles_per_m, harmonics);
                vec![left.weighted(&common), right.weighted(&rest)]
            }
        };
        if self.offset_m > 0.0 {
            let [common, rest] = shares(iso.slope, self.offset_m, bin_cycles_per_m, harmonics);
            sources = sources.into_iter().map(|source| source.weighted(&common)).collect();
            sources.push(Source { purpose: Purpose::RoadBeside, ..own }.weighted(&rest));
        }
        sources
    }
}

/// One of the independent roads a line is made of.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    pub(crate) purpose: Purpose,
    pub(crate) stream: u64,
    /// By harmonic, from the first on; empty: all of it.
    pub(crate) weights: Vec<f64>,
}

impl Source {
    fn weighted(self, by: &[f64]) -> Self {
        let weights = if self.weights.is_empty() {
            by.to_vec()
        } else {
            self.weights.iter().zip(by).map(|(a, b)| a * b).collect()
        };
        Self { weights, ..self }
    }
}

/// Coherence with a line at a distance and the share that is the line's own, `sqrt(1 - γ²)`, by harmonic; read from a
/// table in steps of 2 % of frequency, good to 1e-4.
fn shares(slope: f64, distance_m: f64, bin_cycles_per_m: f64, harmonics: usize) -> [Vec<f64>; 2] {
    const FROM: f64 = 1e-5;
    const STEP: f64 = 0.02;
    // Where exp(-x) has left nothing.
    const ENTRIES: usize = 780;
    let table: Vec<[f64; 2]> = (0..ENTRIES)
        .map(|i| {
            let common = of_phase(FROM * (STEP * i as f64).exp(), 0.5 * slope).min(1.0);
            [common, (1.0 - common * common).sqrt()]
        })
        .collect();
    let mut shares = [Vec::with_capacity(harmonics), Vec::with_capacity(harmonics)];
    for k in 1..=harmonics {
        let position = (2.0 * PI * bin_cycles_per_m * k as f64 * distance_m / FROM).ln() / STEP;
        let pair = if position < 0.0 {
            [1.0, 0.0]
        } else {
            let f = position.fract();
            match table.get(position as usize..position as usize + 2) {
                Some(&[a, b]) => [0, 1].map(|i| a[i] + f * (b[i] - a[i])),
                _ => [0.0, 1.0],
            }
        };
        shares.iter_mut().zip(pair).for_each(|(share, value)| share.push(value));
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_is_the_published_one() {
        // Abramowitz and Stegun, table 9.8: K_0(1), K_1(1), K_1(0.1), K_1(5); half orders are elementary.
        for (nu, x, k) in [
            (0.0, 1.0, 0.421_024_438_240_708),
            (1.0, 1.0, 0.601_907_230_197_235),
            (1.0, 0.1, 9.853_844_780_870_606),
            (1.0, 5.0, 0.004_044_613_445_452),
            (0.5, 2.0, (PI / 4.0).sqrt() * (-2f64).exp()),
        ] {
            assert!((bessel_k(nu, x) / k - 1.0).abs() < 1e-12, "{nu} {x}: {}", bessel_k(nu, x));
        }
    }

    #[test]
    fn the_coherence_is_the_isotropic_integral() {
        // γ = ∫ S(n, m) cos(2π m d) dm / ∫ S(n, m) dm with S = (n² + m²)^-(w+1)/2, by brute force: m to 400 n leaves
        // 400^-w of the integral out.
        for (w, n, d) in [(2.0, 1.0, 0.1), (2.6, 0.5, 0.4), (1.8, 2.0, 0.02)] {
            let (mut with, mut without) = (0.0, 0.0);
            let dm = n / 500.0;
            for i in 0..200_000 {
                let m = (f64::from(i) + 0.5) * dm;
                let s = (n * n + m * m).powf(-0.5 * (w + 1.0));
                with += s * (TAU * m * d).cos();
                without += s;
            }
            let error = (coherence(n, d, w) - with / without).abs();
            assert!(error < 1e-4, "w {w}, n {n}, d {d}: {error}");
        }
    }

    #[test]
    fn long_waves_are_shared_and_short_ones_are_not() {
        assert_eq!(coherence(0.0, 1.5, 2.0), 1.0);
        assert!(coherence(0.01, 1.5, 2.0) > 0.97 && coherence(2.0, 1.5, 2.0) < 1e-6);
        let [common, rest] = shares(2.0, 0.05, 0.01, 5000);
        for k in [1, 10, 317, 2000, 5000] {
            let exact = coherence(0.01 * k as f64, 0.05, 2.0);
            assert!((common[k - 1] - exact).abs() < 1e-4, "{k}");
            assert!((rest[k - 1] - (1.0 - exact * exact).sqrt()).abs() < 1e-4, "{k}");
        }
    }
}
