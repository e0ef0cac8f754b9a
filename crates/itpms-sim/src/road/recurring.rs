//! Recurring features of a road: the waves of a washboard, sleepers, joints of slabs, the rails of a tram.
//!
//! Called by [`Road`](super::Road), which adds them to the surface.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::{Pothole, Tracks};
use crate::error::{Result, within};

/// Beyond any drive, in m.
const FAR_M: f64 = 1e7;

/// Distances in m that differ by less are one.
const SAME_M: f64 = 1e-6;

/// A wave, `amplitude sin(2π x / wavelength)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Washboard {
    pub wavelength_m: f64,
    pub amplitude_m: f64,
    /// Distance in m from which on there are waves, whole ones; always, if not given.
    #[serde(default = "long_before_m")]
    pub from_m: f64,
    /// Distance in m where they end; never, if not given.
    #[serde(default = "long_after_m")]
    pub to_m: f64,
    #[serde(default)]
    pub tracks: Tracks,
}

/// Bumps, one to a spacing, each beginning at a multiple of it; with negative height gaps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sleepers {
    /// Distance in m from the begin of one to the next.
    pub spacing_m: f64,
    pub length_m: f64,
    pub height_m: f64,
    /// Length of each edge in m, half a cosine.
    #[serde(default = "usual_edge_m")]
    pub edge_m: f64,
    /// Distance in m from which on there are some; always, if not given.
    #[serde(default = "long_before_m")]
    pub from_m: f64,
    /// Distance in m where they end; never, if not given.
    #[serde(default = "long_after_m")]
    pub to_m: f64,
    #[serde(default)]
    pub tracks: Tracks,
}

fn long_before_m() -> f64 {
    -FAR_M
}

fn long_after_m() -> f64 {
    FAR_M
}

fn usual_edge_m() -> f64 {
    0.02
}

/// How far a distance is beyond the last multiple of a period, where that period lies within a stretch.
fn within_period_m(x_m: f64, period_m: f64, [from_m, to_m]: [f64; 2]) -> Option<f64> {
    let begin_m = period_m * (x_m / period_m).floor();
    (begin_m >= from_m - SAME_M && begin_m + period_m <= to_m + SAME_M).then_some(x_m - begin_m)
}

fn validate_stretch(from_m: f64, to_m: f64) -> Result<()> {
    within("from_m", from_m, -FAR_M, FAR_M, "a distance in m")?;
    within("to_m", to_m, from_m, FAR_M, "a distance in m no less than from_m")
}

impl Washboard {
    pub(crate) fn height_m(&self, x_m: f64) -> f64 {
        let along_m = within_period_m(x_m, self.wavelength_m, [self.from_m, self.to_m]);
        along_m.map_or(0.0, |along_m| self.amplitude_m * (TAU * along_m / self.wavelength_m).sin())
    }

    pub(crate) fn validate(&self) -> Result<()> {
        within("wavelength_m", self.wavelength_m, 0.05, 100.0, "a length from 0.05 to 100 m")?;
        within("amplitude_m", self.amplitude_m, 0.0, 0.5, "an amplitude from 0 to 0.5 m")?;
        validate_stretch(self.from_m, self.to_m)
    }
}

impl Sleepers {
    pub(crate) fn height_m(&self, x_m: f64) -> f64 {
        within_period_m(x_m, self.spacing_m, [self.from_m, self.to_m]).map_or(0.0, |along_m| {
            let Self { length_m, edge_m, .. } = *self;
            Pothole { at_m: 0.0, length_m, depth_m: -self.height_m, edge_m, tracks: self.tracks }
                .height_m(along_m)
        })
    }

    pub(crate) fn validate(&self) -> Result<()> {
        within("spacing_m", self.spacing_m, 0.1, 1000.0, "a distance from 0.1 to 1000 m")?;
        within("length_m", self.length_m, 0.01, self.spacing_m, "a length from 0.01 m to the spacing")?;
        within("height_m", self.height_m, -0.5, 0.5, "a height from -0.5 to 0.5 m")?;
        within("edge_m", self.edge_m, 0.0, 0.5 * self.length_m, "from 0 to half the length")?;
        validate_stretch(self.from_m, self.to_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_whole_and_where_they_should_be() {
        let w = Washboard {
            wavelength_m: 0.8,
            amplitude_m: 0.01,
            from_m: 10.0,
            to_m: 20.0,
            tracks: Tracks::Both,
        };
        // The first whole wave begins at 10.4 m, the last ends at 20 m.
        for (x, height) in [(10.3, 0.0), (10.6, 0.01), (11.0, -0.01), (19.4, 0.01), (20.2, 0.0)] {
            assert!((w.height_m(x) - height).abs() < 1e-12, "{x}: {}", w.height_m(x));
        }
        let backwards = Washboard { from_m: 3.0, to_m: 2.0, ..w };
        assert!(backwards.validate().unwrap_err().to_string().starts_with("to_m is 2, expected"));
    }

    #[test]
    fn sleepers_come_as_often_as_they_say() {
        let s = Sleepers {
            spacing_m: 0.6,
            length_m: 0.2,
            height_m: 0.005,
            edge_m: 0.05,
            from_m: -FAR_M,
            to_m: FAR_M,
            tracks: Tracks::Both,
        };
        for n in [-3.0, 0.0, 7.0] {
            for (x, height) in [(0.025, 0.0025), (0.1, 0.005), (0.175, 0.0025), (0.4, 0.0)] {
                assert!((s.height_m(0.6 * n + x) - height).abs() < 1e-12, "{n} {x}");
            }
        }
        // Their mean is height (length - edge) over spacing.
        let mean = (0..6000).map(|i| s.height_m(1e-3 * (f64::from(i) + 0.5))).sum::<f64>() / 6000.0;
        assert!((mean - 0.005 * 0.15 / 0.6).abs() < 1e-8, "{mean}");
    }
}
