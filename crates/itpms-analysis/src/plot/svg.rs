//! SVG as text: numbers with two decimals at most, texts escaped.

use std::fmt::Write as _;

/// Text as XML and HTML text or attribute value.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(character),
        }
    }
    out
}

/// A coordinate: one decimal, no trailing zero, never `-0`.
pub(super) fn coordinate(value: f64) -> String {
    let tenths = (value * 10.0).round();
    if tenths == 0.0 || !tenths.is_finite() {
        return "0".to_owned();
    }
    let whole = (tenths / 10.0).trunc();
    if tenths == whole * 10.0 { format!("{whole}") } else { format!("{:.1}", tenths / 10.0) }
}

/// Where a text sits relative to its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

#[derive(Debug, Default)]
pub(super) struct Svg(String);

impl Svg {
    pub(super) fn raw(&mut self, text: impl std::fmt::Display) {
        // Writing to a string cannot fail.
        let _ = write!(self.0, "{text}");
    }

    pub(super) fn segment(&mut self, from: (f64, f64), to: (f64, f64), style: impl std::fmt::Display) {
        let [x1, y1, x2, y2] = [from.0, from.1, to.0, to.1].map(coordinate);
        self.raw(format_args!("<path d=\"M{x1} {y1}L{x2} {y2}\"{style}/>"));
    }

    pub(super) fn text(&mut self, at: (f64, f64), anchor: Anchor, style: impl std::fmt::Display, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let (x, y) = (coordinate(at.0), coordinate(at.1));
        self.raw(format_args!("<text x=\"{x}\" y=\"{y}\"{anchor}{style}>{}</text>", escape(text)));
    }

    pub(super) fn finish(self) -> String {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        assert_eq!([0.0, -0.04, 1.0, 12.34, -7.96].map(coordinate), ["0", "0", "1", "12.3", "-8"]);
        assert_eq!(coordinate(f64::NAN), "0");
    }

    #[test]
    fn texts_end_no_element() {
        assert_eq!(escape("a < b & \"c\""), "a &lt; b &amp; &quot;c&quot;");
    }
}
