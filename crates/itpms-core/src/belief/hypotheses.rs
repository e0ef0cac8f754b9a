//! Which ways there are in which pressures may be changing, and which compliances follow the rate in each
//! (docs/math/shared-road.md, section 6). The bank holds one Gaussian for each, the transition moves weight between them.

use super::gaussian::Hypothesis;
use crate::model::Corner;
use crate::real::Real;

/// Nothing moves; each wheel loses pressure by itself; both of the left alike, or of the right; any wheel wanders either way.
pub(crate) const HYPOTHESES: usize = 8;
pub(super) const CONSTANT: usize = 0;
pub(super) const SIDE: usize = 5;
pub(super) const RANDOM_WALK: usize = 7;

pub(super) type Hypotheses<T> = [Hypothesis<T>; HYPOTHESES];

/// Whether compliances follow the rate in a hypothesis.
pub(super) fn has_rate(hypothesis: usize) -> bool {
    hypothesis != CONSTANT && hypothesis != RANDOM_WALK
}

/// The wheel that loses pressure by itself in a hypothesis, if that is one of those.
pub(super) fn single(hypothesis: usize) -> Option<Corner> {
    Corner::ALL.get(hypothesis.wrapping_sub(1)).copied()
}

/// That of both wheels of a corner's side.
pub(super) fn both(corner: Corner) -> usize {
    SIDE + corner.side().index()
}

/// How the compliances follow the rate in a hypothesis.
pub(super) fn changing<T: Real>(hypothesis: usize) -> [T; 4] {
    let changing = |corner| single(hypothesis) == Some(corner) || hypothesis == both(corner);
    Corner::ALL.map(|corner| if changing(corner) { T::one() } else { T::zero() })
}
