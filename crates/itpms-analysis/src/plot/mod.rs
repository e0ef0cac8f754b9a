//! Figures as SVG: panels with axes, lines, bands, bars and points, drawn alike everywhere.
//!
//! Called by the paper's study and whoever shows a curve. Knows numbers and words, nothing of cars. The same data give the same bytes. A
//! picture scales to any width, loads nothing, and says its title and what it shows to a screen reader.
//!
//! | module | idea |
//! |---|---|
//! | `figure` | panels side by side with one legend; as one SVG, or as HTML whose panels stack on a phone |
//! | `panel` | one pair of axes and what is drawn within |
//! | `axis`, `ticks` | from values to places; round numbers along an axis |
//! | `mark` | what can be drawn |
//! | `paint` | marks as SVG |
//! | `ink` | colors that the color-blind can tell apart, and who has which |
//! | `thin` | as many points of a curve as can be seen |
//! | `svg`, `text` | the writer; how wide a text is |
//!
//! ```
//! use itpms_analysis::plot::{Axis, Figure, Ink, Panel, Stroke};
//!
//! let truth = vec![(0.0, 241.3), (20.0, 241.3), (22.5, 137.9), (40.0, 137.9)];
//! let panel = Panel::new("a", "Tire pressure", Axis::linear("Time", "s"), Axis::linear("Pressure", "kPa"))
//!     .line("truth", Ink::Truth, Stroke::Solid, truth);
//! let figure = Figure::new("figure-06", "A sudden loss of pressure").describe("Falls within 2.5 s.").panel(panel);
//! assert!(figure.svg().starts_with("<svg"));
//! ```

mod axis;
mod figure;
mod ink;
mod mark;
mod paint;
mod panel;
mod svg;
mod text;
mod thin;
mod ticks;

pub use axis::Axis;
pub use figure::Figure;
pub(crate) use ink::night_style;
pub use ink::{Ink, Stroke};
pub use panel::Panel;
pub use svg::escape;
