//! The low-pass that brings a faster acceleration to the rows' rate.
//!
//! A sinc of cut-off 0.43 of the rows' rate under a Kaiser window of 60 dB (J. F. Kaiser 1974: `beta = 0.1102 (A - 8.7)`,
//! transition width `(A - 8) / (2.285 * 2 pi * length)`), five periods to either side: flat to 0.25 of the rate, which is
//! what the estimators look at, and 60 dB down from 0.61 on. Nothing above folds onto what they see. It is a
//! function of time, not a list of taps, so jittered samples need no grid.

use std::f64::consts::PI;

/// Half the kernel's length, in periods of the rows.
pub(super) const HALF_WIDTH: f64 = 5.0;
/// Cut-off in cycles per period of the rows.
const CUT_OFF: f64 = 0.43;
/// Kaiser's beta for 60 dB.
const BETA: f64 = 0.1102 * (60.0 - 8.7);

/// The weight of a sample that lies `periods` of the rows from the row; not normalised.
pub(super) fn weight(periods: f64) -> f64 {
    let place = periods / HALF_WIDTH;
    if !(place.abs() <= 1.0) {
        return 0.0;
    }
    let angle = 2.0 * PI * CUT_OFF * periods;
    let sinc = if angle.abs() < 1e-8 { 1.0 } else { angle.sin() / angle };
    sinc * bessel_i0(BETA * (1.0 - place * place).sqrt()) / bessel_i0(BETA)
}

/// Modified Bessel function of the first kind and order zero, by its series; for the window's arguments, up to 6, twenty
/// terms are more than a double can hold.
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..=20 {
        term *= quarter / f64::from(k * k);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz and Stegun, table 9.8: exp(-x) I0(x).
    #[test]
    fn bessel_function_as_tabulated() {
        for (x, scaled) in
            [(0.0, 1.0), (1.0, 0.465_759_607_6), (3.0, 0.243_000_354_2), (5.0, 0.183_540_812_6)]
        {
            assert!((bessel_i0(x) * f64::exp(-x) - scaled).abs() < 1e-9, "{x}");
        }
    }

    /// Gain at a frequency in cycles per period of the rows, samples `ratio` times as dense.
    fn gain(frequency: f64, ratio: f64) -> f64 {
        let count = (HALF_WIDTH * ratio) as i32;
        let (mut sum, mut norm) = (0.0, 0.0);
        for i in -count..=count {
            let periods = f64::from(i) / ratio;
            sum += weight(periods) * (2.0 * PI * frequency * periods).cos();
            norm += weight(periods);
        }
        (sum / norm).abs()
    }

    #[test]
    fn flat_where_the_estimators_look_and_silent_where_it_would_fold() {
        for ratio in [2.0, 4.0, 5.0, 10.0] {
            for step in 0..=25 {
                let frequency = 0.01 * f64::from(step);
                assert!((gain(frequency, ratio) - 1.0).abs() < 2e-3, "{ratio} {frequency}");
            }
            for step in 0..40 {
                let frequency = 0.62 + 0.01 * f64::from(step);
                if frequency <= ratio / 2.0 {
                    assert!(
                        gain(frequency, ratio) < 1.5e-3,
                        "{ratio} {frequency} {}",
                        gain(frequency, ratio)
                    );
                }
            }
        }
    }
}
