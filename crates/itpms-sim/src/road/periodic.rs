//! A road that repeats itself: one period of a Fourier series, read again and again.
//!
//! Called by the surfaces. The period is a test bed's (3.7 m, 0.66 s at 20 km/h), so its waves are the period's
//! harmonics and nothing between them. A period is a whole number of the grid's nodes, so that it repeats exactly.

use itpms_fourier::Complex;

use super::Side;
use super::iso8608::Iso8608;
use super::lateral::Line;
use super::spectral::Series;

/// One period on the road's grid.
#[derive(Debug, Clone)]
pub(crate) struct PeriodicRoad {
    heights: Vec<f64>,
}

/// Nodes of a period on a grid of at most half the wanted spacing; an even number.
pub(crate) fn nodes_of(period_m: f64, spacing_m: f64) -> usize {
    2 * (period_m / spacing_m).ceil() as usize
}

impl PeriodicRoad {
    /// `follow` is what becomes of a wave of so many cycles/m on its way from the spectrum to the road. Each side has a
    /// road of its own, level across its width.
    pub(crate) fn new(
        iso: &Iso8608,
        period_m: f64,
        nodes: usize,
        follow: impl Fn(f64) -> Complex<f64>,
        seed: u64,
        side: Side,
    ) -> Self {
        let series = Series::new(iso, nodes, period_m / nodes as f64).followed_by(follow);
        let sources = series.sources(iso, &Line::alone(side), 0);
        Self { heights: series.draw(seed, &sources, 0) }
    }

    /// Adds the heights of the nodes from `first` on.
    pub(crate) fn add(&self, first: i64, heights: &mut [f64]) {
        let start = first.rem_euclid(self.heights.len() as i64) as usize;
        let endless = self.heights.iter().cycle().skip(start);
        heights.iter_mut().zip(endless).for_each(|(sum, height)| *sum += height);
    }
}
