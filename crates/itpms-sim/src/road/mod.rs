//! Roads: what a scenario says about one ([`RoadSpec`]) and the road itself ([`Road`]), asked for its height at a distance.
//!
//! Called by the simulation, and by whoever wants a road without a car on it (roughness studies). A road is a
//! function of distance: it knows nothing of time, speed or wheels.
//!
//! A [`Road`] lays its surface and its obstacles on a grid finer than any log samples it, a few tens of metres at a time, averages it over
//! the tire's contact length there, and reads it with a cubic. An hour's drive takes a few megabytes.

mod bench;
mod grid;
mod iso8608;
mod lane;
mod lateral;
mod obstacle;
mod periodic;
mod profile;
mod recurring;
mod segments;
mod spectral;
mod spline;
mod surface;

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

pub use bench::{Actuator, BenchRoad};
pub use iso8608::{Amplitude, Iso8608, REFERENCE_CYCLES_PER_M, RoadClass, Roughness};
pub(crate) use lane::{Following, Lane};
pub use lateral::{Line, coherence};
pub use obstacle::{Pothole, Step, Tracks};
pub use profile::{Extension, MeasuredProfile, ProfileSpec, Trend};
pub use recurring::{Sleepers, Washboard};
pub use segments::{AfterLast, Segment, Segments};

use crate::error::{InvalidValue, ProfileError, Result, positive, within};
pub(crate) use grid::cubic;
use grid::{CHUNK_NODES, Chunk};
use surface::SurfaceRun;

/// Coarsest spacing of a road's grid, in m: 100 cycles/m, and waves of 1.3 km in a block of 2^18 points.
pub const GRID_SPACING_M: f64 = 0.005;

/// Chunks kept at a time: even on the finest grid more than a wheelbase, so that a rear wheel finds the road still
/// there that the front wheel has left.
const CHUNKS_KEPT: usize = 8;

/// One of the two paths that wheels run on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Left,
    Right,
}

/// The shape of the road before obstacles.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Surface {
    #[default]
    Flat,
    /// One ISO 8608 spectrum; both tracks are independent of each other, under a full car two lines of one surface.
    Iso8608(Iso8608),
    /// A test bed's repeated segment, played by an actuator; needs a constant speed.
    Bench(BenchRoad),
    /// Stretches of different ISO 8608 spectra.
    Segments(Segments),
    /// A surveyed profile, the same for both tracks.
    Profile(ProfileSpec),
    /// Stretches composed from the seed, as the scenario's `[journey]` says.
    Journey,
}

/// A road as written in a scenario.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RoadSpec {
    pub surface: Surface,
    /// Length in m over which the tire averages the road (moving average centred under the axle); 0: a point follower.
    pub contact_length_m: f64,
    /// Potholes, and with negative depth bumps.
    pub pothole: Vec<Pothole>,
    pub step: Vec<Step>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub washboard: Vec<Washboard>,
    /// Bumps or gaps at even distances.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sleepers: Vec<Sleepers>,
    /// Stiffness in N/m of soft ground under each tire; hard, if not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_n_per_m: Option<f64>,
}

impl RoadSpec {
    /// One ISO 8608 spectrum: a class letter or `Gd(n0)` in m³, and its slope `w`.
    pub fn iso8608(roughness: impl Into<Roughness>, slope: f64) -> Self {
        Self { surface: Surface::Iso8608(Iso8608::new(roughness, slope)), ..Self::default() }
    }

    /// Checks every number; files are read only when the road is built. Errors: names the first value that is out of range.
    pub fn validate(&self) -> Result<()> {
        within("contact_length_m", self.contact_length_m, 0.0, 1.0, "a length from 0 to 1 m")?;
        match &self.surface {
            Surface::Flat | Surface::Profile(_) => Ok(()),
            Surface::Iso8608(iso) => iso.validate().map_err(|e| e.within("surface.iso8608")),
            Surface::Bench(bench) => bench.validate().map_err(|e| e.within("surface.bench")),
            Surface::Segments(s) => s.validate().map_err(|e| e.within("surface.segments")),
            Surface::Journey => Err(surface::journey_without_one()),
        }?;
        for p in &self.pothole {
            p.validate().map_err(|e| e.within("pothole"))?;
        }
        for s in &self.step {
            s.validate().map_err(|e| e.within("step"))?;
        }
        for w in &self.washboard {
            w.validate().map_err(|e| e.within("washboard"))?;
        }
        for s in &self.sleepers {
            s.validate().map_err(|e| e.within("sleepers"))?;
        }
        self.ground_n_per_m.map_or(Ok(()), |ground| {
            within("ground_n_per_m", ground, 1e4, 1e9, "a stiffness from 10000 to 1000000000 N/m")
        })
    }
}

