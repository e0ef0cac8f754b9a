//! The unknowns that the accelerations and all their derivatives fix or leave free: the rank of the observability matrix
//! with the road as an unknown input (`docs/math/identifiability.md`, eq. 4-10).
//!
//! Called by the study. The unknowns are the states, the stiffnesses and the road with its derivatives at one instant;
//! the outputs are the accelerations with theirs. The matrix is the derivative of the latter by the former, exact (no
//! finite differences), in units that make all of them of order one.

use itpms_core::model::CornerConfig;
use nalgebra::DVector;
use serde::Serialize;

use super::motion::{Layout, Motion, Wheel};

/// Derivatives of the outputs that are looked at; what is missing stops changing at the second.
const ORDER: usize = 7;
const POINTS: u64 = 20;
/// Singular values below this share of the largest count as zero.
pub const TOLERANCE: f64 = 1e-10;
/// A direction of unit length that moves a stiffness by less than this does not move it.
const STILL: f64 = 1e-5;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Known {
    Nothing,
    FirstStiffness,
    Road,
}

itpms_core::labelled! {
    /// Observability of the first wheel's stiffness.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Stiffness {
        /// Nothing is reported of it.
        Free = "free",
        /// Only how much two stiffnesses differ.
        DifferenceOnly = "difference only",
        Fixed = "fixed",
        Known = "known",
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RankCase {
    pub label: String,
    /// States, stiffnesses, road and its derivatives.
    pub unknowns: usize,
    pub rank: usize,
    /// Directions of the unknowns no measurement sees.
    pub missing: usize,
    /// How many of them are body, wheel and road moving together (height and velocity): 0 to 2.
    pub drifts: usize,
    pub stiffness: Stiffness,
    /// Smallest singular value kept, over the largest; the worst instant.
    pub smallest_kept: f64,
    /// Largest singular value taken for zero, over the largest; the worst instant; 0 where there is none.
    pub largest_dropped: f64,
    /// `|J v| / (|J| |v|)` for the exchange of stiffness for road, `v` of eq. 8; one wheel only.
    pub exchange_residual: Option<f64>,
}

/// All cases for a corner and the one behind it.
pub(super) fn cases(front: &CornerConfig<f64>, rear: &CornerConfig<f64>) -> Vec<RankCase> {
    let full = front.placard_kpa;
    let low = 0.8 * full;
    let one = vec![(*front, full)];
    let alike = vec![(*front, full), (*front, full)];
    let after_loss = vec![(*front, low), (*front, full)];
    let unlike = vec![(*front, full), (*rear, rear.placard_kpa)];
    [
        ("one wheel, nothing known", &one, Known::Nothing),
        ("one wheel, its stiffness known", &one, Known::FirstStiffness),
        ("one wheel, the road known", &one, Known::Road),
        ("front and rear alike, same pressure", &alike, Known::Nothing),
        ("the same, pressures differ", &after_loss, Known::Nothing),
        ("the rear wheel another one", &unlike, Known::Nothing),
        ("repeated road, same pressure in both passes", &alike, Known::Nothing),
        ("the same, pressure lost between", &after_loss, Known::Nothing),
        ("the same, first pressure known (calibration)", &after_loss, Known::FirstStiffness),
    ]
    .into_iter()
    .map(|(label, wheels, known)| case(label, wheels, known))
    .collect()
}

fn case(label: &str, wheels: &[Wheel], known: Known) -> RankCase {
    let mut found: Option<RankCase> = None;
    for seed in 0..POINTS {
        let here = at_point(label, wheels, known, ORDER, seed);
        found = Some(match found {
            None => here,
            Some(so_far) => worse(so_far, here),
        });
    }
    // POINTS is not zero.
    found.unwrap_or_else(|| at_point(label, wheels, known, ORDER, 0))
}

/// The less favorable of two instants in every respect.
fn worse(a: RankCase, b: RankCase) -> RankCase {
    let residual = match (a.exchange_residual, b.exchange_residual) {
        (Some(x), Some(y)) => Some(f64::max(x, y)),
        _ => None,
    };
    let smallest_kept = a.smallest_kept.min(b.smallest_kept);
    let largest_dropped = a.largest_dropped.max(b.largest_dropped);
    let base = if b.rank < a.rank { b } else { a };
    RankCase { smallest_kept, largest_dropped, exchange_residual: residual, ..base }
}

fn at_point(label: &str, wheels: &[Wheel], known: Known, order: usize, seed: u64) -> RankCase {
    let layout = Layout { wheels: wheels.len(), road_known: known == Known::Road, order };
    let motion = Motion::random(wheels, order, seed);
    let mut jacobian = motion.jacobian(wheels, &layout);
    if known == Known::FirstStiffness {
        // Known: its column asks for nothing.
        jacobian.column_mut(layout.stiffness(0)).fill(0.0);
    }
    let asked = layout.len() - usize::from(known == Known::FirstStiffness);
    // Wide enough for a full set of right singular vectors.
    let rows = jacobian.nrows().max(layout.len());
    let padded = jacobian.clone().resize_vertically(rows, 0.0);
    let svd = padded.svd(false, true);
    let values = &svd.singular_values;
    let largest = values.max();
    let rank = values.iter().filter(|&&v| v > TOLERANCE * largest).count();
    let over = |v: f64| v / largest;
    let kept = values.iter().copied().filter(|&v| v > TOLERANCE * largest).fold(f64::INFINITY, f64::min);
    let known_columns = usize::from(known == Known::FirstStiffness);
    let mut dropped: Vec<f64> = values.iter().copied().filter(|&v| !(v > TOLERANCE * largest)).collect();
    dropped.sort_by(f64::total_cmp);
    dropped.drain(..known_columns.min(dropped.len()));
    let null: Vec<DVector<f64>> = svd
        .v_t
        .iter()
        .flat_map(|v_t| {
            (0..values.len()).filter(|&i| !(values[i] > TOLERANCE * largest)).map(|i| v_t.row(i).transpose())
        })
        .collect();
    let size = jacobian.norm();
    let residual = |v: &DVector<f64>| (&jacobian * v).norm() / (size * v.norm());
    RankCase {
        label: label.to_owned(),
        unknowns: asked,
        rank,
        missing: asked - rank,
        drifts: motion.drifts(&layout).iter().filter(|v| residual(v) < TOLERANCE).count(),
        stiffness: stiffness(&null, &layout, known),
        smallest_kept: over(kept),
        largest_dropped: over(dropped.last().copied().unwrap_or(0.0)),
        exchange_residual: (wheels.len() == 1 && known == Known::Nothing)
            .then(|| residual(&motion.exchange(&layout))),
    }
}

fn stiffness(null: &[DVector<f64>], layout: &Layout, known: Known) -> Stiffness {
    // A reset is asked what becomes of the other wheel (the later pass).
    let asked = match (known, layout.wheels) {
        (Known::FirstStiffness, 1) => return Stiffness::Known,
        (Known::FirstStiffness, _) => layout.stiffness(1),
        _ => layout.stiffness(0),
    };
    let moves = |part: &dyn Fn(&DVector<f64>) -> f64| null.iter().any(|v| part(v).abs() > STILL);
    if !moves(&|v| v[asked]) {
        return Stiffness::Fixed;
    }
    if layout.wheels == 2 && !moves(&|v| v[layout.stiffness(0)] - v[layout.stiffness(1)]) {
        return Stiffness::DifferenceOnly;
    }
    Stiffness::Free
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observability::rear;

    #[test]
    fn ranks_are_those_of_the_derivation() {
        // missing directions, drifts among them, and the stiffness: counted by hand in section 2 of the page.
        use Stiffness::{DifferenceOnly, Fixed, Free, Known};
        let expected = [
            (3, 2, Free),
            (2, 2, Known),
            (0, 0, Fixed),
            (3, 2, DifferenceOnly),
            (2, 2, Fixed),
            (2, 2, Fixed),
            (3, 2, DifferenceOnly),
            (2, 2, Fixed),
            (2, 2, Fixed),
        ];
        let found = cases(&CornerConfig::paper(), &rear());
        assert_eq!(found.len(), expected.len());
        for (case, (missing, drifts, stiffness)) in found.iter().zip(expected) {
            assert_eq!(
                (case.missing, case.drifts, case.stiffness),
                (missing, drifts, stiffness),
                "{case:#?}"
            );
            // A clear gap between what counts and what does not.
            assert!(case.smallest_kept > 1e3 * case.largest_dropped.max(1e-16), "{case:#?}");
        }
        assert!(found[0].exchange_residual.unwrap() < 1e-14);
    }
}
