//! `itpms lab`: studies. Those that are older than the word have modules of their own beside this one.

#[cfg(feature = "live")]
pub(crate) mod faults;
