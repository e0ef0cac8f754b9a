//! Even heights from a profile at any distances, for the golden car and the spectrum.
//!
//! Called by the roughness command. Small holes are bridged and counted, larger ones stay.

use thiserror::Error;

use super::cells::Cells;
use super::survey::Sampling;

/// Steps that differ from the usual one by less than this share are even.
const EVEN: f64 = 0.02;
/// Profiles that are finer than this, in m, and not even become means over cells of it.
const CELL_M: f64 = 0.05;
/// Holes up to this long, in m, are bridged: the moving average of the standard is as long.
const BRIDGED_M: f64 = 0.25;
/// An uneven profile has a hole where a step is this many times the usual one, and at least [`BRIDGED_M`].
const HOLE: f64 = 4.0;

/// Heights that the gaps of a profile may leave missing in all: no leap in distance is a reason to fill the memory.
const MOST_MISSING: f64 = 1e7;

/// Profiles that cannot be made even.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum EvenError {
    #[error("found {0} points, expected 2 or more")]
    Points(usize),
    #[error(
        "gaps leave {missing:.0} heights missing, {spacing_m:.2} m apart (the longest from {from_m} to {to_m} m), \
         expected {most} or fewer",
        most = MOST_MISSING
    )]
    Gaps { missing: f64, spacing_m: f64, from_m: f64, to_m: f64 },
}

#[derive(Debug, Clone, PartialEq)]
pub struct EvenProfile {
    /// Where the first height is, in m.
    pub start_m: f64,
    pub spacing_m: f64,
    /// Heights in m; NaN is missing.
    pub heights_m: Vec<f64>,
    pub sampling: Sampling,
    /// Heights that were missing and are bridged.
    pub bridged: usize,
}

impl EvenProfile {
    pub fn of_even(start_m: f64, spacing_m: f64, heights_m: Vec<f64>) -> Self {
        let mut even = Self { start_m, spacing_m, heights_m, sampling: Sampling::Points, bridged: 0 };
        even.bridge();
        even
    }

    /// From heights at increasing distances: taken as they are where the steps are even, else read between the points
    /// at their usual distance, or, where that is less than 5 cm, averaged over 5 cm.
    pub fn new(distance_m: &[f64], height_m: &[f64]) -> Result<Self, EvenError> {
        let mut steps: Vec<f64> = distance_m.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let median_m = *steps.get(steps.len() / 2).ok_or(EvenError::Points(distance_m.len()))?;
        // Stations that were rounded make steps that were, too; their mean is hardly touched by it.
        let like = |step: &&f64| (*step - median_m).abs() <= EVEN * median_m;
        let (count, sum) =
            steps.iter().filter(like).fold((0.0, 0.0), |(count, sum), step| (count + 1.0, sum + step));
        let usual_m = sum / count;
        let (start_m, end_m) = (distance_m[0], distance_m[distance_m.len() - 1]);
        let even = steps.iter().all(|step| {
            let whole = (step / usual_m).round().max(1.0);
            (step - whole * usual_m).abs() < EVEN * usual_m
        });
        let (spacing_m, sampling) = if !even && usual_m < CELL_M {
            (CELL_M, Sampling::CellMeans)
        } else {
            (usual_m, Sampling::Points)
        };
        count_missing(distance_m, spacing_m)?;
        if even {
            // The usual step is a difference of rounded numbers; the whole length is rounded once.
            let spacing_m = (end_m - start_m) / ((end_m - start_m) / usual_m).round();
            let mut heights_m = Vec::with_capacity(height_m.len());
            for (x, z) in distance_m.iter().zip(height_m) {
                let place = ((x - start_m) / spacing_m).round() as usize;
                heights_m.resize(place, f64::NAN);
                heights_m.push(*z);
            }
            return Ok(Self::of_even(start_m, spacing_m, heights_m));
        }
        let hole_m = (HOLE * usual_m).max(BRIDGED_M);
        let heights_m = match sampling {
            Sampling::CellMeans => cell_means(distance_m, height_m, hole_m),
            Sampling::Points => between(distance_m, height_m, spacing_m, hole_m),
        };
        let mut profile = Self { start_m, spacing_m, heights_m, sampling, bridged: 0 };
        profile.bridge();
        Ok(profile)
    }

    fn bridge(&mut self) {
        let longest = (BRIDGED_M / self.spacing_m + 1e-9) as usize;
        let mut last: Option<usize> = None;
        for i in 0..self.heights_m.len() {
            if !self.heights_m[i].is_finite() {
                continue;
            }
            if let Some(last) = last.filter(|last| (1..=longest).contains(&(i - last - 1))) {
                let (from, to) = (self.heights_m[last], self.heights_m[i]);
                for k in last + 1..i {
                    let share = (k - last) as f64 / (i - last) as f64;
                    self.heights_m[k] = from + share * (to - from);
                    self.bridged += 1;
                }
            }
            last = Some(i);
        }
    }
}

