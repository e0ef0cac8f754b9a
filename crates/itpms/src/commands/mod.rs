//! One file per command. A command reads its inputs, writes its outputs and says in a few lines what it found.

pub(crate) mod completions;
pub(crate) mod convert;
pub(crate) mod demo;
pub(crate) mod estimate;
pub(crate) mod fleet;
#[cfg(feature = "fmu")]
pub(crate) mod fmu;
pub(crate) mod identify;
pub(crate) mod lab;
pub(crate) mod man;
#[cfg(feature = "live")]
pub(crate) mod monitor;
pub(crate) mod plot;
pub(crate) mod reference;
pub(crate) mod roughness;
pub(crate) mod signals;
pub(crate) mod simulate;
pub(crate) mod vehicle;

/// Rows between two looks at the interrupt flag and the progress bar.
const ROWS_PER_LOOK: u64 = 1024;
