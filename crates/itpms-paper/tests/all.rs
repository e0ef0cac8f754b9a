//! The paper's filters through their public face.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

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
