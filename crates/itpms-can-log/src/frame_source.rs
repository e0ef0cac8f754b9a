//! Where frames come from, whatever the format.

use std::fmt::Debug;

use super::frame::CanFrame;
use super::repairs::FrameRepairs;
use crate::error::CanProblem;

/// A log of one format.
pub(crate) trait FrameSource: Debug + Send + Sync {
    fn next_frame(&mut self, repairs: &mut FrameRepairs) -> Result<Option<CanFrame>, CanProblem>;

    fn progress(&self) -> f64;
}
