//! A road that repeats itself: one period of a Fourier series, read again and again.
//!
//! Called by the surfaces. The period is a test bed's (3.7 m, 0.66 s at 20 km/h), so its waves are the period's
//! harmonics and nothing between them.

use super::grid::cubic;
use super::iso8608::Iso8608;
use super::spectral::Series;

/// One period on a grid of its own, as the road's grid need not divide it.
#[derive(Debug, Clone)]
pub(crate) struct PeriodicRoad {
    heights: Vec<f64>,
    own_nodes_per_node: f64,
}

impl PeriodicRoad {
    pub(crate) fn new(iso: &Iso8608, period_m: f64, spacing_m: f64, seed: u64, stream: u64) -> Self {
        // Twice as fine as the road's grid, since it is read between its nodes.
        let nodes = 2 * (period_m / spacing_m).ceil() as usize;
        let own_spacing_m = period_m / nodes as f64;
        let heights = Series::new(iso, nodes, own_spacing_m).draw(seed, [stream, 0]);
        Self { heights, own_nodes_per_node: spacing_m / own_spacing_m }
    }

    /// Adds the heights of the nodes from `first` on.
    pub(crate) fn add(&self, first: i64, heights: &mut [f64]) {
        let period = self.heights.len();
        for (i, height) in heights.iter_mut().enumerate() {
            let position = ((first + i as i64) as f64 * self.own_nodes_per_node).rem_euclid(period as f64);
            let node = (position as usize).min(period - 1);
            let at = |offset: usize| self.heights[(node + period + offset - 1) % period];
            *height += cubic([at(0), at(1), at(2), at(3)], position - node as f64);
        }
    }
}
