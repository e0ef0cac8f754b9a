//! Residuals about a line of known slope: the height of a friction loop, residuals, and their correlation. Called by
//! the spring's identification.

use super::estimate::Estimate;

pub(super) struct Loop {
    /// Offsets in N at the middle of the travel, of rising and of falling strokes.
    rising: Vec<f64>,
    falling: Vec<f64>,
    /// Load in N at the middle, midway between the directions.
    pub(super) middle_load: f64,
    /// Displacement, load, residual.
    pub(super) residuals: Vec<(f64, f64, f64)>,
    pub(super) residual_rms: f64,
    /// Variance of a stroke's offset if its residuals were independent, for want of strokes to compare.
    offset_variance: f64,
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn squares(values: &[f64]) -> f64 {
    let m = mean(values);
    values.iter().map(|v| (v - m).powi(2)).sum()
}

impl Loop {
    /// Strokes as (rising, rows of displacement and load), about a line of this slope.
    pub(super) fn of(strokes: &[(bool, &[(f64, f64)])], slope: f64, middle: f64) -> Self {
        let (mut rising, mut falling, mut residuals) = (Vec::new(), Vec::new(), Vec::new());
        for (up, rows) in strokes {
            let offsets: Vec<f64> = rows.iter().map(|(x, load)| load - slope * (x - middle)).collect();
            let offset = mean(&offsets);
            residuals.extend(rows.iter().zip(&offsets).map(|((x, load), o)| (*x, *load, o - offset)));
            if *up { rising.push(offset) } else { falling.push(offset) }
        }
        let middle_load = match (rising.is_empty(), falling.is_empty()) {
            (false, false) => 0.5 * (mean(&rising) + mean(&falling)),
            (false, true) => mean(&rising),
            _ => mean(&falling),
        };
        let n = residuals.len() as f64;
        let sum: f64 = residuals.iter().map(|(_, _, e)| e * e).sum();
        Self {
            rising,
            falling,
            middle_load,
            residual_rms: (sum / n).sqrt(),
            offset_variance: sum / n * strokes.len() as f64 / n,
            residuals,
        }
    }

    /// Half the loop's height; positive where moving against the load costs force. `sign` is that of the slope.
    pub(super) fn friction(&self, sign: f64) -> Option<Estimate> {
        if self.rising.is_empty() || self.falling.is_empty() {
            return None;
        }
        let (n_up, n_down) = (self.rising.len() as f64, self.falling.len() as f64);
        let value = 0.5 * sign * (mean(&self.rising) - mean(&self.falling));
        let dof = n_up + n_down - 2.0;
        let (each, dof) = if dof >= 2.0 {
            ((squares(&self.rising) + squares(&self.falling)) / dof, dof)
        } else {
            (self.offset_variance, 5.0)
        };
        Some(Estimate::new(value, 0.25 * each * (1.0 / n_up + 1.0 / n_down), dof))
    }
}

/// Distance from the stroke's mean displacement times residual, row by row, and the square sum of the distances.
pub(super) fn scores<'a>(strokes: impl Iterator<Item = &'a [(f64, f64)]>, slope: f64) -> (Vec<f64>, f64) {
    let (mut scores, mut sum) = (Vec::new(), 0.0);
    for rows in strokes {
        let n = rows.len() as f64;
        let (x_mean, load_mean) = rows.iter().fold((0.0, 0.0), |(x, load), r| (x + r.0 / n, load + r.1 / n));
        for (x, load) in rows {
            let distance = x - x_mean;
            scores.push(distance * (load - load_mean - slope * distance));
            sum += distance * distance;
        }
    }
    (scores, sum)
}

/// Variance of the sum of correlated scores with Bartlett's weights over `window` rows (Newey and West 1987): the mean square
/// of all sums over `window + 1` neighbors, those that overhang the ends included.
pub(super) fn long_run(scores: &[f64], window: usize) -> f64 {
    let length = window + 1;
    let mut sum = 0.0;
    let mut total = 0.0;
    for i in 0..scores.len() + window {
        sum += scores.get(i).copied().unwrap_or(0.0);
        if i >= length {
            sum -= scores[i - length];
        }
        total += sum * sum;
    }
    total / length as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_long_run_variance_is_bartletts_sum() {
        let v = [1.0, -0.5, 2.0, 0.3, -1.1, 0.7, 0.2];
        for window in [0, 1, 3, 5] {
            let mut expected = v.iter().map(|a| a * a).sum::<f64>();
            for lag in 1..=window {
                let weight = 1.0 - lag as f64 / (window + 1) as f64;
                expected += 2.0 * weight * (0..v.len() - lag).map(|i| v[i] * v[i + lag]).sum::<f64>();
            }
            assert!((long_run(&v, window) - expected).abs() < 1e-12, "{window}");
        }
    }

    #[test]
    fn friction_is_half_the_height_whatever_the_sign_of_the_load() {
        for sign in [1.0, -1.0] {
            let stroke = |up: bool, dither: f64| -> Vec<(f64, f64)> {
                let friction = if up { 12.0 } else { -12.0 };
                (0..5).map(|i| (f64::from(i), sign * (100.0 * f64::from(i) + friction + dither))).collect()
            };
            let rows = [stroke(true, 0.1), stroke(false, 0.1), stroke(true, -0.1), stroke(false, -0.1)];
            let strokes: Vec<_> = rows.iter().enumerate().map(|(i, r)| (i % 2 == 0, r.as_slice())).collect();
            let friction = Loop::of(&strokes, sign * 100.0, 2.0).friction(sign).unwrap();
            assert!((friction.value - 12.0).abs() < 1e-12);
            // Offsets differ by ±0.1 in each direction: pooled variance 0.02, halved twice over, t with two degrees.
            let expected = (0.25f64 * 0.02).sqrt() * 4.302_65 / 1.959_96;
            assert!((friction.standard_error - expected).abs() < 1e-4, "{friction:?}");
        }
    }
}
