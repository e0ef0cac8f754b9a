//! Colors that the color-blind can tell apart (Okabe and Ito, 2008; the lighter ones darkened for thin lines on
//! white), and who has which.

/// Who or what is drawn. The same thing has the same color in every figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Ink {
    /// What really is.
    Truth,
    /// The default estimator.
    Default,
    /// The published filter, corrected and informed.
    Mended,
    /// The published adaptive filter.
    Adaptive,
    /// The published filter without forgetting.
    Plain,
    /// A number that the paper prints.
    Paper,
    /// Orange, for what has no color of its own.
    Extra,
    /// Sky blue, for what has no color of its own.
    Light,
    /// Limits and remarks.
    Muted,
}

impl Ink {
    /// As SVG and CSS take it.
    #[must_use]
    pub fn color(self) -> &'static str {
        match self {
            Self::Truth => "#1b1b1b",
            Self::Default => "#0067a8",
            Self::Mended => "#008f68",
            Self::Adaptive => "#d0560a",
            Self::Plain => "#b0528a",
            Self::Paper => "#8a6d00",
            Self::Extra => "#d99100",
            Self::Light => "#3fa0d8",
            Self::Muted => "#6b7280",
        }
    }
}

/// How a line is drawn: a second way, beside color, to tell lines apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stroke {
    /// Unbroken.
    Solid,
    /// Unbroken and broad.
    Bold,
    /// Unbroken and thin, for many of a kind.
    Thin,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
}

impl Stroke {
    pub(super) fn width(self) -> f64 {
        match self {
            Self::Bold => 2.4,
            Self::Thin => 0.8,
            Self::Solid | Self::Dashed => 1.7,
            Self::Dotted => 1.8,
        }
    }

    /// The attribute with its space, or nothing.
    pub(super) fn dashes(self) -> &'static str {
        match self {
            Self::Dashed => " stroke-dasharray=\"7 4\"",
            Self::Dotted => " stroke-dasharray=\"1.5 3.5\" stroke-linecap=\"round\"",
            _ => "",
        }
    }
}
