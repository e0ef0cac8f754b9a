//! Short spectral frames, the signals they are made of, and what a quarter car makes of a road.

pub(crate) mod butterworth;
mod frame;
pub(crate) mod front_end;
pub(crate) mod persistence;
pub(crate) mod reconstruction;
pub(crate) mod transfer;

pub(crate) use self::frame::{Frame, FrameClock, INDEPENDENT, OVERLAP};
pub(crate) use self::persistence::{COHERENCE_S, LASTING_S};
pub(crate) use self::reconstruction::SIGNALS;
pub use self::reconstruction::{
    LEAK_RAD_S, RELATIVE_ACCELERATION, RELATIVE_VELOCITY, Reconstruction, WHEEL_JERK, WHEEL_VELOCITY,
};
