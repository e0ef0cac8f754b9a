//! Potholes and steps: what lies on a road, or is missing from it.
//!
//! Called by [`Road`](super::Road), which adds them to the surface.

use serde::{Deserialize, Serialize};

use super::Side;
use crate::error::{Result, not_negative, within};

/// Which wheels meet an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tracks {
    #[default]
    Both,
    Left,
    Right,
}

impl Tracks {
    pub(crate) fn include(self, side: Side) -> bool {
        match self {
            Tracks::Both => true,
            Tracks::Left => side == Side::Left,
            Tracks::Right => side == Side::Right,
        }
    }
}

/// A hole with rounded edges (cosine halves, inside the length); with negative depth a bump.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pothole {
    /// Distance of its near end in m.
    pub at_m: f64,
    pub length_m: f64,
    pub depth_m: f64,
    #[serde(default = "usual_edge_m")]
    pub edge_m: f64,
    #[serde(default)]
    pub tracks: Tracks,
}

/// A change of height for good, with a rounded edge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Distance of its near end in m.
    pub at_m: f64,
    /// Height in m, negative downwards.
    pub height_m: f64,
    #[serde(default = "usual_edge_m")]
    pub edge_m: f64,
    #[serde(default)]
    pub tracks: Tracks,
}

fn usual_edge_m() -> f64 {
    0.05
}

impl Pothole {
    pub(crate) fn height_m(&self, x_m: f64) -> f64 {
        let end_m = self.at_m + self.length_m;
        -self.depth_m * rise(x_m - self.at_m, self.edge_m) * rise(end_m - x_m, self.edge_m)
    }

    pub(crate) fn validate(&self) -> Result<()> {
        within("at_m", self.at_m, -1e7, 1e7, "a distance in m")?;
        within("length_m", self.length_m, 0.01, 100.0, "a length from 0.01 to 100 m")?;
        within("depth_m", self.depth_m, -1.0, 1.0, "a depth from -1 to 1 m")?;
        within("edge_m", self.edge_m, 0.0, 0.5 * self.length_m, "from 0 to half the length")
    }
}

impl Step {
    pub(crate) fn height_m(&self, x_m: f64) -> f64 {
        self.height_m * rise(x_m - self.at_m, self.edge_m)
    }

    pub(crate) fn validate(&self) -> Result<()> {
        within("at_m", self.at_m, -1e7, 1e7, "a distance in m")?;
        within("height_m", self.height_m, -1.0, 1.0, "a height from -1 to 1 m")?;
        not_negative("edge_m", self.edge_m)
    }
}

/// 0 before 0, 1 beyond `edge`, half a cosine between.
fn rise(x: f64, edge: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if x >= edge {
        1.0
    } else {
        0.5 * (1.0 - (std::f64::consts::PI * x / edge).cos())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pothole_is_as_deep_and_long_as_it_says() {
        let p = Pothole { at_m: 10.0, length_m: 0.6, depth_m: 0.03, edge_m: 0.1, tracks: Tracks::Left };
        for (x, h) in
            [(9.9, 0.0), (10.05, -0.015), (10.1, -0.03), (10.5, -0.03), (10.55, -0.015), (10.6, 0.0)]
        {
            assert!((p.height_m(x) - h).abs() < 1e-12, "{x}");
        }
        assert!(p.tracks.include(Side::Left) && !p.tracks.include(Side::Right));
    }

    #[test]
    fn a_step_stays() {
        let s = Step { at_m: 1.0, height_m: 0.02, edge_m: 0.0, tracks: Tracks::Both };
        assert_eq!((s.height_m(1.0), s.height_m(1.001), s.height_m(500.0)), (0.0, 0.02, 0.02));
    }
}
