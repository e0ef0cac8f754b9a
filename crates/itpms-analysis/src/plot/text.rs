//! How wide a text will be, near enough to place it. The font is the reader's; widths are those of Helvetica.

/// Fonts that every system has, or has a likeness of.
pub(super) const FONT: &str = "Helvetica,Arial,'Liberation Sans',sans-serif";

/// About the width of a text in a font of `size`.
pub(super) fn width(text: &str, size: f64) -> f64 {
    size * text.chars().map(share).sum::<f64>()
}

/// Width of a character in ems.
fn share(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | '\'' | '|' => 0.22,
        'f' | 't' | 'I' | '.' | ',' | ':' | ';' | '!' | '/' | ' ' | '\u{2009}' | '\u{a0}' => 0.28,
        '(' | ')' | '-' | 'r' | '[' | ']' | '·' => 0.33,
        '⁰'..='⁹' | '¹' | '²' | '³' | '⁻' => 0.35,
        'c' | 'k' | 's' | 'v' | 'x' | 'y' | 'z' | 'J' => 0.5,
        'm' | 'M' | '%' | '@' => 0.85,
        'w' => 0.72,
        'W' => 0.94,
        'A'..='Z' => 0.7,
        _ => 0.56,
    }
}
