//! Where rows and frames come from, each source on a thread of its own that does nothing but read and hand on.
//!
//! | room | idea |
//! |---|---|
//! | `replay` | a log at the speed it was driven, or faster |
//!
//! Started by `itpms monitor`; knows nothing of estimators.

mod pace;
pub mod replay;

pub use pace::Speed;
