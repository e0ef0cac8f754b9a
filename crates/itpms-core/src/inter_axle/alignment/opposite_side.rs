//! How the other side's wheels move: anti-roll bars, and a rear axle that is one body, bring that into the forces of this one.

use crate::inter_axle::alignment::channel::{KEPT, SEEN};
use crate::real::Real;

/// How the other side's rear wheel moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum OppositeSide<T> {
    /// Its relative velocity in m/s, and its jerk in m/s³.
    Known([T; 2]),
    /// Not known at this moment, as when its wheel has just left the road.
    Missed,
    /// It has sent nothing for a while.
    Silent,
}

/// How the other side's suspensions moved: at the front when it was where the rear is now, and at the rear. Where one tells
/// nothing it moves as the other one did at that place, `ratio` times as fast at the rear: else the anti-roll bar makes of a
/// hole under that side a road of this one's axle. Where neither is known they stand still, and the bar is one more
/// spring: where a tire shows, each side's wheels move for themselves.
pub(super) fn of_other_side<T: Real>(ahead: Option<T>, beside: OppositeSide<T>, ratio: T) -> [Option<T>; 2] {
    match (ahead, beside) {
        (None, OppositeSide::Known([behind, _])) => [Some(behind / ratio), Some(behind)],
        (Some(ahead), OppositeSide::Silent) => [Some(ahead), Some(ratio * ahead)],
        (None, OppositeSide::Silent) => [Some(T::zero()); 2],
        (ahead, OppositeSide::Known([behind, _])) => [ahead, Some(behind)],
        (ahead, OppositeSide::Missed) => [ahead, None],
    }
}

/// A corner's signals, its relative velocity less the other side's, and the other side's jerk less its own; none, as if both moved alike,
/// where that is not known.
pub(super) fn with_other<T: Real>(signals: [T; KEPT], other: Option<T>, other_jerk: Option<T>) -> [T; SEEN] {
    let [wheel, jerk, acceleration, relative] = signals;
    let across = other.map_or(T::zero(), |other| relative - other);
    let jerk_across = other_jerk.map_or(T::zero(), |other| other - jerk);
    [wheel, jerk, acceleration, relative, across, jerk_across]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_silent_wheel_moves_as_the_other_one_of_its_side_did() {
        // At the rear half as fast again as at the front.
        let others = |ahead, beside| of_other_side(ahead, beside, 1.5);
        assert_eq!(others(Some(2.0), OppositeSide::Known([7.0, 0.0])), [Some(2.0), Some(7.0)]);
        assert_eq!(others(Some(2.0), OppositeSide::Silent), [Some(2.0), Some(3.0)]);
        assert_eq!(others(None, OppositeSide::Known([3.0, 0.0])), [Some(2.0), Some(3.0)]);
        // A wheel in the air moves as no other one.
        assert_eq!(others(Some(2.0), OppositeSide::Missed), [Some(2.0), None]);
        assert_eq!(others(None, OppositeSide::Missed), [None, None]);
        // Of a whole side that is silent it is known that it moves otherwise.
        assert_eq!(others(None, OppositeSide::Silent), [Some(0.0), Some(0.0)]);
    }
}
