//! A wheel sensor's wrong gain: one that changes, one that was wrong from the start.

pub(crate) mod balance;
pub(crate) mod shift;
