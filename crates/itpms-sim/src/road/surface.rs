//! The surface of one track, whichever kind it is, laid node by node.
//!
//! Called by [`Road`](super::Road).

use std::sync::Arc;

use super::periodic::PeriodicRoad;
use super::profile::MeasuredProfile;
use super::segments::SegmentedRoad;
use super::spectral::SpectralRoad;
use super::{GRID_SPACING_M, RoadError, Side, Surface};

/// Nodes of a block on the coarsest grid: 1310.72 m.
const BLOCK_NODES: usize = 1 << 18;

/// A surface being laid.
#[derive(Debug, Clone)]
pub(crate) enum SurfaceRun {
    Flat,
    Spectral(SpectralRoad),
    Periodic(Arc<PeriodicRoad>),
    Segmented(SegmentedRoad),
    Measured { profile: Arc<MeasuredProfile>, spacing_m: f64 },
}

impl SurfaceRun {
    /// On a grid `refinement` times finer than the coarsest.
    pub(crate) fn new(surface: &Surface, side: Side, seed: u64, refinement: u32) -> Result<Self, RoadError> {
        let spacing_m = GRID_SPACING_M / f64::from(refinement);
        let block = BLOCK_NODES * refinement as usize;
        // Even streams lie under the left wheels, odd ones under the right.
        let stream = match side {
            Side::Left => 0,
            Side::Right => 1,
        };
        Ok(match surface {
            Surface::Flat => SurfaceRun::Flat,
            Surface::Iso8608(iso) => match iso.repeat_every_m {
                Some(period_m) => {
                    SurfaceRun::Periodic(Arc::new(PeriodicRoad::new(iso, period_m, spacing_m, seed, stream)))
                }
                None => SurfaceRun::Spectral(SpectralRoad::new(iso, block, spacing_m, seed, stream)),
            },
            Surface::Segments(spec) => {
                SurfaceRun::Segmented(SegmentedRoad::new(spec, block, spacing_m, seed, stream))
            }
            Surface::Profile(spec) => SurfaceRun::Measured { profile: Arc::new(spec.load()?), spacing_m },
        })
    }

    /// Adds the heights in m of the nodes from `first` on.
    pub(crate) fn fill(&mut self, first: i64, heights: &mut [f64]) {
        match self {
            SurfaceRun::Flat => {}
            SurfaceRun::Spectral(road) => road.add(first, heights),
            SurfaceRun::Periodic(road) => road.add(first, heights),
            SurfaceRun::Segmented(road) => road.add(first, heights),
            SurfaceRun::Measured { profile, spacing_m } => {
                for (i, height) in heights.iter_mut().enumerate() {
                    *height += profile.height_m((first + i as i64) as f64 * *spacing_m);
                }
            }
        }
    }
}
