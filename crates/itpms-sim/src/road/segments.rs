//! Stretches of road of different roughness, joined without a step.
//!
//! Called by the surfaces. Where one stretch ends the next one starts at the same height, so a change of class is a
//! change of roughness and not a bump.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::iso8608::{Amplitude, Iso8608, Roughness};
use super::lateral::Line;
use super::spectral::SpectralRoad;
use crate::error::{InvalidValue, Result, within};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    pub length_m: f64,
    /// `Gd(n0)`, or the class it is the mean of.
    pub roughness: Roughness,
    /// Slope `w` of the spectrum.
    pub slope: f64,
}

/// Continuation after the last stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AfterLast {
    /// It goes on for ever.
    #[default]
    Hold,
    /// The list starts again, with a new road of the same spectra.
    Repeat,
}

/// A list of stretches; the first one also lies before the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segments {
    /// In the order in which they are driven.
    pub list: Vec<Segment>,
    #[serde(default)]
    pub after_last: AfterLast,
    /// How the Fourier coefficients are drawn.
    #[serde(default)]
    pub amplitude: Amplitude,
}

impl Segments {
    pub(crate) fn validate(&self) -> Result<()> {
        if self.list.is_empty() {
            return Err(InvalidValue::new("list", "empty", "at least one segment"));
        }
        for s in &self.list {
            within("list.length_m", s.length_m, 1.0, 1e6, "a length from 1 m to 1000 km")?;
            self.iso(s).validate().map_err(|e| e.within("list"))?;
        }
        Ok(())
    }

    fn iso(&self, s: &Segment) -> Iso8608 {
        Iso8608 { amplitude: self.amplitude, ..Iso8608::new(s.roughness, s.slope) }
    }
}

/// Where the n-th stretch driven starts, and by how much it is lifted to meet the one before.
#[derive(Debug, Clone, Copy)]
struct Start {
    node: i64,
    lift_m: f64,
}

/// The stretches laid one after the other.
#[derive(Debug, Clone)]
pub(crate) struct SegmentedRoad {
    spec: Segments,
    spacing_m: f64,
    longest_block: usize,
    seed: u64,
    line: Line,
    /// Of all stretches met so far, from the first on.
    starts: Vec<Start>,
    /// The last stretches used, newest at the back.
    roads: VecDeque<(usize, SpectralRoad)>,
}

impl SegmentedRoad {
    pub(crate) fn new(spec: &Segments, longest_block: usize, spacing_m: f64, seed: u64, line: Line) -> Self {
        Self {
            spec: spec.clone(),
            spacing_m,
            longest_block,
            seed,
            line,
            starts: vec![Start { node: 0, lift_m: 0.0 }],
            roads: VecDeque::new(),
        }
    }

    /// Adds the heights of the nodes from `first` on.
    pub(crate) fn add(&mut self, first: i64, heights: &mut [f64]) {
        let end = first + heights.len() as i64;
        while self.next_start(self.starts.len() - 1).is_some_and(|node| node < end) {
            self.join_next();
        }
        let mut number = self.starts.partition_point(|s| s.node <= first).max(1) - 1;
        let mut from = first;
        while from < end {
            let to = self.starts.get(number + 1).map_or(end, |s| s.node.min(end));
            let stretch = &mut heights[(from - first) as usize..(to - first) as usize];
            let lift_m = self.starts[number].lift_m;
            stretch.iter_mut().for_each(|h| *h += lift_m);
            self.with_road(number, |road| road.add(from, stretch));
            from = to;
            number += 1;
        }
    }

    /// Node on which the stretch after `number` starts, if there is one.
    fn next_start(&self, number: usize) -> Option<i64> {
        let count = self.spec.list.len();
        if self.spec.after_last == AfterLast::Hold && number + 1 >= count {
            return None;
        }
        let length = self.spec.list[number % count].length_m / self.spacing_m;
        Some(self.starts[number].node + length.round() as i64)
    }

    /// Finds where the next stretch starts and how high: at the height the last one ends with.
    fn join_next(&mut self) {
        let number = self.starts.len() - 1;
        let Some(node) = self.next_start(number) else { return };
        let (mut end, mut start) = ([0.0], [0.0]);
        self.with_road(number, |road| road.add(node, &mut end));
        self.with_road(number + 1, |road| road.add(node, &mut start));
        let lift_m = self.starts[number].lift_m + end[0] - start[0];
        self.starts.push(Start { node, lift_m });
    }

