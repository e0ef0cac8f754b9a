//! The paper's filters through their public face.

/// Plants and random numbers of the core's own tests.
#[path = "../../itpms-core/tests/common/mod.rs"]
mod common;
mod estimator;
mod filter_properties;
mod informed_filter;
mod published_filter;
mod published_lean;
mod published_transcription;
mod saved_filters;