/// Why a road cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum RoadError {
    #[error(transparent)]
    Value(#[from] InvalidValue),
    #[error(transparent)]
    Profile(#[from] ProfileError),
}

/// A road under one track of wheels, the same for the same specification, seed and side.
///
/// Distances should come in roughly increasing order; going back by more than some tens of metres is allowed but lays the road anew.
#[derive(Debug, Clone)]
pub struct Road {
    surface: SurfaceRun,
    potholes: Vec<Pothole>,
    steps: Vec<Step>,
    washboards: Vec<Washboard>,
    sleepers: Vec<Sleepers>,
    contact_length_m: f64,
    nodes_per_m: f64,
    /// Index of the chunk at the front of the queue.
    first_chunk: i64,
    chunks: VecDeque<Chunk>,
}

impl Road {
    /// Lays a road. `spacing_m` is that of its grid; it is rounded down to [`GRID_SPACING_M`] over a power of two. A finer grid adds
    /// shorter waves to the same road. The grid of a road that repeats is finer still, a whole number of nodes to a period. Errors: a value
    /// out of range, a profile that cannot be read, or a test bed's road: that needs [`Road::at_speed`].
    pub fn new(spec: &RoadSpec, side: Side, seed: u64, spacing_m: f64) -> Result<Self, RoadError> {
        Self::lay_out(spec, Line::alone(side), seed, spacing_m, None)
    }

    /// The same along a line of a surface that is as rough across as it is along: lines with the same track width and
    /// seed belong to one surface. Measured, flat and repeated surfaces are level across a track.
    pub fn along(spec: &RoadSpec, line: Line, seed: u64, spacing_m: f64) -> Result<Self, RoadError> {
        Self::lay_out(spec, line, seed, spacing_m, None)
    }

    /// The same for a drive at one speed in m/s, which a test bed's road depends on: its segment repeats in time, and its actuator has a
    /// bandwidth in Hz. Other roads are what [`Road::new`] makes them. Errors: a value out of range, or a profile that cannot be read.
    pub fn at_speed(
        spec: &RoadSpec,
        side: Side,
        seed: u64,
        spacing_m: f64,
        speed_m_s: f64,
    ) -> Result<Self, RoadError> {
        positive("speed_m_s", speed_m_s)?;
        Self::lay_out(spec, Line::alone(side), seed, spacing_m, Some(speed_m_s))
    }

    pub(crate) fn lay_out(
        spec: &RoadSpec,
        line: Line,
        seed: u64,
        spacing_m: f64,
        speed_m_s: Option<f64>,
    ) -> Result<Self, RoadError> {
        spec.validate()?;
        within("spacing_m", spacing_m, 1e-4, 1.0, "a spacing from 0.1 mm to 1 m")?;
        let mut refinement = 1u32;
        while GRID_SPACING_M / f64::from(refinement) > spacing_m * (1.0 + 1e-9) {
            refinement *= 2;
        }
        let (surface, nodes_per_m) = SurfaceRun::new(&spec.surface, line, seed, refinement, speed_m_s)?;
        Ok(Self {
            surface,
            potholes: spec.pothole.iter().filter(|p| p.tracks.include(line.side())).cloned().collect(),
            steps: spec.step.iter().filter(|s| s.tracks.include(line.side())).cloned().collect(),
            washboards: spec.washboard.iter().filter(|w| w.tracks.include(line.side())).cloned().collect(),
            sleepers: spec.sleepers.iter().filter(|s| s.tracks.include(line.side())).cloned().collect(),
            contact_length_m: spec.contact_length_m,
            nodes_per_m,
            first_chunk: 0,
            chunks: VecDeque::new(),
        })
    }

    pub fn height_m(&mut self, distance_m: f64) -> f64 {
        let (chunk, position) = self.chunk(distance_m);
        chunk.height(position)
    }

    /// Height in m as the tire feels it: averaged over the contact length.
    pub fn contact_height_m(&mut self, distance_m: f64) -> f64 {
        let (chunk, position) = self.chunk(distance_m);
        chunk.contact_height(position)
    }

    pub fn spacing_m(&self) -> f64 {
        1.0 / self.nodes_per_m
    }

    /// The chunk that holds a distance, and the distance within it in nodes.
    fn chunk(&mut self, distance_m: f64) -> (&Chunk, f64) {
        let position = distance_m * self.nodes_per_m;
        let index = (position / CHUNK_NODES as f64).floor() as i64;
        if !(0..self.chunks.len() as i64).contains(&(index - self.first_chunk)) {
            self.lay(index);
        }
        let place = (index - self.first_chunk) as usize;
        (&self.chunks[place], position - index as f64 * CHUNK_NODES as f64)
    }

    /// Lays chunks until `index` is there: the missing ones in between when they are few, else afresh.
    fn lay(&mut self, index: i64) {
        let end = self.first_chunk + self.chunks.len() as i64;
        if self.chunks.is_empty() || index < self.first_chunk || index > end + CHUNKS_KEPT as i64 {
            self.chunks.clear();
            self.first_chunk = index;
        }
        while self.first_chunk + self.chunks.len() as i64 <= index {
            let next = self.first_chunk + self.chunks.len() as i64;
            let chunk = self.lay_chunk(next);
            self.chunks.push_back(chunk);
            if self.chunks.len() > CHUNKS_KEPT {
                self.chunks.pop_front();
                self.first_chunk += 1;
            }
        }
    }

    fn lay_chunk(&mut self, index: i64) -> Chunk {
        let half_contact = 0.5 * self.contact_length_m * self.nodes_per_m;
        let (first_node, mut heights) = Chunk::empty(index, half_contact);
        self.surface.fill(first_node, &mut heights);
        let is_bare = self.potholes.is_empty()
            && self.steps.is_empty()
            && self.washboards.is_empty()
            && self.sleepers.is_empty();
        if !is_bare {
            for (i, height) in heights.iter_mut().enumerate() {
                let x = (first_node + i as i64) as f64 / self.nodes_per_m;
                *height += self.potholes.iter().map(|p| p.height_m(x)).sum::<f64>();
                *height += self.steps.iter().map(|s| s.height_m(x)).sum::<f64>();
                *height += self.washboards.iter().map(|w| w.height_m(x)).sum::<f64>();
                *height += self.sleepers.iter().map(|s| s.height_m(x)).sum::<f64>();
            }
        }
        Chunk::new(heights, half_contact)
    }
}
