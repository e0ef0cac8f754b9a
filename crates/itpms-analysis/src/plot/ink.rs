//! Colors that the color-blind can tell apart (Okabe and Ito, 2008; the lighter ones darkened for thin lines on white), and who has which.

/// Who or what is drawn. The same thing has the same color in every figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Ink {
    Truth,
    Default,
    Mended,
    Adaptive,
    /// The published filter without forgetting.
    Plain,
    Paper,
    /// Orange, for what has no color of its own.
    Extra,
    /// Sky blue, for what has no color of its own.
    Light,
    Muted,
}

impl Ink {
    /// As SVG and CSS take it.
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

/// Every color of a figure, by day and on a dark page. The first nine are those of [`Ink`], in its order.
const BY_NIGHT: [(&str, &str); 16] = [
    ("#1b1b1b", "#f2f4f6"),
    ("#0067a8", "#5fb0f2"),
    ("#008f68", "#4fc9a4"),
    ("#d0560a", "#f0924b"),
    ("#b0528a", "#e08cc0"),
    ("#8a6d00", "#d6b84a"),
    ("#d99100", "#f2b544"),
    ("#3fa0d8", "#7cc6f2"),
    ("#6b7280", "#9aa7b4"),
    // Paper, stretches that are set off, ticks, grid, axes, captions, words.
    ("#fff", "#182029"),
    ("#eef0f3", "#232d37"),
    ("#9aa1ab", "#5d6a77"),
    ("#e3e6ea", "#2b3641"),
    ("#3b4048", "#aab5c0"),
    ("#4a4f57", "#9aa7b4"),
    ("#1f2328", "#e6ebf0"),
];

/// Style of figures on a dark page: a rule wins over the attribute that it names.
pub(crate) fn night_style() -> String {
    let rule = |property: &str, (day, night): (&str, &str)| {
        format!(
            ":root[data-theme=\"dark\"] :is(.plot-panels,.plot-legend) [{property}=\"{day}\"]{{{property}:{night}}}"
        )
    };
    BY_NIGHT.into_iter().flat_map(|pair| ["fill", "stroke"].map(|property| rule(property, pair))).collect()
}

/// How a line is drawn: a second way, beside color, to tell lines apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stroke {
    Solid,
    Bold,
    Thin,
    Dashed,
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

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Ink; 9] = {
        use Ink::{Adaptive, Default, Extra, Light, Mended, Muted, Paper, Plain, Truth};
        [Truth, Default, Mended, Adaptive, Plain, Paper, Extra, Light, Muted]
    };

    /// Relative luminance of WCAG 2.2.
    fn luminance(color: &str) -> f64 {
        let hex = color.trim_start_matches('#');
        let wide: String =
            if hex.len() == 3 { hex.chars().flat_map(|c| [c, c]).collect() } else { hex.to_owned() };
        let channel = |at: usize| {
            let share = f64::from(u8::from_str_radix(&wide[at..at + 2], 16).unwrap()) / 255.0;
            if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(0) + 0.7152 * channel(2) + 0.0722 * channel(4)
    }

    fn contrast(a: &str, b: &str) -> f64 {
        let [a, b] = [luminance(a), luminance(b)];
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn lines_and_words_stand_out_by_night() {
        assert!((contrast("#fff", "#000") - 21.0).abs() < 1e-9);
        let night = |day: &str| BY_NIGHT.iter().find(|(of_day, _)| *of_day == day).unwrap().1;
        // WCAG 2.2: 4.5 for words, 1.4.3; 3 for graphics, 1.4.11. The inks are those of words, too.
        for (ink, (day, _)) in ALL.into_iter().zip(BY_NIGHT) {
            assert_eq!(ink.color(), day);
            assert!(contrast(night(day), night("#fff")) >= 4.5, "{ink:?}");
        }
        for words in ["#4a4f57", "#1f2328", "#3b4048"] {
            assert!(contrast(night(words), night("#fff")) >= 4.5, "{words}");
        }
    }

    #[test]
    fn every_color_of_a_figure_has_one_by_night() {
        for source in [
            include_str!("paint.rs"),
            include_str!("panel.rs"),
            include_str!("figure.rs"),
            include_str!("mark.rs"),
        ] {
            for color in source.split("\\\"#").skip(1).filter_map(|rest| rest.split('\\').next()) {
                assert!(BY_NIGHT.iter().any(|(day, _)| day[1..] == *color), "#{color}");
            }
        }
    }
}
