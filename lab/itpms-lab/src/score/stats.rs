//! The statistics of the score: errors over a window of time within a drive, and figures over many drives.
//!
//! Called by the rest of the score; knows numbers only.

use itpms_core::model::CornerEstimate;
use serde::Serialize;

/// Half-width of a 95 % interval in standard deviations.
pub(crate) const HALF_95: f64 = 1.96;

/// A stretch of time in s: later than `from_s`, not later than `to_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    pub from_s: f64,
    pub to_s: f64,
}

impl Window {
    pub fn new(from_s: f64, to_s: f64) -> Self {
        Self { from_s, to_s }
    }

    pub fn contains(&self, time_s: f64) -> bool {
        time_s > self.from_s && time_s <= self.to_s
    }

    /// Root of the mean square of the values at times within; NaN if there are none.
    pub(super) fn rms(&self, times_s: &[f64], values: impl Iterator<Item = f64>) -> f64 {
        let within = times_s.iter().zip(values).filter(|(t, _)| self.contains(**t));
        let (sum, count) = within.fold((0.0, 0.0), |(sum, count), (_, v)| (sum + v * v, count + 1.0));
        f64::sqrt(sum / count)
    }
}

/// Errors gathered over a window. Everything is NaN before the first; an error that is not finite makes bias and RMSE
/// not finite and counts as outside its interval.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ErrorSum {
    count: u64,
    sum: f64,
    squares: f64,
    covered: u64,
}

impl ErrorSum {
    /// One more error (estimate minus truth) with the sd the estimator gave it, in the same unit.
    pub fn push(&mut self, error: f64, sd: f64) {
        self.count += 1;
        self.sum += error;
        self.squares += error * error;
        self.covered += u64::from(error.abs() <= HALF_95 * sd);
    }

    pub fn count(&self) -> u64 {
        self.count
    }

    pub fn rmse(&self) -> f64 {
        (self.squares / self.count as f64).sqrt()
    }

    pub fn bias(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// Share of errors within 1.96 sd, 0 to 1.
    pub fn coverage(&self) -> f64 {
        self.covered as f64 / self.count as f64
    }
}

/// Errors of a pressure while it was valid, and for how much of the time that was.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct ValidErrors {
    pub(super) errors: ErrorSum,
    pub(super) sds_kpa: f64,
    pub(super) rows: u64,
}

impl ValidErrors {
    pub(super) fn push(&mut self, truth_kpa: f64, estimate: &CornerEstimate<f64>) {
        self.rows += 1;
        if estimate.validity.is_valid() {
            self.sds_kpa += estimate.pressure_sd_kpa;
            self.errors.push(estimate.pressure_kpa - truth_kpa, estimate.pressure_sd_kpa);
        }
    }

    pub(super) fn valid(all: &[&Self]) -> f64 {
        all.iter().map(|one| one.errors.count()).sum::<u64>() as f64
    }

    pub(super) fn share_valid(all: &[&Self]) -> f64 {
        Self::valid(all) / all.iter().map(|one| one.rows).sum::<u64>() as f64
    }

    /// Mean of a figure over those that were ever valid, every valid row counting alike.
    pub(super) fn mean(all: &[&Self], of: impl Fn(&Self) -> f64) -> f64 {
        let seen = all.iter().filter(|one| one.errors.count() > 0);
        seen.map(|one| one.errors.count() as f64 * of(one)).sum::<f64>() / Self::valid(all)
    }

    pub(super) fn rms(all: &[&Self]) -> f64 {
        Self::mean(all, |one| one.errors.rmse().powi(2)).sqrt()
    }
}

/// Errors of one estimate over the windows of a drive in which a pressure changes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct WindowErrors {
    pub(super) judged: ErrorSum,
    pub(super) before: ErrorSum,
    pub(super) after: ErrorSum,
    pub(super) change: ErrorSum,
}

impl WindowErrors {
    /// `windows`: in the order of the fields.
    pub(super) fn push(
        &mut self,
        windows: [Window; 4],
        time_s: f64,
        truth_kpa: f64,
        estimate: &CornerEstimate<f64>,
    ) {
        let sums = [&mut self.judged, &mut self.before, &mut self.after, &mut self.change];
        for (_, sum) in windows.iter().zip(sums).filter(|(window, _)| window.contains(time_s)) {
            sum.push(estimate.pressure_kpa - truth_kpa, estimate.pressure_sd_kpa);
        }
    }
}

