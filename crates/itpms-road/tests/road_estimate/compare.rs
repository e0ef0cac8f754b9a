//! How a recorded road is held against the truth: error in a band of wavelengths, and the International Roughness
//! Index by an implementation of its own.

use super::plant::Biquad;

/// Seconds left out at both ends: the band-pass and the estimate have to settle.
const MARGIN_S: f64 = 6.0;

pub(crate) fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt()
}

/// Zero-phase band-pass between two frequencies, then the middle of it.
pub(crate) fn band(x: &[f64], rate_hz: f64, low_hz: f64, high_hz: f64) -> Vec<f64> {
    let mut y = x.to_vec();
    for _ in 0..2 {
        let mut sections = Biquad::butterworth_4(low_hz, rate_hz, true);
        if high_hz < 0.45 * rate_hz {
            sections.extend(Biquad::butterworth_4(high_hz, rate_hz, false));
        }
        for v in &mut y {
            *v = sections.iter_mut().fold(*v, |v, s| s.step(v));
        }
        y.reverse();
    }
    let margin = (MARGIN_S * rate_hz) as usize;
    y[margin..y.len() - margin].to_vec()
}

/// Error in wavelengths from 0.5 to 10 m, its rms over the truth's.
pub(crate) fn band_error(estimate: &[f64], truth: &[f64], rate_hz: f64, speed: f64) -> f64 {
    let difference: Vec<f64> = estimate.iter().zip(truth).map(|(e, t)| e - t).collect();
    let within = |x: &[f64]| rms(&band(x, rate_hz, speed / 10.0, speed / 0.5));
    within(&difference) / within(truth)
}

/// IRI in m/km: golden car at 80 km/h over the profile, 250 mm moving average, first 11 m left out.
pub(crate) fn iri(profile: &[f64], spacing_m: f64) -> f64 {
    let half = (0.125 / spacing_m).round() as usize;
    let smooth: Vec<f64> = (0..profile.len())
        .map(|i| {
            let (a, b) = (i.saturating_sub(half), (i + half + 1).min(profile.len()));
            profile[a..b].iter().sum::<f64>() / (b - a) as f64
        })
        .collect();
    let (k1, k2, c, mu) = (653.0, 63.3, 6.0, 0.15);
    let substeps = (spacing_m / 0.02).ceil() as usize;
    let h = spacing_m / (80.0 / 3.6) / substeps as f64;
    let f = |x: &[f64; 4], z: f64| {
        let suspension = k2 * (x[2] - x[0]) + c * (x[3] - x[1]);
        [x[1], suspension, x[3], (k1 * (z - x[2]) - suspension) / mu]
    };
    let mut x = [smooth[0], 0.0, smooth[0], 0.0];
    let (mut sum, mut count) = (0.0, 0.0);
    for i in 0..smooth.len() - 1 {
        for j in 0..substeps {
            let at = |s: f64| smooth[i] + (smooth[i + 1] - smooth[i]) * (j as f64 + s) / substeps as f64;
            let add = |x: &[f64; 4], k: &[f64; 4], s: f64| std::array::from_fn(|j| x[j] + s * k[j]);
            let p1 = f(&x, at(0.0));
            let p2 = f(&add(&x, &p1, 0.5 * h), at(0.5));
            let p3 = f(&add(&x, &p2, 0.5 * h), at(0.5));
            let p4 = f(&add(&x, &p3, h), at(1.0));
            x = std::array::from_fn(|j| x[j] + h / 6.0 * (p1[j] + 2.0 * p2[j] + 2.0 * p3[j] + p4[j]));
        }
        if i as f64 * spacing_m > 11.0 {
            sum += (x[3] - x[1]).abs() * spacing_m / (80.0 / 3.6);
            count += spacing_m;
        }
    }
    1000.0 * sum / count
}
