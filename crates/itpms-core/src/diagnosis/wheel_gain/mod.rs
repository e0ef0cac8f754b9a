//! A wheel sensor's wrong gain: one that changes at once, one that changes by less, one that was wrong from the start.

pub(crate) mod balance;
pub(crate) mod jump;
pub(crate) mod shift;
