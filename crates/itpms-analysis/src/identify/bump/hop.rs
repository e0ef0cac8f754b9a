//! The wheel's own oscillation, from the spectrum of its acceleration while nothing shakes it (docs/math/identification.md,
//! section 6). Called by `corner`.
//!
//! `A(s) (s² + 2 ζ ω s + ω²) = b(s)`: the spectrum of a decaying oscillation is a polynomial over its characteristic one. Linear in ω², 2 ζ
//! ω and b; the weights 1/|s² + 2 ζ ω s + ω²| of the round before make the residual that of the spectrum (Sanathanan and Koerner 1963).

use nalgebra::{Complex, DMatrix, DVector, Matrix2, Vector2};

use super::super::estimate::Estimate;
use super::smooth::low_pass;

/// Frequency in Hz by which the polynomials are scaled.
const SCALE_HZ: f64 = 12.0;
const ROUNDS: usize = 20;
/// Band in Hz, order of the polynomial, and time in s left out at the beginning: what one chooses should not matter.
const VARIANTS: [(f64, f64, usize, f64); 3] =
    [(5.0, 22.0, 2, 0.0), (6.0, 18.0, 3, 0.0), (5.0, 22.0, 3, 0.05)];
/// Standard error over frequency from which the hop counts as hardly excited, and the damping ratio that no wheel has.
const FUZZY: f64 = 0.05;
const GROWING: f64 = -0.02;

/// Between which frequencies in Hz a wheel's motion should be one decaying oscillation.
const HOP_HZ: (f64, f64) = (6.0, 18.0);
/// By how much of the frequency, and of one, frequency and damping ratio may be wrong where none of the motion is: what friction
/// or another oscillation drives shows a frequency of its own, in simulated drops up to 9 % off the hop's.
const DRIVEN: f64 = 0.1;

/// Frequency in Hz and damping ratio, each with its variance, and the degrees of freedom behind these.
struct Mode {
    dof: f64,
    hz: f64,
    hz_variance: f64,
    damping: f64,
    damping_variance: f64,
}

