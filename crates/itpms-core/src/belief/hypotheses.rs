//! Which ways there are in which pressures may be changing, and which compliances follow the rate in each
//! (docs/math/shared-road.md, section 6). The bank holds one Gaussian for each, the transition moves weight between them.

use super::gaussian::Hypothesis;
use crate::real::Real;

/// Nothing moves; each wheel loses pressure by itself; both of the left alike, or of the right; any wheel wanders either way.
pub(crate) const HYPOTHESES: usize = 8;
pub(super) const CONSTANT: usize = 0;
pub(super) const SIDE: usize = 5;
pub(super) const RANDOM_WALK: usize = 7;

/// A Gaussian for each.
pub(super) type Hypotheses<T> = [Hypothesis<T>; HYPOTHESES];

/// Whether compliances follow the rate in a hypothesis.
pub(super) fn has_rate(hypothesis: usize) -> bool {
    hypothesis != CONSTANT && hypothesis != RANDOM_WALK
}

/// How the compliances follow the rate in a hypothesis.
pub(super) fn changing<T: Real>(hypothesis: usize) -> [T; 4] {
    let changing = |i: usize| hypothesis == i + 1 || hypothesis == SIDE + i % 2;
    core::array::from_fn(|i| if changing(i) { T::one() } else { T::zero() })
}
