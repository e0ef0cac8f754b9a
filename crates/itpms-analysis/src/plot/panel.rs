//! One pair of axes and what is drawn within. Filled by whoever has data; a [`super::Figure`] shows it.

use super::axis::{Axis, Settled};
use super::ink::{Ink, Stroke};
use super::mark::{Mark, Points};
use super::paint::{Frame, paint};
use super::svg::{Anchor, Svg, coordinate};
use super::text::width;

/// Width of a panel, in units that are pixels when it is shown at its natural size.
pub(super) const WIDTH: f64 = 430.0;
const HEIGHT: f64 = 290.0;
/// Sizes of letters: title, everything else.
pub(super) const TITLE_SIZE: f64 = 15.5;
pub(super) const SIZE: f64 = 14.0;
/// Room above the axes: title, label of the vertical axis, a gap.
const TOP: f64 = 47.0;
/// Room below: numbers and label.
const BOTTOM: f64 = 44.0;
const RIGHT: f64 = 14.0;

#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    letter: String,
    title: String,
    x: Axis,
    y: Axis,
    height: f64,
    pub(super) marks: Vec<Mark>,
}

impl Panel {
    /// An empty panel. `letter` is what texts call it (`a`, `b`; empty when it is alone), `title` what it shows.
    pub fn new(letter: impl Into<String>, title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { letter: letter.into(), title: title.into(), x, y, height: HEIGHT, marks: vec![] }
    }

    /// Another height than the usual 290, for a width of 430.
    pub fn height(self, height: f64) -> Self {
        Self { height, ..self }
    }

    fn with(mut self, mark: Mark) -> Self {
        self.marks.push(mark);
        self
    }

    /// A curve through (x, y), broken where a value is not finite. An empty name keeps it out of the legend.
    pub fn line(self, name: impl Into<String>, ink: Ink, stroke: Stroke, points: Points) -> Self {
        self.with(Mark::Line { name: name.into(), ink, stroke, points })
    }

    /// The area between (x, low, high).
    pub fn band(self, name: impl Into<String>, ink: Ink, edges: Vec<(f64, f64, f64)>) -> Self {
        self.with(Mark::Band { name: name.into(), ink, edges })
    }

    /// Bars of (left, right, height), as of a histogram.
    pub fn bars(self, name: impl Into<String>, ink: Ink, bars: Vec<(f64, f64, f64)>) -> Self {
        self.with(Mark::Bars { name: name.into(), ink, bars })
    }

    /// Points at (x, y) with error bars of y ± the third; 0 for none.
    pub fn dots(self, name: impl Into<String>, ink: Ink, dots: Vec<(f64, f64, f64)>) -> Self {
        self.with(Mark::Dots { name: name.into(), ink, dots })
    }

    /// A horizontal line with a word on it.
    pub fn level(self, ink: Ink, y: f64, word: impl Into<String>) -> Self {
        self.with(Mark::Level { ink, y, word: word.into() })
    }

    /// A vertical line with a word beside its top.
    pub fn moment(self, ink: Ink, x: f64, word: impl Into<String>) -> Self {
        self.with(Mark::Moment { ink, x, word: word.into() })
    }

    /// A shaded stretch of x with a word at its top.
    pub fn stretch(self, from: f64, to: f64, word: impl Into<String>) -> Self {
        self.with(Mark::Stretch { from, to, word: word.into() })
    }

    pub(super) fn size(&self) -> (f64, f64) {
        (WIDTH, self.height)
    }

    /// Text for a screen reader.
    pub(super) fn spoken(&self) -> String {
        let name = if self.letter.is_empty() { String::new() } else { format!("({}) ", self.letter) };
        format!("{name}{}: {} over {}", self.title, self.y.caption(), self.x.caption())
    }

    fn axes(&self) -> (Settled, Settled) {
        let x = self.x.settled(self.marks.iter().flat_map(Mark::xs), 0.0);
        let seen = |value: f64| (0.0..=1.0).contains(&x.place(value));
        let y = self.y.settled(self.marks.iter().flat_map(|mark| mark.ys(seen)), 0.06);
        (x, y)
    }

