//! The surface of one track, whichever kind it is, laid node by node.
//!
//! Called by [`Road`](super::Road).

use std::sync::Arc;

use itpms_fourier::Complex;

use super::iso8608::Iso8608;
use super::lateral::Line;
use super::periodic::{PeriodicRoad, nodes_of};
use super::profile::MeasuredProfile;
use super::segments::SegmentedRoad;
use super::spectral::SpectralRoad;
use super::{GRID_SPACING_M, RoadError, Surface};
use crate::error::InvalidValue;

/// Nodes of a block on the coarsest grid: 1310.72 m.
const BLOCK_NODES: usize = 1 << 18;

#[derive(Debug, Clone)]
pub(crate) enum SurfaceRun {
    Flat,
    Spectral(SpectralRoad),
    Periodic(Arc<PeriodicRoad>),
    Segmented(SegmentedRoad),
    Measured { profile: Arc<MeasuredProfile>, spacing_m: f64 },
}

impl SurfaceRun {
    /// On a grid `refinement` times finer than the coarsest, and the nodes per m of the grid it is on: a road that
    /// repeats has one of its own. `speed_m_s` is that of a test bed, if the drive has one speed.
    pub(crate) fn new(
        surface: &Surface,
        line: Line,
        seed: u64,
        refinement: u32,
        speed_m_s: Option<f64>,
    ) -> Result<(Self, f64), RoadError> {
        let spacing_m = GRID_SPACING_M / f64::from(refinement);
        let nodes_per_m = f64::from(refinement) / GRID_SPACING_M;
        let block = BLOCK_NODES * refinement as usize;
        let periodic = |iso: &Iso8608, period_m: f64, follow: &dyn Fn(f64) -> Complex<f64>| {
            let nodes = nodes_of(period_m, spacing_m);
            let road = PeriodicRoad::new(iso, period_m, nodes, follow, seed, line.side());
            (SurfaceRun::Periodic(Arc::new(road)), nodes as f64 / period_m)
        };
        let run = match surface {
            Surface::Flat => SurfaceRun::Flat,
            Surface::Iso8608(iso) => match iso.repeat_every_m {
                Some(period_m) => return Ok(periodic(iso, period_m, &|_| Complex::new(1.0, 0.0))),
                None => SurfaceRun::Spectral(SpectralRoad::new(iso, block, spacing_m, seed, &line, 0)),
            },
            Surface::Bench(bench) => {
                let speed_m_s = speed_m_s.ok_or_else(bench_without_speed)?;
                let follow = |cycles_per_m: f64| bench.actuator.response(cycles_per_m * speed_m_s);
                return Ok(periodic(&bench.demand(), bench.repeat_every_s * speed_m_s, &follow));
            }
            Surface::Segments(spec) => {
                SurfaceRun::Segmented(SegmentedRoad::new(spec, block, spacing_m, seed, line))
            }
            Surface::Profile(spec) => SurfaceRun::Measured { profile: Arc::new(spec.load()?), spacing_m },
            Surface::Journey => return Err(journey_without_one().into()),
        };
        Ok((run, nodes_per_m))
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

fn bench_without_speed() -> InvalidValue {
    InvalidValue::new(
        "surface.bench",
        "at no one speed",
        "a constant speed above 0 (a test bed stands for one)",
    )
}

pub(crate) fn journey_without_one() -> InvalidValue {
    InvalidValue::new("surface", "journey", "a scenario with a [journey], composed")
}
