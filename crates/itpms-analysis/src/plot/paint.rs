//! Marks as SVG, within a frame; what leaves the frame is cut off, and where a curve leaves it a small arrow says so.

use super::axis::Settled;
use super::ink::{Ink, Stroke};
use super::mark::Mark;
use super::svg::{Anchor, Svg, coordinate};
use super::text::width;
use super::thin::thin;

/// How far beyond the frame a point may be drawn, in frame heights: enough for the right slope at the edge.
const BEYOND: f64 = 4.0;
const LABEL_SIZE: f64 = 12.0;

/// Where the axes are in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) x: Settled,
    pub(super) y: Settled,
}

impl Frame {
    pub(super) fn at_x(&self, value: f64) -> f64 {
        self.left + self.width * self.x.place(value)
    }

    pub(super) fn at_y(&self, value: f64) -> f64 {
        self.top + self.height * (1.0 - self.y.place(value))
    }

    fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Within the nested picture that cuts off; far-away heights are brought near.
    fn inside(&self, x: f64, y: f64) -> (f64, f64) {
        let far = BEYOND * self.height;
        let height = self.at_y(y) - self.top;
        let height = if height.is_nan() { height } else { height.clamp(-far, self.height + far) };
        (self.at_x(x) - self.left, height)
    }
}

/// Draws in the order areas, lines, dots, words.
pub(super) fn paint(svg: &mut Svg, frame: &Frame, marks: &[Mark]) {
    let [x, y, w, h] = [frame.left, frame.top, frame.width, frame.height].map(coordinate);
    let open = |svg: &mut Svg| {
        svg.raw(format_args!("<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" overflow=\"hidden\">"));
    };
    open(svg);
    for mark in marks {
        match mark {
            Mark::Stretch { from, to, .. } => rectangle(svg, frame, *from, *to),
            Mark::Band { ink, edges, .. } => band(svg, frame, *ink, edges),
            Mark::Bars { ink, bars, .. } => bars_of(svg, frame, *ink, bars),
            _ => {}
        }
    }
    for mark in marks {
        match mark {
            Mark::Line { ink, stroke, points, .. } => line(svg, frame, *ink, *stroke, points),
            Mark::Level { ink, y, .. } => {
                let at = frame.at_y(*y) - frame.top;
                svg.segment((0.0, at), (frame.width, at), thin_dashes(*ink));
            }
            Mark::Moment { ink, x, .. } => {
                let at = frame.at_x(*x) - frame.left;
                svg.segment((at, 0.0), (at, frame.height), thin_dashes(*ink));
            }
            _ => {}
        }
    }
    svg.raw("</svg>");
    for mark in marks {
        match mark {
            Mark::Dots { ink, dots, .. } => dots_of(svg, frame, *ink, dots),
            Mark::Line { ink, points, .. } => exits(svg, frame, *ink, points),
            _ => {}
        }
    }
    words(svg, frame, marks);
}

fn thin_dashes(ink: Ink) -> String {
    format!(" stroke=\"{}\" stroke-width=\"1.2\" stroke-dasharray=\"4 3\"", ink.color())
}

fn rectangle(svg: &mut Svg, frame: &Frame, from: f64, to: f64) {
    let (left, right) = (frame.at_x(from) - frame.left, frame.at_x(to) - frame.left);
    let [x, w, h] = [left, right - left, frame.height].map(coordinate);
    svg.raw(format_args!("<rect x=\"{x}\" y=\"0\" width=\"{w}\" height=\"{h}\" fill=\"#eef0f3\"/>"));
}

fn band(svg: &mut Svg, frame: &Frame, ink: Ink, edges: &[(f64, f64, f64)]) {
    let finite = |edge: &(f64, f64, f64)| edge.0.is_finite() && edge.1.is_finite() && edge.2.is_finite();
    for piece in edges.split(|edge| !finite(edge)).filter(|piece| piece.len() > 1) {
        let side = |pick: fn(&(f64, f64, f64)) -> f64| {
            let points: Vec<_> = piece.iter().map(|edge| frame.inside(edge.0, pick(edge))).collect();
            thin(&points, 1.0)
        };
        let mut path = String::from("M");
        let back = side(|edge| edge.1);
        for (i, (x, y)) in side(|edge| edge.2).into_iter().chain(back.into_iter().rev()).enumerate() {
            if i > 0 {
                path.push('L');
            }
            path += &format!("{} {}", coordinate(x), coordinate(y));
        }
        svg.raw(format_args!("<path d=\"{path}Z\" fill=\"{}\" fill-opacity=\"0.2\"/>", ink.color()));
    }
}

fn bars_of(svg: &mut Svg, frame: &Frame, ink: Ink, bars: &[(f64, f64, f64)]) {
    for (from, to, height) in bars {
        let ((x0, y0), (x1, y1)) = (frame.inside(*from, *height), frame.inside(*to, 0.0));
        if !(x1 > x0 && y1 >= y0) {
            continue;
        }
        let [x, y, w, h] = [x0 + 0.4, y0, (x1 - x0 - 0.8).max(0.5), y1 - y0].map(coordinate);
        let color = ink.color();
        svg.raw(format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"{color}\" fill-opacity=\"0.35\"/>"
        ));
    }
}

