//! Marks within a panel. Filled by the panel's methods, read by `paint`.

use super::ink::{Ink, Stroke};

/// A curve or points: (x, y) in the axes' units.
pub(super) type Points = Vec<(f64, f64)>;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Mark {
    /// Through the points.
    Line { name: String, ink: Ink, stroke: Stroke, points: Points },
    /// (x, low, high)
    Band { name: String, ink: Ink, edges: Vec<(f64, f64, f64)> },
    /// (left, right, height), standing on zero.
    Bars { name: String, ink: Ink, bars: Vec<(f64, f64, f64)> },
    /// (x, y, half the length of its error bar; 0 or NaN for none)
    Dots { name: String, ink: Ink, dots: Vec<(f64, f64, f64)> },
    /// A horizontal line with its word.
    Level { ink: Ink, y: f64, word: String },
    /// A vertical line with its word.
    Moment { ink: Ink, x: f64, word: String },
    /// A stretch of x, shaded.
    Stretch { from: f64, to: f64, word: String },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sample {
    Line(Ink, Stroke),
    Area(Ink),
    Dot(Ink),
}

impl Mark {
    /// Its entry in the legend; `None` where it has no name or carries its word itself.
    pub(super) fn entry(&self) -> Option<(&str, Sample)> {
        let (name, sample) = match self {
            Self::Line { name, ink, stroke, .. } => (name, Sample::Line(*ink, *stroke)),
            Self::Band { name, ink, .. } | Self::Bars { name, ink, .. } => (name, Sample::Area(*ink)),
            Self::Dots { name, ink, .. } => (name, Sample::Dot(*ink)),
            Self::Level { .. } | Self::Moment { .. } | Self::Stretch { .. } => return None,
        };
        (!name.is_empty()).then_some((name.as_str(), sample))
    }

    pub(super) fn xs(&self) -> Vec<f64> {
        match self {
            Self::Line { points, .. } => points.iter().map(|p| p.0).collect(),
            Self::Band { edges, .. } => edges.iter().map(|e| e.0).collect(),
            Self::Bars { bars, .. } => bars.iter().flat_map(|b| [b.0, b.1]).collect(),
            Self::Dots { dots, .. } => dots.iter().map(|d| d.0).collect(),
            Self::Moment { x, .. } => vec![*x],
            Self::Level { .. } | Self::Stretch { .. } => vec![],
        }
    }

    /// Heights at places that `seen` lets pass.
    pub(super) fn ys(&self, seen: impl Fn(f64) -> bool) -> Vec<f64> {
        match self {
            Self::Line { points, .. } => points.iter().filter(|p| seen(p.0)).map(|p| p.1).collect(),
            Self::Band { edges, .. } => edges.iter().filter(|e| seen(e.0)).flat_map(|e| [e.1, e.2]).collect(),
            Self::Bars { bars, .. } => bars.iter().map(|b| b.2).chain([0.0]).collect(),
            Self::Dots { dots, .. } => dots
                .iter()
                .filter(|d| seen(d.0))
                .flat_map(|d| if d.2.is_finite() { [d.1 - d.2, d.1 + d.2] } else { [d.1, d.1] })
                .collect(),
            Self::Level { y, .. } => vec![*y],
            Self::Moment { .. } | Self::Stretch { .. } => vec![],
        }
    }
}
