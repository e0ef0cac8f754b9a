#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | idea |
//! |---|---|
//! | `header` | the clear-text header: sections, names, values |
//! | `channels` | what the columns mean, where the long sections lie |
//! | `payload` | the numbers |
//! | `surface` | modifiers, the reference line's height, holes |
//! | `error` | what can be wrong |
#![forbid(unsafe_code)]

mod channels;
mod error;
mod header;
mod payload;
mod surface;

pub use error::{CrgError, CrgProblem};

use std::path::Path;

use itpms_files::input;

use channels::Layout;
use header::Header;
use surface::Surface;

/// Files are read into memory, and a text of four characters may become a number of eight bytes.
const LARGEST: u64 = 1 << 30;

/// A road surface.
///
/// Cells without a height stay missing (NaN) unless the file itself asks for something else (`grid_nan_mode`). The reference implementation
/// fills them from their neighbors where a file says nothing; a roughness computed from such heights would be made up.
#[derive(Debug, Clone, PartialEq)]
pub struct CrgRoad {
    surface: Surface,
}

/// A line along the road that its surface does not cover.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "{v_m} m beside the reference line is outside of the road, which has heights from {right_m} to {left_m} m"
)]
pub struct OutsideRoad {
    /// The position asked for in m.
    pub v_m: f64,
    /// Right edge in m.
    pub right_m: f64,
    /// Left edge in m.
    pub left_m: f64,
}

impl CrgRoad {
    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read, is larger than 1 GiB, or is no complete OpenCRG file; the message names the line or row.
    pub fn read(path: &Path) -> Result<Self, CrgError> {
        let check = |beginning: &[u8]| match Header::ends_in(beginning) {
            true => Ok(()),
            false => Err(CrgProblem::NoData),
        };
        input::read_after(path, LARGEST, "an OpenCRG file", check)
            .and_then(|bytes| Self::from_bytes(&bytes))
            .map_err(|problem| CrgError { path: path.to_owned(), problem: Box::new(problem) })
    }

    /// The same for a file's contents.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CrgProblem> {
        let header = Header::read(bytes)?;
        let layout = Layout::new(&header)?;
        let increment_m = surface::increment_m(&header.road)?;
        let start_m = header.road.or("reference_line_start_u", 0.0);
        let end_m = header.road.get("reference_line_end_u");
        let wrong_length = |found: usize, expected: usize| CrgProblem::Length {
            found,
            expected,
            start_m,
            end_m: end_m.unwrap_or(f64::NAN),
            increment_m,
        };
        // As a float it goes nowhere near its limits before it is compared with the data.
        let expected = end_m
            .map(|end_m| ((end_m - start_m) / increment_m).round().max(0.0) as usize)
            .map(|steps| steps.saturating_add(1));
        let values = payload::read(bytes, &header, &layout, expected).map_err(|problem| match problem {
            CrgProblem::Length { found, expected, .. } => wrong_length(found, expected),
            other => other,
        })?;
        let rows = values.len() / layout.channels.len();
        if rows != expected.unwrap_or(rows) || rows < 2 {
            return Err(wrong_length(rows, expected.unwrap_or(2)));
        }
        Ok(Self { surface: Surface::new(&header, &layout, &values)? })
    }

    /// Position of the first row along the reference line in m.
    #[must_use]
    pub fn start_m(&self) -> f64 {
        self.surface.start_m
    }

    /// Distance from row to row in m.
    #[must_use]
    pub fn increment_m(&self) -> f64 {
        self.surface.increment_m
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.surface.line_m.len()
    }

    /// Lateral positions of the long sections in m, from right to left; left is positive.
    #[must_use]
    pub fn lateral_m(&self) -> &[f64] {
        &self.surface.v_m
    }

    /// Cells for which the file has no height.
    #[must_use]
    pub fn missing_cells(&self) -> usize {
        self.surface.missing
    }

    /// Heights in m of a line along the road, `v_m` m to the left of the reference line, one per row; straight between
    /// long sections. NaN where a cell it needs is missing.
    pub fn line_m(&self, v_m: f64) -> Result<Vec<f64>, OutsideRoad> {
        let v = &self.surface.v_m;
        let (right_m, left_m) = (v[0], v[v.len() - 1]);
        // A hair's breadth, for positions that were added up.
        let slack = 1e-9 * (left_m - right_m);
        if !(v_m >= right_m - slack && v_m <= left_m + slack) {
            return Err(OutsideRoad { v_m, right_m, left_m });
        }
        let right = v.partition_point(|at| *at <= v_m).clamp(1, v.len() - 1) - 1;
        let exact = (v_m - v[right]) / (v[right + 1] - v[right]);
        let near = |end: f64| (exact - end).abs() < 1e-6;
        let share = if near(0.0) {
            0.0
        } else if near(1.0) {
            1.0
        } else {
            exact
        };
        let height = |row| self.surface.height_m(row, right, share, v_m);
        // Numbers near a float's limits are no heights either.
        Ok((0..self.rows()).map(height).map(|z| if z.is_finite() { z } else { f64::NAN }).collect())
    }
}
