//! Gaussian low-passes without delay, and the bands between them. Called by `motion`.

/// Half-power frequencies in Hz of the low-passes; the bands lie below the first and between one and the next.
pub(super) const CUTS_HZ: [f64; 4] = [4.0, 8.0, 16.0, 32.0];
pub(super) const BANDS: usize = CUTS_HZ.len();
/// How many standard deviations of the kernel are kept on each side.
const REACH: f64 = 4.5;

/// `x` low-passed; beyond its ends it is taken to go on as at them.
pub(super) fn low_pass(x: &[f64], cut_hz: f64, step_s: f64) -> Vec<f64> {
    // The Gaussian whose response has half its power at `cut_hz`.
    let sd = std::f64::consts::LN_2.sqrt() / (std::f64::consts::TAU * cut_hz * step_s);
    let reach = (REACH * sd).ceil() as usize;
    let weights: Vec<f64> = (0..=reach).map(|i| (-0.5 * (i as f64 / sd).powi(2)).exp()).collect();
    let total = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    let last = x.len().saturating_sub(1);
    (0..x.len())
        .map(|i| {
            let sides: f64 =
                (1..=reach).map(|k| weights[k] * (x[i.saturating_sub(k)] + x[(i + k).min(last)])).sum();
            (weights[0] * x[i] + sides) / total
        })
        .collect()
}

/// `x` by band, lowest first; their sum is `x` below the last cut.
pub(super) fn bands(x: &[f64], step_s: f64) -> [Vec<f64>; BANDS] {
    let mut below = CUTS_HZ.map(|cut| low_pass(x, cut, step_s));
    for i in (1..BANDS).rev() {
        let (lower, upper) = below.split_at_mut(i);
        for (u, l) in upper[0].iter_mut().zip(&lower[i - 1]) {
            *u -= l;
        }
    }
    below
}

pub(super) fn derivative(x: &[f64], step_s: f64) -> Vec<f64> {
    let last = x.len().saturating_sub(1);
    (0..x.len())
        .map(|i| {
            let (from, to) = (i.saturating_sub(1), (i + 1).min(last));
            if to > from { (x[to] - x[from]) / ((to - from) as f64 * step_s) } else { 0.0 }
        })
        .collect()
}

/// Trapezoidal integral from zero.
pub(super) fn integral(x: &[f64], step_s: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let mut before = x.first().copied().unwrap_or(0.0);
    x.iter()
        .map(|value| {
            sum += 0.5 * (before + value) * step_s;
            before = *value;
            sum
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_keeps_its_phase_and_loses_what_a_gaussian_takes() {
        let step = 0.001;
        let x: Vec<f64> =
            (0..4000).map(|i| (std::f64::consts::TAU * 8.0 * f64::from(i) * step).sin()).collect();
        let y = low_pass(&x, 8.0, step);
        for i in 1000..3000 {
            // Half the power at the cut.
            assert!((y[i] - 0.5f64.sqrt() * x[i]).abs() < 1e-4, "{i}");
        }
        let sum: Vec<f64> = {
            let b = bands(&x, step);
            (0..x.len()).map(|i| b.iter().map(|band| band[i]).sum()).collect()
        };
        let all = low_pass(&x, 32.0, step);
        assert!(sum.iter().zip(&all).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn integral_and_derivative_undo_each_other() {
        let x: Vec<f64> = (0..500).map(|i| (0.02 * f64::from(i)).cos()).collect();
        let back = derivative(&integral(&x, 0.01), 0.01);
        // Both are second-order: (0.02)² / 4 of the amplitude.
        assert!(back.iter().zip(&x).skip(2).take(490).all(|(a, b)| (a - b).abs() < 2e-4));
    }
}
