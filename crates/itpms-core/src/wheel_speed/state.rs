//! State of a car's wheels: the three ratios of their speeds, and the state that explains them.

/// The three ratios: front left over right, rear left over right, front over rear.
pub(super) const FRONT: usize = 0;
pub(super) const REAR: usize = 1;
pub(super) const AXLE: usize = 2;

/// The state, in thousandths (mrad/s where it is a yaw rate): the three ratios' offsets when the car last drove off, by how much they have
/// changed while it drove, slip per m/s², disturbances, by how much more per m/s² the left wheel of each axle slips than the right one, and
/// what a bend's load does to the ratio of each axle, per m/s² to the left.
pub(super) const OFFSET: usize = 0;
pub(super) const CHANGE: usize = 3;
pub(super) const SLIP: usize = 6;
pub(super) const YAW_BIAS: usize = 7;
pub(super) const YAW_NOISE: usize = 8;
pub(super) const FRONT_WANDER: usize = 9;
pub(super) const REAR_WANDER: usize = 10;
pub(super) const AXLE_FORCE: usize = 11;
pub(super) const UNEQUAL_SLIP: usize = 12;
pub(super) const BEND: usize = 14;
pub(super) const STATES: usize = 16;
/// Log ratios are kept in thousandths, so that single precision holds their squares.
pub(super) const SCALE: f64 = 1e3;
