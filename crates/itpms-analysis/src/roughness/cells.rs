//! Means over even cells of road, from samples at any distance.
//!
//! Called by the report's road and by the survey of a wheel; does not know the channels' meaning.

use crate::spectrum::Psd;

/// Means over cells of `N` channels; memory is one sample.
#[derive(Debug, Clone)]
pub(crate) struct Cells<const N: usize> {
    cell_m: f64,
    last: Option<(f64, [f64; N])>,
    filled_m: f64,
    integral: [f64; N],
}

impl<const N: usize> Cells<N> {
    /// Cells of this length; the first begins at the first sample.
    pub(crate) fn new(cell_m: f64) -> Self {
        Self { cell_m, last: None, filled_m: 0.0, integral: [0.0; N] }
    }

    pub(crate) fn last_m(&self) -> Option<f64> {
        self.last.map(|(last_m, _)| last_m)
    }

    /// The straight line from the last sample to this one, cut at cell borders; each full cell goes to `cell`.
    pub(crate) fn push(&mut self, distance_m: f64, values: [f64; N], mut cell: impl FnMut([f64; N])) {
        let Some((mut at, mut from)) = self.last.replace((distance_m, values)) else { return };
        let whole = distance_m - at;
        if !(whole > 0.0) {
            return;
        }
        let slope: [f64; N] = std::array::from_fn(|i| (values[i] - from[i]) / whole);
        while at < distance_m {
            let step = (self.cell_m - self.filled_m).min(distance_m - at);
            for i in 0..N {
                let end = from[i] + slope[i] * step;
                self.integral[i] += 0.5 * (from[i] + end) * step;
                from[i] = end;
            }
            at += step;
            self.filled_m += step;
            if self.filled_m >= self.cell_m * (1.0 - 1e-9) {
                cell(self.integral.map(|v| v / self.cell_m));
                self.filled_m = 0.0;
                self.integral = [0.0; N];
            }
            if !(step > 0.0) {
                break;
            }
        }
    }

    /// Forgets the last sample: what comes next begins a new stretch.
    pub(crate) fn restart(&mut self) {
        *self = Self::new(self.cell_m);
    }
}

/// Takes the averaging over a cell, `sinc²(n cell)` in power, out of a spectrum. The last bins, where that would
/// double the density, are dropped.
pub(crate) fn undo_cells(mut psd: Psd, cell_m: f64) -> Psd {
    let loss = |n: f64| {
        let angle = std::f64::consts::PI * n * cell_m;
        (angle.sin() / angle).powi(2)
    };
    let keep = psd.frequencies.iter().take_while(|n| loss(**n) > 0.5).count();
    psd.frequencies.truncate(keep);
    psd.densities.truncate(keep);
    for (density, n) in psd.densities.iter_mut().zip(&psd.frequencies) {
        *density /= loss(*n);
    }
    psd
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_the_mean_of_the_straight_lines_between_samples() {
        let mut cells = Cells::new(0.05);
        let mut found = Vec::new();
        // Height 2 x sampled at uneven distances, several to a cell and several cells to a step.
        for x in [0.0, 0.01, 0.04, 0.07, 0.07, 0.29, 0.3001] {
            cells.push(x, [2.0 * x, 0.0, f64::NAN], |cell| found.push(cell));
        }
        assert_eq!(found.len(), 6);
        for (i, cell) in found.iter().enumerate() {
            assert!((cell[0] - 2.0 * (i as f64 + 0.5) * 0.05).abs() < 1e-12);
            assert!(cell[2].is_nan());
        }
    }
}