fn line(svg: &mut Svg, frame: &Frame, ink: Ink, stroke: Stroke, points: &[(f64, f64)]) {
    let placed: Vec<_> = points.iter().map(|(x, y)| frame.inside(*x, *y)).collect();
    let mut path = String::new();
    let mut drawn = false;
    for (x, y) in thin(&placed, 1.0) {
        if !(x.is_finite() && y.is_finite() && x >= -frame.width && x <= 2.0 * frame.width) {
            drawn = false;
            continue;
        }
        path.push(if drawn { 'L' } else { 'M' });
        path += &format!("{} {}", coordinate(x), coordinate(y));
        drawn = true;
    }
    if path.is_empty() {
        return;
    }
    let (color, width, dashes) = (ink.color(), stroke.width(), stroke.dashes());
    svg.raw(format_args!(
        "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dashes}/>"
    ));
}

/// A small arrow at the edge where a curve first leaves the frame upwards, and downwards.
fn exits(svg: &mut Svg, frame: &Frame, ink: Ink, points: &[(f64, f64)]) {
    let seen = |x: f64| (0.0..=1.0).contains(&frame.x.place(x));
    for (edge, up) in [(frame.top, 1.0), (frame.bottom(), -1.0)] {
        let beyond = |y: f64| if up > 0.0 { frame.y.place(y) > 1.0 } else { frame.y.place(y) < 0.0 };
        let Some((x, _)) = points.iter().find(|(x, y)| seen(*x) && beyond(*y)) else { continue };
        let x = frame.at_x(*x).clamp(frame.left + 5.0, frame.left + frame.width - 5.0);
        let [a, b, c] = [x - 5.0, x + 5.0, x].map(coordinate);
        let [base, tip] = [edge + up, edge - up * 7.0].map(coordinate);
        svg.raw(format_args!("<path d=\"M{a} {base}L{b} {base}L{c} {tip}Z\" fill=\"{}\"/>", ink.color()));
    }
}

fn dots_of(svg: &mut Svg, frame: &Frame, ink: Ink, dots: &[(f64, f64, f64)]) {
    let color = ink.color();
    for (x, y, half) in dots {
        let place = (frame.x.place(*x), frame.y.place(*y));
        if !((-0.01..=1.01).contains(&place.0) && (-0.01..=1.01).contains(&place.1)) {
            continue;
        }
        let (at_x, at_y) = (frame.at_x(*x), frame.at_y(*y));
        if *half > 0.0 {
            let inside = |y: f64| y.clamp(frame.top, frame.bottom());
            let (high, low) = (inside(frame.at_y(y + half)), inside(frame.at_y(y - half)));
            let style = format!(" stroke=\"{color}\" stroke-width=\"1.4\"");
            svg.segment((at_x, high), (at_x, low), &style);
            svg.segment((at_x - 4.0, high), (at_x + 4.0, high), &style);
            svg.segment((at_x - 4.0, low), (at_x + 4.0, low), &style);
        }
        let (cx, cy) = (coordinate(at_x), coordinate(at_y));
        svg.raw(format_args!("<circle cx=\"{cx}\" cy=\"{cy}\" r=\"3.6\" fill=\"{color}\"/>"));
    }
}

/// The words that lines and stretches carry, on a light ground so that a curve below does not spoil them.
fn words(svg: &mut Svg, frame: &Frame, marks: &[Mark]) {
    let mut row = 0.0;
    for mark in marks {
        let (at, ink, word) = match mark {
            Mark::Level { ink, y, word } => {
                let at = frame.at_y(*y);
                let above = at - frame.top > 18.0;
                ((frame.left + frame.width - 3.0, if above { at - 5.0 } else { at + 14.0 }), *ink, word)
            }
            Mark::Moment { ink, x, word } => {
                row += 1.0;
                ((frame.at_x(*x) + 4.0, frame.top + 14.0 * row - 2.0), *ink, word)
            }
            Mark::Stretch { from, to, word } => {
                (((frame.at_x(*from) + frame.at_x(*to)) / 2.0, frame.top + 13.0), Ink::Muted, word)
            }
            _ => continue,
        };
        let anchor = match mark {
            Mark::Level { .. } => Anchor::End,
            Mark::Stretch { .. } => Anchor::Middle,
            _ if at.0 + width(word, LABEL_SIZE) > frame.left + frame.width => Anchor::End,
            _ => Anchor::Start,
        };
        let at = if matches!(mark, Mark::Moment { .. }) && anchor == Anchor::End {
            (at.0 - 8.0, at.1)
        } else {
            at
        };
        if word.is_empty() {
            continue;
        }
        let color = ink.color();
        let style = format!(
            " font-size=\"{LABEL_SIZE}\" fill=\"{color}\" stroke=\"#fff\" stroke-width=\"3\" stroke-linejoin=\"round\" \
             paint-order=\"stroke\""
        );
        svg.text(at, anchor, style, word);
    }
}
