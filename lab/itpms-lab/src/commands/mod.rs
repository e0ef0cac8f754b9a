//! One file per study: it reads its inputs, writes its outputs and says in a few lines what it found.

pub(crate) mod certify;
pub(crate) mod faults;
pub(crate) mod malfunctions;
pub(crate) mod observability;
pub(crate) mod reproduce;
pub(crate) mod score;
pub(crate) mod soak;
