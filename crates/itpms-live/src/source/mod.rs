//! Where rows and frames come from, each source on a thread of its own that does nothing but read and hand on.
//!
//! | module | idea |
//! |---|---|
//! | [`replay`] | a log at the speed it was recorded, or faster |
//! | [`socketcan`] | a bus |
//! | [`stdin`] | lines of candump through a pipe |
//! | [`broker`] | the same as messages of an MQTT broker |
//! | `lines` | what such a line says |
//! | `bus_time` | what a frame's stamp tells when the clock is set |
//! | `pace` | when something recorded is due again |
//!
//! Started by `itpms monitor`; knows nothing of estimators.

pub mod broker;
#[cfg(target_os = "linux")]
mod bus_time;
mod lines;
mod pace;
pub mod replay;
#[cfg(target_os = "linux")]
pub mod socketcan;
pub mod stdin;

pub use pace::Speed;