/// Frequency in Hz and damping ratio of the wheel's hop; `None` where it hardly shows.
pub(super) fn hop(wheel_acceleration: &[f64], step_s: f64) -> Option<(Estimate, Estimate)> {
    let modes: Vec<Mode> = VARIANTS
        .iter()
        .map(|(low, high, order, later)| {
            let rows = wheel_acceleration.get((later / step_s) as usize..)?;
            mode(rows, step_s, (*low, *high), *order)
        })
        .collect::<Option<_>>()?;
    let n = modes.len() as f64;
    let driven = DRIVEN * (1.0 - explained(wheel_acceleration, step_s, &modes[0]));
    let pooled = |value: fn(&Mode) -> f64, variance: fn(&Mode) -> f64, scale: f64| {
        let first = value(&modes[0]);
        let mean = modes.iter().map(value).sum::<f64>() / n;
        let between = modes.iter().map(|mode| (value(mode) - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let within = modes.iter().map(variance).sum::<f64>() / n;
        Estimate::new(first, within + between + (driven * scale).powi(2), modes[0].dof)
    };
    let hz = pooled(|m| m.hz, |m| m.hz_variance, modes[0].hz);
    let damping = pooled(|m| m.damping, |m| m.damping_variance, 1.0);
    (hz.standard_error < FUZZY * hz.value && damping.value > GROWING).then_some((hz, damping))
}

/// Share of the motion between 6 and 18 Hz that is one decaying oscillation of this frequency and damping.
fn explained(x: &[f64], step_s: f64, mode: &Mode) -> f64 {
    let (below, above) = (low_pass(x, HOP_HZ.0, step_s), low_pass(x, HOP_HZ.1, step_s));
    let w = std::f64::consts::TAU * mode.hz;
    let turn = w * (1.0 - mode.damping * mode.damping).max(0.0).sqrt();
    let (mut matrix, mut right, mut all) = (Matrix2::zeros(), Vector2::zeros(), 0.0);
    for (i, (above, below)) in above.iter().zip(&below).enumerate() {
        let (t, a) = (i as f64 * step_s, above - below);
        let row = Vector2::new((turn * t).cos(), (turn * t).sin()) * (-mode.damping * w * t).exp();
        matrix += row * row.transpose();
        right += row * a;
        all += a * a;
    }
    matrix.try_inverse().map_or(0.0, |inverse| (right.dot(&(inverse * right)) / all).clamp(0.0, 1.0))
}

fn mode(x: &[f64], step_s: f64, (low, high): (f64, f64), order: usize) -> Option<Mode> {
    let length_s = x.len() as f64 * step_s;
    let high = high.min(0.4 / step_s);
    let bins: Vec<f64> = ((low * length_s).ceil() as usize..=(high * length_s) as usize)
        .map(|k| k as f64 / length_s)
        .collect();
    let width = 3 + order;
    if bins.len() < width {
        return None;
    }
    let spectrum: Vec<Complex<f64>> = bins.iter().map(|hz| transform(x, step_s, *hz)).collect();
    let mut weights = vec![1.0; bins.len()];
    let mut solution = None;
    for _ in 0..ROUNDS {
        let (matrix, target) = equations(&bins, &spectrum, &weights, order);
        let theta = matrix.clone().svd(true, true).solve(&target, 1e-12).ok()?;
        weights = bins
            .iter()
            .map(|hz| {
                let s = Complex::new(0.0, hz / SCALE_HZ);
                1.0 / (s * s + s * theta[1] + theta[0]).norm().max(1e-9)
            })
            .collect();
        solution = Some((matrix, target, theta));
    }
    let (matrix, target, theta) = solution?;
    if !(theta[0] > 0.0) {
        return None;
    }
    let covariance = robust_covariance(&matrix, &(&target - &matrix * &theta))?;
    let w = theta[0].sqrt();
    let variance = |gradient: [f64; 2]| {
        (0..2)
            .flat_map(|i| (0..2).map(move |j| (i, j)))
            .map(|(i, j)| gradient[i] * gradient[j] * covariance[(i, j)])
            .sum()
    };
    Some(Mode {
        dof: (2 * bins.len() - width) as f64,
        hz: SCALE_HZ * w,
        hz_variance: variance([SCALE_HZ / (2.0 * w), 0.0]),
        damping: theta[1] / (2.0 * w),
        damping_variance: variance([-theta[1] / (4.0 * w.powi(3)), 1.0 / (2.0 * w)]),
    })
}

fn transform(x: &[f64], step_s: f64, hz: f64) -> Complex<f64> {
    let turn = Complex::from_polar(1.0, -std::f64::consts::TAU * hz * step_s);
    let mut phase = Complex::new(1.0, 0.0);
    let mut sum = Complex::new(0.0, 0.0);
    for value in x {
        sum += phase * *value;
        phase *= turn;
    }
    sum * step_s
}

/// Real and imaginary parts of `-A ω² - A s 2 ζ ω + b(s) = A s²`, a row each.
fn equations(
    bins: &[f64],
    spectrum: &[Complex<f64>],
    weights: &[f64],
    order: usize,
) -> (DMatrix<f64>, DVector<f64>) {
    let n = bins.len();
    let mut matrix = DMatrix::zeros(2 * n, 3 + order);
    let mut target = DVector::zeros(2 * n);
    let largest = weights.iter().fold(f64::MIN_POSITIVE, |most, w| most.max(*w));
    for (k, ((hz, a), weight)) in bins.iter().zip(spectrum).zip(weights).enumerate() {
        let s = Complex::new(0.0, hz / SCALE_HZ);
        let weight = weight / largest;
        let mut put = |column: usize, value: Complex<f64>| {
            matrix[(k, column)] = weight * value.re;
            matrix[(n + k, column)] = weight * value.im;
        };
        put(0, -a);
        put(1, -(a * s));
        let mut power = Complex::new(1.0, 0.0);
        for column in 2..3 + order {
            put(column, power);
            power *= s;
        }
        let right = a * s * s;
        target[k] = weight * right.re;
        target[n + k] = weight * right.im;
    }
    (matrix, target)
}

/// White's covariance: bins are independent, but not equally loud.
fn robust_covariance(matrix: &DMatrix<f64>, residual: &DVector<f64>) -> Option<DMatrix<f64>> {
    let (rows, width) = matrix.shape();
    let inverse = (matrix.transpose() * matrix).try_inverse()?;
    let mut middle = DMatrix::zeros(width, width);
    for (i, e) in residual.iter().enumerate() {
        let row = matrix.row(i);
        middle += row.transpose() * row * (e * e);
    }
    let correction = rows as f64 / (rows as f64 - width as f64).max(1.0);
    Some(&inverse * middle * &inverse * correction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decaying_sine_gives_its_frequency_and_damping() {
        for (hz, damping) in [(9.9, 0.01), (12.0, 0.1), (13.0, 0.3)] {
            let (step, w) = (0.001, std::f64::consts::TAU * hz);
            let decay =
                |t: f64| (-damping * w * t).exp() * (w * (1.0f64 - damping * damping).sqrt() * t + 0.7).cos();
            // Long enough to have died away: what is cut off at the end is no polynomial in s.
            let x: Vec<f64> = (0..8000).map(|i| decay(f64::from(i) * step)).collect();
            let (f, z) = hop(&x, step).unwrap();
            // A sum in place of an integral: some (w step)² / 12 and a bit at the end.
            assert!((f.value / hz - 1.0).abs() < 5e-3, "{hz} {damping}: {f:?}");
            assert!((z.value - damping).abs() < 5e-3, "{hz} {damping}: {z:?}");
        }
    }

    #[test]
    fn a_wheel_that_does_not_hop_gives_nothing() {
        // A body's slow swing and a noise of no color.
        let mut state = 1u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
        };
        let x: Vec<f64> = (0..2000).map(|i| (0.009 * f64::from(i)).sin() + 0.3 * noise()).collect();
        assert!(hop(&x, 0.001).is_none());
    }
}
