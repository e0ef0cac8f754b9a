//! From the numbers of an OpenCRG file to heights: the modifiers applied, the reference line's own height integrated,
//! holes left or filled as the file asks.
//!
//! Called by the reader last. The height at `u` along and `v` beside the reference line (left is positive) is
//! `z(u, v) = z_ref(u) + banking(u) v + grid(u, v)`, where `z_ref` rises by `slope(u_i)` times the increment from the row
//! before to row `i`. Where the line goes in the plane, and modifiers that move the road in the plane (`refline_*`,
//! `refpoint_*`, `scale_curvature`), change no height along it and are not used.

use itpms_files::Place;

use crate::channels::{Channel, Layout};
use crate::error::CrgProblem;
use crate::header::{Header, Numbers};

/// What becomes of a missing height (`grid_nan_mode`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Missing {
    /// It stays missing: 0, and where the file says nothing.
    Keep,
    /// Level with the reference line: 1.
    Zero,
    /// As its neighbor in the cross section: 2.
    Neighbor,
}

/// The factors and fillings of `$ROAD_CRG_MODS`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Modifiers {
    grid: f64,
    slope: f64,
    banking: f64,
    length: f64,
    width: f64,
    missing: Missing,
    missing_offset_m: f64,
    /// Whether the height at the reference line's end still holds.
    keeps_end: bool,
}

impl Modifiers {
    fn new(numbers: Option<&Numbers>) -> Result<Self, CrgProblem> {
        let none = Numbers::default();
        let numbers = numbers.unwrap_or(&none);
        let positive = |key| {
            let found = numbers.within(key, "a positive number", |k| k > 0.0)?;
            Ok::<f64, CrgProblem>(found.unwrap_or(1.0))
        };
        let mode = numbers.within("grid_nan_mode", "0, 1 or 2", |mode| [0.0, 1.0, 2.0].contains(&mode))?;
        Ok(Self {
            grid: numbers.or("scale_z_grid", 1.0),
            slope: numbers.or("scale_slope", 1.0),
            banking: numbers.or("scale_banking", 1.0),
            length: positive("scale_length")?,
            width: positive("scale_width")?,
            missing: match mode {
                Some(1.0) => Missing::Zero,
                Some(2.0) => Missing::Neighbor,
                _ => Missing::Keep,
            },
            missing_offset_m: numbers.or("grid_nan_offset", 0.0),
            keeps_end: numbers.get("scale_slope").is_none() && numbers.get("scale_length").is_none(),
        })
    }
}

/// Heights over a grid that follows the road.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Surface {
    pub(crate) start_m: f64,
    pub(crate) increment_m: f64,
    /// Lateral positions of the long sections in m, increasing to the left.
    pub(crate) v_m: Vec<f64>,
    /// Row by row, from right to left; NaN is missing.
    pub(crate) grid_m: Vec<f64>,
    pub(crate) line_m: Vec<f64>,
    pub(crate) banking: Vec<f64>,
    /// Cells without a height in the file.
    pub(crate) missing: usize,
}

impl Surface {
    /// From `rows` times as many values as there are channels.
    pub(crate) fn new(header: &Header, layout: &Layout, values: &[f64]) -> Result<Self, CrgProblem> {
        let modifiers = Modifiers::new(header.modifiers.as_ref())?;
        let road = &header.road;
        let channels = layout.channels.len();
        let increment_m = increment_m(road)? * modifiers.length;
        let grid_m = grid(layout, values, modifiers.grid)?;
        let missing = grid_m.iter().filter(|z| z.is_nan()).count();
        let column = |wanted: Channel, from: usize| -> Result<Option<Vec<f64>>, CrgProblem> {
            let Some(place) = layout.channels.iter().position(|c| *c == wanted) else { return Ok(None) };
            let found: Vec<f64> = values.iter().skip(place).step_by(channels).copied().collect();
            match found.iter().enumerate().skip(from).find(|(_, value)| !value.is_finite()) {
                Some((row, value)) => Err(CrgProblem::NotFinite {
                    place: Place::Row(row as u64 + 1),
                    channel: layout.names[place].clone(),
                    found: *value,
                }),
                None => Ok(Some(found)),
            }
        };
        let rows = values.len() / channels;
        let start_b = modifiers.banking * road.or("reference_line_start_b", 0.0);
        let banking = column(Channel::Banking, 0)?
            .map_or_else(|| vec![start_b; rows], |b| b.iter().map(|b| b * modifiers.banking).collect());
        let line_m = match column(Channel::Elevation, 0)? {
            Some(line_m) => line_m,
            None => {
                let start_s = road.or("reference_line_start_s", 0.0);
                // The first row has no row before it: its slope is unused and may be missing.
                let slope = column(Channel::Slope, 1)?.unwrap_or_else(|| vec![start_s; rows]);
                line_heights(road, &slope, &modifiers, increment_m)
            }
        };
        let v_m = layout.v_m.iter().map(|v| v * modifiers.width).collect();
        let start_m = road.or("reference_line_start_u", 0.0);
        let mut surface = Self { start_m, increment_m, v_m, grid_m, line_m, banking, missing };
        surface.fill(&modifiers);
        Ok(surface)
    }

