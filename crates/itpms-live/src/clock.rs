//! A drive's rate and columns, known before the first row is estimated.

use itpms_core::model::Corner;

/// How often rows come, and of which corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    pub sample_rate_hz: f64,
    pub corners: Vec<Corner>,
    /// Whether the speeds of all four wheels come, and the vehicle has what they need.
    pub wheel_speeds: bool,
}

impl Clock {
    /// Whether front and rear of a side are measured: where the speed is known they are held against each other.
    pub fn has_side(&self) -> bool {
        [[Corner::FrontLeft, Corner::RearLeft], [Corner::FrontRight, Corner::RearRight]]
            .iter()
            .any(|side| side.iter().all(|corner| self.corners.contains(corner)))
    }
}
