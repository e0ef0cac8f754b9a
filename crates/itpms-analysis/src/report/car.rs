//! The car from above: four tires, states shown by color, sign and word; the pressures are those of the cards around it. Drawn as SVG, so
//! that it is there without a script and on paper.
//!
//! Called by the page's writer where there are several corners, or wheel speeds alone.

use std::fmt::Write as _;

use itpms_core::model::Corner;

use super::words::{Status, corner_name};
use crate::plot::escape;

/// Middle of a tire, and where its word stands: x, y, and which end of the text.
struct Seat {
    tire: (f64, f64),
    text: (f64, f64),
    anchor: &'static str,
}

fn seat(corner: Corner) -> Seat {
    let (x, text_x, anchor) = match corner {
        Corner::FrontLeft | Corner::RearLeft => (28.0, 56.0, "start"),
        Corner::FrontRight | Corner::RearRight => (212.0, 184.0, "end"),
    };
    let y = match corner {
        Corner::FrontLeft | Corner::FrontRight => 98.0,
        Corner::RearLeft | Corner::RearRight => 304.0,
    };
    Seat { tire: (x, y), text: (text_x, y), anchor }
}

/// Outline, windows, mirrors and lights of a car that looks up the page.
const BODY: &str = "<path class=\"car-body\" d=\"M78 16 Q120 4 162 16 Q190 26 194 62 L198 150 L198 330 Q196 368 172 380 \
    Q120 394 68 380 Q44 368 42 330 L42 150 L46 62 Q50 26 78 16 Z\"/>\
    <path class=\"car-line\" d=\"M62 40 Q120 22 178 40\"/>\
    <path class=\"car-glass\" d=\"M64 166 Q120 140 176 166 L166 196 Q120 182 74 196 Z\"/>\
    <path class=\"car-glass\" d=\"M74 364 Q120 376 166 364 L160 347 Q120 355 80 347 Z\"/>\
    <path class=\"car-body\" d=\"M42 168 L28 174 L30 184 L42 184 Z M198 168 L212 174 L210 184 L198 184 Z\"/>";

#[derive(Debug, Clone, Copy)]
pub(super) struct Tire {
    pub(super) status: Status,
    pub(super) word: &'static str,
}

/// The picture; its words are those of the cards beside it. `says`: what it shows, without a full stop. Of a wheel without data there is `None`.
pub(super) fn drawing(says: &str, tires: &[Option<Tire>; 4]) -> String {
    let mut out = format!(
        "<svg class=\"car\" viewBox=\"0 0 240 400\" role=\"img\" aria-label=\"The car from above. {}.\">{BODY}\
         <text class=\"car-front\" x=\"120\" y=\"34\" text-anchor=\"middle\">front</text>",
        escape(says)
    );
    for (corner, shown) in Corner::ALL.into_iter().zip(tires) {
        let seat = seat(corner);
        match shown {
            Some(shown) => tire(&mut out, &seat, corner, shown),
            None => absent(&mut out, &seat, corner),
        }
    }
    out.push_str("</svg>\n");
    out
}

fn tire(out: &mut String, seat: &Seat, corner: Corner, &Tire { status, word }: &Tire) {
    let ((x, y), (text_x, text_y)) = (seat.tire, seat.text);
    let _ = write!(
        out,
        "<g class=\"tire {class}\"><title>{title}</title><rect x=\"{left}\" y=\"{top}\" width=\"34\" height=\"78\" rx=\"10\"/>\
         <g transform=\"translate({x} {y})\">{sign}</g>\
         <text class=\"tire-word\" x=\"{text_x}\" y=\"{text_y}\" text-anchor=\"{anchor}\">{word}</text></g>",
        class = status.class(),
        title = corner_name(corner),
        left = x - 17.0,
        top = y - 39.0,
        sign = sign(status),
        anchor = seat.anchor,
    );
}

fn absent(out: &mut String, seat: &Seat, corner: Corner) {
    let ((x, y), (text_x, text_y)) = (seat.tire, seat.text);
    let _ = write!(
        out,
        "<g class=\"tire absent\"><title>{}</title><rect x=\"{}\" y=\"{}\" width=\"34\" height=\"78\" rx=\"10\"/>\
         <text class=\"tire-spread\" x=\"{text_x}\" y=\"{text_y}\" text-anchor=\"{}\">no data</text></g>",
        corner_name(corner),
        x - 17.0,
        y - 39.0,
        seat.anchor,
    );
}

/// A sign about the origin, its shape different for every state.
fn sign(status: Status) -> &'static str {
    match status {
        Status::Low => {
            "<path class=\"sign\" d=\"M0 -13 L13 10 L-13 10 Z\"/><path class=\"mark\" d=\"M0 -5 V3 M0 6.4 V6.6\"/>"
        }
        Status::Malfunction => {
            "<path class=\"sign\" d=\"M0 -14 L14 0 L0 14 L-14 0 Z\"/><path class=\"mark\" d=\"M-4 -4 L4 4 M4 -4 L-4 4\"/>"
        }
        Status::Over => "<path class=\"sign\" d=\"M0 -14 L12 0 H6 V12 H-6 V0 H-12 Z\"/>",
        Status::Uncertain | Status::Unknown => {
            "<rect class=\"sign\" x=\"-11\" y=\"-11\" width=\"22\" height=\"22\" rx=\"4\"/>\
             <path class=\"mark\" d=\"M-3.6 -3.4 Q-3.2 -7 0.4 -7 Q4 -6.6 3.6 -3.2 Q3.2 -1 0 0.6 V2.4 M0 6 V6.2\"/>"
        }
        Status::Fine => {
            "<circle class=\"sign\" r=\"12\"/><path class=\"mark\" d=\"M-5 0.5 L-1.5 4 L5.5 -4\"/>"
        }
    }
}