/// Refuses gaps that would take too many heights to fill, before they are filled.
fn count_missing(distance_m: &[f64], spacing_m: f64) -> Result<(), EvenError> {
    let (mut missing, mut longest) = (0.0, (0.0, 0.0));
    for pair in distance_m.windows(2) {
        let (from_m, to_m) = (pair[0], pair[1]);
        let more = ((to_m - from_m) / spacing_m).round() - 1.0;
        if !(more <= 0.0) {
            missing += more;
        }
        if to_m - from_m > longest.1 - longest.0 {
            longest = (from_m, to_m);
        }
    }
    if !(missing <= MOST_MISSING) {
        let (from_m, to_m) = longest;
        return Err(EvenError::Gaps { missing, spacing_m, from_m, to_m });
    }
    Ok(())
}

fn cell_means(distance_m: &[f64], height_m: &[f64], hole_m: f64) -> Vec<f64> {
    let mut cells = Cells::new(CELL_M);
    let mut means = Vec::new();
    for (x, z) in distance_m.iter().zip(height_m) {
        let hole = cells.last_m().is_some_and(|last_m| x - last_m > hole_m);
        if hole {
            cells.restart();
            let place = ((x - distance_m[0]) / CELL_M).round() as usize;
            means.resize(place.max(means.len()), f64::NAN);
        }
        cells.push(*x, [*z], |[mean]| means.push(mean));
    }
    means
}

fn between(distance_m: &[f64], height_m: &[f64], spacing_m: f64, hole_m: f64) -> Vec<f64> {
    let start_m = distance_m[0];
    let mut heights = vec![height_m[0]];
    for i in 1..distance_m.len() {
        let (from, to) = (distance_m[i - 1], distance_m[i]);
        let missing = to - from > hole_m;
        loop {
            let at = start_m + heights.len() as f64 * spacing_m;
            if !(at <= to + 1e-9 * spacing_m) {
                break;
            }
            let share = (at - from) / (to - from);
            let height = height_m[i - 1] + share * (height_m[i] - height_m[i - 1]);
            heights.push(if missing { f64::NAN } else { height });
        }
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_steps_are_taken_as_they_are() {
        let x: Vec<f64> = (0..200).map(|i| (478.0 + 0.1 * f64::from(i)) as f32 as f64).collect();
        let z: Vec<f64> = (0..200).map(f64::from).collect();
        let even = EvenProfile::new(&x, &z).unwrap();
        assert!((even.spacing_m - 0.1).abs() < 1e-6 && even.sampling == Sampling::Points);
        assert_eq!((even.heights_m, even.bridged), (z, 0));
    }

    #[test]
    fn stations_that_were_rounded_are_no_holes() {
        for step in [1.0 / 3.0, 0.1524, 0.0254] {
            let x: Vec<f64> = (0..12_000).map(|i| (1000.0 * step * f64::from(i)).round() / 1000.0).collect();
            let even = EvenProfile::new(&x, &x).unwrap();
            assert_eq!(
                (even.bridged, even.heights_m.iter().filter(|z| z.is_nan()).count()),
                (0, 0),
                "{step}"
            );
            if even.sampling == Sampling::Points {
                assert_eq!(even.heights_m.len(), 12_000, "{step}");
            }
        }
    }

    #[test]
    fn small_holes_are_bridged_and_large_ones_stay() {
        let mut x: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i)).collect();
        let mut z: Vec<f64> = (0..100).map(f64::from).collect();
        (z[10], z[11]) = (f64::NAN, f64::NAN);
        (x, z) = (
            x[..50].iter().chain(&x[60..]).copied().collect(),
            z[..50].iter().chain(&z[60..]).copied().collect(),
        );
        let even = EvenProfile::new(&x, &z).unwrap();
        assert_eq!((even.heights_m.len(), even.bridged), (100, 2));
        assert!((even.heights_m[11] - 11.0).abs() < 1e-9);
        assert!(even.heights_m[50..60].iter().all(|z| z.is_nan()) && even.heights_m[60] == 60.0);
    }

    #[test]
    fn uneven_steps_are_read_between_or_averaged() {
        let mut at = 0.0;
        for scale in [0.2, 0.01] {
            let x: Vec<f64> = (0..4000)
                .map(|i| {
                    at += scale * if i % 3 == 0 { 0.5 } else { 1.25 };
                    at
                })
                .collect();
            // A straight line is read exactly between its points, and its mean over a cell is its middle.
            let z: Vec<f64> = x.iter().map(|x| 3.0 * x).collect();
            let even = EvenProfile::new(&x, &z).unwrap();
            assert!((even.spacing_m - if scale > 0.1 { 0.25 } else { 0.05 }).abs() < 1e-9);
            let middle = if even.sampling == Sampling::CellMeans { 0.5 } else { 0.0 };
            for (i, z) in even.heights_m.iter().enumerate() {
                let expected = 3.0 * (even.start_m + (i as f64 + middle) * even.spacing_m);
                assert!((z - expected).abs() < 1e-9, "{i}: {z} {expected}");
            }
            assert!(even.heights_m.len() as f64 * even.spacing_m > x[3999] - x[0] - 0.3);
        }
    }
}
