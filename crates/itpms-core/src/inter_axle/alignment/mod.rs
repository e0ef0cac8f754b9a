//! The front axle's signals, read again where the rear axle is now.

pub(crate) mod axle_pair;
pub(crate) mod channel;
pub(crate) mod delay_line;
pub(crate) mod delay_search;
pub(crate) mod opposite_side;
pub(crate) mod speed_latency;
pub(crate) mod travel;
pub(crate) mod way;
