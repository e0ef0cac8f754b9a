//! Power spectral densities, and what ISO 8608 reads from a road's.
//!
//! Called by the report, the score, the roughness and the paper's study. Knows profiles and frequencies, nothing of cars.

mod iso8608;
mod welch;

pub use iso8608::{
    Band, FitError, IsoClass, PowerLaw, REFERENCE_FREQUENCY_PER_M, RoadFit, fit_power_law, iso_bands,
};
pub use welch::{Psd, Welch, WelchError, welch};