/// Median and the 10th and 90th percentile of a figure over drives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    pub p10: f64,
    pub median: f64,
    pub p90: f64,
}

impl Spread {
    /// Of one figure per drive; see [`percentile`].
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().map(worst_if_nan).collect();
        sorted.sort_by(f64::total_cmp);
        Self { p10: of_sorted(&sorted, 0.1), median: of_sorted(&sorted, 0.5), p90: of_sorted(&sorted, 0.9) }
    }
}

/// The figure that a share (0 to 1) of drives does not exceed, straight between the two nearest ranks (type 7 of
/// Hyndman and Fan, 1996). A drive without a figure (NaN) counts as infinitely bad; no drives give NaN.
pub fn percentile(values: &[f64], share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().map(worst_if_nan).collect();
    sorted.sort_by(f64::total_cmp);
    of_sorted(&sorted, share)
}

fn worst_if_nan(value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { value }
}

fn of_sorted(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let rank = share.clamp(0.0, 1.0) * last as f64;
    let below = rank as usize;
    let part = rank - below as f64;
    if part > 0.0 { sorted[below] * (1.0 - part) + sorted[below + 1] * part } else { sorted[below] }
}

/// Mean over drives and the standard error of that mean (NaN for a single one).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    pub value: f64,
    pub error: f64,
}

impl Mean {
    /// Of one figure per drive.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - value).powi(2)).sum();
        Self { value, error: (squares / (n - 1.0) / n).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_lie_between_ranks() {
        // Ranks 0..4 at 10, 20, 30, 40, 50: the 10th percentile is at rank 0.4, the 90th at 3.6.
        let s = Spread::of([30.0, 10.0, 50.0, 20.0, 40.0]);
        assert!(
            (s.p10 - 14.0).abs() < 1e-12 && (s.median - 30.0).abs() < 1e-12 && (s.p90 - 46.0).abs() < 1e-12
        );
        // An even number: the median is halfway between the middle two.
        assert!((Spread::of([4.0, 1.0, 2.0, 3.0]).median - 2.5).abs() < 1e-12);
        assert_eq!(percentile(&[7.0], 0.9), 7.0);
        assert!(percentile(&[], 0.5).is_nan());
    }

    #[test]
    fn a_drive_without_a_figure_is_the_worst() {
        let values = [1.0, f64::NAN, 2.0];
        assert_eq!(percentile(&values, 0.5), 2.0);
        assert_eq!(percentile(&values, 1.0), f64::INFINITY);
    }

    #[test]
    fn errors_over_a_window() {
        let mut sum = ErrorSum::default();
        // |3| <= 1.96 * 2, |-4| > 1.96 * 2, |-1.96| <= 1.96 * 1, |5| > 1.96 * 2.5
        for (error, sd) in [(3.0, 2.0), (-4.0, 2.0), (-1.96, 1.0), (5.0, 2.5)] {
            sum.push(error, sd);
        }
        assert_eq!(sum.coverage(), 0.5);
        assert!((sum.bias() - 2.04 / 4.0).abs() < 1e-12);
        assert!((sum.rmse() - ((9.0 + 16.0 + 1.96 * 1.96 + 25.0) / 4.0f64).sqrt()).abs() < 1e-12);
        assert!(ErrorSum::default().rmse().is_nan());
    }

    #[test]
    fn what_is_not_finite_is_not_covered() {
        let mut sum = ErrorSum::default();
        for (error, sd) in [(f64::NAN, 1.0), (1.0, f64::NAN), (0.0, 1.0), (0.0, 1.0)] {
            sum.push(error, sd);
        }
        assert_eq!(sum.coverage(), 0.5);
        assert!(sum.bias().is_nan() && sum.rmse().is_nan());
    }

    #[test]
    fn windows_hold_their_end_but_not_their_begin() {
        let window = Window::new(5.0, 20.0);
        let inside: Vec<f64> =
            [4.9, 5.0, 5.1, 20.0, 20.1].into_iter().filter(|&t| window.contains(t)).collect();
        assert_eq!(inside, [5.1, 20.0]);
        assert!(!window.contains(f64::NAN));
    }

    #[test]
    fn a_mean_has_a_standard_error() {
        // Deviations -2, 0, 2: variance 4, over three drives 4/3.
        let mean = Mean::of(&[1.0, 3.0, 5.0]);
        assert_eq!(mean.value, 3.0);
        assert!((mean.error - (4.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!(Mean::of(&[1.0]).error.is_nan());
    }
}