    fn with_road(&mut self, number: usize, f: impl FnOnce(&mut SpectralRoad)) {
        if !self.roads.iter().any(|(n, _)| *n == number) {
            let segment = &self.spec.list[number % self.spec.list.len()];
            // Waves four times a stretch's length are as good as endless to it.
            let wanted = 4.0 * segment.length_m / self.spacing_m;
            let block =
                (wanted as usize).next_power_of_two().clamp(self.longest_block / 16, self.longest_block);
            let iso = self.spec.iso(segment);
            let road = SpectralRoad::new(&iso, block, self.spacing_m, self.seed, &self.line, number as u64);
            self.roads.push_back((number, road));
            if self.roads.len() > 2 {
                self.roads.pop_front();
            }
        }
        if let Some((_, road)) = self.roads.iter_mut().find(|(n, _)| *n == number) {
            f(road);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{RoadClass, Side};

    fn spec(after_last: AfterLast) -> Segments {
        let segment = |class: RoadClass, length_m| Segment { length_m, roughness: class.into(), slope: 2.0 };
        Segments {
            list: vec![segment(RoadClass::A, 50.0), segment(RoadClass::D, 40.0), segment(RoadClass::B, 60.0)],
            after_last,
            amplitude: Amplitude::Gaussian,
        }
    }

    fn lay(spec: &Segments, length_m: f64) -> Vec<f64> {
        let mut road = SegmentedRoad::new(spec, 1 << 18, 0.005, 5, Line::alone(Side::Left));
        let mut heights = vec![0.0; (length_m / 0.005) as usize];
        for (i, chunk) in heights.chunks_mut(4096).enumerate() {
            road.add(4096 * i as i64, chunk);
        }
        heights
    }

    /// Mean square of the increments over 0.1 m, in m². For w = 2: 2 π² Gd n0² 0.1 (the structure function of a
    /// random walk, `∫ 4 sin²(π n d) C n^-2 dn = 2 π² C d`).
    fn roughness(heights: &[f64]) -> f64 {
        let lag = 20;
        let sum: f64 = heights.windows(lag + 1).map(|w| (w[lag] - w[0]).powi(2)).sum();
        sum / (heights.len() - lag) as f64
    }

    #[test]
    fn every_stretch_has_its_roughness() {
        let heights = lay(&spec(AfterLast::Repeat), 300.0);
        for (from, to, class) in [
            (0.0, 50.0, RoadClass::A),
            (50.0, 90.0, RoadClass::D),
            (90.0, 150.0, RoadClass::B),
            (150.0, 200.0, RoadClass::A),
            (200.0, 240.0, RoadClass::D),
        ] {
            let part = &heights[(from / 0.005) as usize..(to / 0.005) as usize];
            let expected = 2.0 * std::f64::consts::PI.powi(2) * class.gd_n0_m3() * 0.01 * 0.1;
            let ratio = roughness(part) / expected;
            // About 400 independent increments: sd 7 %; waves beyond 100 cycles/m are missing: -1 %.
            assert!((ratio - 1.0).abs() < 0.25, "{from} m, class {class}: {ratio}");
        }
    }

    #[test]
    fn a_change_of_class_is_no_step() {
        let heights = lay(&spec(AfterLast::Hold), 200.0);
        for join_m in [50.0, 90.0] {
            let join = (join_m / 0.005) as usize;
            let step = (heights[join] - heights[join - 1]).abs();
            // The steps between neighbouring nodes on class D have an rms of sqrt(2 π² 1024e-8 0.005) = 1 mm.
            assert!(step < 4e-3, "{join_m}: {step}");
        }
    }

    #[test]
    fn laid_in_other_pieces_it_is_the_same_road() {
        let whole = lay(&spec(AfterLast::Repeat), 200.0);
        let mut road =
            SegmentedRoad::new(&spec(AfterLast::Repeat), 1 << 18, 0.005, 5, Line::alone(Side::Left));
        let mut part = vec![0.0; 3000];
        road.add(17_000, &mut part);
        assert!(part.iter().zip(&whole[17_000..]).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