    /// Puts something into missing cells where the file asks for it.
    fn fill(&mut self, modifiers: &Modifiers) {
        let offset = modifiers.missing_offset_m;
        for section in self.grid_m.chunks_exact_mut(self.v_m.len()) {
            match modifiers.missing {
                Missing::Keep => {}
                Missing::Zero => section.iter_mut().filter(|z| z.is_nan()).for_each(|z| *z = offset),
                Missing::Neighbor => fill_from_neighbors(section, offset),
            }
        }
    }

    /// Height in m at row `row` and between long sections `right` and `right + 1`, `share` of the way to the left one.
    pub(crate) fn height_m(&self, row: usize, right: usize, share: f64, v_m: f64) -> f64 {
        let section = &self.grid_m[row * self.v_m.len()..];
        let grid = match share {
            0.0 => section[right],
            1.0 => section[right + 1],
            _ => (1.0 - share) * section[right] + share * section[right + 1],
        };
        self.line_m[row] + self.banking[row] * v_m + grid
    }
}

/// Distance from row to row in m; 0.01 is the standard's default.
pub(crate) fn increment_m(road: &Numbers) -> Result<f64, CrgProblem> {
    let found = road.within("reference_line_increment", "a positive number", |step| step > 0.0)?;
    Ok(found.unwrap_or(0.01))
}

/// The heights of the long sections from right to left, row by row.
fn grid(layout: &Layout, values: &[f64], factor: f64) -> Result<Vec<f64>, CrgProblem> {
    let mut columns = vec![0; layout.v_m.len()];
    for (column, channel) in layout.channels.iter().enumerate() {
        if let Channel::LongSection(i) = channel {
            columns[*i] = column;
        }
    }
    let mut grid = Vec::with_capacity(values.len());
    for (row, values) in values.chunks_exact(layout.channels.len()).enumerate() {
        for column in &columns {
            let value = values[*column];
            if value.is_infinite() {
                let place = Place::Row(row as u64 + 1);
                let channel = layout.names[*column].clone();
                return Err(CrgProblem::NotFinite { place, channel, found: value });
            }
            grid.push(value * factor);
        }
    }
    Ok(grid)
}

/// The reference line's height in every row. A height at its end that the slopes do not meet is met by a constant slope
/// more, which is no roughness.
fn line_heights(road: &Numbers, slope: &[f64], modifiers: &Modifiers, increment_m: f64) -> Vec<f64> {
    let start = road.or("reference_line_start_z", 0.0);
    let mut height = start;
    let mut line: Vec<f64> = Vec::with_capacity(slope.len());
    for (row, slope) in slope.iter().enumerate() {
        if row > 0 {
            height += modifiers.slope * slope * increment_m;
        }
        line.push(height);
    }
    if let Some(end) = road.get("reference_line_end_z").filter(|_| modifiers.keeps_end)
        && line.len() > 1
    {
        let per_row = (end - height) / (line.len() - 1) as f64;
        line.iter_mut().enumerate().for_each(|(row, z)| *z += per_row * row as f64);
    }
    line
}

/// A missing cell becomes the next one to its right, or, where all to its right are missing, the next one to its left;
/// the first cell of such a run adds the offset.
fn fill_from_neighbors(section: &mut [f64], offset: f64) {
    let (mut last, mut in_a_run) = (f64::NAN, false);
    for z in section.iter_mut() {
        if z.is_nan() {
            *z = if in_a_run { last } else { last + offset };
            in_a_run = !z.is_nan();
        } else {
            in_a_run = false;
        }
        last = *z;
    }
    let first = section.iter().position(|z| !z.is_nan()).unwrap_or(0);
    let edge = section.get(first).copied().unwrap_or(f64::NAN) + offset;
    section[..first].fill(edge);
}