    /// The panel's content, without the `svg` element around it.
    pub(super) fn content(&self) -> String {
        let (x, y) = self.axes();
        let y_ticks = y.ticks((self.height / 55.0) as usize);
        let widest = y_ticks.labelled.iter().map(|(_, word)| width(word, SIZE)).fold(0.0, f64::max);
        let left = (widest + 16.0).clamp(30.0, 0.5 * WIDTH);
        let frame =
            Frame { left, top: TOP, width: WIDTH - left - RIGHT, height: self.height - TOP - BOTTOM, x, y };
        let mut svg = Svg::default();
        self.heading(&mut svg);
        let bottom = frame.top + frame.height;
        for value in &y_ticks.minor {
            let at = frame.at_y(*value);
            svg.segment((left - 3.0, at), (left, at), " stroke=\"#9aa1ab\"");
        }
        for (value, word) in &y_ticks.labelled {
            let at = frame.at_y(*value);
            svg.segment((left, at), (left + frame.width, at), " stroke=\"#e3e6ea\"");
            svg.text((left - 7.0, at + 4.7), Anchor::End, "", word);
        }
        self.feet(&mut svg, &frame, bottom);
        paint(&mut svg, &frame, &self.marks);
        svg.segment((left, bottom), (left + frame.width, bottom), " stroke=\"#3b4048\" stroke-width=\"1.2\"");
        svg.finish()
    }

    fn heading(&self, svg: &mut Svg) {
        let mut head = |at_x: f64, weight: u32, text: &str| {
            let style = format!(" font-size=\"{TITLE_SIZE}\" font-weight=\"{weight}\"");
            svg.text((at_x, 16.0), Anchor::Start, style, text);
        };
        let mut start = 0.0;
        if !self.letter.is_empty() {
            head(0.0, 700, &self.letter);
            start = width(&self.letter, TITLE_SIZE) + 9.0;
        }
        head(start, 600, &self.title);
        svg.text((0.0, 36.0), Anchor::Start, " fill=\"#4a4f57\"", &self.y.caption());
    }

    /// Numbers and label below.
    fn feet(&self, svg: &mut Svg, frame: &Frame, bottom: f64) {
        let ticks = frame.x.ticks(6);
        for value in &ticks.minor {
            let at = frame.at_x(*value);
            svg.segment((at, bottom), (at, bottom + 3.0), " stroke=\"#9aa1ab\"");
        }
        for (value, word) in &ticks.labelled {
            let at = frame.at_x(*value);
            svg.segment((at, bottom), (at, bottom + 5.0), " stroke=\"#3b4048\"");
            // A number at the very end stays inside the picture.
            let half = 0.5 * width(word, SIZE);
            svg.text((at.min(WIDTH - half - 1.0), bottom + 19.0), Anchor::Middle, "", word);
        }
        let middle = frame.left + 0.5 * frame.width;
        svg.text((middle, self.height - 6.0), Anchor::Middle, " fill=\"#4a4f57\"", &self.x.caption());
    }

    pub(super) fn svg(&self) -> String {
        let (width, height) = self.size();
        let mut svg = Svg::default();
        svg.raw(opening(width, height, &self.spoken(), ""));
        svg.raw(self.content());
        svg.raw("</svg>");
        svg.finish()
    }
}

/// The first tag of a picture, with its title and description.
pub(super) fn opening(width: f64, height: f64, title: &str, description: &str) -> String {
    let font = super::text::FONT;
    let (w, h) = (coordinate(width), coordinate(height));
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" role=\"img\" font-family=\"{font}\" \
         font-size=\"{SIZE}\" fill=\"#1f2328\"><title>{}</title>",
        super::escape(title)
    );
    if !description.is_empty() {
        text += &format!("<desc>{}</desc>", super::escape(description));
    }
    text
}
